//! Fields of a state: exact for homogeneous deformations on every kind of cell, convergent for others, objective, and
//! consistent with the energy of the body.

#![allow(non_snake_case)]

use crate::shared::patch::Patch;
use crate::shared::plane_patch::plane_patch;
use emmy::body::{Body, PointMass, PointTerms, Region};
use emmy::body::{FieldName, Fields, NodalMotion, Place};
use emmy::internals::element::{element, jacobian};
use emmy::internals::tensor::{Mat3, det};
use emmy::material::{HolzapfelGasserOgden, Link, NeoHooke, SaintVenantKirchhoff, Volumetric};
use emmy::mesh::{CellKind, Mesh, MeshBuilder, block};

const LAMBDA: f64 = 1000.0;
const MU: f64 = 500.0;
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

fn rubber() -> Region {
    Region::new(NeoHooke::new(LAMBDA, MU).unwrap(), 2.0)
}

fn body(mesh: Mesh) -> Body {
    Body::builder(mesh).region(rubber()).build().unwrap()
}

fn product(A: &Mat3<f64>, B: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| A[i][k] * B[k][j]).sum()))
}

fn transposed(A: &Mat3<f64>) -> Mat3<f64> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[j][i]))
}

/// Rotation about an axis by an angle (Rodrigues).
fn rotation(axis: [f64; 3], angle: f64) -> Mat3<f64> {
    let size = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let n = axis.map(|x| x / size);
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    let (sin, cos) = angle.sin_cos();
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| cos * f64::from(u8::from(i == j)) + sin * cross[i][j] + (1.0 - cos) * n[i] * n[j])
    })
}

/// Displacement of a map of the reference positions.
fn displacement(mesh: &Mesh, x: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.points().iter().flat_map(|&X| [0, 1, 2].map(|i| x(X)[i] - X[i])).collect()
}

fn linear(F: &Mat3<f64>) -> impl Fn([f64; 3]) -> [f64; 3] {
    let F = *F;
    move |X| [0, 1, 2].map(|i| (0..3).map(|j| F[i][j] * X[j]).sum())
}

fn fields(body: &Body, displacement: &[f64], names: &[FieldName]) -> Vec<Vec<f64>> {
    let rest = vec![0.0; displacement.len()];
    Fields::new(body).at([displacement, &rest[..]], names).into_iter().map(|field| field.numbers).collect()
}

/// Fields of a neo-Hookean point: Cauchy stress `(mu (b - I) + lambda ln J I) / J`, second Piola-Kirchhoff stress `mu
/// (I - C^-1) + lambda ln J C^-1`, energy `mu/2 (tr C - 3) - mu ln J + lambda/2 (ln J)^2`.
fn neo_hooke(F: &Mat3<f64>) -> (Mat3<f64>, Mat3<f64>, f64) {
    let (J, b, C) = (det(F), product(F, &transposed(F)), product(&transposed(F), F));
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let inverse = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let at = |a: usize, c: usize| C[(j + a) % 3][(i + c) % 3];
            (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) / (J * J)
        })
    });
    let tensor = |entry: &dyn Fn(usize, usize) -> f64| [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
    let cauchy = tensor(&|i, j| (MU * (b[i][j] - unit(i, j)) + LAMBDA * J.ln() * unit(i, j)) / J);
    let second = tensor(&|i, j| MU * (unit(i, j) - inverse[i][j]) + LAMBDA * J.ln() * inverse[i][j]);
    let trace = C[0][0] + C[1][1] + C[2][2];
    (cauchy, second, 0.5 * MU * (trace - 3.0) - MU * J.ln() + 0.5 * LAMBDA * J.ln().powi(2))
}

/// `sqrt(3/2 s : s)` from the deviator itself.
fn von_mises(stress: &Mat3<f64>) -> f64 {
    let mean = (stress[0][0] + stress[1][1] + stress[2][2]) / 3.0;
    let deviator = |i: usize, j: usize| stress[i][j] - if i == j { mean } else { 0.0 };
    let square: f64 = (0..9).map(|n| deviator(n / 3, n % 3).powi(2)).sum();
    (1.5 * square).sqrt()
}

