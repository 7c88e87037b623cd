//! `[initial]` or `[[initial]]`: velocities at the start.

use emmy::body::InitialVelocity;

use super::fault::Fault;
use super::keys;
use super::region::{Placed, group};
use super::table::Item;

/// Reads one initial velocity field.
pub(super) fn read(item: Item<'_>) -> Result<Placed<InitialVelocity>, Fault> {
    let table = item.table(keys::INITIAL)?;
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
