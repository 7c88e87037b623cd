//! Iterations of conjugate gradients with multigrid do not depend on size, shape, cells and step size.

use std::sync::Arc;

use crate::average::{Request, Rule};
use crate::body::{Body, Region, StepInput};
use crate::element::CellKind;
use crate::material::NeoHooke;
use crate::mesh::{Mesh, MeshBuilder};
use crate::quadrature::gauss;
use crate::sparse::{Multigrid, Shifted, ShiftedSolver, SweepOrder};

/// A block of quadratic cells.
fn quadratic(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Mesh {
    let mut builder = MeshBuilder::new();
    let points = cells.map(|n| 2 * n + 1);
    let mut number = vec![u32::MAX; points.iter().product()];
    let mut node = |builder: &mut MeshBuilder, at: [usize; 3]| {
        let own = &mut number[(at[2] * points[1] + at[1]) * points[0] + at[0]];
        if *own == u32::MAX {
            *own = builder.point([0, 1, 2].map(|a| size[a] * at[a] as f64 / (2 * cells[a]) as f64));
        }
        *own
    };
    for (i, j, k) in
        (0..cells[2]).flat_map(|k| (0..cells[1]).flat_map(move |j| (0..cells[0]).map(move |i| (i, j, k))))
    {
        let corner = |c: [usize; 3]| [2 * (i + c[0]), 2 * (j + c[1]), 2 * (k + c[2])];
        let between = |a: [usize; 3], b: [usize; 3]| [0, 1, 2].map(|x| (a[x] + b[x]) / 2);
        let hexahedron =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let (corners, edges): (Vec<Vec<[usize; 3]>>, &[[usize; 2]]) = match kind {
            CellKind::Hex20 => (
                vec![hexahedron.map(corner).to_vec()],
                &[
                    [0, 1],
                    [1, 2],
                    [2, 3],
                    [3, 0],
                    [4, 5],
                    [5, 6],
                    [6, 7],
                    [7, 4],
                    [0, 4],
                    [1, 5],
                    [2, 6],
                    [3, 7],
                ],
            ),
            _ => (
                [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]]
                    .into_iter()
                    .enumerate()
                    .map(|(index, axes)| {
                        let mut at = [0; 3];
                        let mut path = vec![corner(at)];
                        for axis in axes {
                            at[axis] = 1;
                            path.push(corner(at));
                        }
                        if index > 2 {
                            path.swap(1, 2);
                        }
                        path
                    })
                    .collect(),
                &[[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]],
            ),
        };
        for corners in corners {
            let middles = edges.iter().map(|[a, b]| between(corners[*a], corners[*b]));
            let all: Vec<[usize; 3]> = corners.iter().copied().chain(middles).collect();
            let nodes: Vec<u32> = all.into_iter().map(|at| node(&mut builder, at)).collect();
            builder.cell(kind, &nodes).unwrap();
        }
    }
    builder.build().unwrap()
}

/// Iterations to 1e-3 at a Courant number, for cells of a width.
fn iterations<const C: usize>((body, bulk): (&Body, f64), courant: f64, width: f64) -> usize {
    let rule = Rule::standard(1, &gauss(1));
    let zero = vec![0.0; body.n_dofs()];
    let mut assembly = body.assembly(1);
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
    solver.factorize(&Shifted { stiffness, mass, fixed, positions, shift }).unwrap();
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
        ("block, tet10", quadratic(CellKind::Tet10, [1.5, 5.0, 1.5], [3, 10, 3]), 0.5, 14),
        ("beam, hex20", quadratic(CellKind::Hex20, [50.0, 1.0, 1.0], [50, 1, 1]), 1.0, 40),
    ] {
        let body = free(mesh, BULK);
        let counts = COURANT_NUMBERS.map(|courant| iterations::<1>((&body, BULK), courant, width));
        assert!(counts.iter().all(|count| *count <= most), "{what}: {counts:?}");
    }
}
