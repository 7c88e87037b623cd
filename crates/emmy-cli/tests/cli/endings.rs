//! How runs end despite bad files, terminals or signals: no panic, the right exit code, and a true summary.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::resume::{assert_same_rows, even_box, long_box, start, wait_for_rows};
use super::{BOX, Place};

/// A pipe that nobody reads.
fn closed_pipe() -> Stdio {
    let mut reader = Command::new("true").stdin(Stdio::piped()).spawn().unwrap();
    let end = reader.stdin.take().unwrap();
    reader.wait().unwrap();
    end.into()
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

fn status(place: &Place, arguments: &[impl AsRef<OsStr>], stdout: Stdio, stderr: Stdio) -> ExitStatus {
    let mut command = Command::new(env!("CARGO_BIN_EXE_emmy"));
    command.args(arguments).current_dir(place.path("")).stdout(stdout).stderr(stderr).status().unwrap()
}

/// Every verb with its exit code when messages can be written: all of them write some.
fn verbs() -> Vec<(Vec<&'static str>, i32)> {
    vec![
        (vec!["run", "box.toml"], 0),
        (vec!["run", "box.toml", "--set", "limits.energy=1e-300"], 4),
        (vec!["run", "box.toml", "--set", "mesh.cells=1"], 2),
        (vec!["run", "missing.toml"], 2),
        (vec!["check", "box.toml"], 0),
        (vec!["check", "box.toml", "--output", "/dev/null"], 2),
        (vec!["resume", "done", "--until", "0.6"], 0),
        (vec!["resume", "nothing"], 2),
        (vec!["compare", "done", "done"], 0),
        (vec!["compare", "nothing"], 2),
        (vec!["converge", "box.toml", "--sizes", "0.1,0.05", "--output", "study"], 0),
        (vec!["report", "done"], 0),
        (vec!["report", "nothing"], 2),
        (vec!["list"], 0),
        (vec!["list", "nothing"], 2),
        (vec!["schema"], 0),
        (vec!["new", "l-block"], 0),
        (vec!["new"], 2),
        (vec!["--help"], 0),
        (vec!["nothing"], 2),
    ]
}

/// Verbs whose result is on standard output.
const PRINTING: [&str; 8] =
    ["check", "compare", "converge", "report", "list", "schema", "--help", "--version"];

fn place_with_a_run() -> Place {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "done"]);
    place
}

#[test]
fn messages_that_cannot_be_written_are_lost_and_nothing_else() {
    for unwritable in [full, closed_pipe] {
        let place = place_with_a_run();
        for (arguments, code) in verbs() {
            let ended = status(&place, &arguments, Stdio::null(), unwritable());
            assert_eq!((ended.code(), ended.signal()), (Some(code), None), "{arguments:?}");
        }
        assert_eq!(place.summary("done")["steps"], 10);
    }
}

#[test]
fn results_that_cannot_be_written_end_with_1_and_without_a_reader_with_0() {
    for (unwritable, own) in [(full as fn() -> Stdio, 1), (closed_pipe, 0)] {
        let place = place_with_a_run();
        for (arguments, code) in verbs() {
            let ended = status(&place, &arguments, unwritable(), Stdio::null());
            let prints = code == 0 && PRINTING.contains(&arguments[0]);
            let expected = if prints { own } else { code };
            assert_eq!((ended.code(), ended.signal()), (Some(expected), None), "{arguments:?}");
        }
        for arguments in [&["run", "box.toml", "--json"][..], &["run", "box.toml", "--json", "--quiet"]] {
            assert_eq!(status(&place, arguments, unwritable(), full()).code(), Some(own), "{arguments:?}");
            let expected = if own == 0 { "done" } else { "failed" };
            assert_eq!(place.summary("out")["status"], expected);
        }
    }
}

/// A run whose reader stops in the middle: `emmy run ... 2>&1 | head -1`.
#[test]
fn a_closed_pipe_does_not_end_a_run() {
    let place = Place::with(&even_box(0.5, 0.05));
    let script =
        format!("'{}' run box.toml 2>&1 | head -1; echo ${{PIPESTATUS[0]}}", env!("CARGO_BIN_EXE_emmy"));
    let output = Command::new("bash").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stdout).ends_with("\n0\n"), "{output:?}");
    assert_eq!(place.summary("out")["status"], "done");
}

