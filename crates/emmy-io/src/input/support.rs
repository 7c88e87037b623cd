//! `[[support]]`: fixed and driven parts of the body.

use emmy::body::{GroundSpring, Rotation, Support, TimeFunction};
use emmy::internals::number::{short, short_vector};
use emmy::mesh::Mesh;
use emmy::time::BodyFeature;

use super::context::Context;
use super::description::{Described, Kind, POSITIVE, Section, either, vector, word};
use super::fault::{Fault, Faults, Place};
use super::history;
use super::measured::MEASURED;
use super::placed::{self, Placed};
use super::table::{Item, Read, Table};
use super::time::Time;

/// Names of the components.
const COMPONENTS: [&str; 3] = ["x", "y", "z"];

/// Components in a word.
const FIXED: [&str; 8] = ["all", "xyz", "xy", "xz", "yz", "x", "y", "z"];

/// `[[support]]`.
pub(super) static SUPPORT: Described = Described::new(|| {
    let symmetry =
        "The facets of the group lie in a plane of symmetry, normal to the x, y or z axis, and stay in it";
    let several = Kind::Words(1, Box::new(word("a component", COMPONENTS)));
    Section::new("[[support]]", "Nodes that are held, moved or turned")
        .must("group", Kind::Text, "", "Group of nodes, facets or cells")
        .may("fix", either(word("a set of components", FIXED), several), "", "Components that do not move; `\"all\"` is `\"xyz\"`")
        .may("move", Kind::Table(&MOVE), "", "Displacement of components over time, such as `{ x = \"0.1*sin(5*t)\" }`")
        .may(
            "accelerate",
            Kind::Table(&ACCELERATE),
            "",
            "Acceleration of components over time, from rest at the start, such as `{ x = \"9.81*sin(5*t)\" }`",
        )
        .may("rotate", Kind::Table(&ROTATE), "", "Rotation of the group as a rigid body; `move` and `accelerate` are added to it")
        .may("symmetry", Kind::True, "", symmetry)
        .may(
            "spring",
            POSITIVE,
            "force/length",
            "Stiffness of springs from each node to the ground, alike in all directions and at rest at the start; on a group \
             of facets per reference area [force/length³]",
        )
        .may("until", POSITIVE, "time", "Time of release; not with `spring`")
        .absent("never")
        .at_least_one(&["fix", "move", "accelerate", "rotate", "symmetry", "spring"])
});

pub(super) static MOVE: Described = Described::new(|| {
    components("move", "Displacement of components over time, from 0 on", "length", "Displacement")
});

static ACCELERATE: Described = Described::new(|| {
    components("accelerate", "Acceleration of components over time", "length/time²", "Acceleration")
});

/// Histories of components.
fn components(name: &'static str, doc: &str, unit: &'static str, what: &str) -> Section {
    let add = |section: Section, axis: &'static str| {
        let kind = Kind::TimeFunction(&MEASURED);
        section.may(axis, kind, unit, &format!("{what} along {axis}")).absent("free")
    };
    COMPONENTS.into_iter().fold(Section::new(name, doc), add).at_least_one(&COMPONENTS)
}

static ROTATE: Described = Described::new(|| {
    Section::new("rotate", "Rotation of the group as a rigid body")
        .must("axis", vector(), "", "Direction of the axis, of any length")
        .may("about", vector(), "length", "A point of the axis")
        .absent("the origin")
        .must("angle", Kind::TimeFunction(&MEASURED), "radian", "Angle over time, from 0 on")
});

/// A support, and the springs that stand in the same table.
#[derive(Debug)]
pub(super) struct Held {
    pub(super) support: Option<Placed<Support>>,
    pub(super) spring: Option<Placed<GroundSpring>>,
}

