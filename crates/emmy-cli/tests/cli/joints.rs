//! `[[rigid]]` and `[[joint]]`: mechanisms, from the input to the answers.

use crate::Place;
use crate::resume::assert_same_rows;

/// A body on a hinge, released at 2 rad from the downward vertical; its centre is 0.5 from the axis.
const PENDULUM: &str = r#"
[[rigid]]
name = "pendulum"
mass = 3.0
centre = [0.4546487134128409, 0.0, 0.2080734182735712]
inertia = [0.3, 0.4, 0.2]

[[joint]]
revolute = { between = ["pendulum", "ground"], at = [0, 0, 0], axis = [0, 1, 0] }

[[load]]
acceleration = [0, 0, -9.81]

[time]
scheme = "DGM"
degree = 3
steps = [{ until = 2.0, size = 0.05 }]

[output]
directory = "out"
every = 0
probes = [{ name = "centre", point = [0.4546487134128409, 0.0, 0.2080734182735712] }]
"#;

fn last_place(place: &Place, directory: &str, probe: &str) -> [f64; 3] {
    let history = place.history(directory);
    ["x", "y", "z"].map(|axis| *history[&format!("{probe}_{axis}")].last().unwrap())
}

fn assert_near(own: [f64; 3], expected: [f64; 3], tolerance: f64) {
    let far = (0..3).any(|i| (own[i] - expected[i]).abs() > tolerance);
    assert!(!far, "{own:?} is not {expected:?}");
}

/// Exact solution by elliptic functions; the error of the method is 1.3e-7.
#[test]
fn a_pendulum_on_a_hinge() {
    let place = Place::with(PENDULUM);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "mesh       none: all bodies are rigid\n",
        "rigid      pendulum: mass 3, centre [0.454649, 0, 0.208073]\n",
        "joint      joint-1: revolute, pendulum and the ground, at [0, 0, 0], axis [0, 1, 0]\n",
        "mechanism  1 rigid body, 1 joint with 5 constraints; 1 degree of freedom\n",
        "load       acceleration on all masses: force [0, 0, -29.43]",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    place.succeed(&["run", "box.toml", "--quiet"]);
    let exact = [0.4852565253255716, 0.0, -0.1205242906179201];
    assert_near(last_place(&place, "out", "centre"), exact, 2e-7);
    // Several joints meet in a run that is stopped and resumed as they do in one that is not.
    place.succeed(&["run", "box.toml", "--quiet", "--until", "1.0", "--output", "parts"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "2.0"]);
    assert_same_rows(&place, "out", "parts");
    let failed = place.emmy(&["resume", "parts", "--until", "3", "--set", "rigid.0.mass=4"]);
    assert!(failed.code == 2 && failed.stderr.contains("`rigid.0.mass` is 4, but 3.0"), "{}", failed.stderr);
}

