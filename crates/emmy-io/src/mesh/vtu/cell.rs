//! Cell types of VTK (`vtkCellType.h`) and their node order.

use emmy::mesh::CellKind;

/// A cell type of VTK. Corners come first in the node order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Type {
    pub(super) id: i64,
    name: &'static str,
    pub(super) dim: u8,
    /// Number of nodes; 0: any.
    pub(super) n_nodes: usize,
    /// Number of corners; 0: all nodes.
    n_corners: usize,
}

/// Table of the cell types, one row each.
macro_rules! types {
    ($($id:literal $name:literal $dim:literal $n_nodes:literal $n_corners:literal;)*) => {
        &[$(Type { id: $id, name: $name, dim: $dim, n_nodes: $n_nodes, n_corners: $n_corners }),*]
    };
}

const TYPES: &[Type] = types![
    0 "empty" 0 0 0;
    1 "vertex" 0 1 1;
    2 "vertices" 0 0 0;
    3 "line" 1 2 2;
    4 "polyline" 1 0 0;
    5 "triangle" 2 3 3;
    6 "strip of triangles" 2 0 0;
    7 "polygon" 2 0 0;
    8 "pixel" 2 4 4;
    9 "quadrilateral" 2 4 4;
    10 "tetrahedron" 3 4 4;
    11 "voxel" 3 8 8;
    12 "hexahedron" 3 8 8;
    13 "wedge" 3 6 6;
    14 "pyramid" 3 5 5;
    15 "pentagonal prism" 3 10 10;
    16 "hexagonal prism" 3 12 12;
    21 "quadratic line" 1 3 2;
    22 "quadratic triangle" 2 6 3;
    23 "quadratic quadrilateral" 2 8 4;
    24 "quadratic tetrahedron" 3 10 4;
    25 "quadratic hexahedron" 3 20 8;
    26 "quadratic wedge" 3 15 6;
    27 "quadratic pyramid" 3 13 5;
    28 "biquadratic quadrilateral" 2 9 4;
    29 "triquadratic hexahedron" 3 27 8;
    30 "quadratic-linear quadrilateral" 2 6 4;
    31 "quadratic-linear wedge" 3 12 6;
    32 "biquadratic wedge" 3 18 6;
    33 "biquadratic hexahedron" 3 24 8;
    34 "biquadratic triangle" 2 7 3;
    35 "cubic line" 1 4 2;
    36 "quadratic polygon" 2 0 0;
    37 "triquadratic pyramid" 3 19 5;
    41 "convex hull of points" 3 0 0;
    42 "polyhedron" 3 0 0;
    51 "parametric curve" 1 0 0;
    52 "parametric surface" 2 0 0;
    53 "parametric triangle" 2 0 0;
    54 "parametric quadrilateral" 2 0 0;
    55 "parametric tetrahedron" 3 0 0;
    56 "parametric hexahedron" 3 0 0;
    60 "line of higher order" 1 0 2;
    61 "triangle of higher order" 2 0 3;
    62 "quadrilateral of higher order" 2 0 4;
    63 "polygon of higher order" 2 0 0;
    64 "tetrahedron of higher order" 3 0 4;
    65 "wedge of higher order" 3 0 6;
    66 "pyramid of higher order" 3 0 5;
    67 "hexahedron of higher order" 3 0 8;
    68 "Lagrange curve" 1 0 2;
    69 "Lagrange triangle" 2 0 3;
    70 "Lagrange quadrilateral" 2 0 4;
    71 "Lagrange tetrahedron" 3 0 4;
    72 "Lagrange hexahedron" 3 0 8;
    73 "Lagrange wedge" 3 0 6;
    74 "Lagrange pyramid" 3 0 5;
    75 "Bezier curve" 1 0 2;
    76 "Bezier triangle" 2 0 3;
    77 "Bezier quadrilateral" 2 0 4;
    78 "Bezier tetrahedron" 3 0 4;
    79 "Bezier hexahedron" 3 0 8;
    80 "Bezier wedge" 3 0 6;
    81 "Bezier pyramid" 3 0 5;
];

