//! Smallest eigenvalues of a symmetric pencil: of all eigenvalues of a small one, else by block Lanczos iteration with
//! the shifted inverse.

#![allow(non_snake_case)]

use faer::linalg::matmul::matmul;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

use super::reduce::dot;

/// A pencil `K v = lambda M v` of symmetric matrices with M positive definite, and a shift s with `K + s M` positive
/// definite. Vectors are `[columns][n]`.
pub(crate) trait Pencil {
    /// Length n of a vector.
    fn n(&self) -> usize;

    /// Entries of a vector that are free; they span the space, and the others follow from them.
    fn free(&self) -> Vec<usize>;

    /// The shift s.
    fn shift(&self) -> f64;

    /// `M x`, projected onto the space of the vectors.
    fn multiply_mass(&mut self, x: &[f64], product: &mut [f64]);

    /// `K x`, projected onto the space of the vectors.
    fn multiply_stiffness(&mut self, x: &[f64], product: &mut [f64]);

    /// `(K + s M)^-1 b` in place, for at most [`BLOCK`] columns.
    fn solve(&mut self, b: &mut [f64]);
}

/// Number of vectors of a block. Each eigenvalue of at most this multiplicity is found with all its vectors.
pub(crate) const BLOCK: usize = 8;

/// A new direction that is smaller than this, relative to its vector before the projection, is rounding.
const ROUNDING: f64 = 1e-12;

/// Relative change of a confirmed eigenvalue `1/(lambda + s)`.
const CONFIRMED: f64 = 1e-6;

/// Dimension from which on the iteration has room: in a smaller space its blocks soon have no new direction.
const DENSE: usize = 64;

/// Eigenpairs, the smallest eigenvalue first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Eigenmodes {
    /// Eigenvalues lambda.
    pub values: Vec<f64>,
    /// Eigenvectors with `v^T M v = 1`, `[count][n]`.
    pub vectors: Vec<f64>,
    /// Relative residuals `|r| / sqrt(|lambda| + s)`, with `r = K v - lambda M v` in the norm of `(K + s M)^-1`, in
    /// which the rounding of high frequencies does not drown the others: some eigenvalue is as near,
    /// `|lambda_i - lambda|` relative to `sqrt((lambda_i + s) (|lambda| + s))`.
    pub residuals: Vec<f64>,
    /// Whether no smaller eigenvalue can be missing: the iteration did not end for want of vectors.
    pub is_complete: bool,
}

impl Eigenmodes {
    /// Largest residual; infinite if an eigenpair is missing, or not a number.
    pub(crate) fn largest_residual(&self, count: usize) -> f64 {
        let is_whole =
            self.residuals.len() == count && !self.residuals.iter().any(|residual| residual.is_nan());
        if is_whole { self.residuals.iter().copied().fold(0.0, f64::max) } else { f64::INFINITY }
    }
}

/// The `count` smallest eigenvalues of a pencil with their vectors. The caller judges the residuals.
///
/// All eigenvalues of a small pencil are computed, and of one of which at least half are wanted: the basis of an
/// iteration would fill the space, where new directions are rounding. Otherwise a block Lanczos iteration is used. A
/// last step of inverse iteration removes the remaining high frequencies.
pub(crate) fn smallest(
    pencil: &mut impl Pencil,
    count: usize,
    tolerance: f64,
    max_vectors: usize,
) -> Eigenmodes {
    let free = pencil.free();
    let iterated = match free.len() < DENSE.max(2 * count) {
        true => None,
        false => iterated(pencil, free.len(), (count, tolerance), max_vectors),
    };
    let (vectors, is_complete) = iterated.unwrap_or_else(|| (dense(pencil, &free, count), true));
    Eigenmodes { is_complete, ..refined(pencil, vectors) }
}

