//! Steps whose sizes are chosen by the error: the estimate against the true error, what is conserved, which times are met, what it costs.

use std::error::Error as StdError;

use emmy::body::{Body, History, InitialVelocity, Load, LoadKind, Nodal, PointMass, Region, Support};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{self, CellKind, Mesh, MeshBuilder};
use emmy::motion::{Adaptivity, Event, EventKind, GlobalError, MarchError, Motion, NewtonSettings};
use emmy::motion::{Observer, Phase, Record, Snapshot, State, StepPlan, View};
use emmy::time::{LocalError, Scheme};
use emmy::{Error, sparse::Solver};

const DGM: Scheme = Scheme::DiscreteGradient;

fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 30, ..NewtonSettings::default() }
}

/// Points and links between them; node i is the group `i`.
fn network(points: &[[f64; 3]], links: &[[u32; 2]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for (index, &point) in points.iter().enumerate() {
        let node = builder.point(point);
        builder.node_group(&index.to_string(), [node]);
    }
    for link in links {
        builder.cell(CellKind::Line2, link).unwrap();
    }
    builder.build().unwrap()
}

fn moving(body: &Body, velocities: &[[f64; 3]]) -> State {
    let field = |(i, &velocity): (usize, &[f64; 3])| InitialVelocity {
        group: Some(i.to_string()),
        velocity,
        ..Default::default()
    };
    State::initial(body, 0.0, &velocities.iter().enumerate().map(field).collect::<Vec<_>>()).unwrap()
}

/// Two bodies of masses 2 and 1 that attract each other with g = 3, at their largest distance, 1; `e`: eccentricity of the orbit.
fn orbit(e: f64) -> (Body, State) {
    let mesh = network(&[[1.0 / 3.0, 0.0, 0.0], [-2.0 / 3.0, 0.0, 0.0]], &[[0, 1]]);
    let masses = [2.0, 1.0].iter().enumerate().map(|(i, &mass)| PointMass { group: i.to_string(), mass });
    let nodal = Nodal { masses: masses.collect(), ..Default::default() };
    let region = Region::links(None, 0.0, Link::attraction(3.0).unwrap());
    let body = Body::with_nodal(mesh, vec![region], &nodal, &[], &[]).unwrap();
    // v^2 = g/mu (1 - e)/r at the aphelion r = 1 = a (1 + e), mu = 2/3.
    let v = (4.5 * (1.0 - e)).sqrt();
    let state = moving(&body, &[[0.0, v / 3.0, 0.0], [0.0, -2.0 / 3.0 * v, 0.0]]);
    (body, state)
}

/// Period of the orbit: `tau sqrt(a^3 mu/g)`, a = 1/(1 + e).
fn period(e: f64) -> f64 {
    std::f64::consts::TAU * ((1.0 + e).powi(-3) / 4.5).sqrt()
}

/// Four masses in the corners of a tetrahedron with springs along its edges, stretched and turning.
fn springs() -> (Body, State) {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.2, 0.0], [0.1, 0.2, 0.9]];
    let links = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let masses = (0..4).map(|i| PointMass { group: i.to_string(), mass: 1.0 + 0.2 * i as f64 });
    let nodal = Nodal { masses: masses.collect(), ..Default::default() };
    let region = Region::links(None, 0.0, Link::spring(20.0, None).unwrap());
    let body = Body::with_nodal(network(&points, &links), vec![region], &nodal, &[], &[]).unwrap();
    let state = moving(&body, &[[1.0, 0.0, 0.5], [0.0, 1.5, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, -0.5]]);
    (body, state)
}

