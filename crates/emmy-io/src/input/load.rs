//! `[[load]]`: one row per kind of load.

use emmy::body::{GroundAttraction, Load, LoadKind, TimeFunction};
use emmy::internals::material::Bounds;

use super::context::Context;
use super::description::{Described, Kind, NUMBER, POSITIVE, Rule, Section, exactly, vector, word};
use super::expression;
use super::fault::{Fault, Faults, Place};
use super::history;
use super::measured;
use super::placed::{self, Members, Placed};
use super::table::{Item, Read, Table};
use crate::units::standard_gravity;

/// A kind of load.
struct Row {
    name: &'static str,
    kind: fn() -> Kind,
    unit: &'static str,
    doc: &'static str,
    /// Whether it needs a group.
    needs_group: bool,
    /// Reads it.
    read: fn(Given<'_>, &mut Faults) -> Result<Acting, Fault>,
}

/// A load in the input: its table, the value of its kind, its group (empty if there is none).
struct Given<'a> {
    table: &'a Table<'a>,
    value: Item<'a>,
    group: Option<String>,
    context: Context<'a>,
}

/// The action on the body.
#[derive(Debug)]
pub(super) enum Acting {
    /// A load on a group of these members.
    Load(Load, Members),
    Attraction(GroundAttraction),
    /// Rate of a drag on the whole body.
    Drag(f64),
}

/// Every kind of load.
const ROWS: [Row; 12] = [
    Row {
        name: "traction",
        kind: field,
        unit: "stress",
        doc: "Force per reference area of a group of facets",
        needs_group: true,
        read: |given, faults| match given.value.field().cloned() {
            Some(field) => {
                given.load(faults, Members::Facets, |group| LoadKind::TractionField { group, field })
            }
            None => {
                let traction = Read::read(given.value);
                given.load(faults, Members::Facets, |group| LoadKind::Traction { group, traction })
            }
        },
    },
    Row {
        name: "force",
        kind: vector,
        unit: "force",
        doc: "Resultant, spread evenly over the reference area of a group of facets; on a rigid body or a coupling, by its \
              name, at its centre or point",
        needs_group: true,
        read: |given, faults| {
            let force = Read::read(given.value);
            match given.follows() {
                true => given.load(faults, Members::Nodes, |group| LoadKind::FollowingForce { group, force }),
                false => given.load(faults, Members::Facets, |group| LoadKind::Force { group, force }),
            }
        },
    },
    Row {
        name: "nodal_force",
        kind: vector,
        unit: "force",
        doc: "Force at each node of a group of nodes, facets or cells: n nodes carry n times the force",
        needs_group: true,
        read: |given, faults| {
            let force = Read::read(given.value);
            given.load(faults, Members::Nodes, |group| LoadKind::NodalForce { group, force })
        },
    },
    Row {
        name: "moment",
        kind: vector,
        unit: "force·length",
        doc: "Moment on a rigid body or a rigid coupling, whose name is `group`, in the axes of space",
        needs_group: true,
        read: |given, faults| {
            let (moment, follow) = (Read::read(given.value), given.follows());
            given.load(faults, Members::Nodes, |group| LoadKind::Moment { group, moment, follow })
        },
    },
    Row {
        name: "torque",
        kind: || Kind::Table(&TORQUE),
        unit: "",
        doc: "Moment on a rigid body or a rigid coupling about an axis, such as `{ axis = [0, 0, 1], value = 20 }`",
        needs_group: true,
        read: |given, faults| {
            let (moment, follow) = (torque(&Table::read(given.value))?, given.follows());
            given.load(faults, Members::Nodes, |group| LoadKind::Moment { group, moment, follow })
        },
    },
    Row {
        name: "pressure",
        kind: || NUMBER,
        unit: "stress",
        doc: "Pressure on the current surface of a group of facets, along its current normal; positive pushes onto the body",
        needs_group: true,
        read: |given, faults| {
            let pressure = Read::read(given.value);
            given.load(faults, Members::Facets, |group| LoadKind::Pressure { group, pressure })
        },
    },
    Row {
        name: "acceleration",
        kind: field,
        unit: "length/time²",
        doc: "Acceleration of every mass in a group of cells, such as gravity; without a group, of every mass",
        needs_group: false,
        read: |given, faults| {
            let group = given.group.clone();
            match given.value.field().cloned() {
                Some(field) => {
                    given.load(faults, Members::Cells, |_| LoadKind::AccelerationField { group, field })
                }
                None => {
                    let acceleration = Read::read(given.value);
                    given.load(faults, Members::Cells, |_| LoadKind::Acceleration { group, acceleration })
                }
            }
        },
    },
    Row {
        name: "gravity",
        kind: || word("a direction along an axis", DIRECTIONS.map(|(name, _)| name)),
        unit: "",
        doc: "Direction of the standard acceleration of gravity, 9.80665 m/s² in the units of `[units]`, on every mass in a \
              group of cells; without a group, on every mass",
        needs_group: false,
        read: gravity,
    },
    Row {
        name: "body_force",
        kind: || Kind::Field(Box::new(exactly(3, Kind::Expression))),
        unit: "force/length³",
        doc: "Force per reference volume of a group of cells, by reference position and time; without a group, of all cells",
        needs_group: false,
        read: |given, faults| {
            let field = expression::read_field(&given.value)?;
            let group = given.group.clone();
            given.load(faults, Members::Cells, |_| LoadKind::BodyForceField { group, field })
        },
    },
    Row {
        name: "attraction",
        kind: || Kind::Table(&ATTRACTION),
        unit: "",
        doc: "Attraction of every mass of a group of nodes, facets or cells (default: all) to a point of space, with the \
              potential -g m/distance",
        needs_group: false,
        read: attraction,
    },
    Row {
        name: "rotation",
        kind: || Kind::Table(&ROTATION),
        unit: "",
        doc: "Centrifugal force on all masses, for an observer that turns, and in modes the Coriolis force; no `group`, no \
              `history`; with `[equilibrium]` and without `[time]` only",
        needs_group: false,
        read: rotation,
    },
    Row {
        name: "drag",
        kind: || POSITIVE,
        unit: "1/time",
        doc: "Rate of a force -rate M v on the whole body: mass-proportional (Rayleigh) damping; no `group`, no `history`; time \
              elements only",
        needs_group: false,
        read: drag,
    },
];

