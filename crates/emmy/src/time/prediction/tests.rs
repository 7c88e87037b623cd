//! Motions that are predicted exactly.

use super::{Carry, Prediction};
use crate::body::Body;
use crate::input::{InitialVelocity, Region, Support};
use crate::material::NeoHooke;
use crate::mesh::{Mesh, block};
use crate::tensor::Mat3;
use crate::tensor::rotation::{IDENTITY, exp, image, product, product_transposed, skew};
use crate::time::equations::Equations;
use crate::time::rigid_step::RigidStep;
use crate::time::{State, TimeElement};

fn body_of(mesh: Mesh) -> Body {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.5);
    Body::builder(mesh).region(rubber).build().unwrap()
}

fn system(body: &Body, k: usize) -> Equations<'_> {
    Equations::new(body, TimeElement::discrete_gradient(k).unwrap().coefficients())
}

fn start(system: &mut Equations<'_>, prediction: &mut Prediction, state: &State, h: f64) {
    system.start(&state.displacement, h);
    let k = system.coefficients.rule.degree();
    let n = state.momentum.len();
    for (row, known) in system.coefficients.mass.chunks_exact(k).zip(system.known.chunks_exact_mut(n)) {
        let sum: f64 = row.iter().sum();
        known.iter_mut().zip(&state.momentum).for_each(|(g, p)| *g = sum * h * p);
    }
    prediction.start(system, state);
}

fn spinning(body: &Body, angular_velocity: [f64; 3]) -> State {
    let velocity = [0.3, -0.2, if body.fixed().contains(&true) { 0.0 } else { 0.7 }];
    let motion = InitialVelocity { angular_velocity, velocity, ..Default::default() };
    State::initial(body, 0.0, &[motion]).unwrap()
}

/// The rotation of the whole step, `I + sum_j b_j D_j`.
fn whole_turn(prediction: &Prediction, system: &Equations<'_>) -> Mat3<f64> {
    let mut end = IDENTITY;
    for (D, b) in prediction.motions[0].rigid.rates.iter().zip(system.coefficients.rule.weights()) {
        (0..3).for_each(|i| (0..3).for_each(|j| end[i][j] += b * D[i][j]));
    }
    end
}

fn assert_close(A: &Mat3<f64>, B: &Mat3<f64>, tolerance: f64) {
    for (a, b) in A.iter().flatten().zip(B.iter().flatten()) {
        assert!((a - b).abs() < tolerance, "{A:?} {B:?}");
    }
}

#[test]
fn a_step_turns_the_body_by_an_orthogonal_tensor_without_strain_rates() {
    let body = body_of(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap());
    let state = spinning(&body, [0.7, -1.1, 0.9]);
    for k in 1..=4 {
        let mut system = system(&body, k);
        let mut prediction = Prediction::new(k, &body);
        start(&mut system, &mut prediction, &state, 0.4);
        let end = whole_turn(&prediction, &system);
        assert_close(&product_transposed(&end, &end), &IDENTITY, 1e-14);
        assert_close(&exp(&prediction.motions[0].rigid.rotation), &end, 1e-14);
        for i in 0..k {
            let mut place = IDENTITY;
            for (j, D) in prediction.motions[0].rigid.rates.iter().enumerate() {
                let a = system.coefficients.rule.coefficients()[i * k + j];
                (0..9).for_each(|at| place[at / 3][at % 3] += a * D[at / 3][at % 3]);
            }
            let transposed = [0, 1, 2].map(|r| [0, 1, 2].map(|c| place[c][r]));
            let rate = product(&transposed, &prediction.motions[0].rigid.rates[i]);
            (0..9).for_each(|at| assert!((rate[at / 3][at % 3] + rate[at % 3][at / 3]).abs() < 1e-14));
        }
    }
}