/// A soft block of two cells that turns and bends.
fn soft_block() -> (Body, State) {
    let rubber = Region::new(None, 1.0, NeoHooke::new(30.0, 15.0).unwrap());
    let body = Body::new(mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap(), vec![rubber], &[], &[]).unwrap();
    let field = InitialVelocity {
        angular_velocity: [0.5, 1.0, 0.3],
        about: [0.5, 0.5, 1.0],
        gradient: [[0.0, 0.0, 0.3], [0.0, 0.0, 0.0], [0.1, 0.0, 0.2]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[field]).unwrap();
    (body, state)
}

/// Mean over the mass.
fn mean(body: &Body, field: &[f64]) -> f64 {
    let squares = field.chunks(3).zip(body.lumped_mass());
    squares.map(|(u, m)| m * u.iter().map(|u| u * u).sum::<f64>()).sum::<f64>().sqrt()
}

/// The state after a time, by an element of a high degree in many steps.
fn exact(body: &Body, state: &State, time: f64) -> State {
    let mut motion = Motion::new(body, Scheme::Standard(5), 5, settings(), state.clone()).unwrap();
    let start = state.time;
    for i in 1..=8 {
        motion.step(time / 8.0, start + time * f64::from(i) / 8.0).unwrap();
    }
    motion.state().clone()
}

/// Estimate over true local error, in displacement and velocity, of each step but the first ones of a march.
fn effectivities(
    (body, start): (Body, State),
    scheme: Scheme,
    degree: usize,
    h: f64,
    n_steps: usize,
) -> Vec<[f64; 2]> {
    let mut motion = Motion::new(&body, scheme, degree, settings(), start.clone()).unwrap();
    let mut estimator = LocalError::new(&body, scheme, degree, settings(), &start).unwrap();
    let mut ratios = Vec::new();
    for step in 0..n_steps {
        let before = motion.state().clone();
        motion.step(h, h * (step + 1) as f64).unwrap();
        let after = motion.state();
        estimator.estimate(&before, after, h).unwrap();
        estimator.accept(h);
        let exact = exact(&body, &before, h);
        let difference = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let displacement = difference(&after.displacement, &exact.displacement);
        let velocity = difference(&after.velocity, &exact.velocity);
        if step >= 2 {
            ratios.push([
                mean(&body, estimator.displacement()) / mean(&body, &displacement),
                mean(&body, estimator.velocity()) / mean(&body, &velocity),
            ]);
        }
    }
    ratios
}

#[test]
fn local_errors_are_estimated_where_the_step_resolves_the_motion() {
    for (name, problem, size) in [
        ("orbit", orbit as fn(f64) -> (Body, State), 0.02),
        ("springs", |_| springs(), 0.02),
        ("soft block", |_| soft_block(), 0.01),
    ] {
        for degree in [1, 2, 3] {
            // A higher degree resolves with larger steps; it must not be all rounding.
            let h = size * [1.0, 3.0, 5.0][degree - 1];
            let ratios = effectivities(problem(0.5), DGM, degree, h, 20);
            let [mut displacement, mut velocity] =
                [0, 1].map(|i| -> Vec<f64> { ratios.iter().map(|r| r[i]).collect() });
            displacement.sort_by(f64::total_cmp);
            velocity.sort_by(f64::total_cmp);
            let (least, most) = (displacement[0], displacement[displacement.len() - 1]);
            println!(
                "{name}, k = {degree}: displacement {least:.3} .. {most:.3}, velocity {:.3} .. {:.3}",
                velocity[0],
                velocity[velocity.len() - 1]
            );
            assert!(least > 0.5 && most < 2.0, "{name}, k = {degree}: {displacement:.3?}");
            if degree > 1 {
                assert!(
                    velocity[0] > 0.5 && velocity[velocity.len() - 1] < 2.0,
                    "{name}, k = {degree}: {velocity:.3?}"
                );
            }
        }
    }
}

/// Estimated over true error of the displacement at the end of a march.
fn effectivity((body, start): &(Body, State), degree: usize, plan: &StepPlan, exact: &State) -> f64 {
    let mut estimate = GlobalError::new(body, DGM, degree, settings(), start).unwrap();
    let mut motion = Motion::new(body, DGM, degree, settings(), start.clone()).unwrap();
    motion.march(plan, &mut [&mut estimate]).unwrap();
    let pairs = motion.state().displacement.iter().zip(&exact.displacement);
    let error: Vec<f64> = pairs.map(|(own, exact)| own - exact).collect();
    mean(body, estimate.displacement()) / mean(body, &error)
}

/// The state at the end of equal steps of FE(k).
fn reference((body, start): &(Body, State), degree: usize, until: f64, size: f64) -> State {
    let mut motion = Motion::new(body, Scheme::Standard(degree), degree, settings(), start.clone()).unwrap();
    motion.march(&equal(until, size), &mut []).unwrap();
    motion.state().clone()
}

fn equal(until: f64, size: f64) -> StepPlan {
    StepPlan::new(0.0, vec![Phase { until, size }]).unwrap()
}

#[test]
fn the_error_at_the_end_is_estimated_with_equal_steps_and_others() {
    let problems = [
        ("orbit", orbit(0.5), 2.0, 0.02, 1e-5),
        ("springs", springs(), 2.0, 0.02, 1e-5),
        ("soft block", soft_block(), 1.0, 0.01, 1e-5),
    ];
    for (name, problem, end, size, tolerance) in &problems {
        let exact = reference(problem, 5, *end, 0.5 * size);
        for degree in [1, 2, 3] {
            let plans = [equal(*end, size * [1.0, 3.0, 5.0][degree - 1]), adaptive(*end, *tolerance)];
            let ratios = plans.map(|plan| effectivity(problem, degree, &plan, &exact));
            println!("{name}, k = {degree}: equal steps {:.4}, adaptive ones {:.4}", ratios[0], ratios[1]);
            assert!(
                ratios.iter().all(|ratio| (0.5..2.0).contains(ratio)),
                "{name}, k = {degree}: {ratios:?}"
            );
        }
    }
}

/// The highest modes of the paper's block are not resolved by its steps: what is left of the estimate then.
#[test]
fn what_no_step_resolves_is_estimated_in_size() {
    let rubber = Region::new(None, 0.5, NeoHooke::new(1000.0, 500.0).unwrap());
    let body = Body::new(mesh::l_block(1.0).unwrap(), vec![rubber], &[], &[]).unwrap();
    let field = InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.02]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[field]).unwrap();
    let problem = (body, state);
    let exact = reference(&problem, 3, 0.2, 0.001);
    for h in [0.02, 0.01] {
        let ratios = [1, 2, 3].map(|degree| effectivity(&problem, degree, &equal(0.2, h), &exact));
        println!("L-block, h = {h}: {ratios:.3?}");
        // As large as the error, within a factor of three.
        assert!(ratios.iter().all(|ratio| (0.33..3.0).contains(ratio)), "h = {h}: {ratios:?}");
    }
}

