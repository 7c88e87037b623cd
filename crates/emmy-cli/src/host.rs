//! The environment of a verb: where its text goes, and whether it should stop.

use std::path::Path;
use std::sync::Arc;
use std::{fmt, io};

use emmy::team::Team;

use crate::failure::Failure;

/// The environment of a verb: the program with its terminal, or another program that calls [`crate::run_verb`].
///
/// A verb calls it from any of its threads.
///
/// ```
/// use std::io;
/// use std::sync::Mutex;
/// /// Keeps the results, and drops all messages.
/// #[derive(Default)]
/// struct Kept(Mutex<String>);
/// impl emmy_cli::Host for Kept {
///     fn output(&self, text: &str) -> io::Result<()> {
///         self.0.lock().unwrap().push_str(text);
///         Ok(())
///     }
///     fn message(&self, _: &str) {}
///     fn is_interrupted(&self) -> bool {
///         false
///     }
/// }
/// let kept = Kept::default();
/// emmy_cli::run_verb(["list", "schemes"], &kept).unwrap();
/// assert!(kept.0.into_inner().unwrap().contains("DGM"));
/// ```
pub trait Host: Sync {
    /// Takes text for standard output: results, which end with a line feed.
    ///
    /// # Errors
    /// An error ends the verb as [`Failure::Other`].
    fn output(&self, text: &str) -> io::Result<()>;

    /// Takes a message for standard error, without a line feed at its end: notes, warnings, lines of progress, the
    /// closing report. `--quiet` switches off all but notes and warnings.
    fn message(&self, text: &str);

    /// Takes a note that states how far results can be trusted. The results have it, too, so a host that hands them
    /// over may drop it.
    fn statement(&self, text: &str) {
        self.message(text);
    }

    /// Whether to stop. A run asks after each step, and then ends with its files complete and
    /// [`Failure::Interrupted`].
    fn is_interrupted(&self) -> bool;

    /// Takes the progress of the verb, after each step or run; also with `--quiet`.
    fn progress(&self, _: &ProgressUpdate<'_>) {}

    /// Called once before the work that can be interrupted begins. The program installs its signal handlers here.
    ///
    /// # Errors
    /// A failure ends the verb, before anything is computed.
    fn prepare(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// The team of which this process is a rank, for the verbs `run`, `resume` and `check`; `None`: it works alone. All
    /// ranks run the same verb; only the host of rank 0 should show text.
    fn team(&self) -> Option<&Arc<dyn Team>> {
        None
    }

    /// The folder from which the ranks of the team read their parts of the mesh; `None`: rank 0 reads the mesh.
    fn parts(&self) -> Option<&Path> {
        None
    }

    /// Whether progress is drawn as a bar on the standard error of the process, instead of in lines.
    fn draws_bars(&self) -> bool {
        false
    }
}

impl fmt::Debug for dyn Host + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Host")
    }
}

/// How far the work of a verb is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProgressUpdate<'a> {
    /// The part of the work: empty for the run itself, or `equilibrium`, `start`, `reference`, `runs`.
    pub what: &'a str,
    /// The finished part, from 0 to `total`.
    pub done: f64,
    /// The whole: planned steps, the duration of adaptive steps, or the number of runs.
    pub total: f64,
    /// Time, energy balance and iterations of the step, or the number of failed runs.
    pub text: &'a str,
}

/// Passes a formatted message to a host.
macro_rules! message {
    ($host:expr, $($part:tt)*) => { $host.message(&format!($($part)*)) };
}
pub(crate) use message;
