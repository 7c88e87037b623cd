//! Manufactured solutions: for a given motion with finite strain, the loads are derived by dual numbers, and the
//! computed motion must converge to it with the order of the method.
//!
//! ```math
//! b = rho u_,tt - div P,    t = P n,    P = mu (F - F^-T) + lambda ln J F^-T     (neo-Hooke, written independently of the library)
//! ```

#![allow(non_snake_case)]

use crate::shared::patch::Patch;
use crate::shared::plane_patch::plane_patch;
use crate::shared::schemes::{DGM, at};
use emmy::body::{Body, Field, Load, LoadKind, Region, Support, TimeFunction};
use emmy::internals::element::{element, jacobian};
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Mesh};
use emmy::motion::{Motion, NewtonSettings, State};
use num_dual::{Dual, Dual2_64, Dual64, DualNum};

const LAMBDA: f64 = 30.0;
const MU: f64 = 20.0;
const DENSITY: f64 = 1.5;

/// A given displacement, in space or in the plane z = 0.7.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Given {
    Space,
    Plane,
}

/// The displacement: at rest on the face x = 0, else strains of up to 20 %, without any symmetry. In plane strain it is
/// taken in the plane z = 0, without the component along z.
fn u<D: DualNum<Primitive = f64> + Copy>(given: Given, [x, y, z]: [D; 3], t: D) -> [D; 3] {
    if given == Given::Plane {
        let zero = <D as From<f64>>::from(0.0);
        let [u, v, _] = u(Given::Space, [x, y, zero], t);
        return [u, v, zero];
    }
    let (s, c) = ((t * 2.0).sin(), (t * 3.0 + 0.4).sin());
    let wave = (x * 1.2).sin();
    [
        s * wave * (y * z * 0.1 + 0.08) + c * x * x * 0.05,
        s * wave * ((y * 1.1).cos() * 0.12 + z * 0.08) - c * x * y * y * 0.04,
        c * wave * (z * 0.5).exp() * 0.08 + s * x * x * y * 0.05,
    ]
}

/// Displacement gradient, one direction after the other.
fn gradient<D: DualNum<Primitive = f64> + Copy>(given: Given, X: [D; 3], t: D) -> [[D; 3]; 3] {
    let (zero, one) = (<D as From<f64>>::from(0.0), <D as From<f64>>::from(1.0));
    let columns = [0, 1, 2].map(|J| {
        let along = [0, 1, 2].map(|i| Dual::new(X[i], if i == J { one } else { zero }));
        u(given, along, Dual::new(t, zero)).map(|u| u.eps)
    });
    [0, 1, 2].map(|i| [0, 1, 2].map(|J| columns[J][i]))
}

/// First Piola-Kirchhoff stress.
fn stress<D: DualNum<Primitive = f64> + Copy>(given: Given, X: [D; 3], t: D) -> [[D; 3]; 3] {
    let mut F = gradient(given, X, t);
    (0..3).for_each(|i| F[i][i] += <D as From<f64>>::from(1.0));
    let cofactor = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let at = |a: usize, b: usize| F[(i + a) % 3][(j + b) % 3];
            at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
        })
    });
    let J = F[0][0] * cofactor[0][0] + F[0][1] * cofactor[0][1] + F[0][2] * cofactor[0][2];
    let factor = (J.ln() * LAMBDA - MU) / J;
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| F[i][j] * MU + cofactor[i][j] * factor))
}

fn body_force(given: Given, X: [f64; 3], t: f64) -> [f64; 3] {
    let acceleration = u(given, X.map(Dual2_64::from), Dual2_64::from(t).derivative()).map(|u| u.v2);
    let mut force = acceleration.map(|a| DENSITY * a);
    for J in 0..3 {
        let along = [0, 1, 2].map(|i| Dual64::new(X[i], if i == J { 1.0 } else { 0.0 }));
        let P = stress(given, along, Dual64::from(t));
        (0..3).for_each(|i| force[i] -= P[i][J].eps);
    }
    force
}

/// The body under its loads, fixed on x = 0.
fn body(mesh: Mesh, given: Given) -> Body {
    let field = Field::new(move |X, t| body_force(given, X, t));
    let mut kinds = vec![LoadKind::BodyForceField { group: None, field }];
    let faces =
        [("x-max", 0, 1.0), ("y-min", 1, -1.0), ("y-max", 1, 1.0), ("z-min", 2, -1.0), ("z-max", 2, 1.0)];
    let n_faces = if given == Given::Plane { 3 } else { 5 };
    for (group, axis, sign) in faces.into_iter().take(n_faces) {
        let field = Field::new(move |X, t| {
            let P = stress(given, X, t);
            [0, 1, 2].map(|i| sign * P[i][axis])
        });
        kinds.push(LoadKind::TractionField { group: group.into(), field });
    }
    let loads: Vec<Load> =
        kinds.into_iter().map(|kind| Load { kind, time_function: TimeFunction::constant() }).collect();
    let clamp = Support { group: "x-min".into(), fix: [true; 3], ..Default::default() };
    let rubber = Region::new(NeoHooke::new(LAMBDA, MU).unwrap(), DENSITY);
    Body::builder(mesh).region(rubber).support(clamp).loads(&loads).build().unwrap()
}

