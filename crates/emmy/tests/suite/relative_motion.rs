//! Accelerations, and motions relative to a part of the body.

#![allow(non_snake_case)]

use emmy::motion::ReferenceMotion;
use emmy::prelude::*;

const GRAVITY: [f64; 3] = [1.0, 2.0, -9.0];

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0)
}

fn nearly_equal(found: &[f64], expected: impl Iterator<Item = f64>, within: f64) {
    for (dof, (own, exact)) in found.iter().zip(expected).enumerate() {
        assert!((own - exact).abs() < within, "dof {dof}: {own} is not {exact}");
    }
}

/// A body that falls has the acceleration of gravity, in every scheme.
#[test]
fn every_scheme_has_the_acceleration_of_a_fall() {
    let block = || Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap()).region(rubber());
    let body = block().load(Load::acceleration(GRAVITY)).build().unwrap();
    for (scheme, degree) in [
        ("DGM", 1),
        ("DGM", 3),
        ("AS(2)", 2),
        ("FE(2)", 2),
        ("Newmark(0.25, 0.5)", 1),
        ("HHT(0.05)", 1),
        ("Bathe", 1),
        ("central-differences", 1),
    ] {
        let own = Scheme::from_name(scheme).and_then(|own| own.with_degree(degree));
        let own = own.unwrap_or_else(|error| panic!("{scheme}: {error}"));
        let mut motion = Motion::new(&body, own).unwrap();
        assert!(motion.mean_acceleration(None).is_empty());
        for _ in 0..3 {
            motion.step(0.01).unwrap();
            let n = body.mesh().n_dofs();
            nearly_equal(&motion.mean_acceleration(None)[..n], GRAVITY.into_iter().cycle(), 1e-8);
        }
        // All fall alike.
        let reference = ReferenceMotion::of_group(&body, "x-min").unwrap();
        let [displacement, velocity] = motion.seen_from(Some(&reference));
        let relative = [&displacement[..], &velocity, &motion.mean_acceleration(Some(&reference))].concat();
        nearly_equal(&relative, std::iter::repeat(0.0), 1e-8);
    }
}

/// Relative to the base, which moves by a t^2/2, the base is at rest, and displacements differ by its path.
#[test]
fn relative_to_the_base_its_motion_is_taken_off() {
    let path = TimeFunction::smooth("2 t^2", |t| [2.0 * t * t, 4.0 * t, 4.0]);
    let shaken = Support::driven("x-min", [Some(path), None, None]);
    let body = Body::builder(mesh::block([2.0, 1.0, 1.0], [4, 1, 1]).unwrap()).region(rubber());
    let body = body.support(shaken).build().unwrap();
    let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2).unwrap()).unwrap();
    let base = ReferenceMotion::of_base(&body).unwrap();
    motion = motion.relative_to(Some(base.clone()));
    let nodes = body.mesh().group_nodes("x-min").unwrap();
    let mut largest = 0.0f64;
    for step in 1..=20 {
        motion.step(0.01).unwrap();
        let time = 0.01 * f64::from(step);
        let path = |dof: usize, along: f64| if dof.is_multiple_of(3) { along } else { 0.0 };
        let [relative, rates] = motion.seen_from(Some(&base));
        let state = motion.state();
        let expected = |all: &[f64], along: f64| -> Vec<f64> {
            all.iter().enumerate().map(|(dof, own)| own - path(dof, along)).collect()
        };
        nearly_equal(&relative, expected(&state.displacement, 2.0 * time * time).into_iter(), 1e-13);
        nearly_equal(&rates, expected(&state.velocity, 4.0 * time).into_iter(), 1e-12);
        let [absolute, seen] = [None, Some(&base)].map(|own| motion.mean_acceleration(own));
        nearly_equal(&seen, expected(&absolute, 4.0).into_iter(), 1e-9);
        assert!(nodes.iter().all(|node| (absolute[3 * *node as usize] - 4.0).abs() < 1e-10));
        largest = relative.as_chunks::<3>().0.iter().map(|u| norm(*u)).fold(largest, f64::max);
    }
    let told = motion.statistics().largest_relative_displacement.unwrap();
    // Twice the static rho a L^2/(2 E), with E = mu (3 lambda + 2 mu)/(lambda + mu).
    let most = 2.0 * 2.0 * 4.0 * 2.0 * 2.0 / (2.0 * 4000.0 / 3.0);
    let is_near = (told.value / most - 1.0).abs() < 0.1;
    assert!((told.value - largest).abs() < 1e-14 && is_near, "{told:?} {largest} {most}");
    // A resumed motion counts on.
    let resumed = Motion::resumed(&body, motion.scheme(), motion.settings(), motion.snapshot()).unwrap();
    let resumed = resumed.relative_to(Some(base));
    assert_eq!(resumed.statistics(), motion.statistics());
}

