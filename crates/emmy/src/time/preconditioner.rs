//! Preconditioner of the stage system by real Cholesky factorisations.
//!
//! With `df_i/dx_j ~ w_ij K`, one symmetric `K`, the stage system times `m^-1` is `I (x) M + h^2 m^-1 w (x) K`; for a time
//! element both `m^-1` and `w` are `a`. In the eigenbasis of `m^-1 w` it falls into `M + h^2 lambda K`. For complex `lambda` of argument phi the real matrix
//! `M + h^2 |lambda| K`, turned by `exp(i phi/2)`, stands in: in an eigenvector of `K` with `x = h^2 |lambda| omega^2`
//!
//! ```math
//! exp(-i phi/2) (1 + exp(i phi) x) / (1 + x) = cos(phi/2) + i sin(phi/2) (x - 1) / (x + 1)
//! ```
//!
//! a segment of the right half plane whatever the step size.

use super::stage_system::StageForm;
use crate::body::Body;
use crate::error::Result;
use crate::sparse::{BlockCholesky, Eigenpairs, StageMatrix, eigenpairs};

/// Factorisations of `M + h^2 |lambda| K` and the change of basis between stages and eigenvectors.
#[derive(Debug)]
pub struct Preconditioner {
    groups: Vec<Group>,
    /// Weights w_ij that make `h^2 K` of the stage matrix, and the multiple of M to take off.
    weights: Vec<f64>,
    mass_multiple: f64,
    /// h^2 K, `[block][3 a + b]`.
    stiffness: Vec<f64>,
}

/// One eigenvalue of m^-1 w, or a conjugate pair.
#[derive(Debug)]
struct Group {
    modulus: f64,
    /// Number of real right-hand sides: 1, or 2 for a pair.
    n_columns: usize,
    /// From stages to right-hand sides, `[column][i]`.
    forward: Vec<f64>,
    /// From solutions to stages, `[i][column]`.
    backward: Vec<f64>,
    factor: BlockCholesky,
}

impl Preconditioner {
    /// Symbolic work for a body and the equations of a step.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub fn new(body: &Body, form: &StageForm) -> Result<Self> {
        let (k, a, w) = (form.rule.degree(), &form.inverse_mass, &form.response);
        let product: Vec<f64> =
            (0..k * k).map(|n| (0..k).map(|m| a[n / k * k + m] * w[m * k + n % k]).sum()).collect();
        let eigen = eigenpairs(&product)?;
        let groups = (0..k).filter(|&m| eigen.values[m].1 > -PAIRED);
        let groups = groups.map(|m| Group::new(body, a, &eigen, m)).collect::<Result<_>>()?;
        let weights: Vec<f64> = (0..k * k).map(|n| form.mean[n / k]).collect();
        let mass_multiple = weights.iter().zip(&form.mass).map(|(n, m)| n * m).sum();
        Ok(Preconditioner {
            groups,
            weights,
            mass_multiple,
            stiffness: vec![0.0; 9 * body.pattern().n_blocks()],
        })
    }

    /// Numerical factorisations for a stage matrix.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if the matrix is not finite.
    pub fn factorize(&mut self, body: &Body, matrix: &StageMatrix) -> Result<()> {
        matrix.symmetric_sum(
            body.pattern(),
            &self.weights,
            body.mass(),
            self.mass_multiple,
            &mut self.stiffness,
        );
        for group in &mut self.groups {
            let (stiffness, modulus) = (&self.stiffness, group.modulus);
            group.factor.factorize(|source| {
                // Entries 0, 4, 8 are the diagonal of a 3 x 3 block.
                let mass = if source % 9 % 4 == 0 { body.mass()[source / 9] } else { 0.0 };
                mass + modulus * stiffness[source]
            })?;
        }
        Ok(())
    }

    /// `z = P^-1 r`; `r`, `z`: `[k][n_nodes][3]`.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        z.fill(0.0);
        let k = self.weights.len().isqrt();
        let n_dofs = r.len() / k;
        for group in &mut self.groups {
            let (forward, backward, n_columns) = (&group.forward, &group.backward, group.n_columns);
            let read = |_: &&mut [f64], column: usize, row: usize| {
                (0..k).map(|i| forward[column * k + i] * r[i * n_dofs + row]).sum::<f64>()
            };
            let write = |z: &mut &mut [f64], column: usize, row: usize, value: f64| {
                (0..k).for_each(|i| z[i * n_dofs + row] += backward[i * n_columns + column] * value);
            };
            group.factor.solve(n_columns, &mut &mut *z, read, write);
        }
    }

    /// Norm of `|h^2 K| |u|` over the free degrees of freedom: rounding of the forces is eps times this.
    pub fn rounding_size(&self, body: &Body, displacement: &[f64], increment: &[f64]) -> f64 {
        let size = |dof: usize| displacement[dof].abs() + increment[dof].abs();
        let row_sum = |row: usize, a: usize| -> f64 {
            let blocks = body.pattern().range(row).zip(body.pattern().row(row));
            blocks
                .map(|(block, &column)| {
                    (0..3)
                        .map(|b| self.stiffness[9 * block + 3 * a + b].abs() * size(3 * column as usize + b))
                        .sum::<f64>()
                })
                .sum()
        };
        let rows = (0..body.n_dofs()).filter(|&dof| !body.fixed()[dof]);
        rows.map(|dof| row_sum(dof / 3, dof % 3).powi(2)).sum::<f64>().sqrt()
    }
}

/// An eigenvalue counts as real when its imaginary part is below this.
const PAIRED: f64 = 1e-12;

impl Group {
    fn new(body: &Body, a: &[f64], eigen: &Eigenpairs, m: usize) -> Result<Self> {
        let k = eigen.values.len();
        let (re, im) = eigen.values[m];
        let n_columns = if im > PAIRED { 2 } else { 1 };
        // Row m of V^-1 times the inverse of the mass coefficients.
        let row = |i: usize, part: fn(&(f64, f64)) -> f64| -> f64 {
            (0..k).map(|l| part(&eigen.inverse[m * k + l]) * a[l * k + i]).sum()
        };
        let mut forward: Vec<f64> = (0..k).map(|i| row(i, |z| z.0)).collect();
        let mut backward = Vec::new();
        if n_columns == 2 {
            forward.extend((0..k).map(|i| row(i, |z| z.1)));
            // 2 Re [ V_im exp(-i phi/2) (y_1 + i y_2) ]
            let (sin, cos) = (-0.5 * im.atan2(re)).sin_cos();
            for i in 0..k {
                let (v_re, v_im) = eigen.vectors[i * k + m];
                backward.extend([2.0 * (v_re * cos - v_im * sin), -2.0 * (v_re * sin + v_im * cos)]);
            }
        } else {
            backward.extend((0..k).map(|i| eigen.vectors[i * k + m].0));
        }
        let factor = BlockCholesky::new(body.pattern(), 3, body.fixed(), body.node_order())?;
        Ok(Group { modulus: re.hypot(im), n_columns, forward, backward, factor })
    }
}
