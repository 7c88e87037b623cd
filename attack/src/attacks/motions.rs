//! Random motions in the library, stopped and resumed.

use crate::attack::{Attack, Cases, Trial};
use crate::motions::resumes_in_every_bit;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "motions",
    what: "random motions resumed from snapshots, in every bit",
    share: 1.0,
    cases: Cases::Random,
    trial: |trial: &mut Trial<'_>| resumes_in_every_bit(trial.number),
};
