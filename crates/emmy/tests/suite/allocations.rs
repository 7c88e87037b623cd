//! A step allocates no memory after the first ones.

use allocation_counter::measure;
use emmy::body::{
    Body, Contact, Field, Formulation, InitialVelocity, Load, LoadKind, Obstacle, Region, Rotation, Support,
    TimeFunction, Viscosity,
};
use emmy::internals::time::LocalError;
use emmy::material::NeoHooke;
use emmy::mesh::{MeshBuilder, Placement};
use emmy::motion::{Motion, NewtonSettings, Phase, Solver, State, StepPlan};
use emmy::time::{Estimator, Scheme};

use crate::energy_formulas::formula;
use crate::shared::schemes::{DGM, at, element};

/// With driven nodes: a table and an expression, by time elements.
#[test]
fn a_step_with_supports_that_move_allocates_nothing() {
    let table = TimeFunction::new(vec![(0.0, 0.0), (0.105, 0.01), (1.13, 0.02), (2.0, 0.0)]).unwrap();
    let angle = TimeFunction::smooth("0.1 sin(9 t)", |t| [0.1 * (9.0 * t).sin(), 0.9 * (9.0 * t).cos(), 0.0]);
    let rotation = Some(Rotation { axis: [0.0, 1.0, 0.0], about: [0.5; 3], angle });
    let supports = [
        Support { group: "y-min".into(), rotation, ..Default::default() },
        Support { group: "y-max".into(), displacement: [Some(table), None, None], ..Default::default() },
    ];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body = pool.install(|| Body::builder(mesh).region(rubber).supports(&supports).build().unwrap());
    // In the pool: jobs from outside go through a queue that allocates now and then.
    pool.install(|| {
        for degree in 1..=3 {
            let state = State::initial(&body, 0.0, &[]).unwrap();
            let scheme = DGM;
            let mut motion =
                Motion::starting(&body, at(scheme, degree), NewtonSettings::default(), state).unwrap();
            let mut step = |_: usize| motion.step(0.01).map(|record| record.step).unwrap();
            assert_eq!((1..100).map(&mut step).last(), Some(99));
            let counts = measure(|| assert_eq!((100..120).map(&mut step).last(), Some(119)));
            assert_eq!(counts.count_total, 0, "degree {degree}");
        }
    });
}

#[test]
fn a_step_with_incompatible_modes_allocates_nothing_with_any_solver() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let rubber = rubber.with_formulation(Formulation::IncompatibleModes);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body = pool.install(|| Body::builder(mesh).region(rubber).build().unwrap());
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
        let state = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let settings = NewtonSettings { solver, ..NewtonSettings::default() };
        let mut motion = Motion::starting(&body, at(DGM, 2), settings, state).unwrap();
        let mut step = |_: usize| motion.step(0.01).map(|record| record.step).unwrap();
        assert_eq!((1..100).map(&mut step).last(), Some(99));
        let counts = measure(|| assert_eq!((100..120).map(&mut step).last(), Some(119)));
        assert_eq!(counts.count_total, 0, "{solver:?}");
    }
}

