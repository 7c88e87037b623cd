//! `[mesh]`: a built-in shape, a mesh file, or several of them as parts.

mod built_in;
mod network;
mod parts;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::mesh::Mesh;

use self::built_in::{BuiltIn, SHAPES, with_shapes};
use self::parts::Part;
pub(super) use self::parts::{PARTS, TURN};
use super::description::{Described, Key, Kind, POSITIVE, Section, list, word};
use super::fault::{Fault, Place};
use super::finite;
use super::suggest::nearest;
use super::table::{Read, Table};
use crate::mesh::{MeshFile, MeshOptions};

/// `[mesh]`.
pub(super) static MESH: Described = Described::new(|| {
    let section = Section::new("[mesh]", "Where the cells come from: exactly one source");
    with_file(with_shapes(section))
        .may(
            "parts",
            list(1, Kind::Table(&PARTS)),
            "",
            "Several bodies, each with a source and a place of its own; groups `NAME` of all cells of a part, and \
             `NAME-GROUP` of each of its groups",
        )
        .exactly_one(&[&SHAPES[..], &["file", "parts"]].concat())
        .may("scale", POSITIVE, "", "Factor on all coordinates")
        .absent("1")
        .may(
            "merge",
            POSITIVE,
            "length",
            "Nodes at most this far apart, after `scale`, become one, so that the cells on both sides are joined",
        )
        .absent("none")
        .may("shells", word("a treatment of shells", [PLANE_STRAIN]), "", SHELLS)
        .absent("an error")
        .may(
            "leave_out",
            list(0, Kind::Text),
            "",
            "Names of rigid elements, couplings, ties, masses, springs and joints of a Nastran or Abaqus file that do not act; \
             `emmy check` lists all",
        )
        .absent("all act")
});

/// Group of all links of a mesh in memory.
pub(super) const LINKS: &str = "links";

/// Word of `shells`.
const PLANE_STRAIN: &str = "plane-strain";

const SHELLS: &str = "What the shells of a Nastran or Abaqus file without solid cells are: cells in plane strain, without their thickness";

/// Adds the key of a mesh file to a table.
fn with_file(section: Section) -> Section {
    section.may(
        "file",
        Kind::Text,
        "",
        "A mesh file, its path relative to the input file: Gmsh `.msh` (1 to 4.1), Abaqus `.inp`, Nastran `.bdf` or VTK `.vtu`, `.pvtu`, `.vtk`; groups by their names in the file",
    )
}

/// Sources of meshes with a line on each, for `emmy list meshes`.
pub fn meshes() -> Vec<(&'static str, String)> {
    let line = |key: &Key| match key.kind.section() {
        Some(section) => {
            let keys: Vec<&str> = section.names().collect();
            format!("{}; keys {}", key.doc, keys.join(", "))
        }
        None => key.doc.clone(),
    };
    let sources = MESH.choice().into_iter().filter_map(|name| MESH.key_of(name));
    sources.map(|key| (key.name, line(key).replace('`', ""))).collect()
}

/// Where the mesh comes from.
#[derive(Debug)]
pub(super) struct Shape {
    source: Source,
    /// Place of the source's value.
    place: Place,
    scale: Option<f64>,
    /// Largest distance of nodes that become one.
    merge: Option<(f64, Place)>,
    /// Whether shells of a file are cells in plane strain.
    plane_shells: bool,
    /// Names of the entries of the file that `leave_out` switches off, with their places.
    left_out: Vec<(String, Place)>,
}

#[derive(Debug)]
enum Source {
    BuiltIn(BuiltIn),
    File(PathBuf),
    Parts(Vec<Part>),
    /// A mesh in memory.
    Given(Arc<Mesh>),
    /// No cells: all bodies are rigid.
    Nothing,
}

/// Path of a mesh file in the input.
#[derive(Debug)]
pub(super) struct MeshPath {
    /// The part whose file it is, counted from 0; `None`: of the whole mesh.
    pub(super) part: Option<usize>,
    /// The file, valid in any working directory.
    pub(super) file: PathBuf,
}

/// A mesh in memory.
pub(super) fn given(mesh: &Arc<Mesh>, place: &Place) -> Shape {
    Shape::of(Source::Given(mesh.clone()), place.clone())
}

/// No cells: the place is that of the rigid bodies.
pub(super) fn without_cells(place: &Place) -> Shape {
    Shape::of(Source::Nothing, place.clone())
}

/// Reads the table; paths are relative to `directory`.
pub(super) fn read(table: &Table<'_>, directory: &Path) -> Result<Shape, Fault> {
    let item = table.chosen();
    let source = match BuiltIn::read(item)? {
        Some(shape) => Source::BuiltIn(shape),
        None if item.key == "parts" => Source::Parts(parts::read(item, directory)?),
        None => Source::File(directory.join(<&str>::read(item))),
    };
    let shells = table.item("shells");
    if let Some(shells) = shells.filter(|_| !source.has_file()) {
        let message = "`shells` is a key of mesh files; a built-in mesh has none";
        return Err(shells.fault(message, "of no use here"));
    }
    let left_out = table.item("leave_out").map(|list| list.items()).unwrap_or_default();
    let left_out = left_out.iter().map(|item| (item.name(), item.place().clone())).collect();
    let place = item.place().clone();
    let scale = table.may("scale");
    let merge = table.item("merge").map(|item| (Read::read(item), item.place().clone()));
    Ok(Shape { scale, merge, plane_shells: shells.is_some(), left_out, ..Shape::of(source, place) })
}

