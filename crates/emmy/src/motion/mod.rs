//! Marching: step plan, balances, records, observers.

mod adaptive;
mod adaptivity;
mod control;
mod degree_choice;
mod error_norm;
mod event;
mod failure;
mod global_error;
mod march;
mod observer;
mod plan;
mod record;
pub(crate) mod resolution;
mod samples;
mod snapshot;
mod statistics;
mod step;
mod stepping;
pub(crate) mod subdivision;

pub use crate::newton::NewtonSettings;
pub use crate::sparse::Solver;
pub use crate::time::State;
pub use adaptivity::Adaptivity;
pub use error_norm::ErrorNorm;
pub use event::{Event, EventKind};
pub use global_error::GlobalError;
pub use observer::{MarchError, Observer, ObserverError, ObserverResult, View};
pub use plan::{Phase, PlannedStep, StepPlan};
pub use record::Record;
pub(crate) use resolution::Resolution;
pub use samples::{Sampler, Samples};
pub use snapshot::Snapshot;
pub use statistics::{Extreme, LargestDisplacement, RunStatistics};
pub use stepping::Motion;
pub(crate) use subdivision::Subdivision;
