//! Messages on standard error. A message that cannot be written is dropped: a closed terminal or pipe, or a full disk
//! behind a redirection, must not end a run.

use std::fmt;
use std::io::{self, Write};

/// Writes a line in one call.
pub(crate) fn line(text: fmt::Arguments<'_>) {
    let _ = io::stderr().lock().write_all(format!("{text}\n").as_bytes());
}

/// Writes a formatted line on standard error; unlike `eprintln!` it never panics.
macro_rules! message {
    ($($part:tt)*) => { $crate::message::line(format_args!($($part)*)) };
}
pub(crate) use message;
