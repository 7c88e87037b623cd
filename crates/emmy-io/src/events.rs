//! `events.csv`: what happened besides steps that succeed.

use std::io;
use std::path::Path;

use emmy::motion::Event;

use crate::rows::RowFile;

/// Columns of the file.
pub const COLUMNS: &str = "step,time,event,message";

/// The file; every row is on disk once it is written.
#[derive(Debug)]
pub struct EventsFile {
    rows: RowFile,
}

impl EventsFile {
    /// A new file with its header.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(EventsFile { rows: RowFile::create(path, COLUMNS)? })
    }

    /// The file of a run that goes on after a step; later events are taken out.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(path: &Path, step: usize) -> io::Result<Self> {
        if !path.exists() {
            return EventsFile::create(path);
        }
        Ok(EventsFile { rows: RowFile::resume(path, step)? })
    }

    /// Writes an event; its message is quoted as RFC 4180 has it.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, event: &Event) -> io::Result<()> {
        let message = event.message.replace('"', "\"\"").replace('\n', " ");
        self.rows.write(&format!("{},{:?},{},\"{message}\"", event.step, event.time, event.kind.name()))
    }
}
