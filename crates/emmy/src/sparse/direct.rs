//! Factorised systems `(M + lambda K) y = b`.

use faer::{c32, c64};

use super::Pattern;
use super::factor::{Factor, Number};
use super::lower::Lower;
use super::shifted_solver::{Shifted, ShiftedSolver};
use crate::error::Result;

/// A sparse factorisation in numbers S of single precision, or D of double precision if the system asks for more
/// digits or is not positive definite.
#[derive(Debug)]
pub(crate) struct Factorized<S, D> {
    lower: Lower,
    single: Option<Factor<S>>,
    double: Option<Factor<D>>,
}

/// With a real lambda.
pub(crate) type Direct = Factorized<f32, f64>;

/// With a complex lambda: one complex column, which is two real ones.
pub(crate) type DirectPair = Factorized<c32, c64>;

impl<S: Number, D: Number> Factorized<S, D> {
    /// Symbolic factorisation; `order[new] = old`.
    ///
    /// # Errors
    /// [`crate::Error::Linear`] if there is not enough memory.
    pub(crate) fn new(pattern: &Pattern, fixed: &[bool], order: &[usize]) -> Result<Self> {
        Ok(Factorized { lower: Lower::new(pattern, 3, fixed, order)?, single: None, double: None })
    }
}

impl<S: Number, D: Number> ShiftedSolver for Factorized<S, D> {
    fn factorize(&mut self, system: &Shifted<'_>) -> Result<()> {
        let Shifted { stiffness, mass, shift: [re, im], elastic, .. } = *system;
        let entry = |source: usize| {
            let k = stiffness.block(source / 9)[source % 9];
            // Entries 0, 4, 8 are the diagonal of a 3 x 3 block.
            let m = if (source % 9).is_multiple_of(4) { mass[source / 9] } else { 0.0 };
            let sum = [m + re * k, im * k];
            let Some((elastic, [re, im])) = elastic else { return sum };
            let k = elastic.block(source / 9)[source % 9];
            [sum[0] + re * k, sum[1] + im * k]
        };
        let lower = &self.lower;
        if system.in_single_precision {
            self.double = None;
            if matches!(made(&mut self.single, lower)?.factorize(lower, entry), Ok(true)) {
                return Ok(());
            }
        }
        self.single = None;
        let factor = made(&mut self.double, lower)?;
        if !factor.factorize(lower, entry)? {
            factor.factorize_indefinite(lower)?;
        }
        Ok(())
    }

    fn solve(&mut self, x: &mut [f64], _: f64) -> Option<usize> {
        self.precondition(x);
        Some(1)
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn refactorization_cost(&self) -> f64 {
        D::COLUMNS as f64 * self.lower.cost_over_solution()
    }

    fn precondition(&mut self, x: &mut [f64]) {
        match (&mut self.single, &mut self.double) {
            (Some(factor), _) => backsolve(&self.lower, factor, x),
            (None, Some(factor)) => backsolve(&self.lower, factor, x),
            (None, None) => {}
        }
    }
}

/// The factor, with new memory if there is none.
fn made<'a, T: Number>(factor: &'a mut Option<Factor<T>>, lower: &Lower) -> Result<&'a mut Factor<T>> {
    match factor {
        Some(factor) => Ok(factor),
        None => Ok(factor.insert(Factor::new(lower, 1)?)),
    }
}

