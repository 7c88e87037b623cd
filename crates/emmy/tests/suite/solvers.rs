//! The linear solvers: all give the same motion, on any number of threads, and their approximate tangent rotates with
//! the body.

use emmy::body::{
    Body, BodyBuilder, Formulation, GroundSpring, InitialVelocity, PointTerms, Region, Viscosity,
};
use emmy::internals::sparse::{Solver, SolverKind};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{Mesh, MeshBuilder, block};
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::time::Scheme;

use crate::shared::schemes::at;

fn spin(rate: f64) -> InitialVelocity {
    InitialVelocity { angular_velocity: [0.3 * rate, 0.5 * rate, 0.8 * rate], ..Default::default() }
}

fn flight(
    region: Region,
    motion: InitialVelocity,
    (scheme, degree): (&str, usize),
    settings: NewtonSettings,
    (n, h): (usize, f64),
) -> (Vec<Record>, Vec<f64>) {
    let body = Body::builder(emmy::mesh::l_block(1.0).unwrap()).region(region).build().unwrap();
    let scheme: Scheme = scheme.parse().unwrap();
    let state = State::initial(&body, 0.0, &[motion]).unwrap();
    let mut motion = Motion::starting(&body, at(scheme, degree), settings, state).unwrap();
    let records = (1..=n).map(|_| motion.step(h).unwrap().clone()).collect();
    (records, motion.state().displacement.clone())
}

fn soft(scheme: (&str, usize), settings: NewtonSettings) -> (Vec<Record>, Vec<f64>) {
    let gradient = [[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.02]];
    let motion = InitialVelocity { gradient, ..spin(1.0) };
    flight(Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.5), motion, scheme, settings, (20, 0.05))
}

#[test]
fn all_lead_to_the_same_motion() {
    for scheme in [("FE(1)", 1), ("DGM", 1), ("AS(3)", 2), ("DGM", 3), ("Newmark(0.25, 0.5)", 1)] {
        let with = |solver, exact_tangent| {
            // Solvers agree to the tolerance.
            soft(scheme, NewtonSettings { tolerance: 1e-13, solver, exact_tangent, ..Default::default() })
        };
        let (expected_records, expected) = with(Solver::Direct, true);
        let size = expected.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        for (solver, kind, exact) in [
            (Solver::Iterative, SolverKind::Iterative, true),
            (Solver::Multigrid, SolverKind::Multigrid, true),
            (Solver::Direct, SolverKind::Direct, false),
            (Solver::Iterative, SolverKind::Iterative, false),
            (Solver::Multigrid, SolverKind::Multigrid, false),
        ] {
            let (records, displacement) = with(solver, exact);
            assert_eq!(records[0].solver.map(|choice| choice.kind), Some(kind));
            for (u, expected) in displacement.iter().zip(&expected) {
                assert!((u - expected).abs() < 1e-11 * size, "{scheme:?} {solver:?}: {u} {expected}");
            }
            let balance = |records: &[Record]| {
                records.iter().map(|record| record.angular_momentum_residual).fold(0.0, f64::max)
            };
            if !scheme.0.starts_with("Newmark") {
                // The balances are closed to rounding with any solver.
                let (kept, exact) = (balance(&records), balance(&expected_records));
                assert!(kept < 1e-11 && exact < 1e-11, "{scheme:?} {solver:?}: {kept:e} {exact:e}");
            }
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| soft(("DGM", 2), NewtonSettings { solver, ..Default::default() }).1)
        };
        let one = on(1);
        assert!((2..5).all(|threads| on(threads) == one), "{solver:?}");
    }
}

/// A quasi-rigid body rotates by more than a radian and a half; K is computed in the first step and used to the end.
#[test]
fn a_kept_stiffness_turns_with_the_body() {
    let stiff = || Region::new(SaintVenantKirchhoff::from_engineering(1e7, 0.3).unwrap(), 1.0);
    for scheme in [("DGM", 1), ("AS(2)", 2), ("FE(1)", 1)] {
        let settings = NewtonSettings { solver: Solver::Direct, ..Default::default() };
        let (records, _) = flight(stiff(), spin(2.0), scheme, settings, (80, 0.01));
        let refactorizations: usize = records.iter().map(|record| record.refactorizations).sum();
        assert!(refactorizations <= 3, "{scheme:?}: {refactorizations}");
    }
}

/// A bar of 1 x 1 x 4 cubes, the upper half of it in the group "soft".
fn bar() -> Mesh {
    let cubes = block([1.0, 1.0, 4.0], [1, 1, 4]).unwrap();
    let mut builder = MeshBuilder::new();
    cubes.points().iter().for_each(|point| {
        builder.point(*point);
    });
    for (index, cell) in cubes.cells().enumerate() {
        let number = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(if index < 2 { "stiff" } else { "soft" }, [number]);
    }
    builder.build().unwrap()
}

/// A motion so small that it is linear: what the factorised matrix lacks is all that corrections leave. With the
/// viscosities of all parts in it, they are as many as without viscosity, but for one a step.
#[test]
fn uneven_viscosities_do_not_slow_the_corrections() {
    let rubber = || Region::new(NeoHooke::new(1e3, 30.0).unwrap(), 1.0);
    let projected = || rubber().with_formulation(Formulation::ProjectedVolume(None));
    let stiff = || Region::new(NeoHooke::new(1e5, 1e5).unwrap(), 1.0).on("stiff");
    let springs = || vec![GroundSpring { group: "soft".into(), stiffness: 50.0 }];
    let mixed = || Body::builder(bar()).region(stiff());
    let time = Viscosity { time: 0.3, ..Viscosity::default() };
    let shear = Viscosity { shear: 10.0, ..Viscosity::default() };
    let bodies: [(_, _, &dyn Fn(Viscosity) -> BodyBuilder); 5] = [
        ("a soft part", time, &|own| mixed().region(rubber().on("soft").with_viscosity(own))),
        ("projected", time, &|own| mixed().region(projected().on("soft").with_viscosity(own))),
        ("drag", time, &|own| mixed().region(rubber().on("soft").with_viscosity(own)).drag(2.0)),
        ("shear alone", shear, &|own| Body::builder(bar()).region(rubber().with_viscosity(own))),
        ("springs", time, &|own| {
            let terms = PointTerms { springs: springs(), ..PointTerms::default() };
            Body::builder(bar()).region(rubber().with_viscosity(own)).point_terms(terms)
        }),
    ];
    let gradient = [[1e-6, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 3e-6]];
    let stretch = InitialVelocity { gradient, ..Default::default() };
    for (what, viscosity, body) in bodies {
        for (scheme, degree) in
            [("DGM", 2), ("DGM", 3), ("AS(3)", 3), ("FE(2)", 2), ("DGM", 4), ("DGM(0.5)", 2)]
        {
            let corrections = |viscosity: Viscosity| -> usize {
                let body = body(viscosity).build().unwrap();
                let state = State::initial(&body, 0.0, std::slice::from_ref(&stretch)).unwrap();
                let settings = NewtonSettings { solver: Solver::Direct, ..Default::default() };
                let scheme = at(scheme.parse().unwrap(), degree);
                let mut motion = Motion::starting(&body, scheme, settings, state).unwrap();
                // The factors of later steps have another time s than their K.
                let sizes = [0.1, 0.1, 0.1, 0.03, 0.03];
                sizes.map(|h| motion.step(h).unwrap().newton_iterations).iter().sum()
            };
            let [viscous, elastic] = [viscosity, Viscosity::default()].map(corrections);
            assert!(viscous <= elastic + 5, "{what}, {scheme}, k = {degree}: {viscous} {elastic}");
        }
    }
}
