//! Cells with incompatible modes (Simo and Armero 1992), held as internal nodes without mass.

#![allow(non_snake_case)]

mod bending;
mod motions;
mod reference;

use emmy::body::{Body, Formulation, InitialVelocity, Region};
use emmy::material::{Material, NeoHooke, NeoHookeIsochoric, Volumetric};
use emmy::mesh::{CellKind, Mesh, MeshBuilder};

/// A region whose cells have modes.
fn with_modes(material: impl Material, density: f64) -> Region {
    Region::new(material, density).with_formulation(Formulation::IncompatibleModes)
}

fn rubber() -> Region {
    with_modes(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0)
}

/// Number of degrees of freedom of the nodes of the mesh.
fn of_mesh(body: &Body) -> usize {
    body.mesh().n_dofs()
}

/// The unit cube (square) cut in two across its first coordinate, with its corners moved: the body of `mixed.json`.
fn distorted_pair(kind: CellKind) -> Mesh {
    let mut builder = MeshBuilder::new();
    let layers = if kind == CellKind::Hex8 { 2 } else { 1 };
    for place in 0..6 * layers {
        let [a, b, c] = [0.5 * f64::from(place % 3), f64::from(place / 3 % 2), f64::from(place / 6)];
        let lift = if layers == 2 { a * c } else { a * b };
        let X = [2.0 * a + 0.1 * (2.0 * b).sin(), b + 0.15 * lift, c - 0.1 * a * b];
        builder.point(if layers == 2 { X } else { [X[0], X[1], 0.0] });
    }
    for first in [0, 1] {
        let corners = [0, 1, 4, 3, 6, 7, 10, 9].map(|corner| corner + first);
        builder.cell(kind, &corners[..4 * layers as usize]).unwrap();
    }
    builder.build().unwrap()
}

/// The spin of the cases of `mixed.json`.
fn spin() -> InitialVelocity {
    InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.4, 0.0, 0.0], [0.0, -0.25, 0.0], [0.0, 0.0, -0.15]],
        ..Default::default()
    }
}

/// The material of the cases with modes in `mixed.json`.
fn isochoric() -> NeoHookeIsochoric {
    NeoHookeIsochoric::new(20.0, 40.0, Volumetric::SimoTaylor).unwrap()
}

/// A spinning, stretching pair of distorted cells.
fn pair() -> Body {
    Body::builder(distorted_pair(CellKind::Hex8)).region(with_modes(isochoric(), 1.0)).build().unwrap()
}

fn close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0f64, |size, x| size.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance * size, "{what}: {found} instead of {expected}");
    }
}
