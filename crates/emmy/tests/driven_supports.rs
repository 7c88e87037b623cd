//! Supports that move: against solutions in closed form, balances at round-off, order of accuracy.

use emmy::body::{Body, History, InitialVelocity, Load, LoadKind, Region, Rotation, Support};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;
use emmy::{Error, mesh};

fn table(entries: &[(f64, f64)]) -> History {
    History::new(entries.to_vec()).unwrap()
}

/// A sin(w t).
fn sine(amplitude: f64, w: f64) -> History {
    History::smooth(&format!("{amplitude} sin({w} t)"), move |t| {
        [amplitude * (w * t).sin(), amplitude * w * (w * t).cos(), -amplitude * w * w * (w * t).sin()]
    })
}

fn moved(group: &str, displacement: [Option<History>; 3]) -> Support {
    Support { group: group.into(), displacement, ..Default::default() }
}

fn turned(group: &str, axis: [f64; 3], about: [f64; 3], angle: History) -> Support {
    let rotation = Some(Rotation { axis, about, angle });
    Support { group: group.into(), rotation, ..Default::default() }
}

fn march(
    body: &Body,
    scheme: Scheme,
    degree: usize,
    state: State,
    phases: &[(f64, f64)],
) -> (State, Vec<Record>) {
    let settings = NewtonSettings { tolerance: 1e-12, max_iterations: 20 };
    let mut motion = Motion::new(body, scheme, degree, settings, state).unwrap();
    let phases = phases.iter().map(|&(until, size)| Phase { until, size }).collect();
    let steps = StepPlan::new(0.0, phases).unwrap();
    let records = steps.steps().map(|s| motion.step(s.size, s.end).unwrap().clone()).collect();
    (motion.state().clone(), records)
}

/// All of a block is driven with a constant acceleration: the reactions do the work m a^2 t^2 / 2, whatever the step.
#[test]
fn a_block_that_is_carried_along() {
    let parabola =
        |a: f64| Some(History::smooth(&format!("{a} t^2/2"), move |t| [a * t * t / 2.0, a * t, a]));
    let supports = [moved("body", [parabola(3.0), None, parabola(4.0)])];
    let rubber = Region::new(None, 2.0, NeoHooke::new(10.0, 5.0).unwrap());
    let body = Body::new(mesh::block([1.0; 3], [2; 3]).unwrap(), vec![rubber], &supports, &[]).unwrap();
    for degree in 1..=3 {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let (state, records) = march(&body, Scheme::DiscreteGradient, degree, state, &[(1.0, 0.3)]);
        let last = &records[records.len() - 1];
        assert!((last.external_work - 0.5 * 2.0 * 25.0).abs() < 1e-12, "{last:?}");
        assert!(
            (last.linear_momentum[0] - 6.0).abs() < 1e-12 && (last.linear_momentum[2] - 8.0).abs() < 1e-12
        );
        assert!(
            records.iter().all(|r| r.linear_momentum_residual < 1e-13 && r.energy_residual.abs() < 1e-12)
        );
        assert!((state.displacement[0] - 1.5).abs() < 1e-15 && (state.velocity[2] - 4.0).abs() < 1e-15);
    }
}

