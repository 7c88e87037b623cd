//! The files of each frame, and the collection of them.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, io};

use emmy::body::FieldValues;
use emmy::mesh::Mesh;
use emmy::team::{self, Alone, Subdomain, Team};

use super::frame::Frame;
use super::frame_names::{self, Layout, remove_frames_where, stem};
use super::grid::Grid;
use super::pieces::Pieces;
use super::{FrameTime, Precision, escaped, name_of};
use crate::team::{agreed, on_first_rank};
use crate::whole_file::{named, replace};

/// Writes `NAME.pvd` and `frames/NAME_000000.vtu`, ...: points in the reference configuration, fields as point and cell
/// data, cell data `region`, and the groups of the mesh (`group:NAME`, `facets:NAME`).
///
/// A team writes a piece for each rank, `frames/NAME_000000/0000.vtu`, ..., and their list, `frames/NAME_000000.pvtu`.
/// Pieces have the cells that count on a rank, with their numbers in the whole mesh as point data `node` and cell data
/// `cell`, and the cell data `rank`. Then every method that changes files is a collective call; if one rank fails, all
/// fail with its error.
///
/// A frame is complete before the collection lists it. The collection is rewritten for each of the first thousand
/// frames, then less often, so that the bytes written are linear in the number of frames.
#[derive(Debug)]
pub struct FrameFiles {
    directory: PathBuf,
    name: String,
    frame: Frame,
    /// `None`: no team.
    pieces: Option<Pieces>,
    written: Vec<(FrameTime, Layout)>,
    /// Number of frames in the collection.
    listed: usize,
}

/// Comment in every collection (`.pvd`) that Emmy writes.
pub(crate) const COLLECTION_MARK: &str = "<!-- Written by Emmy -->";

/// Number of frames up to which each is listed at once. Later, the collection lags by at most one frame in this number.
const ALL_LISTED: usize = 1000;

