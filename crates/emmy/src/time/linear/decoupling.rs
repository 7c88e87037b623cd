//! Decoupling of the stage equations, linearised with one stiffness, into systems of the size of the body.
//!
//! With `df_i/dx_j ~ w_ij K`, one symmetric `K`, the stage system times `m^-1` is `I (x) M + s^2 m^-1 w (x) K`; for a
//! time element both `m^-1` and `w` are `a`. In the eigenbasis of `m^-1 w` it decouples into `M + s^2 lambda K`
//! (Butcher 1976). A complex lambda represents itself and its conjugate. It is approximated by the real matrix `M + s^2
//! |lambda| K`, rotated by half the argument phi of lambda: in an eigenvector of `K` with `x = s^2 |lambda| omega^2`
//!
//! ```math
//! exp(-i phi/2) (1 + exp(i phi) x) / (1 + x) = cos(phi/2) + i sin(phi/2) (x - 1) / (x + 1)
//! ```
//!
//! a segment of the right half plane for any step size.
//!
//! A viscosity C that is no multiple of K adds `s m^-1 (x) C` to this system. Because a time element has `m^-1 = w`,
//! the modes decouple it too, into `M + s^2 lambda K + s nu C` with the eigenvalue nu of `m^-1`.

use crate::error::Result;
use crate::sparse::{Eigenpairs, eigenpairs};

/// One eigenvalue of `m^-1 w`, or a conjugate pair, with its change of basis from and to the stages.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StageMode {
    /// Eigenvalue lambda, (real, imaginary); the imaginary part is not negative.
    pub eigenvalue: [f64; 2],
    /// Eigenvalue nu of `m^-1` in this mode, of a time element.
    pub inverse_mass: [f64; 2],
    /// From stages to right-hand sides, `[column][i]`: one column, or two for a pair.
    pub forward: Vec<f64>,
    /// From solutions to stages, `[i][column]`.
    pub backward: Vec<f64>,
    /// From solutions with the real matrix to stages, `[i][column]`.
    pub turned: Vec<f64>,
}

/// An eigenvalue counts as real when its imaginary part is below this.
const PAIRED: f64 = 1e-12;

/// The modes of the equations of a step, by their coefficients `m^-1` and w, `[i k + j]`; real ones first.
///
/// # Errors
/// [`crate::Error::Linear`] if the eigenvalues are not found.
pub(super) fn modes(inverse_mass: &[f64], response: &[f64]) -> Result<Vec<StageMode>> {
    let k = response.len().isqrt();
    let a = inverse_mass;
    let w = response;
    let product: Vec<f64> =
        (0..k * k).map(|n| (0..k).map(|m| a[n / k * k + m] * w[m * k + n % k]).sum()).collect();
    let eigen = eigenpairs(&product)?;
    let first_of_pair = (0..k).filter(|&m| eigen.values[m].1 > -PAIRED);
    let mut modes: Vec<StageMode> = first_of_pair.map(|m| StageMode::new(a, &eigen, m)).collect();
    modes.sort_by_key(StageMode::n_columns);
    Ok(modes)
}

impl StageMode {
    fn new(a: &[f64], eigen: &Eigenpairs, m: usize) -> Self {
        let k = eigen.values.len();
        let (re, im) = eigen.values[m];
        // Row m of V^-1 times the inverse of the mass coefficients.
        let row = |i: usize, part: fn(&(f64, f64)) -> f64| -> f64 {
            (0..k).map(|l| part(&eigen.inverse[m * k + l]) * a[l * k + i]).sum()
        };
        let mut forward: Vec<f64> = (0..k).map(|i| row(i, |z| z.0)).collect();
        let imaginary: Vec<f64> = (0..k).map(|i| row(i, |z| z.1)).collect();
        let products = forward.iter().zip(&imaginary).enumerate().map(|(i, (re, im))| {
            let (v_re, v_im) = eigen.vectors[i * k + m];
            [re * v_re - im * v_im, re * v_im + im * v_re]
        });
        let inverse_mass = products.fold([0.0; 2], |sum, z| [sum[0] + z[0], sum[1] + z[1]]);
        if im <= PAIRED {
            let backward: Vec<f64> = (0..k).map(|i| eigen.vectors[i * k + m].0).collect();
            let (eigenvalue, inverse_mass) = ([re, 0.0], [inverse_mass[0], 0.0]);
            return StageMode { eigenvalue, inverse_mass, forward, turned: backward.clone(), backward };
        }
        forward.extend(imaginary);
        // 2 Re [ V_im exp(-i angle) (y_1 + i y_2) ]
        let turned_by = |angle: f64| -> Vec<f64> {
            let (sin, cos) = (-angle).sin_cos();
            let pairs = (0..k).map(|i| eigen.vectors[i * k + m]);
            pairs.flat_map(|(re, im)| [2.0 * (re * cos - im * sin), -2.0 * (re * sin + im * cos)]).collect()
        };
        StageMode {
            eigenvalue: [re, im],
            inverse_mass,
            forward,
            backward: turned_by(0.0),
            turned: turned_by(0.5 * im.atan2(re)),
        }
    }