/// Keeps all that there is to see, and a snapshot after one of the steps.
#[derive(Default)]
struct Watch {
    records: Vec<Record>,
    events: Vec<Event>,
    snapshot_after: Option<usize>,
    snapshot: Option<Snapshot>,
}

impl Observer for Watch {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn StdError + Send + Sync>> {
        if self.snapshot_after == Some(view.record.step) {
            self.snapshot = Some(view.motion.snapshot());
        }
        self.records.push(view.record.clone());
        Ok(())
    }
    fn notice(&mut self, event: &Event) -> Result<(), Box<dyn StdError + Send + Sync>> {
        self.events.push(event.clone());
        Ok(())
    }
}

fn march(body: &Body, state: &State, degree: usize, plan: &StepPlan) -> (Watch, State) {
    let mut watch = Watch::default();
    let mut motion = Motion::new(body, DGM, degree, settings(), state.clone()).unwrap();
    motion.march(plan, &mut [&mut watch]).unwrap();
    let end = motion.state().clone();
    (watch, end)
}

fn adaptive(until: f64, tolerance: f64) -> StepPlan {
    StepPlan::adaptive(0.0, until, Adaptivity::new(tolerance)).unwrap()
}

#[test]
fn ten_thousand_steps_of_many_sizes_conserve_as_equal_ones_do() {
    let e = 0.9;
    let (body, state) = orbit(e);
    let (watch, _) = march(&body, &state, 1, &adaptive(60.0 * period(e), 3e-7));
    let steps = &watch.records[1..];
    let sizes = || steps.iter().map(|record| record.step_size);
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    println!("{} steps, sizes {least:e} to {most:e}, {} refusals", steps.len(), refusals(&watch));
    assert!(steps.len() > 10_000 && most / least > 20.0);
    let first = &watch.records[0];
    let (energy, momentum) = (first.total_energy.abs(), first.angular_momentum[2].abs());
    for record in steps {
        assert!(record.local_error <= 3e-7);
        // At the perihelion T and -V are 20 times their sum.
        let parts = record.kinetic_energy + record.strain_energy.abs();
        assert!(record.energy_residual.abs() < 1e-13 * parts, "{record:?}");
        assert!(record.angular_momentum_residual < 1e-13 * momentum, "{record:?}");
        assert!((record.total_energy - first.total_energy).abs() < 1e-10 * energy, "{record:?}");
        assert!((record.angular_momentum[2] - first.angular_momentum[2]).abs() < 1e-11 * momentum);
    }
    let smooth = steps.windows(2).filter(|pair| pair[1].step_size <= 2.6 * pair[0].step_size).count();
    assert_eq!(smooth, steps.len() - 1);
    assert!(refusals(&watch) < steps.len() / 50, "{}", refusals(&watch));
}

fn refusals(watch: &Watch) -> usize {
    watch.records.iter().map(|record| record.refusals).sum()
}

