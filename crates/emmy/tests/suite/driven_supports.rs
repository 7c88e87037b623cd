//! Driven supports: closed-form solutions, balances at round-off, order of accuracy.

use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, Rotation, Support, TimeFunction};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;
use emmy::{Error, mesh};

use crate::shared::schemes::{DGM, assumed_strain, at};

fn table(entries: &[(f64, f64)]) -> TimeFunction {
    TimeFunction::new(entries.to_vec()).unwrap()
}

/// A sin(w t).
fn sine(amplitude: f64, w: f64) -> TimeFunction {
    TimeFunction::smooth(&format!("{amplitude} sin({w} t)"), move |t| {
        [amplitude * (w * t).sin(), amplitude * w * (w * t).cos(), -amplitude * w * w * (w * t).sin()]
    })
}

fn moved(group: &str, displacement: [Option<TimeFunction>; 3]) -> Support {
    Support { group: group.into(), displacement, ..Default::default() }
}

fn turned(group: &str, axis: [f64; 3], about: [f64; 3], angle: TimeFunction) -> Support {
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
    let settings = NewtonSettings { tolerance: 1e-12, max_iterations: 20, ..NewtonSettings::default() };
    let mut motion = Motion::starting(body, at(scheme, degree), settings, state).unwrap();
    let phases = phases.iter().map(|&(until, size)| Phase { until, size }).collect();
    let steps = StepPlan::new(0.0, phases).unwrap();
    let records = steps.steps().map(|s| motion.step_of_plan(&s).unwrap().clone()).collect();
    (motion.state().clone(), records)
}

/// The whole block has a constant acceleration: the work of the reactions is m a^2 t^2 / 2 for any step.
#[test]
fn a_block_that_is_carried_along() {
    let parabola =
        |a: f64| Some(TimeFunction::smooth(&format!("{a} t^2/2"), move |t| [a * t * t / 2.0, a * t, a]));
    let supports = [moved("body", [parabola(3.0), None, parabola(4.0)])];
    let rubber = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 2.0);
    let body = Body::builder(mesh::block([1.0; 3], [2; 3]).unwrap())
        .region(rubber)
        .supports(&supports)
        .build()
        .unwrap();
    for degree in 1..=3 {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let (state, records) = march(&body, DGM, degree, state, &[(1.0, 0.3)]);
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
    let steel = Region::new(SaintVenantKirchhoff::new(4.0, 3.0).unwrap(), 2.0);
    let body = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap())
        .region(steel)
        .supports(&supports)
        .build()
        .unwrap();
    let w = 15f64.sqrt();
    let response = amplitude * (w * w + 0.5 * drive * drive) / (w * w - drive * drive);
    let end = body.mesh().nearest_node([1.0; 3]);
    // The phase of the time element lags by (w h)^2k w t / 720 and / 100800; strains of 1e-8 add as much to a linear
    // solution.
    for (degree, bound) in [(2, 5e-5), (3, 1e-6)] {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        assert!((state.velocity[0] - amplitude * drive).abs() < 1e-22 && state.velocity[3 * end] == 0.0);
        let (state, _) = march(&body, DGM, degree, state, &[(4.0, 0.05)]);
        let exact = response * ((drive * 4.0).sin() - drive / w * (w * 4.0).sin());
        let error = (state.displacement[3 * end] - exact).abs() / response.abs();
        assert!(error < bound, "k = {degree}: {error}");
    }
}

