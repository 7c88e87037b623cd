//! The range of the constraints, where some follow from the others.

use super::constraint::Constraint;
use super::constraints::Constraints;

/// An orthonormal basis of the range of the gradients G of some constraints, by orthogonalisation of the columns of G
/// with pivoting.
#[derive(Debug, Default)]
pub(crate) struct Range {
    n_rows: usize,
    /// Vectors of the basis, `[rank][n_rows]`.
    basis: Vec<f64>,
    /// Columns of G, `[n_dofs][n_rows]`, as far as they are not in the range yet.
    columns: Vec<f64>,
    squares: Vec<f64>,
    /// Memory for a product.
    product: Vec<f64>,
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
            columns: vec![0.0; n_dofs * n_rows],
            squares: vec![0.0; n_dofs],
            product: Vec::new(),
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
        let square = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>();
        let mut longest = 0.0f64;
        for _ in 0..n.min(self.squares.len()) {
            let columns = self.columns.chunks_exact(n);
            self.squares.iter_mut().zip(columns).for_each(|(own, column)| *own = square(column));
            let next = (0..self.squares.len())
                .fold(0, |best, at| if self.squares[at] > self.squares[best] { at } else { best });
            let length = self.squares[next].sqrt();
            longest = longest.max(length);
            if length <= LEAST_LENGTH * longest {
                break;
            }
            let begin = self.basis.len();
            self.basis.extend(self.columns[next * n..(next + 1) * n].iter().map(|x| x / length));
            let (before, new) = self.basis.split_at_mut(begin);
            // Once more: a column that is nearly in the range has lost digits.
            before.chunks_exact(n).for_each(|basis| take(basis, new));
            let length = square(new).sqrt();
            new.iter_mut().for_each(|x| *x /= length);
            self.columns.chunks_exact_mut(n).for_each(|column| take(new, column));
        }
        self.rank()
    }

    /// The rank of the constraints.
    pub(crate) fn rank(&self) -> usize {
        self.basis.len() / self.n_rows.max(1)
    }

    /// Whether some constraints follow from the others.
    pub(crate) fn is_redundant(&self) -> bool {
        self.rank() < self.n_rows
    }

    /// Projects numbers of the constraints, `[n_rows]`, on the range.
    pub(crate) fn project(&mut self, values: &mut [f64]) {
        if !self.is_redundant() {
            return;
        }
        self.product.clear();
        self.product.resize(values.len(), 0.0);
        for basis in self.basis.chunks_exact(self.n_rows) {
            let part: f64 = basis.iter().zip(&*values).map(|(b, x)| b * x).sum();
            self.product.iter_mut().zip(basis).for_each(|(sum, b)| *sum += part * b);
        }
        values.copy_from_slice(&self.product);
    }

    /// Projects each column of a table, `[n_rows][n_columns]`.
    pub(crate) fn project_columns(&mut self, table: &mut [f64], n_columns: usize) {
        self.product.clear();
        self.product.resize(table.len() + n_columns, 0.0);
        let (sums, part) = self.product.split_at_mut(table.len());
        for basis in self.basis.chunks_exact(self.n_rows) {
            part.fill(0.0);
            for (b, row) in basis.iter().zip(table.chunks_exact(n_columns)) {
                part.iter_mut().zip(row).for_each(|(sum, x)| *sum += b * x);
            }
            for (b, row) in basis.iter().zip(sums.chunks_exact_mut(n_columns)) {
                row.iter_mut().zip(&*part).for_each(|(sum, x)| *sum += b * x);
            }
        }
        table.copy_from_slice(sums);
    }

    /// The part of a constraint that is not in the range for another one, an entry of `1 - C C^T`.
    pub(crate) fn complement(&self, row: usize, column: usize) -> f64 {
        let basis = self.basis.chunks_exact(self.n_rows);
        let inside: f64 = basis.map(|basis| basis[row] * basis[column]).sum();
        if row == column { 1.0 - inside } else { -inside }
    }
}

/// Takes the part along a unit vector from another vector.
fn take(unit: &[f64], vector: &mut [f64]) {
    let part: f64 = unit.iter().zip(&*vector).map(|(u, x)| u * x).sum();
    vector.iter_mut().zip(unit).for_each(|(x, u)| *x -= part * u);
}
