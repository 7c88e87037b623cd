//! Regions, schemes and bodies that meet in contact.

#![allow(non_snake_case)]

use super::schemes::{DGM, assumed_strain, at, dgm, fe, lobatto};
use emmy::body::{Contact, Formulation};
use emmy::mesh::{MeshBuilder, Placement};
use emmy::prelude::*;

pub(crate) fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
}

/// Regions and energy-momentum schemes with a step size for each, in proportion to a size.
pub(crate) fn conserving(size: f64) -> Vec<(Region, Scheme, f64)> {
    let projected = || rubber().with_formulation(Formulation::ProjectedVolume(None));
    let incompatible = || rubber().with_formulation(Formulation::IncompatibleModes);
    let further = [
        (rubber(), at(assumed_strain(4), 1), size),
        (projected(), at(DGM, 1), size),
        (projected(), at(DGM, 2), 2.0 * size),
        (incompatible(), at(DGM, 1), size),
        (incompatible(), at(DGM, 3), 2.0 * size),
    ];
    (1..=8).map(|k| (rubber(), at(DGM, k), 0.0025 * (k + 1) as f64)).chain(further).collect()
}

/// The other schemes with a step size for each, in proportion to a size.
pub(crate) fn others(size: f64) -> [(Scheme, f64); 7] {
    [
        (at(fe(2), 1), size),
        (at(fe(4), 2), 2.0 * size),
        (at(lobatto(4), 3), 2.0 * size),
        (Scheme::from_name("HHT(0)").unwrap(), size),
        (Scheme::from_name("Bathe").unwrap(), size),
        (Scheme::CentralDifferences, 0.4 * size),
        (at(dgm(0.8), 2), 2.0 * size),
    ]
}

/// Meshes at their places as one, with groups of cells `a`, `b`, ...
pub(crate) fn joined(parts: &[(Mesh, Placement)]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for ((mesh, placement), name) in parts.iter().zip(["a", "b", "c", "d", "e"]) {
        let nodes: Vec<u32> = mesh.points().iter().map(|X| builder.point(placement.point(*X))).collect();
        let cells: Vec<u32> = mesh
            .cells()
            .map(|cell| {
                let nodes: Vec<u32> = cell.nodes.iter().map(|node| nodes[*node as usize]).collect();
                builder.cell(cell.kind, &nodes).unwrap()
            })
            .collect();
        builder.cell_group(name, cells);
    }
    builder.build().unwrap()
}

pub(crate) fn contact() -> Contact {
    Contact::between("a", "b").with_stiffness(1333.0).with_distance(0.05)
}

pub(crate) fn spinning(group: &str, velocity: [f64; 3], spin: [f64; 3], about: [f64; 3]) -> InitialVelocity {
    InitialVelocity {
        group: Some(group.into()),
        velocity,
        angular_velocity: spin,
        about,
        ..InitialVelocity::default()
    }
}

/// Two blocks that fly against each other, with some cells along their edges.
pub(crate) fn two_blocks(n: [usize; 2]) -> (Mesh, [InitialVelocity; 2]) {
    let [a, b] = n.map(|n| mesh::block([1.0; 3], [n; 3]).unwrap());
    let corner = [0.23, 1.07, 0.17];
    let mesh = joined(&[(a, Placement::default()), (b, Placement::default().shifted(corner))]);
    let velocities = [
        spinning("a", [0.0, 1.0, 0.0], [0.5, -0.3, 0.8], [0.5; 3]),
        spinning("b", [0.1, -1.0, 0.0], [-0.35, 0.21, -0.56], corner.map(|x| x + 0.5)),
    ];
    (mesh, velocities)
}
