//! The rates that strain a rotating body.

use std::ops::Range;

use crate::average::Rule;
use crate::nodal;
use crate::sparse::eliminate;
use crate::tensor::rotation::skew;

/// Transformation C from changes of the rates to the changes that strain the body, `[3 k][3 k]`, the same at every
/// node.
///
/// An energy-momentum rule takes the strain rate `E'_m = sym(F(c_m)^T F'_m)`. In a body that rotates with spins w_m, it
/// responds to a change of the rates by `sym(F(c_m)^T (dF'_m - [w_m] sum_j a_mj dF'_j))`. The rates that strain the
/// body are `y = C x`, node by node, with
///
/// ```math
/// C_mj = delta_mj 1 - a_mj [w_m]
/// ```
///
/// The spins belong to the rigid motion that obeys the equations of the step. With the spins of the iterate, found by
/// least squares, Newton's residuals agree in two digits.
#[derive(Debug)]
pub(super) struct StrainRateTransform {
    degree: usize,
    matrix: Vec<f64>,
    inverse: Vec<f64>,
}

impl StrainRateTransform {
    /// Memory for a degree.
    pub(super) fn new(degree: usize) -> Self {
        let n = 3 * degree;
        StrainRateTransform { degree, matrix: vec![0.0; n * n], inverse: vec![0.0; n * n] }
    }

    /// Sets the matrix for the spins of a step; the identity if it is singular.
    pub(super) fn set_spins(&mut self, rule: &Rule, spins: &[[f64; 3]]) {
        let k = self.degree;
        let n = 3 * k;
        let a = rule.coefficients();
        set_identity(&mut self.matrix, n);
        set_identity(&mut self.inverse, n);
        for m in 0..k {
            let spin = skew(&spins[m]);
            for d in 0..3 {
                for j in 0..k {
                    for e in 0..3 {
                        self.matrix[(3 * m + d) * n + 3 * j + e] -= a[m * k + j] * spin[d][e];
                    }
                }
            }
        }
        if !eliminate(&mut self.matrix, &mut self.inverse, n) {
            set_identity(&mut self.inverse, n);
        }
    }

    /// `x = C^-1 x` at the nodes of some degrees of freedom; x: `[k][n_nodes][3]`, `old`: its copy.
    pub(super) fn apply_inverse(&self, old: &[f64], x: &mut [f64], turning: &[Range<usize>]) {
        let k = self.degree;
        let n = x.len() / self.degree;
        for i in 0..k {
            for node in turning.iter().flat_map(|range| range.start / 3..range.end / 3) {
                for d in 0..3 {
                    let row = &self.inverse[(3 * i + d) * 3 * k..][..3 * k];
                    let old = |column: usize| old[column / 3 * n + nodal::dof(node, column % 3)];
                    x[i * n + nodal::dof(node, d)] = (0..3 * k).map(|column| row[column] * old(column)).sum();
                }
            }
        }
    }
}

fn set_identity(matrix: &mut [f64], n: usize) {
    matrix.fill(0.0);
    matrix.iter_mut().step_by(n + 1).for_each(|diagonal| *diagonal = 1.0);
}
