//! The stage equations as a system for Newton's iteration.

use super::StageSystem;
use crate::error::{Error, Result};
use crate::newton::{Ending, ROUND_OFF, Sizes, System, Tangent};
use crate::time::equations::{Equations, step_input};
use crate::time::linear::LinearisedStages;

/// Iterations of GMRES before giving up.
const MAX_LINEAR_ITERATIONS: usize = 300;

/// Rounding floor of the residual over `eps || |h^2 K| |u| ||`: rounding errors of many terms partly cancel.
const FLOOR: f64 = 0.25;

/// Forces over the inertia of all nodes that are none.
const FORCELESS: f64 = 1e-10;

/// Degrees of freedom below which the number of corrections is all that counts.
const DOFS_OF_SMALL_BODY: usize = 500;

impl StageSystem<'_> {
    /// Computes and factorises the approximate tangent at some unknowns.
    fn refactorize(&mut self, unknowns: &[f64]) -> Result<()> {
        let [x, _, local] = self.equations.blocks.split(unknowns);
        self.border.forget();
        let Equations { body, coefficients, displacement, time_scale, .. } = &self.equations;
        let rule = &coefficients.rule;
        self.approximate_tangent.refactorize((body, rule), displacement, x, local, *time_scale)
    }

    /// Sets the flexibility of the joint nodes.
    fn set_flexibility(&mut self) -> Result<()> {
        let StageSystem { equations, approximate_tangent, border, local_of_border, .. } = self;
        let Equations { body, coefficients, scheme_force, force, blocks, .. } = equations;
        if body.constraints().is_empty() {
            return Ok(());
        }
        let is_unturned = scheme_force.is_zero();
        border.set_unturned(blocks.rates, |right, dx, tolerance| {
            let iterations = if is_unturned {
                approximate_tangent.solve_unturned(body, right, dx, tolerance)
            } else {
                force.copy_from_slice(right);
                scheme_force.correct(body, force);
                local_of_border.fill(0.0);
                let rule = &coefficients.rule;
                approximate_tangent.solve((body, rule), force, (dx, local_of_border), tolerance)
            };
            iterations.ok_or_else(|| missed(tolerance))
        })?;
        border.set_turned(|table, memory| {
            if is_unturned {
                approximate_tangent.turn_table(body.constraints().nodes(), table, memory);
            }
        });
        Ok(())
    }

    /// Adds the couplings at some unknowns to the approximate tangent, if it takes them.
    fn couple(&mut self, unknowns: &[f64]) -> Result<()> {
        if self.equations.body.has_couplings() && self.approximates_sudden_parts() {
            self.equations.renew_couplings(unknowns)?;
            self.approximate_tangent.couple(&self.equations.assembly.matrix.couplings);
        }
        Ok(())
    }

    /// Solves with the approximate tangent, as near to the tolerance as its solver reaches.
    fn solve_approximately(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        let blocks = self.equations.blocks;
        let [dx, multipliers, local] = blocks.split_mut(correction);
        let StageSystem { equations, approximate_tangent, border, local_of_border, negative, .. } = self;
        let Equations { body, coefficients, scheme_force, force, .. } = equations;
        let rule = &coefficients.rule;
        let mut solve = |right: &[f64], dx: &mut [f64], local: &mut [f64], tolerance: f64| {
            force.copy_from_slice(right);
            scheme_force.correct(body, force);
            let iterations = approximate_tangent.solve((body, rule), force, (dx, local), tolerance);
            iterations.ok_or_else(|| missed(tolerance))
        };
        let iterations = solve(&negative[..blocks.rates], dx, local, tolerance)?;
        if multipliers.is_empty() {
            return Ok(iterations);
        }
        multipliers.copy_from_slice(&negative[blocks.rates..]);
        let solve = |right: &[f64], dx: &mut [f64], tolerance: f64| {
            local_of_border.fill(0.0);
            solve(right, dx, local_of_border, tolerance)
        };
        let further = border.solve(solve, tolerance, dx, multipliers)?;
        // The last solution is that for the forces of the constraints.
        local.iter_mut().zip(&*local_of_border).for_each(|(change, own)| *change -= own);
        Ok(iterations + further)
    }

    /// Sets the derivatives of the constraints.
    fn set_border(&mut self, unknowns: &[f64]) {
        if !self.equations.body.constraints().is_empty() {
            let [rates, multipliers, _] = self.equations.blocks.split(unknowns);
            let Equations {
                body, constraint_step, coefficients, time_scale, displacement, coordinates, ..
            } = &self.equations;
            let step = step_input(coefficients, *time_scale, (displacement, coordinates), rates);
            let (k, drag) = (coefficients.rule.degree(), *time_scale * body.drag());
            let mass = |i: usize, j: usize| coefficients.mass[i * k + j] + if i == j { drag } else { 0.0 };
            self.border.set(body, (&step, constraint_step), multipliers, mass);
        }
    }

    /// Solves with the exact tangent.
    fn solve_exactly(&mut self, tolerance: f64, correction: &mut [f64]) -> Result<usize> {
        let n_rates = self.equations.blocks.rates;
        let (dx, local) = correction.split_at_mut(self.negative.len());
        let rule = &self.equations.coefficients.rule;
        let s = self.equations.time_scale;
        let right = &mut self.negative[..n_rates];
        self.equations.body.add_local_force(rule, &self.equations.assembly, -s * s, local, right);
        self.equations.body.space.clear_inactive(right);
        let mut system = LinearisedStages {
            body: self.equations.body,
            assembly: &mut self.equations.assembly,
            approximate_tangent: &mut self.approximate_tangent,
            scheme_force: &mut self.equations.scheme_force,
            border: &mut self.border,
            time_scale: self.equations.time_scale,
            right: &mut self.equations.force,
        };
        let solution = self.gmres.solve(&mut system, &self.negative, dx, tolerance, MAX_LINEAR_ITERATIONS);
        if solution.relative_residual <= tolerance {
            self.equations.body.add_local_response(rule, &self.equations.assembly, &dx[..n_rates], local);
            return Ok(solution.iterations);
        }
        Err(Error::Linear {
            reason: format!("GMRES did not reach {tolerance:e} in {MAX_LINEAR_ITERATIONS} iterations"),
        })
    }

    /// This rank's square of the residual with the local unknowns eliminated by the approximate tangent. Their
    /// residuals are scaled by their effect. Unscaled, a second-order error of the rates times the bulk modulus would
    /// mask convergence.
    fn condensed_square(&mut self, residual: &[f64], of_local: &[f64]) -> f64 {
        if of_local.is_empty() {
            return self.equations.body.space.own_dot(residual, residual);
        }
        let system = (self.equations.body, &self.equations.coefficients.rule);
        self.condensed.fill(0.0);
        self.approximate_tangent.add_local_force(system, of_local, &mut self.condensed);
        let soft_part = self.approximate_tangent.soft_part();
        self.condensed.iter_mut().zip(residual).for_each(|(sum, r)| *sum = r - soft_part * *sum);
        self.equations.body.space.clear_inactive(&mut self.condensed);
        self.equations.body.space.own_dot(&self.condensed, &self.condensed)
    }

    /// Square of the residual of the rates that would mend the residuals of the constraints, for the mean mass of a
    /// node.
    fn square_of_constraints(&self, of_constraints: &[f64]) -> f64 {
        let constraints = self.equations.body.constraints();
        if constraints.is_empty() {
            return 0.0;
        }
        self.border.mass_of_node().powi(2) * of_constraints.iter().map(|c| c * c).sum::<f64>()
    }

    /// The rounding floor where supports move rigid bodies on which no force is left over, as at their centre of mass:
    /// that of the inertia of all nodes; else 0.
    fn floor_without_forces(&self, x: &[f64], scale: f64) -> f64 {
        if self.equations.body.constraints().is_empty() {
            return 0.0;
        }
        let rates = &x[..self.equations.blocks.rates];
        let inertia = self.border.mass_of_node() * rates.iter().map(|x| x * x).sum::<f64>().sqrt();
        if scale < FORCELESS * inertia { 16.0 * f64::EPSILON * inertia } else { 0.0 }
    }

    /// Sets the rounding floor, once per step.
    fn set_floor(&mut self, x: &[f64]) {
        if self.floor == 0.0 {
            let displacement = &self.equations.displacement;
            let increment = &x[..self.equations.body.n_dofs()];
            let size = self.approximate_tangent.rounding_size(
                self.equations.body,
                displacement,
                increment,
                self.equations.time_scale,
            );
            let size = size * self.approximate_tangent.soft_part();
            self.floor =
                FLOOR * f64::EPSILON * size * (self.equations.coefficients.rule.degree() as f64).sqrt();
        }
    }
}

