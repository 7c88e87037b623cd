//! The claims and tables in the pages of the book are those of `results.md`, and every claim holds.
//!
//! They stand between `<!-- part: NAME -->` and `<!-- end of part -->` in both.
//! `EMMY_UPDATE_DOCS=1 cargo test -p emmy-validation --test book` writes them into the pages.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const START: &str = "<!-- part: ";
const END: &str = "<!-- end of part -->";

fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../book/src")
}

fn results() -> String {
    std::fs::read_to_string(book().join("paper/results.md")).unwrap()
}

/// Pages of the book.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { pages(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect()
}

/// Splits a page at its parts: the text before the first one, and for each its name, its text and the text after it.
fn split(page: &str) -> (&str, Vec<(&str, &str, &str)>) {
    let mut pieces = page.split(START);
    let before = pieces.next().unwrap();
    let parts = pieces.map(|piece| {
        let (name, rest) = piece.split_once(" -->").expect("the name ends");
        let (text, after) = rest.split_once(END).expect("the part ends");
        (name, text, after)
    });
    (before, parts.collect())
}

#[test]
fn the_parts_of_the_pages_are_those_of_the_results() {
    let results = results();
    let (_, parts) = split(&results);
    let own: BTreeMap<&str, &str> = parts.into_iter().map(|(name, text, _)| (name, text)).collect();
    let mut n_parts = 0;
    for path in pages(&book()) {
        let page = std::fs::read_to_string(&path).unwrap();
        let (before, parts) = split(&page);
        n_parts += parts.len();
        let filled = parts.iter().map(|(name, _, after)| {
            let text = own.get(name).unwrap_or_else(|| panic!("{}: {name}", path.display()));
            format!("{START}{name} -->{text}{END}{after}")
        });
        let filled = before.to_string() + &filled.collect::<String>();
        if std::env::var_os("EMMY_UPDATE_DOCS").is_some() {
            std::fs::write(&path, filled).unwrap();
        } else {
            assert!(
                page == filled,
                "{}: the first lines of this test say how to write its parts",
                path.display()
            );
        }
    }
    assert!(n_parts > own.len(), "the pages show none of them");
}

#[test]
fn every_claim_of_the_book_holds() {
    let results = results();
    assert!(results.contains("Full set") && !results.contains("FAILS"));
    assert!(results.matches("**holds**").count() > 60);
}
