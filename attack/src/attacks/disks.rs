//! Full disks: exit code 1, a true summary, and a run that can be resumed.

use crate::attack::{Attack, Cases, Trial};
use crate::base::{FORMATS, INPUT};
use crate::comparison;
use crate::emmy::Emmy;
use crate::faults;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "disks",
    what: "files that may not grow, file systems without room: exit code 1, an honest summary, resumed in every bit",
    share: 1.0,
    cases: Cases::Random,
    trial,
};

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, rng) = (trial.emmy, &mut trial.rng);
    let format = FORMATS[rng.usize(..2)];
    let input =
        INPUT.replace("until = 0.6", "until = 8.0").replace("\"run\"", "\"run\"\nformat = \"FORMAT\"");
    let input = input.replace("FORMAT", format);
    for name in ["whole", "parts"] {
        trial.place.write(format!("{name}/box.toml"), &input);
    }
    faults::succeeds(&emmy.call(trial.place.path("whole"), RUN).run())?;
    match rng.usize(..3) {
        0 => file_system(trial, emmy),
        // Blocks of 512 bytes; with and without the signal of the limit.
        case => {
            let blocks = trial.rng.usize(4..260);
            let trap = if case == 1 { "trap '' XFSZ; " } else { "" };
            small_files(trial, emmy, &format!("{trap}ulimit -f {blocks}"))
        }
    }
}

const RUN: [&str; 3] = ["run", "box.toml", "--quiet"];

fn small_files(trial: &Trial<'_>, emmy: &Emmy, limit: &str) -> Result<(), String> {
    let parts = trial.place.path("parts");
    let outcome = emmy.call(&parts, RUN).after(limit).run();
    // Without room for the report only, the run succeeds.
    faults::ends_with(&outcome, &[0, 1])?;
    faults::has_ended(&parts.join("run")).map_err(|fault| format!("{fault}\n{}", outcome.call))?;
    if outcome.code == Some(0) {
        return comparison::same_rows(&parts.join("run"), &trial.place.path("whole/run"));
    }
    resumes(trial, emmy)
}

/// Checks that the run can be resumed, or that the message says why not.
fn resumes(trial: &Trial<'_>, emmy: &Emmy) -> Result<(), String> {
    let (parts, whole) = (trial.place.path("parts"), trial.place.path("whole"));
    let has_checkpoint =
        ["a", "b"].iter().any(|name| parts.join(format!("run/checkpoint/{name}.checkpoint")).exists());
    let outcome = emmy.call(&parts, ["resume", "run", "--quiet"]).run();
    faults::ends_with(&outcome, if has_checkpoint { &[0] } else { &[2] })?;
    match has_checkpoint {
        true => comparison::same(&parts.join("run"), &whole.join("run")),
        false => Ok(()),
    }
}

/// A small file system; nothing is tried if it cannot be mounted.
fn file_system(trial: &mut Trial<'_>, emmy: &Emmy) -> Result<(), String> {
    let room = trial.rng.usize(12..400);
    // The mount ends with the shell, so the run is copied first.
    let mount = format!("mount -t tmpfs -o size={room}k tmpfs small || exit 77");
    let parts = trial.place.path("parts");
    std::fs::create_dir_all(parts.join("small")).map_err(|error| error.to_string())?;
    let shell = format!(
        "exec unshare -rm sh -c '{mount}; cd small && cp ../box.toml . && \"$@\"; code=$?; \
         cp -a run .. 2>/dev/null; exit $code' sh \"$@\""
    );
    let outcome = emmy.call(&parts, RUN).within(&shell).run();
    let is_not_allowed = outcome.code == Some(77) || outcome.stderr.contains("unshare");
    if is_not_allowed || !parts.join("run").exists() {
        return Ok(());
    }
    faults::ends_with(&outcome, &[0, 1])?;
    faults::has_ended(&parts.join("run")).map_err(|fault| format!("{fault}\n{room} kB"))?;
    if outcome.code == Some(0) { Ok(()) } else { resumes(trial, emmy) }
}
