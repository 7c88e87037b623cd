//! The report of a run on its accuracy in time, and on the limits of adaptive step sizes.

use super::{BOX, Place};

/// A bar of steel, 100 mm long and 10 mm thick, held at an end and pushed across at the other one.
const BAR: &str = r#"units.system = "mm-t-s"
mesh.box = { size = [100, 10, 10], cells = [12, 2, 2] }
[[region]]
density = 7.85e-9
material.neo-hooke = { youngs_modulus = 2.1e5, poissons_ratio = 0.3 }
formulation = "incompatible-modes"
[[support]]
group = "x-min"
fix = ["x", "y", "z"]
[[load]]
group = "x-max"
force = [0, 0, -100]
history = [[0, 0], [1e-3, 1]]
[time]
scheme = "DGM"
steps = [{ until = 2e-3, size = 1e-2 }]
"#;

/// Period of the lowest bending mode: Euler and Bernoulli, 1.8751^2 sqrt(E I/(rho A L^4)). Shear and rotational inertia
/// add about a percent.
fn bending_period() -> f64 {
    let stiffness: f64 = 2.1e5 * 100.0 / 12.0 / (7.85e-9 * 1e8);
    std::f64::consts::TAU / (1.8751f64.powi(2) * stiffness.sqrt())
}

/// The size that a note suggests.
fn suggested(text: &str) -> f64 {
    let (_, rest) = text.split_once("about `size = ").unwrap_or_else(|| panic!("{text}"));
    rest.split_once('`').unwrap().0.parse().unwrap()
}

#[test]
fn steps_that_do_not_resolve_the_motion_are_noted() {
    let place = Place::with(BAR);
    let check = place.succeed(&["check", "box.toml"]);
    // Of the step that is taken, which its phase shortens.
    let times = format!("a step of 0.002 s is {:.1} times", 2e-3 / bending_period());
    assert!(check.stdout.contains(&format!("{times} this period\n")), "{}", check.stdout);
    // Less than one step is no number of steps: the only one belongs to the suggested size.
    assert_eq!(check.stdout.matches("steps a period").count(), 1, "{}", check.stdout);
    let run = place.succeed(&["run", "box.toml", "--output", "out"]);
    let quiet = place.succeed(&["run", "box.toml", "--output", "quiet", "--quiet"]);
    for text in [&check.stderr, &run.stderr, &quiet.stderr] {
        assert!(
            text.contains("note: a step of 0.01 s is longer than its phase, which ends at t = 0.002 s"),
            "{text}"
        );
        assert!(text.contains("vibrations are not resolved; about"), "{text}");
        // 58 steps a period, rounded down to two digits.
        let wanted = bending_period() / 58.0;
        assert!((suggested(text) / wanted - 1.0).abs() < 0.05, "{text} {wanted}");
    }
    assert!(
        run.stderr.contains(&format!("accuracy in time: coarse, {times} the lowest elastic period")),
        "{}",
        run.stderr
    );
    let summary = place.summary("out");
    assert_eq!(summary["accuracy_in_time"], "coarse");
    assert_eq!(summary["notes"].as_array().unwrap().len(), 2);
    assert!(place.read("out/report.html").contains("vibrations are not resolved; about"));
    // With the suggestion nothing is noted, and the phase error of a thousandth is far below a percent of the result.
    let size = suggested(&run.stderr);
    let run_of = |size: f64, output: &str, more: &[&str]| {
        let steps = format!("time.steps=[{{ until = 2e-3, size = {size} }}]");
        let words = [&["run", "box.toml", "--quiet", "--output", output, "--set", &steps][..], more].concat();
        let ended = place.succeed(&words);
        assert!(!ended.stderr.contains("note:"), "{}", ended.stderr);
        place.summary(output)
    };
    let (fine, finer) = (run_of(size, "fine", &[]), run_of(size / 4.0, "finer", &[]));
    assert_eq!(fine["accuracy_in_time"], "not estimated");
    let text = fine["accuracy_in_time_text"].as_str().unwrap();
    assert!(
        text.starts_with("not estimated (") && text.contains("`emmy converge` or `--estimate-error`"),
        "{text}"
    );
    // In a sweep, too; the step is that of the plan, or of its phase of 0.002 s.
    let sizes = format!("time.steps=[{{ until = 2e-3, size = {size} }}],[{{ until = 2e-3, size = 1e-2 }}]");
    let words = ["sweep", "box.toml", "--quiet", "--json", "--output", "sizes", "--set", &sizes];
    let rows = place.succeed(&words).stdout;
    assert_eq!(rows.lines().count(), 2);
    let noted = place.succeed(&["sweep", "box.toml", "--output", "noted", "--set", &sizes]).stderr;
    assert!(noted.contains("note: in 1 run, vibrations are not resolved: "), "{noted}");
    assert!(noted.contains("first in run 2 ("), "{noted}");
    for ((summary, row), step) in [&fine, &summary].into_iter().zip(rows.lines()).zip([size, 2e-3]) {
        let row: serde_json::Value = serde_json::from_str(row).unwrap();
        let steps = row["steps_per_lowest_period"].as_f64().unwrap();
        assert_eq!(summary["steps_per_lowest_period"].as_f64(), Some(steps));
        assert!((steps * step / bending_period() - 1.0).abs() < 0.05, "{row}");
    }
    let most = |summary: &serde_json::Value| summary["largest_displacement"].as_f64().unwrap();
    assert!((most(&fine) / most(&finer) - 1.0).abs() < 0.01);
    assert!((most(&summary) / most(&finer) - 1.0).abs() > 0.1);
    let estimated = run_of(size, "estimated", &["--estimate-error"]);
    assert_eq!(estimated["accuracy_in_time"], "estimated");
    assert!(estimated["accuracy_in_time_text"].as_str().unwrap().starts_with("estimated at "));
}

