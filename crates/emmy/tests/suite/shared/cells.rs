//! Bricks of cells.

use emmy::internals::element::{LocalFacet, element};
use emmy::mesh::CellKind;

/// Cells that divide a unit cube (a square, where z = 0), by their corners.
pub(crate) fn cells_of_a_brick(kind: CellKind) -> Vec<Vec<[f64; 3]>> {
    let cube: Vec<[f64; 3]> =
        element(CellKind::Hex8).nodes().iter().map(|x| x.map(|x| 0.5 * x + 0.5)).collect();
    let of = |cells: &[&[usize]]| cells.iter().map(|cell| cell.iter().map(|&c| cube[c]).collect()).collect();
    match kind.linear() {
        CellKind::Hex8 => vec![cube],
        CellKind::Wedge6 => of(&[&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]]),
        CellKind::Tet4 => {
            of(&[&[0, 1, 2, 6], &[0, 2, 3, 6], &[0, 3, 7, 6], &[0, 7, 4, 6], &[0, 4, 5, 6], &[0, 5, 1, 6]])
        }
        CellKind::Pyramid5 => {
            // The face is anticlockwise as seen from outside, the base of a pyramid as seen from its apex.
            let pyramid =
                |face: &LocalFacet| face.nodes.iter().rev().map(|&c| cube[c]).chain([[0.5; 3]]).collect();
            CellKind::Hex8.facets().iter().map(pyramid).collect()
        }
        CellKind::Quad4 => of(&[&[0, 1, 2, 3]]),
        CellKind::Tri3 => of(&[&[0, 1, 2], &[0, 2, 3]]),
        other => panic!("{other}"),
    }
}
