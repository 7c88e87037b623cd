//! Masses besides those of the cells: over a group as a whole, and at each of its nodes.

use crate::Place;

/// Two boxes of the widths 1 and 3 side by side, whose upper faces are the group `top`.
const INPUT: &str = r#"
mesh.file = "boxes.inp"
region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]
mass = [{ group = "top", total = 6 }]
initial = [{ velocity = [0, 0, 3] }]
time = { scheme = "DGM", steps = [{ until = 0.2, size = 0.1 }] }
output = { directory = "out", every = 0 }
"#;

const MESH: &str = "\
*NODE
1, 0,0,0\n2, 1,0,0\n3, 1,1,0\n4, 0,1,0\n5, 0,0,1\n6, 1,0,1\n7, 1,1,1\n8, 0,1,1\n9, 0,4,0\n10, 1,4,0\n11, 0,4,1\n12, 1,4,1
*ELEMENT, TYPE=C3D8, ELSET=all
1, 1,2,3,4,5,6,7,8
2, 4,3,10,9,8,7,12,11
*SURFACE, TYPE=ELEMENT, NAME=top
1, S2
2, S2
";

fn place(input: &str) -> Place {
    let place = Place::with(input);
    place.write("boxes.inp", MESH);
    place
}

/// The centre of the area is at y = 2; that of the nodes, at 0, 1 and 4, is at 5/3.
#[test]
fn check_says_where_a_mass_lies() {
    let whole = place(INPUT).succeed(&["check", "box.toml"]).stdout;
    assert!(whole.contains("top: mass 6, centre [0.5, 2, 1]\n"), "{whole}");
    assert!(!whole.contains("nodes of"), "{whole}");
    let at_nodes = place(&INPUT.replace("total = 6", "mass = 1")).succeed(&["check", "box.toml"]).stdout;
    assert!(at_nodes.contains("top: mass 6, centre [0.5, 1.66667, 1]\n"), "{at_nodes}");
    let place = "6 nodes of 1, 0.333333 from the centre of its area, [0.5, 2, 1]: `total` puts a mass there";
    assert!(at_nodes.contains(place), "{at_nodes}");
}

#[test]
fn a_mass_of_a_group_flies_with_the_body() {
    let place = place(INPUT);
    for (set, mass) in [("mass.0.total=6", 14.0), ("mass.0.total=1.5", 9.5)] {
        place.succeed(&["run", "box.toml", "--quiet", "--set", set]);
        let history = place.history("out");
        for (momentum, energy) in history["linear_momentum_z"].iter().zip(&history["kinetic_energy"]) {
            assert!((momentum - 3.0 * mass).abs() < 1e-12 && (energy - 4.5 * mass).abs() < 1e-12, "{set}");
        }
    }
}

#[test]
fn one_size_of_a_mass_is_given() {
    for (size, parts) in [
        ("total = 6, mass = 1", ["takes exactly one of `mass`, `total`", "and this one"]),
        ("total = -6", ["`total` must be positive", "-6"]),
        ("totl = 6", ["unknown key `totl` in [[mass]]", "did you mean `total`?"]),
    ] {
        let failed = place(&INPUT.replace("total = 6", size)).emmy(&["check", "box.toml"]);
        assert_eq!(failed.code, 2, "{size}");
        assert!(parts.iter().all(|part| failed.stderr.contains(part)), "{}", failed.stderr);
    }
    let failed = place(&INPUT.replace(", total = 6", "")).emmy(&["check", "box.toml"]);
    assert!(
        failed.code == 2 && failed.stderr.contains("exactly one of `mass`, `total`"),
        "{}",
        failed.stderr
    );
}

/// Central differences lump the mass: a spin of 2 rad/s of the box 2 x 1 x 1 of density 2 in eight cells, and of a mass
/// of 3 on the face at its end, whose points are those of the corners.
#[test]
fn check_has_the_energy_of_the_scheme_at_the_start() {
    let place = Place::with(
        r#"
mesh.box = { size = [2, 1, 1], cells = [2, 1, 1] }
region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]
mass = [{ group = "x-max", total = 3 }]
initial = [{ angular_velocity = [0, 0, 2], about = [1, 0.5, 0.5] }]
time = { scheme = "central-differences", steps = [{ until = 0.02, size = 0.01 }] }
output = { directory = "out", every = 0 }
"#,
    );
    // Half of omega^2 times the squared distances from the axis: masses of 1/4 at the eight outer corners, 1/2 at the
    // four in the middle, and 3/4 at the four at the end.
    let kinetic = 0.5 * 4.0 * (8.0 * 0.25 * 1.25 + 4.0 * 0.5 * 0.25 + 4.0 * 0.75 * 1.25);
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(check.contains(&format!("start      kinetic energy {kinetic}\n")), "{check}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert!((place.history("out")["kinetic_energy"][0] - kinetic).abs() < 1e-13);
}
