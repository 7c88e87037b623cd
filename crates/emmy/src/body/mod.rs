//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod batches;
mod builder;
mod drive;
mod driven;
mod elimination;
pub(crate) mod entries;
mod facets;
mod field;
mod field_load;
mod fields;
mod followers;
mod frequency_bound;
mod geometry;
mod held;
mod input;
mod integral;
mod internal_nodes;
pub(crate) mod invariants;
mod load_vector;
mod loads;
mod mass;
pub(crate) mod models;
mod nodal;
pub(crate) mod pole;
mod pressure;
mod pressures;
mod projection;
mod proportional;
mod reactions;
mod reductions;
mod regions;
mod signal;
mod solid;
mod spread;
mod start;
pub(crate) mod step;
mod supports;
pub(crate) mod symmetry;
pub(crate) mod system;
mod target;
mod team;
mod term;
mod terms;
mod time_function;
mod viscosity;

pub use crate::element::{Formulation, PressureSpace};
pub use builder::BodyBuilder;
pub(crate) use entries::Entries;
pub use field::Field;
pub(crate) use field_load::LoadMemory;
pub use fields::{FieldName, FieldValues, Fields, Place, Selection};
pub(crate) use geometry::CellTable;
pub use input::{
    FieldDomain, GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind, PointMass, PointTerms,
    Region, Rotation, SpreadMass, Support,
};
pub(crate) use integral::Scratch;
pub(crate) use invariants::sum;
pub use loads::LoadResultant;
pub(crate) use mass::MassSolver;
pub use reactions::Reaction;
pub use regions::RegionSummary;
pub(crate) use signal::{MAX_COMPONENTS, Signal};
pub(crate) use step::{StepDamping, StepInput};
pub(crate) use system::Assembly;
pub use system::Body;
pub(crate) use target::SignalTarget;
pub(crate) use term::{StrainState, Term};
pub use time_function::TimeFunction;
pub use viscosity::Viscosity;
