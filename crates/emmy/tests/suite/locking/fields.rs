//! Output fields of cells with a projected volume.

#![allow(non_snake_case)]

use crate::shared::patch::Patch;
use emmy::body::{Body, FieldName, Fields, Formulation, Region};
use emmy::material::{NeoHooke, NeoHookeIsochoric, SaintVenantKirchhoff, Volumetric};
use emmy::mesh::{CellKind, Mesh, block, rectangle};

const PROJECTED: Formulation = Formulation::ProjectedVolume(None);
const MU: f64 = 0.5;
const BULK: f64 = 400.0;

/// Nearly incompressible materials of both measures of the volume.
fn regions() -> [Region; 3] {
    [
        Region::new(NeoHookeIsochoric::new(MU, BULK, Volumetric::Quadratic).unwrap(), 1.0),
        Region::new(NeoHooke::new(BULK, MU).unwrap(), 1.0),
        Region::new(SaintVenantKirchhoff::new(BULK, MU).unwrap(), 1.0),
    ]
}

fn rubber() -> Region {
    let [rubber, ..] = regions();
    rubber.with_formulation(PROJECTED)
}

fn body(mesh: Mesh, region: Region) -> Body {
    Body::builder(mesh).region(region).build().unwrap()
}

fn patch(kind: CellKind) -> Mesh {
    Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(kind)
}

fn at(body: &Body, displacement: &[f64], names: &[FieldName]) -> Vec<Vec<f64>> {
    let rest = vec![0.0; displacement.len()];
    Fields::new(body).at([displacement, &rest[..]], names).into_iter().map(|field| field.numbers).collect()
}

/// A smooth displacement with strains of a tenth, which changes volumes by as much.
fn bent(mesh: &Mesh) -> Vec<f64> {
    let u = |[x, y, z]: [f64; 3]| {
        [0.1 * (y + 0.3 * x * x).sin(), 0.08 * x * y + 0.03 * y * y, 0.06 * z * (x - y)]
    };
    mesh.points().iter().flat_map(|&X| u(X)).collect()
}

const STATE: [FieldName; 7] = [
    FieldName::CauchyStress,
    FieldName::SecondPiolaKirchhoffStress,
    FieldName::PrincipalStretches,
    FieldName::StrainEnergyDensity,
    FieldName::CellCauchyStress,
    FieldName::CellPressure,
    FieldName::CellStrainEnergyDensity,
];

/// A homogeneous deformation has one volume, which no projection changes.
#[test]
fn fields_of_homogeneous_deformations_are_those_of_the_standard_formulation() {
    let F = [[1.05, 0.1, -0.04], [0.02, 0.93, 0.06], [0.01, -0.05, 1.04]];
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Wedge15] {
        let mesh = patch(kind);
        let place = |X: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| F[i][j] * X[j]).sum::<f64>() - X[i]);
        let displacement: Vec<f64> = mesh.points().iter().flat_map(place).collect();
        for (standard, region) in regions().into_iter().zip(regions()) {
            let expected = at(&body(mesh.clone(), standard), &displacement, &STATE);
            let found = at(&body(mesh.clone(), region.with_formulation(PROJECTED)), &displacement, &STATE);
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                // Rounding of J times the bulk modulus.
                assert!((found - expected).abs() < 1e-12 * BULK, "{kind}: {found} is not {expected}");
            }
        }
    }
}

/// The mean energy density of a cell times its volume is the energy that the body sums over its cells.
#[test]
fn energies_of_projected_cells_add_up_to_the_energy_of_the_body() {
    let meshes =
        [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Wedge15].map(patch);
    for mesh in meshes.into_iter().chain([rectangle([2.0, 1.0], [3, 2]).unwrap()]) {
        let displacement = bent(&mesh);
        for region in regions() {
            let body = body(mesh.clone(), region.with_formulation(PROJECTED));
            let density = at(&body, &displacement, &[FieldName::CellStrainEnergyDensity]).remove(0);
            let fields = Fields::new(&body);
            let energy: f64 = density.iter().enumerate().map(|(cell, W)| W * fields.cell_volume(cell)).sum();
            let expected = body.strain_energy(&displacement);
            assert!((energy - expected).abs() < 1e-12 * expected, "{energy} is not {expected}");
        }
    }
}

/// With W_p isochoric and U = K/2 (J - 1)^2, the pressure of a cell is -K times its relative change of volume, and that
/// of an inner node of equal cells the mean of the eight around it.
#[test]
fn pressures_of_nodes_are_means_of_the_pressures_of_cells() {
    let mesh = block([1.0; 3], [2; 3]).unwrap();
    // An alternating displacement of the middle of each edge: a chequerboard of volumes.
    let displacement: Vec<f64> = bent(&mesh);
    let middle = mesh.points().iter().position(|X| *X == [0.5; 3]).unwrap();
    let body = body(mesh, rubber());
    let names = [FieldName::CellPressure, FieldName::CellVolumeRatio, FieldName::CauchyStress];
    let [pressure, ratio, cauchy] = &at(&body, &displacement, &names)[..] else { unreachable!() };
    for (pressure, ratio) in pressure.iter().zip(ratio) {
        assert!((pressure + BULK * (ratio - 1.0)).abs() < 1e-12 * BULK, "{pressure} {ratio}");
    }
    let spread = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max((x - values[0]).abs()));
    assert!(spread(pressure) > 1.0, "{pressure:?}");
    let mean = pressure.iter().sum::<f64>() / 8.0;
    let of_node = -cauchy[6 * middle..6 * middle + 3].iter().sum::<f64>() / 3.0;
    assert!((of_node - mean).abs() < 1e-11 * BULK, "{of_node} is not {mean}");
}