/// Steps of a plan one by one, under functions of many points and times.
#[test]
fn the_next_step_of_a_plan_allocates_nothing() {
    let sine = || {
        TimeFunction::of_times("sin", |times, values| {
            values.iter_mut().zip(times).for_each(|(value, t)| *value = (3.0 * t).sin());
        })
    };
    let field = || {
        Field::of_points("y", |points, t, values| {
            values.iter_mut().zip(points).for_each(|(value, x)| *value = [t * x[1], 0.0, 0.0]);
        })
    };
    let kinds = [
        LoadKind::AccelerationField { group: None, field: field() },
        LoadKind::TractionField { group: "y-max".into(), field: field() },
        LoadKind::Pressure { group: "x-max".into(), pressure: 2.0 },
        LoadKind::Force { group: "x-max".into(), force: [3.0, 0.0, 0.0] },
    ];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let loads = kinds.map(|kind| Load { kind, time_function: sine() });
    let body = pool.install(|| Body::builder(mesh).region(rubber).loads(loads).build().unwrap());
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.5, size: 0.01 }, Phase { until: 2.0, size: 0.015 }])
        .unwrap();
    pool.install(|| {
        for scheme in [at(DGM, 1), at(DGM, 3), Scheme::Bathe, "Newmark(0.25, 0.5)".parse().unwrap()] {
            let state = State::initial(&body, 0.0, &[]).unwrap();
            let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), state).unwrap();
            let mut step = |_: usize| motion.next_step(&plan, &mut []).unwrap().map(|record| record.step);
            assert_eq!((1..100).map(&mut step).last(), Some(Some(99)));
            let counts = measure(|| assert_eq!((100..120).map(&mut step).last(), Some(Some(119))));
            assert_eq!(counts.count_total, 0, "{scheme}");
        }
    });
}

/// Steps of a body that bounces under its weight, of a degree, allocate nothing; it touches in at least some of them.
fn assert_bounces_without_allocation(body: &Body, degree: usize, least: usize) {
    let state = State::initial(body, 0.0, &[]).unwrap();
    // Not the factorisation, which its crate allocates, and which the impacts renew.
    let settings = NewtonSettings { solver: Solver::Iterative, ..NewtonSettings::default() };
    let mut motion = Motion::starting(body, at(DGM, degree), settings, state).unwrap();
    let mut touched = 0;
    let mut step = |_: usize| {
        let record = motion.step(0.005).unwrap();
        touched += usize::from(record.contact_energy > 0.0);
        record.step
    };
    assert_eq!((1..1000).map(&mut step).last(), Some(999));
    let counts = measure(|| assert_eq!((1000..1060).map(&mut step).last(), Some(1059)));
    assert!(touched > least, "{touched}");
    assert_eq!(counts.count_total, 0, "degree {degree}");
}

/// A block that bounces on a plane.
#[test]
fn a_step_with_contact_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let floor = Obstacle::Plane { point: [0.0, -0.02, 0.0], normal: [0.0, 1.0, 0.0] };
    let mesh = emmy::mesh::block([1.0; 3], [2; 3]).unwrap();
    let weight = Load::acceleration([0.0, -10.0, 0.0]);
    let contact = Contact::with_obstacle("y-min", floor);
    let builder = Body::builder(mesh).region(rubber).contact(contact).load(weight);
    let body = pool.install(|| builder.build().unwrap());
    pool.install(|| (1..=2).for_each(|degree| assert_bounces_without_allocation(&body, degree, 500)));
}

/// A block that bounces on another one, which is held. It is turned a little: with edges exactly along each other, some
/// step has no solution.
#[test]
fn a_step_with_contact_between_bodies_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let block = |n: usize| emmy::mesh::block([1.0; 3], [n; 3]).unwrap();
    let mut builder = MeshBuilder::new();
    builder.part("lower", &block(2)).unwrap();
    let turned = Placement::default().turned([0.0, 1.0, 0.0], 1e-3, [0.5; 3]).unwrap();
    let above = turned.shifted([0.0, 1.02, 0.0]);
    builder.part("upper", &block(2).placed(&above).unwrap()).unwrap();
    let builder = Body::builder(builder.build().unwrap())
        .region(rubber)
        .contact(Contact::between("lower", "upper"))
        .support(Support::fixed("lower-y-min"))
        .load(Load::acceleration([0.0, -10.0, 0.0]));
    let body = pool.install(|| builder.build().unwrap());
    // The memory grows with the number of pairs; with this degree they are at their most before.
    pool.install(|| assert_bounces_without_allocation(&body, 1, 300));
}

