//! Gauss points, Lagrange polynomials and dense matrices.

use std::sync::OnceLock;

/// Points and weights of Gauss' rule on the unit interval, with up to 40 points.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    static RULES: [OnceLock<Vec<(f64, f64)>>; 41] = [const { OnceLock::new() }; 41];
    RULES[n].get_or_init(|| gauss_rule(n)).clone()
}

fn gauss_rule(n: usize) -> Vec<(f64, f64)> {
    let zero = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..60 {
            let (p, dp) = legendre(n, x);
            x -= p / dp;
        }
        let (_, dp) = legendre(n, x);
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * dp * dp))
    };
    (0..n).rev().map(zero).collect()
}

/// Points and weights of Lobatto's rule on the unit interval, with 2 to 5 points, from its closed form.
///
/// # Panics
/// If `n` is outside.
pub fn lobatto(n: usize) -> Vec<(f64, f64)> {
    let rule: Vec<(f64, f64)> = match n {
        2 => vec![(-1.0, 1.0), (1.0, 1.0)],
        3 => vec![(-1.0, 1.0 / 3.0), (0.0, 4.0 / 3.0), (1.0, 1.0 / 3.0)],
        4 => {
            let x = 0.2f64.sqrt();
            vec![(-1.0, 1.0 / 6.0), (-x, 5.0 / 6.0), (x, 5.0 / 6.0), (1.0, 1.0 / 6.0)]
        }
        5 => {
            let x = (3.0f64 / 7.0).sqrt();
            vec![(-1.0, 0.1), (-x, 49.0 / 90.0), (0.0, 32.0 / 45.0), (x, 49.0 / 90.0), (1.0, 0.1)]
        }
        _ => panic!("no rule of Lobatto with {n} points"),
    };
    rule.into_iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect()
}

/// Legendre polynomial of degree n on [-1, 1], with its derivative.
pub fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (0.0, 1.0);
    for m in 0..n {
        let next = ((2 * m + 1) as f64 * x * p - m as f64 * before) / (m + 1) as f64;
        (before, p) = (p, next);
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

/// Lagrange polynomial number i on some points.
pub fn lagrange(points: &[f64], i: usize, x: f64) -> f64 {
    let others = points.iter().enumerate().filter(|(j, _)| *j != i);
    others.map(|(_, c)| (x - c) / (points[i] - c)).product()
}

/// Integral of the Lagrange polynomial from 0 to x.
pub fn lagrange_integral(points: &[f64], i: usize, x: f64) -> f64 {
    gauss(points.len()).iter().map(|(s, w)| w * x * lagrange(points, i, s * x)).sum()
}

/// A dense matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;

/// Factors of a matrix with pivots.
#[derive(Debug, Clone)]
pub struct Factors {
    rows: Matrix,
    pivots: Vec<usize>,
}

impl Factors {
    /// Factorises a matrix.
    pub fn new(mut rows: Matrix) -> Self {
        let n = rows.len();
        let mut pivots = Vec::with_capacity(n);
        for i in 0..n {
            let pivot = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs())).unwrap_or(i);
            rows.swap(i, pivot);
            pivots.push(pivot);
            let (upper, lower) = rows.split_at_mut(i + 1);
            let row = &upper[i];
            for other in lower {
                let factor = other[i] / row[i];
                other[i] = factor;
                if factor != 0.0 {
                    (i + 1..n).for_each(|j| other[j] -= factor * row[j]);
                }
            }
        }
        Factors { rows, pivots }
    }

    /// The solution of a system.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let n = right.len();
        let mut x = right.to_vec();
        for (i, &pivot) in self.pivots.iter().enumerate() {
            x.swap(i, pivot);
        }
        for i in 0..n {
            x[i] -= (0..i).map(|j| self.rows[i][j] * x[j]).sum::<f64>();
        }
        for i in (0..n).rev() {
            x[i] = (x[i] - (i + 1..n).map(|j| self.rows[i][j] * x[j]).sum::<f64>()) / self.rows[i][i];
        }
        x
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix by Jacobi's rotations, the smallest first.
pub fn eigen(mut a: Matrix) -> Vec<(f64, Vec<f64>)> {
    let n = a.len();
    let mut v: Matrix = (0..n).map(|i| (0..n).map(|j| f64::from(i == j)).collect()).collect();
    for _ in 0..40 {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = if theta >= 0.0 { 1.0 } else { -1.0 } / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for j in 0..n {
                    (a[p][j], a[q][j]) = (c * a[p][j] - s * a[q][j], s * a[p][j] + c * a[q][j]);
                }
                for row in &mut v {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    let mut pairs: Vec<_> = (0..n).map(|i| (a[i][i], v.iter().map(|row| row[i]).collect())).collect();
    pairs.sort_by(|x: &(f64, Vec<f64>), y| x.0.total_cmp(&y.0));
    pairs
}

/// Scalar product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Cross product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Product of two 3 x 3 matrices.
pub fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| (0..3).map(|m| a[i][m] * b[m][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Transpose of a 3 x 3 matrix.
pub fn transpose(a: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Determinant of a 3 x 3 matrix.
pub fn determinant(a: &[[f64; 3]; 3]) -> f64 {
    dot(&a[0], &cross(a[1], a[2]))
}

/// Cofactors of a 3 x 3 matrix: the determinant times the transposed inverse.
pub fn cofactor(a: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])]
}

/// Scalar product of two 3 x 3 matrices.
pub fn contract(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    (0..3).map(|i| dot(&a[i], &b[i])).sum()
}

/// `a + factor b` for 3 x 3 matrices.
pub fn plus(a: &[[f64; 3]; 3], factor: f64, b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
}
