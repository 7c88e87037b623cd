//! Meshes of other programs: Gmsh (`.msh`), Abaqus (`.inp`), Nastran (`.bdf`) and VTK (`.vtu`, `.pvtu`, `.vtk`).

mod abaqus;
pub(crate) mod account;
mod entry;
mod error;
mod gmsh;
mod includes;
mod joined;
mod nastran;
mod other;
mod plane;
#[cfg(test)]
mod random_decks;
pub(crate) mod vtu;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::message::counted;
use emmy::internals::number::{short, short_vector};
use emmy::mesh::{Cell, CellKind, Mesh, MeshBuilder};

pub use entry::{DeckEntry, acting_entries};
pub use error::{MeshError, Place, Position};
pub use joined::joined;
pub use vtu::{Grid, GridArray, Numbers};

/// Kinds of cells in files, for messages.
fn kinds() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let names = |kinds: &[CellKind]| {
            let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
            let (last, first) = names.split_last().unwrap_or((&"", &[]));
            format!("{} or {last}", first.join(", "))
        };
        format!("{}, or in a plane of {}", names(&CellKind::SOLIDS), names(&CellKind::PLANES))
    });
    &TEXT
}

/// Number of a kind of cell in Gmsh, if it has one, and its types in Abaqus.
#[cfg(test)]
pub(crate) fn numbers(kind: CellKind) -> (Option<i64>, &'static [&'static str]) {
    (gmsh::number(kind), abaqus::types(kind))
}

/// Entries of each format, and what its reader does with them.
#[cfg(test)]
pub(crate) const ENTRIES: [(&str, &[account::Entries]); 4] =
    [("Gmsh", gmsh::TABLE), ("Abaqus", abaqus::TABLE), ("Nastran", nastran::TABLE), ("VTK", vtu::TABLE)];

type Result<T, E = MeshError> = std::result::Result<T, E>;

/// A mesh from a file, with remarks on how it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh; groups have the names of the file.
    pub mesh: Mesh,
    /// Sentences such as `C3D8R is read as hex8 and integrated fully`.
    pub notes: Vec<String>,
    /// Rigid elements, ties, masses, springs and joints of the file.
    pub entries: Vec<DeckEntry>,
    /// The source files: itself and its includes.
    pub files: Vec<PathBuf>,
}

impl MeshFile {
    /// The mesh with all lengths multiplied by a factor.
    ///
    /// # Errors
    /// As [`Mesh::scaled`].
    pub fn scaled(self, factor: f64) -> emmy::Result<Self> {
        let mesh = self.mesh.scaled(factor)?;
        Ok(MeshFile {
            mesh,
            entries: self.entries.into_iter().map(|own| own.scaled(factor)).collect(),
            ..self
        })
    }

    /// The mesh in which nodes at most a distance apart are one, with a note on their number.
    ///
    /// # Errors
    /// As [`Mesh::merged`]; [`emmy::Error::MergedCells`] if two cells, which are no links, would have the same nodes.
    pub fn merged(self, within: f64) -> emmy::Result<Self> {
        let (mesh, n) = self.mesh.merged(within)?;
        let is_link = |cell: u32| mesh.cell(cell as usize).kind.dimension() == 1;
        if let Some([first, repeated]) = mesh.repeated_cells().into_iter().find(|pair| !is_link(pair[0])) {
            return Err(emmy::Error::MergedCells { first, repeated, within });
        }
        let mut file = MeshFile { mesh, ..self };
        file.leave_out_joined(|_| false);
        file.notes.push(match n {
            0 => format!("merge = {}: no two nodes are so near", short(within)),
            n => counted(n, "node is merged with another one", "nodes are merged with others"),
        });
        Ok(file)
    }

    /// Leaves pairs of nodes that are joined out of the note on nodes at one position.
    pub(crate) fn leave_out_joined(&mut self, is_joined: impl Fn([u32; 2]) -> bool) {
        let Some(at) = self.notes.iter().position(|note| note.ends_with(NOT_JOINED)) else { return };
        self.notes.splice(at..=at, note_on_coincident_nodes(&self.mesh, is_joined));
    }

