//! Newton's iteration, static equilibria and stiffness.

use super::{Motion, add};
use crate::reference::numbers::{Factors, Matrix, dot};

/// Root of a residual: Newton's iteration with a matrix of differences, renewed when it is slow.
///
/// # Errors
/// If it does not converge.
pub(super) fn solve(
    mut x: Vec<f64>,
    scale: f64,
    residual: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<Vec<f64>, String> {
    if x.is_empty() {
        return Ok(x);
    }
    let norm = |r: &[f64]| dot(r, r).sqrt();
    let mut current = residual(&x);
    for _ in 0..20 {
        let step = 1e-6 * scale;
        let mut jacobian = vec![vec![0.0; x.len()]; x.len()];
        for j in 0..x.len() {
            let mut moved = x.clone();
            moved[j] += step;
            let after = residual(&moved);
            (0..x.len()).for_each(|i| jacobian[i][j] = (after[i] - current[i]) / step);
        }
        let factors = Factors::new(jacobian);
        for round in 0..40 {
            let correction = factors.solve(&current);
            let size = correction.iter().fold(0.0f64, |m, c| m.max(c.abs()));
            if !size.is_finite() {
                return Err("not finite".into());
            }
            // With a new matrix a correction that is too long is halved.
            let (mut factor, mut next, mut next_residual);
            let mut halvings = 0;
            loop {
                factor = 0.5f64.powi(halvings);
                next = x.iter().zip(&correction).map(|(x, c)| x - factor * c).collect::<Vec<f64>>();
                next_residual = residual(&next);
                let is_short = norm(&next_residual) < norm(&current) || size < 1e-9 * scale;
                if is_short || round > 0 || halvings == 12 {
                    break;
                }
                halvings += 1;
            }
            let is_better = norm(&next_residual) < 0.5 * norm(&current);
            if is_better || round == 0 && size > 1e-13 * scale {
                x = next;
                current = next_residual;
            }
            if size < 1e-11 * scale && !is_better || norm(&current) == 0.0 {
                return Ok(x);
            }
            if !is_better {
                break;
            }
        }
    }
    Err("does not converge".into())
}

/// An increment of the load fraction that fails is halved down to this.
const SMALLEST_INCREMENT: f64 = 1.0 / 64.0;

impl Motion<'_> {
    /// Static equilibria under parts of the loads before time 0, with the same parts of the motion of driven supports.
    ///
    /// # Errors
    /// If one is not found.
    pub fn equilibria(&self, fractions: &[f64]) -> Result<Vec<Vec<f64>>, String> {
        let mut u = vec![0.0; self.n()];
        let mut path = Vec::new();
        let mut at = 0.0;
        for &fraction in fractions {
            let mut step = fraction - at;
            while at < fraction {
                let next = if fraction - at <= step { fraction } else { at + step };
                match self.equilibrium(&u, next) {
                    Ok(found) => (u, at) = (found, next),
                    Err(_) if step > SMALLEST_INCREMENT => step /= 2.0,
                    Err(error) => return Err(error),
                }
            }
            path.push(u.clone());
        }
        Ok(path)
    }

    /// The equilibrium at a load fraction, from that at a smaller one.
    fn equilibrium(&self, start: &[f64], fraction: f64) -> Result<Vec<f64>, String> {
        let (driven, free) = (self.driven(0.0), self.free(0.0));
        let mut u = start.to_vec();
        for (dof, drive) in driven.iter().enumerate() {
            if let Some((drive, _)) = drive {
                u[dof] = fraction * drive.displacement(0.0);
            }
        }
        let with = |x: &[f64]| {
            let mut all = u.clone();
            free.iter().zip(x).for_each(|(&dof, x)| all[dof] = *x);
            all
        };
        let residual = |x: &[f64]| {
            let all = with(x);
            let (forces, loads) = (self.body.forces(&all), self.body.loads(&all, 0.0, true));
            free.iter().map(|&dof| forces[dof] - fraction * loads[dof]).collect()
        };
        let x = solve(free.iter().map(|&dof| u[dof]).collect(), 1.0, residual)?;
        Ok(with(&x))
    }

    /// Derivative of the forces at a displacement, by differences of the fourth order and of width h, less the
    /// symmetric part of the derivative of the pressure at time 0.
    pub fn stiffness(&self, u: &[f64], h: f64, has_pressure: bool) -> Matrix {
        let force = |u: &[f64], transposed: bool| {
            let mut force = if transposed { vec![0.0; u.len()] } else { self.body.forces(u) };
            if has_pressure {
                add(&mut force, -0.5, &self.body.pressure_load(u, 0.0));
            }
            force
        };
        let mut whole = self.derivative(u, h, |u| force(u, false));
        if has_pressure {
            let other = self.derivative(u, h, |u| force(u, true));
            (0..u.len()).for_each(|i| (0..u.len()).for_each(|j| whole[i][j] += other[j][i]));
        }
        whole
    }

    fn derivative(&self, u: &[f64], h: f64, force: impl Fn(&[f64]) -> Vec<f64>) -> Matrix {
        let column = |dof: usize| {
            let at = |factor: f64| {
                let mut moved = u.to_vec();
                moved[dof] += factor * h;
                force(&moved)
            };
            let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
            (0..u.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect::<Vec<f64>>()
        };
        let columns: Matrix = (0..u.len()).map(column).collect();
        (0..u.len()).map(|i| (0..u.len()).map(|j| columns[j][i]).collect()).collect()
    }
}
