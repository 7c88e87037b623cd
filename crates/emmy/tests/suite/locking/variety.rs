//! Projected volumes with every kind of cell, material and scheme; viscosity, adaptive steps, resumption, threads.

use emmy::body::Formulation;
use emmy::motion::{Adaptivity, Solver};
use emmy::prelude::*;

use super::patches::row;
use crate::shared::schemes::at;
use crate::shared::watch::Watch;

const PROJECTED: Formulation = Formulation::ProjectedVolume(None);
const MU: f64 = 20.0;
const K: f64 = 1e4 * MU;

fn region(material: impl Material) -> Region {
    Region::new(material, 1.0).with_formulation(PROJECTED)
}

fn isochoric() -> Region {
    region(NeoHookeIsochoric::new(MU, K, Volumetric::SimoTaylor).unwrap())
}

fn body(kinds: &[CellKind], region: Region) -> Body {
    Body::builder(row(kinds)).region(region).build().unwrap()
}

/// A motion that turns, stretches and shears in the plane, and out of it for solids.
fn start(body: &Body) -> State {
    let is_plane = body.mesh().cells().all(|cell| cell.kind.dimension() == 2);
    let z = if is_plane { 0.0 } else { 1.0 };
    let field = InitialVelocity {
        velocity: [0.2, -0.1, 0.3 * z],
        angular_velocity: [0.3 * z, 0.5 * z, 0.8],
        gradient: [[0.8, 0.2, 0.0], [0.0, -0.5 - 0.3 * (1.0 - z), 0.1 * z], [0.1 * z, 0.0, -0.3 * z]],
        ..Default::default()
    };
    State::initial(body, 0.0, &[field]).unwrap()
}

fn records(body: &Body, scheme: &str, degree: usize, size: f64, steps: usize) -> Vec<Record> {
    let scheme = at(scheme.parse().unwrap(), degree);
    let mut motion = Motion::starting(body, scheme, NewtonSettings::default(), start(body)).unwrap();
    (0..steps).map(|_| motion.step(size).unwrap().clone()).collect()
}

/// Every balance of every step is closed but for rounding: eps K/mu of the energy.
fn assert_closed(name: &str, records: &[Record]) {
    let energy = records[0].total_energy;
    let strained = records.iter().map(|record| record.strain_energy / energy).fold(0.0, f64::max);
    assert!(strained > 0.01, "{name}: {strained}");
    for record in records {
        assert!(record.energy_residual.abs() < 1e-11 * energy, "{name}: {record:?}");
        assert!(record.linear_momentum_residual < 1e-11, "{name}: {record:?}");
        assert!(record.angular_momentum_residual < 1e-11, "{name}: {record:?}");
    }
}

#[test]
fn every_kind_of_cell_conserves() {
    use CellKind::{Hex8, Pyramid5, Wedge6};
    for kind in CellKind::ALL.into_iter().filter(|kind| !kind.info().pressures.is_empty()) {
        let body = body(&[kind, kind], isochoric());
        for (scheme, degree) in [("DGM", 1), ("DGM", 2), ("AS(10)", 1)] {
            assert_closed(
                &format!("{kind}, {scheme}, k = {degree}"),
                &records(&body, scheme, degree, 0.04, 15),
            );
        }
    }
    let several = body(&[Hex8, Wedge6, Pyramid5, Hex8], isochoric());
    assert_closed("several kinds", &records(&several, "DGM", 2, 0.04, 15));
}

