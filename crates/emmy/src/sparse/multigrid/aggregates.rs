//! Aggregates of neighbouring nodes.

use super::super::Pattern;

/// Disjoint sets of nodes that cover a pattern; each becomes a node of the next level.
#[derive(Debug)]
pub(super) struct Aggregates {
    /// Aggregate of each node.
    pub of_node: Vec<u32>,
    /// Start of the nodes of each aggregate, `[n_aggregates + 1]`.
    pub begin: Vec<usize>,
    /// Nodes by aggregates, ascending in each.
    pub nodes: Vec<u32>,
    /// Place of each node in `nodes`.
    pub place: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Aggregates {
    /// Aggregates of a pattern (Vanek, Mandel and Brezina 1996): a node whose neighbours are all free takes them; what
    /// is left joins the aggregate with most of its neighbours, or is an aggregate of its own.
    pub(super) fn new(pattern: &Pattern) -> Self {
        let n = pattern.n_rows();
        let mut of_node = vec![NONE; n];
        let mut count = 0;
        for node in 0..n {
            let row = pattern.row(node);
            if row.len() > 1 && row.iter().all(|&other| of_node[other as usize] == NONE) {
                row.iter().for_each(|&other| of_node[other as usize] = count);
                count += 1;
            }
        }
        let first = of_node.clone();
        let mut votes: Vec<(u32, u32)> = Vec::new();
        for node in (0..n).filter(|&node| first[node] == NONE) {
            votes.clear();
            for &other in pattern.row(node) {
                let aggregate = first[other as usize];
                match votes.iter_mut().find(|(voted, _)| *voted == aggregate) {
                    Some((_, n_votes)) => *n_votes += 1,
                    None if aggregate != NONE => votes.push((aggregate, 1)),
                    None => {}
                }
            }
            let most =
                votes.iter().max_by_key(|(aggregate, n_votes)| (*n_votes, std::cmp::Reverse(*aggregate)));
            if let Some((aggregate, _)) = most {
                of_node[node] = *aggregate;
            }
        }
        for node in 0..n {
            if of_node[node] == NONE {
                for &other in pattern.row(node) {
                    if of_node[other as usize] == NONE {
                        of_node[other as usize] = count;
                    }
                }
                count += 1;
            }
        }
        Aggregates::by_node(of_node, count as usize)
    }

    fn by_node(of_node: Vec<u32>, count: usize) -> Self {
        let mut begin = vec![0; count + 1];
        of_node.iter().for_each(|&aggregate| begin[aggregate as usize + 1] += 1);
        (0..count).for_each(|aggregate| begin[aggregate + 1] += begin[aggregate]);
        let mut next = begin.clone();
        let mut nodes = vec![0; of_node.len()];
        let mut place = vec![0; of_node.len()];
        for (node, &aggregate) in of_node.iter().enumerate() {
            let at = &mut next[aggregate as usize];
            (nodes[*at], place[node]) = (node as u32, *at as u32);
            *at += 1;
        }
        Aggregates { of_node, begin, nodes, place }
    }

    /// Number of aggregates.
    pub(super) fn len(&self) -> usize {
        self.begin.len() - 1
    }

    /// Nodes of an aggregate.
    pub(super) fn nodes(&self, aggregate: usize) -> &[u32] {
        &self.nodes[self.begin[aggregate]..self.begin[aggregate + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::sweep::tests::grid;
    use super::*;

    #[test]
    fn aggregates_cover_every_node_once_and_coarsen_a_grid_by_twenty() {
        let pattern = grid([12, 9, 15]);
        let aggregates = Aggregates::new(&pattern);
        let mut nodes = aggregates.nodes.clone();
        nodes.sort_unstable();
        assert!(nodes.iter().enumerate().all(|(index, &node)| index == node as usize));
        let ratio = pattern.n_rows() as f64 / aggregates.len() as f64;
        assert!((20.0..=30.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn nodes_without_neighbours_are_aggregates() {
        let pattern = Pattern::new(4, [[0u32, 1]].iter().map(|list| &list[..]));
        let aggregates = Aggregates::new(&pattern);
        assert_eq!((aggregates.len(), &aggregates.of_node[..]), (3, &[0, 0, 1, 2][..]));
    }
}
