//! `report.html`: one run, several side by side, natural modes, spectra or responses, as a page that opens from disk
//! and loads nothing.
//!
//! Everything comes from the directory of the run: `history.csv`, `newton.csv`, `events.csv`, `summary.json`,
//! `input.toml` and the frames. The page is replaced as a whole, also during a run.
//!
//! | module | task |
//! |---|---|
//! | `run` | gathers a directory: a manifest in JSON, numbers in packed arrays |
//! | `history` | histories, reduced to a limited number of rows |
//! | `thinning` | chooses the rows of a long history, with every peak |
//! | `modes`, `curves` | natural modes, or charts over the frequency, in place of a run |
//! | `loads` | time intervals in which loads act |
//! | `events` | `events.csv` |
//! | `collection`, `frames` | frames, and the selection of frames |
//! | `fields` | the quantities for colouring |
//! | `surface`, `coarse` | the visible surface of a mesh, coarsened if it is too large |
//! | `pack` | typed arrays, compressed, as base64 |
//! | `page` | the template |
//! | `pictures` | pictures of the extremes, in files of their own |
//!
//! Sizes are bounded ([`MAX_ROWS`], [`MAX_FRAME_BYTES`], [`MAX_NODES`]), so that a page has at most a few MB.

mod coarse;
mod collection;
mod curves;
mod events;
mod fields;
mod frames;
mod history;
mod loads;
mod modes;
mod pack;
mod page;
pub(crate) mod pictures;
mod run;
mod surface;
mod thinning;

use std::io;
use std::path::{Path, PathBuf};

use crate::comparison::{self, Run, RunError};
use crate::differences::Differences;
use crate::directory::MARK;
use crate::link::relative;
use crate::mesh::MeshError;
use crate::whole_file::{self, replace};
use crate::{response, spectra};
pub(crate) use curves::Curves;
pub use pictures::Pictures;
use run::{RunData, RunLink};

/// Largest number of rows in a page; longer histories keep the rows with the extremes of every column.
pub const MAX_ROWS: usize = 12_000;

/// Largest number of bytes of all frames before compression; with more frames, equally spaced ones are kept.
pub const MAX_FRAME_BYTES: usize = 5_000_000;

/// Rows of each run, even if many share the page.
const MIN_ROWS: usize = 2_000;

/// Largest number of nodes of a surface; a larger one is coarsened.
pub const MAX_NODES: usize = 20_000;

/// Name of the page.
pub const PAGE: &str = "report.html";

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// History or summary of the run cannot be used.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A frame cannot be used.
    #[error(transparent)]
    Frame(#[from] MeshError),
    /// A directory without a run of Emmy.
    #[error("{path} holds no run of Emmy: its input.toml is not there or not written by Emmy")]
    NoRun {
        /// The directory.
        path: PathBuf,
    },
    /// A directory of another verb, which writes its page.
    #[error("{path} was written by `{verb}`, which writes its own {PAGE}")]
    OfAnotherVerb {
        /// The directory.
        path: PathBuf,
        /// The command.
        verb: &'static str,
    },
    /// There is nothing of which pictures could be drawn.
    #[error("no pictures of {path} can be drawn: {cause}")]
    NoPictures {
        /// The directory.
        path: PathBuf,
        /// The missing part.
        cause: &'static str,
        /// A way to get pictures.
        remedy: &'static str,
    },
    /// A page or a picture cannot be written; the error has its path.
    #[error(transparent)]
    Page(io::Error),
    /// An error of the system.
    #[error("{path}: {error}")]
    System {
        /// The file.
        path: PathBuf,
        /// The message of the system.
        #[source]
        error: io::Error,
    },
}

/// Writes `report.html` into the directory of a run or of natural modes, and returns its path.
///
/// # Errors
/// [`ReportError`]; an earlier report is then unchanged.
pub fn write(directory: &Path) -> Result<PathBuf, ReportError> {
    if modes::are_in(directory) {
        return written(directory, &[modes::gather(directory)?], None);
    }
    check(directory)?;
    let run = RunData::gather(directory, RunLink::default(), Room::shared_by(1))?;
    written(directory, &[run], None)
}

/// Checks that a directory holds a run.
fn check(directory: &Path) -> Result<(), ReportError> {
    let input = whole_file::read_text(&directory.join("input.toml")).unwrap_or_default();
    if directory.is_dir() && !input.starts_with(MARK) {
        let path = directory.to_path_buf();
        let of = [(response::TABLE, "emmy response"), (spectra::TABLE, "emmy spectrum")];
        let verb = of.iter().find(|(table, _)| directory.join(table).is_file());
        return Err(match verb {
            Some((_, verb)) => ReportError::OfAnotherVerb { path, verb },
            None => ReportError::NoRun { path },
        });
    }
    Ok(comparison::check(directory)?)
}

/// Writes `report.html` of several runs into a directory, and returns its path. `directories`: those of the runs.
///
/// # Errors
/// [`ReportError`].
pub fn write_comparison(
    directory: &Path,
    runs: &[Run],
    directories: &[PathBuf],
    differences: &Differences,
) -> Result<PathBuf, ReportError> {
    let room = Room::shared_by(runs.len());
    let gather = |(run, own): (&Run, &PathBuf)| {
        let link = RunLink { name: Some(run.name.clone()), href: relative(directory, own) };
        RunData::gather(own, link, room)
    };
    let gathered = runs.iter().zip(directories).map(gather).collect::<Result<Vec<_>, _>>()?;
    written(directory, &gathered, Some(differences))
}

/// Writes `report.html` of charts over the frequency into a directory.
pub(crate) fn write_curves(directory: &Path, curves: &Curves<'_>) -> io::Result<()> {
    replace(&directory.join(PAGE), page::page(&[curves::gather(directory, curves)], None).as_bytes())
}

/// The share of a run in a page.
#[derive(Debug, Clone, Copy)]
struct Room {
    /// Rows of the history.
    rows: usize,
    /// Bytes of the frames.
    frame_bytes: usize,
}

impl Room {
    fn shared_by(n_runs: usize) -> Room {
        let n = n_runs.max(1);
        Room { rows: (MAX_ROWS / n).max(MIN_ROWS), frame_bytes: MAX_FRAME_BYTES / n }
    }
}

fn written(
    directory: &Path,
    runs: &[RunData],
    differences: Option<&Differences>,
) -> Result<PathBuf, ReportError> {
    let path = directory.join(PAGE);
    let page = page::page(runs, differences);
    replace(&path, page.as_bytes()).map_err(ReportError::Page)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_without_a_run_is_told() {
        let temp = tempfile::tempdir().unwrap();
        std::fs::write(temp.path().join("input.toml"), "title = 1").unwrap();
        assert!(matches!(write(temp.path()), Err(ReportError::NoRun { .. })));
        std::fs::write(temp.path().join("spectrum.csv"), "").unwrap();
        assert!(write(temp.path()).unwrap_err().to_string().contains("was written by `emmy spectrum`"));
        let missing = write(&temp.path().join("nothing")).unwrap_err().to_string();
        assert!(missing.contains("not a directory"), "{missing}");
    }
}
