//! The parts of a body besides its mesh: regions, masses and springs at nodes, supports, loads, initial velocity,
//! and the functions of time and place in them. Plain data.

#![allow(non_snake_case)]

mod contact;
mod coupling;
mod field;
mod initial_velocity;
mod joint;
mod load;
pub(crate) mod models;
mod points;
pub(crate) mod pole;
mod region;
mod region_material;
mod rigid_body;
mod span;
mod support;
pub(crate) mod symmetry;
mod target;
mod tie;
pub(crate) mod time_function;
mod viscosity;

pub(crate) use contact::ContactFault;
pub use contact::{Contact, Obstacle, Opponent};
pub use coupling::Coupling;
pub use field::Field;
pub use initial_velocity::InitialVelocity;
pub use joint::{Joint, JointEnd, JointKind, JointSpring};
pub use load::{FieldDomain, Load, LoadKind};
pub use points::{GroundAttraction, GroundSpring, PointMass, PointTerms, SpreadMass};
pub use region::Region;
pub(crate) use region_material::RegionMaterial;
pub use rigid_body::RigidBody;
pub(crate) use span::SAME_TIME;
pub use span::Span;
pub use support::{Rotation, Support};
pub(crate) use target::SignalTarget;
pub use tie::{Tie, TieKind};
pub(crate) use time_function::NotFinite;
pub use time_function::TimeFunction;
pub use viscosity::Viscosity;
