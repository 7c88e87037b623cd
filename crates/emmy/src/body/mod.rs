//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod builder;
mod driven;
mod elimination;
pub(crate) mod entries;
mod fields;
mod followers;
mod frequency_bound;
mod held;
pub(crate) mod invariants;
mod loads;
mod mass;
mod proportional;
mod reactions;
mod reductions;
mod signal;
mod start;
pub(crate) mod system;
mod team;
mod terms;

pub use crate::element::{Formulation, PressureSpace};
pub use crate::input::{
    Field, FieldDomain, GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind, PointMass,
    PointTerms, Region, Rotation, SpreadMass, Support, TimeFunction, Viscosity,
};
pub use crate::mass::RegionSummary;
pub use builder::BodyBuilder;
pub(crate) use entries::Entries;
pub use fields::{FieldName, FieldValues, Fields, Place, Selection};
pub(crate) use invariants::sum;
pub use loads::LoadResultant;
pub(crate) use mass::MassSolver;
pub use reactions::Reaction;
pub(crate) use signal::{MAX_COMPONENTS, Signal};
pub(crate) use system::Assembly;
pub use system::Body;
