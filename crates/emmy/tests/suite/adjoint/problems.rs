//! Bodies, states and motions of these tests.

use emmy::Error;
use emmy::adjoint::{Goal, Gradient, Trajectory};
use emmy::body::{
    Body, GroundAttraction, GroundSpring, Load, LoadKind, PointTerms, Region, Support, TimeFunction,
};
use emmy::material::{Link, NeoHooke, SaintVenantKirchhoff};
use emmy::mesh;
use emmy::motion::{Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::Scheme;

pub(super) use crate::shared::blocks::soft_block;
pub(super) use crate::shared::points::{masses, network, orbit};
use crate::shared::schemes::{assumed_strain, at, fe};

pub(super) type Result<T, E = Error> = std::result::Result<T, E>;

pub(super) use crate::shared::schemes::DGM;

pub(super) fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 30, ..NewtonSettings::default() }
}

pub(super) fn equal(until: f64, size: f64) -> StepPlan {
    StepPlan::new(0.0, vec![Phase { until, size }]).unwrap()
}

/// Schemes of a degree.
pub(super) fn schemes(k: usize) -> [Scheme; 5] {
    [fe(k), fe(k + 2), assumed_strain(k), assumed_strain(k + 2), DGM]
}

/// Numbers between -1 and 1 without order.
pub(super) fn scattered(n: usize, seed: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * i + 7 * i + 1) as f64 * (1.3 + seed as f64)).sin()).collect()
}

/// A soft block, fixed at its bottom face, under a time-dependent traction and gravity.
pub(super) fn held_block([lambda, mu]: [f64; 2], density: f64, traction: f64, rubber: bool) -> Result<Body> {
    let region = match rubber {
        true => Region::new(NeoHooke::new(lambda, mu)?, density),
        false => Region::new(SaintVenantKirchhoff::new(lambda, mu)?, density),
    };
    let kind = LoadKind::Traction { group: "z-max".into(), traction: [traction, 0.3 * traction, -0.2] };
    let load = Load { kind, time_function: TimeFunction::new(vec![(0.0, 0.2), (0.25, 1.0), (0.6, 0.4)])? };
    let gravity = LoadKind::Acceleration { group: None, acceleration: [0.0, 0.5, -2.0] };
    let support = Support { group: "z-min".into(), fix: [true; 3], ..Default::default() };
    let loads = [load, Load { kind: gravity, time_function: TimeFunction::constant() }];
    Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 2])?)
        .region(region)
        .support(support)
        .loads(&loads)
        .build()
}

pub(super) fn rubber() -> Body {
    held_block([30.0, 15.0], 1.0, 2.0, true).unwrap()
}

/// Four masses at the corners of a tetrahedron with springs along its edges, one on a spring to the ground, all
/// attracted by a star.
pub(super) fn springs(stiffness: f64) -> Result<Body> {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.2, 0.0], [0.1, 0.2, 0.9]];
    let links = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let nodal = PointTerms {
        masses: masses(&[1.0, 1.2, 1.4, 1.6]),
        springs: vec![GroundSpring { group: "2".into(), stiffness: 7.0 }],
        attractions: vec![GroundAttraction { group: None, centre: [3.0, 1.0, 0.5], strength: 4.0 }],
        ..PointTerms::default()
    };
    let region = Region::links(Link::spring(stiffness, None)?, 0.0);
    Body::builder(network(&points, &links)).region(region).point_terms(nodal.clone()).build()
}

/// The state of a body with irregular displacement and velocity on its free degrees of freedom.
pub(super) fn disturbed(body: &Body, displacement: f64, velocity: f64) -> State {
    let mut state = State::initial(body, 0.0, &[]).unwrap();
    let (du, dv) = (scattered(body.n_dofs(), 1), scattered(body.n_dofs(), 2));
    shift(body, &mut state, displacement, &du, velocity, &dv);
    state
}

/// Adds `d du` to the displacement of a state and `e dv` to its velocity.
pub(super) fn shift(body: &Body, state: &mut State, d: f64, du: &[f64], e: f64, dv: &[f64]) {
    for dof in (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]) {
        state.displacement[dof] += d * du[dof];
        state.velocity[dof] += e * dv[dof];
    }
    let mut momentum = std::mem::take(&mut state.momentum);
    body.mass_product(&state.velocity, &mut momentum);
    state.momentum = momentum;
}

/// A goal that depends on the complete last state.
pub(super) fn scattered_goal(body: &Body) -> Goal {
    Goal { displacement: scattered(body.n_dofs(), 3), velocity: scattered(body.n_dofs(), 4) }
}

pub(super) fn end(body: &Body, scheme: Scheme, degree: usize, start: &State, plan: &StepPlan) -> State {
    let mut motion = Motion::starting(body, at(scheme, degree), settings(), start.clone()).unwrap();
    motion.march(plan, &mut []).unwrap();
    motion.state().clone()
}

pub(super) fn trajectory<'a>(
    body: &'a Body,
    scheme: Scheme,
    degree: usize,
    start: &State,
    plan: &StepPlan,
) -> Trajectory<'a> {
    let mut motion = Motion::starting(body, at(scheme, degree), settings(), start.clone()).unwrap();
    let mut trajectory = Trajectory::new(&motion).unwrap();
    motion.march(plan, &mut [&mut trajectory]).unwrap();
    trajectory
}

/// Derivative of a function at zero by differences with an error of order d^4.
pub(super) fn slope(d: f64, of: impl Fn(f64) -> f64) -> f64 {
    (8.0 * (of(d) - of(-d)) - (of(2.0 * d) - of(-2.0 * d))) / (12.0 * d)
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Size of a derivative along a direction, with terms that may cancel.
pub(super) fn size(gradient: &Gradient, [du, dv]: [&[f64]; 2]) -> f64 {
    let norm = |a: &[f64]| dot(a, a).sqrt();
    (norm(&gradient.displacement) * norm(du) + norm(&gradient.velocity) * norm(dv)) / (du.len() as f64).sqrt()
}
