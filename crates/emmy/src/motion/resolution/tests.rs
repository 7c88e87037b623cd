//! Tests of the check that steps resolve functions of time.

use super::*;
use crate::input::{Load, LoadKind, Region, Support, TimeFunction};
use crate::material::NeoHooke;
use crate::mesh;
use crate::motion::Phase;
use crate::time::{AveragingRule, TimeElement};

const DGM: TimeElement =
    TimeElement { rule: AveragingRule::DiscreteGradient, degree: 1, spectral_radius: None };

fn body(time_function: TimeFunction, moves: Option<TimeFunction>) -> Body {
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let load =
        Load { kind: LoadKind::Acceleration { group: None, acceleration: [1.0, 0.0, 0.0] }, time_function };
    let driven = moves.map(|time_function| Support {
        group: "y-min".to_string(),
        displacement: [Some(time_function), None, None],
        ..Default::default()
    });
    Body::builder(mesh)
        .region(Region::new(rubber, 1.0))
        .supports(driven.as_slice())
        .load(load)
        .build()
        .unwrap()
}

fn pulse(at: f64, width: f64) -> TimeFunction {
    TimeFunction::smooth(&format!("pulse {at} {width}"), move |t| {
        [(-((t - at) / width).powi(2)).exp(), 0.0, 0.0]
    })
}

fn resolution(body: &Body, scheme: impl Into<Scheme>) -> Resolution {
    let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
    Resolution::new(body, scheme, &plan).unwrap()
}

#[test]
fn tables_need_no_check() {
    let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
    let body = body(TimeFunction::new(vec![(4.99, 0.0), (5.0, 1.0), (5.01, 0.0)]).unwrap(), None);
    assert!(Resolution::new(&body, DGM, &plan).is_none());
}

#[test]
fn a_short_pulse_is_seen_by_every_scheme_and_degree() {
    let body = body(pulse(5.13, 0.01), None);
    let third = TimeElement { degree: 3, ..DGM };
    for scheme in [DGM.into(), third.into(), Scheme::Bathe, Scheme::CentralDifferences] {
        let resolution = resolution(&body, scheme);
        let missed = resolution.unresolved(5.0, 0.5).unwrap();
        assert!((missed.time - 5.13).abs() < 0.01 && missed.target == SignalTarget::Load(0));
        assert_eq!(resolution.unresolved(5.5, 0.5), None);
        assert_eq!(resolution.unresolved(5.13, 0.001), None);
    }
}

#[test]
fn a_pulse_shows_its_load_and_its_place() {
    let plan = StepPlan::new(0.0, vec![Phase { until: 10.0, size: 0.5 }]).unwrap();
    let (count, first) =
        resolution(&body(pulse(5.13, 0.01), None), TimeElement::MID_POINT).unresolved_steps(&plan);
    assert_eq!(count, 1);
    let text = first.unwrap().to_string();
    assert!(text.starts_with("load 0 (\"pulse 5.13 0.01\") near t = 5.1"), "{text}");
}

#[test]
fn a_pole_is_seen_where_a_phase_or_the_plan_ends() {
    let tan = || TimeFunction::smooth("tan", |t| [(std::f64::consts::PI * t / 2.0).tan(), 0.0, 0.0]);
    let costly = TimeFunction::of_times("tan of times", |times, values| {
        values.iter_mut().zip(times).for_each(|(value, t)| *value = (std::f64::consts::PI * t / 2.0).tan());
    });
    let third = TimeElement { degree: 3, ..DGM };
    for body in [body(tan(), None), body(costly, None)] {
        for until in [1.0, 2.0] {
            let plan = StepPlan::new(0.0, vec![Phase { until, size: 0.1 }]).unwrap();
            for scheme in [DGM.into(), third.into(), Scheme::Bathe, Scheme::CentralDifferences] {
                let resolution = Resolution::new(&body, scheme, &plan).unwrap();
                let missed = resolution.unresolved(0.9, 0.1).unwrap();
                assert!((0.95..=1.0).contains(&missed.time), "{scheme} {until}: {missed}");
                assert_eq!(resolution.unresolved(0.1, 0.1), None, "{scheme} {until}");
            }
        }
    }
}

#[test]
fn a_resolved_oscillation_is_none_that_is_missed() {
    let omega = 2.0 * std::f64::consts::PI;
    let sine = TimeFunction::smooth("sine", move |t| [(omega * t).sin(), 0.0, 0.0]);
    for scheme in [DGM.into(), Scheme::CentralDifferences] {
        let resolution = resolution(&body(sine.clone(), Some(sine.clone())), scheme);
        for step in 0..20 {
            assert_eq!(resolution.unresolved(0.05 * step as f64, 0.05), None, "{scheme} {step}");
        }
    }
}

#[test]
fn adaptive_steps_shrink_until_they_resolve_loads_and_given_motions() {
    let at_rest = TimeFunction::smooth("zero", |_| [0.0; 3]);
    for (body, degree) in [
        (body(pulse(5.0, 0.01), None), 1),
        (body(at_rest.clone(), Some(pulse(5.0, 0.01))), 1),
        (body(at_rest, Some(pulse(5.0, 0.01))), 3),
    ] {
        let resolution = resolution(&body, TimeElement { degree, ..DGM });
        let size = resolution.resolved_size(4.0, 6.0, 1e-4, 1.0);
        assert!((0.4..1.0).contains(&size), "{size}");
        let size = resolution.resolved_size(4.99, 5.0, 1e-4, 1.0);
        assert!((1e-4..0.03).contains(&size), "{size}");
        assert_eq!(resolution.resolved_size(6.0, 4.0, 1e-4, 1.0), 4.0);
    }
}

#[test]
fn a_pulse_in_one_place_of_a_field_is_seen_by_calls_for_all_its_points() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use crate::input::Field;
    let calls = Arc::new(AtomicUsize::new(0));
    let count = calls.clone();
    let field = Field::of_points("pulse", move |points, time, values| {
        count.fetch_add(1, Ordering::Relaxed);
        for (value, point) in values.iter_mut().zip(points) {
            let pulse = (-((time - 5.13) / 0.01f64).powi(2)).exp();
            *value = [1.0, if point[1] > 1.0 { pulse } else { 0.0 }, 0.0];
        }
    });
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let load = Load::new(LoadKind::BodyForceField { group: None, field });
    let body = Body::builder(mesh).region(Region::new(rubber, 1.0)).load(load).build().unwrap();
    let resolution = resolution(&body, DGM);
    // Four times a panel, of 2^14 panels for 12 components.
    assert!(calls.swap(0, Ordering::Relaxed) < 4 * (1 << 14) / 12 + 8);
    let missed = resolution.unresolved(5.0, 0.5).unwrap();
    assert!((missed.time - 5.13).abs() < 0.01 && missed.target == SignalTarget::Load(0));
    assert_eq!(resolution.unresolved(5.5, 0.5), None);
}
