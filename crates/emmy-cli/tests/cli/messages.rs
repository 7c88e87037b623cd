//! Whole messages, as they look where there is no terminal.

use super::{BOX, Place};

fn message(from: &str, to: &str) -> String {
    let outcome = Place::with(&BOX.replacen(from, to, 1)).emmy(&["check", "box.toml"]);
    assert_eq!(outcome.code, 2);
    outcome.stderr
}

#[test]
fn unknown_key() {
    insta::assert_snapshot!(message("density", "densty"));
}

#[test]
fn two_kinds_of_load() {
    insta::assert_snapshot!(message("traction", "force = [1, 0, 0]\ntraction"));
}

#[test]
fn scheme_that_does_not_fit_the_degree() {
    insta::assert_snapshot!(message("degree = 1", "degree = 3"));
}

#[test]
fn group_that_is_not_there() {
    insta::assert_snapshot!(message("y-max", "y-mux"));
}

#[test]
fn flag() {
    let outcome = Place::with(BOX).emmy(&["check", "box.toml", "--set", "time.scheme=midpoint"]);
    insta::assert_snapshot!(outcome.stderr);
}
