//! Failures of verbs: their messages and exit codes.

use std::io::{IsTerminal, stderr};

use emmy::motion::MarchError;
use emmy_io::directory::DirectoryError;
use emmy_io::input::{InputError, StartError};
use emmy_io::message::shown;
pub(crate) use emmy_io::message::with_causes;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, MietteDiagnostic};

use crate::message::message;

/// Exit code after an internal error.
pub(crate) const INTERNAL_ERROR: u8 = 101;

/// Largest number of faults that are shown.
const MAX_SHOWN_FAULTS: usize = 20;

/// Exit code of a run that was stopped by a signal.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why a verb ended early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Faults in the input, with lines.
    Input(InputError),
    /// Bad input of another kind: arguments, or files that Emmy must not overwrite.
    Usage {
        /// The reason.
        message: String,
        /// Advice.
        help: Option<String>,
    },
    /// A step did not converge.
    NoConvergence(String),
    /// A run of a study, or the equilibrium at the start of a motion, did not converge.
    Study {
        /// The run and its failure.
        message: String,
        /// Advice, or the results that exist.
        help: String,
    },
    /// A limit was exceeded.
    Limit(String),
    /// A signal came.
    Interrupted {
        /// Step and time.
        message: String,
        /// How to resume.
        help: String,
    },
    /// Any other failure, such as a full disk.
    Other(String),
}

impl Failure {
    /// A result could not be printed.
    pub(crate) fn from_stdout(error: std::io::Error) -> Self {
        Failure::Other(format!("cannot write to standard output: {error}"))
    }

    /// Exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Failure::Input(_) | Failure::Usage { .. } => 2,
            Failure::NoConvergence(_) | Failure::Study { .. } => 3,
            Failure::Limit(_) => 4,
            Failure::Interrupted { .. } => INTERRUPTED,
            Failure::Other(_) => 1,
        }
    }

    /// The reason.
    pub(crate) fn message(&self) -> String {
        match self {
            Failure::Input(error) => error.to_string(),
            Failure::Usage { message, .. }
            | Failure::Study { message, .. }
            | Failure::Interrupted { message, .. } => message.clone(),
            Failure::NoConvergence(message) | Failure::Limit(message) | Failure::Other(message) => {
                message.clone()
            }
        }
    }

    /// Prints the failure on standard error.
    pub(crate) fn show(&self) {
        match self {
            Failure::Input(error) => {
                error.faults().iter().take(MAX_SHOWN_FAULTS).for_each(|fault| show(&fault.excerpt()));
                if error.faults().len() > 1 {
                    message!("{} faults in the input; nothing was run or written", error.faults().len());
                }
            }
            Failure::Usage { message, help } => plain(message, help.as_deref()),
            Failure::Study { message, help } | Failure::Interrupted { message, help } => {
                plain(message, Some(help));
            }
            Failure::NoConvergence(message) => {
                plain(message, Some("the results up to the step before are written"))
            }
            Failure::Limit(message) => plain(message, Some("the results up to this step are written")),
            Failure::Other(message) => plain(message, None),
        }
    }
}

fn plain(message: &str, help: Option<&str>) {
    let diagnostic = MietteDiagnostic::new(shown(message));
    match help {
        Some(help) => show(&diagnostic.with_help(shown(help))),
        None => show(&diagnostic),
    }
}

/// Renders a diagnostic, with colours and line breaks only on a terminal.
fn show(diagnostic: &dyn Diagnostic) {
    let handler = match stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        true => GraphicalReportHandler::new_themed(GraphicalTheme::unicode()).with_width(110),
        false => GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_wrap_lines(false),
    };
    let mut text = String::new();
    match handler.render_report(&mut text, diagnostic) {
        Ok(()) => message!("{}", text.trim_end()),
        Err(_) => message!("{diagnostic}"),
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Failure::Input(error)
    }
}

impl From<DirectoryError> for Failure {
    fn from(error: DirectoryError) -> Self {
        Failure::Usage { message: error.to_string(), help: None }
    }
}

/// A start that does not fit is bad input; an equilibrium that was not found is a failed computation.
impl From<StartError> for Failure {
    fn from(error: StartError) -> Self {
        match error {
            StartError::March(MarchError::Step(error @ emmy::Error::NoEquilibrium { .. })) => {
                let help = "nothing is written; without `[time]` the equilibria up to there are the results";
                Failure::Study { message: with_causes(&error), help: help.to_string() }
            }
            StartError::March(MarchError::Step(error @ emmy::Error::NotHeld { .. })) => {
                let help = "[equilibrium] needs supports: `fix`, `move`, `rotate`, `symmetry` or `spring` in [[support]]";
                Failure::Usage { message: error.to_string(), help: Some(help.to_string()) }
            }
            StartError::Unstable(error) => Failure::Input(error),
            other => Failure::Usage { message: with_causes(&other), help: None },
        }
    }
}

/// Errors of the library before the first step are errors of the input.
impl From<emmy::Error> for Failure {
    fn from(error: emmy::Error) -> Self {
        Failure::Usage { message: error.to_string(), help: None }
    }
}
