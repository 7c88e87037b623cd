//! `[[tie]]`: parts that are joined, from the input to the answers.

use crate::Place;
use crate::resume::assert_same_rows;

/// Three cubes of density 2, one on the other and tied.
const INPUT: &str = r#"units.system = "mm-t-s"
mesh.file = "cubes.inp"
region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]
initial = [{ velocity = [0, 0, 3], gradient = [[0, 0.1, 0.2], [0, 0, 0.3], [0, 0, 0]] }]
time = { scheme = "DGM", steps = [{ until = 0.4, size = 0.1 }] }
output = { directory = "out", every = 0 }

[[tie]]
follower = "bottom-2"
leader = "top-1"
kind = "nodes"

[[tie]]
follower = "bottom-3"
leader = "top-2"
kind = "nodes"
"#;

/// Three unit cubes, the second and third without the part of a gap at their bottoms.
fn cubes(gaps: [f64; 2]) -> String {
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let bottoms = [0.0, 1.0 + gaps[0], 2.0 + gaps[1]];
    let mut text = "*NODE\n".to_string();
    for (cube, bottom) in bottoms.into_iter().enumerate() {
        for (layer, z) in [bottom, cube as f64 + 1.0].into_iter().enumerate() {
            for (corner, [x, y]) in corners.into_iter().enumerate() {
                text += &format!("{}, {x}, {y}, {z}\n", 8 * cube + 4 * layer + corner + 1);
            }
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=all\n";
    for cube in 0..3 {
        let nodes: Vec<String> = (0..8).map(|node| (8 * cube + node + 1).to_string()).collect();
        text += &format!("{}, {}\n", cube + 1, nodes.join(", "));
    }
    for (name, element, face) in
        [("top-1", 1, "S2"), ("bottom-2", 2, "S1"), ("top-2", 2, "S2"), ("bottom-3", 3, "S1")]
    {
        text += &format!("*SURFACE, TYPE=ELEMENT, NAME={name}\n{element}, {face}\n");
    }
    text + "*NSET, NSET=nodes-1\n5, 6, 7, 8\n*ELSET, ELSET=cube-1\n1\n"
}

fn place(input: &str, gaps: [f64; 2]) -> Place {
    let place = Place::with(input);
    place.write("cubes.inp", &cubes(gaps));
    place
}

/// The bottoms move onto the tops, so that three whole cubes are left.
#[test]
fn check_says_how_far_followers_move() {
    let outcome = place(INPUT, [0.01, 0.02]).succeed(&["check", "box.toml"]);
    for line in [
        "dofs       72 degrees of freedom, 0 fixed, 24 tied, 48 free\n",
        "parts      3, which share no nodes and are tied\n",
        "all cells: 3 cells, volume 3 mm³, mass 6 t, centre [0.5, 0.5, 1.5] mm\n",
        "tie        4 nodes of bottom-2 follow top-1, shifted by up to 0.01 mm\n",
        "tie        4 nodes of bottom-3 follow top-2, shifted by up to 0.02 mm\n",
    ] {
        assert!(outcome.stdout.contains(line), "{line}{}", outcome.stdout);
    }
    let note = "note: tie of `bottom-3` to `top-2`: nodes are moved by up to 0.02 mm\n";
    assert!(outcome.stderr.contains(note), "{}", outcome.stderr);
}

#[test]
fn followers_in_place_are_not_noted() {
    let place = place(INPUT, [0.0; 2]);
    let outcome = place.succeed(&["check", "box.toml"]);
    assert!(outcome.stdout.contains("tie        4 nodes of bottom-2 follow top-1\n"), "{}", outcome.stdout);
    assert!(
        !outcome.stderr.contains("moved") && !outcome.stderr.contains("not joined"),
        "{}",
        outcome.stderr
    );
    // Without the second tie, four nodes are apart.
    let (one, _) = INPUT.rsplit_once("[[tie]]").unwrap();
    place.write("box.toml", one);
    let outcome = place.succeed(&["check", "box.toml"]);
    let note =
        "4 nodes lie where another one does, the first at [0, 0, 2]: cells on both sides are not joined";
    assert!(outcome.stderr.contains(note), "{}", outcome.stderr);
}

#[test]
fn the_tolerance_of_each_tie_is_its_own() {
    let place = place(INPUT, [0.01, 0.02]);
    for set in ["tie.1.tolerance=0.015", "tie.0.tolerance=0"] {
        let failed = place.emmy(&["check", "box.toml", "--set", set]);
        assert_eq!(failed.code, 2, "{set}");
        assert!(failed.stderr.contains("this tie"), "{}", failed.stderr);
    }
    place.succeed(&["check", "box.toml", "--set", "tie.1.tolerance=0.025"]);
}

/// Tied cubes with matching faces are the cells of one mesh, whatever kind of group leads.
#[test]
fn tied_cubes_are_one_bar() {
    let names = ["kinetic_energy", "strain_energy", "angular_momentum_x", "angular_momentum_y"];
    let bar = INPUT.split("\n[[tie]]").next().unwrap();
    let bar = bar.replace(r#"mesh.file = "cubes.inp""#, "mesh.box = { size = [1, 1, 3], cells = [1, 1, 3] }");
    let alone = Place::with(&bar);
    alone.succeed(&["run", "box.toml", "--quiet"]);
    let whole = alone.history("out");
    for leader in ["top-1", "nodes-1", "cube-1"] {
        for gaps in [[0.0; 2], [0.01, 0.02]] {
            let place = place(&INPUT.replace("top-1", leader), gaps);
            place.succeed(&["run", "box.toml", "--quiet"]);
            let history = place.history("out");
            for name in names {
                for (own, other) in history[name].iter().zip(&whole[name]) {
                    // A hundred times the tolerance of the iteration; the strain energy begins with zero.
                    let tolerance = 1e-8 * other.abs() + 1e-12;
                    assert!((own - other).abs() < tolerance, "{leader} {name}: {own} {other}");
                }
            }
        }
    }
}

/// Natural frequencies, and the extension under a weight, of a bar on a foot.
#[test]
fn statics_and_modes_are_those_of_one_bar() {
    let foot = "\n[[support]]\ngroup = \"FOOT\"\nfix = [\"x\", \"y\", \"z\"]\n\
                \n[[load]]\nacceleration = [0, 0, -0.1]\n\n[equilibrium]\n";
    let start = INPUT.find("initial = ").unwrap();
    let end = INPUT.find("output = ").unwrap();
    let input = format!("{}{}{foot}", &INPUT[..start], &INPUT[end..]);
    let one = input.split("\n[[tie]]").next().unwrap().to_string() + foot;
    let one = one.replace(r#"mesh.file = "cubes.inp""#, "mesh.box = { size = [1, 1, 3], cells = [1, 1, 3] }");
    let whole = Place::with(&one.replace("FOOT", "z-min"));
    let tied = Place::with(&input.replace("FOOT", "bottom-1"));
    tied.write("cubes.inp", &(cubes([0.01, 0.02]) + "*SURFACE, TYPE=ELEMENT, NAME=bottom-1\n1, S1\n"));
    let numbers = |place: &Place| -> Vec<f64> {
        place.succeed(&["run", "box.toml", "--quiet"]);
        place.succeed(&["modes", "box.toml", "--count", "6", "--quiet", "--output", "modes"]);
        let modes = place.read("modes/modes.csv");
        let frequencies = modes.lines().skip(1).map(|line| line.split(',').nth(2).unwrap().parse().unwrap());
        let history = place.history("out");
        frequencies.chain(history["strain_energy"].last().copied()).collect()
    };
    let (whole, tied) = (numbers(&whole), numbers(&tied));
    assert_eq!(whole.len(), 7);
    for (own, other) in tied.iter().zip(&whole) {
        assert!((own - other).abs() < 1e-8 * other, "{tied:?} {whole:?}");
    }
}

/// Two blocks of 2 x 2 x 1, one on the other, with some cells along x and y and two over the height.
fn blocks(numbers: [usize; 2]) -> String {
    let mut nodes = "*NODE\n".to_string();
    let mut cells = "*ELEMENT, TYPE=C3D8, ELSET=all\n".to_string();
    let mut surfaces = [String::new(), String::new(), String::new(), String::new()];
    let (mut first, mut cell) = (1, 0);
    for (block, n) in numbers.into_iter().enumerate() {
        let node = |[i, j, k]: [usize; 3]| first + (k * (n + 1) + j) * (n + 1) + i;
        let grid = |[along, over]: [usize; 2]| {
            let layer = move |k| (0..along).flat_map(move |j| (0..along).map(move |i| [i, j, k]));
            (0..over).flat_map(layer)
        };
        for [i, j, k] in grid([n + 1, 3]) {
            let [x, y] = [i, j].map(|i| 2.0 * i as f64 / n as f64);
            nodes += &format!("{}, {x}, {y}, {}\n", node([i, j, k]), block as f64 + 0.5 * k as f64);
        }
        for [i, j, k] in grid([n, 2]) {
            cell += 1;
            let layer = |k| {
                [[i, j, k], [i + 1, j, k], [i + 1, j + 1, k], [i, j + 1, k]].map(|at| node(at).to_string())
            };
            cells += &format!("{cell}, {}, {}\n", layer(k).join(", "), layer(k + 1).join(", "));
            surfaces[2 * block + k] += &format!("{cell}, S{}\n", k + 1);
        }
        first += 3 * (n + 1) * (n + 1);
    }
    let names = ["foot", "lower-face", "upper-face", "head"];
    let surface =
        |(name, members): (&str, &String)| format!("*SURFACE, TYPE=ELEMENT, NAME={name}\n{members}");
    let surfaces: String = names.into_iter().zip(&surfaces).map(surface).collect();
    let ends = format!("*NSET, NSET=corner\n1\n*NSET, NSET=edge\n{}\n", numbers[0] + 1);
    [nodes, cells, surfaces, ends].concat()
}

/// Numbers of the book: the stress in cells at a tie under uniform tension.
#[test]
fn a_uniform_stress_passes_between_nested_meshes_only() {
    let input = r#"
mesh.file = "blocks.inp"
region = [{ density = 1, material.neo-hooke = { lambda = 4000, mu = 2000 } }]
load = [{ group = "head", traction = [0, 0, 1e-3] }]
tie = [{ follower = "upper-face", leader = "lower-face", kind = "nodes" }]
equilibrium = { load_steps = 1 }
support = [
  { group = "foot", fix = ["z"] },
  { group = "corner", fix = ["x", "y"] },
  { group = "edge", fix = ["y"] },
]

[output]
directory = "out"
every = 0
values = [{ name = "stress", quantity = "cell_von_mises_stress", measure = "max" }]
"#;
    let swapped = input.replace("upper-face\", leader = \"lower-face", "lower-face\", leader = \"upper-face");
    let [mortar, back] = [input, &swapped].map(|input| input.replace(", kind = \"nodes\"", ""));
    for (input, numbers, excess) in [
        (input, [2, 4], 0.0),
        (input, [2, 3], 0.08),
        (&swapped, [2, 3], 0.12),
        (&mortar, [2, 3], 0.0),
        (&back, [2, 3], 0.0),
    ] {
        let place = Place::with(input);
        place.write("blocks.inp", &blocks(numbers));
        place.succeed(&["run", "box.toml", "--quiet"]);
        let stress = place.history("out")["stress"].last().unwrap() / 1e-3 - 1.0;
        // The strain of 2e-7 changes the area; the book has whole percents.
        let tolerance = if excess == 0.0 { 1e-6 } else { 0.005 };
        assert!((stress - excess).abs() < tolerance, "{numbers:?}: {stress}");
    }
}

/// Two blocks whose nodes meet are one by `merge`, without a tie.
#[test]
fn near_nodes_are_merged() {
    let input = r#"[mesh]
file = "blocks.inp"
merge = 1e-6
[[region]]
density = 1
material.neo-hooke = { lambda = 4000, mu = 2000 }
[initial]
velocity = [1, 0, 0]
[time]
scheme = "DGM"
steps = [{ until = 0.2, size = 0.1 }]
[output]
directory = "out"
"#;
    let place = Place::with(input);
    place.write("blocks.inp", &blocks([2, 2]));
    let checked = place.succeed(&["check", "box.toml"]);
    assert!(checked.stdout.contains("45 nodes, 16 cells"), "{}", checked.stdout);
    assert!(checked.stderr.contains("note: 9 nodes are merged with others\n"), "{}", checked.stderr);
    assert!(!checked.stderr.contains("not joined"), "{}", checked.stderr);
    // A run from the resolved input has the same mesh.
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.succeed(&["run", "out/input.toml", "--quiet", "--output", "again"]);
    let energies = ["out", "again"].map(|name| place.history(name)["kinetic_energy"].clone());
    assert_eq!(energies[0], energies[1]);
    for (merge, message) in [
        ("0.6", "cell 0 has two nodes within 0.6 of each other near [0, 0, 0], which would be one"),
        ("-1", "`merge` must be positive"),
    ] {
        place.write("wrong.toml", &input.replace("1e-6", merge));
        let failed = place.emmy(&["check", "wrong.toml"]);
        assert!(failed.code == 2 && failed.stderr.contains(message), "{}", failed.stderr);
    }
    let one = input.replace("file = \"blocks.inp\"", "box = { size = [1, 1, 1], cells = [2, 1, 1] }");
    place.write("none.toml", &one.replace("1e-6", "1e-9"));
    let checked = place.succeed(&["check", "none.toml"]);
    assert!(checked.stderr.contains("note: merge = 1e-9: no two nodes are so near\n"), "{}", checked.stderr);
}

#[test]
fn every_fault_is_shown_at_once() {
    let input = INPUT
        .replace("\"bottom-2\"", "\"botom-2\"")
        .replace("leader = \"top-1\"\nkind = \"nodes\"", "leader = \"top-4\"\nkind = \"mortr\"")
        .replace("kind = \"nodes\"", "kind = \"node\"");
    let failed = place(&input, [0.0; 2]).emmy(&["check", "box.toml"]);
    assert_eq!(failed.code, 2);
    for part in ["`mortr` is not a kind of tie", "did you mean `mortar`?", "did you mean `nodes`?"] {
        assert!(failed.stderr.contains(part), "{}", failed.stderr);
    }
    let input = INPUT.replace("\"bottom-2\"", "\"botom-2\"").replace("\"top-1\"", "\"nowhere\"");
    let failed = place(&input, [0.0; 2]).emmy(&["check", "box.toml"]);
    assert_eq!(failed.code, 2);
    for part in [
        "the mesh has no group `botom-2` of nodes, facets or cells",
        "did you mean `bottom-2`?",
        "the mesh has no group `nowhere` of nodes, facets or cells",
    ] {
        assert!(failed.stderr.contains(part), "{}", failed.stderr);
    }
    let failed = place(&INPUT.replace("\"top-2\"", "\"bottom-3\""), [0.0; 2]).emmy(&["check", "box.toml"]);
    assert!(
        failed.code == 2 && failed.stderr.contains("`bottom-3` cannot follow itself"),
        "{}",
        failed.stderr
    );
    let held = format!("{INPUT}\n[[support]]\ngroup = \"bottom-3\"\nfix = [\"x\"]\n");
    let failed = place(&held, [0.0; 2]).emmy(&["check", "box.toml"]);
    assert!(failed.code == 2 && failed.stderr.contains("is tied to others; hold these"), "{}", failed.stderr);
    let failed = place(&INPUT.replace("\"bottom-3\"", "\"bottom-2\""), [0.0; 2]).emmy(&["check", "box.toml"]);
    assert!(failed.code == 2 && failed.stderr.contains("this tie"), "{}", failed.stderr);
}

#[test]
fn a_run_with_other_ties_is_another_run() {
    let place = place(INPUT, [0.01, 0.02]);
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.2"]);
    let failed = place.emmy(&["resume", "out", "--until", "0.4", "--set", "tie.1.tolerance=0.1"]);
    assert_eq!(failed.code, 2);
    assert!(failed.stderr.contains("`tie.1.tolerance` is 0.1, but 0.05"), "{}", failed.stderr);
    place.succeed(&["resume", "out", "--quiet", "--until", "0.4"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    assert_same_rows(&place, "out", "whole");
}
