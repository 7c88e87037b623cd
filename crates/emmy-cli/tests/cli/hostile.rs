//! Malicious or unlucky inputs: characters that reach the terminal, and time that they keep the program busy.

use std::time::{Duration, Instant};

use super::{BOX, Outcome, Place};

const MESH: &str = "box = { size = [1, 2, 1], cells = [1, 2, 1] }";

/// A tetrahedron in the format of Gmsh with a group of a given name.
fn gmsh(group: &str) -> String {
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"{group}\"\n$EndPhysicalNames\n\
         $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
    )
}

/// The input of a tetrahedron without loads, in free flight.
fn tetrahedron(group: &str) -> String {
    format!(
        "title = \"a\\u001b[2Jb\"\nmesh.file = \"part.msh\"\n[[region]]\ngroup = \"{group}\"\ndensity = 1.0\n\
         material.neo-hooke = {{ lambda = 1.0, mu = 1.0 }}\n[initial]\nangular_velocity = [0, 0, 1]\n\
         [time]\nscheme = \"DGM\"\nsteps = [{{ until = 0.2, size = 0.1 }}]\n[output]\ndirectory = \"out\"\n"
    )
}

#[track_caller]
fn assert_printable(outcome: &Outcome) {
    let raw = |c: char| c.is_control() && c != '\n' && c != '\t';
    assert!(!outcome.stdout.contains(raw) && !outcome.stderr.contains(raw), "{outcome:?}");
}

#[test]
fn control_characters_reach_neither_the_terminal_nor_the_frames() {
    let place = Place::with(&tetrahedron("a_b"));
    place.write("part.msh", &gmsh("a\u{1b}b"));
    let outcome = place.succeed(&["check", "box.toml"]);
    assert_printable(&outcome);
    assert!(outcome.stdout.contains("a_b: 1 cell,"), "{}", outcome.stdout);
    assert!(outcome.stderr.contains("the name \"a\\u{1b}b\" has control characters"), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("the title \"a\\u{1b}[2Jb\" has control characters"),
        "{}",
        outcome.stderr
    );
    assert_printable(&place.succeed(&["run", "box.toml"]));
    // An invalid XML frame could not be read.
    let frame = emmy_io::mesh::read(&place.path("out/frames/out_000002.vtu")).unwrap();
    assert_eq!(frame.mesh.groups().cells("a_b").unwrap(), [0]);
    assert!(place.path("out/report.html").exists());
    // The name in the file also finds the group.
    let place = Place::with(&tetrahedron("a\\u001bb"));
    place.write("part.msh", &gmsh("a\u{1b}b"));
    place.succeed(&["check", "box.toml"]);
}

#[test]
fn control_characters_are_escaped_in_every_failure() {
    let key = BOX.replacen("density", "\"den\\u001b[31msity\"", 1);
    let raw_key = BOX.replacen("density", "den\u{1b}[31msity", 1);
    for input in [key, raw_key, BOX.replacen("\"y-max\"", "\"y\\u001b-max\"", 1)] {
        let place = Place::with(&input);
        for verb in ["check", "run"] {
            let outcome = place.emmy(&[verb, "box.toml"]);
            assert_eq!(outcome.code, 2);
            assert_printable(&outcome);
        }
    }
    let place = Place::with(BOX);
    for arguments in [
        &["check", "no\u{1b}such.toml"][..],
        &["resume", "no\u{1b}such"],
        &["report", "no\u{1b}such"],
        &["compare", "no\u{1b}such", "nor\u{7}this"],
        &["check", "box.toml", "--set", "a\u{1b}=1"],
        &["check", "box.toml", "--set", "title=\"\u{1b}"],
        &["converge", "no\u{1b}such.toml", "--sizes", "0.1"],
        &["sweep", "box.toml", "--set", "time.degree=1,\u{1b}"],
        &["sweep", "box.toml", "--set", "time.steps.1.size=0.05,1e-12", "--set", "title=\"a\u{9}\u{7}\""],
    ] {
        let outcome = place.emmy(arguments);
        assert_ne!(outcome.code, 0, "{arguments:?}");
        assert_printable(&outcome);
    }
}

