//! Blocks of rubber.

use emmy::body::{Body, InitialVelocity, Load, Region};
use emmy::material::NeoHooke;
use emmy::mesh;
use emmy::motion::State;

/// A soft block of two cells that turns and bends.
pub(crate) fn soft_block() -> (Body, State) {
    let body = soft_block_under(&[]);
    let field = InitialVelocity {
        angular_velocity: [0.5, 1.0, 0.3],
        about: [0.5, 0.5, 1.0],
        gradient: [[0.0, 0.0, 0.3], [0.0, 0.0, 0.0], [0.1, 0.0, 0.2]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[field]).unwrap();
    (body, state)
}

/// The block alone.
pub(crate) fn soft_block_under(loads: &[Load]) -> Body {
    let rubber = Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0);
    Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap())
        .region(rubber)
        .loads(loads)
        .build()
        .unwrap()
}
