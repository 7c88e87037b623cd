//! `[[load]]`: one row per kind of load.

use emmy::body::{GroundAttraction, Load, LoadKind, TimeFunction};
use emmy::internals::material::{Bounds, IfAbsent};

use super::description::{Described, Key, Kind, NUMBER, POSITIVE, Rule, Section, exactly, vector};
use super::expression;
use super::fault::{Fault, Place};
use super::history::{self, Context};
use super::placed::{Members, Placed, group};
use super::table::{Item, Table};

/// A kind of load.
struct Row {
    key: fn() -> Key,
    /// Whether it needs a group.
    needs_group: bool,
    /// Reads it.
    read: fn(Given<'_>) -> Result<Acting, Fault>,
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

#[cfg(test)]
impl Acting {
    pub(super) fn time_function(&self) -> Option<&TimeFunction> {
        match self {
            Acting::Load(load, _) => Some(&load.time_function),
            Acting::Attraction(_) | Acting::Drag(_) => None,
        }
    }
}

/// Every kind of load.
const ROWS: [Row; 8] = [
    Row {
        key: || Key::new("traction", vector(), "stress", "Force per reference area of a group of facets"),
        needs_group: true,
        read: |given| {
            if let Some(field) = given.value.field().cloned() {
                return given.load(Members::Facets, |group| LoadKind::TractionField { group, field });
            }
            expression::check_not_of_program(&given.value)?;
            let traction = given.value.numbers()?;
            given.load(Members::Facets, |group| LoadKind::Traction { group, traction })
        },
    },
    Row {
        key: || {
            let doc = "Resultant, spread evenly over the reference area of a group of facets";
            Key::new("force", vector(), "force", doc)
        },
        needs_group: true,
        read: |given| {
            let force = given.value.numbers()?;
            given.load(Members::Facets, |group| LoadKind::Force { group, force })
        },
    },
    Row {
        key: || {
            let doc =
                "Force at each node of a group of nodes, facets or cells: n nodes carry n times the force";
            Key::new("nodal_force", vector(), "force", doc)
        },
        needs_group: true,
        read: |given| {
            let force = given.value.numbers()?;
            given.load(Members::Nodes, |group| LoadKind::NodalForce { group, force })
        },
    },
    Row {
        key: || {
            let doc = "Pressure on the current surface of a group of facets, along its current normal; positive pushes onto \
                       the body";
            Key::new("pressure", NUMBER, "stress", doc)
        },
        needs_group: true,
        read: |given| {
            let pressure = given.value.number()?;
            given.load(Members::Facets, |group| LoadKind::Pressure { group, pressure })
        },
    },
    Row {
        key: || {
            let doc = "Acceleration of every mass in a group of cells, such as gravity; without a group, of every mass";
            Key::new("acceleration", vector(), "length/time²", doc)
        },
        needs_group: false,
        read: |given| {
            let group = given.group.clone();
            if let Some(field) = given.value.field().cloned() {
                return given.load(Members::Cells, |_| LoadKind::AccelerationField { group, field });
            }
            expression::check_not_of_program(&given.value)?;
            let acceleration = given.value.numbers()?;
            given.load(Members::Cells, |_| LoadKind::Acceleration { group, acceleration })
        },
    },
    Row {
        key: || {
            let doc = "Force per reference volume of a group of cells, by reference position and time; without a group, of all \
                       cells";
            Key::new("body_force", exactly(3, Kind::Expression), "force/length³", doc)
        },
        needs_group: false,
        read: |given| {
            let field = expression::read_field(&given.value)?;
            let group = given.group.clone();
            given.load(Members::Cells, |_| LoadKind::BodyForceField { group, field })
        },
    },
    Row {
        key: || {
            let doc = "Attraction of every mass of a group of nodes, facets or cells (default: all) to a point of space, with \
                       the potential -g m/distance";
            Key::new("attraction", Kind::Table(&ATTRACTION), "", doc)
        },
        needs_group: false,
        read: attraction,
    },
    Row {
        key: || {
            let doc = "Rate of a force -rate M v on the whole body: mass-proportional (Rayleigh) damping; no `group`, no \
                       `history`; time elements only";
            Key::new("drag", POSITIVE, "1/time", doc)
        },
        needs_group: false,
        read: drag,
    },
];

/// `[[load]]`.
pub(super) static LOAD: Described = Described::new(|| {
    let needs = |row: &Row| {
        let name = (row.key)().name;
        if row.needs_group { vec![name, "group"] } else { vec![name] }
    };
    let section = Section::new("[[load]]", "A load on the body: exactly one kind")
        .may("group", Kind::Text, "", "Group on which the load acts")
        .absent("with `acceleration`, `body_force` and `attraction` the whole body");
    let add =
        |section: Section, row: &Row| section.key(Key { if_absent: IfAbsent::Means(""), ..(row.key)() });
    let section = ROWS.iter().fold(section, add);
    let section = section
        .may("history", Kind::TimeFunction, "", "Factor over time, by which the load is multiplied")
        .absent("1");
    Section { rule: Rule::ExactlyOne(ROWS.iter().map(needs).collect()), ..section }
});

static ATTRACTION: Described = Described::new(|| {
    let strength = "Strength g, of a star G times its mass; negative: repulsion";
    Section::new("the attraction of a [[load]]", "Attraction of every mass to a point of space")
        .must("centre", vector(), "length", "The point")
        .must("strength", Kind::Number(Bounds::NotZero), "length³/time²", strength)
});

/// Reads one load.
pub(super) fn read(item: Item<'_>, context: Context<'_>) -> Result<Placed<Acting>, Fault> {
    let table = item.table(&LOAD)?;
    let value = table.exactly_one("one kind of load")?;
    let row = ROWS.iter().find(|row| (row.key)().name == value.key());
    let row = row.ok_or_else(|| value.fault(format!("`{}` is not a load", value.key()), "not known"))?;
    let group = match row.needs_group {
        true => Some(table.require("group")?.name()?),
        false => group(&table)?.map(|(name, _)| name),
    };
    let acting = (row.read)(Given { table: &table, value, group, context })?;
    Placed::new(&table, acting)
}

impl Given<'_> {
    /// The load of a kind with its factor over time.
    fn load(self, members: Members, kind: impl FnOnce(String) -> LoadKind) -> Result<Acting, Fault> {
        let history = self.table.get("history").map(|item| history::read(item, self.context)).transpose()?;
        let time_function = history.unwrap_or_else(TimeFunction::constant);
        Ok(Acting::Load(Load { kind: kind(self.group.unwrap_or_default()), time_function }, members))
    }
}

fn attraction(given: Given<'_>) -> Result<Acting, Fault> {
    if let Some(history) = given.table.get("history") {
        let message = "an attraction has no `history`: its potential belongs to the energy, which it keeps";
        return Err(history.fault(message, "leave it out"));
    }
    let parameters = given.value.table(&ATTRACTION)?;
    let centre = parameters.require("centre")?.numbers()?;
    let item = parameters.require("strength")?;
    let strength = item.number()?;
    if strength == 0.0 {
        return Err(item.fault("`strength` must not be 0; a negative one repels", "no attraction"));
    }
    Ok(Acting::Attraction(GroundAttraction { group: given.group, centre, strength }))
}

/// A drag acts on the whole body.
fn drag(given: Given<'_>) -> Result<Acting, Fault> {
    for key in ["group", "history"] {
        if let Some(item) = given.table.get(key) {
            let message = format!("a drag has no `{key}`: it acts on the whole body at all times");
            return Err(item.fault(message, "leave it out"));
        }
    }
    Ok(Acting::Drag(given.value.positive()?))
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
/// Groups of the loads with the places of their names.
pub(super) fn places(loads: &[Placed<(Load, Members)>]) -> Vec<(String, Place)> {
    loads.iter().filter_map(|load| load.group.clone()).collect()
}

/// The fault of a body with a pressure inside.
pub(super) fn fault(error: &emmy::Error, places: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::PressureInside { group, .. } = error else { return None };
    let (_, place) = places.iter().find(|(name, _)| name == group)?;
    Some(Fault::at(place, error.to_string(), "inside the body"))
}
