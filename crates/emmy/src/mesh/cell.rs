//! Kinds of cells and facets: topology only. The shape functions live in [`crate::element`].

use std::fmt;

/// Kind of a cell of the mesh. Node order is that of VTK for every kind.
///
/// ```
/// use emmy::mesh::CellKind;
/// assert_eq!(CellKind::Hex20.n_nodes(), 20);
/// assert_eq!(CellKind::Tet10.facets().len(), 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// Trilinear hexahedron, 8 nodes.
    Hex8,
    /// Serendipity hexahedron, 20 nodes.
    Hex20,
    /// Triquadratic hexahedron, 27 nodes.
    Hex27,
    /// Linear tetrahedron, 4 nodes.
    Tet4,
    /// Quadratic tetrahedron, 10 nodes.
    Tet10,
    /// Linear wedge, 6 nodes. The base 0, 1, 2 is seen counter-clockwise from the top 3, 4, 5.
    Wedge6,
    /// Serendipity wedge, 15 nodes.
    Wedge15,
    /// Linear pyramid with rational shape functions, 5 nodes. The base is seen counter-clockwise from the apex.
    Pyramid5,
    /// Linear triangle of a body in plane strain, 3 nodes, counter-clockwise.
    Tri3,
    /// Quadratic triangle of a body in plane strain, 6 nodes.
    Tri6,
    /// Bilinear quadrilateral of a body in plane strain, 4 nodes, counter-clockwise.
    Quad4,
    /// Serendipity quadrilateral of a body in plane strain, 8 nodes.
    Quad8,
    /// Biquadratic quadrilateral of a body in plane strain, 9 nodes.
    Quad9,
    /// Link of two nodes: a bar, a spring, an attraction.
    Line2,
}

/// Kind of a facet: a face of a solid cell, an edge of a plane one. Node order is that of VTK for every kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FacetKind {
    /// Linear edge.
    Line2,
    /// Quadratic edge: its ends, then the node between them.
    Line3,
    /// Linear triangle.
    Tri3,
    /// Quadratic triangle.
    Tri6,
    /// Bilinear quadrilateral.
    Quad4,
    /// Serendipity quadrilateral.
    Quad8,
    /// Biquadratic quadrilateral.
    Quad9,
}

/// A face of a reference cell: its kind and the local numbers of its nodes, outward normal by the right-hand rule; an edge
/// has the cell on its left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LocalFacet {
    /// Kind of the facet.
    pub kind: FacetKind,
    /// Local node numbers, in the facet's own node order.
    pub nodes: &'static [usize],
}

impl FacetKind {
    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        match self {
            FacetKind::Line2 => 2,
            FacetKind::Line3 => 3,
            FacetKind::Tri3 => 3,
            FacetKind::Tri6 => 6,
            FacetKind::Quad4 => 4,
            FacetKind::Quad8 => 8,
            FacetKind::Quad9 => 9,
        }
    }

    /// Number of corner nodes; they come first in the node order.
    pub const fn n_corners(self) -> usize {
        match self {
            FacetKind::Line2 | FacetKind::Line3 => 2,
            FacetKind::Tri3 | FacetKind::Tri6 => 3,
            _ => 4,
        }
    }
}

impl CellKind {
    /// All kinds, in the order of `emmy list elements`.
    pub const ALL: [CellKind; 14] = [
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Wedge6,
        CellKind::Wedge15,
        CellKind::Pyramid5,
        CellKind::Tri3,
        CellKind::Tri6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
        CellKind::Line2,
    ];

    /// Kinds of solid cells.
    pub const SOLIDS: [CellKind; 8] = [
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Wedge6,
        CellKind::Wedge15,
        CellKind::Pyramid5,
    ];

    /// Kinds of cells of a body in plane strain.
    pub const PLANES: [CellKind; 5] =
        [CellKind::Tri3, CellKind::Tri6, CellKind::Quad4, CellKind::Quad8, CellKind::Quad9];

