//! `emmy modes`: table, files, rejected requests; periods in `emmy check`.

use super::{BOX, Place};

/// A bar without Poisson's effect, held sideways: its axial modes are 0 and n pi c / L, c = 5, L = 6, times
/// 1 + (k h)^2/24 with linear cells.
const BAR: &str = r#"
mesh.box = { size = [6, 1, 1], cells = [24, 1, 1] }
time = { scheme = "DGM", steps = [{ until = 1, size = 0.1 }] }

[[region]]
density = 2.0
material.neo-hooke = { youngs_modulus = 50.0, poissons_ratio = 0.0 }

[[support]]
group = "y-min"
fix = ["y", "z"]

[[support]]
group = "y-max"
fix = ["y", "z"]
"#;

/// Columns of `modes.csv` and its rows.
fn rows(place: &Place, directory: &str) -> Vec<Vec<f64>> {
    let text = place.read(&format!("{directory}/modes.csv"));
    let (head, rows) = text.split_once('\n').unwrap();
    let columns =
        "mode,angular_frequency,frequency,period,effective_mass_x,effective_mass_y,effective_mass_z";
    assert_eq!(head, columns);
    rows.lines().map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn modes_of_a_bar_are_printed_and_written() {
    let place = Place::with(BAR);
    let outcome = place.succeed(&["modes", "box.toml", "--count", "4", "--output", "own"]);
    let lines: Vec<&str> = outcome.stdout.lines().collect();
    assert!(lines[0].starts_with("mode") && lines[1].contains("rigid") && lines[1].contains("100.0 %"));
    assert!(lines[5].starts_with("sum") && lines.len() == 6, "{}", outcome.stdout);
    assert!(outcome.stderr.contains("1 rigid mode"), "{}", outcome.stderr);
    let rows = rows(&place, "own");
    assert_eq!(rows[0][..4], [1.0, 0.0, 0.0, f64::INFINITY]);
    assert!((rows[0][4] - 12.0).abs() < 1e-9);
    for (n, row) in rows.iter().enumerate().skip(1) {
        let wave = n as f64 * std::f64::consts::PI / 6.0;
        let expected = 5.0 * wave * (1.0 + (wave * 0.25).powi(2) / 24.0);
        assert!((row[1] / expected - 1.0).abs() < 1e-4, "{row:?} {expected}");
        assert!(
            (row[2] * row[3] - 1.0).abs() < 1e-14 && (row[1] / row[2] - std::f64::consts::TAU).abs() < 1e-14
        );
    }
    assert_eq!(place.names("own"), [".lock", "frames", "modes.csv", "modes.toml", "own.pvd", "report.html"]);
    assert_eq!(place.names("own/frames").len(), 5);
    // Fewer modes replace these, other files stay.
    place.write("own/mine.txt", "");
    place.succeed(&["modes", "own/modes.toml", "--count", "2", "--output", "own", "--quiet"]);
    assert_eq!(place.names("own/frames"), ["own_000000.vtu", "own_000001.vtu", "own_000002.vtu"]);
    assert!(place.names("own").contains(&"mine.txt".to_string()));
    // A frame is a mesh with all groups.
    let input = BAR.replacen(
        "mesh.box = { size = [6, 1, 1], cells = [24, 1, 1] }",
        "mesh.file = \"own/frames/own_000001.vtu\"",
        1,
    );
    place.write("again.toml", &input);
    place.succeed(&["modes", "again.toml", "--count", "3"]);
    assert_eq!(place.names("again-modes/frames").len(), 4);
    let outcome = place.emmy(&["modes", "again.toml", "--output", "own"]);
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("own_000001.vtu"), "{}", outcome.stderr);
}

#[test]
fn modes_are_in_one_file_if_frames_are() {
    let place = Place::with(BAR);
    let flags = ["--set", "output.format=vtkhdf", "--count", "2", "--output", "own", "--quiet"];
    let outcome = place.succeed(&[&["modes", "box.toml"][..], &flags].concat());
    assert_eq!(outcome.stderr, "");
    assert_eq!(place.names("own"), [".lock", "modes.csv", "modes.toml", "own.vtkhdf", "report.html"]);
}

