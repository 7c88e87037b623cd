//! Parameters of a body.

use super::step::{StepData, check_body, combine};
use crate::average::{Request, Rule};
use crate::body::{Assembly, Body};
use crate::equilibrium::unbalanced_force;
use crate::error::{Error, Result};
use crate::force::{Sampling, StepDamping, StepInput};
use crate::input::Span;
use crate::sparse::reduce::dot;
use crate::time::State;

/// A parameter theta of a body, by which a goal is differentiated: of a material, a density, a load, or any other part
/// of the body.
///
/// The derivatives of the stage equations are central differences between bodies with varied values, at fixed state and
/// rates:
///
/// ```math
/// mu . dR/dtheta = sum_m c_m mu . [R(theta + m d) - R(theta - m d)] / (2 m d)
/// ```
///
/// For any parameter, three of them (c = 3/2, -3/5, 1/10) have an error of order d^6, with d a 200th of the scale on
/// which the equations change: relative 1e-12 ([`Parameter::smooth`]). Energies are linear in many parameters of
/// materials (Lame's parameters, stiffnesses, the parameters of Mooney and Rivlin), and densities and dead loads enter
/// linearly as well. Then one difference is exact up to rounding, and it may be wide ([`Parameter::linear`]). No
/// difference of motions is taken; it would lose digits to Newton's tolerance.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::adjoint::Parameter;
/// let mesh = mesh::block([1.0; 3], [1; 3])?;
/// let mu = Parameter::linear(500.0, 500.0, |mu| {
///     Body::builder(mesh.clone()).region(Region::new(NeoHooke::new(1000.0, mu)?, 1.0)).build()
/// })?;
/// assert_eq!(mu.value(), 500.0);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Parameter {
    value: f64,
    /// Bodies with varied values and their weights in the derivative.
    variations: Vec<(f64, Body)>,
}

/// Weights c_m / (2 m) of the differences, for 1, 2, 3 widths.
const SMOOTH: [f64; 3] = [0.75, -0.15, 1.0 / 60.0];

impl Parameter {
    /// A parameter in which the equations of a step are linear; `scale`: a positive size of it, such as its value. The
    /// values of the bodies are half of the scale away. An exponent, a power, Poisson's ratio or the place of a node
    /// are not linear: with them the derivative is wrong, and nothing tells.
    ///
    /// # Errors
    /// As `body`; [`Error::NotPositive`] for the scale.
    pub fn linear(value: f64, scale: f64, body: impl Fn(f64) -> Result<Body>) -> Result<Self> {
        Parameter::new(value, 0.5 * scale, &[0.5], body)
    }

    /// A parameter in which the equations of a step are smooth; `scale`: the size of a significant change, such as its
    /// value. The values of the bodies differ by at most 3/200 of the scale.
    ///
    /// # Errors
    /// As `body`; [`Error::NotPositive`] for the scale.
    pub fn smooth(value: f64, scale: f64, body: impl Fn(f64) -> Result<Body>) -> Result<Self> {
        Parameter::new(value, scale / 200.0, &SMOOTH, body)
    }

    fn new(value: f64, width: f64, weights: &[f64], body: impl Fn(f64) -> Result<Body>) -> Result<Self> {
        if !(width > 0.0 && width.is_finite()) {
            return Err(Error::NotPositive { what: "scale of a parameter".into(), value: width });
        }
        let mut variations = Vec::new();
        for (m, weight) in (1..).zip(weights) {
            for sign in [1.0, -1.0] {
                variations.push((sign * weight / width, body(value + sign * f64::from(m) * width)?));
            }
        }
        Ok(Parameter { value, variations })
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Checks that the bodies of the parameter are covered, and have the degrees of freedom of a body.
    ///
    /// # Errors
    /// [`Error::Adjoint`].
    pub(super) fn check(&self, body: &Body) -> Result<()> {
        self.variations.iter().try_for_each(|(_, varied)| check_body(varied))?;
        if self.variations.iter().all(|(_, varied)| varied.fixed() == body.fixed()) {
            return Ok(());
        }
        let reason = "a parameter makes bodies with other degrees of freedom or supports".to_string();
        Err(Error::Adjoint { reason })
    }

    /// `sum_i mu_i . dR_i/dtheta` of a step.
    ///
    /// # Errors
    /// [`Error::Inverted`], [`Error::NotFiniteAt`].
    pub(super) fn product(&self, step: &StepData<'_>, mu: &[f64], memory: &mut Residual) -> Result<f64> {
        let mut sum = 0.0;
        for (weight, body) in &self.variations {
            sum += weight * memory.product(body, step, mu)?;
        }
        Ok(sum)
    }

    /// `mu . d(f - F)/dtheta` of the equations of equilibrium at a state.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub(super) fn equilibrium_product(&self, state: &State, mu: &[f64]) -> Result<f64> {
        let mut sum = 0.0;
        for (weight, body) in &self.variations {
            // The loads of the time in full, before a jump there, as they act in the equilibrium.
            let loaded = body.in_proportion(state.time);
            sum += weight * dot(mu, &unbalanced_force(&loaded, &state.displacement, 1.0)?);
        }
        Ok(sum)
    }
}

/// Memory for the stage equations of bodies with varied parameters.
#[derive(Debug)]
pub(super) struct Residual {
    assembly: Assembly,
    force: Vec<f64>,
    /// `sum_i (a^-1)_ij mu_i`, `[k][n_nodes][3]`.
    inertial: Vec<f64>,
    rates: Vec<f64>,
    momentum: Vec<f64>,
}

impl Residual {
    pub(super) fn new(body: &Body, rule: &Rule) -> Self {
        let n = body.n_dofs();
        let k = rule.degree();
        Residual {
            assembly: body.assembly(rule),
            force: vec![0.0; k * n],
            inertial: vec![0.0; k * n],
            rates: vec![0.0; n],
            momentum: vec![0.0; n],
        }
    }

    /// `sum_i mu_i . R_i` of a body.
    fn product(&mut self, body: &Body, step: &StepData<'_>, mu: &[f64]) -> Result<f64> {
        let StepData { rule, inverse, size: h, displacement, velocity, rates, .. } = *step;
        let damping = StepDamping::default();
        let input = StepInput { damping, ..StepInput::undamped(rule, displacement, rates) };
        body.assemble(&input, Request::Stress, &[], &mut self.assembly)?;
        self.assembly.matrix.copy_force(&mut self.force);
        body.begin(rule, (Span::new(step.time, h), Sampling::Averages), &[], &mut self.assembly)?;
        let [load, _] = self.assembly.external_parts();
        let mut sum = h * h * (dot(mu, &self.force) - dot(mu, load));
        combine(rule, inverse, mu, &mut self.inertial);
        for (x, mu) in rates.chunks_exact(velocity.len()).zip(self.inertial.chunks_exact(velocity.len())) {
            let deviations = x.iter().zip(velocity);
            self.rates.iter_mut().zip(deviations).for_each(|(rate, (x, v))| *rate = x - h * v);
            body.mass_product(&self.rates, &mut self.momentum);
            sum += dot(mu, &self.momentum);
        }
        Ok(sum)
    }
}
