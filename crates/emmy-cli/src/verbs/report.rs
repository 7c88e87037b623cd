//! `emmy report DIR`: writes the report of a run again.

use std::path::PathBuf;

use clap::Args;
use emmy_io::report::{self, ReportError};

use crate::failure::Failure;
use crate::host::Host;
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directory of a run, which may still be running
    #[arg(value_name = "DIR")]
    directory: PathBuf,
}

/// Writes the page and prints its path.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let path = report::write(&arguments.directory)?;
    print::result(host, &format!("{}\n", path.display()))
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::System { .. } => Failure::Other(format!("the report cannot be written: {error}")),
            error => Failure::Files { message: error.to_string(), help: None },
        }
    }
}