    /// Replaces the number of nodes in the note on those of no cell by the number of those that nothing else uses.
    fn count_unused(&mut self, of_no_cell: usize, unused: usize) {
        let note = note_on_unused(of_no_cell);
        let Some(at) = self.notes.iter().position(|own| Some(own) == note.as_ref()) else { return };
        self.notes.splice(at..=at, note_on_unused(unused));
    }
}

/// How a file is read where its format leaves a choice.
///
/// ```
/// let options = emmy_io::mesh::MeshOptions { plane_shells: true, ..Default::default() };
/// let sheet = b"GRID,1\nGRID,2,,2.\nGRID,3,,2.,1.\nGRID,4,,,1.\nCQUAD4,1,7,1,2,3,4\nPSHELL,7,1,.01,1\nENDDATA\n";
/// let file = emmy_io::mesh::parse_with("sheet.bdf".as_ref(), sheet, &options)?;
/// assert_eq!(file.mesh.cell(0).kind, emmy::mesh::CellKind::Quad4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MeshOptions {
    /// Groups whose lines of two nodes are cells (line2), not edges. In an Abaqus file without other cells all of them
    /// (T3D2, T2D2, CONN3D2, SPRINGA) are cells.
    pub links: Vec<String>,
    /// Whether the shells of a file without solid cells are cells in plane strain; without it they are an error.
    pub plane_shells: bool,
}

/// Mesh in a file of Gmsh (MSH 1, 2.0 to 2.2, 4.0 or 4.1, ASCII or binary), of Abaqus (keyword input), of Nastran (bulk
/// data) or of VTK (unstructured grid in XML, ASCII or binary, appended or not, with or without zlib compression, its
/// pieces joined; and legacy files, ASCII or binary).
///
/// Gmsh: physical volumes become cell groups, physical surfaces facet groups, physical curves and points node groups. A
/// physical group without a name is named by its number. Volume elements without a group are kept. Surface elements
/// that are no face of a cell are left out, with a note; their nodes stay a group, in all formats.
///
/// Abaqus: element sets become cell groups, node sets node groups, surfaces facet groups (node surfaces: node groups).
/// A set of a part is available under its own name (in all instances together) and as `Instance.Set`; the cells of an
/// instance form a group of the instance's name. Constraints, masses, springs and connectors become
/// [`MeshFile::entries`]. Other elements that are not solid, such as beams or shells that are no faces of cells, are
/// left out and counted; a set of them is a group of nodes.
///
/// Nastran: elements with a property form a group of the name that a preprocessor gave it in a comment, else `pid_3`;
/// shells are faces of solid cells, bars the nodes at their ends. The grid points of `SPC` and `SPC1` form the group
/// `spc_SET`. Rigid elements, masses, springs and equations are [`MeshFile::entries`], with notes on those that are
/// left out, and why. Other cards that are left out are counted in notes.
///
/// A file without solid cells is a body in plane strain: its triangles and quadrilaterals are the cells (groups of
/// surfaces are cell groups), its lines their facets (groups of curves are facet groups). They must lie in one plane
/// `z = const`.
///
/// VTK: arrays of whole numbers, also if they are stored as real numbers, become groups. `group:NAME`: its cells, its
/// facets (faces that are cells of the file) and the nodes of other cells, wherever it is not 0; as point data, nodes.
/// `facets:NAME`: bit i of a cell denotes its face i. Any other array with up to 64 values: groups called
/// `ARRAY=VALUE`. A note names the other arrays. Emmy's own frames keep all their groups. Cells of lower dimension that
/// are no faces or edges of the body are left out, with a note.
///
/// Cells whose nodes are numbered the other way round are turned, with a note
/// ([`emmy::mesh::MeshBuilder::orient_cells`]). Other inverted cells and repeated ones are errors. Nodes at one
/// position are noted.
///
/// # Errors
/// [`MeshError`]: file unreadable, of unknown format or damaged; elements of other kinds than [`emmy::mesh::CellKind`].
pub fn read(path: &Path) -> Result<MeshFile> {
    read_with(path, &MeshOptions::default())
}

