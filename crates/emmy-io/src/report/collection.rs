//! The frames of a run: files that its collection (`.pvd`) lists, or a series in one file (`.vtkhdf`).

use std::fs;
use std::path::{Path, PathBuf};

use emmy::body::{FieldName, Place};
use roxmltree::Document;

use super::ReportError;
use crate::mesh::{MeshError, vtu};
use crate::vtk::{COLLECTION_MARK, SeriesReader, is_series};
use crate::whole_file;

/// The frames of a run, read one by one.
#[derive(Debug)]
pub(super) enum FrameSource {
    /// One file, or several pieces, for each frame.
    Files(Vec<Listed>),
    /// One file for all frames, with the step of each frame.
    Series(SeriesReader, Vec<u32>),
}

impl FrameSource {
    /// The frames in a directory, with the name of their file. A collection takes precedence over a series.
    pub(super) fn find(directory: &Path) -> Option<(String, FrameSource)> {
        let files = collection(directory).map(|(name, listed)| (name, FrameSource::Files(listed)));
        files.or_else(|| series(directory))
    }

    /// Times of frames whose steps are unknown.
    pub(super) fn times(&self) -> &[f64] {
        match self {
            FrameSource::Files(_) => &[],
            FrameSource::Series(series, _) => series.times(),
        }
    }

    /// Sets unknown steps.
    pub(super) fn set_steps(&mut self, numbers: &[u32]) {
        if let FrameSource::Series(_, steps) = self {
            *steps = numbers.to_vec();
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            FrameSource::Files(listed) => listed.len(),
            FrameSource::Series(_, steps) => steps.len(),
        }
    }

    /// Step and time of a frame.
    pub(super) fn at(&self, frame: usize) -> (u32, f64) {
        match self {
            FrameSource::Files(listed) => (listed[frame].step, listed[frame].time),
            FrameSource::Series(series, steps) => (steps[frame], series.times()[frame]),
        }
    }

    /// Mesh and nodal fields of the first frame.
    pub(super) fn first(&self) -> Result<vtu::Frame, ReportError> {
        match self {
            FrameSource::Files(listed) if vtu::are_pieces_in(&listed[0].path) => {
                Ok(vtu::joined_frame(&listed[0].path)?)
            }
            FrameSource::Files(listed) => Ok(vtu::frame(&listed[0].path, &read(&listed[0])?)?),
            FrameSource::Series(series, _) => {
                let grid = series.points_and_cells();
                let (points, cells) = grid.map_err(|error| unreadable_series(series, error))?;
                let at_nodes = series.fields().into_iter().filter(|field| field.place() == Place::Nodes);
                Ok(vtu::Frame {
                    points,
                    cells,
                    regions: series.regions(),
                    fields: at_nodes.map(|f| (f.name().to_string(), f.components().len())).collect(),
                })
            }
        }
    }

    /// Nodal arrays of a frame by their names; a missing one is empty.
    pub(super) fn values(&self, frame: usize, names: &[&str]) -> Result<Vec<Vec<f64>>, ReportError> {
        match self {
            FrameSource::Files(listed) if vtu::are_pieces_in(&listed[frame].path) => {
                Ok(vtu::joined_fields(&listed[frame].path, names)?)
            }
            FrameSource::Files(listed) => {
                Ok(vtu::fields(&listed[frame].path, &read(&listed[frame])?, Place::Nodes, names)?)
            }
            FrameSource::Series(series, _) => {
                let there = series.fields();
                let field = |name: &&str| match there.iter().find(|field| field.name() == *name) {
                    Some(&field) => {
                        series.values(field, frame).map_err(|error| unreadable_series(series, error))
                    }
                    None => Ok(Vec::new()),
                };
                names.iter().map(field).collect()
            }
        }
    }
}

fn read(frame: &Listed) -> Result<Vec<u8>, ReportError> {
    let unreadable = |reason| MeshError::Unreadable { file: frame.path.clone(), reason };
    Ok(whole_file::read(&frame.path).map_err(unreadable)?)
}

fn unreadable_series(series: &SeriesReader, error: std::io::Error) -> ReportError {
    ReportError::System { path: series.path().to_path_buf(), error }
}

/// The series in a directory, if Emmy wrote one.
fn series(directory: &Path) -> Option<(String, FrameSource)> {
    let path = in_order(directory, "vtkhdf").into_iter().next()?;
    let series =
        SeriesReader::open(&path).ok().filter(|series| series.fields().contains(&FieldName::Displacement))?;
    // The file has times only, which are the same numbers as in the history.
    let steps = vec![0; series.times().len()];
    Some((path.file_name()?.to_string_lossy().into_owned(), FrameSource::Series(series, steps)))
}

/// Whether a directory has a series, with displacements or without.
pub(super) fn has_series(directory: &Path) -> bool {
    in_order(directory, "vtkhdf").iter().any(|path| is_series(path))
}

