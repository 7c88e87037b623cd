//! Lower triangle of a symmetric block matrix in its order of elimination, and the structure of its factor.

use faer::Side;
use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};

use super::Pattern;
use crate::error::{Error, Result};

/// The free scalar rows of a matrix of small square blocks, in the order of elimination.
#[derive(Debug)]
pub(super) struct Lower {
    /// Lower triangle by columns; the rows of a column are not sorted.
    pub pattern: SymbolicSparseColMat<usize>,
    /// The analysis of faer, in the present order.
    pub symbolic: SymbolicCholesky<usize>,
    /// Source of each entry: `position components^2 + entry`.
    pub sources: Vec<usize>,
    /// Source of each diagonal entry.
    pub diagonal: Vec<usize>,
    /// Scalar row of the matrix for each row here.
    pub free: Vec<usize>,
}

impl Lower {
    /// Symbolic factorisation. `components`: rows per block; `fixed: [n_rows components]`; `order[new] = old` of block
    /// rows.
    ///
    /// # Errors
    /// [`Error::Linear`] if there is not enough memory.
    pub(super) fn new(pattern: &Pattern, components: usize, fixed: &[bool], order: &[usize]) -> Result<Self> {
        let rows = order.iter().flat_map(|&node| (0..components).map(move |a| node * components + a));
        let free: Vec<usize> = rows.filter(|&row| !fixed[row]).collect();
        let mut number = vec![usize::MAX; fixed.len()];
        free.iter().enumerate().for_each(|(index, &row)| number[row] = index);
        let (mut begin, mut rows) = (vec![0], Vec::new());
        let (mut sources, mut diagonal) = (Vec::new(), Vec::new());
        for (index, &column) in free.iter().enumerate() {
            let (node, b) = (column / components, column % components);
            for (position, &other) in pattern.range(node).zip(pattern.row(node)) {
                for a in 0..components {
                    let row = number[other as usize * components + a];
                    // The block of row `node`, transposed: symmetric matrices only.
                    let source = (position * components + b) * components + a;
                    if row == index {
                        diagonal.push(source);
                    }
                    if row >= index && row != usize::MAX {
                        rows.push(row);
                        sources.push(source);
                    }
                }
            }
            begin.push(rows.len());
        }
        let n = free.len();
        let pattern = SymbolicSparseColMat::new_unsorted_checked(n, n, begin, None, rows);
        // Without an order, faer takes the pattern for an upper triangle.
        let same = || (0..n).collect::<Box<[usize]>>();
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Custom(Perm::new_checked(same(), same(), n).as_ref()),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|error| Error::Linear { reason: format!("symbolic factorisation: {error:?}") })?;
        Ok(Lower { pattern, symbolic, sources, diagonal, free })
    }

    /// The supernodes of the factor; `None` without free rows.
    pub(super) fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<usize>> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(supernodes) => Some(supernodes),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Cost of a factorisation in real numbers, in solutions.
    pub(super) fn cost_over_solution(&self) -> f64 {
        // A column with c entries takes c^2 operations in cache, and 2 c words from memory in a solution.
        let entries_of_column = self.symbolic.len_val() as f64 / self.free.len().max(1) as f64;
        (0.04 * entries_of_column).max(4.0)
    }
}
