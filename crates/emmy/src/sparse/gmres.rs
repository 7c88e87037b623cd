//! Generalised minimal residual method with a right preconditioner.

use super::reduce::dot;

/// GMRES (Saad and Schultz 1986) with restarts; its memory is reused by the next solution.
///
/// With a right preconditioner GMRES minimises the residual of the system itself.
#[derive(Debug, Clone, Default)]
pub struct Gmres {
    /// Orthonormal basis of the Krylov space.
    basis: Vec<Vec<f64>>,
    /// Columns of the Hessenberg matrix, made triangular by rotations.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    rhs: Vec<f64>,
    work: Vec<f64>,
    /// Products of the second orthogonalisation on a team.
    again: Vec<f64>,
}

/// Outcome of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Number of iterations.
    pub iterations: usize,
    /// Norm of the residual over the norm of the right-hand side.
    pub relative_residual: f64,
}

/// Basis vectors before a restart.
const RESTART: usize = 60;

/// Basis vectors that are allocated together.
const IN_RESERVE: usize = 8;

impl Gmres {
    /// Solves `A x = b` from x = 0 until the relative residual is below `tolerance`, or the iterations are used up.
    ///
    /// `system` offers the product with A and the preconditioner, both as `(input, output)`.
    pub fn solve(
        &mut self,
        system: &mut impl LinearSystem,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        max_iterations: usize,
    ) -> Solution {
        x.fill(0.0);
        let b_norm = system.norm(b);
        let mut solution =
            Solution { iterations: 0, relative_residual: if b_norm == 0.0 { 0.0 } else { 1.0 } };
        if b_norm == 0.0 || !b_norm.is_finite() {
            return solution;
        }
        self.work.resize(b.len(), 0.0);
        while solution.iterations < max_iterations {
            self.start(system, b, x, solution.iterations == 0);
            let limit = RESTART.min(max_iterations - solution.iterations);
            let n = self.iterate(system, tolerance * b_norm, limit);
            self.update(system, x, n);
            solution.iterations += n;
            solution.relative_residual = self.rhs[n].abs() / b_norm;
            if n == 0 || solution.relative_residual <= tolerance || solution.relative_residual.is_nan() {
                break;
            }
        }
        solution
    }

    /// First basis vector: the residual, normalised.
    fn start(&mut self, system: &mut impl LinearSystem, b: &[f64], x: &[f64], x_is_zero: bool) {
        let first = vector(&mut self.basis, 0, b.len());
        first.copy_from_slice(b);
        if !x_is_zero {
            system.product(x, &mut self.work);
            first.iter_mut().zip(&self.work).for_each(|(r, y)| *r -= y);
        }
        let size = system.norm(first);
        first.iter_mut().for_each(|r| *r /= size);
        self.rhs.clear();
        self.rhs.push(size);
    }

    /// Builds the basis until the residual is small enough; returns the number of vectors used.
    fn iterate(&mut self, system: &mut impl LinearSystem, target: f64, limit: usize) -> usize {
        for n in 0..limit {
            let next = self.basis.get(n + 1).map_or(0, Vec::len);
            if next == 0 {
                // Several at once: later solutions take a few iterations more.
                let length = self.basis[n].len();
                (n + 1..=(n + IN_RESERVE).min(RESTART)).for_each(|i| _ = vector(&mut self.basis, i, length));
                (n..(n + IN_RESERVE).min(RESTART))
                    .for_each(|i| _ = vector(&mut self.columns, i, RESTART + 1));
            }
            let (known, next) = self.basis.split_at_mut(n + 1);
            let next = &mut next[0];
            system.precondition(&known[n], &mut self.work);
            system.product(&self.work, next);
            let column = vector(&mut self.columns, n, RESTART + 1);
            match system.is_shared() {
                true => orthogonalise_twice(system, known, next, (column, &mut self.again)),
                false => orthogonalise(system, known, next, column),
            }
            self.rotate(n);
            if self.rhs[n + 1].abs() <= target || self.columns[n][n + 1] == 0.0 {
                return n + 1;
            }
        }
        limit
    }

    /// Applies the old rotations to the new column and adds one that clears its last entry.
    fn rotate(&mut self, n: usize) {
        let column = &mut self.columns[n];
        for (i, &(c, s)) in self.rotations[..n.min(self.rotations.len())].iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let size = column[n].hypot(column[n + 1]);
        let (c, s) = if size == 0.0 { (1.0, 0.0) } else { (column[n] / size, column[n + 1] / size) };
        column[n] = size;
        self.rotations.truncate(n);
        self.rotations.push((c, s));
        let last = self.rhs[n];
        self.rhs[n] = c * last;
        self.rhs.truncate(n + 1);
        self.rhs.push(-s * last);
    }

    /// Adds the preconditioned combination of the basis that minimises the residual.
    fn update(&mut self, system: &mut impl LinearSystem, x: &mut [f64], n: usize) {
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| self.columns[j][i] * self.rhs[j]).sum();
            self.rhs[i] = (self.rhs[i] - known) / self.columns[i][i];
        }
        self.work.fill(0.0);
        for (basis, y) in self.basis.iter().zip(&self.rhs[..n]) {
            self.work.iter_mut().zip(basis).for_each(|(w, v)| *w += y * v);
        }
        // The first basis vector is no longer needed.
        system.precondition(&self.work, &mut self.basis[0]);
        x.iter_mut().zip(&self.basis[0]).for_each(|(x, d)| *x += d);
    }
}

