//! Everything that can go wrong when a mesh file is read.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use emmy::internals::number::short;

/// Position inside a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Byte of a binary file, counted from 0.
    Byte(usize),
}

/// A place in a file; prints as `cube.msh, line 12`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line or byte.
    pub position: Position,
}

impl Place {
    pub(super) fn line(file: &Path, line: usize) -> Self {
        Place { file: file.to_path_buf(), position: Position::Line(line) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Position::Line(line) => write!(f, "{}, line {line}", self.file.display()),
            Position::Byte(byte) => write!(f, "{}, byte {byte}", self.file.display()),
        }
    }
}

/// Formats that are read.
const FORMATS: &str =
    "Gmsh (.msh), Abaqus (.inp), Nastran (.bdf, .nas, .fem, .dat) and VTK (.vtu, .pvtu, .vtk)";

/// Error of a mesh file. Every message names the fault, its place, and something to try, with the numbers of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A file that cannot be opened.
    #[error("{}: cannot be read: {reason}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Message of the system.
        reason: io::Error,
    },
    /// A file of an unknown format.
    #[error(
        "{}: not a mesh file of a known format; Emmy reads {}", file.display(), FORMATS
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
    },
    /// A file in an unsupported format of another program.
    #[error(
        "{}: {format} is not read; {command}; Emmy reads {}", file.display(), FORMATS
    )]
    OtherFormat {
        /// The file.
        file: PathBuf,
        /// The format.
        format: &'static str,
        /// The converter.
        command: String,
    },
    /// A file that has only surface elements, which do not lie in a plane.
    #[error("{}: the file has {found} only and no solid cells, and they do not lie in one plane z = const ({place}); {advice}", file.display())]
    SurfaceAlone {
        /// The file.
        file: PathBuf,
        /// The elements found.
        found: &'static str,
        /// The first node that is not in the plane.
        place: String,
        /// Something to try.
        advice: &'static str,
    },
    /// An unsupported version of the MSH format.
    #[error(
        "{place}: version {version} of the MSH format is not read, only 1, 2.0 to 2.2, 4.0 and 4.1; \
         try `gmsh OLD.msh -save -format msh41 -o NEW.msh`"
    )]
    UnsupportedVersion {
        /// Place of the version.
        place: Place,
        /// The version.
        version: String,
    },
    /// Elements that cannot be cells of a body.
    #[error("{place}: elements of type {kind} are not supported; make the body of {supported}")]
    UnsupportedElement {
        /// Place of the first one.
        place: Place,
        /// Name of the type.
        kind: String,
        /// The supported types.
        supported: &'static str,
    },
    /// A count that exceeds the rest of the file.
    #[error(
        "{place}: {count} {what} are announced, but the rest of the file has room for at most {room}; \
         the file is damaged or cut off, write it again"
    )]
    Count {
        /// Place of the count.
        place: Place,
        /// The counted items.
        what: &'static str,
        /// The count.
        count: u64,
        /// Number that would fit.
        room: u64,
    },
    /// A repeated node or element number.
    #[error("{place}: {what} {number} exists already; renumber it, or remove the repetition")]
    Duplicate {
        /// Place of the second one.
        place: Place,
        /// `node` or `element`.
        what: &'static str,
        /// The number.
        number: u64,
    },
    /// An element with a node that the file does not define.
    #[error(
        "{place}: element {element} names node {node}, which the file does not define; write the mesh again"
    )]
    UnknownNode {
        /// Place of the element.
        place: Place,
        /// Number of the element.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// A node whose coordinates are NaN or infinite.
    #[error("{place}: node {node} has a coordinate that is not a finite number; correct it or mesh again")]
    CoordinateNotFinite {
        /// Place of the node.
        place: Place,
        /// Number of the node.
        node: u64,
    },
    /// A repeated cell, with its nodes in the same or in another order.
    #[error(
        "{}: {repeated} has the nodes of {first}; remove one of the two, or their stiffness and mass would add up",
        file.display()
    )]
    RepeatedCell {
        /// The file.
        file: PathBuf,
        /// The later one, by the file's own number.
        repeated: String,
        /// The earlier one.
        first: String,
    },
    /// A cell that is inverted or degenerate.
    #[error(
        "{}: {cell} ({kind}) is inverted or degenerate: det(dX/dxi) = {} at one of its points, and \
         the mirrored order of its nodes does not help; check its shape in the mesher", file.display(), short(.det)
    )]
    InvertedCell {
        /// The file.
        file: PathBuf,
        /// The cell, by the file's own number.
        cell: String,
        /// Kind of the cell.
        kind: emmy::mesh::CellKind,
        /// The smallest determinant.
        det: f64,
    },
    /// A file without cells.
    #[error("{}: the mesh has no solid or plane cells; {advice}", file.display())]
    NoCells {
        /// The file.
        file: PathBuf,
        /// Something to try.
        advice: &'static str,
    },
    /// A file whose elements are neither solid nor plane.
    #[error("{}: the file has no solid or plane cells, only {found}; {advice}", file.display())]
    NothingSolid {
        /// The file.
        file: PathBuf,
        /// Numbers and types of its elements.
        found: String,
        /// Something to try.
        advice: String,
    },
    /// Text or bytes that the format does not permit at this place.
    #[error("{place}: {problem}; {advice}")]
    Malformed {
        /// Place.
        place: Place,
        /// Reason.
        problem: String,
        /// Something to try.
        advice: &'static str,
    },
    /// A set, part, surface or coordinate system that the file does not define.
    #[error("{place}: {problem}; {advice}")]
    Undefined {
        /// Place that names it.
        place: Place,
        /// Reason.
        problem: String,
        /// Something to try.
        advice: &'static str,
    },
    /// Something is missing; lists the lines of the file that were not read and may be the cause.
    #[error("{error}; {suspects}")]
    Suspected {
        /// The error.
        error: Box<MeshError>,
        /// The lines that were not read.
        suspects: String,
    },
    /// A fault of an unstructured grid of VTK, in a file or in memory.
    #[error("{}: {problem}; {advice}", file.display())]
    Grid {
        /// The file, or the name of the grid.
        file: PathBuf,
        /// Reason.
        problem: String,
        /// Something to try.
        advice: &'static str,
    },
    /// A fault found by the checks of the mesh itself.
    #[error("{}: {reason}", file.display())]
    Mesh {
        /// The file.
        file: PathBuf,
        /// The error of the mesh.
        reason: emmy::Error,
    },
}

impl MeshError {
    /// Adds the lines that were not read to an error that something is missing.
    pub(super) fn with_suspects(self, suspects: Option<String>) -> Self {
        match (self, suspects) {
            (
                error @ (MeshError::UnknownNode { .. }
                | MeshError::NoCells { .. }
                | MeshError::NothingSolid { .. }
                | MeshError::Undefined { .. }),
                Some(suspects),
            ) => MeshError::Suspected { error: Box::new(error), suspects },
            (error, _) => error,
        }
    }
}