    /// Dimension of the cell: 3 for a solid, 2 in a plane, 1 for a link.
    ///
    /// ```
    /// use emmy::mesh::CellKind;
    /// assert_eq!((CellKind::Hex8.dimension(), CellKind::Quad8.dimension()), (3, 2));
    /// ```
    pub const fn dimension(self) -> usize {
        match self {
            CellKind::Tri3 | CellKind::Tri6 | CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => 2,
            CellKind::Line2 => 1,
            _ => 3,
        }
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        match self {
            CellKind::Hex8 => 8,
            CellKind::Hex20 => 20,
            CellKind::Hex27 => 27,
            CellKind::Tet4 => 4,
            CellKind::Tet10 => 10,
            CellKind::Wedge6 => 6,
            CellKind::Wedge15 => 15,
            CellKind::Pyramid5 => 5,
            CellKind::Tri3 => 3,
            CellKind::Tri6 => 6,
            CellKind::Quad4 => 4,
            CellKind::Quad8 => 8,
            CellKind::Quad9 => 9,
            CellKind::Line2 => 2,
        }
    }

    /// Number of corner nodes; they come first in the node order.
    pub const fn n_corners(self) -> usize {
        match self {
            CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => 8,
            CellKind::Tet4 | CellKind::Tet10 => 4,
            CellKind::Wedge6 | CellKind::Wedge15 => 6,
            CellKind::Pyramid5 => 5,
            CellKind::Tri3 | CellKind::Tri6 => 3,
            CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => 4,
            CellKind::Line2 => 2,
        }
    }

    /// The linear kind with the same corners.
    ///
    /// ```
    /// use emmy::mesh::CellKind;
    /// assert_eq!(CellKind::Wedge15.linear(), CellKind::Wedge6);
    /// ```
    pub const fn linear(self) -> CellKind {
        match self {
            CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => CellKind::Hex8,
            CellKind::Tet4 | CellKind::Tet10 => CellKind::Tet4,
            CellKind::Wedge6 | CellKind::Wedge15 => CellKind::Wedge6,
            CellKind::Pyramid5 => CellKind::Pyramid5,
            CellKind::Tri3 | CellKind::Tri6 => CellKind::Tri3,
            CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => CellKind::Quad4,
            CellKind::Line2 => CellKind::Line2,
        }
    }

    /// Faces (edges of a plane cell) with outward orientation, numbered as in [`crate::mesh::Facet::local`].
    pub const fn facets(self) -> &'static [LocalFacet] {
        match self {
            CellKind::Hex8 => &HEX8_FACETS,
            CellKind::Hex20 => &HEX20_FACETS,
            CellKind::Hex27 => &HEX27_FACETS,
            CellKind::Tet4 => &TET4_FACETS,
            CellKind::Tet10 => &TET10_FACETS,
            CellKind::Wedge6 => &WEDGE6_FACETS,
            CellKind::Wedge15 => &WEDGE15_FACETS,
            CellKind::Pyramid5 => &PYRAMID5_FACETS,
            CellKind::Tri3 => &TRI3_FACETS,
            CellKind::Tri6 => &TRI6_FACETS,
            CellKind::Quad4 => &QUAD4_FACETS,
            CellKind::Quad8 | CellKind::Quad9 => &QUAD8_FACETS,
            CellKind::Line2 => &[],
        }
    }

    /// Key word of the kind, as in `emmy list elements`.
    pub const fn name(self) -> &'static str {
        match self {
            CellKind::Hex8 => "hex8",
            CellKind::Hex20 => "hex20",
            CellKind::Hex27 => "hex27",
            CellKind::Tet4 => "tet4",
            CellKind::Tet10 => "tet10",
            CellKind::Wedge6 => "wedge6",
            CellKind::Wedge15 => "wedge15",
            CellKind::Pyramid5 => "pyramid5",
            CellKind::Tri3 => "tri3",
            CellKind::Tri6 => "tri6",
            CellKind::Quad4 => "quad4",
            CellKind::Quad8 => "quad8",
            CellKind::Quad9 => "quad9",
            CellKind::Line2 => "line2",
        }
    }
}

impl fmt::Display for CellKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Faces from a list of node lists: all of one kind, or each with its own.
macro_rules! facets {
    ($kind:ident; $([$($node:literal),*]),* $(,)?) => {
        [$(LocalFacet { kind: FacetKind::$kind, nodes: &[$($node),*] }),*]
    };
    ($($kind:ident [$($node:literal),*]),* $(,)?) => {
        [$(LocalFacet { kind: FacetKind::$kind, nodes: &[$($node),*] }),*]
    };
}

