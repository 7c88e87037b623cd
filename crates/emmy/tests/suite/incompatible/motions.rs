//! Motions of cells with modes: balances, orders, schemes, solvers, releases.

use emmy::body::{Body, Load, LoadKind, Region, Support, TimeFunction, Viscosity};
use emmy::material::NeoHooke;
use emmy::mesh::{self, CellKind};
use emmy::motion::{Motion, NewtonSettings, Solver, State};
use emmy::time::Scheme;
use emmy::{Error, time::Stepper};

use super::{distorted_pair, isochoric, of_mesh, pair, rubber, spin, with_modes};
use crate::shared::schemes::{DGM, assumed_strain, at, fe};

fn strict() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, ..NewtonSettings::default() }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn energy_and_angular_momentum_stay_in_free_flight() {
    let body = pair();
    for degree in 1..=4 {
        for (scheme, allowed) in [(DGM, 1e-12), (assumed_strain(8), 1e-12)] {
            let state = State::initial(&body, 0.0, &[spin()]).unwrap();
            let mut motion = Motion::starting(&body, at(scheme, degree), strict(), state).unwrap();
            let first = motion.record().clone();
            let [mut energy, mut momentum, mut strained] = [0f64; 3];
            for _ in 0..300 {
                let record = motion.step(0.05).unwrap();
                energy = energy.max((record.total_energy / first.total_energy - 1.0).abs());
                momentum = momentum.max(distance(record.angular_momentum, first.angular_momentum));
                strained = strained.max(record.strain_energy / record.total_energy);
            }
            println!("{scheme}, k = {degree}: {energy:.1e} {momentum:.1e} {strained:.2}");
            assert!(strained > 0.02);
            assert!(
                energy < allowed && momentum < allowed,
                "{scheme}, k = {degree}: {energy:e} {momentum:e}"
            );
        }
    }
}

