//! Schemes from outside: a stepper in a motion, forces and matrices of a body, the stage equations at any
//! rates.

use emmy::Error;
use emmy::body::{
    BlockRow, Body, Formulation, GroundSpring, InitialVelocity, Joint, JointEnd, JointKind, Load, PointTerms,
    Reaction, Region, Support, TimeFunction, Viscosity,
};
use emmy::material::NeoHooke;
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::{BodyFeature, PointForces, Scheme, StepOutcome, Stepper, TimeElement};

use crate::shared::schemes::{DGM, assumed_strain, at, fe};

/// Verlet's method as a user would write it, which central differences are, too.
#[derive(Debug)]
struct Verlet<'a> {
    forces: PointForces<'a>,
    /// Mass of each node.
    mass: Vec<f64>,
    mean: Vec<f64>,
}

impl<'a> Verlet<'a> {
    fn new(body: &'a Body) -> Self {
        let mass = body.lumped_mass().to_vec();
        Verlet { forces: PointForces::new(body).unwrap(), mass, mean: vec![0.0; body.n_dofs()] }
    }

    /// A body whose mass is scaled, so that it takes larger steps.
    fn scaled(body: &'a Body, factor: f64) -> Self {
        let own = Verlet::new(body);
        Verlet { mass: own.mass.iter().map(|mass| factor * mass).collect(), ..own }
    }

    fn kick(&mut self, state: &mut State, time: f64, duration: f64) -> emmy::Result<()> {
        let body = self.forces.body();
        let net = self.forces.evaluate(&state.displacement, time)?;
        for dof in (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]) {
            let before = state.velocity[dof];
            state.momentum[dof] += duration * net[dof];
            state.velocity[dof] = state.momentum[dof] / self.mass[dof / 3];
            self.mean[dof] = 0.5 * (before + state.velocity[dof]);
        }
        self.forces.book(duration, &self.mean, None)
    }
}

impl Stepper for Verlet<'_> {
    fn start(&mut self, state: &mut State) -> emmy::Result<()> {
        let momenta = state.momentum.iter_mut().zip(&state.velocity).enumerate();
        momenta.for_each(|(dof, (p, v))| *p = self.mass[dof / 3] * v);
        Ok(())
    }

    fn advance(&mut self, state: &mut State, h: f64) -> emmy::Result<StepOutcome> {
        self.forces.begin();
        self.kick(state, state.time, 0.5 * h)?;
        state.displacement.iter_mut().zip(&state.velocity).for_each(|(u, v)| *u += h * v);
        self.kick(state, state.time + h, 0.5 * h)?;
        StepOutcome::new(self.forces.body(), state, self.forces.end(h))
    }

    fn reactions(&self) -> &[Reaction] {
        self.forces.reactions()
    }
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
}

fn block() -> emmy::body::BodyBuilder {
    Body::builder(emmy::mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap())
}

fn ramp() -> TimeFunction {
    TimeFunction::new(vec![(0.0, 0.5), (1.0, 2.5)]).unwrap()
}

/// A held and sprung body under a dead and a following load.
fn loaded() -> Body {
    let spring = GroundSpring { group: "x-max".into(), stiffness: 30.0 };
    block()
        .region(rubber())
        .support(Support::of_components("y-min", [true, true, false]))
        .load(Load::traction("y-max", [5.0, -3.0, 20.0]).with_time_function(ramp()))
        .load(Load::pressure("z-max", 40.0).with_time_function(ramp()))
        .point_terms(PointTerms { springs: vec![spring], ..PointTerms::default() })
        .build()
        .unwrap()
}

fn stretch() -> InitialVelocity {
    let gradient = [[0.5, 0.2, 0.0], [0.0, -0.3, 0.1], [0.0, 0.4, 0.2]];
    InitialVelocity { gradient, ..InitialVelocity::default() }
}

