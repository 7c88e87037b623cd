//! Sparse factors `L L^T` in single and double precision, real and complex.

use std::fmt;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::PermRef;
use faer::prelude::ReborrowMut;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::IntranodeLbltRef;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLltRef, SymbolicSupernodalCholesky, factorize_supernodal_numeric_llt,
    factorize_supernodal_numeric_llt_scratch,
};
use faer::{Conj, MatMut, Par, Side, c32, c64};

use super::lower::Lower;
use super::symmetric::{Field, Workspace};
use crate::error::{Error, Result};

/// Numbers of a factor.
pub(crate) trait Number: Field {
    /// Number of real columns in one column.
    const COLUMNS: usize;
    /// The nearest number, from real and imaginary part.
    fn of(parts: [f64; 2]) -> Self;
    /// Real and imaginary part.
    fn parts(self) -> [f64; 2];
    /// Memory on the stack for [`Number::factorize`].
    fn request(supernodes: &SymbolicSupernodalCholesky<usize>) -> StackReq;
    /// Computes L of a matrix. False if the numbers are real and the matrix is not positive definite.
    fn factorize(
        supernodes: &SymbolicSupernodalCholesky<usize>,
        matrix: SparseColMatRef<'_, usize, Self>,
        values: &mut [Self],
        memory: (&mut MemStack, &mut Workspace<Self>),
    ) -> bool;
}

macro_rules! real {
    ($T:ty) => {
        impl Number for $T {
            const COLUMNS: usize = 1;
            fn of([re, _]: [f64; 2]) -> Self {
                re as $T
            }
            fn parts(self) -> [f64; 2] {
                [f64::from(self), 0.0]
            }
            fn request(supernodes: &SymbolicSupernodalCholesky<usize>) -> StackReq {
                factorize_supernodal_numeric_llt_scratch::<usize, $T>(
                    supernodes,
                    Par::Seq,
                    Default::default(),
                )
            }
            fn factorize(
                supernodes: &SymbolicSupernodalCholesky<usize>,
                matrix: SparseColMatRef<'_, usize, Self>,
                values: &mut [Self],
                (stack, _): (&mut MemStack, &mut Workspace<Self>),
            ) -> bool {
                let (none, automatic) = Default::default();
                factorize_supernodal_numeric_llt(values, matrix, none, supernodes, Par::Seq, stack, automatic)
                    .is_ok()
            }
        }
    };
}

macro_rules! complex {
    ($T:ty, $R:ty) => {
        impl Number for $T {
            const COLUMNS: usize = 2;
            fn of([re, im]: [f64; 2]) -> Self {
                <$T>::new(re as $R, im as $R)
            }
            fn parts(self) -> [f64; 2] {
                [f64::from(self.re), f64::from(self.im)]
            }
            fn request(_: &SymbolicSupernodalCholesky<usize>) -> StackReq {
                StackReq::EMPTY
            }
            fn factorize(
                supernodes: &SymbolicSupernodalCholesky<usize>,
                matrix: SparseColMatRef<'_, usize, Self>,
                values: &mut [Self],
                (_, workspace): (&mut MemStack, &mut Workspace<Self>),
            ) -> bool {
                workspace.factorize(supernodes, matrix, values);
                true
            }
        }
    };
}

real!(f32);
real!(f64);
complex!(c32, f32);
complex!(c64, f64);

/// The factor of a matrix whose diagonal is scaled to nearly one by powers of two. They round nothing, and they keep
/// single precision in its range.
pub(super) struct Factor<T> {
    scale: Vec<f64>,
    /// Lower triangle of the scaled matrix.
    matrix: Vec<T>,
    values: Vec<T>,
    indefinite: Option<Pivots<T>>,
    columns: Vec<T>,
    memory: MemBuffer,
    workspace: Workspace<T>,
    /// Largest number of columns solved at once.
    max_columns: usize,
}

/// Data of an indefinite factorisation `L B L^T` besides the values.
struct Pivots<T> {
    subdiagonal: Vec<T>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl<T> fmt::Debug for Factor<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Factor").field("n", &self.scale.len()).field("nnz", &self.values.len()).finish()
    }
}

