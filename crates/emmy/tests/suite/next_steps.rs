//! Steps of a plan one by one: the bits of a march, from wherever the motion is.

use emmy::body::{Body, InitialVelocity, Load, Region, TimeFunction};
use emmy::material::NeoHooke;
use emmy::mesh;
use emmy::motion::{Adaptivity, MarchError, Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;

use crate::shared::schemes::{DGM, assumed_strain, at, fe};
use crate::shared::watch::Watch;

fn plan(phases: &[(f64, f64)]) -> StepPlan {
    StepPlan::new(0.0, phases.iter().map(|&(until, size)| Phase { until, size }).collect()).unwrap()
}

/// Every bit of records, events and the last state.
fn bits(watch: &Watch, motion: &Motion<'_>) -> String {
    format!("{:?} {:?} {:?}", watch.records, watch.events, motion.state())
}

/// All steps of a plan one by one; the loop is left after some steps and taken up again.
fn pull(motion: &mut Motion<'_>, plan: &StepPlan, watch: &mut Watch, pause: usize) -> Vec<Record> {
    let mut records = Vec::new();
    for _ in 0..pause {
        records.extend(motion.next_step(plan, &mut [&mut *watch]).unwrap().cloned());
    }
    while let Some(record) = motion.next_step(plan, &mut [&mut *watch]).unwrap() {
        records.push(record.clone());
    }
    assert!(motion.next_step(plan, &mut [&mut *watch]).unwrap().is_none(), "a second loop is empty");
    records
}

fn assert_same(
    body: &Body,
    scheme: Scheme,
    settings: NewtonSettings,
    start: &InitialVelocity,
    plan: &StepPlan,
) {
    let motion = || {
        let state = State::initial(body, plan.start(), std::slice::from_ref(start)).unwrap();
        let mut motion = Motion::starting(body, scheme, settings, state).unwrap();
        motion.allow_cuts(None);
        motion
    };
    let (mut marched, mut expected) = (motion(), Watch::default());
    marched.march_on(plan, &mut [&mut expected]).unwrap();
    for pause in [0, 3] {
        let (mut pulled, mut watch) = (motion(), Watch::default());
        let records = pull(&mut pulled, plan, &mut watch, pause);
        assert_eq!(bits(&watch, &pulled), bits(&expected, &marched), "{scheme}");
        assert_eq!(format!("{records:?}"), format!("{:?}", expected.records));
        assert_eq!(pulled.time(), plan.end());
    }
}

#[test]
fn a_motion_before_its_plan_is_rejected() {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let body = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber).build().unwrap();
    let mut motion = Motion::new(&body, at(DGM, 1)).unwrap();
    let late = StepPlan::new(5.0, vec![Phase { until: 6.0, size: 0.1 }]).unwrap();
    let error = motion.next_step(&late, &mut []).unwrap_err().to_string();
    assert!(error.contains("it begins at t = 5, and the motion is at t = 0"), "{error}");
    assert_eq!(motion.time(), 0.0);
}

fn spin() -> InitialVelocity {
    InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], about: [0.5, 1.0, 0.5], ..Default::default() }
}

/// A body with initial velocities that invert its cells within a large step.
fn violent() -> (Body, InitialVelocity) {
    let soft = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 1.0);
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap()).region(soft).build().unwrap();
    let gradient = [[0.0, 9.0, 0.0], [-3.0, -6.0, 0.0], [0.0, 0.0, 5.0]];
    (body, InitialVelocity { gradient, about: [0.5, 1.0, 0.5], ..Default::default() })
}

#[test]
fn a_loop_of_steps_has_the_bits_of_a_march() {
    let push = TimeFunction::of_times("sin", |times, values| {
        values.iter_mut().zip(times).for_each(|(value, t)| *value = (9.0 * t).sin());
    });
    let load = Load::traction("y-max", [0.0, 3.0, 4.0]).with_time_function(push);
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.7);
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(mesh).region(rubber).load(load).build().unwrap();
    let steps = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for (scheme, degree) in
        [(DGM, 1), (assumed_strain(3), 2), (Scheme::Bathe, 1), (Scheme::CentralDifferences, 1)]
    {
        assert_same(&body, at(scheme, degree), NewtonSettings::default(), &spin(), &steps);
    }
    let adaptivity = Adaptivity { largest: 0.2, ..Adaptivity::new(1e-4) };
    let adaptive = StepPlan::adaptive(0.0, 0.5, adaptivity).unwrap().with_end_at(0.31).with_interval(0.06);
    assert_same(&body, at(DGM, 2), NewtonSettings::default(), &spin(), &adaptive.unwrap());
}

#[test]
fn a_loop_goes_through_the_substeps_of_steps_that_are_cut() {
    let (body, start) = violent();
    let settings = NewtonSettings { max_iterations: 8, ..NewtonSettings::default() };
    assert_same(&body, at(fe(1), 1), settings, &start, &plan(&[(4.0, 0.5)]));
}

/// A body whose critical step is below that of the plan.
fn explicit() -> Body {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.7);
    Body::builder(mesh::block([1.0; 3], [2; 3]).unwrap()).region(rubber).build().unwrap()
}

#[test]
fn a_step_that_begins_inside_a_planned_one_ends_with_it_even_if_it_is_cut() {
    let body = explicit();
    let plan = plan(&[(0.4, 0.1)]);
    let mut motion = Motion::new(&body, Scheme::CentralDifferences).unwrap();
    motion.allow_cuts(None);
    motion.step(0.001).unwrap();
    let mut sizes = Vec::new();
    while motion.time() < 0.1 {
        sizes.push(motion.next_step(&plan, &mut []).unwrap().unwrap().step_size);
    }
    // Equal substeps fill the rest of the planned step.
    assert_eq!(motion.time(), 0.1);
    let halvings = |size: &f64| (0.099 / size).log2();
    assert!(
        sizes.len() > 1 && sizes.iter().all(|size| (halvings(size) - halvings(size).round()).abs() < 1e-12)
    );
    assert!((sizes.iter().sum::<f64>() - 0.099).abs() < 1e-15, "{sizes:?}");
    // A step by hand in between.
    motion.next_step(&plan, &mut []).unwrap();
    motion.step(0.0003).unwrap();
    while motion.time() < 0.2 {
        motion.next_step(&plan, &mut []).unwrap();
    }
    assert_eq!(motion.time(), 0.2);
}

#[test]
fn after_a_step_that_failed_the_motion_goes_on() {
    let body = explicit();
    let plan = plan(&[(0.4, 0.1)]);
    let mut motion = Motion::new(&body, Scheme::CentralDifferences).unwrap();
    let start = motion.state().clone();
    assert!(matches!(motion.next_step(&plan, &mut []), Err(MarchError::Step(_))));
    assert_eq!(motion.state(), &start);
    motion.allow_cuts(None);
    assert!(motion.next_step(&plan, &mut []).unwrap().unwrap().cuts > 0);
    // Another plan, from here on.
    let other =
        StepPlan::new(motion.time(), vec![Phase { until: motion.time() + 0.05, size: 0.005 }]).unwrap();
    motion.march_on(&other, &mut []).unwrap();
    assert!(motion.time() == other.end() && motion.record().step_size <= 0.005 * (1.0 + 1e-6));
}