#[test]
fn paths_that_are_no_text_serve_every_verb() {
    let place = Place::new();
    let name = |bytes: &[u8]| OsStr::from_bytes(bytes).to_os_string();
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../emmy-io/tests/meshes/hex8-41-ascii.msh");
    let folder = place.path("").join(name(b"in\xff"));
    fs::create_dir(&folder).unwrap();
    fs::copy(mesh, folder.join("body.msh")).unwrap();
    let input = "mesh.file = \"body.msh\"\nregion = { density = 2.0, material.neo-hooke = { lambda = 10.0, mu = 5.0 } }\n\
                 initial.velocity = [1, 0, 0]\n[time]\nscheme = \"DGM\"\nsteps = [{ until = 0.2, size = 0.1 }]\n";
    fs::write(folder.join(name(b"b\xfe.toml")), input).unwrap();
    let file = name(b"in\xff/b\xfe.toml");
    let out = name(b"in\xff/out\xfd");
    let words = |words: &[&str]| -> Vec<std::ffi::OsString> { words.iter().map(Into::into).collect() };
    let run = [words(&["run"]), vec![file.clone()]].concat();
    let named = [run.clone(), words(&["--output"]), vec![out.clone()]].concat();
    let cases = [
        run,
        named,
        [words(&["check"]), vec![file.clone()]].concat(),
        [words(&["resume"]), vec![out.clone()], words(&["--until", "0.4"])].concat(),
        [words(&["report"]), vec![out.clone()]].concat(),
        [words(&["compare"]), vec![out.clone(), name(b"b\xfe")], words(&["--output"]), vec![name(b"c\xff")]]
            .concat(),
        [words(&["converge"]), vec![file], words(&["--sizes", "0.1,0.05", "--output"]), vec![name(b"s\xff")]]
            .concat(),
    ];
    for arguments in cases {
        let ended = status(&place, &arguments, Stdio::null(), Stdio::null());
        assert_eq!(ended.code(), Some(0), "{arguments:?}");
    }
    let out = place.path("").join(out);
    let history = fs::read_to_string(out.join("history.csv")).unwrap();
    assert_eq!(history.lines().count(), 6);
    assert!(fs::read_to_string(out.join("run.log")).unwrap().contains("run in\u{fffd}/b\u{fffd}.toml"));
    assert!(fs::read_dir(out.join("frames")).unwrap().count() > 2);
}

/// The run is rejected, and the files that it would have removed still exist.
#[track_caller]
fn assert_kept(place: &Place, arguments: &[&str], file: &str) {
    let before = fs::read(place.path(file)).unwrap();
    let outcome = place.emmy(&[&["run"], arguments].concat());
    assert_eq!(outcome.code, 2, "{arguments:?} {}", outcome.stderr);
    assert!(outcome.stderr.contains("which is among the files in"), "{}", outcome.stderr);
    assert_eq!(fs::read(place.path(file)).unwrap(), before);
    let check = place.emmy(&[&["check"], arguments].concat());
    assert_eq!((check.code, check.stderr), (2, outcome.stderr));
}

#[test]
fn a_run_does_not_remove_its_own_mesh_or_input() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let mesh = "box = { size = [1, 2, 1], cells = [1, 2, 1] }";
    let on_a_frame = |path: &str| BOX.replacen(mesh, &format!("file = \"{path}\""), 1);
    let frame = "out/frames/out_000008.vtu";
    place.write("frame.toml", &on_a_frame(frame));
    assert_kept(&place, &["frame.toml"], frame);
    assert_kept(&place, &["frame.toml", "--output", "out/../out"], frame);
    std::os::unix::fs::symlink("out", place.path("link")).unwrap();
    assert_kept(&place, &["frame.toml", "--output", "link"], frame);
    std::os::unix::fs::symlink(frame, place.path("mesh.vtu")).unwrap();
    place.write("linked.toml", &on_a_frame("mesh.vtu"));
    assert_kept(&place, &["linked.toml"], frame);
    // An include of a mesh.
    place.write("deck.inp", "*Include, input=out/run.log\n");
    fs::write(
        place.path("out/run.log"),
        "*Node\n1,0,0,0\n2,1,0,0\n3,0,2,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n\
         *Nset, nset=y-min\n1,2,4\n*Surface, name=y-max\n1, S2\n",
    )
    .unwrap();
    place.write("deck.toml", &on_a_frame("deck.inp"));
    assert_kept(&place, &["deck.toml"], "out/run.log");
    place.write("out/events.csv", BOX);
    assert_kept(&place, &["out/events.csv"], "out/events.csv");
    // In other directories the same inputs run.
    place.succeed(&["run", "frame.toml", "--quiet", "--output", "elsewhere"]);
}