#[cfg(unix)]
#[test]
fn special_files_are_rejected_at_once() {
    let place = Place::with(BOX);
    let made = std::process::Command::new("mkfifo").arg(place.path("pipe")).status().unwrap();
    assert!(made.success());
    std::fs::create_dir(place.path("folder")).unwrap();
    for (file, says) in [
        ("/dev/zero", "it is a device or a pipe, not a regular file"),
        ("pipe", "it is a device or a pipe, not a regular file"),
        ("folder", "it is a directory"),
    ] {
        place.write("mesh.toml", &BOX.replacen(MESH, &format!("file = \"{file}\""), 1));
        let start = Instant::now();
        for arguments in [["check", "mesh.toml"], ["run", "mesh.toml"], ["check", file], ["run", file]] {
            let outcome = place.emmy(&arguments);
            assert_eq!(outcome.code, 2, "{arguments:?}: {}", outcome.stderr);
            assert!(outcome.stderr.contains(says), "{arguments:?}: {}", outcome.stderr);
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{file}");
    }
}

#[test]
fn messages_of_long_lines_show_the_neighbourhood_of_the_mark() {
    let long = "k".repeat(100_000);
    let line = format!("density = 2.0 # {long}");
    for (input, says) in [
        (BOX.replacen("density = 2.0", &format!("{long} = 2.0"), 1), "unknown key `kkk"),
        (BOX.replacen("density = 2.0", &line.replacen("2.0", "-2.0", 1), 1), "density = -2.0 # kkk"),
        (BOX.replacen("\"y-max\"", &format!("\"{long}\""), 1), "the mesh has no group `kkk"),
    ] {
        let outcome = Place::with(&input).emmy(&["check", "box.toml"]);
        assert_eq!(outcome.code, 2);
        assert!(outcome.stderr.len() < 5_000, "{} bytes", outcome.stderr.len());
        assert!(outcome.stderr.contains(says), "{}", outcome.stderr);
    }
    let outcome = Place::with(BOX).emmy(&["check", "box.toml", "--set", &format!("{long}=1")]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.len() < 5_000, "{} bytes", outcome.stderr.len());
}

#[test]
fn a_mark_in_a_long_line_keeps_its_column() {
    let comment = " ".repeat(1000);
    let input = BOX.replacen("size = [1, 2, 1], cells", &format!("size = [1, 2, 1],{comment}zells"), 1);
    let outcome = Place::with(&input).emmy(&["check", "box.toml"]);
    // box = { size = [1, 2, 1],: 25 characters, then the spaces.
    assert!(outcome.stderr.contains("box.toml:4:1026"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("…"), "{}", outcome.stderr);
}

#[test]
fn derived_values_must_be_finite() {
    let elastic = "lambda = 1000.0, mu = 500.0";
    let (traction, velocity) = ("traction = [0.0, 0.0, 10.0]", "velocity = [0, 0, 0]");
    let wide = ("size = [1, 2, 1]", "size = [1e10, 2, 1e10]");
    for (changes, says) in [
        (
            &[(elastic, "youngs_modulus = 1e149, poissons_ratio = 0.49999999999999994")][..],
            "the Lame parameters that follow",
        ),
        (&[(elastic, "youngs_modulus = 1e308, poissons_ratio = 0.4999999999")], "youngs_modulus"),
        (&[("size = [1, 2, 1]", "size = [1e140, 1e140, 1e140]")], "coordinates up to 1e140"),
        (&[(velocity, "velocity = [1e150, 0, 0]"), wide], "the kinetic energy at the start is inf"),
        (&[(traction, "traction = [0.0, 0.0, 1e140]"), wide], "the resultant of this load is 1e160"),
        (&[(traction, "pressure = 1e140"), wide], "the resultant of this load is -1e160"),
        (&[("density = 2.0", "density = 1e-300")], "the mass here is 2e-300"),
        (&[("density = 2.0", "density = 1e150")], "the mass here is 2e150"),
        (
            &[(MESH, "box = { size = [1, 2, 1], cells = [1, 2, 1] }\nscale = 1e-80")],
            "the mesh has a size of 2e-80",
        ),
    ] {
        let fix = ("fix = [\"x\", \"y\", \"z\"]", "fix = [\"y\"]");
        let input = changes.iter().chain([&fix]).fold(BOX.to_string(), |input, (from, to)| {
            assert!(input.contains(from), "{from}");
            input.replacen(from, to, 1)
        });
        for verb in ["check", "run"] {
            let outcome = Place::with(&input).emmy(&[verb, "box.toml"]);
            assert_eq!(outcome.code, 2, "{verb} {says}: {}", outcome.stderr);
            assert!(
                outcome.stderr.contains(says) && outcome.stderr.contains("box.toml:"),
                "{says}: {}",
                outcome.stderr
            );
        }
    }
}

#[test]
fn coordinates_of_a_file_must_have_volumes_that_are_numbers() {
    let place = Place::with(&tetrahedron("body"));
    place
        .write("part.msh", &gmsh("body").replace("2 1 0 0", "2 1e160 0 0").replace("3 0 1 0", "3 0 1e160 0"));
    let outcome = place.emmy(&["check", "box.toml"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("must be a finite number, not inf"), "{}", outcome.stderr);
}

#[test]
fn a_body_that_nothing_moves_is_noted() {
    const NOTE: &str = "note: nothing moves this body";
    let place = Place::with(BOX);
    for verb in ["check", "run"] {
        let unloaded = place.succeed(&[verb, "box.toml", "--set", "load=[]"]);
        assert!(unloaded.stderr.contains(NOTE), "{}", unloaded.stderr);
        for moved in [
            "title=box",
            "initial.velocity=[1, 0, 0]",
            "load={ acceleration = [0, 0, -9.81] }",
            "load={ attraction = { centre = [5, 5, 5], strength = 1 } }",
            "support={ group = \"y-min\", move = { x = \"t\" } }",
        ] {
            let flags = match moved.starts_with("title") || moved.starts_with("load") {
                true => vec!["--set", moved],
                false => vec!["--set", "load=[]", "--set", moved],
            };
            let scheme = ["--set", "time.scheme=DGM"];
            let outcome = place.succeed(&[&[verb, "box.toml"], &flags[..], &scheme[..]].concat());
            assert!(!outcome.stderr.contains(NOTE), "{moved}: {}", outcome.stderr);
        }
    }
}

#[test]
fn numbers_of_messages_have_six_digits_at_most() {
    // Six steps of 0.1 end at 0.6, whose nearest sum is 0.6000000000000001.
    let place = Place::with(BOX);
    let steps = "time.steps=[{ until = 0.30000000000000004, size = 0.1 }, { until = 0.7000000000000001, size = 0.05 }]";
    let check = place.succeed(&["check", "box.toml", "--set", steps, "--set", "output.every=0"]);
    let run = place.succeed(&["run", "box.toml", "--set", steps, "--set", "output.every=0"]);
    let steps = "time.steps=[{ until = 0.30000000000000004, size = 0.1 }, { until = 0.1, size = 0.1 }]";
    let fault = place.emmy(&["check", "box.toml", "--set", steps]);
    assert!(fault.stderr.contains("ends at 0.1, but begins at 0.3;"), "{}", fault.stderr);
    for text in [check.stdout, check.stderr, run.stderr] {
        let digits = |word: &str| {
            let mantissa = word.split('e').next().unwrap_or_default();
            mantissa.chars().filter(char::is_ascii_digit).collect::<String>().trim_start_matches('0').len()
        };
        let is_number = |word: &str| word.parse::<f64>().is_ok();
        let words = text
            .split(|c: char| c.is_whitespace() || ",()[]".contains(c))
            .map(|word| word.trim_end_matches('.'));
        let long: Vec<&str> = words.filter(|word| is_number(word) && digits(word) > 6).collect();
        assert!(long.is_empty(), "{long:?} in {text}");
    }
}
