//! Conjugate gradients for real and complex symmetric systems.

use rayon::prelude::*;

use super::gmres::Solution;
use super::kernel::{Entry, Row};
use super::real::Real;
use super::shared_rows::SharedRows;
use super::shifted::{CHUNK, ShiftedMatrix, dot, summed};
use super::sweep::SweepOrder;

/// An approximate inverse, real and symmetric.
pub(crate) trait Approximate<T, const C: usize> {
    /// `x = P^-1 x`.
    fn solve(&mut self, sweep: &SweepOrder, x: &mut [Row<T, C>]);
}

/// Conjugate gradients (Hestenes and Stiefel 1952) with one column; with two, for a complex symmetric matrix, conjugate
/// orthogonal conjugate gradients (van der Vorst and Melissen 1990): the same recurrences with products that are not
/// conjugated.
#[derive(Debug, Clone)]
pub(crate) struct ConjugateGradients<T, const C: usize> {
    /// Right-hand side, then residual.
    pub rhs: Vec<Row<T, C>>,
    /// Solution.
    pub solution: Vec<Row<T, C>>,
    preconditioned: Vec<Row<T, C>>,
    direction: Vec<Row<T, C>>,
    product: Vec<Row<T, C>>,
    partial: Vec<[f64; 2]>,
    /// The other ranks; `None`: there are none.
    ranks: Option<SharedRows>,
}

/// Part of the square of a residual that its predecessor and the last direction determine to 8 digits.
const CANCELLED: f64 = 1e-8;

/// Relative residual that no further iteration improves.
const ROUNDING: f64 = 1e-14;

impl<T: Real, const C: usize> ConjugateGradients<T, C> {
    /// Memory for systems of a size.
    pub(crate) fn new(n_rows: usize) -> Self {
        let zero = vec![[[T::default(); C]; 4]; n_rows];
        ConjugateGradients {
            rhs: zero.clone(),
            solution: zero.clone(),
            preconditioned: zero.clone(),
            direction: zero.clone(),
            product: zero,
            partial: vec![[0.0; 2]; n_rows.div_ceil(CHUNK)],
            ranks: None,
        }
    }

    /// The same memory, for rows that a team shares.
    pub(crate) fn on(self, ranks: Option<SharedRows>) -> Self {
        ConjugateGradients { ranks, ..self }
    }

    /// The largest of a number of all ranks.
    pub(super) fn largest(&self, own: f64) -> f64 {
        self.ranks.as_ref().map_or(own, |ranks| ranks.largest(own))
    }

    /// Solves from zero until the residual is `tolerance` times the right-hand side after at least `least` iterations,
    /// or the iterations are used up. On a team, an iteration is two sums.
    pub(crate) fn solve(
        &mut self,
        sweep: &SweepOrder,
        matrix: &ShiftedMatrix<impl Entry<Number = T>, C>,
        inverse: &mut impl Approximate<T, C>,
        tolerance: f64,
        (least, max_iterations): (usize, usize),
    ) -> Solution {
        self.solution.fill([[T::default(); C]; 4]);
        // After an overflow the previous solution is not finite, and zero times it would not be zero.
        self.direction.fill([[T::default(); C]; 4]);
        // On a team, the first products have it.
        let mut norm = if self.ranks.is_none() { self.residual_square().sqrt() } else { 1.0 };
        let mut outcome = Solution { iterations: 0, relative_residual: if norm == 0.0 { 0.0 } else { 1.0 } };
        if norm == 0.0 || !norm.is_finite() {
            return outcome;
        }
        let mut rho = [1.0, 0.0];
        let is_left = |outcome: &Solution| {
            let wanted = if outcome.iterations < least { ROUNDING.min(tolerance) } else { tolerance };
            outcome.relative_residual > wanted
        };
        while outcome.iterations < max_iterations && is_left(&outcome) {
            self.preconditioned.copy_from_slice(&self.rhs);
            inverse.solve(sweep, &mut self.preconditioned);
            let (new, square) = self.rhs_products();
            if self.ranks.is_some() && outcome.iterations == 0 {
                norm = square.sqrt();
                if norm == 0.0 {
                    outcome.relative_residual = 0.0;
                    break;
                }
            }
            let beta = if outcome.iterations == 0 { [0.0; 2] } else { divided(new, rho) };
            rho = new;
            self.turn(beta);
            if let Some(ranks) = &self.ranks {
                ranks.exchange(&mut self.direction);
            }
            let curvature = matrix.multiply(sweep, &self.direction, &mut self.product, &mut self.partial);
            let residual = match self.ranks.is_some() {
                true => self.advance_on_team(rho, curvature, square).sqrt(),
                false => self.advance(divided(rho, curvature)).sqrt(),
            };
            outcome.iterations += 1;
            outcome.relative_residual = residual / norm;
            if !residual.is_finite() {
                break;
            }
        }
        outcome
    }

