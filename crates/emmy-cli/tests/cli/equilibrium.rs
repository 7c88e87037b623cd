//! `[equilibrium]` before a motion and alone; `initial.state`.

use super::resume::{assert_same_rows, rows};
use super::{BOX, Place};

const TIME: &str = "[time]\nscheme = \"AS(2)\"\ndegree = 1\nsteps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]";

/// The box under its whole traction from the start on, with steps of one size.
fn loaded() -> String {
    let time = "[time]\nscheme = \"DGM\"\nsteps = [{ until = 0.5, size = 0.05 }]";
    BOX.replace("[[0.0, 0.0], [0.5, 1.0]]", "[[0.0, 20.0], [0.1, 20.0], [0.15, 0.0]]").replace(TIME, time)
}

/// The box in equilibrium at the start, then released.
fn released() -> String {
    loaded().replace("[time]", "[equilibrium]\nload_steps = 4\n\n[time]")
}

/// The box under its load, without a motion.
fn alone() -> String {
    let time = "[time]\nscheme = \"DGM\"\nsteps = [{ until = 0.5, size = 0.05 }]";
    let equilibrium = loaded().replace(time, "[equilibrium]\nload_steps = 8");
    equilibrium.replace("[initial]\nvelocity = [0, 0, 0]\n\n", "")
}

/// Increments that are cut are more than planned ones, and their lines come after each tenth of the load.
#[test]
fn increments_that_are_cut_are_not_counted_among_the_planned_ones() {
    let place = Place::with(
        r#"
mesh.box = { size = [10, 100, 10], cells = [1, 10, 1] }
region = [{ density = 1.0, formulation = "incompatible-modes", material.neo-hooke = { youngs_modulus = 1.5, poissons_ratio = 0.3 } }]
support = [{ group = "y-min", fix = ["x", "y", "z"] }]
load = [{ group = "y-max", force = [0, 0, 0.5] }]
equilibrium.load_steps = 2
output = { directory = "out", every = 0 }
"#,
    );
    let run = place.succeed(&["run", "box.toml"]).stderr;
    let [cuts, lines] = [" cut to ", ", load fraction "]
        .map(|words| run.lines().filter(|line| line.contains(words)).collect::<Vec<_>>());
    assert!(cuts.iter().all(|line| line.starts_with("increment ")) && !cuts.is_empty(), "{run}");
    assert!(lines.len() > 2 && lines.iter().all(|line| !line.contains(" of 2,")), "{run}");
    assert!(lines[lines.len() - 1].contains(", load fraction 1  "), "{run}");
}

#[test]
fn a_static_analysis_has_a_row_for_each_increment() {
    let place = Place::with(&alone());
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(
        check.contains("analysis   static, 8 increments of the loads and driven supports at t = 0"),
        "{check}"
    );
    assert!(!check.contains("scheme") && !check.contains("initial"), "{check}");
    let run = place.succeed(&["run", "box.toml"]);
    assert!(run.stderr.contains("done: 8 increments to load fraction 1 in"), "{}", run.stderr);
    let history = place.history("out");
    let fractions: Vec<f64> = (0..=8).map(|i| f64::from(i) / 8.0).collect();
    assert_eq!(history["time"], fractions);
    assert!(history["kinetic_energy"].iter().all(|&energy| energy == 0.0));
    assert!(history["strain_energy"].windows(2).all(|pair| pair[1] > pair[0]));
    assert_eq!(history["external_work"], history["strain_energy"]);
    assert!(history["linear_momentum_residual"].iter().all(|&resultant| resultant < 1e-12));
    let summary = place.summary("out");
    assert_eq!((summary["status"].as_str(), summary["steps"].as_u64()), (Some("done"), Some(8)));
    // A frame for every second increment, the first and the last one among them.
    assert_eq!(place.names("out/frames").len(), 5);
    assert!(place.path("out/report.html").is_file());
    place.succeed(&["report", "out"]);
    place.succeed(&["compare", "out", "out"]);

    // The load fraction has no unit, and the residuals are a force and a moment.
    let units =
        place.succeed(&["run", "box.toml", "--output", "units", "--set", "units.system=m-kg-s"]).stderr;
    assert!(units.contains("to load fraction 1 in") && !units.contains("load fraction 1 s"), "{units}");
    let columns: serde_json::Value = serde_json::from_str(&place.read("units/columns.json")).unwrap();
    let unit = |name: &str| {
        columns.as_array().unwrap().iter().find(|own| own["column"] == name).unwrap()["unit"].clone()
    };
    let own = ["time", "step_size", "linear_momentum_residual", "angular_momentum_residual"].map(unit);
    assert_eq!(own, ["", "", "N", "N·m"]);

    let again = place.succeed(&["resume", "out"]);
    assert!(
        again.stderr.contains("nothing to do: the run is complete, after step 8, t = 1"),
        "{}",
        again.stderr
    );
    assert!(!again.stderr.contains("--until"), "{}", again.stderr);
    let motion = place.emmy(&[
        "resume",
        "out",
        "--set",
        "time.scheme=DGM",
        "--set",
        "time.steps=[{ until = 1, size = 0.1 }]",
    ]);
    assert!(motion.code == 2 && motion.stderr.contains("`time` is given, but missing"), "{}", motion.stderr);
    let study = place.emmy(&["converge", "box.toml", "--sizes", "0.1,0.05"]);
    assert!(study.code == 2 && study.stderr.contains("no steps in time"), "{}", study.stderr);
}

