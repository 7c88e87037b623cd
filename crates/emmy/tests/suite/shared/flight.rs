//! Free flight that must keep its balances.

use emmy::body::{Body, InitialVelocity, Region};
use emmy::material::{Material, NeoHooke, Ogden, SaintVenantKirchhoff, Volumetric};
use emmy::mesh::{CellKind, Mesh};
use emmy::motion::{Motion, NewtonSettings, State};

use crate::shared::schemes::{DGM, at};

/// A region of a material.
fn region(material: impl Material) -> Region {
    Region::new(material, 2.0)
}

/// St. Venant-Kirchhoff, neo-Hooke and Ogden, DGM of degree 1 and 2, for 200 steps each: every kind of cell, in a mesh
/// of it.
pub(crate) fn every_kind_flies(kinds: &[CellKind], mesh: impl Fn(CellKind) -> Mesh, field: &InitialVelocity) {
    for &kind in kinds {
        for degree in 1..=2 {
            let ogden =
                Ogden::new(&[(630.0, 1.3), (1.2, 5.0), (-10.0, -2.0)], 1500.0, Volumetric::SimoTaylor);
            let regions = [
                ("St. Venant-Kirchhoff", region(SaintVenantKirchhoff::new(1000.0, 500.0).unwrap())),
                ("neo-Hooke", region(NeoHooke::new(1000.0, 500.0).unwrap())),
                ("Ogden", region(ogden.unwrap())),
            ];
            for (material, region) in regions {
                let body = Body::builder(mesh(kind)).region(region).build().unwrap();
                flies(&format!("{kind}, {material}, k = {degree}"), &body, field, degree);
            }
        }
    }
}

/// 200 steps with strains of several percent: the balances of every step, and their sums, are at round-off.
fn flies(name: &str, body: &Body, field: &InitialVelocity, degree: usize) {
    let state = State::initial(body, 0.0, std::slice::from_ref(field)).unwrap();
    let settings = NewtonSettings::default();
    let mut motion = Motion::starting(body, at(DGM, degree), settings, state).unwrap();
    let (first, mut strained) = (motion.record().clone(), 0f64);
    for _ in 1..=200 {
        let record = motion.step(0.004).unwrap();
        strained = strained.max(record.strain_energy / record.total_energy);
        assert!(record.energy_residual.abs() < 1e-12 * first.total_energy, "{name}: {record:?}");
        assert!(record.linear_momentum_residual < 1e-12, "{name}: {record:?}");
        assert!(record.angular_momentum_residual < 1e-12, "{name}: {record:?}");
    }
    let (last, drift) =
        (motion.record(), |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max));
    assert!(strained > 0.02, "{name}: {strained}");
    let energy = (last.total_energy - first.total_energy).abs() / first.total_energy;
    assert!(energy < 1e-11, "{name}: {energy:e}");
    assert!(drift(last.linear_momentum, first.linear_momentum) < 1e-11, "{name}");
    assert!(drift(last.angular_momentum, first.angular_momentum) < 1e-11, "{name}");
    // A plane motion stays in its plane.
    if body.mesh().cells().all(|cell| cell.kind.dimension() == 2) {
        assert!(motion.state().displacement.iter().skip(2).step_by(3).all(|&u| u == 0.0), "{name}");
    }
}