fn assert_all_are(found: &[f64], expected: &[f64], size: f64, what: &str) {
    for (index, tuple) in found.chunks_exact(expected.len()).enumerate() {
        for (a, b) in tuple.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12 * size, "{what} at {index}: {tuple:?} is not {expected:?}");
        }
    }
    assert!(found.len() >= expected.len());
}

const NODAL: [FieldName; 5] = [
    FieldName::CauchyStress,
    FieldName::SecondPiolaKirchhoffStress,
    FieldName::VonMisesStress,
    FieldName::PrincipalStretches,
    FieldName::StrainEnergyDensity,
];
const CELLS: [FieldName; 5] = [
    FieldName::CellCauchyStress,
    FieldName::CellSecondPiolaKirchhoffStress,
    FieldName::CellVonMisesStress,
    FieldName::CellStrainEnergyDensity,
    FieldName::CellVolumeRatio,
];

/// A homogeneous deformation: at every node and in every cell the fields of F, whose stretches are given.
fn is_exact(mesh: Mesh, F: &Mat3<f64>, stretches: [f64; 3], what: &str) {
    let body = body(mesh);
    let displacement = displacement(body.mesh(), linear(F));
    let (cauchy, second, energy) = neo_hooke(F);
    let of = |A: &Mat3<f64>| PAIRS.map(|(i, j)| A[i][j]);
    let found = fields(&body, &displacement, &NODAL);
    let expected: [&[f64]; 5] = [&of(&cauchy), &of(&second), &[von_mises(&cauchy)], &stretches, &[energy]];
    for ((found, expected), name) in found.iter().zip(expected).zip(NODAL) {
        let size = if name == FieldName::PrincipalStretches { 10.0 } else { 1e4 };
        assert_eq!(found.len(), body.mesh().n_nodes() * expected.len());
        assert_all_are(found, expected, size, &format!("{what}: {name}"));
    }
    let found = fields(&body, &displacement, &CELLS);
    let expected: [&[f64]; 5] = [&of(&cauchy), &of(&second), &[von_mises(&cauchy)], &[energy], &[det(F)]];
    for ((found, expected), name) in found.iter().zip(expected).zip(CELLS) {
        assert_eq!(found.len(), body.mesh().n_cells() * expected.len());
        let size = if name == FieldName::CellVolumeRatio { 10.0 } else { 1e4 };
        assert_all_are(found, expected, size, &format!("{what}: {name}"));
    }
}

#[test]
fn homogeneous_deformations_are_exact_on_every_kind() {
    // R Q diag(1.4, 1.1, 0.7) Q^T
    let Q = rotation([1.0, 2.0, -1.0], 0.8);
    let stretch =
        product(&product(&Q, &[[0.7, 0.0, 0.0], [0.0, 1.4, 0.0], [0.0, 0.0, 1.1]]), &transposed(&Q));
    let F = product(&rotation([-2.0, 1.0, 3.0], 2.1), &stretch);
    for kind in CellKind::SOLIDS {
        let mesh = Patch { bricks: 2, curved: false, distortion: 1.0 }.mesh(kind);
        is_exact(mesh, &F, [1.4, 1.1, 0.7], kind.name());
    }
}

/// In plane strain, the stress across the plane belongs to a stretch of 1; it is not zero.
#[test]
fn homogeneous_deformations_are_exact_in_plane_strain() {
    let Q = rotation([0.0, 0.0, 1.0], 0.5);
    let stretch =
        product(&product(&Q, &[[1.3, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 1.0]]), &transposed(&Q));
    let F = product(&rotation([0.0, 0.0, 1.0], 1.9), &stretch);
    let (cauchy, ..) = neo_hooke(&F);
    assert!(cauchy[2][2].abs() > 1.0);
    for kind in CellKind::PLANES {
        is_exact(plane_patch(kind, 3), &F, [1.3, 1.0, 0.8], kind.name());
    }
}

