//! The output directory: nothing of anybody else's is ever written over or removed.
//!
//! A run may write into a directory that does not exist, that is empty, or that holds an earlier run of Emmy (its
//! `input.toml` begins with [`MARK`]). An earlier run is replaced: `input.toml`, [`FILES`], its checkpoints, the frames of its
//! collections and its series of frames (`.vtkhdf`) are removed, every other file stays. A directory with other content is refused.
//!
//! Studies and comparisons have directories of their own kind, told by one of their files ([`check_kind`]).

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rust_hdf5::H5File;

use crate::input::Problem;
use crate::vtk::CREATOR;
use crate::{checkpoint, lock, sources};

/// First words of every `input.toml` that Emmy writes.
pub const MARK: &str = "# Written by Emmy";

/// Comment in every collection (`.pvd`) that Emmy writes.
pub(crate) const COLLECTION_MARK: &str = "<!-- Written by Emmy -->";

/// Ending of a file that is not whole yet.
pub(crate) const PART: &str = ".part";

/// Endings of what a run that was killed may leave beside its files.
const UNFINISHED: [&str; 8] = [
    ".vtkhdf.part",
    ".vtkhdf.copy",
    ".vtkhdf.journal",
    ".pvd.part",
    "history.csv.part",
    "summary.json.part",
    "input.toml.part",
    "report.html.part",
];
/// What a run writes besides its input and its frames.
pub const FILES: [&str; 6] =
    ["history.csv", "newton.csv", "events.csv", "run.log", "summary.json", "report.html"];

/// What a run leaves that was killed before it could write its `input.toml`.
const BEGINNINGS: [&str; 2] = [lock::FILE, "input.toml.part"];

/// Why a directory cannot be written to.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// It is a file.
    #[error("{path} is not a directory; name another one with --output")]
    NotADirectory {
        /// The path.
        path: PathBuf,
    },
    /// It holds files that are not of a run.
    #[error(
        "the directory {path} holds files that are not from a run of Emmy (such as {example}); nothing was written, \
         name another directory with --output"
    )]
    Foreign {
        /// The path.
        path: PathBuf,
        /// One of the files.
        example: String,
    },
    /// It holds files, but not those of its kind.
    #[error(
        "the directory {path} holds files, but no {kind} of Emmy (there is {example}, but no {witness} that Emmy wrote); \
         nothing was written, name another directory with --output"
    )]
    OfAnotherKind {
        /// The path.
        path: PathBuf,
        /// What it should hold.
        kind: &'static str,
        /// The file that would tell it.
        witness: &'static str,
        /// One of the files.
        example: String,
    },
    /// Another run writes into it.
    #[error(
        "another run of Emmy is writing into {path}; wait for it, or name another directory with --output"
    )]
    Busy {
        /// The path.
        path: PathBuf,
    },
    /// The run would remove or overwrite what it reads.
    #[error(
        "the run reads {file}, which is among the files in {path} that it would remove or overwrite; nothing was changed, \
         name another directory with --output or move that file"
    )]
    Source {
        /// The directory.
        path: PathBuf,
        /// The file.
        file: PathBuf,
    },
    /// The system refused.
    #[error("cannot write to {path}: {error}")]
    System {
        /// The path.
        path: PathBuf,
        /// What the system says.
        #[source]
        error: io::Error,
    },
}

/// Checks that a run may write into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`] if it is a file or holds what is not Emmy's.
pub fn check(path: &Path) -> Result<(), DirectoryError> {
    match first_name(path)? {
        Some(example) if !is_run(path) => Err(DirectoryError::Foreign { path: path.to_path_buf(), example }),
        _ => Ok(()),
    }
}

/// Checks that a run may write into its directory, and that nothing that it reads lies there in its way. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check_run(problem: &Problem) -> Result<(), DirectoryError> {
    let directory = &problem.output.directory;
    check(directory)?;
    sources::check(directory, &problem.files)
}