/// Files of a directory with an extension; the one named after the directory is first.
fn in_order(directory: &Path, extension: &str) -> Vec<PathBuf> {
    let own = directory.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_os_string()));
    let entries = fs::read_dir(directory).into_iter().flatten();
    let mut names: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    names.retain(|path| path.extension().is_some_and(|own| own == extension));
    names.sort_by_key(|path| (path.file_stem() != own.as_deref(), path.clone()));
    names
}

/// A frame in a collection.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Listed {
    pub(super) time: f64,
    /// Number of the step, from the name of the file.
    pub(super) step: u32,
    pub(super) path: PathBuf,
}

/// Name and frames of the collection in a directory, if Emmy wrote one; the one named after the directory is first.
fn collection(directory: &Path) -> Option<(String, Vec<Listed>)> {
    in_order(directory, "pvd").into_iter().find_map(|path| {
        let text = whole_file::read_text(&path).ok().filter(|text| text.contains(COLLECTION_MARK))?;
        Some((path.file_name()?.to_string_lossy().into_owned(), listed(directory, &text)?))
    })
}

fn listed(directory: &Path, text: &str) -> Option<Vec<Listed>> {
    let document = Document::parse(text).ok()?;
    let sets = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let frame = |(index, node): (usize, roxmltree::Node<'_, '_>)| {
        let time = node.attribute("timestep")?.parse().ok()?;
        let file = node.attribute("file")?;
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let number = stem.rsplit('_').next().and_then(|digits| digits.parse().ok());
        Some(Listed { time, step: number.unwrap_or(index as u32), path: directory.join(file) })
    };
    Some(sets.enumerate().filter_map(frame).collect())
}

#[cfg(test)]
mod tests {
    use emmy::body::{Body, FieldValues, Region};
    use emmy::material::NeoHooke;
    use emmy::mesh::{Mesh, Share, block, owners};
    use emmy::team::Threads;

    use super::super::surface::Surface;
    use super::*;
    use crate::vtk::{Format, FrameWriter, Precision};

    #[test]
    fn frames_come_in_their_order_with_times_and_steps() {
        let temp = tempfile::tempdir().unwrap();
        let set = |time: &str, step: u32| {
            format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"frames/a_{step:06}.vtu\"/>")
        };
        let text = format!(
            "{COLLECTION_MARK}<VTKFile><Collection>{}{}{}</Collection></VTKFile>",
            set("0.0", 0),
            set("1e-3", 1_000_020),
            set("2e-3", 1_000_040).replace(".vtu", ".pvtu")
        );
        fs::write(temp.path().join("a.pvd"), text).unwrap();
        fs::write(temp.path().join("b.pvd"), "<VTKFile/>").unwrap();
        let (name, frames) = collection(temp.path()).unwrap();
        assert_eq!((name.as_str(), frames.len()), ("a.pvd", 3));
        assert_eq!((frames[1].time, frames[1].step), (1e-3, 1_000_020));
        assert_eq!((frames[2].time, frames[2].step), (2e-3, 1_000_040));
        assert!(frames[0].path.ends_with("frames/a_000000.vtu"));
        assert_eq!(collection(&temp.path().join("nothing")), None);
    }

    /// A team writes frames in pieces, whose nodes on the borders coincide.
    #[test]
    fn frames_in_pieces_have_the_surface_of_the_whole_mesh() {
        let temp = tempfile::tempdir().unwrap();
        let mesh = block([3.0, 2.0, 2.0], [3, 2, 2]).unwrap();
        let owners = owners(&mesh, 3).unwrap();
        let moved = |mesh: &Mesh| -> Vec<f64> { mesh.points().iter().flatten().map(|x| 0.1 * x).collect() };
        Threads::run(3, |team| {
            let rubber = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 2.0);
            let share = Share::new(&mesh, &owners, team.rank());
            let body = Body::shared(share, team).region(rubber).build().unwrap();
            let form = (Format::Vtu, Precision::Double);
            let mut frames = FrameWriter::create(form, temp.path(), &body).unwrap();
            let displacement = FieldValues { name: FieldName::Displacement, numbers: moved(body.mesh()) };
            frames.write(7, 0.5, &[displacement]).unwrap();
        })
        .unwrap();
        let (_, frames) = FrameSource::find(temp.path()).unwrap();
        assert_eq!((frames.len(), frames.at(0)), (1, (7, 0.5)));
        let first = frames.first().unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        assert_eq!((first.points, first.regions), (mesh.points().to_vec(), vec![0; 12]));
        assert_eq!(Surface::new(&first.cells), Surface::new(&cells));
        assert_eq!(frames.values(0, &["displacement", "velocity"]).unwrap(), [moved(&mesh), Vec::new()]);
        let piece = fs::read_dir(temp.path().join("frames"))
            .unwrap()
            .find(|entry| entry.as_ref().unwrap().path().is_dir());
        fs::remove_file(piece.unwrap().unwrap().path().join("0001.vtu")).unwrap();
        let error = frames.values(0, &["displacement"]).unwrap_err().to_string();
        assert!(error.contains("0001.vtu"), "{error}");
    }
}