/// Positions `X + 0.1 f(X)` with quadratic functions f_i, and their F.
fn bent([x, y, z]: [f64; 3]) -> ([f64; 3], Mat3<f64>) {
    let f = [x * y + 0.5 * z * z, y * y - x * z, x * x + 0.3 * y * z];
    let G = [[y, x, z], [-z, 2.0 * y, -x], [2.0 * x, 0.3 * z, 0.3 * y]];
    let F = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.1 * G[i][j] + f64::from(u8::from(i == j))));
    ([x + 0.1 * f[0], y + 0.1 * f[1], z + 0.1 * f[2]], F)
}

/// Quadratic cells have a deformation that is linear in space at their points, and its projection is exact, at the
/// surface too.
#[test]
fn fields_that_vary_are_exact_where_the_cells_have_them() {
    for kind in [CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Wedge15, CellKind::Pyramid13] {
        let body = body(Patch { bricks: 2, curved: false, distortion: 0.0 }.mesh(kind));
        let displacement = displacement(body.mesh(), |X| bent(X).0);
        let found = fields(&body, &displacement, &[FieldName::CauchyStress]);
        for (found, &X) in found[0].chunks_exact(6).zip(body.mesh().points()) {
            let (cauchy, ..) = neo_hooke(&bent(X).1);
            for (found, (i, j)) in found.iter().zip(PAIRS) {
                assert!((found - cauchy[i][j]).abs() < 1e-10, "{kind} at {X:?}: {found} {}", cauchy[i][j]);
            }
        }
    }
}

/// Positions of a smooth deformation that no cell reproduces, and its F.
fn waved([x, y, z]: [f64; 3]) -> ([f64; 3], Mat3<f64>) {
    let (a, b, c) = (2.0 * x + y, 2.0 * y - z, 2.0 * z + x);
    let position = [x + 0.08 * a.sin(), y + 0.08 * b.cos(), z + 0.08 * c.sin()];
    let G = [
        [0.16 * a.cos(), 0.08 * a.cos(), 0.0],
        [0.0, -0.16 * b.sin(), 0.08 * b.sin()],
        [0.08 * c.cos(), 0.0, 0.16 * c.cos()],
    ];
    (position, [0, 1, 2].map(|i| [0, 1, 2].map(|j| G[i][j] + f64::from(u8::from(i == j)))))
}

/// Largest error of the Cauchy stress at the inner nodes, and at all nodes.
fn errors(kind: CellKind, bricks: usize) -> [f64; 2] {
    let body = body(Patch { bricks, curved: false, distortion: 1.0 }.mesh(kind));
    let displacement = displacement(body.mesh(), |X| waved(X).0);
    let found = fields(&body, &displacement, &[FieldName::CauchyStress]);
    let mut errors = [0.0f64; 2];
    for (found, &X) in found[0].chunks_exact(6).zip(body.mesh().points()) {
        let (cauchy, ..) = neo_hooke(&waved(X).1);
        let error =
            found.iter().zip(PAIRS).map(|(found, (i, j))| (found - cauchy[i][j]).abs()).fold(0.0, f64::max);
        // One cell away from the surface, averages are two-sided.
        if X.iter().all(|&x| x > 0.2 && x < 0.8) {
            errors[0] = errors[0].max(error);
        }
        errors[1] = errors[1].max(error);
    }
    errors
}

/// Order 2 inside and 1 at the surface of linear cells, whose gradients have order 1; order 2 of quadratic ones.
#[test]
fn recovered_stresses_converge() {
    for (kind, bricks, orders) in [
        (CellKind::Hex8, [4, 8], [1.7, 0.8]),
        (CellKind::Tet4, [4, 8], [0.8, 0.7]),
        (CellKind::Wedge6, [4, 8], [0.8, 0.7]),
        (CellKind::Pyramid5, [3, 6], [0.8, 0.7]),
        (CellKind::Hex20, [3, 6], [1.7, 1.7]),
        (CellKind::Tet10, [3, 6], [1.7, 1.7]),
        (CellKind::Wedge15, [3, 6], [1.7, 1.7]),
        (CellKind::Pyramid13, [3, 6], [1.7, 1.7]),
    ] {
        let [coarse, fine] = bricks.map(|bricks| errors(kind, bricks));
        for place in 0..2 {
            let order = (coarse[place] / fine[place]).log2();
            assert!(order > orders[place], "{kind}: order {order:.2} of {coarse:?} {fine:?}");
        }
    }
}

