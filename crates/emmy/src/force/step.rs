//! A step, as the assembly needs it.

use crate::average::Rule;

/// A step, as the terms need it.
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
    /// Damping of the strain rates.
    pub damping: StepDamping,
    /// Pressures of cells with a projected volume, `[function][l]`; `None`: those of the deformation.
    pub pressures: Option<&'a [f64]>,
}

impl<'a> StepInput<'a> {
    /// A step for its forces alone, without derivatives and damping.
    pub(crate) fn undamped(rule: &'a Rule, displacement: &'a [f64], rates: &'a [f64]) -> Self {
        StepInput {
            rule,
            tangent_factor: 0.0,
            displacement,
            rates,
            damping: StepDamping::default(),
            pressures: None,
        }
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
