//! The program: its standard streams, signals and exit codes.

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write, stderr};
use std::process::ExitCode;

use clap::Parser;
use emmy_io::summary::{self, Status};

use crate::failure::{Failure, INTERNAL_ERROR};
use crate::host::Host;
use crate::{Arguments, signals};

/// The standard streams of the process, and its signals.
#[derive(Debug)]
struct Program;

impl Host for Program {
    /// A reader that stops early (`emmy list schemes | head -1`) is not a failure.
    fn output(&self, text: &str) -> io::Result<()> {
        let mut stdout = io::stdout().lock();
        let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
        written.or_else(without_reader)
    }

    fn message(&self, text: &str) {
        line(text);
    }

    fn is_interrupted(&self) -> bool {
        signals::is_asked()
    }

    fn prepare(&self) -> Result<(), Failure> {
        signals::listen()
    }

    fn draws_bars(&self) -> bool {
        stderr().is_terminal()
    }
}

/// Writes a line on standard error in one call. A line that cannot be written is dropped: a closed terminal or pipe, or a
/// full disk behind a redirection, must not end a run.
pub(crate) fn line(text: &str) {
    let _ = stderr().lock().write_all(format!("{text}\n").as_bytes());
}

/// Success if the reader of a pipe has stopped.
fn without_reader(error: io::Error) -> io::Result<()> {
    if error.kind() == io::ErrorKind::BrokenPipe { Ok(()) } else { Err(error) }
}

/// The whole program: runs a verb with the standard streams of the process and returns its exit code. `arguments` begin
/// with the name of the program.
///
/// It installs a panic hook and, for runs, signal handlers: it must be the only work of the process. Other programs call
/// [`crate::run_verb`].
pub fn main<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> ExitCode {
    ExitCode::from(exit_code(arguments))
}

/// [`main`] with the exit code as a number.
pub fn exit_code<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    std::panic::set_hook(Box::new(|info| {
        line(&format!("emmy: internal error: {info}. Please report it."));
        summary::abandon(Status::Failed, &format!("internal error: {info}"));
        std::process::exit(INTERNAL_ERROR.into());
    }));
    let ended = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments.verb.run(&Program),
        Err(error) if error.use_stderr() => {
            let _ = error.print();
            return error.exit_code() as u8;
        }
        // Help or version.
        Err(text) => text.print().or_else(without_reader).map_err(Failure::from_stdout),
    };
    match ended {
        Ok(()) => 0,
        Err(failure) => {
            let has_colours = stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
            failure.texts(has_colours).iter().for_each(|text| line(text));
            failure.code()
        }
    }
}
