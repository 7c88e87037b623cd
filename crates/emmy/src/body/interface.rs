//! Linear systems of a body with constraints, from the factorised matrix of the body alone.
//!
//! ```math
//! (A + Q) x + R^T mu = b,    R x = 0
//! ```
//!
//! A is a stiffness, in a search for modes with a mass; Q and R act on a few joint nodes B. R are independent rows with
//! the same motions as the gradients of the constraints, and `Q = sum_c lambda_c G_c'` is the stiffness of their
//! forces. With the inverse of A and its part F at B, a solution takes one with a dense matrix:
//!
//! ```math
//! z = A^-1 b,    x_B + F (Q x_B + R^T mu) = z_B,    R x_B = 0,    x = z - A^-1 (Q x_B + R^T mu)
//! ```
//!
//! The factor may have more at B than A, so that it is regular: Q takes it off.

#![allow(non_snake_case)]

use super::system::Body;
use crate::error::{Error, Result};
use crate::nodal;
use crate::sparse::{DenseLu, eigenvalues};
use crate::unknowns::LinearConstraints;

/// Part of the largest eigenvalue of the inverse that a negative one may have by rounding.
const ROUNDING: f64 = 1e-10;

/// Constraints at a configuration, and the dense system of the joint nodes.
#[derive(Debug)]
pub(crate) struct Interface {
    pub constraints: LinearConstraints,
    /// The stiffness of the forces of the constraints, `[n][n]`; empty without forces.
    stiffness: Vec<f64>,
    /// R, `[m][n]`.
    rows: Vec<f64>,
    /// Q, `[n][n]`.
    beside: Vec<f64>,
    /// F, `[n][n]`.
    flexibility: Vec<f64>,
    system: Option<DenseLu>,
}

impl Interface {
    /// Constraints of a body at a configuration with some multipliers.
    pub(crate) fn new(body: &Body, constraints: LinearConstraints, multipliers: &[f64]) -> Self {
        let is_loaded = multipliers.iter().any(|multiplier| *multiplier != 0.0);
        let stiffness = match is_loaded {
            true => constraints.curvature(body.constraints(), multipliers),
            false => Vec::new(),
        };
        let rows = constraints.independent_rows();
        let (beside, flexibility) = (Vec::new(), Vec::new());
        Interface { constraints, stiffness, rows, beside, flexibility, system: None }
    }

    /// Adds the product of the stiffness of the constraints' forces with a motion.
    pub(crate) fn add_product(&self, motion: &[f64], product: &mut [f64]) {
        let dofs = self.constraints.dofs();
        for (&dof, row) in dofs.iter().zip(self.stiffness.chunks_exact(dofs.len())) {
            product[dof] += row.iter().zip(dofs).map(|(entry, &dof)| entry * motion[dof]).sum::<f64>();
        }
    }

    /// The diagonal of the stiffness of the constraints' forces, with its degrees of freedom.
    pub(crate) fn diagonal(&self) -> impl Iterator<Item = (usize, f64)> {
        let n = self.constraints.dofs().len();
        let entries = self.stiffness.iter().step_by(n + 1);
        self.constraints.dofs().iter().copied().zip(entries.copied())
    }

    /// The carriers of a factor with a multiple of the mass, `[n][n]`.
    pub(crate) fn carriers(&self, body: &Body, factor: f64) -> Vec<f64> {
        let n = self.constraints.dofs().len();
        let mut table = vec![0.0; n * n];
        let local = |node: u32, d: usize| body.constraints().local_dof(nodal::dof(node as usize, d));
        for carrier in &body.mechanism.carriers {
            let pairs = carrier.weights().flat_map(|a| carrier.weights().map(move |b| (a, b)));
            for ((a, own), (b, other)) in pairs {
                (0..3).for_each(|d| table[local(a, d) * n + local(b, d)] += factor * own * other);
            }
        }
        table
    }

