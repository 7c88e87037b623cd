//! `emmy resume`: a stopped, killed or finished run continues as if uninterrupted.

use std::process::{Child, Command, Stdio};
use std::time::Duration;

use emmy_io::history::History;
use emmy_io::vtk::SeriesReader;

use super::{BOX, Place};

/// The box with steps of one size.
pub(crate) fn even_box(until: f64, size: f64) -> String {
    BOX.replace(
        "steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]",
        &format!("steps = [{{ until = {until}, size = {size} }}]"),
    )
    .replace("energy = 1e-2", "energy = 1.0")
}

/// A box that takes some thousand steps, with few frames and many checkpoints.
pub(crate) fn long_box() -> String {
    even_box(4.0, 0.002).replace("every = 2", "every = 500\ncheckpoint_every = 20")
}

/// The rows of a history without the last column of every history, `wall_seconds`.
pub(crate) fn rows(place: &Place, directory: &str) -> Vec<String> {
    let text = place.read(&format!("{directory}/history.csv"));
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let wall = header.iter().position(|name| *name == "wall_seconds").unwrap();
    let without = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(i, _)| *i != wall);
        cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
    };
    text.lines().map(without).collect()
}

pub(crate) fn assert_same_rows(place: &Place, own: &str, expected: &str) {
    let (own, expected) = (rows(place, own), rows(place, expected));
    let first = own.iter().zip(&expected).position(|(own, expected)| own != expected);
    assert!(own == expected, "{} and {} rows, the first that differs: {first:?}", own.len(), expected.len());
}

pub(crate) fn frames(place: &Place, directory: &str) -> Vec<String> {
    let text = place.read(&format!("{directory}/{directory}.pvd"));
    text.lines()
        .filter(|line| line.contains("<DataSet"))
        .map(|line| line.replace(directory, "NAME"))
        .collect()
}

#[test]
fn a_run_in_two_parts_is_the_run_in_one() {
    // 0.3 is not 3 times 0.1 in floating point: a plan that ends there has another time than a longer plan.
    for (scheme, degree, size) in [("AS(2)", 1, 0.05), ("DGM", 2, 0.1), ("Newmark(0.25, 0.5)", 1, 0.05)] {
        let input =
            even_box(1.0, size).replace("AS(2)", scheme).replace("degree = 1", &format!("degree = {degree}"));
        let place = Place::with(&input);
        place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
        place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
        place.succeed(&["resume", "parts", "--quiet", "--until", "0.7"]);
        place.succeed(&["resume", "parts", "--quiet", "--until", "1.0"]);
        assert_same_rows(&place, "parts", "whole");
        assert_eq!(frames(&place, "parts"), frames(&place, "whole"));
        let (whole, parts) = (place.summary("whole"), place.summary("parts"));
        for key in ["steps", "newton_iterations", "worst_energy_residual", "external_work", "status"] {
            assert_eq!(whole[key], parts[key], "{key}");
        }
        assert!(place.read("parts/run.log").contains("resumed after step"));
    }
}

#[test]
fn a_body_force_by_expression_goes_on() {
    let force = "group = \"body\"\nbody_force = [\"3*sin(4*t)\", 0, \"x*y*cos(t)\"]";
    let place =
        Place::with(&even_box(1.0, 0.05).replace("group = \"y-max\"\ntraction = [0.0, 0.0, 10.0]", force));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "1.0"]);
    assert_same_rows(&place, "parts", "whole");
    assert_eq!(frames(&place, "parts"), frames(&place, "whole"));
}

#[test]
fn a_series_of_frames_is_resumed() {
    let place = Place::with(&even_box(0.4, 0.05).replace("every = 2", "every = 2\nformat = \"vtkhdf\""));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.15"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.4"]);
    let open = |name: &str| SeriesReader::open(&place.path(&format!("{name}/{name}.vtkhdf"))).unwrap();
    let (whole, parts) = (open("whole"), open("parts"));
    // The last frame of the first part, of step 3, was additional.
    assert_eq!((parts.times(), parts.times().len()), (whole.times(), 5));
    assert_eq!(parts.fields(), whole.fields());
    for (frame, field) in (0..5).flat_map(|frame| whole.fields().into_iter().map(move |field| (frame, field)))
    {
        assert_eq!(
            parts.values(field, frame).unwrap(),
            whole.values(field, frame).unwrap(),
            "{field} {frame}"
        );
    }
}

