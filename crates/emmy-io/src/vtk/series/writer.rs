//! The file as it grows.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fmt, fs, io};

use emmy::body::fields::{FieldName, FieldValues};
use emmy::mesh::Mesh;
use rayon::prelude::*;
use rust_hdf5::types::H5Type;
use rust_hdf5::{DatatypeMessage, H5Dataset, H5File, H5Group};

use super::chunks::Chunks;
use super::journal::{self, Entries, Journal};
use super::{CREATOR, SeriesReader, groups, refused, without_slash};
use crate::directory::PART;
use crate::rows::with_ending;
use crate::vtk::array::LEVEL;
use crate::vtk::marks::marks;
use crate::vtk::{Place, Precision, cell_type, name_of};

/// Writes `NAME.vtkhdf`: mesh, groups and cell data `region` once, the fields for each step.
///
/// HDF5 files cannot be read while they change. The one that grows is `NAME.vtkhdf.part`; `NAME.vtkhdf` is a copy of it, put in place
/// by renaming, of the first frame and then whenever the time that copying takes is a twentieth of what has gone by. In the end
/// the growing file takes its place. The frames since the last copy are also in `NAME.vtkhdf.journal`, as plain numbers: a run that is
/// killed leaves a whole file, and when it is resumed it has every frame.
pub struct Series {
    path: PathBuf,
    growing: PathBuf,
    journal: Journal,
    /// Not there once the series has ended.
    file: Option<H5File>,
    precision: Precision,
    n_nodes: usize,
    n_cells: usize,
    fields: Vec<Field>,
    n_frames: usize,
    last_step: Option<usize>,
    published: Instant,
    /// How long the last copy took; not known before the first.
    cost: Option<Duration>,
}

/// A field in the file that is open.
struct Field {
    name: FieldName,
    chunks: Chunks,
    dataset: H5Dataset,
    offsets: H5Dataset,
}

/// Part of the time that may go into copies: one in so many.
const SHARE: u32 = 20;

/// Rows of a chunk of the small tables of the steps, and of the mesh.
const STEPS: usize = 256;
const ROWS: usize = 1 << 16;

/// Tables with the same number for each step; whether they have a second axis.
const SAME: [(&str, i64, bool); 5] = [
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
    /// The file in a directory, called by its name; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(
        directory: &Path,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        fs::create_dir_all(directory)?;
        let path = directory.join(format!("{}.vtkhdf", name_of(directory)));
        let journal = Journal::create(&with_ending(&path, journal::ENDING))?;
        Series::new(path, journal, precision, mesh, region_of_cell)
    }

    /// The series of a run that is resumed, with the frames that it had, steps and times; returned with those that are lost. Until
    /// all are in the new file, the old ones stay as they are.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(
        directory: &Path,
        precision: Precision,
        (mesh, region_of_cell): (&Mesh, &[u32]),
        kept: &[(usize, f64)],
    ) -> io::Result<(Self, Vec<(usize, f64)>)> {
        let path = directory.join(format!("{}.vtkhdf", name_of(directory)));
        let journal = with_ending(&path, journal::ENDING);
        let (copy, mut entries) = (SeriesReader::open(&path).ok(), Entries::read(&journal).ok());
        let journal = Journal::open(&journal)?;
        let (mut series, mut lost) =
            (Series::new(path, journal, precision, mesh, region_of_cell)?, Vec::new());
        for &(step, time) in kept {
            let mut fields = copy.as_ref().map_or(Ok(None), |copy| copy.frame_at(time))?;
            if let (None, Some(entries)) = (&fields, &mut entries) {
                fields = entries.fields(step)?;
            }
            match fields {
                Some(fields) => series.append(step, time, &fields)?,
                None => lost.push((step, time)),
            }
        }
        drop(copy);
        if series.n_frames > 0 {
            series.publish()?;
        }
        Ok((series, lost))
    }

    fn new(
        path: PathBuf,
        journal: Journal,
        precision: Precision,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        let growing = with_ending(&path, PART);
        let file = H5File::options().best_effort_locking().create(&growing).map_err(refused)?;
        write_static(&file, mesh, region_of_cell).map_err(refused)?;
        Ok(Series {
            path,
            growing,
            journal,
            file: Some(file),
            precision,
            n_nodes: mesh.n_nodes(),
            n_cells: mesh.n_cells(),
            fields: Vec::new(),
            n_frames: 0,
            last_step: None,
            published: Instant::now(),
            cost: None,
        })
    }

    /// Writes the fields of a step, unless it has been written.
    ///
    /// # Errors
    /// What the system refuses, and other fields than those of the first step.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        if self.last_step == Some(step) {
            return Ok(());
        }
        self.append(step, time, fields)?;
        match self.cost {
            Some(cost) if self.published.elapsed() < SHARE * cost => self.journal.add(step, time, fields),
            _ => self.publish(),
        }
    }

    /// Writes a frame into the growing file.
    fn append(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        let names = fields.iter().map(|field| field.name);
        if self.n_frames > 0 && !names.eq(self.fields.iter().map(|field| field.name)) {
            let message = "a series of frames has the same fields in every frame";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        if self.n_frames == 0 {
            self.fields = fields.iter().map(|field| self.new_field(field.name)).collect::<io::Result<_>>()?;
        }
        for (field, values) in self.fields.iter().zip(fields) {
            field.write(self.n_frames, &values.numbers).map_err(refused)?;
        }
        self.write_step(time).map_err(refused)?;
        (self.n_frames, self.last_step) = (self.n_frames + 1, Some(step));
        Ok(())
    }

    /// Ends the series: the growing file is the one to read.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(&mut self) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        self.fields.clear();
        file.close_no_sync().map_err(refused)?;
        fs::rename(&self.growing, &self.path)?;
        self.journal.remove()
    }

    /// Path of the file to read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of the last step that was written.
    pub fn last_step(&self) -> Option<usize> {
        self.last_step
    }

    /// Puts a copy in place of the file to read.
    fn publish(&mut self) -> io::Result<()> {
        let start = Instant::now();
        if let Some(file) = self.file.take() {
            file.close_no_sync().map_err(refused)?;
        }
        let copy = with_ending(&self.path, ".copy");
        fs::copy(&self.growing, &copy)?;
        fs::rename(&copy, &self.path)?;
        let file = H5File::options().best_effort_locking().open_rw(&self.growing).map_err(refused)?;
        for field in &mut self.fields {
            field.reopen(&file).map_err(refused)?;
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

    fn new_field(&self, name: FieldName) -> io::Result<Field> {
        let (place, components) = (name.place(), name.components().len());
        let n_rows = if place == Place::Nodes { self.n_nodes } else { self.n_cells };
        let chunks = Chunks::new(n_rows, components, self.precision);
        let (file, [data, offsets]) = (self.file()?, groups(place));
        let data = format!("{data}/{name}");
        let dataset = match self.precision {
            Precision::Double => growing::<f64>(file, &data, chunks),
            Precision::Single => growing::<f32>(file, &data, chunks),
        };
        Ok(Field {
            name,
            chunks,
            dataset: dataset.map_err(refused)?,
            offsets: table::<i64>(file, &format!("{offsets}/{name}"), false).map_err(refused)?,
        })
    }

    /// Adds a step to the tables of the steps.
    fn write_step(&self, time: f64) -> rust_hdf5::Result<()> {
        let Some(file) = &self.file else { return Ok(()) };
        let row = self.n_frames;
        add(&file.dataset_writer("VTKHDF/Steps/Values")?, row, false, time)?;
        for (name, number, has_columns) in SAME {
            add(&file.dataset_writer(&format!("VTKHDF/Steps/{name}"))?, row, has_columns, number)?;
        }
        steps(file)?.set_attr_numeric("NSteps", &(row as i64 + 1))
    }
}

impl Drop for Series {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            // Whoever wants to know of a failure has called `finish`.
            let _ = file.close_no_sync();
        }
    }
}

