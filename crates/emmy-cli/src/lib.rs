//! The command line of Emmy. Each verb is a file in `verbs`; only results go to standard output.
//!
//! The program `emmy` is [`main`]. Another program calls [`run_verb`] with a [`Host`], which receives all text; then
//! nothing is printed, except by the panic hook of the process, and no handler is touched.

// These macros panic if they cannot write; the host does not.
#![deny(clippy::print_stderr, clippy::print_stdout)]

mod failure;
mod host;
mod print;
mod program;
mod progress;
mod signals;
mod verbs;

use std::any::Any;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};

use clap::Parser;

pub use failure::Failure;
pub use host::{Host, ProgressUpdate};
pub use program::{exit_code, exit_code_on_team, main};
pub use signals::report_file_limits;
pub use verbs::{report_on, report_on_body};

/// Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.
#[derive(Debug, Parser)]
#[command(name = "emmy", version, max_term_width = 110, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    verb: verbs::Verb,
}

/// The verbs of a team of processes.
#[derive(Debug, Parser)]
#[command(name = "emmy-mpi", version, max_term_width = 110, after_help = EXIT_CODES_OF_TEAMS)]
struct TeamArguments {
    #[command(subcommand)]
    verb: verbs::TeamVerb,
}

const EXIT_CODES_OF_TEAMS: &str = "Exit codes: 0 done; 2 bad input; 3 no convergence; 4 a limit of [limits] exceeded; \
                                   130 stopped by a signal, the file `stop` or --wall-limit, with a checkpoint; 101 an internal \
                                   error, or a failed call of MPI; 1 any other failure.\n\
                                   Start with `mpirun -n 4 emmy-mpi run l-block.toml`; `emmy` has the other verbs.";

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad input; 3 no convergence; 4 a limit of [limits] exceeded; \
                          130 stopped by a signal, the file `stop` or --wall-limit, with a checkpoint; 101 an internal error; \
                          1 any other failure.\nStart with `emmy new l-block`, then `emmy run l-block.toml`.";

/// Runs a verb in another program. `arguments` are those of the command line after `emmy`, such as `["run", "a.toml"]`;
/// relative paths count from the working directory of the process.
///
/// All text goes to the host. With `--threads` the work has a thread pool of its own, otherwise the rayon pool of the
/// caller. Several verbs may run side by side, with a host each.
///
/// # Errors
/// [`Failure`], with the exit code that the program would have. A panic becomes [`Failure::Internal`].
pub fn run_verb<A: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
    host: &dyn Host,
) -> Result<(), Failure> {
    let arguments = arguments.into_iter().map(Into::into);
    let arguments = match Arguments::try_parse_from([OsString::from("emmy")].into_iter().chain(arguments)) {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => return Err(Failure::from_arguments(&error)),
        // Help or version.
        Err(text) => return print::result(host, &text.to_string()),
    };
    let ended = catch_unwind(AssertUnwindSafe(|| arguments.verb.run(host)));
    ended.unwrap_or_else(|panic| Err(Failure::Internal(text_of(&*panic))))
}

/// The message of a panic.
fn text_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".to_string())
}
