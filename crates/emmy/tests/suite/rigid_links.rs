//! Rigid links: multipliers of constraints beside the rates.

#![allow(non_snake_case)]

use crate::shared::schemes::{DGM, at, dgm};
use emmy::body::{Formulation, TimeFunction, Viscosity};
use emmy::material::Link;
use emmy::mesh::MeshBuilder;
use emmy::motion::{NewtonSettings, Solver};
use emmy::prelude::*;

const GRAVITY: f64 = 9.81;

/// A mass of 2 on a rigid link of length 1 to the origin, 2.5 rad from the downward vertical, in the plane of x and z.
/// Its cell is a spring so soft that its force is rounding.
fn pendulum() -> Body {
    hung(Support::fixed("pivot"), to_origin)
}

/// The same in a medium with a drag.
fn pendulum_in(drag: f64) -> Body {
    hung_in(drag, Support::fixed("pivot"), to_origin)
}

/// A rigid link between two nodes of a mesh.
fn link_of(mesh: &Mesh, [a, b]: [u32; 2]) -> Joint {
    let [at, to] = [a, b].map(|node| mesh.points()[node as usize]);
    Joint::new("link", JointKind::Distance { to }, [JointEnd::Node(a), JointEnd::Node(b)], at)
}

/// A rigid link of a node to the origin.
fn to_origin(mesh: &Mesh, node: u32) -> Joint {
    let between = [JointEnd::Node(node), JointEnd::Ground];
    Joint::new("link", JointKind::Distance { to: [0.0; 3] }, between, mesh.points()[node as usize])
}

/// The same on a link of a kind, with a pivot under a support.
fn hung(support: Support, link: impl FnOnce(&Mesh, u32) -> Joint) -> Body {
    hung_in(0.0, support, link)
}