#[test]
fn a_frame_that_cannot_be_written_makes_a_run_fail_with_all_its_ends() {
    let place = Place::with(&long_box().replace("every = 500", "every = 50"));
    let run = start(&place, &["run", "box.toml"]);
    wait_for_rows(&place, "out", 60);
    fs::remove_dir_all(place.path("out/frames")).unwrap();
    assert_eq!(run.wait_with_output().unwrap().status.code(), Some(1));
    let summary = place.summary("out");
    assert_eq!(summary["status"], "failed");
    let message = summary["message"].as_str().unwrap();
    assert!(message.contains("the results cannot be written") && message.contains("frames"), "{message}");
    let log = place.read("out/run.log");
    assert!(log.lines().last().unwrap().starts_with("failed at step"), "{log}");
}

/// Writes beyond the limit are errors and do not end the process.
#[test]
fn a_limit_on_the_size_of_files_is_an_error_as_any() {
    let place = Place::with(&long_box());
    let script = format!("ulimit -f 100; exec '{}' run box.toml --quiet", env!("CARGO_BIN_EXE_emmy"));
    let output = Command::new("bash").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{:?} {message}", output.status);
    assert!(message.contains("the results cannot be written: ") && message.contains("out"), "{message}");
    assert_eq!(place.summary("out")["status"], "failed");
}

#[test]
fn a_history_that_is_gone_or_changed_at_the_end_is_noticed() {
    let spoil: [fn(&Path); 2] =
        [|path| fs::remove_file(path).unwrap(), |path| fs::write(path, "step\n").unwrap()];
    for (spoil, says) in
        spoil.into_iter().zip(["it was removed during the run", "it was changed during the run"])
    {
        let place = Place::with(&long_box());
        let run = start(&place, &["run", "box.toml"]);
        wait_for_rows(&place, "out", 30);
        spoil(&place.path("out/history.csv"));
        assert_eq!(run.wait_with_output().unwrap().status.code(), Some(1));
        let summary = place.summary("out");
        assert_eq!(summary["status"], "failed");
        assert!(summary["message"].as_str().unwrap().contains(says), "{summary}");
    }
}

#[test]
fn no_signal_that_can_be_handled_leaves_a_run_that_runs() {
    let at_a_step = "stopped after step ";
    for (signals, says) in [
        (&["-USR1"][..], at_a_step),
        (&["-XCPU", "-XCPU"], at_a_step),
        (&["-QUIT"], at_a_step),
        (&["-INT", "-INT"], "stopped"),
    ] {
        let place = Place::with(&long_box());
        let run = start(&place, &["run", "box.toml"]);
        wait_for_rows(&place, "out", 30);
        for signal in signals {
            Command::new("kill").args([signal, &run.id().to_string()[..]]).status().unwrap();
        }
        let ended = run.wait_with_output().unwrap().status;
        assert_eq!((ended.code(), ended.signal()), (Some(130), None), "{signals:?}");
        let summary = place.summary("out");
        assert_eq!(summary["status"], "interrupted", "{signals:?}");
        assert!(summary["message"].as_str().unwrap().starts_with(says), "{signals:?} {summary}");
        place.succeed(&["resume", "out", "--quiet"]);
        assert_eq!(place.summary("out")["status"], "done");
    }
}

