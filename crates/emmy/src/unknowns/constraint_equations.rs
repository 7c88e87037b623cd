//! The part of constraints in the equations of a step.

use super::constraint_step::ConstraintStep;
use super::constraints::Constraints;
use crate::force::StepInput;
use crate::nodal;

/// Derivatives of the equations of a step by the rates of the joint nodes, `n = 3 k n_nodes` of them, and by the
/// multipliers, m of them; dense, row by row. The constraints are those before the projection on their range.
#[derive(Debug, Default)]
pub(crate) struct Derivatives {
    /// Number of the constraints of a stage.
    pub n_constraints: usize,
    /// Of the constraints by the rates, `[m][n]`.
    pub rates: Vec<f64>,
    /// Of the forces by the multipliers, `[n][m]`.
    pub multipliers: Vec<f64>,
    /// Of the forces by the rates, at fixed multipliers, `[n][n]`.
    pub forces: Vec<f64>,
}

impl Constraints {
    /// Sets the residuals of a step, `residual: [k][n]`; of an equilibrium, those at its end.
    pub(crate) fn set_residual(
        &self,
        step: &StepInput<'_>,
        times: &mut ConstraintStep,
        residual: &mut [f64],
    ) {
        let (k, n_dofs, n) = (step.rule.degree(), step.displacement.len(), self.len());
        if step.rule.is_at_end() {
            let value = |c: usize| times.row(self, k, c).value(&|dof| step.displacement_at_end(dof));
            return residual.iter_mut().enumerate().for_each(|(c, residual)| *residual = value(c));
        }
        let weights = step.rule.weights();
        for c in 0..n {
            let start = self.rows()[c].value(&|dof| step.displacement[dof]);
            for i in 0..k {
                let (rates, u) = (&step.rates[i * n_dofs..], |dof| step.displacement_in(i, dof));
                let row = times.row(self, i, c);
                residual[i * n + c] = row.rate(&u, &|dof| rates[dof]);
                match row.drive {
                    None => residual[i * n + c] += start,
                    Some(_) => residual[i * n + c] += times.step_size() * row.rate_of_time(&u),
                }
            }
            if self.rows()[c].drive.is_some() {
                let end = times.row(self, k, c).value(&|dof| step.displacement_at_end(dof));
                let mean: f64 = (0..k).map(|j| weights[j] * residual[j * n + c]).sum();
                (0..k).for_each(|i| residual[i * n + c] += end - mean);
            }
        }
        residual.chunks_exact_mut(n).for_each(|of_stage| times.project(of_stage));
    }

    /// Sets the dense gradients of all constraints at a configuration, `[n][n_dofs of joint nodes]`.
    pub(crate) fn set_gradients(
        &self,
        (times, stage): (&ConstraintStep, usize),
        u: &dyn Fn(usize) -> f64,
        gradients: &mut [f64],
    ) {
        let n = self.n_dofs();
        gradients.fill(0.0);
        for (c, own) in gradients.chunks_exact_mut(n).enumerate() {
            let row = times.row(self, stage, c);
            row.for_each_gradient(u, &mut |dof, value| own[self.local_dof(dof)] += value);
        }
    }

    /// Adds a multiple of the forces `G(q_i)^T Lambda_i` of a stage, `force: [n_nodes][3]`; `multipliers: [k][n]`.
    pub(crate) fn add_force(
        &self,
        (step, times): (&StepInput<'_>, &ConstraintStep),
        stage: usize,
        (factor, multipliers): (f64, &[f64]),
        force: &mut [f64],
    ) {
        let of_stage = &multipliers[stage * self.len()..];
        for (c, multiplier) in (0..self.len()).zip(of_stage) {
            let add = &mut |dof: usize, value: f64| force[dof] += factor * multiplier * value;
            times.row(self, stage, c).for_each_gradient(&|dof| step.displacement_in(stage, dof), add);
        }
    }

    /// The work of given motions in a step, `-sum_i b_i lambda_i . G(q_i) x_i`. Other constraints do none.
    pub(crate) fn work(&self, step: &StepInput<'_>, times: &ConstraintStep, multipliers: &[f64]) -> f64 {
        if !times.is_driven() {
            return 0.0;
        }
        let (n_dofs, n) = (step.displacement.len(), self.len());
        let of_stage = |i: usize| -> f64 {
            let x = &step.rates[i * n_dofs..];
            let rate =
                |c: usize| times.row(self, i, c).rate(&|dof| step.displacement_in(i, dof), &|dof| x[dof]);
            (0..n).map(|c| multipliers[i * n + c] * rate(c)).sum()
        };
        let stages = step.rule.weights().iter().enumerate();
        -stages.map(|(i, b)| b * of_stage(i)).sum::<f64>() / times.step_size().powi(2)
    }

    /// Sets the derivatives at a step with multipliers.
    ///
    /// ```math
    /// dC_i/dx_j = delta_ij G(q_i) + a_ij G'(x_i),    df_i/dLambda_i = G(q_i)^T,    df_i/dx_j = a_ij Lambda_i G'
    /// ```
    ///
    /// Derivatives of driven constraints are those of `r_i`, as the rest is that of the quadrature.
    pub(crate) fn set_derivatives(
        &self,
        (step, times): (&StepInput<'_>, &ConstraintStep),
        multipliers: &[f64],
        derivatives: &mut Derivatives,
    ) {
        let (k, n_dofs) = (step.rule.degree(), step.displacement.len());
        let (of_stage, rows) = (self.n_dofs(), self.len());
        let (n, m) = (k * of_stage, k * rows);
        let Derivatives { n_constraints, rates, multipliers: by_multipliers, forces } = derivatives;
        *n_constraints = rows;
        let tables = [(&mut *rates, m * n), (&mut *by_multipliers, n * m), (&mut *forces, n * n)];
        for (table, len) in tables {
            table.clear();
            table.resize(len, 0.0);
        }
        let a = step.rule.coefficients();
        let stages = (0..k).flat_map(|i| (0..rows).map(move |c| (i, c)));
        for (i, c) in stages {
            let (row, at) = (times.row(self, i, c), i * rows + c);
            row.for_each_gradient(&|dof| step.displacement_in(i, dof), &mut |dof, value| {
                let column = i * of_stage + self.local_dof(dof);
                rates[at * n + column] += value;
                by_multipliers[column * m + at] += value;
            });
            let x = &step.rates[i * n_dofs..];
            row.for_each_curvature(&mut |[node, other], value| {
                for (d, j) in (0..3).flat_map(|d| (0..k).map(move |j| (d, j))) {
                    let (own, other) = (nodal::dof(node as usize, d), nodal::dof(other as usize, d));
                    let weight = a[i * k + j] * value;
                    let column = j * of_stage + self.local_dof(own);
                    rates[at * n + column] += weight * x[other];
                    forces[(i * of_stage + self.local_dof(other)) * n + column] += weight * multipliers[at];
                }
            });
        }
    }
}
