//! `emmy run`: its endings, and the directories it may write to.

use super::{BOX, Place};

#[test]
fn a_run_ends_with_its_report_on_standard_error() {
    let place = Place::with(BOX);
    let outcome = place.succeed(&["run", "box.toml"]);
    assert!(outcome.stdout.is_empty());
    for part in ["step 8 of 8", "done: 8 steps to t = 0.5", "worst balance", "angular momentum", "out.pvd"] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    let quiet = place.succeed(&["run", "box.toml", "--quiet"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
}

#[test]
fn json_has_one_object_a_step_and_the_summary() {
    let place = Place::with(BOX);
    let outcome = place.succeed(&["run", "box.toml", "--json", "--quiet"]);
    let lines: Vec<serde_json::Value> =
        outcome.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 10);
    let columns: Vec<String> =
        place.read("out/history.csv").lines().next().unwrap().split(',').map(String::from).collect();
    let history = place.history("out");
    for (row, line) in lines[..9].iter().enumerate() {
        assert_eq!(line.as_object().unwrap().keys().collect::<Vec<_>>(), columns.iter().collect::<Vec<_>>());
        assert_eq!(line["total_energy"].as_f64().unwrap(), history["total_energy"][row]);
        assert_eq!(line["step"], row);
    }
    assert_eq!(lines[9], place.summary("out"));
    assert!(outcome.stderr.is_empty());
}

#[test]
fn a_step_that_does_not_converge_ends_with_3_and_leaves_the_last_good_state() {
    // Nothing acts before t = 0.2; the third step is the first with a system to solve.
    let input = BOX
        .replace("[[0.0, 0.0], [0.5, 1.0]]", "[[0.2, 0.0], [0.2, 1.0]]")
        .replace("max_iterations = 20", "max_iterations = 1")
        .replace("degree = 1", "degree = 1\nsmallest_step = 0.05")
        .replace("every = 2", "every = 5");
    let place = Place::with(&input);
    let outcome = place.emmy(&["run", "box.toml"]);
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("no convergence in step 3, to t = 0.25"), "{}", outcome.stderr);
    let summary = place.summary("out");
    assert_eq!((summary["status"].as_str(), summary["steps"].as_u64()), (Some("no-convergence"), Some(2)));
    assert!(summary["message"].as_str().unwrap().contains("no convergence"));
    assert_eq!(place.history("out")["step"], [0.0, 1.0, 2.0]);
    assert_eq!(place.names("out/frames"), ["out_000000.vtu", "out_000002.vtu"]);
    assert_eq!(place.read("out/out.pvd").matches("<DataSet").count(), 2);
}

#[test]
fn a_limit_that_is_exceeded_ends_with_4_after_its_step() {
    let input = BOX
        .replace("AS(2)", "FE(1)")
        .replace("energy = 1e-2", "energy = 1e-14")
        .replace("every = 2", "every = 50");
    let place = Place::with(&input);
    let outcome = place.emmy(&["run", "box.toml"]);
    assert_eq!(outcome.code, 4, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("accumulated energy residual"), "{}", outcome.stderr);
    let summary = place.summary("out");
    let steps = summary["steps"].as_u64().unwrap();
    assert_eq!(summary["status"], "limit-exceeded");
    assert!(steps < 8 && summary["energy_drift"].as_f64().unwrap() > 1e-14);
    assert_eq!(place.history("out")["step"].len() as u64, steps + 1);
    assert!(place.path(&format!("out/frames/out_{steps:06}.vtu")).is_file());
}

#[test]
fn until_cuts_and_extends_the_plan() {
    for (until, end, steps) in [("0.1", 0.1, 1), ("0.25", 0.25, 3), ("0.6", 0.6, 10)] {
        let place = Place::with(BOX);
        place.succeed(&["run", "box.toml", "--quiet", "--until", until]);
        let history = place.history("out");
        assert_eq!((history["time"].last(), history["time"].len()), (Some(&end), steps + 1));
        assert_eq!(place.summary("out")["planned_steps"].as_u64(), Some(steps as u64));
    }
}

#[test]
fn an_earlier_run_is_replaced_and_foreign_files_stay() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.write("out/notes.txt", "mine");
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.1"]);
    // The last state is a frame although its step is not a multiple of `every`.
    assert_eq!(place.names("out/frames"), ["out_000000.vtu", "out_000001.vtu"]);
    assert_eq!(place.history("out")["step"].len(), 2);
    assert_eq!(place.read("out/notes.txt"), "mine");
    // Bad input leaves the earlier run unchanged.
    let before = place.read("out/history.csv");
    assert_eq!(place.emmy(&["run", "box.toml", "--set", "time.scheme=FE(0)"]).code, 2);
    assert_eq!(place.read("out/history.csv"), before);
    place.succeed(&["run", "box.toml", "--quiet", "--set", "output.every=0"]);
    let names = [
        ".lock",
        "checkpoint",
        "events.csv",
        "history.csv",
        "input.toml",
        "newton.csv",
        "notes.txt",
        "report.html",
        "run.log",
        "summary.json",
    ];
    assert_eq!(place.names("out"), names);
}

#[test]
fn directories_of_others_are_left_alone() {
    let place = Place::with(BOX);
    place.write("data/measured.csv", "mine");
    for directory in ["data", "data/measured.csv", "."] {
        let outcome = place.emmy(&["run", "box.toml", "--output", directory]);
        assert_eq!(outcome.code, 2);
        assert!(outcome.stderr.contains("--output"), "{}", outcome.stderr);
    }
    assert_eq!(
        (place.names("."), place.names("data")),
        (vec!["box.toml".into(), "data".into()], vec!["measured.csv".into()])
    );
}

/// A pulse of 0.01 in steps of 0.05, at a time between their points.
#[test]
fn a_body_force_that_no_step_resolves_is_told() {
    let force = "body_force = [0, 0, \"x*exp(-((t - 0.33)/0.002)^2)\"]";
    let place = Place::with(&BOX.replace("group = \"y-max\"\ntraction = [0.0, 0.0, 10.0]", force));
    let outcome = place.emmy(&["run", "box.toml", "--quiet"]);
    assert!(outcome.code == 0 && outcome.stderr.contains("resolve"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("x*exp(-((t - 0.33)"), "{}", outcome.stderr);
    assert!(place.summary("out")["unresolved_loads"].as_u64().unwrap() > 0);
    let check = place.emmy(&["check", "box.toml"]);
    assert!(check.stdout.contains("body force on all cells: force [0, 0, 0]"), "{}", check.stdout);
    assert!(check.stdout.contains("at t = 0, of [0, 0, x*exp(-((t - 0.33)/0.002)^2)]"), "{}", check.stdout);
}

#[test]
fn notes_are_shown_once() {
    let place = Place::with(BOX);
    let outcome = place.succeed(&[
        "run",
        "box.toml",
        "--quiet",
        "--set",
        "output.probes=[{name=\"p\", point=[9,9,9]}]",
    ]);
    assert_eq!(outcome.stderr.matches("probe `p`: the nearest node").count(), 1, "{}", outcome.stderr);
}