#[test]
fn step_scheme_degree_and_output_may_change() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let outcome =
        place.succeed(&["resume", "out", "--until", "0.5", "--step", "0.1", "--set", "output.every=1"]);
    assert!(outcome.stderr.contains("resuming after step 6, t = 0.3"), "{}", outcome.stderr);
    let sizes = place.history("out")["step_size"].clone();
    assert_eq!((sizes.len(), sizes[6], sizes[7], sizes[8]), (9, 0.05, 0.1, 0.1));
    let changes = ["--set", "time.scheme=DGM", "--set", "time.degree=2", "--set", "solver.kind=direct"];
    place.succeed(&[&["resume", "out", "--quiet", "--until", "0.7"][..], &changes].concat());
    let summary = place.summary("out");
    assert_eq!((summary["scheme"].as_str(), summary["steps"].as_u64()), (Some("DGM"), Some(10)));
    // The resolved input describes the steps done: the sizes of all parts.
    let input = place.read("out/input.toml");
    assert!(input.contains("{ until = 0.3, size = 0.05 }, { until = 0.7, size = 0.1 }"), "{input}");
    // Without a load, the energy of the state is conserved in the future: here the balance of every step closes.
    let history = place.history("out");
    let largest = history["total_energy"].iter().copied().fold(0.0, f64::max);
    assert!(history["energy_residual"][9..].iter().all(|residual| residual.abs() < 1e-12 * largest));
}

