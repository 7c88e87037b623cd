//! The equations of the next step at any rates.

use super::Motion;
use crate::body::BlockRow;
use crate::error::{Error, Result};
use crate::input::SAME_TIME;
use crate::time::Scheme;

impl Motion<'_> {
    /// Residual of the stage equations for a step from the present state, at rates x of the displacement,
    /// `[degree][n_nodes][3]` \[length\], on all degrees of freedom, in the same order \[mass length\].
    ///
    /// ```math
    /// R_i = sum_j (a^-1)_ij (M x_j - h p_1) + h^2 (f_i - f_i^ext)
    /// ```
    ///
    /// (Betsch and Steinmann (2001), equations (28)-(32)), with the terms of damping and of a dissipative element. At
    /// held degrees of freedom it is h^2 times the reaction. The motion stays where it is; supports whose release is
    /// due are released, as at the beginning of a step.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
    /// let start = State::initial(&body, 0.0, &[flight])?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(start)?;
    /// // At rest all momentum is missing: R = -2 h p, with p = m v.
    /// let residual = motion.residual(&[0.0; 24], 0.1)?;
    /// assert!((residual.iter().sum::<f64>() + 2.0 * 0.1 * 6.0).abs() < 1e-14);
    /// motion.step(0.1)?;
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Scheme`] for another scheme than a time element, and a body with joints; [`Error::Length`],
    /// [`Error::NoDuration`], [`Error::NotOnTeam`]; the reason of a force that refuses the rates, such as
    /// [`Error::Inverted`].
    pub fn residual(&mut self, rates: &[f64], step_size: f64) -> Result<Vec<f64>> {
        self.check_rates(rates, step_size)?;
        self.stepper.residual(&self.state, rates, step_size)
    }

    /// Derivative of [`Motion::residual`] by the rates \[mass\]: a row for each stage and node, `stage n_nodes + node`,
    /// with its columns in the same order, ascending within each stage, and the 3x3 blocks row by row.
    ///
    /// ```math
    /// dR_i/dx_j = (a^-1)_ij M + h^2 df_i/dx_j
    /// ```
    ///
    /// Pressures of projected volumes are eliminated. Held degrees of freedom are included.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?;
    /// let rows = motion.tangent(&[0.0; 48], 0.1)?;
    /// // A translation meets inertia alone, M (a^-1)_11 with a^-1 = [[3, 0.46], [-6.46, 3]].
    /// let sum: f64 = rows[..8].iter().flatten().filter(|(column, _)| *column < 8).map(|(_, block)| block[0]).sum();
    /// assert!((sum - 2.0 * 3.0).abs() < 1e-13);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Motion::residual`]; [`Error::Scheme`] for a dissipative element, whose projection couples all nodes.
    pub fn tangent(&mut self, rates: &[f64], step_size: f64) -> Result<Vec<BlockRow>> {
        self.check_rates(rates, step_size)?;
        if self.scheme.dissipation().is_some() {
            return Err(self.without("its dissipation couples all nodes, so the tangent is not sparse"));
        }
        self.stepper.tangent(&self.state, rates, step_size)
    }

    /// Checks what the stage equations are asked for, and releases supports that are due before the step.
    fn check_rates(&mut self, rates: &[f64], step_size: f64) -> Result<()> {
        self.body.space.check_whole("a residual or tangent at rates")?;
        if !self.scheme.is_time_element() && !matches!(self.scheme, Scheme::Own(_)) {
            return Err(self.without("residual and tangent need a time element"));
        }
        if !self.body.mechanism.is_empty() {
            return Err(self.without("joints have multipliers, which are not among the rates"));
        }
        self.check_step_size(step_size)?;
        let (found, expected) = (rates.len(), self.scheme.degree() * self.body.n_dofs());
        if found != expected {
            return Err(Error::Length { what: "a list of rates", found, expected });
        }
        self.release(SAME_TIME * step_size)
    }

    fn without(&self, reason: &str) -> Error {
        Error::Scheme { scheme: self.scheme.to_string(), reason: reason.to_string() }
    }
}
