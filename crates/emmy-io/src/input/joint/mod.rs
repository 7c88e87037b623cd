//! `[[joint]]`: one row per kind of joint.

mod motion;

use emmy::body::{Joint, JointEnd, JointKind, TimeFunction};

use crate::input::context::Context;
use crate::input::description::{Described, Kind, NUMBER, POSITIVE, Section, TAKEN, either, exactly, vector};
use crate::input::fault::{Fault, Faults, Place};
use crate::input::measured::MEASURED;
use crate::input::suggest::listed;
use crate::input::table::{Item, Read, Table};
use motion::Forces;

/// A kind of joint.
struct Row {
    name: &'static str,
    doc: &'static str,
    /// Its keys.
    keys: &'static Described,
    /// Reads its places.
    read: ReadKind,
}

/// Reads a kind of joint, and the point of its first body.
type ReadKind = fn(&Table<'_>) -> Result<(JointKind, [f64; 3]), Fault>;

/// Every kind of joint.
const ROWS: [Row; 10] = [
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
        read: |table| between_points(table, |to| JointKind::Distance { to }),
    },
    Row {
        name: "line",
        doc: "No constraint: a line between two points for `spring`, `damping` or `force`",
        keys: &LINE,
        read: |table| between_points(table, |to| JointKind::Line { to }),
    },
];

