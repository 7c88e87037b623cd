//! A motion resumed from a snapshot equals the motion itself, bit for bit; failed steps are cut and grow back.

use emmy::body::{
    Body, Formulation, InitialVelocity, Load, LoadKind, Region, Support, TimeFunction, Viscosity,
};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::Solver;
use emmy::motion::{EventKind, MarchError, Motion, NewtonSettings, Phase, Record, Snapshot, State, StepPlan};
use emmy::time::Scheme;
use emmy::{Error, mesh};

use crate::shared::schemes::{DGM, assumed_strain, at, fe, lobatto};
use crate::shared::watch::Watch;

fn plan(phases: &[(f64, f64)]) -> StepPlan {
    StepPlan::new(0.0, phases.iter().map(|&(until, size)| Phase { until, size }).collect()).unwrap()
}

/// Every bit of the records and the last state, also of NaN and -0.
fn bits(records: &[Record], state: &State) -> String {
    format!("{records:?} {state:?}")
}

/// One motion without interruption, and in two parts with a snapshot after each of some steps.
fn assert_same(
    body: &Body,
    (scheme, degree): (Scheme, usize),
    settings: NewtonSettings,
    spin: &InitialVelocity,
    plan: &StepPlan,
) {
    let what = format!("{scheme} k = {degree} {:?}", settings.solver);
    let state = || State::initial(body, 0.0, std::slice::from_ref(spin)).unwrap();
    let n = plan.n_steps();
    for after in [0, 1, n / 2, n - 1] {
        let mut whole = Watch { snapshot_after: Some(after), ..Watch::default() };
        let mut motion = Motion::starting(body, at(scheme, degree), settings, state()).unwrap();
        motion.allow_cuts(None);
        motion.march(plan, &mut [&mut whole]).unwrap_or_else(|error| panic!("{what}: {error}"));
        let index = whole.records.iter().position(|record| record.step == after).unwrap();
        let snapshot = whole.snapshot.take().unwrap();
        let mut rest = Watch::default();
        let mut resumed = Motion::resumed(body, at(scheme, degree), settings, snapshot.clone()).unwrap();
        assert_eq!(resumed.snapshot(), snapshot, "{what}");
        resumed.allow_cuts(None);
        resumed.march_on(plan, &mut [&mut rest]).unwrap();
        let (own, expected) =
            (bits(&rest.records, resumed.state()), bits(&whole.records[index + 1..], motion.state()));
        assert!(own == expected, "{what}, from step {after}:\n{own:.2000}\n{expected:.2000}");
    }
}

fn spin() -> InitialVelocity {
    InitialVelocity {
        angular_velocity: [1.0, 2.0, -1.0],
        about: [0.5, 1.0, 0.5],
        gradient: [[0.5, 0.2, 0.0], [0.0, -0.4, 0.1], [0.2, 0.0, 0.3]],
        ..Default::default()
    }
}

fn settings(solver: Solver) -> NewtonSettings {
    NewtonSettings { solver, ..NewtonSettings::default() }
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.7)
}

fn table(entries: &[(f64, f64)]) -> TimeFunction {
    TimeFunction::new(entries.to_vec()).unwrap()
}

fn force() -> Load {
    let kind = LoadKind::Force { group: "y-max".into(), force: [0.0, 30.0, 40.0] };
    Load { kind, time_function: table(&[(0.05, 0.0), (0.21, 1.0), (0.21, 0.3)]) }
}

#[test]
fn every_time_element_resumes_bit_for_bit() {
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(block()).region(rubber()).load(force()).build().unwrap();
    let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for degree in 1..=3 {
        let schemes = [fe(degree + 1), assumed_strain(degree + 2), DGM, lobatto(degree + 1)];
        for scheme in schemes {
            for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
                assert_same(&body, (scheme, degree), settings(solver), &spin(), &plan);
            }
        }
    }
}

#[test]
fn damped_bodies_and_schemes_that_dissipate_go_on_in_every_bit() {
    let viscosity = Viscosity { time: 0.01, shear: 0.5, bulk: 0.1 };
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let damped = Body::builder(block())
        .region(rubber().with_viscosity(viscosity))
        .load(force())
        .drag(0.3)
        .build()
        .unwrap();
    let free = Body::builder(block()).region(rubber()).load(force()).build().unwrap();
    let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for (text, degree) in [("DGM", 1), ("FE(1)", 1), ("AS(3)", 2), ("DGM(0.5)", 1), ("AS(4, 0.2)", 2)] {
        for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
            for body in [&damped, &free] {
                assert_same(body, (text.parse().unwrap(), degree), settings(solver), &spin(), &plan);
            }
        }
    }
}

