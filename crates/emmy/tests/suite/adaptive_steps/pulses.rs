//! Short pulses given as expressions: adaptive steps find them from rest, planned ones report that they miss them.

use emmy::motion::Record;

use super::*;
use crate::shared::schemes::{DGM, at};

const WIDTH: f64 = 0.01;

/// A Gaussian pulse of a height at t = 5.
fn pulse(height: f64) -> TimeFunction {
    TimeFunction::smooth(&format!("pulse {height}"), move |t| {
        let s = (t - 5.0) / WIDTH;
        let value = height * (-s * s).exp();
        [value, -2.0 * s / WIDTH * value, (4.0 * s * s - 2.0) / (WIDTH * WIDTH) * value]
    })
}

fn block(supports: &[Support], loads: &[Load]) -> Body {
    let rubber = Region::new(NeoHooke::from_engineering(1000.0, 0.3).unwrap(), 1.0);
    Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap())
        .region(rubber)
        .supports(supports)
        .loads(loads)
        .build()
        .unwrap()
}

fn loaded() -> Body {
    let kind = LoadKind::Traction { group: "y-max".into(), traction: [1.0, 0.0, 0.0] };
    block(&[], &[Load { kind, time_function: pulse(1000.0) }])
}

fn at_rest(body: &Body) -> State {
    State::initial(body, 0.0, &[]).unwrap()
}

/// The record at the end of a march from rest.
fn end(body: &Body, degree: usize, plan: &StepPlan) -> Record {
    let mut motion = Motion::starting(body, at(DGM, degree), settings(), at_rest(body)).unwrap();
    motion.march(plan, &mut []).unwrap();
    motion.record().clone()
}

#[test]
fn a_load_is_found_from_rest() {
    let body = loaded();
    // 1000 times the integral of exp(-(t/0.01)^2), over the unit face.
    let impulse = 1000.0 * WIDTH * std::f64::consts::PI.sqrt();
    for degree in [1, 2, 3] {
        let [x, y, z] = end(&body, degree, &adaptive(6.0, 1e-4)).linear_momentum;
        let error = (x / impulse - 1.0).abs();
        assert!(error < 1e-4 && y.abs() + z.abs() < 1e-9, "k = {degree}: {x} {y} {z}");
    }
}

/// The support returns to its place after the pulse; the remaining vibration of the body agrees with short equal steps.
#[test]
fn a_moving_support_is_found_from_rest() {
    let support =
        Support { group: "y-min".into(), displacement: [Some(pulse(0.1)), None, None], ..Default::default() };
    let body = block(&[support], &[]);
    let until = 5.06;
    let plan =
        StepPlan::new(0.0, vec![Phase { until: 4.9, size: 0.1 }, Phase { until, size: 1e-3 }]).unwrap();
    let energy = end(&body, 2, &plan).total_energy;
    for degree in [1, 2, 3] {
        let found = end(&body, degree, &adaptive(until, 1e-5)).total_energy;
        assert!((found / energy - 1.0).abs() < 1e-2, "k = {degree}: {found} {energy}");
    }
}

#[test]
fn planned_steps_that_miss_a_pulse_are_counted() {
    let body = loaded();
    for (scheme, size, missed) in [(DGM, 0.5, 1..3), (DGM, 0.005, 0..1), (Scheme::Bathe, 0.5, 1..3)] {
        let mut motion = Motion::starting(&body, at(scheme, 1), settings(), at_rest(&body)).unwrap();
        let mut count = Unresolved(0);
        let plan =
            StepPlan::new(0.0, vec![Phase { until: 4.6, size: 0.46 }, Phase { until: 5.6, size }]).unwrap();
        motion.march(&plan, &mut [&mut count]).unwrap();
        assert!(missed.contains(&count.0), "{scheme} {size}: {}", count.0);
    }
}

/// Counts the steps that miss a part of a load.
struct Unresolved(usize);

impl emmy::motion::Observer for Unresolved {
    fn observe(
        &mut self,
        view: emmy::motion::View<'_>,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.0 += usize::from(view.record.is_unresolved);
        Ok(())
    }
}

/// If steps of a smallest size do not resolve a pulse, an error names it.
#[test]
fn a_smallest_size_that_misses_a_pulse_ends_the_march() {
    let body = loaded();
    let plan = StepPlan::adaptive(0.0, 10.0, Adaptivity { smallest: 0.2, ..Adaptivity::new(1e-4) }).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 1), settings(), at_rest(&body)).unwrap();
    let Err(MarchError::Step(Error::SmallestStep { cause, .. })) = motion.march(&plan, &mut []) else {
        panic!("the pulse is missed");
    };
    assert!(cause.to_string().starts_with("load 0 (\"pulse 1000\") near t = "), "{cause}");
}