    /// `p = z + beta p`.
    fn turn(&mut self, beta: [f64; 2]) {
        let beta = beta.map(T::of);
        let parts = self.direction.par_chunks_mut(CHUNK).zip(self.preconditioned.par_chunks(CHUNK));
        parts.for_each(|(p, z)| {
            for (p, z) in p.iter_mut().zip(z) {
                let mut turned = *z;
                add_multiple(&mut turned, beta, p);
                *p = turned;
            }
        });
    }

    /// `x += alpha p`, `r -= alpha A p`; the square of the new r on this rank.
    fn advance(&mut self, alpha: [f64; 2]) -> f64 {
        let along = alpha.map(T::of);
        let against = alpha.map(|a| T::of(-a));
        let solution = self.solution.par_chunks_mut(CHUNK).zip(self.direction.par_chunks(CHUNK));
        let residual = self.rhs.par_chunks_mut(CHUNK).zip(self.product.par_chunks(CHUNK));
        solution.zip(residual).zip(self.partial.par_iter_mut()).for_each(|(((x, p), (r, q)), partial)| {
            x.iter_mut().zip(p).for_each(|(x, p)| add_multiple(x, along, p));
            r.iter_mut().zip(q).for_each(|(r, q)| add_multiple(r, against, q));
            *partial = [square(r), 0.0];
        });
        summed(&self.partial)[0]
    }

    /// [`ConjugateGradients::advance`] with all products of the iteration in one sum; the square of the new r on all
    /// ranks from that of the old one.
    ///
    /// ```math
    /// |r - alpha q|^2 = |r|^2 - 2 Re(alpha r* . q) + |alpha|^2 |q|^2
    /// ```
    fn advance_on_team(&mut self, rho: [f64; 2], curvature: [f64; 2], square: f64) -> f64 {
        let products = [curvature, self.mixed_product(), [self.product_square(), 0.0]];
        let products = products.as_flattened();
        let sums: [f64; 6] = self.sum_of_ranks(std::array::from_fn(|at| products[at]));
        let alpha = divided(rho, [sums[0], sums[1]]);
        let own = self.advance(alpha);
        let mixed = alpha[0] * sums[2] - alpha[1] * sums[3];
        let new = square - 2.0 * mixed + (alpha[0] * alpha[0] + alpha[1] * alpha[1]) * sums[4];
        if new > CANCELLED * square { new } else { self.sum_of_ranks([own])[0] }
    }

    fn sum_of_ranks<const N: usize>(&self, own: [f64; N]) -> [f64; N] {
        self.ranks.as_ref().map_or(own, |ranks| ranks.sum(own))
    }

    fn residual_square(&mut self) -> f64 {
        let parts = self.rhs.par_chunks(CHUNK).zip(self.partial.par_iter_mut());
        parts.for_each(|(r, partial)| *partial = [square(r), 0.0]);
        summed(&self.partial)[0]
    }

    fn product_square(&mut self) -> f64 {
        let parts = self.product.par_chunks(CHUNK).zip(self.partial.par_iter_mut());
        parts.for_each(|(q, partial)| *partial = [square(q), 0.0]);
        summed(&self.partial)[0]
    }

    /// `r* . q` on this rank, r conjugated.
    fn mixed_product(&mut self) -> [f64; 2] {
        let vectors = self.rhs.par_chunks(CHUNK).zip(self.product.par_chunks(CHUNK));
        vectors
            .zip(self.partial.par_iter_mut())
            .for_each(|((r, q), partial)| *partial = conjugated_dot(r, q));
        summed(&self.partial)
    }

    /// `r . z` of all ranks, and on a team the square of r.
    fn rhs_products(&mut self) -> ([f64; 2], f64) {
        let vectors = self.rhs.par_chunks(CHUNK).zip(self.preconditioned.par_chunks(CHUNK));
        vectors.zip(self.partial.par_iter_mut()).for_each(|((r, z), partial)| *partial = dot(r, z));
        let product = summed(&self.partial);
        if self.ranks.is_none() {
            return (product, f64::NAN);
        }
        let own = [product[0], product[1], self.residual_square()];
        let [re, im, square] = self.sum_of_ranks(own);
        ([re, im], square)
    }
}

/// `y += a x`.
#[inline(always)]
fn add_multiple<T: Real, const C: usize>(y: &mut Row<T, C>, a: [T; 2], x: &Row<T, C>) {
    for component in 0..4 {
        if C == 1 {
            y[component][0] += a[0] * x[component][0];
        } else {
            let re = x[component][0];
            let im = x[component][C - 1];
            y[component][0] += a[0] * re - a[1] * im;
            y[component][C - 1] += a[0] * im + a[1] * re;
        }
    }
}

