//! Frames for ParaView and PyVista: one `.vtu` each, or a `.pvtu` of pieces, collected with their times in a `.pvd`; or
//! all in one `.vtkhdf`.

mod array;
mod frame;
mod frame_files;
mod frame_names;
mod grid;
mod marks;
mod pieces;
mod series;

use std::io;
use std::path::{Path, PathBuf};

use emmy::Error;
use emmy::body::{Body, FieldValues, Place};
use emmy::mesh::CellKind;
use serde::{Deserialize, Serialize};

pub use frame::mesh_file;
pub(crate) use frame::{CELL, MESH_MARK, NODE};
pub(crate) use frame_files::COLLECTION_MARK;
pub use frame_files::FrameFiles;
pub(crate) use frame_names::{is_of_frame, remove_frames};
use grid::Grid;
pub(crate) use grid::{REGION, VERTEX};
pub use series::{Series, SeriesReader};
pub(crate) use series::{is_series, series_fields};

/// File format of the frames.
///
/// ```
/// use emmy_io::vtk::Format;
/// assert_eq!(Format::ALL.map(Format::name), ["vtu", "vtkhdf"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `NAME.pvd` and a `.vtu` for each frame: [`FrameFiles`].
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

    /// Checks that frames of a body can have the format.
    ///
    /// # Errors
    /// [`Error::NotOnTeam`] for one file of all frames.
    pub fn check(self, body: &Body) -> Result<(), Error> {
        match (self, body.ranks().size()) {
            (Format::Vtkhdf, 2..) => {
                let what = "one file of all frames (use `output.format = \"vtu\"`)".to_string();
                Err(Error::NotOnTeam { what })
            }
            _ => Ok(()),
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
    /// 8 bytes per number: all digits.
    Double,
    /// 4 bytes per number: 7 digits, for pictures.
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

/// Step and time of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameTime {
    /// Number of the step.
    pub step: usize,
    /// Time \[time\].
    pub time: f64,
}

/// The frames of a run, in one of the formats.
#[derive(Debug)]
pub enum FrameWriter {
    /// A file for each frame.
    Vtu(Box<FrameFiles>),
    /// One file.
    Vtkhdf(Box<Series>),
}

impl FrameWriter {
    /// Frames of a body in a directory, named after it. On a team, every method that changes files is a collective
    /// call; if one rank fails, all fail with its error.
    ///
    /// # Errors
    /// Errors of the system, and on a team those of [`Format::check`].
    pub fn create(
        (format, precision): (Format, Precision),
        directory: &Path,
        body: &Body,
    ) -> io::Result<Self> {
        format.check(body).map_err(io::Error::other)?;
        Ok(match format {
            Format::Vtu => FrameWriter::Vtu(files(precision, directory, body)?),
            Format::Vtkhdf => {
                let series = Series::of_grid(directory, precision, &Grid::of(body))?;
                FrameWriter::Vtkhdf(Box::new(series))
            }
        })
    }

    /// Frames of a run that is resumed after a step, continuing the given ones. Returned with the given frames that are
    /// missing.
    ///
    /// # Errors
    /// As [`FrameWriter::create`].
    pub fn resume(
        (format, precision): (Format, Precision),
        directory: &Path,
        body: &Body,
        (kept, step): (&[FrameTime], usize),
    ) -> io::Result<(Self, Vec<FrameTime>)> {
        format.check(body).map_err(io::Error::other)?;
        match format {
            Format::Vtu => {
                let mut frames = files(precision, directory, body)?;
                let missing = frames.resume(kept, step)?;
                Ok((FrameWriter::Vtu(frames), missing))
            }
            Format::Vtkhdf => {
                let (series, missing) = Series::resume(directory, precision, &Grid::of(body), kept)?;
                Ok((FrameWriter::Vtkhdf(Box::new(series)), missing))
            }
        }
    }

    /// Writes the fields of a step, once.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, step: usize, time: f64, fields: &[FieldValues]) -> io::Result<()> {
        match self {
            FrameWriter::Vtu(frames) => frames.write(step, time, fields),
            FrameWriter::Vtkhdf(series) => series.write(step, time, fields),
        }
    }

    /// Number of the last step.
    pub fn last_step(&self) -> Option<usize> {
        match self {
            FrameWriter::Vtu(frames) => frames.last_step(),
            FrameWriter::Vtkhdf(series) => series.last_step(),
        }
    }

    /// Completes the files.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn finish(&mut self) -> io::Result<()> {
        match self {
            FrameWriter::Vtu(frames) => frames.finish(),
            FrameWriter::Vtkhdf(series) => series.finish(),
        }
    }

    /// The file to open: the collection or the series.
    pub fn path(&self) -> PathBuf {
        match self {
            FrameWriter::Vtu(frames) => frames.collection(),
            FrameWriter::Vtkhdf(series) => series.path().to_path_buf(),
        }
    }
}

/// A file for each frame of a body, or a piece for each rank.
fn files(precision: Precision, directory: &Path, body: &Body) -> io::Result<Box<FrameFiles>> {
    let (mesh, regions) = (body.mesh(), body.region_of_cell());
    let files = match body.ranks().size() {
        1 => FrameFiles::of_grid(directory, precision, &Grid::of(body)),
        _ => FrameFiles::shared(directory, precision, mesh, regions, body.ranks()),
    };
    files.map(Box::new)
}

/// Array of a group of cells (cell data) or nodes (point data), 1 for its members: `group:NAME`.
pub(crate) const GROUP: &str = "group:";

/// Array of a group of facets, as cell data: bit i denotes face i of the cell. `facets:NAME`.
pub(crate) const FACETS: &str = "facets:";

/// Number of a kind of cell in VTK. The wedges' base is seen counter-clockwise from the top, as in VTK's tables of
/// faces.
pub(crate) fn cell_type(kind: CellKind) -> u8 {
    kind.info().vtk_type
}

/// Name of a directory, also of `.` and `..`; characters that XML cannot hold become `_`.
pub(crate) fn name_of(directory: &Path) -> String {
    let whole = directory.canonicalize().unwrap_or_else(|_| directory.to_path_buf());
    let name = whole.file_name().map_or("emmy".into(), |name| name.to_string_lossy().into_owned());
    let is_possible = |c: char| !c.is_control() || matches!(c, '\t' | '\n' | '\r' | '\u{7f}'..='\u{9f}');
    name.replace(|c| !is_possible(c) || matches!(c, '\u{fffe}' | '\u{ffff}'), "_")
}

/// Text as the value of an XML attribute.
fn escaped(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    // A reader would replace these by blanks.
    escaped.replace('\t', "&#9;").replace('\n', "&#10;").replace('\r', "&#13;")
}