/// As [`read`], with options.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: &Path, options: &MeshOptions) -> Result<MeshFile> {
    let bytes = crate::whole_file::read(path)
        .map_err(|reason| MeshError::Unreadable { file: path.to_path_buf(), reason })?;
    parse_with(path, &bytes, options)
}

/// Mesh in the bytes of a file, as [`read`]; `path` is its name in messages and the base of its includes.
///
/// ```
/// let deck = b"*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n";
/// let file = emmy_io::mesh::parse("tet.inp".as_ref(), deck)?;
/// assert_eq!(file.mesh.groups().cells("body")?, [0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<MeshFile> {
    parse_with(path, bytes, &MeshOptions::default())
}

/// Mesh in the bytes of a file, as [`read_with`].
///
/// # Errors
/// As [`read`].
pub fn parse_with(path: &Path, bytes: &[u8], options: &MeshOptions) -> Result<MeshFile> {
    if let Some(error) = other::format(path) {
        return Err(error);
    }
    if bytes.trim_ascii().is_empty() {
        return Err(MeshError::Malformed {
            place: Place::line(path, 1),
            problem: "the file is empty".to_string(),
            advice: "write the mesh again",
        });
    }
    let format = format(path, bytes);
    let mut file = match format {
        Some(Format::Gmsh) => gmsh::mesh(path, bytes, &options.links),
        Some(Format::Abaqus) => abaqus::mesh(path, bytes, options),
        Some(Format::Vtu) => vtu::mesh(path, bytes, &options.links),
        Some(Format::Vtk) => vtu::legacy(path, bytes, &options.links),
        Some(Format::Nastran) => nastran::mesh(path, bytes, options),
        None => Err(MeshError::UnknownFormat { file: path.to_path_buf() }),
    }?;
    if options.plane_shells && matches!(format, Some(Format::Gmsh | Format::Vtu | Format::Vtk)) {
        let note = "`shells` has no effect on files of Gmsh and VTK: without solid cells, their surfaces are cells in plane strain";
        file.notes.push(note.to_string());
    }
    Ok(file)
}

/// Mesh of an unstructured grid, with the groups that [`read`] takes from the arrays of a file of VTK; `name` stands
/// for the grid in messages, and lines of two nodes in the groups `links` are cells. If the grid has only lines, all
/// are cells, with the group `links`.
///
/// # Errors
/// As [`read`].
pub fn from_grid(name: &Path, grid: Grid, links: &[String]) -> Result<MeshFile> {
    vtu::of_grid(name, grid, links)
}

/// Mesh of arrays in memory, with the checks and the notes of [`read`] after those that are given; `name` stands for
/// the arrays in messages. Nodes that no cell uses are left out; a note says which node is the first with another
/// number.
///
/// ```
/// let mut builder = emmy::mesh::MeshBuilder::new();
/// for point in [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
///     builder.point(point);
/// }
/// builder.cell(emmy::mesh::CellKind::Tet4, &[1, 2, 3, 4])?;
/// builder.node_group("tip", [4]);
/// let file = emmy_io::mesh::from_builder("the arrays".as_ref(), builder, Vec::new())?;
/// assert_eq!(file.mesh.groups().nodes["tip"], [3]);
/// assert!(file.notes[0].starts_with("1 node belongs to no cell"));
/// assert!(file.notes[1].starts_with("node 1 is now node 0"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`read`].
pub fn from_builder(name: &Path, builder: MeshBuilder, notes: Vec<String>) -> Result<MeshFile> {
    let is_used = builder.used_points();
    let cell = |cell: usize| format!("cell {cell}");
    let origin = Origin { file: name, n_nodes: is_used.len(), name: &cell };
    let mut file = finished(builder, &origin, notes)?;
    let next_to = |unused: usize| Some(unused + is_used[unused..].iter().position(|is_used| *is_used)?);
    let unused = is_used.iter().position(|is_used| !is_used);
    if let Some((next, unused)) = unused.and_then(|unused| Some((next_to(unused)?, unused))) {
        let rest = "without the nodes that are left out the later ones have other numbers; groups follow";
        file.notes.push(format!("node {next} is now node {unused}: {rest}"));
    }
    Ok(file)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Gmsh,
    Abaqus,
    Vtu,
    Vtk,
    Nastran,
}