#[test]
fn every_classic_stepper_resumes_bit_for_bit() {
    let held = Support { group: "y-min".into(), fix: [true; 3], ..Default::default() };
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    for supports in [vec![], vec![held]] {
        let spin = if supports.is_empty() { spin() } else { InitialVelocity::default() };
        let body = Body::builder(block()).region(rubber()).supports(&supports).load(force()).build().unwrap();
        for scheme in ["Newmark(0.3, 0.6)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe"] {
            for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
                let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
                assert_same(&body, (scheme.parse().unwrap(), 1), settings(solver), &spin, &plan);
            }
        }
        // More steps than lie between two estimates of the critical one.
        let plan = plan(&[(0.08, 1e-3)]);
        assert_same(&body, (Scheme::CentralDifferences, 1), settings(Solver::Auto), &spin, &plan);
    }
}

#[test]
fn a_stiff_rotating_body_resumes_bit_for_bit() {
    let stiff = Region::new(SaintVenantKirchhoff::new(1e6, 1e6).unwrap(), 1.5);
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap()).region(stiff).build().unwrap();
    let spin = InitialVelocity { gradient: [[0.0; 3]; 3], ..spin() };
    for degree in [1, 2] {
        let plan = plan(&[(1.0, 0.1)]);
        for scheme in [DGM, assumed_strain(degree + 2)] {
            assert_same(&body, (scheme, degree), settings(Solver::Auto), &spin, &plan);
        }
    }
}

#[test]
fn supports_that_move_and_are_released_go_on_in_every_bit() {
    let shaken = Support {
        group: "y-min".into(),
        displacement: [Some(table(&[(0.0, 0.0), (0.11, 0.05), (0.3, -0.05)])), None, None],
        ..Default::default()
    };
    let released = Support { group: "y-max".into(), fix: [true; 3], until: Some(0.2), ..Default::default() };
    let mesh = mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body =
        Body::builder(mesh).region(rubber()).support(shaken).support(released).load(force()).build().unwrap();
    for degree in [1, 2] {
        for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
            let plan = plan(&[(0.2, 0.03), (0.4, 0.07)]);
            let rest = InitialVelocity::default();
            assert_same(&body, (DGM, degree), settings(solver), &rest, &plan);
        }
    }
}

/// One scheme of each family with degrees, and a solver.
fn families() -> Vec<(Scheme, usize, Solver)> {
    let degrees: [(&str, &[usize]); 11] = [
        ("FE(2)", &[1, 2]),
        ("AS(3)", &[1, 2]),
        ("DGM", &[1, 2, 3]),
        ("Lobatto(3)", &[2]),
        ("trapezoidal", &[1]),
        ("DGM(0.5)", &[1, 2]),
        ("AS(4, 0.2)", &[2]),
        ("Newmark(0.3, 0.6)", &[1]),
        ("HHT(0.05)", &[1]),
        ("generalized-alpha(0.8)", &[1]),
        ("Bathe", &[1]),
    ];
    let of = |(text, degrees): (&str, &[usize])| {
        let scheme: Scheme = text.parse().unwrap();
        let both =
            degrees.iter().flat_map(|degree| [(*degree, Solver::Direct), (*degree, Solver::Iterative)]);
        both.map(|(degree, solver)| (scheme, degree, solver)).collect::<Vec<_>>()
    };
    degrees.into_iter().flat_map(of).collect()
}

fn pressure() -> Load {
    let kind = LoadKind::Pressure { group: "x-max".into(), pressure: 40.0 };
    Load { kind, time_function: table(&[(0.0, 1.0), (0.3, 0.6), (0.4, 0.0)]) }
}

#[test]
fn a_free_body_under_pressure_resumes_bit_for_bit() {
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(block()).region(rubber()).load(pressure()).load(force()).build().unwrap();
    // The pressure ends at 0.4: it must have no effect on later steps.
    let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for (scheme, degree, solver) in families() {
        assert_same(&body, (scheme, degree), settings(solver), &spin(), &plan);
    }
}

#[test]
fn a_released_body_under_pressure_resumes_bit_for_bit() {
    let released = Support { group: "y-max".into(), fix: [true; 3], until: Some(0.12), ..Default::default() };
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let body = Body::builder(block()).region(rubber()).support(released).load(pressure()).build().unwrap();
    let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for (scheme, degree, solver) in families() {
        assert_same(&body, (scheme, degree), settings(solver), &InitialVelocity::default(), &plan);
    }
}

/// The modes of cells are part of the state: in free flight, and released with a velocity of their own.
#[test]
fn incompatible_modes_resume_bit_for_bit() {
    let released = Support { group: "y-max".into(), fix: [true; 3], until: Some(0.12), ..Default::default() };
    let block = || mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    let with_modes = || rubber().with_formulation(Formulation::IncompatibleModes);
    let bodies = [
        (Body::builder(block()).region(with_modes()).load(force()).build().unwrap(), spin()),
        (
            Body::builder(block()).region(with_modes()).support(released).load(pressure()).build().unwrap(),
            InitialVelocity::default(),
        ),
    ];
    let plan = plan(&[(0.2, 0.03), (0.5, 0.07)]);
    for (body, start) in &bodies {
        for (scheme, degree, solver) in families() {
            assert_same(body, (scheme, degree), settings(solver), start, &plan);
        }
    }
}

