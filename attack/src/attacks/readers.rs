//! Damaged files of every kind that the command reads.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use emmy_io::checkpoint;
use fastrand::Rng;

use crate::attack::{Attack, Cases, Trial};
use crate::base::FORMATS;
use crate::draw::{self, Length};
use crate::faults;
use crate::mutation::damaged;
use crate::place;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "readers",
    what: "damaged inputs, meshes, checkpoints, histories, summaries, frames: no panic, hang or NaN, always a message",
    share: 4.0,
    cases: Cases::Random,
    trial,
};

/// Time after which a run of a damaged input is killed, as it may have a million steps.
const MAX_RUN: Duration = Duration::from_millis(700);

/// Cells and steps beyond which an input takes too long for this attack.
const MAX_CELLS: f64 = 2000.0;

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    match trial.rng.usize(..8) {
        0..=1 => input(trial),
        2..=5 => mesh(trial),
        6 => damaged_checkpoint(trial),
        _ => run(trial),
    }
}

/// Files in a folder of the repository with one of some extensions; `""`: all.
fn corpus(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let is_wanted = |path: &PathBuf| {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        path.is_file() && (extensions.is_empty() || extensions.contains(&&*extension))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<PathBuf> = entries.filter(is_wanted).collect();
    paths.sort();
    paths
}

fn one_of(rng: &mut Rng, paths: &[PathBuf]) -> Vec<u8> {
    let path = &paths[rng.usize(..paths.len())];
    fs::read(path).unwrap_or_default()
}

/// A damaged input: `check`, and a short run.
fn input(trial: &mut Trial<'_>) -> Result<(), String> {
    let rng = &mut trial.rng;
    let whole = match rng.usize(..4) {
        0 => one_of(rng, &corpus("examples", &["toml"])),
        1 => one_of(rng, &corpus("fuzz/corpus/input", &[])),
        _ => draw::input(rng, Length::Short).into_bytes(),
    };
    let bytes = damaged(&whole, rng);
    if is_large(&bytes) {
        return Ok(());
    }
    trial.place.write("input.toml", bytes);
    check_and_run(trial)
}

/// Checks `input.toml` and runs it for a while: both must agree on whether it is valid.
fn check_and_run(trial: &Trial<'_>) -> Result<(), String> {
    let checked = trial.emmy.call(trial.place.path(""), ["check", "input.toml", "--output", "run"]).run();
    faults::ends_with(&checked, &[0, 2])?;
    faults::is_printable(&checked.stdout).map_err(|fault| format!("{fault}: {}", checked.call))?;
    let is_valid = checked.code == Some(0);
    let call = trial.emmy.call(trial.place.path(""), ["run", "input.toml", "--quiet", "--output", "run"]);
    let outcome = call.killed_after(MAX_RUN).run();
    if outcome.signal != Some(9) {
        faults::check(&outcome)?;
        if (outcome.code == Some(2)) == is_valid {
            return Err(format!(
                "check and run disagree: valid by check: {is_valid}\n{}",
                faults::excerpt(&outcome.stderr)
            ));
        }
        faults::has_ended(&trial.place.path("run"))?;
    }
    let history = trial.place.path("run/history.csv");
    if history.exists() && outcome.code == Some(0) { faults::is_finite(&history) } else { Ok(()) }
}

/// Whether an input takes too long for this attack.
fn is_large(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let numbers = |after: &str| {
        let lists = text.match_indices(after).map(|(at, key)| &text[at + key.len()..]);
        lists.filter_map(|list| list.split([']', '}', '\n']).next()).map(product).fold(1.0, f64::max)
    };
    numbers("cells") > MAX_CELLS
        || text.split("cell_size").skip(1).any(|rest| product(rest.split('}').next().unwrap_or("")) < 0.5)
}

/// Product of the numbers of a text.
fn product(text: &str) -> f64 {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || ".+-_".contains(c)))
        .filter_map(|word| word.replace('_', "").parse::<f64>().ok())
        .product()
}

