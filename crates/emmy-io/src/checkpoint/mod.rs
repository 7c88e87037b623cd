//! Checkpoints: everything that a run needs to resume, with the same bits.
//!
//! There are two files, `checkpoint/a.checkpoint` and `checkpoint/b.checkpoint`. One of them has been synced to the
//! disk; the next checkpoint replaces the other. Syncing takes as long as a hundred steps of a small body, so it is
//! done at most once a second; then the files change roles. [`newest`] takes the later one that is complete.
//!
//! A checkpoint has the same format from any number of ranks, and any number of ranks can read it. Each rank writes and
//! reads the numbers of its own part of the body, so none holds the state of the whole body.

mod blocks;
mod file;
pub(crate) mod identity;
mod part;
mod runs;

use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use emmy::body::Body;
use emmy::motion::{Motion, Snapshot, State};
use emmy::team::{self, Alone, Team};
use serde::{Deserialize, Serialize};

use crate::history::Extreme;
use crate::input::Problem;
use crate::vtk::FrameTime;
use crate::whole_file::{self, PART, named, names, remove};
use blocks::Table;
pub use identity::{Identity, Mismatch};
pub(crate) use identity::{digest, other_input};
use part::Part;
use runs::Runs;

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
    /// The motion. Of a checkpoint from [`newest`] without the numbers of nodes and cells, which
    /// [`Checkpoint::snapshot`] reads.
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
    #[serde(skip)]
    lists: Lists,
}

/// Where the numbers of nodes and cells are.
#[derive(Debug, Clone, PartialEq)]
enum Lists {
    /// In the snapshot, with these entries of the whole body.
    Here(Runs),
    /// In a file.
    In(PathBuf, Table),
}

impl Default for Lists {
    fn default() -> Self {
        Lists::Here(Runs::default())
    }
}

impl Checkpoint {
    /// A checkpoint of a motion without files, on one rank.
    pub fn of(identity: Identity, motion: &Motion<'_>) -> Self {
        Checkpoint {
            identity,
            snapshot: motion.snapshot(),
            frames: Vec::new(),
            history_checksum: 0,
            wall_seconds: 0.0,
            extremes: Vec::new(),
            lists: Lists::Here(Runs::counted(motion.body())),
        }
    }

    /// The snapshot with the numbers of the nodes and cells of a body; on a team, of this rank's part. A call of all
    /// ranks.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`], on all ranks; also if the checkpoint is of another body.
    pub fn snapshot(&self, body: &Body) -> Result<Snapshot, CheckpointError> {
        self.read_for(body, &Runs::needed(body), self.snapshot.clone())
    }

    /// The state at the nodes of a body, as [`Checkpoint::snapshot`]; at those of its mesh alone if the checkpoint has
    /// other incompatible modes.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`], on all ranks; also if the checkpoint is of another mesh.
    pub fn state(&self, body: &Body) -> Result<State, CheckpointError> {
        let start = || Snapshot { memory: None, control: None, ..self.snapshot.clone() };
        let read = self
            .read_for(body, &Runs::needed_of_nodes(body), start())
            .or_else(|_| self.read_for(body, &Runs::needed_of_mesh(body), start()));
        read.map(|snapshot| snapshot.state)
    }

    /// Reads the lists of a snapshot for a body.
    fn read_for(
        &self,
        body: &Body,
        needed: &Runs,
        mut snapshot: Snapshot,
    ) -> Result<Snapshot, CheckpointError> {
        let own = match &self.lists {
            Lists::Here(_) => Ok(()),
            Lists::In(path, table) => {
                read(path, |input| table.fill_for(body, needed.clone(), input, &mut snapshot))
            }
        };
        let agreed = team::agree(team_of(body), own, |reason| reason);
        agreed.map(|()| snapshot).map_err(|reasons| CheckpointError::Damaged { reasons })
    }

