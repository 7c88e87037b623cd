//! The attacks, each in a file.

mod checkpoints;
mod combinations;
mod disks;
mod kills;
mod motions;
mod paths;
mod readers;
mod streams;
mod triples;

use crate::attack::Attack;

/// All attacks.
pub const ALL: [Attack; 9] = [
    motions::ATTACK,
    readers::ATTACK,
    kills::ATTACK,
    checkpoints::ATTACK,
    disks::ATTACK,
    streams::ATTACK,
    paths::ATTACK,
    combinations::ATTACK,
    triples::ATTACK,
];

/// The attack of a name.
pub fn of(name: &str) -> Option<&'static Attack> {
    ALL.iter().find(|attack| attack.name == name)
}
