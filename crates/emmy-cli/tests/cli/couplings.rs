//! `[[coupling]]`, masses beside their groups, torques and loads that follow: from the input to the answers.

use crate::Place;
use crate::resume::assert_same_rows;

/// A clamped block with a force at a point that its free end moves.
const BLOCK: &str = r#"
mesh.box = { size = [2, 1, 1], cells = [2, 1, 1] }

[[region]]
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }

[[support]]
group = "x-min"
fix = ["x", "y", "z"]

[[coupling]]
name = "hook"
group = "x-max"
point = [2, 0.75, 0.5]
kind = "distributing"

[[load]]
group = "hook"
force = [0, 0, -8]

[time]
scheme = "DGM"
steps = [{ until = 0.2, size = 0.05 }]

[output]
directory = "out"
probes = [{ name = "point", point = [2, 0.75, 0.5] }]
"#;

fn last(place: &Place, directory: &str, column: &str) -> f64 {
    *place.history(directory)[column].last().unwrap()
}

/// A point in the plane of four corners follows their bilinear mean; the work of the force is its product with the
/// displacement.
#[test]
fn a_force_acts_at_a_point_of_a_face() {
    let place = Place::with(BLOCK);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    for line in [
        "mesh       12 nodes, 2 cells (2 hex8)\n",
        "coupling   hook: the point [2, 0.75, 0.5] follows the mean of 4 nodes of `x-max`\n",
        "load       force on hook: force [0, 0, -8], torque about the origin [-6, 16, 0]\n",
        "probe      point: node 12 at [2, 0.75, 0.5]\n",
    ] {
        assert!(check.contains(line), "{line}{check}");
    }
    place.succeed(&["run", "box.toml", "--quiet"]);
    let sunk = last(&place, "out", "point_z") - 0.5;
    assert!((last(&place, "out", "external_work") + 8.0 * sunk).abs() < 1e-11, "{sunk}");
    // Other schemes come to the same with small steps.
    let mut places = Vec::new();
    for scheme in ["DGM", "Newmark(0.25,0.5)", "FE(2)", "Bathe"] {
        let set = format!("time.scheme=\"{scheme}\"");
        let small = "time.steps.0.size=0.002";
        place.succeed(&["run", "box.toml", "--quiet", "--output", scheme, "--set", &set, "--set", small]);
        places.push(last(&place, scheme, "point_z") - 0.5);
    }
    assert!(places.iter().all(|own| (own - places[0]).abs() < 1e-3 * places[0].abs()), "{places:?}");
}

/// A point that is moved up and has a mass: its column is the force of the support on it.
#[test]
fn a_held_point_has_a_reaction() {
    let held = BLOCK.replace(
        "[[load]]\ngroup = \"hook\"\nforce = [0, 0, -8]\n",
        "[[mass]]\ngroup = \"hook\"\nmass = 3.0\n\n[[support]]\ngroup = \"hook\"\nfix = [\"x\", \"y\"]\n\
         move = { z = \"0.05*t^2\" }\n",
    );
    let place = Place::with(&held);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    assert!((last(&place, "out", "point_z") - 0.5 - 0.05 * 0.04).abs() < 1e-14);
    let impulse: f64 =
        history["step_size"].iter().zip(&history["hook_force_z"]).skip(1).map(|(h, f)| h * f).sum();
    let foot: f64 =
        history["step_size"].iter().zip(&history["x-min_force_z"]).skip(1).map(|(h, f)| h * f).sum();
    let momentum = last(&place, "out", "linear_momentum_z");
    assert!((impulse + foot - momentum).abs() < 1e-11, "{impulse} {foot} {momentum}");
    // A run that is stopped and resumed, and one by another number of threads, have the same bits.
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.1", "--output", "parts"]);
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.2"]);
    assert_same_rows(&place, "out", "parts");
    place.succeed(&["run", "box.toml", "--quiet", "--threads", "1", "--output", "alone"]);
    assert_same_rows(&place, "out", "alone");
}

/// A block that one point holds can turn about it.
#[test]
fn a_point_alone_does_not_hold_a_body() {
    let support = "[[support]]\ngroup = \"x-min\"\nfix = [\"x\", \"y\", \"z\"]\n";
    let hung = BLOCK.replace(support, "").replace(
        "[time]",
        "[[support]]\ngroup = \"hook\"\nfix = [\"x\", \"y\", \"z\"]\n\n[equilibrium]\n\n[time]",
    );
    for input in [hung.clone(), hung.replace("kind = \"distributing\"", "kind = \"rigid\"")] {
        let outcome = Place::with(&input).emmy(&["run", "box.toml"]);
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        assert!(outcome.stderr.contains("turn"), "{}", outcome.stderr);
    }
    // Three springs hold it.
    let sprung = hung.replace("[equilibrium]", "[[support]]\ngroup = \"x-min\"\nspring = 5\n\n[equilibrium]");
    Place::with(&sprung).succeed(&["run", "box.toml", "--quiet"]);
}

