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
    assert!(!columns.contains_key("mass.mass") && columns["status"].iter().all(|cell| cell == "done"));
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

/// Endings of the names of a column's last, smallest and largest number.
const PEAK: [&str; 5] = ["", "_min", "_min_time", "_max", "_max_time"];

/// The oscillator with the quantities whose peaks are known.
fn asking(stiffness: f64) -> String {
    OSCILLATOR
        .replace("stiffness = 1.0", &format!("stiffness = {stiffness:?}"))
        .replace("until = 1.0", "until = 0.9")
        .replace("[1, 0, 0] }]", "[1, 0, 0], quantities = [\"displacement\"] }]")
        + "extremes = [\"displacement\"]\nreactions = [\"foot\"]\n"
}

/// Last, smallest and largest number of a column of a history with their times, by sorting.
fn peak_in(history: &BTreeMap<String, Vec<f64>>, name: &str) -> [f64; 5] {
    let pairs = history[name].iter().copied().zip(history["time"].iter().copied());
    let mut sorted: Vec<(f64, f64)> = pairs.filter(|(number, _)| !number.is_nan()).collect();
    sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let (smallest, largest) = (sorted[0], sorted[sorted.len() - 1].0);
    let largest = *sorted.iter().find(|(number, _)| *number == largest).unwrap();
    [*history[name].last().unwrap(), smallest.0, smallest.1, largest.0, largest.1]
}

/// With A = v/omega the deflection is A sin(omega t), and the reaction of the foot, a mean over a step of size h, is
/// -k A (cos(omega (t - h)) - cos(omega t))/(omega h).
#[test]
fn peaks_of_an_oscillator_are_its_amplitude_and_its_largest_force() {
    let place = Place::with(&asking(1.0));
    let omegas = [PI, 2.0 * PI];
    let stiffnesses = omegas.map(|omega| format!("{:?}", omega * omega)).join(",");
    let flag = format!("region.material.spring.stiffness={stiffnesses}");
    let outcome = place.succeed(&["sweep", "box.toml", "--set", &flag, "--keep"]);
    let columns = table(&place, "out-sweep");
    let (speed, h) = (0.1, 0.01);
    for (row, omega) in omegas.into_iter().enumerate() {
        let of = |name: &str| numbers(&columns, name)[row];
        let (amplitude, stiffness) = (speed / omega, omega * omega);
        let quarter = 0.5 * PI / omega;
        close(of("mass_displacement_x"), amplitude * (0.9 * omega).sin(), 1e-10, "last deflection");
        close(of("mass_displacement_x_max"), amplitude, 1e-10, "largest deflection");
        close(of("mass_displacement_x_max_time"), quarter, 1e-12, "time of the largest deflection");
        close(of("max_displacement_max"), amplitude, 1e-10, "largest displacement");
        close(of("max_displacement_max_time"), quarter, 1e-12, "time of the largest displacement");
        // Two steps around a quarter of the period have the same mean.
        let largest_force = stiffness * amplitude * (omega * h).sin() / (omega * h);
        close(of("foot_force_x_min"), -largest_force, 1e-9, "largest reaction");
        close(of("foot_force_x_min_time"), quarter + 0.5 * h, 0.51 * h, "time of the largest reaction");
        // The half period of the first run is beyond the end: only in the empty first cell does its reaction vanish.
        let (smallest, force) = match row {
            0 => (0.0, -stiffness * amplitude * (1.0 - (omega * h).cos()) / (omega * h)),
            _ => (-amplitude, largest_force),
        };
        close(of("mass_displacement_x_min"), smallest, 1e-10, "smallest deflection");
        close(of("foot_force_x_max"), force, 1e-9, "smallest reaction");
        let time = if row == 0 { 0.0 } else { 3.0 * quarter };
        close(of("mass_displacement_x_min_time"), time, 1e-12, "time of the smallest deflection");
        // The kept run.
        let run = format!("out-sweep/runs/{}", row + 1);
        let (history, summary) = (place.history(&run), place.summary(&run));
        assert_eq!((history["time"].len(), summary["status"].as_str()), (91, Some("done")));
        for name in [
            "mass_displacement_x",
            "mass_displacement_y",
            "foot_force_x",
            "foot_moment_z",
            "max_displacement",
        ] {
            for (ending, number) in PEAK.iter().zip(peak_in(&history, name)) {
                let name = format!("{name}{ending}");
                assert_eq!((of(&name), summary[&name].as_f64()), (number, Some(number)), "{name}");
            }
        }
    }
    // The columns that the input asks for, unless they are always 0.
    let head = outcome.stdout.lines().next().unwrap();
    for name in ["mass_displacement_x_max", "foot_force_x", "foot_force_x_min", "max_displacement_max"] {
        assert!(head.split("  ").any(|own| own.trim() == name), "{name}\n{head}");
    }
    assert!(!head.contains("mass_displacement_y") && !head.contains("foot_moment"), "{head}");
    // A new sweep without --keep has no histories of the old one; one on standard output as JSON.
    let flags = ["--set", "initial.velocity.0=0.2", "--quiet", "--json"];
    let outcome = place.succeed(&[&["sweep", "box.toml"], &flags[..]].concat());
    let row: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(
        (row["run"].as_u64(), row["status"].as_str(), row["end_time"].as_f64()),
        (Some(1), Some("done"), Some(0.9))
    );
    close(
        row["mass_displacement_x_max"].as_f64().unwrap(),
        0.2 * 0.9_f64.sin(),
        1e-9,
        "a part of the first quarter",
    );
    assert_eq!(place.names("out-sweep"), [".lock", "sweep.csv", "sweep.toml"]);
}