/// A body with initial velocities that invert its cells within a large step.
fn violent() -> (Body, InitialVelocity) {
    let soft = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 1.0);
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap()).region(soft).build().unwrap();
    let gradient = [[0.0, 9.0, 0.0], [-3.0, -6.0, 0.0], [0.0, 0.0, 5.0]];
    (body, InitialVelocity { gradient, about: [0.5, 1.0, 0.5], ..Default::default() })
}

#[test]
fn a_step_that_fails_is_cut_and_grows_back() {
    let (body, start) = violent();
    let plan = plan(&[(4.0, 0.5)]);
    let settings = NewtonSettings { max_iterations: 8, ..NewtonSettings::default() };
    let state = || State::initial(&body, 0.0, std::slice::from_ref(&start)).unwrap();
    let motion = || Motion::starting(&body, at(fe(1), 1), settings, state()).unwrap();
    let failed = motion().march(&plan, &mut []);
    assert!(matches!(failed, Err(MarchError::Step(_))), "the step must fail by itself");
    let (mut watch, mut cut) = (Watch::default(), motion());
    cut.allow_cuts(None);
    cut.march(&plan, &mut [&mut watch]).unwrap();
    let of = |kind| watch.events.iter().filter(|event| event.kind == kind).count();
    assert!(of(EventKind::Cut) > 0 && of(EventKind::Grown) > 0, "{:?}", watch.events);
    assert_eq!(watch.records.iter().map(|record| record.cuts).sum::<usize>(), of(EventKind::Cut));
    // Every time of the plan is exactly the end of a step, and all sizes are planned sizes over powers of two.
    for step in plan.steps() {
        assert!(watch.records.iter().any(|record| record.time == step.end), "{}", step.end);
    }
    let sizes = watch.records[1..].iter().map(|record| 0.5 / record.step_size);
    assert!(sizes.clone().all(|n| n.log2().fract() == 0.0 && n <= 1024.0));
    assert!(sizes.clone().fold(0.0, f64::max) > 1.0);
    // In the middle of a divided step as well as between two.
    for after in 0..watch.records.len() - 1 {
        let (mut whole, mut rest) =
            (Watch { snapshot_after: Some(after), ..Watch::default() }, Watch::default());
        let mut motion = motion();
        motion.allow_cuts(None);
        motion.march(&plan, &mut [&mut whole]).unwrap();
        let snapshot = whole.snapshot.unwrap();
        let mut resumed = Motion::resumed(&body, at(fe(1), 1), settings, snapshot).unwrap();
        resumed.allow_cuts(None);
        resumed.march_on(&plan, &mut [&mut rest]).unwrap();
        let expected = bits(&whole.records[after + 1..], motion.state());
        assert!(bits(&rest.records, resumed.state()) == expected, "from step {after}");
    }
}

#[test]
fn cuts_end_at_the_smallest_step() {
    let (body, start) = violent();
    let settings = NewtonSettings { max_iterations: 1, tolerance: 1e-15, ..NewtonSettings::default() };
    let state = State::initial(&body, 0.0, &[start]).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 1), settings, state).unwrap();
    motion.allow_cuts(Some(0.1));
    let mut watch = Watch::default();
    let failed = motion.march(&plan(&[(2.0, 0.5)]), &mut [&mut watch]);
    let Err(MarchError::Step(Error::SmallestStep { step: 1, start, step_size, .. })) = failed else {
        panic!("{failed:?}")
    };
    assert_eq!((start, step_size, watch.events.len()), (0.0, 0.125, 2));
}

#[test]
fn central_differences_are_cut_below_their_critical_step() {
    let body = Body::builder(mesh::block([1.0; 3], [2; 3]).unwrap()).region(rubber()).build().unwrap();
    let state = State::initial(&body, 0.0, &[spin()]).unwrap();
    let mut motion =
        Motion::starting(&body, at(Scheme::CentralDifferences, 1), NewtonSettings::default(), state).unwrap();
    motion.allow_cuts(None);
    let mut watch = Watch::default();
    motion.march(&plan(&[(0.4, 0.1)]), &mut [&mut watch]).unwrap();
    assert!(watch.records.iter().any(|record| record.cuts > 0));
    assert_eq!(motion.state().time, 0.4);
}

#[test]
fn a_memory_of_another_body_is_rejected() {
    let body = |n| Body::builder(mesh::block([1.0; 3], [n; 3]).unwrap()).region(rubber()).build().unwrap();
    let (small, large) = (body(1), body(2));
    let motion = |body| {
        let state = State::initial(body, 0.0, &[]).unwrap();
        Motion::starting(body, at(DGM, 1), NewtonSettings::default(), state).unwrap()
    };
    let of_small = motion(&small).snapshot();
    let snapshot = Snapshot { state: motion(&large).state().clone(), ..of_small };
    let failed = Motion::resumed(&large, at(DGM, 1), NewtonSettings::default(), snapshot);
    assert!(matches!(failed, Err(Error::Memory { .. })), "{failed:?}");
}