#[test]
fn a_run_ends_when_its_time_is_over() {
    let place = Place::with(&long_box());
    let start = Instant::now();
    let outcome = place.emmy(&["run", "box.toml", "--quiet", "--wall-limit", "1", "--until", "1e6"]);
    assert!(start.elapsed() >= Duration::from_secs(1));
    assert_eq!(outcome.code, 130, "{}", outcome.stderr);
    assert_eq!(place.summary("out")["status"], "interrupted");
    assert!(place.summary("out")["message"].as_str().unwrap().ends_with(", by --wall-limit"));
    assert_eq!(place.emmy(&["run", "box.toml", "--wall-limit", "0"]).code, 2);
}

#[test]
fn a_file_named_stop_ends_a_run_like_a_signal() {
    let place = Place::with(&long_box());
    let run = start(&place, &["run", "box.toml"]);
    wait_for_rows(&place, "out", 30);
    fs::write(place.path("out/stop"), "").unwrap();
    assert_eq!(run.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(place.summary("out")["status"], "interrupted");
    assert!(!place.path("out/stop").exists());
    // One that is there before the run does not end it.
    fs::write(place.path("out/stop"), "").unwrap();
    place.succeed(&["resume", "out", "--quiet"]);
    assert_eq!(place.summary("out")["status"], "done");
}

#[test]
fn resume_completes_the_files_of_a_finished_run() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet"]);
    // Killed after the last checkpoint, before the page; before the summary; before its status was final.
    let running = place.read("out/summary.json").replace("\"done\"", "\"running\"");
    let spoils: [&dyn Fn(); 3] = [
        &|| fs::remove_file(place.path("out/report.html")).unwrap(),
        &|| fs::remove_file(place.path("out/summary.json")).unwrap(),
        &|| place.write("out/summary.json", &running),
    ];
    for spoil in spoils {
        spoil();
        place.write("out/checkpoint/a.checkpoint.part", "left by a kill");
        place.succeed(&["resume", "out"]);
        assert_eq!(place.summary("out")["status"], "done");
        assert!(place.path("out/report.html").is_file());
        assert!(place.names("out/checkpoint").iter().all(|name| !name.ends_with(".part")));
        assert_same_rows(&place, "out", "whole");
    }
    let outcome = place.succeed(&["resume", "out"]);
    assert!(outcome.stderr.contains("nothing to do: the run is complete"), "{}", outcome.stderr);
}

#[test]
fn a_history_with_another_digit_is_not_resumed() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let whole = place.read("out/history.csv");
    // A digit of the strain energy of step 3.
    let line = whole.lines().nth(4).unwrap();
    let cell = line.split(',').nth(4).unwrap();
    let digit = if cell.as_bytes()[5] == b'7' { "8" } else { "7" };
    let other = line.replacen(cell, &format!("{}{digit}{}", &cell[..5], &cell[6..]), 1);
    place.write("out/history.csv", &whole.replacen(line, &other, 1));
    let outcome = place.emmy(&["resume", "out", "--until", "0.5"]);
    assert_eq!(outcome.code, 2);
    for part in ["history.csv was changed after the run wrote it", "restore the file"] {
        assert!(outcome.stderr.contains(part), "{}", outcome.stderr);
    }
    // Rows after the checkpoint do not matter.
    place.write("out/history.csv", &format!("{whole}7,any,thing"));
    place.succeed(&["resume", "out", "--quiet", "--until", "0.5"]);
    assert_eq!(place.history("out")["step"].len(), 11);
}

/// A collection in a directory whose name has a line feed: readers find the name of the directory itself.
#[test]
fn odd_names_of_directories_have_frames_and_pages() {
    for name in ["a\nb", "tab\tbed", "a & <b>"] {
        let place = Place::with(BOX);
        place.succeed(&["run", "box.toml", "--quiet", "--output", name]);
        let xml = place.read(&format!("{name}/{name}.pvd"));
        let expected = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let expected = expected.replace('\n', "&#10;").replace('\t', "&#9;");
        assert!(xml.contains(&format!("file=\"frames/{expected}_000000.vtu\"")), "{xml}");
        let page = place.read(&format!("{name}/report.html"));
        assert!(page.contains("\"n_nodes\":12"), "{name:?}");
    }
}