/// Fibres in two directions, so that nothing is isotropic.
fn tissue() -> Region {
    let fibres = vec![[1.0, 0.5, 0.0], [0.0, 0.3, 1.0]];
    let volume = Volumetric::Quadratic;
    Region::new(HolzapfelGasserOgden::new(3.0, [2.0, 0.7], 0.1, &fibres, 40.0, volume).unwrap(), 1.0)
}

#[test]
fn rotations_turn_the_cauchy_stress_and_leave_the_rest() {
    let mesh = Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(CellKind::Hex20);
    let body = Body::builder(mesh).region(tissue()).build().unwrap();
    let R = rotation([1.0, -0.4, 2.0], 2.3);
    let plain = displacement(body.mesh(), |X| waved(X).0);
    let turned = displacement(body.mesh(), |X| {
        let x = waved(X).0;
        [0, 1, 2].map(|i| (0..3).map(|j| R[i][j] * x[j]).sum::<f64>() + 7.0)
    });
    let (plain, turned) = (fields(&body, &plain, &NODAL), fields(&body, &turned, &NODAL));
    let size = plain[1].iter().fold(0.0, |size: f64, s| size.max(s.abs()));
    for field in 1..NODAL.len() {
        for (a, b) in plain[field].iter().zip(&turned[field]) {
            assert!((a - b).abs() < 1e-11 * size, "{}: {a} {b}", NODAL[field]);
        }
    }
    for (a, b) in plain[0].chunks_exact(6).zip(turned[0].chunks_exact(6)) {
        let index = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
        let a = product(&product(&R, &index.map(|row| row.map(|i| a[i]))), &transposed(&R));
        for (b, (i, j)) in b.iter().zip(PAIRS) {
            assert!((b - a[i][j]).abs() < 1e-11 * size);
        }
    }
}

/// Volume of a cell by the quadrature of its internal force.
fn volume(mesh: &Mesh, index: usize) -> f64 {
    let cell = mesh.cell(index);
    let X: Vec<[f64; 3]> = cell.nodes.iter().map(|&node| mesh.points()[node as usize]).collect();
    let mut dN = vec![[0.0; 3]; X.len()];
    let rule = element(cell.kind).quadrature();
    rule.iter()
        .map(|(&xi, weight)| {
            element(cell.kind).gradient(xi, &mut dN);
            weight * det(&jacobian(cell.kind, &X, &dN))
        })
        .sum()
}

/// The mean energy density of a cell times its volume is the energy summed by the body over the quadrature points.
#[test]
fn energies_of_the_cells_add_up_to_the_energy_of_the_body() {
    let solids = CellKind::SOLIDS.map(|kind| Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(kind));
    let planes = CellKind::PLANES.map(|kind| plane_patch(kind, 3));
    for mesh in solids.into_iter().chain(planes) {
        let section = if mesh.cell(0).kind.dimension() == 2 { 0.3 } else { 1.0 };
        let body = Body::builder(mesh).region(rubber().with_thickness(section)).build().unwrap();
        let in_plane = section < 1.0;
        let displacement = displacement(body.mesh(), |X| {
            let [x, y, z] = waved(X).0;
            if in_plane { [x, y, X[2]] } else { [x, y, z] }
        });
        let density = &fields(&body, &displacement, &[FieldName::CellStrainEnergyDensity])[0];
        let energy: f64 = density.iter().enumerate().map(|(i, W)| W * volume(body.mesh(), i) * section).sum();
        let expected = body.strain_energy(&displacement);
        assert!((energy - expected).abs() < 1e-13 * expected, "{energy} is not {expected}");
        assert!(expected > 1.0);
    }
}