#[test]
fn a_motion_starts_from_equilibrium_with_the_stored_energy() {
    let place = Place::with(&released());
    let check = place.succeed(&["check", "box.toml"]).stdout;
    let line = "start      static equilibrium under the loads and driven supports at t = 0, in 4 increments";
    assert!(check.contains(line), "{check}");
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    let history = place.history("whole");
    let stored = history["strain_energy"][0];
    assert!(stored > 0.0 && history["external_work"][0] == 0.0 && history["kinetic_energy"][0] == 0.0);
    // The support carries the traction from the start on: 20 times 10 on an area of 1.
    let carried = &history["y-min_force_z"];
    assert!(carried[..3].iter().all(|force| (force + 200.0).abs() < 1e-10), "{carried:?}");
    // At rest while the load holds.
    assert!(history["time"][2] == 0.1 && history["kinetic_energy"][2] < 1e-24 * stored);
    assert!(history["kinetic_energy"].iter().any(|&energy| energy > 0.3 * stored));
    let balance = |i: usize| history["total_energy"][i] - history["external_work"][i] - stored;
    assert!((0..history["time"].len()).all(|i| balance(i).abs() < 1e-13 * stored));

    // The equilibrium is not solved for again.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
    let resumed = place.succeed(&["resume", "parts", "--until", "0.5"]);
    assert!(!resumed.stderr.contains("equilibrium"), "{}", resumed.stderr);
    assert_same_rows(&place, "parts", "whole");
}

#[test]
fn a_load_that_jumps_at_the_start_is_released() {
    let jump = released().replace("[[0.0, 20.0], [0.1, 20.0], [0.15, 0.0]]", "[[0.0, 20.0], [0.0, 0.0]]");
    let place = Place::with(&jump);
    let run = place.succeed(&["run", "box.toml"]);
    assert!(!run.stderr.contains("no load acts"), "{}", run.stderr);
    let history = place.history("out");
    let stored = history["strain_energy"][0];
    assert!(stored > 0.0 && history["kinetic_energy"].iter().any(|&energy| energy > 0.3 * stored));
    assert!(history["external_work"].iter().all(|&work| work == 0.0));
    assert!(history["total_energy"].iter().all(|&energy| (energy - stored).abs() < 1e-13 * stored));
    place.write("box.toml", &jump.replace("[[0.0, 20.0], [0.0, 0.0]]", "[[0.0, 0.0], [0.1, 20.0]]"));
    let check = place.succeed(&["check", "box.toml"]);
    assert!(check.stderr.contains("note: no load acts at t = 0"), "{}", check.stderr);
}

#[test]
fn supports_may_start_displaced_in_equilibrium() {
    let moved = "[[support]]\ngroup = \"y-max\"\nmove = { z = [[0.0, 0.1], [1.0, 0.1]] }\n\n[initial]";
    let input = loaded().replace("[initial]", moved);
    let place = Place::with(&input);
    let failed = place.emmy(&["check", "box.toml"]);
    assert!(failed.code == 2 && failed.stderr.contains("let it start from 0"), "{}", failed.stderr);
    place.write("box.toml", &input.replace("[time]", "[equilibrium]\n\n[time]"));
    place.succeed(&["check", "box.toml"]);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    assert!(history["tip_z"].iter().all(|&z| (z - 0.1).abs() < 1e-15), "{:?}", history["tip_z"]);
}