/// Format by the first character, unless the extension belongs to another known format; otherwise by the extension, so
/// that the reader of that format writes the message.
fn format(path: &Path, bytes: &[u8]) -> Option<Format> {
    let extension = || Some(path.extension()?.to_str()?.to_ascii_lowercase());
    if extension().is_some_and(|extension| ["bdf", "nas", "fem"].contains(&&*extension)) {
        return Some(Format::Nastran);
    }
    match without_mark(bytes).trim_ascii_start().first() {
        // A comment of Nastran, whose files often are called .dat.
        Some(b'$') if extension().is_some_and(|extension| extension == "dat") && !has_sections(bytes) => {
            return Some(Format::Nastran);
        }
        Some(b'$') => return Some(Format::Gmsh),
        Some(b'*') => return Some(Format::Abaqus),
        Some(b'<') => return Some(Format::Vtu),
        Some(b'#') if bytes.starts_with(b"# vtk") => return Some(Format::Vtk),
        _ => {}
    }
    match extension()?.as_str() {
        "msh" => Some(Format::Gmsh),
        "inp" => Some(Format::Abaqus),
        "vtu" | "pvtu" => Some(Format::Vtu),
        "vtk" => Some(Format::Vtk),
        "dat" => Some(Format::Nastran),
        _ => None,
    }
}

/// Whether a text begins with a section of Gmsh.
fn has_sections(bytes: &[u8]) -> bool {
    let text = without_mark(bytes).trim_ascii_start();
    [&b"$MeshFormat"[..], b"$Comments", b"$NOD"].iter().any(|section| text.starts_with(section))
}

/// Bytes after the byte order mark that some editors write before UTF-8 text.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// End of the note on a group without nodes of cells.
const EMPTY: &str = "\" has no node of a cell";

/// Data of the file for the check of a mesh.
struct Origin<'a> {
    file: &'a Path,
    /// Number of nodes in the file.
    n_nodes: usize,
    /// The cell with an index, by the file's own number: `element 17`.
    name: &'a dyn Fn(usize) -> String,
}

/// Builds the mesh, checks its cells, and notes omitted parts.
fn finished(mut builder: MeshBuilder, origin: &Origin<'_>, mut notes: Vec<String>) -> Result<MeshFile> {
    let file = || origin.file.to_path_buf();
    let turned = builder.orient_cells();
    notes.extend(note_on_free_facets(&builder.drop_free_facets()));
    let mesh = builder.build().map_err(|reason| MeshError::Mesh { file: file(), reason })?;
    check_cells(&mesh, origin)?;
    notes.extend(note_on_turned_cells(&mesh, turned));
    notes.extend(note_on_unused(origin.n_nodes - mesh.n_nodes()));
    for (name, _) in mesh.groups().nodes.iter().filter(|(_, nodes)| nodes.is_empty()) {
        notes.push(format!("node group \"{name}{EMPTY}"));
    }
    notes.extend(note_on_coincident_nodes(&mesh, |_| false));
    notes.extend(note_on_collapsed_cells(&mesh, origin));
    Ok(MeshFile { mesh, notes, entries: Vec::new(), files: vec![file()] })
}

/// A note on nodes that no cell has.
fn note_on_unused(n: usize) -> Option<String> {
    let [one, many] = ["node belongs to no cell and is left out", "nodes belong to no cell and are left out"];
    (n > 0).then(|| counted(n, one, many))
}

