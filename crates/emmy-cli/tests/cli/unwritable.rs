//! Protected folders and files: exit code 2, a message with the reason, and nothing half-written.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::process::Command;

use super::{BOX, Outcome, Place, names};

/// A user without privileges, for tests that run as root: root may write everywhere.
const NOBODY: u32 = 65534;

impl Place {
    fn permit(&self, name: &str, mode: u32) {
        fs::set_permissions(self.path(name), Permissions::from_mode(mode)).unwrap();
    }

    fn emmy_without_rights(&self, arguments: &[&str]) -> Outcome {
        let mut command = Command::new(env!("CARGO_BIN_EXE_emmy"));
        command.args(arguments).current_dir(self.path("")).env("NO_COLOR", "1");
        if fs::metadata(self.path("")).unwrap().uid() == 0 {
            command.uid(NOBODY).gid(NOBODY);
        }
        let output = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Outcome {
            code: output.status.code().unwrap(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

/// Checks a rejection with these words, which leaves the folder unchanged.
#[track_caller]
fn rejected(place: &Place, arguments: &[&str], says: &[&str]) {
    let before = names(&place.path(""));
    let outcome = place.emmy_without_rights(arguments);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{}", outcome.stderr);
    for part in says.iter().chain(&["Permission denied"]) {
        assert!(outcome.stderr.contains(part), "\"{part}\" is not in\n{}", outcome.stderr);
    }
    assert_eq!(names(&place.path("")), before);
}

#[test]
fn a_folder_in_which_nothing_may_be_made() {
    let place = Place::with(BOX);
    place.permit("", 0o555);
    rejected(&place, &["run", "box.toml"], &["cannot write to out"]);
    rejected(&place, &["new", "l-block"], &["cannot write l-block.toml"]);
    let sizes = ["converge", "box.toml", "--sizes", "0.1,0.05", "--output", "study"];
    rejected(&place, &sizes, &["cannot write to study"]);
    let sweep = ["sweep", "box.toml", "--set", "region.density=1,2", "--output", "study"];
    rejected(&place, &sweep, &["cannot write to study"]);
    // `check` only reads.
    assert_eq!(place.emmy_without_rights(&["check", "box.toml"]).code, 0);
}

#[test]
fn an_empty_output_directory_of_somebody_else() {
    let place = Place::with(BOX);
    fs::create_dir(place.path("out")).unwrap();
    place.permit("out", 0o555);
    place.permit("", 0o777);
    rejected(&place, &["run", "box.toml"], &["cannot write to out"]);
    assert!(names(&place.path("out")).is_empty());
}

#[test]
fn an_earlier_run_that_may_not_be_replaced_stays_whole() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let files = ["history.csv", "summary.json", "input.toml", "out.pvd"].map(|name| format!("out/{name}"));
    let before = files.clone().map(|file| place.read(&file));
    place.permit("out", 0o555);
    place.permit("", 0o777);
    rejected(&place, &["run", "box.toml", "--set", "time.scheme=DGM"], &["cannot write to out"]);
    assert_eq!(files.map(|file| place.read(&file)), before);
}

#[test]
fn files_that_may_not_be_read() {
    let place = Place::with(BOX);
    place.permit("", 0o777);
    place.permit("box.toml", 0o000);
    rejected(&place, &["run", "box.toml"], &["cannot read box.toml"]);

    let mesh = "box = { size = [1, 2, 1], cells = [1, 2, 1] }";
    place.permit("box.toml", 0o644);
    place.write("box.toml", &BOX.replacen(mesh, "file = \"part.msh\"", 1));
    place.write("part.msh", "$MeshFormat\n");
    place.permit("part.msh", 0o000);
    rejected(&place, &["run", "box.toml"], &["part.msh: cannot be read"]);
}
