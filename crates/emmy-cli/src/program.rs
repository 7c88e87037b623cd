//! The program: its standard streams, signals and exit codes.

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write, stderr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use emmy::team::Team;
use emmy_io::summary::{self, Status};
use emmy_io::team::other_than_first;

use crate::failure::{Failure, INTERNAL_ERROR};
use crate::host::Host;
use crate::{Arguments, TeamArguments, signals};

/// The standard streams of the process, and its signals. Ranks other than 0 show nothing.
#[derive(Debug)]
struct Program {
    team: Option<Arc<dyn Team>>,
    parts: Option<PathBuf>,
}

impl Program {
    fn is_shown(&self) -> bool {
        self.team.as_ref().is_none_or(|team| team.rank() == 0)
    }
}

impl Host for Program {
    /// A reader that stops early (`emmy list schemes | head -1`) is not a failure.
    fn output(&self, text: &str) -> io::Result<()> {
        if !self.is_shown() {
            return Ok(());
        }
        let mut stdout = io::stdout().lock();
        let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
        written.or_else(without_reader)
    }

    fn message(&self, text: &str) {
        if self.is_shown() {
            line(text);
        }
    }

    fn is_interrupted(&self) -> bool {
        signals::is_asked()
    }

    fn prepare(&self) -> Result<(), Failure> {
        signals::listen(self.is_shown())
    }

    fn team(&self) -> Option<&Arc<dyn Team>> {
        self.team.as_ref()
    }

    fn parts(&self) -> Option<&Path> {
        self.parts.as_deref()
    }

    fn draws_bars(&self) -> bool {
        self.is_shown() && stderr().is_terminal()
    }
}

/// Writes a line on standard error in one call. A line that cannot be written is dropped: a closed terminal or pipe, or
/// a full disk behind a redirection, must not end a run.
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
/// It installs a panic hook and, for runs, signal handlers: it must be the only work of the process. Other programs
/// call [`crate::run_verb`].
pub fn main<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> ExitCode {
    ExitCode::from(exit_code(arguments))
}

/// [`main`] with the exit code as a number.
pub fn exit_code<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    signals::report_file_limits();
    report_panics(|| std::process::exit(INTERNAL_ERROR.into()));
    let program = Program { team: None, parts: None };
    match Arguments::try_parse_from(arguments) {
        Ok(arguments) => program.ended(arguments.verb.run(&program)),
        Err(text) => not_parsed(&text),
    }
}

/// The whole program of a rank of a team: all ranks run the same verb, and have the same exit code. `arguments` begin
/// with the name of the program; the verbs are `run`, `resume` and `check`.
///
/// As [`main`], it must be the only work of the process.
pub fn exit_code_on_team<A: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
    team: Arc<dyn Team>,
) -> u8 {
    // Whoever started the team ends all ranks after a panic of one.
    report_panics(|| {});
    let mut program = Program { team: Some(team.clone()), parts: None };
    let arguments = TeamArguments::try_parse_from(arguments);
    let code = match check_commands(&*team, &arguments).and(Ok(arguments)) {
        Err(failure) => program.ended(Err(failure)),
        Ok(Ok(arguments)) => {
            let (verb, parts) = arguments.verb.verb();
            program.parts = parts;
            program.ended(verb.run(&program))
        }
        Ok(Err(text)) if program.is_shown() => not_parsed(&text),
        Ok(Err(text)) => text.exit_code() as u8,
    };
    let of_first = if program.is_shown() { f64::from(code) } else { 0.0 };
    let mut codes = [of_first, f64::from(code)];
    team.largest("exit code", &mut codes);
    codes.into_iter().find(|code| *code > 0.0).unwrap_or(0.0) as u8
}

/// Checks that all ranks have the same command. This is their first call, because ranks with different commands would
/// make different calls.
fn check_commands(team: &dyn Team, arguments: &Result<TeamArguments, clap::Error>) -> Result<(), Failure> {
    let own = match arguments {
        Ok(arguments) => arguments.verb.compared(),
        Err(text) => text.to_string(),
    };
    let Some(rank) = other_than_first(team, "command", &format!("{} {own}", env!("CARGO_PKG_VERSION")))
    else {
        return Ok(());
    };
    let message = format!("rank {rank} has another command than rank 0, or another version of Emmy");
    let help = "all ranks compute one body: give each the same verb and flags; --threads may differ";
    Err(Failure::Usage { message, help: Some(help.to_string()) })
}

impl Program {
    /// Prints a failure and returns the exit code of a verb.
    fn ended(&self, outcome: Result<(), Failure>) -> u8 {
        let Err(failure) = outcome else { return 0 };
        let has_colours = stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        failure.texts(has_colours).iter().for_each(|text| self.message(text));
        failure.code()
    }
}

/// Reports panics, and then calls a function.
fn report_panics(then: impl Fn() + Send + Sync + 'static) {
    std::panic::set_hook(Box::new(move |info| {
        line(&format!("emmy: internal error: {info}. Please report it."));
        summary::abandon(Status::Failed, &format!("internal error: {info}"));
        then();
    }));
}

/// Prints help, the version, or why arguments cannot be read; returns the exit code.
fn not_parsed(text: &clap::Error) -> u8 {
    if text.use_stderr() {
        let _ = text.print();
        return text.exit_code() as u8;
    }
    let printed = text.print().or_else(without_reader).map_err(Failure::from_stdout);
    Program { team: None, parts: None }.ended(printed)
}
