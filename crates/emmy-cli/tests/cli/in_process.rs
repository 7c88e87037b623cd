//! Verbs in another program, without its streams and signals.

use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use emmy_cli::{Failure, Host, ProgressUpdate, run_verb};

use super::{BOX, Place};

/// Keeps everything, and asks to stop after a number of steps.
#[derive(Default)]
struct Kept {
    output: Mutex<String>,
    messages: Mutex<Vec<String>>,
    updates: Mutex<Vec<(String, f64, f64)>>,
    stop_after: Option<usize>,
    steps: AtomicUsize,
}

impl Host for Kept {
    fn output(&self, text: &str) -> io::Result<()> {
        self.output.lock().unwrap().push_str(text);
        Ok(())
    }

    fn message(&self, text: &str) {
        self.messages.lock().unwrap().push(text.to_string());
    }

    fn is_interrupted(&self) -> bool {
        self.stop_after.is_some_and(|steps| self.steps.load(Ordering::SeqCst) > steps)
    }

    fn progress(&self, update: &ProgressUpdate<'_>) {
        self.steps.fetch_add(1, Ordering::SeqCst);
        self.updates.lock().unwrap().push((update.what.to_string(), update.done, update.total));
    }
}

impl Kept {
    fn output(&self) -> String {
        self.output.lock().unwrap().clone()
    }

    fn messages(&self) -> String {
        self.messages.lock().unwrap().join("\n")
    }
}

/// The absolute path of a file of a place.
fn path(place: &Place, name: &str) -> String {
    place.path(name).to_str().unwrap().to_string()
}

/// Runs `box.toml` of a place into a directory of it.
fn run(place: &Place, directory: &str, host: &Kept, flags: &[&str]) -> Result<(), Failure> {
    let [input, output] = [path(place, "box.toml"), path(place, directory)];
    run_verb([&["run", &input, "--output", &output], flags].concat(), host)
}

/// The history without the clock.
fn rows(place: &Place, directory: &str) -> String {
    let mut columns = place.history(directory);
    columns.remove("wall_seconds");
    format!("{columns:?}")
}

#[test]
fn a_run_has_the_results_of_the_program_and_prints_nothing() {
    let place = Place::with(BOX);
    let program = place.succeed(&["run", "box.toml", "--output", "program/out", "--json"]);
    let kept = Kept::default();
    run(&place, "own/out", &kept, &["--json"]).unwrap();
    assert_eq!(rows(&place, "own/out"), rows(&place, "program/out"));
    assert_eq!(place.names("own/out"), place.names("program/out"));
    // A line for each of the 8 steps and the start, and the summary.
    assert_eq!(kept.output().lines().count(), program.stdout.lines().count());
    assert!(kept.messages().contains("done: 8 steps to t = 0.5") && kept.messages().contains("step 4 of 8"));
    let expected: Vec<_> = (0..=8).map(|step| (String::new(), f64::from(step), 8.0)).collect();
    assert_eq!(*kept.updates.lock().unwrap(), expected);
    let quiet = Kept::default();
    run(&place, "quiet", &quiet, &["--quiet"]).unwrap();
    assert_eq!((quiet.messages(), quiet.updates.lock().unwrap().len()), (String::new(), 9));
}

#[test]
fn a_run_that_its_host_stops_is_resumed_to_the_same_results() {
    let place = Place::with(BOX);
    run(&place, "whole", &Kept::default(), &[]).unwrap();
    let stopping = Kept { stop_after: Some(4), ..Kept::default() };
    let failure = run(&place, "parts", &stopping, &[]).unwrap_err();
    assert_eq!(failure.code(), 130);
    let Failure::Interrupted { message, help } = failure else { panic!("{failure}") };
    assert!(message.starts_with("stopped after step 4,") && help.contains("emmy resume"), "{message} {help}");
    assert_eq!(place.summary("parts")["status"], "interrupted");
    let kept = Kept::default();
    run_verb(["resume", &path(&place, "parts")], &kept).unwrap();
    assert!(kept.messages().contains("resuming after step 4"), "{}", kept.messages());
    assert_eq!(rows(&place, "parts"), rows(&place, "whole"));
    assert_eq!(place.summary("parts")["status"], "done");
}

