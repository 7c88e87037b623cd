//! The adjoint of one step.

use crate::average::{Request, Rule};
use crate::body::{Assembly, Body};
use crate::error::{Error, Result};
use crate::force::StepInput;
use crate::newton::NewtonSettings;
use crate::sparse::reduce::norm;
use crate::sparse::{Gmres, LinearSystem, SparseLu};
use crate::time::{ApproximateTangent, StageCoefficients, TimeElement};

/// A step that was done.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepData<'a> {
    /// Averaging rule.
    pub rule: &'a Rule,
    /// Coefficients (a^-1)_ij.
    pub inverse: &'a [f64],
    /// Time at the start.
    pub time: f64,
    /// Size h.
    pub size: f64,
    /// Displacement at the start, `[n_nodes][3]`.
    pub displacement: &'a [f64],
    /// Velocity at the start.
    pub velocity: &'a [f64],
    /// Rates x_j, `[k][n_nodes][3]`.
    pub rates: &'a [f64],
}

/// Derivatives of a goal by a state, `[n_nodes][3]`; zero at fixed degrees of freedom.
#[derive(Debug, Clone)]
pub(super) struct AdjointState {
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
}

impl AdjointState {
    pub(super) fn new(body: &Body, displacement: &[f64], velocity: &[f64]) -> Self {
        let free = |gradient: &[f64]| -> Vec<f64> {
            gradient.iter().zip(body.fixed()).map(|(g, fixed)| if *fixed { 0.0 } else { *g }).collect()
        };
        AdjointState { displacement: free(displacement), velocity: free(velocity) }
    }
}

/// Takes the derivatives of a goal back over steps; holds the memory for this.
#[derive(Debug)]
pub(super) struct AdjointStep<'a> {
    body: &'a Body,
    rule: Rule,
    /// Weights beta_j of the rates in the velocity at the end.
    end_weights: Vec<f64>,
    assembly: Assembly,
    /// Right-hand side of the transposed equations.
    approximate_tangent: ApproximateTangent,
    gmres: Gmres,
    right: Vec<f64>,
    /// Multipliers mu_i of the stage equations, `[k][n_nodes][3]`.
    multipliers: Vec<f64>,
    /// Residual of the multipliers, and their correction.
    residual: Vec<f64>,
    correction: Vec<f64>,
    combined: Vec<f64>,
    sum: Vec<f64>,
    /// Pressures of cells with a projected volume, `[function][n]`.
    local: Vec<f64>,
    product: Vec<f64>,
    /// Iterations of the last system, and of the first one after the stiffness was refactorised; `None`: there is no
    /// stiffness.
    iterations: Option<[usize; 2]>,
    /// Whether GMRES has failed; then each system is factorised.
    is_direct: bool,
}

/// Relative residual of the transposed systems.
const TOLERANCE: f64 = 1e-13;

/// Relative residual above which a system counts as unsolved: rounding may keep it above the tolerance.
const UNSOLVED: f64 = 1e-10;

/// Relative residual of one solution by GMRES.
const PRECISION: f64 = 1e-4;

/// Iterations of one solution by GMRES.
const MAX_ITERATIONS: usize = 300;

/// Iterations beyond those with a fresh stiffness after which the stiffness is refactorised.
const SLOWER: usize = 6;

impl<'a> AdjointStep<'a> {
    /// # Errors
    /// As [`ApproximateTangent::new`].
    pub(super) fn new(body: &'a Body, element: TimeElement, settings: NewtonSettings) -> Result<Self> {
        let n = body.n_dofs();
        let k = element.degree;
        let coefficients = element.coefficients();
        let transposed_coefficients = StageCoefficients {
            rule: coefficients.rule.clone(),
            sampling: coefficients.sampling,
            mass: transposed(&coefficients.mass, k),
            mass_low: transposed(&coefficients.mass_low, k),
            inverse_mass: transposed(&coefficients.inverse_mass, k),
            response: transposed(&coefficients.response, k),
            damping: None,
        };
        Ok(AdjointStep {
            body,
            assembly: body.assembly(&coefficients.rule),
            approximate_tangent: ApproximateTangent::new(body, &transposed_coefficients, settings.solver)?,
            gmres: Gmres::default(),
            right: vec![0.0; k * n],
            multipliers: vec![0.0; k * n],
            residual: vec![0.0; k * n],
            correction: vec![0.0; k * n],
            combined: vec![0.0; k * n],
            sum: vec![0.0; n],
            local: vec![0.0; body.n_local() * coefficients.rule.n_pressures()],
            product: vec![0.0; n],
            iterations: None,
            is_direct: false,
            end_weights: (0..k).map(|j| coefficients.end_weights(j)[1]).collect(),
            rule: coefficients.rule,
        })
    }

