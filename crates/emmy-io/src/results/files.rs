//! The files of the whole run, which one rank writes.

use std::io;
use std::path::Path;

use emmy::motion::View;

use crate::directory::{Lock, MARK};
use crate::events::EventsFile;
use crate::history::{HistoryColumns, HistoryFile, Number, Peaks};
use crate::input::Problem;
use crate::log::RunLog;
use crate::newton::NewtonFile;
use crate::whole_file::{remove, replace};

/// Files that one rank writes.
#[derive(Debug)]
pub(super) struct Files {
    pub(super) history: HistoryFile,
    /// Peaks of the rows of the history.
    pub(super) peaks: Peaks,
    newton: NewtonFile,
    pub(super) events: EventsFile,
    pub(super) log: RunLog,
    _lock: Lock,
}

impl Files {
    /// Creates the files of a run in a directory, or opens those of a run that resumes after a step and a time.
    pub(super) fn open(
        problem: &Problem,
        lock: Lock,
        (history, peaks): (HistoryFile, Peaks),
        start: Option<(usize, f64)>,
    ) -> io::Result<Self> {
        let directory = problem.output.directory.as_path();
        let (events, newton) = (directory.join("events.csv"), directory.join("newton.csv"));
        write_units(&directory.join("columns.json"), problem)?;
        let log = RunLog::open(&directory.join("run.log"), problem, start)?;
        let (events, newton) = match start {
            Some((step, _)) => (EventsFile::resume(&events, step)?, NewtonFile::resume(&newton, step)?),
            None => (EventsFile::create(&events)?, NewtonFile::create(&newton)?),
        };
        Ok(Files { history, peaks, newton, events, log, _lock: lock })
    }

    /// Writes the lines of a step, and its iteration if it `is_logged`.
    pub(super) fn write(&mut self, view: View<'_>, numbers: &[Number], is_logged: bool) -> io::Result<()> {
        self.history.write(numbers)?;
        self.peaks.add(numbers);
        self.log.solver(view.record)?;
        if is_logged {
            self.newton.write(view)?;
            self.log.step(view.record)?;
        }
        Ok(())
    }

    pub(super) fn write_lost_frames(
        &mut self,
        (step, time): (usize, f64),
        notes: &[String],
    ) -> io::Result<()> {
        for note in notes {
            self.events.write_lost_frames(step, time, note)?;
            self.log.line(&format!("note: {note}"))?;
        }
        Ok(())
    }
}

/// Writes the units of the columns of the history, if the input has units.
pub(crate) fn write_units(path: &Path, problem: &Problem) -> io::Result<()> {
    match problem.units.system() {
        Some(_) => {
            let columns = HistoryColumns::of(problem).with_units(problem.units);
            replace(path, format!("{columns:#}\n").as_bytes())
        }
        None => remove(path),
    }
}

/// The resolved input with its mark.
pub(crate) fn input(problem: &Problem) -> String {
    format!(
        "{MARK} {}: the input of this run with all defaults.\n\n{}",
        env!("CARGO_PKG_VERSION"),
        problem.resolved
    )
}
