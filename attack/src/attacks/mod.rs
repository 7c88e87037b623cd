//! The attacks, each in a file.

mod checkpoints;
mod combinations;
mod disks;
mod kills;
mod motions;
mod paths;
mod readers;
mod streams;

use crate::attack::Attack;

/// All attacks.
pub const ALL: [Attack; 8] = [
    motions::ATTACK,
    readers::ATTACK,
    kills::ATTACK,
    checkpoints::ATTACK,
    disks::ATTACK,
    streams::ATTACK,
    paths::ATTACK,
    combinations::ATTACK,
];

/// The attack of a name.
pub fn of(name: &str) -> Option<&'static Attack> {
    ALL.iter().find(|attack| attack.name == name)
}
