//! Reads a series.

use std::path::{Path, PathBuf};
use std::{fmt, io};

use emmy::body::{FieldName, FieldValues, Place};
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};
use rust_hdf5::H5File;

use super::{groups, rejected};
use crate::vtk::{FACETS, GROUP, Precision, REGION, VERTEX, cell_type};
use crate::whole_file;

/// Reads a `.vtkhdf` that Emmy wrote.
///
/// ```
/// use emmy::body::{FieldName, Fields};
/// use emmy::prelude::*;
/// use emmy_io::vtk::{Precision, Series, SeriesReader};
/// # let directory = std::env::temp_dir().join(format!("emmy-doc-series-{}", std::process::id()));
/// let rubber = Region::new(NeoHooke::new(1.0, 1.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let mut series = Series::create(&directory, Precision::Double, body.mesh(), body.region_of_cell())?;
/// for (step, time) in [0.0, 0.5].into_iter().enumerate() {
///     let fields = Fields::new(&body).at([&[0.0; 24], &[time; 24]], &[FieldName::MomentumDensity]);
///     series.write(step, time, &fields)?;
/// }
/// series.finish()?;
/// let series = SeriesReader::open(series.path())?;
/// assert_eq!(series.times(), [0.0, 0.5]);
/// assert_eq!(series.values(FieldName::MomentumDensity, 1)?, [1.0; 24]);
/// # std::fs::remove_dir_all(&directory)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SeriesReader {
    path: PathBuf,
    file: H5File,
    times: Vec<f64>,
    n_nodes: usize,
    n_cells: usize,
}

/// Points, and kinds and nodes of cells.
pub(crate) type PointsAndCells = (Vec<[f64; 3]>, Vec<(CellKind, Vec<u32>)>);

impl fmt::Debug for SeriesReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SeriesReader({} frames)", self.times.len())
    }
}

