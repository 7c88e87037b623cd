//! Lines on the edges of cells.

use std::collections::HashMap;

use super::MeshBuilder;

impl MeshBuilder {
    /// For each line, by the nodes at its ends, whether it is an edge of a plane or solid cell. One that is none may be
    /// a beam.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let mut builder = MeshBuilder::new();
    /// for point in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] {
    ///     builder.point(point);
    /// }
    /// builder.cell(CellKind::Quad4, &[0, 1, 2, 3])?;
    /// assert_eq!(builder.are_edges(&[[3, 0], [0, 2]]), [true, false]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn are_edges(&self, lines: &[[u32; 2]]) -> Vec<bool> {
        if lines.is_empty() {
            return Vec::new();
        }
        let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let mut found: HashMap<[u32; 2], bool> = lines.iter().map(|&line| (sorted(line), false)).collect();
        // Most cells of a large mesh are away from the lines: they need no look-up.
        let mut is_end = vec![false; self.points.len()];
        for &node in lines.as_flattened() {
            is_end.get_mut(node as usize).into_iter().for_each(|is_end| *is_end = true);
        }
        for (cell, kind) in self.kinds.iter().enumerate().filter(|(_, kind)| kind.dimension() > 1) {
            let nodes = self.nodes_of(cell);
            let is_end = |local: usize| is_end.get(nodes[local] as usize).is_some_and(|is_end| *is_end);
            if (0..kind.n_corners()).filter(|&local| is_end(local)).count() < 2 {
                continue;
            }
            for facet in kind.facets() {
                let corners = &facet.nodes[..facet.kind.n_corners()];
                for (i, &corner) in corners.iter().enumerate() {
                    let next = corners[(i + 1) % corners.len()];
                    found.entry(sorted([nodes[corner], nodes[next]])).and_modify(|is_edge| *is_edge = true);
                }
            }
        }
        lines.iter().map(|&line| found[&sorted(line)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellKind;

    #[test]
    fn the_edges_of_every_kind_are_those_of_its_corners() {
        // Euler: corners - edges + faces = 2 of a solid; a plane cell has as many edges as corners.
        for kind in CellKind::SOLIDS.into_iter().chain(CellKind::PLANES) {
            let mut builder = MeshBuilder::new();
            let nodes: Vec<u32> = (0..kind.n_nodes()).map(|_| builder.point([0.0; 3])).collect();
            builder.cell(kind, &nodes).unwrap();
            let lines: Vec<[u32; 2]> = nodes.iter().flat_map(|&a| (0..a).map(move |b| [a, b])).collect();
            let n_edges = builder.are_edges(&lines).into_iter().filter(|is_edge| *is_edge).count();
            let n_corners = kind.n_corners();
            let expected =
                if kind.dimension() == 3 { n_corners + kind.facets().len() - 2 } else { n_corners };
            assert_eq!(n_edges, expected, "{kind}");
            assert_eq!(builder.are_edges(&[[0, 99]]), [false]);
        }
    }
}
