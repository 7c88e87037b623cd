//! Checkpoints: everything that a run needs to resume, with the same bits.
//!
//! There are two files, `checkpoint/a.checkpoint` and `checkpoint/b.checkpoint`. One of them has been synced to the
//! disk; the next checkpoint replaces the other. Syncing takes as long as a hundred steps of a small body, so it is
//! done at most once a second; then the files change roles. [`newest`] takes the later one that is complete.

mod file;
pub(crate) mod identity;

use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use emmy::motion::{Motion, Snapshot};
use serde::{Deserialize, Serialize};

use crate::history::Extreme;
use crate::input::Problem;
use crate::vtk::FrameTime;
use crate::whole_file::{PART, named, names, remove, replace, replace_durably};
pub(crate) use identity::digest;
pub use identity::{Identity, Mismatch};

/// Directory of the checkpoints, in the directory of a run.
pub const DIRECTORY: &str = "checkpoint";

/// The two files.
pub const FILES: [&str; 2] = ["a.checkpoint", "b.checkpoint"];

/// Least time between two syncs.
const BETWEEN_SYNCS: Duration = Duration::from_secs(1);

/// Everything that a run needs to resume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The run that it belongs to.
    pub identity: Identity,
    /// The motion.
    pub snapshot: Snapshot,
    /// Frames written so far.
    pub frames: Vec<FrameTime>,
    /// Checksum of the rows of the history so far.
    pub history_checksum: u32,
    /// Duration of the run so far, in seconds.
    pub wall_seconds: f64,
    /// Largest values of fields so far.
    #[serde(default)]
    pub extremes: Vec<Extreme>,
}

/// Why there is no checkpoint to resume from.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// There is none.
    #[error(
        "there is no checkpoint in {path}; `emmy run` writes them with `[output] checkpoint_every`, and when it is stopped"
    )]
    Missing {
        /// The directory.
        path: PathBuf,
    },
    /// None can be used.
    #[error("no checkpoint can be read: {reasons}; start again with `emmy run`")]
    Damaged {
        /// Why each of them cannot be used.
        reasons: String,
    },
}

/// The newest usable checkpoint of a run, and why the other one cannot be used, if so.
///
/// # Errors
/// [`CheckpointError`] if none can be used.
pub fn newest(directory: &Path) -> Result<(Checkpoint, Option<String>), CheckpointError> {
    let folder = directory.join(DIRECTORY);
    let (mut whole, mut reasons): (Vec<Checkpoint>, Vec<String>) = (Vec::new(), Vec::new());
    for path in FILES.map(|name| folder.join(name)) {
        let bytes = match std::fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => Err(error.to_string()),
            Ok(bytes) => Ok(bytes),
        };
        match bytes.and_then(|bytes| file::read(&bytes)) {
            Ok(checkpoint) => whole.push(checkpoint),
            Err(reason) => reasons.push(format!("{} {reason}", path.display())),
        }
    }
    let reasons = (!reasons.is_empty()).then(|| reasons.join("; "));
    match (whole.into_iter().max_by_key(|checkpoint| checkpoint.snapshot.state.step), reasons) {
        (Some(checkpoint), reasons) => Ok((checkpoint, reasons)),
        (None, Some(reasons)) => Err(CheckpointError::Damaged { reasons }),
        (None, None) => Err(CheckpointError::Missing { path: folder }),
    }
}

/// A checkpoint from the bytes of its file.
///
/// # Errors
/// Why they cannot be used, as the predicate of a sentence about the file.
pub fn parse(bytes: &[u8]) -> Result<Checkpoint, String> {
    file::read(bytes)
}

/// The bytes of a checkpoint, as in its file.
///
/// # Errors
/// None in practice: every checkpoint can be written.
pub fn bytes(checkpoint: &Checkpoint) -> io::Result<Vec<u8>> {
    file::bytes(checkpoint)
}

/// Removes the checkpoints in a folder, and the folder if it is then empty.
pub(crate) fn remove_all(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for name in FILES {
        remove(&folder.join(name))?;
        remove(&folder.join(format!("{name}{PART}")))?;
    }
    if names(folder)?.is_empty() { std::fs::remove_dir(folder) } else { Ok(()) }
}

/// State of the files of a run.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Frames written so far.
    pub frames: &'a [FrameTime],
    /// Checksum of the rows of the history.
    pub history_checksum: u32,
    /// Duration of the run, in seconds.
    pub wall_seconds: f64,
    /// Largest values of fields so far.
    pub extremes: &'a [Extreme],
}

/// Writes the checkpoints of a run.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    identity: Identity,
    /// Index of the file that has been synced; the other one is written next.
    safe: usize,
    /// When it was synced.
    synced: Option<Instant>,
    /// Step of the last checkpoint.
    last_step: Option<usize>,
}

impl Checkpoints {
    /// Checkpoints of a problem in its directory; `after`: the checkpoint that it resumes from.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn new(problem: &Problem, after: Option<&Checkpoint>) -> io::Result<Self> {
        let folder = problem.output.directory.join(DIRECTORY);
        std::fs::create_dir_all(&folder).map_err(named(&folder))?;
        for name in FILES {
            // A killed run may have left an unfinished checkpoint.
            remove(&folder.join(format!("{name}{PART}"))).map_err(named(&folder))?;
        }
        let last_step = after.map(|checkpoint| checkpoint.snapshot.state.step);
        let is_kept = |name: &&str| {
            let step = std::fs::read(folder.join(name)).ok().and_then(|bytes| file::read(&bytes).ok());
            step.map(|checkpoint| checkpoint.snapshot.state.step) == last_step
        };
        // The checkpoint that the run resumes from stays until the other one is complete.
        let safe = match last_step {
            Some(_) => FILES.iter().position(is_kept).unwrap_or(1),
            None => 1,
        };
        Ok(Checkpoints { identity: Identity::new(problem), folder, safe, synced: None, last_step })
    }

    /// Whether the next checkpoint should be synced. The history must be synced before it.
    pub fn is_sync_due(&self) -> bool {
        self.synced.is_none_or(|then| then.elapsed() >= BETWEEN_SYNCS)
    }

    /// Writes a checkpoint of a motion, once a step, and synced if `is_safe`. A state that is not finite is not
    /// written, since nothing could resume from it.
    ///
    /// # Errors
    /// Errors of the system; the checkpoint before is then still there.
    pub fn write(&mut self, motion: &Motion<'_>, progress: Progress<'_>, is_safe: bool) -> io::Result<()> {
        let step = motion.state().step;
        if self.last_step == Some(step) || !file::is_finite(motion.state()) {
            return Ok(());
        }
        let checkpoint = Checkpoint {
            identity: self.identity.clone(),
            snapshot: motion.snapshot(),
            frames: progress.frames.to_vec(),
            history_checksum: progress.history_checksum,
            wall_seconds: progress.wall_seconds,
            extremes: progress.extremes.to_vec(),
        };
        let other = 1 - self.safe;
        let path = self.folder.join(FILES[other]);
        let bytes = file::bytes(&checkpoint)?;
        if is_safe {
            replace_durably(&path, &bytes)?;
            (self.safe, self.synced) = (other, Some(Instant::now()));
        } else {
            replace(&path, &bytes)?;
        }
        self.last_step = Some(step);
        Ok(())
    }
}