/// Two cubes of different material and density side by side along x, with a common face at x = 1.
fn two_cubes() -> Body {
    let whole = block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
    let mut builder = MeshBuilder::new();
    whole.points().iter().for_each(|&point| {
        builder.point(point);
    });
    for (name, cell) in ["soft", "hard"].into_iter().zip(whole.cells()) {
        let index = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(name, [index]);
    }
    let region = |name: &str, density: f64, mu: f64| {
        Region::new(SaintVenantKirchhoff::new(0.0, mu).unwrap(), density).on(name)
    };
    let regions = vec![region("soft", 1.0, 10.0), region("hard", 3.0, 70.0)];
    let masses = vec![PointMass { group: "soft".into(), mass: 5.0 }];
    let nodal = PointTerms { masses, ..Default::default() };
    Body::builder(builder.build().unwrap()).regions(regions).point_terms(nodal.clone()).build().unwrap()
}

/// S = 2 mu E of each side, E_11 = (1.2^2 - 1)/2 = 0.22; the mean of both in between.
#[test]
fn between_regions_there_is_the_mean_and_the_cells_have_the_sides() {
    let body = two_cubes();
    let displacement = displacement(body.mesh(), |[x, y, z]| [1.2 * x, y, z]);
    let names = [FieldName::SecondPiolaKirchhoffStress, FieldName::CellSecondPiolaKirchhoffStress];
    let found = fields(&body, &displacement, &names);
    for (node, X) in body.mesh().points().iter().enumerate() {
        let mu = if X[0] < 0.5 {
            10.0
        } else if X[0] > 1.5 {
            70.0
        } else {
            40.0
        };
        assert!((found[0][6 * node] - 2.0 * mu * 0.22).abs() < 1e-12, "{X:?}: {}", found[0][6 * node]);
    }
    assert!((found[1][0] - 4.4).abs() < 1e-12 && (found[1][6] - 30.8).abs() < 1e-12);
}

#[test]
fn momentum_density_is_density_times_velocity_without_point_masses() {
    let body = two_cubes();
    let rest = vec![0.0; body.n_dofs()];
    let velocity: Vec<f64> = body.mesh().points().iter().flat_map(|_| [1.0, -2.0, 0.5]).collect();
    let found = Fields::new(&body).at([&rest, &velocity], &[FieldName::MomentumDensity, FieldName::Velocity]);
    for (p, X) in found[0].numbers.chunks_exact(3).zip(body.mesh().points()) {
        let density = if X[0] < 0.5 {
            1.0
        } else if X[0] > 1.5 {
            3.0
        } else {
            2.0
        };
        assert_eq!(p, [density, -2.0 * density, 0.5 * density]);
    }
    assert_eq!(found[1].numbers, velocity);
}

/// Two bars and a spring at one node: forces, and stresses along the current bars.
#[test]
fn links_have_a_force_and_bars_a_stress_along_their_axis() {
    let mut builder = MeshBuilder::new();
    let nodes = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|X| builder.point(X));
    for (name, ends) in [("bar", [0, 1]), ("spring", [0, 2])] {
        let cell = builder.cell(CellKind::Line2, &ends.map(|end| nodes[end])).unwrap();
        builder.cell_group(name, [cell]);
    }
    let bar = Region::links(Link::bar(1000.0, 0.5).unwrap(), 4.0).on("bar");
    let spring = Region::links(Link::spring(8.0, Some(0.25)).unwrap(), 0.0).on("spring");
    let nodal =
        PointTerms { masses: vec![PointMass { group: "spring".into(), mass: 1.0 }], ..Default::default() };
    let body = Body::builder(builder.build().unwrap())
        .region(bar)
        .region(spring)
        .point_terms(nodal.clone())
        .build()
        .unwrap();
    // The bar turns to y and is 2.4 long: e = (1.2^2 - 1)/2 = 0.22, N = E A e 1.2; the spring turns to x, 0.75 long.
    let displacement = [0.0, 0.0, 0.0, -2.0, 2.4, 0.0, 0.75, -1.0, 0.0];
    let mut names = vec![FieldName::AxialForce];
    names.extend(CELLS);
    names.extend(NODAL);
    names.push(FieldName::MomentumDensity);
    let found = Fields::new(&body).at([&displacement, &displacement], &names);
    let near = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        found
            .iter()
            .zip(expected)
            .for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}"));
    };
    near(&found[0].numbers, &[132.0, 4.0]);
    let mut cauchy = [0.0; 12];
    cauchy[1] = 264.0;
    near(&found[1].numbers, &cauchy);
    let mut second = [0.0; 12];
    second[0] = 220.0;
    near(&found[2].numbers, &second);
    near(&found[3].numbers, &[264.0, 0.0]);
    near(&found[4].numbers, &[24.2, 0.0]);
    near(&found[5].numbers, &[1.2, 1.0]);
    near(&found[6].numbers, &[0.0; 18]);
    near(&found[9].numbers, &[1.0; 9]);
    near(&found[11].numbers, &[0.0, 0.0, 0.0, -8.0, 9.6, 0.0, 0.0, 0.0, 0.0]);
    // Zero stresses need not be written.
    let fields = Fields::new(&body);
    assert!(fields.has(FieldName::AxialForce) && fields.has(FieldName::CellCauchyStress));
    assert!(!fields.has(FieldName::CauchyStress) && !Fields::new(&two_cubes()).has(FieldName::AxialForce));
}

