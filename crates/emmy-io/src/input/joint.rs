//! `[[joint]]`: one row per kind of joint.

use emmy::body::{Joint, JointEnd, JointKind, TimeFunction};
use emmy::internals::number::short;

use super::description::{Described, Kind, POSITIVE, Section, TAKEN, either, exactly, vector};
use super::fault::{Fault, Faults, Place};
use super::history::{self, Context};
use super::measured::MEASURED;
use super::table::{Item, Read, Table};

/// A kind of joint.
struct Row {
    name: &'static str,
    doc: &'static str,
    /// Its keys.
    keys: &'static Described,
    /// Reads its places.
    read: fn(&Table<'_>) -> Result<(JointKind, [f64; 3]), Fault>,
}

/// Every kind of joint.
const ROWS: [Row; 9] = [
    Row {
        name: "spherical",
        doc: "A point in common",
        keys: &AT_A_POINT,
        read: |table| Ok((JointKind::Spherical, table.must("at"))),
    },
    Row {
        name: "revolute",
        doc: "A hinge: a point and an axis in common",
        keys: &WITH_AN_AXIS,
        read: |table| with_axis(table, |axis| JointKind::Revolute { axis }),
    },
    Row {
        name: "universal",
        doc: "A point in common, and an angle between an axis of each",
        keys: &UNIVERSAL,
        read: universal,
    },
    Row {
        name: "cylindrical",
        doc: "An axis in common, about which they turn and along which they slide",
        keys: &WITH_AN_AXIS,
        read: |table| with_axis(table, |axis| JointKind::Cylindrical { axis }),
    },
    Row {
        name: "prismatic",
        doc: "A slider: an axis in common, along which they slide without turning",
        keys: &WITH_AN_AXIS,
        read: |table| with_axis(table, |axis| JointKind::Prismatic { axis }),
    },
    Row {
        name: "inline",
        doc: "A point of the first body on an axis of the second",
        keys: &WITH_AN_AXIS,
        read: |table| with_axis(table, |axis| JointKind::Inline { axis }),
    },
    Row {
        name: "planar",
        doc: "A plane in common, normal to the axis",
        keys: &WITH_AN_AXIS,
        read: |table| with_axis(table, |axis| JointKind::Planar { axis }),
    },
    Row {
        name: "fixed",
        doc: "Two bodies made one",
        keys: &AT_A_POINT,
        read: |table| Ok((JointKind::Fixed, table.must("at"))),
    },
    Row {
        name: "distance",
        doc: "A rigid link without mass between two points",
        keys: &DISTANCE,
        read: distance,
    },
];

/// `[[joint]]`.
pub(super) static JOINT: Described = Described::new(|| {
    let section = Section::new("[[joint]]", "A joint of two bodies, as they are drawn: exactly one kind")
        .may("name", Kind::Column(&TAKEN), "", "Its name: letters, digits, `_` and `-`")
        .absent("`joint-1`, `joint-2`, .. by its place");
    let add = |section: Section, row: &Row| section.may(row.name, Kind::Table(row.keys), "", row.doc);
    let angle = "Given angle of a revolute or cylindrical joint over time, from 0 on: of the first body relative to the \
                 second, about the axis, counter-clockwise seen from its tip";
    let slide = "Given slide of a prismatic joint over time, from 0 on: of the first body relative to the second, along \
                 the axis";
    ROWS.iter()
        .fold(section, add)
        .may("angle", Kind::TimeFunction(&MEASURED), "radian", angle)
        .absent("free")
        .may("slide", Kind::TimeFunction(&MEASURED), "length", slide)
        .absent("free")
        .exactly_one(&ROWS.map(|row| row.name))
});

const BETWEEN: &str = "The two bodies: names of rigid bodies, `\"ground\"`, or for some kinds groups of the mesh, of \
                       which the node at the place of the joint is meant";
const AT: &str = "The point in common, of both as they are drawn";

/// A table of a joint with its two bodies.
fn between(name: &'static str, doc: &str) -> Section {
    Section::new(name, doc).must("between", exactly(2, Kind::Text), "", BETWEEN)
}

static AT_A_POINT: Described = Described::new(|| {
    between("a joint at a point", "A joint without an axis").must("at", vector(), "length", AT)
});

static WITH_AN_AXIS: Described = Described::new(|| {
    between("a joint with an axis", "A joint with an axis").must("at", vector(), "length", AT).must(
        "axis",
        vector(),
        "",
        "Direction of the axis, of any length",
    )
});

static UNIVERSAL: Described = Described::new(|| {
    between("a universal joint", "A joint with an axis of each body").must("at", vector(), "length", AT).must(
        "axes",
        exactly(2, vector()),
        "",
        "Directions of the axis of the first and of the second body",
    )
});

static DISTANCE: Described = Described::new(|| {
    let length = "Length of the link: the distance of the points, or a history that begins with it";
    between("a distance", "A rigid link without mass")
        .must("points", exactly(2, vector()), "length", "A point of the first body and one of the second")
        .may("length", either(POSITIVE, Kind::TimeFunction(&MEASURED)), "length", length)
        .absent("as drawn")
});

/// A joint before its bodies are found, with its places.
#[derive(Debug)]
pub(super) struct PlacedJoint {
    pub(super) name: String,
    pub(super) kind: JointKind,
    pub(super) at: [f64; 3],
    pub(super) drive: Option<TimeFunction>,
    /// Names of the bodies.
    pub(super) between: [(String, Place); 2],
    /// Place of the table.
    pub(super) place: Place,
    /// Place of the name, or of the table.
    pub(super) name_place: Place,
}

/// Reads one joint; `number` counts joints from 1.
pub(super) fn read(
    table: &Table<'_>,
    number: usize,
    context: Context<'_>,
    faults: &mut Faults,
) -> Option<PlacedJoint> {
    let chosen = table.chosen();
    let own = Table::read(chosen);
    let row = ROWS.iter().find(|row| row.name == chosen.key)?;
    let given = table.item("name");
    let name = given.and_then(|item| item.text()).map_or_else(|| format!("joint-{number}"), str::to_string);
    let found = faults.keep((row.read)(&own).map_err(|fault| fault.before(&format!("joint `{name}`: "))));
    let (kind, at) = found?;
    let drive = drive(table, &own, (&name, kind, at), context);
    let drive = faults.keep(drive)?;
    let names: Vec<Item<'_>> = own.must("between");
    let [first, second] = names.as_slice() else { return None };
    let between = [first, second].map(|item| (item.name(), item.place().clone()));
    let place = table.place.clone();
    let name_place = given.map_or(&place, |item| item.place()).clone();
    Some(PlacedJoint { name, kind, at, drive, between, place, name_place })
}

fn direction(item: &Item<'_>) -> Result<[f64; 3], Fault> {
    let axis: [f64; 3] = Read::read(*item);
    match axis == [0.0; 3] {
        true => Err(item.fault(format!("`{}` must have a direction", item.key), "zero")),
        false => Ok(axis),
    }
}

fn with_axis(table: &Table<'_>, kind: fn([f64; 3]) -> JointKind) -> Result<(JointKind, [f64; 3]), Fault> {
    Ok((kind(direction(&table.must("axis"))?), table.must("at")))
}

/// Sine of the angle between two axes below which they are parallel.
const PARALLEL: f64 = 1e-9;

fn universal(table: &Table<'_>) -> Result<(JointKind, [f64; 3]), Fault> {
    let item: Item<'_> = table.must("axes");
    let items = item.items();
    let [first, second] = items.as_slice() else { return Err(item.fault("`axes` are two", "here")) };
    let axes = [direction(first)?, direction(second)?];
    let [a, b] = axes.map(|axis| {
        let largest = axis.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        axis.map(|x| x / largest)
    });
    let normal = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    });
    if size(normal) < PARALLEL * size(a) * size(b) {
        let message = "its axes are parallel; a universal joint needs an angle between them";
        return Err(item.fault(message, "parallel"));
    }
    Ok((JointKind::Universal { axes }, table.must("at")))
}