/// All features together: one face follows tables with kinks inside the steps, the opposite one rotates and moves, a
/// third one is fixed in one direction, and loads act.
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
        Load { kind: force, time_function: table(&[(0.05, 0.0), (0.21, 1.0), (0.21, 0.3)]) },
        Load { kind: gravity, time_function: sine(1.0, 20.0) },
    ];
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.7);
    let mesh = mesh::block([1.0, 3.0, 1.0], [1, 4, 1]).unwrap();
    let body = Body::builder(mesh).region(rubber).supports(&supports).loads(&loads).build().unwrap();
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    for degree in 1..=3 {
        for scheme in [DGM, assumed_strain(10)] {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
            let (state, records) = march(&body, scheme, degree, state, &[(0.2, 0.03), (0.4, 0.07)]);
            let energy = records.iter().map(|r| r.total_energy).fold(0.0, f64::max);
            for record in &records {
                assert!(record.energy_residual.abs() < 3e-12 * energy, "{scheme} k = {degree}: {record:?}");
                assert!(record.linear_momentum_residual < 1e-11, "{scheme} k = {degree}: {record:?}");
                assert!(record.angular_momentum_residual < 3e-11, "{scheme} k = {degree}: {record:?}");
            }
            assert!(records[3].external_work.abs() > 1e-2);
            // The foot follows the table, and is at rest after its last entry.
            assert!((state.displacement[0] + 0.03).abs() < 1e-15 && state.velocity[0] == 0.0);
        }
    }
}