fn moving(body: &Body) -> State {
    State::initial(body, 0.0, &[stretch()]).unwrap()
}

#[test]
fn a_stepper_from_outside_does_what_that_of_the_library_does() {
    let body = loaded();
    let plan = || StepPlan::new(0.0, vec![Phase { until: 0.2, size: 0.002 }]).unwrap();
    let mut own = Motion::with_stepper(&body, Verlet::new(&body)).unwrap().from(moving(&body)).unwrap();
    let mut library = Motion::new(&body, Scheme::CentralDifferences).unwrap().from(moving(&body)).unwrap();
    assert_eq!(own.scheme().to_string(), "own scheme");
    let (mut peak, mut error) = ([0.0_f64; 2], [0.0_f64; 3]);
    for _ in 0..100 {
        let same: Record = library.next_step(&plan(), &mut []).unwrap().unwrap().clone();
        let record = own.next_step(&plan(), &mut []).unwrap().unwrap();
        let close = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-11 * size, "{a} {b}");
        close(record.strain_energy, same.strain_energy, 10.0);
        close(record.kinetic_energy, same.kinetic_energy, 10.0);
        (0..3).for_each(|d| close(record.angular_momentum[d], same.angular_momentum[d], 1.0));
        // Both balances of momentum are closed, with reactions, springs and loads.
        peak[0] = peak[0].max(record.linear_momentum_residual);
        peak[1] = peak[1].max(record.angular_momentum_residual);
        error[0] += record.energy_residual;
        error[1] += same.energy_residual;
        error[2] = error[2].max(record.strain_energy);
        for (a, b) in own.reactions().iter().zip(library.reactions()) {
            (0..3).for_each(|d| close(a.force[d], b.force[d], 100.0));
            (0..3).for_each(|d| close(a.moment[d], b.moment[d], 100.0));
        }
    }
    assert_eq!(own.reactions().len(), 2);
    assert!(peak[0] < 1e-12 && peak[1] < 1e-12, "{peak:?}");
    // The work of the loads is booked with the error of the scheme.
    assert!(error[0].abs() < 1e-3 * error[2] && error[1].abs() < 1e-3 * error[2], "{error:?}");
    assert!(own.record().external_work.abs() > 0.1 && error[2] > 0.5, "{error:?}");
}

#[test]
fn a_motion_by_an_own_stepper_is_resumed_bit_for_bit() {
    let body = loaded();
    let mut motion = Motion::with_stepper(&body, Verlet::new(&body)).unwrap();
    for mass in [1.0, 4.0] {
        let verlet = || Verlet::scaled(&body, mass);
        motion = Motion::with_stepper(&body, verlet()).unwrap().from(moving(&body)).unwrap();
        (0..5).for_each(|_| _ = motion.step(0.002).unwrap());
        let mut resumed = Motion::resumed_with_stepper(&body, verlet(), motion.snapshot()).unwrap();
        assert_eq!(resumed.step(0.002).unwrap(), motion.step(0.002).unwrap());
        assert_eq!(resumed.state(), motion.state());
    }
    // A scheme by its name has no stepper from outside.
    let error = Motion::resumed(&body, motion.scheme(), NewtonSettings::default(), motion.snapshot());
    assert!(error.unwrap_err().to_string().contains("with_stepper"));
}

#[test]
fn a_step_that_inverts_a_cell_is_cut() {
    let body = loaded();
    let mut motion = Motion::with_stepper(&body, Verlet::new(&body)).unwrap().from(moving(&body)).unwrap();
    let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 2.0 }]).unwrap();
    motion.allow_cuts(None);
    // The first step that holds is 1/2^n of the planned one, and the state before it is untouched by the others.
    let record = motion.next_step(&plan, &mut []).unwrap().unwrap().clone();
    assert!(record.cuts > 0);
    let mut same = Motion::with_stepper(&body, Verlet::new(&body)).unwrap().from(moving(&body)).unwrap();
    assert_eq!(same.step(2.0 / 2f64.powi(record.cuts as i32)).unwrap().total_energy, record.total_energy);
}