#[test]
fn a_run_starts_from_the_end_of_another() {
    let place = Place::with(&loaded().replace("velocity = [0, 0, 0]", "state = \"static\""));
    place.write("static.toml", &alone().replace("directory = \"out\"", "directory = \"static\""));
    place.succeed(&["run", "static.toml", "--quiet"]);
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.write("direct.toml", &released().replace("load_steps = 4", "load_steps = 8"));
    place.succeed(&["run", "direct.toml", "--quiet", "--output", "direct"]);
    // The same start, so the same bits; only an equilibrium has reactions at the start.
    let moving = |directory: &str| rows(&place, directory).split_off(2);
    assert_eq!(moving("out"), moving("direct"));
    // A motion goes on with its velocity, without the support.
    let check = place.succeed(&["check", "box.toml", "--set", "initial.state=direct"]).stdout;
    assert!(check.contains("start      last state of the run in direct"), "{check}");
    let free = loaded().replace("velocity = [0, 0, 0]", "state = \"direct\"");
    place.write("free.toml", &free.replace("fix = [\"x\", \"y\", \"z\"]", "fix = [\"x\"]"));
    place.succeed(&["run", "free.toml", "--quiet", "--output", "free"]);
    let (before, after) = (place.history("direct"), place.history("free"));
    let last = |name: &str| *before[name].last().unwrap();
    assert_eq!(after["time"][0], 0.0);
    assert!((after["strain_energy"][0] / last("strain_energy") - 1.0).abs() < 1e-14);
    assert!((after["kinetic_energy"][0] / last("kinetic_energy") - 1.0).abs() < 1e-12);

    let other = place.emmy(&["run", "box.toml", "--output", "other", "--set", "mesh.box.cells=[1, 3, 1]"]);
    assert_eq!(other.code, 2);
    let counts = ["has another mesh: 12 nodes, 2 cells", "here 16 nodes, 3 cells"];
    assert!(counts.iter().all(|part| other.stderr.contains(part)), "{}", other.stderr);
    let own = place.emmy(&["run", "box.toml", "--output", "static"]);
    assert!(own.code == 2 && own.stderr.contains("output directory of this run"), "{}", own.stderr);
    // It resumes without the other run.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
    std::fs::remove_dir_all(place.path("static")).unwrap();
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.5"]);
    assert_same_rows(&place, "parts", "out");
}

/// Pressure on the ends of a soft box squeezes it until nothing balances it.
#[test]
fn an_equilibrium_that_does_not_exist_ends_with_its_load_fraction() {
    let squeezed = |input: String| {
        let neo_hooke = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";
        let svk = "material.saint-venant-kirchhoff = { lambda = 0.0, mu = 500.0 }";
        let along_y = "[[support]]\ngroup = \"body\"\nfix = [\"x\", \"z\"]\n\n[newton]";
        let input = input.replace(neo_hooke, svk).replace("[newton]", along_y);
        input.replace("traction = [0.0, 0.0, 10.0]", "traction = [0.0, -30.0, 0.0]")
    };
    let place = Place::with(&squeezed(alone()));
    let failed = place.emmy(&["run", "box.toml"]);
    assert_eq!(failed.code, 3, "{}", failed.stderr);
    assert!(
        failed.stderr.contains("no equilibrium was found beyond a load fraction of 0."),
        "{}",
        failed.stderr
    );
    let summary = place.summary("out");
    assert_eq!(summary["status"], "no-convergence");
    let fractions = &place.history("out")["time"];
    // A bar of lateral stiffness zero: N = E (l^3 - l)/2, least at l = 1/sqrt 3, where N = -E/sqrt 27.
    let limit = 1000.0 / 27f64.sqrt() / 600.0;
    assert!((fractions.last().unwrap() - limit).abs() < 0.02 * limit, "{fractions:?} {limit}");

    let place = Place::with(&squeezed(released()));
    let failed = place.emmy(&["run", "box.toml"]);
    assert_eq!(failed.code, 3, "{}", failed.stderr);
    assert!(failed.stderr.contains("nothing is written"), "{}", failed.stderr);
    assert_eq!(place.names("."), ["box.toml"]);
}

/// A bar without Poisson's effect, held sideways and pulled to twice its length: `P = mu (l - 1/l)`, so its axial
/// stiffness is `mu (1 + 1/l^2)` in place of 2 mu, and so are the squares of its frequencies.
#[test]
fn modes_are_about_the_equilibrium() {
    let bar = r#"
[mesh]
box = { size = [6, 1, 1], cells = [6, 1, 1] }

[[region]]
density = 2.0
material.neo-hooke = { youngs_modulus = 50.0, poissons_ratio = 0.0 }

[[support]]
group = "body"
fix = ["y", "z"]

[[support]]
group = "x-min"
fix = ["x"]

[[load]]
group = "x-max"
traction = [37.5, 0, 0]

"#;
    let time = "[time]\nscheme = \"DGM\"\nsteps = [{ until = 1, size = 0.1 }]\n";
    let place = Place::with(&format!("{bar}{time}"));
    place.write("pulled.toml", &format!("{bar}[equilibrium]\n\n{time}"));
    place.write("static.toml", &format!("{bar}[equilibrium]\n"));
    let frequency = |name: &str| -> f64 {
        place.succeed(&["modes", &format!("{name}.toml"), "--count", "2", "--output", name]);
        let text = place.read(&format!("{name}/modes.csv"));
        text.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap()
    };
    let free = frequency("box");
    for name in ["pulled", "static"] {
        let ratio = frequency(name) / free;
        assert!((ratio - 0.625f64.sqrt()).abs() < 1e-9, "{name}: {ratio}");
    }
}

