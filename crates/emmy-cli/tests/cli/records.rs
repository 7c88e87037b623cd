//! Pulses in expressions, and corrections of records.

use std::f64::consts::PI;

use super::Place;

/// A free cube that is accelerated along x.
const CUBE: &str = r#"[mesh]
box = { size = [1.0, 1.0, 1.0], cells = [1, 1, 1] }

[[region]]
density = 2.0
material.neo-hooke = { lambda = 1e6, mu = 5e5 }

[[load]]
acceleration = [1.0, 0.0, 0.0]
history = "294.2*half_sine(t, 0.002, 0.013)"

[time]
scheme = "DGM"
degree = 2
steps = [{ until = 0.03, size = 0.03 }]

[output]
directory = "out"
probes = [{ name = "centre", point = [1.0, 1.0, 1.0] }]
"#;

#[test]
fn a_pulse_within_a_step_gives_its_momentum() {
    let place = Place::with(CUBE);
    let outcome = place.succeed(&["run", "box.toml"]);
    assert!(!outcome.stderr.contains("resolve"), "{}", outcome.stderr);
    // The change of velocity is 2 A T/pi.
    let momentum = 2.0 * 2.0 * 294.2 * 0.011 / PI;
    let history = place.history("out");
    let ratio = history["linear_momentum_x"].last().unwrap() / momentum;
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    assert_eq!(place.summary("out")["unresolved_loads"], 0);
}

/// Fields are integrated up to the kinks of their history, of a record up to its corners.
#[test]
fn histories_of_fields_are_integrated_to_their_kinks() {
    let load = "acceleration = [1.0, 0.0, 0.0]\nhistory = \"294.2*half_sine(t, 0.002, 0.013)\"";
    // The mean of 1 + y is 3/2, and that of the hat over 10 ms is 1/2.
    let hat = "[[0.002, 0.0], [0.007, 100.0], [0.012, 0.0]]";
    let record = "{ file = \"hat.csv\", time = \"t\", value = \"f\" }";
    for history in [hat, record] {
        let field = format!("body_force = [\"1 + y\", 0, 0]\nhistory = {history}");
        let place = Place::with(&CUBE.replace(load, &field));
        place.write("hat.csv", "t,f\n0,0\n0.002,0\n0.007,100\n0.012,0\n0.03,0\n");
        place.succeed(&["run", "box.toml", "--quiet"]);
        let ratio = place.history("out")["linear_momentum_x"].last().unwrap() / (1.5 * 0.5 * 100.0 * 0.01);
        assert!((ratio - 1.0).abs() < 1e-12, "{history}: {ratio}");
    }
}

#[test]
fn adaptive_steps_end_at_the_kinks_of_a_pulse() {
    let place =
        Place::with(&CUBE.replace(
            "steps = [{ until = 0.03, size = 0.03 }]",
            "until = 0.03\nadaptive = { tolerance = 1e-3 }",
        ));
    place.succeed(&["run", "box.toml"]);
    let times = &place.history("out")["time"];
    for kink in [0.002, 0.013] {
        assert!(times.iter().any(|time| (time - kink).abs() < 1e-12), "{kink}: {times:?}");
    }
}

#[test]
fn pulses_of_supports_must_not_jump() {
    let held = |history: &str| {
        let support = format!("[[support]]\ngroup = \"x-min\"\nmove = {{ x = \"{history}\" }}\n\n[time]");
        Place::with(&CUBE.replace("[time]", &support)).emmy(&["check", "box.toml"])
    };
    let outcome = held("0.1*step(t, 0.01)");
    assert!(outcome.code == 2 && outcome.stderr.contains("jumps at t = 0.01"), "{}", outcome.stderr);
    assert_eq!(held("0.1*step(t, 0.01, 0.02)").code, 0);
    let outcome = held("0.1*halfsine(t, 0.01, 0.02)");
    assert!(outcome.code == 2 && outcome.stderr.contains("did you mean `half_sine`"), "{}", outcome.stderr);
}

/// The cube on a floor with a record of 101 rows: 1 + 0.3 sin(2 pi 200 t), 3 s long.
fn on_a_floor(corrections: &str) -> Place {
    let floor = format!(
        "[[support]]\ngroup = \"x-min\"\nfix = \"yz\"\naccelerate.x = {{ file = \"floor.csv\", time = \"t\", \
         value = \"a\"{corrections} }}\n\n[time]"
    );
    let start = CUBE.find("[[load]]").unwrap();
    let end = CUBE.find("[time]").unwrap();
    let rest = CUBE[end..].replace("[time]", &floor).replace("0.03", "0.1");
    let place = Place::with(&(CUBE[..start].to_string() + &rest));
    let row = |i: u32| {
        let t = 1e-3 * f64::from(i);
        format!("{t},{}\n", 1.0 + 0.3 * (400.0 * PI * t).sin())
    };
    place.write("floor.csv", &("t,a\n".to_string() + &(0..=100).map(row).collect::<String>()));
    place
}

#[test]
fn corrections_of_a_record_say_what_they_change() {
    let report = on_a_floor("").succeed(&["check", "box.toml"]);
    // 20 whole periods: v = 0.1; of a sine, the straight lines between rows leave
    // u = 0.1^2/2 + 0.1 * 0.3 * 5e-4 cot(pi/5) = 0.0050206.
    assert!(report.stdout.contains("integrated: velocity 0.1, displacement 0.00502"), "{}", report.stdout);
    let notes = |corrections: &str| {
        let outcome = on_a_floor(corrections).succeed(&["check", "box.toml"]);
        outcome.stdout + &outcome.stderr
    };
    let own = notes(", correct_baseline = true");
    assert!(own.contains("floor.csv: corrected baseline: values change by up to 1."), "{own}");
    assert!(own.contains("the velocity changes from 0.1 to"), "{own}");
    assert!(own.contains("then it should not be corrected"), "{own}");
    // At 200 Hz the filter leaves 1/(1 + (tan(0.2 pi)/tan(0.05 pi))^4) = 0.22 %.
    let own = notes(", low_pass = 50");
    assert!(own.contains("floor.csv: filtered at 50"), "{own}");
    let refused = |corrections: &str| {
        let outcome = on_a_floor(corrections).emmy(&["check", "box.toml"]);
        assert_eq!(outcome.code, 2);
        outcome.stderr
    };
    assert!(refused(", low_pass = 600").contains("half of it is 500"));
    assert!(refused(", low_pass = 0").contains("low_pass"));
    assert!(refused(", lowpass = 60").contains("did you mean `low_pass`"));
    assert!(refused(", correct_baseline = 3").contains("correct_baseline"));
}