#[test]
fn peaks_of_a_resumed_run_are_those_of_the_whole_run() {
    let place = Place::with(&asking(4.0 * PI * PI));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.4"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.6"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.9"]);
    let (whole, parts) = (place.summary("whole"), place.summary("parts"));
    // The largest deflection before the first stop, the smallest after the last one.
    for (name, exact) in [("max", 0.05 / PI), ("max_time", 0.25), ("min", -0.05 / PI), ("min_time", 0.75)] {
        close(parts[format!("mass_displacement_x_{name}")].as_f64().unwrap(), exact, 1e-10, name);
    }
    let history = place.history("parts");
    for name in ["mass_displacement_x", "foot_force_x", "foot_moment_z", "max_displacement"] {
        for (ending, number) in PEAK.iter().zip(peak_in(&history, name)) {
            let name = format!("{name}{ending}");
            assert_eq!(
                (parts[&name].as_f64(), whole[&name].as_f64()),
                (Some(number), Some(number)),
                "{name}"
            );
        }
    }
    for name in ["", "_time"] {
        let [peak, largest] = [format!("max_displacement_max{name}"), format!("largest_displacement{name}")];
        assert_eq!(parts[&peak], parts[&largest], "{peak}");
    }
}

#[test]
fn rows_of_two_sweeps_stand_side_by_side() {
    let place = Place::with(&asking(4.0 * PI * PI));
    let sweep = |speeds: &str, mass: &str, output: &str| {
        let flags = [format!("initial.velocity.0={speeds}"), format!("mass.mass={mass}")];
        place.succeed(&[
            "sweep", "box.toml", "--set", &flags[0], "--set", &flags[1], "--output", output, "--keep",
        ]);
    };
    sweep("0.1,0.2", "1.0", "light");
    sweep("0.2,0.1,0.30", "4.0", "heavy");
    let table = place.succeed(&["compare", "light", "heavy"]).stdout;
    let cells = |line: &str| line.split_whitespace().map(String::from).collect::<Vec<_>>();
    let lines: Vec<Vec<String>> = table.lines().map(cells).collect();
    assert_eq!(lines[0][..4], ["initial.velocity.0", "sweep", "run", "status"]);
    let first: Vec<String> = lines[1..6].iter().map(|line| line[..3].join(" ")).collect();
    assert_eq!(first, ["0.1 light 1", "0.1 heavy 2", "0.2 light 2", "0.2 heavy 1", "0.30 heavy 3"]);
    // Four times the mass has four times the energy, half the frequency and twice the amplitude.
    let difference =
        |name: &str| table.lines().find(|line| line.starts_with(&format!("{name} "))).map(cells).unwrap();
    assert_eq!(difference("total energy")[2..], ["75.00", "%"]);
    assert_eq!(difference("mass_displacement_x_max")[1..], ["50.00", "%"]);
    let text = place.read("compare/compare.csv");
    assert!(text.starts_with("sweep,run,initial.velocity.0,status,end_time,"), "{text}");
    assert_eq!(text.lines().count(), 6);
    assert!(place.read("compare/compare.svg").contains("heavy: largest"));
    let lines = place.succeed(&["compare", "light", "heavy", "--json", "--quiet"]).stdout;
    let last: serde_json::Value = serde_json::from_str(lines.lines().last().unwrap()).unwrap();
    assert_eq!((last["sweep"].as_str(), last["initial.velocity.0"].as_str()), (Some("heavy"), Some("0.30")));
    close(last["mass_displacement_x_max"].as_f64().unwrap(), 0.3 / PI, 1e-10, "amplitude");
    // The kept runs, too.
    let runs = place.succeed(&["compare", "light/runs/1", "heavy/runs/2", "--output", "runs"]).stdout;
    assert_eq!(runs.lines().position(str::is_empty), Some(3), "{runs}");
    place.succeed(&["sweep", "box.toml", "--set", "time.degree=1,2", "--output", "degrees", "--quiet"]);
    for (others, part) in [
        (&["light", "light/runs/1"][..], "light holds a sweep, and light/runs/1 does not"),
        (&["light", "degrees"], "other keys: light (initial.velocity.0) and degrees (time.degree)"),
    ] {
        let outcome = place.emmy(&[&["compare"], others].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""));
        assert!(outcome.stderr.contains(part), "{}", outcome.stderr);
    }
}

