//! Loads and supports that follow long tables, such as measurements.

use emmy::body::{Body, Load, LoadKind, PointMass, PointTerms, Region, Support, TimeFunction};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{self, CellKind, MeshBuilder};
use emmy::motion::{Adaptivity, Motion, NewtonSettings, Phase, State, StepPlan};

use crate::shared::schemes::{DGM, assumed_strain, at};

/// Numbers between -1 and 1 (SplitMix64).
fn random() -> impl FnMut() -> f64 {
    let mut state = 42u64;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
    }
}

/// A table of random values at random times from 0 to 1, every hundredth of them a jump.
fn random_table(n: usize) -> Vec<(f64, f64)> {
    let mut number = random();
    let mut times: Vec<f64> = (0..n).map(|_| 0.5 * (number() + 1.0)).collect();
    times.extend([0.0, 1.0]);
    times.sort_by(f64::total_cmp);
    (0..n).step_by(100).for_each(|i| times[i + 1] = times[i]);
    times.into_iter().map(|time| (time, number())).collect()
}

/// Integrals of a table and of its size.
fn integrals(table: &[(f64, f64)]) -> [f64; 2] {
    let of = |size: fn(f64) -> f64| -> f64 {
        table.windows(2).map(|pair| 0.5 * (pair[1].0 - pair[0].0) * (size(pair[0].1) + size(pair[1].1))).sum()
    };
    [of(|value| value), of(f64::abs)]
}

fn rubber() -> Region {
    Region::new(NeoHooke::from_engineering(1000.0, 0.3).unwrap(), 2.0)
}

fn at_rest(body: &Body) -> State {
    State::initial(body, 0.0, &[]).unwrap()
}

/// The change of momentum is the impulse of the table, however many rows lie in a step.
#[test]
fn the_impulse_of_a_long_table_is_exact_at_any_step_size() {
    let table = random_table(10_000);
    let [impulse, size] = integrals(&table);
    let kind = LoadKind::Acceleration { group: None, acceleration: [3.0, 0.0, 0.0] };
    let load = Load { kind, time_function: TimeFunction::measured(table).unwrap() };
    let body =
        Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber()).load(load).build().unwrap();
    for (scheme, degree) in [(DGM, 1), (DGM, 2), (assumed_strain(2), 1), (DGM, 3)] {
        for step in [1.0, 0.37, 0.1, 0.003] {
            let mut motion =
                Motion::starting(&body, at(scheme, degree), NewtonSettings::default(), at_rest(&body))
                    .unwrap();
            let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: step }]).unwrap();
            motion.march(&plan, &mut []).unwrap();
            let error = motion.record().linear_momentum[0] - 6.0 * impulse;
            assert!(error.abs() < 1e-13 * 6.0 * size, "{scheme:?} {degree} {step}: {error:e}");
        }
    }
}

/// Adaptive steps follow a measured pulse from rest, and end at far fewer times than it has rows.
#[test]
fn adaptive_steps_do_not_end_at_every_row() {
    let pulse = |t: f64| (-((t - 5.0) / 0.01f64).powi(2)).exp();
    let rows = (0..=100_000).map(|i| 1e-4 * f64::from(i));
    let table: Vec<(f64, f64)> = rows.map(|t| (t, pulse(t))).collect();
    let [impulse, _] = integrals(&table);
    let kind = LoadKind::Acceleration { group: None, acceleration: [1000.0, 0.0, 0.0] };
    let load = Load { kind, time_function: TimeFunction::measured(table).unwrap() };
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap())
        .region(rubber())
        .load(load)
        .build()
        .unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 1), NewtonSettings::default(), at_rest(&body)).unwrap();
    motion.march(&StepPlan::adaptive(0.0, 10.0, Adaptivity::new(1e-4)).unwrap(), &mut []).unwrap();
    let record = motion.record();
    assert!((record.linear_momentum[0] / (4000.0 * impulse) - 1.0).abs() < 1e-12, "{record:?}");
    assert!((10..2000).contains(&record.step), "{} steps", record.step);
}

/// A mass on a spring whose foot has a measured acceleration, against the exact solution for linear pieces (Nigam and
/// Jennings 1969, Bull. Seismol. Soc. Am. 59, 909-922).
#[test]
fn an_oscillator_on_a_shaken_base_matches_its_exact_solution() {
    let mut number = random();
    let dt = 0.05;
    let table: Vec<(f64, f64)> = (0..=200).map(|i| (dt * f64::from(i), number())).collect();
    let mut builder = MeshBuilder::new();
    builder.point([0.0; 3]);
    builder.point([20.0, 0.0, 0.0]);
    builder.cell(CellKind::Line2, &[0, 1]).unwrap();
    builder.node_group("base", [0]);
    builder.node_group("mass", [1]);
    let w = 3.0;
    let masses =
        vec![PointMass { group: "base".into(), mass: 1.0 }, PointMass { group: "mass".into(), mass: 2.0 }];
    let acceleration = TimeFunction::measured(table.clone()).unwrap();
    let path = TimeFunction::from_acceleration(&acceleration, [0.0, 10.0]).unwrap();
    let base = Support {
        fix: [false, true, true],
        displacement: [Some(path.clone()), None, None],
        ..Support::fixed("base")
    };
    let guide = Support::of_components("mass", [false, true, true]);
    let body = Body::builder(builder.build().unwrap())
        .region(Region::links(Link::spring(2.0 * w * w, Some(20.0)).unwrap(), 0.0))
        .point_terms(PointTerms { masses, ..Default::default() })
        .supports(&[base, guide])
        .build()
        .unwrap();
    // y'' + w^2 y = -(a + b s), from y and y' at s = 0.
    let [mut y, mut rate] = [0.0; 2];
    let mut exact = vec![];
    for pair in table.windows(2) {
        let [a, b] = [pair[0].1, (pair[1].1 - pair[0].1) / dt];
        let [c, s] = [(w * dt).cos(), (w * dt).sin()];
        let [p, q] = [y + a / (w * w), (rate + b / (w * w)) / w];
        [y, rate] = [p * c + q * s - (a + b * dt) / (w * w), w * (q * c - p * s) - b / (w * w)];
        exact.push(y);
    }
    let settings = NewtonSettings { tolerance: 1e-13, ..NewtonSettings::default() };
    let mut motion = Motion::starting(&body, at(DGM, 3), settings, at_rest(&body)).unwrap();
    for (step, exact) in exact.into_iter().enumerate() {
        motion.step(dt).unwrap();
        let displacement = &motion.state().displacement;
        let time = motion.state().time;
        assert!((displacement[0] - path.value(time)).abs() < 1e-14, "step {step}");
        let error = displacement[3] - displacement[0] - exact;
        assert!(error.abs() < 1e-9, "step {step}: {error:e} of {exact}");
        assert!(motion.record().energy_residual.abs() < 1e-12);
    }
}
