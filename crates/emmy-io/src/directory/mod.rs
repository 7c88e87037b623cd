//! The output directory. Files of others are never overwritten or removed.
//!
//! A run may write into a directory that does not exist, that is empty, or that holds an earlier run of Emmy (its
//! `input.toml` begins with [`MARK`]). An earlier run is replaced: `input.toml`, [`FILES`], its checkpoints, the frames
//! of its collections, its series of frames (`.vtkhdf`) and its pictures are removed, all other files stay. Any other
//! directory is rejected.
//!
//! Studies and comparisons have directories of their own kind, recognized by one of their files ([`check_kind`]).

mod contents;
mod error;
mod lock;
mod sources;

use std::path::Path;
use std::{fs, io};

use contents::{BEGINNINGS, is_run, remove_run};
pub use contents::{FILES, MARK};
pub(crate) use contents::{remove_frames, remove_pictures, remove_unfinished};
pub use error::DirectoryError;
pub use lock::Lock;
pub(crate) use sources::check as check_sources;

use emmy::mesh::Mesh;

use crate::input::{MESH_FILE, Problem};
use crate::vtk::{self, MESH_MARK};
use crate::whole_file::{self, names, remove, replace};

/// Checks that a run may write into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`] if it is a file or holds files that are not Emmy's.
pub fn check(path: &Path) -> Result<(), DirectoryError> {
    match first_name(path)? {
        Some(example) if !is_run(path) => Err(DirectoryError::Foreign { path: path.to_path_buf(), example }),
        _ => Ok(()),
    }
}

/// Checks that a run may write into its directory, and that it would not overwrite a file that it reads. Nothing is
/// changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check_run(problem: &Problem) -> Result<(), DirectoryError> {
    let directory = &problem.output.directory;
    check(directory)?;
    check_sources(directory, &problem.files)
}

/// Creates a directory for results that are not a run's. It may be new, empty, or hold earlier results, which are
/// recognized by a file that Emmy wrote, the witness. Nothing is removed.
///
/// # Errors
/// [`DirectoryError`] if it is a file or holds other files, and errors of the system.
pub fn prepare_kind(path: &Path, kind: &'static str, witness: &'static str) -> Result<(), DirectoryError> {
    check_kind(path, kind, witness)?;
    fs::create_dir_all(path).map_err(|error| system(path, error))
}

/// The check of [`prepare_kind`]. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`] if it is a file or holds other files.
pub fn check_kind(path: &Path, kind: &'static str, witness: &'static str) -> Result<(), DirectoryError> {
    let text = || whole_file::read_text(&path.join(witness)).unwrap_or_default();
    match first_name(path)? {
        Some(example) if !text().contains(MARK.trim_start_matches("# ")) => {
            Err(DirectoryError::OfAnotherKind { path: path.to_path_buf(), kind, witness, example })
        }
        _ => Ok(()),
    }
}

/// Name of some file in a directory; `None` if the directory is empty or missing.
fn first_name(path: &Path) -> Result<Option<String>, DirectoryError> {
    if !path.exists() {
        // A new directory needs a directory above it.
        return match path.ancestors().skip(1).find(|above| above.exists()) {
            Some(above) if !above.is_dir() => {
                Err(DirectoryError::NotADirectory { path: above.to_path_buf() })
            }
            _ => Ok(None),
        };
    }
    if !path.is_dir() {
        return Err(DirectoryError::NotADirectory { path: path.to_path_buf() });
    }
    let names = names(path).map_err(|error| system(path, error))?;
    Ok(names.into_iter().find(|name| !BEGINNINGS.contains(&name.as_str())))
}

/// Prepares a directory for a run: creates it, and removes the files of an earlier run.
///
/// # Errors
/// As [`check`], and errors of the system.
pub fn prepare(path: &Path) -> Result<(), DirectoryError> {
    check(path)?;
    fs::create_dir_all(path).map_err(|error| system(path, error))?;
    remove_run(path).map_err(|error| system(path, error))
}

/// Removes the runs in the subdirectories of a directory whose names are numbers. Files of others stay.
pub(crate) fn remove_numbered_runs(path: &Path) -> io::Result<()> {
    if !path.is_dir() {
        return Ok(());
    }
    for name in names(path)?.into_iter().filter(|name| name.parse::<usize>().is_ok()) {
        let run = path.join(name);
        if is_run(&run) {
            remove_run(&run)?;
            remove(&run.join("input.toml"))?;
        }
        if run.is_dir() && names(&run)?.is_empty() {
            fs::remove_dir(&run)?;
        }
    }
    if names(path)?.is_empty() { fs::remove_dir(path) } else { Ok(()) }
}

