//! `new`, `check`, `list`, `completions`, and the command line itself.

use super::{BOX, Place};

#[test]
fn new_writes_an_example_that_checks_and_never_overwrites() {
    for name in ["l-block", "quasi-rigid", "cantilever", "spinning-block"] {
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
fn check_reports_and_writes_nothing() {
    let place = Place::with(BOX);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    for part in [
        "12 nodes, 2 cells (2 hex8)",
        "36 degrees of freedom, 12 fixed, 24 free",
        "y-max: 1 facets, 4 nodes",
        "body: 2 cells, volume 2, mass 4, centre [0.5, 1, 0.5]",
        "[[1.666666667, 0, 0], [0, 0.6666666667, 0], [0, 0, 1.666666667]]",
        "traction on y-max: force [0, 0, 10], torque about the origin [20, -5, 0]",
        "y-min: x, y, z fixed, 12 degrees of freedom",
        "8 steps from t = 0 to t = 0.5",
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
}

#[test]
fn list_has_the_key_word_first() {
    let place = Place::new();
    let expected = [
        ("schemes", ["FE(n)", "DGM"]),
        ("materials", ["saint-venant-kirchhoff", "neo-hooke"]),
        ("elements", ["hex8", "tet10"]),
        ("meshes", ["l-block", "file"]),
        ("solvers", ["auto", "auto"]),
        ("templates", ["l-block", "cantilever"]),
    ];
    for (what, words) in expected {
        let text = place.succeed(&["list", what]).stdout;
        let first: Vec<&str> = text.lines().map(|line| line.split_whitespace().next().unwrap()).collect();
        let json: serde_json::Value =
            serde_json::from_str(&place.succeed(&["list", what, "--json"]).stdout).unwrap();
        let named: Vec<&str> =
            json.as_array().unwrap().iter().map(|item| item["name"].as_str().unwrap()).collect();
        assert_eq!(first, named);
        assert!(words.iter().all(|word| first.contains(word)), "{what}: {text}");
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