/// Distance of the first mass from where it was one period before, over the largest distance.
fn closure(body: &Body, state: &State) -> f64 {
    let at = state.position(body, 0);
    (at[0] - 1.0 / 3.0).hypot(at[1]) * 3.0
}

#[test]
fn an_eccentric_orbit_takes_a_third_of_the_equal_steps_at_equal_error() {
    let e = 0.9;
    let (body, state) = orbit(e);
    for degree in [1, 2, 3] {
        let (watch, end) = march(&body, &state, degree, &adaptive(period(e), 1e-6));
        let (error, n) = (closure(&body, &end), watch.records.len() - 1 + refusals(&watch));
        // Equal steps, three times as many.
        let mut motion = Motion::new(&body, DGM, degree, settings(), state.clone()).unwrap();
        let equal = 3 * n;
        let h = period(e) / equal as f64;
        for i in 1..=equal {
            motion.step(h, h * i as f64).unwrap();
        }
        let of_equal = closure(&body, motion.state());
        println!("k = {degree}: {n} steps with error {error:.2e}; {equal} equal ones {of_equal:.2e}");
        assert!(
            of_equal > error,
            "k = {degree}: {n} steps with error {error:e}, {equal} equal ones {of_equal:e}"
        );
    }
}

/// Work by counts, not by a clock. Estimates for k > 1, a step of the next degree each, are not counted.
#[test]
fn an_eccentric_orbit_takes_a_third_of_the_corrections_at_equal_error() {
    let e = 0.9;
    let (body, state) = orbit(e);
    for degree in [1, 2, 3] {
        let (watch, end) = march(&body, &state, degree, &adaptive(period(e), 1e-6));
        let of_steps = || watch.records.iter().map(|record| record.newton_iterations);
        // A step that was refused has taken as many as any other at most.
        let own = of_steps().sum::<usize>() + refusals(&watch) * of_steps().max().unwrap();
        let error = closure(&body, &end);
        // Eight times as many equal steps: each of these takes fewer corrections.
        let n = 8 * (watch.records.len() - 1);
        let (plan, mut corrections) = (equal(period(e), period(e) / n as f64), 0);
        let (equal, end) = march(&body, &state, degree, &plan);
        equal.records.iter().for_each(|record| corrections += record.newton_iterations);
        let of_equal = closure(&body, &end);
        println!(
            "k = {degree}: {own} corrections with error {error:.2e}; {corrections} in {n} equal steps, {of_equal:.2e}"
        );
        assert!(of_equal > error, "k = {degree}: error {error:e}, of equal steps {of_equal:e}");
        assert!(corrections >= 3 * own, "k = {degree}: {own} corrections, {corrections} in equal steps");
    }
}

#[test]
fn smaller_tolerances_make_smaller_errors() {
    // Not after a whole revolution, in which errors of both halves cancel.
    let (e, problem) = (0.6, orbit(0.6));
    let end = 0.8 * period(e);
    let exact = reference(&problem, 5, end, end / 400.0);
    for degree in [1, 2] {
        let errors = [1e-6, 1e-7, 1e-8].map(|tolerance| {
            let (_, state) = march(&problem.0, &problem.1, degree, &adaptive(end, tolerance));
            let pairs = state.displacement.iter().zip(&exact.displacement);
            pairs.map(|(own, exact)| (own - exact).powi(2)).sum::<f64>().sqrt()
        });
        // n steps of error tol ~ h^(2k+1) make n tol ~ h^2k.
        let expected = 2.0 * degree as f64 / (2.0 * degree as f64 + 1.0);
        let power = (errors[0] / errors[2]).log10() / 2.0;
        println!("k = {degree}: {errors:?} go with tolerance^{power}");
        assert!((power - expected).abs() < 0.15, "k = {degree}: {errors:?} go with tolerance^{power}");
    }
}

/// A block that hangs on two supports, one of which is released, under a load with a kink and a jump.
fn loaded_block() -> Body {
    let rubber = Region::new(None, 1.0, NeoHooke::new(300.0, 150.0).unwrap());
    let held = Support { group: "z-min".into(), until: Some(0.31), ..Support::default() };
    let history = History::new(vec![(0.0, 0.0), (0.1234, 1.0), (0.2, 1.0), (0.2, 0.0)]).unwrap();
    let kind = LoadKind::Traction { group: "z-max".into(), traction: [4.0, 0.0, 0.0] };
    let mesh = mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    Body::new(mesh, vec![rubber], &[held], &[Load { kind, history }]).unwrap()
}

