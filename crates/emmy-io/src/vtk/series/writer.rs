//! Writes a series.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fmt, fs, io};

use emmy::body::{FieldName, FieldValues};
use emmy::mesh::Mesh;
use rayon::prelude::*;
use rust_hdf5::types::H5Type;
use rust_hdf5::{DatatypeMessage, H5Dataset, H5File, H5Group};

use super::chunks::Chunks;
use super::journal::{self, Entries, Journal};
use super::{CREATOR, SeriesReader, groups, rejected, without_slash};
use crate::vtk::array::LEVEL;
use crate::vtk::grid::{Grid, REGION, on_grid};
use crate::vtk::{FrameTime, Place, Precision, name_of};
use crate::whole_file::{PART, named, with_ending};

/// Writes `NAME.vtkhdf`: mesh, groups and cell data `region` once, the fields for each step.
///
/// HDF5 files cannot be read while they change. Frames go to `NAME.vtkhdf.part`; `NAME.vtkhdf` is a copy, put in place
/// by renaming. It is made after the first frame and refreshed so that copying takes at most a twentieth of the time.
/// At the end the growing file replaces it. Frames since the last copy are also in `NAME.vtkhdf.journal`, so that a
/// killed run leaves a readable file and loses no frame when it is resumed.
pub struct Series {
    path: PathBuf,
    growing: PathBuf,
    journal: Journal,
    /// `None` once the series has ended.
    file: Option<H5File>,
    precision: Precision,
    n_nodes: usize,
    n_cells: usize,
    fields: Vec<FieldDataset>,
    n_frames: usize,
    last_step: Option<usize>,
    published: Instant,
    /// Duration of the last copy; `None` before the first.
    cost: Option<Duration>,
}

/// A field in the open file.
struct FieldDataset {
    name: FieldName,
    chunks: Chunks,
    dataset: H5Dataset,
    offsets: H5Dataset,
}

/// Copies take at most one part of the time in this number.
const COPY_INTERVAL: u32 = 20;

/// Rows of a chunk of the small tables of the steps, and of the mesh.
const STEPS: usize = 256;
const ROWS: usize = 1 << 16;

/// Tables with one number for all steps, and whether they have a second axis.
const CONSTANT_TABLES: [(&str, i64, bool); 5] = [
    ("PartOffsets", 0, false),
    ("NumberOfParts", 1, false),
    ("PointOffsets", 0, false),
    ("CellOffsets", 0, true),
    ("ConnectivityIdOffsets", 0, true),
];

impl fmt::Debug for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Series({}, {} frames)", self.path.display(), self.n_frames)
    }
}