/// Writes a mesh that no other file holds.
///
/// # Errors
/// [`DirectoryError::System`] if a file of that name is not of Emmy, and errors of the system.
pub(crate) fn write_mesh(directory: &Path, mesh: &Mesh) -> Result<(), DirectoryError> {
    let path = directory.join(MESH_FILE);
    let is_own = |text: Vec<u8>| text.windows(MESH_MARK.len()).any(|part| part == MESH_MARK.as_bytes());
    if path.exists() && !whole_file::read(&path).is_ok_and(is_own) {
        let reason = "there is a file of this name that Emmy has not written";
        return Err(system(&path, io::Error::new(io::ErrorKind::AlreadyExists, reason)));
    }
    replace(&path, vtk::mesh_file(mesh).as_bytes()).map_err(|error| DirectoryError::File { path, error })
}

fn system(path: &Path, error: io::Error) -> DirectoryError {
    DirectoryError::System { path: path.to_path_buf(), error }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::vtk::COLLECTION_MARK;

    fn write(path: PathBuf, text: &str) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn directories_of_others_are_rejected() {
        let temp = tempfile::tempdir().unwrap();
        assert!(check(temp.path()).is_ok() && check(&temp.path().join("new")).is_ok());
        write(temp.path().join("input.toml"), "title = \"mine\"\n");
        assert!(matches!(prepare(temp.path()), Err(DirectoryError::Foreign { .. })));
        let file = temp.path().join("input.toml");
        assert!(matches!(prepare(&file), Err(DirectoryError::NotADirectory { .. })));
        assert_eq!(fs::read_to_string(file).unwrap(), "title = \"mine\"\n");
    }

    #[test]
    fn other_results_have_directories_of_their_own_kind() {
        let temp = tempfile::tempdir().unwrap();
        let prepare = |path: &Path| prepare_kind(path, "study", "study.toml");
        let new = temp.path().join("new");
        prepare(&new).unwrap();
        prepare(&new).unwrap();
        write(new.join("input.toml"), MARK);
        let error = prepare(&new).unwrap_err().to_string();
        assert!(error.contains("no study") && error.contains("input.toml"), "{error}");
        write(new.join("study.toml"), "title = 1");
        assert!(prepare(&new).is_err() && prepare(&new.join("study.toml")).is_err());
        write(new.join("study.toml"), MARK);
        prepare(&new).unwrap();
    }

    #[test]
    fn only_files_of_the_earlier_run_are_removed() {
        let temp = tempfile::tempdir().unwrap();
        let own = [
            "history.csv",
            "report.html",
            "summary.json",
            "old.pvd",
            "frames/old_000000.vtu",
            "frames/old_1000000.vtu",
            "frames/old_000020.vtu.part",
            "frames/old_000040.pvtu",
            "frames/old_000040/0000.vtu",
            "frames/old_000040/10000.vtu",
            "frames/old_000060.pvtu.part",
            "frames/old_000060/0003.vtu.part",
            "old.vtkhdf.part",
            "old.vtkhdf.copy",
            "run.log",
            "events.csv",
            "checkpoint/a.checkpoint",
            "pictures/start.png",
            "pictures/von_mises_stress.png",
            "pictures/largest_stretch.png.part",
            "pictures/extremes.csv",
            "pictures/mode-2.png",
        ];
        let foreign = [
            "checkpoint/mine.txt",
            "pictures/mine.png",
            "pictures/mode-2b.png",
            "notes.txt",
            "notes.part",
            "other.pvd",
            "other.vtkhdf",
            "frames/other_000000.vtu",
            "frames/old_final.vtu",
            "frames/old_1.vtu",
            "frames/old_000040/mine.vtu",
            "frames/other_000000/0000.vtu",
        ];
        own.iter().chain(&foreign).for_each(|name| write(temp.path().join(name), "x"));
        write(temp.path().join("old.pvd"), COLLECTION_MARK);
        write(temp.path().join("input.toml"), MARK);
        prepare(temp.path()).unwrap();
        assert!(own.iter().all(|name| !temp.path().join(name).exists()));
        assert!(foreign.iter().all(|name| temp.path().join(name).exists()));
        assert!(!temp.path().join("frames/old_000060").exists());
    }
}