/// A block driven by one of its faces in steady rotation from the start: the steady motion of a stiff body, L = I
/// omega.
#[test]
fn a_driven_face_keeps_a_spin() {
    let (omega, about) = (2.0, [0.5, 0.5, 0.0]);
    let angle = TimeFunction::smooth("2 t", |t| [2.0 * t, 2.0, 0.0]);
    let supports = [turned("z-min", [0.0, 0.0, 3.0], about, angle)];
    let stiff = Region::new(SaintVenantKirchhoff::new(1e5, 1e5).unwrap(), 1.5);
    let body = Body::builder(mesh::block([1.0, 1.0, 2.0], [2, 2, 3]).unwrap())
        .region(stiff)
        .supports(&supports)
        .build()
        .unwrap();
    let spin = InitialVelocity { angular_velocity: [0.0, 0.0, omega], about, ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let (state, records) = march(&body, DGM, 2, state, &[(std::f64::consts::PI, 0.05)]);
    // I_zz = m (a^2 + b^2)/12 about its own axis through (0.5, 0.5), which is at rest.
    let momentum = 3.0 / 6.0 * omega;
    for record in &records {
        assert!((record.angular_momentum[2] - momentum).abs() < 1e-3 * momentum, "{record:?}");
        assert!(
            record.energy_residual.abs() < 1e-10 && record.angular_momentum_residual < 1e-10,
            "{record:?}"
        );
    }
    // One revolution: the driven nodes are back.
    assert!((0..4).all(|dof| state.displacement[dof].abs() < 1e-13));
}

/// The whole block rotates by a given angle, about an axis that is not its own: no strain, velocities angle' e x r, L =
/// I e angle' and T = I angle'^2/2, at the end of every step for any step size.
#[test]
fn a_block_that_is_turned_has_the_velocities_of_the_rotation() {
    let (axis, about) = ([2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], [0.3, -0.4, 0.2]);
    let turns = [
        TimeFunction::smooth("0.7 t + sin(2 t)", |t| {
            let (sin, cos) = (2.0 * t).sin_cos();
            [0.7 * t + sin, 0.7 + 2.0 * cos, -4.0 * sin]
        }),
        // A kink inside a step; its rate is the rate after it.
        table(&[(0.0, 0.0), (0.35, 0.9), (2.0, -0.3)]),
    ];
    let rate_at = |which: usize, t: f64| match which {
        0 => 0.7 + 2.0 * (2.0 * t).cos(),
        _ if t < 0.35 => 0.9 / 0.35,
        _ => -1.2 / 1.65,
    };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    // Inertia about the axis: of the centre, m d^2, and about it, m (a^2/12 of each edge, across the axis).
    let (edges, mass) = ([1.0, 2.0, 0.5], 1.5);
    let arm = cross(axis, [0, 1, 2].map(|d| edges[d] / 2.0 - about[d]));
    let own: f64 = (0..3).map(|d| edges[d].powi(2) / 12.0 * (1.0 - axis[d].powi(2))).sum();
    let inertia = mass * (arm.iter().map(|x| x * x).sum::<f64>() + own);
    for (which, angle) in turns.into_iter().enumerate() {
        let supports = [turned("body", axis.map(|e| 3.0 * e), about, angle)];
        let stiff = Region::new(SaintVenantKirchhoff::new(10.0, 10.0).unwrap(), 1.5);
        let mesh = mesh::block(edges, [2, 2, 1]).unwrap();
        let body = Body::builder(mesh).region(stiff).supports(&supports).build().unwrap();
        for degree in 1..=3 {
            let mut state = State::initial(&body, 0.0, &[]).unwrap();
            for end in [0.0, 0.2, 0.4, 0.6, 0.8] {
                let energy = if end == 0.0 {
                    None
                } else {
                    let settings = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
                    let mut motion = Motion::starting(&body, at(DGM, degree), settings, state).unwrap();
                    let energy = motion.step(0.2).unwrap().kinetic_energy;
                    state = motion.state().clone();
                    Some(energy)
                };
                let rate = rate_at(which, end);
                for (node, point) in body.mesh().points().iter().enumerate() {
                    let q = [0, 1, 2].map(|d| point[d] + state.displacement[3 * node + d] - about[d]);
                    let expected = cross(axis, q).map(|x| rate * x);
                    let found = [0, 1, 2].map(|d| state.velocity[3 * node + d]);
                    assert!(
                        (0..3).all(|d| (found[d] - expected[d]).abs() < 1e-13),
                        "k = {degree}, t = {end}, node {node}: {found:?} is not {expected:?}"
                    );
                }
                let expected = 0.5 * inertia * rate * rate;
                assert!(
                    energy.is_none_or(|energy| (energy - expected).abs() < 1e-12),
                    "{energy:?} {expected}"
                );
            }
        }
    }
}

#[test]
fn order_is_twice_the_degree() {
    let turn = turned("y-min", [0.3, 0.2, 1.0], [0.5, 0.0, 0.5], sine(0.3, 2.0));
    let supports = [turn, moved("y-max", [Some(sine(0.2, 1.5)), None, None])];
    let rubber = Region::new(NeoHooke::new(1.0, 0.5).unwrap(), 1.0);
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap())
        .region(rubber)
        .supports(&supports)
        .build()
        .unwrap();
    let at_end = |degree: usize, size: f64| {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let state = march(&body, DGM, degree, state, &[(1.0, size)]).0;
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
fn impossible_drives_are_rejected() {
    let body = |supports: &[Support]| {
        let rubber = Region::new(NeoHooke::new(1.0, 0.5).unwrap(), 1.0);
        Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber).supports(supports).build()
    };
    let along = |time_function: TimeFunction| moved("x-min", [Some(time_function), None, None]);
    let jump = body(&[along(table(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]))]);
    assert!(matches!(jump, Err(Error::Support { .. })));
    let twice = body(&[along(sine(1.0, 1.0)), moved("y-min", [Some(sine(1.0, 1.0)), None, None])]);
    assert!(matches!(twice, Err(Error::Support { .. })));
    let held = Support { group: "body".into(), fix: [true, false, false], ..Default::default() };
    assert!(matches!(body(&[held, along(sine(1.0, 1.0))]), Err(Error::Support { .. })));
    assert!(body(&[turned("x-min", [0.0; 3], [0.0; 3], sine(1.0, 1.0))]).is_err());
    let body = body(&[along(table(&[(0.0, 0.5)]))]).unwrap();
    assert!(matches!(State::initial(&body, 0.0, &[]), Err(Error::DrivenStart { .. })));
    let zero = || vec![0.0; 24];
    let mut state = State { displacement: zero(), momentum: zero(), velocity: zero(), ..Default::default() };
    for scheme in ["Newmark(0.25, 0.5)", "Bathe", "central-differences"] {
        let stepper = scheme.parse::<Scheme>().unwrap().stepper(&body, NewtonSettings::default(), &mut state);
        assert!(matches!(stepper, Err(Error::Scheme { .. })), "{scheme}");
    }
}