/// Starts the binary without waiting for it.
pub(crate) fn start(place: &Place, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_emmy"))
        .args(arguments)
        .current_dir(place.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Waits until a history has some rows.
pub(crate) fn wait_for_rows(place: &Place, directory: &str, n: usize) {
    let path = place.path(&format!("{directory}/history.csv"));
    for _ in 0..6000 {
        if std::fs::read_to_string(&path).is_ok_and(|text| text.lines().count() > n) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("{path:?} does not grow");
}

#[test]
fn two_runs_do_not_write_into_one_directory() {
    let place = Place::with(&long_box());
    let mut first = start(&place, &["run", "box.toml"]);
    wait_for_rows(&place, "out", 2);
    for arguments in [&["run", "box.toml"][..], &["resume", "out"]] {
        let outcome = place.emmy(arguments);
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        assert!(outcome.stderr.contains("another run of Emmy is writing into"), "{}", outcome.stderr);
    }
    first.kill().unwrap();
    first.wait().unwrap();
}

#[cfg(unix)]
#[test]
fn signals_stop_a_run_at_the_end_of_a_step() {
    for signal in ["-INT", "-TERM"] {
        let place = Place::with(&long_box().replace("until = 4.0", "until = 1.0"));
        place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
        let mut run = start(&place, &["run", "box.toml"]);
        wait_for_rows(&place, "out", 30);
        assert!(Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap().success());
        assert_eq!(run.wait().unwrap().code(), Some(130), "{signal}");
        let summary = place.summary("out");
        assert_eq!(summary["status"], "interrupted");
        let outcome = place.succeed(&["resume", "out"]);
        let step = format!("resuming after step {},", summary["steps"]);
        assert!(outcome.stderr.contains(&step), "{step}\n{}", outcome.stderr);
        assert_same_rows(&place, "out", "whole");
    }
}

/// Kills a run and its continuations at different moments. After each kill the directory is readable, and the run
/// reaches the history of an uninterrupted run. Returns the number of kills before the first checkpoint, and after.
fn kill_again_and_again(times: u64) -> [usize; 2] {
    let place = Place::with(&long_box());
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    let milliseconds = (1e3 * place.summary("whole")["wall_seconds"].as_f64().unwrap()) as u64;
    let (mut killed, mut seed) = ([0, 0], 1u64);
    for _ in 0..times {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let wait = Duration::from_micros((seed >> 33) % (1000 * milliseconds.max(1)));
        let has_checkpoint = place.path("out/checkpoint/a.checkpoint").exists();
        let arguments: &[&str] = if has_checkpoint { &["resume", "out"] } else { &["run", "box.toml"] };
        let mut run = start(&place, arguments);
        std::thread::sleep(wait);
        run.kill().unwrap();
        run.wait().unwrap();
        let has_checkpoint = place.path("out/checkpoint/a.checkpoint").exists();
        killed[usize::from(has_checkpoint)] += 1;
        if has_checkpoint {
            // Valid for any reader: only the last row may be incomplete, and every frame is complete.
            assert!(History::read(&place.path("out/history.csv")).unwrap().n_rows() > 0);
            for frame in frames(&place, "out") {
                let file = frame.split("file=\"").nth(1).unwrap().split('"').next().unwrap();
                assert!(
                    place
                        .read(&format!("out/{}", file.replace("NAME", "out")))
                        .trim_end()
                        .ends_with("</VTKFile>")
                );
            }
        }
        let done = place.path("out/summary.json").exists() && place.summary("out")["status"] == "done";
        if done {
            assert_same_rows(&place, "out", "whole");
            std::fs::remove_dir_all(place.path("out")).unwrap();
        }
    }
    if place.path("out/checkpoint/a.checkpoint").exists() {
        place.succeed(&["resume", "out", "--quiet"]);
    } else {
        place.succeed(&["run", "box.toml", "--quiet"]);
    }
    assert_same_rows(&place, "out", "whole");
    killed
}

#[test]
fn a_killed_run_is_resumed() {
    kill_again_and_again(10);
}

#[test]
#[ignore = "minutes; `.ci/run` and `just validate` run it"]
fn a_run_killed_two_hundred_times_is_resumed() {
    let [early, late] = kill_again_and_again(200);
    println!(
        "killed {early} times before the first checkpoint, {late} times after; every history was that of the whole run"
    );
}

/// A limit of no, one, ... blocks of 512 bytes stops the run at its first files.
#[cfg(unix)]
#[test]
fn a_disk_that_is_full_from_the_start_is_no_bad_input() {
    for format in ["vtu", "vtkhdf"] {
        let place = Place::with(&long_box().replace("[output]", &format!("[output]\nformat = \"{format}\"")));
        for blocks in [0, 1, 4, 5] {
            let script = format!(
                "trap '' XFSZ; ulimit -f {blocks}; exec '{}' run box.toml --quiet --output out-{blocks}",
                env!("CARGO_BIN_EXE_emmy")
            );
            let output =
                Command::new("sh").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(1), "{format} {blocks}: {message}");
            assert!(message.contains("File too large"), "{format} {blocks}: {message}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_disk_that_is_full_leaves_whole_rows() {
    let place = Place::with(&long_box().replace("until = 4.0", "until = 1.0"));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    // To a program that handles its signal, a limit on the size of files is a full disk.
    let script =
        format!("trap '' XFSZ; ulimit -f 100; exec '{}' run box.toml --quiet", env!("CARGO_BIN_EXE_emmy"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the results cannot be written: ") && message.contains("out"), "{message}");
    assert!(place.read("out/history.csv").ends_with('\n'));
    let parts = walk(&place.path("out")).into_iter().filter(|name| name.ends_with(".part"));
    assert_eq!(parts.count(), 0);
    place.succeed(&["resume", "out", "--quiet"]);
    assert_same_rows(&place, "out", "whole");
}

#[cfg(unix)]
fn walk(directory: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let below = |path: std::path::PathBuf| match path.is_dir() {
        true => walk(&path),
        false => vec![path.display().to_string()],
    };
    entries.flat_map(below).collect()
}

/// A soft box with initial velocities so large that cells are inverted at h = 0.5.
const VIOLENT: &str = "mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }\n\
    region = { density = 1.0, material.neo-hooke = { lambda = 10.0, mu = 5.0 } }\n\
    initial = { gradient = [[0.0, 9.0, 0.0], [-3.0, -6.0, 0.0], [0.0, 0.0, 5.0]], about = [0.5, 1.0, 0.5] }\n\
    newton.max_iterations = 8\n\
    [time]\nscheme = \"FE(1)\"\nsteps = [{ until = 4.0, size = 0.5 }]\n";

#[test]
fn a_step_that_fails_is_cut_and_grows_back() {
    let place = Place::with(VIOLENT);
    let outcome = place.succeed(&["run", "box.toml"]);
    assert!(outcome.stderr.contains("step cut to 0.25"), "{}", outcome.stderr);
    let events = place.read("box/events.csv");
    assert!(events.starts_with("step,time,event,message\n"), "{events}");
    assert!(events.contains(",cut,\"step cut to 0.25: step "), "{events}");
    assert!(events.contains(",grown,"), "{events}");
    let cuts = events.lines().filter(|line| line.contains(",cut,")).count();
    assert_eq!(place.summary("box")["cuts"].as_u64(), Some(cuts as u64));
    let times = place.history("box")["time"].clone();
    assert!((0..=8).all(|step| times.contains(&(0.5 * step as f64))), "{times:?}");
    for part in ["step cut to", "linear solver: ", "machine: ", "command: ", "done at step"] {
        assert!(place.read("box/run.log").contains(part), "{part}");
    }
}

#[test]
fn cuts_end_at_the_smallest_step_with_3() {
    let place = Place::with(VIOLENT);
    let flags = [
        "--set",
        "time.smallest_step=0.1",
        "--set",
        "newton.max_iterations=1",
        "--set",
        "newton.tolerance=1e-15",
    ];
    let outcome = place.emmy(&[&["run", "box.toml"][..], &flags].concat());
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    for part in
        ["step 1 from t = 0 failed with every size down to 0.125", "no convergence in step 1", "near ["]
    {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    // The run can be resumed from the last state with other settings.
    place.succeed(&[
        "resume",
        "box",
        "--quiet",
        "--set",
        "newton.max_iterations=20",
        "--set",
        "newton.tolerance=1e-10",
        "--set",
        "time.smallest_step=1e-3",
    ]);
    assert_eq!(place.summary("box")["status"], "done");
}

/// A pulse from a file is a part of the input: its path may change, its rows may not.
#[test]
fn a_run_with_a_measured_load_is_resumed_with_the_same_table() {
    let place = Place::with(&even_box(1.0, 0.05).replace(
        "history = [[0.0, 0.0], [0.5, 1.0]]",
        "history = { file = \"in/pulse.csv\", time = \"t\", value = \"force\", factor = 2 }",
    ));
    place.write("in/pulse.csv", "t,force\n0,0\n0.31,0.7\n0.5,0.5\n");
    let whole =
        even_box(1.0, 0.05).replace("[[0.0, 0.0], [0.5, 1.0]]", "[[0.0, 0.0], [0.31, 1.4], [0.5, 1.0]]");
    place.write("whole.toml", &whole);
    place.succeed(&["run", "whole.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.3"]);
    place.succeed(&["resume", "out", "--quiet", "--until", "0.5"]);
    std::fs::rename(place.path("in"), place.path("moved")).unwrap();
    let outcome = place.emmy(&["resume", "out", "--until", "1"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("in/pulse.csv"), "{}", outcome.stderr);
    let file = format!("load.history.file={}", place.path("moved/pulse.csv").display());
    place.succeed(&["resume", "out", "--quiet", "--until", "0.7", "--set", &file]);
    place.write("moved/pulse.csv", "t,force\n0,0\n0.31,0.8\n0.5,0.5\n");
    let outcome = place.emmy(&["resume", "out", "--until", "1"]);
    assert!(
        outcome.code == 2 && outcome.stderr.contains("the tables had 3 rows, checksum"),
        "{}",
        outcome.stderr
    );
    place.write("moved/pulse.csv", "t,force\n0,0\n0.31,0.7\n0.5,0.5\n");
    place.succeed(&["resume", "out", "--quiet", "--until", "1"]);
    assert_same_rows(&place, "out", "whole");
    let factor = place.emmy(&["resume", "out", "--until", "2", "--set", "load.history.factor=3"]);
    assert!(factor.code == 2 && factor.stderr.contains("`load.0.history.factor` is 3"), "{}", factor.stderr);
}

/// A driven support that follows an acceleration is resumed bit for bit. An expression is integrated on panels of
/// the same size if both ends lie between the same powers of two.
#[test]
fn a_shaken_support_is_resumed() {
    let input = even_box(0.9, 0.05).replace("scheme = \"AS(2)\"", "scheme = \"DGM\"").replace(
        "fix = [\"x\", \"y\", \"z\"]",
        "fix = [\"y\"]\naccelerate = { x = { file = \"quake.csv\", time = \"t\", value = \"a\" }, z = \"sin(9*t)\" }",
    );
    let place = Place::with(&input);
    place.write("quake.csv", "t,a\n0,0\n0.31,0.7\n0.5,-0.5\n0.8,0\n");
    let report = place.succeed(&["check", "box.toml"]).stdout;
    // v = 0.31*0.35 + 0.19*0.1 - 0.3*0.25 = 0.0525.
    for part in [
        "x accelerates: 4 rows from t = 0 to t = 0.8, values from -0.5 to 0.7",
        "integrated: velocity 0.0525, displacement 0.0",
        "z accelerates: sin(9*t)",
    ] {
        assert!(report.contains(part), "{part}\n{report}");
    }
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.6"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.9"]);
    assert_same_rows(&place, "parts", "whole");
}
