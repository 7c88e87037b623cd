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
    pub(crate) const fn width(self) -> usize {
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

    /// Frames of a run that is resumed after a step, with some of those that are there: steps and times. Returned with those that
    /// should be there and are not.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn resume(
        (format, precision): (Format, Precision),
        directory: &Path,
        mesh: &Mesh,
        region_of_cell: &[u32],
        (kept, step): (&[(usize, f64)], usize),
    ) -> io::Result<(Self, Vec<(usize, f64)>)> {
        match format {
            Format::Vtu => {
                let mut frames = Frames::create(directory, precision, mesh, region_of_cell)?;
                let lost = frames.resume(kept, step)?;
                Ok((FrameWriter::Vtu(frames), lost))
            }
            Format::Vtkhdf => {
                let (series, lost) = Series::resume(directory, precision, (mesh, region_of_cell), kept)?;
                Ok((FrameWriter::Vtkhdf(Box::new(series)), lost))
            }
        }
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

/// Number of a kind of cell in VTK. The wedges' base is seen counter-clockwise from the top, as in VTK's tables of faces.
pub(crate) fn cell_type(kind: CellKind) -> u8 {
    kind.info().vtk_type
}

/// Last part of a path, also of `.` and `..`. Characters that XML cannot hold become `_`.
pub(crate) fn name_of(directory: &Path) -> String {
    let whole = directory.canonicalize().unwrap_or_else(|_| directory.to_path_buf());
    let name = whole.file_name().map_or("emmy".into(), |name| name.to_string_lossy().into_owned());
    let is_possible = |c: char| !c.is_control() || matches!(c, '\t' | '\n' | '\r' | '\u{7f}'..='\u{9f}');
    name.replace(|c| !is_possible(c) || matches!(c, '\u{fffe}' | '\u{ffff}'), "_")
}

/// Text as the value of an XML attribute.
fn escaped(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    // A reader would make these blanks.
    escaped.replace('\t', "&#9;").replace('\n', "&#10;").replace('\r', "&#13;")
}
