//! Forces on the nodes of a body, one file each: cells and links, springs and attractions to the ground, loads, drag.

#![allow(non_snake_case)]

mod attraction;
mod batches;
pub(crate) mod cells;
mod centrifugal;
mod contact;
mod contact_summary;
pub(crate) mod dead;
mod drag;
mod facets;
mod field_load;
mod frame_load;
mod integral;
mod interface;
mod list;
mod load;
pub(crate) mod pressures;
pub(crate) mod projection;
pub(crate) mod signal;
pub(crate) mod solid;
pub(crate) mod source;
mod spring;
pub(crate) mod step;
mod strain_state;
mod surface_pressure;

pub use contact_summary::ContactSummary;
pub(crate) use drag::Drag;
pub(crate) use integral::Scratch;
pub(crate) use interface::{Book, Force, ForceMemory, OverTime, Side};
pub(crate) use list::{Cells, Forces};
pub(crate) use pressures::{PressureCells, PressureResults};
pub(crate) use signal::{MAX_COMPONENTS, Signal};
pub(crate) use source::{ForceSource, Site};
pub(crate) use step::{Sampling, StepDamping, StepInput, StepStart};
pub(crate) use strain_state::ContactAtNode;
pub use strain_state::StrainState;
