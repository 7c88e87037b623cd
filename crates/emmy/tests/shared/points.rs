//! Points with masses, and links between them. No test needs all of it.
#![allow(dead_code)]

use emmy::body::{Body, InitialVelocity, PointMass};
use emmy::mesh::{CellKind, Mesh, MeshBuilder};
use emmy::motion::State;

/// Points and links between them; node i is the group `i`.
pub fn network(points: &[[f64; 3]], links: &[[u32; 2]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for (index, &point) in points.iter().enumerate() {
        let node = builder.point(point);
        builder.node_group(&index.to_string(), [node]);
    }
    for link in links {
        builder.cell(CellKind::Line2, link).unwrap();
    }
    builder.build().unwrap()
}

/// Mass of node i: `masses[i]`.
pub fn masses(masses: &[f64]) -> Vec<PointMass> {
    masses.iter().enumerate().map(|(i, &mass)| PointMass { group: i.to_string(), mass }).collect()
}

/// Velocity of node i: `velocities[i]`.
pub fn moving(body: &Body, velocities: &[[f64; 3]]) -> State {
    let field = |(i, &velocity): (usize, &[f64; 3])| InitialVelocity {
        group: Some(i.to_string()),
        velocity,
        ..InitialVelocity::default()
    };
    State::initial(body, 0.0, &velocities.iter().enumerate().map(field).collect::<Vec<_>>()).unwrap()
}
