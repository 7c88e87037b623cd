//! Bending: cantilevers, frequencies, stresses.

use emmy::body::{Body, Load, LoadKind, Region, Support};
use emmy::equilibrium::Equilibrium;
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};
use emmy::motion::{NewtonSettings, State};

use super::with_modes;

const LENGTH: usize = 10;

/// Ten bricks 1 x 1 x 1 in a row, with the inner nodes moved along the beam by `skew` times a function of their place.
fn beam(skew: impl Fn(usize, f64, f64) -> f64) -> Mesh {
    let mut builder = MeshBuilder::new();
    for i in 0..=LENGTH {
        for (y, z) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let shift = if i == 0 || i == LENGTH { 0.0 } else { skew(i, y, z) };
            builder.point([i as f64 + shift, y, z]);
        }
    }
    for i in 0..LENGTH as u32 {
        let [a, b] = [4 * i, 4 * i + 4];
        builder.cell(CellKind::Hex8, &[a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2]).unwrap();
    }
    builder.node_group("wall", 0..4);
    builder.facet_group("end", [Facet { cell: LENGTH as u32 - 1, local: 1 }]);
    builder.build().unwrap()
}

/// Deflection of the end under a small force along z, over that of the beam of Euler, Bernoulli and Timoshenko with the
/// shear factor 5/6; E = 1000.
fn deflection(mesh: Mesh, nu: f64, has_modes: bool) -> f64 {
    let material = NeoHooke::from_engineering(1000.0, nu).unwrap();
    let region = if has_modes { with_modes(material, 1.0) } else { Region::new(material, 1.0) };
    let force = 1e-6;
    let body = Body::builder(mesh)
        .region(region)
        .support(Support::fixed("wall"))
        .load(Load::force("end", [0.0, 0.0, force]))
        .build()
        .unwrap();
    let settings = NewtonSettings { tolerance: 1e-11, ..NewtonSettings::default() };
    let state = Equilibrium::new(&body, 0.0, 1).unwrap().start(settings, &[], &mut []).unwrap();
    let mean = (4 * LENGTH..4 * LENGTH + 4).map(|node| state.displacement[3 * node + 2]).sum::<f64>() / 4.0;
    let (length, modulus) = (LENGTH as f64, 1000.0);
    let shear = modulus / (2.0 * (1.0 + nu));
    mean / (force * (length.powi(3) / (3.0 * modulus / 12.0) + length / (5.0 / 6.0 * shear)))
}

#[test]
fn ten_bricks_bend_like_a_beam() {
    for nu in [0.3, 0.4999] {
        for has_modes in [false, true] {
            let regular = deflection(beam(|_, _, _| 0.0), nu, has_modes);
            let skewed = deflection(beam(|_, _, z| 0.5 * (2.0 * z - 1.0)), nu, has_modes);
            let zigzag = deflection(
                beam(|i, _, z| if i % 2 == 0 { 0.25 } else { -0.25 } * (2.0 * z - 1.0)),
                nu,
                has_modes,
            );
            println!("nu = {nu}, modes {has_modes}: {regular:.4} {skewed:.4} {zigzag:.4}");
        }
    }
    let _ = (LoadKind::NodalForce { group: String::new(), force: [0.0; 3] }, State::default());
}
