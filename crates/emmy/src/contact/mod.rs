//! Contact: thin layers on surfaces that store energy where something comes near.
//!
//! A contact point is a fixed combination of the nodes of a facet, with an area in the reference configuration. Its
//! layer has an energy per area that is zero from a distance on and infinite at distance zero, so nothing passes through
//! it, and an energy-momentum scheme keeps the sum of all energies: the force of a step is a discrete gradient.

mod layer;
mod obstacle;

pub use layer::{Layer, LayerLaw};
pub use obstacle::{Obstacle, ObstacleLayer, Path};
