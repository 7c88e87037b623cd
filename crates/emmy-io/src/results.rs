//! All files of a run: an observer that writes while the motion is computed.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use emmy::body::fields::{FieldName, Fields};
use emmy::motion::{Event, Motion, Observer, State, StepPlan, View};
use serde_json::Value;

use crate::checkpoint::{Checkpoint, Checkpoints, Progress};
use crate::directory::{self, DirectoryError, MARK, replace};
use crate::events::EventsFile;
use crate::history::{self, Extent, HistoryError, HistoryFile};
use crate::input::{Limits, Output, Problem};
use crate::limits;
use crate::lock::Lock;
use crate::log::RunLog;
use crate::newton::NewtonFile;
use crate::report::{self, ReportError};
use crate::sources;
use crate::summary::{self, Heading, Status};
use crate::tally::Tally;
use crate::vtk::{Format, FrameWriter};

/// Why results cannot be written on.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// The history cannot be continued.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The run would remove what it reads.
    #[error(transparent)]
    Directory(#[from] DirectoryError),
    /// The system refused.
    #[error("cannot write the results: {0}")]
    System(#[from] io::Error),
}

/// Writes `input.toml`, `history.csv`, `newton.csv`, `events.csv`, `run.log`, the frames, checkpoints, `summary.json` and `report.html` into
/// the output directory,
/// and watches the limits.
#[derive(Debug)]
pub struct Results {
    output: Output,
    plan: StepPlan,
    extent: Extent,
    limits: Limits,
    heading: Heading,
    history: HistoryFile,
    newton: NewtonFile,
    frames: Option<Frames>,
    tally: Tally,
    events: EventsFile,
    log: RunLog,
    checkpoints: Option<Checkpoints>,
    started: Instant,
    /// Seconds after which the page is written anew.
    report_due: f64,
    /// Seconds that the run took before it went on.
    seconds_before: f64,
    /// Estimated error of the positions, if it was asked for.
    estimated_error: Option<f64>,
    /// What the user should know of the files.
    notes: Vec<String>,
    _lock: Lock,
}

/// Seconds between two pages of a run that is going on, at the least.
const BETWEEN_REPORTS: f64 = 5.0;

/// The run goes on for so many times the time that a page took before the next one: pages cost at most 2 per cent of it.
const SPARINGLY: f64 = 50.0;

impl Results {
    /// Makes the directory ready and opens the files. The clock starts here.
    ///
    /// # Errors
    /// [`DirectoryError`] if the directory is not for Emmy to write to, or another run writes there; then nothing was changed.
    pub fn create(problem: &Problem) -> Result<Self, DirectoryError> {
        let directory = &problem.output.directory;
        let system = |error| DirectoryError::System { path: directory.clone(), error };
        directory::check_run(problem)?;
        std::fs::create_dir_all(directory).map_err(system)?;
        let lock = Lock::take(directory)?;
        directory::prepare(directory)?;
        replace(&directory.join("input.toml"), input(problem).as_bytes()).map_err(system)?;
        let history = HistoryFile::create(&directory.join("history.csv"), &Extent::of(problem));
        let history = history.map_err(system)?;
        Results::open(problem, lock, history, None).map_err(system)
    }

    /// Takes the files of a run up where a checkpoint left them: what was written after it is taken out.
    ///
    /// # Errors
    /// [`ResumeError`].
    pub fn resume(problem: &Problem, lock: Lock, checkpoint: &Checkpoint) -> Result<Self, ResumeError> {
        let (directory, state) = (&problem.output.directory, &checkpoint.snapshot.state);
        let path = directory.join("history.csv");
        // The directory's own input is the one that is written again.
        sources::check(directory, &problem.files[1..])?;
        let history =
            HistoryFile::resume(&path, &Extent::of(problem), state.step, state.time, checkpoint.history)?;
        replace(&directory.join("input.toml"), input(problem).as_bytes())?;
        Ok(Results::open(problem, lock, history, Some(checkpoint))?)
    }

    fn open(
        problem: &Problem,
        lock: Lock,
        history: HistoryFile,
        after: Option<&Checkpoint>,
    ) -> io::Result<Self> {
        let (output, directory) = (problem.output.clone(), problem.output.directory.as_path());
        let place = after.map(|checkpoint| (checkpoint.snapshot.state.step, checkpoint.snapshot.state.time));
        let events = directory.join("events.csv");
        let mut events = match place {
            Some((step, _)) => EventsFile::resume(&events, step)?,
            None => EventsFile::create(&events)?,
        };
        let mut log = RunLog::open(&directory.join("run.log"), problem, place)?;
        let newton = directory.join("newton.csv");
        let newton = match place {
            Some((step, _)) => NewtonFile::resume(&newton, step)?,
            None => NewtonFile::create(&newton)?,
        };
        let frames = || Frames::open(problem, after);
        let (frames, lost) = output.has_frames().then(frames).transpose()?.unzip();
        let notes: Vec<String> = lost.and_then(|lost| lost_frames(&lost)).into_iter().collect();
        if let Some((step, time)) = place {
            directory::remove_unfinished(directory, frames.is_some() && output.format == Format::Vtkhdf)?;
            for note in &notes {
                events.write_lost_frames(step, time, note)?;
                log.line(&format!("note: {note}"))?;
            }
        }
        let checkpoints =
            (output.checkpoint_every > 0).then(|| Checkpoints::new(problem, after)).transpose()?;
        let heading = Heading::new(problem);
        let tally = after.map_or(Tally::default(), |checkpoint| checkpoint.tally.clone());
        let seconds_before = after.map_or(0.0, |checkpoint| checkpoint.wall_seconds);
        let summary = heading.summary(&tally, Status::Running, None, seconds_before);
        summary::write(&directory.join("summary.json"), &summary)?;
        Ok(Results {
            limits: problem.limits,
            extent: Extent::of(problem),
            output,
            plan: problem.plan.clone(),
            heading,
            history,
            newton,
            frames,
            tally,
            events,
            log,
            checkpoints,
            started: Instant::now(),
            report_due: seconds_before + BETWEEN_REPORTS,
            seconds_before,
            estimated_error: None,
            notes,
            _lock: lock,
        })
    }

    /// Ends the run: the last state is written as a frame and as a checkpoint if it is not there yet, then the summary. All is tried,
    /// whatever fails of it; a run that was done has then failed.
    pub fn finish(&mut self, motion: &Motion<'_>, status: Status, message: Option<&str>) -> Ending {
        // A step that could not be written is not one to go on from.
        let is_sound = status != Status::Failed;
        let mut errors = vec![self.end_frames(motion, is_sound)];
        errors.extend(is_sound.then(|| self.write_checkpoint(motion, true)));
        errors.push(self.history.verify());
        let mut error = errors.into_iter().find_map(Result::err);
        let status = if error.is_some() && status == Status::Done { Status::Failed } else { status };
        let unwritten = error.as_ref().map(|error| format!("the results cannot be written: {error}"));
        let message = message.map(str::to_string).or(unwritten);
        let end = format!("{} at step {}, t = {}", status.name(), self.tally.steps, self.tally.time);
        let end = message.as_ref().map_or(end.clone(), |message| format!("{end}: {message}"));
        let logged = self.log.line(&end);
        let mut summary = self.heading.summary(&self.tally, status, message.as_deref(), self.wall_seconds());
        summary["estimated_error"] = self.estimated_error.into();
        let written = summary::write(&self.summary_path(), &summary);
        error = error.or(logged.err()).or(written.err());
        Ending { status, summary, error }
    }

    /// Ends the files of the frames, with the last state among them if that `is_sound`.
    fn end_frames(&mut self, motion: &Motion<'_>, is_sound: bool) -> io::Result<()> {
        let Some(frames) = &mut self.frames else { return Ok(()) };
        let written = if is_sound { frames.write(motion.state()) } else { Ok(()) };
        written.and(frames.files.finish())
    }

    fn summary_path(&self) -> PathBuf {
        self.directory().join("summary.json")
    }

    /// What the user should know of the files of a run that was resumed.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Notes the estimated error of the positions at the end, a mean over the mass \[length\], for the summary.
    pub fn note_error(&mut self, error: f64) {
        self.estimated_error = Some(error);
    }

    /// Writes `report.html`, of the run as far as it is.
    ///
    /// # Errors
    /// [`ReportError`] if a file cannot be written, or read back.
    pub fn report(&self) -> Result<PathBuf, ReportError> {
        report::write(self.directory())
    }

    /// Writes summary and page of a run that is going on, if it is time. A page that cannot be written is no reason to end a
    /// run: the one at the end tells why.
    fn report_progress(&mut self) -> io::Result<()> {
        let begin = self.wall_seconds();
        if begin >= self.report_due {
            let summary = self.heading.summary(&self.tally, Status::Running, None, begin);
            summary::write(&self.summary_path(), &summary)?;
            let _ = self.report();
            let now = self.wall_seconds();
            self.report_due = now + BETWEEN_REPORTS.max(SPARINGLY * (now - begin));
        }
        Ok(())
    }

    /// The output directory.
    pub fn directory(&self) -> &Path {
        &self.output.directory
    }

    /// The collection of frames, or the one file that holds them, if there are any.
    pub fn collection(&self) -> Option<PathBuf> {
        self.frames.as_ref().map(|frames| frames.files.path())
    }

    /// What the run adds up to so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Seconds since the start of the run, without the time in which it was not running.
    pub fn wall_seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }

    /// Whether the run writes checkpoints.
    pub fn has_checkpoints(&self) -> bool {
        self.checkpoints.is_some()
    }

    fn write_checkpoint(&mut self, motion: &Motion<'_>, is_last: bool) -> io::Result<()> {
        let seconds = self.wall_seconds();
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        let frames = self.frames.as_ref().map_or(&[][..], |frames| &frames.times);
        let is_safe = is_last || checkpoints.is_sync_due();
        if is_safe {
            // A checkpoint must not know of more steps than the history has.
            self.history.sync()?;
        }
        let progress = Progress { frames, history: self.history.sum(), wall_seconds: seconds };
        checkpoints.write(motion, &self.tally, progress, is_safe)
    }
}

