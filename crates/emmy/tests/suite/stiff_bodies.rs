//! Stiff bodies in tiny vibration and in rigid rotation keep their balances as well as soft ones.

#![allow(non_snake_case)]

use emmy::Error;
use emmy::body::{Body, InitialVelocity, Region, Support};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::{MarchError, Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::Scheme;

use crate::shared::schemes::{DGM, assumed_strain, at, fe};

/// Worst residuals of a run: energy relative to T + V, angular momentum relative to the scale `sum |q x p|`.
#[derive(Debug)]
struct Worst {
    energy: f64,
    momentum: f64,
    iterations: usize,
}

fn run(body: &Body, scheme: Scheme, degree: usize, field: InitialVelocity, size: f64, steps: usize) -> Worst {
    let state = State::initial(body, 0.0, &[field]).unwrap();
    let mut motion = Motion::starting(body, at(scheme, degree), NewtonSettings::default(), state).unwrap();
    let mut worst = Worst { energy: 0.0, momentum: 0.0, iterations: 0 };
    let mut largest_strain_energy = 0f64;
    for _ in 1..=steps {
        let record = motion.step(size).unwrap().clone();
        let state = motion.state();
        // Angular momentum is judged by the size of the moments in its sum.
        let nodes = body.mesh().points().iter().zip(state.momentum.chunks_exact(3));
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let moments: f64 = nodes.map(|(X, p)| norm(X) * norm(p)).sum();
        worst.energy = worst.energy.max(record.energy_residual.abs() / record.total_energy);
        worst.momentum = worst.momentum.max(record.angular_momentum_residual / moments);
        worst.iterations = worst.iterations.max(record.newton_iterations);
        largest_strain_energy = largest_strain_energy.max(record.strain_energy / record.total_energy);
    }
    assert!(largest_strain_energy > 1e-12, "the body must strain: {largest_strain_energy:e}");
    worst
}

fn assert_kept(what: &str, worst: Worst) {
    println!("{what}: {worst:?}");
    assert!(worst.energy < 1e-9 && worst.momentum < 1e-9, "{what}: {worst:?}");
}

fn vibration(size: f64) -> InitialVelocity {
    InitialVelocity {
        gradient: [[size, 0.3 * size, 0.0], [0.0, -0.5 * size, 0.0], [0.2 * size, 0.0, 0.1 * size]],
        ..Default::default()
    }
}

fn svk(youngs_modulus: f64, density: f64) -> Region {
    Region::new(SaintVenantKirchhoff::from_engineering(youngs_modulus, 0.3).unwrap(), density)
}

fn rubber(youngs_modulus: f64, density: f64) -> Region {
    Region::new(NeoHooke::from_engineering(youngs_modulus, 0.3).unwrap(), density)
}

/// AS(8) rather than AS(4): at degree 3 four inner points leave a relative error of the order of the strain.
const SCHEMES: [Scheme; 2] = [DGM, assumed_strain(8)];

/// Strains of about 1e-8 in a stiff body, in a soft one, and in steel with millimetres, tonnes and seconds.
#[test]
fn tiny_vibration() {
    for (name, region) in [
        ("soft", rubber(1e3, 1.0)),
        ("stiff", svk(1e7, 1.0)),
        ("stiff neo-Hooke", rubber(1e7, 1.0)),
        ("steel", rubber(2.1e5, 7.85e-9)),
    ] {
        let wave_speed = match name {
            "soft" => 30.0,
            "steel" => 5e6,
            _ => 3e3,
        };
        let body = Body::builder(emmy::mesh::block([2.0, 6.0, 2.0], [2, 6, 2]).unwrap())
            .region(region)
            .build()
            .unwrap();
        for scheme in SCHEMES {
            for degree in 1..=3 {
                // Velocities of 1e-8 of the wave speed; steps of some and of many wave transits of a cell.
                for transits in [1.0, 50.0] {
                    let worst =
                        run(&body, scheme, degree, vibration(1e-8 * wave_speed), transits / wave_speed, 20);
                    assert_kept(&format!("{name} {scheme} k = {degree}, {transits} transits"), worst);
                }
            }
        }
    }
}

/// A clamped bar vibrates with strains of 1e-8.
#[test]
fn tiny_vibration_of_a_clamped_bar() {
    let supports = [Support { group: "y-min".into(), fix: [true; 3], ..Default::default() }];
    let mesh = emmy::mesh::block([2.0, 6.0, 2.0], [2, 6, 2]).unwrap();
    let body = Body::builder(mesh).region(rubber(1e7, 1.0)).supports(&supports).build().unwrap();
    for degree in 1..=3 {
        assert_kept("clamped", run(&body, DGM, degree, vibration(3e-5), 1e-3, 20));
    }
}

/// Free rotation of stiff bodies: strains of 1e-4 and less on top of a rotation by a quarter of a radian a step.
#[test]
fn rigid_rotation() {
    let spin = |rate: f64| InitialVelocity {
        angular_velocity: [0.3 * rate, 0.5 * rate, 0.8 * rate],
        about: [1.0, 3.0, 1.0],
        velocity: [rate, 0.0, -rate],
        ..Default::default()
    };
    for (name, region, rate) in [("stiff", svk(1e7, 1.0), 5.0), ("steel", rubber(2.1e5, 7.85e-9), 500.0)] {
        let body = Body::builder(emmy::mesh::block([2.0, 6.0, 2.0], [2, 6, 2]).unwrap())
            .region(region)
            .build()
            .unwrap();
        for scheme in SCHEMES {
            for degree in 1..=2 {
                let worst = run(&body, scheme, degree, spin(rate), 0.25 / rate, 40);
                assert_kept(&format!("{name} {scheme} k = {degree}"), worst);
            }
        }
    }
}

/// Rotation of a quasi-rigid body by half a radian per step. Newton's iteration must start at the right rotation: a
/// rotation error of angle d leaves the strain d^2/2 after a linear correction, and the iteration fails if `E d^2/2`
/// exceeds the inertia `density (length/h)^2`. From the rigid motion of the step it starts within quadratic
/// convergence: four iterations with the exact tangent and the last correction, and one in reserve.
#[test]
fn a_rigid_rotation_takes_few_iterations() {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(svk(1e7, 1.0)).build().unwrap();
    let spin = InitialVelocity {
        angular_velocity: [0.6, 1.0, 1.6],
        about: [3.0, 3.0, 1.5],
        velocity: [1.0, 0.0, -1.0],
        ..Default::default()
    };
    for scheme in SCHEMES {
        let state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let settings = NewtonSettings { exact_tangent: true, ..Default::default() };
        let mut motion = Motion::starting(&body, at(scheme, 1), settings, state).unwrap();
        let mut step = |_: usize| motion.step(0.2).map(|record| record.newton_iterations).unwrap();
        let first = step(1);
        let most = (2..=20).map(&mut step).inspect(|n| print!(" {n}")).max().unwrap();
        println!("{scheme}: first step {first}, at most {most} afterwards");
        assert!(most <= 6, "{scheme}: {most} iterations");
    }
}

/// In a quasi-rigid body that rotates by a fifth of a radian per step, the approximate tangent is accurate for modes
/// with strain; with the tangent of the mid-point rule, which sees mid-step shrinkage as strain, a first correction
/// leaves 0.3.
#[test]
fn the_kept_stiffness_of_a_turning_body_is_right() {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(svk(1e7, 0.5)).build().unwrap();
    let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
    for scheme in [assumed_strain(1), assumed_strain(5), DGM] {
        let mut state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let mut stepper = scheme.stepper(&body, NewtonSettings::default(), &mut state).unwrap();
        for step in 1..=20 {
            stepper.advance(&mut state, 0.2).unwrap();
            // The first step starts far away, with the velocity of the start along a chord.
            let [start, corrected, ..] = *stepper.newton_history() else { panic!("{scheme}: no correction") };
            assert!(
                step == 1 || corrected < 1e-2 * start,
                "{scheme}, step {step}: {corrected:e} of {start:e}"
            );
        }
    }
}

/// A tumbling steel part in mm, t, s with steps of a second: the stiffness is 1e13 times the inertia and more, and both
/// sizes of the part keep the reported number of digits.
#[test]
fn a_steel_part_tumbles_in_steps_of_a_second() {
    for scale in [1.0, 0.1] {
        let mesh = emmy::mesh::block([1.0, 10.0, 2.0], [2, 20, 4]).unwrap().scaled(scale).unwrap();
        let body = Body::builder(mesh).region(svk(210_000.0, 7.85e-9)).build().unwrap();
        let spin = InitialVelocity {
            angular_velocity: [0.02, 0.05, 0.2],
            about: [0.5 * scale, 5.0 * scale, scale],
            ..Default::default()
        };
        let state = State::initial(&body, 0.0, &[spin]).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, 1), NewtonSettings::default(), state).unwrap();
        let start = motion.record().clone();
        for _ in 1..=100 {
            motion.step(1.0).unwrap();
        }
        let end = motion.record();
        let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let energy = (end.total_energy / start.total_energy - 1.0).abs();
        let change = [0, 1, 2].map(|d| end.angular_momentum[d] - start.angular_momentum[d]);
        let momentum = norm(change) / norm(start.angular_momentum);
        println!("scale {scale}: H {energy:.1e}, L {momentum:.1e}, rounding {:.1e}", end.rounding);
        assert!(end.rounding > 0.0 && end.rounding < 1e-6, "six digits: {:e}", end.rounding);
        assert!(energy < end.rounding.max(1e-13) && momentum < end.rounding.max(1e-13));
    }
}