#[test]
fn a_step_with_a_formula_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(formula([1000.0, 500.0]).unwrap(), 1.0);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body = pool.install(|| Body::builder(mesh).region(rubber).build().unwrap());
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 2), NewtonSettings::default(), state).unwrap();
    let mut step = |_: usize| motion.step(0.01).map(|record| record.step).unwrap();
    assert_eq!((1..100).map(&mut step).last(), Some(99));
    let counts = measure(|| assert_eq!((100..120).map(&mut step).last(), Some(119)));
    assert_eq!(counts.count_total, 0);
}

#[test]
fn an_estimate_of_the_error_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap();
    let body = pool.install(|| Body::builder(mesh).region(rubber).build().unwrap());
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    for (degree, estimator) in [
        (1, Estimator::Difference),
        (2, Estimator::Element),
        (1, Estimator::Residual),
        (2, Estimator::Residual),
        (2, Estimator::Sampled),
    ] {
        let (scheme, settings) = (DGM, NewtonSettings::default());
        let mut start = State::initial(&body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let mut error = LocalError::new(&body, element(scheme, degree), estimator, settings, &start).unwrap();
        let mut motion = Motion::starting(&body, at(scheme, degree), settings, start.clone()).unwrap();
        let mut step = |_: usize| {
            start.copy_from(motion.state());
            motion.step(0.01).unwrap();
            error.estimate(&start, motion.state(), motion.stepper().rates(), 0.01).unwrap();
            error.accept(0.01);
        };
        (1..100).for_each(&mut step);
        let counts = measure(|| (100..120).for_each(&mut step));
        assert_eq!(counts.count_total, 0, "{estimator:?}, degree {degree}");
    }
}

#[test]
fn a_step_allocates_nothing() {
    let load = Load {
        kind: LoadKind::Force { group: "x-max".into(), force: [3.0, 0.0, 0.0] },
        time_function: TimeFunction::new(vec![(0.0, 0.0), (0.105, 1.0)]).unwrap(),
    };
    let pressure = Load {
        kind: LoadKind::Pressure { group: "y-max".into(), pressure: 2.0 },
        time_function: TimeFunction::new(vec![(0.0, 0.0), (0.107, 1.0)]).unwrap(),
    };
    // One part: the thread pool would allocate for its own queues.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [2, 6, 2]).unwrap();
    let viscosity = Viscosity { time: 1e-3, ..Viscosity::default() };
    let viscous = vec![Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0).with_viscosity(viscosity)];
    let damped = pool.install(|| Body::builder(mesh.clone()).regions(viscous).drag(0.3).build().unwrap());
    let body = pool.install(|| Body::builder(mesh).region(rubber).load(load).load(pressure).build().unwrap());
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    let schemes = [
        ("DGM", 1, 0.01),
        ("DGM", 2, 0.01),
        ("Newmark(0.25, 0.5)", 1, 0.01),
        ("generalized-alpha(0.8)", 1, 0.01),
        ("Bathe", 1, 0.01),
        ("central-differences", 1, 0.002),
        ("DGM(0.5)", 1, 0.01),
        ("DGM", 1, 0.01),
        ("DGM", 2, 0.01),
    ];
    let n_undamped = schemes.len() - 2;
    for (index, (text, degree, size)) in schemes.into_iter().enumerate() {
        let body = if index < n_undamped { &body } else { &damped };
        let (scheme, settings) = (text.parse::<Scheme>().unwrap(), NewtonSettings::default());
        let state = State::initial(body, 0.0, std::slice::from_ref(&spin)).unwrap();
        let mut motion = Motion::starting(body, at(scheme, degree), settings, state).unwrap();
        let mut step = |_: usize| motion.step(size).map(|record| record.newton_iterations).unwrap();
        // Before counting begins, GMRES has had its longest iteration, and a refactorization has happened.
        (1..100).for_each(|i| {
            step(i);
        });
        let counts = measure(|| {
            (100..120).for_each(|i| {
                step(i);
            })
        });
        assert_eq!(counts.count_total, 0, "{text} degree {degree}");
    }
}
