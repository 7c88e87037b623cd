//! The program `emmy-mpi`: the verbs `run`, `resume` and `check` of `emmy` on all processes that `mpirun` starts.

use std::env;
use std::process::ExitCode;

/// Variables with the number of started processes: of Open MPI, of MPICH and others, and of Slurm.
const STARTED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"];

fn main() -> ExitCode {
    // Before MPI, which writes files of its own.
    emmy_cli::report_file_limits();
    ExitCode::from(emmy_mpi::run(|team| {
        let started = STARTED.into_iter().find_map(|name| env::var(name).ok()?.parse::<usize>().ok());
        match started.filter(|&n| n > 1 && team.size() == 1) {
            Some(n) => {
                eprintln!(
                    "emmy-mpi: {n} processes were started, but MPI does not connect them, so each would compute the whole \
                     body. Start them with the `mpirun` of the MPI that emmy-mpi was built with, or try `srun --mpi=pmix`."
                );
                2
            }
            None => emmy_cli::exit_code_on_team(env::args_os(), team),
        }
    }))
}
