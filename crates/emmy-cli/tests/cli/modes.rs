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
        "mode,angular_frequency,frequency,period,effective_mass_x,effective_mass_y,effective_mass_z,residual";
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
    assert!(rows.iter().all(|row| row[7] >= 0.0 && row[7] < 1e-6), "{rows:?}");
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
    assert!(rows[2][4..7].iter().chain(&rows[3][4..7]).all(|mass| *mass < 1e-3 * total));
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
    // From the cells alone: h/c.
    assert!(report.contains("critical step of central differences at least 0.0004\n"), "{report}");
}

/// A bar of steel, clamped at both ends; it starts from the bar that `pull` has stretched with 10 kN.
fn string(start: &str) -> String {
    format!(
        r#"
mesh.box = {{ size = [1, 0.01, 0.01], cells = [24, 1, 1] }}
initial.state = "{start}"
time = {{ scheme = "DGM", degree = 2, steps = [{{ until = 0.1, size = 0.0005 }}] }}

[[region]]
density = 7850
material.saint-venant-kirchhoff = {{ youngs_modulus = 2e11, poissons_ratio = 0 }}
formulation = "incompatible-modes"

[[support]]
group = "x-min"
fix = ["x", "y", "z"]

[[support]]
group = "x-max"
fix = ["x", "y", "z"]
"#
    )
}

