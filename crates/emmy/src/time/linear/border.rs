//! Corrections of the rates together with the multipliers of constraints.
//!
//! Constraints act on a few joint nodes B. Their derivatives at the iterate are exact, those of the rest of the body
//! are kept: with the approximate inverse `P^-1` of the stage equations and its part F at the joint nodes, a correction
//! is
//!
//! ```math
//! z = P^-1 (-R),    x_B + F (Q x_B + G^T dLambda) = z_B,    J x_B = -C,    dx = z - P^-1 (Q x_B + G^T dLambda)
//! ```
//!
//! Constraints outside the range of all, with the orthonormal basis Z, need not hold: `J x_B - Z nu = -C` with the
//! unknowns nu, and `Z^T dLambda = 0`.
//!
//! Q contains the derivatives of springs and dampers in joints, which P leaves out, and takes off what carriers add to
//! the mass in P, `m_ij S`.

use crate::body::Body;
use crate::error::{Error, Result};
use crate::force::StepInput;
use crate::nodal;
use crate::sparse::eliminate;
use crate::unknowns::{ConstraintStep, Derivatives};

/// Tolerance of F, which many corrections use.
const FLEXIBILITY_TOLERANCE: f64 = 1e-8;

/// The dense system of the joint nodes and the multipliers.
#[derive(Debug, Default)]
pub(crate) struct Border {
    /// Entries of the joint nodes among the rates, `[k][n_nodes][3]`.
    entries: Vec<usize>,
    /// Whether each of them is held: forces of constraints do not move it.
    is_held: Vec<bool>,
    /// F in the orientation of K, `[n][n]`, once it is computed.
    unturned: Vec<f64>,
    is_computed: bool,
    /// F, once it is turned.
    flexibility: Vec<f64>,
    is_turned: bool,
    /// Mean mass of a node.
    mass_of_node: f64,
    derivatives: Derivatives,
    /// Z of a stage, `[vector][constraint]`.
    complement: Vec<f64>,
    /// Q, if there are carriers, springs or dampers; without them it is that of the derivatives.
    beside: Vec<f64>,
    /// Memory for the dense system, its right side, and a right side and a solution of the body.
    matrix: Vec<f64>,
    right: Vec<f64>,
    force: Vec<f64>,
    column: Vec<f64>,
}

impl Border {
    /// Memory for the constraints of a body.
    pub(crate) fn new(body: &Body, degree: usize) -> Self {
        let n = body.n_dofs();
        let stages = 0..degree;
        let entries: Vec<usize> =
            stages.flat_map(|i| body.constraints().dofs().map(move |dof| i * n + dof)).collect();
        let is_held = entries.iter().map(|at| body.space.inactive()[at % n]).collect();
        let mass = if entries.is_empty() { 0.0 } else { body.total_lumped_mass() };
        let mass_of_node = mass / body.mesh().n_nodes() as f64;
        Border { entries, is_held, mass_of_node, ..Border::default() }
    }

    /// Forgets F: the approximate inverse is another one.
    pub(crate) fn forget(&mut self) {
        self.is_computed = false;
        self.is_turned = false;
    }

    /// The parts of the body turned: F turns with them.
    pub(crate) fn turn(&mut self) {
        self.is_turned = false;
    }

    /// Sets F in the orientation of K, unless it is known; `solve` solves there for stage forces, `[k][n_nodes][3]`.
    ///
    /// # Errors
    /// Those of `solve`.
    pub(crate) fn set_unturned(
        &mut self,
        n_rates: usize,
        mut solve: impl FnMut(&[f64], &mut [f64], f64) -> Result<usize>,
    ) -> Result<()> {
        if self.is_computed {
            return Ok(());
        }
        // A part of the set-up, as factorising is: a resumed motion repeats it, so its iterations do not count.
        let n = self.entries.len();
        self.force.resize(n_rates, 0.0);
        self.column.resize(n_rates, 0.0);
        self.unturned.resize(n * n, 0.0);
        for (column, &at) in self.entries.iter().enumerate() {
            self.force.fill(0.0);
            self.force[at] = 1.0;
            self.column.fill(0.0);
            if !self.is_held[column] {
                solve(&self.force, &mut self.column, FLEXIBILITY_TOLERANCE)?;
            }
            self.entries.iter().enumerate().for_each(|(row, &at)| {
                self.unturned[row * n + column] = self.column[at];
            });
        }
        self.is_computed = true;
        Ok(())
    }

