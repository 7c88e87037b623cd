//! Order of accuracy, conservation, and the number of corrections at any bulk modulus, with a projected volume.

use emmy::body::{Formulation, LoadKind};
use emmy::prelude::*;

use super::mapped;
use crate::shared::schemes::{DGM, assumed_strain, at};

/// Isochoric neo-Hooke material with K = `ratio` mu.
fn rubber(mu: f64, ratio: f64, density: f64) -> Region {
    let rubber = NeoHookeIsochoric::new(mu, ratio * mu, Volumetric::SimoTaylor).unwrap();
    Region::new(rubber, density).with_formulation(Formulation::ProjectedVolume(None))
}

/// Two distorted bricks that share a face.
fn two_bricks(ratio: f64) -> Body {
    let map = |[a, b, c]: [f64; 3]| [2.0 * a + 0.1 * (2.0 * b).sin(), b + 0.15 * a * c, c - 0.1 * a * b];
    let mesh = mapped(CellKind::Hex8, [2, 1, 1], map).build().unwrap();
    Body::builder(mesh).region(rubber(20.0, ratio, 1.0)).build().unwrap()
}

fn spin_and_stretch() -> InitialVelocity {
    InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.4, 0.0, 0.0], [0.0, -0.25, 0.0], [0.0, 0.0, -0.15]],
        ..Default::default()
    }
}

/// Displacement of the spinning and stretching bricks at t = 0.4.
fn displacement(body: &Body, scheme: Scheme, size: f64) -> Vec<f64> {
    let state = State::initial(body, 0.0, &[spin_and_stretch()]).unwrap();
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap();
    motion.march(&StepPlan::new(0.0, vec![Phase { until: 0.4, size }]).unwrap(), &mut []).unwrap();
    motion.state().displacement.clone()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Steps in which the pressure waves of K/mu = 1e3, which no step resolves, stay below the error.
#[test]
fn order_is_twice_the_degree_at_any_bulk_modulus() {
    let bodies = [1e3, 1e5].map(two_bricks);
    let references = [0, 1].map(|i| displacement(&bodies[i], at(DGM, 3), 0.4 / 128.0));
    for (degree, size) in [(1, 0.025), (2, 0.05), (3, 0.1)] {
        for scheme in [assumed_strain(6), DGM] {
            let error =
                |i: usize, h| distance(&displacement(&bodies[i], at(scheme, degree), h), &references[i]);
            let (coarse, fine, softer) = (error(1, size), error(1, size / 2.0), error(0, size));
            let order = (coarse / fine).log2();
            println!(
                "{}: {coarse:.2e}, {fine:.2e}, order {order:.2}; K = 1e3 mu: {softer:.2e}",
                at(scheme, degree)
            );
            assert!((order - 2.0 * f64::from(degree as u32)).abs() < 0.25, "{scheme}, k = {degree}: {order}");
            assert!((softer / coarse - 1.0).abs() < 0.05, "{scheme}, k = {degree}: {softer} {coarse}");
        }
    }
}

/// The L-shaped block of Betsch and Steinmann (2001), Section 5, under half of their load.
fn l_block(ratio: f64) -> Body {
    let traction = [256.0, 512.0, 768.0].map(|t| t / 9.0);
    let hat = TimeFunction::new(vec![(0.0, 0.0), (0.5, 0.5), (1.0, 0.0)]).unwrap();
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| Load {
        kind: LoadKind::Traction { group: group.into(), traction: traction.map(|t| sign * t) },
        time_function: hat.clone(),
    });
    let mesh = mesh::l_block(1.0).unwrap();
    Body::builder(mesh).region(rubber(500.0, ratio, 0.5)).loads(loads).build().unwrap()
}

/// State of the block after the load.
fn launched(body: &Body) -> State {
    let state = State::initial(body, 0.0, &[]).unwrap();
    let mut motion = Motion::starting(body, at(DGM, 1), NewtonSettings::default(), state).unwrap();
    motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.02 }]).unwrap(), &mut []).unwrap();
    motion.state().clone()
}

/// Largest relative changes of energy and angular momentum in free flight, and corrections a step.
fn drift(body: &Body, state: &State, scheme: Scheme, size: f64, steps: usize) -> [f64; 3] {
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), state.clone()).unwrap();
    let first = motion.record().clone();
    let momentum = distance(&first.angular_momentum, &[0.0; 3]);
    let mut found = [0f64; 3];
    for _ in 0..steps {
        let record = motion.step(size).unwrap();
        found[0] = found[0].max((record.total_energy / first.total_energy - 1.0).abs());
        found[1] = found[1].max(distance(&record.angular_momentum, &first.angular_momentum) / momentum);
        found[2] += record.newton_iterations as f64 / steps as f64;
    }
    println!(
        "{scheme}, h = {size}, {steps} steps: drift of H {:.1e}, of L {:.1e}, {:.2} corrections a step",
        found[0], found[1], found[2]
    );
    found
}

