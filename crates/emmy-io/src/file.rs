//! Files that are read whole.

use std::io;
use std::path::Path;

/// Bytes of a regular file: a device or a pipe may never end.
///
/// # Errors
/// What the system refuses, and every other kind of file, which is not opened.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let kind = std::fs::metadata(path)?.file_type();
    match kind.is_file() {
        true => std::fs::read(path),
        false if kind.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory")),
        false => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a regular file"))
        }
    }
}
