//! `emmy sweep`: numbers from theory, the same bits as `emmy run`, failures, interruptions, mistakes.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::process::{Child, Command};
use std::time::Duration;

use super::resume::start;
use super::{BOX, Outcome, Place};

/// A mass of 1 on a spring along x, whose other end is fixed.
const OSCILLATOR: &str = r#"
[mesh.network]
points = [[0, 0, 0], [1, 0, 0]]
links = [[0, 1]]
groups = { foot = [0], mass = [1] }

[[mass]]
group = "mass"
mass = 1.0

[[region]]
material.spring = { stiffness = 1.0 }

[[support]]
group = "foot"
fix = ["x", "y", "z"]

[[initial]]
group = "mass"
velocity = [0.1, 0, 0]

[time]
scheme = "DGM"
degree = 3
steps = [{ until = 1.0, size = 0.01 }]

[newton]
tolerance = 1e-13

[output]
directory = "out"
probes = [{ name = "mass", point = [1, 0, 0] }]
"#;

/// Columns of `sweep.csv`; no cell has a comma.
fn table(place: &Place, directory: &str) -> BTreeMap<String, Vec<String>> {
    let text = place.read(&format!("{directory}/sweep.csv"));
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let mut columns: BTreeMap<String, Vec<String>> =
        names.iter().map(|name| (name.to_string(), vec![])).collect();
    assert_eq!(columns.len(), names.len(), "{names:?}");
    for line in lines {
        assert_eq!(line.len(), names.len(), "{line:?}");
        names
            .iter()
            .zip(line)
            .for_each(|(name, cell)| columns.get_mut(*name).unwrap().push(cell.to_string()));
    }
    columns
}

fn numbers(columns: &BTreeMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    columns[name].iter().map(|cell| cell.parse().unwrap_or_else(|_| panic!("{name}: {cell:?}"))).collect()
}

/// The lines without the wall time, which differs from run to run.
fn lines(place: &Place, directory: &str) -> Vec<String> {
    let mut columns = table(place, directory);
    columns.remove("wall_seconds").unwrap();
    let n = columns["run"].len();
    (0..n).map(|row| columns.values().map(|cells| &cells[row][..]).collect::<Vec<_>>().join(",")).collect()
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} instead of {expected}");
}

/// x = 1 + v/omega sin(omega t) with omega^2 = k/m, for whole and quarter periods.
#[test]
fn an_oscillator_is_where_theory_puts_it_for_every_stiffness_and_velocity() {
    let place = Place::with(OSCILLATOR);
    let omegas = [0.5 * PI, PI, 2.0 * PI, 4.0 * PI];
    let speeds = [0.1, -0.3];
    let stiffnesses = omegas.map(|omega| format!("{:?}", omega * omega)).join(",");
    let flags =
        [format!("region.material.spring.stiffness={stiffnesses}"), "initial.velocity.0=0.1,-0.3".into()];
    let arguments = ["sweep", "box.toml", "--set", &flags[0], "--set", &flags[1], "--set", "mass.mass=1.0"];
    let outcome = place.succeed(&arguments);
    assert_eq!(outcome.stdout.lines().count(), 9, "{}", outcome.stdout);
    assert!(outcome.stderr.contains("run 8 of 8"), "{}", outcome.stderr);
    assert_eq!(place.names("out-sweep"), [".lock", "sweep.csv", "sweep.toml"]);
    let columns = table(&place, "out-sweep");
    assert_eq!(columns["run"], ["1", "2", "3", "4", "5", "6", "7", "8"]);
    assert_eq!(columns["initial.velocity.0"], ["0.1", "-0.3"].repeat(4));
    assert!(!columns.contains_key("mass.mass") && columns["status"].iter().all(|cell| cell == "completed"));
    let of = |name: &str| numbers(&columns, name);
    let runs = omegas.iter().flat_map(|omega| speeds.map(|speed| (*omega, speed)));
    for (row, (omega, speed)) in runs.enumerate() {
        let what = format!("omega {omega}, v {speed}");
        close(of("mass_x")[row], 1.0 + speed / omega * omega.sin(), 1e-9, &what);
        close(of("linear_momentum_x")[row], speed * omega.cos(), 1e-8, &what);
        close(of("kinetic_energy")[row], 0.5 * (speed * omega.cos()).powi(2), 1e-8, &what);
        close(of("total_energy")[row], 0.5 * speed * speed, 1e-14, &what);
        assert_eq!((of("end_time")[row], of("steps")[row]), (1.0, 100.0));
        assert!(of("newton_iterations_per_step")[row] >= 1.0 && of("energy_drift")[row] < 1e-12);
    }
}