impl<T: Number> Factor<T> {
    /// Memory for a factor and for a number of columns solved at once.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(super) fn new(lower: &Lower, max_columns: usize) -> Result<Self> {
        let n = lower.free.len();
        Ok(Factor {
            scale: vec![1.0; n],
            matrix: zeros(lower.sources.len())?,
            values: zeros(lower.symbolic.len_val())?,
            indefinite: None,
            columns: Vec::with_capacity(n),
            memory: scratch::<T>(lower, max_columns)?,
            workspace: Workspace::default(),
            max_columns,
        })
    }

    /// Reserves memory for a number of columns solved at once.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(super) fn reserve(&mut self, lower: &Lower, max_columns: usize) -> Result<()> {
        self.memory = scratch::<T>(lower, max_columns)?;
        self.max_columns = max_columns;
        Ok(())
    }

    /// Whether the last matrix was not positive definite.
    pub(super) fn is_indefinite(&self) -> bool {
        self.indefinite.is_some()
    }

    /// Factorises a matrix, of which `entry` returns real and imaginary part at a source. False if it is real and not
    /// positive definite; then there is no factor.
    ///
    /// # Errors
    /// [`Error::Linear`] if an entry is not finite.
    pub(super) fn factorize(&mut self, lower: &Lower, entry: impl Fn(usize) -> [f64; 2]) -> Result<bool> {
        self.indefinite = None;
        for (scale, &source) in self.scale.iter_mut().zip(&lower.diagonal) {
            let [re, im] = entry(source);
            *scale = power_of_two(re.hypot(im).sqrt().recip());
        }
        let mut is_finite = true;
        let mut at = 0;
        for (column, scale) in self.scale.iter().enumerate() {
            for &row in lower.pattern.row_idx_of_col_raw(column) {
                let factor = scale * self.scale[row];
                let value = T::of(entry(lower.sources[at]).map(|part| factor * part));
                is_finite &= value.parts().iter().all(|part| part.is_finite());
                self.matrix[at] = value;
                at += 1;
            }
        }
        if !is_finite {
            return Err(Error::Linear { reason: "the matrix has an entry that is not finite".into() });
        }
        let matrix = SparseColMatRef::new(lower.pattern.as_ref(), &self.matrix);
        let memory = (MemStack::new(&mut self.memory), &mut self.workspace);
        let of = |supernodes| T::factorize(supernodes, matrix, &mut self.values, memory);
        Ok(lower.supernodes().is_none_or(of))
    }

    /// Factorises the last matrix as `L B L^T` with pivots inside supernodes: rare (a strongly compressed body at a
    /// large step), so it may allocate.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(super) fn factorize_indefinite(&mut self, lower: &Lower) -> Result<()> {
        let n = lower.free.len();
        let mut pivots =
            Pivots { subdiagonal: vec![T::default(); n], forward: vec![0; n], inverse: vec![0; n] };
        let symbolic = &lower.symbolic;
        let request = symbolic.factorize_numeric_intranode_lblt_scratch::<T>(Par::Seq, Default::default());
        symbolic.factorize_numeric_intranode_lblt(
            &mut self.values,
            &mut pivots.subdiagonal,
            &mut pivots.forward,
            &mut pivots.inverse,
            SparseColMatRef::new(lower.pattern.as_ref(), &self.matrix),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut memory(request)?),
            Default::default(),
        );
        self.indefinite = Some(pivots);
        Ok(())
    }

    /// Solves for columns, given by access to the scalar rows: `read(x, column, row)` and `write(x, column, row,
    /// value)`; fixed rows are unchanged.
    pub(super) fn solve<X>(
        &mut self,
        lower: &Lower,
        n_columns: usize,
        x: &mut X,
        read: impl Fn(&X, usize, usize) -> [f64; 2],
        mut write: impl FnMut(&mut X, usize, usize, [f64; 2]),
    ) {
        assert!(n_columns <= self.max_columns);
        let rows = || self.scale.iter().zip(&lower.free);
        let scaled =
            |column: usize, (scale, row): (&f64, &usize)| read(x, column, *row).map(|part| scale * part);
        let parts = (0..n_columns).flat_map(|column| rows().flat_map(move |row| scaled(column, row)));
        let largest = parts.fold(0.0, |largest: f64, part| largest.max(part.abs()));
        if largest == 0.0 {
            return;
        }
        let size = power_of_two(largest.recip());
        self.columns.clear();
        for column in 0..n_columns {
            let numbers = rows().map(|row| T::of(scaled(column, row).map(|part| size * part)));
            self.columns.extend(numbers);
        }
        self.backsolve(lower, n_columns);
        let n = lower.free.len();
        for column in 0..n_columns {
            let solution = &self.columns[column * n..];
            for ((scale, &row), value) in self.scale.iter().zip(&lower.free).zip(solution) {
                write(x, column, row, value.parts().map(|part| scale * part / size));
            }
        }
    }

    fn backsolve(&mut self, lower: &Lower, n_columns: usize) {
        let n = lower.free.len();
        let mut columns = MatMut::from_column_major_slice_mut(&mut self.columns, n, n_columns);
        let stack = MemStack::new(&mut self.memory);
        match (&self.indefinite, lower.supernodes()) {
            (Some(pivots), _) => {
                let order = PermRef::new_checked(&pivots.forward, &pivots.inverse, n);
                let factor = IntranodeLbltRef::new(&lower.symbolic, &self.values, &pivots.subdiagonal, order);
                factor.solve_in_place_with_conj(Conj::No, columns, Par::Seq, stack);
            }
            (None, Some(supernodes)) => {
                let factor = SupernodalLltRef::new(supernodes, &self.values);
                factor.l_solve_with_conj(Conj::No, columns.rb_mut(), Par::Seq, stack);
                factor.l_transpose_solve_with_conj(Conj::No, columns, Par::Seq, stack);
            }
            (None, None) => {}
        }
    }
}

/// The power of two next to a number, towards zero; 1 for zero and what is not a normal number.
fn power_of_two(number: f64) -> f64 {
    let exponent = f64::from_bits(number.to_bits() & f64::INFINITY.to_bits());
    if exponent.is_normal() { exponent } else { 1.0 }
}

fn out_of_memory(bytes: usize) -> Error {
    Error::OutOfMemory { what: "the factorisation", gigabytes: bytes as f64 / 1e9 }
}

/// Memory for a factorisation and for a number of columns solved at once.
fn scratch<T: Number>(lower: &Lower, max_columns: usize) -> Result<MemBuffer> {
    let request = lower.symbolic.solve_in_place_scratch::<T>(max_columns, Par::Seq);
    memory(lower.supernodes().map_or(request, |supernodes| request.or(T::request(supernodes))))
}

fn memory(request: StackReq) -> Result<MemBuffer> {
    MemBuffer::try_new(request).map_err(|_| out_of_memory(request.size_bytes()))
}

/// Zeros, or an error if the machine does not have the memory: the factor is by far the largest object of a run.
fn zeros<T: Number>(length: usize) -> Result<Vec<T>> {
    let mut zeros = Vec::new();
    let bytes = length.saturating_mul(size_of::<T>());
    zeros.try_reserve_exact(length).map_err(|_| out_of_memory(bytes))?;
    zeros.resize(length, T::default());
    Ok(zeros)
}
