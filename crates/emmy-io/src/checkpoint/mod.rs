//! Checkpoints: all that a run needs to go on, in every bit.
//!
//! There are two files, `checkpoint/a.checkpoint` and `checkpoint/b.checkpoint`. One is on the disk for certain, whatever becomes of the
//! machine; the next checkpoint goes to the other one, under another name first. Waiting for the disk costs as much as a hundred
//! steps of a small body, so it is done once in a second at most; then the files change their roles. [`newest`] takes the later one that
//! is whole.

mod content;
mod file;
mod identity;

use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use emmy::motion::{Motion, Snapshot};

use crate::directory::{PART, named, remove, replace, replace_durably};
use crate::input::Problem;
use crate::tally::Tally;
pub use identity::{Identity, Mismatch};

/// Directory of the checkpoints in that of a run.
pub const DIRECTORY: &str = "checkpoint";

/// The two files.
pub const FILES: [&str; 2] = ["a.checkpoint", "b.checkpoint"];

/// Time between two checkpoints whose writing is waited for until they are on the disk, at the least.
const BETWEEN_SYNCS: Duration = Duration::from_secs(1);

/// All that a run needs to go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Version of the program that wrote it.
    pub version: String,
    /// Of what run it is.
    pub identity: Identity,
    /// The motion.
    pub snapshot: Snapshot,
    /// What the run adds up to so far.
    pub tally: Tally,
    /// Frames that were written: step and time.
    pub frames: Vec<(usize, f64)>,
    /// Checksum of the rows of the history up to here.
    pub history: u32,
    /// Seconds that the run took so far.
    pub wall_seconds: f64,
}

/// Why there is no checkpoint to go on from.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// There is none.
    #[error(
        "there is no checkpoint in {path}; `emmy run` writes them with `[output] checkpoint_every`, and when it is stopped"
    )]
    Missing {
        /// Where it was looked for.
        path: PathBuf,
    },
    /// There are some, but none is whole.
    #[error("no checkpoint can be read: {reasons}; start again with `emmy run`")]
    Damaged {
        /// What is wrong with each.
        reasons: String,
    },
}

/// The newest whole checkpoint of a run, and what is wrong with the other one, if anything is.
///
/// # Errors
/// [`CheckpointError`] if none is whole.
pub fn newest(directory: &Path) -> Result<(Checkpoint, Option<String>), CheckpointError> {
    let folder = directory.join(DIRECTORY);
    let (mut whole, mut reasons): (Vec<Checkpoint>, Vec<String>) = (Vec::new(), Vec::new());
    for path in FILES.map(|name| folder.join(name)) {
        let bytes = match std::fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => Err(error.to_string()),
            Ok(bytes) => Ok(bytes),
        };
        match bytes.and_then(|bytes| content::read(&bytes)) {
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
/// What is wrong with them, as what would follow the name of the file.
pub fn parse(bytes: &[u8]) -> Result<Checkpoint, String> {
    content::read(bytes)
}

/// How far the files of a run are.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Frames that were written: step and time.
    pub frames: &'a [(usize, f64)],
    /// Checksum of the rows of the history.
    pub history: u32,
    /// Seconds that the run took.
    pub wall_seconds: f64,
}

/// Writes the checkpoints of a run.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    identity: Identity,
    /// Index of the file that is on the disk; the other one is written next.
    safe: usize,
    /// When that was.
    synced: Option<Instant>,
    /// Step of the last one that was written.
    last_step: Option<usize>,
}

impl Checkpoints {
    /// Checkpoints of a problem in its directory, after one with which it goes on.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn new(problem: &Problem, after: Option<&Checkpoint>) -> io::Result<Self> {
        let folder = problem.output.directory.join(DIRECTORY);
        std::fs::create_dir_all(&folder).map_err(named(&folder))?;
        for name in FILES {
            // What a run that was killed left of a checkpoint.
            remove(&folder.join(format!("{name}{PART}"))).map_err(named(&folder))?;
        }
        let last_step = after.map(|checkpoint| checkpoint.snapshot.state.step);
        let is_kept = |name: &&str| {
            let step = std::fs::read(folder.join(name)).ok().and_then(|bytes| content::read(&bytes).ok());
            step.map(|checkpoint| checkpoint.snapshot.state.step) == last_step
        };
        // The one that is gone on from stays until the other one is whole.
        let safe = match last_step {
            Some(_) => FILES.iter().position(is_kept).unwrap_or(1),
            None => 1,
        };
        Ok(Checkpoints { identity: Identity::new(problem), folder, safe, synced: None, last_step })
    }

    /// Whether the next checkpoint should wait for the disk. All that it builds on, such as the history, must be there before.
    pub fn is_sync_due(&self) -> bool {
        self.synced.is_none_or(|then| then.elapsed() >= BETWEEN_SYNCS)
    }

    /// Writes a checkpoint of a motion, unless there is one of this step or the state is not finite: nothing could be resumed from that.
    /// On the disk for certain if `is_safe`.
    ///
    /// # Errors
    /// What the system refuses; the one before is then still there.
    pub fn write(
        &mut self,
        motion: &Motion<'_>,
        tally: &Tally,
        progress: Progress<'_>,
        is_safe: bool,
    ) -> io::Result<()> {
        let step = motion.state().step;
        if self.last_step == Some(step) || !content::is_finite(motion.state()) {
            return Ok(());
        }
        let checkpoint = Checkpoint {
            version: env!("CARGO_PKG_VERSION").to_string(),
            identity: self.identity.clone(),
            snapshot: motion.snapshot(),
            tally: tally.clone(),
            frames: progress.frames.to_vec(),
            history: progress.history,
            wall_seconds: progress.wall_seconds,
        };
        let other = 1 - self.safe;
        let (path, bytes) = (self.folder.join(FILES[other]), content::bytes(&checkpoint));
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
