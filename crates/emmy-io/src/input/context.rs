//! The rest of the input, as the reading of a history knows it.

use std::cell::RefCell;
use std::path::Path;

use crate::units::Units;

/// The input around a history.
#[derive(Debug, Clone, Copy)]
pub(super) struct Context<'a> {
    /// Folder of the input.
    pub(super) directory: &'a Path,
    pub(super) units: Units,
    /// Start and end of the run, if they are known.
    pub(super) run: Option<[f64; 2]>,
    /// Whether the body is undeformed at the start.
    pub(super) is_undeformed: bool,
    /// Notes on histories, which are for the user.
    pub(super) notes: &'a RefCell<Vec<String>>,
}

impl Context<'_> {
    /// Adds a note.
    pub(super) fn note(&self, note: String) {
        self.notes.borrow_mut().push(note);
    }
}