// Order of the hexahedron's faces: x-min, x-max, y-min, y-max, z-min, z-max of the reference cube.
const HEX8_FACETS: [LocalFacet; 6] = facets![Quad4;
    [0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
const HEX20_FACETS: [LocalFacet; 6] = facets![Quad8;
    [0, 4, 7, 3, 16, 15, 19, 11],
    [1, 2, 6, 5, 9, 18, 13, 17],
    [0, 1, 5, 4, 8, 17, 12, 16],
    [3, 7, 6, 2, 19, 14, 18, 10],
    [0, 3, 2, 1, 11, 10, 9, 8],
    [4, 5, 6, 7, 12, 13, 14, 15]];
const HEX27_FACETS: [LocalFacet; 6] = facets![Quad9;
    [0, 4, 7, 3, 16, 15, 19, 11, 20],
    [1, 2, 6, 5, 9, 18, 13, 17, 21],
    [0, 1, 5, 4, 8, 17, 12, 16, 22],
    [3, 7, 6, 2, 19, 14, 18, 10, 23],
    [0, 3, 2, 1, 11, 10, 9, 8, 24],
    [4, 5, 6, 7, 12, 13, 14, 15, 25]];
const TET4_FACETS: [LocalFacet; 4] = facets![Tri3; [1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
const TET10_FACETS: [LocalFacet; 4] = facets![Tri6;
    [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6], [0, 1, 3, 4, 8, 7], [0, 2, 1, 6, 5, 4]];
// Order of the wedge's faces: base, top, then the sides over the edges 01, 12, 20 of the base.
const WEDGE6_FACETS: [LocalFacet; 5] = facets![
    Tri3[0, 2, 1], Tri3[3, 4, 5], Quad4[0, 1, 4, 3], Quad4[1, 2, 5, 4], Quad4[2, 0, 3, 5]];
const WEDGE15_FACETS: [LocalFacet; 5] = facets![
    Tri6[0, 2, 1, 8, 7, 6],
    Tri6[3, 4, 5, 9, 10, 11],
    Quad8[0, 1, 4, 3, 6, 13, 9, 12],
    Quad8[1, 2, 5, 4, 7, 14, 10, 13],
    Quad8[2, 0, 3, 5, 8, 12, 11, 14]];
// Order of the pyramid's faces: base, then the sides over the edges 01, 12, 23, 30 of the base.
const PYRAMID5_FACETS: [LocalFacet; 5] = facets![
    Quad4[0, 3, 2, 1], Tri3[0, 1, 4], Tri3[1, 2, 4], Tri3[2, 3, 4], Tri3[3, 0, 4]];
// Edges of plane cells go round counter-clockwise.
const TRI3_FACETS: [LocalFacet; 3] = facets![Line2; [0, 1], [1, 2], [2, 0]];
const TRI6_FACETS: [LocalFacet; 3] = facets![Line3; [0, 1, 3], [1, 2, 4], [2, 0, 5]];
const QUAD4_FACETS: [LocalFacet; 4] = facets![Line2; [0, 1], [1, 2], [2, 3], [3, 0]];
const QUAD8_FACETS: [LocalFacet; 4] = facets![Line3; [0, 1, 4], [1, 2, 5], [2, 3, 6], [3, 0, 7]];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn facets_list_corners_then_the_edges_between_them() {
        for kind in CellKind::SOLIDS {
            let mut edge_nodes: BTreeMap<[usize; 2], usize> = BTreeMap::new();
            for facet in kind.facets() {
                assert_eq!(facet.nodes.len(), facet.kind.n_nodes());
                let n = facet.kind.n_corners();
                for (i, &mid) in facet.nodes[n..].iter().take(n).enumerate() {
                    let mut edge = [facet.nodes[i], facet.nodes[(i + 1) % n]];
                    edge.sort();
                    // Both faces of an edge must name the same mid-side node.
                    assert_eq!(*edge_nodes.entry(edge).or_insert(mid), mid, "{kind} {edge:?}");
                }
            }
        }
    }
}