#[test]
fn a_body_at_rest_has_no_stress() {
    let body = Body::builder(block([1.0; 3], [2; 3]).unwrap()).region(tissue()).build().unwrap();
    let rest = vec![0.0; body.n_dofs()];
    for (values, name) in fields(&body, &rest, &FieldName::ALL).iter().zip(FieldName::ALL) {
        if matches!(name, FieldName::ContactGap | FieldName::Acceleration) {
            // Nothing is near, and no acceleration is given.
            assert!(values.iter().all(|value| value.is_nan()));
            continue;
        }
        use FieldName::{CellVolumeRatio, LargestStretch, PrincipalStretches};
        let is_ratio = matches!(name, PrincipalStretches | LargestStretch | CellVolumeRatio);
        let expected = if is_ratio { 1.0 } else { 0.0 };
        assert!(values.iter().all(|&value| value == expected), "{name}");
        let n = if name.place() == Place::Nodes { body.mesh().n_nodes() } else { body.mesh().n_cells() };
        assert_eq!(values.len(), n * name.components().len());
    }
}

#[test]
fn inverted_cells_have_no_values() {
    let body = body(block([1.0; 3], [1; 3]).unwrap());
    let displacement = displacement(body.mesh(), |[x, y, z]| [-x, y, z]);
    let found = fields(&body, &displacement, &NODAL);
    assert!(found.iter().flatten().all(|value| value.is_nan()));
    let ratio = &fields(&body, &displacement, &[FieldName::CellVolumeRatio])[0];
    assert!((ratio[0] + 1.0).abs() < 1e-14, "{ratio:?}");
}

/// A deformation that leaves the surface of the cube in place leaves its volume, whatever becomes of the cells. The
/// quadrature of these kinds is exact for the volume of any cell.
#[test]
fn volume_ratios_add_up_to_the_volume_that_the_surface_encloses() {
    let kinds = [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Wedge15];
    for kind in kinds.into_iter().chain([CellKind::Pyramid5, CellKind::Pyramid13]) {
        let body = body(Patch { bricks: 2, curved: false, distortion: 1.0 }.mesh(kind));
        let displacement = displacement(body.mesh(), |X| {
            let bubble: f64 = X.iter().map(|x| 4.0 * x * (1.0 - x)).product();
            [X[0] + 0.1 * bubble, X[1] - 0.05 * bubble, X[2] + 0.07 * bubble]
        });
        let ratio = &fields(&body, &displacement, &[FieldName::CellVolumeRatio])[0];
        let volume: f64 = ratio.iter().enumerate().map(|(cell, J)| J * volume(body.mesh(), cell)).sum();
        assert!((volume - 1.0).abs() < 1e-14, "{kind}: {volume}");
        assert!(ratio.iter().any(|J| (J - 1.0).abs() > 0.05), "{kind}");
    }
}

