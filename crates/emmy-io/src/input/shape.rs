//! `[mesh]`: a built-in shape or a mesh file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use emmy::internals::mesh::check_count;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};

use super::description::{Described, Key, Kind, POSITIVE, Section, exactly, list, vector, whole, word};
use super::fault::{Fault, Place};
use super::finite;
use super::suggest::nearest;
use super::table::{Item, Read, Table};
use crate::mesh::{MeshFile, MeshOptions};
use crate::message;

/// `[mesh]`.
pub(super) static MESH: Described = Described::new(|| {
    Section::new("[mesh]", "Where the cells come from: exactly one source")
        .may(
            "l-block",
            Kind::Table(&L_BLOCK),
            "",
            "The L-shaped block of Betsch and Steinmann (2001): 10 long, 6 wide, 3 thick; groups `body`, `face-a` (y = 10), `face-b` (x = 6)",
        )
        .may(
            "box",
            Kind::Table(&BOX),
            "",
            "A block of hex8 cells with a corner at the origin; groups `body`, `x-min`, `x-max`, `y-min`, `y-max`, `z-min`, `z-max`",
        )
        .may(
            "rectangle",
            Kind::Table(&RECTANGLE),
            "",
            "A body in plane strain: quad4 cells in the plane z = 0 with a corner at the origin; groups `body`, `x-min`, `x-max`, `y-min`, `y-max`",
        )
        .may(
            "network",
            Kind::Table(&NETWORK),
            "",
            "Links between points, for masses on springs, trusses, bodies in space; group `links` of all of them",
        )
        .may(
            "file",
            Kind::Text,
            "",
            "A mesh file, its path relative to the input file: Gmsh `.msh` (1 to 4.1), Abaqus `.inp`, Nastran `.bdf` or VTK `.vtu`, `.pvtu`, `.vtk`; groups by their names in the file",
        )
        .exactly_one(&["l-block", "box", "rectangle", "network", "file"])
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

/// Word of `shells`.
const PLANE_STRAIN: &str = "plane-strain";

const SHELLS: &str = "What the shells of a Nastran or Abaqus file without solid cells are: cells in plane strain, without their thickness";

static L_BLOCK: Described = Described::new(|| {
    Section::new("l-block", "L-shaped block").must(
        "cell_size",
        POSITIVE,
        "length",
        "Edge of its hex8 cells: 1, 1/2, 1/3, ...",
    )
});

static BOX: Described = Described::new(|| {
    Section::new("box", "Block of hex8 cells")
        .must("size", exactly(3, POSITIVE), "length", "Its three edges")
        .must("cells", exactly(3, whole(1)), "", "Number of cells along each edge")
});

static RECTANGLE: Described = Described::new(|| {
    Section::new("rectangle", "Rectangle of quad4 cells")
        .must("size", exactly(2, POSITIVE), "length", "Its two edges")
        .must("cells", exactly(2, whole(1)), "", "Number of cells along each edge")
});

static NETWORK: Described = Described::new(|| {
    Section::new("network", "Links between points")
        .must("points", list(0, vector()), "length", "Positions of the points, counted from 0")
        .must("links", list(1, exactly(2, whole(0))), "", "Pairs of points, such as `[[0, 1], [1, 2]]`")
        .may(
            "groups",
            Kind::Groups,
            "",
            "Groups of points by name, such as `{ star = [0], planets = [1, 2] }`",
        )
        .may("link_groups", Kind::Groups, "", "Groups of links by name, counted from 0")
});

/// Sources of meshes with a line on each, for `emmy list meshes`.
pub fn meshes() -> Vec<(&'static str, String)> {
    let line = |key: &Key| match &key.kind {
        Kind::Table(section) => {
            let keys: Vec<&str> = section.names().collect();
            format!("{}; keys {}", key.doc, keys.join(", "))
        }
        _ => key.doc.clone(),
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
    LBlock {
        cell_size: f64,
    },
    Box {
        size: [f64; 3],
        cells: [usize; 3],
    },
    Rectangle {
        size: [f64; 2],
        cells: [usize; 2],
    },
    Network(Network),
    File(PathBuf),
    /// A mesh in memory.
    Given(Arc<Mesh>),
    /// No cells: all bodies are rigid.
    Nothing,
}

/// Points, links between them, and named groups of both.
#[derive(Debug)]
struct Network {
    points: Vec<[f64; 3]>,
    links: Vec<[u32; 2]>,
    groups: Vec<(String, Vec<u32>)>,
    link_groups: Vec<(String, Vec<u32>)>,
    notes: Vec<String>,
}

impl Network {
    fn read(table: Table<'_>) -> Result<Self, Fault> {
        let points: Vec<[f64; 3]> = table.must("points");
        let links: Vec<Item<'_>> = table.must("links");
        let links = links.iter().map(|item| link(item, points.len())).collect::<Result<Vec<_>, _>>()?;
        let groups = |key: &str, what: &str, n: usize| -> Result<Vec<(String, Vec<u32>)>, Fault> {
            let items = table.item(key).map(|item| item.items()).unwrap_or_default();
            items.iter().map(|item| Ok((item.key.to_string(), members(item, what, n)?))).collect()
        };
        let groups_of_links = groups("link_groups", "links", links.len())?;
        let groups = groups("groups", "points", points.len())?;
        let names = groups.iter().chain(&groups_of_links).map(|(name, _)| name);
        let notes = names.filter_map(|name| message::note_on_name(name)).collect();
        let read = |groups: Vec<(String, Vec<u32>)>| {
            groups.into_iter().map(|(name, members)| (message::name(&name).into_owned(), members)).collect()
        };
        Ok(Network { groups: read(groups), link_groups: read(groups_of_links), points, links, notes })
    }

    fn mesh(&self) -> emmy::Result<Mesh> {
        let mut builder = MeshBuilder::new();
        self.points.iter().for_each(|&point| {
            builder.point(point);
        });
        for link in &self.links {
            builder.cell(CellKind::Line2, link)?;
        }
        builder.cell_group("links", 0..self.links.len() as u32);
        self.groups.iter().for_each(|(name, nodes)| builder.node_group(name, nodes.iter().copied()));
        self.link_groups.iter().for_each(|(name, links)| builder.cell_group(name, links.iter().copied()));
        let mesh = builder.build()?;
        emmy::mesh::check(&mesh)?;
        Ok(mesh)
    }
}

/// A link between two points.
fn link(item: &Item<'_>, n_points: usize) -> Result<[u32; 2], Fault> {
    let [a, b]: [usize; 2] = Read::read(*item);
    if a == b {
        return Err(item.fault(format!("a link from point {a} to itself"), "two different points"));
    }
    within(item, a.max(b), "points", n_points)?;
    Ok([a as u32, b as u32])
}

fn within(item: &Item<'_>, number: usize, what: &str, n: usize) -> Result<(), Fault> {
    if number < n {
        return Ok(());
    }
    Err(item.fault(format!("there is no number {number} among the {n} {what}, counted from 0"), "too large"))
}

fn members(group: &Item<'_>, what: &str, n: usize) -> Result<Vec<u32>, Fault> {
    let number = |item: &Item<'_>| {
        let number = usize::read(*item);
        within(item, number, what, n)?;
        Ok(number as u32)
    };
    group.items().iter().map(number).collect()
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
    let source = match item.key {
        "l-block" => l_block(Table::read(item))?,
        "box" => {
            let (size, cells) = size_and_cells(Table::read(item))?;
            Source::Box { size, cells }
        }
        "rectangle" => {
            let (size, cells) = size_and_cells(Table::read(item))?;
            Source::Rectangle { size, cells }
        }
        "network" => Source::Network(Network::read(Table::read(item))?),
        _ => Source::File(directory.join(<&str>::read(item))),
    };
    let shells = table.item("shells");
    if let Some(shells) = shells.filter(|_| !matches!(source, Source::File(_))) {
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

fn l_block(table: Table<'_>) -> Result<Source, Fault> {
    let cell_size: f64 = table.must("cell_size");
    few_cells(117.0 / cell_size.powi(3), &table.must("cell_size"))?;
    Ok(Source::LBlock { cell_size })
}

/// Edges and numbers of cells along them.
fn size_and_cells<const N: usize>(table: Table<'_>) -> Result<([f64; N], [usize; N]), Fault> {
    let counts: [usize; N] = table.must("cells");
    few_cells(counts.iter().map(|&n| n as f64).product(), &table.must("cells"))?;
    Ok((table.must("size"), counts))
}

fn few_cells(count: f64, item: &Item<'_>) -> Result<(), Fault> {
    check_count(count).map_err(|error| item.fault(error.to_string(), "too many cells"))
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

impl Shape {
    fn of(source: Source, place: Place) -> Self {
        Shape { source, place, scale: None, merge: None, plane_shells: false, left_out: Vec::new() }
    }

    /// The mesh, scaled and merged, with the remarks of its reader. Lines of a file in one of the groups `links` are
    /// cells.
    pub(super) fn mesh(&self, links: &[String]) -> Result<MeshFile, Fault> {
        let at = |error: &dyn std::fmt::Display| Fault::at(&self.place, error.to_string(), "from here");
        let made = |mesh: emmy::Result<Mesh>, notes| -> Result<MeshFile, Fault> {
            let mesh = mesh.map_err(|error| at(&error))?;
            Ok(MeshFile { mesh, notes, entries: Vec::new(), files: Vec::new() })
        };
        let file = match &self.source {
            Source::LBlock { cell_size } => made(emmy::mesh::l_block(*cell_size), Vec::new()),
            Source::Box { size, cells } => made(emmy::mesh::block(*size, *cells), Vec::new()),
            Source::Rectangle { size, cells } => made(emmy::mesh::rectangle(*size, *cells), Vec::new()),
            Source::Network(network) => made(network.mesh(), network.notes.clone()),
            Source::Given(mesh) => made(emmy::mesh::check(mesh).map(|()| Mesh::clone(mesh)), Vec::new()),
            Source::Nothing => made(Ok(Mesh::without_cells()), Vec::new()),
            Source::File(path) => {
                let options = MeshOptions { links: links.to_vec(), plane_shells: self.plane_shells };
                crate::mesh::read_with(path, &options).map_err(|error| match neighbour(path) {
                    Some(name) => at(&error).help(format!("did you mean `{name}`?")),
                    None => at(&error),
                })
            }
        }?;
        let file = match self.scale {
            Some(scale) => file.scaled(scale).map_err(|error| at(&error))?,
            None => file,
        };
        if file.mesh.n_cells() > 0 {
            finite::check_extent(&file.mesh, &self.place)?;
        }
        match &self.merge {
            Some((within, place)) => {
                file.merged(*within).map_err(|error| Fault::at(place, error.to_string(), "this distance"))
            }
            None => Ok(file),
        }
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

    /// The mesh file as a path that is valid in any working directory.
    pub(super) fn absolute_file(&self) -> Option<PathBuf> {
        match &self.source {
            Source::File(path) => Some(std::path::absolute(path).unwrap_or_else(|_| path.clone())),
            _ => None,
        }
    }
}
