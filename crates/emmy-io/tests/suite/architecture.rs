//! The order of the files of the input.

use std::fs;
use std::path::{Path, PathBuf};

/// Files and folders of `src/input`; each uses only earlier ones.
const ORDER: [&str; 61] = [
    "fault",
    "excerpt",
    "syntax",
    "tree",
    "suggest",
    "description",
    "table",
    "placed",
    "finite",
    "expression",
    "shape",
    "context",
    "record",
    "measured",
    "history",
    "adaptive",
    "time",
    "support",
    "tie",
    "contact",
    "rigid",
    "coupling",
    "joint",
    "mechanism",
    "nodal",
    "load",
    "initial",
    "energy",
    "material",
    "groups",
    "equilibrium",
    "formulation",
    "region",
    "units",
    "quantities",
    "names",
    "settings",
    "plausible",
    "expect",
    "parameters",
    "catalogue",
    "synonyms",
    "canonical",
    "walk",
    "start",
    "complete",
    "set",
    "write",
    "derived",
    "plane_strain",
    "problem",
    "start_state",
    "source",
    "root",
    "deck",
    "sections",
    "large_output",
    "reading",
    "memory",
    "schema",
    "reference",
];

/// Code of a file without comments and without tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let code = text.split("#[cfg(test)]\n").next().unwrap();
    code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Whether a code names something of a file of the input: `super::file::`, `input::file::` or `file::` alone.
fn uses(code: &str, file: &str) -> bool {
    let word = format!("{file}::");
    let is_own = |before: &str| {
        let is_inside = before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        match before.strip_suffix("::") {
            Some(before) => before.ends_with("super") || before.ends_with("input"),
            None => !is_inside,
        }
    };
    code.match_indices(&word).any(|(at, _)| is_own(&code[..at]))
}

fn rust_files(path: PathBuf) -> Vec<PathBuf> {
    match path.is_dir() {
        true => fs::read_dir(path).unwrap().flat_map(|entry| rust_files(entry.unwrap().path())).collect(),
        false => vec![path],
    }
}

#[test]
fn files_of_the_input_use_only_earlier_ones() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/input");
    let mut n_uses = 0;
    for path in rust_files(folder.clone()) {
        let place = path.strip_prefix(&folder).unwrap().with_extension("");
        let own = place.iter().next().unwrap().to_str().unwrap();
        if own == "mod" {
            continue;
        }
        let rank = ORDER.iter().position(|file| *file == own);
        let rank = rank.unwrap_or_else(|| panic!("{own} has no place in the order"));
        let code = code(&path);
        let used = |file: &&&str| **file != own && uses(&code, file);
        n_uses += ORDER[..rank].iter().filter(used).count();
        let later: Vec<&&str> = ORDER[rank..].iter().filter(used).collect();
        assert!(later.is_empty(), "{own} uses {later:?}");
    }
    assert!(n_uses > 2 * ORDER.len(), "{n_uses}");
}

#[test]
fn uses_are_found() {
    let code = "use super::time::Time;\nuse super::{load, units};\nuse emmy::start::State; fn f() { units::g(my_load::h) }";
    let found: Vec<&&str> = ORDER.iter().filter(|file| uses(code, file)).collect();
    assert_eq!(found, [&"time", &"units"]);
}