/// A damaged mesh: `check`, and a run of two steps.
fn mesh(trial: &mut Trial<'_>) -> Result<(), String> {
    let rng = &mut trial.rng;
    let meshes = "crates/emmy-io/tests/meshes";
    let formats = [("gmsh", "msh"), ("abaqus", "inp"), ("nastran", "bdf"), ("vtu", "vtu")];
    let (format, extension) = formats[rng.usize(..formats.len())];
    let folder = &format!("fuzz/corpus/{format}");
    let whole = match rng.usize(..3) {
        0 => one_of(rng, &corpus(folder, &[])),
        _ => one_of(rng, &corpus(meshes, &[extension])),
    };
    let bytes = damaged(&whole, rng);
    trial.place.write(format!("mesh.{extension}"), bytes);
    trial.place.write("input.toml", input_with_mesh(extension));
    check_and_run(trial)
}

fn input_with_mesh(extension: &str) -> String {
    format!(
        "mesh.file = \"mesh.{extension}\"\n[[region]]\ndensity = 1.0\n\
         material.neo-hooke = {{ lambda = 100.0, mu = 100.0 }}\n[initial]\nvelocity = [1, 0.5, 0]\n\
         angular_velocity = [0, 0, 1]\n[time]\nscheme = \"DGM\"\nsteps = [{{ until = 0.02, size = 0.01 }}]\n"
    )
}

/// A damaged checkpoint with valid checksums, so that its content is read.
fn damaged_checkpoint(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, rng) = (trial.emmy, &mut trial.rng);
    let format = FORMATS[rng.usize(..2)];
    let own = trial.place.path("run");
    place::copy(&emmy.base().place.path(format).join("run"), &own);
    for name in ["a", "b"] {
        let path = own.join(format!("checkpoint/{name}.checkpoint"));
        let bytes = fs::read(&path).unwrap_or_default();
        trial.place.write(&path, checkpoint::sealed(damaged(&bytes, rng)));
    }
    let call = emmy.call(trial.place.path(""), ["resume", "run", "--quiet", "--until", "0.7"]);
    let outcome = call.killed_after(MAX_RUN).run();
    if outcome.signal == Some(9) { Ok(()) } else { faults::check(&outcome) }
}

/// A damaged file of a finished run, for all verbs that read runs.
fn run(trial: &mut Trial<'_>) -> Result<(), String> {
    let (emmy, rng) = (trial.emmy, &mut trial.rng);
    let format = FORMATS[rng.usize(..2)];
    let own = trial.place.path("run");
    place::copy(&emmy.base().place.path(format).join("run"), &own);
    let is_read = |name: &PathBuf| {
        let extension = name.extension().unwrap_or_default().to_string_lossy();
        ["csv", "json", "toml", "vtu", "pvd", "vtkhdf"].contains(&&*extension)
    };
    let mut names: Vec<PathBuf> = place::files(&own).into_iter().filter(is_read).collect();
    // One frame represents all, so that the other files are tried often enough.
    names.dedup_by_key(|name| name.extension().map(ToOwned::to_owned).filter(|extension| extension == "vtu"));
    let path = own.join(&names[rng.usize(..names.len())]);
    let bytes = fs::read(&path).unwrap_or_default();
    trial.place.write(&path, damaged(&bytes, rng));
    let calls: [&[&str]; 3] = [
        &["report", "run"],
        &["compare", "run", "run", "--output", "compared"],
        &["resume", "run", "--quiet", "--until", "0.7"],
    ];
    for arguments in calls {
        let outcome = emmy.call(trial.place.path(""), arguments).killed_after(Duration::from_secs(5)).run();
        // A damaged plan may have many steps.
        if outcome.signal == Some(9) && arguments[0] == "resume" {
            continue;
        }
        faults::check(&outcome)?;
    }
    Ok(())
}
