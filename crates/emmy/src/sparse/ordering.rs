//! Orders and partitions of the rows of a pattern.

use super::Pattern;
use super::metis::Graph;
use crate::error::Result;

/// Nested-dissection ordering of a pattern: `order[new] = old`.
///
/// METIS (Karypis and Kumar 1998) finds separators of the coupling graph of the outer rows; inner rows come before
/// their neighbours. The Cholesky factor of a 3D mesh is then two to three times cheaper than with a minimum-degree
/// ordering.
///
/// # Errors
/// [`crate::Error::Linear`] if METIS runs out of memory or the pattern is too large for its 32-bit indices.
///
/// ```
/// use emmy::internals::sparse::{Pattern, nested_dissection};
/// let pattern = Pattern::new(3, [&[0u32, 1][..], &[1, 2]].into_iter());
/// let mut order = nested_dissection(&pattern)?;
/// order.sort();
/// assert_eq!(order, [0, 1, 2]);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn nested_dissection(pattern: &Pattern) -> Result<Vec<usize>> {
    if pattern.n_blocks() == pattern.n_rows() {
        return Ok((0..pattern.n_rows()).collect());
    }
    let order = Graph::new(pattern)?.dissect()?;
    Ok(pattern.with_inner_rows(order.into_iter().map(|node| node as usize).collect()))
}

/// The part of each row of a pattern without inner rows, below `n_parts`: about equal numbers of couplings in each
/// part, few couplings between parts, and no part without a row if there are as many rows as parts.
///
/// # Errors
/// As [`nested_dissection`].
///
/// ```
/// use emmy::internals::sparse::{Pattern, partition};
/// let chain: Vec<[u32; 2]> = (0..7).map(|row| [row, row + 1]).collect();
/// let pattern = Pattern::new(8, chain.iter().map(|pair| &pair[..]));
/// let parts = partition(&pattern, 2)?;
/// assert!(parts == [0, 0, 0, 0, 1, 1, 1, 1] || parts == [1, 1, 1, 1, 0, 0, 0, 0]);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn partition(pattern: &Pattern, n_parts: usize) -> Result<Vec<u32>> {
    let n = pattern.n_rows();
    let in_turn = || (0..n).map(|row| (row * n_parts / n) as u32).collect();
    let graph = Graph::new(pattern)?;
    if n_parts == 1 || graph.is_empty() {
        return Ok(in_turn());
    }
    let parts: Vec<u32> = graph.partition(n_parts)?.into_iter().map(|part| part as u32).collect();
    let mut is_used = vec![false; n_parts];
    parts.iter().for_each(|&part| is_used[part as usize] = true);
    // METIS may leave out a part of a few rows.
    Ok(if is_used.contains(&false) { in_turn() } else { parts })
}
