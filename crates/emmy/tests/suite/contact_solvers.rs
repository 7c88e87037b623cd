//! Impacts of bodies with 500 degrees of freedom and more, in which conjugate gradients take the derivatives of the
//! layer.

use crate::shared::contact::{conserving, contact, joined, rubber, spinning, two_blocks};
use crate::shared::schemes::{DGM, at, dgm};
use emmy::body::{Contact, Obstacle};
use emmy::mesh::Placement;
use emmy::motion::{NewtonSettings, Solver};
use emmy::prelude::*;

const ITERATIVE: NewtonSettings =
    NewtonSettings { tolerance: 1e-10, max_iterations: 20, solver: Solver::Iterative, exact_tangent: false };

/// Two blocks that fly against each other, with their start.
fn thrown(region: Region) -> (Body, State) {
    let (mesh, velocities) = two_blocks([4, 4]);
    let body = Body::builder(mesh).region(region).contact(contact()).build().unwrap();
    assert!(body.n_dofs() >= 500);
    let start = State::initial(&body, 0.0, &velocities).unwrap();
    (body, start)
}

/// A motion with conjugate gradients unless the settings say otherwise.
fn motion(body: &Body, scheme: Scheme, settings: NewtonSettings, start: State) -> Motion<'_> {
    Motion::new(body, scheme).unwrap().newton(settings).unwrap().from(start).unwrap()
}

/// A factorisation leaves the derivatives of the layer to GMRES.
#[test]
fn the_solution_of_an_impact_does_not_depend_on_the_solver() {
    let (body, start) = thrown(rubber());
    let run = |solver: Solver| {
        let mut motion = motion(&body, at(DGM, 1), NewtonSettings { solver, ..ITERATIVE }, start.clone());
        let (mut corrections, mut touching, mut with_exact) = (0, 0, 0);
        for _ in 0..15 {
            let record = motion.step(0.01).unwrap();
            corrections += record.newton_iterations;
            touching += usize::from(record.contact_energy > 0.0);
            with_exact += usize::from(record.took_exact_tangent);
            assert!(record.energy_residual.abs() < 1e-11 * record.total_energy, "{solver:?}");
            assert!(record.linear_momentum_residual < 1e-11 && record.angular_momentum_residual < 1e-11);
        }
        (motion.state().displacement.clone(), corrections, [with_exact, touching])
    };
    let (expected, of_direct, _) = run(Solver::Direct);
    for solver in [Solver::Iterative, Solver::Multigrid] {
        let (found, corrections, [with_exact, touching]) = run(solver);
        let off = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-8, "{solver:?}: {off:e}");
        assert!(2 * corrections <= 3 * of_direct, "{solver:?}: {corrections} and {of_direct} corrections");
        // The first step has no factor yet, and slow corrections go to the exact tangent.
        assert!(
            2 * with_exact < touching,
            "{solver:?}: {with_exact} of {touching} steps with the exact tangent"
        );
    }
}

/// Every formulation keeps energy and momenta, and a motion resumed in the impact has the same bits.
#[test]
fn formulations_keep_energy_and_momenta() {
    for (region, scheme, h) in conserving(0.01).into_iter().filter(|(_, scheme, _)| scheme.degree() == 1) {
        let name = format!("{scheme:?} {region:?}");
        let (body, start) = thrown(region);
        let mut motion = motion(&body, scheme, ITERATIVE, start);
        let first = motion.record().clone();
        let mut largest = 0.0f64;
        for step in 0..(0.2 / h).ceil() as usize {
            let snapshot = (step == (0.06 / h) as usize).then(|| motion.snapshot());
            let record = motion.step(h).unwrap_or_else(|error| panic!("{name}: {error}")).clone();
            largest = largest.max(record.contact_energy);
            if let Some(snapshot) = snapshot {
                assert!(record.contact_energy > 0.0, "{name}");
                let mut resumed = Motion::resumed(&body, scheme, ITERATIVE, snapshot).unwrap();
                assert_eq!(record, *resumed.step(h).unwrap(), "{name}");
            }
        }
        let record = motion.record();
        assert!(largest > 0.05 && record.smallest_gap.is_none_or(|gap| gap > 1.0), "{name}: {largest}");
        assert!((record.total_energy - first.total_energy).abs() < 1e-10, "{name}: {record:?}");
        for d in 0..3 {
            assert!((record.linear_momentum[d] - first.linear_momentum[d]).abs() < 1e-12, "{name}");
            assert!((record.angular_momentum[d] - first.angular_momentum[d]).abs() < 1e-11, "{name}");
        }
    }
}