/// Folder of the frames.
const FRAMES: &str = "frames";

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
        FrameFiles::of_grid(directory, precision, &Grid::new(mesh, Some(region_of_cell)))
    }

    /// The same of a grid.
    pub(super) fn of_grid(directory: &Path, precision: Precision, grid: &Grid<'_>) -> io::Result<Self> {
        FrameFiles::new(directory, Frame::new(precision, grid), None)
    }

    /// As [`FrameFiles::create`], of a team: each rank gives the mesh of its share and its part.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn shared(
        directory: &Path,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
        subdomain: &Arc<Subdomain>,
    ) -> io::Result<Self> {
        let pieces = Pieces::new(mesh, subdomain);
        FrameFiles::new(directory, pieces.frame(precision, mesh, region_of_cell), Some(pieces))
    }

    fn new(directory: &Path, frame: Frame, pieces: Option<Pieces>) -> io::Result<Self> {
        let team = team_of(pieces.as_ref());
        on_first_rank(team, || {
            let folder = directory.join(FRAMES);
            fs::create_dir_all(&folder).map_err(named(&folder))
        })?;
        let name = name_of(directory);
        let name = team::text_of(team, 0, &name);
        let directory = directory.to_path_buf();
        let mut frames = FrameFiles { directory, name, frame, pieces, written: Vec::new(), listed: 0 };
        frames.write_collection()?;
        Ok(frames)
    }

    /// Resumes the collection with the given frames, up to a step; all others are removed. Returns the given frames
    /// that are missing.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn resume(&mut self, kept: &[FrameTime], step: usize) -> io::Result<Vec<FrameTime>> {
        let layouts = self.layouts(kept);
        let found = || kept.iter().copied().zip(layouts.iter().copied());
        self.written = found().filter_map(|(frame, layout)| Some((frame, layout?))).collect();
        self.write_collection()?;
        let steps: BTreeSet<usize> = self.written.iter().map(|(frame, _)| frame.step).collect();
        let is_unwanted = |number: usize| number > step || !steps.contains(&number);
        on_first_rank(self.team(), || {
            remove_frames_where(&self.directory.join(FRAMES), &self.name, is_unwanted)
        })?;
        Ok(found().filter(|(_, layout)| layout.is_none()).map(|(frame, _)| frame).collect())
    }

    /// The files of some frames, as the first rank finds them; `None`: missing.
    fn layouts(&self, frames: &[FrameTime]) -> Vec<Option<Layout>> {
        let found = |frame: &FrameTime| {
            Layout::ALL.iter().position(|layout| self.path(frame.step, *layout).is_file())
        };
        let mut numbers: Vec<f64> =
            frames.iter().map(|frame| found(frame).map_or(0.0, |layout| 1.0 + layout as f64)).collect();
        if self.team().rank() != 0 {
            numbers.fill(0.0);
        }
        self.team().sum("files of frames", &mut numbers);
        numbers
            .into_iter()
            .map(|number| Layout::ALL.get((number as usize).wrapping_sub(1)).copied())
            .collect()
    }

    /// Writes the fields of a step, once.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.last_step() == Some(step) {
            return Ok(());
        }
        let layout = match &self.pieces {
            None => {
                replace(&self.path(step, Layout::File), self.frame.xml(time, fields).as_bytes())?;
                Layout::File
            }
            Some(pieces) => {
                self.write_pieces(pieces, step, time, fields)?;
                Layout::Pieces
            }
        };
        self.written.push((FrameTime { step, time }, layout));
        if is_due(self.written.len(), self.listed) { self.write_collection() } else { Ok(()) }
    }

    /// Writes the pieces of a frame, and then their list.
    fn write_pieces(
        &self,
        pieces: &Pieces,
        step: usize,
        time: f64,
        fields: &[FieldValues],
    ) -> io::Result<()> {
        let team = self.team();
        let stem = stem(&self.name, step);
        let folder = self.directory.join(FRAMES).join(&stem);
        on_first_rank(team, || fs::create_dir_all(&folder).map_err(named(&folder)))?;
        let own = || {
            let path = folder.join(frame_names::piece(pieces.subdomain.rank()));
            replace(&path, self.frame.xml(time, &pieces.fields(fields)).as_bytes())
        };
        agreed(team, if pieces.has_own() { own() } else { Ok(()) })?;
        on_first_rank(team, || {
            let sources = pieces.ranks.iter().map(|&rank| format!("{stem}/{}", frame_names::piece(rank)));
            replace(&self.path(step, Layout::Pieces), self.frame.list(fields, sources).as_bytes())
        })
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
        self.written.last().map(|(frame, _)| frame.step)
    }

    /// Path of the collection.
    pub fn collection(&self) -> PathBuf {
        self.directory.join(format!("{}.pvd", self.name))
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.written.len()
    }

    fn team(&self) -> &dyn Team {
        team_of(self.pieces.as_ref())
    }

    fn path(&self, step: usize, layout: Layout) -> PathBuf {
        self.directory.join(FRAMES).join(layout.file(&self.name, step))
    }

    /// Rewrites the whole collection, so that a killed run leaves a readable one.
    fn write_collection(&mut self) -> io::Result<()> {
        on_first_rank(self.team(), || replace(&self.collection(), self.listing().as_bytes()))?;
        self.listed = self.written.len();
        Ok(())
    }

    /// The text of the collection.
    fn listing(&self) -> String {
        let mut xml = format!("<?xml version=\"1.0\"?>\n{COLLECTION_MARK}\n");
        xml += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
        for &(FrameTime { step, time }, layout) in &self.written {
            let file = escaped(&layout.file(&self.name, step));
            let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{FRAMES}/{file}\"/>");
        }
        xml + "</Collection>\n</VTKFile>\n"
    }
}

/// Whether the collection must be rewritten.
fn is_due(n_frames: usize, listed: usize) -> bool {
    n_frames <= ALL_LISTED || (n_frames - listed) * ALL_LISTED >= n_frames
}

/// The team that writes pieces.
fn team_of(pieces: Option<&Pieces>) -> &dyn Team {
    pieces.map_or(&Alone, |pieces| &**pieces.subdomain.team())
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

    /// Rewrites of n entries: for each of the first thousand frames, then for every n/1000-th.
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