/// A note on cells that [`MeshBuilder::orient_cells`] has turned, if there are any.
fn note_on_turned_cells(mesh: &Mesh, turned: usize) -> Option<String> {
    let how =
        if mesh.cells().all(|cell| cell.kind.dimension() < 3) { "clockwise" } else { "negative volume" };
    let order = format!("numbered the other way round ({how})");
    match turned {
        0 => None,
        n if n == mesh.n_cells() && n > 1 => Some(format!(
            "all {n} cells are {order} and were turned; if a coordinate has changed its sign, the body is a mirror image"
        )),
        n => Some(format!("{} {order} and turned", counted(n, "cell was", "cells were"))),
    }
}

/// A note on surface elements (in a plane: lines) that are no face of a cell.
fn note_on_free_facets(dropped: &BTreeMap<String, usize>) -> Option<String> {
    note_on_free(dropped, ["facet is no face", "facets are no faces"], "a shell")
}

/// A note on lines that are no edge of a solid cell, counted by their groups.
fn note_on_free_lines(dropped: &BTreeMap<String, usize>) -> Option<String> {
    note_on_free(dropped, ["line is no edge", "lines are no edges"], "a beam")
}

fn note_on_free(dropped: &BTreeMap<String, usize>, [one, many]: [&str; 2], such: &str) -> Option<String> {
    const MAX_NAMES: usize = 10;
    let n: usize = dropped.values().sum();
    let names: Vec<String> = dropped.keys().take(MAX_NAMES).map(|name| format!("\"{name}\"")).collect();
    let more = dropped.len().saturating_sub(MAX_NAMES);
    let rest = if more > 0 { format!(" and {more} others") } else { String::new() };
    let left_out =
        format!("of a cell, such as {such}, and left out; their nodes stay in the groups of nodes");
    (n > 0).then(|| format!("{} {left_out} {}{rest}", counted(n, one, many), names.join(", ")))
}

/// Cells must not be repeated or inverted.
fn check_cells(mesh: &Mesh, origin: &Origin<'_>) -> Result<()> {
    let file = || origin.file.to_path_buf();
    let name = |cell: u32| (origin.name)(cell as usize);
    if let Some(&[first, repeated]) = mesh.repeated_cells().first() {
        return Err(MeshError::RepeatedCell { file: file(), repeated: name(repeated), first: name(first) });
    }
    emmy::mesh::check(mesh).map_err(|reason| match reason {
        emmy::Error::InvertedCell { cell, kind, det } => {
            MeshError::InvertedCell { file: file(), cell: name(cell as u32), kind, det }
        }
        reason => MeshError::Mesh { file: file(), reason },
    })
}

/// End of the note on nodes at one position.
const NOT_JOINED: &str = "cells on both sides are not joined there";

/// Nodes at one position belong to contact or cracks, or to a mesh that was not joined. A function says which pairs
/// something else joins.
fn note_on_coincident_nodes(mesh: &Mesh, is_joined: impl Fn([u32; 2]) -> bool) -> Option<String> {
    let mut pairs = mesh.coincident_nodes();
    pairs.retain(|pair| !is_joined(*pair));
    let place = short_vector(mesh.points()[pairs.first()?[1] as usize]);
    let lie = counted(pairs.len(), "node lies", "nodes lie");
    Some(format!("{lie} where another one does, the first at {place}: {NOT_JOINED}"))
}

/// Cells with two corners at one position are integrated as they are, although they were probably meant as wedges or
/// pyramids.
fn note_on_collapsed_cells(mesh: &Mesh, origin: &Origin<'_>) -> Option<String> {
    let is_collapsed = |cell: &Cell<'_>| {
        let corners = &cell.nodes[..cell.kind.n_corners()];
        let place = |node: &u32| mesh.points()[*node as usize];
        corners.iter().enumerate().any(|(i, a)| corners[..i].iter().any(|b| place(a) == place(b)))
    };
    let mut collapsed = mesh.cells().enumerate().filter(|(_, cell)| is_collapsed(cell));
    let (first, cell) = collapsed.next()?;
    let have = counted(1 + collapsed.count(), "cell has", "cells have");
    let name = (origin.name)(first);
    let kind = cell.kind;
    Some(format!(
        "{have} two corners at one place (aspect ratio inf), the first is {name} ({kind}); is another kind of cell meant?"
    ))
}
