//! Velocities that constraints allow.

use super::mass::MassSolver;
use super::system::Body;
use crate::error::{Error, Result};
use crate::nodal;
use crate::sparse::eliminate;
use crate::unknowns::ConstraintStep;

/// Velocities that the constraints of a body allow, `G v + dPhi/dt = 0`, nearest to others by the kinetic energy.
///
/// ```math
/// v - M^-1 G^T nu,    (G M^-1 G^T) nu = G v + dPhi/dt
/// ```
///
/// With carriers S = n n^T in the factors, M^-1 is (M + S)^-1, and the force `n y` that takes a carrier off again is
/// one more multiplier, `y = n . (change of v)`: G has the row -n, and the matrix -1 on the diagonal.
#[derive(Debug)]
pub(crate) struct ConstrainedVelocity {
    solver: MassSolver,
    /// M^-1 at the degrees of freedom of the joint nodes, `[n][n]`.
    inverse_mass: Vec<f64>,
    dofs: Vec<usize>,
    times: ConstraintStep,
    gradients: Vec<f64>,
    /// Memory of the body's size.
    momentum: Vec<f64>,
    change: Vec<f64>,
}

/// Part of the rates of the constraints outside their range that is rounding.
const TOLERANCE: f64 = 1e-6;

/// Rates of the constraints over the velocities that are rounding.
const ROUNDING: f64 = 1e-10;

impl ConstrainedVelocity {
    /// The velocities of a body with constraints.
    ///
    /// # Errors
    /// As [`MassSolver::new`].
    pub(crate) fn new(body: &Body) -> Result<Self> {
        let constraints = body.constraints();
        let dofs: Vec<usize> = constraints.dofs().collect();
        let mut own = ConstrainedVelocity {
            solver: MassSolver::new(body)?,
            inverse_mass: vec![0.0; dofs.len() * dofs.len()],
            times: ConstraintStep::new(constraints, 0),
            gradients: vec![0.0; (constraints.len() + 3 * body.mechanism.carriers.len()) * dofs.len()],
            dofs,
            momentum: vec![0.0; body.n_dofs()],
            change: vec![0.0; body.n_dofs()],
        };
        let n = own.dofs.len();
        for (column, &dof) in own.dofs.iter().enumerate() {
            if body.space.inactive()[dof] {
                continue;
            }
            own.momentum[dof] = 1.0;
            own.solver.velocity(body, &own.momentum, &mut own.change)?;
            own.momentum[dof] = 0.0;
            own.dofs
                .iter()
                .enumerate()
                .for_each(|(row, &at)| own.inverse_mass[row * n + column] = own.change[at]);
        }
        Ok(own)
    }

    /// Takes from a velocity at a time what the constraints do not allow; at a kink of a given motion, on the side that
    /// the sign of the second number of `time` gives. Returns the largest `|G v + dPhi/dt|` before.
    ///
    /// # Errors
    /// [`Error::NoMotion`] if the given motions contradict each other, [`crate::Error::NotFiniteAt`].
    pub(crate) fn project(&mut self, body: &Body, time: [f64; 2], u: &[f64], v: &mut [f64]) -> Result<f64> {
        let (largest, impulses) = self.impulses(body, time, u, v)?;
        self.momentum.fill(0.0);
        self.dofs.iter().zip(&impulses).for_each(|(&dof, impulse)| self.momentum[dof] = *impulse);
        self.solver.velocity(body, &self.momentum, &mut self.change)?;
        v.iter_mut().zip(&self.change).for_each(|(v, change)| *v -= change);
        Ok(largest)
    }

    /// The same for the joint nodes alone.
    ///
    /// # Errors
    /// As [`ConstrainedVelocity::project`].
    pub(crate) fn project_joints(&mut self, body: &Body, time: f64, u: &[f64], v: &mut [f64]) -> Result<f64> {
        let (largest, impulses) = self.impulses(body, [time, 0.0], u, v)?;
        for (&dof, row) in self.dofs.iter().zip(self.inverse_mass.chunks_exact(impulses.len().max(1))) {
            v[dof] -= row.iter().zip(&impulses).map(|(f, impulse)| f * impulse).sum::<f64>();
        }
        Ok(largest)
    }