impl Drop for Results {
    /// A run that ends without [`Results::finish`] has failed.
    fn drop(&mut self) {
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
    /// What could not be written first.
    pub error: Option<io::Error>,
}

/// A note on frames that are not there any more.
fn lost_frames(lost: &[(usize, f64)]) -> Option<String> {
    let [(_, first), .., (_, last)] = lost else {
        let (step, time) = lost.first()?;
        return Some(format!(
            "the frame of step {step}, t = {time}, is lost: it is not among the files of the run"
        ));
    };
    let n = lost.len();
    Some(format!(
        "{n} frames from t = {first} to t = {last} are lost: they are not among the files of the run"
    ))
}

/// The frames with what is in them.
#[derive(Debug)]
struct Frames {
    files: FrameWriter,
    fields: Fields,
    names: Vec<FieldName>,
    /// Steps and times of the frames that were written.
    times: Vec<(usize, f64)>,
}

impl Frames {
    /// The frames of a run; of one that is resumed, with those up to its checkpoint, and which of them are lost.
    fn open(problem: &Problem, after: Option<&Checkpoint>) -> io::Result<(Self, Vec<(usize, f64)>)> {
        let (body, output) = (&problem.body, &problem.output);
        let fields = Fields::new(body);
        let names = output.fields.iter().copied().filter(|&name| fields.has(name)).collect();
        let (form, directory) = ((output.format, output.precision), &output.directory);
        let (mesh, regions) = (body.mesh(), body.region_of_cell());
        let Some(checkpoint) = after else {
            let files = FrameWriter::create(form, directory, mesh, regions)?;
            return Ok((Frames { files, fields, names, times: Vec::new() }, Vec::new()));
        };
        // The last state of a run that ended is a frame out of turn.
        let step = checkpoint.snapshot.state.step;
        let is_kept = |own: usize, time| own != step || output.is_frame(&problem.plan, own, time);
        let written = checkpoint.frames.iter().copied();
        let mut times: Vec<_> = written.filter(|(own, time)| is_kept(*own, *time)).collect();
        let (files, lost) = FrameWriter::resume(form, directory, mesh, regions, (&times, step))?;
        times.retain(|frame| !lost.contains(frame));
        Ok((Frames { files, fields, names, times }, lost))
    }