impl Type {
    /// The cell type of a number.
    pub(super) fn of(id: i64) -> Option<&'static Type> {
        TYPES.iter().find(|own| own.id == id)
    }

    /// Number of corners of a cell.
    pub(super) fn n_corners(&self, n_nodes: usize) -> usize {
        if self.n_corners == 0 { n_nodes } else { self.n_corners.min(n_nodes) }
    }

    /// Kind of a cell, if Emmy has it. The nodes of Lagrange cells of the orders 1 and 2 are in the order of the other
    /// cells with as many nodes.
    pub(super) fn kind(&self, n_nodes: usize) -> Option<CellKind> {
        match (self.id, n_nodes) {
            (PIXEL | POLYGON | 70, 4) => Some(CellKind::Quad4),
            (POLYGON | 69, 3) => Some(CellKind::Tri3),
            (VOXEL | LAGRANGE_HEXAHEDRON, 8) => Some(CellKind::Hex8),
            (4 | 68, 2) => Some(CellKind::Line2),
            (69, 6) => Some(CellKind::Tri6),
            (70, 9) => Some(CellKind::Quad9),
            (71, 4) => Some(CellKind::Tet4),
            (71, 10) => Some(CellKind::Tet10),
            (LAGRANGE_HEXAHEDRON, 27) => Some(CellKind::Hex27),
            (73, 6) => Some(CellKind::Wedge6),
            (74, 5) => Some(CellKind::Pyramid5),
            _ => CellKind::ALL.into_iter().find(|&kind| i64::from(crate::vtk::cell_type(kind)) == self.id),
        }
    }

    /// Advice for a solid cell of a kind that Emmy does not have.
    pub(super) fn cure(&self, n_nodes: usize) -> &'static str {
        match (self.id, n_nodes) {
            // Wedges of 18 and pyramids of 14 nodes.
            (32, _) | (73, 18) | (74, 14) => {
                "in Gmsh, `Mesh.SecondOrderIncomplete = 1` before meshing makes hex20, wedge15 and pyramid13; in ParaView \
                 and VTK, the filter Tetrahedralize makes tetrahedra"
            }
            _ => "in ParaView and VTK, the filter Tetrahedralize makes tetrahedra of other cells",
        }
    }

    /// Index in the file's node list of each node of the kind; `None`: the same order.
    pub(super) fn order(&self) -> Option<&'static [usize]> {
        match self.id {
            PIXEL => Some(&[0, 1, 3, 2]),
            VOXEL => Some(&[0, 1, 3, 2, 4, 5, 7, 6]),
            _ => None,
        }
    }

    /// Its name in messages, such as `VTK type 11 (voxel)`.
    pub(super) fn described(&self, n_nodes: usize) -> String {
        let nodes = if self.id > 36 { format!(" of {n_nodes} nodes") } else { String::new() };
        format!("VTK type {} ({}{nodes})", self.id, self.name)
    }
}

const POLYGON: i64 = 7;
/// A rectangle along the axes; its last two nodes are exchanged.
pub(super) const PIXEL: i64 = 8;
/// A brick along the axes; nodes 2 and 3, 6 and 7 are exchanged.
pub(super) const VOXEL: i64 = 11;
const LAGRANGE_HEXAHEDRON: i64 = 72;

/// Brings the nodes of Lagrange hexahedra of order 2 from files before version 2.1 (XML) or 5.0 (legacy) into the
/// present order: the last two vertical edges were exchanged.
pub(super) fn renumber_old_hexahedra(types: &[i64], ends: &[i64], connectivity: &mut [i64]) {
    let mut begin = 0;
    for (&id, &end) in types.iter().zip(ends) {
        let end = usize::try_from(end).unwrap_or(0);
        if let Some(nodes) = connectivity.get_mut(begin..end)
            && id == LAGRANGE_HEXAHEDRON
            && nodes.len() == 27
        {
            nodes.swap(18, 19);
        }
        begin = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_cell_has_a_type() {
        for kind in CellKind::ALL {
            let own = Type::of(i64::from(crate::vtk::cell_type(kind))).unwrap();
            let found = (own.n_nodes, own.n_corners, usize::from(own.dim), own.kind(own.n_nodes));
            assert_eq!(found, (kind.n_nodes(), kind.n_corners(), kind.dimension(), Some(kind)));
        }
        assert_eq!(Type::of(11).unwrap().described(8), "VTK type 11 (voxel)");
        assert_eq!(Type::of(72).unwrap().described(64), "VTK type 72 (Lagrange hexahedron of 64 nodes)");
        assert_eq!(Type::of(17), None);
    }
}