/// A rigid coupling is a rigid body of the group whose centre is the point; so is a mass beside the group.
#[test]
fn rigid_couplings_are_rigid_bodies() {
    let coupled = BLOCK
        .replace("kind = \"distributing\"", "kind = \"rigid\"")
        .replace("2, 0.75, 0.5", "2.5, 0.75, 0.5");
    let table =
        "[[coupling]]\nname = \"hook\"\ngroup = \"x-max\"\npoint = [2.5, 0.75, 0.5]\nkind = \"rigid\"\n";
    assert!(coupled.contains(table));
    let rigid =
        coupled.replace(table, "[[rigid]]\nname = \"hook\"\ngroup = \"x-max\"\ncentre = [2.5, 0.75, 0.5]\n");
    let place = Place::with(&coupled);
    place.write("rigid.toml", &rigid);
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.succeed(&["run", "rigid.toml", "--quiet", "--output", "rigid"]);
    for column in ["strain_energy", "hook_z", "hook_spin_y"] {
        assert_eq!(place.history("out")[column], place.history("rigid")[column], "{column}");
    }
    let mass = "mass = 3.0\ninertia = [0.3, 0.4, 0.5]\n";
    let heavy = rigid.replace("0.5]\n\n[[load]]", &format!("0.5]\n{mass}\n[[load]]"));
    assert_ne!(heavy, rigid);
    let beside = coupled.replace(
        table,
        &format!("[[mass]]\nname = \"hook\"\ngroup = \"x-max\"\nat = [2.5, 0.75, 0.5]\n{mass}"),
    );
    let added = coupled.replace("[[load]]", &format!("[[mass]]\ngroup = \"hook\"\n{mass}\n[[load]]"));
    for (name, input) in [("heavy", heavy), ("beside", beside), ("added", added)] {
        place.write(&format!("{name}.toml"), &input);
        place.succeed(&["run", &format!("{name}.toml"), "--quiet", "--output", name]);
        assert_eq!(place.history(name)["hook_z"], place.history("heavy")["hook_z"], "{name}");
    }
    assert_ne!(place.history("heavy")["hook_z"], place.history("rigid")["hook_z"]);
}

/// A puck that spins, with a thrust that turns with it: x = F/(m w^2) (1 - cos w t), y = F/(m w^2) (w t - sin w t). And
/// a torque about its axis.
#[test]
fn a_thrust_turns_with_its_body() {
    let puck = r#"
[[rigid]]
name = "puck"
mass = 2.0
centre = [0, 0, 0]
inertia = [0.1, 0.1, 0.18]

[[load]]
group = "puck"
force = [3, 0, 0]
follow = true

[[initial]]
group = "puck"
angular_velocity = [0, 0, 2]

[time]
scheme = "DGM"
degree = 3
steps = [{ until = 1.0, size = 0.05 }]

[output]
directory = "out"
"#;
    let place = Place::with(puck);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let (size, w) = (3.0 / (2.0 * 4.0), 2.0f64);
    let due = [size * (1.0 - w.cos()), size * (w - w.sin())];
    for (axis, due) in ["x", "y"].into_iter().zip(due) {
        let own = last(&place, "out", &format!("puck_{axis}"));
        assert!((own - due).abs() < 1e-8, "{axis}: {own} {due}");
    }
    let energy = &place.history("out")["total_energy"];
    let work = last(&place, "out", "external_work");
    assert!((energy.last().unwrap() - energy[0] - work).abs() < 1e-13, "{energy:?} {work}");
    let turned = puck.replace("force = [3, 0, 0]", "torque = { axis = [0, 0, 5], value = 0.36 }");
    place.write("turned.toml", &turned);
    place.succeed(&["run", "turned.toml", "--quiet", "--output", "turned"]);
    assert!((last(&place, "turned", "puck_spin_z") - 4.0).abs() < 1e-12);
}

