//! The program `emmy`.

use std::process::ExitCode;

fn main() -> ExitCode {
    emmy_cli::main(std::env::args_os())
}
