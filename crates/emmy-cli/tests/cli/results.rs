//! Files of a run.

use super::{BOX, Place};

const COLUMNS: &str = "step,time,step_size,kinetic_energy,strain_energy,external_work,total_energy,energy_residual,\
    linear_momentum_x,linear_momentum_y,linear_momentum_z,angular_momentum_x,angular_momentum_y,angular_momentum_z,\
    linear_momentum_residual,angular_momentum_residual,newton_iterations,wall_seconds,smallest_determinant,tip_x,tip_y,tip_z,\
    y-min_force_x,y-min_force_y,y-min_force_z,y-min_moment_x,y-min_moment_y,y-min_moment_z";

#[test]
fn the_history_has_its_columns_and_a_row_a_step() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let files = [
        ".lock",
        "checkpoint",
        "events.csv",
        "frames",
        "history.csv",
        "input.toml",
        "newton.csv",
        "out.pvd",
        "report.html",
        "run.log",
        "summary.json",
    ];
    assert_eq!(place.names("out"), files);
    assert_eq!(place.read("out/history.csv").lines().next(), Some(COLUMNS));
    let history = place.history("out");
    assert_eq!(history["step"], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!((history["step_size"][0], history["step_size"][1], history["step_size"][8]), (0.0, 0.1, 0.05));
    assert_eq!((history["tip_x"][0], history["tip_y"][0], history["tip_z"][0]), (0.0, 2.0, 0.0));
    for step in 1..9 {
        let (kinetic, strain) = (history["kinetic_energy"][step], history["strain_energy"][step]);
        assert_eq!(history["total_energy"][step], kinetic + strain);
        assert!(history["tip_z"][step] > history["tip_z"][step - 1]);
        assert!(history["newton_iterations"][step] >= 1.0);
    }
    let worst = history["energy_residual"].iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
    assert_eq!(place.summary("out")["worst_energy_residual"].as_f64(), Some(worst));
}

/// The body is undeformed at the start, and every step ends with a residual below its target.
#[test]
fn newton_and_determinants_are_recorded() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    let det = &history["smallest_determinant"];
    assert!((det[0] - 1.0).abs() < 1e-15 && det[8] < 1.0 && det[8] > 0.5, "{det:?}");
    let text = place.read("out/newton.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("step,iteration,residual,target"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    for step in 1..9 {
        let rows: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] == step as f64).collect();
        // One evaluation before each correction; the last residual is not evaluated.
        assert_eq!(rows.len() as f64, history["newton_iterations"][step]);
        assert!(rows.iter().enumerate().all(|(i, row)| row[1] == i as f64));
        let last = rows.last().unwrap();
        assert!(last[2] <= last[3] && rows[0][2] > 1e3 * last[3], "{rows:?}");
    }
}

#[test]
fn the_summary_describes_the_run() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let summary = place.summary("out");
    assert_eq!(summary["status"], "done");
    assert_eq!((&summary["scheme"], &summary["degree"]), (&"AS(2)".into(), &1.into()));
    assert_eq!((&summary["dofs"], &summary["cells"], &summary["steps"]), (&36.into(), &2.into(), &8.into()));
    for key in [
        "version",
        "newton_iterations",
        "wall_seconds",
        "worst_energy_residual",
        "worst_angular_momentum_residual",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
}

#[test]
fn the_end_of_a_run_tells_the_time_in_its_summary() {
    let place = Place::with(BOX);
    let printed = place.succeed(&["run", "box.toml"]);
    let seconds = place.summary("out")["wall_seconds"].as_f64().unwrap();
    assert!(printed.stderr.contains(&format!(" in {seconds:.2} s, ")), "{seconds} {}", printed.stderr);
}

#[test]
fn the_collection_lists_every_frame_with_its_time() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let (collection, history) = (place.read("out/out.pvd"), place.history("out"));
    assert_eq!(collection.matches("<DataSet").count(), 5);
    for step in [0, 2, 4, 6, 8] {
        let file = format!("frames/out_{step:06}.vtu");
        assert!(place.path("out").join(&file).is_file());
        let line = format!("timestep=\"{:?}\" part=\"0\" file=\"{file}\"", history["time"][step]);
        assert!(collection.contains(&line), "{line}\n{collection}");
    }
}

