//! Results of an adjoint motion.

/// Derivatives of a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// By the displacement at the start, `[n_nodes][3]` \[goal/length\]; zero at fixed degrees of freedom, like the
    /// others.
    pub displacement: Vec<f64>,
    /// By the velocity at the start \[goal time/length\]; the momentum changes with it.
    pub velocity: Vec<f64>,
    /// By the momentum at the start, `M^-1` times the derivative by the velocity \[goal time/(mass length)\].
    pub momentum: Vec<f64>,
    /// By the parameters, in their order; displacement and velocity at the start do not change with them.
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