/// Makes a directory ready for results other than those of a run: it may be new, empty, or hold earlier ones, which
/// shows in a file, the witness, that says that Emmy wrote it. Nothing is removed.
///
/// # Errors
/// [`DirectoryError`] if it is a file, holds something else, or the system refuses.
pub fn prepare_kind(path: &Path, kind: &'static str, witness: &'static str) -> Result<(), DirectoryError> {
    check_kind(path, kind, witness)?;
    fs::create_dir_all(path).map_err(|error| system(path, error))
}

/// The check of [`prepare_kind`]. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`] if it is a file or holds something else.
pub fn check_kind(path: &Path, kind: &'static str, witness: &'static str) -> Result<(), DirectoryError> {
    let text = || fs::read_to_string(path.join(witness)).unwrap_or_default();
    match first_name(path)? {
        Some(example) if !text().contains(MARK.trim_start_matches("# ")) => {
            Err(DirectoryError::OfAnotherKind { path: path.to_path_buf(), kind, witness, example })
        }
        _ => Ok(()),
    }
}

/// Name of some file in a directory that is there and not empty.
fn first_name(path: &Path) -> Result<Option<String>, DirectoryError> {
    if !path.exists() {
        // What is to be made needs a directory to be made in.
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

/// Makes a directory ready for a run: created, and without the files of an earlier run.
///
/// # Errors
/// Those of [`check`], or what the system refuses.
pub fn prepare(path: &Path) -> Result<(), DirectoryError> {
    check(path)?;
    fs::create_dir_all(path).map_err(|error| system(path, error))?;
    remove_run(path).map_err(|error| system(path, error))
}

fn system(path: &Path, error: io::Error) -> DirectoryError {
    DirectoryError::System { path: path.to_path_buf(), error }
}

/// Whether a directory holds a run of Emmy.
fn is_run(path: &Path) -> bool {
    fs::read_to_string(path.join("input.toml")).is_ok_and(|text| text.starts_with(MARK))
}

fn remove_run(path: &Path) -> io::Result<()> {
    // Checkpoints first: without them nothing goes on from what is left, should it end here.
    remove_checkpoints(&path.join(checkpoint::DIRECTORY))?;
    for name in FILES {
        remove(&path.join(name))?;
    }
    for name in collections(path)? {
        remove_frames(&path.join("frames"), &name)?;
        remove(&path.join(format!("{name}.pvd")))?;
    }
    for name in names(path)?.into_iter().filter(|name| is_removed(path, name)) {
        remove(&path.join(&name))?;
    }
    Ok(())
}

/// Names of the collections of frames in a directory.
pub(crate) fn collections(path: &Path) -> io::Result<Vec<String>> {
    let is_own = |name: &String| {
        fs::read_to_string(path.join(format!("{name}.pvd"))).is_ok_and(|text| text.contains(COLLECTION_MARK))
    };
    let names = names(path)?.into_iter().filter_map(|name| Some(name.strip_suffix(".pvd")?.to_string()));
    Ok(names.filter(is_own).collect())
}

/// Whether a file is one whose name is not known beforehand and which the next run removes: a collection, a series, or what is not whole.
pub(crate) fn is_removed(path: &Path, name: &str) -> bool {
    // Names of files that are not whole yet are nobody else's.
    let is_unfinished = UNFINISHED.iter().any(|ending| name.ends_with(ending));
    let is_collection = || {
        name.ends_with(".pvd")
            && fs::read_to_string(path.join(name)).is_ok_and(|text| text.contains(COLLECTION_MARK))
    };
    is_unfinished || is_collection() || name.ends_with(".vtkhdf") && is_series(&path.join(name))
}

/// Removes what a run that was killed left beside its files, but for a series of frames that grows on.
pub(crate) fn remove_unfinished(path: &Path, has_series: bool) -> io::Result<()> {
    let is_of_series = |name: &str| name.ends_with(".vtkhdf.part") || name.ends_with(".vtkhdf.journal");
    for name in names(path)? {
        let is_unfinished = UNFINISHED.iter().any(|ending| name.ends_with(ending));
        if is_unfinished && !(has_series && is_of_series(&name)) {
            remove(&path.join(&name))?;
        }
    }
    Ok(())
}

/// Whether a file is a series of frames that Emmy wrote.
fn is_series(path: &Path) -> bool {
    let creator = H5File::open(path).and_then(|file| file.attr_string(CREATOR));
    creator.is_ok_and(|creator| creator.starts_with("Emmy"))
}

/// Removes the checkpoints, and their directory if nothing is left in it.
fn remove_checkpoints(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for name in checkpoint::FILES {
        remove(&folder.join(name))?;
        remove(&folder.join(format!("{name}{PART}")))?;
    }
    if names(folder)?.is_empty() { fs::remove_dir(folder) } else { Ok(()) }
}

/// Removes `frames/NAME_000000.vtu` and so on, and the directory if nothing is left in it.
fn remove_frames(frames: &Path, name: &str) -> io::Result<()> {
    if !frames.is_dir() {
        return Ok(());
    }
    remove_frames_where(frames, name, |_| true)?;
    if names(frames)?.is_empty() { fs::remove_dir(frames) } else { Ok(()) }
}

/// Removes frames of some steps.
pub(crate) fn remove_frames_where(
    frames: &Path,
    name: &str,
    is_unwanted: impl Fn(usize) -> bool,
) -> io::Result<()> {
    for file in names(frames)? {
        if step_of_frame(&file, name).is_some_and(|step| file.ends_with(PART) || is_unwanted(step)) {
            remove(&frames.join(file))?;
        }
    }
    Ok(())
}

/// The step of a frame, whole or not, by the name of its file.
pub(crate) fn step_of_frame(file: &str, name: &str) -> Option<usize> {
    let whole = file.strip_suffix(PART).unwrap_or(file);
    let number = whole.strip_prefix(name)?.strip_prefix('_')?.strip_suffix(".vtu")?;
    let is_number = number.len() >= 6 && number.bytes().all(|byte| byte.is_ascii_digit());
    number.parse().ok().filter(|_| is_number)
}

fn names(path: &Path) -> io::Result<Vec<String>> {
    fs::read_dir(path)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}

pub(crate) fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        result => result,
    }
}

