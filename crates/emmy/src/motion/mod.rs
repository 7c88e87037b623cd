//! Marching: step plan, balances, records, observers.

mod adaptive;
mod adaptivity;
mod degrees;
mod division;
mod error_norm;
mod event;
mod global_error;
mod march;
mod plan;
mod record;
mod resolution;
mod samples;
mod snapshot;
mod statistics;

pub use crate::newton::NewtonSettings;
pub use crate::time::State;
pub use adaptivity::{Adaptivity, Controller};
pub use division::{Division, GOOD_STEPS};
pub use error_norm::ErrorNorm;
pub use event::{Event, EventKind};
pub use global_error::GlobalError;
pub use march::Motion;
pub use plan::{Phase, PlannedStep, StepPlan};
pub use record::{MarchError, Observer, Record, View};
pub use resolution::{Resolution, Unresolved};
pub use samples::{Sampler, Samples};
pub use snapshot::Snapshot;
pub use statistics::{Extreme, LargestDisplacement, RunStatistics};