/// The balance of a scheme with a spectral radius closes with the energy that it dissipates.
#[test]
fn dissipated_energy_is_in_the_balance() {
    let (body, start) = thrown(rubber());
    let mut motion = motion(&body, at(dgm(0.8), 1), ITERATIVE, start);
    for _ in 0..20 {
        let record = motion.step(0.01).unwrap();
        assert!(record.energy_residual.abs() < 1e-11 * record.total_energy, "{record:?}");
        assert!(record.linear_momentum_residual < 1e-11 && record.angular_momentum_residual < 1e-11);
    }
    assert!(motion.record().dissipated_energy > 0.0);
}

/// A block that falls on a plane at rest, and a block at rest that a plane hits, move alike in the frame of the plane.
#[test]
fn a_plane_hits_like_one_that_is_hit() {
    const SPEED: f64 = 1.5;
    let run = |rises: bool| {
        let mesh = mesh::block([1.0; 3], [6; 3]).unwrap();
        let floor = Obstacle::Plane { point: [0.0, -0.06, 0.0], normal: [0.0, 1.0, 0.0] };
        let contact = Contact::with_obstacle("y-min", floor).with_stiffness(1333.0).with_distance(0.05);
        let way = TimeFunction::smooth("v*t", |t| [SPEED * t, SPEED, 0.0]);
        let contact = if rises { contact.moved([None, Some(way), None]) } else { contact };
        let body = Body::builder(mesh).region(rubber()).contact(contact).build().unwrap();
        let thrown = InitialVelocity {
            velocity: [0.2, if rises { 0.0 } else { -SPEED }, 0.0],
            angular_velocity: [0.3, 0.2, 0.1],
            about: [0.5; 3],
            ..InitialVelocity::default()
        };
        let start = State::initial(&body, 0.0, &[thrown]).unwrap();
        let mut motion = motion(&body, at(DGM, 1), ITERATIVE, start);
        let mut largest = 0.0f64;
        for _ in 0..40 {
            let record = motion.step(0.005).unwrap();
            largest = largest.max(record.contact_energy);
            assert!(record.energy_residual.abs() < 1e-11 * record.total_energy.max(1.0), "{record:?}");
        }
        assert!(largest > 0.1, "{largest}");
        let carried = if rises { SPEED * motion.state().time } else { 0.0 };
        let at = |node: usize| motion.state().position(&body, node);
        let nodes = (0..7usize.pow(3)).map(at).map(|[x, y, z]| [x, y - carried, z]);
        nodes.collect::<Vec<[f64; 3]>>()
    };
    let pairs = run(false).into_iter().zip(run(true));
    let off = pairs.flat_map(|(a, b)| [0, 1, 2].map(|d| (a[d] - b[d]).abs())).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off:e}");
}

/// The stiffness of blocks that spin against each other serves them for two thirds of a turn.
#[test]
fn the_stiffness_turns_with_each_body() {
    let block = || mesh::block([1.0, 1.0, 0.5], [6, 6, 4]).unwrap();
    let above = Placement::default().shifted([0.1, 0.1, 0.6]);
    let mesh = joined(&[(block(), Placement::default()), (block(), above)]);
    let close = Contact::between("a", "b").with_stiffness(1333.0).with_distance(0.02);
    let body = Body::builder(mesh).region(rubber()).contact(close).build().unwrap();
    let spin = 5.0;
    let velocities = [
        spinning("a", [0.0; 3], [0.0, 0.0, spin], [0.5, 0.5, 0.25]),
        spinning("b", [0.0; 3], [0.0, 0.0, -spin], [0.6, 0.6, 0.85]),
    ];
    let start = State::initial(&body, 0.0, &velocities).unwrap();
    let mut motion = motion(&body, at(DGM, 1), ITERATIVE, start);
    let records: Vec<_> = (0..40).map(|_| motion.step(0.02).unwrap().clone()).collect();
    let new: usize = records.iter().map(|record| record.refactorizations).sum();
    assert!(new <= 3 && records.iter().all(|record| !record.took_exact_tangent), "{new}");
}
