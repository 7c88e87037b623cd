//! Solvers of `(M + lambda K) y = b`.

use std::fmt;
use std::sync::Arc;

use half::bf16;
use rayon::prelude::*;

use super::kernel::Row;
use super::{
    Approximate, BlockCholesky, ConjugateGradients, IncompleteCholesky, Pattern, Real, SharedRows,
    ShiftedMatrix, StageMatrix, SweepOrder,
};
use crate::error::Result;

/// The parts of a matrix `M + lambda K` on the free rows of a pattern.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shifted<'a> {
    /// K, a matrix of one stage.
    pub stiffness: &'a StageMatrix,
    /// Mass of each block.
    pub mass: &'a [f64],
    /// Fixed components, `[n_rows][3]`.
    pub fixed: &'a [bool],
    /// Positions of the nodes in K, for its rigid modes, `[n_rows][3]`.
    pub positions: &'a [f64],
    /// lambda.
    pub shift: [f64; 2],
}

/// A solver; vectors are `[n_nodes][3][columns]`.
pub(crate) trait ShiftedSolver: fmt::Debug + Send {
    /// Sets the matrix.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if the matrix is not finite or there is not enough memory.
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()>;

    /// Solves in place to a relative tolerance. Returns the number of iterations, or `None` if it missed the tolerance.
    fn solve(&mut self, x: &mut [f64], tolerance: f64) -> Option<usize>;

    /// Cost of a new stiffness and its factorisation, in solutions.
    fn refactorization_cost(&self) -> f64;

    /// Solves approximately in place with the real matrix `M + |lambda| K`: always the same linear map.
    fn precondition(&mut self, x: &mut [f64]);
}

/// Conjugate gradients, preconditioned by an incomplete factor, in single precision; the caller corrects the result.
#[derive(Debug)]
pub(crate) struct Iterative<const C: usize> {
    sweep: Arc<SweepOrder>,
    matrix: ShiftedMatrix<bf16, C>,
    factor: IncompleteCholesky,
    krylov: ConjugateGradients<f32, C>,
}

/// Iterations before giving up.
pub(super) const MAX_ITERATIONS: usize = 400;

impl<const C: usize> Iterative<C> {
    /// Memory for a matrix with fixed rows, `[n_rows 3]`, those of guests among them.
    pub(crate) fn new(fixed: &[bool], sweep: Arc<SweepOrder>, ranks: Option<SharedRows>) -> Self {
        Iterative {
            matrix: ShiftedMatrix::new(&sweep, fixed),
            factor: IncompleteCholesky::new(&sweep),
            krylov: ConjugateGradients::new(sweep.n_rows()).on(ranks),
            sweep,
        }
    }
}

impl<const C: usize> ShiftedSolver for Iterative<C> {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let Shifted { stiffness, mass, fixed, shift, .. } = *system;
        let block = |position: usize| stiffness.block(position);
        self.matrix.set(&self.sweep, shift, mass, block);
        let modulus = shift[0].hypot(shift[1]);
        self.factor.factorize(&self.sweep, fixed, modulus, mass, block);
        Ok(())
    }

    fn solve(&mut self, x: &mut [f64], tolerance: f64) -> Option<usize> {
        let size = self.krylov.largest(largest(x));
        if size == 0.0 {
            return Some(0);
        }
        gather(&self.sweep, x, 1.0 / size, &mut self.krylov.rhs);
        let matrix = &self.matrix;
        let factor = &mut self.factor;
        let limits = (0, MAX_ITERATIONS);
        let outcome = self.krylov.solve(&self.sweep, matrix, factor, tolerance, limits);
        scatter(&self.sweep, &self.krylov.solution, size, x);
        (outcome.relative_residual <= tolerance).then_some(outcome.iterations)
    }

    fn refactorization_cost(&self) -> f64 {
        4.0
    }

    fn precondition(&mut self, x: &mut [f64]) {
        let size = largest(x);
        if size == 0.0 {
            return;
        }
        gather(&self.sweep, x, 1.0 / size, &mut self.krylov.rhs);
        self.factor.sweeps(&self.sweep, &mut self.krylov.rhs);
        scatter(&self.sweep, &self.krylov.rhs, size, x);
    }
}

/// A sparse factorisation; exact for a real lambda.
#[derive(Debug)]
pub(crate) struct Direct {
    factor: BlockCholesky,
}

impl Direct {
    /// Symbolic factorisation; `order[new] = old`.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::Linear`].
    pub(crate) fn new(pattern: &Pattern, fixed: &[bool], order: &[usize]) -> Result<Self> {
        Ok(Direct { factor: BlockCholesky::new(pattern, 3, fixed, order)? })
    }

    fn factorize_real(&mut self, stiffness: &StageMatrix, mass: &[f64], modulus: f64) -> Result<()> {
        self.factor.factorize(|source| {
            // Entries 0, 4, 8 are the diagonal of a 3 x 3 block.
            let diagonal = if source % 9 % 4 == 0 { mass[source / 9] } else { 0.0 };
            diagonal + modulus * stiffness.block(source / 9)[source % 9]
        })
    }