    /// Multipliers of the last step.
    pub(super) fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// Takes the derivatives by the state at the end of a step to those by the state at its start.
    ///
    /// # Errors
    /// [`Error::Linear`] if the transposed system is not solved, [`Error::Inverted`].
    pub(super) fn take_back(&mut self, step: &StepData<'_>, adjoint: &mut AdjointState) -> Result<()> {
        self.set_right_side(step.size, adjoint);
        self.solve(step)?;
        let n = self.sum.len();
        let h = step.size;
        let input = input(step);
        self.body.start_gradient(&input, &self.multipliers, &mut self.sum);
        adjoint.displacement.iter_mut().zip(&self.sum).for_each(|(u, sum)| *u -= h * h * sum);
        combine(step.rule, step.inverse, &self.multipliers, &mut self.combined);
        self.sum.fill(0.0);
        for stage in self.combined.chunks_exact(n) {
            self.sum.iter_mut().zip(stage).for_each(|(sum, mu)| *sum += mu);
        }
        self.body.mass_product(&self.sum, &mut self.product);
        let kept = 1.0 - self.end_weights.iter().sum::<f64>();
        adjoint.velocity.iter_mut().zip(&self.product).for_each(|(v, p)| *v = kept * *v + h * p);
        adjoint.velocity[self.body.space.internal_dofs()].fill(0.0);
        for (dof, _) in self.body.fixed().iter().enumerate().filter(|(_, fixed)| **fixed) {
            (adjoint.displacement[dof], adjoint.velocity[dof]) = (0.0, 0.0);
        }
        Ok(())
    }

    /// `b_j ubar_2 + beta_j/h vbar_2`
    fn set_right_side(&mut self, h: f64, adjoint: &AdjointState) {
        let weights = self.rule.weights().iter().zip(&self.end_weights);
        for ((b, beta), right) in weights.zip(self.right.chunks_exact_mut(self.sum.len())) {
            let terms = adjoint.displacement.iter().zip(&adjoint.velocity);
            right.iter_mut().zip(terms).for_each(|(r, (u, v))| *r = b * u + beta / h * v);
        }
        // The velocity of internal nodes is the end of the polynomial of their rates.
        let n = self.sum.len();
        for (j, dof) in
            (0..self.end_weights.len()).flat_map(|j| self.body.space.internal_dofs().map(move |dof| (j, dof)))
        {
            let change = self.rule.basis(j, 1.0) - self.end_weights[j];
            self.right[j * n + dof] += change / h * adjoint.velocity[dof];
        }
    }

    /// Solves with the transposed tangent.
    fn solve(&mut self, step: &StepData<'_>) -> Result<()> {
        self.body.assemble(&input(step), Request::Tangent, step.inverse, &mut self.assembly)?;
        self.assembly.matrix.transpose(self.body.pattern());
        if !self.is_direct && self.solve_iteratively(step)? {
            return Ok(());
        }
        self.is_direct = true;
        let matrix = &self.assembly.matrix;
        let factor = SparseLu::new(matrix, self.body.pattern(), self.body.fixed())?;
        let left = self.refine(|_, residual, correction| factor.solve(residual, correction))?;
        if left <= UNSOLVED {
            return Ok(());
        }
        Err(Error::Linear {
            reason: format!("a factorisation left {left:.1e} of the right side of an adjoint step"),
        })
    }

