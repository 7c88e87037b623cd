//! Small bodies in motion, and their exact motion.

use emmy::body::{Body, PointMass, PointTerms, Region};
use emmy::material::Link;
use emmy::motion::{Motion, NewtonSettings, State};

pub(super) use crate::shared::blocks::{soft_block, soft_block_under};
pub(super) use crate::shared::points::{moving, network, orbit};
use crate::shared::schemes::{at, fe};

pub(super) fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 30, ..NewtonSettings::default() }
}

/// Period of the orbit: `tau sqrt(a^3 mu/g)`, a = 1/(1 + e).
pub(super) fn period(e: f64) -> f64 {
    std::f64::consts::TAU * ((1.0 + e).powi(-3) / 4.5).sqrt()
}

/// Four masses at the corners of a tetrahedron with springs along its edges, stretched and rotating.
pub(super) fn springs() -> (Body, State) {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.2, 0.0], [0.1, 0.2, 0.9]];
    let links = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let masses = (0..4).map(|i| PointMass { group: i.to_string(), mass: 1.0 + 0.2 * i as f64 });
    let nodal = PointTerms { masses: masses.collect(), ..Default::default() };
    let region = Region::links(Link::spring(20.0, None).unwrap(), 0.0);
    let body =
        Body::builder(network(&points, &links)).region(region).point_terms(nodal.clone()).build().unwrap();
    let state = moving(&body, &[[1.0, 0.0, 0.5], [0.0, 1.5, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, -0.5]]);
    (body, state)
}

/// Mean over the mass.
pub(super) fn mean(body: &Body, field: &[f64]) -> f64 {
    let squares = field.chunks(3).zip(body.lumped_mass());
    squares.map(|(u, m)| m * u.iter().map(|u| u * u).sum::<f64>()).sum::<f64>().sqrt()
}

/// The state after a time, by an element of a high degree in many steps.
pub(super) fn exact(body: &Body, state: &State, time: f64) -> State {
    let mut motion = Motion::starting(body, at(fe(5), 5), settings(), state.clone()).unwrap();
    for _ in 1..=8 {
        motion.step(time / 8.0).unwrap();
    }
    motion.state().clone()
}

/// Asserts that a number agrees with the book, to a given part of it.
pub(super) fn assert_quoted(what: &str, found: f64, quoted: f64, part: f64) {
    assert!((found - quoted).abs() <= part * quoted.abs(), "{what}: {found} is not the book's {quoted}");
}