    /// Sets F from that in the orientation of K, unless it is known; `turn` turns a table of the joint nodes, with
    /// memory for another.
    pub(crate) fn set_turned(&mut self, turn: impl FnOnce(&mut [f64], &mut [f64])) {
        if self.is_turned {
            return;
        }
        self.flexibility.clone_from(&self.unturned);
        self.matrix.resize(self.unturned.len(), 0.0);
        turn(&mut self.flexibility, &mut self.matrix[..self.unturned.len()]);
        self.is_turned = true;
    }

    /// Mean mass of a node, which weighs the residuals of the constraints.
    pub(crate) fn mass_of_node(&self) -> f64 {
        self.mass_of_node
    }

    /// Sets the derivatives at a step with multipliers; `mass`: the coefficients m_ij of the masses.
    pub(crate) fn set(
        &mut self,
        body: &Body,
        step: (&StepInput<'_>, &ConstraintStep),
        multipliers: &[f64],
        mass: impl Fn(usize, usize) -> f64,
    ) {
        let k = step.0.rule.degree();
        self.complement.clear();
        self.complement.extend(step.1.range().complement().flatten());
        body.constraints().set_derivatives(step, multipliers, &mut self.derivatives);
        self.beside.clear();
        let laws = || body.mechanism.laws().filter(|law| law.has_stored_force());
        if body.mechanism.carriers.is_empty() && laws().next().is_none() {
            return;
        }
        self.beside.extend_from_slice(&self.derivatives.forces);
        let n = self.entries.len();
        let local = |stage: usize, dof: usize| stage * (n / k) + body.constraints().local_dof(dof);
        for law in laws() {
            law.for_each_stored_derivative(step.0, &mut |[i, j], [own, other], value| {
                self.beside[local(i, own) * n + local(j, other)] += value;
            });
        }
        for carrier in &body.mechanism.carriers {
            for ((a, own), (b, other)) in
                carrier.weights().flat_map(|a| carrier.weights().map(move |b| (a, b)))
            {
                for (i, j, d) in (0..k * k * 3).map(|at| (at / (3 * k), at / 3 % k, at % 3)) {
                    let [a, b] = [a, b].map(|node| nodal::dof(node as usize, d));
                    self.beside[local(i, a) * n + local(j, b)] -= mass(i, j) * own * other;
                }
            }
        }
    }

    /// Q, row by row.
    fn forces(&self) -> &[f64] {
        if self.beside.is_empty() { &self.derivatives.forces } else { &self.beside }
    }

    /// Adds the products of the derivatives with changes of the rates and the multipliers to those of the body.
    pub(crate) fn add_product(
        &mut self,
        (x, multipliers): (&[f64], &[f64]),
        (y, rows): (&mut [f64], &mut [f64]),
    ) {
        let n = self.entries.len();
        for (row, rates) in rows.iter_mut().zip(self.derivatives.rates.chunks_exact(n)) {
            *row = rates.iter().zip(&self.entries).map(|(entry, &at)| entry * x[at]).sum();
        }
        let of_stage = self.derivatives.n_constraints;
        for (rows, multipliers) in rows.chunks_exact_mut(of_stage).zip(multipliers.chunks_exact(of_stage)) {
            for z in self.complement.chunks_exact(of_stage) {
                let outside: f64 =
                    z.iter().zip(multipliers.iter().zip(&*rows)).map(|(z, (l, r))| z * (l - r)).sum();
                rows.iter_mut().zip(z).for_each(|(row, z)| *row += outside * z);
            }
        }
        let mut x_B = std::mem::take(&mut self.right);
        x_B.clear();
        x_B.extend(self.entries.iter().map(|&at| x[at]));
        self.add_forces(&self.derivatives.forces, (&x_B, multipliers), y);
        self.right = x_B;
    }

    /// Adds `Q x_B + G^T dLambda`, Q row by row.
    fn add_forces(&self, Q: &[f64], (x_B, multipliers): (&[f64], &[f64]), y: &mut [f64]) {
        let (n, m) = (self.entries.len(), multipliers.len());
        let by_multipliers = &self.derivatives.multipliers;
        let rows = Q.chunks_exact(n).zip(by_multipliers.chunks_exact(m));
        let entries = self.entries.iter().zip(&self.is_held).zip(rows).filter(|((_, held), _)| !**held);
        for ((&at, _), (forces, by_multipliers)) in entries {
            let of_rates: f64 = forces.iter().zip(x_B).map(|(entry, x)| entry * x).sum();
            let own: f64 = by_multipliers.iter().zip(multipliers).map(|(entry, x)| entry * x).sum();
            y[at] += of_rates + own;
        }
    }

    /// Corrects a solution of the body alone, so that it obeys the constraints; on input `multipliers` are the negative
    /// residuals -C, on output the changes of the multipliers. `solve` applies `P^-1` to stages, `[k][n_nodes][3]`, to
    /// a relative tolerance: to the forces of the constraints. Returns its number of iterations.
    ///
    /// # Errors
    /// Those of `solve`; [`Error::Linear`] if the system is singular.
    pub(crate) fn solve(
        &mut self,
        solve: impl FnOnce(&[f64], &mut [f64], f64) -> Result<usize>,
        tolerance: f64,
        solution: &mut [f64],
        multipliers: &mut [f64],
    ) -> Result<usize> {
        let (n, m) = (self.entries.len(), multipliers.len());
        self.force.resize(solution.len(), 0.0);
        self.column.resize(solution.len(), 0.0);
        let n_outside = self.set_matrix(n, m);
        self.right.clear();
        self.right.extend(self.entries.iter().map(|&at| solution[at]));
        self.right.extend_from_slice(multipliers);
        self.right.resize(n + m + n_outside, 0.0);
        if !eliminate(&mut self.matrix, &mut self.right, 1) {
            let reason = "the constraints depend on each other, or hold what nothing moves".to_string();
            return Err(Error::Linear { reason });
        }
        let (x_B, changes) = self.right[..n + m].split_at(n);
        multipliers.copy_from_slice(changes);
        let mut force = std::mem::take(&mut self.force);
        force.fill(0.0);
        self.add_forces(self.forces(), (x_B, changes), &mut force);
        self.column.fill(0.0);
        let solved = solve(&force, &mut self.column, tolerance);
        self.force = force;
        solution.iter_mut().zip(&self.column).for_each(|(dx, change)| *dx -= change);
        solved
    }

    /// Sets `[1 + F Q, F G^T, 0; J, 0, -Z; 0, Z^T, 0]`. Returns the number of vectors of Z in all stages.
    fn set_matrix(&mut self, n: usize, m: usize) -> usize {
        let of_stage = self.derivatives.n_constraints;
        let vectors = self.complement.len() / of_stage;
        let n_outside = vectors * m / of_stage;
        let size = n + m + n_outside;
        let mut matrix = std::mem::take(&mut self.matrix);
        matrix.clear();
        matrix.resize(size * size, 0.0);
        let Derivatives { rates, multipliers, .. } = &self.derivatives;
        let forces = self.forces();
        for (row, flexibility) in self.flexibility.chunks_exact(n).enumerate() {
            let own = &mut matrix[row * size..row * size + n + m];
            own[row] = 1.0;
            // Rigid bodies move their own nodes alone.
            for (l, f) in flexibility.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                let (of_rates, of_multipliers) = own.split_at_mut(n);
                let forces = of_rates.iter_mut().zip(&forces[l * n..(l + 1) * n]);
                forces.for_each(|(sum, entry)| *sum += f * entry);
                let multipliers = of_multipliers.iter_mut().zip(&multipliers[l * m..(l + 1) * m]);
                multipliers.for_each(|(sum, entry)| *sum += f * entry);
            }
        }
        for (row, rates) in matrix[n * size..].chunks_exact_mut(size).zip(rates.chunks_exact(n)) {
            row[..n].copy_from_slice(rates);
        }
        for (vector, z) in (0..n_outside).map(|at| (at, at % vectors)) {
            let (stage, outside) = (vector / vectors, n + m + vector);
            for (c, z) in self.complement[z * of_stage..(z + 1) * of_stage].iter().enumerate() {
                let multiplier = n + stage * of_stage + c;
                matrix[multiplier * size + outside] = -z;
                matrix[outside * size + multiplier] = *z;
            }
        }
        self.matrix = matrix;
        n_outside
    }
}