/// A stepper that claims more than it does.
#[derive(Debug)]
struct Claims<'a>(Verlet<'a>, Option<BodyFeature>);

impl Stepper for Claims<'_> {
    fn advance(&mut self, state: &mut State, h: f64) -> emmy::Result<StepOutcome> {
        self.0.advance(state, h)
    }

    fn integrates(&self, feature: BodyFeature) -> bool {
        self.1 == Some(feature)
    }
}

#[test]
fn what_a_stepper_does_not_integrate_is_refused() {
    let driven = || Support::driven("y-min", [Some(ramp_from_zero()), None, None]);
    let refused: [(Body, BodyFeature, &str); 3] = [
        (
            block().region(rubber()).support(driven()).build().unwrap(),
            BodyFeature::PrescribedMotion,
            "supports with a given motion",
        ),
        (block().region(rubber()).drag(0.1).build().unwrap(), BodyFeature::Damping, "viscosity or drag"),
        (
            block().region(rubber().with_formulation(Formulation::IncompatibleModes)).build().unwrap(),
            BodyFeature::IncompatibleModes,
            "cells with incompatible modes",
        ),
    ];
    for (body, feature, words) in refused {
        let motion = |claim| Motion::with_stepper(&body, Claims(Verlet::new(&body), claim));
        let message = motion(None).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("Stepper::integrates"), "{message}");
        assert!(motion(Some(feature)).is_ok());
    }
    // No stepper from outside has multipliers, whatever it claims.
    let between = [JointEnd::Node(0), JointEnd::Ground];
    let link = Joint::new("link", JointKind::Spherical, between, [0.0; 3]);
    let linked = block().region(rubber()).joint(link).build().unwrap();
    let claims = Claims(Verlet::new(&linked), Some(BodyFeature::Joints));
    let error = Motion::with_stepper(&linked, claims).unwrap_err().to_string();
    assert!(error.contains("joints and rigid bodies need a time element"), "{error}");
    let held = block().region(rubber()).support(Support::fixed("y-min").until(1.0)).build().unwrap();
    let error = Motion::with_stepper(&held, Verlet::new(&held)).unwrap_err().to_string();
    assert!(error.contains("released"), "{error}");

    let body = loaded();
    let mut motion = Motion::with_stepper(&body, Verlet::new(&body)).unwrap();
    let error = motion.residual(&vec![0.0; body.n_dofs()], 0.1).unwrap_err().to_string();
    assert!(error.contains("own scheme") && error.contains("time element"), "{error}");
    let error = motion.newton(NewtonSettings::default()).unwrap_err().to_string();
    assert!(error.contains("stepper from outside"), "{error}");
}

fn ramp_from_zero() -> TimeFunction {
    TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -1.0)]).unwrap()
}

/// Product of rows of blocks with a vector.
fn product(rows: &[BlockRow], x: &[f64]) -> Vec<f64> {
    let entry = |(row, i): (&BlockRow, usize)| {
        let blocks = row
            .iter()
            .flat_map(|(node, block)| (0..3).map(move |j| (3 * *node as usize + j, block[3 * i + j])));
        blocks.map(|(at, value)| value * x[at]).sum::<f64>()
    };
    rows.iter().flat_map(|row| [0, 1, 2].map(|i| entry((row, i)))).collect()
}

/// Numbers between -1 and 1, the same in every run.
fn numbers(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| ((i as f64 + seed) * 0.754_877_666).fract() * 2.0 - 1.0).collect()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

fn assert_near(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    assert_eq!(a.len(), b.len());
    let size = largest(b);
    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= tolerance * size && size > 0.0, "{what}: {worst:e} of {size:e}");
}

