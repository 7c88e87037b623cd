//! The book takes code, inputs and numbers from tested files; all files that it names must exist.

use std::path::{Path, PathBuf};

/// Pages of the book.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { pages(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect()
}

/// Texts between two marks.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    text.split(start).skip(1).filter_map(|rest| rest.split_once(end)).map(|(inside, _)| inside).collect()
}

fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../book/src")
}

#[test]
fn everything_that_is_included_is_there() {
    let mut n_included = 0;
    for page in pages(&book()) {
        let text = std::fs::read_to_string(&page).unwrap();
        for include in between(&text, "{{#include ", "}}") {
            let (file, anchor) = include.split_once(':').map_or((include, None), |(f, a)| (f, Some(a)));
            let path = page.parent().unwrap().join(file);
            let included =
                std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{include}: {error}"));
            if let Some(anchor) = anchor {
                for mark in ["ANCHOR", "ANCHOR_END"].map(|mark| format!("{mark}: {anchor}")) {
                    let is_there =
                        included.lines().any(|line| line.trim_end_matches(" -->").ends_with(&mark));
                    assert!(is_there, "{}: {include}", page.display());
                }
            }
            n_included += 1;
        }
    }
    assert!(n_included > 20);
}

#[test]
fn pictures_and_pages_are_there() {
    for page in pages(&book()) {
        let text = std::fs::read_to_string(&page).unwrap();
        let links = between(&text, "](", ")").into_iter().filter(|link| !link.contains("://"));
        for link in links {
            let path = page.parent().unwrap().join(link.split('#').next().unwrap());
            assert!(path.exists(), "{}: {link}", page.display());
        }
    }
}

#[test]
fn every_claim_of_the_book_holds() {
    let results = std::fs::read_to_string(book().join("paper/results.md")).unwrap();
    assert!(results.contains("Full set") && !results.contains("FAILS"));
    assert!(results.matches("**holds**").count() > 60);
}
