//! `report.html`: a run, or several side by side, as one page that opens from disk and loads nothing.
//!
//! Everything comes from the directory of the run: `history.csv`, `newton.csv`, `events.csv`, `summary.json`, `input.toml`
//! and the frames of its collection. The page is written whole or not at all, also of a run that is going on.
//!
//! | module | what it does |
//! |---|---|
//! | `run` | gathers a directory: small things as JSON, numbers as packed arrays |
//! | `history` | histories, and what is kept of them |
//! | `thinning` | chooses rows of a long history, so that every peak stays |
//! | `loads` | when loads act |
//! | `events` | `events.csv` |
//! | `collection`, `frames` | frames, in one file each or all in one, and what is kept of them |
//! | `surface`, `coarse` | what is seen of a mesh, and less of it where it is too much |
//! | `pack` | typed arrays, compressed, as text |
//! | `page` | the template and its parts |
//!
//! Sizes are bounded ([`MAX_ROWS`], [`MAX_FRAME_BYTES`], [`MAX_NODES`]): whatever the run, the page stays within a few MB.

mod coarse;
mod collection;
mod events;
mod frames;
mod history;
mod loads;
mod pack;
mod page;
mod run;
mod surface;
mod thinning;

use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use crate::comparison::RunError;
use crate::directory::MARK;
use crate::mesh::MeshError;
use crate::whole_file::replace;
use run::{Place, RunData};

/// Rows of histories that a page has at most; of longer ones those with the extremes of every column are kept.
pub const MAX_ROWS: usize = 12_000;

/// Bytes of all frames of a page before compression, at most; of more frames some are kept, at equal distances.
pub const MAX_FRAME_BYTES: usize = 5_000_000;

/// Rows that a run keeps in any case, however many share the page.
const FEWEST_ROWS: usize = 2_000;

/// Nodes of a surface at most; a larger one is made coarser.
pub const MAX_NODES: usize = 20_000;

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// History or summary of the run cannot be used.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A frame cannot be used.
    #[error(transparent)]
    Frame(#[from] MeshError),
    /// A directory with files, but not of a run.
    #[error("{path} holds no run of Emmy: its input.toml is not there or not written by Emmy")]
    NoRun {
        /// The directory.
        path: PathBuf,
    },
    /// The system refused.
    #[error("{path}: {error}")]
    System {
        /// The file.
        path: PathBuf,
        /// What the system says.
        #[source]
        error: io::Error,
    },
}

/// Writes `report.html` into the directory of a run; its path.
///
/// # Errors
/// [`ReportError`]; then a report that was there is as it was.
pub fn write(directory: &Path) -> Result<PathBuf, ReportError> {
    let input = fs::read_to_string(directory.join("input.toml")).unwrap_or_default();
    if directory.is_dir() && !input.starts_with(MARK) {
        return Err(ReportError::NoRun { path: directory.to_path_buf() });
    }
    let run = RunData::gather(directory, Place::default(), Room::shared_by(1))?;
    written(directory, &[run])
}

/// Writes `report.html` of several runs into a directory; its path. `runs`: their names and directories.
///
/// # Errors
/// [`ReportError`].
pub fn write_comparison(directory: &Path, runs: &[(String, PathBuf)]) -> Result<PathBuf, ReportError> {
    let room = Room::shared_by(runs.len());
    let gather = |(name, run): &(String, PathBuf)| {
        let place = Place { name: Some(name.clone()), href: relative(directory, run) };
        RunData::gather(run, place, room)
    };
    let runs = runs.iter().map(gather).collect::<Result<Vec<_>, _>>()?;
    written(directory, &runs)
}

/// What a run may take of a page.
#[derive(Debug, Clone, Copy)]
struct Room {
    /// Rows of its history.
    rows: usize,
    /// Bytes of its frames.
    frame_bytes: usize,
}

impl Room {
    fn shared_by(n_runs: usize) -> Room {
        let n = n_runs.max(1);
        Room { rows: (MAX_ROWS / n).max(FEWEST_ROWS), frame_bytes: MAX_FRAME_BYTES / n }
    }
}

fn written(directory: &Path, runs: &[RunData]) -> Result<PathBuf, ReportError> {
    let path = directory.join("report.html");
    let page = page::page(runs);
    replace(&path, page.as_bytes()).map_err(|error| ReportError::System { path: path.clone(), error })?;
    Ok(path)
}

/// The way from a directory to another one as a link, with a slash behind; an absolute one where there is no other.
pub(crate) fn relative(from: &Path, to: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| absolute(path));
    let (from, to) = (whole(from), whole(to));
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        let parts = to.iter().map(|part| part.as_os_str().to_string_lossy()).filter(|part| part != "/");
        return parts.fold("file://".to_string(), |link, part| link + "/" + &part) + "/";
    }
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy());
    let up = from[common..].iter().map(|_| "..".into());
    up.chain(down).fold(String::new(), |link, part: std::borrow::Cow<'_, str>| link + &part + "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_from_one_directory_to_another() {
        let link = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
        assert_eq!(link("/no/such/compare", "/no/such/run"), "../run/");
        assert_eq!(link("/no/such", "/no/such/a b/c"), "a b/c/");
        assert_eq!(link("/no/such/run", "/no/such/run"), "");
    }

    #[test]
    fn a_directory_without_a_run_is_told() {
        let temp = tempfile::tempdir().unwrap();
        fs::write(temp.path().join("input.toml"), "title = 1").unwrap();
        assert!(matches!(write(temp.path()), Err(ReportError::NoRun { .. })));
        let missing = write(&temp.path().join("nothing")).unwrap_err().to_string();
        assert!(missing.contains("not a directory"), "{missing}");
    }
}