/// A linear system, as GMRES uses it.
pub trait LinearSystem {
    /// `y = A x`.
    fn product(&mut self, x: &[f64], y: &mut [f64]);
    /// `y = P^-1 x`, with P near A.
    fn precondition(&mut self, x: &[f64], y: &mut [f64]);
    /// Whether ranks of a team share the vectors, so that scalar products are best asked for together.
    fn is_shared(&self) -> bool {
        false
    }
    /// Scalar products of some vectors with another one, and then of this one with itself if there is a place for it.
    fn products(&self, known: &[Vec<f64>], x: &[f64], products: &mut [f64]) {
        let vectors = known.iter().map(|known| &known[..]).chain([x]);
        products.iter_mut().zip(vectors).for_each(|(product, other)| *product = self.dot(other, x));
    }
    /// Scalar product.
    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        dot(x, y)
    }
    /// Euclidean norm.
    fn norm(&self, x: &[f64]) -> f64 {
        self.dot(x, x).sqrt()
    }
}

/// The vector with an index, created or extended if it is missing.
fn vector(vectors: &mut Vec<Vec<f64>>, index: usize, length: usize) -> &mut Vec<f64> {
    if vectors.len() <= index {
        vectors.resize_with(index + 1, Vec::new);
    }
    vectors[index].resize(length, 0.0);
    &mut vectors[index]
}

/// Modified Gram-Schmidt; the coefficients and the length of the remainder go to the column.
fn orthogonalise(system: &impl LinearSystem, known: &[Vec<f64>], next: &mut [f64], column: &mut [f64]) {
    for (basis, coefficient) in known.iter().zip(column.iter_mut()) {
        *coefficient = system.dot(basis, next);
        next.iter_mut().zip(basis).for_each(|(w, v)| *w -= *coefficient * v);
    }
    let size = system.norm(next);
    column[known.len()] = size;
    if size > 0.0 {
        next.iter_mut().for_each(|w| *w /= size);
    }
}

/// Classical Gram-Schmidt, twice, with one sum over the ranks each (Giraud, Langou, Rozloznik and van den Eshof 2005);
/// results as from [`orthogonalise`].
fn orthogonalise_twice(
    system: &impl LinearSystem,
    known: &[Vec<f64>],
    next: &mut [f64],
    (column, again): (&mut [f64], &mut Vec<f64>),
) {
    let n = known.len();
    let subtract = |next: &mut [f64], products: &[f64]| {
        for (basis, product) in known.iter().zip(products) {
            next.iter_mut().zip(basis).for_each(|(w, v)| *w -= product * v);
        }
    };
    system.products(known, next, &mut column[..n]);
    subtract(next, &column[..n]);
    again.resize(RESTART + 1, 0.0);
    system.products(known, next, &mut again[..n + 1]);
    subtract(next, &again[..n]);
    let mut square = again[n];
    for (coefficient, again) in column.iter_mut().zip(&again[..n]) {
        *coefficient += again;
        square -= again * again;
    }
    // The first pass may have left mere rounding.
    let size = if square > 0.5 * again[n] { square.sqrt() } else { system.norm(next) };
    column[n] = size;
    if size > 0.0 {
        next.iter_mut().for_each(|w| *w /= size);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Convection-diffusion in one dimension, preconditioned by its diagonal.
    #[derive(Default)]
    struct Convection {
        n: usize,
        is_shared: bool,
    }

    impl LinearSystem for Convection {
        fn product(&mut self, x: &[f64], y: &mut [f64]) {
            for i in 0..self.n {
                let left = if i > 0 { x[i - 1] } else { 0.0 };
                let right = x.get(i + 1).copied().unwrap_or(0.0);
                y[i] = 2.5 * x[i] - 1.4 * left - 0.6 * right;
            }
        }
        fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
            y.iter_mut().zip(x).for_each(|(y, x)| *y = x / 2.5);
        }
        fn is_shared(&self) -> bool {
            self.is_shared
        }
    }

    #[test]
    fn non_symmetric_system_is_solved_across_restarts() {
        let n = 400;
        let exact: Vec<f64> = (0..n).map(|i| (0.1 * i as f64).cos()).collect();
        let (mut b, mut x) = (vec![0.0; n], vec![0.0; n]);
        let mut gmres = Gmres::default();
        for is_shared in [false, false, true, true] {
            let mut system = Convection { n, is_shared };
            system.product(&exact, &mut b);
            let solution = gmres.solve(&mut system, &b, &mut x, 1e-12, 500);
            assert!(solution.relative_residual <= 1e-12 && solution.iterations > RESTART);
            assert!(x.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-9));
        }
    }

    #[test]
    fn zero_right_hand_side_costs_nothing() {
        let solution = Gmres::default().solve(
            &mut Convection { n: 5, ..Default::default() },
            &[0.0; 5],
            &mut [1.0; 5],
            1e-10,
            10,
        );
        assert_eq!(solution.iterations, 0);
    }
}
