//! Kinds of cells and facets. Each kind is described in the file of its element.

use std::fmt;

use super::{CellKind, PressureSpace, ReferenceElement};

/// A kind of cell, described.
pub struct CellInfo {
    /// Key word, as in `emmy list elements`.
    pub name: &'static str,
    /// Description in a few words.
    pub description: &'static str,
    /// Shape of the cell.
    pub shape: CellShape,
    /// Number of nodes.
    pub n_nodes: usize,
    /// Number of the cell type of VTK, whose node order the kind has.
    pub vtk_type: u8,
    /// Faces (edges of a plane cell), with outward orientation.
    pub facets: &'static [LocalFacet],
    /// Reference element, in three coordinates.
    pub element: &'static dyn ReferenceElement<3>,
    /// Functions of the pressure for a projected volume, the default first; empty if a projection would change nothing.
    pub pressures: &'static [PressureSpace],
    /// Bulk modulus that a projected volume leaves at the quadrature points, over the shear modulus: it removes modes
    /// without energy.
    pub point_share: f64,
    /// Number of incompatible modes; 0 if there are none for this kind.
    pub n_modes: usize,
}

/// Shape of a cell, for any nodes on its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellShape {
    /// Hexahedron.
    Hexahedron,
    /// Tetrahedron.
    Tetrahedron,
    /// Wedge (prism).
    Wedge,
    /// Pyramid.
    Pyramid,
    /// Triangle of a body in plane strain.
    Triangle,
    /// Quadrilateral of a body in plane strain.
    Quadrilateral,
    /// Line.
    Line,
}

impl CellShape {
    /// Dimension: 3 of a solid, 2 in a plane, 1 of a line.
    pub const fn dimension(self) -> usize {
        match self {
            CellShape::Hexahedron | CellShape::Tetrahedron | CellShape::Wedge | CellShape::Pyramid => 3,
            CellShape::Triangle | CellShape::Quadrilateral => 2,
            CellShape::Line => 1,
        }
    }

    /// The kind of cell with linear edges.
    pub const fn linear(self) -> CellKind {
        match self {
            CellShape::Hexahedron => CellKind::Hex8,
            CellShape::Tetrahedron => CellKind::Tet4,
            CellShape::Wedge => CellKind::Wedge6,
            CellShape::Pyramid => CellKind::Pyramid5,
            CellShape::Triangle => CellKind::Tri3,
            CellShape::Quadrilateral => CellKind::Quad4,
            CellShape::Line => CellKind::Line2,
        }
    }
}

/// Declares the kinds of cells, each with its [`CellInfo`].
macro_rules! cell_kinds {
    ($($(#[$doc:meta])* $kind:ident = $info:expr;)+) => {
        /// Kind of a cell of the mesh. Every kind has the node order of VTK.
        ///
        /// ```
        /// use emmy::mesh::CellKind;
        /// assert_eq!(CellKind::Hex20.n_nodes(), 20);
        /// assert_eq!(CellKind::Tet10.facets().len(), 4);
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum CellKind {
            $($(#[$doc])* $kind,)+
        }

        impl CellKind {
            /// All kinds, in the order of `emmy list elements`.
            pub const ALL: [CellKind; [$(CellKind::$kind),+].len()] = [$(CellKind::$kind),+];

            /// The description of the kind.
            pub const fn info(self) -> &'static kind::CellInfo {
                match self {
                    $(CellKind::$kind => &$info,)+
                }
            }
        }
    };
}

pub(super) use cell_kinds;

/// Number of kinds of a dimension.
const fn count(dimension: usize) -> usize {
    let (mut n, mut at) = (0, 0);
    while at < CellKind::ALL.len() {
        n += (CellKind::ALL[at].dimension() == dimension) as usize;
        at += 1;
    }
    n
}

/// Kinds of a dimension.
const fn of_dimension<const N: usize>(dimension: usize) -> [CellKind; N] {
    let mut kinds = [CellKind::ALL[0]; N];
    let (mut n, mut at) = (0, 0);
    while at < CellKind::ALL.len() {
        if CellKind::ALL[at].dimension() == dimension {
            kinds[n] = CellKind::ALL[at];
            n += 1;
        }
        at += 1;
    }
    kinds
}

impl CellKind {
    /// Kinds of solid cells.
    pub const SOLIDS: [CellKind; count(3)] = of_dimension(3);

    /// Kinds of cells of a body in plane strain.
    pub const PLANES: [CellKind; count(2)] = of_dimension(2);

    /// Dimension of the cell: 3 for a solid, 2 in a plane, 1 for a link.
    ///
    /// ```
    /// use emmy::mesh::CellKind;
    /// assert_eq!((CellKind::Hex8.dimension(), CellKind::Quad8.dimension()), (3, 2));
    /// ```
    pub const fn dimension(self) -> usize {
        self.info().shape.dimension()
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        self.info().n_nodes
    }

    /// Number of corner nodes; they come first in the node order.
    pub const fn n_corners(self) -> usize {
        self.linear().info().n_nodes
    }

    /// The linear kind with the same corners.
    ///
    /// ```
    /// use emmy::mesh::CellKind;
    /// assert_eq!(CellKind::Wedge15.linear(), CellKind::Wedge6);
    /// ```
    pub const fn linear(self) -> CellKind {
        self.info().shape.linear()
    }

    /// Faces (edges of a plane cell) with outward orientation, numbered as in [`crate::mesh::Facet::local`].
    pub const fn facets(self) -> &'static [LocalFacet] {
        self.info().facets
    }

    /// Key word of the kind, as in `emmy list elements`.
    pub const fn name(self) -> &'static str {
        self.info().name
    }
}

impl fmt::Display for CellKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Kind of a facet: a face of a solid cell, an edge of a plane one. Every kind has the node order of VTK.
///
/// ```
/// use emmy::mesh::{CellKind, FacetKind};
/// assert_eq!(CellKind::Hex20.facets()[0].kind, FacetKind::Quad8);
/// ```
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

/// A face of a reference cell: its kind and the local numbers of its nodes, outward normal by the right-hand rule; an
/// edge has the cell on its left.
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
            FacetKind::Quad4 | FacetKind::Quad8 | FacetKind::Quad9 => 4,
        }
    }
}

/// Faces from a list of node lists: all of one kind, or each with its own.
macro_rules! facets {
    ($kind:ident; $([$($node:literal),*]),* $(,)?) => {
        &[$(LocalFacet { kind: FacetKind::$kind, nodes: &[$($node),*] }),*]
    };
    ($($kind:ident [$($node:literal),*]),* $(,)?) => {
        &[$(LocalFacet { kind: FacetKind::$kind, nodes: &[$($node),*] }),*]
    };
}
pub(super) use facets;

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn numbers_of_nodes_match_the_elements() {
        for kind in CellKind::ALL {
            assert_eq!(kind.n_nodes(), kind.info().element.nodes().len(), "{kind}");
            assert!(kind.n_corners() <= kind.n_nodes() && kind.linear().linear() == kind.linear());
        }
        assert_eq!(CellKind::SOLIDS.len() + CellKind::PLANES.len() + 1, CellKind::ALL.len());
    }

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
