//! The files of a run in its directory: which they are, and their removal.

use std::io;
use std::path::Path;

use super::lock;
use crate::report::pictures;
use crate::vtk::{self, COLLECTION_MARK};
use crate::whole_file::{self, names, remove};
use crate::{checkpoint, vtk::is_series};

/// First words of every `input.toml` that Emmy writes.
pub const MARK: &str = "# Written by Emmy";

/// Files that a run writes besides its input and its frames.
pub const FILES: [&str; 7] =
    ["history.csv", "columns.json", "newton.csv", "events.csv", "run.log", "summary.json", "report.html"];

/// Endings of unfinished files, which a killed run may leave.
const UNFINISHED: [&str; 9] = [
    ".vtkhdf.part",
    ".vtkhdf.copy",
    ".vtkhdf.journal",
    ".pvd.part",
    "history.csv.part",
    "columns.json.part",
    "summary.json.part",
    "input.toml.part",
    "report.html.part",
];

/// Files of a run that was killed before it could write its `input.toml`.
pub(super) const BEGINNINGS: [&str; 2] = [lock::FILE, "input.toml.part"];

/// Whether a directory holds a run of Emmy.
pub(super) fn is_run(path: &Path) -> bool {
    whole_file::read_text(&path.join("input.toml")).is_ok_and(|text| text.starts_with(MARK))
}

/// Removes the files of a run.
pub(super) fn remove_run(path: &Path) -> io::Result<()> {
    // Checkpoints first: if the removal is interrupted, the rest cannot be resumed.
    checkpoint::remove_all(&path.join(checkpoint::DIRECTORY))?;
    for name in FILES {
        remove(&path.join(name))?;
    }
    remove_frames(path)
}

/// Removes the frames of all collections, the series, and unfinished files; and the pictures, which show frames.
pub(crate) fn remove_frames(path: &Path) -> io::Result<()> {
    remove_pictures(path)?;
    for name in collections(path)? {
        vtk::remove_frames(&path.join("frames"), &name)?;
        remove(&path.join(format!("{name}.pvd")))?;
    }
    for name in names(path)?.into_iter().filter(|name| is_removed(path, name)) {
        remove(&path.join(&name))?;
    }
    Ok(())
}

/// Removes the pictures of a run or of natural modes.
pub(crate) fn remove_pictures(path: &Path) -> io::Result<()> {
    pictures::remove_all(&path.join(pictures::DIRECTORY))
}

/// Names of the collections of frames in a directory.
pub(super) fn collections(path: &Path) -> io::Result<Vec<String>> {
    let names = names(path)?.into_iter().filter_map(|name| Some(name.strip_suffix(".pvd")?.to_string()));
    Ok(names.filter(|name| is_collection(&path.join(format!("{name}.pvd")))).collect())
}

fn is_collection(path: &Path) -> bool {
    whole_file::read_text(path).is_ok_and(|text| text.contains(COLLECTION_MARK))
}

/// Whether the next run removes a file whose name depends on the run: a collection, a series, or an unfinished file.
pub(super) fn is_removed(path: &Path, name: &str) -> bool {
    let file = path.join(name);
    is_unfinished(name)
        || name.ends_with(".pvd") && is_collection(&file)
        || name.ends_with(".vtkhdf") && is_series(&file)
}

fn is_unfinished(name: &str) -> bool {
    UNFINISHED.iter().any(|ending| name.ends_with(ending))
}

/// Removes the unfinished files of a killed run, except the files of a series of frames that will be continued.
pub(crate) fn remove_unfinished(path: &Path, has_series: bool) -> io::Result<()> {
    let is_of_series = |name: &str| name.ends_with(".vtkhdf.part") || name.ends_with(".vtkhdf.journal");
    for name in names(path)? {
        if is_unfinished(&name) && !(has_series && is_of_series(&name)) {
            remove(&path.join(&name))?;
        }
    }
    Ok(())
}