/// Two regions of different materials, deformed and in motion without any symmetry.
fn two_regions() -> (Body, Vec<f64>, Vec<f64>) {
    let whole = block([2.0, 3.0, 1.0], [4, 3, 2]).unwrap();
    let mut builder = MeshBuilder::new();
    for &point in whole.points() {
        builder.point(point);
    }
    for (index, cell) in whole.cells().enumerate() {
        let cell = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(if index % 3 == 0 { "left" } else { "right" }, [cell]);
    }
    let mesh = builder.build().unwrap();
    let stiff = Region::new(SaintVenantKirchhoff::new(4000.0, 900.0).unwrap(), 0.3).on("right");
    let body = Body::builder(mesh).region(rubber().on("left")).region(stiff).build().unwrap();
    let wave = |X: &[f64; 3]| [0.1 * (X[1] + X[2]).sin(), 0.05 * X[0] * X[0], 0.02 * X[0] * X[1]];
    let displacement: Vec<f64> = body.mesh().points().iter().flat_map(wave).collect();
    let velocity: Vec<f64> =
        body.mesh().points().iter().flat_map(|X| [X[1] * X[2], 2.0 - X[0], X[0] * X[0]]).collect();
    (body, displacement, velocity)
}

/// A selection sees the cells around it alone, and gets the same bits.
#[test]
fn fields_of_a_selection_are_those_of_the_whole_body() {
    let (body, displacement, velocity) = two_regions();
    let fields = Fields::new(&body);
    let motion =
        NodalMotion { displacement: &displacement, velocity: &velocity, acceleration: &displacement };
    for name in FieldName::ALL.into_iter().filter(|&name| fields.has(name)) {
        let whole = &fields.at(motion, &[name])[0].numbers;
        let n = name.components().len();
        let members: Vec<u32> = vec![7, 0, 11, 23];
        let selection = match name.place() {
            Place::Nodes => fields.select_nodes(&members),
            Place::Cells => fields.select_cells(&members),
        };
        let of = |member: &u32| &whole[n * *member as usize..n * (*member as usize + 1)];
        let expected: Vec<f64> = members.iter().flat_map(of).copied().collect();
        assert_eq!(fields.on(&selection, motion, name), expected, "{name}");
    }
}

/// Where regions meet, fields recovered from the cells of one of them are those of its material; all cells give the
/// mean by volume.
#[test]
fn each_side_of_an_interface_has_its_own_fields() {
    let (body, _, _) = two_regions();
    let fields = Fields::new(&body);
    let F = [[1.2, 0.1, -0.05], [0.02, 0.9, 0.1], [0.04, -0.03, 1.1]];
    let displacement = displacement(body.mesh(), linear(&F));
    let velocity = vec![3.0; displacement.len()];
    let on = |group: &str, name: FieldName| {
        let cells = body.mesh().groups().cells(group).unwrap().to_vec();
        let nodes = body.mesh().group_nodes(group).unwrap();
        let selection = fields.select_nodes_in(&nodes, cells);
        assert_eq!(selection.members(), nodes);
        fields.on(&selection, [&displacement, &velocity], name)
    };
    let (cauchy, _, energy) = neo_hooke(&F);
    let components = PAIRS.map(|(i, j)| cauchy[i][j]);
    assert_all_are(&on("left", FieldName::CauchyStress), &components, 1e3, "stress");
    assert_all_are(&on("left", FieldName::VonMisesStress), &[von_mises(&cauchy)], 1e3, "von Mises stress");
    assert_all_are(&on("left", FieldName::StrainEnergyDensity), &[energy], 1e2, "energy");
    // St. Venant-Kirchhoff: S = lambda tr E I + 2 mu E, sigma = F S F^T / det F.
    let C = product(&transposed(&F), &F);
    let E = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (C[i][j] - f64::from(u8::from(i == j))) / 2.0));
    let trace = E[0][0] + E[1][1] + E[2][2];
    let S =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| 1800.0 * E[i][j] + if i == j { 4000.0 * trace } else { 0.0 }));
    let stiff = product(&product(&F, &S), &transposed(&F)).map(|row| row.map(|x| x / det(&F)));
    assert_all_are(&on("right", FieldName::VonMisesStress), &[von_mises(&stiff)], 1e4, "von Mises stress");
    for (group, density) in [("left", 2.0), ("right", 0.3)] {
        assert_all_are(&on(group, FieldName::MomentumDensity), &[3.0 * density; 3], 1.0, group);
    }
    let whole = fields.at([&displacement, &velocity], &[FieldName::VonMisesStress]).remove(0).numbers;
    let between = |x: f64| x > 1.01 * von_mises(&cauchy) && x < 0.99 * von_mises(&stiff);
    assert!(whole.iter().any(|&x| between(x)), "no node has a mean of both sides");
}

