//! `events.csv`: cuts, rejections, releases and other events of a run.

use std::io;
use std::path::Path;

use emmy::motion::Event;

use crate::rows::RowFile;

/// Columns of the file.
pub const COLUMNS: &str = "step,time,event,message";

/// The file; every row is written at once.
#[derive(Debug)]
pub struct EventsFile {
    rows: RowFile,
}

impl EventsFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(EventsFile { rows: RowFile::create(path, COLUMNS)? })
    }

    /// The file of a run that is resumed after a step; later events are removed.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn resume(path: &Path, step: usize) -> io::Result<Self> {
        if !path.exists() {
            return EventsFile::create(path);
        }
        Ok(EventsFile { rows: RowFile::resume(path, step)? })
    }

    /// Writes an event; its message is quoted as in RFC 4180.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, event: &Event) -> io::Result<()> {
        self.write_row(event.step, event.time, event.kind.name(), &event.message)
    }

    /// Writes that frames of the run are missing.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write_lost_frames(&mut self, step: usize, time: f64, message: &str) -> io::Result<()> {
        self.write_row(step, time, "lost-frames", message)
    }

    fn write_row(&mut self, step: usize, time: f64, kind: &str, message: &str) -> io::Result<()> {
        let message = message.replace('"', "\"\"").replace('\n', " ");
        self.rows.write(&format!("{step},{time:?},{kind},\"{message}\""))
    }
}