/// A bar of one cell whose foot is shaken, small strain: an oscillator with consistent mass,
/// `u'' + w^2 u = w^2 u_c - u_c''/2` with `w^2 = 3 (lambda + 2 mu) / (rho L^2)`, from rest.
#[test]
fn base_excitation_of_an_oscillator() {
    let (amplitude, drive) = (1e-8, 3.0);
    let supports = [
        Support { group: "body".into(), fix: [false, true, true], ..Default::default() },
        moved("x-min", [Some(sine(amplitude, drive)), None, None]),
    ];
    let steel = Region::new(None, 2.0, SaintVenantKirchhoff::new(4.0, 3.0).unwrap());
    let body = Body::new(mesh::block([1.0; 3], [1; 3]).unwrap(), vec![steel], &supports, &[]).unwrap();
    let w = 15f64.sqrt();
    let response = amplitude * (w * w + 0.5 * drive * drive) / (w * w - drive * drive);
    let end = body.mesh().nearest_node([1.0; 3]);
    // The phase of the time element lags by (w h)^2k w t / 720 and / 100800; strains of 1e-8 add as much to a linear solution.
    for (degree, bound) in [(2, 5e-5), (3, 1e-6)] {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        assert!((state.velocity[0] - amplitude * drive).abs() < 1e-22 && state.velocity[3 * end] == 0.0);
        let (state, _) = march(&body, Scheme::DiscreteGradient, degree, state, &[(4.0, 0.05)]);
        let exact = response * ((drive * 4.0).sin() - drive / w * (w * 4.0).sin());
        let error = (state.displacement[3 * end] - exact).abs() / response.abs();
        assert!(error < bound, "k = {degree}: {error}");
    }
}

/// Everything at once: one face follows tables with kinks inside the steps, the opposite one turns and moves, a third one is
/// held in one direction, and loads act.
#[test]
fn balances_close_under_loads_with_kinks_inside_steps() {
    let zigzag = |a: f64| Some(table(&[(0.05, 0.0), (0.11, a), (0.13, a), (0.31, -a)]));
    let mut crank =
        turned("y-max", [0.2, 1.0, -0.5], [0.5, 3.0, 0.5], table(&[(0.0, 0.0), (0.17, 0.2), (0.33, 0.1)]));
    crank.displacement[1] = Some(sine(0.1, 7.0));
    let supports = [moved("y-min", [zigzag(0.03), None, zigzag(-0.02)]), crank];
    let force = LoadKind::Force { group: "x-max".into(), force: [0.0, 30.0, 40.0] };
    let gravity = LoadKind::Acceleration { group: None, acceleration: [1.0, -9.81, 2.0] };
    let loads = [
        Load { kind: force, history: table(&[(0.05, 0.0), (0.21, 1.0), (0.21, 0.3)]) },
        Load { kind: gravity, history: sine(1.0, 20.0) },
    ];
    let rubber = Region::new(None, 0.7, NeoHooke::new(1000.0, 500.0).unwrap());
    let mesh = mesh::block([1.0, 3.0, 1.0], [1, 4, 1]).unwrap();
    let body = Body::new(mesh, vec![rubber], &supports, &loads).unwrap();
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    for degree in 1..=3 {
        for scheme in [Scheme::DiscreteGradient, Scheme::AssumedStrain(10)] {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
            let (state, records) = march(&body, scheme, degree, state, &[(0.2, 0.03), (0.4, 0.07)]);
            let energy = records.iter().map(|r| r.total_energy).fold(0.0, f64::max);
            for record in &records {
                assert!(record.energy_residual.abs() < 3e-12 * energy, "{scheme} k = {degree}: {record:?}");
                assert!(record.linear_momentum_residual < 1e-11, "{scheme} k = {degree}: {record:?}");
                assert!(record.angular_momentum_residual < 3e-11, "{scheme} k = {degree}: {record:?}");
            }
            assert!(records[3].external_work.abs() > 1e-2);
            // The foot is where the table says, and at rest after its last entry.
            assert!((state.displacement[0] + 0.03).abs() < 1e-15 && state.velocity[0] == 0.0);
        }
    }
}

