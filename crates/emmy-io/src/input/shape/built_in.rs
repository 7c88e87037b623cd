//! Built-in shapes.

use emmy::internals::mesh::{FEWEST_AROUND, ball_count, check_count, cylinder_count};
use emmy::mesh::Mesh;

use super::network::{NETWORK, Network};
use crate::input::description::{Described, Kind, POSITIVE, Section, exactly, whole};
use crate::input::fault::Fault;
use crate::input::table::{Item, Read, Table};

/// Adds the keys of the built-in shapes to a table.
pub(super) fn with_shapes(section: Section) -> Section {
    section
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
            "ring",
            Kind::Table(&RING),
            "",
            "A ring of hex8 cells about the z axis, its base at z = 0; groups `body`, `inner`, `outer`, `z-min`, `z-max`",
        )
        .may(
            "cylinder",
            Kind::Table(&CYLINDER),
            "",
            "A cylinder of hex8 cells about the z axis, its base at z = 0; groups `body`, `side`, `z-min`, `z-max`",
        )
        .may("ball", Kind::Table(&BALL), "", "A ball of hex8 cells about the origin; groups `body`, `surface`")
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
}

/// Keys of the built-in shapes.
pub(super) const SHAPES: [&str; 7] = ["l-block", "box", "ring", "cylinder", "ball", "rectangle", "network"];

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

static RING: Described = Described::new(|| {
    let cells = "Number of cells along the radius, around the axis (at least 3) and along it";
    Section::new("ring", "Ring of hex8 cells")
        .must("inner", POSITIVE, "length", "Inner radius")
        .must("outer", POSITIVE, "length", "Outer radius")
        .must("height", POSITIVE, "length", "Length along the axis")
        .must("cells", exactly(3, whole(1)), "", cells)
});

static CYLINDER: Described = Described::new(|| {
    let cells = "Number of cells from the axis to the side, and along the axis";
    Section::new("cylinder", "Cylinder of hex8 cells")
        .must("radius", POSITIVE, "length", "Its radius")
        .must("height", POSITIVE, "length", "Length along the axis")
        .must("cells", exactly(2, whole(1)), "", cells)
});

static BALL: Described = Described::new(|| {
    Section::new("ball", "Ball of hex8 cells").must("radius", POSITIVE, "length", "Its radius").must(
        "cells",
        whole(1),
        "",
        "Number of cells from the centre to the surface",
    )
});

/// A built-in shape.
#[derive(Debug)]
pub(super) enum BuiltIn {
    LBlock { cell_size: f64 },
    Box { size: [f64; 3], cells: [usize; 3] },
    Ring { radii: [f64; 2], height: f64, cells: [usize; 3] },
    Cylinder { radius: f64, height: f64, cells: [usize; 2] },
    Ball { radius: f64, cells: usize },
    Rectangle { size: [f64; 2], cells: [usize; 2] },
    Network(Network),
}

impl BuiltIn {
    /// Reads the table of a shape; `None` for another source of a mesh.
    pub(super) fn read(item: Item<'_>) -> Result<Option<Self>, Fault> {
        if !SHAPES.contains(&item.key) {
            return Ok(None);
        }
        let table = Table::read(item);
        let shape = match item.key {
            "l-block" => BuiltIn::LBlock { cell_size: table.must("cell_size") },
            "box" => BuiltIn::Box { size: table.must("size"), cells: table.must("cells") },
            "ring" => Self::ring(&table)?,
            "cylinder" => BuiltIn::Cylinder {
                radius: table.must("radius"),
                height: table.must("height"),
                cells: table.must("cells"),
            },
            "ball" => BuiltIn::Ball { radius: table.must("radius"), cells: table.must("cells") },
            "rectangle" => BuiltIn::Rectangle { size: table.must("size"), cells: table.must("cells") },
            _ => return Ok(Some(BuiltIn::Network(Network::read(table)?))),
        };
        let counted: Item<'_> = table.must(if item.key == "l-block" { "cell_size" } else { "cells" });
        few_cells(shape.count(), &counted)?;
        Ok(Some(shape))
    }

    fn ring(table: &Table<'_>) -> Result<Self, Fault> {
        let radii: [f64; 2] = [table.must("inner"), table.must("outer")];
        if radii[0] >= radii[1] {
            let [inner, outer]: [Item<'_>; 2] = [table.must("inner"), table.must("outer")];
            let error = emmy::Error::InnerRadius { inner: radii[0], outer: radii[1] };
            return Err(inner.fault(error.to_string(), "inner").label(outer.place(), "outer"));
        }
        let cells: [usize; 3] = table.must("cells");
        if cells[1] < FEWEST_AROUND {
            let error = emmy::Error::CellsAround { count: cells[1], least: FEWEST_AROUND };
            let item: Item<'_> = table.must("cells");
            let around = item.items().get(1).copied().unwrap_or(item);
            return Err(around.fault(error.to_string(), "too few"));
        }
        Ok(BuiltIn::Ring { radii, height: table.must("height"), cells })
    }

    /// Number of its cells.
    pub(super) fn count(&self) -> f64 {
        let product = |cells: &[usize]| cells.iter().map(|&n| n as f64).product();
        match self {
            BuiltIn::LBlock { cell_size } => 117.0 / cell_size.powi(3),
            BuiltIn::Box { cells, .. } | BuiltIn::Ring { cells, .. } => product(cells),
            BuiltIn::Cylinder { cells, .. } => cylinder_count(*cells),
            BuiltIn::Ball { cells, .. } => ball_count(*cells),
            BuiltIn::Rectangle { cells, .. } => product(cells),
            BuiltIn::Network(network) => network.n_links() as f64,
        }
    }

    /// The mesh.
    pub(super) fn mesh(&self) -> emmy::Result<Mesh> {
        match self {
            BuiltIn::LBlock { cell_size } => emmy::mesh::l_block(*cell_size),
            BuiltIn::Box { size, cells } => emmy::mesh::block(*size, *cells),
            BuiltIn::Ring { radii, height, cells } => emmy::mesh::ring(*radii, *height, *cells),
            BuiltIn::Cylinder { radius, height, cells } => emmy::mesh::cylinder(*radius, *height, *cells),
            BuiltIn::Ball { radius, cells } => emmy::mesh::ball(*radius, *cells),
            BuiltIn::Rectangle { size, cells } => emmy::mesh::rectangle(*size, *cells),
            BuiltIn::Network(network) => network.mesh(),
        }
    }

    /// Remarks on it.
    pub(super) fn notes(&self) -> &[String] {
        match self {
            BuiltIn::Network(network) => &network.notes,
            _ => &[],
        }
    }
}

/// Checks a number of cells.
pub(super) fn few_cells(count: f64, item: &Item<'_>) -> Result<(), Fault> {
    check_count(count).map_err(|error| item.fault(error.to_string(), "too many cells"))
}
