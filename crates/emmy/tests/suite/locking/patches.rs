//! Constant strain in distorted cells, of one kind or of several: a projection changes nothing.

use emmy::body::{Formulation, PressureSpace};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::element::element;
use emmy::internals::quadrature::gauss;
use emmy::internals::sparse::null_space;
use emmy::prelude::*;

use std::collections::HashMap;

use crate::shared::cells::cells_of_a_brick;
use crate::shared::stiffness::stiffness;

const H: [[f64; 3]; 3] = [[0.1, 0.05, 0.0], [-0.03, 0.2, 0.0], [0.0, 0.0, -0.15]];

/// A row of distorted bricks, each divided into cells of a kind.
pub(super) fn row(kinds: &[CellKind]) -> Mesh {
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    for (brick, &kind) in kinds.iter().enumerate() {
        for corners in cells_of_a_brick(kind) {
            let mut N = vec![0.0; corners.len()];
            let mut node = |&xi: &[f64; 3]| {
                element(kind.linear()).shape(xi, &mut N);
                let on = |of: &dyn Fn([f64; 3]) -> [f64; 3]| {
                    let corners = corners.iter().map(|&[x, y, z]| of([x + brick as f64, y, z]));
                    corners.zip(&N).fold([0.0; 3], |sum, (c, N)| [0, 1, 2].map(|i| sum[i] + N * c[i]))
                };
                // Straight edges, so that the nodes between corners fit those of all kinds.
                let (place, position) = (on(&|c| c), on(&|c| distorted(c, kind.dimension())));
                let key = place.map(|x| (1e6 * x).round() as i64);
                *nodes.entry(key).or_insert_with(|| builder.point(position))
            };
            let cell: Vec<u32> = element(kind).nodes().iter().map(&mut node).collect();
            builder.cell(kind, &cell).unwrap();
        }
    }
    builder.build().unwrap()
}

/// Places of corners; those of the faces between bricks stay in a plane, which pyramids and wedges need.
fn distorted([x, y, z]: [f64; 3], dimension: usize) -> [f64; 3] {
    let plane = [1.2 * x + 0.15 * y + 0.1 * x * y, y + 0.1 * x * (1.0 - 0.5 * y), 0.0];
    match dimension {
        2 => plane,
        _ => [plane[0] + 0.1 * z, plane[1] + 0.07 * z * x, z * (1.0 + 0.1 * x) - 0.1 * y],
    }
}

/// The stage forces of two points of time with constant strains, by the standard rule, and the energy at the start.
fn forces_and_energy(mesh: &Mesh, region: Region) -> (Vec<f64>, f64) {
    let body = Body::builder(mesh.clone()).region(region).build().unwrap();
    let is_plane = mesh.cells().all(|cell| cell.kind.dimension() == 2);
    let field = |factor: f64| {
        let gradient =
            |i: usize, j: usize| if is_plane && (i == 2 || j == 2) { 0.0 } else { factor * H[i][j] };
        let u = move |X: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| gradient(i, j) * X[j]).sum::<f64>());
        mesh.points().iter().flat_map(u).collect::<Vec<f64>>()
    };
    let rates: Vec<f64> = [field(0.3), field(-0.2)].concat();
    let displacement = field(1.0);
    let step = StepInput {
        rule: &Rule::standard(2, &gauss(2)),
        tangent_factor: 1.0,
        displacement: &displacement,
        rates: &rates,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let mut assembly = body.assembly(step.rule);
    body.assemble(&step, Request::Stress, &[0.0], &mut assembly).unwrap();
    let mut forces = vec![0.0; 2 * body.n_dofs()];
    assembly.matrix.copy_force(&mut forces);
    (forces, body.strain_energy(&displacement))
}

fn assert_unchanged(name: &str, mesh: &Mesh, formulation: Formulation) {
    let quality = mesh::quality(mesh);
    assert!(quality.inverted.is_empty() && quality.scaled_jacobian.value < 0.99, "{name}: {quality:?}");
    let materials: [fn() -> Region; 3] = [
        || Region::new(NeoHookeIsochoric::new(0.5, 20.0, Volumetric::Quadratic).unwrap(), 1.0),
        || Region::new(NeoHooke::new(20.0, 0.5).unwrap(), 1.0),
        || Region::new(SaintVenantKirchhoff::new(20.0, 0.5).unwrap(), 1.0),
    ];
    for region in materials {
        let (expected, energy) = forces_and_energy(mesh, region());
        let (found, projected) = forces_and_energy(mesh, region().with_formulation(formulation));
        let size = expected.iter().fold(0f64, |size, f| size.max(f.abs()));
        let error = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(size > 0.1 && error < 1e-13 * size.max(10.0), "{name}: {error:e} of {size}");
        assert!((projected / energy - 1.0).abs() < 1e-13, "{name}: {projected} {energy}");
    }
}

