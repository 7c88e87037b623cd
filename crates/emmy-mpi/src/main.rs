//! The program `emmy-mpi`: the verbs `run`, `resume` and `check` of `emmy` on all processes that `mpirun` starts.

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(emmy_mpi::run(|team| emmy_cli::exit_code_on_team(env::args_os(), team)))
}
