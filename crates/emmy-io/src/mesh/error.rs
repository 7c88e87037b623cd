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

/// Error of a mesh file. Every message says what, where, and what to try; numbers are those of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A file that the system does not let us read.
    #[error("{}: cannot be read: {reason}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// A file of a format that is not known.
    #[error(
        "{}: not a mesh file of a known format; Emmy reads Gmsh (.msh, versions 2.2 and 4.1, ASCII or binary), \
         Abaqus (.inp) and VTK (.vtu)", file.display()
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
    },
    /// A file of a format of other programs that is not read.
    #[error(
        "{}: {format} is not read; {command}; Emmy reads Gmsh (.msh), Abaqus (.inp) and VTK (.vtu)", file.display()
    )]
    OtherFormat {
        /// The file.
        file: PathBuf,
        /// The format.
        format: &'static str,
        /// What converts it.
        command: String,
    },
    /// A file with elements of surfaces alone, which do not lie in a plane.
    #[error("{}: the file has {found} only and no solid cells, and they do not lie in one plane z = const ({place}); {advice}", file.display())]
    SurfaceAlone {
        /// The file.
        file: PathBuf,
        /// What there is.
        found: &'static str,
        /// The first node that is not in the plane.
        place: String,
        /// What to try.
        advice: &'static str,
    },
    /// A version of the MSH format that is not read.
    #[error(
        "{place}: version {version} of the MSH format is not read, only 2.2 and 4.1; \
         try `gmsh OLD.msh -save -format msh41 -o NEW.msh`"
    )]
    UnsupportedVersion {
        /// Where it says so.
        place: Place,
        /// The version.
        version: String,
    },
    /// Elements that are no cells that a body can be made of.
    #[error("{place}: elements of type {kind} are not supported; make the body of {supported}")]
    UnsupportedElement {
        /// Where they begin.
        place: Place,
        /// Name of the type.
        kind: String,
        /// What is supported.
        supported: &'static str,
    },
    /// A count that the rest of the file has no room for.
    #[error(
        "{place}: {count} {what} are announced, but the rest of the file has room for at most {room}; \
         the file is damaged or cut off, write it again"
    )]
    Count {
        /// Where the count stands.
        place: Place,
        /// What is counted.
        what: &'static str,
        /// The count.
        count: u64,
        /// How many would fit.
        room: u64,
    },
    /// A node or element number that was there before.
    #[error("{place}: {what} {number} is there already; renumber, or remove the repetition")]
    Duplicate {
        /// Where the second one stands.
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
        /// Where the element stands.
        place: Place,
        /// Number of the element.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// A node whose coordinates are NaN or infinite.
    #[error("{place}: node {node} has a coordinate that is not a finite number; correct it or mesh again")]
    CoordinateNotFinite {
        /// Where the node stands.
        place: Place,
        /// Number of the node.
        node: u64,
    },
    /// A facet of a group that is not a face of any cell.
    #[error(
        "{}: group \"{group}\": the facet with corner nodes {nodes:?} is not a face of any cell; \
         save the volume behind it too, with elements of the same mesh", file.display()
    )]
    FacetWithoutCell {
        /// The file.
        file: PathBuf,
        /// Name of the group.
        group: String,
        /// Corner nodes of the facet, as numbered in the file.
        nodes: Vec<u64>,
    },
    /// A cell that is there already, with its nodes in the same or in another order.
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
        "{}: {cell} ({kind}) is inverted or degenerate: det(dX/dxi) = {} at one of its points; check its \
         orientation (the order of its nodes) and its shape in the mesher", file.display(), short(.det)
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
        /// What to try.
        advice: &'static str,
    },
    /// Text or bytes that are not what the format wants in this place.
    #[error("{place}: {problem}; {advice}")]
    Malformed {
        /// Where.
        place: Place,
        /// What is wrong.
        problem: String,
        /// What to try.
        advice: &'static str,
    },
    /// What the checks of the mesh itself found.
    #[error("{}: {reason}", file.display())]
    Mesh {
        /// The file.
        file: PathBuf,
        /// The error of the mesh.
        reason: emmy::Error,
    },
}