/// The time of a release is not the end of an equal step; after it, the centre flies on a parabola.
#[test]
fn a_pendulum_that_is_let_go() {
    let hinge = "axis = [0, 1, 0] }\n";
    let input =
        PENDULUM.replace(hinge, &format!("{hinge}until = 0.84375\n")).replace("size = 0.05", "size = 0.0625");
    let place = Place::with(&input);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(check.contains("           released at t = 0.84375\n"), "{check}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    let events = place.read("out/events.csv");
    assert!(
        events.contains("15,0.84375,release,\"the joint joint-1 was released (until = 0.84375)\"\n"),
        "{events}"
    );
    let history = place.history("out");
    let release = history["time"].iter().position(|t| *t == 0.84375).unwrap();
    let [last, middle] = [history["time"].len() - 1, release + 8];
    let of = |name: &str, row: usize| history[name][row];
    let times = [release, middle, last].map(|row| of("time", row));
    // Heights less the fall are linear in time.
    let free = [release, middle, last].map(|row| {
        let fallen = 0.5 * 9.81 * (of("time", row) - times[0]).powi(2);
        of("centre_z", row) + fallen
    });
    let slopes = [1, 2].map(|i| (free[i] - free[0]) / (times[i] - times[0]));
    assert!((slopes[0] - slopes[1]).abs() < 1e-11, "{slopes:?}");
    assert_eq!((of("joint-1_force_z", last), of("joint-1_moment_y", last)), (0.0, 0.0));
    assert!(of("joint-1_force_z", release) > 0.0);
    let (spin, angle) =
        (of("pendulum_spin_y", last), of("joint-1_angle", last) - of("joint-1_angle", release));
    // The spin is constant, the angle as exact as steps of degree 3.
    assert!((angle - spin * (times[2] - times[0])).abs() < 1e-7, "{spin} {angle}");
    for (name, until) in [("before", "0.5"), ("at", "0.84375"), ("after", "1.21875")] {
        place.succeed(&["run", "box.toml", "--quiet", "--until", until, "--output", name]);
        place.succeed(&["resume", name, "--quiet", "--until", "2.0"]);
        assert_same_rows(&place, "out", name);
    }
    let failed = place.emmy(&["resume", "after", "--until", "3", "--set", "joint.0.until=2.5"]);
    assert!(
        failed.code == 2 && failed.stderr.contains("`joint.0.until` is 2.5, but 0.84375"),
        "{}",
        failed.stderr
    );
}

/// A crank that is turned, a rod, and a slider on the x axis.
const SLIDER_CRANK: &str = r#"
[[rigid]]
name = "crank"
mass = 1.0
centre = [0.5, 0.0, 0.0]
inertia = [0.01, 0.1, 0.1]

[[rigid]]
name = "rod"
mass = 2.0
centre = [3.0, 0.0, 0.0]
inertia = [0.02, 3.0, 3.0]

[[rigid]]
name = "slider"
mass = 1.0
centre = [5.0, 0.0, 0.0]
inertia = [0.1, 0.1, 0.1]

[[joint]]
name = "motor"
revolute = { between = ["crank", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }
angle = "2*t^2"

[[joint]]
revolute = { between = ["rod", "crank"], at = [1, 0, 0], axis = [0, 0, 1] }

[[joint]]
revolute = { between = ["rod", "slider"], at = [5, 0, 0], axis = [0, 0, 1] }

[[joint]]
prismatic = { between = ["slider", "ground"], at = [5, 0, 0], axis = [1, 0, 0] }

[time]
scheme = "DGM"
degree = 2
steps = [{ until = 1.0, size = 0.05 }]

[output]
directory = "out"
probes = [{ name = "slider-centre", point = [5, 0, 0] }]
"#;

/// The place of the slider is that of geometry, at the ends of steps to round-off.
#[test]
fn a_driven_slider_crank_is_where_geometry_says() {
    let place = Place::with(SLIDER_CRANK);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "joint      motor: revolute, crank and the ground, at [0, 0, 0], axis [0, 0, 1]\n           angle: 2*t^2\n",
        "mechanism  3 rigid bodies, 4 joints with 21 constraints; 1 degree of freedom, which is driven\n",
        "3 of 21 constraints follow from the others: the motion is unique, their single forces are not\n",
        "they are constraints of the joint joint-4\n",
        "body       all: mass 4, centre [2.875, 0, 0]\n",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    for (time, x) in history["time"].iter().zip(&history["slider-centre_x"]) {
        let angle = 2.0 * time * time;
        let exact = angle.cos() + (16.0 - angle.sin().powi(2)).sqrt();
        assert!((x - exact).abs() < 1e-10, "t = {time}: {x} is not {exact}");
    }
    // All energy comes from the drive.
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-10, "{energy} {work}");
    }
}