#[test]
fn tangents_are_derivatives_of_residuals() {
    let viscous = || rubber().with_viscosity(Viscosity { time: 0.02, shear: 3.0, bulk: 5.0 });
    let pressed = |builder: emmy::body::BodyBuilder| builder.load(Load::pressure("z-max", 40.0));
    let held = |builder: emmy::body::BodyBuilder| pressed(builder).support(Support::fixed("y-min"));
    let bodies = [
        ("free", pressed(block().region(rubber())).build().unwrap()),
        ("damped", held(block().region(viscous()).drag(2.0)).build().unwrap()),
        (
            "projected",
            held(block().region(viscous().with_formulation(Formulation::ProjectedVolume(None))))
                .build()
                .unwrap(),
        ),
        (
            "modes",
            held(block().region(rubber().with_formulation(Formulation::IncompatibleModes))).build().unwrap(),
        ),
        ("sprung", loaded()),
    ];
    for (name, body) in bodies {
        for scheme in [at(DGM, 1), at(DGM, 2), at(fe(1), 1), at(fe(2), 2), at(assumed_strain(4), 3)] {
            let mut motion = Motion::new(&body, scheme).unwrap().from(moving(&body)).unwrap();
            let (n, h) = (scheme.degree() * body.n_dofs(), 0.05);
            let rates: Vec<f64> = numbers(n, 0.3).iter().map(|x| 0.03 * x).collect();
            let direction = numbers(n, 7.7);
            let mut at = |step: f64| {
                let moved: Vec<f64> = rates.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
                motion.residual(&moved, h).unwrap()
            };
            let d = 1e-5;
            let ends = [at(d), at(-d)];
            let difference: Vec<f64> =
                ends[0].iter().zip(&ends[1]).map(|(plus, minus)| (plus - minus) / (2.0 * d)).collect();
            let exact = product(&motion.tangent(&rates, h).unwrap(), &direction);
            // The difference has an error of d^2 over the size of a cell, and rounding over d.
            assert_near(&exact, &difference, 1e-7, &format!("{name}, {scheme}"));
        }
    }
}

#[test]
fn the_residual_of_collocation_is_that_of_its_forces() {
    let body = loaded();
    let n = body.n_dofs();
    let (h, root) = (0.05, 3f64.sqrt());
    // Gauss' methods of one and two stages: a (Butcher 1964) and its inverse.
    let a: [Vec<f64>; 2] = [vec![0.5], vec![0.25, 0.25 - root / 6.0, 0.25 + root / 6.0, 0.25]];
    let inverse: [Vec<f64>; 2] = [vec![2.0], vec![3.0, 2.0 * root - 3.0, -2.0 * root - 3.0, 3.0]];
    let nodes: [Vec<f64>; 2] = [vec![0.5], vec![0.5 - root / 6.0, 0.5 + root / 6.0]];
    for k in 1..=2 {
        let state = moving(&body);
        let mut motion = Motion::new(&body, at(fe(k), k)).unwrap().from(state.clone()).unwrap();
        let rates: Vec<f64> = numbers(k * n, 0.1).iter().map(|x| 0.02 * x).collect();
        let residual = motion.residual(&rates, h).unwrap();
        for i in 0..k {
            let mut inertia = vec![0.0; n];
            let mut displacement = state.displacement.clone();
            for j in 0..k {
                let mut mass_rates = vec![0.0; n];
                body.mass_product(&rates[j * n..(j + 1) * n], &mut mass_rates);
                for dof in 0..n {
                    let momentum = h * state.momentum[dof];
                    inertia[dof] += inverse[k - 1][i * k + j] * (mass_rates[dof] - momentum);
                    displacement[dof] += a[k - 1][i * k + j] * rates[j * n + dof];
                }
            }
            let internal = body.internal_force(&displacement).unwrap();
            let loads = body.external_force(nodes[k - 1][i] * h, &displacement).unwrap();
            let expected: Vec<f64> =
                (0..n).map(|dof| inertia[dof] + h * h * (internal[dof] - loads[dof])).collect();
            assert_near(&residual[i * n..(i + 1) * n], &expected, 1e-12, &format!("k = {k}, stage {i}"));
        }
    }
}

