//! Sparse Cholesky factorisation of a symmetric matrix, symbolic work done once.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::{Perm, PermRef};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

use crate::error::{Error, Result};

/// Factorisation `L L^T` of a symmetric positive definite matrix, or `L B L^T` if the matrix is indefinite.
///
/// The matrix is given by its lower triangle in compressed columns; the pattern is analysed once, in [`Cholesky::new`].
pub struct Cholesky {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    indefinite: Option<Pivots>,
    memory: MemBuffer,
    /// Largest number of right-hand sides solved at once.
    max_columns: usize,
}

/// Data of an indefinite factorisation besides the values.
struct Pivots {
    subdiagonal: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky").field("n", &self.pattern.nrows()).field("nnz", &self.values.len()).finish()
    }
}

/// Largest number of right-hand sides solved at once, unless more are reserved.
const MAX_COLUMNS: usize = 3;

impl Cholesky {
    /// Symbolic factorisation.
    ///
    /// `column_begin`, `rows`: lower triangle in compressed columns, rows ascending; `order[new] = old`.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Linear`].
    pub fn new(column_begin: Vec<usize>, rows: Vec<usize>, order: Vec<usize>) -> Result<Self> {
        let n = order.len();
        let pattern = SymbolicSparseColMat::new_checked(n, n, column_begin, None, rows);
        let mut inverse = vec![0; n];
        order.iter().enumerate().for_each(|(new, &old)| inverse[old] = new);
        let order = Perm::new_checked(order.into_boxed_slice(), inverse.into_boxed_slice(), n);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Custom(order.as_ref()),
            CholeskySymbolicParams::default(),
        )
        .map_err(|error| Error::Linear { reason: format!("symbolic factorisation: {error:?}") })?;
        let request = (symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()))
            .or(symbolic.solve_in_place_scratch::<f64>(MAX_COLUMNS, Par::Seq));
        let memory = MemBuffer::try_new(request).map_err(|_| out_of_memory(request.size_bytes()))?;
        let values = zeros(symbolic.len_val())?;
        Ok(Cholesky { pattern, symbolic, values, indefinite: None, memory, max_columns: MAX_COLUMNS })
    }

    /// Reserves memory for the solution of `n_columns` right-hand sides at once.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn reserve(&mut self, n_columns: usize) -> Result<()> {
        let request = (self.symbolic.solve_in_place_scratch::<f64>(n_columns, Par::Seq))
            .or(self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()));
        self.memory = MemBuffer::try_new(request).map_err(|_| out_of_memory(request.size_bytes()))?;
        self.max_columns = n_columns;
        Ok(())
    }

    /// Number of stored entries of the factor.
    pub fn n_entries(&self) -> usize {
        self.values.len()
    }

    /// Whether the last matrix was positive definite.
    pub fn is_definite(&self) -> bool {
        self.indefinite.is_none()
    }

    /// Numerical factorisation. `values`: entries of the lower triangle, in the order of the pattern.
    ///
    /// # Errors
    /// [`Error::Linear`] if an entry is not finite, [`Error::OutOfMemory`].
    pub fn factorize(&mut self, values: &[f64]) -> Result<()> {
        if !values.iter().all(|value| value.is_finite()) {
            return Err(Error::Linear { reason: "the matrix has an entry that is not finite".into() });
        }
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
        let stack = MemStack::new(&mut self.memory);
        let regularization = Default::default();
        let factor = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            regularization,
            Par::Seq,
            stack,
            Default::default(),
        );
        if factor.is_ok() {
            self.indefinite = None;
            return Ok(());
        }
        self.factorize_indefinite(values)
    }

    /// `L B L^T` with pivots inside supernodes: rare (a strongly compressed body at a large step), so it may allocate.
    fn factorize_indefinite(&mut self, values: &[f64]) -> Result<()> {
        let n = self.pattern.nrows();
        let mut pivots = Pivots { subdiagonal: vec![0.0; n], forward: vec![0; n], inverse: vec![0; n] };
        let request =
            self.symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).map_err(|_| out_of_memory(request.size_bytes()))?;
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut self.values,
            &mut pivots.subdiagonal,
            &mut pivots.forward,
            &mut pivots.inverse,
            SparseColMatRef::new(self.pattern.as_ref(), values),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        self.indefinite = Some(pivots);
        Ok(())
    }

    /// Solves in place. `rhs`: right-hand sides one after another, `[n_columns][n]`.
    pub fn solve(&mut self, rhs: &mut [f64], n_columns: usize) {
        assert!(n_columns <= self.max_columns);
        let n = self.pattern.nrows();
        let rhs = MatMut::from_column_major_slice_mut(rhs, n, n_columns);
        let stack = MemStack::new(&mut self.memory);
        match &self.indefinite {
            None => {
                let factor = LltRef::new(&self.symbolic, &self.values);
                factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack);
            }
            Some(pivots) => {
                let order = PermRef::new_checked(&pivots.forward, &pivots.inverse, n);
                let factor = IntranodeLbltRef::new(&self.symbolic, &self.values, &pivots.subdiagonal, order);
                factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack);
            }
        }
    }
}

fn out_of_memory(bytes: usize) -> Error {
    Error::OutOfMemory { what: "the factorisation", gigabytes: bytes as f64 / 1e9 }
}

/// Zeros, or an error if the machine does not have the memory: the factor is by far the largest object of a run.
fn zeros(length: usize) -> Result<Vec<f64>> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(length).map_err(|_| out_of_memory(length.saturating_mul(8)))?;
    zeros.resize(length, 0.0);
    Ok(zeros)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lower triangle of the tridiagonal matrix (-1, d, -1).
    fn tridiagonal(n: usize, d: f64) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let mut begin = vec![0];
        let mut rows = vec![];
        let mut values = vec![];
        for i in 0..n {
            rows.push(i);
            values.push(d);
            if i + 1 < n {
                rows.push(i + 1);
                values.push(-1.0);
            }
            begin.push(rows.len());
        }
        (begin, rows, values)
    }

    #[test]
    fn definite_and_indefinite_systems_are_solved() {
        let n = 50;
        for (d, definite) in [(2.5, true), (0.3, false)] {
            let (begin, rows, values) = tridiagonal(n, d);
            let mut factor = Cholesky::new(begin, rows, (0..n).rev().collect()).unwrap();
            factor.factorize(&values).unwrap();
            assert_eq!(factor.is_definite(), definite);
            let x: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
            let mut rhs = vec![0.0; 2 * n];
            for c in 0..2 {
                let at = |i: usize| x[c * n + i];
                for i in 0..n {
                    let left = if i > 0 { at(i - 1) } else { 0.0 };
                    let right = if i + 1 < n { at(i + 1) } else { 0.0 };
                    rhs[c * n + i] = d * at(i) - left - right;
                }
            }
            factor.solve(&mut rhs, 2);
            assert!(rhs.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-11));
        }
    }

    #[test]
    fn entries_must_be_finite() {
        let (begin, rows, mut values) = tridiagonal(3, 2.0);
        values[2] = f64::NAN;
        let mut factor = Cholesky::new(begin, rows, vec![0, 1, 2]).unwrap();
        assert!(matches!(factor.factorize(&values), Err(Error::Linear { .. })));
    }
}