/// The vectors of the `count` largest eigenvalues of `(K + s M)^-1 M` among all.
///
/// With `G` the free part of `(K + s M)^-1` and `M = L L^T`, `L^T G L y = y/(lambda + s)` and `v = L^-T y`.
fn dense(pencil: &mut impl Pencil, free: &[usize], count: usize) -> Vec<f64> {
    let (n, m) = (pencil.n(), free.len());
    let (mut mass, mut inverse) = (Mat::<f64>::zeros(m, m), Mat::<f64>::zeros(m, m));
    for first in (0..m).step_by(BLOCK) {
        let columns = first..m.min(first + BLOCK);
        let mut block = vec![0.0; columns.len() * n];
        block.chunks_exact_mut(n).zip(&free[columns.clone()]).for_each(|(x, &dof)| x[dof] = 1.0);
        let mut product = vec![0.0; block.len()];
        pencil.multiply_mass(&block, &mut product);
        pencil.solve(&mut block);
        for ((column, x), product) in columns.zip(block.chunks_exact(n)).zip(product.chunks_exact(n)) {
            for (row, &dof) in free.iter().enumerate() {
                mass[(row, column)] = product[dof];
                inverse[(row, column)] = x[dof];
            }
        }
    }
    let Ok(factor) = mass.llt(Side::Lower) else { return Vec::new() };
    let L = factor.L();
    let product = L.transpose() * &inverse * L;
    let (_, y) = eigen(&Mat::from_fn(m, m, |i, j| 0.5 * (product[(i, j)] + product[(j, i)])));
    let largest = Mat::from_fn(m, count, |i, c| y[(i, m - 1 - c)]);
    let mut vectors = vec![0.0; count * n];
    let momenta = L * &largest;
    for (column, vector) in vectors.chunks_exact_mut(n).enumerate() {
        free.iter().enumerate().for_each(|(row, &dof)| vector[dof] = momenta[(row, column)]);
    }
    vectors.chunks_mut(BLOCK * n).for_each(|block| pencil.solve(block));
    vectors
}

/// The vectors of the `count` smallest eigenvalues by a block Lanczos iteration, and whether it ended in time; `None`
/// if its basis would fill the space.
///
/// The iteration is one with `(K + s M)^-1 M`, whose largest eigenvalues 1/(lambda + s) belong to the smallest lambda,
/// in the inner product of M with full orthogonalisation (Grimes, Lewis and Simon 1994). It ends when the residuals of
/// all Ritz vectors are below `tolerance`, and a block of new random vectors has not changed the Ritz values. This also
/// finds eigenvalues of a multiplicity above the block size. The basis has at most `max_vectors` vectors.
///
/// faer's matrix-free solver iterates with single vectors, and misses repeated eigenvalues: it found four of seven
/// equal ones among 3000, another one twice, and with other settings it did not end.
fn iterated(
    pencil: &mut impl Pencil,
    dimension: usize,
    (count, tolerance): (usize, f64),
    max_vectors: usize,
) -> Option<(Vec<f64>, bool)> {
    let mut basis = Basis::new(pencil.n());
    let mut confirmed: Option<(usize, Vec<f64>)> = None;
    let mut next_test = count;
    loop {
        // A block that has no room in the space has directions of rounding alone.
        if basis.len() + BLOCK > dimension {
            return None;
        }
        if basis.n_images() == basis.len() {
            basis.extend(pencil);
            // Beside very many low modes, all other directions are rounding.
            if basis.n_images() == basis.len() {
                let ritz = basis.ritz(count);
                let is_found = ritz.residuals.iter().all(|residual| *residual <= tolerance);
                return Some((ritz.vectors, is_found && basis.len() >= count));
            }
        }
        basis.step(pencil);
        let done = basis.n_images();
        if done >= max_vectors {
            return Some((basis.ritz(count).vectors, false));
        }
        if done < next_test {
            continue;
        }
        // The cost of all tests stays below that of a few.
        next_test = done + done / 10;
        let ritz = basis.ritz(count);
        if !ritz.residuals.iter().all(|residual| *residual <= tolerance) {
            continue;
        }
        let is_same = |before: &[f64]| {
            let mut pairs = before.iter().zip(&ritz.values);
            pairs.all(|(before, now)| (now - before).abs() <= CONFIRMED * now)
        };
        match &confirmed {
            Some((at, _)) if done < *at => continue,
            Some((_, values)) if is_same(values) => return Some((ritz.vectors, true)),
            _ => next_test = done,
        }
        basis.extend(pencil);
        confirmed = Some((basis.len(), ritz.values));
    }
}