#[test]
fn impossible_couplings_are_refused() {
    let load = "force = [0, 0, -8]\n";
    let kind = "kind = \"distributing\"\n";
    for (from, to, parts) in [
        (kind, "kind = \"distribute\"\n", &["did you mean `distributing`?"][..]),
        (
            kind,
            "kind = \"rigid\"\nweights = [1, 1, 1, 1]\n",
            &["`weights` are those of a distributing coupling"],
        ),
        ("2, 0.75, 0.5]\nkind", "2.5, 0.75, 0.5]\nkind", &["lie in a plane", "is 0.5 off", "this coupling"]),
        (kind, "kind = \"distributing\"\nweights = [1, 1]\n", &["2 weights for the 4 nodes"]),
        (
            load,
            "moment = [0, 0, 1]\n",
            &["`hook` is a distributing coupling and has no direction", "\"rigid\" there"],
        ),
        (load, "torque = { axis = [0, 0, 0], value = 1 }\n", &["`axis` of a torque must have a direction"]),
        (load, "force = [0, 0, -8]\nfollow = true\n", &["`hook` is a distributing coupling"]),
        (
            "group = \"hook\"\nforce = [0, 0, -8]\n",
            "acceleration = [0, 0, -8]\nfollow = true\n",
            &["`follow` is a key of `force`, `moment` and `torque`, not of `acceleration`"],
        ),
        (
            "name = \"hook\"",
            "name = \"x-max\"",
            &["the mesh has a group `x-max`, too; give the coupling another name"],
        ),
        ("name = \"hook\"", "name = \"point\"", &["a coupling and a probe are named `point`"]),
        ("group = \"hook\"", "group = \"hok\"", &["did you mean `hook`?"]),
        (
            "[time]",
            "[[mass]]\ngroup = \"hook\"\nmass = 1\ninertia = [1, 1, 1]\n[time]",
            &["`hook` is a distributing coupling, which has no rotation, so `inertia` has no effect"],
        ),
        (
            "[time]",
            "[[mass]]\ngroup = \"x-max\"\nmass = 1\ninertia = [1, 1, 1]\n[time]",
            &["`inertia` turns with a rigid body, and `x-max` is none", "`at`"],
        ),
        (
            "[time]",
            "[[mass]]\ngroup = \"x-max\"\nmass = 1\nat = [2, 1, 1]\ncoupling = \"distributing\"\ninertia = [1, 1, 1]\n[time]",
            &["a distributing coupling has no rotation", "needs a rigid coupling"],
        ),
        (
            "[time]",
            "[[mass]]\ngroup = \"x-max\"\ntotal = 1\nat = [2, 1, 1]\n[time]",
            &["`at` is a key of one `mass`; `total` is spread over the group"],
        ),
        (
            "[time]",
            "[[mass]]\ngroup = \"x-max\"\nmass = 1\ncoupling = \"rigid\"\n[time]",
            &["`coupling` is a key of a mass with a place", "without `at`"],
        ),
        (
            "[time]",
            "[[joint]]\nrevolute = { between = [\"hook\", \"ground\"], at = [2, 0.75, 0.5], axis = [0, 0, 1] }\n[time]",
            &[
                "`hook` is the point of a distributing coupling and has no direction",
                "kind = \"rigid\" there",
            ],
        ),
        (
            "[time]",
            "[[support]]\ngroup = \"x-max\"\nfix = [\"x\"]\n[[support]]\ngroup = \"hook\"\nfix = [\"z\"]\n[time]",
            &["coupling \"hook\": each of its nodes is held", "this coupling"],
        ),
        (
            "[time]",
            "[[tie]]\nfollower = \"x-max\"\nleader = \"x-min\"\nkind = \"mortar\"\nweights = [1]\n[time]",
            &["`weights` are those of a node; by mortar they are integrals"],
        ),
    ] {
        let input = BLOCK.replacen(from, to, 1);
        assert_ne!(input, BLOCK, "{from}");
        let outcome = Place::with(&input).emmy(&["run", "box.toml"]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{to}\n{}", outcome.stderr);
        for part in parts {
            assert!(outcome.stderr.contains(part), "\"{part}\" is not in\n{}", outcome.stderr);
        }
    }
}

/// A point with a mass starts with the mean velocity of its nodes, whatever is given for itself.
#[test]
fn initial_velocities_of_a_point_have_a_note() {
    let start = |group: &str| {
        let input = BLOCK.replace(
            "[time]",
            &format!(
                "[[mass]]\ngroup = \"hook\"\nmass = 3.0\n\n[[initial]]\ngroup = \"{group}\"\nvelocity = [0, 0, 1]\n\n[time]"
            ),
        );
        Place::with(&input).succeed(&["check", "box.toml"]).stderr
    };
    let note =
        "initial velocity of `hook`: 1 tied node starts with the velocity of the nodes followed instead";
    assert!(start("hook").contains(note), "{}", start("hook"));
    assert!(!start("x-max").contains("tied node"), "{}", start("x-max"));
}

/// Names of a file that has a mesh alone.
#[test]
fn what_is_left_out_must_be_there() {
    let file = format!("{}/../../examples/tied-blocks.toml", env!("CARGO_MANIFEST_DIR"));
    let place = Place::with(BLOCK);
    let outcome = place.emmy(&["check", &file, "--set", "mesh.leave_out=['rbe2_1']"]);
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    for part in ["`leave_out`: the mesh has nothing that is named `rbe2_1`", "it has a mesh alone"] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
}
