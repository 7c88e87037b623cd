//! Marching: step plan, balances, records, observers.

mod march;
mod plan;
mod record;

pub use crate::newton::NewtonSettings;
pub use crate::time::State;
pub use march::Motion;
pub use plan::{Phase, PlannedStep, StepPlan};
pub use record::{MarchError, Observer, Record, View};