fn hung_in(drag: f64, support: Support, link: impl FnOnce(&Mesh, u32) -> Joint) -> Body {
    let mut mesh = MeshBuilder::new();
    let pivot = mesh.point([0.0; 3]);
    let mass = mesh.point([2.5f64.sin(), 0.0, -(2.5f64.cos())]);
    mesh.cell(CellKind::Line2, &[pivot, mass]).unwrap();
    mesh.node_group("pivot", [pivot]);
    mesh.node_group("mass", [mass]);
    let spring = Link::spring(1e-20, Some(1.0)).unwrap();
    let mesh = mesh.build().unwrap();
    let link = link(&mesh, mass);
    Body::builder(mesh)
        .region(Region::links(spring, 0.0))
        .point_terms(emmy::body::PointTerms {
            masses: vec![PointMass { group: "mass".into(), mass: 2.0 }],
            ..Default::default()
        })
        .support(support)
        .load(Load::acceleration([0.0, 0.0, -GRAVITY]))
        .drag(drag)
        .joint(link)
        .build()
        .unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// The position at t = 2 by elliptic functions, and the errors of an independent implementation of the method.
#[test]
fn a_pendulum_on_a_rigid_link_has_the_errors_of_the_method() {
    let exact = [-0.8593287654041214, 0.0, 0.5114235748858558];
    let body = pendulum();
    for (k, h, expected) in [(1, 0.01, 3.384_576e-4), (2, 0.02, 5.765_248e-7), (3, 0.05, 5.732_235e-8)] {
        let mut motion = Motion::new(&body, at(DGM, k)).unwrap();
        let energy = 2.0 * GRAVITY * -(2.5f64.cos());
        let (mut drift, mut length, mut corrections) = (0f64, 0f64, 0);
        let steps = (2.0f64 / h).round() as usize;
        for _ in 0..steps {
            let record = motion.step(h).unwrap().clone();
            let position = motion.state().position(&body, 1);
            drift = drift.max((record.total_energy + 2.0 * GRAVITY * position[2] - energy).abs());
            length = length.max((distance(position, [0.0; 3]) - 1.0).abs());
            corrections += record.newton_iterations;
            assert!(record.energy_residual.abs() < 1e-12 && record.linear_momentum_residual < 1e-12);
        }
        let error = distance(motion.state().position(&body, 1), exact);
        assert!((error / expected - 1.0).abs() < 0.02, "k = {k}: {error:e} is not {expected:e}");
        assert!(drift < 1e-12 * energy.abs() && length < 1e-12, "k = {k}: {drift:e}, {length:e}");
        assert!(corrections < 6 * steps, "k = {k}: {corrections} corrections in {steps} steps");
    }
}

/// A soft block tumbles with a rigid link between two opposite corners: the link has neither a resultant nor a moment
/// and does no work.
#[test]
fn a_link_between_two_nodes_keeps_energy_and_momenta() {
    let mesh = mesh::block([1.0; 3], [2; 3]).unwrap();
    let ends = [[0.0; 3], [1.0; 3]];
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap() as u32;
    let link = ends.map(node);
    let builder = || {
        let rubber = NeoHooke::new(100.0, 50.0).unwrap();
        Body::builder(mesh.clone()).region(Region::new(rubber, 1.0))
    };
    let body = builder().joint(link_of(&mesh, link)).build().unwrap();
    let without = builder().build().unwrap();
    let flies = InitialVelocity {
        velocity: [0.3, -0.2, 0.1],
        angular_velocity: [1.0, 2.0, -3.0],
        ..InitialVelocity::default()
    };
    let start = |body: &Body| State::initial(body, 0.0, std::slice::from_ref(&flies)).unwrap();
    for k in 1..=3 {
        // Steps with a link are solved to rounding.
        let settings = NewtonSettings { tolerance: 1e-15, ..NewtonSettings::default() };
        let [mut motion, mut other] =
            [&body, &without].map(|body| Motion::starting(body, at(DGM, k), settings, start(body)).unwrap());
        let (mut length, mut energy) = (0f64, Vec::new());
        let (mut corrections, mut corrections_without, mut moved) = (0, 0, 0f64);
        for _ in 0..50 {
            let record = motion.step(0.05).unwrap().clone();
            let [a, b] = link.map(|node| motion.state().position(&body, node as usize));
            length = length.max((distance(a, b) - 3f64.sqrt()).abs());
            energy.push(record.total_energy);
            corrections += record.newton_iterations;
            corrections_without += other.step(0.05).unwrap().newton_iterations;
            moved = moved.max(record.strain_energy / record.total_energy);
            assert!(record.energy_residual.abs() < 1e-12, "k = {k}: {record:?}");
            assert!(record.linear_momentum_residual < 1e-12 && record.angular_momentum_residual < 1e-12);
        }
        let drift = energy.iter().map(|e| (e / energy[0] - 1.0).abs()).fold(0.0, f64::max);
        assert!(drift < 1e-12 && length < 1e-12, "k = {k}: {drift:e}, {length:e}");
        assert!(moved > 1e-3, "the block must deform, {moved:e}");
        assert!(2 * corrections < 3 * corrections_without, "k = {k}: {corrections}, {corrections_without}");
    }
}

/// Computations without multipliers refuse a body with rigid links.
#[test]
fn rigid_links_are_refused_where_they_have_no_multipliers() {
    let body = pendulum();
    for scheme in ["HHT(0.05)", "Bathe", "central-differences"] {
        let scheme: Scheme = scheme.parse().unwrap();
        let error = scheme.check_body(&body).unwrap_err().to_string();
        assert!(error.contains("joints and rigid bodies need a time element"), "{error}");
    }
}

/// A link to a held node is one to the ground, and a pivot that glides with a steady velocity takes the pendulum along.
#[test]
fn a_link_to_a_held_node_does_not_move_it() {
    let between = |mesh: &Mesh, _| link_of(mesh, [0, 1]);
    let line = |end: f64| TimeFunction::new(vec![(0.0, 0.0), (10.0, end)]).unwrap();
    let gliding = Support::driven("pivot", [5.0, 0.0, 0.0].map(|end| Some(line(end))));
    let bodies = [(hung(Support::fixed("pivot"), between), 0.0), (hung(gliding, between), 0.5)];
    for solver in [Solver::Direct, Solver::Iterative] {
        for k in 1..=3 {
            let settings = NewtonSettings { solver, ..NewtonSettings::default() };
            let ground = pendulum();
            let start = State::initial(&ground, 0.0, &[]).unwrap();
            let mut expected = Motion::starting(&ground, at(DGM, k), settings, start).unwrap();
            (0..20).for_each(|_| _ = expected.step(0.05).unwrap());
            let expected = expected.state().position(&ground, 1);
            for (body, velocity) in &bodies {
                let flies = InitialVelocity { velocity: [*velocity, 0.0, 0.0], ..InitialVelocity::default() };
                let start = State::initial(body, 0.0, &[flies]).unwrap();
                let mut motion = Motion::starting(body, at(DGM, k), settings, start).unwrap();
                for _ in 0..20 {
                    let record = motion.step(0.05).unwrap();
                    assert!(record.energy_residual.abs() < 1e-11, "{record:?}");
                }
                let [pivot, mass] = [0, 1].map(|node| motion.state().position(body, node));
                assert!(distance(pivot, [*velocity, 0.0, 0.0]) < 1e-14, "k = {k}: {pivot:?}");
                let relative = [0, 1, 2].map(|d| mass[d] - pivot[d]);
                let error = distance(relative, expected);
                assert!(error < 1e-9, "{solver:?}, k = {k}, velocity {velocity}: {error:e}");
            }
        }
    }
}

/// Multipliers are in the snapshot: a motion goes on bit for bit.
#[test]
fn a_motion_with_a_link_is_resumed_bit_for_bit() {
    let mesh = mesh::block([1.0; 3], [1; 3]).unwrap();
    let link = link_of(&mesh, [0, 7]);
    let held = Body::builder(mesh)
        .region(Region::new(NeoHooke::new(100.0, 50.0).unwrap(), 1.0))
        .support(Support::fixed("x-min"))
        .load(Load::acceleration([0.0, 0.0, -GRAVITY]))
        .joint(link)
        .build()
        .unwrap();
    for (body, scheme) in [(pendulum(), at(DGM, 2)), (held, at(dgm(0.8), 2))] {
        let mut motion = Motion::new(&body, scheme).unwrap();
        (0..5).for_each(|_| _ = motion.step(0.02).unwrap());
        let snapshot = motion.snapshot();
        let mut resumed = Motion::resumed(&body, scheme, NewtonSettings::default(), snapshot).unwrap();
        for _ in 0..5 {
            assert_eq!(resumed.step(0.02).unwrap(), motion.step(0.02).unwrap());
            assert_eq!(resumed.state(), motion.state());
        }
    }
}

#[test]
fn a_link_names_a_node_of_the_mesh() {
    let mesh = mesh::block([1.0; 3], [1; 3]).unwrap();
    let rubber = Region::new(NeoHooke::new(100.0, 50.0).unwrap(), 1.0);
    let link = Joint { between: [JointEnd::Node(0), JointEnd::Node(8)], ..link_of(&mesh, [0, 7]) };
    let error = Body::builder(mesh).region(rubber).joint(link).build().unwrap_err();
    assert_eq!(error.to_string(), "joint \"link\": node 8 does not exist");
}

/// A driven pendulum in a medium: `theta'' = -g sin theta - r theta'`, by the method of Runge and Kutta.
#[test]
fn a_pendulum_with_drag_follows_its_equation() {
    const RATE: f64 = 0.4;
    let acceleration = |[angle, speed]: [f64; 2]| [speed, -GRAVITY * angle.sin() - RATE * speed];
    let mut state = [2.5, 0.0];
    let h = 1e-4;
    for _ in 0..20_000 {
        let at = |slope: [f64; 2], part: f64| [0, 1].map(|i| state[i] + part * h * slope[i]);
        let first = acceleration(state);
        let second = acceleration(at(first, 0.5));
        let third = acceleration(at(second, 0.5));
        let fourth = acceleration(at(third, 1.0));
        let slope = [0, 1].map(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
        state = at(slope, 1.0);
    }
    let expected = [state[0].sin(), 0.0, -state[0].cos()];
    let body = pendulum_in(RATE);
    let mut motion = Motion::new(&body, at(DGM, 3)).unwrap();
    for _ in 0..40 {
        let record = motion.step(0.05).unwrap();
        assert!(record.energy_residual.abs() < 1e-12 && record.linear_momentum_residual < 1e-12);
    }
    let position = motion.state().position(&body, 1);
    assert!((distance(position, [0.0; 3]) - 1.0).abs() < 1e-12);
    assert!(distance(position, expected) < 1e-6, "{position:?} is not {expected:?}");
    // The energy that is left, by the speed of the equation.
    let left = state[1] * state[1] - 2.0 * GRAVITY * state[0].cos();
    let lost = -2.0 * GRAVITY * 2.5f64.cos() - left;
    assert!((motion.record().dissipated_energy / lost - 1.0).abs() < 1e-6);
}

/// With cells and schemes of every kind the length is kept and every balance closes, by each linear solver.
#[test]
fn links_and_all_kinds_of_cells_keep_every_balance() {
    let mesh = mesh::block([1.0; 3], [2; 3]).unwrap();
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap() as u32;
    let link = [[0.0; 3], [1.0; 3]].map(node);
    let viscosity = Viscosity { time: 0.02, ..Viscosity::default() };
    let soft = || Region::new(NeoHooke::new(100.0, 50.0).unwrap(), 1.0);
    let rubber = || {
        let stiff = NeoHooke::new(1e5, 50.0).unwrap();
        Region::new(stiff, 1.0).with_formulation(Formulation::ProjectedVolume(None))
    };
    let cases = [
        ("viscous", soft().with_viscosity(viscosity), 0.0, DGM),
        ("projected volume", rubber(), 0.0, DGM),
        ("viscous projected volume", rubber().with_viscosity(viscosity), 0.0, DGM),
        ("incompatible modes", soft().with_formulation(Formulation::IncompatibleModes), 0.0, DGM),
        ("drag", soft(), 0.3, DGM),
        ("dissipative", soft(), 0.0, dgm(0.8)),
        ("dissipative projected volume", rubber(), 0.0, dgm(0.8)),
    ];
    for (name, region, drag, scheme) in cases {
        let builder = Body::builder(mesh.clone()).region(region).drag(drag);
        let body = builder.joint(link_of(&mesh, link)).build().unwrap();
        let flies = InitialVelocity {
            velocity: [0.3, -0.2, 0.1],
            angular_velocity: [1.0, 2.0, -3.0],
            ..InitialVelocity::default()
        };
        let mut ends = Vec::new();
        for (solver, exact_tangent) in
            [(Solver::Direct, false), (Solver::Iterative, false), (Solver::Direct, true)]
        {
            let settings = NewtonSettings { solver, exact_tangent, ..NewtonSettings::default() };
            for k in 1..=2 {
                let start = State::initial(&body, 0.0, std::slice::from_ref(&flies)).unwrap();
                let mut motion = Motion::starting(&body, at(scheme, k), settings, start).unwrap();
                for _ in 0..15 {
                    let record = motion.step(0.04).unwrap().clone();
                    let [a, b] = link.map(|node| motion.state().position(&body, node as usize));
                    let length = (distance(a, b) - 3f64.sqrt()).abs();
                    assert!(length < 1e-12, "{name}, k = {k}, {solver:?}: length {length:e}");
                    let residuals = [record.linear_momentum_residual, record.angular_momentum_residual];
                    let energy = record.energy_residual.abs();
                    assert!(
                        energy < 2e-12 && residuals.iter().all(|r| *r < 2e-12),
                        "{name}, k = {k}, {solver:?}: {energy:e}, {residuals:?}"
                    );
                }
                ends.push(motion.state().displacement.clone());
            }
        }
        for (at, end) in ends.iter().enumerate() {
            let far = end.iter().zip(&ends[at % 2]).map(|(u, v)| (u - v).abs()).fold(0.0, f64::max);
            assert!(far < 1e-8, "{name}: solvers differ by {far:e}");
        }
    }
}

/// A block hangs on a wall until it is released: then it falls freely, with its link.
#[test]
fn a_link_stays_when_supports_are_released() {
    let mesh = mesh::block([1.0; 3], [2; 3]).unwrap();
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap() as u32;
    let link = [[0.0; 3], [1.0; 3]].map(node);
    let body = Body::builder(mesh.clone())
        .region(Region::new(NeoHooke::new(100.0, 50.0).unwrap(), 1.0))
        .support(Support::fixed("x-min").until(0.5))
        .load(Load::acceleration([0.0, 0.0, -1.0]))
        .joint(link_of(&mesh, link))
        .build()
        .unwrap();
    let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
    let plan = StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.05 }]).unwrap();
    let mut at_release = [0.0; 3];
    while let Some(record) = motion.next_step(&plan, &mut []).unwrap() {
        let record = record.clone();
        assert!(
            record.energy_residual.abs() < 1e-12 && record.linear_momentum_residual < 1e-12,
            "{record:?}"
        );
        if (record.time - 0.5).abs() < 1e-9 {
            at_release = record.linear_momentum;
        }
        let [a, b] = link.map(|node| motion.state().position(&body, node as usize));
        assert!((distance(a, b) - 3f64.sqrt()).abs() < 1e-12);
    }
    // The weight of a mass of 1 acts alone for half a second.
    let change = [0, 1, 2].map(|d| motion.record().linear_momentum[d] - at_release[d]);
    assert!(distance(change, [0.0, 0.0, -0.5]) < 1e-11, "{change:?}");
}
