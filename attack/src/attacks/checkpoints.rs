//! Damaged checkpoints: the damage is reported, and the other checkpoint is used.

use std::fs;

use crate::attack::{Attack, Cases, Trial};
use crate::base::FORMATS;
use crate::comparison;
use crate::faults;
use crate::mutation::damaged;
use crate::place;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "checkpoints",
    what: "damaged checkpoints: reported, the other one used, or exit code 2",
    share: 1.0,
    cases: Cases::Random,
    trial,
};

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, rng) = (trial.emmy, &mut trial.rng);
    let format = FORMATS[rng.usize(..2)];
    let whole = emmy.base().place.path(format).join("run");
    let own = trial.place.path("run");
    place::copy(&whole, &own);
    let chosen: &[&str] = [&["a"][..], &["b"], &["a", "b"]][rng.usize(..3)];
    for name in chosen {
        let path = own.join(format!("checkpoint/{name}.checkpoint"));
        let bytes = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut new = damaged(&bytes, rng);
        if new == bytes {
            new.push(0);
        }
        trial.place.write(&path, new);
    }
    let until = ["resume", "run", "--quiet", "--until", "0.8"];
    let outcome = emmy.call(trial.place.path(""), until).run();
    faults::ends_with(&outcome, if chosen.len() == 2 { &[2] } else { &[0] })?;
    if let Some(name) = chosen.iter().find(|name| !outcome.stderr.contains(&format!("{name}.checkpoint"))) {
        return Err(format!("damage not reported: {name}.checkpoint\n{}", outcome.stderr));
    }
    if outcome.code == Some(0) {
        let expected = trial.place.path("expected/run");
        place::copy(&whole, &expected);
        let outcome = emmy.call(trial.place.path("expected"), until).run();
        faults::succeeds(&outcome)?;
        comparison::same_rows(&own, &expected)?;
    }
    Ok(())
}
