//! The inputs that fuzzing kept (`fuzz/corpus`), read with the stable toolchain: none may panic.

use std::fs;
use std::path::{Path, PathBuf};

use emmy::motion::{Motion, State};
use emmy_io::checkpoint;
use emmy_io::input::{self, Overrides};
use emmy_io::results::Results;
use emmy_io::summary::Status;

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty(), "{target}");
    files
}

#[test]
fn mesh_files() {
    let readers =
        [("gmsh", "fuzz.msh"), ("abaqus", "fuzz.inp"), ("nastran", "fuzz.bdf"), ("vtu", "fuzz.vtu")];
    for (target, name) in readers {
        for file in corpus(target) {
            let options = crate::meshes::links("links");
            let read = emmy_io::mesh::parse_with(name.as_ref(), &fs::read(&file).unwrap(), &options);
            if let Err(error) = read {
                assert!(!error.to_string().is_empty(), "{}", file.display());
            }
        }
    }
}

#[test]
fn checkpoints() {
    if std::env::var_os("EMMY_UPDATE_SEEDS").is_some() {
        write_seeds();
    }
    for file in corpus("checkpoint") {
        // The fuzz target sets the checksums of the corpus.
        let bytes = checkpoint::sealed(fs::read(&file).unwrap());
        let is_seed = SEEDS.iter().any(|(name, _)| file.ends_with(name));
        match checkpoint::parse(&bytes) {
            Ok(checkpoint) => {
                assert_eq!(checkpoint.snapshot.state.displacement.len(), 24, "{}", file.display())
            }
            Err(reason) => assert!(!is_seed && !reason.is_empty(), "{}: {reason}", file.display()),
        }
    }
}

/// Checkpoints of one cell, with the tables that differ between the inputs.
const SEEDS: [(&str, &str); 4] = [
    ("dgm", "[time]\nscheme = 'DGM'\nsteps = [{ until = 0.1, size = 0.01 }]\n"),
    ("newmark", "[time]\nscheme = 'Newmark(0.25, 0.5)'\nsteps = [{ until = 0.1, size = 0.01 }]\n"),
    ("adaptive", "[time]\nscheme = 'DGM'\ndegree = 2\nuntil = 0.1\nadaptive = { tolerance = 1e-4 }\n"),
    (
        "releases",
        "[[support]]\ngroup = 'x-min'\nfix = ['x']\nuntil = 0.05\n\
         [time]\nscheme = 'DGM'\nsteps = [{ until = 0.1, size = 0.01 }]\n",
    ),
];

fn write_seeds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/checkpoint");
    fs::create_dir_all(&folder).unwrap();
    for (name, tables) in SEEDS {
        fs::write(folder.join(name), seed(tables)).unwrap();
    }
}

/// The last checkpoint of a run.
fn seed(tables: &str) -> Vec<u8> {
    // A relative path, because the checkpoint contains the directory.
    let folder = Path::new("seed-of-a-checkpoint");
    fs::create_dir_all(folder).unwrap();
    let file = folder.join("cell.toml");
    let head = "mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }\n\
                region = { density = 2.0, material.neo-hooke = { lambda = 1000.0, mu = 500.0 } }\n\
                initial = { angular_velocity = [1, 2, 3], about = [0.5, 0.5, 0.5] }\n";
    fs::write(&file, format!("{head}[output]\nevery = 0\n{tables}")).unwrap();
    let overrides = Overrides { output: Some(folder.join("cell")), ..Overrides::default() };
    let problem = input::read(&file, &overrides).unwrap();
    let state = State::initial(&problem.body, 0.0, &problem.initial).unwrap();
    let mut motion = Motion::starting(&problem.body, problem.scheme, problem.newton, state).unwrap();
    let mut results = Results::create(&problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());
    let checkpoints = folder.join("cell/checkpoint");
    let bytes = fs::read(checkpoints.join("b.checkpoint"))
        .or_else(|_| fs::read(checkpoints.join("a.checkpoint")))
        .unwrap();
    fs::remove_dir_all(folder).unwrap();
    bytes
}

#[test]
fn inputs() {
    for file in corpus("input") {
        if let Err(error) = input::read(&file, &Overrides::default()) {
            assert!(!error.faults().is_empty(), "{}", file.display());
        }
    }
}
