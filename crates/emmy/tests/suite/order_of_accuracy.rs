//! Order 2k at the time nodes for FE(k), AS and DGM of degree k (Betsch and Steinmann 2001; Gauss collocation); order 2
//! for the other steppers, except Newmark's method with gamma other than 1/2.

use emmy::body::{Body, InitialVelocity, Region};
use emmy::material::{HolzapfelGasserOgden, NeoHooke, Volumetric};
use emmy::motion::{Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::{NewmarkFamily, Scheme};

use crate::shared::schemes::{DGM, TRAPEZOIDAL, assumed_strain, at, fe};

/// A soft block that is stretched, sheared and rotated, so slowly that the steps resolve every mode.
fn body() -> Body {
    let rubber = Region::new(NeoHooke::new(1.0, 0.5).unwrap(), 1.0);
    Body::builder(emmy::mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap()).region(rubber).build().unwrap()
}

/// Displacement at t = 1.
fn displacement(body: &Body, scheme: Scheme, degree: usize, size: f64) -> Vec<f64> {
    let motion = InitialVelocity {
        angular_velocity: [0.2, 0.4, 0.6],
        gradient: [[0.4, 0.1, 0.0], [0.0, -0.3, 0.2], [0.1, 0.0, 0.2]],
        ..Default::default()
    };
    let state = State::initial(body, 0.0, &[motion]).unwrap();
    let settings = NewtonSettings { tolerance: 1e-13, max_iterations: 20, ..NewtonSettings::default() };
    let mut motion = Motion::starting(body, at(scheme, degree), settings, state).unwrap();
    motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size }]).unwrap(), &mut []).unwrap();
    motion.state().displacement.clone()
}

fn order(body: &Body, reference: &[f64], scheme: Scheme, degree: usize, size: f64) -> f64 {
    let error = |size| {
        let u = displacement(body, scheme, degree, size);
        u.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let (coarse, fine) = (error(size), error(size / 2.0));
    let order = (coarse / fine).log2();
    println!("{scheme} k = {degree}: errors {coarse:.2e}, {fine:.2e}, order {order:.2}");
    order
}

#[test]
fn order_is_twice_the_degree() {
    let body = body();
    // Two more degrees, and a step at which they have converged to rounding.
    let reference = displacement(&body, DGM, 5, 0.05);
    for (degree, size) in [(1, 0.05), (2, 0.2), (3, 0.25)] {
        for scheme in [fe(degree), assumed_strain(5), DGM] {
            let order = order(&body, &reference, scheme, degree, size);
            assert!((order - 2.0 * degree as f64).abs() < 0.25, "{scheme} k = {degree}: order {order}");
        }
    }
}

/// Fibres that go slack during the motion: the tangent has a kink there, which no polynomial in time reproduces.
#[test]
fn fibres_that_go_slack_cost_the_order() {
    let tissue = |k1: f64| {
        let fibres = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let tissue =
            HolzapfelGasserOgden::new(5.0, [k1, 0.5], 0.0, &fibres, 20.0, Volumetric::default()).unwrap();
        let mesh = emmy::mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
        Body::builder(mesh).region(Region::new(tissue, 1.0)).build().unwrap()
    };
    let mean_order = |body: &Body| {
        let reference = displacement(body, DGM, 4, 0.00125);
        let orders = [0.1, 0.05, 0.025].map(|size| order(body, &reference, DGM, 3, size));
        orders.iter().sum::<f64>() / 3.0
    };
    let (without, with) = (mean_order(&tissue(1e-9)), mean_order(&tissue(10.0)));
    assert!(without > 5.7 && with < 4.5, "{without} {with}");
}

#[test]
fn average_acceleration_is_of_second_order() {
    let body = body();
    let reference = displacement(&body, DGM, 5, 0.05);
    assert!((order(&body, &reference, TRAPEZOIDAL, 1, 0.05) - 2.0).abs() < 0.2);
}

#[test]
fn classic_steppers_are_of_second_order() {
    let body = body();
    let reference = displacement(&body, DGM, 5, 0.05);
    for scheme in [
        "Newmark(0.25, 0.5)",
        "HHT(0.05)",
        "HHT(0.3)",
        "generalized-alpha(0.8)",
        "generalized-alpha(0)",
        "Bathe",
    ] {
        let order = order(&body, &reference, scheme.parse().unwrap(), 1, 0.025);
        assert!((order - 2.0).abs() < 0.2, "{scheme}: order {order}");
    }
    // Newmark (1959): the dissipation of gamma > 1/2 costs an order.
    let newmark = Scheme::Newmark(NewmarkFamily::Newmark { beta: 0.3025, gamma: 0.6 });
    let order = order(&body, &reference, newmark, 1, 0.0125);
    assert!((order - 1.0).abs() < 0.1, "order {order}");
}

#[test]
fn central_differences_are_of_second_order() {
    let body = body();
    // The lumped mass gives another system of equations, which is its own reference.
    let scheme = Scheme::CentralDifferences;
    let reference = displacement(&body, scheme, 1, 0.05 / 128.0);
    assert!((order(&body, &reference, scheme, 1, 0.05) - 2.0).abs() < 0.1);
}
