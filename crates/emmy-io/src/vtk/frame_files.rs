//! One `.vtu` for each frame, and the collection of them.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

use emmy::body::FieldValues;
use emmy::mesh::Mesh;

use super::frame::Frame;
use super::{FrameTime, Precision, escaped, name_of};
use crate::whole_file::{PART, names, remove, replace};

/// Writes `NAME.pvd` and `frames/NAME_000000.vtu`, ...: points in the reference configuration, fields as point and cell
/// data, cell data `region`, and the groups of the mesh (`group:NAME`, `facets:NAME`).
///
/// A frame is complete before the collection lists it. The collection is rewritten for each of the first thousand
/// frames, then less often, so that the bytes written are linear in the number of frames.
#[derive(Debug)]
pub struct FrameFiles {
    directory: PathBuf,
    name: String,
    frame: Frame,
    written: Vec<FrameTime>,
    /// Number of frames in the collection.
    listed: usize,
}

/// Comment in every collection (`.pvd`) that Emmy writes.
pub(crate) const COLLECTION_MARK: &str = "<!-- Written by Emmy -->";

/// Up to this number of frames, each is listed at once; after that the collection may lag by one frame in as many.
const ALL_LISTED: usize = 1000;

impl FrameFiles {
    /// Frames in a directory, named after it; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn create(
        directory: &Path,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        fs::create_dir_all(directory.join("frames"))?;
        let name = name_of(directory);
        let frame = Frame::new(precision, mesh, region_of_cell);
        let mut frames =
            FrameFiles { directory: directory.to_path_buf(), name, frame, written: Vec::new(), listed: 0 };
        frames.write_collection()?;
        Ok(frames)
    }

    /// Resumes the collection with the given frames, up to a step; all others are removed. Returns the given frames
    /// that are missing.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn resume(&mut self, kept: &[FrameTime], step: usize) -> io::Result<Vec<FrameTime>> {
        let is_there = |frame: &FrameTime| self.directory.join(self.file(frame.step)).is_file();
        let (there, missing): (Vec<_>, Vec<_>) = kept.iter().copied().partition(is_there);
        self.written = there;
        self.write_collection()?;
        let steps: BTreeSet<usize> = self.written.iter().map(|frame| frame.step).collect();
        let is_unwanted = |number: usize| number > step || !steps.contains(&number);
        remove_frames_where(&self.directory.join("frames"), &self.name, is_unwanted)?;
        Ok(missing)
    }

    /// Writes the fields of a step, once.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.last_step() == Some(step) {
            return Ok(());
        }
        let path = self.directory.join(self.file(step));
        replace(&path, self.frame.xml(time, fields).as_bytes())?;
        self.written.push(FrameTime { step, time });
        if is_due(self.written.len(), self.listed) { self.write_collection() } else { Ok(()) }
    }

    /// Completes the collection.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn finish(&mut self) -> io::Result<()> {
        if self.listed < self.written.len() { self.write_collection() } else { Ok(()) }
    }

    /// Number of the last step.
    pub fn last_step(&self) -> Option<usize> {
        self.written.last().map(|frame| frame.step)
    }

    /// Path of the collection.
    pub fn collection(&self) -> PathBuf {
        self.directory.join(format!("{}.pvd", self.name))
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.written.len()
    }

    fn file(&self, step: usize) -> String {
        format!("frames/{}_{step:06}.vtu", self.name)
    }

    /// Rewrites the whole collection, so that a killed run leaves a readable one.
    fn write_collection(&mut self) -> io::Result<()> {
        let mut xml = format!("<?xml version=\"1.0\"?>\n{COLLECTION_MARK}\n");
        xml += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
        for &FrameTime { step, time } in &self.written {
            let file = escaped(&self.file(step));
            let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>");
        }
        xml += "</Collection>\n</VTKFile>\n";
        replace(&self.collection(), xml.as_bytes())?;
        self.listed = self.written.len();
        Ok(())
    }
}

/// Removes `frames/NAME_000000.vtu` and so on, and the directory if it is then empty.
pub(crate) fn remove_frames(frames: &Path, name: &str) -> io::Result<()> {
    if !frames.is_dir() {
        return Ok(());
    }
    remove_frames_where(frames, name, |_| true)?;
    if names(frames)?.is_empty() { fs::remove_dir(frames) } else { Ok(()) }
}

/// Removes the frames of some steps, and unfinished ones.
fn remove_frames_where(frames: &Path, name: &str, is_unwanted: impl Fn(usize) -> bool) -> io::Result<()> {
    for file in names(frames)? {
        if step_of_frame(&file, name).is_some_and(|step| file.ends_with(PART) || is_unwanted(step)) {
            remove(&frames.join(file))?;
        }
    }
    Ok(())
}

/// The step of a frame, finished or not, from the name of its file.
pub(crate) fn step_of_frame(file: &str, name: &str) -> Option<usize> {
    let whole = file.strip_suffix(PART).unwrap_or(file);
    let number = whole.strip_prefix(name)?.strip_prefix('_')?.strip_suffix(".vtu")?;
    let is_number = number.len() >= 6 && number.bytes().all(|byte| byte.is_ascii_digit());
    number.parse().ok().filter(|_| is_number)
}

/// Whether the collection must be rewritten.
fn is_due(n_frames: usize, listed: usize) -> bool {
    n_frames <= ALL_LISTED || (n_frames - listed) * ALL_LISTED >= n_frames
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collections_list_the_frames_that_are_there() {
        let temp = tempfile::tempdir().unwrap();
        let directory = temp.path().join("a & b");
        let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
        let mut frames = FrameFiles::create(&directory, Precision::Double, &mesh, &[0]).unwrap();
        frames.write(0, 0.0, &[]).unwrap();
        frames.write(20, 0.1, &[]).unwrap();
        frames.write(20, 0.1, &[]).unwrap();
        let text = fs::read_to_string(directory.join("a & b.pvd")).unwrap();
        assert_eq!(text.matches("<DataSet").count(), 2);
        assert!(text.contains("timestep=\"0.1\" part=\"0\" file=\"frames/a &amp; b_000020.vtu\""), "{text}");
        assert!(directory.join("frames/a & b_000020.vtu").is_file());
        assert_eq!(fs::read_dir(directory.join("frames")).unwrap().count(), 2);
    }

    /// Writing n entries at the listed ones only: each of the first thousand frames, then every n/1000-th.
    #[test]
    fn entries_that_are_written_grow_linearly() {
        let (mut listed, mut entries) = (0, 0);
        for n in 1..=100_000 {
            if is_due(n, listed) {
                (listed, entries) = (n, entries + n);
            }
            assert!(n - listed <= n / ALL_LISTED);
        }
        // 1000^2/2 for the first thousand, about 1000 for each of the others; rewriting for every frame would need 5e9.
        assert!(entries < 101_000_000, "{entries}");
    }
}
