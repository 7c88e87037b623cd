//! Rigid modes: translations apart from rotations.

use crate::sparse::reduce::dot;

/// A combination of modes of no more than this, relative to what was removed from it, is rounding.
const ROUNDING: f64 = 1e-6;

/// Replaces orthonormal rigid modes `[count][n_nodes][3]` by others that span the same space: first the parts of the
/// translations along x, y and z in it, then the rest. `translations`: M times the unit translations.
pub(super) fn separate(modes: &mut [f64], translations: &[Vec<f64>; 3]) {
    let n = translations[0].len();
    let count = modes.len() / n;
    let along = translations.iter().map(|translation| -> Vec<f64> {
        modes.chunks_exact(n).map(|mode| dot(mode, translation)).collect()
    });
    let own = (0..count).map(|i| (0..count).map(|j| if i == j { 1.0 } else { 0.0 }).collect());
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut candidate in along.chain(own) {
        let size = dot(&candidate, &candidate).sqrt();
        // Twice, so that the rest of a small remainder is orthogonal too.
        for other in basis.iter().chain(&basis) {
            let c = dot(other, &candidate);
            candidate.iter_mut().zip(other).for_each(|(x, other)| *x -= c * other);
        }
        let rest = dot(&candidate, &candidate).sqrt();
        if rest > ROUNDING * size {
            candidate.iter_mut().for_each(|x| *x /= rest);
            basis.push(candidate);
        }
    }
    let combined: Vec<f64> =
        basis.iter().flat_map(|coefficients| combination(modes, n, coefficients)).collect();
    modes.copy_from_slice(&combined);
}

fn combination(modes: &[f64], n: usize, coefficients: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for (mode, c) in modes.chunks_exact(n).zip(coefficients) {
        sum.iter_mut().zip(mode).for_each(|(sum, x)| *sum += c * x);
    }
    sum
}
