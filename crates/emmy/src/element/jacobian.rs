//! Derivatives of the position by the reference coordinates of a cell, at one point or at many side by side.

use pulp::{Arch, NullaryFnOnce};

use super::{CellKind, element};
use crate::tensor::{LANES, Mat3, cross, det, inlined, mat3};

/// Derivative of the position by the reference coordinates of a cell, `X: [n_nodes][3]`, `dN: [n_nodes][3]`.
///
/// ```math
/// J_ij = dX_i/dxi_j = sum_A X_Ai dN_A/dxi_j
/// ```
///
/// The third column of a plane cell is the unit vector along z: det J is then area per area, negative for clockwise
/// nodes, and gradients dN/dX have no third component. The other columns of a link are unit vectors across it: det J is
/// length per length, and gradients dN/dX lie along the link.
pub fn jacobian(kind: CellKind, X: &[[f64; 3]], dN: &[[f64; 3]]) -> Mat3<f64> {
    let mut J = [[0.0; 3]; 3];
    for (X, dN) in X.iter().zip(dN) {
        for i in 0..3 {
            for j in 0..3 {
                J[i][j] += X[i] * dN[j];
            }
        }
    }
    completed(kind, J)
}

/// A Jacobian with the columns for the coordinates that a cell does not have.
fn completed(kind: CellKind, mut J: Mat3<f64>) -> Mat3<f64> {
    match kind.dimension() {
        2 => J[2][2] = 1.0,
        1 => {
            let across = across([J[0][0], J[1][0], J[2][0]]);
            (0..3).for_each(|i| (0..2).for_each(|j| J[i][j + 1] = across[j][i]));
        }
        _ => {}
    }
    J
}

/// Two unit vectors that form a right-handed system of axes with a vector; NaN for the zero vector.
fn across(a: [f64; 3]) -> [[f64; 3]; 2] {
    let unit = |a: [f64; 3]| {
        let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
        a.map(|x| x / length)
    };
    let axis = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())).unwrap_or(0);
    let b = unit(cross(a, [0, 1, 2].map(|i| f64::from(u8::from(i == axis)))));
    [b, unit(cross(a, b))]
}

/// The Jacobians of a kind of cell at some points, each with the same bits as [`jacobian`].
#[derive(Debug, Clone)]
pub struct Jacobians {
    kind: CellKind,
    n_points: usize,
    /// Gradients of the shape functions, `[batch of points][node]`; those of points that do not exist are zero.
    gradients: Vec<[[f64; LANES]; 3]>,
}

impl Jacobians {
    /// For the cells of a kind and some points of the reference cell.
    pub fn new(kind: CellKind, points: &[[f64; 3]]) -> Self {
        let n = kind.n_nodes();
        let mut gradients = vec![[[0.0; LANES]; 3]; n * points.len().div_ceil(LANES)];
        let mut dN = vec![[0.0; 3]; n];
        for (point, &xi) in points.iter().enumerate() {
            element(kind).gradient(xi, &mut dN);
            for (batch, dN) in gradients[point / LANES * n..].iter_mut().zip(&dN) {
                (0..3).for_each(|j| batch[j][point % LANES] = dN[j]);
            }
        }
        Jacobians { kind, n_points: points.len(), gradients }
    }

    /// The Jacobians of a cell, `X: [n_nodes]`.
    pub fn of<'a>(&'a self, X: &'a [[f64; 3]]) -> impl Iterator<Item = Mat3<f64>> + 'a {
        let batches = self.gradients.chunks_exact(self.kind.n_nodes()).map(|batch| self.of_batch(X, batch));
        let of_batch = |J: Mat3<[f64; LANES]>| (0..LANES).map(move |lane| at_lane(&J, lane));
        batches.flat_map(of_batch).take(self.n_points)
    }

    /// The determinants of the Jacobians of a cell, `X: [n_nodes]`.
    pub fn dets(&self, X: &[[f64; 3]], dets: &mut Vec<f64>) {
        dets.clear();
        Arch::new().dispatch(Dets { jacobians: self, X, dets });
        dets.truncate(self.n_points);
    }

    /// Written with plain indices: the compiler computes the points side by side. A row of J after another, because
    /// its sums fit into the registers.
    #[inline(always)]
    fn of_batch(&self, X: &[[f64; 3]], batch: &[[[f64; LANES]; 3]]) -> Mat3<[f64; LANES]> {
        let mut J = [[[0.0; LANES]; 3]; 3];
        for i in 0..3 {
            let mut row = [[0.0; LANES]; 3];
            for (X, dN) in X.iter().zip(batch) {
                let x = X[i];
                for j in 0..3 {
                    for lane in 0..LANES {
                        row[j][lane] += x * dN[j][lane];
                    }
                }
            }
            J[i] = row;
        }
        if self.kind.dimension() < 3 {
            for lane in 0..LANES {
                let own = completed(self.kind, at_lane(&J, lane));
                (0..9).for_each(|at| J[at / 3][at % 3][lane] = own[at / 3][at % 3]);
            }
        }
        J
    }
}

/// Adds the determinants of all points, and of those that do not exist.
struct Dets<'a> {
    jacobians: &'a Jacobians,
    X: &'a [[f64; 3]],
    dets: &'a mut Vec<f64>,
}

impl NullaryFnOnce for Dets<'_> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        for batch in self.jacobians.gradients.chunks_exact(self.jacobians.kind.n_nodes()) {
            let J = self.jacobians.of_batch(self.X, batch);
            let mut dets = [0.0; LANES];
            for lane in 0..LANES {
                dets[lane] = det(&at_lane(&J, lane));
            }
            self.dets.extend_from_slice(&dets);
        }
    }
}

#[inline(always)]
fn at_lane(J: &Mat3<[f64; LANES]>, lane: usize) -> Mat3<f64> {
    mat3(inlined!(|i: usize, j: usize| J[i][j][lane]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_points_have_the_bits_of_each() {
        for kind in CellKind::ALL {
            let place =
                |x: &[f64; 3]| [x[0] + 0.1 * x[1] * x[1], x[1] - 0.3 * x[0], x[2] + 0.2 * x[0] * x[2]];
            let X: Vec<[f64; 3]> = element(kind).nodes().iter().map(place).collect();
            let points = element(kind).mass_quadrature().points;
            let one = |&xi: &[f64; 3]| {
                let mut dN = vec![[0.0; 3]; kind.n_nodes()];
                element(kind).gradient(xi, &mut dN);
                jacobian(kind, &X, &dN)
            };
            let expected: Vec<_> = points.iter().map(one).collect();
            let jacobians = Jacobians::new(kind, &points);
            assert_eq!(jacobians.of(&X).collect::<Vec<_>>(), expected);
            let mut dets = vec![f64::NAN];
            jacobians.dets(&X, &mut dets);
            assert_eq!(dets, expected.iter().map(det).collect::<Vec<_>>());
        }
    }
}
