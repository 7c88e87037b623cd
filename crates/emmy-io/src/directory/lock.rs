//! One run at a time in a directory.

use std::fs::{File, TryLockError};
use std::path::Path;

use super::DirectoryError;

/// Name of the lock file. It stays after the run; the system releases the lock, however the run ends.
pub(super) const FILE: &str = ".lock";

/// An advisory lock on a directory, held until it is dropped.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Locks an existing directory.
    ///
    /// # Errors
    /// [`DirectoryError::Busy`] if another run holds it, [`DirectoryError::System`].
    pub fn take(directory: &Path) -> Result<Self, DirectoryError> {
        let path = directory.join(FILE);
        let system = |error| DirectoryError::System { path: path.clone(), error };
        let file = File::options().create(true).truncate(false).write(true).open(&path).map_err(system)?;
        match file.try_lock() {
            Ok(()) => Ok(Lock { _file: file }),
            Err(TryLockError::WouldBlock) => Err(DirectoryError::Busy { path: directory.to_path_buf() }),
            // Without locks on this file system, the run goes ahead.
            Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => {
                Ok(Lock { _file: file })
            }
            Err(TryLockError::Error(error)) => Err(system(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_has_one_run_at_a_time() {
        let temp = tempfile::tempdir().unwrap();
        let first = Lock::take(temp.path()).unwrap();
        assert!(matches!(Lock::take(temp.path()), Err(DirectoryError::Busy { .. })));
        drop(first);
        Lock::take(temp.path()).unwrap();
    }
}