/// The intended file in the folder of a missing path: one with a similar name, or with the name and an extension.
pub(super) fn neighbour(path: &Path) -> Option<String> {
    if path.exists() {
        return None;
    }
    let folder = path.parent()?;
    let wanted = path.file_name()?.to_str()?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let names =
        std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let names: Vec<String> = names.collect();
    let with_suffix =
        names.iter().find(|name| name.strip_prefix(wanted).is_some_and(|rest| rest.starts_with('.')));
    with_suffix.cloned().or_else(|| nearest(wanted, names.iter().map(String::as_str)).map(str::to_string))
}

/// Advice on an inverted cell of a file.
const INVERTED: &str =
    "cells count from 0 in the order of the file; check the shape of this one in the mesher";

impl Source {
    fn has_file(&self) -> bool {
        match self {
            Source::File(_) => true,
            Source::Parts(parts) => parts.iter().any(|part| part.file().is_some()),
            Source::BuiltIn(_) | Source::Given(_) | Source::Nothing => false,
        }
    }
}

/// The mesh of a built-in shape, with its remarks.
fn of_shape(shape: &BuiltIn, place: &Place) -> Result<MeshFile, Fault> {
    of_mesh(shape.mesh(), shape.notes().to_vec(), place)
}

fn of_mesh(mesh: emmy::Result<Mesh>, notes: Vec<String>, place: &Place) -> Result<MeshFile, Fault> {
    let mesh = mesh.map_err(|error| from_here(place, &error))?;
    Ok(MeshFile { mesh, notes, entries: Vec::new(), files: Vec::new() })
}

/// The mesh of a file.
fn of_file(path: &Path, options: &MeshOptions, place: &Place) -> Result<MeshFile, Fault> {
    crate::mesh::read_with(path, options).map_err(|error| match neighbour(path) {
        Some(name) => from_here(place, &error).help(format!("did you mean `{name}`?")),
        None => from_here(place, &error),
    })
}

fn from_here(place: &Place, error: &dyn std::fmt::Display) -> Fault {
    Fault::at(place, error.to_string(), "from here")
}

impl Shape {
    fn of(source: Source, place: Place) -> Self {
        Shape { source, place, scale: None, merge: None, plane_shells: false, left_out: Vec::new() }
    }

    /// The mesh, scaled and merged, with the remarks of its reader. Lines of a file in one of the groups `links` are
    /// cells.
    pub(super) fn mesh(&self, links: &[String]) -> Result<MeshFile, Fault> {
        let place = &self.place;
        let options = MeshOptions { links: links.to_vec(), plane_shells: self.plane_shells };
        let file = match &self.source {
            Source::BuiltIn(shape) => of_shape(shape, place),
            Source::File(path) => of_file(path, &options, place),
            Source::Parts(parts) => parts::mesh(parts, &options, place),
            Source::Given(mesh) => {
                of_mesh(emmy::mesh::check(mesh).map(|()| Mesh::clone(mesh)), Vec::new(), place)
            }
            Source::Nothing => of_mesh(Ok(Mesh::without_cells()), Vec::new(), place),
        }?;
        let file = match self.scale {
            Some(scale) => file.scaled(scale).map_err(|error| from_here(place, &error))?,
            None => file,
        };
        if file.mesh.n_cells() > 0 {
            finite::check_extent(&file.mesh, &self.place)?;
        }
        let Some((within, place)) = &self.merge else { return Ok(file) };
        file.merged(*within).map_err(|error| Fault::at(place, error.to_string(), "this distance"))
    }

    /// Place of its source.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// Names of the entries of the file that `leave_out` switches off, with their places.
    pub(super) fn left_out(&self) -> &[(String, Place)] {
        &self.left_out
    }

    /// The mesh in memory, if it is the source.
    pub(super) fn given(&self) -> Option<&Arc<Mesh>> {
        match &self.source {
            Source::Given(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// The fault of a mesh that cannot become a body.
    pub(super) fn fault(&self, error: &emmy::Error) -> Fault {
        let Source::File(path) = &self.source else {
            let label = if matches!(self.source, Source::Nothing) { "these bodies" } else { "this mesh" };
            return Fault::at(&self.place, error.to_string(), label);
        };
        let fault = Fault::at(&self.place, format!("{}: {error}", path.display()), "this mesh");
        match error {
            emmy::Error::InvertedCell { .. } => fault.help(INVERTED),
            _ => fault,
        }
    }

    /// The mesh files.
    pub(super) fn files(&self) -> Vec<MeshPath> {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        match &self.source {
            Source::File(path) => vec![MeshPath { part: None, file: absolute(path) }],
            Source::Parts(parts) => {
                let files = parts.iter().enumerate().filter_map(|(part, own)| Some((part, own.file()?)));
                files.map(|(part, file)| MeshPath { part: Some(part), file: absolute(file) }).collect()
            }
            Source::BuiltIn(_) | Source::Given(_) | Source::Nothing => Vec::new(),
        }
    }
}