    fn backsolve(&mut self, n_columns: usize, x: &mut [f64]) {
        let read = |x: &&mut [f64], column: usize, row: usize| x[row * n_columns + column];
        let write = |x: &mut &mut [f64], column: usize, row: usize, value: f64| {
            x[row * n_columns + column] = value;
        };
        self.factor.solve(n_columns, &mut &mut *x, read, write);
    }
}

impl ShiftedSolver for Direct {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let Shifted { stiffness, mass, shift, .. } = *system;
        self.factorize_real(stiffness, mass, shift[0])
    }

    fn solve(&mut self, x: &mut [f64], _: f64) -> Option<usize> {
        self.precondition(x);
        Some(1)
    }

    fn refactorization_cost(&self) -> f64 {
        self.factor.cost_over_solution()
    }

    fn precondition(&mut self, x: &mut [f64]) {
        self.backsolve(1, x);
    }
}

/// Conjugate gradients for a complex lambda, preconditioned by the factorisation of `M + |lambda| K`: the number of
/// iterations depends on neither mesh nor step size, only on the argument phi of lambda.
///
/// ```math
/// |e_n| <= tan(phi/4)^n |e_0|
/// ```
///
/// in the norm of `M + |lambda| K`. For stiff projected volumes, the Euclidean norm of the residual alone would leave
/// the soft modes.
#[derive(Debug)]
pub(crate) struct DirectPair {
    sweep: Arc<SweepOrder>,
    matrix: ShiftedMatrix<f64, 2>,
    inverse: Reordered,
    krylov: ConjugateGradients<f64, 2>,
    /// tan(phi/4).
    contraction: f64,
    /// Whether K has projected volumes.
    is_mixed: bool,
}

/// A factorisation as an approximate inverse, in the order of the sweep.
#[derive(Debug)]
struct Reordered {
    direct: Direct,
    work: Vec<f64>,
}

impl DirectPair {
    /// Symbolic factorisation; `order[new] = old`; `is_mixed`: whether K has projected volumes.
    ///
    /// # Errors
    /// As [`Direct::new`].
    pub(crate) fn new(
        pattern: &Pattern,
        fixed: &[bool],
        order: &[usize],
        sweep: Arc<SweepOrder>,
        is_mixed: bool,
    ) -> Result<Self> {
        Ok(DirectPair {
            is_mixed,
            matrix: ShiftedMatrix::new(&sweep, fixed),
            inverse: Reordered {
                direct: Direct::new(pattern, fixed, order)?,
                work: vec![0.0; 2 * fixed.len()],
            },
            krylov: ConjugateGradients::new(sweep.n_rows()),
            contraction: 0.0,
            sweep,
        })
    }
}

impl ShiftedSolver for DirectPair {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let Shifted { stiffness, mass, shift, .. } = *system;
        self.matrix.set(&self.sweep, shift, mass, |position| stiffness.block(position));
        self.contraction = (0.25 * shift[1].atan2(shift[0])).tan();
        self.inverse.direct.factorize_real(stiffness, mass, shift[0].hypot(shift[1]))
    }

    fn solve(&mut self, x: &mut [f64], tolerance: f64) -> Option<usize> {
        gather(&self.sweep, x, 1.0, &mut self.krylov.rhs);
        let matrix = &self.matrix;
        let inverse = &mut self.inverse;
        let least = (tolerance.ln() / self.contraction.ln()).ceil() as usize;
        let limits = (if self.is_mixed { least } else { 0 }, MAX_ITERATIONS);
        let outcome = self.krylov.solve(&self.sweep, matrix, inverse, tolerance, limits);
        scatter(&self.sweep, &self.krylov.solution, 1.0, x);
        (outcome.relative_residual <= tolerance).then_some(outcome.iterations)
    }

    fn refactorization_cost(&self) -> f64 {
        self.inverse.direct.refactorization_cost()
    }

    fn precondition(&mut self, x: &mut [f64]) {
        self.inverse.direct.backsolve(2, x);
    }
}

impl Approximate<f64, 2> for Reordered {
    fn solve(&mut self, sweep: &SweepOrder, x: &mut [Row<f64, 2>]) {
        scatter(sweep, x, 1.0, &mut self.work);
        self.direct.backsolve(2, &mut self.work);
        gather(sweep, &self.work, 1.0, x);
    }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

/// Smallest number of rows of a task.
const ROWS: usize = 2048;

/// `rows = factor x`, rows in the order of the sweep.
pub(super) fn gather<T: Real, const C: usize>(
    sweep: &SweepOrder,
    x: &[f64],
    factor: f64,
    rows: &mut [Row<T, C>],
) {
    rows.par_iter_mut().with_min_len(ROWS).zip(&sweep.order).for_each(|(row, &node)| {
        let x = &x[3 * C * node as usize..][..3 * C];
        for a in 0..3 {
            (0..C).for_each(|c| row[a][c] = T::of(factor * x[a * C + c]));
        }
    });
}

/// `x = factor rows`, back in the order of the nodes.
pub(super) fn scatter<T: Real, const C: usize>(
    sweep: &SweepOrder,
    rows: &[Row<T, C>],
    factor: f64,
    x: &mut [f64],
) {
    for (row, &node) in rows.iter().zip(&sweep.order) {
        let x = &mut x[3 * C * node as usize..][..3 * C];
        for a in 0..3 {
            (0..C).for_each(|c| x[a * C + c] = factor * row[a][c].wide());
        }
    }
}