#[test]
fn logs_can_be_thinned_and_left_out() {
    let steps = |place: &Place| {
        let count = |file: &str, begin: &str| {
            place.read(&format!("out/{file}")).lines().filter(|line| line.starts_with(begin)).count()
        };
        let newton = place.read("out/newton.csv");
        let first = newton.lines().filter(|line| line.split(',').nth(1) == Some("0")).count();
        (first, count("run.log", "step "))
    };
    for (every, expected) in [("1", (8, 9)), ("3", (2, 3)), ("0", (0, 0))] {
        let place = Place::with(BOX);
        place.succeed(&["run", "box.toml", "--quiet", "--set", &format!("output.log_every={every}")]);
        assert_eq!(steps(&place), expected, "{every}");
        assert_eq!(place.history("out")["step"].len(), 9);
        assert!(
            place.read("out/run.log").contains("linear solver: ") && place.path("out/report.html").is_file()
        );
    }
}

#[test]
fn check_tells_the_size_of_the_files_within_a_tenth() {
    let place = Place::with(&even_box(0.5, 0.005).replace("every = 2", "every = 0"));
    let report = place.succeed(&["check", "box.toml"]).stdout;
    let told = report.split_once("history about ").unwrap().1.split_once(" kB").unwrap().0;
    place.succeed(&["run", "box.toml", "--quiet"]);
    let written = place.read("out/history.csv").len() as f64 / 1e3;
    assert!((told.parse::<f64>().unwrap() / written - 1.0).abs() < 0.1, "{told} {written}");
}

#[test]
fn check_rejects_the_directories_that_run_rejects() {
    let place = Place::with(BOX);
    for directory in ["/dev/null", "/dev/null/x", "box.toml/x", ".."] {
        let [check, run] =
            ["check", "run"].map(|verb| place.emmy(&[verb, "box.toml", "--output", directory]));
        assert_eq!((check.code, check.stdout.as_str(), run.code), (2, "", 2), "{directory}");
        assert_eq!(check.stderr, run.stderr, "{directory}");
    }
    // An earlier run is replaced.
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.succeed(&["check", "box.toml"]);
}

/// The loaded end moves most, at the last step.
#[test]
fn the_largest_displacement_is_at_the_loaded_end() {
    let corners = ["[0, 2, 0]", "[1, 2, 0]", "[0, 2, 1]", "[1, 2, 1]"];
    let probes: Vec<String> =
        corners.iter().enumerate().map(|(i, at)| format!("{{ name = \"c{i}\", point = {at} }}")).collect();
    let place = Place::with(&BOX.replace("{ name = \"tip\", point = [0, 2, 0] }", &probes.join(", ")));
    let closing = place.succeed(&["run", "box.toml"]).stderr;
    let (summary, history) = (place.summary("out"), place.history("out"));
    let moved = |i: usize| {
        let along = |axis: &str| {
            let path = &history[&format!("c{i}_{axis}")];
            path[8] - path[0]
        };
        (along("x").powi(2) + along("y").powi(2) + along("z").powi(2)).sqrt()
    };
    let largest = (0..4).map(moved).fold(0.0, f64::max);
    // The probes have the rounding of their positions.
    assert!(
        (summary["largest_displacement"].as_f64().unwrap() - largest).abs() < 1e-14,
        "{summary} {largest}"
    );
    assert_eq!(
        (&summary["largest_displacement_step"], &summary["largest_displacement_time"]),
        (&8.into(), &0.5.into())
    );
    assert_eq!(summary["largest_displacement_point"][1], 2.0);
    assert!(
        closing.contains("largest displacement: ") && closing.contains(" at t = 0.5, node "),
        "{closing}"
    );
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.5"]);
    assert_eq!(place.summary("parts")["largest_displacement"], summary["largest_displacement"]);
}

#[test]
fn a_page_of_very_many_loads_stays_small() {
    let load = |i: usize| format!("[[load]]\ngroup = \"y-max\"\ntraction = [0.0, 0.0, {i}e-9]\n");
    let loads: String = (0..20_000).map(load).collect();
    let place = Place::with(&BOX.replacen("[[support]]", &format!("{loads}\n[[support]]"), 1));
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.1"]);
    let page = place.read("out/report.html");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    assert!(page.contains("all 1") && page.contains(" bytes are in input.toml"));
}
