//! Blocks of rubber.

use emmy::body::{Body, Formulation, InitialVelocity, Load, Region};
use emmy::material::NeoHooke;
use emmy::mesh::{self, Mesh};
use emmy::motion::State;

/// A soft block of two cells that turns and bends.
pub(crate) fn soft_block() -> (Body, State) {
    launched(soft_block_under(&[]))
}

/// The soft block with incompatible modes.
pub(crate) fn soft_block_with_modes() -> (Body, State) {
    let region = rubber().with_formulation(Formulation::IncompatibleModes);
    launched(Body::builder(two_cells()).region(region).build().unwrap())
}

fn launched(body: Body) -> (Body, State) {
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
    Body::builder(two_cells()).region(rubber()).loads(loads).build().unwrap()
}

fn two_cells() -> Mesh {
    mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap()
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0)
}
