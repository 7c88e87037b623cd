//! Points with masses, and links between them.

use emmy::body::{Body, InitialVelocity, PointMass, PointTerms, Region};
use emmy::material::Link;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};
use emmy::motion::State;

/// Points and links between them; node i is the group `i`.
pub(crate) fn network(points: &[[f64; 3]], links: &[[u32; 2]]) -> Mesh {
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
pub(crate) fn masses(masses: &[f64]) -> Vec<PointMass> {
    masses.iter().enumerate().map(|(i, &mass)| PointMass { group: i.to_string(), mass }).collect()
}

/// Velocity of node i: `velocities[i]`.
pub(crate) fn moving(body: &Body, velocities: &[[f64; 3]]) -> State {
    let field = |(i, &velocity): (usize, &[f64; 3])| InitialVelocity {
        group: Some(i.to_string()),
        velocity,
        ..InitialVelocity::default()
    };
    State::initial(body, 0.0, &velocities.iter().enumerate().map(field).collect::<Vec<_>>()).unwrap()
}

/// Two bodies of masses 2 and 1 that attract each other with g = 3, at their largest distance, 1; `e`: eccentricity of
/// the orbit.
pub(crate) fn orbit(e: f64) -> (Body, State) {
    let mesh = network(&[[1.0 / 3.0, 0.0, 0.0], [-2.0 / 3.0, 0.0, 0.0]], &[[0, 1]]);
    let nodal = PointTerms { masses: masses(&[2.0, 1.0]), ..Default::default() };
    let region = Region::links(Link::attraction(3.0).unwrap(), 0.0);
    let body = Body::builder(mesh).region(region).point_terms(nodal.clone()).build().unwrap();
    // v^2 = g/mu (1 - e)/r at the aphelion r = 1 = a (1 + e), mu = 2/3.
    let v = (4.5 * (1.0 - e)).sqrt();
    let state = moving(&body, &[[0.0, v / 3.0, 0.0], [0.0, -2.0 / 3.0 * v, 0.0]]);
    (body, state)
}
