//! Names of the frames in the folder `frames`, and their removal.

use std::path::Path;
use std::{fs, io};

use crate::whole_file::{PART, names, remove};

/// The files of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// `NAME_000020.vtu`.
    File,
    /// A piece for each rank of a team, `NAME_000020/0003.vtu`, and their list, `NAME_000020.pvtu`.
    Pieces,
}

impl Layout {
    pub(super) const ALL: [Layout; 2] = [Layout::File, Layout::Pieces];

    const fn ending(self) -> &'static str {
        match self {
            Layout::File => ".vtu",
            Layout::Pieces => ".pvtu",
        }
    }

    /// The file that a collection lists.
    pub(super) fn file(self, name: &str, step: usize) -> String {
        format!("{}{}", stem(name, step), self.ending())
    }
}

/// Name of a frame without an ending, which is also the folder of its pieces.
pub(super) fn stem(name: &str, step: usize) -> String {
    format!("{name}_{step:06}")
}

/// Name of the piece of a rank.
pub(super) fn piece(rank: usize) -> String {
    format!("{rank:04}{}", Layout::File.ending())
}

/// Removes the frames of a name, and the directory if it is then empty.
pub(crate) fn remove_frames(frames: &Path, name: &str) -> io::Result<()> {
    if !frames.is_dir() {
        return Ok(());
    }
    remove_frames_where(frames, name, |_| true)?;
    remove_if_empty(frames)
}

/// Removes the frames of some steps, and unfinished ones.
pub(super) fn remove_frames_where(
    frames: &Path,
    name: &str,
    is_unwanted: impl Fn(usize) -> bool,
) -> io::Result<()> {
    let all = names(frames)?;
    for file in &all {
        if step_of_file(file, name).is_some_and(|step| file.ends_with(PART) || is_unwanted(step)) {
            remove(&frames.join(file))?;
        }
    }
    // A list is written after its pieces and removed before them.
    let has_list = |folder: &str| frames.join(format!("{folder}{}", Layout::Pieces.ending())).exists();
    for folder in all.iter().filter(|folder| step_of(folder, name).is_some() && !has_list(folder)) {
        remove_pieces(&frames.join(folder))?;
    }
    Ok(())
}

/// Removes the pieces in a folder, and the folder if it is then empty.
fn remove_pieces(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for file in names(folder)?.iter().filter(|file| is_piece(file)) {
        remove(&folder.join(file))?;
    }
    remove_if_empty(folder)
}

fn remove_if_empty(folder: &Path) -> io::Result<()> {
    if names(folder)?.is_empty() { fs::remove_dir(folder) } else { Ok(()) }
}

/// Whether a path in the folder `frames` is a file of a frame of a name, finished or not.
pub(crate) fn is_of_frame(path: &[&str], name: &str) -> bool {
    match path {
        [file] => step_of_file(file, name).is_some(),
        [folder, file] => step_of(folder, name).is_some() && is_piece(file),
        _ => false,
    }
}

/// The step of a frame from the name of its file or list, finished or not.
fn step_of_file(file: &str, name: &str) -> Option<usize> {
    let whole = file.strip_suffix(PART).unwrap_or(file);
    step_of(Layout::ALL.iter().find_map(|layout| whole.strip_suffix(layout.ending()))?, name)
}

/// The step of a frame from its name without an ending.
fn step_of(stem: &str, name: &str) -> Option<usize> {
    let number = stem.strip_prefix(name)?.strip_prefix('_')?;
    number.parse().ok().filter(|_| is_number(number, 6))
}

fn is_piece(file: &str) -> bool {
    let number = file.strip_suffix(PART).unwrap_or(file).strip_suffix(Layout::File.ending());
    number.is_some_and(|number| is_number(number, 4))
}

fn is_number(text: &str, digits: usize) -> bool {
    text.len() >= digits && text.bytes().all(|byte| byte.is_ascii_digit())
}