    /// Number of real right-hand sides: 1, or 2 for a pair.
    pub(super) fn n_columns(&self) -> usize {
        if self.eigenvalue[1] > PAIRED { 2 } else { 1 }
    }

    /// Modulus of the eigenvalue.
    pub(super) fn modulus(&self) -> f64 {
        self.eigenvalue[0].hypot(self.eigenvalue[1])
    }

    /// Right-hand sides of the mode, `[dof][column]`, from the right-hand sides of the stages, `[k][dof]`.
    pub(super) fn restrict(&self, stages: &[f64], columns: &mut [f64]) {
        let k = self.forward.len() / self.n_columns();
        let n = columns.len() / self.n_columns();
        for (dof, columns) in columns.chunks_exact_mut(self.n_columns()).enumerate() {
            for (value, forward) in columns.iter_mut().zip(self.forward.chunks_exact(k)) {
                *value = forward.iter().enumerate().map(|(i, forward)| forward * stages[i * n + dof]).sum();
            }
        }
    }

    /// Adds solutions of the mode, `[dof][column]`, to the stages, `[k][dof]`; `backward`: one of the two changes of
    /// basis.
    pub(super) fn add_to(&self, backward: &[f64], columns: &[f64], stages: &mut [f64]) {
        let n = columns.len() / self.n_columns();
        for (stage, row) in stages.chunks_exact_mut(n).zip(backward.chunks_exact(self.n_columns())) {
            for (value, columns) in stage.iter_mut().zip(columns.chunks_exact(self.n_columns())) {
                *value += row.iter().zip(columns).map(|(b, y)| b * y).sum::<f64>();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::TimeElement;

    #[test]
    fn modes_solve_the_stage_equations_of_an_oscillator() {
        // (a^-1 + y a + c I) x = r for one degree of freedom with M = 1, s^2 K = y, s C = c.
        let (y, c) = (3.7, 0.9);
        for k in 1..=5 {
            let stage = TimeElement::discrete_gradient(k).unwrap().coefficients();
            let right: Vec<f64> = (0..k).map(|i| (i as f64 + 0.3).cos()).collect();
            let mut x = vec![0.0; k];
            let modes = modes(&stage.inverse_mass, &stage.response).unwrap();
            assert_eq!(modes.iter().map(StageMode::n_columns).sum::<usize>(), k);
            for mode in &modes {
                let mut columns = vec![0.0; mode.n_columns()];
                mode.restrict(&right, &mut columns);
                let part = |at: usize| y * mode.eigenvalue[at] + c * mode.inverse_mass[at];
                let (re, im) = (part(0), part(1));
                let (re, size) = (1.0 + re, (1.0 + re).powi(2) + im * im);
                let imaginary = if columns.len() == 2 { columns[1] } else { 0.0 };
                let u = columns[0];
                let v = imaginary;
                columns[0] = (u * re + v * im) / size;
                if columns.len() == 2 {
                    columns[1] = (v * re - u * im) / size;
                }
                mode.add_to(&mode.backward, &columns, &mut x);
            }
            for i in 0..k {
                let entry = |j: usize| stage.mass[i * k + j] + y * stage.response[i * k + j];
                let left = c * x[i] + (0..k).map(|j| entry(j) * x[j]).sum::<f64>();
                assert!((left - right[i]).abs() < 1e-11, "{k}: {left} {}", right[i]);
            }
        }
    }
}
