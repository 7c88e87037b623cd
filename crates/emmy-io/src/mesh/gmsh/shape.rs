//! Element types of Gmsh (Gmsh reference manual, "MSH file format" and "Node ordering").

use emmy::mesh::CellKind;

/// An element type of Gmsh. Corners come first in the node order.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) id: i64,
    pub(super) name: &'static str,
    pub(super) dim: u8,
    pub(super) n_nodes: usize,
    pub(super) n_corners: usize,
}

impl Shape {
    /// The largest number of nodes in the table.
    pub(super) const MAX_NODES: usize = 125;

    /// The element type of a number.
    pub(super) fn of(id: i64) -> Option<&'static Shape> {
        SHAPES.iter().find(|shape| shape.id == id)
    }

    /// Something to try in Gmsh where the kind is not read.
    pub(super) fn cure(&self) -> &'static str {
        match self.name {
            "wedge18" | "pyramid14" => {
                "set `Mesh.SecondOrderIncomplete = 1` before meshing: Gmsh then makes hex20, wedge15 and pyramid13"
            }
            _ => HIGHER_ORDER,
        }
    }

    /// The element type of a kind of cell.
    #[cfg(test)]
    pub(super) fn of_kind(kind: CellKind) -> Option<&'static Shape> {
        SHAPES.iter().find(|shape| shape.name == kind.name())
    }

    /// Kind of cell, and the index in the file's node list of each node in VTK order.
    pub(super) fn cell(&self) -> Option<(CellKind, &'static [usize])> {
        let kind = CellKind::ALL.into_iter().find(|kind| kind.name() == self.name)?;
        let order: &[usize] = match kind {
            CellKind::Tet10 => &TET10,
            CellKind::Wedge15 => &WEDGE15,
            CellKind::Pyramid13 => &PYRAMID13,
            CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => &HEX27[..self.n_nodes],
            CellKind::Tet4 | CellKind::Wedge6 | CellKind::Pyramid5 | CellKind::Line2 => {
                &AS_IN_VTK[..self.n_nodes]
            }
            // Corners, edges in the same order, centre.
            CellKind::Tri3 | CellKind::Tri6 | CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => {
                &AS_IN_VTK[..self.n_nodes]
            }
        };
        Some((kind, order))
    }
}

/// Advice for Gmsh where elements have an order above 2.
pub(super) const HIGHER_ORDER: &str = "elements of the orders 1 and 2 are read: set `Mesh.ElementOrder = 2` and `Mesh.SecondOrderIncomplete = 1` before meshing";

const AS_IN_VTK: [usize; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
/// The last two edges, 2-3 and 1-3, are exchanged in VTK.
const TET10: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
/// Gmsh numbers edges by their lower corner: 01, 02, 03, 12, 14, 25, 34, 35, 45.
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
/// Gmsh numbers edges by their lower corner: 01, 03, 04, 12, 14, 23, 24, 34.
const PYRAMID13: [usize; 13] = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];
/// Gmsh numbers edges by their lower corner and faces as z-min, y-min, x-min, x-max, y-max, z-max; the bricks of 8
/// and 20 nodes are the beginning of this list.
const HEX27: [usize; 27] = [
    0, 1, 2, 3, 4, 5, 6, 7, // corners
    8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, // edges
    22, 23, 21, 24, 20, 25, 26, // faces and centre
];

/// Table of the element types, one row each.
macro_rules! shapes {
    ($($id:literal $name:literal $dim:literal $n_nodes:literal $n_corners:literal;)*) => {
        [$(Shape { id: $id, name: $name, dim: $dim, n_nodes: $n_nodes, n_corners: $n_corners }),*]
    };
}

const SHAPES: [Shape; 42] = shapes![
    1 "line2" 1 2 2;
    2 "tri3" 2 3 3;
    3 "quad4" 2 4 4;
    4 "tet4" 3 4 4;
    5 "hex8" 3 8 8;
    6 "wedge6" 3 6 6;
    7 "pyramid5" 3 5 5;
    8 "line3" 1 3 2;
    9 "tri6" 2 6 3;
    10 "quad9" 2 9 4;
    11 "tet10" 3 10 4;
    12 "hex27" 3 27 8;
    13 "wedge18" 3 18 6;
    14 "pyramid14" 3 14 5;
    15 "point" 0 1 1;
    16 "quad8" 2 8 4;
    17 "hex20" 3 20 8;
    18 "wedge15" 3 15 6;
    19 "pyramid13" 3 13 5;
    20 "tri9" 2 9 3;
    21 "tri10" 2 10 3;
    22 "tri12" 2 12 3;
    23 "tri15" 2 15 3;
    24 "tri15i" 2 15 3;
    25 "tri21" 2 21 3;
    26 "line4" 1 4 2;
    27 "line5" 1 5 2;
    28 "line6" 1 6 2;
    29 "tet20" 3 20 4;
    30 "tet35" 3 35 4;
    31 "tet56" 3 56 4;
    36 "quad16" 2 16 4;
    37 "quad25" 2 25 4;
    38 "quad36" 2 36 4;
    39 "quad12" 2 12 4;
    40 "quad16i" 2 16 4;
    41 "quad20" 2 20 4;
    90 "wedge40" 3 40 6;
    91 "wedge75" 3 75 6;
    92 "hex64" 3 64 8;
    93 "hex125" 3 125 8;
    118 "pyramid30" 3 30 5;
];