/// A support that is at rest is no base.
#[test]
fn a_body_without_driven_supports_has_no_base() {
    let body = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber());
    let body = body.support(Support::fixed("x-min")).build().unwrap();
    assert_eq!(
        ReferenceMotion::of_base(&body).unwrap_err().to_string(),
        "no support moves, so there is no base: name a group"
    );
    assert!(ReferenceMotion::of_group(&body, "nothing").is_err());
}

/// Relative to the rigid motion, a body that turns and vibrates has its vibration alone, and relative velocities are
/// the rates of relative displacements.
#[test]
fn the_fitted_rigid_motion_leaves_the_vibration() {
    let body = Body::builder(mesh::block([2.0, 1.0, 0.5], [3, 2, 1]).unwrap()).region(rubber());
    let body = body.build().unwrap();
    let points = body.mesh().points();
    // R(t) (X + w(X, t)) + c(t), with R about the axis (1, 2, 2)/3.
    let moved = |t: f64, wave: f64| -> Vec<f64> {
        let (axis, angle) = ([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], 2.5 * t + 0.3 * t * t);
        let (sin, cos) = angle.sin_cos();
        let place = |X: &[f64; 3]| {
            let w = (2.0 * t).sin() * wave;
            let Y = [X[0] + w * X[1] * X[2], X[1] + w * X[0] * X[0], X[2] - w * X[0] * X[1]];
            let along: f64 = (0..3).map(|d| axis[d] * Y[d]).sum();
            let across = [
                axis[1] * Y[2] - axis[2] * Y[1],
                axis[2] * Y[0] - axis[0] * Y[2],
                axis[0] * Y[1] - axis[1] * Y[0],
            ];
            let shift = [3.0 * t, -t * t, 0.5];
            [0, 1, 2].map(|d| cos * Y[d] + sin * across[d] + (1.0 - cos) * along * axis[d] + shift[d] - X[d])
        };
        points.iter().flat_map(place).collect()
    };
    let rates = |at: &dyn Fn(f64) -> Vec<f64>, t: f64| -> Vec<f64> {
        let (before, after) = (at(t - 1e-5), at(t + 1e-5));
        before.iter().zip(after).map(|(before, after)| (after - before) / 2e-5).collect()
    };
    let reference = ReferenceMotion::of_body();
    for t in [0.0, 0.4, 1.3] {
        let rigid = |t: f64| moved(t, 0.0);
        let [relative, velocity] = reference.seen(&body, &rigid(t), &rates(&rigid, t));
        nearly_equal(&relative, std::iter::repeat(0.0), 1e-14);
        nearly_equal(&velocity, std::iter::repeat(0.0), 1e-8);
        let bent = |t: f64| moved(t, 0.2);
        let seen = |t: f64| {
            let [relative, _] = reference.seen(&body, &bent(t), &vec![0.0; body.n_dofs()]);
            relative
        };
        let [_, velocity] = reference.seen(&body, &bent(t), &rates(&bent, t));
        nearly_equal(&velocity, rates(&seen, t).into_iter(), 1e-8);
        // It has neither momentum nor moment of momentum about the places at rest.
        let masses = body.lumped_mass();
        let momentum = |d: usize| (0..points.len()).map(|A| masses[A] * velocity[3 * A + d]).sum::<f64>();
        assert!((0..3).all(|d| momentum(d).abs() < 1e-8));
    }
}

fn norm(u: [f64; 3]) -> f64 {
    u.iter().map(|x| x * x).sum::<f64>().sqrt()
}
