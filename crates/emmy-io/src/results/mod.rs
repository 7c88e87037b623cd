//! All files of a run, written by an observer of the motion.

mod files;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use emmy::motion::{Event, Motion, Observer, RunStatistics, StepPlan, View};
use emmy::team::Subdomain;
use serde_json::Value;

use crate::accuracy::{self, Accuracy};
use crate::checkpoint::{Checkpoint, Checkpoints, Progress};
use crate::directory::{self, DirectoryError, Lock};
use crate::history::{
    Extreme, HistoryColumns, HistoryError, HistoryFile, Peak, Peaks, RESIDUAL, keep_largest,
};
use crate::input::{Limits, Output, Problem};
use crate::limits;
use crate::recording::{OtherFields, Recording};
use crate::report::{self, ReportError};
use crate::summary::{self, Status, SummaryHeader};
use crate::team::agreed;
use crate::vtk::{Format, FrameTime};
use crate::whole_file::replace;
use files::Files;
pub(crate) use files::{input, write_units};

/// Why the results of a run cannot be resumed.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// The history cannot be continued.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The run would remove a file that it reads.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// The frames have other fields.
    #[error(transparent)]
    Fields(#[from] OtherFields),
    /// An error of the system.
    #[error("cannot write the results: {0}")]
    System(#[from] io::Error),
}

/// Writes `input.toml`, `history.csv`, `newton.csv`, `events.csv`, `run.log`, frames, checkpoints, `summary.json` and
/// `report.html` into the output directory, and checks the limits.
///
/// On a team every rank has results and makes the same calls. Rank 0 writes the files of the whole run; the others take
/// part in frames and checkpoints.
#[derive(Debug)]
pub struct Results {
    /// The part of the rank, on a team.
    ranks: Arc<Subdomain>,
    output: Output,
    plan: StepPlan,
    columns: HistoryColumns,
    limits: Limits,
    header: SummaryHeader,
    /// Absent on the ranks that do not write the files of the whole run.
    files: Option<Files>,
    recording: Option<Recording>,
    statistics: RunStatistics,
    /// Largest values of fields so far.
    extremes: Vec<Extreme>,
    checkpoints: Option<Checkpoints>,
    started: Instant,
    /// Duration of the run at which the report is due, in seconds.
    report_due: f64,
    /// Duration of the run before it was resumed, in seconds.
    seconds_before: f64,
    /// Estimated error of the positions, if requested.
    estimated_error: Option<f64>,
    /// Notes to the user on the files.
    notes: Vec<String>,
}

/// Least time between two reports of a run, in seconds.
const REPORT_INTERVAL: f64 = 5.0;

/// Part of the time that reports of a running motion may take.
const MAX_REPORT_COST: f64 = 0.02;

impl Results {
    /// Prepares the directory and opens the files. The clock starts here.
    ///
    /// # Errors
    /// [`DirectoryError`] if the directory is not Emmy's or another run writes there; nothing is changed then.
    pub fn create(problem: &Problem) -> Result<Self, DirectoryError> {
        let directory = &problem.output.directory;
        let system = |error| DirectoryError::System { path: directory.clone(), error };
        let unwritten = |error| DirectoryError::File { path: directory.clone(), error };
        let files = problem.on_first_rank(
            || {
                directory::check_run(problem)?;
                std::fs::create_dir_all(directory).map_err(system)?;
                let lock = Lock::take(directory)?;
                directory::prepare(directory)?;
                if let Some(mesh) = &problem.mesh_in_memory {
                    directory::write_mesh(directory, mesh)?;
                }
                replace(&directory.join("input.toml"), input(problem).as_bytes()).map_err(unwritten)?;
                let columns = HistoryColumns::of(problem);
                let history =
                    HistoryFile::create(&directory.join("history.csv"), &columns).map_err(unwritten)?;
                Files::open(problem, lock, (history, Peaks::of(&columns)), None).map_err(unwritten)
            },
            |message| system(io::Error::other(message)),
        )?;
        Results::open(problem, files, None).map_err(unwritten)
    }

    /// Resumes the files of a run at a checkpoint: later rows, events and frames are removed. `lock`: of the directory;
    /// absent on the ranks of a team that do not hold it.
    ///
    /// # Errors
    /// [`ResumeError`]; if the run cannot be resumed, nothing is changed.
    pub fn resume(
        problem: &Problem,
        lock: Option<Lock>,
        checkpoint: &Checkpoint,
    ) -> Result<Self, ResumeError> {
        let directory = &problem.output.directory;
        let state = &checkpoint.snapshot.state;
        let path = directory.join("history.csv");
        let is_continuable = Recording::check(problem);
        let files = lock.map(|lock| -> Result<Files, ResumeError> {
            // The first file is the input in the directory, which is replaced by itself.
            directory::check_sources(directory, &problem.files[1..])?;
            is_continuable?;
            let columns = HistoryColumns::of(problem);
            let history =
                HistoryFile::resume(&path, &columns, state.step, state.time, checkpoint.history_checksum)?;
            replace(&directory.join("input.toml"), input(problem).as_bytes())?;
            let peaks = Peaks::read(&columns, &path)?;
            Ok(Files::open(problem, lock, (history, peaks), Some((state.step, state.time)))?)
        });
        let files = problem.agree(files.transpose(), |message| io::Error::other(message).into())?;
        Ok(Results::open(problem, files, Some(checkpoint))?)
    }

    fn open(problem: &Problem, mut files: Option<Files>, after: Option<&Checkpoint>) -> io::Result<Self> {
        let output = problem.output.clone();
        let directory = problem.output.directory.as_path();
        let start = after.map(|checkpoint| (checkpoint.snapshot.state.step, checkpoint.snapshot.state.time));
        let recording = output.has_frames().then(|| Recording::open(problem, after)).transpose()?;
        let (recording, missing) = recording.unzip();
        let notes: Vec<String> = missing.and_then(|missing| missing_frames(&missing)).into_iter().collect();
        let cleaned = match (start, &mut files) {
            (Some(start), Some(files)) => {
                let has_series = recording.is_some() && output.format == Format::Vtkhdf;
                // Pictures show extremes of the frames, which a resumed run changes.
                directory::remove_unfinished(directory, has_series)
                    .and_then(|()| directory::remove_pictures(directory))
                    .and_then(|()| files.write_lost_frames(start, &notes))
            }
            _ => Ok(()),
        };
        problem.agree(cleaned, io::Error::other)?;
        let checkpoints =
            (output.checkpoint_every > 0).then(|| Checkpoints::new(problem, after)).transpose()?;
        let header = SummaryHeader::new(problem);
        let statistics =
            after.map_or_else(RunStatistics::default, |checkpoint| checkpoint.snapshot.statistics.clone());
        let extremes = after.map_or_else(Vec::new, |checkpoint| checkpoint.extremes.clone());
        let seconds_before = after.map_or(0.0, |checkpoint| checkpoint.wall_seconds);
        let mut results = Results {
            ranks: problem.body.ranks().clone(),
            limits: problem.limits,
            columns: HistoryColumns::of(problem),
            output,
            plan: problem.plan.clone(),
            header,
            files,
            recording,
            statistics,
            extremes,
            checkpoints,
            started: Instant::now(),
            report_due: seconds_before + REPORT_INTERVAL,
            seconds_before,
            estimated_error: None,
            notes,
        };
        let written = results.write_summary(&results.summary(Status::Running, None));
        results.agree(written)?;
        results.started = Instant::now();
        Ok(results)
    }

    /// The same outcome on all ranks.
    fn agree(&self, own: io::Result<()>) -> io::Result<()> {
        agreed(&**self.ranks.team(), own)
    }

    /// Whether this rank writes the files of the whole run.
    fn is_writer(&self) -> bool {
        self.files.is_some()
    }

    /// Ends the run: writes the last state as a frame and a checkpoint, unless this is done already, then the summary.
    /// Each file is tried even if another one fails; the status `done` then becomes a failure.
    pub fn finish(
        &mut self,
        problem: &Problem,
        motion: &Motion<'_>,
        status: Status,
        message: Option<&str>,
    ) -> Ending {
        // A run cannot resume from a step that could not be written.
        let [has_failed] = self.ranks.any("whether the run failed", [status == Status::Failed]);
        let is_sound = !has_failed;
        let status = if is_sound { status } else { Status::Failed };
        let mut errors = vec![self.end_frames(motion, is_sound)];
        errors.extend(is_sound.then(|| self.write_checkpoint(motion, true)));
        errors.push(self.files.as_mut().map_or(Ok(()), |files| files.history.verify()));
        let first = errors.into_iter().find_map(Result::err).map_or(Ok(()), Err);
        let mut error = self.agree(first).err();
        let status = if error.is_some() && status == Status::Done { Status::Failed } else { status };
        let unwritten = error.as_ref().map(|error| format!("the results cannot be written: {error}"));
        let message = message.map(str::to_string).or(unwritten);
        let end =
            format!("{} at step {}, t = {}", status.name(), self.statistics.steps, self.statistics.time);
        let end = message.as_ref().map_or(end.clone(), |message| format!("{end}: {message}"));
        let logged = self.files.as_mut().map_or(Ok(()), |files| files.log.line(&end));
        let mut summary = self.summary(status, message.as_deref());
        summary["estimated_error"] = self.estimated_error.into();
        let period = || accuracy::lowest_period(problem);
        let accuracy = Accuracy::of(problem, &self.plan, &self.statistics, self.estimated_error, period);
        if let Some(accuracy) = &accuracy {
            summary::add_accuracy(&mut summary, accuracy);
        }
        summary::add_notes(&mut summary, &self.statistics, problem);
        let written = self.write_summary(&summary);
        let last = self.agree(logged.and(written));
        error = error.or(last.err());
        Ending { status, summary, accuracy, error }
    }

    /// Completes the frames, with the last state if it `is_sound`.
    fn end_frames(&mut self, motion: &Motion<'_>, is_sound: bool) -> io::Result<()> {
        let written = if is_sound { self.write_frame(motion) } else { Ok(()) };
        let finished = self.recording.as_mut().map_or(Ok(()), Recording::finish);
        written.and(finished)
    }

    /// Writes a state as a frame, if there are frames.
    fn write_frame(&mut self, motion: &Motion<'_>) -> io::Result<()> {
        let Some(recording) = &mut self.recording else { return Ok(()) };
        let stress = recording.write(motion)?;
        keep_largest(&mut self.extremes, stress);
        Ok(())
    }

    fn summary(&self, status: Status, message: Option<&str>) -> Value {
        let mut summary =
            self.header.summary(&self.statistics, &self.extremes, status, message, self.wall_seconds());
        if let Some(files) = &self.files {
            summary::add_peaks(&mut summary, &files.peaks);
        }
        summary
    }

    /// Largest values of fields so far, in the body (`region` is `None`) and in each region if there are several: for
    /// fields that the input asks for, over every step; otherwise for the von Mises stress, over the frames.
    pub fn extremes(&self) -> &[Extreme] {
        &self.extremes
    }

    /// The largest opening of a joint or change of a rigid body's shape, over the size of the whole; `None` without
    /// constraints, and on ranks that do not write the files of the run.
    pub fn worst_constraint(&self) -> Option<&Peak> {
        self.files.as_ref()?.peaks.of_column(RESIDUAL)
    }

    /// Whether the largest value of a field is taken over every step, not only over the frames.
    pub fn is_in_every_step(&self, field: &str) -> bool {
        self.columns.has_extreme(field)
    }

    /// Replaces the summary, on the rank that writes the files of the run.
    fn write_summary(&self, summary: &Value) -> io::Result<()> {
        if self.is_writer() { summary::write(&self.summary_path(), summary) } else { Ok(()) }
    }

    fn summary_path(&self) -> PathBuf {
        self.directory().join("summary.json")
    }

    /// Notes to the user on the files of a resumed run.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sets the estimated error of the positions at the end for the summary: a root mean square over the mass
    /// \[length\].
    pub fn set_error(&mut self, error: f64) {
        self.estimated_error = Some(error);
    }

    /// Writes `report.html` for the run so far; `None` on the ranks that do not write it.
    ///
    /// # Errors
    /// [`ReportError`] if a file cannot be written or read.
    pub fn report(&self) -> Result<Option<PathBuf>, ReportError> {
        self.is_writer().then(|| report::write(self.directory())).transpose()
    }

    /// Writes summary and report of a running motion when they are due. Errors of the report do not end the run; they
    /// are reported at its end.
    fn report_progress(&mut self) -> io::Result<()> {
        let begin = self.wall_seconds();
        if self.is_writer() && begin >= self.report_due {
            summary::write(&self.summary_path(), &self.summary(Status::Running, None))?;
            let _ = self.report();
            let now = self.wall_seconds();
            self.report_due = now + REPORT_INTERVAL.max((now - begin) / MAX_REPORT_COST);
        }
        Ok(())
    }

    /// The output directory.
    pub fn directory(&self) -> &Path {
        &self.output.directory
    }

    /// The collection or the series of frames, if there are any.
    pub fn collection(&self) -> Option<PathBuf> {
        self.recording.as_ref().map(Recording::path)
    }

    /// Statistics of the run so far.
    pub fn statistics(&self) -> &RunStatistics {
        &self.statistics
    }

    /// Duration of the run in seconds, without the time in which it was not running.
    fn wall_seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }

    /// Whether the run writes checkpoints.
    pub fn has_checkpoints(&self) -> bool {
        self.checkpoints.is_some()
    }

    fn write_checkpoint(&mut self, motion: &Motion<'_>, is_last: bool) -> io::Result<()> {
        let seconds = self.wall_seconds();
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        let frames = self.recording.as_ref().map_or(&[][..], Recording::written);
        // The clock of rank 0 decides.
        let is_due = self.files.is_some() && checkpoints.is_sync_due();
        let [is_due] = self.ranks.any("whether a sync is due", [is_due]);
        let is_safe = is_last || is_due;
        let synced = match &mut self.files {
            // The history must reach the disk before the checkpoint that belongs to it.
            Some(files) if is_safe => files.history.sync(),
            _ => Ok(()),
        };
        agreed(&**self.ranks.team(), synced)?;
        let progress = Progress {
            frames,
            history_checksum: self.files.as_ref().map_or(0, |files| files.history.sum()),
            wall_seconds: seconds,
            extremes: &self.extremes,
        };
        checkpoints.write(motion, progress, is_safe)
    }
}

