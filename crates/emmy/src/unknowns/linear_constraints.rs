//! Constraints linearised at a configuration, for modes and equilibria.

use super::constraint_step::ConstraintStep;
use super::constraints::Constraints;
use crate::error::Result;
use crate::nodal;
use crate::sparse::eliminate;

/// The motions that constraints allow at a configuration, `G v = 0`: some degrees of freedom of the joint nodes follow
/// from the others.
#[derive(Debug)]
pub(crate) struct LinearConstraints {
    times: ConstraintStep,
    /// Degrees of freedom of the joint nodes.
    dofs: Vec<usize>,
    /// Numbers among the joint nodes of the degrees of freedom that follow, and of those that they follow.
    dependent: Vec<usize>,
    independent: Vec<usize>,
    /// `v_d = W v_i`, `[n_dependent][n_independent]`.
    weights: Vec<f64>,
    /// The sums of constraints that say so, `v_d - W v_i = S G v`, `[n_dependent][n_constraints]`.
    sums: Vec<f64>,
}

/// Pivot over the largest one that is rounding, as in the range of the constraints.
const LEAST_PIVOT: f64 = 1e-8;

impl LinearConstraints {
    /// The constraints of a body, with the degrees of freedom that are held, at a displacement and a time; without a
    /// time, with given motions as drawn.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn new(
        (constraints, is_held): (&Constraints, &[bool]),
        displacement: &[f64],
        time: Option<f64>,
    ) -> Result<Self> {
        let mut times = ConstraintStep::new(constraints, 0);
        times.set_instant((constraints, is_held), time, &|dof| displacement[dof])?;
        let dofs: Vec<usize> = constraints.dofs().collect();
        let mut gradients = vec![0.0; constraints.len() * dofs.len()];
        if !dofs.is_empty() {
            constraints.set_gradients((&times, 0), &|dof| displacement[dof], &mut gradients);
        }
        for row in gradients.chunks_exact_mut(dofs.len().max(1)) {
            row.iter_mut().zip(&dofs).filter(|(_, dof)| is_held[**dof]).for_each(|(entry, _)| *entry = 0.0);
        }
        let (n, m) = (dofs.len(), constraints.len());
        let mut table = vec![0.0; m * (n + m)];
        for (c, row) in table.chunks_exact_mut((n + m).max(1)).enumerate() {
            row[..n].copy_from_slice(&gradients[c * n..(c + 1) * n]);
            row[n + c] = 1.0;
        }
        let dependent = reduce(&mut table, [m, n, n + m]);
        let mut is_free: Vec<bool> = dofs.iter().map(|dof| !is_held[*dof]).collect();
        dependent.iter().for_each(|&at| is_free[at] = false);
        let independent: Vec<usize> = (0..n).filter(|at| is_free[*at]).collect();
        let rows = || table.chunks_exact((n + m).max(1)).take(dependent.len());
        let weights = rows().flat_map(|row| independent.iter().map(|&at| -row[at])).collect();
        let sums = rows().flat_map(|row| row[n..].iter().copied()).collect();
        Ok(LinearConstraints { times, dofs, dependent, independent, weights, sums })
    }

    /// The constraints at the time.
    pub(crate) fn times(&self) -> &ConstraintStep {
        &self.times
    }

    /// Degrees of freedom of the joint nodes.
    pub(crate) fn dofs(&self) -> &[usize] {
        &self.dofs
    }

    /// The degrees of freedom that follow from the others.
    pub(crate) fn dependent(&self) -> impl ExactSizeIterator<Item = usize> {
        self.dependent.iter().map(|&at| self.dofs[at])
    }

    /// Sets the degrees of freedom that follow to those of an allowed motion, `motion: [n_nodes][3]`.
    pub(crate) fn complete(&self, motion: &mut [f64]) {
        for (&at, row) in self.dependent.iter().zip(self.rows()) {
            let terms = row.iter().zip(&self.independent).map(|(w, &at)| w * motion[self.dofs[at]]);
            motion[self.dofs[at]] = terms.sum();
        }
    }

    /// Moves the forces at degrees of freedom that follow to those that they follow: the work on allowed motions stays
    /// the same.
    pub(crate) fn gather(&self, force: &mut [f64]) {
        for (&at, row) in self.dependent.iter().zip(self.rows()) {
            let own = std::mem::take(&mut force[self.dofs[at]]);
            row.iter().zip(&self.independent).for_each(|(w, &at)| force[self.dofs[at]] += w * own);
        }
    }

    /// Independent constraints with the same motions, `v_d - W v_i = 0`, on the degrees of freedom of the joint nodes,
    /// `[n_dependent][n_dofs]`.
    pub(crate) fn independent_rows(&self) -> Vec<f64> {
        let n = self.dofs.len();
        let mut table = vec![0.0; self.dependent.len() * n];
        for ((&at, row), entries) in
            self.dependent.iter().zip(self.rows()).zip(table.chunks_exact_mut(n.max(1)))
        {
            entries[at] = 1.0;
            row.iter().zip(&self.independent).for_each(|(w, &at)| entries[at] = -w);
        }
        table
    }

    /// Numbers among the joint nodes of the degrees of freedom that are free and follow no others.
    pub(crate) fn independent(&self) -> &[usize] {
        &self.independent
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.weights.chunks(self.independent.len().max(1)).chain(std::iter::repeat(&[][..]))
    }

    /// The values of the constraints at displacements, in the sums that say which degrees of freedom follow.
    pub(crate) fn values(&self, constraints: &Constraints, displacement: &[f64]) -> Vec<f64> {
        let value = |c: usize| self.times.row(constraints, 0, c).value(&|dof| displacement[dof]);
        let values: Vec<f64> = (0..constraints.len()).map(value).collect();
        let sums = self.sums.chunks_exact(values.len().max(1));
        sums.map(|row| row.iter().zip(&values).map(|(s, value)| s * value).sum()).collect()
    }

    /// The multipliers of the constraints for those of the sums: of all with the same forces, the least ones.
    pub(crate) fn multipliers(&mut self, of_sums: &[f64]) -> Vec<f64> {
        let m = self.sums.len() / of_sums.len().max(1);
        let mut multipliers = vec![0.0; m];
        for (of_sum, row) in of_sums.iter().zip(self.sums.chunks_exact(m.max(1))) {
            multipliers.iter_mut().zip(row).for_each(|(sum, s)| *sum += s * of_sum);
        }
        self.times.project(&mut multipliers);
        multipliers
    }

    /// The multipliers that balance a force `[n_nodes][3]` of the body best: `|f + G^T lambda|` is least.
    pub(crate) fn balancing(&mut self, force: &[f64]) -> Vec<f64> {
        let rows = self.independent_rows();
        let rows = || rows.chunks_exact(self.dofs.len().max(1));
        let of_force = |row: &[f64]| row.iter().zip(&self.dofs).map(|(r, &dof)| -r * force[dof]).sum::<f64>();
        let mut of_sums: Vec<f64> = rows().map(of_force).collect();
        if of_sums.iter().any(|x| *x != 0.0) {
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let mut matrix: Vec<f64> = rows().flat_map(|a| rows().map(move |b| product(a, b))).collect();
            // 1 + W W^T is regular.
            eliminate(&mut matrix, &mut of_sums, 1);
        }
        self.multipliers(&of_sums)
    }

    /// Adds the forces `G^T lambda` of some multipliers at the displacement, on held degrees of freedom, too;
    /// `force: [n_nodes][3]`.
    pub(crate) fn add_force(
        &self,
        (constraints, displacement): (&Constraints, &[f64]),
        multipliers: &[f64],
        force: &mut [f64],
    ) {
        for (c, multiplier) in multipliers.iter().enumerate() {
            let row = self.times.row(constraints, 0, c);
            let mut add = |dof: usize, gradient: f64| force[dof] += multiplier * gradient;
            row.for_each_gradient(&|dof| displacement[dof], &mut add);
        }
    }

    /// The derivative `sum_c lambda_c G_c'` of the forces of some multipliers, `[n_dofs][n_dofs]`.
    pub(crate) fn curvature(&self, constraints: &Constraints, multipliers: &[f64]) -> Vec<f64> {
        let n = self.dofs.len();
        let mut table = vec![0.0; n * n];
        for (c, multiplier) in multipliers.iter().enumerate() {
            self.times.row(constraints, 0, c).for_each_curvature(&mut |[node, other], value| {
                for d in 0..3 {
                    let [row, column] =
                        [node, other].map(|node| constraints.local_dof(nodal::dof(node as usize, d)));
                    table[row * n + column] += multiplier * value;
                }
            });
        }
        table
    }
}

