//! Loads and given motions by functions of many points or times; values that are not numbers.

use std::sync::Arc;
use std::sync::Mutex;

use emmy::body::{
    Body, Field, InitialVelocity, Load, LoadKind, PointMass, PointTerms, Region, Support, TimeFunction,
};
use emmy::material::NeoHooke;
use emmy::mesh::MeshBuilder;
use emmy::motion::{Adaptivity, MarchError, Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::Scheme;
use emmy::{Error, mesh};

use crate::shared::schemes::{DGM, at};

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 3.0)
}

fn body(loads: Vec<Load>, supports: Vec<Support>) -> Body {
    let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
    Body::builder(mesh).region(rubber()).loads(loads).supports(supports).build().unwrap()
}

fn of_times(law: impl Fn(f64) -> f64 + Send + Sync + 'static) -> TimeFunction {
    TimeFunction::of_times("law", move |times, values| {
        values.iter_mut().zip(times).for_each(|(value, &time)| *value = law(time));
    })
}

fn motion(body: &Body, scheme: Scheme) -> Motion<'_> {
    let state = State::initial(body, 0.0, &[]).unwrap();
    Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap()
}

#[test]
fn a_field_of_all_points_has_the_bits_of_a_field_of_one_and_is_called_once_a_time() {
    let law = |x: [f64; 3], t: f64| [x[1] * t, (x[0] + t).sin(), 0.3];
    let calls = Arc::new(Mutex::new(Vec::new()));
    let noted = calls.clone();
    let at_once = Field::of_points("", move |points, time, values| {
        noted.lock().unwrap().push(points.len());
        values.iter_mut().zip(points).for_each(|(value, &x)| *value = law(x, time));
    });
    let one_by_one = Field::new(law);
    let loaded = |field: Field| {
        let history = of_times(|t| 1.0 + t);
        let kind = LoadKind::TractionField { group: "y-max".into(), field: field.clone() };
        let body_force = LoadKind::BodyForceField { group: None, field };
        body(vec![Load { kind, time_function: history }, Load::new(body_force)], vec![])
    };
    let bodies = [loaded(at_once), loaded(one_by_one)];
    for degree in [1, 3] {
        let mut motions = bodies.each_ref().map(|body| motion(body, at(DGM, degree)));
        calls.lock().unwrap().clear();
        for _ in 0..3 {
            motions.iter_mut().for_each(|motion| motion.step(0.05).map(|_| ()).unwrap());
        }
        assert_eq!(format!("{:?}", motions[0].state()), format!("{:?}", motions[1].state()));
        // k + 4 Gauss points a step; 4 points on one facet, 8 in each of two cells.
        let calls = calls.lock().unwrap();
        let of = |n: usize| calls.iter().filter(|&&own| own == n).count();
        assert_eq!((of(4), of(16), calls.len()), (3 * (degree + 4), 3 * (degree + 4), 6 * (degree + 4)));
    }
}

