//! Quantities in the history: reactions, probes, extremes, values of groups.

use crate::report::manifest;
use crate::{BOX, Place};

/// A cube in uniaxial strain: one end is held, the other moves with the velocity 0.1; density 2, lambda 1000, mu 500.
const STRETCH: &str = r#"
[mesh]
box = { size = [1, 1, 1], cells = [2, 1, 1] }

[[region]]
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }

[[support]]
group = "x-min"
fix = ["x", "y", "z"]

[[support]]
group = "x-max"
fix = ["y", "z"]
move = { x = "0.1*t" }

[[support]]
group = "body"
fix = ["y", "z"]

[time]
scheme = "DGM"
steps = [{ until = 2.0, size = 0.1 }]

[output]
directory = "out"
every = 5
reactions = ["x-max", "x-min"]
extremes = ["von_mises_stress", "displacement"]
probes = [
  { name = "end", point = [1, 0, 0], quantities = ["displacement", "velocity", "cauchy_stress", "von_mises_stress"] },
]
values = [
  { name = "stress", group = "body", quantity = "cauchy_stress" },
  { name = "energy", quantity = "strain_energy_density", measure = "total" },
  { name = "kinetic", quantity = "cell_kinetic_energy_density", measure = "total" },
  { name = "end_stress", group = "x-max", quantity = "von_mises_stress", measure = "max" },
  { name = "mean_velocity", group = "x-max", quantity = "velocity" },
]
"#;

#[test]
fn the_answers_of_a_stretched_cube_are_those_of_theory() {
    let place = Place::with(STRETCH);
    let closing = place.succeed(&["run", "box.toml"]).stderr;
    let history = place.history("out");
    let column = |name: &str| history.get(name).unwrap_or_else(|| panic!("{name}: {:?}", history.keys()));
    let near = |name: &str, row: usize, exact: f64, scale: f64| {
        let own = column(name)[row];
        assert!((own - exact).abs() < 1e-9 * scale, "{name} in row {row}: {own} is not {exact}");
    };
    for row in [5, 20] {
        // The middle nodes vibrate a little, the mean stretch is exact; the stress is that of neo-Hooke.
        let stretch = 1.0 + 0.1 * column("time")[row];
        near("end_displacement_x", row, stretch - 1.0, 1.0);
        near("end_velocity_x", row, 0.1, 1.0);
        let energy = column("energy")[row];
        assert!(
            (energy - column("strain_energy")[row]).abs() < 1e-13 * energy,
            "the whole body is the group"
        );
        let kinetic = column("kinetic_energy")[row];
        assert!((column("kinetic")[row] - kinetic).abs() < 1e-13 * kinetic.max(1e-3));
        near("end_von_mises_stress", row, column("end_stress")[row], 1.0);
        let largest = column("max_von_mises_stress")[row];
        assert!(largest >= column("end_stress")[row] && largest < 1.5 * column("end_stress")[row]);
        near("max_displacement", row, stretch - 1.0, 1.0);
    }
    assert!(history["x-min_force_x"][0].is_nan(), "the start has no reactions");
    // The loads of both ends over a step change the momentum and do the work: dV + dT = F . du.
    for row in 1..=20 {
        let change = |name: &str| column(name)[row] - column(name)[row - 1];
        let force = column("x-max_force_x")[row] + column("x-min_force_x")[row];
        assert!((change("linear_momentum_x") - 0.1 * force).abs() < 1e-12, "row {row}");
    }
    let summary = place.summary("out");
    let largest = column("max_von_mises_stress").iter().copied().fold(0.0, f64::max);
    assert_eq!(summary["largest_von_mises_stress"], largest);
    let step = summary["largest_von_mises_stress_step"].as_u64().unwrap() as usize;
    assert_eq!(column("max_von_mises_stress")[step], largest);
    assert_eq!(summary["largest_von_mises_stress_time"], column("time")[step]);
    assert!(
        summary["largest_von_mises_stress_node"].is_u64()
            && summary["largest_von_mises_stress_point"].is_array()
    );
    assert!(closing.contains("largest von Mises stress: "), "{closing}");
    // One region is the body.
    assert!(summary.get("largest_in_regions").is_none() && !closing.contains("\n  in "), "{closing}");
    // Stopped and resumed: the same file, bit for bit, but for the wall time.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.7"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "2"]);
    let parts = place.history("parts");
    for (name, numbers) in history.iter().filter(|(name, _)| *name != "wall_seconds") {
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(numbers), bits(&parts[name]), "{name}");
    }
    assert_eq!(place.summary("parts")["largest_von_mises_stress"], largest);
    place.succeed(&["compare", "out", "parts"]);
    place.succeed(&["report", "out"]);
}