#[test]
fn longer_steps_of_other_schemes_and_phases_are_noted_and_higher_degrees_may_take_longer_ones() {
    let place = Place::with(BAR);
    let period = bending_period();
    let accuracy = |scheme: &str, degree: usize, steps: &str| {
        let scheme = format!("time.scheme={scheme}");
        let (degree, steps) = (format!("time.degree={degree}"), format!("time.steps=[{steps}]"));
        let words = [
            "run", "box.toml", "--quiet", "--output", "out", "--set", &scheme, "--set", &degree, "--set",
            &steps,
        ];
        let noted = place.succeed(&words).stderr.contains("vibrations are not resolved; about");
        let kind = place.summary("out")["accuracy_in_time"].as_str().unwrap().to_string();
        assert_eq!(noted, kind == "coarse");
        kind
    };
    let steps = |part: f64| format!("{{ until = {}, size = {} }}", 2.0 * period, part * period);
    for scheme in ["DGM", "AS(2)", "Newmark(0.25, 0.5)", "Bathe"] {
        assert_eq!(accuracy(scheme, 1, &steps(0.25)), "coarse", "{scheme}");
        assert_eq!(accuracy(scheme, 1, &steps(0.15)), "not estimated", "{scheme}");
    }
    for (degree, fine, coarse) in [(2, 0.2, 0.35), (3, 0.4, 0.65)] {
        assert_eq!(accuracy("DGM", degree, &steps(coarse)), "coarse", "{degree}");
        assert_eq!(accuracy("DGM", degree, &steps(fine)), "not estimated", "{degree}");
    }
    let second = format!("{{ until = {period}, size = {} }}, {}", 0.02 * period, steps(0.5));
    assert_eq!(accuracy("DGM", 1, &second), "coarse");
}

/// The steps are some hundred elastic periods long, and still the rotation is right: nothing to worry about.
#[test]
fn a_stiff_body_that_turns_is_not_coarse() {
    let input = BOX
        .replace("lambda = 1000.0, mu = 500.0", "lambda = 1e8, mu = 1e8")
        .replace("velocity = [0, 0, 0]", "angular_velocity = [0, 0, 1]")
        .replace("[[support]]\ngroup = \"y-min\"\nfix = [\"x\", \"y\", \"z\"]\n", "")
        .replace("traction = [0.0, 0.0, 10.0]\n", "acceleration = [0, 0, -1]\n")
        .replace("group = \"y-max\"\n", "");
    let place = Place::with(&input);
    let check = place.succeed(&["check", "box.toml"]);
    assert!(!check.stderr.contains("note"), "{}", check.stderr);
    assert!(check.stdout.contains("harmless while the body moves as if rigid"), "{}", check.stdout);
    let run = place.succeed(&["run", "box.toml", "--quiet"]);
    assert_eq!(
        (run.stderr.as_str(), &place.summary("out")["accuracy_in_time"]),
        ("", &"not estimated".into())
    );
}

#[test]
fn a_static_analysis_has_no_accuracy_in_time() {
    let timeless = &BOX[..BOX.find("[initial]").unwrap()];
    let place = Place::with(
        &format!("{timeless}[equilibrium]\nload_steps = 2\n[output]\ndirectory = \"out\"\n")
            .replace("history = [[0.0, 0.0], [0.5, 1.0]]", ""),
    );
    let run = place.succeed(&["run", "box.toml"]);
    assert!(!run.stderr.contains("accuracy"), "{}", run.stderr);
    assert!(place.summary("out")["accuracy_in_time"].is_null());
}

#[test]
fn a_table_that_starts_late_is_noted() {
    let place = Place::with(&BOX.replace("[[0.0, 0.0], [0.5, 1.0]]", "[[0.1, 0.5], [0.5, 1.0]]"));
    let note = "note: load 0: the table begins at t = 0.1; its first value, 0.5, acts from t = 0 on";
    for verb in [&["check", "box.toml"][..], &["run", "box.toml", "--quiet"]] {
        let told = place.succeed(verb).stderr;
        assert!(told.contains(note), "{told}");
    }
}

