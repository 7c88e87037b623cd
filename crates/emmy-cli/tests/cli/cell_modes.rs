//! Cells with incompatible modes: runs in parts, natural modes, checks. Files are of the nodes of the mesh.

use super::resume::{assert_same_rows, even_box, frames};
use super::{BOX, Place};

fn with_modes(input: &str) -> String {
    let input = input.replace("[[region]]", "[[region]]\nformulation = \"incompatible-modes\"");
    assert!(input.contains("incompatible-modes"));
    input
}

#[test]
fn a_run_with_incompatible_modes_in_two_parts_is_the_run_in_one() {
    for (scheme, degree, size) in [("DGM", 2, 0.1), ("Newmark(0.25, 0.5)", 1, 0.05)] {
        let input =
            even_box(1.0, size).replace("AS(2)", scheme).replace("degree = 1", &format!("degree = {degree}"));
        let place = Place::with(&with_modes(&input));
        place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
        place.succeed(&["run", "box.toml", "--quiet", "--output", "parts", "--until", "0.3"]);
        place.succeed(&["resume", "parts", "--quiet", "--until", "1.0"]);
        assert_same_rows(&place, "parts", "whole");
        assert_eq!(frames(&place, "parts"), frames(&place, "whole"));
        // The modes are no rounding: the standard cells move differently.
        place.write("standard.toml", &input);
        place.succeed(&["run", "standard.toml", "--quiet", "--output", "standard"]);
        let work = |directory: &str| place.summary(directory)["external_work"].as_f64().unwrap();
        assert!((work("standard") / work("whole") - 1.0).abs() > 1e-3);
    }
}

#[test]
fn natural_modes_and_checks_know_incompatible_modes() {
    let place = Place::with(&with_modes(BOX));
    let check = place.succeed(&["check", "box.toml"]).stdout;
    assert!(check.contains("in the incompatible modes of cells, without mass"), "{check}");
    assert!(!check.contains("critical step"), "{check}");
    place.succeed(&["modes", "box.toml", "--count", "3", "--output", "own", "--quiet"]);
    // A frame is a mesh, with the vectors of its own nodes alone.
    let input = with_modes(BOX);
    let again = input
        .replace("box = { size = [1, 2, 1], cells = [1, 2, 1] }", "file = \"own/frames/own_000001.vtu\"");
    assert_ne!(again, input);
    place.write("again.toml", &again);
    place.succeed(&["check", "again.toml"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "ran"]);
    place.succeed(&["report", "ran"]);
}
