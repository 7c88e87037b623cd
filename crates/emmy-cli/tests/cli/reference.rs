//! The pages of input and results (`book/src/input.md`, `book/src/results.md`) against the program.

use super::{BOX, Place};

const INPUT: &str = include_str!("../../../../book/src/input.md");
const RESULTS: &str = include_str!("../../../../book/src/results.md");

fn has(word: &str) {
    let word = format!("`{word}`");
    assert!(
        INPUT.contains(&word) || RESULTS.contains(&word),
        "book/src/input.md and book/src/results.md lack {word}"
    );
}

#[test]
fn it_has_every_column_and_every_field() {
    let place = Place::with(&BOX.replace("tip", "NAME"));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("out");
    history.keys().for_each(|column| has(&column.replace("y-min", "GROUP")));
    for field in place.summary("out").as_object().unwrap().keys() {
        // The page names the peaks of any column X.
        let is_peak =
            |suffix: &&&str| field.strip_suffix(**suffix).is_some_and(|column| history.contains_key(column));
        match ["_min_time", "_min", "_max_time", "_max"].iter().find(is_peak) {
            Some(suffix) => has(&format!("X{suffix}")),
            None if history.contains_key(field) => has(&field.replace("y-min", "GROUP")),
            None => has(field),
        }
    }
}

#[test]
fn it_has_every_scheme_material_and_field_of_a_frame() {
    for what in ["schemes", "materials", "fields"] {
        let list = Place::new().succeed(&["list", what, "--json"]).stdout;
        let list: serde_json::Value = serde_json::from_str(&list).unwrap();
        list.as_array().unwrap().iter().for_each(|item| has(item["name"].as_str().unwrap()));
    }
}

#[test]
fn its_smallest_input_checks() {
    let input = INPUT.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let report = Place::with(input).succeed(&["check", "box.toml"]).stdout;
    assert!(report.contains("100 steps from t = 0 to t = 10"), "{report}");
}
