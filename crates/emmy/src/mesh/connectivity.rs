//! Connectivity of the cells of a mesh: parts, repeated cells, coincident nodes.

use std::collections::{BTreeMap, HashMap};

use super::{Mesh, distance};
use crate::error::{Error, Result};

impl Mesh {
    /// Cells of each connected part, ascending, the part of the first cell first. Cells with a common node are
    /// connected.
    ///
    /// ```
    /// let mesh = emmy::mesh::block([1.0; 3], [2, 2, 2])?;
    /// assert_eq!(mesh.parts().len(), 1);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn parts(&self) -> Vec<Vec<u32>> {
        let roots = roots(self.n_nodes(), self.cells().map(|cell| cell.nodes));
        let mut part_of_root = HashMap::new();
        let mut parts = Vec::<Vec<u32>>::new();
        for (index, cell) in self.cells().enumerate() {
            let part = *part_of_root.entry(roots[cell.nodes[0] as usize]).or_insert(parts.len());
            if part == parts.len() {
                parts.push(Vec::new());
            }
            parts[part].push(index as u32);
        }
        parts
    }

    /// Cells with the nodes of an earlier cell, in any order: `[earlier, later]`, by the later one ascending.
    ///
    /// ```
    /// let mesh = emmy::mesh::block([1.0; 3], [2, 1, 1])?;
    /// assert!(mesh.repeated_cells().is_empty());
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn repeated_cells(&self) -> Vec<[u32; 2]> {
        let mut first_of: HashMap<Vec<u32>, u32> = HashMap::with_capacity(self.n_cells());
        let mut repeated = Vec::new();
        for (index, cell) in self.cells().enumerate() {
            let mut nodes = cell.nodes.to_vec();
            nodes.sort_unstable();
            let first = *first_of.entry(nodes).or_insert(index as u32);
            if first != index as u32 {
                repeated.push([first, index as u32]);
            }
        }
        repeated
    }

    /// Nodes at the position of an earlier node, up to 1e-9 of the extent of the mesh: `[earlier, later]`, by the later
    /// one ascending. Cells on both sides of them touch, but are not connected.
    ///
    /// ```
    /// let mesh = emmy::mesh::block([1.0; 3], [2, 1, 1])?;
    /// assert!(mesh.coincident_nodes().is_empty());
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn coincident_nodes(&self) -> Vec<[u32; 2]> {
        let tolerance = 1e-9 * self.extent().into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        self.for_each_near(tolerance, &mut |[earlier, later]| match pairs.last_mut() {
            Some(last) if last[1] == later => last[0] = last[0].min(earlier),
            _ => pairs.push([earlier, later]),
        });
        pairs
    }

    /// The mesh in which nodes at most a distance apart are one, the first of them, and the number of nodes that were
    /// joined with others. Groups have the node in the place of each.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let points = [0.0, 1.0, 1.001, 2.0].map(|x| [x, 0.0, 0.0]);
    /// let apart = Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [2, 3]])?.with_node_group("right", [2])?;
    /// let (merged, n) = apart.merged(0.01)?;
    /// assert_eq!((n, merged.n_nodes(), merged.group_nodes("right")?), (1, 3, vec![1]));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotPositive`] unless the distance is positive and finite; [`Error::MergedCell`] if two nodes of a cell
    /// would be one.
    pub fn merged(mut self, within: f64) -> Result<(Mesh, usize)> {
        if !(within > 0.0 && within.is_finite()) {
            return Err(Error::NotPositive { what: "distance of nodes to be merged".into(), value: within });
        }
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        self.for_each_near(within, &mut |pair| {
            let [a, b] = pair.map(|node| self.points[node as usize]);
            if distance(a, b) <= within {
                pairs.push(pair);
            }
        });
        let first_of = roots(self.n_nodes(), pairs.iter().map(<[u32; 2]>::as_slice));
        let is_kept = |node: &usize| first_of[*node] as usize == *node;
        let mut number = vec![0; self.n_nodes()];
        (0..self.n_nodes()).filter(is_kept).enumerate().for_each(|(new, old)| number[old] = new as u32);
        for (index, cell) in self.cells().enumerate() {
            let mut nodes: Vec<u32> = cell.nodes.iter().map(|&node| first_of[node as usize]).collect();
            nodes.sort_unstable();
            if let Some(pair) = nodes.windows(2).find(|pair| pair[0] == pair[1]) {
                let position = self.points[pair[0] as usize];
                return Err(Error::MergedCell { cell: index, position, within });
            }
        }
        let n_before = self.n_nodes();
        let new = |node: &mut u32| *node = number[first_of[*node as usize] as usize];
        self.connectivity.iter_mut().for_each(new);
        for group in self.groups.nodes.values_mut() {
            group.iter_mut().for_each(new);
            group.sort_unstable();
            group.dedup();
        }
        self.points = (0..n_before).filter(is_kept).map(|node| self.points[node]).collect();
        let n_joined = n_before - self.n_nodes();
        Ok((self, n_joined))
    }

    /// Calls a function with all nodes at most a distance apart along each axis, `[earlier, later]`, by the later one
    /// ascending.
    fn for_each_near(&self, tolerance: f64, visit: &mut dyn FnMut([u32; 2])) {
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() <= tolerance);
        // Boxes much larger than the tolerance, so that a point lies in one of them as a rule, in at most eight.
        let box_of = |x: f64| (x / (64.0 * tolerance)).floor() as i64;
        let mut nodes_in: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(self.n_nodes());
        for (node, &point) in self.points().iter().enumerate() {
            let ends = point.map(|x| [box_of(x - tolerance), box_of(x + tolerance)]);
            let candidates = boxes(ends).filter_map(|key| nodes_in.get(&key)).flatten();
            let earlier = candidates.filter(|&&other| near(self.points()[other as usize], point));
            earlier.for_each(|&earlier| visit([earlier, node as u32]));
            nodes_in.entry(point.map(box_of)).or_default().push(node as u32);
        }
    }

    /// Edge lengths of the smallest box along the axes around the nodes \[length\].
    pub fn extent(&self) -> [f64; 3] {
        let [low, high] = self.bounds();
        [0, 1, 2].map(|i| high[i] - low[i])
    }

    /// Diagonal of the smallest box along the axes around the nodes \[length\].
    ///
    /// ```
    /// assert_eq!(emmy::mesh::block([2.0, 3.0, 6.0], [1; 3])?.diagonal(), 7.0);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn diagonal(&self) -> f64 {
        self.extent().iter().map(|length| length * length).sum::<f64>().sqrt()
    }

    /// Number of cells of each kind, in the order of [`super::CellKind::ALL`].
    ///
    /// ```
    /// use emmy::mesh::{CellKind, block};
    /// assert_eq!(block([1.0; 3], [2, 1, 1])?.counts_by_kind(), [(CellKind::Hex8, 2)]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn counts_by_kind(&self) -> Vec<(super::CellKind, usize)> {
        let mut counts = BTreeMap::new();
        self.cells().for_each(|cell| *counts.entry(cell.kind).or_default() += 1);
        counts.into_iter().collect()
    }
}

