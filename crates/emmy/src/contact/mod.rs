//! Contact: thin layers on surfaces that store energy where something comes near.
//!
//! A contact point is a fixed combination of the nodes of a facet, with an area in the reference configuration. Its
//! layer has an energy per area that is zero from a distance on and infinite at distance zero, so nothing passes
//! through it, and an energy-momentum scheme keeps the sum of all energies: the force of a step is a discrete gradient.

mod apart;
mod candidates;
mod closest;
mod correction;
mod layer;
mod links;
mod obstacle;
mod pair;
mod path;
mod step;
mod surface;
mod surface_layer;
mod surface_state;
#[cfg(test)]
mod tests;
mod tree;

pub use apart::Intersection;
pub use candidates::{Candidate, Candidates};
pub use closest::{ActiveFace, Closest, PairKind, PairTangent, PairVectors};
pub use layer::{Layer, LayerLaw, LayerOf};
pub use links::PairState;
pub use obstacle::{MAX_STAGES, ObstacleLayer, ObstacleSurface, PointPath};
pub use pair::Pair;
pub use path::paths_meet;
pub use step::PairStage;
pub use surface::{Surface, SurfaceBody, SurfaceEdge, SurfaceFacet, SurfacePoint, SurfaceTriangle};
pub use surface_layer::{ActingPair, SurfaceLayer, SurfaceMemory};
pub use surface_state::{NEAR, SurfaceNode, SurfaceSearch, SurfaceState};
pub use tree::{Bounds, BoxTree};