/// Spin w about a principal axis: the mid-point rule rotates a rigid body by 2 atan(h w / 2), and an element of degree
/// k by the correct angle up to an error of order 2k + 1 per step.
#[test]
fn a_spin_about_a_principal_axis_has_the_angle_of_the_time_element() {
    let body = body_of(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap());
    let state = spinning(&body, [0.0, 0.0, 1.3]);
    for k in 1..=3 {
        let mut system = system(&body, k);
        let mut prediction = Prediction::new(k, &body);
        let errors = [0.8, 0.4].map(|h| {
            start(&mut system, &mut prediction, &state, h);
            let [x, y, angle] = prediction.motions[0].rigid.rotation;
            assert!(x.abs() < 1e-14 && y.abs() < 1e-14);
            if k == 1 {
                assert!((angle - 2.0 * (0.5 * 1.3 * h).atan()).abs() < 1e-14);
            }
            (angle - 1.3 * h).abs()
        });
        let order = (errors[0] / errors[1]).log2();
        assert!((order - (2 * k + 1) as f64).abs() < 0.3, "k = {k}: order {order}");
    }
}

/// A steady motion in the body's own frame: each step repeats the last one, rotated with the body.
#[test]
fn a_steady_rotation_is_predicted_to_rounding() {
    let body = body_of(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap());
    let state = spinning(&body, [0.7, -1.1, 0.9]);
    for k in 1..=3 {
        let mut system = system(&body, k);
        let n = body.n_dofs();
        let mut prediction = Prediction::new(k, &body);
        start(&mut system, &mut prediction, &state, 0.3);
        let mut rates = vec![0.0; k * n];
        prediction.predict(Carry::Repeated, &system.coefficients, 0.3, &mut rates);
        // At first only the rigid motion: a rigid body has no other velocity.
        for (i, rates) in rates.chunks_exact(n).enumerate() {
            let move_on = prediction.motions[0].translation[i];
            let D = prediction.motions[0].rigid.rates[i];
            for (x, y) in rates.chunks_exact(3).zip(prediction.arm.chunks_exact(3)) {
                let rigid = image(&D, y);
                (0..3).for_each(|d| assert!((x[d] - move_on[d] - rigid[d]).abs() < 1e-13, "k = {k}"));
            }
        }
        rates.iter_mut().enumerate().for_each(|(at, x)| *x = 0.5 * (1.3 * at as f64).sin());
        prediction.remember(&system.coefficients, &rates, 0.3);

        let turn = exp(&prediction.motions[0].rigid.rotation);
        let mut next = spinning(&body, [0.0; 3]);
        let nodes = body.mesh().points().iter().zip(next.displacement.chunks_exact_mut(3));
        for (X, u) in nodes {
            let q = image(&turn, X);
            (0..3).for_each(|d| u[d] = q[d] + 5.0 - X[d]);
        }
        for (p, old) in next.momentum.chunks_exact_mut(3).zip(state.momentum.chunks_exact(3)) {
            p.copy_from_slice(&image(&turn, old));
        }
        start(&mut system, &mut prediction, &next, 0.3);
        let mut predicted = vec![0.0; k * n];
        prediction.predict(Carry::Repeated, &system.coefficients, 0.3, &mut predicted);
        for (new, old) in predicted.chunks_exact(3).zip(rates.chunks_exact(3)) {
            let expected = image(&turn, old);
            (0..3).for_each(|d| assert!((new[d] - expected[d]).abs() < 1e-13, "k = {k}"));
        }
    }
}

#[test]
fn a_translation_is_predicted_at_any_step_size() {
    let body = body_of(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap());
    let state = spinning(&body, [0.0; 3]);
    for k in 1..=3 {
        let mut system = system(&body, k);
        let n = body.n_dofs();
        let mut prediction = Prediction::new(k, &body);
        start(&mut system, &mut prediction, &state, 0.3);
        let at_speed = |h: f64| state.velocity.iter().cycle().take(k * n).map(move |v| h * v);
        prediction.remember(&system.coefficients, &at_speed(0.3).collect::<Vec<f64>>(), 0.3);
        for carry in [Carry::Continued, Carry::Repeated, Carry::Nothing] {
            let mut predicted = vec![0.0; k * n];
            start(&mut system, &mut prediction, &state, 0.7);
            prediction.predict(carry, &system.coefficients, 0.7, &mut predicted);
            for (x, expected) in predicted.iter().zip(at_speed(0.7)) {
                assert!((x - expected).abs() < 1e-13);
            }
        }
    }
}

