//! Error of a motion since its start, by a simultaneous motion of higher degree.

use super::stepping::due_release;
use super::{Observer, ObserverResult, View};
use crate::body::Body;
use crate::error::Result;
use crate::input::SAME_TIME;
use crate::newton::NewtonSettings;
use crate::time::{Scheme, State, Stepper};

/// Estimates the error of a motion since its start: an observer that repeats the steps with the element of degree k +
/// 1.
///
/// ```math
/// u_h - u ~ u_h - u_h^(k+1)
/// ```
///
/// The motion has an error of order 2k, the other one of order 2k + 2, so that the estimate is exact in the limit of
/// small steps; it is as good as the steps resolve the motion. Modes that no step resolves are wrong in both, in
/// different ways; then the difference has the size of their vibration. Unlike sums of local errors, the estimate
/// includes the growth of errors. It costs one step of degree k + 1 per step.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::motion::GlobalError;
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 1.0], about: [0.5; 3], ..Default::default() };
/// let (element, settings) = (TimeElement::discrete_gradient(1)?, NewtonSettings::default());
/// let state = State::initial(&body, 0.0, &[spin])?;
/// let mut error = GlobalError::new(&body, element, settings, &state)?;
/// let mut motion = Motion::starting(&body, element, settings, state)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.1 }])?, &mut [&mut error])?;
/// // A rigid body lags behind by t h^2 omega^3/12 = 8.3e-4; its radius of gyration is 1/sqrt 2, by the lumped mass of its corners.
/// assert!((body.mass_weighted_rms(error.displacement()) / (8.3e-4 / f64::sqrt(2.0)) - 1.0).abs() < 0.1);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct GlobalError<'a> {
    body: &'a Body,
    scheme: Scheme,
    settings: NewtonSettings,
    stepper: Box<dyn Stepper + 'a>,
    state: State,
    /// The state at the start of a step.
    start: State,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl<'a> GlobalError<'a> {
    /// The estimator of a motion of a scheme that starts from a state; if degrees are chosen, the scheme of the highest
    /// one.
    ///
    /// # Errors
    /// As [`Scheme::stepper`], for the next degree.
    pub fn new(
        body: &'a Body,
        scheme: impl Into<Scheme>,
        settings: NewtonSettings,
        state: &State,
    ) -> Result<Self> {
        let own = scheme.into();
        let scheme = own.conserving().at_degree(own.degree() + 1)?;
        let mut state = state.clone();
        let stepper = scheme.stepper(body, settings, &mut state)?;
        let zero = vec![0.0; body.n_dofs()];
        Ok(GlobalError {
            body,
            scheme,
            settings,
            stepper,
            start: state.clone(),
            state,
            displacement: zero.clone(),
            velocity: zero,
        })
    }

    /// Error of the positions after the last step, `[n_nodes][3]` \[length\].
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Error of the velocities \[length/time\].
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// The state of the motion of higher degree.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Does a step, in parts if the higher degree does not converge at once.
    fn advance(&mut self, step_size: f64) -> Result<()> {
        self.start.copy_from(&self.state);
        let mut outcome = Ok(());
        for parts in [1, 2, 4, 8, 16] {
            let size = step_size / f64::from(parts);
            outcome = (0..parts).try_for_each(|part| {
                self.state.time = self.start.time + size * f64::from(part);
                self.stepper.advance(&mut self.state, size).map(|_| ())
            });
            if outcome.is_ok() {
                break;
            }
            self.state.copy_from(&self.start);
        }
        outcome
    }

    /// Repeats the step that led to a state.
    fn follow(&mut self, state: &State, step_size: f64) -> Result<()> {
        while let Some((_, body)) = due_release(self.body, self.state.time, SAME_TIME * step_size) {
            self.stepper = self.scheme.stepper(body, self.settings, &mut self.state)?;
            self.body = body;
        }
        self.advance(step_size)?;
        (self.state.time, self.state.step) = (state.time, state.step);
        let pairs = [
            (&mut self.displacement, &state.displacement, &self.state.displacement),
            (&mut self.velocity, &state.velocity, &self.state.velocity),
        ];
        for (difference, own, better) in pairs {
            let terms = own.iter().zip(better);
            difference
                .iter_mut()
                .zip(terms)
                .for_each(|(difference, (own, better))| *difference = own - better);
        }
        Ok(())
    }
}

impl Observer for GlobalError<'_> {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        if view.state.step > self.state.step {
            self.follow(view.state, view.record.step_size)?;
        }
        Ok(())
    }
}
