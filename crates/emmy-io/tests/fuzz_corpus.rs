//! The inputs that fuzzing kept (`fuzz/corpus`), read once more: none may panic, whatever the toolchain.

use std::fs;
use std::path::{Path, PathBuf};

use emmy_io::input::{self, Overrides};

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty(), "{target}");
    files
}

#[test]
fn mesh_files() {
    for (target, name) in [("gmsh", "fuzz.msh"), ("abaqus", "fuzz.inp"), ("vtu", "fuzz.vtu")] {
        for file in corpus(target) {
            let read = emmy_io::mesh::parse_with_links(
                name.as_ref(),
                &fs::read(&file).unwrap(),
                &["links".to_string()],
            );
            if let Err(error) = read {
                assert!(!error.to_string().is_empty(), "{}", file.display());
            }
        }
    }
}

#[test]
fn inputs() {
    for file in corpus("input") {
        if let Err(error) = input::read(&file, &Overrides::default()) {
            assert!(!error.faults().is_empty(), "{}", file.display());
        }
    }
}
