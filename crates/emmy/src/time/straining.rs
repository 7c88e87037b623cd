//! From the rates of a step to those that strain the body.

use super::prediction::rigid::eliminate;
use super::prediction::rotation::cross;
use crate::average::Rule;
use crate::body::Body;

/// The matrix C from changes of the rates to those that strain, `[3 k][3 k]`, the same at every node.
///
/// An energy-momentum rule takes the strain rate `E'_m = sym(F(c_m)^T F'_m)`, which answers to a change of the rates, in a
/// body that turns with spins w_m, by `sym(F(c_m)^T (dF'_m - [w_m] sum_j a_mj dF'_j))`. The rates that strain it are
/// `y = C x`, node by node, with
///
/// ```math
/// C_mj = delta_mj 1 - a_mj [w_m]
/// ```
///
/// The spins are those of the iterate. An error d of a spin strains a turning body by `a d` for each unit of rotation, which resists
/// as much as its inertia where `E a d = 4 rho L^2/h^2`: in a quasi-rigid body (E = 1e7, rho = 0.5, L = 10, h = 0.2) from 1e-3 on.
#[derive(Debug)]
pub struct Straining {
    degree: usize,
    matrix: Vec<f64>,
    inverse: Vec<f64>,
    old: Vec<f64>,
}

impl Straining {
    /// Memory for a degree and a number of degrees of freedom.
    pub fn new(degree: usize, n_dofs: usize) -> Self {
        let n = 3 * degree;
        Straining {
            degree,
            matrix: vec![0.0; n * n],
            inverse: vec![0.0; n * n],
            old: vec![0.0; degree * n_dofs],
        }
    }

    /// Takes the spins of the rates x from a displacement; all without effect if they are singular.
    pub fn follow(&mut self, body: &Body, rule: &Rule, displacement: &[f64], x: &[f64]) {
        let (k, n, a) = (self.degree, 3 * self.degree, rule.coefficients());
        set_unit(&mut self.matrix, n);
        set_unit(&mut self.inverse, n);
        for m in 0..k {
            let spin = cross(&spin(body, &a[m * k..(m + 1) * k], m, displacement, x));
            for (j, d, e) in (0..9 * k).map(|at| (at / 9, at / 3 % 3, at % 3)) {
                self.matrix[(3 * m + d) * n + 3 * j + e] -= a[m * k + j] * spin[d][e];
            }
        }
        if !eliminate(&mut self.matrix, &mut self.inverse, n) {
            set_unit(&mut self.inverse, n);
        }
    }

    /// `x = C^-1 x` at every node; x: `[k][n_nodes][3]`.
    pub fn undo(&mut self, x: &mut [f64]) {
        let (k, n) = (self.degree, x.len() / self.degree);
        self.old.copy_from_slice(x);
        for i in 0..k {
            for node in 0..n / 3 {
                for d in 0..3 {
                    let row = &self.inverse[(3 * i + d) * 3 * k..][..3 * k];
                    let old = |column: usize| self.old[column / 3 * n + 3 * node + column % 3];
                    x[i * n + 3 * node + d] = (0..3 * k).map(|column| row[column] * old(column)).sum();
                }
            }
        }
    }
}

/// Spin w of the rates at a Gauss point, by least squares: `x_m = w x q(c_m)` but for a translation, each node with its mass.
/// `coefficients`: `a_mj`, of which `q(c_m) = q_1 + sum_j a_mj x_j`.
fn spin(body: &Body, coefficients: &[f64], m: usize, displacement: &[f64], x: &[f64]) -> [f64; 3] {
    let n = body.n_dofs();
    let position = |node: usize, d: usize| {
        let at = 3 * node + d;
        let moved: f64 = coefficients.iter().enumerate().map(|(j, a)| a * x[j * n + at]).sum();
        body.mesh().points()[node][d] + displacement[at] + moved
    };
    let rate = |node: usize, d: usize| x[m * n + 3 * node + d];
    let mass = body.lumped_mass();
    let total: f64 = mass.iter().sum();
    let mean = |value: &dyn Fn(usize, usize) -> f64| {
        [0, 1, 2].map(|d| mass.iter().enumerate().map(|(node, m)| m * value(node, d)).sum::<f64>() / total)
    };
    let (center, drift) = (mean(&position), mean(&rate));
    let (mut inertia, mut moment) = ([0.0; 9], [0.0; 3]);
    for (node, m) in mass.iter().enumerate() {
        let q = [0, 1, 2].map(|d| position(node, d) - center[d]);
        let v = [0, 1, 2].map(|d| rate(node, d) - drift[d]);
        let square: f64 = q.iter().map(|q| q * q).sum();
        for (a, b) in (0..9).map(|at| (at / 3, at % 3)) {
            inertia[3 * a + b] += m * (if a == b { square } else { 0.0 } - q[a] * q[b]);
        }
        moment[0] += m * (q[1] * v[2] - q[2] * v[1]);
        moment[1] += m * (q[2] * v[0] - q[0] * v[2]);
        moment[2] += m * (q[0] * v[1] - q[1] * v[0]);
    }
    if eliminate(&mut inertia, &mut moment, 1) { moment } else { [0.0; 3] }
}

fn set_unit(matrix: &mut [f64], n: usize) {
    matrix.fill(0.0);
    matrix.iter_mut().step_by(n + 1).for_each(|diagonal| *diagonal = 1.0);
}