impl Series {
    /// A series in a directory, named after it; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn create(
        directory: &Path,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        Series::of_grid(directory, precision, &Grid::new(mesh, Some(region_of_cell)))
    }

    /// The same of a grid.
    pub(in crate::vtk) fn of_grid(
        directory: &Path,
        precision: Precision,
        grid: &Grid<'_>,
    ) -> io::Result<Self> {
        fs::create_dir_all(directory).map_err(named(directory))?;
        let path = directory.join(format!("{}.vtkhdf", name_of(directory)));
        let journal = Journal::create(&with_ending(&path, journal::ENDING))?;
        Series::new(path, journal, precision, grid)
    }

    /// The series of a resumed run with its given frames, returned with those that are missing. The old files stay
    /// until all frames are in the new one.
    ///
    /// # Errors
    /// Errors of the system.
    pub(in crate::vtk) fn resume(
        directory: &Path,
        precision: Precision,
        grid: &Grid<'_>,
        kept: &[FrameTime],
    ) -> io::Result<(Self, Vec<FrameTime>)> {
        let path = directory.join(format!("{}.vtkhdf", name_of(directory)));
        let journal = with_ending(&path, journal::ENDING);
        let copy = SeriesReader::open(&path).ok();
        let mut entries = Entries::read(&journal).ok();
        let journal = Journal::open(&journal)?;
        let mut series = Series::new(path, journal, precision, grid)?;
        let mut missing = Vec::new();
        for &FrameTime { step, time } in kept {
            let mut fields = copy.as_ref().map_or(Ok(None), |copy| copy.frame_at(time))?;
            if let (None, Some(entries)) = (&fields, &mut entries) {
                fields = entries.fields(step)?;
            }
            match fields {
                Some(fields) => series.append(step, time, &fields)?,
                None => missing.push(FrameTime { step, time }),
            }
        }
        drop(copy);
        if series.n_frames > 0 {
            series.publish()?;
        }
        Ok((series, missing))
    }

    fn new(path: PathBuf, journal: Journal, precision: Precision, grid: &Grid<'_>) -> io::Result<Self> {
        let growing = with_ending(&path, PART);
        let file = H5File::options().best_effort_locking().create(&growing).map_err(failed(&growing))?;
        write_static(&file, grid).map_err(failed(&growing))?;
        Ok(Series {
            path,
            growing,
            journal,
            file: Some(file),
            precision,
            n_nodes: grid.mesh.n_nodes(),
            n_cells: grid.n_cells(),
            fields: Vec::new(),
            n_frames: 0,
            last_step: None,
            published: Instant::now(),
            cost: None,
        })
    }

    /// Writes the fields of a step, once.
    ///
    /// # Errors
    /// Errors of the system, and other fields than in the first frame.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.last_step == Some(step) {
            return Ok(());
        }
        self.append(step, time, fields)?;
        match self.cost {
            Some(cost) if self.published.elapsed() < COPY_INTERVAL * cost => {
                self.journal.add(FrameTime { step, time }, fields)
            }
            _ => self.publish(),
        }
    }

    /// Appends a frame to the growing file.
    fn append(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.n_frames == 0 {
            self.fields = fields.iter().map(|field| self.new_field(field.name)).collect::<io::Result<_>>()?;
        }
        for field in &self.fields {
            let values = fields.iter().find(|values| values.name == field.name).ok_or_else(other_fields)?;
            field.write(self.n_frames, &on_grid(values, self.n_cells)).map_err(failed(&self.growing))?;
        }
        if fields.len() != self.fields.len() {
            return Err(other_fields());
        }
        self.write_step(time).map_err(failed(&self.growing))?;
        (self.n_frames, self.last_step) = (self.n_frames + 1, Some(step));
        Ok(())
    }

    /// Completes the series: the growing file becomes the one to read.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn finish(&mut self) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        self.fields.clear();
        file.close_no_sync().map_err(failed(&self.growing))?;
        fs::rename(&self.growing, &self.path).map_err(named(&self.path))?;
        self.journal.remove()
    }

    /// Path of the file to read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of the last step.
    pub fn last_step(&self) -> Option<usize> {
        self.last_step
    }

    /// Replaces the file to read by a copy.
    fn publish(&mut self) -> io::Result<()> {
        let start = Instant::now();
        if let Some(file) = self.file.take() {
            file.close_no_sync().map_err(failed(&self.growing))?;
        }
        let copy = with_ending(&self.path, ".copy");
        fs::copy(&self.growing, &copy).map_err(named(&copy))?;
        fs::rename(&copy, &self.path).map_err(named(&self.path))?;
        let file =
            H5File::options().best_effort_locking().open_rw(&self.growing).map_err(failed(&self.growing))?;
        for field in &mut self.fields {
            field.reopen(&file).map_err(failed(&self.growing))?;
        }
        self.file = Some(file);
        self.journal.clear()?;
        self.published = Instant::now();
        self.cost = Some(self.published - start);
        Ok(())
    }

    fn file(&self) -> io::Result<&H5File> {
        self.file.as_ref().ok_or_else(|| io::Error::other("the series of frames has ended"))
    }

    fn new_field(&self, name: FieldName) -> io::Result<FieldDataset> {
        let place = name.place();
        let components = name.components().len();
        let n_rows = if place == Place::Nodes { self.n_nodes } else { self.n_cells };
        let chunks = Chunks::new(n_rows, components, self.precision);
        let file = self.file()?;
        let [data, offsets] = groups(place);
        let data = format!("{data}/{name}");
        let dataset = match self.precision {
            Precision::Double => growing::<f64>(file, &data, chunks),
            Precision::Single => growing::<f32>(file, &data, chunks),
        };
        Ok(FieldDataset {
            name,
            chunks,
            dataset: dataset.map_err(failed(&self.growing))?,
            offsets: table::<i64>(file, &format!("{offsets}/{name}"), false)
                .map_err(failed(&self.growing))?,
        })
    }

    /// Adds a step to the tables of the steps.
    fn write_step(&self, time: f64) -> rust_hdf5::Result<()> {
        let Some(file) = &self.file else { return Ok(()) };
        let row = self.n_frames;
        add(&file.dataset_writer("VTKHDF/Steps/Values")?, row, false, time)?;
        for (name, number, has_columns) in CONSTANT_TABLES {
            add(&file.dataset_writer(&format!("VTKHDF/Steps/{name}"))?, row, has_columns, number)?;
        }
        steps(file)?.set_attr_numeric("NSteps", &(row as i64 + 1))
    }
}

