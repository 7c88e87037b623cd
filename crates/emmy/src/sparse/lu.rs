//! Sparse factorisation of a non-symmetric stage matrix, for systems that GMRES does not solve.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SparseColMatRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::{Conj, MatMut, Par};

use super::{Pattern, StageMatrix};
use crate::error::{Error, Result};

/// Factorisation `P A Q = L U` of the free part of a stage matrix, with partial pivoting and its own order (COLAMD).
#[derive(Debug)]
pub struct SparseLu {
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    /// Positions of the unknowns in `[k][n_rows][3]`.
    unknowns: Vec<usize>,
}

impl SparseLu {
    /// Analyses and factorises; rows and columns of `fixed: [n_rows][3]` are omitted.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Linear`].
    pub fn new(matrix: &StageMatrix, pattern: &Pattern, fixed: &[bool]) -> Result<Self> {
        let (begin, columns, values) = matrix.free_rows(pattern, fixed);
        if !values.iter().all(|value| value.is_finite()) {
            return Err(Error::Linear { reason: "the matrix has an entry that is not finite".into() });
        }
        let n = begin.len() - 1;
        // Rows of the matrix, read as columns of its transpose.
        let transposed = SymbolicSparseColMatRef::new_checked(n, n, &begin, None, &columns);
        let fail = |what: &str| Error::Linear { reason: what.to_string() };
        let symbolic = factorize_symbolic_lu(transposed, Default::default())
            .map_err(|error| fail(&format!("symbolic factorisation: {error:?}")))?;
        let mut numeric = NumericLu::new();
        let request = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        symbolic
            .factorize_numeric_lu(
                &mut numeric,
                SparseColMatRef::new(transposed, &values),
                Par::Seq,
                MemStack::new(&mut buffer(request)?),
                Default::default(),
            )
            .map_err(|error| fail(&format!("factorisation: {error:?}")))?;
        let n_stages = matrix.degree();
        let free = (0..n_stages * fixed.len()).filter(|at| !fixed[at % fixed.len()]);
        Ok(SparseLu { symbolic, numeric, unknowns: free.collect() })
    }

    /// Solves `A x = b`; `b`, `x`: `[k][n_rows][3]`; x is zero at omitted rows.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn solve(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        let mut solution: Vec<f64> = self.unknowns.iter().map(|&at| b[at]).collect();
        let request = self.symbolic.solve_transpose_in_place_scratch::<f64>(1, Par::Seq);
        let factor = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        factor.solve_transpose_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut solution, self.unknowns.len(), 1),
            Par::Seq,
            MemStack::new(&mut buffer(request)?),
        );
        x.fill(0.0);
        self.unknowns.iter().zip(&solution).for_each(|(&at, value)| x[at] = *value);
        Ok(())
    }
}

fn buffer(request: StackReq) -> Result<MemBuffer> {
    let gigabytes = request.size_bytes() as f64 * 1e-9;
    MemBuffer::try_new(request).map_err(|_| Error::OutOfMemory { what: "a factorisation", gigabytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_systems_that_are_not_symmetric() {
        let lists: Vec<[u32; 3]> = (0..8).map(|i| [i, i + 1, i + 2]).collect();
        let pattern = Pattern::new(10, lists.iter().map(|list| &list[..]));
        let mut matrix = StageMatrix::new(&pattern, &pattern.divided(2), 2);
        for part in matrix.parts_mut() {
            for position in part.rows().flat_map(|row| pattern.range(row)) {
                for stages in 0..4 {
                    for (entry, value) in part.block_mut(position, stages).iter_mut().enumerate() {
                        // The square: without it, rows would be sums of two.
                        *value = (((position * 36 + stages * 9 + entry) as f64).powi(2) * 0.37).sin();
                    }
                }
            }
        }
        let fixed: Vec<bool> = (0..30).map(|dof| dof % 7 == 3).collect();
        let free = |vector: &mut [f64]| {
            (0..60).filter(|at| fixed[at % 30]).for_each(|at| vector[at] = 0.0);
        };
        let mut exact: Vec<f64> = (0..60).map(|i| (i as f64).cos()).collect();
        free(&mut exact);
        let [mut b, mut x] = [vec![0.0; 60], vec![0.0; 60]];
        matrix.multiply(&pattern, &exact, &mut b);
        free(&mut b);
        SparseLu::new(&matrix, &pattern, &fixed).unwrap().solve(&b, &mut x).unwrap();
        assert!(x.iter().zip(&exact).all(|(x, exact)| (x - exact).abs() < 1e-10), "{x:?}");
    }
}
