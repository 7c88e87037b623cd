//! Random runs that are killed and resumed until they end.

use std::time::{Duration, Instant};

use crate::attack::{Attack, Cases, Trial};
use crate::comparison;
use crate::draw::{self, Length};
use crate::faults;
use crate::place::files;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "kills",
    what: "random runs killed at random moments and resumed: history, frames, checkpoints as of the run in one",
    share: 3.0,
    cases: Cases::Random,
    trial,
};

/// Largest number of kills of a run.
const MAX_KILLS: usize = 5;

/// Time limit of a run that is killed and resumed.
const LONGEST: Duration = Duration::from_secs(3);

const RUN: [&str; 3] = ["run", "draw.toml", "--quiet"];

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, place) = (trial.emmy, &trial.place);
    let input = draw::input(&mut trial.rng, Length::Long);
    for name in ["whole", "parts"] {
        place.write(format!("{name}/draw.toml"), &input);
    }
    let start = Instant::now();
    let whole = emmy.call(place.path("whole"), RUN).killed_after(LONGEST).run();
    let duration = start.elapsed();
    if duration >= LONGEST {
        // The steps of some motions become tiny, which takes too long.
        return Ok(());
    }
    faults::ends_with(&whole, &[0, 3])?;
    let mut kills = 0;
    let last = loop {
        let has_checkpoint = place.path("parts/run/checkpoint/a.checkpoint").exists()
            || place.path("parts/run/checkpoint/b.checkpoint").exists();
        let arguments = if has_checkpoint { ["resume", "run", "--quiet"] } else { RUN };
        let call = emmy.call(place.path("parts"), arguments);
        if kills == MAX_KILLS {
            break call.run();
        }
        let outcome = call.killed_after(duration.mul_f64(trial.rng.f64())).run();
        if outcome.signal != Some(9) {
            break outcome;
        }
        kills += 1;
    };
    faults::check(&last)?;
    // After a kill between summary and report there is nothing to resume.
    let is_done = last.code == Some(2) && last.stderr.contains("emmy report");
    if last.code != whole.code && !is_done {
        let (code, expected) = (last.code, whole.code);
        return Err(format!(
            "exit codes differ: {code:?} after {kills} kills, not {expected:?}\n{}",
            last.stderr
        ));
    }
    let [own, expected] = ["parts/run", "whole/run"].map(|name| place.path(name));
    faults::has_ended(&own)?;
    comparison::same(&own, &expected).map_err(|fault| format!("{fault}\n(after {kills} kills)"))?;
    match files(&own).iter().find(|name| name.extension().is_some_and(|extension| extension == "part")) {
        Some(left) => Err(format!("left behind: {}", left.display())),
        None => Ok(()),
    }
}
