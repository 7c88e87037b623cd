//! The command line of Emmy. Each verb is a file in `verbs`; only results go to standard output.

// These macros panic if they cannot write; `message` and `print::result` do not.
#![deny(clippy::print_stderr, clippy::print_stdout)]

mod failure;
mod message;
mod print;
mod progress;
mod signals;
mod verbs;

use std::process::ExitCode;

use clap::Parser;
use emmy_io::summary::{self, Status};

use crate::failure::Failure;
use crate::message::message;

/// Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.
#[derive(Debug, Parser)]
#[command(name = "emmy", version, max_term_width = 110, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    verb: verbs::Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad input; 3 no convergence; 4 a limit of [limits] exceeded; \
                          130 stopped by a signal, with a checkpoint; 1 any other failure.\nStart with `emmy new l-block`, then `emmy run l-block.toml`.";

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|info| {
        message!("emmy: internal error: {info}. Please report it.");
        summary::abandon(Status::Failed, &format!("internal error: {info}"));
        std::process::exit(failure::INTERNAL_ERROR.into());
    }));
    let ended = match Arguments::try_parse() {
        Ok(arguments) => arguments.verb.run(),
        Err(error) if error.use_stderr() => {
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
        // Help or version.
        Err(text) => text.print().or_else(print::without_reader).map_err(Failure::from_stdout),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            ExitCode::from(failure.code())
        }
    }
}
