//! Streams that are closed, full or cut off never end a run.

use crate::attack::{Attack, Cases, Trial};
use crate::base::INPUT;
use crate::comparison;
use crate::faults;
use crate::place;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "streams",
    what: "closed streams, full devices and pipes that end early: no run ends by them",
    share: 0.5,
    cases: Cases::Listed(|_| REDIRECTIONS.len() * VERBS.len()),
    trial,
};

/// Damage to the streams.
const REDIRECTIONS: [&str; 9] = [
    "\"$@\" 2>&-",
    "\"$@\" >&-",
    "\"$@\" >&- 2>&-",
    "\"$@\" 2>/dev/full",
    "\"$@\" >/dev/full",
    "\"$@\" >/dev/full 2>&1",
    "{ trap '' PIPE; \"$@\"; echo $? >code; } 2>&1 | head -1",
    "{ trap '' PIPE; \"$@\"; echo $? >code; } 2>&1 | true",
    "\"$@\" <&-",
];

/// Arguments; the run of the base has ended.
const VERBS: [&[&str]; 7] = [
    &["run", "box.toml"],
    &["run", "box.toml", "--json"],
    &["resume", "done/run", "--until", "0.8"],
    &["check", "box.toml"],
    &["check", "wrong.toml"],
    &["list", "schemes"],
    &["compare", "done/run", "done/run", "--output", "compared"],
];

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, place, number) = (trial.emmy, &trial.place, trial.number as usize);
    let (shell, verb) = (REDIRECTIONS[number % REDIRECTIONS.len()], VERBS[number / REDIRECTIONS.len()]);
    place.write("box.toml", INPUT);
    place.write("wrong.toml", INPUT.replace("density", "dichte"));
    let base = emmy.base().place.path("vtu/run");
    place::copy(&base, &place.path("done/run"));
    let mut outcome = emmy.call(place.path(""), verb).within(shell).run();
    if shell.contains("code") {
        // The exit code of the shell would be the code of the last command.
        let code =
            std::fs::read_to_string(place.path("code")).map_err(|error| format!("no exit code: {error}"))?;
        outcome.code = code.trim().parse().ok();
    }
    // The shell reports a signal as a code above 128.
    if let Some(code @ 129..) = outcome.code.filter(|code| *code != 130) {
        (outcome.code, outcome.signal) = (None, Some(code - 128));
    }
    if outcome.stderr.is_empty() {
        // If standard error cannot be read, it is not checked.
        outcome.stderr = "(not seen)".into();
    }
    let is_wrong = verb.contains(&"wrong.toml");
    faults::ends_with(&outcome, if is_wrong { &[2] } else { &[0, 1] })?;
    if verb[0] != "run" {
        return Ok(());
    }
    // The motion must be computed and written even if messages are lost. Numbers on standard output are results.
    faults::has_ended(&place.path("run")).map_err(|fault| format!("{fault}\n{}", outcome.call))?;
    match verb.contains(&"--json") {
        true => Ok(()),
        false => {
            faults::succeeds(&outcome)?;
            comparison::same_rows(&place.path("run"), &base)
        }
    }
}
