//! Frames for ParaView and PyVista: one `.vtu` each, collected with their times in a `.pvd`.

mod array;
mod frame;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

use emmy::mesh::{CellKind, Mesh};
use emmy::motion::State;

use crate::directory::{COLLECTION_MARK, replace};
use frame::Frame;

/// Array of a group of cells (cell data) or nodes (point data), 1 for its members: `group:NAME`.
pub(crate) const GROUP: &str = "group:";

/// Array of a group of facets, as cell data: bit i of a cell's number stands for its face i. `facets:NAME`.
pub(crate) const FACETS: &str = "facets:";

/// Number of a cell type in VTK. The wedges' base is seen counter-clockwise from the top, as in VTK's tables of faces.
pub(crate) fn cell_type(kind: CellKind) -> u8 {
    match kind {
        CellKind::Hex8 => 12,
        CellKind::Hex20 => 25,
        CellKind::Hex27 => 29,
        CellKind::Tet4 => 10,
        CellKind::Tet10 => 24,
        CellKind::Wedge6 => 13,
        CellKind::Wedge15 => 26,
        CellKind::Pyramid5 => 14,
        CellKind::Tri3 => 5,
        CellKind::Tri6 => 22,
        CellKind::Quad4 => 9,
        CellKind::Quad8 => 23,
        CellKind::Quad9 => 28,
        CellKind::Line2 => 3,
    }
}

/// Writes `NAME.pvd` and `frames/NAME_000000.vtu`, ...: points in the reference configuration, point data
/// `displacement` and `velocity`, cell data `region`, and the groups of the mesh (`group:NAME`, `facets:NAME`).
#[derive(Debug)]
pub struct Frames {
    directory: PathBuf,
    name: String,
    frame: Frame,
    times: Vec<(usize, f64)>,
}

impl Frames {
    /// Frames in a directory, called by its name; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(directory: &Path, mesh: &Mesh, region_of_cell: &[u32]) -> io::Result<Self> {
        fs::create_dir_all(directory.join("frames"))?;
        let name = name_of(directory);
        let frame = Frame::new(mesh, region_of_cell);
        let frames = Frames { directory: directory.to_path_buf(), name, frame, times: Vec::new() };
        frames.write_collection()?;
        Ok(frames)
    }

    /// Writes a state, unless its step has been written.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, state: &State) -> io::Result<()> {
        if self.times.last().is_some_and(|&(step, _)| step == state.step) {
            return Ok(());
        }
        let path = self.directory.join(self.file(state.step));
        replace(&path, self.frame.xml(state).as_bytes())?;
        self.times.push((state.step, state.time));
        self.write_collection()
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
    fn write_collection(&self) -> io::Result<()> {
        let mut xml = format!("<?xml version=\"1.0\"?>\n{COLLECTION_MARK}\n");
        xml += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
        for &(step, time) in &self.times {
            let file = escaped(&self.file(step));
            let _ = writeln!(xml, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>");
        }
        xml += "</Collection>\n</VTKFile>\n";
        replace(&self.collection(), xml.as_bytes())
    }
}

/// Last part of a path, also of `.` and `..`.
fn name_of(directory: &Path) -> String {
    let whole = directory.canonicalize().unwrap_or_else(|_| directory.to_path_buf());
    whole.file_name().map_or("emmy".into(), |name| name.to_string_lossy().into_owned())
}

/// Text as the value of an XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collections_list_the_frames_that_are_there() {
        let temp = tempfile::tempdir().unwrap();
        let directory = temp.path().join("a & b");
        let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
        let mut frames = Frames::create(&directory, &mesh, &[0]).unwrap();
        let mut state = State {
            time: 0.0,
            step: 0,
            displacement: vec![0.0; 24],
            momentum: vec![0.0; 24],
            velocity: vec![0.0; 24],
        };
        frames.write(&state).unwrap();
        (state.step, state.time) = (20, 0.1);
        frames.write(&state).unwrap();
        frames.write(&state).unwrap();
        let text = fs::read_to_string(directory.join("a & b.pvd")).unwrap();
        assert_eq!(text.matches("<DataSet").count(), 2);
        assert!(text.contains("timestep=\"0.1\" part=\"0\" file=\"frames/a &amp; b_000020.vtu\""), "{text}");
        assert!(directory.join("frames/a & b_000020.vtu").is_file());
        assert_eq!(fs::read_dir(directory.join("frames")).unwrap().count(), 2);
    }
}
