//! Rigid bodies and joints.

use super::{Mistake, changed, whole};

/// A door on a hinge, and a lamp that a rod holds to it.
const DOOR: &str = r#"[[rigid]]
name = "door"
mass = 20.0
centre = [0.5, 0.0, 1.0]
inertia = [7.0, 9.0, 2.0]

[[rigid]]
name = "lamp"
mass = 1.0
centre = [1.0, 0.0, 3.0]

[[joint]]
name = "hinge"
revolute = { between = ["door", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }

[[joint]]
name = "rod"
distance = { between = ["lamp", "door"], points = [[1, 0, 3], [1, 0, 2]] }

[[load]]
acceleration = [0, 0, -9.81]

[time]
scheme = "DGM"
steps = [{ until = 1.0, size = 0.1 }]

[output]
directory = "out"
"#;

/// A mistake in the door.
fn door(name: &str, from: &str, to: &str) -> Mistake {
    whole(name, DOOR).and(from, to)
}

const HINGE: &str = r#"revolute = { between = ["door", "ground"], at = [0, 0, 0], axis = [0, 0, 1] }"#;
const ROD: &str = r#"points = [[1, 0, 3], [1, 0, 2]] }"#;
const INERTIA: &str = "inertia = [7.0, 9.0, 2.0]";

/// A joint beside the support of a box, whose groups are elastic.
fn on_box(name: &str, joint: &str) -> Mistake {
    let rigid = "[[rigid]]\nname = \"hub\"\nmass = 1.0\ncentre = [0, 2, 0]\ninertia = [1, 1, 1]\n";
    changed(name, "[[support]]", &format!("{rigid}\n[[joint]]\n{joint}\n\n[[support]]"))
}

/// A joint of the rigid body on the box, and the mass of the body.
const HUB: &str = "spherical = { between = [\"hub\", \"ground\"], at = [0, 2, 0] }";
const MASS: &str = "mass = 1.0\ncentre = [0, 2, 0]\ninertia = [1, 1, 1]";

pub(super) fn all() -> Vec<Mistake> {
    [bodies(), joints(), drives(), forces(), names(), meshes()].into_iter().flatten().collect()
}

fn bodies() -> Vec<Mistake> {
    vec![
        door("rigid-without-a-name", "name = \"door\"\n", ""),
        door("rigid-without-mass-and-centre", "mass = 20.0\ncentre = [0.5, 0.0, 1.0]\n", "").unseen(),
        door("rigid-of-a-group", "mass = 20.0\n", "mass = 20.0\ngroup = \"panel\"\n").unseen(),
        on_box("rigid-of-a-misspelt-group", HUB).and(MASS, "group = \"y-mx\"").unseen(),
        on_box("rigid-of-a-held-group", HUB).and(MASS, "group = \"y-min\"").unseen(),
        on_box("rigid-of-a-group-and-an-inertia", HUB)
            .and("mass = 1.0\ncentre = [0, 2, 0]\n", "group = \"y-max\"\n")
            .unseen(),
        on_box("rigid-of-two-groups-that-share-nodes", HUB)
            .and(MASS, "group = \"y-max\"\n\n[[rigid]]\nname = \"other\"\ngroup = \"x-max\"")
            .unseen(),
        door("rigid-of-no-inertia", INERTIA, "inertia = [0.9, 0.3, 0.4]").unseen(),
        door(
            "rigid-of-no-inertia-by-a-matrix",
            INERTIA,
            "inertia = [[0.9, 0.1, 0], [0.1, 0.3, 0], [0, 0, 0.4]]",
        )
        .unseen(),
        door("rigid-of-an-uneven-inertia", INERTIA, "inertia = [[7, 1, 0], [0, 9, 0], [0, 0, 2]]").unseen(),
        door("rigid-of-a-negative-moment", INERTIA, "inertia = [7, -9, 2]"),
        door("rigid-of-two-moments", INERTIA, "inertia = [7, 9]"),
        door("rigid-of-one-moment", INERTIA, "inertia = 7"),
        door("rigid-of-nothing", "mass = 20.0", "mass = 0.0"),
        door("rigid-by-the-name-of-the-ground", "name = \"lamp\"", "name = \"ground\"").unseen(),
        door("rigid-with-a-name-of-two-words", "name = \"lamp\"", "name = \"a lamp\""),
        door("rigid-misspelt", "[[rigid]]", "[[rigidbody]]"),
        door(
            "rigid-in-the-language-of-another-program",
            "centre = [1.0, 0.0, 3.0]",
            "center = [1.0, 0.0, 3.0]",
        ),
        door("coupling", "[time]", "[[coupling]]\nname = \"leaf\"\n\n[time]"),
        door("region-beside-rigid-bodies", "[time]", "[[region]]\ndensity = 1.0\n\n[time]"),
        door("mesh-beside-rigid-bodies", "[time]", "[mesh]\nl-block.cell_size = 1.0\n\n[time]"),
    ]
}

fn joints() -> Vec<Mistake> {
    let hinge = |name: &str, from: &str, to: &str| {
        assert!(HINGE.contains(from), "{from}");
        door(name, HINGE, &HINGE.replacen(from, to, 1))
    };
    vec![
        hinge("joint-of-an-unknown-body", "\"door\"", "\"dor\"").unseen(),
        hinge("joint-of-an-unknown-body-far-away", "\"door\"", "\"wheel\"").unseen(),
        hinge("joint-of-one-body", "\"door\", \"ground\"", "\"door\""),
        hinge("joint-with-itself", "\"ground\"", "\"door\"").unseen(),
        hinge("joint-of-a-point-mass", "\"door\"", "\"lamp\"").unseen(),
        hinge("joint-without-a-direction", "axis = [0, 0, 1]", "axis = [0, 0, 0]").unseen(),
        hinge("joint-without-an-axis", ", axis = [0, 0, 1]", ""),
        hinge("joint-without-a-place", "at = [0, 0, 0], ", ""),
        hinge("joint-in-other-words", "revolute", "hinge"),
        hinge("joint-misspelt", "revolute", "revolut"),
        hinge("joint-with-the-axes-of-another", "axis = [0, 0, 1]", "axes = [[0, 0, 1], [1, 0, 0]]"),
        hinge("joint-with-an-axis-beside-it", " }", " }\naxis = [0, 0, 1]"),
        door(
            "joint-with-the-axis-of-another-kind",
            HINGE,
            "spherical = { between = [\"door\", \"ground\"], at = [0, 0, 0], axis = [0, 0, 1] }",
        ),
        door("joint-without-a-kind", HINGE, ""),
        door(
            "joint-of-two-kinds",
            HINGE,
            &format!("{HINGE}\nspherical = {{ between = [\"door\", \"ground\"], at = [0, 0, 0] }}"),
        ),
        door(
            "joint-of-parallel-axes",
            HINGE,
            "universal = { between = [\"door\", \"ground\"], at = [0, 0, 0], axes = [[0, 1, 1], [0, -2, -2]] }",
        )
        .unseen(),
        door("joint-between-one-point", ROD, "points = [[1, 0, 2], [1, 0, 2]] }").unseen(),
        door("joint-of-another-length", ROD, "points = [[1, 0, 3], [1, 0, 2]], length = 2.5 }").unseen(),
        door("joint-of-no-length", ROD, "points = [[1, 0, 3], [1, 0, 2]], length = 0 }"),
        door("joint-of-a-length-of-a-wrong-kind", ROD, "points = [[1, 0, 3], [1, 0, 2]], length = true }"),
        door("joint-that-is-released-before", HINGE, &format!("{HINGE}\nuntil = -3.0")),
        door("moment-on-a-point-mass", "[time]", "[[load]]\ngroup = \"lamp\"\nmoment = [0, 0, 1]\n\n[time]").unseen(),
        door("moment-on-no-body", "[time]", "[[load]]\ngroup = \"dor\"\nmoment = [0, 0, 1]\n\n[time]").unseen(),
        changed(
            "moment-on-elastic-cells",
            "[[support]]",
            "[[load]]\ngroup = \"y-max\"\nmoment = [0, 0, 1]\n\n[[support]]",
        )
        .unseen(),
        door("joint-with-another-scheme", "\"DGM\"", "\"Bathe\"").unseen(),
        door("joint-with-a-scheme-of-explicit-steps", "\"DGM\"", "\"central-differences\"").unseen(),
    ]
}

fn drives() -> Vec<Mistake> {
    let drive = |name: &str, drive: &str| door(name, HINGE, &format!("{HINGE}\n{drive}"));
    let length = |name: &str, length: &str| {
        door(name, ROD, &format!("points = [[1, 0, 3], [1, 0, 2]], length = {length} }}"))
    };
    vec![
        drive("drive-off-its-start", "angle = \"0.2 + t\"").unseen(),
        door(
            "drive-of-a-mechanism-that-cannot-move",
            "distance = { between = [\"lamp\", \"door\"], points = [[1, 0, 3], [1, 0, 2]] }",
            "spherical = { between = [\"lamp\", \"ground\"], at = [1, 0, 3] }\n\n[[joint]]\nname = \"bolt\"\nfixed = { between = [\"door\", \"ground\"], at = [0, 0, 1] }",
        )
        .and(HINGE, &format!("{HINGE}\nangle = \"t\""))
        .unseen(),
        drive("drive-that-jumps", "angle = [[0, 0], [1, 0], [1, 1]]").unseen(),
        drive("drive-of-another-joint", "slide = \"t\"").unseen(),
        drive("drive-of-a-number", "angle = 2.0"),
        drive("drive-that-does-not-parse", "angle = \"2*tt\"").unseen(),
        length("drive-of-a-length-off-its-start", "\"2 + t\"").unseen(),
        length("drive-of-a-length-that-jumps", "[[0, 1], [1, 1], [1, 2]]").unseen(),
        door(
            "drive-of-a-spherical-joint",
            HINGE,
            "spherical = { between = [\"door\", \"ground\"], at = [0, 0, 0] }\nangle = \"t\"",
        )
        .unseen(),
    ]
}

fn forces() -> Vec<Mistake> {
    let hinge = |name: &str, keys: &str| door(name, HINGE, &format!("{HINGE}\n{keys}"));
    let rod = |name: &str, kind: &str, keys: &str| {
        let points = "{ between = [\"lamp\", \"door\"], points = [[1, 0, 3], [1, 0, 2]] }";
        door(name, &format!("distance = {points}"), &format!("{kind} = {points}\n{keys}"))
    };
    vec![
        hinge("spring-beside-a-drive", "angle = \"t\"\nspring = { stiffness = 4.0 }").unseen(),
        hinge("spring-without-stiffness", "spring = { rest = 4.0 }"),
        hinge("spring-of-a-number", "spring = 4.0"),
        hinge("force-in-a-hinge", "force = \"sin(t)\"").unseen(),
        hinge("damping-that-drives", "damping = -1"),
        hinge("torque-of-a-number", "torque = 5.0"),
        hinge("motor-of-a-hinge", "motor = [[0, 5.0]]"),
        rod("torque-in-a-line", "line", "torque = \"sin(t)\"").unseen(),
        rod("line-without-a-force", "line", "").unseen(),
        rod("spring-in-a-rigid-link", "distance", "spring = { stiffness = 4.0 }").unseen(),
        door(
            "damping-of-a-spherical-joint",
            HINGE,
            "spherical = { between = [\"door\", \"ground\"], at = [0, 0, 0] }\ndamping = 1",
        )
        .unseen(),
    ]
}

fn names() -> Vec<Mistake> {
    vec![
        door("rigid-bodies-of-one-name", "name = \"lamp\"", "name = \"door\"").unseen(),
        door("joints-of-one-name", "name = \"rod\"", "name = \"hinge\"").unseen(),
        door("joint-with-the-name-of-a-body", "name = \"rod\"", "name = \"door\"").unseen(),
        door(
            "probe-with-the-name-of-a-body",
            "directory = \"out\"",
            "directory = \"out\"\nprobes = [{ name = \"lamp\", point = [1, 0, 3] }]",
        )
        .unseen(),
        door("output-of-an-unknown-joint", "directory = \"out\"", "directory = \"out\"\njoints = [\"hing\"]")
            .unseen(),
        on_box(
            "joint-with-the-columns-of-a-support",
            "name = \"y-min\"\nspherical = { between = [\"y-max\", \"hub\"], at = [0, 2, 0] }",
        )
        .unseen(),
        door("velocity-of-an-unknown-body", "[time]", "[initial]\ngroup = \"dor\"\n\n[time]").unseen(),
        door(
            "force-on-an-unknown-body",
            "acceleration = [0, 0, -9.81]",
            "force = [1, 0, 0]\ngroup = \"lmp\"",
        )
        .unseen(),
        door("traction-on-a-body", "acceleration = [0, 0, -9.81]", "traction = [1, 0, 0]\ngroup = \"lamp\"")
            .unseen(),
    ]
}

fn meshes() -> Vec<Mistake> {
    vec![
        on_box(
            "joint-of-an-elastic-group-with-an-axis",
            "revolute = { between = [\"y-max\", \"hub\"], at = [0, 2, 0], axis = [0, 0, 1] }",
        )
        .unseen(),
        on_box(
            "joint-of-nodes-elsewhere",
            "spherical = { between = [\"y-max\", \"hub\"], at = [0.4, 2, 0] }",
        )
        .unseen(),
        on_box(
            "joint-of-a-point-on-the-axis-of-a-group",
            "inline = { between = [\"hub\", \"y-max\"], at = [0, 2, 0], axis = [0, 0, 1] }",
        )
        .unseen(),
        on_box("joint-of-a-misspelt-group", "spherical = { between = [\"y-mx\", \"hub\"], at = [0, 2, 0] }")
            .unseen(),
        on_box(
            "rigid-with-the-name-of-a-group",
            "spherical = { between = [\"y-max\", \"hub\"], at = [0, 2, 0] }",
        )
        .and("name = \"hub\"", "name = \"y-max\"")
        .unseen(),
    ]
}
