//! The command line of Emmy. One verb a file, in `verbs`; only results go to standard output.

mod failure;
mod print;
mod progress;
mod signals;
mod verbs;

use std::process::ExitCode;

use clap::Parser;

/// Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.
#[derive(Debug, Parser)]
#[command(name = "emmy", version, max_term_width = 110, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    verb: verbs::Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 2 bad input; 3 no convergence; 4 a limit of [limits] exceeded; \
                          130 stopped from outside, with a checkpoint; 1 anything else.\nStart with `emmy new l-block`, then `emmy run l-block.toml`.";

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|info| {
        eprintln!("emmy: a fault of the program itself: {info}; please report it");
        std::process::exit(failure::FAULT_OF_THE_PROGRAM.into());
    }));
    match Arguments::parse().verb.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            ExitCode::from(failure.code())
        }
    }
}