/// Positions at t = 0.4 by steps of one size.
fn positions(body: &Body, scheme: Scheme, n: u32) -> Vec<f64> {
    let state = State::initial(body, 0.0, &[spin()]).unwrap();
    let mut motion = Motion::starting(body, scheme, strict(), state).unwrap();
    (0..n).for_each(|_| _ = motion.step(0.4 / f64::from(n)).unwrap());
    motion.state().displacement.clone()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn elements_of_degree_k_have_the_order_2k() {
    let body = pair();
    let best = positions(&body, at(DGM, 4), 32);
    for scheme in [DGM, assumed_strain(6)] {
        for (k, n) in [(1, 16), (2, 8), (3, 4)] {
            let error = |n| largest_difference(&positions(&body, at(scheme, k), n), &best);
            let order = (error(n) / error(2 * n)).log2();
            println!("{scheme}, k = {k}: {order:.2} {:.1e}", error(2 * n));
            assert!((order - 2.0 * k as f64).abs() < 0.3, "{scheme}, k = {k}: {order}");
        }
    }
    for scheme in
        ["trapezoidal", "Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe", "FE(1)"]
    {
        let scheme: Scheme = scheme.parse().unwrap();
        let error = |n| largest_difference(&positions(&body, scheme, n), &best);
        let order = (error(20) / error(40)).log2();
        println!("{scheme}: {order:.2} {:.1e}", error(40));
        assert!((order - 2.0).abs() < 0.3, "{scheme}: {order}");
    }
}

/// The modes that a time element leaves are in balance over its last step, not at its end. The schemes that weight
/// forces and accelerations at single times keep the linear momentum of a free body all the same.
#[test]
fn modes_out_of_balance_at_the_start_keep_the_momentum() {
    let body = pair();
    let state = State::initial(&body, 0.0, &[spin()]).unwrap();
    let mut flight = Motion::starting(&body, fe(1), strict(), state).unwrap();
    (0..3).for_each(|_| _ = flight.step(0.05).unwrap());
    let start = flight.record().linear_momentum;
    let size = distance(start, [0.0; 3]);
    for scheme in ["Newmark(0.3, 0.6)", "HHT(0.1)", "generalized-alpha(0.7)", "Bathe"] {
        let scheme = Scheme::from_name(scheme).unwrap();
        let state = flight.state().clone().transferred(&body, 0.0).unwrap();
        let mut motion = Motion::starting(&body, scheme, strict(), state).unwrap();
        for _ in 0..3 {
            let record = motion.step(0.05).unwrap();
            let change = distance(record.linear_momentum, start);
            assert!(change < 1e-12 * size, "{scheme}: {change:e} of {size:e}");
        }
    }
}

#[test]
fn an_explicit_scheme_is_rejected_by_name() {
    let body = pair();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    let error = Motion::starting(&body, Scheme::CentralDifferences, strict(), state).unwrap_err();
    assert!(matches!(&error, Error::Scheme { scheme, .. } if scheme == "central-differences"), "{error}");
    assert!(error.to_string().contains("incompatible modes"), "{error}");
}

/// A loaded bar that is held until t = 0.15, with modes.
fn released() -> Body {
    let mesh = mesh::block([1.0, 3.0, 1.0], [2, 5, 2]).unwrap();
    let held = Support { until: Some(0.15), ..Support::fixed("y-min") };
    let kind = LoadKind::Traction { group: "y-max".into(), traction: [30.0, -20.0, 40.0] };
    let push =
        Load { kind, time_function: TimeFunction::new(vec![(0.0, 0.0), (0.1, 1.0), (0.1, 0.0)]).unwrap() };
    Body::builder(mesh).region(rubber()).support(held).load(push).build().unwrap()
}

/// After the release the body flies freely: the modes are part of the state that both bodies share.
#[test]
fn a_released_body_keeps_its_modes() {
    let body = released();
    for (scheme, degree) in [(DGM, 1), (assumed_strain(9), 2)] {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let mut motion = Motion::starting(&body, at(scheme, degree), strict(), state).unwrap();
        (0..10).for_each(|_| _ = motion.step(0.015).unwrap());
        let at_release = motion.record().clone();
        let modes = &motion.state().displacement[of_mesh(&body)..];
        assert!(modes.iter().any(|x| x.abs() > 1e-3));
        for _ in 0..40 {
            let record = motion.step(0.015).unwrap();
            println!(
                "{} {:e} {:e} {:e}",
                record.time, record.total_energy, at_release.total_energy, record.energy_residual
            );
            assert!((record.total_energy / at_release.total_energy - 1.0).abs() < 1e-12);
            let free = record.total_energy > 0.0 && record.angular_momentum_residual < 1e-12;
            assert!(free, "{record:?}");
        }
    }
}

/// A motion may go on with cells of another formulation.
#[test]
fn states_are_transferred_to_cells_with_modes_and_back() {
    let standard =
        Body::builder(distorted_pair(CellKind::Hex8)).region(Region::new(isochoric(), 1.0)).build();
    let (standard, with_modes) = (standard.unwrap(), pair());
    let mut state = State::initial(&standard, 0.0, &[spin()]).unwrap();
    for body in [&standard, &with_modes, &standard] {
        let kinetic =
            |state: &State| state.momentum.iter().zip(&state.velocity).map(|(p, v)| p * v).sum::<f64>();
        let before = kinetic(&state);
        state = state.transferred(body, 0.0).unwrap();
        assert_eq!(state.displacement.len(), body.n_dofs());
        assert!((kinetic(&state) / before - 1.0).abs() < 1e-14);
        let mut motion = Motion::starting(body, at(DGM, 1), strict(), state).unwrap();
        (0..5).for_each(|_| _ = motion.step(0.05).unwrap());
        state = motion.state().clone();
    }
}

#[test]
fn both_solvers_find_the_same_motion() {
    let body = released();
    let run = |solver, degree| {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let settings = NewtonSettings { solver, ..strict() };
        let mut motion = Motion::starting(&body, at(DGM, degree), settings, state).unwrap();
        let iterations: usize = (0..20).map(|_| motion.step(0.015).unwrap().linear_iterations).sum();
        (motion.state().displacement.clone(), iterations)
    };
    for degree in 1..=2 {
        let [(direct, _), (iterative, n)] =
            [Solver::Direct, Solver::Iterative].map(|solver| run(solver, degree));
        println!("k = {degree}: {n} iterations, {:.1e}", largest_difference(&direct, &iterative));
        assert!(largest_difference(&direct, &iterative) < 1e-10, "k = {degree}");
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mesh = mesh::block([1.0, 3.0, 1.0], [4, 12, 4]).unwrap();
                let body = Body::builder(mesh).region(rubber()).build().unwrap();
                let state = State::initial(&body, 0.0, &[spin()]).unwrap();
                let settings = NewtonSettings { solver, ..NewtonSettings::default() };
                let mut motion = Motion::starting(&body, at(DGM, 2), settings, state).unwrap();
                (0..4).for_each(|_| _ = motion.step(0.02).unwrap());
                motion.state().clone()
            })
        };
        let one = on(1);
        assert!((2..5).all(|threads| on(threads) == one), "{solver:?}");
    }
}

