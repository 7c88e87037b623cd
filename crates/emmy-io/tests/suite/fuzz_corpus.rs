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
fn checkpoints() {
    for file in corpus("checkpoint") {
        // The corpus has no checksums: the fuzz target adds them.
        let mut bytes = fs::read(&file).unwrap();
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        match emmy_io::checkpoint::parse(&bytes) {
            Ok(checkpoint) => {
                assert_eq!(checkpoint.snapshot.state.displacement.len(), 24, "{}", file.display())
            }
            Err(reason) => assert!(!reason.is_empty(), "{}", file.display()),
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