/// Ritz values and vectors of the operator `(K + s M)^-1 M`, the largest value first.
struct Ritz {
    values: Vec<f64>,
    vectors: Vec<f64>,
    /// Relative residuals in the norm of M.
    residuals: Vec<f64>,
}

/// Vectors that are orthonormal in the inner product of M, with the images of the first ones.
struct Basis {
    n: usize,
    vectors: Vec<f64>,
    /// M times the vectors.
    products: Vec<f64>,
    /// Coefficients of the images of the first vectors on all vectors; missing ones are zero.
    images: Vec<Vec<f64>>,
    random: u64,
}

impl Basis {
    fn new(n: usize) -> Self {
        Basis { n, vectors: Vec::new(), products: Vec::new(), images: Vec::new(), random: 0 }
    }

    fn len(&self) -> usize {
        self.vectors.len() / self.n
    }

    fn n_images(&self) -> usize {
        self.images.len()
    }

    /// Adds a block of random vectors, smoothed by the operator.
    fn extend(&mut self, pencil: &mut impl Pencil) {
        let mut block: Vec<f64> = (0..BLOCK * self.n).map(|_| uniform(&mut self.random)).collect();
        let mut product = vec![0.0; block.len()];
        for _ in 0..2 {
            pencil.multiply_mass(&block, &mut product);
            pencil.solve(&mut product);
            std::mem::swap(&mut block, &mut product);
        }
        self.add(pencil, block);
    }

    /// Applies the operator to the next block, and adds the new directions of its images.
    fn step(&mut self, pencil: &mut impl Pencil) {
        let first = self.n_images();
        let end = self.len().min(first + BLOCK);
        let mut block = self.products[first * self.n..end * self.n].to_vec();
        pencil.solve(&mut block);
        let images = self.add(pencil, block);
        self.images.extend(images);
    }

    /// Adds the new directions of a block; returns the coefficients of its vectors on the basis.
    fn add(&mut self, pencil: &mut impl Pencil, mut block: Vec<f64>) -> Vec<Vec<f64>> {
        let mut coefficients = self.project(&mut block);
        let sizes: Vec<f64> = coefficients.iter().map(|c| dot(c, c)).collect();
        let (mut block, _, inner) = orthonormal(pencil, self.n, block, &sizes);
        coefficients.iter_mut().zip(inner).for_each(|(all, inner)| all.extend(inner));
        // A second projection removes the rounding of the first.
        self.project(&mut block);
        let (block, products, _) = orthonormal(pencil, self.n, block, &[]);
        self.vectors.extend(block);
        self.products.extend(products);
        coefficients
    }

    /// Removes the components in the basis from a block; returns them.
    fn project(&self, block: &mut [f64]) -> Vec<Vec<f64>> {
        let (n, m) = (self.n, self.len());
        let p = block.len() / n;
        let vectors = MatRef::from_column_major_slice(&self.vectors, n, m);
        let products = MatRef::from_column_major_slice(&self.products, n, m);
        let mut block = MatMut::from_column_major_slice_mut(block, n, p);
        let mut coefficients = Mat::<f64>::zeros(m, p);
        matmul(coefficients.as_mut(), Accum::Replace, products.transpose(), block.rb(), 1.0, Par::Seq);
        matmul(block.rb_mut(), Accum::Add, vectors, coefficients.as_ref(), -1.0, Par::Seq);
        (0..p).map(|c| (0..m).map(|i| coefficients[(i, c)]).collect()).collect()
    }

    /// The largest Ritz values of the vectors that have images.
    fn ritz(&self, count: usize) -> Ritz {
        let m = self.n_images();
        let image = |i: usize, j: usize| self.images[j].get(i).copied().unwrap_or(0.0);
        let projected = Mat::from_fn(m, m, |i, j| 0.5 * (image(i, j) + image(j, i)));
        let (values, coefficients) = eigen(&projected);
        let count = count.min(m);
        let chosen: Vec<usize> = (0..count).map(|i| m - 1 - i).collect();
        let residual = |&column: &usize| {
            let rest = (m..self.len()).map(|row| {
                let terms = (0..m).map(|j| image(row, j) * coefficients[(j, column)]);
                terms.sum::<f64>().powi(2)
            });
            rest.sum::<f64>().sqrt() / values[column].abs()
        };
        let residuals = chosen.iter().map(residual).collect();
        let coefficients = Mat::from_fn(m, count, |i, c| coefficients[(i, chosen[c])]);
        Ritz {
            values: chosen.iter().map(|&column| values[column]).collect(),
            vectors: combined(&self.vectors[..m * self.n], self.n, &coefficients),
            residuals,
        }
    }
}

