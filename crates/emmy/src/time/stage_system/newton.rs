//! The stage equations as a system for Newton's iteration.

use super::StageSystem;
use crate::average::Request;
use crate::error::{Error, Result};
use crate::newton::{ROUND_OFF, Sizes, System, Tangent};
use crate::time::linear::LinearisedStages;

/// Iterations of GMRES before giving up.
const MAX_LINEAR_ITERATIONS: usize = 300;

/// Rounding floor of the residual over `eps || |h^2 K| |u| ||`: rounding errors of many terms partly cancel.
const FLOOR: f64 = 0.25;

/// Degrees of freedom below which the number of corrections is all that counts.
const SMALL: usize = 500;

impl StageSystem<'_> {
    /// Computes and factorises the approximate tangent at some unknowns.
    fn refactorize(&mut self, unknowns: &[f64]) -> Result<()> {
        let (x, pressures) = self.split(unknowns);
        self.approximate_tangent.refactorize(self.body, &self.displacement, x, pressures, self.time_scale)
    }

    /// Solves with the approximate tangent, as near to the tolerance as its solver reaches.
    fn solve_approximately(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        if let Some(projection) = &mut self.projection {
            projection.correct(self.body, &mut self.negative);
            self.body.space.clear_inactive(&mut self.negative);
        }
        let parts = correction.split_at_mut(self.negative.len());
        let system = (self.body, &self.coefficients.rule);
        let iterations = self.approximate_tangent.solve(system, &self.negative, parts, tolerance);
        iterations.ok_or_else(|| Error::Linear {
            reason: format!("conjugate gradients did not reach {tolerance:e}"),
        })
    }

    /// Solves with the exact tangent.
    fn solve_exactly(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        let (dx, pressures) = correction.split_at_mut(self.negative.len());
        let rule = &self.coefficients.rule;
        let s = self.time_scale;
        self.body.add_pressure_force(rule, &self.assembly, -s * s, pressures, &mut self.negative);
        self.body.space.clear_inactive(&mut self.negative);
        let mut system = LinearisedStages {
            body: self.body,
            assembly: &mut self.assembly,
            approximate_tangent: &mut self.approximate_tangent,
            projection: self.projection.as_mut(),
            time_scale: self.time_scale,
            right: &mut self.force,
        };
        let solution = self.gmres.solve(&mut system, &self.negative, dx, tolerance, MAX_LINEAR_ITERATIONS);
        if solution.relative_residual <= tolerance {
            self.body.add_pressure_response(rule, &self.assembly, dx, pressures);
            return Ok(solution.iterations);
        }
        Err(Error::Linear {
            reason: format!("GMRES did not reach {tolerance:e} in {MAX_LINEAR_ITERATIONS} iterations"),
        })
    }

    /// This rank's square of the residual with the pressures eliminated by the approximate tangent, their part in proportion to its
    /// effect: otherwise, an error of the rates of the second order, times the bulk modulus, would hide the convergence.
    fn condensed_square(&mut self, residual: &[f64], of_pressures: &[f64]) -> f64 {
        if of_pressures.is_empty() {
            return self.body.space.own_dot(residual, residual);
        }
        let system = (self.body, &self.coefficients.rule);
        self.condensed.fill(0.0);
        self.approximate_tangent.add_pressure_force(system, of_pressures, &mut self.condensed);
        let soft_part = self.approximate_tangent.soft_part();
        self.condensed.iter_mut().zip(residual).for_each(|(sum, r)| *sum = r - soft_part * *sum);
        self.body.space.clear_inactive(&mut self.condensed);
        self.body.space.own_dot(&self.condensed, &self.condensed)
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
        let (of_rates, of_pressures) = residual.split_at_mut(self.force.len());
        self.body.space.clear_inactive(of_rates);
        let mut squares = [inertia, internal, external, self.condensed_square(of_rates, of_pressures)];
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
        let (of_rates, of_pressures) = self.split(residual);
        self.negative.iter_mut().zip(of_rates).for_each(|(b, r)| *b = -r);
        let pressures = &mut dx[of_rates.len()..];
        pressures.iter_mut().zip(of_pressures).for_each(|(change, r)| *change = -r);
        if tangent == Tangent::Refactorized || !self.approximate_tangent.is_made() {
            self.refactorize(x)?;
        }
        self.approximate_tangent.rescale(self.body, self.time_scale)?;
        self.set_floor(x);
        let n_rates = of_rates.len();
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
        let rates = self.split(x).0;
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
    /// last K contracted too little. With pressures the exact tangent differs from K by directions that the bulk modulus
    /// makes stiff, and GMRES may not converge.
    fn largest_contraction(&self, slow_corrections: usize) -> f64 {
        match (self.body.has_pressures(), self.body.n_dofs_of_ranks()) {
            (false, SMALL..) if slow_corrections == 0 => 0.4,
            (false, _) => 0.0,
            _ => 0.9,
        }
    }
}