/// Brings a table of `[rows, columns, width]` to the reduced echelon form in its first columns, by elimination with
/// full pivoting. Returns the column of each pivot: the first rows have a one there and zeros in the columns of the
/// others.
fn reduce(table: &mut [f64], [n_rows, n_columns, width]: [usize; 3]) -> Vec<usize> {
    let mut pivots = Vec::new();
    let mut largest = 0.0f64;
    // The place and the size of the largest entry of each row, which few eliminations change.
    let largest_of = |row: &[f64]| {
        let sizes = row[..n_columns].iter().map(|entry| entry.abs()).enumerate();
        sizes.fold((0, 0.0), |most: (usize, f64), own| if own.1 > most.1 { own } else { most })
    };
    let mut best: Vec<(usize, f64)> = table.chunks_exact(width.max(1)).map(largest_of).collect();
    while pivots.len() < n_rows {
        let done = pivots.len();
        let Some(row) = (done..n_rows).max_by(|a, b| best[*a].1.total_cmp(&best[*b].1)) else { break };
        let (column, size) = best[row];
        largest = largest.max(size);
        if size <= LEAST_PIVOT * largest {
            break;
        }
        (0..width).for_each(|j| table.swap(done * width + j, row * width + j));
        best.swap(done, row);
        let mut own = table[done * width..(done + 1) * width].to_vec();
        let pivot = own[column];
        own.iter_mut().for_each(|entry| *entry /= pivot);
        own[column] = 1.0;
        let rows = table.chunks_exact_mut(width).zip(&mut best).enumerate();
        for (_, (entries, best)) in rows.filter(|(at, (entries, _))| *at != done && entries[column] != 0.0) {
            let factor = entries[column];
            entries.iter_mut().zip(&own).for_each(|(entry, x)| *entry -= factor * x);
            entries[column] = 0.0;
            *best = largest_of(entries);
        }
        table[done * width..(done + 1) * width].copy_from_slice(&own);
        pivots.push(column);
    }
    pivots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_follow_from_others_have_no_pivot() {
        // The third row is the sum of the first two.
        let rows = [[1.0, 2.0, 0.0, -1.0], [0.0, 0.3, 0.1, 0.0], [1.0, 2.3, 0.1, -1.0]];
        let mut table = vec![0.0; 21];
        for (c, row) in rows.iter().enumerate() {
            table[7 * c..7 * c + 4].copy_from_slice(row);
            table[7 * c + 4 + c] = 1.0;
        }
        let pivots = reduce(&mut table, [3, 4, 7]);
        assert_eq!(pivots.len(), 2);
        for own in table.chunks_exact(7).take(2) {
            for at in 0..4 {
                let sum: f64 = (0..3).map(|c| own[4 + c] * rows[c][at]).sum();
                assert!((sum - own[at]).abs() < 1e-15, "{table:?}");
            }
        }
        for (row, at) in rows.iter().flat_map(|row| (0..4).map(move |at| (row, at))) {
            let sum: f64 = pivots.iter().zip(table.chunks_exact(7)).map(|(&c, own)| row[c] * own[at]).sum();
            assert!((sum - row[at]).abs() < 1e-15, "{table:?}");
        }
    }
}