impl Drop for Results {
    /// A run that ends without [`Results::finish`] has failed.
    fn drop(&mut self) {
        if !self.is_writer() {
            return;
        }
        summary::abandon_one(&self.summary_path(), Status::Failed, "the run ended before its time");
    }
}

/// How the files of a run ended.
#[derive(Debug)]
pub struct Ending {
    /// Status in the summary.
    pub status: Status,
    /// The summary.
    pub summary: Value,
    /// The statement on its accuracy in time.
    pub accuracy: Option<Accuracy>,
    /// The first error.
    pub error: Option<io::Error>,
}

/// A note on missing frames.
fn missing_frames(missing: &[FrameTime]) -> Option<String> {
    match missing {
        [] => None,
        [FrameTime { step, time }] => Some(format!(
            "the frame of step {step}, t = {time}, is lost: it is not among the files of the run"
        )),
        [first, .., last] => Some(format!(
            "{} frames from t = {} to t = {} are lost: they are not among the files of the run",
            missing.len(),
            first.time,
            last.time
        )),
    }
}

impl Observer for Results {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let row = self.columns.row(view, self.wall_seconds());
        let every = self.output.log_every;
        let is_logged = every > 0 && view.record.step.is_multiple_of(every);
        let written = self.files.as_mut().map_or(Ok(()), |files| files.write(view, &row.numbers, is_logged));
        self.agree(written)?;
        keep_largest(&mut self.extremes, row.extremes);
        let is_frame = self.output.is_frame(&self.plan, view.state.step, view.state.time);
        if is_frame {
            self.write_frame(view.motion)?;
        }
        self.statistics.clone_from(view.motion.statistics());
        let every = self.output.checkpoint_every;
        if every > 0 && view.record.step.is_multiple_of(every) {
            self.write_checkpoint(view.motion, false)?;
        }
        self.report_progress()?;
        Ok(limits::check(&self.limits, &self.statistics)?)
    }

    fn notice(&mut self, event: &Event) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let Some(files) = &mut self.files else { return Ok(()) };
        files.log.event(event)?;
        Ok(files.events.write(event)?)
    }
}
