//! Input of a body besides its mesh: regions, point terms, supports, loads, initial velocity. Plain data.

mod initial_velocity;
mod load;
mod points;
mod region;
mod support;

pub use initial_velocity::InitialVelocity;
pub use load::{FieldDomain, Load, LoadKind};
pub use points::{GroundAttraction, GroundSpring, PointMass, PointTerms, SpreadMass};
pub use region::Region;
pub use support::{Rotation, Support};