/// A body on a line has no inertia about it, one in a plane rotates in that plane alone, and a fixed one not at all.
#[test]
fn lines_planes_and_supports_are_no_special_cases() {
    let plane = body_of(crate::mesh::rectangle([2.0, 1.0], [4, 2]).unwrap());
    let state = spinning(&plane, [0.0, 0.0, 1.3]);
    for k in 1..=3 {
        let mut system = system(&plane, k);
        let mut prediction = Prediction::new(k, &plane);
        start(&mut system, &mut prediction, &state, 0.4);
        let [x, y, angle] = prediction.motions[0].rigid.rotation;
        assert!(x == 0.0 && y == 0.0 && (angle - 1.3 * 0.4).abs() < 0.02);
        assert!(prediction.motions[0].translation.iter().all(|rate| rate[2] == 0.0));
    }

    // A line along (1, 2, 2)/3: a spin across it has the inertia of a rod, a spin along it has none.
    let along = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let velocity = [0.2, -0.1, 0.0];
    let mid_point = system(&plane, 1);
    let mut rod = RigidStep::new(1);
    let tensor = |b: [f64; 3]| [0, 1, 2].map(|i| [0, 1, 2].map(|j| b[i] * along[j]));
    rod.solve(&mid_point.coefficients, &tensor(along), &[tensor(velocity.map(|v| 2.0 * v))], [true; 3]);
    let rate = image(&rod.rates[0], &along);
    // x = w x (y + x/2) with the angle 2 atan(|v|/2) in the plane of y and v.
    let speed = 0.05f64.sqrt();
    let angle = 2.0 * (0.5 * speed).atan();
    for d in 0..3 {
        let expected = (angle.cos() - 1.0) * along[d] + angle.sin() * velocity[d] / speed;
        assert!((rate[d] - expected).abs() < 1e-12, "{rate:?}");
    }
    assert_eq!(rod.rates[0].iter().flatten().filter(|D| !D.is_finite()).count(), 0);

    let clamp = Support { group: "x-min".into(), fix: [true; 3], ..Default::default() };
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.5);
    let held = Body::builder(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap())
        .region(rubber)
        .support(clamp)
        .build()
        .unwrap();
    let mut system = system(&held, 1);
    let mut prediction = Prediction::new(1, &held);
    start(&mut system, &mut prediction, &spinning(&held, [0.7, -1.1, 0.9]), 0.4);
    assert!(
        prediction.motions[0].rigid.rotation == [0.0; 3] && prediction.motions[0].translation == [[0.0; 3]]
    );
}

/// A solution with a superposed rigid motion has resultants and moments; they are removed, also in a loaded body.
#[test]
fn resultants_and_moments_are_balanced_to_rounding() {
    let body = body_of(block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap());
    let state = spinning(&body, [0.7, -1.1, 0.9]);
    for k in 1..=3 {
        let mut system = system(&body, k);
        let n = body.n_dofs();
        let mut prediction = Prediction::new(k, &body);
        start(&mut system, &mut prediction, &state, 0.3);
        let (mut rates, mut residual) = (vec![0.0; k * n], vec![0.0; k * n]);
        prediction.predict(Carry::Repeated, &system.coefficients, 0.3, &mut rates);
        for (x, y) in rates.chunks_exact_mut(3).zip(prediction.arm.chunks_exact(3).cycle()) {
            let turned = image(&skew(&[1e-6, -2e-6, 3e-6]), y);
            (0..3).for_each(|d| x[d] += turned[d] + 1e-6 * (d as f64 - 0.5));
        }
        let size: f64 = state.momentum.iter().map(|p| 0.3 * p.abs()).sum();
        let unbalanced =
            |prediction: &mut Prediction, system: &mut Equations<'_>, rates: &[f64], residual: &mut [f64]| {
                system.unbalanced(rates, residual).unwrap();
                let [_, impulse, moment] = prediction.imbalance(system, rates, residual);
                impulse.max(moment) * 0.3 / size
            };
        assert!(unbalanced(&mut prediction, &mut system, &rates, &mut residual) > 1e-8);
        prediction.balance(&mut system, &mut rates, &mut residual).unwrap();
        let left = unbalanced(&mut prediction, &mut system, &rates, &mut residual);
        assert!(left < 1e-12, "k = {k}: {left:e}");
    }
}