/// Makes the vectors of a block orthonormal; those of no more than rounding are left out. Returned with their products
/// with M, and the coefficients of the original vectors on them. `sizes`: squares of what was removed from the vectors
/// before.
fn orthonormal(
    pencil: &mut impl Pencil,
    n: usize,
    mut block: Vec<f64>,
    sizes: &[f64],
) -> (Vec<f64>, Vec<f64>, Vec<Vec<f64>>) {
    let mut vectors: Vec<f64> = Vec::with_capacity(block.len());
    let mut products: Vec<f64> = Vec::with_capacity(block.len());
    let mut coefficients = Vec::new();
    let mut product = vec![0.0; n];
    for (index, x) in block.chunks_exact_mut(n).enumerate() {
        let mut own = Vec::new();
        for (vector, product) in vectors.chunks_exact(n).zip(products.chunks_exact(n)) {
            let c = dot(product, x);
            x.iter_mut().zip(vector).for_each(|(x, v)| *x -= c * v);
            own.push(c);
        }
        pencil.multiply_mass(x, &mut product);
        let square = dot(x, &product);
        let removed = sizes.get(index).map_or(0.0, |size| size + dot(&own, &own));
        if square > ROUNDING * ROUNDING * removed {
            let size = square.sqrt();
            vectors.extend(x.iter().map(|x| x / size));
            products.extend(product.iter().map(|x| x / size));
            own.push(size);
        }
        coefficients.push(own);
    }
    (vectors, products, coefficients)
}

/// A step of inverse iteration, and the eigenpairs of the pencil in the space of the result.
fn refined(pencil: &mut impl Pencil, mut vectors: Vec<f64>) -> Eigenmodes {
    let n = pencil.n();
    let mut product = vec![0.0; vectors.len()];
    pencil.multiply_mass(&vectors, &mut product);
    product.chunks_mut(BLOCK * n).for_each(|block| pencil.solve(block));
    for _ in 0..2 {
        (product, vectors, _) = orthonormal(pencil, n, product, &[]);
    }
    let count = product.len() / n;
    pencil.multiply_stiffness(&product, &mut vectors);
    let stiff = |i: usize, j: usize| dot(&product[i * n..(i + 1) * n], &vectors[j * n..(j + 1) * n]);
    let projected = Mat::from_fn(count, count, |i, j| stiff(i.max(j), i.min(j)));
    let (values, coefficients) = eigen(&projected);
    let vectors = combined(&product, n, &coefficients);
    let residuals = residuals(pencil, &values, &vectors);
    Eigenmodes { values, vectors, residuals, is_complete: true }
}

/// Relative residuals of eigenpairs.
fn residuals(pencil: &mut impl Pencil, values: &[f64], vectors: &[f64]) -> Vec<f64> {
    let n = pencil.n();
    let shift = pencil.shift();
    let mut residuals = Vec::with_capacity(values.len());
    for (vectors, values) in vectors.chunks(BLOCK * n).zip(values.chunks(BLOCK)) {
        let (mut rest, mut mass) = (vec![0.0; vectors.len()], vec![0.0; vectors.len()]);
        pencil.multiply_stiffness(vectors, &mut rest);
        pencil.multiply_mass(vectors, &mut mass);
        for ((rest, mass), value) in rest.chunks_exact_mut(n).zip(mass.chunks_exact(n)).zip(values) {
            rest.iter_mut().zip(mass).for_each(|(rest, mass)| *rest -= value * mass);
        }
        let mut solution = rest.clone();
        pencil.solve(&mut solution);
        for ((rest, solution), value) in rest.chunks_exact(n).zip(solution.chunks_exact(n)).zip(values) {
            residuals.push((dot(rest, solution).abs() / (value.abs() + shift)).sqrt());
        }
    }
    residuals
}

