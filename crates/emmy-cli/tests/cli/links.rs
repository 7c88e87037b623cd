//! Networks: links, point masses, springs and attraction to the ground from an input, and their mistakes.

use super::Place;

const NETWORK: &str = "\
[mesh.network]
points = [[0, 0, 0], [2, 0, 0], [0, 2, 0]]
links = [[0, 1], [1, 2], [0, 2]]
groups = { feet = [0], head = [1, 2] }
link_groups = { first = [0], rest = [1, 2] }

[[mass]]
group = \"head\"
mass = 0.5

[[region]]
group = \"first\"
material.spring = { stiffness = 10.0, rest_length = 1.5 }

[[region]]
group = \"rest\"
density = 0.1
material.bar = { youngs_modulus = 100.0, area = 0.5 }

[[support]]
group = \"feet\"
fix = [\"z\"]
spring = 7.0

[[load]]
attraction = { centre = [5, 5, 0], strength = 3.0 }

[time]
scheme = \"DGM\"
steps = [{ until = 0.5, size = 0.05 }]

[output]
directory = \"out\"
";

/// A change of a line, and the expected parts of the message.
const CASES: &[(&str, &str, &[&str])] = &[
    // The network.
    ("[0, 1], [1, 2]", "[0, 1], [1, 3]", &["no number 3 among the 3 points"]),
    ("[0, 1], [1, 2]", "[0, 1], [1, 1]", &["a link from point 1 to itself"]),
    ("[0, 1], [1, 2]", "[0, 1], [1, -2]", &["`links` must be at least 0"]),
    ("[0, 1], [1, 2]", "[0, 1, 2]", &["`links` must have 2 whole numbers, not 3"]),
    ("links = [[0, 1], [1, 2], [0, 2]]", "links = []", &["`links` is empty"]),
    ("links = [", "elements = [", &["unknown key `elements` in `network`", "did you mean `links`?"]),
    ("points = [[0, 0, 0]", "points = [[0, 0]", &["`points` must have 3 numbers, not 2"]),
    ("feet = [0]", "feet = [9]", &["no number 9 among the 3 points"]),
    ("first = [0]", "first = [3]", &["no number 3 among the 3 links"]),
    ("first = [0]", "first = 0", &["`first` must be a list"]),
    ("link_groups", "linkgroups", &["unknown key `linkgroups`", "did you mean `link_groups`?"]),
    // Masses.
    ("mass = 0.5", "mass = 0", &["`mass` must be positive"]),
    ("mass = 0.5", "weight = 0.5", &["unknown key `weight` in [[mass]]"]),
    ("group = \"head\"", "group = \"heda\"", &["no group `heda`", "did you mean `head`?"]),
    // Links.
    ("stiffness", "k", &["unknown key `k` in `spring`", "did you mean `stiffness`?"]),
    ("stiffness = 10.0", "stiffness = 0", &["`stiffness` must be positive, not 0"]),
    ("rest_length = 1.5", "rest_length = -1", &["`rest_length` must be at least 0, not -1"]),
    ("rest_length", "l0", &["did you mean `rest_length`?"]),
    ("area = 0.5", "area = -0.5", &["`area` must be positive, not -0.5"]),
    (", area = 0.5", "", &["`area` is missing in `bar`"]),
    ("youngs_modulus = 100.0", "youngs_modulos = 100.0", &["did you mean `youngs_modulus`?"]),
    (
        "spring = { stiffness = 10.0, rest_length = 1.5 }",
        "attraction = { strength = 0 }",
        &["`strength` must not be 0"],
    ),
    (
        "spring = { stiffness = 10.0, rest_length = 1.5 }",
        "attraction = { g = 1 }",
        &["unknown key `g` in `attraction`"],
    ),
    (
        "material.spring",
        "density = 1\nmaterial.spring",
        &["`spring` has no mass: `density` must be left out"],
    ),
    // The ground.
    ("spring = 7.0", "spring = -7.0", &["`spring` must be positive"]),
    ("spring = 7.0", "spring = \"7\"", &["`spring` must be a number, not a string"]),
    ("centre = [5, 5, 0]", "center = [5, 5, 0]", &["did you mean `centre`?"]),
    ("centre = [5, 5, 0]", "centre = [5, 5]", &["`centre` must have 3 numbers, not 2"]),
    ("strength = 3.0", "strength = 0", &["`strength` must not be 0"]),
    (
        "attraction = { centre = [5, 5, 0], strength = 3.0 }",
        "attraction = 3.0",
        &["`attraction` must be a table with the keys `centre`, `strength`"],
    ),
    (
        "strength = 3.0 }",
        "strength = 3.0 }\nforce = [1, 0, 0]",
        &["[[load]] takes exactly one of `traction`, `force`"],
    ),
    ("strength = 3.0 }", "strength = 3.0 }\nhistory = [[0, 1]]", &["an attraction has no `history`"]),
    ("strength = 3.0 }", "strength = 3.0 }\ngroup = \"sky\"", &["no group `sky`"]),
];

#[test]
fn every_fault_is_shown_on_its_line() {
    for (from, to, says) in CASES {
        assert!(NETWORK.contains(from), "{from}");
        let input = NETWORK.replacen(from, to, 1);
        let first = NETWORK.lines().zip(input.lines()).position(|(a, b)| a != b).unwrap() + 1;
        let stderr = rejected(&input, says);
        // Of two loads in one table, the first may be the one that is shown.
        let lines = (first - 1..=first + to.matches('\n').count()).map(|line| format!("box.toml:{line}:"));
        assert!(lines.into_iter().any(|line| stderr.contains(&line)), "{to}: line {first}\n{stderr}");
    }
}

fn rejected(input: &str, says: &[&str]) -> String {
    let place = Place::with(input);
    let outcome = place.emmy(&["run", "box.toml"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{input}\n{}", outcome.stderr);
    for part in says {
        assert!(outcome.stderr.contains(part), "\"{part}\" is not in\n{}", outcome.stderr);
    }
    outcome.stderr
}

#[test]
fn materials_and_masses_go_with_their_cells() {
    let rubber = NETWORK.replace(
        "material.bar = { youngs_modulus = 100.0, area = 0.5 }",
        "material.neo-hooke = { lambda = 1, mu = 1 }",
    );
    rejected(&rubber, &["cell 1 is a line2", "not for this material", "`bar`, `spring` or `attraction`"]);
    let light = NETWORK.replace("group = \"rest\"", "group = \"links\"").replacen(
        "[[region]]\ngroup = \"first\"\n",
        "",
        1,
    );
    let light = light.replace("material.spring = { stiffness = 10.0, rest_length = 1.5 }\n", "").replace(
        "density = 0.1\nmaterial.bar = { youngs_modulus = 100.0, area = 0.5 }",
        "material.attraction = { strength = 1.0 }",
    );
    rejected(&light, &["node 0 at [0, 0, 0] has no mass", "give it a point mass"]);
}

#[test]
fn a_network_on_the_ground_keeps_its_balances() {
    let place = Place::with(NETWORK);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    for column in ["energy_residual", "linear_momentum_residual", "angular_momentum_residual"] {
        assert!(
            history[column].iter().all(|residual| residual.abs() < 1e-13),
            "{column}: {:?}",
            history[column]
        );
    }
    // From rest it begins to fall towards the centre, and its energy is conserved.
    let energy = &history["total_energy"];
    assert!(energy.iter().all(|e| (e - energy[0]).abs() < 1e-12));
    assert!(history["linear_momentum_x"][10].abs() > 0.01);
    // The resolved input gives the same run.
    place.succeed(&["run", "out/input.toml", "--quiet", "--output", "again"]);
    assert_eq!(place.history("again")["total_energy"], history["total_energy"]);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    for part in
        ["3 line2", "mass       head: mass 1, centre [1, 1, 0]", "spring 7", "attraction to [5, 5, 0]"]
    {
        assert!(report.contains(part), "\"{part}\" is not in\n{report}");
    }
}

/// Frames of a network are mesh files: their lines are cells if a region of links names their group.
#[test]
fn a_frame_is_a_network_again() {
    let place = Place::with(NETWORK);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let start = NETWORK.find("points").unwrap();
    let end = NETWORK.find("[[mass]]").unwrap();
    let mut again = NETWORK.replace(&NETWORK[start..end], "file = \"out/frames/out_000000.vtu\"\n\n");
    again = again.replace("[mesh.network]", "[mesh]").replace("\"out\"\n", "\"again\"\n");
    place.write("again.toml", &again);
    place.succeed(&["run", "again.toml", "--quiet"]);
    assert_eq!(place.history("again")["total_energy"], place.history("out")["total_energy"]);
}