    /// Writes a state, unless its step has been written.
    fn write(&mut self, state: &State) -> io::Result<()> {
        if self.files.last_step() == Some(state.step) {
            return Ok(());
        }
        let fields = self.fields.at(&state.displacement, &state.velocity, &self.names);
        self.files.write(state.step, state.time, &fields)?;
        self.times.push((state.step, state.time));
        Ok(())
    }
}

impl Observer for Results {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let row = history::row(view, &self.extent, self.wall_seconds());
        self.history.write(&row)?;
        let every = self.output.log_every;
        let is_logged = every > 0 && view.record.step.is_multiple_of(every);
        if is_logged {
            self.newton.write(view)?;
        }
        let is_frame = self.output.is_frame(&self.plan, view.state.step, view.state.time);
        if let Some(frames) = self.frames.as_mut().filter(|_| is_frame) {
            frames.write(view.state)?;
        }
        self.tally.add(view);
        self.log.solver(view.record)?;
        if is_logged {
            self.log.step(view.record)?;
        }
        let every = self.output.checkpoint_every;
        if every > 0 && view.record.step.is_multiple_of(every) {
            self.write_checkpoint(view.motion, false)?;
        }
        self.report_progress()?;
        Ok(limits::check(&self.limits, &self.tally)?)
    }

    fn notice(&mut self, event: &Event) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.log.event(event)?;
        Ok(self.events.write(event)?)
    }
}

/// The resolved input under its mark.
fn input(problem: &Problem) -> String {
    format!(
        "{MARK} {}: the input of this run with all values that hold.\n\n{}",
        env!("CARGO_PKG_VERSION"),
        problem.resolved
    )
}
