//! Small decks with rigid elements, couplings, equations, masses and springs, in the format of Abaqus and in that of
//! Nastran (`decks/decks.py`), against their natural frequencies in CalculiX.

use super::Place;

/// The decks with their frequencies.
pub(super) fn decks() -> Vec<(String, Vec<f64>)> {
    let table: toml::Table = include_str!("../decks/calculix.toml").parse().unwrap();
    let row = |(name, values): (String, toml::Value)| {
        let values = values.as_array().unwrap().iter().map(|value| value.as_float().unwrap()).collect();
        (name, values)
    };
    table.into_iter().map(row).collect()
}

/// An input for a deck, and what holds it.
pub(super) fn input(name: &str, extension: &str, group: &str) -> String {
    let file = format!("{}/tests/decks/{name}.{extension}", env!("CARGO_MANIFEST_DIR"));
    format!(
        "mesh.file = '{file}'\n\n[[region]]\ndensity = 1.5\n\
         material.saint-venant-kirchhoff = {{ youngs_modulus = 2000, poissons_ratio = 0.3 }}\n\n\
         [[support]]\ngroup = '{group}'\nfix = ['x', 'y', 'z']\n\n[equilibrium]\n"
    )
}

#[test]
fn modes_of_decks_are_those_of_calculix() {
    let place = Place::new();
    assert_eq!(decks().len(), 10);
    let mut wrong = Vec::new();
    for (name, expected) in decks() {
        for (extension, group) in [("inp", "FIX"), ("bdf", "spc_1")] {
            place.write("deck.toml", &input(&name, extension, group));
            let output = format!("{name}-{extension}");
            let n = expected.len().to_string();
            let outcome = place.emmy(&["modes", "deck.toml", "--count", &n, "--output", &output]);
            assert_eq!(outcome.code, 0, "{name}.{extension}: {}", outcome.stderr);
            let modes = place.read(&format!("{output}/modes.csv"));
            let own: Vec<f64> =
                modes.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().parse().unwrap()).collect();
            // CalculiX prints seven digits.
            let off = own.iter().zip(&expected).map(|(own, due)| (own / due - 1.0).abs()).fold(0.0, f64::max);
            if own.len() != expected.len() || off > 1e-6 {
                wrong.push(format!("{name}.{extension}: {own:?}\n{expected:?}\n{}", outcome.stderr));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Entries of a deck stand in the resolved input, and can be left out or referred to by their names.
#[test]
fn what_a_deck_has_can_be_left_out() {
    let place = Place::new();
    place.write("deck.toml", &input("rigid-mass", "bdf", "spc_1"));
    let check = place.succeed(&["check", "deck.toml"]);
    let text = format!("{}{}", check.stdout, check.stderr);
    assert!(text.contains("rbe2_901"), "{text}");
    place.succeed(&["run", "deck.toml", "--quiet", "--output", "all"]);
    let resolved = place.read("all/input.toml");
    for part in ["leave_out = [\"rbe2_901\", \"conm2_902\"]", "name = \"rbe2_901\"", "mass = 2.0"] {
        assert!(resolved.contains(part), "{part}\n{resolved}");
    }
    // The resolved input is the same run.
    place.succeed(&["modes", "all/input.toml", "--count", "3", "--quiet", "--output", "again"]);
    place.succeed(&["modes", "deck.toml", "--count", "3", "--quiet", "--output", "first"]);
    assert_eq!(place.read("again/modes.csv"), place.read("first/modes.csv"));
    let bare = ["--set", "mesh.leave_out=['rbe2_901','conm2_902']", "--output", "bare"];
    place.succeed(&[&["modes", "deck.toml", "--count", "3", "--quiet"], &bare[..]].concat());
    // The block alone, in CalculiX.
    let frequency: f64 =
        place.read("bare/modes.csv").lines().nth(1).unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!((frequency / 0.7442006 - 1.0).abs() < 1e-6, "{frequency}");
    // A mass on a body goes with it.
    let body = ["--set", "mesh.leave_out=['rbe2_901']", "--output", "body"];
    let outcome = place.succeed(&[&["modes", "deck.toml", "--count", "3"], &body[..]].concat());
    for part in ["switched off by `mesh.leave_out`: rbe2_901", "conm2_902 is left out with rbe2_901"] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    assert!(!outcome.stderr.contains("mass acts"), "{}", outcome.stderr);
    assert_eq!(place.read("body/modes.csv"), place.read("bare/modes.csv"));
    let wrong = place.emmy(&["check", "deck.toml", "--set", "mesh.leave_out=['rbe2_90']"]);
    assert!(wrong.code == 2 && wrong.stderr.contains("did you mean `rbe2_901`?"), "{}", wrong.stderr);
}

/// A distributing coupling whose point lies off the plane of its nodes, and a mass there, are left out by name.
#[test]
fn what_cannot_act_is_named() {
    let place = Place::new();
    let deck = include_str!("../decks/distributing-mass.inp");
    let off = deck.replace("37, 3, 0.5, 0.5\n", "37, 4, 0.5, 0.5\n");
    assert_ne!(off, deck);
    place.write("off.inp", &off);
    let text = input("x", "inp", "FIX");
    let file = format!("{}/tests/decks/x.inp", env!("CARGO_MANIFEST_DIR"));
    place.write("deck.toml", &text.replace(&file, "off.inp"));
    let check = place.succeed(&["check", "deck.toml"]);
    for part in [
        "coupling-END is left out: coupling \"coupling-END\": the nodes of",
        "lie in a plane, and the point [4, 0.5, 0.5] is 1 off",
        "coupling-END-mass is left out with coupling-END",
    ] {
        assert!(check.stderr.contains(part), "{part}\n{}", check.stderr);
    }
}