#[test]
fn every_material_conserves() {
    let law = Volumetric::SimoTaylor;
    let fibres = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]];
    let mut regions = vec![
        ("neo-Hooke", region(NeoHooke::new(K, MU).unwrap())),
        ("Mooney-Rivlin", region(MooneyRivlin::new(0.3 * MU, 0.2 * MU, K, law).unwrap())),
        ("Yeoh", region(Yeoh::new([0.5 * MU, 0.1, 0.01], K, law).unwrap())),
        ("Gent", region(Gent::new(MU, 30.0, K, law).unwrap())),
        ("Arruda-Boyce", region(ArrudaBoyce::new(MU, 3.0, K, law).unwrap())),
        ("Ogden", region(Ogden::new(&[(25.2, 1.3), (0.05, 5.0), (-0.4, -2.0)], K, law).unwrap())),
        ("Hencky", region(Hencky::new(K, MU).unwrap())),
        ("Saint Venant-Kirchhoff", region(SaintVenantKirchhoff::new(K, MU).unwrap())),
        ("Ciarlet-Geymonat", region(CiarletGeymonat::new(K, MU).unwrap())),
        (
            "Holzapfel-Gasser-Ogden",
            region(HolzapfelGasserOgden::new(MU, [5.0, 0.5], 0.1, &fibres, K, law).unwrap()),
        ),
    ];
    for law in Volumetric::ALL {
        regions.push((law.name(), region(NeoHookeIsochoric::new(MU, K, law).unwrap())));
    }
    for (name, region) in regions {
        let body = body(&[CellKind::Hex8; 2], region);
        // No inner rule is exact where fibres go slack.
        let schemes = [("DGM", 1), ("DGM", 3), ("AS(10)", 2)];
        let n = if name == "Holzapfel-Gasser-Ogden" { 2 } else { 3 };
        for (scheme, degree) in &schemes[..n] {
            assert_closed(
                &format!("{name}, {scheme}, k = {degree}"),
                &records(&body, scheme, *degree, 0.04, 15),
            );
        }
    }
}

/// Schemes without conservation: they reach the same motion.
#[test]
fn other_schemes_are_of_second_order() {
    let body =
        body(&[CellKind::Hex8; 2], region(NeoHookeIsochoric::new(MU, 30.0 * MU, Volumetric::Liu).unwrap()));
    let end = |scheme: &str, degree, size: f64| {
        let scheme = at(scheme.parse().unwrap(), degree);
        let settings = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
        let mut motion = Motion::starting(&body, scheme, settings, start(&body)).unwrap();
        motion.march(&StepPlan::new(0.0, vec![Phase { until: 0.2, size }]).unwrap(), &mut []).unwrap();
        motion.state().displacement.clone()
    };
    // Steps that resolve the pressure waves, whose speed is 25.
    let reference = end("DGM", 3, 0.001);
    let schemes = ["FE(1)", "FE(2)", "trapezoidal", "Lobatto(3)", "Newmark(0.25, 0.5)", "HHT(0.05)"];
    for scheme in schemes.into_iter().chain(["generalized-alpha(0.8)", "Bathe"]) {
        let errors = [0.001, 0.0005].map(|size| {
            let squares =
                end(scheme, 1, size).iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            squares.sqrt()
        });
        let order = (errors[0] / errors[1]).log2();
        println!("{scheme}: {:.1e}, {:.1e}, order {order:.2}", errors[0], errors[1]);
        assert!((order - 2.0).abs() < 0.3, "{scheme}: {errors:?}");
    }
    let explicit = Scheme::CentralDifferences;
    let mut motion = Motion::starting(&body, explicit, NewtonSettings::default(), start(&body)).unwrap();
    let momentum = motion.record().angular_momentum;
    for _ in 0..200 {
        motion.step(2e-4).unwrap();
    }
    let found = motion.record().angular_momentum;
    assert!((0..3).all(|i| (found[i] - momentum[i]).abs() < 1e-12), "{found:?} {momentum:?}");
}

#[test]
fn viscosity_and_dissipative_schemes_balance_what_they_dissipate() {
    let viscosity = Viscosity { time: 0.01, shear: 0.5, bulk: 0.1 };
    let viscous = body(&[CellKind::Hex8; 2], isochoric().with_viscosity(viscosity));
    let elastic = body(&[CellKind::Hex8; 2], isochoric());
    let cases = [
        (&viscous, "DGM", 1),
        (&viscous, "AS(10)", 2),
        (&elastic, "DGM(0.5)", 1),
        (&elastic, "AS(10, 0.2)", 2),
    ];
    for (body, scheme, degree) in cases {
        let records = records(body, scheme, degree, 0.04, 25);
        assert_closed(scheme, &records);
        let last = records.last().unwrap();
        assert!(last.dissipated_energy > 1e-3 * last.total_energy, "{scheme}: {last:?}");
        let falls =
            records.windows(2).all(|pair| pair[1].total_energy <= pair[0].total_energy * (1.0 + 1e-12));
        assert!(falls, "{scheme}");
    }
}

