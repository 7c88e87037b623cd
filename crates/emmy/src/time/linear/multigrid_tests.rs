//! Iterations of conjugate gradients with multigrid do not depend on size, shape, cells and step size.

use std::collections::HashMap;
use std::sync::Arc;

use crate::average::{Request, Rule};
use crate::body::Body;
use crate::element::{CellKind, element};
use crate::force::StepInput;
use crate::input::Region;
use crate::material::NeoHooke;
use crate::mesh::{Mesh, MeshBuilder};
use crate::quadrature::gauss;
use crate::sparse::{Multigrid, Shifted, ShiftedSolver, SweepOrder};

/// A block of bricks of hex20, or of six tet10 each.
fn quadratic(kind: CellKind, size: [f64; 3], bricks: [usize; 3]) -> Mesh {
    let (linear, mut builder, mut numbers) = (element(kind.linear()), MeshBuilder::new(), HashMap::new());
    let corners: Vec<Vec<[f64; 3]>> = match kind {
        CellKind::Hex20 => vec![linear.nodes().iter().map(|xi| xi.map(|x| 0.5 * (1.0 + x))).collect()],
        // Paths along the edges from one corner to the opposite one; odd ones have two corners interchanged.
        _ => [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]]
            .into_iter()
            .enumerate()
            .map(|(index, [a, b, _])| {
                let unit = |axes: &[usize]| [0, 1, 2].map(|x| f64::from(u8::from(axes.contains(&x))));
                let mut path = vec![[0.0; 3], unit(&[a]), unit(&[a, b]), [1.0; 3]];
                path.swap(1, 1 + index / 3);
                path
            })
            .collect(),
    };
    let mut N = vec![0.0; linear.nodes().len()];
    for at in 0..bricks.iter().product() {
        let brick = [at % bricks[0], at / bricks[0] % bricks[1], at / bricks[0] / bricks[1]];
        for corners in &corners {
            let mut node = |&xi: &[f64; 3]| {
                linear.shape(xi, &mut N);
                let inside = |a: usize| corners.iter().zip(&N).map(|(corner, N)| N * corner[a]).sum::<f64>();
                let grid = [0, 1, 2].map(|a| brick[a] as f64 + inside(a));
                let point = [0, 1, 2].map(|a| size[a] * grid[a] / bricks[a] as f64);
                let key = grid.map(|x| (2.0 * x).round() as u32);
                *numbers.entry(key).or_insert_with(|| builder.point(point))
            };
            let nodes: Vec<u32> = element(kind).nodes().iter().map(&mut node).collect();
            builder.cell(kind, &nodes).unwrap();
        }
    }
    builder.build().unwrap()
}

/// Iterations to 1e-3 at a Courant number, for cells of a width.
fn iterations<const C: usize>((body, bulk): (&Body, f64), courant: f64, width: f64) -> usize {
    let rule = Rule::standard(1, &gauss(1));
    let zero = vec![0.0; body.n_dofs()];
    let mut assembly = body.assembly(&rule);
    let step = StepInput { tangent_factor: 2.0, ..StepInput::undamped(&rule, &zero, &zero) };
    body.assemble(&step, Request::Tangent, &[0.0], &mut assembly).unwrap();
    let sweep = Arc::new(SweepOrder::new(body.pattern()));
    let mut solver = Multigrid::<C>::new(body.pattern(), body.fixed(), sweep).unwrap();
    let h = courant * width / (bulk + 4.0 / 3.0).sqrt();
    let modulus = 0.25 * h * h;
    // The argument of the mode of k = 2.
    let shift = if C == 1 { [modulus, 0.0] } else { [0.5 * modulus, 0.75f64.sqrt() * modulus] };
    let positions = body.mesh().points().as_flattened();
    let (stiffness, mass, fixed) = (&assembly.matrix, body.mass(), body.fixed());
    let (elastic, in_single_precision) = (None, false);
    let system = Shifted { stiffness, mass, fixed, positions, shift, elastic, in_single_precision };
    solver.factorize(&system).unwrap();
    let value = |at: usize| if fixed[at / C] { 0.0 } else { ((at * at) as f64 * 0.1).sin() };
    let mut x: Vec<f64> = (0..C * body.n_dofs()).map(value).collect();
    solver.solve(&mut x, 1e-3).unwrap()
}

/// A free body of neo-Hooke material with a bulk modulus for the shear modulus 1 and the density 1.
fn free(mesh: Mesh, bulk: f64) -> Body {
    let rubber = NeoHooke::new(bulk - 2.0 / 3.0, 1.0).unwrap();
    Body::builder(mesh).region(Region::new(rubber, 1.0)).build().unwrap()
}

/// Bulk modulus of a soft rubber foam, Poisson's ratio 1/3.
const BULK: f64 = 8.0 / 3.0;

const COURANT_NUMBERS: [f64; 4] = [20.0, 80.0, 320.0, 1e4];

/// PETSc's GAMG takes 5 to 8 (27 thousand degrees of freedom, rigid modes as near-null space).
#[test]
fn iterations_depend_on_neither_size_nor_courant_number() {
    for r in [2, 4] {
        let body = free(crate::mesh::l_block(1.0 / f64::from(r)).unwrap(), BULK);
        for courant in COURANT_NUMBERS {
            assert!(iterations::<1>((&body, BULK), courant, 1.0 / f64::from(r)) <= 6, "{r} {courant}");
        }
        assert!(iterations::<2>((&body, BULK), 1e3, 1.0 / f64::from(r)) <= 9, "{r}");
    }
    // 197 thousand degrees of freedom.
    let body = free(crate::mesh::l_block(0.125).unwrap(), BULK);
    assert!([20.0, 1e4].iter().all(|courant| iterations::<1>((&body, BULK), *courant, 0.125) <= 6));
    let stiffer = free(crate::mesh::l_block(0.5).unwrap(), 10.0);
    assert!(COURANT_NUMBERS.iter().all(|courant| iterations::<1>((&stiffer, 10.0), *courant, 0.5) <= 12));
}

#[test]
fn plates_beams_and_quadratic_cells_take_a_few_more() {
    let plate = crate::mesh::block([20.0, 20.0, 1.0], [40, 40, 2]).unwrap();
    let beam = crate::mesh::block([50.0, 1.0, 1.0], [100, 2, 2]).unwrap();
    for (what, mesh, width, most) in [
        ("plate, hex8", plate, 0.5, 9),
        ("beam, hex8", beam, 0.5, 12),
        ("flat hex8", crate::mesh::block([10.0, 10.0, 0.4], [10, 10, 4]).unwrap(), 0.1, 100),
        ("block, tet10", quadratic(CellKind::Tet10, [1.5, 5.0, 1.5], [3, 10, 3]), 0.5, 14),
        ("beam, hex20", quadratic(CellKind::Hex20, [50.0, 1.0, 1.0], [50, 1, 1]), 1.0, 40),
    ] {
        let body = free(mesh, BULK);
        let counts = COURANT_NUMBERS.map(|courant| iterations::<1>((&body, BULK), courant, width));
        assert!(counts.iter().all(|count| *count <= most), "{what}: {counts:?}");
    }
}
