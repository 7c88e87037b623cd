//! The stage equations as a system for Newton's iteration.

use super::StageSystem;
use crate::average::Request;
use crate::error::{Error, Result};
use crate::newton::{ROUND_OFF, Sizes, System, Tangent};
use crate::time::linear::LinearisedStages;
use crate::unknowns::BorderStep;

/// Iterations of GMRES before giving up.
const MAX_LINEAR_ITERATIONS: usize = 300;

/// Rounding floor of the residual over `eps || |h^2 K| |u| ||`: rounding errors of many terms partly cancel.
const FLOOR: f64 = 0.25;

/// Degrees of freedom below which the number of corrections is all that counts.
const SMALL: usize = 500;

impl StageSystem<'_> {
    /// Computes and factorises the approximate tangent at some unknowns.
    fn refactorize(&mut self, unknowns: &[f64]) -> Result<()> {
        let [x, _, local] = self.split(unknowns);
        self.border.forget();
        self.approximate_tangent.refactorize(self.body, &self.displacement, x, local, self.time_scale)
    }

    /// Solves with the approximate tangent, as near to the tolerance as its solver reaches.
    fn solve_approximately(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        let (n_rates, n_multipliers) = (self.force.len(), self.n_multipliers());
        let (dx, others) = correction.split_at_mut(n_rates);
        let (multipliers, local) = others.split_at_mut(n_multipliers);
        let StageSystem { body, coefficients, projection, approximate_tangent, border, force, .. } = self;
        let rule = &coefficients.rule;
        let mut solve = |right: &[f64], dx: &mut [f64], local: &mut [f64]| {
            force.copy_from_slice(right);
            if let Some(projection) = projection {
                projection.correct(body, force);
                body.space.clear_inactive(force);
            }
            let iterations = approximate_tangent.solve((body, rule), force, (dx, local), tolerance);
            iterations.ok_or_else(|| Error::Linear {
                reason: format!("conjugate gradients did not reach {tolerance:e}"),
            })
        };
        let iterations = solve(&self.negative[..n_rates], dx, local)?;
        if multipliers.is_empty() {
            return Ok(iterations);
        }
        multipliers.copy_from_slice(&self.negative[n_rates..]);
        let mut rest = vec![0.0; local.len()];
        let further = border.solve(
            |right, dx| {
                rest.fill(0.0);
                solve(right, dx, &mut rest)
            },
            dx,
            multipliers,
        )?;
        // The last solution is that for the forces of the constraints.
        local.iter_mut().zip(&rest).for_each(|(change, rest)| *change -= rest);
        Ok(iterations + further)
    }

    /// Sets the derivatives of the constraints.
    fn set_border(&mut self, unknowns: &[f64]) {
        if !self.body.constraints().is_empty() {
            let [rates, multipliers, _] = self.split(unknowns);
            let (rule, displacement) = (&self.coefficients.rule, &self.displacement);
            self.border.set(self.body, BorderStep { rule, displacement, rates }, multipliers);
        }
    }

    /// Solves with the exact tangent.
    fn solve_exactly(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        let n_rates = self.force.len();
        let (dx, local) = correction.split_at_mut(self.negative.len());
        let rule = &self.coefficients.rule;
        let s = self.time_scale;
        let right = &mut self.negative[..n_rates];
        self.body.add_local_force(rule, &self.assembly, -s * s, local, right);
        self.body.space.clear_inactive(right);
        let mut system = LinearisedStages {
            body: self.body,
            assembly: &mut self.assembly,
            approximate_tangent: &mut self.approximate_tangent,
            projection: self.projection.as_mut(),
            border: &mut self.border,
            time_scale: self.time_scale,
            right: &mut self.force,
        };
        let solution = self.gmres.solve(&mut system, &self.negative, dx, tolerance, MAX_LINEAR_ITERATIONS);
        if solution.relative_residual <= tolerance {
            self.body.add_local_response(rule, &self.assembly, &dx[..n_rates], local);
            return Ok(solution.iterations);
        }
        Err(Error::Linear {
            reason: format!("GMRES did not reach {tolerance:e} in {MAX_LINEAR_ITERATIONS} iterations"),
        })
    }

    /// This rank's square of the residual with the local unknowns eliminated by the approximate tangent. Their residuals are
    /// scaled by their effect. Unscaled, a second-order error of the rates times the bulk modulus would mask convergence.
    fn condensed_square(&mut self, residual: &[f64], of_local: &[f64]) -> f64 {
        if of_local.is_empty() {
            return self.body.space.own_dot(residual, residual);
        }
        let system = (self.body, &self.coefficients.rule);
        self.condensed.fill(0.0);
        self.approximate_tangent.add_local_force(system, of_local, &mut self.condensed);
        let soft_part = self.approximate_tangent.soft_part();
        self.condensed.iter_mut().zip(residual).for_each(|(sum, r)| *sum = r - soft_part * *sum);
        self.body.space.clear_inactive(&mut self.condensed);
        self.body.space.own_dot(&self.condensed, &self.condensed)
    }

    /// Square of the residual of the rates that would mend the residuals of the constraints, for the mean mass of a node.
    fn square_of_constraints(&mut self, x: &[f64], of_constraints: &[f64]) -> f64 {
        let constraints = self.body.constraints();
        if constraints.is_empty() {
            return 0.0;
        }
        let mass = self.body.total_lumped_mass() / self.body.mesh().n_nodes() as f64;
        mass * mass * constraints.square_of_residual(self.border_step(x), of_constraints)
    }

    /// Sets the rounding floor, once per step.
    fn set_floor(&mut self, x: &[f64]) {
        if self.floor == 0.0 {
            let displacement = &self.displacement;
            let increment = &x[..self.body.n_dofs()];
            let size =
                self.approximate_tangent.rounding_size(self.body, displacement, increment, self.time_scale);
            let size = size * self.approximate_tangent.soft_part();
            self.floor = FLOOR * f64::EPSILON * size * (self.coefficients.rule.degree() as f64).sqrt();
        }
    }
}