    /// Solves by GMRES with the approximate tangent of this step or of a nearby one; false if it misses the tolerance.
    fn solve_iteratively(&mut self, step: &StepData<'_>) -> Result<bool> {
        let is_new = self.iterations.is_none_or(|[last, first]| last > first + SLOWER);
        if is_new {
            self.body.copy_local(&self.assembly, &mut self.local);
            let StepData { displacement, rates, size, .. } = *step;
            self.approximate_tangent.refactorize(
                (self.body, &self.rule),
                displacement,
                rates,
                &self.local,
                size,
            )?;
        } else {
            self.approximate_tangent.rescale(self.body, step.size)?;
        }
        let mut gmres = std::mem::take(&mut self.gmres);
        let mut iterations = 0;
        // The preconditioner may work in single precision, which GMRES does not notice: restart from the true residual.
        let left = self.refine(|system, residual, correction| {
            iterations += gmres.solve(system, residual, correction, PRECISION, MAX_ITERATIONS).iterations;
            Ok(())
        })?;
        self.gmres = gmres;
        let first = self.iterations.filter(|_| !is_new).map_or(iterations, |[_, first]| first);
        self.iterations = Some([iterations, first]);
        Ok(left <= UNSOLVED)
    }

    /// Corrects the multipliers by solutions for the residual, from zero, until the residual is small or no longer
    /// falls. The right side then holds the remaining residual.
    fn refine(
        &mut self,
        mut solve: impl FnMut(&mut Transposed<'_>, &[f64], &mut [f64]) -> Result<()>,
    ) -> Result<f64> {
        let AdjointStep { body, assembly, approximate_tangent, .. } = self;
        let mut system = Transposed { body, assembly, approximate_tangent };
        self.multipliers.fill(0.0);
        self.residual.copy_from_slice(&self.right);
        let size = norm(&self.right);
        let mut left = 1.0;
        while size > 0.0 && left > TOLERANCE {
            solve(&mut system, &self.residual, &mut self.correction)?;
            self.multipliers.iter_mut().zip(&self.correction).for_each(|(mu, d)| *mu += d);
            system.product(&self.multipliers, &mut self.residual);
            self.residual.iter_mut().zip(&self.right).for_each(|(r, b)| *r = b - *r);
            let last = std::mem::replace(&mut left, norm(&self.residual) / size);
            if left.is_nan() || left > 0.5 * last {
                break;
            }
        }
        Ok(if size > 0.0 { left } else { 0.0 })
    }
}

/// Checks that the adjoint covers a body.
///
/// # Errors
/// [`Error::Adjoint`].
pub(super) fn check_body(body: &Body) -> Result<()> {
    let not_covered = [
        (!body.mechanism.is_empty(), "rigid bodies and joints are not covered; supports are"),
        (body.has_ties(), "ties and couplings are not covered"),
        (body.is_driven(), "driven supports are not covered; supports at rest are"),
        (body.release().is_some(), "supports that are released are not covered; supports at rest are"),
    ];
    let reason = not_covered.iter().find(|(is_so, _)| *is_so).map(|(_, reason)| *reason);
    match reason.or(body.without_adjoint()) {
        Some(reason) => Err(Error::Adjoint { reason: reason.to_string() }),
        None => Ok(()),
    }
}

/// `y_j = sum_i m_ij x_i`; `x`, `y`: `[k][n_nodes][3]`.
pub(super) fn combine(rule: &Rule, m: &[f64], x: &[f64], y: &mut [f64]) {
    let k = rule.degree();
    let n = x.len() / k;
    y.fill(0.0);
    for (j, y) in y.chunks_exact_mut(n).enumerate() {
        for (i, x) in x.chunks_exact(n).enumerate() {
            y.iter_mut().zip(x).for_each(|(y, x)| *y += m[i * k + j] * x);
        }
    }
}

fn input<'a>(step: &StepData<'a>) -> StepInput<'a> {
    let tangent_factor = step.size * step.size;
    StepInput { tangent_factor, ..StepInput::undamped(step.rule, step.displacement, step.rates) }
}

fn transposed(m: &[f64], k: usize) -> Vec<f64> {
    (0..k * k).map(|at| m[at % k * k + at / k]).collect()
}

/// The transposed tangent on the free degrees of freedom.
struct Transposed<'a> {
    body: &'a Body,
    assembly: &'a mut Assembly,
    approximate_tangent: &'a mut ApproximateTangent,
}

impl LinearSystem for Transposed<'_> {
    fn product(&mut self, x: &[f64], y: &mut [f64]) {
        self.assembly.matrix.multiply(self.body.pattern(), x, y);
        for stage in y.chunks_exact_mut(self.body.n_dofs()) {
            let fixed = stage.iter_mut().zip(self.body.fixed()).filter(|(_, fixed)| **fixed);
            fixed.for_each(|(value, _)| *value = 0.0);
        }
    }

    fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
        self.approximate_tangent.precondition(x, y);
    }
}