/// Lowest frequency of a clamped beam of length 1 with the bending stiffness B, the mass m per length and the tension T
/// (Euler and Bernoulli): `2 a b (1 - cos a cosh b) + (b^2 - a^2) sin a sinh b = 0`, with `b^2, a^2 = (s +- T)/(2 B)`
/// and `s^2 = T^2 + 4 B m omega^2`.
fn clamped_beam(stiffness: f64, mass: f64, tension: f64) -> f64 {
    let rest = |omega: f64| {
        let s = (tension * tension + 4.0 * stiffness * mass * omega * omega).sqrt();
        let [a, b] = [s - tension, s + tension].map(|sum| (sum / (2.0 * stiffness)).sqrt());
        2.0 * a * b * (1.0 - a.cos() * b.cosh()) + (b * b - a * a) * a.sin() * b.sinh()
    };
    let (mut low, mut high) = (200.0, 800.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if rest(low) * rest(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low / std::f64::consts::TAU
}

/// The last state of another run counts in the modes, and in the period and the step size of `check`. 24 cells take the
/// frequency 0.5 % too high, with and without tension.
#[test]
fn modes_are_about_the_state_of_another_run() {
    let [free, pulled] = [1e-3, 1e4].map(|tension| clamped_beam(2e11 * 1e-8 / 12.0, 7850.0 * 1e-4, tension));
    assert!((free - 51.88).abs() < 0.005 && (pulled - 80.93).abs() < 0.005, "{free} {pulled}");
    let place = Place::with(&string("pull"));
    let ends = "fix = [\"x\", \"y\", \"z\"]\n";
    let pull = string("pull").replace("initial.state = \"pull\"\n", "").replace(
        "time = { scheme = \"DGM\", degree = 2, steps = [{ until = 0.1, size = 0.0005 }] }",
        "equilibrium.load_steps = 2",
    );
    let last = pull.rfind(ends).unwrap();
    let load = "fix = [\"y\", \"z\"]\n\n[[load]]\ngroup = \"x-max\"\nforce = [10000, 0, 0]\n";
    place.write("pull.toml", &format!("{}{load}", &pull[..last]));
    place.succeed(&["run", "pull.toml", "--output", "pull", "--quiet"]);
    let outcome = place.succeed(&["modes", "box.toml", "--count", "2", "--output", "own"]);
    assert!(outcome.stderr.contains("about the last state of the run in pull"), "{}", outcome.stderr);
    assert!(!outcome.stderr.contains("no equilibrium"), "{}", outcome.stderr);
    for row in rows(&place, "own") {
        assert!((row[2] / pulled - 1.0).abs() < 0.006, "{} is not {pulled}", row[2]);
    }
    let period = rows(&place, "own")[0][3];
    let report = place.succeed(&["check", "box.toml"]).stdout;
    let line = report.lines().find(|line| line.starts_with("period")).unwrap();
    let printed: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((printed / period - 1.0).abs() < 1e-5, "{report}");
    assert!(report.contains("about the state of that run") && report.contains("`size = 0.0015`"), "{report}");
    // A state that moves, under a load that it does not balance.
    let load = "\n[[load]]\ngroup = \"body\"\nbody_force = [0, 0, 1e5]\n";
    place.write("loaded.toml", &(string("pull") + load));
    let outcome = place.succeed(&["modes", "loaded.toml", "--count", "1"]);
    assert!(outcome.stderr.contains("are not balanced under the loads at t = 0"), "{}", outcome.stderr);
    let few = ["--set", "time.steps=[{ until = 0.002, size = 0.0005 }]", "--quiet"];
    place.succeed(&[&["run", "loaded.toml", "--output", "moving"][..], &few].concat());
    place.write("later.toml", &string("moving"));
    let outcome = place.succeed(&["modes", "later.toml", "--count", "1"]);
    assert!(outcome.stderr.contains("it moves, with velocities of up to"), "{}", outcome.stderr);
    // The reference configuration has no tension.
    let rest = string("pull").replace("initial.state = \"pull\"\n", "");
    place.write("rest.toml", &rest);
    place.succeed(&["modes", "rest.toml", "--count", "1", "--output", "rest"]);
    assert!((rows(&place, "rest")[0][2] / free - 1.0).abs() < 0.006);
}

/// The period of `check` is about the equilibrium of the start: `sqrt(0.625)` of the frequency of a bar that is pulled
/// to twice its length, `P = mu (l - 1/l)` (`modes_are_about_the_equilibrium`). Larger bodies say that it is not
/// counted.
#[test]
fn check_reports_the_period_about_the_equilibrium() {
    let place = Place::with(&BAR.replacen("\n\n[[region]]", "\nequilibrium.load_steps = 4\n\n[[region]]", 1));
    place.write("rest.toml", BAR);
    let ends = "\n[[support]]\ngroup = \"x-min\"\nfix = [\"x\"]\n\n[[load]]\ngroup = \"x-max\"\ntraction = [37.5, 0, 0]\n";
    for name in ["box.toml", "rest.toml"] {
        let text = place.read(name);
        place.write(name, &(text + ends));
    }
    let period = |flags: &[&str]| {
        let report = place.succeed(&[&["check"], flags].concat()).stdout;
        let line = report.lines().find(|line| line.starts_with("period")).unwrap().to_string();
        (line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap(), report)
    };
    let (rest, _) = period(&["rest.toml"]);
    let (pulled, report) = period(&["box.toml"]);
    assert!((rest / pulled / 0.625f64.sqrt() - 1.0).abs() < 1e-5, "{rest} {pulled}");
    assert!(report.contains("about the equilibrium"), "{report}");
    let (same, report) = period(&["box.toml", "--set", "equilibrium.load_steps=1000"]);
    assert!(same == rest && report.contains("about the undeformed body: `emmy modes` has"), "{report}");
}

/// Two masses on a spring: omega^2 = k (1/m_1 + 1/m_2), and five modes without force.
#[test]
fn check_finds_the_period_of_two_masses_on_a_spring() {
    let place = Place::with(
        r#"
time = { scheme = "DGM", steps = [{ until = 1, size = 0.1 }] }
mesh.network = { points = [[0, 0, 0], [1, 2, 0.5]], links = [[0, 1]], groups = { a = [0], b = [1] } }
region = { material.spring = { stiffness = 12 } }
mass = [{ group = "a", mass = 2 }, { group = "b", mass = 3 }]
"#,
    );
    let report = place.succeed(&["check", "box.toml"]).stdout;
    // 2 pi / sqrt(10).
    assert!(report.contains("period     1.98692 in the lowest elastic mode"), "{report}");
    assert!(report.contains("beside 5 rigid modes"), "{report}");
}

/// A sheet whose thickness is 0.0003 of its length: `omega^2` of its cells is `12 c^2/t^2` and more, that of its lowest
/// mode about `14 c^2 t^2/(12 L^4)`, `10^15` times less. No digit of it is left beside rounding.
#[test]
fn modes_without_digits_are_a_failure() {
    let sheet =
        BAR.replace("size = [6, 1, 1], cells = [24, 1, 1]", "size = [1, 1, 0.0003], cells = [10, 10, 1]");
    let place = Place::with(&sheet[..sheet.find("[[support]]").unwrap()]);
    let outcome = place.emmy(&["modes", "box.toml", "--count", "7", "--output", "own"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (3, ""), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("the largest relative residual is"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("nothing was written"), "{}", outcome.stderr);
    assert_eq!(place.names("."), ["box.toml"]);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    assert!(report.contains("period     not found: the search for 7 natural modes"), "{report}");
}
