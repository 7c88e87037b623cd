//! Stiffness of a cell.

use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::element::element;
use emmy::internals::quadrature::gauss;
use emmy::prelude::*;

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
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let mut assembly = body.assembly(step.rule);
    body.assemble(&step, Request::Tangent, &[0.0], &mut assembly).unwrap();
    let column = |dof: usize| {
        let (mut x, mut y) = (zeros.clone(), zeros.clone());
        x[dof] = 1.0;
        assembly.matrix.multiply(body.pattern(), &x, &mut y);
        y
    };
    (0..body.n_dofs()).map(column).collect()
}
