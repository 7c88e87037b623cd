//! An observer that keeps all records.

use std::error::Error as StdError;

use emmy::motion::{Event, Observer, Record, Snapshot, View};

/// Keeps everything an observer sees, and a snapshot after one of the steps.
#[derive(Default)]
pub(crate) struct Watch {
    pub records: Vec<Record>,
    pub events: Vec<Event>,
    pub snapshot_after: Option<usize>,
    pub snapshot: Option<Snapshot>,
}

impl Observer for Watch {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn StdError + Send + Sync>> {
        if self.snapshot_after == Some(view.record.step) {
            self.snapshot = Some(view.motion.snapshot());
        }
        self.records.push(view.record.clone());
        Ok(())
    }

    fn notice(&mut self, event: &Event) -> Result<(), Box<dyn StdError + Send + Sync>> {
        self.events.push(event.clone());
        Ok(())
    }
}