impl SeriesReader {
    /// Opens a file.
    ///
    /// # Errors
    /// Errors of the system, and files of another kind.
    pub fn open(path: &Path) -> io::Result<Self> {
        whole_file::check_kind(path)?;
        let file = H5File::options().best_effort_locking().open(path).map_err(rejected)?;
        let count = |name: &str| -> io::Result<usize> {
            let numbers: Vec<i64> = read(&file, &format!("VTKHDF/{name}"))?;
            numbers.first().and_then(|&n| usize::try_from(n).ok()).ok_or_else(|| damaged(name))
        };
        let n_nodes = count("NumberOfPoints")?;
        let n_cells = count("NumberOfCells")?;
        let times = read(&file, "VTKHDF/Steps/Values")?;
        Ok(SeriesReader { path: path.to_path_buf(), file, times, n_nodes, n_cells })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Times of the frames.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Fields in the file.
    pub fn fields(&self) -> Vec<FieldName> {
        let names = self.file.dataset_names();
        let is_there = |field: &FieldName| {
            let path = format!("{}/{field}", groups(field.place())[0]);
            names.iter().any(|name| name.trim_start_matches('/') == path)
        };
        FieldName::ALL.into_iter().filter(is_there).collect()
    }

    /// A field of a frame, `[n_nodes][n_components]` or `[n_cells][n_components]`.
    ///
    /// # Errors
    /// Errors of the system, a missing field or frame.
    pub fn values(&self, name: FieldName, frame: usize) -> io::Result<Vec<f64>> {
        let [data, offsets] = groups(name.place());
        let offsets: Vec<i64> = read(&self.file, &format!("{offsets}/{name}"))?;
        let offset = offsets.get(frame).and_then(|&offset| usize::try_from(offset).ok());
        let offset = offset.ok_or_else(|| damaged(name.name()))?;
        let n_rows = if name.place() == Place::Nodes { self.n_nodes } else { self.n_cells };
        let dataset = self.file.dataset(&format!("{data}/{name}")).map_err(rejected)?;
        let axes = dataset.ndims();
        let start = [offset, 0];
        let count = [n_rows, name.components().len()];
        let (start, count) = (&start[..axes], &count[..axes]);
        if dataset.element_size() == Precision::Single.width() {
            let numbers: Vec<f32> = dataset.read_slice(start, count).map_err(rejected)?;
            return Ok(numbers.into_iter().map(f64::from).collect());
        }
        dataset.read_slice(start, count).map_err(rejected)
    }

    /// All fields of the frame at a time, up to rounding of the time.
    pub(super) fn frame_at(&self, time: f64) -> io::Result<Option<Vec<FieldValues>>> {
        let is_same = |own: &f64| (own - time).abs() <= 1e-9 * time.abs();
        let Some(frame) = self.times.iter().position(is_same) else { return Ok(None) };
        let values = |name| Ok(FieldValues { name, numbers: self.values(name, frame)? });
        self.fields().into_iter().map(values).collect::<io::Result<_>>().map(Some)
    }

    /// Points and cells; axes of rigid bodies are lines, their centres lines without length.
    pub(crate) fn points_and_cells(&self) -> io::Result<PointsAndCells> {
        let of = |name: &str| format!("VTKHDF/{name}");
        let points: Vec<f64> = read(&self.file, &of("Points"))?;
        let [nodes, ends]: [Vec<i64>; 2] =
            [read(&self.file, &of("Connectivity"))?, read(&self.file, &of("Offsets"))?];
        let types: Vec<u8> = read(&self.file, &of("Types"))?;
        let mut cells = Vec::with_capacity(types.len());
        for (ends, id) in ends.windows(2).zip(types) {
            let kind = CellKind::ALL.into_iter().find(|&kind| cell_type(kind) == id);
            let nodes = nodes.get(ends[0] as usize..ends[1] as usize);
            if let (VERTEX, Some([centre])) = (id, nodes) {
                cells.push((CellKind::Line2, vec![*centre as u32; 2]));
                continue;
            }
            let (Some(kind), Some(nodes)) = (kind, nodes) else { return Err(damaged("Types")) };
            cells.push((kind, nodes.iter().map(|&node| node as u32).collect()));
        }
        Ok((points.as_chunks().0.to_vec(), cells))
    }

    /// Region of each cell, negative for those of rigid bodies; empty if the file does not have it.
    pub(crate) fn regions(&self) -> Vec<i32> {
        read(&self.file, &format!("VTKHDF/CellData/{REGION}")).unwrap_or_default()
    }

    /// The mesh with its groups.
    ///
    /// # Errors
    /// Errors of the system, an invalid mesh.
    pub fn mesh(&self) -> io::Result<Mesh> {
        let (points, cells) = self.points_and_cells()?;
        let mut builder = MeshBuilder::new();
        points.into_iter().for_each(|point| {
            builder.point(point);
        });
        for (kind, nodes) in cells.into_iter().filter(|(_, nodes)| nodes[0] != nodes[1]) {
            builder.cell(kind, &nodes).map_err(io::Error::other)?;
        }
        self.add_groups(&mut builder)?;
        builder.build().map_err(io::Error::other)
    }

    fn add_groups(&self, builder: &mut MeshBuilder) -> io::Result<()> {
        for path in self.file.dataset_names() {
            let Some((place, array)) = path.trim_start_matches('/').rsplit_once('/') else { continue };
            let group = |prefix: &str| array.strip_prefix(prefix).map(|name| name.replace('\u{2215}', "/"));
            if let Some(name) = group(GROUP) {
                let members = members(&read(&self.file, &path)?);
                match place == groups(Place::Nodes)[0] {
                    true => builder.node_group(&name, members),
                    false => builder.cell_group(&name, members),
                };
            } else if let Some(name) = group(FACETS) {
                let bits: Vec<u8> = read(&self.file, &path)?;
                let of_cell = |(cell, bits): (usize, u8)| {
                    let local = (0..8).filter(move |local| (bits >> local) & 1 == 1);
                    local.map(move |local| Facet { cell: cell as u32, local })
                };
                builder.facet_group(&name, bits.into_iter().enumerate().flat_map(of_cell));
            }
        }
        Ok(())
    }
}

/// Indices of the numbers that are not zero.
fn members(bits: &[u8]) -> Vec<u32> {
    (0..bits.len() as u32).filter(|&member| bits[member as usize] != 0).collect()
}

fn read<T: rust_hdf5::types::H5Type>(file: &H5File, path: &str) -> io::Result<Vec<T>> {
    file.dataset(path.trim_start_matches('/')).and_then(|dataset| dataset.read_raw()).map_err(rejected)
}

fn damaged(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("{what}: not as Emmy writes it"))
}