#[test]
fn check_and_compare_return_what_the_program_prints() {
    let place = Place::with(BOX);
    let input = path(&place, "box.toml");
    let kept = Kept::default();
    run_verb(["check", &input], &kept).unwrap();
    let program = place.succeed(&["check", &input]);
    assert_eq!(kept.output(), program.stdout);
    let problem = emmy_io::input::read(&place.path("box.toml"), &Default::default()).unwrap();
    let report = emmy_cli::report_on(&problem).unwrap();
    assert_eq!(kept.output(), format!("input      {input}\n{report}"));
    // m = rho V = 2 * 2.
    assert!(report.contains("volume 2, mass 4,"), "{report}");
    for directory in ["a", "b"] {
        run(&place, directory, &Kept::default(), &["--quiet"]).unwrap();
    }
    let kept = Kept::default();
    let charts = path(&place, "charts");
    run_verb(["compare", &path(&place, "a"), &path(&place, "b"), "--output", &charts], &kept).unwrap();
    let program = place.succeed(&["compare", "a", "b", "--output", "charts"]);
    assert_eq!(kept.output(), program.stdout);
    assert!(place.names("charts").contains(&"compare.svg".to_string()));
}

#[test]
fn mistakes_come_back_as_failures_with_all_their_faults() {
    let place = Place::with(&BOX.replace("density = 2.0", "density = -2.0").replace("\"AS(2)\"", "\"DG\""));
    let kept = Kept::default();
    let failure = run(&place, "out", &kept, &[]).unwrap_err();
    assert_eq!((failure.code(), kept.output(), kept.messages()), (2, String::new(), String::new()));
    let Failure::Input(error) = failure else { panic!("{failure}") };
    assert_eq!(error.faults().len(), 2, "{error}");
    assert!(!place.path("out").exists());
    for (arguments, part) in [
        (vec!["fly"], "unrecognized subcommand 'fly'"),
        (vec!["run"], "required arguments were not provided"),
    ] {
        let failure = run_verb(arguments, &Kept::default()).unwrap_err();
        assert!(matches!(&failure, Failure::Usage { .. }) && failure.to_string().contains(part), "{failure}");
    }
    for verb in ["resume", "report", "compare"] {
        let failure = run_verb([verb, "/nowhere/at/all"], &Kept::default()).unwrap_err();
        assert!(matches!(&failure, Failure::Files { .. }) && failure.code() == 2, "{verb}: {failure:?}");
    }
    let kept = Kept::default();
    run_verb(["--version"], &kept).unwrap();
    assert_eq!(kept.output(), format!("emmy {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_step_that_fails_brings_its_error() {
    // Nothing acts before t = 0.2; the third step is the first with a system to solve.
    let input = BOX
        .replace("[[0.0, 0.0], [0.5, 1.0]]", "[[0.2, 0.0], [0.2, 1.0]]")
        .replace("max_iterations = 20", "max_iterations = 1")
        .replace("degree = 1", "degree = 1\nsmallest_step = 0.05");
    let place = Place::with(&input);
    let failure = run(&place, "out", &Kept::default(), &[]).unwrap_err();
    assert_eq!(failure.code(), 3);
    let Failure::NoConvergence(error) = failure else { panic!("{failure}") };
    assert!(error.to_string().contains("no convergence in step 3, to t = 0.25"), "{error}");
    assert_eq!(place.summary("out")["status"], "no-convergence");
}

#[test]
fn two_verbs_run_side_by_side_with_threads_and_texts_of_their_own() {
    let place = Place::with(BOX);
    let ends = [("0.2", "t = 0.2"), ("0.4", "t = 0.4")];
    let hosts = [Kept::default(), Kept::default()];
    std::thread::scope(|scope| {
        for (host, (until, _)) in hosts.iter().zip(ends) {
            let place = &place;
            scope.spawn(move || {
                for round in ["1", "2"] {
                    let directory = format!("{until}-{round}");
                    run(place, &directory, host, &["--until", until, "--threads", round]).unwrap();
                }
            });
        }
    });
    for (host, (_, end)) in hosts.iter().zip(ends) {
        let messages = host.messages();
        let done: Vec<&str> = messages.lines().filter(|line| line.starts_with("done:")).collect();
        assert!(done.len() == 2 && done.iter().all(|line| line.contains(end)), "{messages}");
    }
    assert_eq!(rows(&place, "0.4-1"), rows(&place, "0.4-2"));
}
