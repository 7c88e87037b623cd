//! `[[support]]`: fixed and driven parts of the body.

use emmy::body::{Rotation, Support, TimeFunction};
use emmy::internals::number::{short, short_vector};
use emmy::mesh::Mesh;
use emmy::motion::StepPlan;
use emmy::time::BodyFeature;

use super::description::{Described, Kind, POSITIVE, Section, list, vector};
use super::fault::{Fault, Place};
use super::history::{self, Context};
use super::region::Placed;
use super::suggest::listed;
use super::table::{Item, Table};
use super::time::Time;

/// Names of the components.
const COMPONENTS: [&str; 3] = ["x", "y", "z"];

/// `[[support]]`.
pub(super) static SUPPORT: Described = Described::new(|| {
    let symmetry =
        "The facets of the group lie in a plane of symmetry, normal to the x, y or z axis, and stay in it";
    Section::new("[[support]]", "Nodes that are held, moved or turned")
        .must("group", Kind::Text, "", "Group of nodes, facets or cells")
        .may("fix", list(1, Kind::Word(COMPONENTS.to_vec())), "", "Components that do not move, such as `[\"x\", \"y\", \"z\"]`")
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

static MOVE: Described = Described::new(|| {
    Section::new("move", "Displacement of components over time, from 0 on")
        .may("x", Kind::TimeFunction, "length", "Displacement along x")
        .absent("free")
        .may("y", Kind::TimeFunction, "length", "Displacement along y")
        .absent("free")
        .may("z", Kind::TimeFunction, "length", "Displacement along z")
        .absent("free")
        .at_least_one(&COMPONENTS)
});

static ACCELERATE: Described = Described::new(|| {
    Section::new("accelerate", "Acceleration of components over time")
        .may("x", Kind::TimeFunction, "length/time²", "Acceleration along x")
        .absent("free")
        .may("y", Kind::TimeFunction, "length/time²", "Acceleration along y")
        .absent("free")
        .may("z", Kind::TimeFunction, "length/time²", "Acceleration along z")
        .absent("free")
        .at_least_one(&COMPONENTS)
});

static ROTATE: Described = Described::new(|| {
    Section::new("rotate", "Rotation of the group as a rigid body")
        .must("axis", vector(), "", "Direction of the axis, of any length")
        .may("about", vector(), "length", "A point of the axis")
        .absent("the origin")
        .must("angle", Kind::TimeFunction, "radian", "Angle over time, from 0 on")
});

/// Reads one support.
pub(super) fn read(item: Item<'_>, context: Context<'_>) -> Result<Placed<Support>, Fault> {
    let table = item.table(&SUPPORT)?;
    let group = table.require("group")?.name()?;
    let kinds = SUPPORT.choice();
    if kinds.iter().all(|key| table.get(key).is_none()) {
        let message = format!("[[support]] needs at least one of {}", listed(kinds));
        return Err(Fault::at(table.place(), message, "none of them is here"));
    }
    let fix = table.get("fix").map(fixed).transpose()?.unwrap_or_default();
    let displacement = displacement(&table, context)?;
    let rotation = table.get("rotate").map(|item| rotation(item, context)).transpose()?;
    let symmetry = table.get("symmetry").map(symmetry).transpose()?.unwrap_or_default();
    let until = table.get("until").map(|item| item.positive()).transpose()?;
    let support = Support { group, fix, displacement, rotation, symmetry, until };
    check(&table, &support)?;
    Placed::new(&table, support)
}

fn fixed(item: Item<'_>) -> Result<[bool; 3], Fault> {
    let mut fixed = [false; 3];
    let components = item.list()?;
    if components.is_empty() {
        let message = "`fix` is empty: it lists the components that do not move";
        return Err(item.fault(message, "such as [\"x\", \"y\"]"));
    }
    for component in components {
        let word = component.word("a component", &COMPONENTS)?;
        fixed[(word.as_bytes()[0] - b'x') as usize] = true;
    }
    Ok(fixed)
}

fn symmetry(item: Item<'_>) -> Result<bool, Fault> {
    match item.boolean()? {
        true => Ok(true),
        false => Err(item.fault("`symmetry` is true or left out", "without effect")),
    }
}

/// Displacements of components, given by themselves or by their accelerations.
fn displacement(table: &Table<'_>, context: Context<'_>) -> Result<[Option<TimeFunction>; 3], Fault> {
    let mut displacement = [const { None }; 3];
    for (key, section, read) in DRIVES {
        let Some(item) = table.get(key) else { continue };
        let components = item.table(section)?;
        let given = COMPONENTS.map(|component| components.get(component));
        if given.iter().all(Option::is_none) {
            let message = format!("`{key}` is empty: it gives histories of components");
            return Err(item.fault(message, format!("such as {key} = {{ x = \"0.1*t\" }}")));
        }
        for (history, item) in displacement.iter_mut().zip(given) {
            let Some(item) = item else { continue };
            if history.is_some() {
                let message = format!("component `{}` is both moved and accelerated", item.key());
                return Err(Fault::at(item.key_place, message, "twice"));
            }
            *history = Some(read(item, context)?);
        }
    }
    Ok(displacement)
}

/// Reads the displacement of a component.
type ReadMotion = fn(Item<'_>, Context<'_>) -> Result<TimeFunction, Fault>;

/// The histories of the motion of components: key, description, reader.
const DRIVES: [(&str, &Described, ReadMotion); 2] =
    [("move", &MOVE, motion), ("accelerate", &ACCELERATE, accelerated)];

/// The displacement of nodes with an acceleration.
fn accelerated(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let acceleration = history::read(item, context)?;
    TimeFunction::from_acceleration(&acceleration, [0.0, context.end])
        .map_err(|error| item.fault(format!("`{}`: {error}", item.key()), "here"))
}

fn rotation(item: Item<'_>, context: Context<'_>) -> Result<Rotation, Fault> {
    let table = item.table(&ROTATE)?;
    let axis_item = table.require("axis")?;
    let axis: [f64; 3] = axis_item.numbers()?;
    if axis == [0.0; 3] {
        return Err(axis_item.fault("`axis` of a rotation must have a direction", "zero"));
    }
    let about = table.get("about").map_or(Ok([0.0; 3]), |item| item.numbers())?;
    Ok(Rotation { axis, about, angle: motion(table.require("angle")?, context)? })
}

/// A time function that nodes can follow: without jumps.
fn motion(item: Item<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let history = history::read(item, context)?;
    let key = item.key();
    if let Some(time) = history.first_jump() {
        let message = format!("`{key}`: the motion jumps at t = {}; give the jump a duration", short(time));
        return Err(item.fault(message, "two values at one time"));
    }
    Ok(history)
}

/// Checks that supports of an undeformed body move from zero on.
pub(super) fn check_starts(root: &Table<'_>, context: Context<'_>) -> Result<(), Fault> {
    let supports = root.get("support").map_or(Ok(Vec::new()), |item| item.one_or_more());
    // Other faults of supports are found where they are read.
    for table in supports.unwrap_or_default().iter().filter_map(|item| item.table(&SUPPORT).ok()) {
        let moves = table.get("move").and_then(|item| item.table(&MOVE).ok());
        let shifts =
            moves.into_iter().flat_map(|moves| COMPONENTS.into_iter().filter_map(move |x| moves.get(x)));
        let turns = table.get("rotate").and_then(|item| item.table(&ROTATE).ok());
        shifts
            .chain(turns.and_then(|turns| turns.get("angle")))
            .try_for_each(|item| check_zero(item, context))?;
    }
    Ok(())
}

fn check_zero(item: Item<'_>, context: Context<'_>) -> Result<(), Fault> {
    let start = motion(item, context).map_or(0.0, |history| history.value(0.0));
    // Rounding in an expression that is exactly zero is no displacement; other values are checked with the size of the
    // mesh. Numbers that are not finite have their own fault.
    if start.is_nan() || start.abs() <= 1e-9 {
        return Ok(());
    }
    let message = format!(
        "`{}` is {} at t = 0, where the body is undeformed; let it start from 0",
        item.key(),
        short(start)
    );
    Err(item.fault(message, "not 0 at the start"))
}

/// Components that are given twice.
fn check(table: &Table<'_>, support: &Support) -> Result<(), Fault> {
    let Some(fix) = table.get("fix") else { return Ok(()) };
    if let Some(rotate) = table.get("rotate") {
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
        .get(key)
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
        let is_element = time.scheme.is_time_element();
        let kind = if is_element { "a scheme without dissipation" } else { "a time element" };
        let message = format!("the scheme {} cannot move a support: this needs {kind}", time.scheme.name());
        let other = if is_element { time.scheme.conserving().name() } else { "DGM".to_string() };
        return Err(Fault::at(&driven.place, message, "moves").help(format!("such as scheme = \"{other}\"")));
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

/// Checks that the group of a support is a plane of symmetry.
fn symmetry_axis(mesh: &Mesh, support: &Placed<Support>) -> Result<(), Fault> {
    let error = match emmy::internals::body::symmetry_axis(mesh, &support.value.group) {
        Ok(_) => return Ok(()),
        Err(error) => error,
    };
    let place = support.group.as_ref().map_or(&support.place, |(_, place)| place);
    Err(Fault::at(place, error.to_string(), "no plane of symmetry"))
}

/// The plan with steps that end where supports are released.
pub(super) fn plan_with_releases(plan: &StepPlan, supports: &[Placed<Support>]) -> StepPlan {
    let times = supports.iter().filter_map(|support| support.value.until);
    times.fold(plan.clone(), StepPlan::with_end_at)
}

/// Groups of the supports with the places of their names.
pub(super) fn places(supports: &[Placed<Support>]) -> Vec<(String, Place)> {
    supports.iter().filter_map(|support| support.group.clone()).collect()
}

/// The fault of a body with invalid supports.
pub(super) fn fault(error: &emmy::Error, places: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Support { group, .. } = error else { return None };
    let (_, place) = places.iter().find(|(name, _)| name == group)?;
    Some(Fault::at(place, error.to_string(), "this support"))
}
