//! Tests of step plans.

use proptest::prelude::*;

use super::*;

fn plan(phases: &[(f64, f64)]) -> Result<StepPlan> {
    StepPlan::new(0.0, phases.iter().map(|&(until, size)| Phase { until, size }).collect())
}

#[test]
fn steps_that_are_lost_in_the_rounding_of_the_time_are_rejected() {
    for phases in [
        [(1.0, 0.1), (1.000000000000001, 1e-16)],
        [(1e17, 1e15), (2e17, 10.0)],
        [(1000.0, 1.0), (1001.0, 1e-13)],
    ] {
        assert!(matches!(plan(&phases), Err(Error::Plan { phase: 1, .. })), "{phases:?}");
    }
    // A last step of 1e-15 is merged with the previous one.
    let ends: Vec<f64> =
        plan(&[(1.0, 0.5), (1.0 + 3e-9 + 1e-15, 1e-9)]).unwrap().steps().map(|step| step.size).collect();
    assert!(ends.iter().all(|&size| size > 0.5e-9), "{ends:?}");
}

/// Steps from a time on, by a scan of all steps.
fn scanned(plan: &StepPlan, time: f64) -> Vec<PlannedStep> {
    plan.steps().skip_while(|step| step.end - time <= plan.same_time(step.size)).collect()
}

proptest! {
    #[test]
    fn the_place_of_a_time_is_that_of_a_scan(
        start in prop::sample::select(vec![0.0, -3.7, 1e6, 0.1]),
        phases in prop::collection::vec((0.05..3.0, 0.01..1.7), 1..5),
        at in 0.0..1.2,
        near in prop::sample::select(vec![0.0, 1e-7, -1e-7, 1e-5, -1e-5, 1e-12, -1e-12]),
        step in 0usize..400,
        adaptive in any::<bool>(),
    ) {
        let mut until: f64 = start;
        let phases: Vec<Phase> = phases
            .into_iter()
            .map(|(length, size): (f64, f64)| {
                until += length;
                Phase { until, size }
            })
            .collect();
        let mut plan = StepPlan::new(start, phases).unwrap();
        if adaptive {
            plan.adaptivity = Some(Adaptivity::new(1e-3));
        }
        // Any time, and times at and beside the ends of steps.
        let steps: Vec<PlannedStep> = plan.steps().collect();
        let own = steps[step % steps.len()];
        for time in [start + at * (until - start), own.end + near * own.size, own.start, start - 1.0] {
            let found: Vec<PlannedStep> = plan.steps_from(time).collect();
            prop_assert_eq!(found, scanned(&plan, time), "{} of {:?}", time, plan);
        }
    }
}

#[test]
fn the_place_in_a_plan_of_a_million_million_steps_is_found_at_once() {
    let plan = plan(&[(1e6, 1e-6), (2e6, 2e-6)]).unwrap();
    for (time, start, size) in [(123_456.789, 123_456.789, 1e-6), (1_500_000.0, 1_500_000.0, 2e-6)] {
        let step = plan.steps_from(time).next().unwrap();
        assert!((step.start - start).abs() < 1e-9 && (step.size / size - 1.0).abs() < 1e-4, "{step:?}");
    }
    assert_eq!(plan.steps_from(2e6).next(), None);
}

#[test]
fn rounding_makes_no_extra_step() {
    for (until, size, n) in [(1.0, 0.01, 100), (0.3, 0.1, 3), (4.0, 0.04, 100), (1.0, 1e-4, 10_000)] {
        let plan = plan(&[(until, size)]).unwrap();
        assert_eq!(plan.n_steps(), n);
        assert!(plan.steps().all(|step| step.size == size));
        assert_eq!(plan.steps().last().unwrap().end, until);
    }
}

#[test]
fn every_multiple_of_an_interval_is_met_or_named() {
    let steps = |phases: &[(f64, f64)], interval: f64| plan(phases).unwrap().with_interval(interval);
    let good = steps(&[(0.3, 0.1), (0.5, 0.05), (2.0, 0.02)], 0.1).unwrap();
    let outputs = good.steps().filter(|step| good.is_output(step.end)).count();
    assert_eq!(outputs, 20);
    // 0.25 + i 0.1 are not multiples of 0.1; the end of a phase is met for any size.
    let missed = |phases, interval| steps(phases, interval).unwrap_err().to_string();
    assert!(missed(&[(0.25, 0.05), (1.0, 0.1)], 0.1).contains("steps of 0.1 miss t = 0.3"));
    assert!(missed(&[(1.0, 0.03)], 0.1).contains("steps of 0.03 miss t = 0.1"));
    assert!(steps(&[(0.1, 0.03), (0.2, 0.04)], 0.1).is_ok());
    assert!(steps(&[(1.0, 0.1)], 5.0).is_ok() && steps(&[(1.0, 0.1)], 0.0).is_err());
    let twice = good.with_size_from(0.5, 0.01).unwrap();
    assert_eq!(twice.interval(), Some(0.1));
}

#[test]
fn outputs_follow_each_other_without_gaps() {
    let plan = StepPlan::adaptive(0.7, 1e4, Adaptivity::new(1e-3)).unwrap().with_interval(0.1).unwrap();
    let mut time = 0.7;
    for n in 1..=90_000 {
        time = plan.next_output(time).unwrap();
        assert_eq!(time, 0.7 + f64::from(n) * 0.1);
        assert!(plan.is_output(time) && !plan.is_output(time + 0.04));
        // Up to rounding, unchanged at the end of a phase.
        assert!(plan.next_output(time.next_down()).unwrap() > time + 0.05);
    }
}

#[test]
fn bad_plans_are_rejected() {
    assert!(matches!(plan(&[(1.0, 0.1), (0.5, 0.1)]), Err(Error::Plan { phase: 1, .. })));
    assert!(plan(&[(1.0, 0.0)]).is_err() && plan(&[(1.0, f64::NAN)]).is_err() && plan(&[]).is_err());
    assert!(plan(&[(0.0, 0.1)]).is_err() && plan(&[(f64::INFINITY, 0.1)]).is_err());
}
