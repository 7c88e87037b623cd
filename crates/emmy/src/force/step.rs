//! A step, as the forces need it.

use crate::average::{FollowerRule, Rule};
use crate::error::Result;
use crate::input::Span;

/// A step, as the forces need it.
#[derive(Debug, Clone, Copy)]
pub struct StepInput<'a> {
    /// Averaging rule.
    pub rule: &'a Rule,
    /// Factor on the derivatives df_i/dx_j (h^2 in the stage equations).
    pub tangent_factor: f64,
    /// Displacement at the start, `[n_nodes][3]`.
    pub displacement: &'a [f64],
    /// Rates x_j of the displacement, `[k][n_nodes][3]`.
    pub rates: &'a [f64],
    /// Coordinates of the joints at the start, angles counted over full turns, `[n_joints]`; empty: angles within half
    /// a turn.
    pub coordinates: &'a [f64],
    /// Damping of the strain rates.
    pub damping: StepDamping,
    /// Local unknowns, such as the pressures of cells with a projected volume, `[function][l]`; `None`: those of the
    /// deformation.
    pub local: Option<&'a [f64]>,
}

impl<'a> StepInput<'a> {
    /// A step for its forces alone, without derivatives and damping.
    pub(crate) fn undamped(rule: &'a Rule, displacement: &'a [f64], rates: &'a [f64]) -> Self {
        StepInput {
            rule,
            tangent_factor: 0.0,
            displacement,
            rates,
            coordinates: &[],
            damping: StepDamping::default(),
            local: None,
        }
    }

    /// Displacement of a degree of freedom at the node of a stage, where constraints hold. Forces act at the points of
    /// the rule, [`StepStart::points`].
    pub(crate) fn displacement_in(&self, stage: usize, dof: usize) -> f64 {
        let k = self.rule.degree();
        self.displacement_at(&self.rule.coefficients()[stage * k..(stage + 1) * k], dof)
    }

    /// Displacement of a degree of freedom at the end of the step.
    pub(crate) fn displacement_at_end(&self, dof: usize) -> f64 {
        self.displacement_at(self.rule.weights(), dof)
    }

    /// Displacement of a degree of freedom at a point with the integrals L_j of the basis.
    pub(crate) fn displacement_at(&self, integrals: &[f64], dof: usize) -> f64 {
        let rates = self.rates[dof..].iter().step_by(self.displacement.len());
        self.displacement[dof] + integrals.iter().zip(rates).map(|(L_j, x)| L_j * x).sum::<f64>()
    }
}

/// Factors of the damping in a step; zero by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepDamping {
    /// Factor on viscosities: one over the step size \[1/time\].
    pub inverse_step_size: f64,
    /// Factor beta on the elasticity at rest, for a dissipative scheme.
    pub dissipation: f64,
}

/// How a step takes what is given over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// By averages over the step, exact for every kink.
    Averages,
    /// By the values at the points of the rule.
    Points,
}

/// The start of a step.
#[derive(Debug, Clone, Copy)]
pub struct StepStart<'a> {
    /// Averaging rule.
    pub rule: &'a Rule,
    /// Points at which the rule takes loads.
    pub points: &'a FollowerRule,
    pub span: Span,
    pub sampling: Sampling,
    /// History variables of the force, `[n_history]`.
    pub history: &'a [f64],
}

impl StepStart<'_> {
    /// The stage averages of a function of time from its values at the points of the rule, `averages: [k]`.
    ///
    /// # Errors
    /// Those of the function.
    pub(crate) fn average_values(
        &self,
        value: impl Fn(f64) -> Result<f64>,
        averages: &mut [f64],
    ) -> Result<()> {
        averages.fill(0.0);
        for (m, alpha) in self.points.alphas().enumerate() {
            let value = value(self.span.time(alpha))?;
            let weights = self.points.stage_weights(m);
            averages.iter_mut().zip(weights).for_each(|(average, weight)| *average += weight * value);
        }
        Ok(())
    }
}
