//! The interface of observers of a march.

use super::{Event, Motion, Record};
use crate::body::Body;
use crate::error::Error;
use crate::time::State;

/// The motion after a step, as an observer sees it.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The body.
    pub body: &'a Body,
    /// Its state.
    pub state: &'a State,
    /// Energies, momenta, balances.
    pub record: &'a Record,
    /// Norms of the Newton residuals in the step, one for each evaluation. For a step in two parts, only the second
    /// part; empty at the start and for explicit steppers.
    pub newton_residuals: &'a [f64],
    /// The motion itself, for its [`super::Snapshot`] and [`super::RunStatistics`].
    pub motion: &'a Motion<'a>,
}

/// Error of an observer.
pub type ObserverError = Box<dyn std::error::Error + Send + Sync>;

/// Result of an observer.
pub type ObserverResult = Result<(), ObserverError>;

/// An observer of a march: files, progress and plots are attached through this trait.
pub trait Observer {
    /// Called at the start and after every step.
    ///
    /// # Errors
    /// An error of the observer ends the march as [`super::MarchError::Observer`].
    fn observe(&mut self, view: View<'_>) -> ObserverResult;

    /// Called for every event, before the step to which it belongs is observed.
    ///
    /// # Errors
    /// As [`Observer::observe`].
    fn notice(&mut self, _: &Event) -> ObserverResult {
        Ok(())
    }
}

/// Error of a march.
#[derive(Debug, thiserror::Error)]
pub enum MarchError {
    /// A step failed.
    #[error(transparent)]
    Step(#[from] Error),
    /// An observer failed.
    #[error(transparent)]
    Observer(ObserverError),
}

impl From<MarchError> for Error {
    /// The error of the step, or [`Error::Observer`] with the message of an observer.
    fn from(error: MarchError) -> Self {
        match error {
            MarchError::Step(error) => error,
            MarchError::Observer(error) => Error::Observer { message: error.to_string() },
        }
    }
}
