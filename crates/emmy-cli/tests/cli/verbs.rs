//! `new`, `check`, `list`, `completions`, and the command line itself.

use super::{BOX, Place};

#[test]
fn new_writes_an_example_that_checks_and_never_overwrites() {
    for name in ["l-block", "quasi-rigid", "cantilever", "spinning-block", "driven-beam"] {
        let place = Place::new();
        let file = format!("{name}.toml");
        let outcome = place.succeed(&["new", name]);
        assert!(outcome.stdout.is_empty() && outcome.stderr.contains(&file));
        let report = place.succeed(&["check", &file]).stdout;
        assert!(report.contains("scheme") && report.contains("plan"), "{report}");
        place.write(&file, "mine");
        assert_eq!(place.emmy(&["new", name]).code, 2);
        assert_eq!(place.read(&file), "mine");
    }
}

#[test]
fn new_without_a_known_name_lists_the_examples() {
    let place = Place::new();
    for arguments in [&["new"][..], &["new", "lblock"]] {
        let outcome = place.emmy(arguments);
        assert_eq!(outcome.code, 2);
        assert!(["l-block", "quasi-rigid", "cantilever"].iter().all(|name| outcome.stderr.contains(name)));
    }
    assert!(place.names(".").is_empty());
}

#[test]
fn new_says_where_the_examples_with_meshes_are() {
    let place = Place::new();
    for name in [
        "bolted-bracket",
        "bracket",
        "satellite",
        "steel-bracket",
        "tied-blocks",
        "tuning-fork",
        "two-materials",
    ] {
        let outcome = place.emmy(&["new", name]);
        assert_eq!(outcome.code, 2);
        let mesh = name.strip_prefix("bolted-").unwrap_or(name);
        for file in [format!("examples/{name}.toml"), format!("examples/meshes/{mesh}.msh")] {
            assert!(outcome.stderr.contains(&file), "{}", outcome.stderr);
            assert!(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(&file).is_file());
        }
        assert!(place.emmy(&["new"]).stderr.contains(name));
    }
    assert!(place.names(".").is_empty());
}

#[test]
fn check_reports_and_writes_nothing() {
    let place = Place::with(BOX);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    for part in [
        "12 nodes, 2 cells (2 hex8)",
        "36 degrees of freedom, 12 fixed, 24 free",
        "y-max: 1 facet, 4 nodes",
        "body: 2 cells, volume 2, mass 4, centre [0.5, 1, 0.5]",
        "[[1.66667, 0, 0], [0, 0.666667, 0], [0, 0, 1.66667]]",
        "traction on y-max: force [0, 0, 10], torque about the origin [20, -5, 0]",
        "y-min: x, y, z fixed, 12 degrees of freedom",
        "8 steps from t = 0 to t = 0.5",
        "out, 5 frames",
        "AS(2), degree 1",
        "aspect ratio 1.0000",
        "tip: node",
    ] {
        assert!(report.contains(part), "{part}\n{report}");
    }
    assert_eq!(place.names("."), ["box.toml"]);
    let report =
        place.succeed(&["check", "box.toml", "--set", "time.scheme=DGM", "--set", "time.degree=3"]).stdout;
    assert!(report.contains("DGM, degree 3"), "{report}");
    let report = place.succeed(&["check", "box.toml", "--set", "output.every=3"]).stdout;
    assert!(report.contains("out, 4 frames"), "{report}");
}

#[test]
fn symmetry_fixes_the_normal_component_of_its_plane() {
    let input = BOX
        .replacen("box = { size = [1, 2, 1], cells = [1, 2, 1] }", "file = \"tet.inp\"", 1)
        .replacen("fix = [\"x\", \"y\", \"z\"]", "symmetry = true", 1)
        .replacen("y-min", "floor", 1);
    let place = Place::with(&input);
    let deck = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n\
                *Surface, name=floor\n1, S1\n";
    place.write("tet.inp", deck);
    let report = place.succeed(&["check", "box.toml", "--set", "load="]).stdout;
    assert!(report.contains("floor: z fixed, 3 degrees of freedom"), "{report}");
}

#[test]
fn a_group_of_nodes_is_counted_by_its_own_nodes() {
    let input = BOX
        .replacen("box = { size = [1, 2, 1], cells = [1, 2, 1] }", "file = \"tet.inp\"", 1)
        .replacen("y-min", "left", 1);
    let place = Place::with(&input);
    // The set `left` has the tetrahedron, its first face, and two nodes.
    let deck = "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n9,9,9,9\n*Element, type=C3D4, elset=left\n1, 1,2,3,4\n\
                *Elset, elset=body\n1\n*Surface, name=left\n1, S1\n*Nset, nset=left\n1,2\n*Nset, nset=far\n9\n";
    place.write("tet.inp", deck);
    let report = place.succeed(&["check", "box.toml", "--set", "load="]).stdout;
    for line in ["left: 1 cell, 1 facet, 2 nodes\n", "far: no nodes of cells\n"] {
        assert!(report.contains(line), "{line}\n{report}");
    }
}

/// Two unit cubes side by side without a common node, and one node without a cell.
const CUBES: &str = "*Node\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                     11,1,0,0\n12,2,0,0\n13,2,1,0\n14,1,1,0\n15,1,0,1\n16,2,0,1\n17,2,1,1\n18,1,1,1\n99,9,9,9\n\
                     *Element, type=C3D8, elset=steel\n7, 1,2,3,4,5,6,7,8\n\
                     *Element, type=C3D8, elset=rubber\n9, 11,12,13,14,15,16,17,18\n";