/// A block in accelerated rotation about an axis, fixed in z by a plane; released from the axis at t = 0.5, from the
/// plane at t = 0.7. Momenta are continuous, and conserved in free flight together with the energy.
#[test]
fn a_swing_that_is_released() {
    let angle = TimeFunction::smooth("3 t^2", |t| [3.0 * t * t, 6.0 * t, 6.0]);
    let plane = Support { group: "z-min".into(), symmetry: true, until: Some(0.7), ..Default::default() };
    let mut swing = turned("y-min", [0.0, 0.0, 1.0], [0.5, -2.0, 0.0], angle);
    (swing.rotation, swing.until) = (swing.rotation.take(), Some(0.5));
    // The edge at z = 0 of the face belongs to both.
    let rubber = || Region::new(NeoHooke::new(500.0, 250.0).unwrap(), 1.0);
    let block = || mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let both = Body::builder(block()).region(rubber()).support(plane.clone()).support(swing.clone()).build();
    assert!(matches!(both, Err(Error::Support { .. })));
    let plane = Support { group: "y-max".into(), ..plane };
    let body = Body::builder(block()).region(rubber()).support(plane).support(swing).build().unwrap();
    assert_eq!((body.n_free_dofs(), body.release().unwrap().1.n_free_dofs()), (48 - 16, 48 - 4));
    assert_eq!(body.release().unwrap().1.release().unwrap().1.n_free_dofs(), 48);
    for degree in 1..=3 {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let phases = [(0.5, 0.03), (0.7, 0.03), (1.2, 0.05)];
        let (_, records) = march(&body, DGM, degree, state, &phases);
        let flight = &records[records.iter().position(|r| r.time == 0.7).unwrap()];
        for record in &records {
            assert!(record.energy_residual.abs() < 1e-11, "k = {degree}: {record:?}");
            assert!(record.linear_momentum_residual < 1e-11, "k = {degree}: {record:?}");
            assert!(record.angular_momentum_residual < 1e-11, "k = {degree}: {record:?}");
            if record.time > 0.7 {
                assert!((record.total_energy - flight.total_energy).abs() < 1e-11 * flight.total_energy);
                let change = (0..3).map(|i| record.angular_momentum[i] - flight.angular_momentum[i]);
                assert!(change.map(f64::abs).fold(0.0, f64::max) < 1e-11, "k = {degree}: {record:?}");
                assert_eq!(record.external_work, flight.external_work);
            }
        }
        assert!(flight.external_work > 10.0);
    }
}

/// A fixed support is released in every scheme; free fall follows, and the energy is the work of gravity.
#[test]
fn every_scheme_releases() {
    let held = Support { group: "z-max".into(), fix: [true; 3], until: Some(0.2), ..Default::default() };
    let kind = LoadKind::Acceleration { group: None, acceleration: [0.0, 0.0, -10.0] };
    let gravity = Load { kind, time_function: TimeFunction::constant() };
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let body = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap())
        .region(rubber)
        .support(held)
        .load(gravity)
        .build()
        .unwrap();
    for scheme in ["DGM", "Newmark(0.25, 0.5)", "generalized-alpha(0.8)", "Bathe", "central-differences"] {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let phases = [(0.2, 0.002), (0.4, 0.002)];
        let (_, records) = march(&body, scheme.parse().unwrap(), 1, state, &phases);
        let released = &records[99];
        assert!((released.time - 0.2).abs() < 1e-12);
        let last = &records[records.len() - 1];
        let change = last.linear_momentum[2] - released.linear_momentum[2];
        assert!((change + 10.0 * 0.2).abs() < 1e-10, "{scheme}: {change}");
    }
}

#[test]
fn planes_of_symmetry_are_normal_to_an_axis() {
    let axis = |group: &str| {
        emmy::internals::body::symmetry_axis(&mesh::block([1.0, 2.0, 3.0], [1, 2, 2]).unwrap(), group)
    };
    assert_eq!(["x-max", "y-min", "z-max"].map(|group| axis(group).unwrap()), [0, 1, 2]);
    assert!(matches!(axis("body"), Err(Error::UnknownGroup { .. })));
    let l_block = mesh::l_block(1.0).unwrap();
    assert_eq!(emmy::internals::body::symmetry_axis(&l_block, "face-a"), Ok(1));
}