#[test]
fn impossible_requests_for_modes_change_nothing() {
    let place = Place::with(BOX);
    place.write("taken/mine.txt", "");
    for (flags, part) in [
        (&["--count", "25"][..], "25 modes were requested, but the body has only 24"),
        (&["--count", "0"], "0 is not in 1.."),
        (&["--count", "many"], "invalid value 'many'"),
        (&["--output", "taken"], "no natural modes of Emmy (there is mine.txt"),
        (&["--output", "box.toml"], "is not a directory"),
        (&["--set", "region.0.density=0"], "density"),
    ] {
        let outcome = place.emmy(&[&["modes", "box.toml"], flags].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{flags:?}\n{}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    assert_eq!(place.names("."), ["box.toml", "taken"]);
    // Without --count, there are as many as a small body has.
    let held = "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\nregion = { density = 1, material.neo-hooke = { lambda = 1, mu = 1 } }\n\
                support = [{ group = \"x-min\", fix = [\"x\", \"y\", \"z\"] }, { group = \"x-max\", fix = [\"y\", \"z\"] }]\n\
                time = { scheme = \"DGM\", steps = [{ until = 1, size = 0.1 }] }\n";
    place.write("small.toml", held);
    assert_eq!(place.succeed(&["modes", "small.toml"]).stdout.lines().count(), 2 + 4);
}

/// The numbers of the book: the tone of the fork is 11 % below that of a clamped tine,
/// 1.875^2/(2 pi) sqrt(E/(12 rho)) t/L^2 = 1105 Hz, and the handle does not feel it.
#[test]
fn a_tuning_fork_sounds_a_little_below_its_tine() {
    let place = Place::new();
    let file = format!("{}/../../examples/tuning-fork.toml", env!("CARGO_MANIFEST_DIR"));
    place.succeed(&["modes", &file, "--count", "4", "--output", "own", "--quiet"]);
    let rows = rows(&place, "own");
    let tine = 1.875_104f64.powi(2) / std::f64::consts::TAU * (2.1e5 / (12.0 * 7.85e-9f64)).sqrt() * 4.0
        / 55.0f64.powi(2);
    assert!((tine - 1105.0).abs() < 0.5 && (rows[3][2] / tine - 0.891).abs() < 1e-3, "{tine}, {:?}", rows[3]);
    let total = 7.85e-9 * 2600.0;
    assert!(rows[2][4..].iter().chain(&rows[3][4..]).all(|mass| *mass < 1e-3 * total));
    assert!((rows[3][3] / 1e-5 - 102.0).abs() < 0.5);
    let report = place.succeed(&["check", &file]).stdout;
    assert!(report.contains("280 steps a period"), "{report}");
}

/// The critical step of an explicit scheme does not matter here.
#[test]
fn any_plan_will_do_for_modes() {
    let place = Place::with(BAR);
    let flags = ["--set", "time.scheme=central-differences"];
    assert_eq!(place.emmy(&[&["check", "box.toml"][..], &flags].concat()).code, 2);
    place.succeed(&[&["modes", "box.toml"][..], &flags].concat());
}

/// The lowest period of the bar is 2.4/(1 + (k h)^2/24), k h = 0.25 pi/6. With lumped masses omega_max = 2 c/h, so that
/// the critical step is h/c = 0.05.
#[test]
fn check_reports_the_lowest_period() {
    let place = Place::with(BAR);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    for part in [
        "period     2.39829",
        "in the lowest elastic mode (frequency 0.416964",
        "beside 1 rigid mode",
        "a step of 0.1 is 0.042 of this period",
        "24 steps a period",
        "`size = 0.041` makes 58 steps a period",
        "critical step of central differences 0.05000",
    ] {
        assert!(report.contains(part), "{part}\n{report}");
    }
    let report = place.succeed(&["check", "box.toml", "--set", "time.degree=2"]).stdout;
    assert!(report.contains("`size = 0.29` makes 8 steps a period"), "{report}");
    let report = place.succeed(&["check", "box.toml", "--set", "mesh.box.cells=[3000, 2, 2]"]).stdout;
    assert!(report.contains("not computed beyond 30000 degrees of freedom"), "{report}");
    assert!(report.contains("critical step of central differences 0.0"), "{report}");
}
