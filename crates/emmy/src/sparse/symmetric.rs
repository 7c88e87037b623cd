//! Factorisation `L L^T` of a complex symmetric matrix, one supernode after another.
//!
//! It has no pivots. For `M + lambda K` with a positive definite M, a symmetric K and a lambda of argument phi, each
//! pivot is at least `|sin phi|` times that of M. If K is positive semidefinite, it is at least `cos phi/2` times that
//! of `M + |lambda| K`.

use std::ops::{Mul, MulAssign, Sub, SubAssign};

use faer::linalg::matmul::matmul_with_conj;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::traits::ComplexField;
use faer::traits::math_utils::{one, recip, sqrt};
use faer::{Accum, Conj, MatMut, MatRef, Par};

/// Numbers with a square root.
pub(crate) trait Field:
    ComplexField + Copy + Default + Mul<Output = Self> + Sub<Output = Self> + MulAssign + SubAssign
{
}

impl<T: ComplexField + Copy + Default + Mul<Output = T> + Sub<Output = T> + MulAssign + SubAssign> Field
    for T
{
}

/// Memory of a factorisation.
#[derive(Debug, Default)]
pub(crate) struct Workspace<T> {
    /// Row in the present supernode of each row of the matrix.
    place: Vec<usize>,
    /// First of the supernodes that change a supernode next, and the one after each supernode in such a list.
    first: Vec<usize>,
    next: Vec<usize>,
    /// Number of rows below each supernode whose supernodes it has changed.
    done: Vec<usize>,
    /// Change of a supernode by another one.
    change: Vec<T>,
}

/// No further supernode.
const NONE: usize = usize::MAX;

impl<T: Field> Workspace<T> {
    /// Computes L; `matrix`: lower triangle, its rows in any order.
    pub(super) fn factorize(
        &mut self,
        supernodes: &SymbolicSupernodalCholesky<usize>,
        matrix: SparseColMatRef<'_, usize, T>,
        values: &mut [T],
    ) {
        let n = supernodes.n_supernodes();
        self.place.resize(supernodes.nrows(), 0);
        self.next.resize(n, NONE);
        self.done.resize(n, 0);
        self.first.clear();
        self.first.resize(n, NONE);
        values.fill(T::default());
        let (begin, end) = (supernodes.supernode_begin(), supernodes.supernode_end());
        let start_of_values = supernodes.col_ptr_for_val();
        for s in 0..n {
            let (own, below) = (begin[s]..end[s], supernodes.supernode(s).pattern());
            let n_rows = own.len() + below.len();
            own.clone().chain(below.iter().copied()).enumerate().for_each(|(at, row)| self.place[row] = at);
            let (known, rest) = values.split_at_mut(start_of_values[s]);
            let columns = &mut rest[..n_rows * own.len()];
            for (column, j) in columns.chunks_exact_mut(n_rows).zip(own.clone()) {
                let entries = matrix.row_idx_of_col_raw(j).iter().zip(matrix.val_of_col(j));
                entries.for_each(|(&row, &value)| column[self.place[row]] = value);
            }
            let mut d = self.first[s];
            while d != NONE {
                let after = self.next[d];
                let width = end[d] - begin[d];
                let pattern = supernodes.supernode(d).pattern();
                let left = &pattern[self.done[d]..];
                let n_changed = left.partition_point(|&row| row < end[s]);
                let factor = &known[start_of_values[d]..start_of_values[d + 1]];
                let factor = MatRef::from_column_major_slice(factor, width + pattern.len(), width);
                let factor = factor.subrows(width + self.done[d], left.len());
                self.change.resize(self.change.len().max(left.len() * n_changed), T::default());
                let change = &mut self.change[..left.len() * n_changed];
                matmul_with_conj(
                    MatMut::from_column_major_slice_mut(change, left.len(), n_changed),
                    Accum::Replace,
                    factor,
                    Conj::No,
                    factor.subrows(0, n_changed).transpose(),
                    Conj::No,
                    one::<T>(),
                    Par::Seq,
                );
                for (j, change) in change.chunks_exact(left.len()).enumerate() {
                    let column = &mut columns[(left[j] - begin[s]) * n_rows..][..n_rows];
                    for (&row, &change) in left[j..].iter().zip(&change[j..]) {
                        let entry = &mut column[self.place[row]];
                        *entry -= change;
                    }
                }
                self.done[d] += n_changed;
                self.append(d, pattern, end);
                d = after;
            }
            let columns = MatMut::from_column_major_slice_mut(columns, n_rows, own.len());
            let (mut top, bottom) = columns.split_at_row_mut(own.len());
            factorize_dense(top.rb_mut());
            solve_lower_triangular_in_place(top.rb(), bottom.transpose_mut(), Par::Seq);
            self.done[s] = 0;
            self.append(s, below, end);
        }
    }

    /// Puts a supernode into the list of the one that it changes next.
    fn append(&mut self, d: usize, pattern: &[usize], end: &[usize]) {
        if let Some(row) = pattern.get(self.done[d]) {
            let s = end.partition_point(|end| end <= row);
            self.next[d] = self.first[s];
            self.first[s] = d;
        }
    }
}

/// Size of a matrix factorised entry by entry.
const SMALL: usize = 16;

/// `A = L L^T` in place, above the diagonal anything.
fn factorize_dense<T: Field>(mut A: MatMut<'_, T>) {
    let n = A.nrows();
    if n > SMALL {
        let half = (n / 2).next_multiple_of(8);
        let (mut first, _, mut below, mut rest) = A.split_at_mut(half, half);
        factorize_dense(first.rb_mut());
        solve_lower_triangular_in_place(first.rb(), below.rb_mut().transpose_mut(), Par::Seq);
        triangular::matmul_with_conj(
            rest.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            below.rb(),
            BlockStructure::Rectangular,
            Conj::No,
            below.rb().transpose(),
            BlockStructure::Rectangular,
            Conj::No,
            T::default() - one::<T>(),
            Par::Seq,
        );
        return factorize_dense(rest);
    }
    for j in 0..n {
        let root = sqrt(&A[(j, j)]);
        let inverse = recip(&root);
        A[(j, j)] = root;
        for i in j + 1..n {
            A[(i, j)] *= inverse;
        }
        for k in j + 1..n {
            for i in k..n {
                A[(i, k)] = A[(i, k)] - A[(i, j)] * A[(k, j)];
            }
        }
    }
}