    /// The checkpoint with the numbers of all nodes and cells of the whole body.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`].
    pub fn complete(&self) -> Result<Checkpoint, CheckpointError> {
        let mut whole = self.clone();
        if let Lists::In(path, table) = &self.lists {
            let runs = read(path, |input| table.fill_whole(input, &mut whole.snapshot));
            whole.lists = Lists::Here(runs.map_err(|reasons| CheckpointError::Damaged { reasons })?);
        }
        Ok(whole)
    }
}

/// Reads from a file; errors begin with its path.
fn read<T>(path: &Path, work: impl FnOnce(&mut BufReader<File>) -> Result<T, String>) -> Result<T, String> {
    let opened = whole_file::open(path).map_err(|error| error.to_string());
    let done = opened.and_then(|file| work(&mut BufReader::new(file)));
    done.map_err(|reason| format!("{} {reason}", path.display()))
}

/// The team of a body.
fn team_of(body: &Body) -> &dyn Team {
    &**body.ranks().team()
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
    /// The directory does not exist.
    #[error("there is no directory {path}")]
    NoDirectory {
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

/// The newest usable checkpoint of a run, and why the other one cannot be used, if so. A collective call: the ranks
/// check the files together.
///
/// # Errors
/// [`CheckpointError`] if none can be used, on all ranks.
pub fn newest(directory: &Path, team: &dyn Team) -> Result<(Checkpoint, Option<String>), CheckpointError> {
    let folder = directory.join(DIRECTORY);
    let (mut whole, mut reasons): (Vec<Checkpoint>, Vec<String>) = (Vec::new(), Vec::new());
    for path in FILES.map(|name| folder.join(name)) {
        let is_absent = matches!(fs::metadata(&path), Err(error) if error.kind() == ErrorKind::NotFound);
        let mut is_there = [f64::from(u8::from(team.rank() == 0 && !is_absent))];
        team.sum("presence of a checkpoint", &mut is_there);
        if is_there == [0.0] {
            continue;
        }
        match open(&path, team) {
            Ok(checkpoint) => whole.push(checkpoint),
            Err(reason) => reasons.push(reason),
        }
    }
    let reasons = (!reasons.is_empty()).then(|| reasons.join("; "));
    match (whole.into_iter().max_by_key(|checkpoint| checkpoint.snapshot.state.step), reasons) {
        (Some(checkpoint), reasons) => Ok((checkpoint, reasons)),
        (None, Some(reasons)) => Err(CheckpointError::Damaged { reasons }),
        (None, None) if !directory.exists() => {
            Err(CheckpointError::NoDirectory { path: directory.to_path_buf() })
        }
        (None, None) => Err(CheckpointError::Missing { path: folder }),
    }
}

/// The checkpoint of a file, of which each rank of a team checks some blocks.
///
/// # Errors
/// Why it cannot be used, on all ranks.
fn open(path: &Path, team: &dyn Team) -> Result<Checkpoint, String> {
    let own = read(path, |input| {
        let (checkpoint, table) = file::read(input)?;
        table.verify(input, team)?;
        Ok(Checkpoint { lists: Lists::In(path.to_path_buf(), table), ..checkpoint })
    });
    let checkpoint = team::agree(team, own, |reason| reason)?;
    // A rank may still see a file that another program has replaced.
    let step = checkpoint.snapshot.state.step as f64;
    let mut bounds = [step, -step];
    team.largest("step of a checkpoint", &mut bounds);
    match bounds == [step, -step] {
        true => Ok(checkpoint),
        false => Err(format!("{} is another file on another rank", path.display())),
    }
}

/// A checkpoint from the bytes of its file, with all numbers.
///
/// # Errors
/// Why they cannot be used, as the predicate of a sentence about the file.
pub fn parse(bytes: &[u8]) -> Result<Checkpoint, String> {
    let mut input = Cursor::new(bytes);
    let (mut checkpoint, table) = file::read(&mut input)?;
    table.verify(&mut input, &Alone)?;
    let runs = table.fill_whole(&mut input, &mut checkpoint.snapshot)?;
    Ok(Checkpoint { lists: Lists::Here(runs), ..checkpoint })
}

/// The bytes of a checkpoint of one rank, as in its file; a checkpoint from [`newest`] is made complete by
/// [`Checkpoint::complete`].
///
/// # Errors
/// Errors of the system, if numbers are to be read from a file.
pub fn bytes(checkpoint: &Checkpoint) -> io::Result<Vec<u8>> {
    let mut whole = checkpoint.complete().map_err(io::Error::other)?;
    let Lists::Here(runs) = std::mem::take(&mut whole.lists) else { unreachable!("a complete checkpoint") };
    let part = Part::take_whole(&mut whole.snapshot, &runs);
    file::bytes(&whole, part)
}

/// The bytes of a file of one rank with right checksums, whatever else is damaged: for tests of the content.
#[doc(hidden)]
pub fn sealed(bytes: Vec<u8>) -> Vec<u8> {
    file::sealed(bytes)
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
    if names(folder)?.is_empty() { fs::remove_dir(folder) } else { Ok(()) }
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
    /// Checkpoints of a problem in its directory; `after`: the checkpoint that it resumes from. On a team a call of all
    /// ranks.
    ///
    /// # Errors
    /// Errors of the system, on all ranks.
    pub fn new(problem: &Problem, after: Option<&Checkpoint>) -> io::Result<Self> {
        let folder = problem.output.directory.join(DIRECTORY);
        let team = team_of(&problem.body);
        let own = if team.rank() == 0 { prepare(&folder) } else { Ok(()) };
        file::agree(team, own)?;
        // The checkpoint that the run resumes from stays until the other one is complete.
        let is_kept = |name: &&str| match after.map(|checkpoint| &checkpoint.lists) {
            Some(Lists::In(path, _)) => path.file_name().is_some_and(|kept| kept == *name),
            _ => false,
        };
        Ok(Checkpoints {
            identity: Identity::new(problem),
            safe: FILES.iter().position(is_kept).unwrap_or(1),
            folder,
            synced: None,
            last_step: after.map(|checkpoint| checkpoint.snapshot.state.step),
        })
    }

    /// Whether the next checkpoint should be synced. The history must be synced before it.
    pub fn is_sync_due(&self) -> bool {
        self.synced.is_none_or(|then| then.elapsed() >= BETWEEN_SYNCS)
    }

    /// Writes a checkpoint of a motion, once a step, and synced if `is_safe`. A state that is not finite is not
    /// written, since nothing could resume from it. On a team a call of all ranks with the same `is_safe`; `progress`
    /// is that of rank 0.
    ///
    /// # Errors
    /// Errors of the system, on all ranks; the earlier checkpoint then remains.
    pub fn write(&mut self, motion: &Motion<'_>, progress: Progress<'_>, is_safe: bool) -> io::Result<()> {
        let step = motion.state().step;
        let team = team_of(motion.body());
        if self.last_step == Some(step) {
            return Ok(());
        }
        let mut is_broken = [f64::from(u8::from(!file::is_finite(motion.state())))];
        team.largest("state that is not finite", &mut is_broken);
        if is_broken != [0.0] {
            return Ok(());
        }
        let mut snapshot = motion.snapshot();
        let part = Part::take(&mut snapshot, motion.body());
        let checkpoint = Checkpoint {
            identity: self.identity.clone(),
            snapshot,
            frames: progress.frames.to_vec(),
            history_checksum: progress.history_checksum,
            wall_seconds: progress.wall_seconds,
            extremes: progress.extremes.to_vec(),
            lists: Lists::default(),
        };
        let other = 1 - self.safe;
        file::write(&self.folder.join(FILES[other]), &checkpoint, part, team, is_safe)?;
        if is_safe {
            (self.safe, self.synced) = (other, Some(Instant::now()));
        }
        self.last_step = Some(step);
        Ok(())
    }
}

/// Creates the folder. A killed run may have left an unfinished checkpoint.
fn prepare(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder).map_err(named(folder))?;
    FILES.iter().try_for_each(|name| remove(&folder.join(format!("{name}{PART}"))))
}
