//! Solvers of `(M + lambda K) y = b`.

use std::fmt;
use std::sync::Arc;

use half::bf16;
use rayon::prelude::*;

use super::kernel::Row;
use super::row_couplings::CouplingScale;
use super::{
    ConjugateGradients, Couplings, IncompleteCholesky, Real, SharedRows, ShiftedMatrix, StageMatrix,
    SweepOrder,
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
    /// A second stiffness with its own factor, which factorisations add.
    pub elastic: Option<(&'a StageMatrix, [f64; 2])>,
    /// Whether a factor in single precision has enough digits.
    pub in_single_precision: bool,
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

    /// Whether [`ShiftedSolver::couple`] works.
    fn takes_couplings(&self) -> bool {
        false
    }

    /// Adds `factor R^T A R` to the matrix of [`ShiftedSolver::solve`], in the place of earlier couplings, with the
    /// symmetric part A of some and the rotation R of each node.
    fn couple(&mut self, _: &Couplings, (_factor, _R): CouplingScale<'_>) {}

    /// Whether [`ShiftedSolver::precondition`] solves with the matrix itself.
    fn is_exact(&self) -> bool {
        false
    }

    /// Solves approximately in place with the real matrix `M + |lambda| K`, or with the matrix itself: always the same
    /// linear map.
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

    fn takes_couplings(&self) -> bool {
        C == 1
    }

    fn couple(&mut self, couplings: &Couplings, scale: CouplingScale<'_>) {
        self.matrix.couple(&self.sweep, couplings, scale);
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