/// Directions of gravity, by their names.
const DIRECTIONS: [(&str, [f64; 3]); 9] = [
    ("-x", [-1.0, 0.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("-z", [0.0, 0.0, -1.0]),
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
    ("+x", [1.0, 0.0, 0.0]),
    ("+y", [0.0, 1.0, 0.0]),
    ("+z", [0.0, 0.0, 1.0]),
];

/// A vector, or a field of a program.
fn field() -> Kind {
    Kind::Field(Box::new(vector()))
}

/// `[[load]]`.
pub(super) static LOAD: Described = Described::new(|| {
    let needs = |row: &Row| if row.needs_group { vec![row.name, "group"] } else { vec![row.name] };
    let section = Section::new("[[load]]", "A load on the body: exactly one kind")
        .may("group", Kind::Text, "", "Group on which the load acts")
        .absent("with `acceleration`, `gravity`, `body_force`, `attraction` and `rotation` the whole body");
    let add = |section: Section, row: &Row| section.may(row.name, (row.kind)(), row.unit, row.doc);
    let section = ROWS.iter().fold(section, add);
    let section = section
        .may(
            "history",
            Kind::TimeFunction(&measured::MEASURED),
            "",
            "Factor over time, by which the load is multiplied",
        )
        .absent("1")
        .may(
            "follow",
            Kind::True,
            "",
            "A `force`, `moment` or `torque` turns with the rigid body on which it acts; its vector is that in the drawing",
        )
        .absent("it keeps its direction");
    Section { rule: Rule::ExactlyOne(ROWS.iter().map(needs).collect()), ..section }
});

static TORQUE: Described = Described::new(|| {
    Section::new("the torque of a [[load]]", "A moment about an axis")
        .must("axis", vector(), "", "Direction of the axis, of any length")
        .must("value", NUMBER, "force·length", "Moment, counter-clockwise seen from the tip of the axis")
});

/// The moment of a torque.
fn torque(table: &Table<'_>) -> Result<[f64; 3], Fault> {
    let (axis, value): ([f64; 3], f64) = (table.must("axis"), table.must("value"));
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    match length > 0.0 {
        true => Ok(axis.map(|x| value * x / length)),
        false => {
            let item: Item<'_> = table.must("axis");
            Err(item.fault("`axis` of a torque must have a direction", "zero"))
        }
    }
}

/// Kinds of loads that may follow a rigid body.
const FOLLOWING: [&str; 3] = ["force", "moment", "torque"];

static ATTRACTION: Described = Described::new(|| {
    let strength = "Strength g, of a star G times its mass; negative: repulsion";
    Section::new("the attraction of a [[load]]", "Attraction of every mass to a point of space")
        .must("centre", vector(), "length", "The point")
        .must("strength", Kind::Number(Bounds::NotZero), "length³/time²", strength)
});

static ROTATION: Described = Described::new(|| {
    Section::new(
        "the rotation of a [[load]]",
        "An observer that turns, at rest in whose axes the body is in equilibrium",
    )
    .must("axis", vector(), "", "Direction of the axis, of any length")
    .may("about", vector(), "length", "A point of the axis")
    .absent("the origin")
    .must("speed", Kind::Number(Bounds::NotZero), "1/time", "Speed in radians")
});

/// Reads one load.
pub(super) fn read(table: &Table<'_>, context: Context<'_>, faults: &mut Faults) -> Option<Placed<Acting>> {
    let value = table.chosen();
    let row = ROWS.iter().find(|row| row.name == value.key);
    let row =
        faults.keep(row.ok_or_else(|| value.fault(format!("`{}` is not a load", value.key), "not known")))?;
    if let Some(follow) = table.item("follow").filter(|_| !FOLLOWING.contains(&value.key)) {
        let message = format!("`follow` is a key of `force`, `moment` and `torque`, not of `{}`", value.key);
        faults.push(follow.fault(message, "of no use here"));
    }
    let group = table.group().map(|(name, _)| name);
    let acting = (row.read)(Given { table, value, group, context }, faults);
    Some(Placed::new(table, faults.keep(acting)?))
}

impl Given<'_> {
    /// Whether it turns with a rigid body.
    fn follows(&self) -> bool {
        self.table.item("follow").is_some()
    }

    /// Checks that the load names neither a group nor a factor over time.
    fn on_all(&self, what: &str) -> Result<(), Fault> {
        for key in ["group", "history"] {
            if let Some(item) = self.table.item(key) {
                let message = format!("a {what} has no `{key}`: it acts on the whole body at all times");
                return Err(item.fault(message, "leave it out"));
            }
        }
        Ok(())
    }

    /// The load of a kind with its factor over time. A faulty factor does not hide an unknown group.
    fn load(
        self,
        faults: &mut Faults,
        members: Members,
        kind: impl FnOnce(String) -> LoadKind,
    ) -> Result<Acting, Fault> {
        let history = self.table.item("history").map(|item| history::read(item, self.context));
        let time_function = history.and_then(|history| faults.keep(history));
        let time_function = time_function.unwrap_or_else(TimeFunction::constant);
        Ok(Acting::Load(Load { kind: kind(self.group.unwrap_or_default()), time_function }, members))
    }
}

/// Gravity along an axis, in the units of the input.
fn gravity(given: Given<'_>, faults: &mut Faults) -> Result<Acting, Fault> {
    let Some(system) = given.context.units.system() else {
        let message = "`gravity` needs `[units]`: the acceleration of gravity has another number in each system of units";
        let help =
            "add `[units]`, such as system = \"m-kg-s\", or give the vector: acceleration = [0, 0, -9.81]";
        return Err(given.value.fault(message, "in which units?").help(help));
    };
    let size = standard_gravity(system);
    let acceleration = given.value.one_of(DIRECTIONS).map(|x| size * x);
    let group = given.group.clone();
    given.load(faults, Members::Cells, |_| LoadKind::Acceleration { group, acceleration })
}

fn attraction(given: Given<'_>, _: &mut Faults) -> Result<Acting, Fault> {
    if let Some(history) = given.table.item("history") {
        let message = "an attraction has no `history`: its potential belongs to the energy, which it keeps";
        return Err(history.fault(message, "leave it out"));
    }
    let parameters = Table::read(given.value);
    let (centre, strength) = (parameters.must("centre"), parameters.must("strength"));
    Ok(Acting::Attraction(GroundAttraction { group: given.group, centre, strength }))
}

/// A drag acts on the whole body.
fn drag(given: Given<'_>, _: &mut Faults) -> Result<Acting, Fault> {
    given.on_all("drag")?;
    Ok(Acting::Drag(Read::read(given.value)))
}

/// An observer sees the centrifugal force on all masses.
fn rotation(given: Given<'_>, faults: &mut Faults) -> Result<Acting, Fault> {
    given.on_all("rotation")?;
    let parameters = Table::read(given.value);
    let (axis, speed): ([f64; 3], f64) = (parameters.must("axis"), parameters.must("speed"));
    let about = parameters.may("about").unwrap_or_default();
    if let (Some(item), true) = (parameters.item("axis"), axis == [0.0; 3]) {
        return Err(item.fault("`axis` must have a direction", "no direction"));
    }
    given.load(faults, Members::Cells, |_| LoadKind::Rotation { axis, about, speed })
}

/// Checks that there is one observer at most, and no motion: `time` is the place of `[time]`.
pub(super) fn check_observers(loads: &[Placed<(Load, Members)>], time: Option<&Place>, faults: &mut Faults) {
    let mut turning = loads.iter().filter(|load| matches!(load.value.0.kind, LoadKind::Rotation { .. }));
    let Some(first) = turning.next() else { return };
    for other in turning {
        let fault = Fault::at(&other.place, "several loads are a `rotation`", "again");
        faults.push(fault.label(&first.place, "first").help("an observer turns about one axis"));
    }
    if let Some(time) = time {
        let message = "`rotation` is what an observer sees who turns with a body in equilibrium; in a motion the body itself turns";
        let help = "`[equilibrium]` without `[time]` is a static analysis, also for `emmy modes`; in a motion take `angular_velocity` \
                    of `[initial]`, or a support with `rotate`";
        faults.push(Fault::at(&first.place, message, "this load").label(time, "a motion").help(help));
    }
}

/// Loads, attractions and drags by themselves.
#[derive(Debug, Default)]
pub(super) struct Sorted {
    pub(super) loads: Vec<Placed<(Load, Members)>>,
    pub(super) attractions: Vec<Placed<GroundAttraction>>,
    pub(super) drags: Vec<Placed<f64>>,
}

impl FromIterator<Placed<Acting>> for Sorted {
    fn from_iter<I: IntoIterator<Item = Placed<Acting>>>(all: I) -> Self {
        let mut sorted = Sorted::default();
        for Placed { value, group, place } in all {
            match value {
                Acting::Load(load, members) => {
                    sorted.loads.push(Placed { value: (load, members), group, place })
                }
                Acting::Attraction(value) => sorted.attractions.push(Placed { value, group, place }),
                Acting::Drag(value) => sorted.drags.push(Placed { value, group, place }),
            }
        }
        sorted
    }
}

/// The fault of a body with a pressure inside.
pub(super) fn fault(error: &emmy::Error, groups: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::PressureInside { group, .. } = error else { return None };
    placed::fault(error, group, groups, "inside the body")
}