    /// The largest residual of a constraint at the time of the last projection, over the size of the body.
    pub(crate) fn opening(&self, body: &Body, u: &[f64]) -> f64 {
        let constraints = body.constraints();
        let value = |c: usize| self.times.row(constraints, 0, c).value(&|dof| u[dof]).abs();
        (0..constraints.len()).map(value).fold(0.0, f64::max) / constraints.size()
    }

    /// The largest `|G v + dPhi/dt|`, and `G^T nu` of the joint nodes.
    fn impulses(&mut self, body: &Body, time: [f64; 2], u: &[f64], v: &[f64]) -> Result<(f64, Vec<f64>)> {
        let constraints = body.constraints();
        if constraints.is_empty() {
            return Ok((0.0, Vec::new()));
        }
        let (n_constraints, n) = (constraints.len(), self.dofs.len());
        let m = n_constraints + 3 * body.mechanism.carriers.len();
        self.times.set_time((constraints, body.space.inactive()), time, &|dof| u[dof])?;
        let (of_constraints, of_carriers) = self.gradients.split_at_mut(n_constraints * n);
        constraints.set_gradients((&self.times, 0), &|dof| u[dof], of_constraints);
        of_carriers.fill(0.0);
        let carriers = body.mechanism.carriers.iter().flat_map(|carrier| (0..3).map(move |d| (carrier, d)));
        for (row, (carrier, d)) in of_carriers.chunks_exact_mut(n).zip(carriers) {
            if !carrier.is_free(d, |dof| body.fixed()[dof]) {
                continue;
            }
            for (node, weight) in carrier.weights() {
                row[constraints.local_dof(nodal::dof(node as usize, d))] = -weight;
            }
        }
        let rate = |c: usize| {
            let row = self.times.row(constraints, 0, c);
            row.rate(&|dof| u[dof], &|dof| v[dof]) + row.rate_of_time(&|dof| u[dof])
        };
        let mut nu: Vec<f64> = (0..n_constraints).map(rate).collect();
        let largest = nu.iter().fold(0.0, |largest: f64, rate| largest.max(rate.abs()));
        let fastest = self.dofs.iter().fold(0.0, |most: f64, &dof| most.max(v[dof].abs()));
        let scale = TOLERANCE * largest + ROUNDING * fastest;
        let all = nu.clone();
        self.times.project(&mut nu);
        if all.iter().zip(&nu).any(|(rate, inside)| (rate - inside).abs() > scale) {
            let outside: Vec<f64> = all.iter().zip(&nu).map(|(rate, inside)| rate - inside).collect();
            let [_, driven] = body.mechanism.open(&outside);
            return Err(Error::NoMotion { time: time[0], driven });
        }
        nu.resize(m, 0.0);
        let mut products = vec![0.0; m * n];
        for (product, gradient) in products.chunks_exact_mut(n).zip(self.gradients.chunks_exact(n)) {
            for (g, row) in gradient.iter().zip(self.inverse_mass.chunks_exact(n)).filter(|(g, _)| **g != 0.0)
            {
                product.iter_mut().zip(row).for_each(|(sum, f)| *sum += g * f);
            }
        }
        // With the constraints outside their range as in a step: further rows and columns of an orthonormal basis Z.
        let range = self.times.range();
        let size = m + range.n_redundant();
        let mut matrix = vec![0.0; size * size];
        for (column, gradient) in self.gradients.chunks_exact(n).enumerate() {
            for (at, g) in gradient.iter().enumerate().filter(|(_, g)| **g != 0.0) {
                let rows = matrix.chunks_exact_mut(size).zip(products.chunks_exact(n));
                rows.for_each(|(row, product)| row[column] += product[at] * g);
            }
        }
        (n_constraints..m).for_each(|at| matrix[at * size + at] -= 1.0);
        for (outside, z) in (m..).zip(range.complement()) {
            for (c, z) in z.iter().enumerate() {
                matrix[c * size + outside] = -z;
                matrix[outside * size + c] = *z;
            }
        }
        nu.resize(size, 0.0);
        if !eliminate(&mut matrix, &mut nu, 1) {
            return Err(Error::NoMotion { time: time[0], driven: Vec::new() });
        }
        let mut impulses = vec![0.0; n];
        for (nu, gradient) in nu[..m].iter().zip(self.gradients.chunks_exact(n)) {
            impulses.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += nu * g);
        }
        Ok((largest, impulses))
    }
}
