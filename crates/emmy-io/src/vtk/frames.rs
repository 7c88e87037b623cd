//! One `.vtu` for each frame, and the collection of them.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

use emmy::body::fields::FieldValues;
use emmy::mesh::Mesh;

use super::frame::Frame;
use super::{Precision, escaped, name_of};
use crate::directory::{COLLECTION_MARK, remove_frames_where, replace};

/// Writes `NAME.pvd` and `frames/NAME_000000.vtu`, ...: points in the reference configuration, fields as point and cell data, cell
/// data `region`, and the groups of the mesh (`group:NAME`, `facets:NAME`).
///
/// A frame is there, whole, before the collection lists it. The collection is written anew for each of the first thousand
/// frames, then as often as makes its bytes linear in their number.
#[derive(Debug)]
pub struct Frames {
    directory: PathBuf,
    name: String,
    frame: Frame,
    times: Vec<(usize, f64)>,
    /// Frames that the collection lists.
    listed: usize,
}

/// Frames that are listed one by one; the collection of more lags behind by up to one in as many of them.
const ALL_LISTED: usize = 1000;

impl Frames {
    /// Frames in a directory, called by its name; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(
        directory: &Path,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        fs::create_dir_all(directory.join("frames"))?;
        let (name, frame) = (name_of(directory), Frame::new(precision, mesh, region_of_cell));
        let mut frames =
            Frames { directory: directory.to_path_buf(), name, frame, times: Vec::new(), listed: 0 };
        frames.write_collection()?;
        Ok(frames)
    }

    /// Resumes the collection with some of the frames, steps and times, up to a step; the others are removed. Returns those that
    /// are not there.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(&mut self, kept: &[(usize, f64)], step: usize) -> io::Result<Vec<(usize, f64)>> {
        let is_there = |(own, _): &(usize, f64)| self.directory.join(self.file(*own)).is_file();
        let (there, lost): (Vec<_>, Vec<_>) = kept.iter().copied().partition(|frame| is_there(frame));
        self.times = there;
        self.write_collection()?;
        let steps: BTreeSet<usize> = self.times.iter().map(|(own, _)| *own).collect();
        let is_unwanted = |number: usize| number > step || !steps.contains(&number);
        remove_frames_where(&self.directory.join("frames"), &self.name, is_unwanted)?;
        Ok(lost)
    }

    /// Writes the fields of a step, unless it has been written.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.last_step() == Some(step) {
            return Ok(());
        }
        let path = self.directory.join(self.file(step));
        replace(&path, self.frame.xml(time, fields).as_bytes())?;
        self.times.push((step, time));
        if is_due(self.times.len(), self.listed) { self.write_collection() } else { Ok(()) }
    }

    /// Lists what is not listed yet.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(&mut self) -> io::Result<()> {
        if self.listed < self.times.len() { self.write_collection() } else { Ok(()) }
    }

    /// Number of the last step that was written.
    pub fn last_step(&self) -> Option<usize> {
        self.times.last().map(|&(step, _)| step)
    }

    /// Path of the collection.
    pub fn collection(&self) -> PathBuf {
        self.directory.join(format!("{}.pvd", self.name))
    }

    /// Number of frames that were written.
    pub fn n_frames(&self) -> usize {
        self.times.len()
    }

    fn file(&self, step: usize) -> String {
        format!("frames/{}_{step:06}.vtu", self.name)
    }

    /// The whole collection anew, so that a run that is killed leaves a readable one.
    fn write_collection(&mut self) -> io::Result<()> {
        let mut xml = format!("<?xml version=\"1.0\"?>\n{COLLECTION_MARK}\n");
        xml += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
        for &(step, time) in &self.times {
            let file = escaped(&self.file(step));
            let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>");
        }
        xml += "</Collection>\n</VTKFile>\n";
        replace(&self.collection(), xml.as_bytes())?;
        self.listed = self.times.len();
        Ok(())
    }
}

/// Whether a collection of some of the frames is to be written anew.
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
        let mut frames = Frames::create(&directory, Precision::Double, &mesh, &[0]).unwrap();
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
        // 1000^2/2 of the first thousand, about 1000 for each of the others, where each time would make 5e9.
        assert!(entries < 101_000_000, "{entries}");
    }
}