/// `x* . y`, x conjugated, as (real, imaginary).
fn conjugated_dot<T: Real, const C: usize>(x: &[Row<T, C>], y: &[Row<T, C>]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (x, y) in x.as_flattened().iter().zip(y.as_flattened()) {
        (0..C).for_each(|c| sums[0] += x[c].wide() * y[c].wide());
        if C == 2 {
            sums[1] += x[0].wide() * y[C - 1].wide() - x[C - 1].wide() * y[0].wide();
        }
    }
    sums
}

fn square<T: Real, const C: usize>(x: &[Row<T, C>]) -> f64 {
    let mut sums = [0.0; 4];
    for x in x {
        (0..4).for_each(|a| (0..C).for_each(|c| sums[a] += x[a][c].wide() * x[a][c].wide()));
    }
    sums.iter().sum()
}

/// Quotient of two complex numbers.
fn divided(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let square = b[0] * b[0] + b[1] * b[1];
    [(a[0] * b[0] + a[1] * b[1]) / square, (a[1] * b[0] - a[0] * b[1]) / square]
}

#[cfg(test)]
mod tests {
    use half::bf16;

    use super::super::incomplete_cholesky::IncompleteCholesky;
    use super::super::incomplete_cholesky::tests::elastic;
    use super::super::sweep::tests::grid;
    use super::*;

    /// Solves a system with a known solution; returns its error and the iterations.
    fn solved<const C: usize>(shift: [f64; 2], tolerance: f64) -> (f64, usize) {
        let pattern = grid([8, 7, 60]);
        let (mass, stiffness) = elastic(&pattern);
        let sweep = SweepOrder::new(&pattern);
        let mut fixed = vec![false; 3 * pattern.n_rows()];
        (0..40).for_each(|dof| fixed[5 * dof] = true);
        let block = |position: usize| &stiffness[9 * position..9 * position + 9];
        let mut matrix = ShiftedMatrix::<bf16, C>::new(&sweep, &fixed);
        matrix.set(&sweep, shift, &mass, block);
        let mut factor = IncompleteCholesky::new(&sweep);
        factor.factorize(&sweep, &fixed, shift[0].hypot(shift[1]), &mass, block);
        let mut solver = ConjugateGradients::<f32, C>::new(sweep.n_rows());
        // State after an overflow in the previous solution.
        solver.direction.fill([[f32::NAN; C]; 4]);
        let value = |row: usize, a: usize, c: usize| {
            let held = fixed[3 * sweep.order[row] as usize + a];
            if held { 0.0 } else { ((3 * row + a + 7 * c) as f32 * 0.1).sin() }
        };
        let x: Vec<Row<f32, C>> = (0..sweep.n_rows())
            .map(|row| {
                [0, 1, 2, 3].map(|a| std::array::from_fn(|c| if a < 3 { value(row, a, c) } else { 0.0 }))
            })
            .collect();
        matrix.multiply(&sweep, &x, &mut solver.rhs, &mut vec![[0.0; 2]; sweep.n_rows().div_ceil(CHUNK)]);
        let outcome = solver.solve(&sweep, &matrix, &mut factor, tolerance, (0, 200));
        assert!(outcome.relative_residual <= tolerance);
        let errors = x.iter().flatten().flatten().zip(solver.solution.iter().flatten().flatten());
        (errors.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max), outcome.iterations)
    }

    #[test]
    fn real_and_complex_systems_are_solved() {
        let (error, real) = solved::<1>([0.5, 0.0], 1e-5);
        assert!(error < 1e-4, "{error:e}");
        let (error, complex) = solved::<2>([0.3, 0.4], 1e-5);
        assert!(error < 1e-4, "{error:e}");
        // The same modulus; the argument of lambda, 53 degrees, leaves a factor tan(53/4) = 0.24 an iteration, 1e-5 in
        // 8.
        assert!(complex <= real + 8, "{complex} {real}");
    }

    #[test]
    fn zero_right_hand_side_costs_nothing() {
        let pattern = grid([2, 2, 2]);
        let sweep = SweepOrder::new(&pattern);
        let mut solver = ConjugateGradients::<f32, 1>::new(8);
        let matrix = ShiftedMatrix::<bf16, 1>::new(&sweep, &[false; 24]);
        let outcome = solver.solve(&sweep, &matrix, &mut IncompleteCholesky::new(&sweep), 1e-3, (0, 10));
        assert_eq!(outcome.iterations, 0);
    }
}