impl Drop for Series {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            // Errors are reported by `finish`.
            let _ = file.close_no_sync();
        }
    }
}

impl FieldDataset {
    fn write(&self, frame: usize, numbers: &[f64]) -> rust_hdf5::Result<()> {
        let chunks = self.chunks;
        let Chunks { count, components, .. } = chunks;
        let stored: Vec<Vec<u8>> =
            (0..count).into_par_iter().map(|chunk| chunks.stored(numbers, chunk)).collect();
        for (chunk, bytes) in stored.iter().enumerate() {
            let place = [frame * count + chunk, 0];
            let axes = if components == 1 { 1 } else { 2 };
            self.dataset.write_chunk_raw_at(&place[..axes], bytes, 0)?;
        }
        add(&self.offsets, frame, false, (frame * self.chunks.stride()) as i64)
    }

    fn reopen(&mut self, file: &H5File) -> rust_hdf5::Result<()> {
        let [data, offsets] = groups(self.name.place());
        self.dataset = file.dataset_writer(&format!("{data}/{}", self.name))?;
        self.offsets = file.dataset_writer(&format!("{offsets}/{}", self.name))?;
        Ok(())
    }
}

/// An error of a file, with its path.
fn failed(path: &Path) -> impl Fn(rust_hdf5::Hdf5Error) -> io::Error + '_ {
    move |error| named(path)(rejected(error))
}