/// Lines of a history without `wall_seconds`.
fn timeless(history: &str) -> Vec<Vec<&str>> {
    let mut lines: Vec<Vec<&str>> = history.lines().map(|line| line.split(',').collect()).collect();
    for line in &mut lines {
        line.remove(17);
    }
    lines
}

#[test]
fn the_resolved_input_gives_the_same_run() {
    let place = Place::with(BOX);
    let flags = ["--set", "time.scheme=DGM", "--set", "load.0.traction=[3, 0.1, 1e1]", "--until", "0.4"];
    place.succeed(&[&["run", "box.toml", "--quiet"], &flags[..]].concat());
    let first = place.read("out/history.csv");
    place.succeed(&["run", "out/input.toml", "--quiet", "--output", "again"]);
    assert_eq!(timeless(&first), timeless(&place.read("again/history.csv")));
    assert_eq!(place.read("out/input.toml").replace("\"out\"", "\"again\""), place.read("again/input.toml"));
    // In place, too.
    place.succeed(&["run", "out/input.toml", "--quiet"]);
    assert_eq!(timeless(&first), timeless(&place.read("out/history.csv")));
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let input = BOX.replace("cells = [1, 2, 1]", "cells = [4, 8, 4]");
    let place = Place::with(&input);
    for threads in ["1", "3"] {
        place.succeed(&[
            "run",
            "box.toml",
            "--quiet",
            "--until",
            "0.2",
            "--threads",
            threads,
            "--output",
            threads,
        ]);
    }
    assert_eq!(timeless(&place.read("1/history.csv")), timeless(&place.read("3/history.csv")));
    let [one, all] = [&["--threads", "1"][..], &[]]
        .map(|threads| place.succeed(&[&["check", "box.toml"], threads].concat()).stdout);
    assert_eq!(one, all);
}

/// So many threads would take minutes to start, and a machine with them.
#[test]
fn threads_above_the_cores_are_capped_with_a_note() {
    let place = Place::with(BOX);
    let cores = std::thread::available_parallelism().unwrap().get();
    let begin = format!("note: --threads 65535: this machine has {cores} core");
    for verb in [&["check", "box.toml"][..], &["run", "box.toml", "--quiet"]] {
        let outcome = place.succeed(&[verb, &["--threads", "65535"]].concat());
        assert!(outcome.stderr.starts_with(&begin), "{}", outcome.stderr);
    }
    let within = cores.to_string();
    assert_eq!(place.succeed(&["run", "box.toml", "--quiet", "--threads", &within]).stderr, "");
}

const DECK: &str = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n";

#[test]
fn mesh_files_are_found_beside_the_input_and_from_the_resolved_one() {
    let input = "[mesh]\nfile = \"meshes/tet.inp\"\nscale = 2.0\n\n[[region]]\ndensity = 1.0\n\
        material.saint-venant-kirchhoff = { youngs_modulus = 100, poissons_ratio = 0.25 }\n\n\
        [[initial]]\ngroup = \"body\"\nangular_velocity = [1, 0, 0]\n\n\
        [time]\nscheme = \"AS(1)\"\nsteps = [{ until = 1, size = 0.25 }]\n";
    let place = Place::new();
    place.write("inputs/tet.toml", input);
    place.write("inputs/meshes/tet.inp", DECK);
    place.succeed(&["run", "inputs/tet.toml", "--quiet"]);
    let report = place.succeed(&["check", "tet/input.toml"]).stdout;
    assert!(report.contains("1 tet4") && report.contains("volume 1.33333"), "{report}");
    place.succeed(&["run", "tet/input.toml", "--quiet", "--output", "again"]);
    assert_eq!(timeless(&place.read("tet/history.csv")), timeless(&place.read("again/history.csv")));
}