/// The lowest of the nodes with which each of n nodes is connected, given lists of nodes that are.
pub(crate) fn roots<'l>(n: usize, connected: impl Iterator<Item = &'l [u32]>) -> Vec<u32> {
    let mut roots: Vec<u32> = (0..n as u32).collect();
    for list in connected {
        for &node in list {
            let [a, b] = [list[0], node].map(|node| root(&mut roots, node));
            roots[a.max(b) as usize] = a.min(b);
        }
    }
    (0..n as u32).map(|node| root(&mut roots, node)).collect()
}

/// The representative of all nodes connected with one; the path to it is halved on the way.
fn root(roots: &mut [u32], mut node: u32) -> u32 {
    while roots[node as usize] != node {
        roots[node as usize] = roots[roots[node as usize] as usize];
        node = roots[node as usize];
    }
    node
}

/// All boxes between two along each axis.
fn boxes(ends: [[i64; 2]; 3]) -> impl Iterator<Item = [i64; 3]> {
    let [x, y, z] = ends.map(|[first, last]| first..=last);
    x.flat_map(move |i| {
        let z = z.clone();
        y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
    })
}

#[cfg(test)]
mod tests {
    use super::super::{CellKind, MeshBuilder};

    /// Tetrahedra with separate nodes, each moved along x.
    fn tetrahedra(offsets: &[f64]) -> MeshBuilder {
        let mut builder = MeshBuilder::new();
        for x in offsets {
            let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let nodes = points.map(|p| builder.point([p[0] + x, p[1], p[2]]));
            builder.cell(CellKind::Tet4, &nodes).unwrap();
        }
        builder
    }

    #[test]
    fn parts_are_told_apart_by_their_nodes() {
        let mut builder = tetrahedra(&[0.0, 1.0, 5.0]);
        builder.cell(CellKind::Tet4, &[9, 1, 2, 3]).unwrap();
        // The last cell joins the first to the third.
        assert_eq!(builder.build().unwrap().parts(), [vec![0, 2, 3], vec![1]]);
    }

    #[test]
    fn cells_with_the_same_nodes_are_found_in_any_order_of_them() {
        let mut builder = tetrahedra(&[0.0, 2.0]);
        builder.cell(CellKind::Tet4, &[5, 6, 4, 7]).unwrap();
        assert_eq!(builder.build().unwrap().repeated_cells(), [[1, 2]]);
    }

    #[test]
    fn nodes_at_one_place_are_found_up_to_rounding() {
        // (1, 0, 0) of the first is the origin of the second; the third is off by more than rounding.
        let mesh = tetrahedra(&[0.0, 1.0 + 1e-12, 2.0 + 1e-6]).build().unwrap();
        assert_eq!(mesh.coincident_nodes(), [[1, 4]]);
        assert_eq!(tetrahedra(&[0.0, 0.0]).build().unwrap().coincident_nodes().len(), 4);
    }

    #[test]
    fn near_nodes_are_one_over_any_number_of_them() {
        // The fourth tetrahedron lies between the first and the third, which are too far apart.
        let mesh = tetrahedra(&[0.0, 3.0, 0.018, 0.009]).build().unwrap();
        let (merged, n) = mesh.clone().merged(0.01).unwrap();
        assert_eq!((n, merged.n_nodes(), merged.n_cells()), (8, 8, 4));
        assert_eq!(merged.cell(2).nodes, merged.cell(0).nodes);
        assert_eq!(merged.points()[..4], mesh.points()[..4]);
        assert_eq!(mesh.clone().merged(0.005).unwrap(), (mesh.clone(), 0));
        let error = mesh.merged(1.1).unwrap_err().to_string();
        assert!(error.contains("cell 0 has two nodes within 1.1 of each other"), "{error}");
    }
}