#[test]
fn adaptive_steps_conserve() {
    let body = body(&[CellKind::Hex8; 2], isochoric());
    let plan = StepPlan::adaptive(0.0, 1.0, Adaptivity::new(1e-3)).unwrap();
    let mut watch = Watch::default();
    let scheme = at("DGM".parse().unwrap(), 2);
    let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), start(&body)).unwrap();
    motion.march(&plan, &mut [&mut watch]).unwrap();
    println!("{} steps", watch.records.len() - 1);
    assert!(watch.records.iter().all(|record| record.local_error <= 1e-3));
    assert_closed("adaptive", &watch.records[1..]);
}

/// The records and the last state of a motion in one piece, and resumed after a number of steps.
#[test]
fn a_resumed_motion_is_the_same_in_every_bit() {
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.4, size: 0.05 }]).unwrap();
    let bodies = [body(&[CellKind::Hex8; 2], isochoric()), body(&[CellKind::Quad9; 2], isochoric())];
    let schemes = [("DGM", 1), ("DGM", 2), ("AS(5)", 2), ("DGM(0.5)", 1), ("FE(2)", 2), ("Bathe", 1)];
    for body in &bodies {
        for (scheme, degree) in schemes {
            for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
                let what = format!("{scheme}, k = {degree}, {solver:?}");
                let scheme = at(scheme.parse().unwrap(), degree);
                let settings = NewtonSettings { solver, ..NewtonSettings::default() };
                let mut whole = Watch { snapshot_after: Some(3), ..Watch::default() };
                let mut motion = Motion::starting(body, scheme, settings, start(body)).unwrap();
                motion.march(&plan, &mut [&mut whole]).unwrap();
                let mut rest = Watch::default();
                let mut resumed =
                    Motion::resumed(body, scheme, settings, whole.snapshot.take().unwrap()).unwrap();
                resumed.march_on(&plan, &mut [&mut rest]).unwrap();
                assert_eq!(format!("{:?}", rest.records), format!("{:?}", &whole.records[4..]), "{what}");
                assert_eq!(resumed.state(), motion.state(), "{what}");
            }
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let map = |[a, b, c]: [f64; 3]| [3.0 * a + 0.1 * b, b + 0.15 * a * c, c - 0.1 * a * b];
    let mesh = super::mapped(CellKind::Hex8, [9, 5, 5], map).build().unwrap();
    let body = Body::builder(mesh).region(isochoric()).build().unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scheme = at("DGM".parse().unwrap(), 2);
            let mut motion =
                Motion::starting(&body, scheme, NewtonSettings::default(), start(&body)).unwrap();
            (0..3).for_each(|_| _ = motion.step(0.02).unwrap());
            motion.state().clone()
        })
    };
    let one = on(1);
    assert!([2, 3, 5].into_iter().all(|threads| on(threads) == one));
}

/// A clamped block: the forces of changes of the pressures, in corrections with a kept stiffness, do not move the
/// support.
#[test]
fn supports_do_not_move() {
    let mesh = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    for bulk in [10.0 * MU, K] {
        let material = NeoHookeIsochoric::new(MU, bulk, Volumetric::SimoTaylor).unwrap();
        let body = Body::builder(mesh.clone())
            .region(region(material))
            .support(Support::fixed("x-min"))
            .load(Load::traction("x-max", [0.5, 1.0, 2.0]))
            .build()
            .unwrap();
        for degree in 1..=2 {
            let settings = NewtonSettings { tolerance: 1e-12, ..Default::default() };
            let mut motion = Motion::new(&body, at("DGM".parse().unwrap(), degree)).unwrap();
            motion = motion.newton(settings).unwrap();
            (0..2).for_each(|_| _ = motion.step(0.05).unwrap());
            let held = body.fixed().iter().zip(&motion.state().displacement).filter(|(fixed, _)| **fixed);
            assert!(held.clone().count() == 27 && held.into_iter().all(|(_, u)| *u == 0.0));
        }
    }
}
