//! All files of a run: an observer that writes while the motion is computed.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use emmy::body::fields::{FieldName, Fields};
use emmy::motion::{Observer, State, View};
use serde_json::Value;

use crate::directory::{self, DirectoryError, MARK, replace};
use crate::history::{self, HistoryFile};
use crate::input::{Limits, Output, Problem};
use crate::limits;
use crate::newton::NewtonFile;
use crate::report::{self, ReportError};
use crate::summary::{self, Heading, Status};
use crate::tally::Tally;
use crate::vtk::FrameWriter;

/// Writes `input.toml`, `history.csv`, `newton.csv`, the frames, `summary.json` and `report.html` into the output directory,
/// and watches the limits.
#[derive(Debug)]
pub struct Results {
    output: Output,
    limits: Limits,
    heading: Heading,
    history: HistoryFile,
    newton: NewtonFile,
    frames: Option<Frames>,
    tally: Tally,
    started: Instant,
    /// Seconds after which the page is written anew.
    report_due: f64,
}

/// Seconds between two pages of a run that is going on, at the least.
const BETWEEN_REPORTS: f64 = 5.0;

/// The run goes on for so many times the time that a page took before the next one: pages cost at most 2 per cent of it.
const SPARINGLY: f64 = 50.0;

impl Results {
    /// Makes the directory ready and opens the files. The clock starts here.
    ///
    /// # Errors
    /// [`DirectoryError`] if the directory is not for Emmy to write to; then nothing was changed.
    pub fn create(problem: &Problem) -> Result<Self, DirectoryError> {
        let directory = &problem.output.directory;
        directory::prepare(directory)?;
        Results::open(problem).map_err(|error| DirectoryError::System { path: directory.clone(), error })
    }

    fn open(problem: &Problem) -> io::Result<Self> {
        let (output, directory) = (problem.output.clone(), problem.output.directory.as_path());
        replace(&directory.join("input.toml"), input(problem).as_bytes())?;
        let history = HistoryFile::create(&directory.join("history.csv"), &output.probes)?;
        let newton = NewtonFile::create(&directory.join("newton.csv"))?;
        let frames = || Frames::create(problem);
        let frames = (output.every > 0).then(frames).transpose()?;
        let (heading, tally) = (Heading::new(problem), Tally::default());
        let summary = heading.summary(&tally, Status::Running, None, 0.0);
        summary::write(&directory.join("summary.json"), &summary)?;
        Ok(Results {
            limits: problem.limits,
            output,
            heading,
            history,
            newton,
            frames,
            tally,
            started: Instant::now(),
            report_due: BETWEEN_REPORTS,
        })
    }

    /// Ends the run: the last state is written as a frame if it is not there yet, then the summary, which is returned.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(&mut self, state: &State, status: Status, message: Option<&str>) -> io::Result<Value> {
        if let Some(frames) = &mut self.frames {
            frames.write(state)?;
            frames.files.finish()?;
        }
        let summary = self.heading.summary(&self.tally, status, message, self.wall_seconds());
        summary::write(&self.directory().join("summary.json"), &summary)?;
        Ok(summary)
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
            summary::write(&self.directory().join("summary.json"), &summary)?;
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

    /// Seconds since the start of the run.
    pub fn wall_seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

/// The frames with what is in them.
#[derive(Debug)]
struct Frames {
    files: FrameWriter,
    fields: Fields,
    names: Vec<FieldName>,
}

impl Frames {
    fn create(problem: &Problem) -> io::Result<Self> {
        let (body, output) = (&problem.body, &problem.output);
        let fields = Fields::new(body);
        let names = output.fields.iter().copied().filter(|&name| fields.has(name)).collect();
        let files = FrameWriter::create(
            (output.format, output.precision),
            &output.directory,
            body.mesh(),
            body.region_of_cell(),
        )?;
        Ok(Frames { files, fields, names })
    }

    /// Writes a state, unless its step has been written.
    fn write(&mut self, state: &State) -> io::Result<()> {
        if self.files.last_step() == Some(state.step) {
            return Ok(());
        }
        let fields = self.fields.at(&state.displacement, &state.velocity, &self.names);
        self.files.write(state.step, state.time, &fields)
    }
}

impl Observer for Results {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let row = history::row(view, &self.output.probes, self.wall_seconds());
        self.history.write(&row)?;
        self.newton.write(view)?;
        if let Some(frames) =
            self.frames.as_mut().filter(|_| view.record.step.is_multiple_of(self.output.every))
        {
            frames.write(view.state)?;
        }
        self.tally.add(view);
        self.report_progress()?;
        Ok(limits::check(&self.limits, &self.tally)?)
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