/// The state of the given motion at t = 0 at the nodes.
fn start(body: &Body, given: Given) -> State {
    let mut state = State::initial(body, 0.0, &[]).unwrap();
    for (node, &X) in body.mesh().points().iter().enumerate() {
        let at = u(given, X.map(Dual64::from), Dual64::from(0.0).derivative());
        for i in 0..3 {
            state.displacement[3 * node + i] = at[i].re;
            state.velocity[3 * node + i] = at[i].eps;
        }
    }
    body.mass_product(&state.velocity, &mut state.momentum);
    state
}

/// The state after n steps until a time.
fn run(body: &Body, given: Given, degree: usize, until: f64, n: usize) -> State {
    let settings = NewtonSettings { tolerance: 1e-11, ..Default::default() };
    let mut motion = Motion::starting(body, at(DGM, degree), settings, start(body, given)).unwrap();
    for _ in 1..=n {
        motion.step(until / n as f64).unwrap();
    }
    motion.state().clone()
}

/// Norm in L2 of the error of the displacement.
fn error(body: &Body, given: Given, state: &State) -> f64 {
    let mut square = 0.0;
    for cell in body.mesh().cells() {
        let (element, n) = (element(cell.kind), cell.nodes.len());
        let (mut N, mut dN) = (vec![0.0; n], vec![[0.0; 3]; n]);
        let positions: Vec<[f64; 3]> =
            cell.nodes.iter().map(|&node| body.mesh().points()[node as usize]).collect();
        for (&xi, weight) in element.mass_quadrature().iter() {
            element.shape(xi, &mut N);
            element.gradient(xi, &mut dN);
            let det = emmy::internals::tensor::det(&jacobian(cell.kind, &positions, &dN));
            let X = [0, 1, 2].map(|i| (0..n).map(|A| N[A] * positions[A][i]).sum::<f64>());
            let exact = u(given, X, state.time);
            for i in 0..3 {
                let of = |A: usize| state.displacement[3 * cell.nodes[A] as usize + i];
                let value: f64 = (0..n).map(|A| N[A] * of(A)).sum();
                square += weight * det * (value - exact[i]).powi(2);
            }
        }
    }
    square.sqrt()
}

/// Order of the error in space from n to 2n bricks along an edge.
fn order_in_space(kind: CellKind, n: usize) -> f64 {
    let given = if CellKind::PLANES.contains(&kind) { Given::Plane } else { Given::Space };
    let error = |bricks: usize| {
        let mesh = match given {
            Given::Space => Patch { bricks, curved: false, distortion: 0.5 }.mesh(kind),
            Given::Plane => plane_patch(kind, bricks as u32),
        };
        let body = body(mesh, given);
        // Degree 3 in time: four steps have an error far below the error in space.
        error(&body, given, &run(&body, given, 3, 0.2, 4))
    };
    (error(n) / error(2 * n)).log2()
}

/// Order p + 1 in L2. The linear tetrahedron and wedge approach their order slowly from below (1.6 and 1.7 from 3 to 6
/// bricks, 1.84 and 1.88 from 6 to 12): they get finer meshes.
#[test]
fn every_kind_has_its_order_in_space() {
    for kind in CellKind::SOLIDS.into_iter().chain(CellKind::PLANES) {
        let (n, expected) = match kind {
            CellKind::Tri3 | CellKind::Quad4 => (8, 2.0),
            CellKind::Tri6 | CellKind::Quad8 | CellKind::Quad9 => (6, 3.0),
            CellKind::Tet4 | CellKind::Wedge6 => (6, 2.0),
            CellKind::Hex8 | CellKind::Pyramid5 => (3, 2.0),
            _ => (2, 3.0),
        };
        let order = order_in_space(kind, n);
        assert!((order - expected).abs() < 0.2, "{kind}: order {order}");
    }
}

/// Order 2k in time, on one mesh: differences between runs, which exclude the error in space.
#[test]
fn time_elements_have_order_2k() {
    let body = body(Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(CellKind::Hex8), Given::Space);
    for (degree, n) in [(1, 16), (2, 8), (3, 5)] {
        let end = |n: usize| run(&body, Given::Space, degree, 0.4, n).displacement;
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let (coarse, middle, fine) = (end(n), end(2 * n), end(4 * n));
        let order = 0.5 * (difference(&coarse, &middle) / difference(&middle, &fine)).log2();
        assert!((order - 2.0 * degree as f64).abs() < 0.2, "k = {degree}: order {order}");
    }
}
