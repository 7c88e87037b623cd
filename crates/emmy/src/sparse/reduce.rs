//! Sums over vectors. Every dot product and norm goes through here, in fixed chunks, so that the result depends neither
//! on threads nor on how a vector is divided.

/// Length of a chunk that is summed on its own; sums of chunks keep the rounding error small as well.
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