fn distance(table: &Table<'_>) -> Result<(JointKind, [f64; 3]), Fault> {
    let [at, to]: [[f64; 3]; 2] = table.must("points");
    if at == to {
        let item: Item<'_> = table.must("points");
        let message = "its points coincide; a distance needs two points, a spherical joint one";
        return Err(item.fault(message, "one point"));
    }
    Ok((JointKind::Distance { to }, at))
}

fn size(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Difference of a given length from that of the drawing, relative to it, that is rounding in the input.
const SAME_LENGTH: f64 = 1e-6;

/// The given motion of a joint: of its angle, its slide or its length.
fn drive(
    table: &Table<'_>,
    own: &Table<'_>,
    (name, kind, at): (&str, JointKind, [f64; 3]),
    context: Context<'_>,
) -> Result<Option<TimeFunction>, Fault> {
    let given = ["angle", "slide"].into_iter().filter_map(|key| table.item(key));
    let taken = kind.coordinate();
    for item in given {
        if taken == Some(item.key) {
            return from_rest(&item, name, context).map(Some);
        }
        let (kind, key) = (with_article(kind), item.key);
        let message = format!("joint `{name}`: {kind} joint has no `{key}` to be given");
        let fault = item.fault(message, format!("not of {kind} joint"));
        return Err(fault.help(match key {
            "angle" => "revolute and cylindrical joints take `angle`",
            _ => "prismatic joints take `slide`",
        }));
    }
    let JointKind::Distance { to } = kind else { return Ok(None) };
    let Some(item) = own.item("length").and_then(Item::of_one_kind) else { return Ok(None) };
    let drawn = size([0, 1, 2].map(|i| at[i] - to[i]));
    if matches!(item.kind, Kind::Number(_)) {
        let length: f64 = Read::read(item);
        if (length - drawn).abs() <= SAME_LENGTH * drawn {
            return Ok(None);
        }
        let [length, drawn] = [length, drawn].map(short);
        let message = format!(
            "joint `{name}`: the points are {drawn} apart, `length` says {length}; leave it out to take {drawn}"
        );
        return Err(item.fault(message, format!("not {drawn}")));
    }
    let length = history::without_jumps(item, context)?;
    let start = length.value(0.0);
    if context.is_undeformed && (start - drawn).abs() > SAME_LENGTH * drawn {
        let [start, drawn] = [start, drawn].map(short);
        let message = format!(
            "the drive of `{name}` starts at a length of {start}; joints start as drawn, here at {drawn}"
        );
        return Err(item.fault(message, "not as drawn"));
    }
    // Exactly zero at the start, also where the input has rounded the length.
    let drawn = if context.is_undeformed { start } else { drawn };
    less(&length, drawn).map(Some).map_err(|error| item.fault(error.to_string(), "here"))
}

/// A drive that starts as drawn.
fn from_rest(item: &Item<'_>, name: &str, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let drive = history::without_jumps(*item, context)?;
    let start = drive.value(0.0);
    if context.is_undeformed && start.abs() > history::ROUNDING {
        let unit = if item.key == "angle" { " rad" } else { "" };
        let message =
            format!("the drive of `{name}` starts at {}{unit}; joints start as drawn, at 0", short(start));
        return Err(item.fault(message, "not 0 at the start"));
    }
    Ok(drive)
}

/// A time function less a number.
fn less(function: &TimeFunction, number: f64) -> emmy::Result<TimeFunction> {
    let entries = function.entries();
    if !entries.is_empty() {
        let entries = entries.iter().map(|&(time, value)| (time, value - number)).collect();
        return if function.is_measured() {
            TimeFunction::measured(entries)
        } else {
            TimeFunction::new(entries)
        };
    }
    let text = format!("{} - {number:?}", function.text().unwrap_or_default());
    let own = function.clone();
    Ok(match function.has_rate() {
        true => TimeFunction::smooth(&text, move |time| [own.value(time) - number, own.rate(time), f64::NAN]),
        false => TimeFunction::of_times(&text, move |times, values| {
            values.iter_mut().zip(times).for_each(|(value, time)| *value = own.value(*time) - number);
        }),
    })
}

impl PlacedJoint {
    /// Whether its first or second end must have directions.
    pub(super) fn needs_direction(&self, end: usize) -> bool {
        match self.kind {
            JointKind::Spherical | JointKind::Distance { .. } => false,
            JointKind::Inline { .. } => end == 1,
            _ => true,
        }
    }

    /// The place of its first or second end.
    pub(super) fn point(&self, end: usize) -> [f64; 3] {
        match self.kind {
            JointKind::Distance { to } if end == 1 => to,
            _ => self.at,
        }
    }

    /// The key of its places.
    pub(super) fn key_of_points(&self) -> &'static str {
        if matches!(self.kind, JointKind::Distance { .. }) { "points" } else { "at" }
    }

    /// The joint of two bodies.
    pub(super) fn of(&self, between: [JointEnd; 2]) -> Joint {
        let joint = Joint::new(self.name.clone(), self.kind, between, self.at);
        Joint { drive: self.drive.clone(), ..joint }
    }
}

/// A kind of joint in a sentence.
pub(super) fn with_article(kind: JointKind) -> String {
    let word = kind.word();
    let article = if word.starts_with('i') { "an" } else { "a" };
    format!("{article} {word}")
}

/// The fault of an impossible joint.
pub(super) fn fault(error: &emmy::Error, placed: &[PlacedJoint]) -> Option<Fault> {
    let emmy::Error::Joint { joint, .. } = error else { return None };
    let own = placed.iter().find(|own| own.name == *joint)?;
    Some(Fault::at(&own.place, error.to_string(), "this joint"))
}