fn other_fields() -> io::Error {
    let message = "a series of frames has the same fields in every frame";
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// The parts that do not change: header, mesh, groups, and the empty tables of the steps.
fn write_static(file: &H5File, grid: &Grid<'_>) -> rust_hdf5::Result<()> {
    let creator = format!("Emmy {}", env!("CARGO_PKG_VERSION"));
    file.set_attr_typed(CREATOR, text(&creator), creator.into_bytes())?;
    let root = file.create_group("VTKHDF")?;
    root.set_attr_array_numeric("Version", &[2i64, 0])?;
    root.set_attr_typed("Type", text("UnstructuredGrid"), b"UnstructuredGrid".to_vec())?;
    write_mesh(file, grid)?;
    for name in ["PointData", "CellData", "Steps"] {
        root.create_group(name)?;
    }
    once(file, &format!("VTKHDF/CellData/{REGION}"), grid.regions().unwrap_or_default())?;
    for marks in grid.marks() {
        let [group, _] = groups(marks.place);
        once(file, &format!("{group}/{}", without_slash(&marks.name)), marks.bits)?;
    }
    let steps = steps(file)?;
    steps.create_group("PointDataOffsets")?;
    steps.create_group("CellDataOffsets")?;
    steps.set_attr_numeric("NSteps", &0i64)?;
    table::<f64>(file, "VTKHDF/Steps/Values", false)?;
    CONSTANT_TABLES.iter().try_for_each(|&(name, _, has_columns)| {
        table::<i64>(file, &format!("VTKHDF/Steps/{name}"), has_columns).map(|_| ())
    })
}

fn write_mesh(file: &H5File, grid: &Grid<'_>) -> rust_hdf5::Result<()> {
    let mesh = grid.mesh;
    let nodes = grid.connectivity();
    let count = |name: &str, n: usize| once(file, &format!("VTKHDF/{name}"), vec![n as i64]);
    count("NumberOfPoints", mesh.n_nodes())?;
    count("NumberOfCells", grid.n_cells())?;
    count("NumberOfConnectivityIds", nodes.len())?;
    once(file, "VTKHDF/Connectivity", nodes)?;
    once(file, "VTKHDF/Offsets", [0].into_iter().chain(grid.ends()).collect())?;
    once(file, "VTKHDF/Types", grid.types())?;
    let points: Vec<f64> = mesh.points().iter().flatten().copied().collect();
    let n = mesh.n_nodes();
    let dataset = file.new_dataset::<f64>().shape([n, 3]).chunk(&[n.min(ROWS), 3]).shuffle_deflate(LEVEL);
    dataset.create("VTKHDF/Points")?.write_raw(&points)
}

/// A list without later frames.
fn once<T: H5Type>(file: &H5File, name: &str, numbers: Vec<T>) -> rust_hdf5::Result<()> {
    let n = numbers.len();
    let dataset = file.new_dataset::<T>().shape([n]).chunk(&[n.clamp(1, ROWS)]).shuffle_deflate(LEVEL);
    dataset.create(name)?.write_raw(&numbers)
}

/// An empty field that grows by the chunks of a frame; scalars have one axis.
fn growing<T: H5Type>(file: &H5File, name: &str, chunks: Chunks) -> rust_hdf5::Result<H5Dataset> {
    let components = chunks.components;
    let axes = |rows: usize| if components == 1 { vec![rows] } else { vec![rows, components] };
    let most = if components == 1 { vec![None] } else { vec![None, Some(components)] };
    let dataset = file.new_dataset::<T>().shape(axes(0)).chunk(&axes(chunks.rows)).max_shape(&most);
    dataset.shuffle_deflate(LEVEL).create(name)
}

/// An empty table that grows by a number for each step; `has_columns`: it has two axes.
fn table<T: H5Type>(file: &H5File, name: &str, has_columns: bool) -> rust_hdf5::Result<H5Dataset> {
    let dataset = file.new_dataset::<T>();
    let dataset = match has_columns {
        false => dataset.shape([0]).chunk(&[STEPS]).max_shape(&[None]),
        true => dataset.shape([0, 1]).chunk(&[STEPS, 1]).max_shape(&[None, Some(1)]),
    };
    dataset.create(name)
}

/// Adds a number to a table.
fn add<T: H5Type>(table: &H5Dataset, row: usize, has_columns: bool, number: T) -> rust_hdf5::Result<()> {
    let axes = if has_columns { 2 } else { 1 };
    table.extend(&[row + 1, 1][..axes])?;
    table.write_slice(&[row, 0][..axes], &[1, 1][..axes], &[number])
}

fn steps(file: &H5File) -> rust_hdf5::Result<H5Group> {
    file.root_group().group("VTKHDF")?.group("Steps")
}

/// Text of fixed length, as the reader of VTK requires.
fn text(text: &str) -> DatatypeMessage {
    DatatypeMessage::fixed_string(text.len() as u32)
}
