//! The interface of observers of a march.

use super::{Event, Motion, Record};
use crate::body::Body;
use crate::error::Error;
use crate::time::State;

/// The motion after a step, as an observer sees it.
///
/// ```
/// use emmy::motion::{Observer, ObserverResult, View};
/// struct Peak(f64);
/// impl Observer for Peak {
///     fn observe(&mut self, view: View<'_>) -> ObserverResult {
///         self.0 = self.0.max(view.record.strain_energy);
///         Ok(())
///     }
/// }
/// ```
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

impl Motion<'_> {
    /// The motion as observers see it.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
    /// assert_eq!(motion.view().record.time, 0.0);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn view(&self) -> View<'_> {
        View {
            body: self.body(),
            state: self.state(),
            record: self.record(),
            newton_residuals: self.stepper().newton_history(),
            motion: self,
        }
    }
}

/// Error of an observer.
///
/// ```
/// let error: emmy::motion::ObserverError = "the disk is full".into();
/// assert_eq!(error.to_string(), "the disk is full");
/// ```
pub type ObserverError = Box<dyn std::error::Error + Send + Sync>;

/// Result of an observer.
///
/// ```
/// let result: emmy::motion::ObserverResult = Err("the disk is full".into());
/// assert!(result.is_err());
/// ```
pub type ObserverResult = Result<(), ObserverError>;

/// An observer of a march: files, progress and plots are attached through this trait.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::motion::{Observer, ObserverResult, View};
/// // Keeps the time of each step.
/// struct Times(Vec<f64>);
/// impl Observer for Times {
///     fn observe(&mut self, view: View<'_>) -> ObserverResult {
///         self.0.push(view.record.time);
///         Ok(())
///     }
/// }
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
/// let state = State::initial(&body, 0.0, &[flight])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// let mut times = Times(Vec::new());
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.5 }])?, &mut [&mut times])?;
/// assert_eq!(times.0, [0.0, 0.5, 1.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
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
///
/// ```
/// use emmy::motion::MarchError;
/// let error: emmy::Error = MarchError::Observer("the disk is full".into()).into();
/// assert!(error.to_string().contains("the disk is full"));
/// ```
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