/// In cells with curved edges the points of the stresses and those of the mass give different volumes.
#[test]
fn energies_of_curved_cells_add_up_to_the_energies_of_the_body() {
    let mut largest: f64 = 0.0;
    let mut assert_adds_up = |body: &Body, what: &str| {
        let (fields, mesh) = (Fields::new(body), body.mesh());
        let wave = |X: &[f64; 3]| [0.1 * X[1].sin(), 0.05 * X[0] * X[0], 0.0];
        let displacement: Vec<f64> = mesh.points().iter().flat_map(wave).collect();
        let velocity: Vec<f64> =
            mesh.points().iter().flat_map(|X| [0.3 + X[1] * X[0], 2.0 - X[0], 0.0]).collect();
        let total = |name: FieldName| {
            let densities = &fields.at([&displacement, &velocity], &[name])[0].numbers;
            (0..mesh.n_cells()).map(|cell| densities[cell] * fields.volume_for(name, cell)).sum::<f64>()
        };
        let mut momentum = vec![0.0; velocity.len()];
        body.mass_product(&velocity, &mut momentum);
        let kinetic = 0.5 * momentum.iter().zip(&velocity).map(|(p, v)| p * v).sum::<f64>();
        let strain = body.strain_energy(&displacement);
        for (name, energy) in
            [(FieldName::CellKineticEnergyDensity, kinetic), (FieldName::CellStrainEnergyDensity, strain)]
        {
            assert!((total(name) - energy).abs() < 1e-13 * energy, "{what}: {name} {}", total(name) - energy);
        }
        for cell in 0..mesh.n_cells() {
            let volumes =
                [fields.cell_volume(cell), fields.volume_for(FieldName::CellKineticEnergyDensity, cell)];
            largest = largest.max((volumes[1] / volumes[0] - 1.0).abs());
        }
    };
    for kind in CellKind::ALL {
        match kind.dimension() {
            3 => {
                let mesh = Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(kind);
                assert_adds_up(&body(mesh), &format!("{kind}"));
            }
            2 => {
                let region = rubber().with_thickness(0.3);
                let plane = Body::builder(plane_patch(kind, 2)).region(region).build().unwrap();
                assert_adds_up(&plane, &format!("{kind}"));
            }
            _ => {}
        }
    }
    assert!(largest > 1e-6, "in no cell the two volumes differ: {largest}");
}

/// Energy densities times volumes are the energies of the body: `v . M v / 2` and the sum of its terms.
#[test]
fn energies_of_cells_add_up_to_the_energies_of_the_body() {
    let (body, displacement, velocity) = two_regions();
    let fields = Fields::new(&body);
    let total = |name: FieldName| {
        let densities = &fields.at([&displacement, &velocity], &[name])[0].numbers;
        densities.iter().enumerate().map(|(cell, density)| density * fields.cell_volume(cell)).sum::<f64>()
    };
    let strain = body.strain_energy(&displacement);
    assert!((total(FieldName::CellStrainEnergyDensity) - strain).abs() < 1e-13 * strain);
    let mut momentum = vec![0.0; velocity.len()];
    body.mass_product(&velocity, &mut momentum);
    let kinetic = 0.5 * momentum.iter().zip(&velocity).map(|(p, v)| p * v).sum::<f64>();
    assert!((total(FieldName::CellKineticEnergyDensity) - kinetic).abs() < 1e-13 * kinetic);
}
