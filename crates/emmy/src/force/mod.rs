//! Forces on the nodes of a body: cells, links, springs and attractions to the ground, pressures, dead loads.

#![allow(non_snake_case)]

pub(crate) mod batches;
pub(crate) mod cells;
mod facets;
pub(crate) mod field_load;
pub(crate) mod ground;
pub(crate) mod integral;
pub(crate) mod load_vector;
pub(crate) mod pressure;
pub(crate) mod pressures;
pub(crate) mod projection;
mod solid;
pub(crate) mod step;
pub(crate) mod term;

pub(crate) use field_load::{FieldLoad, LoadMemory};
pub(crate) use integral::Scratch;
pub(crate) use load_vector::LoadVector;
pub(crate) use pressure::Pressure;
pub(crate) use step::{StepDamping, StepInput};
pub(crate) use term::{StrainState, Term};