/// The inner rule of AS has points enough for its error to be below rounding at these strains.
#[test]
fn free_flight_conserves_at_every_degree() {
    for ratio in [1e3, 1e5] {
        let body = two_bricks(ratio);
        let state = State::initial(&body, 0.0, &[spin_and_stretch()]).unwrap();
        for degree in 1..=4 {
            for scheme in [assumed_strain(10), DGM] {
                let [energy, momentum, _] = drift(&body, &state, at(scheme, degree), 0.05, 100);
                assert!(
                    energy < 1e-12 && momentum < 1e-12,
                    "{ratio} {scheme} {degree}: {energy:e} {momentum:e}"
                );
            }
        }
    }
}

#[test]
fn an_l_block_of_silicone_conserves() {
    let body = l_block(5e4);
    let state = launched(&body);
    for (degree, steps) in [(1, 100), (2, 40)] {
        let [energy, momentum, _] = drift(&body, &state, at(DGM, degree), 0.02 * degree as f64, steps);
        assert!(energy < 1e-12 && momentum < 1e-12, "k = {degree}: {energy:e} {momentum:e}");
    }
}

#[test]
#[ignore = "half a minute; `.ci/run` and `just validate` run it"]
fn an_l_block_conserves_at_every_degree() {
    for ratio in [1e3, 1e5] {
        let body = l_block(ratio);
        let state = launched(&body);
        for degree in 1..=4 {
            for scheme in [assumed_strain(degree + 4), DGM] {
                let (size, steps) = (0.02 * degree as f64, 100 / degree);
                let [energy, momentum, _] = drift(&body, &state, at(scheme, degree), size, steps);
                assert!(
                    energy < 1e-12 && momentum < 1e-12,
                    "{ratio} {scheme} {degree}: {energy:e} {momentum:e}"
                );
            }
        }
    }
}

/// The pressures are unknowns of the iteration: its contraction depends on neither the bulk modulus nor the step.
#[test]
fn corrections_do_not_grow_with_the_bulk_modulus() {
    for (degree, steps) in [(1, 25), (2, 12)] {
        let corrections = |ratio: f64| {
            let body = l_block(ratio);
            let state = State::initial(&body, 0.0, &[]).unwrap();
            let scheme = at(assumed_strain(degree + 4), degree);
            let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), state).unwrap();
            let of_step = |_| motion.step(0.02 * degree as f64).unwrap().newton_iterations;
            (0..steps).map(of_step).sum::<usize>() as f64 / f64::from(steps as u32)
        };
        let soft = corrections(10.0);
        for ratio in [1e3, 1e4, 1e6] {
            let stiff = corrections(ratio);
            println!("k = {degree}: {soft:.2} corrections a step at K = 10 mu, {stiff:.2} at {ratio:e} mu");
            assert!(stiff < 1.3 * soft, "k = {degree}: {stiff} at {ratio}, {soft}");
        }
    }
}

/// Two tumbling cells whose strains of a third are so fast that an error which the approximate tangent contracts hides
/// one which it increases.
fn largest_changes(steps: usize) -> [f64; 2] {
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap())
        .region(rubber(20.0, 1e3, 1.2))
        .build()
        .unwrap();
    let start = InitialVelocity {
        about: [0.5, 1.0, 0.5],
        velocity: [-0.5, 0.8, -0.25],
        angular_velocity: [0.7, 0.4, 1.5],
        gradient: [[0.8, 0.1, 0.0], [0.0, -0.9, 0.2], [0.3, 0.0, 0.2]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[start]).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 3), NewtonSettings::default(), state).unwrap();
    let mut before = motion.record().clone();
    let size = before.angular_momentum.iter().map(|l| l * l).sum::<f64>().sqrt();
    let mut largest = [0f64; 2];
    for _ in 0..steps {
        let record = motion.step(0.08).unwrap();
        let energy = (record.total_energy - before.total_energy).abs() / record.total_energy;
        let momentum = distance(&record.angular_momentum, &before.angular_momentum) / size;
        largest = [largest[0].max(energy), largest[1].max(momentum)];
        before = record.clone();
    }
    println!("largest change of energy {:.1e}, of angular momentum {:.1e}", largest[0], largest[1]);
    largest
}

/// Rounding of a step with K = 1e3 mu is a few times 1e-15; corrections that were taken although the residual grew, or
/// that stopped before it had fallen, changed the angular momentum by 7e-12 in step 300.
#[test]
fn no_step_is_left_with_more_than_rounding() {
    assert!(largest_changes(310).into_iter().all(|change| change < 2e-14));
}

/// Some steps of this flight need the exact tangent after convergence. Left to the approximate one, two of them changed
/// energy and angular momentum by 2e-8 and 9e-8.
#[test]
#[ignore = "ten seconds; `.ci/run` and `just validate` run it"]
fn no_step_of_a_long_flight_is_left_with_more_than_rounding() {
    assert!(largest_changes(4068).into_iter().all(|change| change < 2e-14));
}
