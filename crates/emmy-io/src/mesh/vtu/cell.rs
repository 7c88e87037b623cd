//! Cell types of VTK (`vtkCellType.h`) and their node order.

use emmy::internals::element::{element, jacobian};
use emmy::internals::tensor::det;
use emmy::mesh::CellKind;

/// A cell type of VTK. Corners come first in the node order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) dim: u8,
    pub(super) n_nodes: usize,
    pub(super) n_corners: usize,
    pub(super) kind: Option<CellKind>,
}

/// The cell type of a number, if it is supported.
pub(super) fn shape(id: i64) -> Option<Shape> {
    let flat = |dim, n_nodes, n_corners| Some(Shape { dim, n_nodes, n_corners, kind: None });
    match id {
        1 => flat(0, 1, 1),  // vertex
        21 => flat(1, 3, 2), // quadratic edge
        PIXEL => Some(cell(CellKind::Quad4)),
        VOXEL => Some(cell(CellKind::Hex8)),
        _ => CellKind::ALL.into_iter().find(|&kind| i64::from(crate::vtk::cell_type(kind)) == id).map(cell),
    }
}

fn cell(kind: CellKind) -> Shape {
    Shape {
        dim: kind.dimension() as u8,
        n_nodes: kind.n_nodes(),
        n_corners: kind.n_corners(),
        kind: Some(kind),
    }
}

/// A rectangle along the axes; its last two nodes are exchanged.
pub(super) const PIXEL: i64 = 8;
pub(super) const PIXEL_ORDER: [usize; 4] = [0, 1, 3, 2];

/// A brick along the axes; nodes 2 and 3, 6 and 7 are exchanged.
pub(super) const VOXEL: i64 = 11;
pub(super) const VOXEL_ORDER: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Wedge whose base is clockwise as seen from the top, as in older documentation of VTK and some programs: index in the
/// file's node list of each node.
pub(super) const MIRRORED_WEDGE: [usize; 15] = [0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13];

/// Whether det(dX/dxi) of the cell with the same corners and straight edges is negative in the middle.
pub(super) fn is_mirrored(kind: CellKind, corners: &[[f64; 3]]) -> bool {
    let linear = element(kind.linear());
    let n = linear.nodes().len();
    let middle = [0, 1, 2].map(|i| linear.nodes().iter().map(|xi| xi[i]).sum::<f64>() / n as f64);
    let mut gradients = vec![[0.0; 3]; n];
    linear.gradient(middle, &mut gradients);
    det(&jacobian(kind, &corners[..n], &gradients)) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_wedge_put_right_is_the_wedge() {
        for kind in [CellKind::Wedge6, CellKind::Wedge15] {
            let nodes = element(kind).nodes();
            // Exchanging the first two coordinates mirrors the wedge and maps its nodes onto each other.
            let mirrored: Vec<[f64; 3]> = nodes.iter().map(|&[x, y, z]| [y, x, z]).collect();
            assert!(is_mirrored(kind, &mirrored) && !is_mirrored(kind, nodes));
            let right: Vec<[f64; 3]> =
                MIRRORED_WEDGE[..kind.n_nodes()].iter().map(|&i| mirrored[i]).collect();
            assert_eq!(right, nodes);
        }
    }
}