#[test]
fn check_reports_on_parts_and_the_whole_body() {
    let region = |group: &str, density: f64| {
        format!(
            "[[region]]\ngroup = \"{group}\"\ndensity = {density}\nmaterial.neo-hooke = {{ lambda = 10.0, mu = 5.0 }}\n"
        )
    };
    let time = "[time]\nscheme = \"DGM\"\nsteps = [{ until = 1.0, size = 0.5 }]\n";
    let (steel, rubber) = (region("steel", 3.0), region("rubber", 1.0));
    let place = Place::with(&format!("[mesh]\nfile = \"cubes.inp\"\n{steel}{rubber}{time}"));
    place.write("cubes.inp", CUBES);
    let outcome = place.succeed(&["check", "box.toml"]);
    // Masses 3 and 1, centres 1 apart: I_yy = (3 + 1)/6 + 3/4.
    for part in [
        "parts      2, which are not connected",
        "1 cell of steel, the first is cell 0",
        "1 cell of rubber, the first is cell 1",
        "largest aspect ratio 1.0000 (cell 0, hex8)",
        "steel: 1 cell, volume 1, mass 3, centre [0.5, 0.5, 0.5]",
        "body       all regions: 2 cells, volume 2, mass 4, centre [0.75, 0.5, 0.5]",
        "[[0.666667, 0, 0], [0, 1.41667, 0], [0, 0, 1.41667]]",
    ] {
        assert!(outcome.stdout.contains(part), "{part}\n{}", outcome.stdout);
    }
    for note in ["4 nodes lie where another one does, the first at [1, 0, 0]", "1 node belongs to no cell"] {
        assert!(outcome.stderr.contains(note), "{note}\n{}", outcome.stderr);
    }
    let report = Place::with(BOX).succeed(&["check", "box.toml"]).stdout;
    assert!(!report.contains("parts") && !report.contains("all regions"), "{report}");
}

#[test]
fn check_reports_on_the_start() {
    let input = BOX.replace(
        "velocity = [0, 0, 0]",
        "velocity = [1, 0, 0]\ngradient = [[0, 0, 0], [0, 0, 0], [0, 0, 1]]",
    );
    let input = input.replace("[[support]]\ngroup = \"y-min\"\nfix = [\"x\", \"y\", \"z\"]\n", "");
    let report = Place::with(&input).succeed(&["check", "box.toml"]).stdout;
    // Mass 4 at v = (1, 0, z), z from 0 to 1: T = 4/2 (1 + 1/3), P = 4 (1, 0, 1/2), L = integral of rho x cross v.
    for part in [
        "all nodes: velocity [1, 0, 0]",
        "gradient [[0, 0, 0], [0, 0, 0], [0, 0, 1]]",
        "kinetic energy 2.66667",
        "linear momentum [4, 0, 2]",
        "angular momentum about the origin [2, 1, -4]",
    ] {
        assert!(report.contains(part), "{part}\n{report}");
    }
    assert!(!Place::with(BOX).succeed(&["check", "box.toml"]).stdout.contains("gradient"));
}

#[test]
fn list_has_the_key_word_first() {
    let place = Place::new();
    let expected = [
        ("schemes", ["FE(n)", "DGM"]),
        ("estimators", ["difference", "sampled"]),
        ("materials", ["neo-hooke", "holzapfel-gasser-ogden"]),
        ("elements", ["hex8", "tet10"]),
        ("meshes", ["l-block", "file"]),
        ("solvers", ["auto", "auto"]),
        ("templates", ["l-block", "cantilever"]),
        ("fields", ["cauchy_stress", "axial_force"]),
    ];
    for (what, words) in expected {
        let text = place.succeed(&["list", what]).stdout;
        let json: serde_json::Value =
            serde_json::from_str(&place.succeed(&["list", what, "--json"]).stdout).unwrap();
        let named: Vec<&str> =
            json.as_array().unwrap().iter().map(|item| item["name"].as_str().unwrap()).collect();
        assert_eq!(text.lines().count(), named.len());
        assert!(text.lines().zip(&named).all(|(line, name)| line.starts_with(name)), "{what}: {text}");
        assert!(words.iter().all(|word| named.contains(word)), "{what}: {text}");
    }
    let words = place.succeed(&["list"]).stdout;
    for what in ["schemes", "estimators", "materials", "elements", "meshes", "solvers", "fields", "templates"]
    {
        let line = words.lines().find(|line| line.split_whitespace().next() == Some(what)).unwrap();
        assert!(line.split_whitespace().count() > 2, "{line}");
    }
    for line in place.succeed(&["list", "materials"]).stdout.lines() {
        let is_link = ["bar", "spring", "attraction"].iter().any(|link| line.starts_with(link));
        let parts = [if is_link { "V = " } else { "W = " }, "; parameter"];
        assert!(parts.iter().all(|part| line.contains(part)), "{line}");
    }
    assert_eq!(place.emmy(&["list", "cheese"]).code, 2);
}

#[test]
fn completions_know_the_verbs() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(Place::new().succeed(&["completions", shell]).stdout.contains("check"));
    }
}

#[test]
fn wrong_arguments_end_with_2() {
    let place = Place::with(BOX);
    for arguments in [
        &[][..],
        &["fly"],
        &["run"],
        &["run", "box.toml", "--threads", "0"],
        &["run", "box.toml", "--until", "soon"],
        &["run", "box.toml", "--speed", "2"],
        &["run", "nothing.toml"],
        &["run", "."],
        &["check", "box"],
    ] {
        let outcome = place.emmy(arguments);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{arguments:?}");
        assert!(!outcome.stderr.is_empty());
    }
    assert!(place.emmy(&["check", "box"]).stderr.contains("did you mean box.toml?"));
    assert_eq!(place.names("."), ["box.toml"]);
    assert!(place.succeed(&["--version"]).stdout.starts_with("emmy "));
    assert!(place.succeed(&["--help"]).stdout.contains("Exit codes"));
}
