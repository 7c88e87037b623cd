//! Results of an adjoint motion.

/// Derivatives of a goal.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::adjoint::{Goal, Trajectory};
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
/// let mut trajectory = Trajectory::new(&motion)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 0.3, size: 0.1 }])?, &mut [&mut trajectory])?;
/// // The displacement of a node at the end grows by the time with the velocity of all nodes.
/// let gradient = trajectory.gradient(&Goal::displacement_at(&body, 0, [1.0, 0.0, 0.0]), &[])?;
/// let shift: f64 = gradient.velocity.iter().step_by(3).sum();
/// assert!((shift - 0.3).abs() < 1e-12);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// By the displacement at the start, `[n_nodes][3]` \[goal/length\]; zero at fixed degrees of freedom, like the
    /// others.
    pub displacement: Vec<f64>,
    /// By the velocity at the start \[goal time/length\]; the momentum changes with it.
    pub velocity: Vec<f64>,
    /// By the momentum at the start, `M^-1` times the derivative by the velocity \[goal time/(mass length)\].
    pub momentum: Vec<f64>,
    /// By the parameters, in their order. The displacement at the start changes with them if it is an equilibrium
    /// ([`crate::motion::State::is_equilibrium`]); any other displacement, and the velocity at the start, do not.
    pub parameters: Vec<f64>,
}

/// Estimated error of a goal, numerical less true value.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalError {
    /// Effect of the local error of each step on the goal.
    pub steps: Vec<f64>,
}

impl GoalError {
    /// The error, with its sign.
    ///
    /// ```
    /// let error = emmy::adjoint::GoalError { steps: vec![0.5, -0.25] };
    /// assert_eq!((error.total(), error.size()), (0.25, 0.75));
    /// ```
    pub fn total(&self) -> f64 {
        self.steps.iter().sum()
    }

    /// Sum of the sizes of the terms: the error if none of them cancelled.
    pub fn size(&self) -> f64 {
        self.steps.iter().map(|term| term.abs()).sum()
    }
}