/// Reads one support.
pub(super) fn read(table: &Table<'_>, context: Context<'_>, faults: &mut Faults) -> Held {
    let spring = table.may("spring").and_then(|stiffness| faults.keep(spring(table, stiffness)));
    if SUPPORT.choice().iter().all(|key| *key == "spring" || table.item(key).is_none()) {
        return Held { support: None, spring };
    }
    let own = table.may("rotate");
    let support = Support {
        group: table.must::<Item<'_>>("group").name(),
        fix: table.item("fix").map_or([false; 3], fixed),
        displacement: displacement(table, context, faults),
        rotation: own.and_then(|own: Table<'_>| faults.keep(rotation(&own, context))),
        symmetry: table.item("symmetry").is_some(),
        until: table.may("until"),
    };
    faults.keep(check(table, &support));
    Held { support: Some(Placed::new(table, support)), spring }
}

fn spring(table: &Table<'_>, stiffness: f64) -> Result<Placed<GroundSpring>, Fault> {
    if let Some(until) = table.item("until") {
        let message = "`until` cannot be used with `spring`: springs to the ground stay; use a separate support for the components that are released";
        return Err(until.fault(message, "with a spring"));
    }
    Ok(Placed::new(table, GroundSpring { group: table.must::<Item<'_>>("group").name(), stiffness }))
}

fn fixed(item: Item<'_>) -> [bool; 3] {
    match item.text() {
        Some("all") => [true; 3],
        Some(word) => COMPONENTS.map(|component| word.contains(component)),
        None => {
            let listed: Vec<&str> = Read::read(item);
            COMPONENTS.map(|component| listed.contains(&component))
        }
    }
}

/// Displacements of components, given by themselves or by their accelerations.
fn displacement(table: &Table<'_>, context: Context<'_>, faults: &mut Faults) -> [Option<TimeFunction>; 3] {
    let mut displacement = [const { None }; 3];
    for (key, read) in DRIVES {
        let Some(components) = table.may::<Table<'_>>(key) else { continue };
        let given = COMPONENTS.map(|component| components.item(component));
        for (history, item) in displacement.iter_mut().zip(given) {
            let Some(item) = item else { continue };
            if history.is_some() {
                let message = format!("component `{}` is both moved and accelerated", item.key);
                faults.push(Fault::at(item.key_place, message, "twice"));
            }
            *history = faults.keep(read(item, context));
        }
    }
    displacement
}

/// The displacements in a table such as `move`.
pub(super) fn moved_components(
    components: &Table<'_>,
    context: Context<'_>,
    faults: &mut Faults,
) -> [Option<TimeFunction>; 3] {
    COMPONENTS.map(|component| components.item(component).and_then(|item| faults.keep(motion(item, context))))
}

/// Reads the displacement of a component.
type ReadMotion = fn(Item<'_>, Context<'_>) -> Result<TimeFunction, Fault>;

/// The histories of the motion of components: key, reader.
const DRIVES: [(&str, ReadMotion); 2] = [("move", motion), ("accelerate", accelerated)];

/// The displacement of nodes with an acceleration.
fn accelerated(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let acceleration = history::read(item, context)?;
    TimeFunction::from_acceleration(&acceleration, context.run.unwrap_or([0.0, 1.0]))
        .map_err(|error| item.fault(format!("`{}`: {error}", item.key), "here"))
}

fn rotation(table: &Table<'_>, context: Context<'_>) -> Result<Rotation, Fault> {
    let axis: [f64; 3] = table.must("axis");
    if axis == [0.0; 3] {
        let item: Item<'_> = table.must("axis");
        return Err(item.fault("`axis` of a rotation must have a direction", "zero"));
    }
    let about = table.may("about").unwrap_or_default();
    Ok(Rotation { axis, about, angle: motion(table.must("angle"), context)? })
}

/// A time function that nodes can follow: without jumps, from zero on where the body is undeformed at the start.
fn motion(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let history = history::without_jumps(item, context)?;
    // Rounding is no displacement; other values are checked with the size of the mesh. Numbers that are not finite have
    // their own fault.
    let (key, start) = (item.key, history.value(0.0));
    if context.is_undeformed && start.abs() > history::ROUNDING {
        let message = format!(
            "`{key}` is {} at t = 0, where the body is undeformed; let it start from 0",
            short(start)
        );
        return Err(item.fault(message, "not 0 at the start"));
    }
    Ok(history)
}

/// Components that are given twice.
fn check(table: &Table<'_>, support: &Support) -> Result<(), Fault> {
    let Some(fix) = table.item("fix") else { return Ok(()) };
    if let Some(rotate) = table.item("rotate") {
        let message = "`rotate` gives the motion of all components: nothing is left to `fix`";
        return Err(fix.fault(message, "fixed here").label(rotate.place(), "turned here"));
    }
    let is_twice = |&i: &usize| support.fix[i] && support.displacement[i].is_some();
    let Some(component) = (0..3).find(is_twice) else { return Ok(()) };
    let is_accelerated =
        support.displacement[component].as_ref().is_some_and(|history| history.acceleration().is_some());
    let (key, how) = if is_accelerated { ("accelerate", "accelerated") } else { ("move", "moved") };
    let message = format!("component `{}` is both fixed and {how}", COMPONENTS[component]);
    let fault = fix.fault(message, "fixed here");
    Err(table
        .item(key)
        .into_iter()
        .fold(fault, |fault, item| fault.label(item.place(), format!("{how} here"))))
}

/// Checks supports against each other and the scheme: two may fix the same component of a node, or the scheme may not
/// permit driven supports.
pub(super) fn check_together(mesh: &Mesh, supports: &[Placed<Support>], time: &Time) -> Result<(), Fault> {
    for support in supports.iter().filter(|support| support.value.symmetry) {
        symmetry_axis(mesh, support)?;
    }
    let Some(driven) = supports.iter().find(|support| support.value.is_driven()) else { return Ok(()) };
    if time.scheme.check_feature(BodyFeature::PrescribedMotion).is_err() {
        return Err(cannot_move(time, ("a support", &driven.place)));
    }
    let mut by = vec![None; mesh.n_dofs()];
    for (index, support) in supports.iter().enumerate() {
        let Ok(nodes) = mesh.group_nodes(&support.value.group) else { continue };
        let fixed = support.value.fixed_components(mesh).unwrap_or_default();
        for dof in nodes.iter().flat_map(|&node| (0..3).map(move |i| 3 * node as usize + i)) {
            if !fixed[dof % 3] && !support.value.drives(dof % 3) {
                continue;
            }
            let other: Option<&Placed<Support>> = by[dof].replace(index).map(|other: usize| &supports[other]);
            let moves = |support: &Placed<Support>| support.value.drives(dof % 3);
            let Some(other) = other.filter(|other| moves(other) || moves(support)) else { continue };
            let component = COMPONENTS[dof % 3];
            let point = short_vector(mesh.points()[dof / 3]);
            let message = format!("component `{component}` of the node at {point} is given by two supports");
            return Err(Fault::at(&support.place, message, "second").label(&other.place, "first"));
        }
    }
    Ok(())
}

/// The fault of something that moves with a scheme that does not permit it.
pub(super) fn cannot_move(time: &Time, (what, place): (&str, &Place)) -> Fault {
    let is_element = time.scheme.is_time_element();
    let kind = if is_element { "a scheme without dissipation" } else { "a time element" };
    let message = format!("the scheme {} cannot move {what}: this needs {kind}", time.scheme.name());
    let other = if is_element { time.scheme.conserving().name() } else { "DGM".to_string() };
    Fault::at(place, message, "moves").help(format!("such as scheme = \"{other}\""))
}

/// Checks that the group of a support is a plane of symmetry.
fn symmetry_axis(mesh: &Mesh, support: &Placed<Support>) -> Result<(), Fault> {
    let error = match emmy::internals::body::symmetry_axis(mesh, &support.value.group) {
        Ok(_) => return Ok(()),
        Err(error) => error,
    };
    let place = support.group.as_ref().map_or(&support.place, |(_, place)| place);
    Err(Fault::at(place, error.to_string(), "no plane of symmetry"))
}

/// The times at which supports are released.
pub(super) fn releases(supports: &[Placed<Support>]) -> impl Iterator<Item = f64> {
    supports.iter().filter_map(|support| support.value.until)
}

/// The fault of a body with invalid supports.
pub(super) fn fault(error: &emmy::Error, groups: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Support { group, .. } = error else { return None };
    placed::fault(error, group, groups, "this support")
}
