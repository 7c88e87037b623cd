//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod builder;
mod constrained_velocity;
mod couplings;
pub(crate) mod entries;
mod fields;
pub(crate) mod forces;
mod frequency_bound;
mod held;
mod held_mechanism;
mod interface;
pub(crate) mod invariants;
mod loads;
mod local_unknowns;
mod mass;
mod proportional;
mod start;
pub(crate) mod system;
mod team;

pub use crate::contact::LayerLaw;
pub use crate::element::{Formulation, PressureSpace};
pub use crate::force::ContactSummary;
pub use crate::input::{
    Contact, Coupling, Field, FieldDomain, GroundAttraction, GroundSpring, InitialVelocity, Joint, JointEnd,
    JointKind, JointSpring, Load, LoadKind, Obstacle, Opponent, PointMass, PointTerms, Region, RigidBody,
    Rotation, SpreadMass, Support, Tie, TieKind, TimeFunction, Viscosity,
};
pub use crate::mass::RegionSummary;
pub use crate::space::{CoupledPoint, Reaction, TieSummary};
pub use crate::sparse::BlockRow;
pub use crate::unknowns::{JointState, Mobility, RigidMotion};
pub use builder::BodyBuilder;
pub(crate) use constrained_velocity::ConstrainedVelocity;
pub(crate) use entries::Entries;
pub use fields::{FieldName, FieldValues, Fields, NodalMotion, Place, Selection};
pub(crate) use forces::Assembly;
pub(crate) use interface::Interface;
pub use loads::LoadResultant;
pub(crate) use local_unknowns::ReusedDamping;
pub(crate) use mass::MassSolver;
pub use system::Body;