/// Linear combinations of vectors, one for each column of the coefficients.
fn combined(vectors: &[f64], n: usize, coefficients: &Mat<f64>) -> Vec<f64> {
    let vectors = MatRef::from_column_major_slice(vectors, n, coefficients.nrows());
    let mut sums = vec![0.0; n * coefficients.ncols()];
    let target = MatMut::from_column_major_slice_mut(&mut sums, n, coefficients.ncols());
    matmul(target, Accum::Replace, vectors, coefficients.as_ref(), 1.0, Par::Seq);
    sums
}

/// Eigenvalues, ascending, and eigenvectors of a small symmetric matrix; NaN if it is not finite.
fn eigen(matrix: &Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    let n = matrix.nrows();
    match matrix.self_adjoint_eigen(Side::Lower) {
        Ok(eigen) => ((0..n).map(|i| eigen.S()[i]).collect(), eigen.U().to_owned()),
        Err(_) => (vec![f64::NAN; n], Mat::zeros(n, n)),
    }
}

/// The next number of a sequence in `[-1, 1)` (Steele, Lea and Flood 2014, SplitMix64).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Diagonal K and M.
    struct Diagonal {
        stiffness: Vec<f64>,
        mass: Vec<f64>,
        shift: f64,
    }

    impl Pencil for Diagonal {
        fn n(&self) -> usize {
            self.mass.len()
        }

        fn free(&self) -> Vec<usize> {
            (0..self.mass.len()).collect()
        }

        fn shift(&self) -> f64 {
            self.shift
        }

        fn multiply_mass(&mut self, x: &[f64], product: &mut [f64]) {
            let mass = self.mass.iter().cycle();
            product.iter_mut().zip(x).zip(mass).for_each(|((product, x), m)| *product = m * x);
        }

        fn multiply_stiffness(&mut self, x: &[f64], product: &mut [f64]) {
            let stiffness = self.stiffness.iter().cycle();
            product.iter_mut().zip(x).zip(stiffness).for_each(|((product, x), k)| *product = k * x);
        }

        fn solve(&mut self, b: &mut [f64]) {
            let diagonal = self.stiffness.iter().zip(&self.mass).map(|(k, m)| k + self.shift * m);
            let diagonal: Vec<f64> = diagonal.collect();
            b.iter_mut().zip(diagonal.iter().cycle()).for_each(|(b, d)| *b /= d);
        }
    }

    /// K = lambda M with given eigenvalues, shuffled, and some masses.
    fn pencil(values: impl Fn(usize) -> f64, n: usize, shift: f64) -> Diagonal {
        let mass: Vec<f64> = (0..n).map(|i| 1.0 + 0.5 * (i as f64).sin()).collect();
        let stiffness = mass.iter().enumerate().map(|(i, m)| m * values(11 * i % n)).collect();
        Diagonal { stiffness, mass, shift }
    }

    #[test]
    fn eigenvalues_of_any_multiplicity_are_found() {
        // Twenty zeros, seven of 1, then 2, 3, ...: more of a kind than a block has vectors.
        let values = |i: usize| if i < 20 { 0.0 } else { (i.max(26) - 25) as f64 };
        for shift in [1e-4, 1.0, 10.0] {
            let found = smallest(&mut pencil(values, 1000, shift), 40, 1e-9, 900);
            assert!(found.is_complete);
            for (i, value) in found.values.iter().enumerate() {
                assert!((value - values(i)).abs() < 1e-9 * shift.max(1.0), "{shift}: {:?}", found.values);
            }
            assert!(found.residuals.iter().all(|residual| *residual < 1e-9), "{:?}", found.residuals);
        }
    }

    #[test]
    fn all_eigenvalues_of_a_small_pencil_are_exact() {
        for n in [1, 2, 7, 8, 9, 30] {
            let found = smallest(&mut pencil(|i| i as f64 - 1.0, n, 2.0), n, 1e-9, 500);
            assert!(found.is_complete && found.values.len() == n);
            let error = |(i, value): (usize, &f64)| (value - (i as f64 - 1.0)).abs();
            assert!(
                found.values.iter().enumerate().map(error).all(|error| error < 1e-11),
                "{:?}",
                found.values
            );
        }
    }
}