/// Two hinges on one axis turn a leaf by different angles. The steps are cut, and the short ones must not pass either.
#[test]
fn given_motions_that_contradict_each_other_end_the_run() {
    let input = r#"
rigid = [{ name = "leaf", mass = 1.0, centre = [0.5, 0, 0], inertia = [0.1, 0.1, 0.1] }]
joint = [
  { revolute = { between = ["leaf", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }, angle = "0.5*t^2" },
  { revolute = { between = ["leaf", "ground"], at = [0, 0, 1], axis = [0, 0, 1] }, angle = "0.4*t^2" },
]
time = { scheme = "DGM", degree = 2, steps = [{ until = 2.0, size = 0.05 }] }
output = { directory = "out", every = 0 }
"#;
    let place = Place::with(input);
    let failed = place.emmy(&["run", "box.toml", "--quiet"]);
    assert_eq!(failed.code, 3, "{failed:?}");
    for words in [
        "the given motions of \"joint-1\" and \"joint-2\" contradict each other",
        "; look at the joints and their given motions at this time\n",
    ] {
        assert!(failed.stderr.contains(words), "{words}: {}", failed.stderr);
    }
    // With different speeds at the start no step is tried.
    place.write("fast.toml", &input.replace("0.5*t^2", "3*t").replace("0.4*t^2", "2*t"));
    for verb in ["check", "run"] {
        let failed = place.emmy(&[verb, "fast.toml"]);
        let words = "no motion obeys all joints at t = 0: the given motions of \"joint-1\" and \"joint-2\" contradict each other";
        assert!(failed.code == 2 && failed.stderr.contains(words), "{failed:?}");
    }
}

/// A parallelogram of two cranks and a coupler, which turns one crank as fast as the other.
fn parallelogram(left: &str, right: &str) -> String {
    format!(
        r#"
rigid = [
  {{ name = "left", mass = 1.0, centre = [0, 0.5, 0], inertia = [0.1, 0.1, 0.1] }},
  {{ name = "right", mass = 1.0, centre = [1, 0.5, 0], inertia = [0.1, 0.1, 0.1] }},
  {{ name = "coupler", mass = 1.0, centre = [0.5, 1, 0], inertia = [0.1, 0.1, 0.1] }},
]
joint = [
  {{ name = "foot", revolute = {{ between = ["left", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }}{left} }},
  {{ name = "other", revolute = {{ between = ["right", "ground"], at = [1, 0, 0], axis = [0, 0, 1] }}{right} }},
  {{ revolute = {{ between = ["coupler", "left"], at = [0, 1, 0], axis = [0, 0, 1] }} }},
  {{ revolute = {{ between = ["coupler", "right"], at = [1, 1, 0], axis = [0, 0, 1] }} }},
]
time = {{ scheme = "DGM", degree = 2, steps = [{{ until = 1.0, size = 0.1 }}] }}
output = {{ directory = "out", every = 0 }}
"#
    )
}

/// The drives are named although all four joints are open, and not the one that has a body of its own.
#[test]
fn drives_that_contradict_each_other_by_way_of_other_joints_are_named() {
    let alone = "[\n  { name = \"wheel\", mass = 1.0, centre = [5, 0, 0], inertia = [0.1, 0.1, 0.1] },\n";
    let third = "[\n  { name = \"axle\", revolute = { between = [\"wheel\", \"ground\"], at = [5, 0, 0], axis = [0, 0, 1] }, angle = \"t\" },\n";
    let with_third = |input: String| {
        input.replacen("rigid = [\n", &format!("rigid = {alone}"), 1).replacen(
            "joint = [\n",
            &format!("joint = {third}"),
            1,
        )
    };
    let words = "the given motions of \"foot\" and \"other\" contradict each other";
    for (right, code) in [("2*t", 2), ("t + 0.3*t^2", 3)] {
        let input = parallelogram(", angle = \"t\"", &format!(", angle = \"{right}\""));
        let place = Place::with(&with_third(input));
        let failed = place.emmy(&["run", "box.toml", "--quiet"]);
        assert!(failed.code == code && failed.stderr.contains(words), "{right}: {failed:?}");
    }
}

#[test]
fn forces_that_are_not_unique_are_noted_with_the_names_of_their_joints() {
    let forces =
        "note: single forces and moments of the joints `foot`, `other`, `joint-3`, `joint-4` are not unique";
    let drives =
        ", nor are those by which they obey the given motions of `foot`, `other`: some constraints follow";
    for (right, words) in [
        (
            "",
            format!(
                "{forces}: some constraints follow from the others; Emmy's forces are the smallest ones\n"
            ),
        ),
        (", angle = \"t\"", format!("{forces}{drives}")),
    ] {
        let place = Place::with(&parallelogram(", angle = \"t\"", right));
        for verb in ["check", "run"] {
            let outcome = place.succeed(&[verb, "box.toml"]);
            assert!(outcome.stderr.contains(&words), "{verb}: {}", outcome.stderr);
        }
        let summary = place.summary("out");
        let note = summary["notes"][0].as_str().unwrap().to_string();
        assert!(words.contains(&note) || format!("note: {note}").starts_with(&words), "{note}");
    }
    let place = Place::with(PENDULUM);
    assert!(!place.succeed(&["check", "box.toml"]).stderr.contains("not unique"));
}

/// A door that hangs at rest: its energy is the square of a velocity of round-off, and no scale for a residual.
#[test]
fn a_mechanism_at_rest_closes_its_balances() {
    let input = r#"
rigid = [{ name = "door", mass = 20.0, centre = [0.5, 0.0, 1.0], inertia = [7.0, 9.0, 2.0] }]
joint = [{ revolute = { between = ["door", "ground"], at = [0, 0, 0], axis = [0, 0, 1] } }]
load = [{ acceleration = [0, 0, -9.81] }]
time = { scheme = "DGM", degree = 2, steps = [{ until = 1.0, size = 0.1 }] }
limits = { energy = 1e-10, angular_momentum = 1e-10 }
output = { directory = "out", every = 0 }
"#;
    let place = Place::with(input);
    let run = place.succeed(&["run", "box.toml"]).stderr;
    for words in [" of the largest possible T + V)\n", " of the largest possible |L|)\n"] {
        assert!(run.contains(words), "{words}{run}");
    }
    let summary = place.summary("out");
    let number = |name: &str| summary[name].as_f64().unwrap();
    assert!(number("largest_energy") < 1e-30 && number("energy_drift") < 1e-15, "{summary}");
    // The weight over the diagonal of the box of the centre and the hinge, and its moment about the hinge.
    let [weight, size] = [20.0 * 9.81, 1.25f64.sqrt()];
    assert!(number("energy_scale") >= weight * size, "{summary}");
    // A push of 1e-9 rad/s is a motion, with the scale of its own energy.
    let unlimited = input.replace("limits = { energy = 1e-10, angular_momentum = 1e-10 }\n", "");
    place.write("pushed.toml", &format!("initial = {{ angular_velocity = [0, 0, 1e-9] }}{unlimited}"));
    let pushed = place.succeed(&["run", "pushed.toml"]).stderr;
    assert!(pushed.contains(" of the largest T + V)\n"), "{pushed}");
}

#[test]
fn a_release_after_the_end_is_noted() {
    let hinge = "axis = [0, 1, 0] }\n";
    let place = Place::with(&PENDULUM.replace(hinge, &format!("{hinge}until = 2.5\n")));
    let note = "note: joint `joint-1`: the run ends at t = 2, before its release at t = 2.5\n";
    for verb in ["check", "run"] {
        let outcome = place.succeed(&[verb, "box.toml"]);
        assert!(outcome.stderr.contains(note), "{verb}: {}", outcome.stderr);
    }
    let longer = place.succeed(&["check", "box.toml", "--until", "3"]).stderr;
    assert!(!longer.contains("before its release"), "{longer}");
}

/// Steps of more than a turn.
#[test]
fn steps_of_a_mechanism_that_fail_do_not_ask_for_a_finer_mesh() {
    let input = r#"
rigid = [{ name = "top", mass = 20.0, centre = [0.5, 0.0, 1.0], inertia = [7.0, 9.0, 2.0] }]
joint = [{ spherical = { between = ["top", "ground"], at = [0, 0, 0] } }]
initial = { angular_velocity = [100, 30, 200] }
time = { scheme = "DGM", degree = 2, steps = [{ until = 1.0, size = 1.0 }], smallest_step = 0.5 }
output = { directory = "out", every = 0 }
"#;
    let failed = Place::with(input).emmy(&["run", "box.toml", "--quiet"]);
    assert_eq!(failed.code, 3, "{failed:?}");
    for words in [
        "try another scheme, or a smaller `smallest_step`, and look at the joints, their springs and the loads at this time",
        " of the rigid body \"top\"; try a smaller step, or more iterations",
    ] {
        assert!(failed.stderr.contains(words), "{words}: {}", failed.stderr);
    }
    assert!(!failed.stderr.contains("mesh"), "{}", failed.stderr);
}

#[test]
fn a_mechanism_that_cannot_move_has_no_modes() {
    let bolt = PENDULUM.replace("revolute", "fixed").replace(", axis = [0, 1, 0]", "");
    let place = Place::with(&bolt);
    for (flags, prefix) in [(&["--count", "1"][..], "--count: "), (&[], "")] {
        let failed = place.emmy(&[&["modes", "box.toml"], flags].concat());
        let words = format!("  × {prefix}1 mode was requested, but the body has no free degree of freedom\n");
        assert!(failed.code == 2 && failed.stderr.contains(&words), "{failed:?}");
    }
}

/// A mass on a winch: the length of the rope is given, and the same by a table.
#[test]
fn a_link_whose_length_is_given() {
    let input = r#"
rigid = [{ name = "hook", mass = 1.0, centre = [0, 0, -1] }]
load = [{ group = "hook", force = [0, 0, -9.81] }]
joint = [{ distance = { between = ["hook", "ground"], points = [[0, 0, -1], [0, 0, 0]], length = "1 + t^2/2" } }]
time = { scheme = "DGM", degree = 1, steps = [{ until = 1.0, size = 0.1 }] }
output = { directory = "out", every = 0, probes = [{ name = "end", point = [0, 0, -1] }] }
"#;
    let place = Place::with(input);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "rigid      hook: point mass 1, centre [0, 0, -1]\n",
        "joint      joint-1: distance, hook and the ground, from [0, 0, -1] to [0, 0, 0], length 1\n",
        "           change of the distance: 1 + t^2/2 - 1.0\n",
        "load       force on hook: force [0, 0, -9.81]",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert_near(last_place(&place, "out", "end"), [0.0, 0.0, -1.5], 1e-12);
    let table = input.replace("\"1 + t^2/2\"", "[[0, 1], [1, 1.5]]");
    place.write("table.toml", &table.replace("\"out\"", "\"table\""));
    place.succeed(&["run", "table.toml", "--quiet"]);
    assert_near(last_place(&place, "table", "end"), [0.0, 0.0, -1.5], 1e-12);
}

/// An elastic door on a free frame, by two corners of its edge: numbers of an independent implementation.
const DOOR: &str = r#"
[mesh]
box = { size = [3, 0.5, 2], cells = [3, 1, 2] }

[[region]]
density = 1.0
material.neo-hooke = { lambda = 4000.0, mu = 2000.0 }

[[rigid]]
name = "frame"
mass = 5.0
centre = [-0.5, 0.0, 1.0]
inertia = [2.0, 2.5, 1.0]

[[joint]]
spherical = { between = ["body", "frame"], at = [0, 0, 0] }

[[joint]]
spherical = { between = ["x-min", "frame"], at = [0, 0, 2] }

[[initial]]
angular_velocity = [0.2, 0.1, 0.3]

[[initial]]
group = "body"
angular_velocity = [0.2, 0.1, 2.3]

[time]
scheme = "DGM"
degree = 2
steps = [{ until = 2.0, size = 0.05 }]

[output]
directory = "out"
every = 20
probes = [{ name = "corner", point = [3, 0, 0] }, { name = "middle", point = [-0.5, 0, 1] }]
"#;

#[test]
fn an_elastic_door_swings_on_a_flying_frame_as_elsewhere() {
    let place = Place::with(DOOR);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "mesh       24 nodes, 6 cells (6 hex8)\n",
        "region     all cells: 6 cells, volume 3, mass 3, ",
        "body       all regions: 6 cells, volume 3, mass 8, ",
        "joint      joint-1: spherical, node 0 at [0, 0, 0] and frame, at [0, 0, 0]\n",
        "mechanism  1 rigid body, 2 joints with 6 constraints; elastic parts are joined\n",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    assert!(!check.contains("group      frame"), "{check}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    for (name, expected) in [("kinetic_energy", 22.676734905857177), ("strain_energy", 0.10951509414249672)] {
        let own = *history[name].last().unwrap();
        assert!((own - expected).abs() < 1e-8, "{name}: {own} is not {expected}");
    }
    let corner = [-2.2054562791101127, 0.5005178502045893, 0.46761605011585133];
    assert_near(last_place(&place, "out", "corner"), corner, 1e-8);
    let middle = [0.5966190919652725, 2.447056135250055, 0.7917096507575111];
    assert_near(last_place(&place, "out", "middle"), middle, 1e-8);
    assert!(place.read("out/report.html").contains("displacement"));
}

/// A hub that a support holds at its centre turns there, and its axes carry a load.
#[test]
fn a_support_holds_the_centre_of_a_rigid_body() {
    let input = r#"
rigid = [{ name = "hub", mass = 2.0, centre = [1, 0, 0], inertia = [0.1, 0.2, 0.25] }]
support = [{ group = "hub", fix = ["x", "y", "z"] }]
initial = [{ group = "hub", angular_velocity = [0, 0, 3], about = [1, 0, 0] }]
time = { scheme = "DGM", degree = 2, steps = [{ until = 1.0, size = 0.05 }] }
output = { directory = "out", every = 0, probes = [{ name = "place", point = [1, 0, 0] }] }
"#;
    let place = Place::with(input);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(check.contains("support    hub: x, y, z fixed, 3 degrees of freedom\n"), "{check}");
    assert!(check.contains("1 rigid body, 0 joints with 0 constraints; 3 degrees of freedom\n"), "{check}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert_near(last_place(&place, "out", "place"), [1.0, 0.0, 0.0], 1e-15);
    let history = place.history("out");
    history["kinetic_energy"].iter().for_each(|energy| assert!((energy - 1.125).abs() < 1e-12, "{energy}"));
}

/// A mass on a spring of stiffness 4, and one that a force pulls along a slide against a damper.
#[test]
fn springs_dampers_and_motors() {
    let input = r#"
rigid = [
  { name = "bob", mass = 1.0, centre = [1, 0, 0] },
  { name = "sledge", mass = 2.0, centre = [0, 3, 0], inertia = [1, 1, 1] },
]
joint = [
  { line = { between = ["bob", "ground"], points = [[1, 0, 0], [0, 0, 0]] }, spring = { stiffness = 4, rest = 0.9 } },
  { prismatic = { between = ["sledge", "ground"], at = [0, 3, 0], axis = [0, 1, 0] }, damping = 4, force = "6" },
]
time = { scheme = "DGM", degree = 3, steps = [{ until = 1.0, size = 0.05 }] }
output = { directory = "out", every = 0, probes = [{ name = "x", point = [1, 0, 0] }, { name = "y", point = [0, 3, 0] }] }
"#;
    let place = Place::with(input);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "joint      joint-1: line, bob and the ground, from [1, 0, 0] to [0, 0, 0], length 1\n",
        "           spring: stiffness 4, rest 0.9\n",
        "           damping 4\n           force: 6\n",
        "mechanism  2 rigid bodies, 2 joints with 5 constraints; 4 degrees of freedom\n",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert_near(last_place(&place, "out", "x"), [0.9 + 0.1 * 2f64.cos(), 0.0, 0.0], 1e-7);
    // 2 y'' + 4 y' = 6: y = 1.5 (t - (1 - exp(-2 t))/2).
    let slide = 1.5 * (1.0 - 0.5 * (1.0 - (-2f64).exp()));
    assert_near(last_place(&place, "out", "y"), [0.0, 3.0 + slide, 0.0], 1e-7);
    // Spring, damper and force act from outside.
    let summary = place.summary("out");
    for balance in ["worst_linear_momentum_residual", "worst_angular_momentum_residual"] {
        assert!(summary[balance].as_f64().unwrap() < 1e-12, "{balance}: {summary}");
    }
}

#[test]
fn units_stand_behind_moments_of_inertia_and_places() {
    let place = Place::with(&format!("units.system = \"m-kg-s\"\n{PENDULUM}"));
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for part in [
        "pendulum: mass 3 kg, centre [0.454649, 0, 0.208073] m\n",
        "inertia about the centre [[0.3, 0, 0], [0, 0.4, 0], [0, 0, 0.2]] kg·m²\n",
        "revolute, pendulum and the ground, at [0, 0, 0] m, axis [0, 1, 0]\n",
    ] {
        assert!(check.contains(part), "{part}{check}");
    }
}

#[test]
fn what_has_no_joints_yet_says_so() {
    let place = Place::with(DOOR);
    let failed = place.emmy(&["split", "box.toml", "--parts", "2"]);
    assert_ne!(failed.code, 0);
    let words = "several ranks do not compute a body with couplings, rigid bodies or joints";
    assert!(failed.stderr.contains(words), "{}", failed.stderr);
}

/// Its centre there for k = 46.
const REST: [f64; 3] = [0.496_906_752_126_060_34, 0.0, 0.055_530_889_525_830_705];

/// The pendulum on a torsion spring: k phi = m g l sin(2 - phi) at rest.
fn on_a_spring(stiffness: f64) -> String {
    let joint = "axis = [0, 1, 0] }\n";
    PENDULUM.replace(joint, &format!("{joint}spring = {{ stiffness = {stiffness} }}\n"))
}

/// omega^2 = k / J about the axis, J = 0.4 + 3/4; about the equilibrium (k + m g l cos(2 - phi)) / J.
#[test]
fn modes_of_a_pendulum_on_a_spring() {
    let place = Place::with(&on_a_spring(46.0));
    place.write("hanging.toml", &format!("[equilibrium]\n{}", on_a_spring(46.0)));
    for (file, expected) in [("box.toml", 40f64.sqrt()), ("hanging.toml", 6.211_190_876_590_33)] {
        let modes = place.succeed(&["modes", file, "--output", "own"]);
        let table = place.read("own/modes.csv");
        let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
        assert!((row[1].parse::<f64>().unwrap() / expected - 1.0).abs() < 1e-10, "{}", modes.stdout);
        assert_eq!(table.lines().count(), 2);
    }
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(
        check.contains("period     0.993459 in the lowest elastic mode (frequency 1.00658)\n"),
        "{check}"
    );
    place.write("free.toml", PENDULUM);
    let free = place.succeed(&["modes", "free.toml", "--output", "free"]);
    assert!(free.stdout.contains("rigid") && free.stderr.contains("1 rigid mode"), "{}", free.stderr);
}

#[test]
fn an_equilibrium_of_a_pendulum_on_a_spring() {
    let [head, rest] = PENDULUM.split_once("[time]").map(|(head, rest)| [head, rest]).unwrap();
    let output = rest.split_once("[output]").unwrap().1;
    let static_input = |spring: &str| {
        let joint = "axis = [0, 1, 0] }\n";
        let head = head.replace(joint, &format!("{joint}{spring}"));
        format!("{head}[equilibrium]\nload_steps = 4\n\n[output]{output}")
    };
    let place = Place::with(&static_input("spring = { stiffness = 46.0 }\n"));
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert_near(last_place(&place, "out", "centre"), REST, 1e-10);
    // The hinge carries the weight from the first row of a motion on.
    place.write("rests.toml", &format!("[equilibrium]\n{}", on_a_spring(46.0)));
    place.succeed(&["run", "rests.toml", "--quiet", "--output", "rests"]);
    let history = place.history("rests");
    for (name, column) in
        history.iter().filter(|(name, _)| name.contains("_force_") || name.ends_with("_torque"))
    {
        assert!((column[0] - column[1]).abs() < 1e-7, "{name}: {column:?}");
    }
    assert!(history.iter().any(|(name, column)| name.ends_with("_force_z") && column[0] > 1.0));
    place.write("free.toml", &static_input(""));
    for verb in ["check", "run"] {
        let failed = place.emmy(&[verb, "free.toml"]);
        assert_eq!(failed.code, 2, "{}", failed.stderr);
        let words = "nothing holds the part `pendulum` against rotation about y through [0, 0, 0]";
        assert!(failed.stderr.contains(words), "{}", failed.stderr);
    }
}

/// A leaf with J = 0.1 + 1 0.5^2 about its hinge turns by 2 rad/s from the first instant on: J w^2 / 2 = 0.7.
#[test]
fn given_motions_that_begin_with_a_speed_are_noted() {
    let place = Place::with(
        r#"
rigid = [{ name = "leaf", mass = 1.0, centre = [0.5, 0, 0], inertia = [0.1, 0.1, 0.1] }]
joint = [{ revolute = { between = ["leaf", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }, angle = "2*t" }]
time = { scheme = "DGM", degree = 2, steps = [{ until = 0.1, size = 0.05 }] }
output = { directory = "out", every = 0 }
"#,
    );
    let note = "given motions of joints begin with a speed, which adds 0.7 of kinetic energy at the start\n";
    for verb in ["check", "run"] {
        let outcome = place.succeed(&[verb, "box.toml"]);
        let text = outcome.stdout + &outcome.stderr;
        assert!(text.contains(note), "{verb}: {text}");
    }
    assert_near([place.history("out")["kinetic_energy"][0], 0.0, 0.0], [0.7, 0.0, 0.0], 1e-12);
}

/// A velocity along the axis of the hinge is not a motion of the pendulum: all of its energy, m v^2 / 2, is taken out.
#[test]
fn velocities_that_joints_do_not_allow_are_taken_out_with_a_note() {
    let place = Place::with(&PENDULUM.replace("[time]", "[initial]\nvelocity = [0, 1, 0]\n\n[time]"));
    let note = "the joints take 1.5 of 1.5 of the kinetic energy out of the initial velocities\n";
    for verb in ["check", "run"] {
        let outcome = place.succeed(&[verb, "box.toml"]);
        let text = outcome.stdout + &outcome.stderr;
        assert!(text.contains(note), "{verb}: {text}");
    }
    assert!(place.history("out")["kinetic_energy"][0].abs() < 1e-20);
}
