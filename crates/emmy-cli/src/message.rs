//! Messages on standard error. One that cannot be written is lost: a terminal that has gone away, a pipe without a reader or a full
//! disk behind a redirection must not end a run.

use std::fmt;
use std::io::{self, Write};

/// Writes a line, in one piece.
pub fn line(text: fmt::Arguments<'_>) {
    let _ = io::stderr().lock().write_all(format!("{text}\n").as_bytes());
}

/// Writes a line of the form of [`format!`] on standard error; unlike `eprintln!` it never panics.
macro_rules! message {
    ($($part:tt)*) => { $crate::message::line(format_args!($($part)*)) };
}
pub(crate) use message;
