//! Files that are read or replaced as a whole.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Ending of a file that is still being written.
pub(crate) const PART: &str = ".part";

/// Bytes of a regular file, as [`open`].
///
/// # Errors
/// As [`open`].
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    check_kind(path)?;
    fs::read(path)
}

/// Text of a regular file, as [`open`].
///
/// # Errors
/// As [`open`], and for bytes that are not UTF-8.
pub(crate) fn read_text(path: &Path) -> io::Result<String> {
    check_kind(path)?;
    fs::read_to_string(path)
}

/// A regular file for reading. Devices and pipes are not opened, as they may never end.
///
/// # Errors
/// Errors of the system, and every other kind of file.
pub(crate) fn open(path: &Path) -> io::Result<File> {
    check_kind(path)?;
    File::open(path)
}

/// Checks that a path is one of a regular file.
///
/// # Errors
/// As [`open`].
pub(crate) fn check_kind(path: &Path) -> io::Result<()> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        Ok(())
    } else if kind.is_dir() {
        Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"))
    } else {
        Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a regular file"))
    }
}

/// Replaces a file: at every moment either the old or the new one is there, complete.
///
/// # Errors
/// Errors of the system, with the path.
pub(crate) fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let part = with_ending(path, PART);
    let written = File::create(&part).and_then(|mut file| file.write_all(content));
    if let Err(error) = written {
        // The disk may be full. If the removal fails too, the first error says more.
        let _ = fs::remove_file(&part);
        return Err(named(path)(error));
    }
    put(path, false)
}

/// Gives a complete file its name, which it has without [`PART`]; with `is_safe` the name reaches the disk.
///
/// # Errors
/// Errors of the system, with the path.
pub(crate) fn put(path: &Path, is_safe: bool) -> io::Result<()> {
    fs::rename(with_ending(path, PART), path).map_err(named(path))?;
    if is_safe { sync_folder(path) } else { Ok(()) }
}

/// Waits until the name of a file is on the disk.
fn sync_folder(path: &Path) -> io::Result<()> {
    // Only Unix lets a program sync a directory.
    match path.parent().filter(|_| cfg!(unix)) {
        Some(folder) => File::open(folder).and_then(|folder| folder.sync_all()).map_err(named(folder)),
        None => Ok(()),
    }
}

/// Removes a file if it exists.
///
/// # Errors
/// Errors of the system, with the path.
pub(crate) fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        result => result.map_err(named(file)),
    }
}

/// Puts the path of a file before the message of the system.
pub(crate) fn named(path: &Path) -> impl Fn(io::Error) -> io::Error + '_ {
    move |error| io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// A path with an ending added to the file name.
pub(crate) fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(ending);
    path.with_file_name(name)
}

/// Names of the files and folders in a directory.
///
/// # Errors
/// Errors of the system.
pub(crate) fn names(path: &Path) -> io::Result<Vec<String>> {
    fs::read_dir(path)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}