/// 2 x 3 runs of a box with a load, supports, reactions and a probe.
const SWEPT: [&str; 6] =
    ["--set", "time.scheme=DGM,Bathe", "--set", "region.density=2.0,1,4", "--set", "limits="];

fn sweep(place: &Place, arguments: &[&str]) -> Outcome {
    place.emmy(&[&["sweep", "box.toml"], arguments].concat())
}

#[test]
fn a_row_has_the_bits_of_a_run_for_any_number_of_threads() {
    let place = Place::with(BOX);
    for threads in ["1", "2", "5"] {
        let more = ["--threads", threads, "--output", threads, "--quiet"];
        let outcome = sweep(&place, &[&SWEPT[..], &more].concat());
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    }
    assert_eq!(lines(&place, "1"), lines(&place, "2"));
    assert_eq!(lines(&place, "1"), lines(&place, "5"));
    let columns = table(&place, "2");
    // The fourth run.
    place.succeed(&["run", "box.toml", "--set", "time.scheme=Bathe", "--set", "limits=", "--quiet"]);
    let mut n_compared = 0;
    for (name, numbers) in place.history("out").iter().filter(|(name, _)| *name != "wall_seconds") {
        if let Some(cells) = columns.get(name) {
            assert_eq!(cells[3].parse(), Ok(*numbers.last().unwrap()), "{name}");
            n_compared += 1;
        }
    }
    // Five energies with the work, two momenta, a probe, forces and moments of the reaction.
    assert_eq!(n_compared, 4 + 6 + 3 + 6);
    let summary = place.summary("out");
    for name in ["steps", "worst_energy_residual", "energy_drift", "angular_momentum_drift", "digits_left"] {
        assert_eq!(columns[name][3].parse(), Ok(summary[name].as_f64().unwrap()), "{name}");
    }
}

#[test]
fn a_run_that_fails_is_a_row_with_its_message_and_the_others_go_on() {
    let place = Place::with(&BOX.replace("energy = 1e-2", "energy = 1.0"));
    // Forces that invert a cell, and a limit that is exceeded.
    let flags = ["--set", "load.traction.2=10,1e9", "--set", "limits.energy=1e-17,1.0", "--quiet"];
    let outcome = sweep(&place, &flags);
    assert_eq!(outcome.code, 3, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("3 of 4 runs failed"), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("run 1 (load.traction.2=10, limits.energy=1e-17): "),
        "{}",
        outcome.stderr
    );
    let text = place.read("out-sweep/sweep.csv");
    let rows: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(rows.len(), 4);
    assert!(
        rows[0].starts_with("1,10,1e-17,failed,1.0") && rows[0].contains("the limit is 1e-17"),
        "{}",
        rows[0]
    );
    assert!(rows[1].starts_with("2,10,1.0,completed,5.0") && rows[1].ends_with(','), "{}", rows[1]);
    assert!(
        rows[3].starts_with("4,1e9,1.0,failed,") && rows[3].contains("is turned inside out"),
        "{}",
        rows[3]
    );
    // A failed run stays as it is.
    let resumed = sweep(&place, &[&flags[..], &["--resume"]].concat());
    assert_eq!((resumed.code, place.read("out-sweep/sweep.csv")), (3, text));
}

#[test]
fn columns_are_those_of_all_runs_and_lists_stay_whole() {
    let place = Place::with(BOX);
    let probe = "output.probes=[],[{ name = \"mid\", point = [0, 1, 0] }]";
    let outcome = sweep(&place, &["--set", probe, "--set", "initial.velocity=[0, 0, 0]"]);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let text = place.read("out-sweep/sweep.csv");
    let rows: Vec<&str> = text.lines().collect();
    assert!(rows[0].ends_with(",wall_seconds,y-min_force_x,y-min_force_y,y-min_force_z,y-min_moment_x,y-min_moment_y,y-min_moment_z,mid_x,mid_y,mid_z,message"), "{}", rows[0]);
    assert!(rows[1].starts_with("1,[],completed,") && rows[1].ends_with(",,,,"), "{}", rows[1]);
    let cell = r#"2,"[{ name = ""mid"", point = [0, 1, 0] }]",completed,"#;
    assert!(rows[2].starts_with(cell) && !rows[2].ends_with(",,"), "{}", rows[2]);
}

