//! The output directory: nothing of anybody else's is ever written over or removed.
//!
//! A run may write into a directory that does not exist, that is empty, or that holds an earlier run of Emmy (its
//! `input.toml` begins with [`MARK`]). An earlier run is replaced: `input.toml`, `history.csv`, `summary.json` and the
//! frames of its collections are removed, every other file stays. A directory with other content is refused.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// First words of every `input.toml` that Emmy writes.
pub const MARK: &str = "# Written by Emmy";

/// Comment in every collection (`.pvd`) that Emmy writes.
pub(crate) const COLLECTION_MARK: &str = "<!-- Written by Emmy -->";

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
    if !path.exists() {
        return Ok(());
    }
    if !path.is_dir() {
        return Err(DirectoryError::NotADirectory { path: path.to_path_buf() });
    }
    let first = fs::read_dir(path).map_err(|error| system(path, error))?.next();
    match first {
        Some(Ok(entry)) if !is_run(path) => {
            let example = entry.file_name().to_string_lossy().into_owned();
            Err(DirectoryError::Foreign { path: path.to_path_buf(), example })
        }
        _ => Ok(()),
    }
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
    for name in ["history.csv", "summary.json"] {
        remove(&path.join(name))?;
    }
    let collections = names(path)?.into_iter().filter(|name| name.ends_with(".pvd"));
    for name in collections {
        let text = fs::read_to_string(path.join(&name)).unwrap_or_default();
        if text.contains(COLLECTION_MARK) {
            remove_frames(&path.join("frames"), name.trim_end_matches(".pvd"))?;
            remove(&path.join(&name))?;
        }
    }
    Ok(())
}

/// Removes `frames/NAME_000000.vtu` and so on, and the directory if nothing is left in it.
fn remove_frames(frames: &Path, name: &str) -> io::Result<()> {
    if !frames.is_dir() {
        return Ok(());
    }
    for file in names(frames)? {
        let number = file.strip_prefix(name).and_then(|rest| rest.strip_prefix('_')?.strip_suffix(".vtu"));
        if number.is_some_and(|number| number.len() >= 6 && number.bytes().all(|byte| byte.is_ascii_digit()))
        {
            remove(&frames.join(file))?;
        }
    }
    if names(frames)?.is_empty() { fs::remove_dir(frames) } else { Ok(()) }
}

fn names(path: &Path) -> io::Result<Vec<String>> {
    fs::read_dir(path)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}

fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        result => result,
    }
}

/// Writes a file so that at every moment either the old or the new one is there, whole.
pub(crate) fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    let mut file = fs::File::create(&part)?;
    file.write_all(content)?;
    drop(file);
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
    fn only_files_of_the_earlier_run_are_removed() {
        let temp = tempfile::tempdir().unwrap();
        let own =
            ["history.csv", "summary.json", "old.pvd", "frames/old_000000.vtu", "frames/old_1000000.vtu"];
        let foreign =
            ["notes.txt", "other.pvd", "frames/other_000000.vtu", "frames/old_final.vtu", "frames/old_1.vtu"];
        own.iter().chain(&foreign).for_each(|name| write(temp.path().join(name), "x"));
        write(temp.path().join("old.pvd"), COLLECTION_MARK);
        write(temp.path().join("input.toml"), MARK);
        prepare(temp.path()).unwrap();
        assert!(own.iter().all(|name| !temp.path().join(name).exists()));
        assert!(foreign.iter().all(|name| temp.path().join(name).exists()));
    }
}