/// A stiffness number of 1e15 leaves six digits, at any degree.
#[test]
fn a_block_beyond_all_stiffness_keeps_six_digits() {
    let mesh = emmy::mesh::block([1.0; 3], [3; 3]).unwrap();
    let body = Body::builder(mesh).region(rubber(1e16, 1.0)).build().unwrap();
    for (scheme, degree) in [(DGM, 1), (assumed_strain(5), 1), (DGM, 2)] {
        let spin =
            InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], about: [0.5; 3], ..Default::default() };
        let state = State::initial(&body, 0.0, &[spin]).unwrap();
        let mut motion =
            Motion::starting(&body, at(scheme, degree), NewtonSettings::default(), state).unwrap();
        let start = motion.record().clone();
        for _ in 1..=50 {
            motion.step(0.05).unwrap();
        }
        let end = motion.record();
        let energy = (end.total_energy / start.total_energy - 1.0).abs();
        assert!(
            energy < end.rounding.max(1e-12) && end.rounding < 1e-6,
            "{scheme}: {energy:e} {:e}",
            end.rounding
        );
    }
}

/// Schemes whose internal forces have a moment lose their digits to rounding, and report an error instead of
/// continuing.
#[test]
fn a_step_without_digits_fails() {
    let mesh = emmy::mesh::block([1.0; 3], [3; 3]).unwrap();
    let body = Body::builder(mesh).region(rubber(1e19, 1.0)).build().unwrap();
    let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], about: [0.5; 3], ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let mut motion = Motion::starting(&body, at(fe(1), 1), NewtonSettings::default(), state).unwrap();
    let plan = StepPlan::new(0.0, vec![Phase { until: 5.0, size: 0.05 }]).unwrap();
    let ended = motion.march(&plan, &mut []);
    assert!(matches!(ended, Err(MarchError::Step(Error::NoDigits { .. }))), "{ended:?}");
}