#[test]
fn constant_strain_has_the_forces_of_the_standard_formulation() {
    for kind in CellKind::ALL {
        for &space in kind.info().pressures {
            let formulation = Formulation::ProjectedVolume(Some(space));
            assert_unchanged(&format!("{kind}, {space}"), &row(&[kind, kind]), formulation);
        }
    }
}

/// Every pair of kinds that share a face.
#[test]
fn cells_of_several_kinds_pass_the_patch_test() {
    use CellKind::{Hex8, Hex20, Pyramid5, Pyramid13, Quad4, Quad8, Tri3, Tri6, Wedge6, Wedge15};
    let projected = Formulation::ProjectedVolume(None);
    for kinds in
        [&[Hex8, Wedge6, Pyramid5, Hex8][..], &[Hex20, Wedge15, Pyramid13, Hex20], &[Quad8, Tri6, Quad8]]
    {
        assert_unchanged(&format!("{kinds:?}"), &row(kinds), projected);
    }
    // A region that also holds cells whose volume cannot be projected is rejected.
    let region = Region::new(NeoHooke::new(20.0, 0.5).unwrap(), 1.0).with_formulation(projected);
    let error = Body::builder(row(&[Quad4, Tri3])).region(region).build().unwrap_err();
    assert!(error.to_string().contains("tri6"), "{error}");
}

/// Two formulations in one body, and two spaces of the pressure.
#[test]
fn regions_have_their_own_formulations() {
    let mesh = row(&[CellKind::Quad9, CellKind::Quad9, CellKind::Quad9]);
    let groups = |builder: &mut MeshBuilder| (0..3).for_each(|i| builder.cell_group(&i.to_string(), [i]));
    let mut builder = MeshBuilder::new();
    mesh.points().iter().for_each(|&point| _ = builder.point(point));
    mesh.cells().for_each(|cell| _ = builder.cell(cell.kind, cell.nodes).unwrap());
    groups(&mut builder);
    let mesh = builder.build().unwrap();
    let material = || NeoHookeIsochoric::new(0.5, 20.0, Volumetric::SimoTaylor).unwrap();
    let energy = |formulations: [Formulation; 3]| {
        let regions = formulations.into_iter().enumerate().map(|(i, formulation)| {
            Region::new(material(), 1.0).on(i.to_string()).with_formulation(formulation)
        });
        let body = Body::builder(mesh.clone()).regions(regions).build().unwrap();
        let u = |X: &[f64; 3]| [0.1 * X[0] + 0.05 * X[1], 0.1 * X[1] - 0.03 * X[0], 0.0];
        body.strain_energy(&mesh.points().iter().flat_map(u).collect::<Vec<f64>>())
    };
    let standard = energy([Formulation::Standard; 3]);
    let of = |space| Formulation::ProjectedVolume(Some(space));
    let mixed = energy([Formulation::Standard, of(PressureSpace::Linear), of(PressureSpace::Constant)]);
    assert!((mixed / standard - 1.0).abs() < 1e-13, "{mixed} {standard}");
}

/// Number of independent displacements of a single undistorted cell at rest that have no energy.
fn n_without_energy(kind: CellKind, region: Region) -> usize {
    null_space(&stiffness(kind, region).concat()).unwrap().len()
}

/// Nothing but rigid motions (and a translation out of the plane) is without energy, even where the projection leaves
/// no volumetric energy at the points; conformal maps would be, with constants on complete quadratics.
#[test]
fn no_cell_deforms_without_energy() {
    for kind in CellKind::ALL {
        let rigid = if kind.dimension() == 2 { 4 } else { 6 };
        for &space in kind.info().pressures {
            for bulk_modulus in [1.0, 100.0] {
                let rubber = NeoHookeIsochoric::new(1.0, bulk_modulus, Volumetric::Quadratic).unwrap();
                let region = Region::new(rubber, 1.0);
                let region = region.with_formulation(Formulation::ProjectedVolume(Some(space)));
                assert_eq!(n_without_energy(kind, region), rigid, "{kind}, {space}, K = {bulk_modulus}");
            }
        }
    }
}