/// A mass on a spring has the frequency sqrt(k/m)/(2 pi), and all its mass moves.
#[test]
fn a_sweep_of_natural_modes_has_their_frequencies() {
    let input = asking(1.0) + "[[support]]\ngroup = \"mass\"\nfix = [\"y\", \"z\"]\n";
    let place = Place::with(&input);
    let stiffnesses = [1.0, 4.0, 9.0].map(|root| format!("{:?}", (root * PI).powi(2))).join(",");
    let flags =
        ["--set", &format!("region.material.spring.stiffness={stiffnesses}"), "--set", "mass.mass=1.0,4.0"];
    let sweep = [&["sweep", "box.toml", "--modes", "1"], &flags[..]].concat();
    let outcome = place.succeed(&sweep);
    let columns = table(&place, "out-sweep");
    for (row, (root, mass)) in
        [(1.0, 1.0), (1.0, 4.0), (4.0, 1.0), (4.0, 4.0), (9.0, 1.0), (9.0, 4.0)].iter().enumerate()
    {
        close(numbers(&columns, "frequency_1")[row], 0.5 * root / f64::sqrt(*mass), 1e-12, "frequency");
        close(numbers(&columns, "effective_mass_x_1")[row], *mass, 1e-12, "effective mass");
        assert!(numbers(&columns, "residual_1")[row] < 1e-12);
    }
    let head = outcome.stdout.lines().next().unwrap();
    assert!(head.contains("frequency_1") && !head.contains("end time"), "{head}");
    let motions = [&["sweep", "box.toml", "--resume"], &flags[..]].concat();
    let outcome = place.emmy(&motions);
    assert!(
        outcome.code == 2 && outcome.stderr.contains("`--modes 1` there, `no --until` now"),
        "{}",
        outcome.stderr
    );
    rejected(
        &place,
        &["--modes", "2", "--set", "mass.mass=1,2"],
        &["--modes 2: these are more natural modes than the body has, 1", "take at most 1"],
    );
    rejected(
        &place,
        &["--modes", "1", "--keep", "--set", "mass.mass=1,2"],
        &["--keep", "cannot be used with"],
    );
    let table = place.succeed(&["compare", "out-sweep", "--quiet"]).stdout;
    assert!(table.lines().next().unwrap().contains("frequency_1"), "{table}");
}