#[test]
fn a_constant_acceleration_field_is_an_acceleration() {
    let with = |kind: LoadKind| {
        let block = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
        let mut mesh = MeshBuilder::new();
        let nodes: Vec<u32> = block.points().iter().map(|&x| mesh.point(x)).collect();
        for (cell, name) in block.cells().zip(["low", "high"]) {
            let index = mesh.cell(cell.kind, cell.nodes).unwrap();
            mesh.cell_group(name, [index]);
        }
        mesh.node_group("corner", [nodes[0]]);
        let rubber = |density: f64| Region::new(NeoHooke::new(10.0, 5.0).unwrap(), density);
        let masses = vec![PointMass { group: "corner".into(), mass: 5.0 }];
        Body::builder(mesh.build().unwrap())
            .region(rubber(3.0).on("low"))
            .region(rubber(7.0).on("high"))
            .point_terms(PointTerms { masses, ..Default::default() })
            .load(Load::new(kind))
            .build()
            .unwrap()
    };
    let g = [1.0, -2.0, 0.5];
    for (group, mass) in [(None, 15.0), (Some("high".to_string()), 7.0)] {
        let field = Field::new(move |_, _| g);
        let by_field = with(LoadKind::AccelerationField { group: group.clone(), field });
        let constant = with(LoadKind::Acceleration { group, acceleration: g });
        let mut forces = [vec![0.0; by_field.n_dofs()], vec![0.0; by_field.n_dofs()]];
        assert!(by_field.loads_at(0.0, &mut forces[0]).unwrap());
        assert!(constant.loads_at(0.0, &mut forces[1]).unwrap());
        assert!(forces[0].iter().zip(&forces[1]).all(|(a, b)| (a - b).abs() < 1e-14));
        let force = by_field.load_resultants()[0].force;
        assert!((0..3).all(|i| (force[i] - mass * g[i]).abs() < 1e-13), "{force:?}");
    }
    // integral rho y^2 over both halves, 3/3 + 7 (8 - 1)/3; the point mass lies at y = 0.
    let square = Field::new(|x, t| [t * x[1] * x[1], 0.0, 0.0]);
    let body = with(LoadKind::AccelerationField { group: None, field: square });
    let mut force = vec![0.0; body.n_dofs()];
    body.loads_at(2.0, &mut force).unwrap();
    let sum: f64 = force.iter().step_by(3).sum();
    assert!((sum - 2.0 * (1.0 + 49.0 / 3.0)).abs() < 1e-13, "{sum}");
}

#[test]
fn a_frame_that_accelerates_is_a_body_at_rest() {
    // A field that is the centrifugal acceleration w^2 r of all masses: total force m w^2 c of the mass centre.
    let field = Field::of_points("4 r", |points, _, values| {
        values.iter_mut().zip(points).for_each(|(value, x)| *value = [4.0 * x[0], 4.0 * x[1], 0.0]);
    });
    let body = body(vec![Load::new(LoadKind::AccelerationField { group: None, field })], vec![]);
    let mut motion = motion(&body, at(DGM, 2));
    let record = motion.step(0.001).unwrap();
    // p = m w^2 c t, with m = 6 and c = (0.5, 1, 0.5).
    let p = record.linear_momentum;
    assert!(
        (p[0] - 6.0 * 4.0 * 0.5 * 0.001).abs() < 1e-12 && (p[1] - 6.0 * 4.0 * 0.001).abs() < 1e-12,
        "{p:?}"
    );
}

/// The fault of the first step that fails: what and when; the motion is then at the last good step.
fn fault(mut motion: Motion<'_>, plan: &StepPlan) -> (String, f64) {
    motion.allow_cuts(None);
    let mut last = motion.state().clone();
    loop {
        match motion.next_step(plan, &mut []) {
            Ok(Some(_)) => last = motion.state().clone(),
            Ok(None) => panic!("no step failed"),
            Err(MarchError::Step(Error::NotFiniteAt { what, time, value })) => {
                assert!(!value.is_finite());
                assert_eq!(motion.state(), &last);
                assert!(time >= last.time && time <= last.time + 0.05 + 1e-12, "{time} after {}", last.time);
                return (what, time);
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn a_value_that_is_no_number_fails_the_step_and_names_load_and_time() {
    let late = || of_times(|t| if t > 0.22 { f64::NAN } else { t });
    let good = || Load::force("y-max", [1.0, 0.0, 0.0]);
    let undefined =
        Field::named("1/0", |x, t| [1.0, if t > 0.22 && x[0] > 0.5 { 1.0 / 0.0 } else { 0.0 }, 0.0]);
    let field = |kind: fn(Field) -> LoadKind| Load::new(kind(undefined.clone()));
    let loads = [
        (good().with_time_function(late()), "load 1 (\"law\")"),
        (Load::pressure("y-max", 1.0).with_time_function(late()), "load 1 (\"law\")"),
        (field(|field| LoadKind::BodyForceField { group: None, field }), "load 1 (\"1/0\") at ["),
        (field(|field| LoadKind::AccelerationField { group: None, field }), "load 1 (\"1/0\") at ["),
        (
            Load::new(LoadKind::TractionField { group: "y-max".into(), field: Field::new(|_, _| [1.0; 3]) })
                .with_time_function(late()),
            "load 1 (\"law\")",
        ),
    ];
    let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.05 }]).unwrap();
    let small = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.005 }]).unwrap();
    let adaptivity = Adaptivity { largest: 0.05, ..Adaptivity::new(1e-3) };
    let adaptive = StepPlan::adaptive(0.0, 1.0, adaptivity).unwrap();
    for (load, name) in loads {
        let body = body(vec![good(), load], vec![]);
        for (scheme, plan) in [
            ("DGM", &plan),
            ("DGM", &adaptive),
            ("AS(3)", &plan),
            ("FE(1)", &plan),
            ("Newmark(0.25, 0.5)", &plan),
            ("Bathe", &plan),
            ("central-differences", &small),
        ] {
            let (what, time) = fault(motion(&body, scheme.parse().unwrap()), plan);
            assert!(what.starts_with(name) && time > 0.22 && time < 0.3, "{scheme}: {what} {time}");
        }
    }
}