/// `[[joint]]`.
pub(in crate::input) static JOINT: Described = Described::new(|| {
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
        .may("spring", Kind::Table(&SPRING), "", "A spring in the angle, over any number of turns, in the slide or in the length of the line")
        .absent("none")
        .may("damping", POSITIVE, "", "Force over the rate of the slide or the length, torque over that of the angle")
        .absent("none")
        .may(
            "torque",
            Kind::TimeFunction(&MEASURED),
            "force·length",
            "Torque of a revolute or cylindrical joint on the first body about the axis, over time",
        )
        .absent("none")
        .may(
            "force",
            Kind::TimeFunction(&MEASURED),
            "force",
            "Force of a prismatic joint on the first body along the axis, or of a line that lengthens it, over time",
        )
        .absent("none")
        .may("until", POSITIVE, "time", "Time of release, from which on it exerts nothing")
        .absent("never")
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

static SPRING: Described = Described::new(|| {
    let rest = "Angle or slide from the drawing, or length of the line, at which it has no force";
    Section::new(
        "the spring of a joint",
        "A spring in the coordinate x of a joint: its energy is stiffness (x - rest)²/2",
    )
    .must("stiffness", POSITIVE, "", "Force over length, or torque over angle")
    .may("rest", NUMBER, "", rest)
    .absent("as drawn")
});

static LINE: Described = Described::new(|| {
    between("a line", "A line without a constraint").must("points", exactly(2, vector()), "length", POINTS)
});

const POINTS: &str = "A point of the first body and one of the second";

static DISTANCE: Described = Described::new(|| {
    let length = "Length of the link: the distance of the points, or a history that begins with it";
    between("a distance", "A rigid link without mass")
        .must("points", exactly(2, vector()), "length", POINTS)
        .may("length", either(POSITIVE, Kind::TimeFunction(&MEASURED)), "length", length)
        .absent("as drawn")
});

/// A joint before its bodies are found, with its places.
#[derive(Debug)]
pub(in crate::input) struct PlacedJoint {
    pub(in crate::input) name: String,
    pub(in crate::input) kind: JointKind,
    pub(in crate::input) at: [f64; 3],
    pub(in crate::input) drive: Option<TimeFunction>,
    pub(in crate::input) forces: Forces,
    pub(in crate::input) until: Option<f64>,
    /// Names of the bodies.
    pub(in crate::input) between: [(String, Place); 2],
    /// Place of the table.
    pub(in crate::input) place: Place,
    /// Place of the name, or of the table.
    pub(in crate::input) name_place: Place,
}

/// Reads one joint; `number` counts joints from 1.
pub(in crate::input) fn read(
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
    let drive = motion::drive(table, &own, (&name, kind, at), context);
    let drive = faults.keep(drive)?;
    let forces = faults.keep(motion::forces(table, chosen, (&name, kind, drive.is_some()), context))?;
    let names: Vec<Item<'_>> = own.must("between");
    let [first, second] = names.as_slice() else { return None };
    let between = [first, second].map(|item| (item.name(), item.place().clone()));
    let place = table.place.clone();
    let name_place = given.map_or(&place, |item| item.place()).clone();
    let until = table.may("until");
    Some(PlacedJoint { name, kind, at, drive, forces, until, between, place, name_place })
}

/// Label and advice of a key of another kind of joint in the table of one, or of a key of a kind beside that table.
pub(in crate::input) fn of_another_kind(section: &Section, key: &str) -> Option<(String, String)> {
    let has = |row: &&Row| row.keys.key_of(key).is_some();
    let with_key: Vec<&str> = ROWS.iter().filter(has).map(|row| row.name).collect();
    if with_key.is_empty() {
        return None;
    }
    let advice = format!("`{key}` is a key of {}", listed(with_key));
    if std::ptr::eq(&*JOINT, section) {
        return Some((format!("`{key}` belongs in the braces of the kind"), advice));
    }
    let is_own = |row: &&Row| std::ptr::eq::<Section>(&**row.keys, section);
    let own: Vec<&str> = ROWS.iter().filter(is_own).map(|row| row.name).collect();
    if own.is_empty() {
        return None;
    }
    Some((format!("{} joints have no `{key}`", own.join(" and ")), advice))
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

fn between_points(
    table: &Table<'_>,
    kind: fn([f64; 3]) -> JointKind,
) -> Result<(JointKind, [f64; 3]), Fault> {
    let [at, to]: [[f64; 3]; 2] = table.must("points");
    if at == to {
        let item: Item<'_> = table.must("points");
        let message = "its points coincide; a distance needs two points, a spherical joint one";
        return Err(item.fault(message, "one point"));
    }
    Ok((kind(to), at))
}

fn size(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl PlacedJoint {
    /// Whether its first or second end must have directions.
    pub(in crate::input) fn needs_direction(&self, end: usize) -> bool {
        match self.kind {
            JointKind::Spherical | JointKind::Distance { .. } | JointKind::Line { .. } => false,
            JointKind::Inline { .. } => end == 1,
            _ => true,
        }
    }

    /// The place of its first or second end.
    pub(in crate::input) fn point(&self, end: usize) -> [f64; 3] {
        match self.kind {
            JointKind::Distance { to } | JointKind::Line { to } if end == 1 => to,
            _ => self.at,
        }
    }

    /// The key of its places.
    pub(in crate::input) fn key_of_points(&self) -> &'static str {
        match self.kind {
            JointKind::Distance { .. } | JointKind::Line { .. } => "points",
            _ => "at",
        }
    }

    /// The joint of two bodies.
    pub(in crate::input) fn of(&self, between: [JointEnd; 2]) -> Joint {
        let joint = Joint::new(self.name.clone(), self.kind, between, self.at);
        let Forces { spring, damping, motor } = &self.forces;
        let (drive, motor) = (self.drive.clone(), motor.clone());
        Joint { drive, spring: *spring, damping: *damping, motor, until: self.until, ..joint }
    }
}

/// A kind of joint in a sentence.
pub(in crate::input) fn with_article(kind: JointKind) -> String {
    let word = kind.word();
    let article = if word.starts_with('i') { "an" } else { "a" };
    format!("{article} {word}")
}

/// The fault of an impossible joint.
pub(in crate::input) fn fault(error: &emmy::Error, placed: &[PlacedJoint]) -> Option<Fault> {
    let emmy::Error::Joint { joint, .. } = error else { return None };
    let own = placed.iter().find(|own| own.name == *joint)?;
    Some(Fault::at(&own.place, error.to_string(), "this joint"))
}