/// A value of the name of a peak, and lists of values for one run.
#[test]
fn names_of_peaks_are_reserved_and_a_run_takes_one_value() {
    let value = |name: &str| {
        format!("values = [{{ name = \"{name}\", quantity = \"velocity\", measure = \"max\" }}]\n")
    };
    for name in ["foot_force_x_max", "max_displacement_min_time", "mass_displacement_x_min"] {
        let place = Place::with(&(asking(1.0) + &value(name)));
        let outcome = place.emmy(&["check", "box.toml"]);
        let column = name.rsplit_once("_m").unwrap().0;
        let message = format!("`{name}` is also the name of a peak of `{column}` over the run");
        assert!(outcome.code == 2 && outcome.stderr.contains(&message), "{}", outcome.stderr);
    }
    let place = Place::with(&(asking(1.0) + &value("foot_max") + "every = 0\n"));
    place.succeed(&["run", "box.toml", "--quiet"]);
    close(place.summary("out")["foot_max_max"].as_f64().unwrap(), 0.1, 1e-12, "the speed at the start");
    for verb in ["run", "check"] {
        let outcome = place.emmy(&[verb, "box.toml", "--set", "mass.mass=1,2"]);
        assert!(
            outcome.code == 2 && outcome.stderr.contains("`emmy sweep` runs each value"),
            "{}",
            outcome.stderr
        );
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
        // More threads than cores are not used.
        let other = outcome.stderr.lines().find(|line| !line.starts_with("note: --threads "));
        assert_eq!((outcome.code, other), (0, None));
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
    assert!(rows[1].starts_with("2,10,1.0,done,5.0") && rows[1].ends_with(','), "{}", rows[1]);
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
    let asked =
        ["force", "moment"].iter().flat_map(|own| ["x", "y", "z"].map(|axis| format!("y-min_{own}_{axis}")));
    let asked = asked.chain(["mid_x", "mid_y", "mid_z"].map(String::from));
    let columns: String = asked.flat_map(|own| PEAK.map(|ending| format!(",{own}{ending}"))).collect();
    assert!(rows[0].ends_with(&format!(",wall_seconds{columns},message")), "{}", rows[0]);
    assert!(rows[1].starts_with("1,[],done,") && rows[1].ends_with(&",".repeat(16)), "{}", rows[1]);
    let cell = r#"2,"[{ name = ""mid"", point = [0, 1, 0] }]",done,"#;
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
    place.write("out-sweep/sweep.csv", &format!("{complete}17,9,1,do"));
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
    let longer = [&flags[..], &resume, &["--until", "0.75"]].concat();
    rejected(&place, &longer, &["has another input: `no --until` there, `--until 0.75` now"]);
    let other = ["--set", "region.density=1,3"];
    rejected(
        &place,
        &[&other[..], &resume].concat(),
        &["has another input", "`--set region.density=1,2` there"],
    );
    place.write("box.toml", &BOX.replace("mu = 500.0", "mu = 501.0"));
    rejected(
        &place,
        &[&flags[..], &resume].concat(),
        &["has another input: `material = ", "mu = 500.0 } }` there", "mu = 501.0 } }` now"],
    );
    assert_eq!(place.read("out-sweep/sweep.csv"), text);
    place.write("box.toml", BOX);
    for (from, to, message) in [
        ("\n2,2,", "\n2,1,", "sweep.csv:3: this is no row of the sweep"),
        ("\n2,2,", "\n1,1,", "sweep.csv:3: the run is there twice"),
        ("done", "completed", "sweep.csv:2: this is no row of the sweep"),
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