#[test]
fn the_residual_vanishes_at_the_rates_of_a_step_and_disturbs_no_motion() {
    let body = loaded();
    let start = || Motion::new(&body, at(DGM, 2)).unwrap().from(moving(&body)).unwrap();
    let (mut motion, mut other) = (start(), start());
    for _ in 0..3 {
        let small: Vec<f64> = numbers(2 * body.n_dofs(), 0.9).iter().map(|x| 0.02 * x).collect();
        assert!(largest(&other.residual(&small, 0.01).unwrap()) > 1e-3);
        other.tangent(&vec![0.0; 2 * body.n_dofs()], 0.03).unwrap();
        motion.step(0.05).unwrap();
        let rates = motion.stepper().rates().to_vec();
        let before = other.residual(&rates, 0.05).unwrap();
        let free = |(dof, r): (usize, &f64)| if body.fixed()[dof % body.n_dofs()] { 0.0 } else { *r };
        let free: Vec<f64> = before.iter().enumerate().map(free).collect();
        assert!(largest(&free) <= motion.record().newton_target, "{:e}", largest(&free));
        // At held degrees of freedom it is h^2 times the reaction: the sum of the weights 1/2 is the mean.
        let n = body.n_dofs();
        let held: f64 = (0..n)
            .filter(|&dof| body.fixed()[dof] && dof % 3 == 1)
            .map(|dof| 0.5 * (before[dof] + before[n + dof]) / 0.05_f64.powi(2))
            .sum();
        assert!((held - motion.reactions()[0].force[1]).abs() < 1e-9 * held.abs(), "{held}");
        other.step(0.05).unwrap();
        assert_eq!(motion.state(), other.state());
    }
}

#[test]
fn the_residual_of_a_dissipative_element_has_its_projection() {
    let body = loaded();
    let element = TimeElement::discrete_gradient(1).unwrap().dissipating(0.5).unwrap();
    let start = || Motion::new(&body, element).unwrap().from(moving(&body)).unwrap();
    let (mut motion, mut other) = (start(), start());
    motion.step(0.05).unwrap();
    let residual = other.residual(motion.stepper().rates(), 0.05).unwrap();
    let free = residual.iter().zip(body.fixed()).map(|(r, fixed)| if *fixed { 0.0 } else { r.abs() });
    assert!(free.fold(0.0, f64::max) <= motion.record().newton_target);
    let error = other.tangent(motion.stepper().rates(), 0.05).unwrap_err().to_string();
    assert!(error.contains("not sparse"), "{error}");
}

#[test]
fn damping_is_the_stiffness_times_the_viscous_time_and_drag_times_the_mass() {
    let tau = 0.02;
    let viscous = Viscosity { time: tau, ..Viscosity::default() };
    let plain = block().region(rubber()).build().unwrap();
    let body = block().region(rubber().with_viscosity(viscous)).drag(0.3).build().unwrap();
    let velocity = numbers(body.n_dofs(), 0.6);
    let stiffness = plain.stiffness(&vec![0.0; body.n_dofs()]).unwrap();
    let mut momentum = vec![0.0; body.n_dofs()];
    body.mass_product(&velocity, &mut momentum);
    let expected: Vec<f64> =
        product(&stiffness, &velocity).iter().zip(&momentum).map(|(f, p)| tau * f + 0.3 * p).collect();
    let damping = body.damping().unwrap();
    assert_near(&product(&damping, &velocity), &expected, 1e-13, "Rayleigh");
    assert!(plain.damping().unwrap().iter().all(Vec::is_empty));
    // A viscosity without elasticity: the mid-point rule from rest has h^2 (K/2 + C/h).
    let shear = Viscosity { shear: 3.0, bulk: 5.0, ..Viscosity::default() };
    let body = block().region(rubber().with_viscosity(shear)).build().unwrap();
    let h = 1e-3;
    let at_rest = vec![0.0; body.n_dofs()];
    let tangent = |body: &Body| {
        let mut motion = Motion::new(body, TimeElement::MID_POINT).unwrap();
        product(&motion.tangent(&at_rest, h).unwrap(), &velocity)
    };
    let expected: Vec<f64> =
        tangent(&body).iter().zip(tangent(&plain)).map(|(with, without)| (with - without) / h).collect();
    assert_near(&product(&body.damping().unwrap(), &velocity), &expected, 1e-11, "viscosity");
}

