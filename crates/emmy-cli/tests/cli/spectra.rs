//! `emmy spectrum` and `emmy response`: tables, files, rejected requests.

use std::f64::consts::TAU;

use super::{BOX, Place};

/// A run `own` whose probe moves as given: rows of time, `tip_x` and `tip_y`.
fn run_with(rows: &[[f64; 3]]) -> Place {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--until", "0.1", "--quiet"]);
    let head = place.read("out/history.csv").lines().next().unwrap().to_string();
    let row = |[time, x, y]: &[f64; 3]| {
        let cell = |name: &str| match name {
            "time" => time.to_string(),
            "tip_x" => x.to_string(),
            "tip_y" => y.to_string(),
            _ => "0".to_string(),
        };
        head.split(',').map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    place.write("own/history.csv", &(format!("{head}\n") + &rows.iter().map(row).collect::<String>()));
    place
}

/// A sine of amplitude 3 and frequency 5, and twice the sine a quarter of a period later.
fn waves(steps: impl Iterator<Item = f64>) -> Vec<[f64; 3]> {
    steps.map(|t| [t, 3.0 * (5.0 * TAU * t).sin(), 6.0 * (5.0 * TAU * (t - 0.05)).sin()]).collect()
}

fn even() -> Place {
    run_with(&waves((0..400).map(|i| 0.01 * f64::from(i))))
}

/// Columns of a table and its rows.
fn table(place: &Place, name: &str) -> (String, Vec<Vec<f64>>) {
    let text = place.read(name);
    let (head, rows) = text.split_once('\n').unwrap();
    let row = |row: &str| row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    (head.to_string(), rows.lines().map(row).collect())
}

/// The row of a frequency.
fn at(rows: &[Vec<f64>], frequency: f64) -> &[f64] {
    rows.iter().find(|row| (row[0] - frequency).abs() < 1e-9).unwrap()
}

#[test]
fn spectra_of_columns_are_printed_and_written() {
    let place = even();
    let outcome =
        place.succeed(&["spectrum", "own/", "--column", "tip_x", "--column", "tip_y", "--kind", "amplitude"]);
    assert!(
        outcome.stdout.lines().count() == 3 && outcome.stdout.contains("tip_y_amplitude"),
        "{}",
        outcome.stdout
    );
    assert!(outcome.stderr.contains("written: own-spectrum/spectrum.csv"), "{}", outcome.stderr);
    let (head, rows) = table(&place, "own-spectrum/spectrum.csv");
    assert_eq!((head.as_str(), rows.len()), ("frequency,tip_x_amplitude,tip_y_amplitude", 201));
    let row = at(&rows, 5.0);
    assert!((row[1] - 3.0).abs() < 1e-12 && (row[2] - 6.0).abs() < 1e-12, "{row:?}");
    assert_eq!(
        place.names("own-spectrum"),
        [".lock", "report.html", "spectrum.csv", "spectrum.png", "spectrum.svg"]
    );

    // The mean square 9/2 is spread over the band 1/(n h) of the transform.
    let flags = ["--window", "boxcar", "--segment", "200", "--detrend", "none", "--quiet"];
    let outcome = place.succeed(&[&["spectrum", "own", "--column", "tip_x"][..], &flags].concat());
    assert_eq!(outcome.stderr, "");
    let (head, rows) = table(&place, "own-spectrum/spectrum.csv");
    assert!(head == "frequency,tip_x_psd" && (at(&rows, 5.0)[1] - 4.5 * 2.0).abs() < 1e-11, "{head}");
}

#[test]
fn a_transient_is_taken_as_a_whole() {
    // The response is three times the input two samples later.
    let pulse = |i: i32| if (0..20).contains(&i) { (0.05 * TAU * 0.5 * f64::from(i)).sin() } else { 0.0 };
    let place =
        run_with(&(0..400).map(|i| [0.01 * f64::from(i), pulse(i), 3.0 * pulse(i - 2)]).collect::<Vec<_>>());
    let of = |flags: &[&str]| {
        let own = ["spectrum", "own", "--column", "tip_y", "--input", "tip_x", "--kind", "transmissibility"];
        place.succeed(&[&own[..], flags].concat()).stderr
    };
    assert!(of(&[]).contains("note: the input dies out"));
    assert!(!of(&["--window", "boxcar", "--segment", "400", "--detrend", "none"]).contains("dies out"));
    let (_, rows) = table(&place, "own-spectrum/spectrum.csv");
    assert!(rows.iter().take(15).all(|row| (row[1] - 3.0).abs() < 1e-10), "{rows:?}");
}

/// Half a sine of 0.2 has its first zero at 7.5: at 7.25, a vibration of the response looks like a resonance.
#[test]
fn the_largest_quotient_is_where_the_input_has_power() {
    let rows = (0..400).map(|i| {
        let t = 0.01 * f64::from(i);
        let pulse = if i < 20 { (2.5 * TAU * t).sin() } else { 0.0 };
        [t, pulse, 3.0 * pulse + 0.1 * (7.25 * TAU * t).sin()]
    });
    let place = run_with(&rows.collect::<Vec<_>>());
    let own = ["spectrum", "own", "--column", "tip_y", "--input", "tip_x", "--kind", "transmissibility"];
    let whole = ["--window", "boxcar", "--segment", "400", "--detrend", "none"];
    let outcome = place.succeed(&[&own[..], &whole].concat());
    let (_, rows) = table(&place, "own-spectrum/spectrum.csv");
    assert!(at(&rows, 7.25)[1] > 10.0, "{:?}", at(&rows, 7.25));
    let largest: f64 =
        outcome.stdout.lines().nth(1).unwrap().split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((largest - 3.0).abs() < 1e-3, "{}", outcome.stdout);
}

#[test]
fn frequency_response_of_columns_has_amplitude_phase_and_coherence() {
    let place = even();
    let flags = ["--input", "tip_x", "--segment", "100", "--output", "frf"];
    let of = |kind| {
        place.succeed(&[&["spectrum", "own", "--column", "tip_y", "--kind", kind], &flags[..]].concat())
    };
    of("frf");
    let (head, rows) = table(&place, "frf/spectrum.csv");
    assert_eq!(head, "frequency,tip_y_amplitude,tip_y_phase,tip_y_coherence");
    let row = at(&rows, 5.0);
    let phase = -0.25 * TAU;
    assert!((row[1] - 2.0).abs() < 1e-10 && (row[2] - phase).abs() < 1e-10 && (row[3] - 1.0).abs() < 1e-10);
    of("transmissibility");
    let (head, rows) = table(&place, "frf/spectrum.csv");
    assert_eq!(head, "frequency,tip_y_transmissibility,tip_y_coherence");
    assert!((at(&rows, 5.0)[1] - 2.0).abs() < 1e-10);
}

/// Central differences of a sine are lower by sin(x)/x with x = omega h; an oscillator at the frequency of a sine that
/// lasts 20 periods has Q (1 - exp(-pi n/Q)) of its amplitude.
#[test]
fn shock_response_takes_derivatives_of_columns() {
    let place = even();
    let flags = ["--kind", "srs", "--frequencies", "5:5:1", "--q", "10"];
    let outcome = place.succeed(&[&["spectrum", "own", "--column", "tip_x"], &flags[..]].concat());
    assert!(outcome.stderr.contains("taken as accelerations"), "{}", outcome.stderr);
    let (head, rows) = table(&place, "own-spectrum/spectrum.csv");
    let names =
        ["maximax", "positive", "negative"].map(|name| format!("tip_x_acceleration_{name}")).join(",");
    assert!(head.starts_with(&format!("frequency,{names},tip_x_displacement_maximax")), "{head}");
    // The absolute acceleration has (1 + 1/Q^2)^(1/2) of this, and the straight lines between the samples have
    // (sin(y)/y)^2 of the sine, y = omega h/2; 20 samples in a period may miss 1.2 % of the peak.
    let y = 2.5 * TAU * 0.01;
    let expected =
        3.0 * 10.0 * (1.0 - (-2.0 * std::f64::consts::PI).exp()) * 1.01f64.sqrt() * (y.sin() / y).powi(2);
    assert!((rows[0][1] / expected - 0.994).abs() < 0.0061, "{} {expected}", rows[0][1]);
    let acceleration = rows[0][1];
    place.succeed(&[&["spectrum", "own", "--column", "tip_x", "--derivative", "1"], &flags[..]].concat());
    let (_, rows) = table(&place, "own-spectrum/spectrum.csv");
    let x = 5.0 * TAU * 0.01;
    assert!((rows[0][1] / acceleration / (5.0 * TAU * x.sin() / x) - 1.0).abs() < 0.02, "{}", rows[0][1]);
}

#[test]
fn uneven_steps_are_interpolated_with_a_note() {
    let place = run_with(&waves(
        (0..300).map(|i| 0.01 * f64::from(i)).chain((0..100).map(|i| 3.0 + 0.005 * f64::from(i))),
    ));
    let flags = ["--column", "tip_x", "--kind", "amplitude", "--to", "3.4"];
    let outcome = place.succeed(&[&["spectrum", "own"], &flags[..]].concat());
    assert!(outcome.stderr.contains("the steps differ: the columns are interpolated at distances of 0.01"));
    let (_, rows) = table(&place, "own-spectrum/spectrum.csv");
    assert_eq!(rows.len(), 341 / 2 + 1);
}

#[test]
fn impossible_spectra_change_nothing() {
    let place = even();
    place.write("taken/mine.txt", "");
    for (flags, part) in [
        (&["--column", "tip_w"][..], "no column `tip_w`"),
        (&["--column", "tip_w"], "did you mean `tip_x`?"),
        (&["--column", "tip_x", "--kind", "frf"], "this kind needs an input"),
        (&["--column", "tip_x", "--input", "tip_y"], "--input has no effect"),
        (&["--column", "tip_x", "--frequencies", "1:2:3"], "--frequencies has no effect"),
        (&["--column", "tip_x", "--kind", "srs", "--frequencies", "2:1:3"], "frequencies must grow"),
        (&["--column", "tip_x", "--kind", "srs", "--q", "0"], "the quality factor is 0"),
        (&["--column", "tip_x", "--kind", "spd"], "invalid value 'spd'"),
        (&["--column", "tip_x", "--segment", "1000"], "longer than the record, which has 400"),
        (&["--column", "tip_x", "--segment", "10", "--overlap", "10"], "cannot overlap by 10"),
        (&["--column", "tip_x", "--from", "9"], "there are 0 samples"),
        (&["--column", "tip_x", "--step", "-1"], "must be a positive number"),
        (&["--column", "tip_x", "--output", "taken"], "no spectrum of Emmy (there is mine.txt"),
        (&["--column", "tip_x", "--output", "own"], "history.csv"),
    ] {
        let outcome = place.emmy(&[&["spectrum", "own"], flags].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{flags:?}\n{}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    let outcome = place.emmy(&["spectrum", "missing", "--column", "tip_x"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("missing is not a directory"), "{}", outcome.stderr);
    assert_eq!(place.names("."), ["box.toml", "out", "own", "taken"]);
}

/// A mass 0.5 on a spring of stiffness 18 along x, omega = 6, pulled with 3.
const OSCILLATOR: &str = r#"
[mesh.network]
points = [[0, 0, 0], [1, 0, 0]]
links = [[0, 1]]
groups = { foot = [0], head = [1] }

[[mass]]
group = "head"
mass = 0.5

[[region]]
material.spring = { stiffness = 18.0 }

[[support]]
group = "foot"
fix = ["x", "y", "z"]

[[support]]
group = "head"
fix = ["y", "z"]

[[load]]
group = "head"
nodal_force = [3.0, 0.0, 0.0]

[time]
scheme = "DGM"
steps = [{ until = 1, size = 0.1 }]

[output]
directory = "out"
probes = [{ name = "tip", point = [1, 0, 0] }]
"#;

/// At resonance the amplitude is F/(2 zeta k), a quarter of a period late; absolute over base acceleration is
/// (1 + 4 zeta^2)^(1/2)/(2 zeta).
#[test]
fn harmonic_response_is_printed_and_written() {
    let place = Place::with(OSCILLATOR);
    let resonance = 6.0 / TAU;
    let frequencies = format!("{}:{resonance}:2", 0.5 * resonance);
    let outcome =
        place.succeed(&["response", "box.toml", "--frequencies", &frequencies, "--damping", "0.05"]);
    assert!(outcome.stdout.contains("tip_x") && outcome.stderr.contains("out-response/response.csv"));
    let (head, rows) = table(&place, "out-response/response.csv");
    let columns = ["x", "y", "z"].map(|axis| format!("tip_{axis}_amplitude,tip_{axis}_phase")).join(",");
    assert_eq!(head, format!("frequency,{columns}"));
    assert!((rows[1][1] / (3.0 / (0.1 * 18.0)) - 1.0).abs() < 1e-9, "{rows:?}");
    assert!((rows[1][2] + 0.25 * TAU).abs() < 1e-9 && rows[1][3..] == [0.0; 4]);
    assert!((rows[0][1] / (3.0 / 18.0 / 0.75f64.hypot(0.05)) - 1.0).abs() < 1e-9);
    let plots = ["report.html", "response.csv", "response.png", "response.svg"];
    let names = [&[".lock"], &plots[..], &["response.toml", "response_modes.csv"]].concat();
    assert_eq!(place.names("out-response"), names);
    let (head, modes) = table(&place, "out-response/response_modes.csv");
    assert_eq!(head, "mode,angular_frequency,damping_ratio,modal_force");
    assert!((modes[0][1] - 6.0).abs() < 1e-9 && (modes[0][2] - 0.05).abs() < 1e-12);
    // The base, from the input that was written; the earlier response is replaced.
    let flags =
        ["--base", "x", "--quantity", "acceleration", "--damping", "0.05", "--output", "out-response"];
    let verb = ["response", "out-response/response.toml", "--frequencies", &frequencies, "--quiet"];
    assert_eq!(place.succeed(&[&verb[..], &flags].concat()).stderr, "");
    let (_, rows) = table(&place, "out-response/response.csv");
    assert!((rows[1][1] / (1.01f64.sqrt() / 0.1) - 1.0).abs() < 1e-9, "{rows:?}");
}

/// A pillar under a slow tension of 3, with its first frequency sqrt(E/rho)/(4 L) = 12.5 and mu = E/2.
const PILLAR: &str = r#"
[units]
system = "m-kg-s"

[mesh]
box = { size = [1, 1, 2], cells = [1, 1, 8] }

[[region]]
density = 0.1
material.neo-hooke = { lambda = 0.0, mu = 500.0 }

[[support]]
group = "z-min"
fix = "z"

[[support]]
group = "x-min"
fix = "x"

[[support]]
group = "y-min"
fix = "y"

[[load]]
group = "z-max"
traction = [0, 0, 3]

[time]
scheme = "DGM"
steps = [{ until = 1, size = 0.1 }]

[output]
directory = "out"
probes = [{ name = "foot", point = [0, 0, 0], quantities = ["von_mises_stress", "cauchy_stress"] }]
"#;

/// A bar with a free end under p sin(omega t) has the stress p/cos(k L) at its foot, k = omega (rho/E)^(1/2).
#[test]
fn stresses_of_probes_have_amplitudes() {
    let place = Place::with(PILLAR);
    let flags = ["--frequencies", "2:8:2", "--damping", "0.0001", "--count", "40"];
    let outcome = place.succeed(&[&["response", "box.toml"][..], &flags].concat());
    assert!(outcome.stderr.contains("von_mises_stress of the probe foot is left out"), "{}", outcome.stderr);
    let (head, rows) = table(&place, "out-response/response.csv");
    let at = head.split(',').position(|name| name == "foot_cauchy_stress_zz_amplitude").unwrap();
    for row in &rows {
        let expected = 3.0 / (0.25 * TAU * row[0] / 12.5).cos();
        assert!((row[at] / expected - 1.0).abs() < 0.01, "{row:?} {expected}");
    }
    // The stress drawn, with the excitation, and the page.
    let caption = "all loads at factor 1; 40 modes, damping ratio 0.0001";
    assert!(outcome.stderr.contains(caption) && place.read("out-response/response.toml").contains(caption));
    let drawn = place.read("out-response/response.svg");
    assert!(drawn.contains("foot_cauchy_stress_zz") && drawn.contains("all loads"), "{drawn}");
    let page = place.read("out-response/report.html");
    assert!(page.contains(caption));
    assert!(page.contains("amplitude of the stress [Pa]") && page.contains("foot_cauchy_stress_zz"));
}

#[test]
fn impossible_responses_change_nothing() {
    let place = Place::with(OSCILLATOR);
    place.write("taken/mine.txt", "");
    let resonance = format!("1:{}:2", 6.0 / TAU);
    let no_probe = ["--frequencies", "1:2:3", "--set", "output.probes=[]"];
    for (flags, part) in [
        (&["--frequencies", "1:2"][..], "A:B:N"),
        (&["--frequencies", "0:2:3"], "frequencies must be positive"),
        (&["--frequencies", "1:2:3", "--base", "w"], "invalid value 'w'"),
        (&["--frequencies", "1:2:3", "--relative"], "--base"),
        (&["--frequencies", "1:2:3", "--load", "1"], "no load with the number 1"),
        (&["--frequencies", "1:2:3", "--damping", "-0.1"], "a damping ratio is -0.1"),
        (&["--frequencies", "1:2:3", "--damping", "2%"], "a ratio of 2 % is written 0.02"),
        (&["--frequencies", "-5:2:3"], "frequencies must be positive"),
        (&["--frequencies", "1:2:3", "--count", "2"], "2 modes were requested"),
        (&["--frequencies", "1:2:3", "--output", "taken"], "no harmonic response of Emmy"),
        (&["--frequencies", "1:2:3", "--output", "taken"], "mine.txt"),
        (&no_probe, "no probe"),
    ] {
        let outcome = place.emmy(&[&["response", "box.toml"], flags].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{flags:?}\n{}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    let flags = ["response", "box.toml", "--frequencies", "1:2:3", "--damping", "2"];
    let told = place.succeed(&[&flags[..], &["--base", "x"]].concat()).stderr;
    assert!(told.contains("a damping ratio of 2 is not below the critical one"), "{told}");
    assert!(
        told.contains("base along x, 1; 1 mode, damping ratio 2") && !told.contains("nothing moves"),
        "{told}"
    );
    let told = place.emmy(&["report", "out-response"]);
    assert!(told.code == 2 && told.stderr.contains("was written by `emmy response`"), "{}", told.stderr);
    // Without damping, resonance is finite only because the frequency has rounding.
    let outcome = place.emmy(&["response", "box.toml", "--frequencies", &resonance]);
    assert!(outcome.code == 2 || outcome.stderr.contains("there is no damping"), "{}", outcome.stderr);
}
