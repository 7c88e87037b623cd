//! The components of a body between its joints.

use std::ops::Range;

use crate::mesh::roots;
use crate::tensor::Mat3;

/// Nodes that cells, ties or a rigid body connect. Joints do not: a component moves nearly like a rigid body, whatever
/// the others do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Component {
    /// Its nodes in ascending ranges.
    ranges: Vec<Range<usize>>,
}

impl Component {
    /// The components of n nodes, given lists of nodes that are connected, in the order of their first nodes.
    pub(crate) fn all<'l>(n: usize, connected: impl Iterator<Item = &'l [u32]>) -> Vec<Component> {
        let mut components: Vec<Component> = Vec::new();
        let mut numbers = vec![0; n];
        for (node, root) in roots(n, connected).into_iter().enumerate() {
            let root = root as usize;
            if root == node {
                numbers[node] = components.len();
                components.push(Component { ranges: Vec::new() });
            }
            extend(&mut components[numbers[root]].ranges, node);
        }
        components
    }

    /// A component of all of n nodes.
    pub(crate) fn whole(n: usize) -> Component {
        Component { ranges: std::iter::once(0..n).collect() }
    }

    /// The same with some of its nodes.
    pub(crate) fn retained(&self, retains: impl Fn(usize) -> bool) -> Component {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for node in self.nodes().filter(|&node| retains(node)) {
            extend(&mut ranges, node);
        }
        Component { ranges }
    }

    /// Its nodes, ascending.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        self.ranges.iter().cloned().flatten()
    }

    /// Ranges of its degrees of freedom.
    pub(crate) fn dofs(&self) -> Vec<Range<usize>> {
        self.ranges.iter().map(|range| 3 * range.start..3 * range.end).collect()
    }

    /// Mean of a vector over its nodes.
    pub(crate) fn mean(&self, vector: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for node in self.nodes() {
            let own = vector(node);
            (0..3).for_each(|d| sum[d] += own[d]);
        }
        let n: usize = self.ranges.iter().map(Range::len).sum();
        sum.map(|sum| sum / n as f64)
    }

    /// Sum of the products `a b^T` of two vectors over its nodes.
    pub(crate) fn products(&self, vectors: impl Fn(usize) -> [[f64; 3]; 2]) -> Mat3<f64> {
        let mut sum = [[0.0; 3]; 3];
        for node in self.nodes() {
            let [a, b] = vectors(node);
            (0..3).for_each(|d| (0..3).for_each(|e| sum[d][e] += a[d] * b[e]));
        }
        sum
    }
}

/// Adds a node after those of some ranges.
fn extend(ranges: &mut Vec<Range<usize>>, node: usize) {
    match ranges.last_mut() {
        Some(last) if last.end == node => last.end += 1,
        _ => ranges.push(node..node + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_connected_nodes() {
        let lists: [&[u32]; 4] = [&[3, 4], &[0, 2], &[5, 6], &[6, 3]];
        let components = Component::all(8, lists.into_iter());
        let nodes: Vec<Vec<usize>> = components.iter().map(|component| component.nodes().collect()).collect();
        assert_eq!(nodes, [vec![0, 2], vec![1], vec![3, 4, 5, 6], vec![7]]);
        let last = components[2].mean(|node| [node as f64, 0.0, 1.0]);
        assert_eq!(last, [4.5, 0.0, 1.0]);
    }
}
