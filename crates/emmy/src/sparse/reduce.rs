//! Sums over vectors. All dot products and norms are computed here, in fixed chunks, so that the result depends neither
//! on threads nor on the division of a vector.

/// Length of a chunk; sums over chunks also keep the rounding error small.
const CHUNK: usize = 1024;

/// Dot product.
///
/// ```
/// assert_eq!(emmy::internals::sparse::reduce::dot(&[1.0, 2.0], &[3.0, 4.0]), 11.0);
/// ```
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    let chunks = x.chunks(CHUNK).zip(y.chunks(CHUNK));
    chunks.map(|(x, y)| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>()).sum()
}

/// Euclidean norm.
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