/// A column of words.
fn limits(place: &Place) -> Vec<String> {
    let text = place.read("out/history.csv");
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|name| name == "limited_by").unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().to_string()).collect()
}

/// The words of an adaptive run, which are counted in its summary.
fn words(history: &str, settings: &str, more: &[&str]) -> (Place, Vec<String>) {
    let steps = &BOX[BOX.find("steps = ").unwrap()..BOX.find("\n\n[newton]").unwrap()];
    let input = BOX
        .replace(steps, &format!("adaptive = {{ {settings} }}\nuntil = 0.5"))
        .replace("[[0.0, 0.0], [0.5, 1.0]]", history)
        .replace("AS(2)", "DGM");
    let place = Place::with(&input);
    let closing = place.succeed(&[&["run", "box.toml"][..], more].concat()).stderr;
    assert!(closing.contains("step size limited by: "), "{closing}");
    assert!(closing.contains("accuracy in time: estimated: the errors of the steps add up to "), "{closing}");
    let words = limits(&place);
    assert_eq!(words[0], "");
    let summary = place.summary("out");
    for name in ["start", "error", "corrections", "kink", "load", "output", "phase", "max_size", "min_size"] {
        let count = words.iter().filter(|word| *word == name).count();
        let told = &summary[format!("step_limits_{name}")];
        assert_eq!(told.as_u64().unwrap_or(0), count as u64, "{name}: {words:?}");
    }
    let sum: f64 = place.history("out")["local_error"].iter().sum();
    assert!((summary["accumulated_local_error"].as_f64().unwrap() / sum - 1.0).abs() < 1e-12);
    (place, words)
}

#[test]
fn the_column_says_what_set_the_size_of_each_step() {
    // One cause each, which the input makes certain.
    let ramp = "[[0.0, 0.0], [0.5, 1.0]]";
    let (_, limited) = words(ramp, "tolerance = 0.9, max_size = 0.01, first_size = 0.01", &[]);
    assert!(limited[1..].iter().all(|word| word == "max_size" || word == "kink"), "{limited:?}");
    let (_, limited) = words(ramp, "tolerance = 1e-8", &[]);
    let by_error = limited.iter().filter(|word| *word == "error").count();
    assert!(by_error > limited.len() / 2, "{limited:?}");
    let (_, limited) = words(ramp, "tolerance = 1e-4, first_size = 1e-5", &[]);
    assert!(limited[1..4].iter().all(|word| word == "start"), "{limited:?}");
    // Steps end at the kink; afterwards sizes grow again from a first one.
    let (place, limited) = words("[[0.0, 0.0], [0.2, 1.0], [0.5, 1.0]]", "tolerance = 1e-4", &[]);
    let times = &place.history("out")["time"];
    let at = times.iter().position(|time| *time == 0.2).unwrap();
    assert_eq!((limited[at].as_str(), limited[at + 1].as_str()), ("kink", "kink"), "{limited:?}");
    let pulse = "\"exp(-((t - 0.25)/0.002)^2)\"";
    let (place, limited) = words(pulse, "tolerance = 1e-3", &[]);
    let times = &place.history("out")["time"];
    assert!(
        limited.iter().zip(times).any(|(word, time)| word == "load" && (time - 0.25).abs() < 0.01),
        "{limited:?}"
    );
    assert_eq!(limited.last().unwrap(), "phase");
    let (place, limited) = words(
        "\"1\"",
        "tolerance = 0.5, first_size = 0.1",
        &["--set", "output.every=", "--set", "output.interval=0.05"],
    );
    let times = &place.history("out")["time"];
    assert_eq!(times.len(), 11, "{times:?}");
    assert!(limited[1..10].iter().all(|word| word == "output") && limited[10] == "phase", "{limited:?}");
}

/// A resumed run has the words of the whole one.
#[test]
fn words_survive_a_stop() {
    let (place, whole) = words("[[0.0, 0.0], [0.2, 1.0], [0.5, 1.0]]", "tolerance = 1e-5", &[]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.5"]);
    let text = place.read("parts/history.csv").replace("parts", "out");
    place.write("out/history.csv", &text);
    let parts = limits(&place);
    let at = whole.len().min(parts.len());
    assert!(at > 5 && parts.contains(&"kink".to_string()), "{parts:?} {whole:?}");
    let summary = place.summary("parts");
    let counted: u64 = summary
        .as_object()
        .unwrap()
        .iter()
        .filter(|(key, _)| key.starts_with("step_limits_"))
        .map(|(_, count)| count.as_u64().unwrap())
        .sum();
    assert_eq!(counted, summary["steps"].as_u64().unwrap());
}