impl System for StageSystem<'_> {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        let [inertia, internal, external] = self.full_residual(x, residual)?;
        let [of_rates, of_constraints, of_local] = self.split_mut(residual);
        self.body.space.clear_inactive(of_rates);
        let own = self.condensed_square(of_rates, of_local) + self.square_of_constraints(x, of_constraints);
        let mut squares = [inertia, internal, external, own];
        self.body.space.sum_ranks("squares of a residual and its parts", &mut squares);
        let [inertia, internal, external, residual] = squares.map(f64::sqrt);
        Ok(Sizes {
            residual,
            scale: [inertia, internal, external].into_iter().fold(0.0, f64::max),
            floor: self.floor,
        })
    }

    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        let n_rates = self.force.len();
        let (of_rates, of_local) = residual.split_at(self.negative.len());
        self.negative.iter_mut().zip(of_rates).for_each(|(b, r)| *b = -r);
        let local = &mut dx[of_rates.len()..];
        local.iter_mut().zip(of_local).for_each(|(change, r)| *change = -r);
        self.set_border(x);
        if tangent == Tangent::Refactorized || !self.approximate_tangent.is_made() {
            self.refactorize(x)?;
        }
        if self.approximate_tangent.rescale(self.body, self.time_scale)? {
            self.border.forget();
        }
        self.set_floor(x);
        let iterations = match tangent {
            Tangent::Reused | Tangent::Refactorized => self.solve_approximately(tolerance, dx),
            Tangent::Exact => {
                self.assemble(x, Request::Tangent)?;
                self.solve_exactly(tolerance, dx)
            }
            Tangent::LastExact => self.solve_exactly(tolerance, dx),
        }?;
        self.body.space.update_guests("correction", &mut dx[..n_rates]);
        Ok(iterations)
    }

    fn largest_part(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        let [rates, ..] = self.split(x);
        self.body.largest_part(&self.step_at(rates), &self.assembly, &dx[..rates.len()])
    }

    fn refactorization_cost(&self) -> f64 {
        self.approximate_tangent.refactorization_cost()
    }

    /// The inertia of a stage is the difference of terms that grow with the degree like m_ij, and what a residual leaves has
    /// the same sign in every step.
    fn rounding(&self) -> f64 {
        match &self.coefficients.mass[..] {
            [_] => ROUND_OFF,
            mass => 2.0 * ROUND_OFF / mass.iter().fold(2.0, |largest: f64, m| largest.max(m.abs())),
        }
    }

    /// Another K costs less than GMRES with the exact tangent, unless the body is so small that both cost nothing or the
    /// last K contracted too little. With local unknowns the exact tangent differs from K by directions that the bulk modulus
    /// makes stiff, and GMRES may not converge.
    fn largest_contraction(&self, slow_corrections: usize) -> f64 {
        match (self.body.has_local(), self.body.n_dofs_of_ranks()) {
            (false, SMALL..) if slow_corrections == 0 => 0.4,
            (false, _) => 0.0,
            _ => 0.9,
        }
    }
}
