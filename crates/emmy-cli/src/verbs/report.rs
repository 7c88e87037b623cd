//! `emmy report DIR`: writes the report of a run again, with `--pictures` also pictures of its extremes.

use std::path::PathBuf;

use clap::Args;
use emmy_io::report::{self, Pictures, ReportError};

use crate::failure::Failure;
use crate::host::Host;
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directory of a run, which may still be running
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Also write pictures for a document into DIR/pictures: of each field its extreme, of natural modes each mode
    #[arg(long)]
    pictures: bool,
}

/// Writes the page, and the pictures if they are wanted, and prints their paths.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    // If there is nothing to draw, nothing is written.
    let pictures = arguments.pictures.then(|| Pictures::find(&arguments.directory)).transpose()?;
    let mut paths = vec![report::write(&arguments.directory)?];
    if let Some(pictures) = pictures {
        paths.extend(pictures.write()?);
    }
    let lines: String = paths.iter().map(|path| format!("{}\n", path.display())).collect();
    print::result(host, &lines)
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::System { .. } => Failure::Other(format!("the report cannot be written: {error}")),
            ReportError::NoPictures { remedy, .. } => {
                Failure::Files { message: error.to_string(), help: Some(remedy.to_string()) }
            }
            error => Failure::Files { message: error.to_string(), help: None },
        }
    }
}
