//! Frames for ParaView and PyVista: one `.vtu` each, collected with their times in a `.pvd`, or all in one `.vtkhdf`.

mod array;
mod frame;
mod frames;
mod marks;
mod series;

use std::io;
use std::path::{Path, PathBuf};

use emmy::body::fields::{FieldValues, Place};
use emmy::mesh::{CellKind, Mesh};

pub use frames::Frames;
pub(crate) use series::CREATOR;
pub use series::{Series, SeriesReader};

/// Which files the frames are.
///
/// ```
/// use emmy_io::vtk::Format;
/// assert_eq!(Format::ALL.map(Format::name), ["vtu", "vtkhdf"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `NAME.pvd` and a `.vtu` for each frame: [`Frames`].
    Vtu,
    /// One `NAME.vtkhdf`: [`Series`].
    Vtkhdf,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 2] = [Format::Vtu, Format::Vtkhdf];

    /// Its name in the input.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Vtu => "vtu",
            Format::Vtkhdf => "vtkhdf",
        }
    }
}

/// Precision of the fields in a file; points are always in double precision.
///
/// ```
/// use emmy_io::vtk::Precision;
/// assert_eq!(Precision::ALL.map(Precision::name), ["double", "single"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 8 bytes a number: all digits.
    Double,
    /// 4 bytes a number: 7 digits, for pictures.
    Single,
}

impl Precision {
    /// Both.
    pub const ALL: [Precision; 2] = [Precision::Double, Precision::Single];

    /// Its name in the input.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Double => "double",
            Precision::Single => "single",
        }
    }

    /// Bytes of a number.
    const fn width(self) -> usize {
        match self {
            Precision::Double => 8,
            Precision::Single => 4,
        }
    }
}

/// The frames of a run, in one of the formats.
#[derive(Debug)]
pub enum FrameWriter {
    /// A file for each frame.
    Vtu(Frames),
    /// One file.
    Vtkhdf(Box<Series>),
}

impl FrameWriter {
    /// Frames in a directory, called by its name; `region_of_cell: [n_cells]`.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn create(
        (format, precision): (Format, Precision),
        directory: &Path,
        mesh: &Mesh,
        region_of_cell: &[u32],
    ) -> io::Result<Self> {
        Ok(match format {
            Format::Vtu => FrameWriter::Vtu(Frames::create(directory, precision, mesh, region_of_cell)?),
            Format::Vtkhdf => {
                let series = Series::create(directory, precision, mesh, region_of_cell)?;
                FrameWriter::Vtkhdf(Box::new(series))
            }
        })
    }

    /// Frames of a run that goes on after a step, with some of those that are there: steps and times. A series is written anew from
    /// the one that is there, as far as that goes.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(
        form: (Format, Precision),
        directory: &Path,
        mesh: &Mesh,
        region_of_cell: &[u32],
        (kept, step): (&[(usize, f64)], usize),
    ) -> io::Result<Self> {
        // The new series takes the place of the old one later; until then that is open.
        let old = directory.join(format!("{}.vtkhdf", name_of(directory)));
        let old = SeriesReader::open(&old).ok().filter(|_| form.0 == Format::Vtkhdf);
        let mut frames = FrameWriter::create(form, directory, mesh, region_of_cell)?;
        if let FrameWriter::Vtu(frames) = &mut frames {
            frames.go_on(kept, step)?;
        }
        for (old, &(step, time)) in old.iter().flat_map(|old| kept.iter().map(move |kept| (old, kept))) {
            // The last time may be off by its rounding: the plan has changed.
            let is_same = |own: &f64| (own - time).abs() <= 1e-9 * time.abs();
            let Some(index) = old.times().iter().position(is_same) else { continue };
            let values = |name| Ok(FieldValues { name, numbers: old.values(name, index)? });
            let fields: io::Result<Vec<FieldValues>> = old.fields().into_iter().map(values).collect();
            frames.write(step, time, &fields?)?;
        }
        Ok(frames)
    }

    /// Writes the fields of a step, unless it has been written.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        match self {
            FrameWriter::Vtu(frames) => frames.write(step, time, fields),
            FrameWriter::Vtkhdf(series) => series.write(step, time, fields),
        }
    }

    /// Number of the last step that was written.
    pub fn last_step(&self) -> Option<usize> {
        match self {
            FrameWriter::Vtu(frames) => frames.last_step(),
            FrameWriter::Vtkhdf(series) => series.last_step(),
        }
    }

    /// Ends the files: every frame is where a reader finds it.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(&mut self) -> io::Result<()> {
        match self {
            FrameWriter::Vtu(frames) => frames.finish(),
            FrameWriter::Vtkhdf(series) => series.finish(),
        }
    }

    /// The file to open: the collection, or the one that holds them all.
    pub fn path(&self) -> PathBuf {
        match self {
            FrameWriter::Vtu(frames) => frames.collection(),
            FrameWriter::Vtkhdf(series) => series.path().to_path_buf(),
        }
    }
}

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

/// Last part of a path, also of `.` and `..`.
fn name_of(directory: &Path) -> String {
    let whole = directory.canonicalize().unwrap_or_else(|_| directory.to_path_buf());
    whole.file_name().map_or("emmy".into(), |name| name.to_string_lossy().into_owned())
}

/// Text as the value of an XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
