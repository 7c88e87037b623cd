//! Cells whose nodes are numbered the other way round.

use std::collections::{BTreeMap, HashMap};

use super::MeshBuilder;
use crate::element::element;
use crate::mesh::CellKind;
use crate::mesh::quality::samples;

/// The mirrored order of a kind of cell: its reference cell with the first two coordinates exchanged.
struct Mirror {
    /// Place of each node in the other order.
    nodes: Vec<usize>,
    /// Place of each facet.
    facets: Vec<u8>,
}

impl Mirror {
    fn of(kind: CellKind) -> Self {
        let points = element(kind).nodes();
        let place = |&[x, y, z]: &[f64; 3]| points.iter().position(|point| *point == [y, x, z]);
        let nodes: Vec<usize> = points.iter().filter_map(place).collect();
        debug_assert_eq!(nodes.len(), points.len(), "{kind}");
        let sorted = |nodes: &mut dyn Iterator<Item = usize>| {
            let mut nodes: Vec<usize> = nodes.collect();
            nodes.sort_unstable();
            nodes
        };
        let own: Vec<Vec<usize>> =
            kind.facets().iter().map(|facet| sorted(&mut facet.nodes.iter().copied())).collect();
        let mirrored =
            kind.facets().iter().map(|facet| sorted(&mut facet.nodes.iter().map(|&local| nodes[local])));
        let place = |facet: Vec<usize>| own.iter().position(|own| *own == facet).map(|place| place as u8);
        Mirror { facets: mirrored.filter_map(place).collect(), nodes }
    }
}

impl MeshBuilder {
    /// Turns cells whose nodes are numbered the other way round, and returns their number; facets keep their place.
    ///
    /// Such a cell has det(dX/dxi) < 0; in the mirrored order of its nodes det(dX/dxi) > 0 at all points, and its
    /// neighbours lie on the other side of its facets. A cell that is folded over a neighbour is not turned.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let mut builder = MeshBuilder::new();
    /// for point in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
    ///     builder.point(point);
    /// }
    /// builder.cell(CellKind::Tet4, &[0, 2, 1, 3])?;
    /// assert_eq!(builder.orient_cells(), 1);
    /// assert_eq!(builder.build()?.cell(0).nodes, [0, 1, 2, 3]);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn orient_cells(&mut self) -> usize {
        let kinds = CellKind::ALL.into_iter().filter(|kind| kind.dimension() > 1);
        let mirrors: BTreeMap<CellKind, Mirror> = kinds.map(|kind| (kind, Mirror::of(kind))).collect();
        let mut is_turned = self.mirrored_cells(&mirrors);
        if is_turned.contains(&true) {
            self.keep_folded(&mut is_turned);
        }
        let turned = |cell: &usize| is_turned[*cell];
        for cell in (0..self.kinds.len()).filter(turned) {
            let nodes = self.nodes_of(cell).to_vec();
            let order = &mirrors[&self.kinds[cell]].nodes;
            let begin = self.offsets[cell] as usize;
            order.iter().enumerate().for_each(|(i, &place)| self.connectivity[begin + i] = nodes[place]);
        }
        for facet in self.groups.facets.values_mut().flatten() {
            if is_turned.get(facet.cell as usize).is_some_and(|turned| *turned) {
                facet.local = mirrors[&self.kinds[facet.cell as usize]].facets[facet.local as usize];
            }
        }
        is_turned.into_iter().filter(|turned| *turned).count()
    }

    /// For each cell whether its volume is negative, and positive everywhere in the mirrored order.
    fn mirrored_cells(&self, mirrors: &BTreeMap<CellKind, Mirror>) -> Vec<bool> {
        let samples = samples();
        let is_mirrored = |cell: usize| {
            let kind = self.kinds[cell];
            let sample = &samples[&kind];
            let place = |&node: &u32| self.points.get(node as usize).copied();
            // `build` reports nodes that are not there.
            let points: Option<Vec<[f64; 3]>> = self.nodes_of(cell).iter().map(place).collect();
            let Some(points) = points.filter(|points| kind.dimension() > 1 && sample.begins_negative(points))
            else {
                return false;
            };
            let mirrored: Vec<[f64; 3]> = mirrors[&kind].nodes.iter().map(|&place| points[place]).collect();
            sample.is_positive(&mirrored)
        };
        (0..self.kinds.len()).map(is_mirrored).collect()
    }

    /// Removes cells from those to turn that would then lie on the same side of a facet as a neighbour.
    fn keep_folded(&self, is_turned: &mut [bool]) {
        // Cells of a facet, each with the direction in which it goes round the facet.
        let mut facets: HashMap<Vec<u32>, Vec<(u32, bool)>> = HashMap::new();
        for (cell, kind) in self.kinds.iter().enumerate() {
            let nodes = self.nodes_of(cell);
            for facet in kind.facets() {
                let corners: Vec<u32> =
                    facet.nodes[..facet.kind.n_corners()].iter().map(|&local| nodes[local]).collect();
                let Some(is_forward) = is_forward(&corners) else { continue };
                let mut key = corners;
                key.sort_unstable();
                facets.entry(key).or_default().push((cell as u32, is_forward != is_turned[cell]));
            }
        }
        for cells in facets.into_values() {
            if let [(a, first), (b, second)] = cells[..]
                && first == second
            {
                [a, b].into_iter().for_each(|cell| is_turned[cell as usize] = false);
            }
        }
    }

    pub(super) fn nodes_of(&self, cell: usize) -> &[u32] {
        &self.connectivity[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }
}

