//! Nodal vectors: three components for each node, `[n_nodes][3]`.

use std::ops::Range;

/// Degree of freedom of a component at a node.
#[inline(always)]
pub(crate) fn dof(node: usize, component: usize) -> usize {
    3 * node + component
}

/// Degrees of freedom of a node.
#[inline(always)]
pub(crate) fn dofs(node: usize) -> Range<usize> {
    3 * node..3 * node + 3
}

/// The vector at a node.
#[inline(always)]
pub(crate) fn at<T: Copy>(vectors: &[T], node: usize) -> [T; 3] {
    vectors.as_chunks::<3>().0[node]
}

/// The vector at a node, to change it.
#[inline(always)]
pub(crate) fn at_mut<T>(vectors: &mut [T], node: usize) -> &mut [T; 3] {
    &mut vectors.as_chunks_mut::<3>().0[node]
}

/// Adds to the vector at a node.
#[inline(always)]
pub(crate) fn add(vectors: &mut [f64], node: usize, vector: [f64; 3]) {
    let sum = at_mut(vectors, node);
    (0..3).for_each(|d| sum[d] += vector[d]);
}