/// Homogeneous: one cell, so that no node is free along x, and the stress is uniform:
/// `sigma_xx = (mu (a^2 - 1) + lambda ln a)/a`, `sigma_yy = lambda ln a/a`, `W = mu/2 (a^2 - 1) - mu ln a +
/// lambda/2 (ln a)^2` for the stretch a.
#[test]
fn uniform_tension_has_the_stress_and_the_reaction_of_theory() {
    let place = Place::with(&STRETCH.replace("cells = [2, 1, 1]", "cells = [1, 1, 1]"));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    let energy = |a: f64| 250.0 * (a * a - 1.0) - 500.0 * a.ln() + 500.0 * a.ln().powi(2);
    for row in 1..=20 {
        let near = |name: &str, exact: f64| {
            let own = history[name][row];
            assert!(
                (own - exact).abs() < 1e-10 * exact.abs().max(1.0),
                "{name}, row {row}: {own} is not {exact}"
            );
        };
        let a = 1.0 + 0.01 * row as f64;
        let [along, across] = [(500.0 * (a * a - 1.0) + 1000.0 * a.ln()) / a, 1000.0 * a.ln() / a];
        for name in ["stress", "end_cauchy_stress"] {
            near(&format!("{name}_xx"), along);
            near(&format!("{name}_yy"), across);
            near(&format!("{name}_xy"), 0.0);
        }
        near("max_von_mises_stress", along - across);
        near("energy", energy(a));
        // int rho v^2/2 with v = 0.1 X.
        near("kinetic", 2.0 * 0.1 * 0.1 / 6.0);
        near("end_velocity_y", 0.0);
        if row > 1 {
            // Nothing accelerates, and the discrete gradient does the work exactly.
            let force = (energy(a) - energy(a - 0.01)) / 0.01;
            near("x-max_force_x", force);
            near("x-min_force_x", -force);
            // The force of an end acts at its centre.
            near("x-max_moment_z", -0.5 * force);
            near("x-max_moment_y", 0.5 * force);
        }
    }
}

