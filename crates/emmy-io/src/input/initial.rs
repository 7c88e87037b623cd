//! `[initial]` or `[[initial]]`: velocities at the start. `initial.state` is in `start`.

use emmy::body::InitialVelocity;

use super::description::{Described, Kind, Section, exactly, vector};
use super::fault::Fault;
use super::placed::{Placed, group};
use super::table::Item;

/// `[initial]` or `[[initial]]`.
pub(super) static INITIAL: Described = Described::new(|| {
    let doc = "Velocities at the start: velocity + angular_velocity × (X - about) + gradient X";
    Section::new("[initial]", doc)
        .may("group", Kind::Text, "", "Group of nodes, facets or cells")
        .absent("all nodes")
        .may("velocity", vector(), "length/time", "Velocity")
        .absent("0")
        .may("angular_velocity", vector(), "1/time", "Angular velocity")
        .absent("0")
        .may("about", vector(), "length", "A point of the axis")
        .absent("the origin")
        .may("gradient", exactly(3, vector()), "1/time", "Gradient of the velocity, row by row")
        .absent("0")
        .may(
            "state",
            Kind::Text,
            "",
            "Output directory of another run with the same mesh, whose last displacement and velocity are the start; relative to the input, alone in `[initial]`",
        )
        .absent("undeformed")
});

/// Reads one initial velocity field.
pub(super) fn read(item: Item<'_>) -> Result<Placed<InitialVelocity>, Fault> {
    let table = item.table(&INITIAL)?;
    let vector = |key: &str| table.get(key).map_or(Ok([0.0; 3]), |item| item.numbers());
    let initial = InitialVelocity {
        group: group(&table)?.map(|(name, _)| name),
        velocity: vector("velocity")?,
        angular_velocity: vector("angular_velocity")?,
        about: vector("about")?,
        gradient: table.get("gradient").map_or(Ok([[0.0; 3]; 3]), |item| item.tensor())?,
    };
    Placed::new(&table, initial)
}