fn backsolve<T: Number>(lower: &Lower, factor: &mut Factor<T>, mut x: &mut [f64]) {
    let n = T::COLUMNS;
    let read = |x: &&mut [f64], _: usize, row: usize| [x[n * row], x[n * row + n - 1]];
    let write = |x: &mut &mut [f64], _: usize, row: usize, parts: [f64; 2]| {
        x[n * row..][..n].copy_from_slice(&parts[..n]);
    };
    factor.solve(lower, 1, &mut x, read, write);
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::incomplete_cholesky::tests::elastic;
    use super::super::shifted::CHUNK;
    use super::super::shifted_solver::{gather, scatter};
    use super::super::sweep::tests::grid;
    use super::super::{ShiftedMatrix, StageMatrix, SweepOrder, nested_dissection};
    use super::*;

    /// Largest error of the solution of a system, whose matrix has a shift, with a known one of size 1.
    fn error<const C: usize>(
        solver: &mut dyn ShiftedSolver,
        (system, shift): (&Shifted<'_>, [f64; 2]),
        pattern: &Pattern,
    ) -> f64 {
        let sweep = Arc::new(SweepOrder::new(pattern));
        let mut matrix = ShiftedMatrix::<f64, C>::new(&sweep, system.fixed);
        matrix.set(&sweep, shift, system.mass, |position| system.stiffness.block(position));
        let free = |at: usize| !system.fixed[at / C];
        let exact: Vec<f64> =
            (0..C * system.fixed.len()).map(|at| if free(at) { (at as f64).sin() } else { 0.0 }).collect();
        let mut rows = vec![[[0.0; C]; 4]; sweep.n_rows()];
        let mut products = rows.clone();
        gather(&sweep, &exact, 1.0, &mut rows);
        matrix.multiply(&sweep, &rows, &mut products, &mut vec![[0.0; 2]; sweep.n_rows().div_ceil(CHUNK)]);
        let mut x = exact.clone();
        scatter(&sweep, &products, 1.0, &mut x);
        solver.factorize(system).unwrap();
        assert_eq!(solver.solve(&mut x, 1e-1), Some(1));
        x.iter().zip(&exact).map(|(x, exact)| (x - exact).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn real_and_complex_systems_are_solved_in_both_precisions() {
        let pattern = grid([7, 6, 9]);
        let (mass, blocks) = elastic(&pattern);
        let mut stiffness = StageMatrix::new(&pattern, &pattern.divided(1), 1);
        stiffness.parts_mut()[0].blocks_mut().0.as_flattened_mut().copy_from_slice(&blocks);
        let mut half = stiffness.clone();
        half.parts_mut()[0].blocks_mut().0.as_flattened_mut().iter_mut().for_each(|entry| *entry *= 0.5);
        let fixed: Vec<bool> = (0..3 * pattern.n_rows()).map(|dof| dof % 11 == 3).collect();
        let order = nested_dissection(&pattern).unwrap();
        let (positions, mass, fixed) = (&[][..], &mass[..], &fixed[..]);
        let mut real = Direct::new(&pattern, fixed, &order).unwrap();
        let mut pair = DirectPair::new(&pattern, fixed, &order).unwrap();
        // The real matrices of the last shifts are indefinite.
        for (re, im) in [(0.5, 0.8), (-0.3, 0.9), (-2.0, 1.5)] {
            for in_single_precision in [true, false, true] {
                let shift = [re, im];
                let system = Shifted {
                    stiffness: &stiffness,
                    mass,
                    fixed,
                    positions,
                    shift,
                    elastic: None,
                    in_single_precision,
                };
                let bound = if in_single_precision { 1e-5 } else { 1e-12 };
                // A second matrix, half of the first one, with a factor that the first one lacks.
                let of_two =
                    Shifted { shift: [re - 0.2, im + 0.1], elastic: Some((&half, [0.4, -0.2])), ..system };
                let found = error::<2>(&mut pair, (&of_two, shift), &pattern);
                assert!(found < bound, "two: {re} {im} {in_single_precision}: {found:e}");
                let found = error::<2>(&mut pair, (&system, shift), &pattern);
                assert!(found < bound, "{re} {im} {in_single_precision}: {found:e}");
                assert_eq!(
                    [pair.single.is_some(), pair.double.is_some()],
                    [in_single_precision, !in_single_precision]
                );
                if in_single_precision {
                    assert!(found > 1e-9, "not in single precision: {found:e}");
                }
                let shift = [re, 0.0];
                let found = error::<1>(&mut real, (&Shifted { shift, ..system }, shift), &pattern);
                // An indefinite matrix is factorised in double precision.
                let is_single = in_single_precision && re > 0.0;
                let bound = if is_single { 1e-5 } else { 1e-8 };
                assert!(found < bound, "{re} {in_single_precision}: {found:e}");
                assert_eq!([real.single.is_some(), real.double.is_some()], [is_single, !is_single]);
            }
        }
    }
}