#[test]
fn given_motions_are_those_of_their_functions() {
    let turning = Support {
        group: "y-max".into(),
        rotation: Some(emmy::body::Rotation {
            axis: [0.0, 0.0, 1.0],
            about: [0.5, 2.0, 0.0],
            angle: TimeFunction::smooth("2 t", |t| [2.0 * t, 2.0, 0.0]),
        }),
        ..Support::default()
    };
    let pulled = Support::driven("y-min", [None, Some(ramp_from_zero()), None]).until(0.75);
    let body = block().region(rubber()).supports([turning, pulled]).build().unwrap();
    let t = 0.5;
    let given = body.prescribed(t).unwrap();
    assert_eq!(given.dofs.len(), 4 * 3 + 4);
    for (at, &dof) in given.dofs.iter().enumerate() {
        let point = body.mesh().points()[dof / 3];
        let expected = if point[1] == 0.0 {
            // At the kink the rate after it.
            [1.0, -4.0]
        } else {
            let (s, c) = (2.0_f64 * t).sin_cos();
            let r = point[0] - 0.5;
            [[r * (c - 1.0), -2.0 * r * s], [r * s, 2.0 * r * c], [0.0; 2]][dof % 3]
        };
        assert!((given.displacement[at] - expected[0]).abs() < 1e-15, "{dof}");
        assert!((given.velocity[at] - expected[1]).abs() < 1e-14, "{dof}");
    }
    assert_eq!(body.prescribed(0.75).unwrap().dofs.len(), 4 * 3);
    let pole = TimeFunction::smooth("1/(t-1)", |t| [t / (1.0 - t), 1.0 / (1.0 - t).powi(2), 0.0]);
    let lost = Support::driven("y-min", [None, Some(pole), None]);
    let body = block().region(rubber()).support(lost).build().unwrap();
    assert!(matches!(body.prescribed(1.0), Err(Error::NotFiniteAt { .. })));
}

#[test]
fn vectors_of_another_length_are_refused() {
    let body = loaded();
    let short = [0.0; 3];
    let n = body.n_dofs();
    let is_length = |error: Error| matches!(error, Error::Length { found: 3, expected, .. } if expected == n);
    assert!(is_length(body.internal_force(&short).unwrap_err()));
    assert!(is_length(body.stiffness(&short).unwrap_err()));
    assert!(is_length(body.external_force(0.0, &short).unwrap_err()));
    assert!(is_length(PointForces::new(&body).unwrap().evaluate(&short, 0.0).unwrap_err()));
    assert!(is_length(PointForces::new(&body).unwrap().book(0.1, &short, None).unwrap_err()));
    let mut motion = Motion::new(&body, at(DGM, 1)).unwrap();
    assert!(is_length(motion.residual(&short, 0.1).unwrap_err()));
    let rates = vec![0.0; n];
    assert!(matches!(motion.residual(&rates, -0.1), Err(Error::NoDuration { .. })));
    let newmark: Scheme = "Newmark(0.25, 0.5)".parse().unwrap();
    let error = Motion::new(&body, newmark).unwrap().tangent(&rates, 0.1).unwrap_err().to_string();
    assert!(error.contains("Newmark") && error.contains("time element"), "{error}");
}
