//! Random motions with three features, computed again by the reference.

use crate::agreement::agrees_in;
use crate::attack::{Attack, Cases, Trial};
use crate::features::{AXES, Choice, describe, has_void};

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "triples",
    what: "motions with three features against independently written ones",
    share: 6.0,
    cases: Cases::Random,
    trial,
};

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let choice = loop {
        let mut axes: Vec<usize> = (0..AXES.len()).collect();
        trial.rng.shuffle(&mut axes);
        let mut choice: Choice = [0; AXES.len()];
        for &axis in &axes[..3] {
            choice[axis] = trial.rng.usize(1..AXES[axis].values.len());
        }
        if !has_void(&choice) {
            break choice;
        }
    };
    let agreement = agrees_in(&trial.place, &choice, trial.number);
    // The Newton of the reference has no cuts: such a motion is not compared.
    if agreement.as_ref().is_err_and(|fault| fault.starts_with("the reference fails")) {
        return Ok(());
    }
    agreement.map_err(|fault| format!("{fault}\n  features: {}", describe(&choice)))
}