impl StageSystem<'_> {
    /// Largest part, up to 1, of some rates that the forces admit.
    pub(in crate::time) fn largest_part_from_rest(&mut self, rates: &[f64]) -> f64 {
        if !self.equations.body.has_bounds() {
            return 1.0;
        }
        let zero = &mut self.negative[..rates.len()];
        zero.fill(0.0);
        self.equations.body.largest_part(&self.equations.step_at(zero), &self.equations.assembly, rates)
    }
}

fn missed(tolerance: f64) -> Error {
    Error::Linear { reason: format!("conjugate gradients did not reach {tolerance:e}") }
}

impl System for StageSystem<'_> {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<Sizes> {
        let [inertia, internal, external] = self.equations.full_residual(x, residual)?;
        let [of_rates, of_constraints, of_local] = self.equations.blocks.split_mut(residual);
        self.equations.body.space.clear_inactive(of_rates);
        let own = self.condensed_square(of_rates, of_local) + self.square_of_constraints(of_constraints);
        let mut squares = [inertia, internal, external, own];
        self.equations.body.space.sum_ranks("squares of a residual and its parts", &mut squares);
        let [inertia, internal, external, residual] = squares.map(f64::sqrt);
        let scale = [inertia, internal, external].into_iter().fold(0.0, f64::max);
        Ok(Sizes { residual, scale, floor: self.floor.max(self.floor_without_forces(x, scale)) })
    }

    fn correction(
        &mut self,
        x: &[f64],
        residual: &[f64],
        tolerance: f64,
        tangent: Tangent,
        dx: &mut [f64],
    ) -> Result<usize> {
        let n_rates = self.equations.blocks.rates;
        let (of_rates, of_local) = residual.split_at(self.negative.len());
        self.negative.iter_mut().zip(of_rates).for_each(|(b, r)| *b = -r);
        let local = &mut dx[of_rates.len()..];
        local.iter_mut().zip(of_local).for_each(|(change, r)| *change = -r);
        self.set_border(x);
        if tangent == Tangent::Refactorized || !self.approximate_tangent.is_factorised() {
            self.refactorize(x)?;
        }
        if self.approximate_tangent.rescale(self.equations.body, self.equations.time_scale)? {
            self.border.forget();
        }
        // The first correction is the largest: it may turn parts whose motion joints decide.
        if self.n_corrections == 1 && !self.equations.body.constraints().is_empty() {
            self.turn_parts(&x[..n_rates]);
        }
        self.n_corrections += 1;
        self.set_floor(x);
        self.set_flexibility()?;
        let iterations = match tangent {
            Tangent::Reused | Tangent::Refactorized => {
                self.couple(x)?;
                self.solve_approximately(tolerance, dx)
            }
            Tangent::Unchanged => self.solve_approximately(tolerance, dx),
            Tangent::Exact => {
                self.equations.assemble_tangent(x)?;
                self.solve_exactly(tolerance, dx)
            }
            Tangent::Renewed => {
                self.equations.renew_couplings(x)?;
                self.solve_exactly(tolerance, dx)
            }
            Tangent::LastExact => self.solve_exactly(tolerance, dx),
        }?;
        self.equations.body.space.complete("correction", &mut dx[..n_rates]);
        Ok(iterations)
    }

    fn largest_part(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        let [rates, ..] = self.equations.blocks.split(x);
        self.equations.body.largest_part(
            &self.equations.step_at(rates),
            &self.equations.assembly,
            &dx[..rates.len()],
        )
    }

    fn is_sudden(&mut self, x: &[f64]) -> bool {
        let [rates, ..] = self.equations.blocks.split(x);
        self.equations.body.has_sudden_force(&self.equations.step_at(rates), &self.equations.assembly)
    }

    fn approximates_sudden_parts(&self) -> bool {
        let body = self.equations.body;
        body.n_dofs_of_ranks() >= DOFS_OF_SMALL_BODY && self.approximate_tangent.takes_couplings(body)
    }

    fn refactorization_cost(&self) -> f64 {
        self.approximate_tangent.refactorization_cost()
    }

    /// The inertia of a stage is the difference of terms that grow with the degree like m_ij, and what a residual
    /// leaves has the same sign in every step.
    fn rounding(&self) -> f64 {
        match &self.equations.coefficients.mass[..] {
            [_] => ROUND_OFF,
            mass => 2.0 * ROUND_OFF / mass.iter().fold(2.0, |largest: f64, m| largest.max(m.abs())),
        }
    }

    fn ending(&self) -> Ending {
        self.ending
    }

    /// Another K costs less than GMRES with the exact tangent, unless the body is so small that both cost nothing or
    /// the last K contracted too little. With local unknowns the exact tangent differs from K by directions that the
    /// bulk modulus makes stiff, and GMRES may not converge.
    fn largest_contraction(&self, slow_corrections: usize) -> f64 {
        match (self.equations.body.has_local(), self.equations.body.n_dofs_of_ranks()) {
            (false, DOFS_OF_SMALL_BODY..) if slow_corrections == 0 => 0.4,
            (false, _) => 0.0,
            _ => 0.9,
        }
    }
}
