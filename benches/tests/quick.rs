//! The whole program in its quick set: every item runs, and the block has the energies of the other programs.

use std::f64::consts::PI;
use std::process::{Command, Output};

fn bench(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_emmy-bench")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_item_runs_and_results_do_not_depend_on_threads() {
    // It checks the energies itself, and would end with an error.
    let output = bench(&["all", "--quick"]);
    let (page, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{errors}");
    let headings = [
        "A step of Emmy",
        "Beside other programs",
        "Schemes",
        "Materials with eigenvectors",
        "Degrees in time",
        "Error within a time",
        "A stiff block beside other programs",
        "Real cells beside other programs",
        "Solvers",
        "Cells against locking",
        "Large meshes",
        "Large stiff meshes",
        "Assembly",
        "Ensembles",
        "Threads",
        "Adaptive steps on a shaker",
        "Check of an input",
        "Contact of two bodies",
        "Search and pairs of contact",
    ];
    assert!(headings.iter().all(|heading| page.contains(&format!("## {heading}\n"))), "{page}");
    assert!(page.contains("**holds**: numbers that depend on the number of threads"), "{page}");
    assert!(page.contains("**not judged**") && !page.contains("does not hold"), "{page}");
}

#[test]
fn a_case_prints_one_line_of_json() {
    let input = concat!(env!("CARGO_MANIFEST_DIR"), "/spinning-block.toml");
    let output = bench(&["case", input, "--set", "time.steps=[{ until = 0.04, size = 0.02 }]"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let line: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((line["cells"].as_u64(), line["dofs"].as_u64()), (Some(117), Some(672)));
    // The energy at the start by the integrals of its definition; the mid-point rule keeps only some digits of it.
    let total = line["kinetic_energy"].as_f64().unwrap() + line["strain_energy"].as_f64().unwrap();
    assert!((total - 464.5311).abs() < 0.05, "{total}");
    assert!(line["cpu_seconds_per_step"].as_f64().unwrap() >= 0.0);
}

#[test]
fn a_bushing_of_steel_and_rubber_is_a_case() {
    let input = concat!(env!("CARGO_MANIFEST_DIR"), "/bushing.toml");
    let output = bench(&["case", input, "--set", "time.steps=[{ until = 8e-4, size = 2e-4 }]"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let line: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((line["cells"].as_u64(), line["dofs"].as_u64()), (Some(1702), Some(8445)));
    let energy = |name: &str| line[name].as_f64().unwrap();
    // The pin of 0.0266 kg takes the impulse of half a sine, 600 N and 5 ms; rubber only slows it.
    let impulse = 600.0 * 0.005 / PI * (1.0 - (PI * 0.16).cos());
    let total = energy("kinetic_energy") + energy("strain_energy");
    assert!(total > 0.0 && total < impulse * impulse / (2.0 * 2.66135e-5), "{total}");
}

#[test]
fn adaptive_steps_are_measured_beside_equal_ones() {
    let folder = tempfile::tempdir().unwrap();
    let output = bench(&["precision", "orbit", "--quick", "--output", folder.path().to_str().unwrap()]);
    let page = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(page.contains("## Orbit of eccentricity 0.9") && page.contains("## Summary"), "{page}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    // 3 runs with equal steps and 2 adaptive ones of each degree, below the heading.
    assert_eq!(read("orbit.csv").lines().count(), 16);
    assert!(read("orbit.svg").starts_with("<svg"));
}

#[test]
fn impossible_runs_end_with_a_message() {
    for (arguments, part) in [
        (&["stp"][..], "there are step, schemes"),
        (&["--python", "nothing=python"][..], "no program nothing"),
        (&["case", "nowhere.toml"][..], "nowhere.toml"),
        (&["precision", "orbits"][..], "there are orbit, block"),
    ] {
        let output = bench(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(part), "{}", text(&output.stderr));
    }
}
