//! States of runs, written for the program that compares them.

use std::path::PathBuf;

/// A folder that is removed when it is dropped.
#[derive(Debug)]
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// A new folder with a name of its own.
    ///
    /// # Errors
    /// The message of the system if it cannot be created.
    pub(crate) fn new(name: &str) -> Result<Self, String> {
        let folder = std::env::temp_dir().join(format!("emmy-bench-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(Scratch(folder))
    }

    /// Path of a file in it.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Numbers of a run, in order: displacement, momentum, velocity, then energies and momenta of every step.
    ///
    /// # Errors
    /// The message of the system if there is no such file.
    pub(crate) fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        let path = self.file(name);
        let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
    }
}

impl Drop for Scratch {
    /// Removes the folder; files left after a failure do no harm.
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
