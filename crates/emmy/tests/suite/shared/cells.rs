//! Single cells and bricks of cells.

use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::element::{LocalFacet, element};
use emmy::internals::quadrature::gauss;
use emmy::prelude::*;

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

/// Stiffness of a single undistorted cell at rest, row by row (up to the factor of the mid-point rule).
pub(crate) fn stiffness(kind: CellKind, region: Region) -> Vec<Vec<f64>> {
    let points = element(kind).nodes().to_vec();
    let nodes: Vec<u32> = (0..points.len() as u32).collect();
    let mesh = Mesh::from_cells(kind, &points, &[nodes]).unwrap();
    let body = Body::builder(mesh).region(region).build().unwrap();
    let (rule, zeros) = (Rule::standard(1, &gauss(1)), vec![0.0; body.n_dofs()]);
    let step = StepInput {
        rule: &rule,
        tangent_factor: 1.0,
        displacement: &zeros,
        rates: &zeros,
        damping: StepDamping::default(),
        pressures: None,
    };
    let mut assembly = body.assembly(1);
    body.assemble(&step, Request::Tangent, &[0.0], &mut assembly).unwrap();
    let column = |dof: usize| {
        let (mut x, mut y) = (zeros.clone(), zeros.clone());
        x[dof] = 1.0;
        assembly.matrix.multiply(body.pattern(), &x, &mut y);
        y
    };
    (0..body.n_dofs()).map(column).collect()
}