    /// Sets the dense system; `solve` applies the inverse of the factor, which has `more` at the joint nodes, `[n][n]`.
    ///
    /// # Errors
    /// [`Error::Linear`] if the system is singular.
    pub(crate) fn factorize(
        &mut self,
        body: &Body,
        more: &[f64],
        mut solve: impl FnMut(&mut [f64]),
    ) -> Result<()> {
        let dofs = self.constraints.dofs();
        let n = dofs.len();
        self.flexibility.clear();
        self.flexibility.resize(n * n, 0.0);
        let mut column = vec![0.0; body.n_dofs()];
        for (at, &dof) in dofs.iter().enumerate().filter(|(_, dof)| !body.space.inactive()[**dof]) {
            column.fill(0.0);
            column[dof] = 1.0;
            solve(&mut column);
            dofs.iter().enumerate().for_each(|(row, &dof)| self.flexibility[row * n + at] = column[dof]);
        }
        self.beside.clone_from(&self.stiffness);
        self.beside.resize(n * n, 0.0);
        self.beside.iter_mut().zip(more).for_each(|(entry, more)| *entry -= more);
        let size = n + self.rows.len() / n;
        let mut matrix = vec![0.0; size * size];
        for (row, of_row) in self.flexibility.chunks_exact(n).enumerate() {
            let own = &mut matrix[row * size..(row + 1) * size];
            own[row] = 1.0;
            let entries = of_row.iter().zip(self.beside.chunks_exact(n)).filter(|(f, _)| **f != 0.0);
            entries.for_each(|(f, row)| own.iter_mut().zip(row).for_each(|(sum, entry)| *sum += f * entry));
            for (sum, constraint) in own[n..].iter_mut().zip(self.rows.chunks_exact(n)) {
                *sum = of_row.iter().zip(constraint).map(|(f, r)| f * r).sum();
            }
        }
        for (row, constraint) in matrix[n * size..].chunks_exact_mut(size).zip(self.rows.chunks_exact(n)) {
            row[..n].copy_from_slice(constraint);
        }
        let singular = || Error::Linear { reason: "nothing holds some motion of the joints".to_string() };
        self.system = Some(DenseLu::new(&matrix).ok_or_else(singular)?);
        Ok(())
    }

    /// Whether `A + Q` is positive definite for allowed motions, if the factor is positive definite: the inverse has
    /// the signs that it has at the joint nodes.
    ///
    /// # Errors
    /// [`Error::Linear`] if its eigenvalues are not found.
    pub(crate) fn is_definite(&self) -> Result<bool> {
        let (Some(system), n) = (&self.system, self.constraints.dofs().len()) else { return Ok(false) };
        let independent = self.constraints.independent();
        let mut inverse = vec![0.0; independent.len() * independent.len()];
        let mut right = vec![0.0; n + self.rows.len() / n];
        for (own, &at) in inverse.chunks_exact_mut(independent.len().max(1)).zip(independent) {
            right.fill(0.0);
            (0..n).for_each(|row| right[row] = self.flexibility[row * n + at]);
            system.solve(&mut right);
            own.iter_mut().zip(independent).for_each(|(entry, &row)| *entry = right[row]);
        }
        let values = eigenvalues(&inverse)?;
        let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
        Ok(values.iter().all(|value| *value >= -ROUNDING * largest))
    }

    /// Whether the constraints' forces have a stiffness.
    pub(crate) fn is_loaded(&self) -> bool {
        !self.stiffness.is_empty()
    }

    /// Corrects solutions of the body alone, `[columns][n_nodes][3]`, with `solve` as before.
    pub(crate) fn correct(&self, body: &Body, mut solve: impl FnMut(&mut [f64]), solutions: &mut [f64]) {
        let Some(system) = &self.system else { return };
        let (dofs, n_dofs) = (self.constraints.dofs(), body.n_dofs());
        let n = dofs.len();
        let size = n + self.rows.len() / n;
        let mut right = vec![0.0; solutions.len() / n_dofs * size];
        for (own, solution) in right.chunks_exact_mut(size).zip(solutions.chunks_exact(n_dofs)) {
            own.iter_mut().zip(dofs).for_each(|(x, &dof)| *x = solution[dof]);
        }
        system.solve(&mut right);
        let mut changes = vec![0.0; solutions.len()];
        for (own, force) in right.chunks_exact(size).zip(changes.chunks_exact_mut(n_dofs)) {
            let (x_B, multipliers) = own.split_at(n);
            for (&dof, row) in dofs.iter().zip(self.beside.chunks_exact(n)) {
                force[dof] = row.iter().zip(x_B).map(|(entry, x)| entry * x).sum();
            }
            for (multiplier, row) in multipliers.iter().zip(self.rows.chunks_exact(n)) {
                dofs.iter().zip(row).for_each(|(&dof, r)| force[dof] += multiplier * r);
            }
            body.space.clear_inactive(force);
        }
        solve(&mut changes);
        solutions.iter_mut().zip(&changes).for_each(|(x, change)| *x -= change);
        // The rounding of large solutions of free bodies is in the constraints, too.
        solutions.chunks_exact_mut(n_dofs).for_each(|solution| self.constraints.complete(solution));
    }
}