/// A block spun by one of its faces, and in that spin from the start: the steady motion of a stiff body, L = I omega.
#[test]
fn a_driven_face_keeps_a_spin() {
    let (omega, about) = (2.0, [0.5, 0.5, 0.0]);
    let angle = History::smooth("2 t", |t| [2.0 * t, 2.0, 0.0]);
    let supports = [turned("z-min", [0.0, 0.0, 3.0], about, angle)];
    let stiff = Region::new(None, 1.5, SaintVenantKirchhoff::new(1e5, 1e5).unwrap());
    let body =
        Body::new(mesh::block([1.0, 1.0, 2.0], [2, 2, 3]).unwrap(), vec![stiff], &supports, &[]).unwrap();
    let spin = InitialVelocity { angular_velocity: [0.0, 0.0, omega], about, ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let (state, records) = march(&body, Scheme::DiscreteGradient, 2, state, &[(std::f64::consts::PI, 0.05)]);
    // I_zz = m (a^2 + b^2)/12 about its own axis, which stands through (0.5, 0.5) and does not move.
    let momentum = 3.0 / 6.0 * omega;
    for record in &records {
        assert!((record.angular_momentum[2] - momentum).abs() < 1e-3 * momentum, "{record:?}");
        assert!(
            record.energy_residual.abs() < 1e-10 && record.angular_momentum_residual < 1e-10,
            "{record:?}"
        );
    }
    // One turn: the driven nodes are back.
    assert!((0..4).all(|dof| state.displacement[dof].abs() < 1e-13));
}

#[test]
fn order_is_twice_the_degree() {
    let turn = turned("y-min", [0.3, 0.2, 1.0], [0.5, 0.0, 0.5], sine(0.3, 2.0));
    let supports = [turn, moved("y-max", [Some(sine(0.2, 1.5)), None, None])];
    let rubber = Region::new(None, 1.0, NeoHooke::new(1.0, 0.5).unwrap());
    let body =
        Body::new(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap(), vec![rubber], &supports, &[]).unwrap();
    let at_end = |degree: usize, size: f64| {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let state = march(&body, Scheme::DiscreteGradient, degree, state, &[(1.0, size)]).0;
        [state.displacement, state.velocity].concat()
    };
    let reference = at_end(5, 0.05);
    for (degree, size) in [(1, 0.05), (2, 0.2), (3, 0.25)] {
        let error = |size| {
            let pairs =
                at_end(degree, size).into_iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            pairs.sqrt()
        };
        let (coarse, fine) = (error(size), error(size / 2.0));
        let order = (coarse / fine).log2();
        println!("k = {degree}: errors {coarse:.2e}, {fine:.2e}, order {order:.2}");
        assert!((order - 2.0 * degree as f64).abs() < 0.3, "k = {degree}: order {order}");
    }
}

#[test]
fn what_cannot_be_driven_is_refused() {
    let body = |supports: &[Support]| {
        let rubber = Region::new(None, 1.0, NeoHooke::new(1.0, 0.5).unwrap());
        Body::new(mesh::block([1.0; 3], [1; 3]).unwrap(), vec![rubber], supports, &[])
    };
    let along = |history: History| moved("x-min", [Some(history), None, None]);
    let jump = body(&[along(table(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]))]);
    assert!(matches!(jump, Err(Error::Support { .. })));
    let twice = body(&[along(sine(1.0, 1.0)), moved("y-min", [Some(sine(1.0, 1.0)), None, None])]);
    assert!(matches!(twice, Err(Error::Support { .. })));
    let held = Support { group: "body".into(), fix: [true, false, false], ..Default::default() };
    assert!(matches!(body(&[held, along(sine(1.0, 1.0))]), Err(Error::Support { .. })));
    assert!(body(&[turned("x-min", [0.0; 3], [0.0; 3], sine(1.0, 1.0))]).is_err());
    let body = body(&[along(table(&[(0.0, 0.5)]))]).unwrap();
    assert!(matches!(State::initial(&body, 0.0, &[]), Err(Error::DrivenStart { .. })));
    let mut state = State {
        time: 0.0,
        step: 0,
        displacement: vec![0.0; 24],
        momentum: vec![0.0; 24],
        velocity: vec![0.0; 24],
    };
    for scheme in ["Newmark(0.25, 0.5)", "Bathe", "central-differences"] {
        let stepper =
            scheme.parse::<Scheme>().unwrap().stepper(&body, 1, NewtonSettings::default(), &mut state);
        assert!(matches!(stepper, Err(Error::Scheme { .. })), "{scheme}");
    }
}