#[test]
fn kinks_releases_and_ends_are_met_exactly() {
    let body = loaded_block();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let plan = adaptive(0.5, 1e-4).with_end_at(0.31).with_end_at(0.4);
    for degree in [1, 2] {
        let (watch, end) = march(&body, &state, degree, &plan);
        let times: Vec<f64> = watch.records.iter().map(|record| record.time).collect();
        for time in [0.1234, 0.2, 0.31, 0.4, 0.5] {
            assert!(times.contains(&time), "k = {degree}: {time} is not among {times:?}");
        }
        assert_eq!(end.time, 0.5);
        let kinds: Vec<EventKind> = watch.events.iter().map(|event| event.kind).collect();
        assert!(kinds.contains(&EventKind::Release), "{kinds:?}");
        for record in &watch.records[1..] {
            assert!(record.energy_residual.abs() < 1e-12 && record.local_error <= 1e-4, "{record:?}");
        }
    }
}

#[test]
fn a_motion_that_goes_on_from_a_snapshot_is_the_motion_itself() {
    let body = loaded_block();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let plan = adaptive(0.5, 3e-5).with_end_at(0.31);
    for (degree, solver) in [(1, Solver::Iterative), (1, Solver::Direct), (2, Solver::Auto)] {
        let settings = NewtonSettings { solver, ..settings() };
        let n = {
            let (watch, _) = march(&body, &state, degree, &plan);
            watch.records.len() - 1
        };
        for after in [0, 1, n / 3, n / 2, 3 * n / 4, n - 1] {
            let mut whole = Watch { snapshot_after: Some(after), ..Watch::default() };
            let mut motion = Motion::new(&body, DGM, degree, settings, state.clone()).unwrap();
            motion.march(&plan, &mut [&mut whole]).unwrap();
            let snapshot = whole.snapshot.take().unwrap();
            let mut rest = Watch::default();
            let mut resumed = Motion::resumed(&body, DGM, degree, settings, snapshot.clone()).unwrap();
            assert_eq!(resumed.snapshot(), snapshot);
            resumed.march_on(&plan, &mut [&mut rest]).unwrap();
            let own = format!("{:?} {:?}", rest.records, resumed.state());
            let expected = format!("{:?} {:?}", &whole.records[after + 1..], motion.state());
            assert!(
                own == expected,
                "k = {degree}, {solver:?}, from step {after} of {n}:\n{own:.1500}\n{expected:.1500}"
            );
        }
    }
}

#[test]
fn a_tolerance_that_the_smallest_step_does_not_meet_is_an_error() {
    let (body, state) = orbit(0.9);
    let adaptivity = Adaptivity { smallest: 0.05, ..Adaptivity::new(1e-8) };
    let plan = StepPlan::adaptive(0.0, period(0.9), adaptivity).unwrap();
    let mut motion = Motion::new(&body, DGM, 1, settings(), state).unwrap();
    let before = motion.state().clone();
    match motion.march(&plan, &mut []) {
        Err(MarchError::Step(Error::SmallestStep { cause, .. })) => {
            assert!(matches!(*cause, Error::Tolerance { tolerance: 1e-8, .. }), "{cause}");
        }
        other => panic!("{other:?}"),
    }
    // The state is that of the last good step, here the start.
    assert_eq!(*motion.state(), before);
}

/// A body at rest takes steps as large as they may be; what is short beside them is not passed over.
#[test]
fn a_short_phase_after_a_long_one_is_done() {
    let rubber = Region::new(None, 1.0, NeoHooke::new(30.0, 15.0).unwrap());
    let body = Body::new(mesh::block([1.0; 3], [1; 3]).unwrap(), vec![rubber], &[], &[]).unwrap();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let plan = adaptive(1e8 + 2.0, 1e-4).with_end_at(1e8).with_end_at(1e8 + 1.0);
    let (watch, end) = march(&body, &state, 1, &plan);
    assert!(watch.records.iter().any(|record| record.time == 1e8 + 1.0));
    assert_eq!(end.time, 1e8 + 2.0);
}

#[test]
fn what_has_no_scale_or_no_estimate_is_refused() {
    let (body, state) = orbit(0.5);
    let newmark = "Newmark(0.25, 0.5)".parse().unwrap();
    let mut motion = Motion::new(&body, newmark, 1, settings(), state).unwrap();
    let refused = motion.march(&adaptive(1.0, 1e-4), &mut []);
    assert!(matches!(refused, Err(MarchError::Step(Error::Scheme { .. }))), "{refused:?}");
}