/// Viscosity, drag and schemes that dissipate: what the energy loses is recorded.
#[test]
fn dissipated_energy_is_recorded() {
    let viscosity = Viscosity { time: 0.01, shear: 0.5, bulk: 0.1 };
    let damped = Body::builder(distorted_pair(CellKind::Hex8))
        .region(with_modes(isochoric(), 1.0).with_viscosity(viscosity))
        .drag(0.3)
        .build()
        .unwrap();
    let free = pair();
    for (body, scheme, degree) in [
        (&damped, "DGM", 1),
        (&damped, "AS(6)", 2),
        (&free, "DGM(0.5)", 1),
        (&free, "AS(6, 0.2)", 2),
        (&damped, "DGM(0.5)", 1),
    ] {
        let state = State::initial(body, 0.0, &[spin()]).unwrap();
        let scheme: Scheme = scheme.parse().unwrap();
        let mut motion = Motion::starting(body, at(scheme, degree), strict(), state).unwrap();
        let first = motion.record().total_energy;
        let mut dissipated = 0.0;
        for _ in 0..40 {
            let record = motion.step(0.05).unwrap();
            dissipated += record.dissipated_energy;
            assert!(record.energy_residual.abs() < 1e-11 * first, "{scheme}: {record:?}");
            assert!(record.angular_momentum_residual < 1e-12, "{scheme}: {record:?}");
        }
        let lost = first - motion.record().total_energy;
        assert!(lost > 1e-3 * first, "{scheme}: {lost:e}");
        let _ = dissipated;
    }
}

/// In a slow motion the rates of the modes follow those of the corners; a rigid motion has no modes at all.
#[test]
fn a_rigid_body_has_no_modes() {
    let stiff = with_modes(NeoHooke::new(1e9, 5e8).unwrap(), 1.0);
    let body = Body::builder(distorted_pair(CellKind::Hex8)).region(stiff).build().unwrap();
    let turn = emmy::body::InitialVelocity { gradient: [[0.0; 3]; 3], ..spin() };
    let state = State::initial(&body, 0.0, &[turn]).unwrap();
    let mut motion = Motion::starting(&body, at(DGM, 2), strict(), state).unwrap();
    (0..20).for_each(|_| _ = motion.step(0.1).unwrap());
    let displacement = &motion.state().displacement;
    let mut internal = of_mesh(&body);
    for cell in body.mesh().cells() {
        for _ in 0..3 {
            for d in 0..3 {
                let mean: f64 = cell.nodes.iter().map(|&node| displacement[3 * node as usize + d]).sum();
                assert!((displacement[internal + d] - mean / 8.0).abs() < 1e-8);
            }
            internal += 3;
        }
    }
    let _: fn(&dyn Stepper) -> &[f64] = |stepper| stepper.rates();
    let _: fn(Region) -> Region = |region| region;
}