/// A body that hangs at rest has energies and momenta of motion only up to rounding, which is no scale for its
/// residuals.
#[test]
fn a_body_at_rest_under_its_weight_closes() {
    let weight = BOX.replace(
        "traction = [0.0, 0.0, 10.0]\nhistory = [[0.0, 0.0], [0.5, 1.0]]",
        "acceleration = [3, 0, -9.81]",
    );
    let weight = weight.replace("group = \"y-max\"\nacceleration", "acceleration");
    let hanging = weight.replace("[initial]\nvelocity = [0, 0, 0]\n", "[equilibrium]\n");
    for scheme in ["DGM", "trapezoidal", "Newmark(0.25, 0.5)"] {
        for size in [0.1, 100.0] {
            let place = Place::with(&hanging);
            let steps = format!("time.steps=[{{ until = {}, size = {size} }}]", 10.0 * size);
            let scheme = format!("time.scheme={scheme}");
            let limits = ["limits.energy=1e-6", "limits.angular_momentum=1e-6"];
            let flags = [steps.as_str(), &scheme, limits[0], limits[1]].map(|flag| ["--set", flag]).concat();
            let run = place.succeed(&[&["run", "box.toml"], &flags[..]].concat());
            assert!(run.stderr.contains(" of the largest possible |L|)"), "{}", run.stderr);
            let summary = place.summary("out");
            assert!(summary["angular_momentum_drift"].as_f64().unwrap() < 1e-9, "{summary:#}");
            let [worst, scale] = ["worst_linear_momentum_residual", "linear_momentum_scale"]
                .map(|key| summary[key].as_f64().unwrap());
            assert!(worst < 1e-9 * scale, "{worst} {scale}");
        }
    }
}

#[test]
fn a_state_in_no_directory_is_named() {
    let place = Place::with(&loaded().replace("velocity = [0, 0, 0]", "state = \"bned\""));
    let check = place.emmy(&["check", "box.toml"]);
    assert!(check.code == 2 && check.stderr.contains("there is no directory bned"), "{}", check.stderr);
}

/// A mass on springs, drawn at a distance of 1 from the axis: `r = k/(k - m Omega^2)`, and frequencies
/// `omega_0 -+ Omega`; beyond the limit there is no equilibrium.
const BALL: &str = r#"
rigid = [{ name = "ball", mass = 2, centre = [1, 0, 0] }]
support = [{ group = "ball", spring = 18 }]
load = [{ rotation = { axis = [0, 0, 5], speed = 1 } }]
equilibrium.load_steps = 2
output = { directory = "out", every = 0 }
"#;

#[test]
fn an_observer_that_turns_sees_masses_thrown_out() {
    let place = Place::with(BALL);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(
        check.contains("rotation of the observer: 1 about the axis [0, 0, 5] through [0, 0, 0]"),
        "{check}"
    );
    assert!(check.contains("centrifugal force [2, 0, 0], torque about the origin [0, 0, 0]"), "{check}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    // At half of the load and at the whole.
    let x = &place.history("out")["ball_x"];
    for (x, square) in x.iter().zip([0.0, 0.5, 1.0]) {
        assert!((x - 18.0 / (18.0 - 2.0 * square)).abs() < 1e-13, "{x}");
    }
    let output = place.succeed(&["modes", "box.toml"]);
    assert!(output.stderr.contains("note: frequencies are those that the observer sees, who turns with 1;"));
    let table = place.read("out-modes/modes.csv");
    for (row, expected) in table.lines().skip(1).zip([2.0, 3.0, 4.0]) {
        let omega: f64 = row.split(',').nth(1).unwrap().parse().unwrap();
        assert!((omega - expected).abs() < 1e-12, "{table}");
    }
    let beyond = ["box.toml", "--set", "load.rotation.speed=5", "--output", "beyond"];
    let run = place.emmy(&[&["run"], &beyond[..]].concat());
    assert!(run.code == 3 && run.stderr.contains("beyond a load fraction of 0.359"), "{}", run.stderr);
    assert!(run.stderr.contains("softens the body more than it is stiff"), "{}", run.stderr);
    let modes = place.emmy(&[&["modes"], &beyond[..4], &["own"]].concat());
    assert!(modes.code == 3 && modes.stderr.contains("take a lower speed"), "{}", modes.stderr);
    // A motion has no such observer.
    let time = "time={ scheme = 'DGM', steps = [{ until = 1, size = 0.1 }] }";
    for verb in ["run", "modes", "check"] {
        let refused = place.emmy(&[verb, "box.toml", "--set", time]);
        assert!(refused.code == 2 && refused.stderr.contains("the body itself turns"), "{}", refused.stderr);
    }
}