/// Whether the smaller neighbour of the smallest corner follows it; `None` for corners that are one node.
fn is_forward(corners: &[u32]) -> Option<bool> {
    let n = corners.len();
    let least = (0..n).min_by_key(|&i| corners[i])?;
    let (next, last) = (corners[(least + 1) % n], corners[(least + n - 1) % n]);
    match n {
        2 => (next != corners[least]).then_some(least == 0),
        _ => {
            let is_once = |i: usize| corners[..i].iter().all(|corner| *corner != corners[i]);
            (0..n).all(is_once).then_some(next < last)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facet, Mesh, quality};

    /// Numbers between -1 and 1 of a linear congruential generator.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / 2f64.powi(52) - 1.0
        }
    }

    /// A cell with every facet in a group of its own.
    fn cell(kind: CellKind, points: &[[f64; 3]]) -> MeshBuilder {
        let mut builder = MeshBuilder::new();
        let nodes: Vec<u32> = points.iter().map(|&point| builder.point(point)).collect();
        let cell = builder.cell(kind, &nodes).unwrap();
        for local in 0..kind.facets().len() as u8 {
            builder.facet_group(&local.to_string(), [Facet { cell, local }]);
        }
        builder
    }

    fn facets(mesh: &Mesh) -> Vec<Vec<u32>> {
        mesh.groups().names().iter().map(|name| mesh.group_nodes(name).unwrap()).collect()
    }

    #[test]
    fn every_kind_numbered_the_other_way_round_is_turned_with_its_facets() {
        let mut random = Random(1);
        for kind in CellKind::SOLIDS.into_iter().chain(CellKind::PLANES) {
            let is_plane = kind.dimension() == 2;
            for _ in 0..20 {
                // An affine map near the identity, so det > 0, and its mirror image.
                let map = [[0; 3]; 3].map(|row: [i32; 3]| row.map(|_| 0.25 * random.next()));
                let place = |xi: &[f64; 3]| {
                    let row = |i: usize| xi[i] + (0..3).map(|j| map[i][j] * xi[j]).sum::<f64>();
                    [row(0), row(1), if is_plane { 0.0 } else { row(2) }]
                };
                let points: Vec<[f64; 3]> = element(kind).nodes().iter().map(place).collect();
                let images: Vec<[f64; 3]> = points.iter().map(|&[x, y, z]| [-x, y, z]).collect();
                assert_eq!(cell(kind, &points).orient_cells(), 0, "{kind}");
                let right = cell(kind, &points).build().unwrap();
                let mut mirrored = cell(kind, &images);
                assert!(quality(&mirrored.clone().build().unwrap()).volume < 0.0, "{kind}");
                assert_eq!((mirrored.orient_cells(), mirrored.orient_cells()), (1, 0), "{kind}");
                let turned = mirrored.build().unwrap();
                assert_eq!(crate::mesh::check(&turned), Ok(()), "{kind}");
                let volumes = [&right, &turned].map(|mesh| quality(mesh).volume);
                assert!((volumes[0] - volumes[1]).abs() < 1e-14 * volumes[0], "{kind} {volumes:?}");
                assert_eq!(facets(&turned), facets(&right), "{kind}");
            }
        }
    }

    #[test]
    fn a_mesh_that_is_its_own_mirror_image_is_turned() {
        // All coordinates x of a block are reversed: the body is the mirror image, the cells are numbered wrongly.
        let block = crate::mesh::block([2.0, 1.0, 1.0], [3, 2, 2]).unwrap();
        let mut builder = MeshBuilder::new();
        block.points().iter().for_each(|&[x, y, z]| _ = builder.point([-x, y, z]));
        block.cells().for_each(|cell| _ = builder.cell(cell.kind, cell.nodes).unwrap());
        builder.facet_group("x-max", block.groups().facets["x-max"].iter().copied());
        assert_eq!(builder.orient_cells(), 12);
        let mesh = builder.build().unwrap();
        assert!((quality(&mesh).volume - 2.0).abs() < 1e-14);
        assert_eq!(mesh.group_nodes("x-max").unwrap(), block.group_nodes("x-max").unwrap());
    }

    #[test]
    fn a_cell_that_is_folded_over_its_neighbour_is_not_turned() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.2, 0.5]];
        let mut builder = MeshBuilder::new();
        points.iter().for_each(|&point| _ = builder.point(point));
        builder.cell(CellKind::Tet4, &[0, 1, 2, 3]).unwrap();
        // Its apex should be below the common face, and lies above.
        builder.cell(CellKind::Tet4, &[0, 2, 1, 4]).unwrap();
        assert_eq!(builder.orient_cells(), 0);
        let error = crate::mesh::check(&builder.build().unwrap());
        assert!(matches!(error, Err(crate::Error::InvertedCell { cell: 1, .. })), "{error:?}");
    }
}