/// Forty runs, of some hundredths of a second each.
const MANY: [&str; 6] = [
    "--set",
    "region.density=1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20",
    "--set",
    "time.degree=1,2",
    "--set",
    "time.steps=[{ until = 0.5, size = 0.002 }]",
];

/// Starts a sweep, and returns once it has some rows.
fn started(place: &Place, n_rows: usize) -> Child {
    let sweep = start(place, &[&["sweep", "box.toml", "--threads", "2"], &MANY[..]].concat());
    let n_lines = || {
        let text = std::fs::read_to_string(place.path("out-sweep/sweep.csv")).unwrap_or_default();
        text.lines().count()
    };
    for _ in 0..6000 {
        if n_lines() > n_rows {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    sweep
}

fn even_box() -> Place {
    Place::with(&BOX.replace("AS(2)", "DGM").replace("energy = 1e-2", "energy = 1.0"))
}

#[test]
fn a_killed_sweep_is_resumed_with_the_missing_runs() {
    let place = even_box();
    let whole = sweep(&place, &[&MANY[..], &["--output", "whole", "--quiet"]].concat());
    assert_eq!(whole.code, 0, "{}", whole.stderr);
    let mut run = started(&place, 4);
    let busy = sweep(&place, &[&MANY[..], &["--resume"]].concat());
    assert!(busy.code == 2 && busy.stderr.contains("another run of Emmy is writing"), "{}", busy.stderr);
    run.kill().unwrap();
    run.wait().unwrap();
    // As if the kill had come inside a row.
    let text = place.read("out-sweep/sweep.csv");
    let complete = &text[..=text.rfind('\n').unwrap()];
    place.write("out-sweep/sweep.csv", &format!("{complete}17,9,1,comp"));
    let before: Vec<&str> = complete.lines().skip(1).collect();
    assert!(before.len() >= 4 && before.len() < 40, "{}", before.len());
    let resumed = sweep(&place, &[&MANY[..], &["--resume", "--threads", "1"]].concat());
    assert_eq!(resumed.code, 0, "{}", resumed.stderr);
    assert!(resumed.stderr.contains(&format!("resuming: {} of 40 runs have a row", before.len())));
    assert!(resumed.stdout.ends_with("... and 21 more runs in sweep.csv\n"), "{}", resumed.stdout);
    assert_eq!(lines(&place, "out-sweep"), lines(&place, "whole"));
    // With their wall times: they were not run again.
    let text = place.read("out-sweep/sweep.csv");
    before.iter().for_each(|row| assert!(text.lines().any(|line| line == *row), "{row}"));
}

#[test]
fn a_signal_ends_a_sweep_with_the_rows_of_the_finished_runs() {
    let place = even_box();
    let mut run = started(&place, 2);
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    assert_eq!(run.wait().unwrap().code(), Some(130));
    let n_rows = lines(&place, "out-sweep").len();
    assert!((2..40).contains(&n_rows), "{n_rows}");
    let resumed = sweep(&place, &[&MANY[..], &["--resume", "--quiet"]].concat());
    assert_eq!((resumed.code, resumed.stderr.as_str()), (0, ""));
    assert_eq!(lines(&place, "out-sweep").len(), 40);
}

/// A sweep that must be rejected with some parts of a message.
fn rejected(place: &Place, flags: &[&str], parts: &[&str]) {
    let outcome = sweep(place, flags);
    assert_eq!(outcome.code, 2, "{flags:?}: {}{}", outcome.stdout, outcome.stderr);
    parts
        .iter()
        .for_each(|part| assert!(outcome.stderr.contains(part), "{flags:?}: {part}\n{}", outcome.stderr));
}

#[test]
fn another_sweep_is_not_resumed() {
    let place = Place::with(BOX);
    let flags = ["--set", "region.density=1,2", "--quiet"];
    rejected(&place, &[&flags[..], &["--resume"]].concat(), &["out-sweep holds no sweep to resume"]);
    assert!(!place.path("out-sweep").exists());
    assert_eq!(sweep(&place, &flags).code, 0);
    let text = place.read("out-sweep/sweep.csv");
    let resume = ["--resume", "--output", "out-sweep"];
    let other = ["--set", "region.density=1,3"];
    rejected(
        &place,
        &[&other[..], &resume].concat(),
        &["has another input", "`--set region.density=1,2` there"],
    );
    place.write("box.toml", &BOX.replace("mu = 500.0", "mu = 501.0"));
    rejected(&place, &[&flags[..], &resume].concat(), &["has another input: `data of all runs"]);
    assert_eq!(place.read("out-sweep/sweep.csv"), text);
    place.write("box.toml", BOX);
    for (from, to, message) in [
        ("\n2,2,", "\n2,1,", "sweep.csv:3: this is no row of the sweep"),
        ("\n2,2,", "\n1,1,", "sweep.csv:3: the run is there twice"),
        ("completed", "done", "sweep.csv:2: this is no row of the sweep"),
        ("steps", "step", "sweep.csv:1: the table has other columns"),
    ] {
        let changed = text.replacen(from, to, 1);
        place.write("out-sweep/sweep.csv", &changed);
        rejected(&place, &[&flags[..], &resume].concat(), &[message]);
        assert_eq!(place.read("out-sweep/sweep.csv"), changed);
    }
}

#[test]
fn mistakes_in_any_combination_are_found_before_the_first_run() {
    let place = Place::with(BOX);
    let density = ["--set", "region.density=1,-2,0,4"];
    let parts = [
        "run 3 (region.density=-2, time.degree=1): `density` must be positive, not -2",
        "run 5 (region.density=0, time.degree=1): `density` must be positive, not 0",
        "region.density=-2",
        "2 faults in the input; nothing was run or written",
    ];
    rejected(
        &place,
        &[&density[..], &["--set", "time.degree=1,2", "--set", "time.scheme=DGM"]].concat(),
        &parts,
    );
    // A mistake of every combination is shown once, without one.
    let outcome = sweep(&place, &["--set", "region.densty=1,2,3", "--set", "time.degree=1,2"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("× unknown key `densty`"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("did you mean `density`?"), "{}", outcome.stderr);
    assert_eq!(outcome.stderr.matches("densty`").count(), 1, "{}", outcome.stderr);
    for (flags, parts) in [
        (&["--set", "time.degree=1,,2"][..], &["a value is empty", "values stand between commas"][..]),
        (&["--set", "region.density"], &["there is no `=`"]),
        (&["--set", "time.scheme=DGM,DMG"], &["run 2 (time.scheme=DMG): ", "did you mean \"DGM\"?"]),
        (&["--set", "time.degree=1,2", "--set", "time.degree=3"], &["a swept key is given twice"]),
        (
            &["--set", "region.density=1,2", "--set", "region.0.density=3,4"],
            &["run 1 (region.density=1, region.0.density=3) and run 3", "have the same input"],
        ),
        (&["--set", "output.directory=a,b"], &["`output.directory` cannot be swept"]),
        (
            &["--set", "time.scheme=DGM,central-differences"],
            &["run 2 (time.scheme=central-differences): `time.steps`: steps of 0.1 are unstable"],
        ),
        (&["--set", "initial=[],[{ state = 'none' }]"], &["run 2", "`initial.state`"]),
        (&["--set", "load.traction=[0,0,1,[0,0,2]"], &["not valid TOML"]),
    ] {
        rejected(&place, flags, parts);
    }
    let many = vec!["1,2,3,4,5,6,7,8,9,10"; 7];
    let keys = ["a", "b", "c", "d", "e", "f", "g"];
    let flags: Vec<String> = keys.iter().zip(many).map(|(key, values)| format!("{key}={values}")).collect();
    let flags: Vec<&str> = flags.iter().flat_map(|flag| ["--set", flag]).collect();
    rejected(&place, &flags, &["10 x 10 x 10 x 10 x 10 x 10 x 10 combinations are too many"]);
    assert_eq!(place.names("."), ["box.toml"]);
    place.write("out-sweep/notes.txt", "mine");
    rejected(&place, &["--set", "time.degree=1"], &["no sweep of Emmy"]);
    assert_eq!(place.names("out-sweep"), ["notes.txt"]);
}
