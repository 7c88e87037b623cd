//! Failures of verbs: their messages and exit codes.

use std::fmt;

use emmy::motion::MarchError;
use emmy_io::directory::DirectoryError;
use emmy_io::input::{InputError, StartError};
use emmy_io::message::shown;
pub(crate) use emmy_io::message::with_causes;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, MietteDiagnostic};

/// Exit code after an internal error.
pub(crate) const INTERNAL_ERROR: u8 = 101;

/// Largest number of faults that are shown.
const MAX_SHOWN_FAULTS: usize = 20;

/// Exit code of a run that was stopped by a signal.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why a verb ended early.
///
/// ```
/// struct Silent;
/// impl emmy_cli::Host for Silent {
///     fn output(&self, _: &str) -> std::io::Result<()> {
///         Ok(())
///     }
///     fn message(&self, _: &str) {}
///     fn is_interrupted(&self) -> bool {
///         false
///     }
/// }
/// let failure = emmy_cli::run_verb(["run", "missing.toml"], &Silent).unwrap_err();
/// assert!(matches!(&failure, emmy_cli::Failure::Input(error) if error.faults().len() == 1));
/// assert_eq!(failure.code(), 2);
/// ```
#[derive(Debug)]
#[non_exhaustive]
pub enum Failure {
    /// Faults in the input, with lines.
    Input(InputError),
    /// Bad input of another kind, such as arguments.
    Usage {
        /// The reason.
        message: String,
        /// Advice.
        help: Option<String>,
    },
    /// Results that are missing, damaged, of another input, or that Emmy must not overwrite.
    Files {
        /// The reason.
        message: String,
        /// Advice.
        help: Option<String>,
    },
    /// A step did not converge; the results up to the step before are written.
    NoConvergence(Box<emmy::Error>),
    /// A run of a study, or the equilibrium at the start of a motion, did not converge.
    Study {
        /// The run and its failure.
        message: String,
        /// Advice, or the results that exist.
        help: String,
    },
    /// A limit was exceeded; the results up to this step are written.
    Limit(String),
    /// A signal came, or the host asked to stop.
    Interrupted {
        /// Step and time.
        message: String,
        /// How to resume.
        help: String,
    },
    /// Any other failure, such as a full disk.
    Other(String),
    /// A fault of Emmy itself.
    Internal(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message())
    }
}

impl std::error::Error for Failure {}

impl Failure {
    /// A result could not be printed.
    pub(crate) fn from_stdout(error: std::io::Error) -> Self {
        Failure::Other(format!("cannot write to standard output: {error}"))
    }

    /// Arguments that cannot be read.
    pub(crate) fn from_arguments(error: &clap::Error) -> Self {
        let text = error.to_string();
        let message = text.strip_prefix("error: ").unwrap_or(&text).trim_end().to_string();
        Failure::Usage { message, help: None }
    }

    /// Exit code of the program.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Input(_) | Failure::Usage { .. } | Failure::Files { .. } => 2,
            Failure::NoConvergence(_) | Failure::Study { .. } => 3,
            Failure::Limit(_) => 4,
            Failure::Interrupted { .. } => INTERRUPTED,
            Failure::Other(_) => 1,
            Failure::Internal(_) => INTERNAL_ERROR,
        }
    }

    /// The reason.
    pub fn message(&self) -> String {
        match self {
            Failure::Input(error) => error.to_string(),
            Failure::NoConvergence(error) => with_causes(&**error),
            Failure::Usage { message, .. }
            | Failure::Files { message, .. }
            | Failure::Study { message, .. }
            | Failure::Interrupted { message, .. }
            | Failure::Limit(message)
            | Failure::Other(message) => message.clone(),
            Failure::Internal(message) => format!("internal error: {message}. Please report it."),
        }
    }

    /// Advice, or a list of the results that exist; faults of the input have their own advice.
    pub fn help(&self) -> Option<&str> {
        match self {
            Failure::Usage { help, .. } | Failure::Files { help, .. } => help.as_deref(),
            Failure::Study { help, .. } | Failure::Interrupted { help, .. } => Some(help),
            Failure::NoConvergence(_) => Some("the results up to the step before are written"),
            Failure::Limit(_) => Some("the results up to this step are written"),
            Failure::Input(_) | Failure::Other(_) | Failure::Internal(_) => None,
        }
    }

    /// The messages for standard error: one for each fault.
    pub(crate) fn texts(&self, has_colours: bool) -> Vec<String> {
        let Failure::Input(error) = self else {
            let diagnostic = MietteDiagnostic::new(shown(&self.message()));
            return vec![match self.help() {
                Some(help) => rendered(&diagnostic.with_help(shown(help)), has_colours),
                None => rendered(&diagnostic, has_colours),
            }];
        };
        let faults = error.faults();
        let shown = faults.iter().take(MAX_SHOWN_FAULTS);
        let mut texts: Vec<String> = shown.map(|fault| rendered(&fault.excerpt(), has_colours)).collect();
        if faults.len() > 1 {
            texts.push(format!("{} faults in the input; nothing was run or written", faults.len()));
        }
        texts
    }
}

/// A diagnostic as text; with colours it is meant for a terminal, and long lines are broken.
fn rendered(diagnostic: &dyn Diagnostic, has_colours: bool) -> String {
    let handler = match has_colours {
        true => GraphicalReportHandler::new_themed(GraphicalTheme::unicode()).with_width(110),
        false => GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_wrap_lines(false),
    };
    let mut text = String::new();
    match handler.render_report(&mut text, diagnostic) {
        Ok(()) => text.trim_end().to_string(),
        Err(_) => diagnostic.to_string(),
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Failure::Input(error)
    }
}

/// A directory that cannot be used is bad input; a file that cannot be written there is not.
impl From<DirectoryError> for Failure {
    fn from(error: DirectoryError) -> Self {
        let message = error.to_string();
        match error {
            DirectoryError::File { .. } => Failure::Other(message),
            _ => Failure::Files { message, help: None },
        }
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
                let help = "[equilibrium] needs supports: `fix`, `move`, `rotate`, `symmetry` or `spring` in [[support]], or joints that hold every part, by a `spring` if they may turn or slide";
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