impl Field {
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

/// What does not change: header, mesh, groups, and the tables of the steps, which are empty.
fn write_static(file: &H5File, mesh: &Mesh, region_of_cell: &[u32]) -> rust_hdf5::Result<()> {
    let creator = format!("Emmy {}", env!("CARGO_PKG_VERSION"));
    file.set_attr_typed(CREATOR, text(&creator), creator.into_bytes())?;
    let root = file.create_group("VTKHDF")?;
    root.set_attr_array_numeric("Version", &[2i64, 0])?;
    root.set_attr_typed("Type", text("UnstructuredGrid"), b"UnstructuredGrid".to_vec())?;
    write_mesh(file, mesh)?;
    for name in ["PointData", "CellData", "Steps"] {
        root.create_group(name)?;
    }
    once(file, "VTKHDF/CellData/region", region_of_cell.iter().map(|&region| region as i32).collect())?;
    for marks in marks(mesh) {
        let [group, _] = groups(marks.place);
        once(file, &format!("{group}/{}", without_slash(&marks.name)), marks.bits)?;
    }
    let steps = steps(file)?;
    steps.create_group("PointDataOffsets")?;
    steps.create_group("CellDataOffsets")?;
    steps.set_attr_numeric("NSteps", &0i64)?;
    table::<f64>(file, "VTKHDF/Steps/Values", false)?;
    SAME.iter().try_for_each(|&(name, _, has_columns)| {
        table::<i64>(file, &format!("VTKHDF/Steps/{name}"), has_columns).map(|_| ())
    })
}

fn write_mesh(file: &H5File, mesh: &Mesh) -> rust_hdf5::Result<()> {
    let nodes: Vec<i64> =
        mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node))).collect();
    let ends = mesh.cells().scan(0, |end, cell| {
        *end += cell.nodes.len() as i64;
        Some(*end)
    });
    let count = |name: &str, n: usize| once(file, &format!("VTKHDF/{name}"), vec![n as i64]);
    count("NumberOfPoints", mesh.n_nodes())?;
    count("NumberOfCells", mesh.n_cells())?;
    count("NumberOfConnectivityIds", nodes.len())?;
    once(file, "VTKHDF/Connectivity", nodes)?;
    once(file, "VTKHDF/Offsets", [0].into_iter().chain(ends).collect())?;
    once(file, "VTKHDF/Types", mesh.cells().map(|cell| cell_type(cell.kind)).collect())?;
    let points: Vec<f64> = mesh.points().iter().flatten().copied().collect();
    let n = mesh.n_nodes();
    let dataset = file.new_dataset::<f64>().shape([n, 3]).chunk(&[n.min(ROWS), 3]).shuffle_deflate(LEVEL);
    dataset.create("VTKHDF/Points")?.write_raw(&points)
}

/// A list that is written once.
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

/// An empty table that grows by a number a step; `has_columns`: on two axes.
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

/// A text of fixed length, as VTK's reader wants it.
fn text(text: &str) -> DatatypeMessage {
    DatatypeMessage::fixed_string(text.len() as u32)
}
