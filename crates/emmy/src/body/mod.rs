//! The body: the semidiscrete Hamiltonian system of section 2. Terms, mass, loads, supports, invariants.

#![allow(non_snake_case)]

mod batches;
mod builder;
mod drive;
mod driven;
mod facets;
mod field;
mod field_load;
pub mod fields;
mod followers;
mod geometry;
mod input;
mod integral;
mod invariants;
mod load_vector;
mod loads;
mod mass;
mod models;
mod nodal;
mod pressure;
mod regions;
mod signal;
mod solid;
mod start;
mod step;
mod supports;
mod symmetry;
mod system;
mod term;
mod time_function;
mod viscosity;

pub use builder::BodyBuilder;
pub use field::Field;
pub use geometry::CellTable;
pub use input::{
    FieldDomain, GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind, PointMass, PointTerms,
    Region, Rotation, Support,
};
pub use integral::Scratch;
pub use invariants::sum;
pub use loads::LoadResultant;
pub use mass::MassSolver;
pub use models::{MODELS, RegionModel};
pub use regions::RegionSummary;
pub use signal::{Signal, SignalTarget};
pub use step::{StepDamping, StepInput};
pub use symmetry::symmetry_axis;
pub use system::{Assembly, Body};
pub use term::{StrainState, Term};
pub use time_function::TimeFunction;
pub use viscosity::Viscosity;
