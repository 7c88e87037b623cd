//! `[initial]` or `[[initial]]`: velocities at the start. `initial.state` is in `start`.

use emmy::body::InitialVelocity;

use super::description::{Described, Kind, Section, exactly, vector};
use super::placed::Placed;
use super::table::Table;

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
pub(super) fn read(table: &Table<'_>) -> Placed<InitialVelocity> {
    let initial = InitialVelocity {
        group: table.group().map(|(name, _)| name),
        velocity: table.may("velocity").unwrap_or_default(),
        angular_velocity: table.may("angular_velocity").unwrap_or_default(),
        about: table.may("about").unwrap_or_default(),
        gradient: table.may("gradient").unwrap_or_default(),
    };
    Placed::new(table, initial)
}