/// Puts the path of a file before what the system says of it.
pub(crate) fn named(path: &Path) -> impl Fn(io::Error) -> io::Error + '_ {
    move |error| io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// Writes a file so that at every moment either the old or the new one is there, whole.
pub(crate) fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    replace_by(path, content, |_| Ok(())).map_err(named(path))
}

/// As [`replace`], also when the machine loses its power: the content is on the disk before the name is.
pub(crate) fn replace_durably(path: &Path, content: &[u8]) -> io::Result<()> {
    replace_by(path, content, fs::File::sync_all).map_err(named(path))?;
    // Directories are files on Unix only; elsewhere the system sees to it.
    match path.parent().filter(|_| cfg!(unix)) {
        Some(folder) => fs::File::open(folder).and_then(|folder| folder.sync_all()).map_err(named(folder)),
        None => Ok(()),
    }
}

fn replace_by(path: &Path, content: &[u8], finish: impl Fn(&fs::File) -> io::Result<()>) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(PART);
    let part = path.with_file_name(name);
    let mut file = fs::File::create(&part)?;
    let written = file.write_all(content).and_then(|()| finish(&file));
    drop(file);
    if let Err(error) = written {
        // The disk may be full: what is of no use goes, and if it cannot, the error is still that of the writing.
        let _ = fs::remove_file(&part);
        return Err(error);
    }
    fs::rename(&part, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: PathBuf, text: &str) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn directories_of_others_are_refused() {
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
            "old.vtkhdf.part",
            "old.vtkhdf.copy",
            "run.log",
            "events.csv",
            "checkpoint/a.checkpoint",
        ];
        let foreign = [
            "checkpoint/mine.txt",
            "notes.txt",
            "notes.part",
            "other.pvd",
            "other.vtkhdf",
            "frames/other_000000.vtu",
            "frames/old_final.vtu",
            "frames/old_1.vtu",
        ];
        own.iter().chain(&foreign).for_each(|name| write(temp.path().join(name), "x"));
        write(temp.path().join("old.pvd"), COLLECTION_MARK);
        write(temp.path().join("input.toml"), MARK);
        prepare(temp.path()).unwrap();
        assert!(own.iter().all(|name| !temp.path().join(name).exists()));
        assert!(foreign.iter().all(|name| temp.path().join(name).exists()));
    }
}