/// Reactions are there by default, also for groups with names that CSV must quote.
#[test]
fn names_of_groups_are_quoted() {
    let network = r#"
mesh.network = { points = [[0, 0, 0], [1, 0, 0], [2, 0, 0]], links = [[0, 1], [1, 2]], groups = { "left, \"upper\"" = [0] } }
region = [{ density = 2.0, material.bar = { youngs_modulus = 10.0, area = 0.5 } }]
load = [{ acceleration = [0, 0, -1] }]
support = [{ group = 'left, "upper"', fix = ["x", "y", "z"] }]
time = { scheme = "DGM", steps = [{ until = 0.5, size = 0.1 }] }
output = { directory = "out", every = 0 }
"#;
    let place = Place::with(network);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let header = place.read("out/history.csv").lines().next().unwrap().to_string();
    assert!(header.contains(r#","left, ""upper""_force_x","left, ""upper""_force_y","#), "{header}");
    place.succeed(&["report", "out"]);
    let json = place.succeed(&["run", "box.toml", "--quiet", "--json"]).stdout;
    assert!(json.lines().next().unwrap().contains(r#""left, \"upper\"_force_x":null"#), "{json}");
    let last: serde_json::Value = serde_json::from_str(json.lines().nth(5).unwrap()).unwrap();
    let force = last[r#"left, "upper"_force_z"#].as_f64().unwrap();
    assert!(force > 0.0 && force < 2.0 * 2.0 * 0.5, "{force}");
}

#[test]
fn a_history_without_requests_has_the_reactions_of_the_supports() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let header = place.read("out/history.csv").lines().next().unwrap().to_string();
    let end = "tip_x,tip_y,tip_z,y-min_force_x,y-min_force_y,y-min_force_z,y-min_moment_x,y-min_moment_y,y-min_moment_z";
    assert!(header.ends_with(end), "{header}");
    // The traction grows like t/0.5 from 0 to 10 on an area of 1: its impulse, and that of the support.
    let history = place.history("out");
    for row in 1..history["time"].len() {
        let [t, h] = ["time", "step_size"].map(|name| history[name][row]);
        let change = history["linear_momentum_z"][row] - history["linear_momentum_z"][row - 1];
        let load = 20.0 * h * (t - 0.5 * h);
        assert!((change - load - h * history["y-min_force_z"][row]).abs() < 1e-12, "row {row}");
    }
    // Without any, the columns are those of before.
    let place = Place::with(&BOX.replace("every = 2", "every = 2\nreactions = []"));
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert!(place.read("out/history.csv").lines().next().unwrap().ends_with("tip_x,tip_y,tip_z"));
}

/// Two cubes side by side with a common face, both stretched alike along x: `von Mises = mu (a^2 - 1)/a` in each of
/// them for the stretch a, which is largest at t = 0.5.
const SIDES: &str = r#"
mesh.file = "sides.inp"
region = [
  { group = "soft", density = 2, material.neo-hooke = { lambda = 10, mu = 5 } },
  { group = "stiff", density = 6, material.neo-hooke = { lambda = 1000, mu = 500 } },
]
support = [
  { group = "left", fix = ["x", "y", "z"] },
  { group = "right", fix = ["y", "z"], move = { x = [[0, 0], [0.5, 0.05], [1, 0]] } },
]
time = { scheme = "DGM", steps = [{ until = 1, size = 0.1 }] }
[output]
directory = "out"
every = 5
reactions = []
extremes = ["von_mises_stress", "cell_von_mises_stress", "displacement"]
probes = [
  { name = "mean", point = [1, 1, 0], quantities = ["von_mises_stress"] },
  { name = "side", point = [1, 2, 0], group = "soft", quantities = ["von_mises_stress", "momentum_density"] },
]
values = [
  { name = "soft_nodes", group = "soft", quantity = "von_mises_stress", measure = "max" },
  { name = "soft_cells", group = "soft", quantity = "cell_von_mises_stress", measure = "max" },
  { name = "stiff_nodes", group = "stiff", quantity = "von_mises_stress", measure = "max" },
  { name = "face", group = "face", quantity = "von_mises_stress", measure = "max" },
  { name = "soft_energy", group = "soft", quantity = "strain_energy_density", measure = "max" },
  { name = "soft_momentum", group = "soft", quantity = "momentum_density" },
  { name = "soft_velocity", group = "soft", quantity = "velocity", measure = "max" },
]
"#;

const SIDES_MESH: &str = "\
*NODE
1, 0,0,0\n2, 1,0,0\n3, 1,1,0\n4, 0,1,0\n5, 0,0,1\n6, 1,0,1\n7, 1,1,1\n8, 0,1,1\n9, 0,2,0\n10, 1,2,0\n11, 0,2,1\n12, 1,2,1
*ELEMENT, TYPE=C3D8, ELSET=soft
1, 1,2,3,4,5,6,7,8
*ELEMENT, TYPE=C3D8, ELSET=stiff
2, 4,3,10,9,8,7,12,11
*NSET, NSET=left
1,4,5,8,9,11
*NSET, NSET=right
2,3,6,7,10,12
*NSET, NSET=face
3,4,7,8
";

#[test]
fn stresses_of_a_region_come_from_its_own_cells() {
    let place = Place::with(SIDES);
    place.write("sides.inp", SIDES_MESH);
    let run = place.succeed(&["run", "box.toml"]);
    let note = "probe `mean`: `soft`, `stiff` meet at node 2, so `von_mises_stress` is a mean by volume";
    assert!(run.stderr.contains(note), "{}", run.stderr);
    let history = place.history("out");
    let stress = |mu: f64, a: f64| mu * (a * a - 1.0) / a;
    for row in 0..=10 {
        let near = |name: &str, exact: f64| {
            let own = history[name][row];
            assert!(
                (own - exact).abs() < 1e-11 * exact.abs().max(1.0),
                "{name}, {row}: {own} is not {exact}"
            );
        };
        let t = 0.1 * row as f64;
        let a = 1.0 + 0.1 * t.min(1.0 - t);
        let [soft, stiff] = [stress(5.0, a), stress(500.0, a)];
        ["soft_nodes", "soft_cells", "side_von_mises_stress"].into_iter().for_each(|name| near(name, soft));
        ["stiff_nodes", "face", "max_von_mises_stress"].into_iter().for_each(|name| near(name, stiff));
        near("mean_von_mises_stress", (soft + stiff) / 2.0);
        near("soft_energy", 2.5 * (a * a - 1.0) - 5.0 * a.ln() + 5.0 * a.ln().powi(2));
        // The density of the soft cube times the velocity of the right side, and its mean with the resting left side.
        let momentum = history["side_momentum_density_x"][row];
        near("soft_velocity", momentum.abs() / 2.0);
        near("soft_momentum_x", momentum / 2.0);
        assert!([0, 5, 10].contains(&row) || (momentum.abs() - 0.2).abs() < 1e-12, "row {row}: {momentum}");
    }
    let expected = |summary: &serde_json::Value, fields: &[&str]| {
        let rows = summary["largest_in_regions"].as_array().unwrap();
        assert_eq!(rows.len(), 2 * fields.len(), "{rows:?}");
        for (row, (field, (region, mu))) in rows.iter().zip(
            fields.iter().flat_map(|field| [("soft", 5.0), ("stiff", 500.0)].map(|region| (field, region))),
        ) {
            assert_eq!((row["field"].as_str(), row["region"].as_str()), (Some(*field), Some(region)));
            let [value, time] = ["value", "time"].map(|key| row[key].as_f64().unwrap());
            let exact = stress(mu, 1.05);
            assert!((value - exact).abs() < 1e-11 * exact && (time - 0.5).abs() < 1e-15, "{row}");
            let kind = if field.starts_with("cell") { "cell" } else { "node" };
            assert!(
                row[kind].is_u64() && row["point"].as_array().is_some_and(|point| point.len() == 3),
                "{row}"
            );
        }
        assert!((summary["largest_von_mises_stress"].as_f64().unwrap() - stress(500.0, 1.05)).abs() < 1e-9);
    };
    let fields = ["von_mises_stress", "cell_von_mises_stress"];
    expected(&place.summary("out"), &fields);
    for line in ["largest von Mises stress: ", "  in soft: 0.488", "  in stiff: 48.8"] {
        assert!(run.stderr.lines().any(|own| own.starts_with(line)), "{line} {}", run.stderr);
    }
    // The checkpoint has the peak of the time before it.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.7"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "1"]);
    expected(&place.summary("parts"), &fields);
    // Without `extremes` the frames have the largest values; t = 0.5 is one of them.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "frames", "--set", "output.extremes=[]"]);
    expected(&place.summary("frames"), &fields[..1]);
    // Four nodes of each cube are those where it meets the other one.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "series", "--set", "output.format=vtkhdf"]);
    for page in ["frames/report.html", "series/report.html"] {
        let run = &manifest(&place, page)["runs"][0];
        let region = |name: &str| serde_json::json!({ "name": name, "n": 8, "inside": 4 });
        assert_eq!(run["frames"]["regions"], serde_json::json!([region("soft"), region("stiff")]));
        assert_eq!(run["frames"]["n_nodes"], 16);
        assert!(run["summary"]["largest_in_regions"].is_array());
    }
}

#[test]
fn the_group_of_a_probe_has_cells() {
    let place = Place::with(&SIDES.replace(r#"group = "soft", quantities"#, r#"group = "sift", quantities"#));
    place.write("sides.inp", SIDES_MESH);
    let failed = place.emmy(&["check", "box.toml"]);
    assert_eq!(failed.code, 2);
    for part in ["the mesh has no group `sift` of cells", "did you mean `soft`?", "`soft`, `stiff`"] {
        assert!(failed.stderr.contains(part), "{}", failed.stderr);
    }
}

/// In cells with curved edges the volume by the points of the stresses is not that by the points of the mass.
#[test]
fn kinetic_energies_of_curved_cells_add_up() {
    let place = Place::with(
        r#"
mesh.file = "curved.inp"
region = [{ density = 1.4, material.neo-hooke = { lambda = 60, mu = 20 } }]
initial = [{ velocity = [0.3, 0.2, 0.1], gradient = [[0.5, 0.2, 0], [0, -0.4, 0.1], [0.3, 0, 0.2]] }]
time = { scheme = "DGM", steps = [{ until = 0.02, size = 0.01 }] }
[output]
directory = "out"
every = 0
values = [
  { name = "kinetic", quantity = "cell_kinetic_energy_density", measure = "total" },
  { name = "strain", quantity = "strain_energy_density", measure = "total" },
]
"#,
    );
    let mesh = "\
*NODE
1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n5, 0.5,-0.1,0.05\n6, 0.55,0.6,-0.04\n7, -0.06,0.5,0\n8, 0,0.05,0.5\n9, 0.5,0,0.58
10, 0.03,0.52,0.5
*ELEMENT, TYPE=C3D10, ELSET=all
1, 1,2,3,4,5,6,7,8,9,10
";
    place.write("curved.inp", mesh);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    for (own, whole) in [("kinetic", "kinetic_energy"), ("strain", "strain_energy")] {
        for (own, whole) in history[own].iter().zip(&history[whole]) {
            assert!((own - whole).abs() < 1e-14 * whole.abs().max(1e-3), "{own} is not {whole}");
        }
    }
}

/// A bar on a table that shakes along z with the acceleration `a0 cos(w t)`.
const SHAKEN: &str = r#"
mesh.box = { size = [3, 1, 1], cells = [3, 1, 1] }
region = [{ density = 2, material.neo-hooke = { lambda = 1000, mu = 500 } }]
support = [
  { group = "x-min", fix = ["x", "y"] },
  { group = "x-min", accelerate = { z = "4*cos(3*t)" } },
]
time = { scheme = "DGM", degree = 2, steps = [{ until = 1, size = 0.02 }] }
[output]
directory = "out"
every = 10
fields = ["displacement", "acceleration", "von_mises_stress"]
extremes = ["displacement", "acceleration", "von_mises_stress"]
relative_to = "base"
probes = [
  { name = "tip", point = [3, 0, 0], quantities = ["position", "displacement", "velocity", "acceleration", "von_mises_stress"] },
  { name = "seen", point = [3, 0, 0], quantities = ["displacement", "velocity", "acceleration", "von_mises_stress"], relative_to = "ground" },
  { name = "foot", point = [0, 0, 0], quantities = ["acceleration"], relative_to = "ground" },
  { name = "back", point = [0, 0, 0], quantities = ["displacement", "acceleration"], relative_to = "x-max" },
]
values = [
  { name = "end", group = "x-max", quantity = "acceleration" },
  { name = "foot_mean", group = "x-min", quantity = "acceleration" },
]
"#;

/// Relative to the base, its motion, known as a function of time, is taken off; accelerations are means over the step.
#[test]
fn motions_are_told_relative_to_the_base() {
    let place = Place::with(SHAKEN);
    let closing = place.succeed(&["run", "box.toml"]).stderr;
    let history = place.history("out");
    let column = |name: &str| history.get(name).unwrap_or_else(|| panic!("{name}: {:?}", history.keys()));
    let (mut largest, mut fastest) = (0.0f64, 0.0f64);
    for row in 0..=50 {
        let t = 0.02 * row as f64;
        let near = |name: &str, exact: f64, within: f64| {
            let own = column(name)[row];
            assert!((own - exact).abs() < within, "{name}, row {row}: {own} is not {exact}");
        };
        let of = |name: &str| column(name)[row];
        // From rest: v = 4/3 sin 3t, u = 4/9 (1 - cos 3t).
        let [path, speed] = [4.0 / 9.0 * (1.0 - (3.0 * t).cos()), 4.0 / 3.0 * (3.0 * t).sin()];
        near("tip_displacement_z", of("seen_displacement_z") - path, 1e-10);
        near("tip_velocity_z", of("seen_velocity_z") - speed, 1e-9);
        near("tip_displacement_x", of("seen_displacement_x"), 1e-15);
        near("tip_z", of("tip_displacement_z"), 1e-15);
        near("tip_von_mises_stress", of("seen_von_mises_stress"), 1e-15);
        let norm = ["x", "y", "z"].iter().map(|axis| of(&format!("tip_displacement_{axis}")).powi(2));
        largest = largest.max(norm.sum::<f64>().sqrt());
        fastest = fastest.max(of("max_displacement"));
        if row == 0 {
            for name in ["tip_acceleration_z", "foot_acceleration_z", "max_acceleration", "end_z"] {
                assert!(of(name).is_nan(), "no step has led to the start: {name}");
            }
            continue;
        }
        // The change of the speed of the base over the step.
        let mean = (speed - 4.0 / 3.0 * (3.0 * (t - 0.02)).sin()) / 0.02;
        near("foot_acceleration_z", mean, 1e-8);
        near("tip_acceleration_z", of("seen_acceleration_z") - mean, 1e-8);
        near("foot_mean_z", 0.0, 1e-8);
        let change = (of("tip_velocity_z") - column("tip_velocity_z")[row - 1]) / 0.02;
        near("tip_acceleration_z", change, 1e-10);
        near("back_acceleration_z", -of("end_z"), 1e-8);
    }
    assert!(largest > 0.003 && fastest >= largest - 1e-12, "{largest} {fastest}");
    let summary = place.summary("out");
    let told = summary["largest_relative_displacement"].as_f64().unwrap();
    assert!((told - fastest).abs() < 1e-12, "{told} {fastest}");
    assert!(summary["largest_displacement"].as_f64().unwrap() > 0.8, "the base moves by 8/9");
    assert!(closing.contains("largest displacement relative to base: "), "{closing}");
    let page = place.read("out/report.html");
    assert!(page.contains("\"is_driven\":true") && page.contains("\"relative_to\":{\"all\":\"base\""));
    // Stopped and resumed: the same numbers, but for the rounding of the path, which is integrated over the run.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.5"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "1"]);
    let parts = place.history("parts");
    for name in ["tip_displacement_z", "tip_acceleration_z", "seen_acceleration_z", "max_acceleration"] {
        let pairs = history[name].iter().zip(&parts[name]).skip(1);
        assert!(pairs.clone().count() == 50 && pairs.clone().all(|(a, b)| (a - b).abs() < 1e-8), "{name}");
    }
    let resumed = place.summary("parts")["largest_relative_displacement"].as_f64().unwrap();
    assert!((resumed - told).abs() < 1e-12, "{resumed} {told}");
    // Columns of one name cannot tell something else from there on.
    let ground = place.emmy(&["resume", "parts", "--until", "2", "--set", "output.relative_to=\"ground\""]);
    assert_eq!(ground.code, 2);
    assert!(ground.stderr.contains("`output.relative_to` is \"ground\""), "{}", ground.stderr);
}

#[test]
fn a_reference_is_a_group_the_base_or_the_rigid_motion() {
    let place = Place::with(SHAKEN);
    let check = |set: &str| place.emmy(&["check", "box.toml", "--set", set]);
    for name in ["ground", "base", "rigid-motion", "x-max"] {
        assert_eq!(check(&format!("output.relative_to=\"{name}\"")).code, 0, "{name}");
    }
    let unknown = check("output.relative_to=\"x-mix\"");
    assert_eq!(unknown.code, 2);
    for part in ["`relative_to`: there is no group `x-mix`", "did you mean `x-m", "`rigid-motion`"] {
        assert!(unknown.stderr.contains(part), "{}", unknown.stderr);
    }
    let place = Place::with(BOX);
    let failed = place.emmy(&["check", "box.toml", "--set", "output.relative_to=\"base\""]);
    assert_eq!(failed.code, 2);
    assert!(failed.stderr.contains("no support moves, so there is no base"), "{}", failed.stderr);
}