#[test]
fn a_given_motion_that_is_no_number_fails_the_step_and_names_its_support() {
    let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.05 }]).unwrap();
    let cut = |t: f64, value: f64| if t > 0.22 { f64::NAN } else { value };
    let moved = of_times(move |t| cut(t, 0.1 * t)).with_rate(|_, rates| rates.fill(0.1));
    let rate = of_times(|t| 0.1 * t).with_rate(move |times, rates| {
        rates.iter_mut().zip(times).for_each(|(rate, &t)| *rate = cut(t, 0.1));
    });
    for function in [moved, rate] {
        let still = Support::driven(
            "y-max",
            [Some(of_times(|_| 0.0).with_rate(|_, rates| rates.fill(0.0))), None, None],
        );
        // Released before: the others keep their numbers.
        let first = Support::of_components("y-max", [false, false, true]).until(0.1);
        let supports = vec![first, still, Support::driven("y-min", [Some(function), None, None])];
        let body = body(vec![], supports);
        let (what, time) = fault(motion(&body, at(DGM, 2)), &plan);
        assert!(what == "moving support 2 (\"law\")" && time > 0.22 && time < 0.3, "{what} {time}");
    }
}

#[test]
fn a_support_moves_by_a_function_of_many_times_only_if_it_has_a_rate() {
    let drive = |function: TimeFunction| {
        let mesh = mesh::block([1.0, 2.0, 1.0], [1, 2, 1]).unwrap();
        let support = Support::driven("y-min", [None, Some(function), None]);
        Body::builder(mesh).region(rubber()).support(support).build()
    };
    let shake = of_times(|t| 0.1 * (5.0 * t).sin().powi(2));
    let message = drive(shake.clone()).unwrap_err().to_string();
    assert!(
        message.contains("y-min") && message.contains("the rate of its motion \"law\" is not known"),
        "{message}"
    );
    let rate = |t: f64| 0.5 * (10.0 * t).sin();
    let shake = shake.with_rate(move |times, rates| {
        rates.iter_mut().zip(times).for_each(|(own, &t)| *own = rate(t));
    });
    let same = TimeFunction::smooth("law", move |t| [0.1 * (5.0 * t).sin().powi(2), rate(t), 0.0]);
    let bodies = [drive(shake).unwrap(), drive(same).unwrap()];
    let mut motions = bodies.each_ref().map(|body| motion(body, at(DGM, 2)));
    for _ in 0..5 {
        motions.iter_mut().for_each(|motion| motion.step(0.03).map(|_| ()).unwrap());
    }
    assert_eq!(format!("{:?}", motions[0].state()), format!("{:?}", motions[1].state()));
    let spin = InitialVelocity { velocity: [0.0, 1.0, 0.0], ..Default::default() };
    assert!(State::initial(&bodies[0], 0.0, &[spin]).is_ok());
}
