//! The range of the constraints, where some follow from the others.

use super::constraint::Constraint;
use super::constraints::Constraints;

/// The range of the gradients G of some constraints, by orthogonalisation of the columns of G with pivoting.
///
/// It also has an orthonormal basis Z of the complement, of few vectors: the projection on the range is
/// `P = 1 - Z Z^T`.
#[derive(Debug, Default)]
pub(crate) struct Range {
    n_rows: usize,
    /// Vectors of an orthonormal basis of the range, then of its complement, `[n_rows][n_rows]`.
    basis: Vec<f64>,
    rank: usize,
    /// Columns of G, `[n_dofs][n_rows]`, as far as they are not in the range yet.
    columns: Vec<f64>,
    squares: Vec<f64>,
    /// Squares of the columns before their parts in the range were taken.
    whole: Vec<f64>,
}

/// Length of a column beside the others, over that of the longest, that is rounding.
const LEAST_LENGTH: f64 = 1e-8;

impl Range {
    /// Memory for some constraints.
    pub(crate) fn new(constraints: &Constraints) -> Self {
        let (n_rows, n_dofs) = (constraints.len(), constraints.dofs().count());
        Range {
            n_rows,
            basis: Vec::with_capacity(n_rows * n_rows),
            rank: 0,
            columns: vec![0.0; n_dofs * n_rows],
            squares: vec![0.0; n_dofs.max(n_rows)],
            whole: vec![0.0; n_dofs],
        }
    }

    /// Sets the range to that of some constraints at displacements, `rows` in their order. Returns the rank.
    pub(crate) fn set<'r>(
        &mut self,
        constraints: &Constraints,
        rows: impl Iterator<Item = &'r Constraint>,
        is_held: &[bool],
        displacement: &dyn Fn(usize) -> f64,
    ) -> usize {
        let n = self.n_rows;
        if n == 0 {
            return 0;
        }
        self.basis.clear();
        self.columns.fill(0.0);
        for (c, row) in rows.enumerate() {
            row.for_each_gradient(displacement, &mut |dof, value| {
                if !is_held[dof] {
                    self.columns[constraints.local_dof(dof) * n + c] += value;
                }
            });
        }
        let n_dofs = self.columns.len() / n;
        let mut longest = 0.0f64;
        let columns = self.columns.chunks_exact(n);
        self.squares.iter_mut().zip(columns).for_each(|(own, column)| *own = dot(column, column));
        self.whole.copy_from_slice(&self.squares[..n_dofs]);
        for _ in 0..n.min(n_dofs) {
            let next = largest(&self.squares[..n_dofs]);
            let length = self.squares[next].sqrt();
            longest = longest.max(length);
            if length <= LEAST_LENGTH * longest {
                break;
            }
            let begin = self.basis.len();
            self.basis.extend(self.columns[next * n..(next + 1) * n].iter().map(|x| x / length));
            // Once more if the column has lost digits; twice is enough.
            if self.squares[next] < 0.5 * self.whole[next] {
                self.orthogonalise(begin);
            }
            let new = &self.basis[begin..];
            let columns = self.squares.iter_mut().zip(self.columns.chunks_exact_mut(n));
            for (square, column) in columns.filter(|(square, _)| **square > 0.0) {
                if take(new, column) {
                    *square = dot(column, column);
                }
            }
            self.squares[next] = 0.0;
        }
        self.rank = self.basis.len() / n;
        self.complete();
        self.rank
    }

    /// Adds a basis of the complement. Each vector is a unit vector without its parts along the vectors before; the
    /// unit vector that keeps most of its length comes next.
    fn complete(&mut self) {
        let n = self.n_rows;
        let left = &mut self.squares[..n];
        left.fill(1.0);
        for basis in self.basis.chunks_exact(n) {
            left.iter_mut().zip(basis).for_each(|(left, b)| *left -= b * b);
        }
        for _ in self.rank..n {
            let next = largest(&self.squares[..n]);
            let begin = self.basis.len();
            self.basis.extend((0..n).map(|row| if row == next { 1.0 } else { 0.0 }));
            self.orthogonalise(begin);
            self.orthogonalise(begin);
            let new = &self.basis[begin..];
            self.squares.iter_mut().zip(new).for_each(|(left, b)| *left -= b * b);
        }
    }

    /// Makes the last vector, which begins at a place in the basis, one of length one that the others leave.
    fn orthogonalise(&mut self, begin: usize) {
        let (before, new) = self.basis.split_at_mut(begin);
        before.chunks_exact(self.n_rows).for_each(|basis| {
            take(basis, new);
        });
        let length = dot(new, new).sqrt();
        new.iter_mut().for_each(|x| *x /= length);
    }

    /// Vectors of an orthonormal basis of the complement, each `[n_rows]`.
    pub(crate) fn complement(&self) -> impl Iterator<Item = &[f64]> {
        self.basis[self.rank * self.n_rows..].chunks_exact(self.n_rows.max(1))
    }

    /// Number of the constraints that follow from the others.
    pub(crate) fn n_redundant(&self) -> usize {
        self.n_rows - self.rank
    }

    /// Projects numbers of the constraints, `[n_rows]`, on the range.
    pub(crate) fn project(&self, values: &mut [f64]) {
        self.complement().for_each(|z| {
            take(z, values);
        });
    }
}

fn largest(values: &[f64]) -> usize {
    (0..values.len()).fold(0, |best, at| if values[at] > values[best] { at } else { best })
}

/// Dot product, in lanes that vectorise.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let ((x, last_x), (y, last_y)) = (x.as_chunks::<8>(), y.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (x, y) in x.iter().zip(y) {
        (0..8).for_each(|lane| sums[lane] += x[lane] * y[lane]);
    }
    let rest: f64 = last_x.iter().zip(last_y).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Takes the part along a unit vector from another vector. Returns whether there is one.
fn take(unit: &[f64], vector: &mut [f64]) -> bool {
    let part = dot(unit, vector);
    if part != 0.0 {
        vector.iter_mut().zip(unit).for_each(|(x, u)| *x -= part * u);
    }
    part != 0.0
}
