//! The boundary of a mesh.

use std::collections::BTreeMap;

use super::{Facet, Mesh};
use crate::error::Result;

impl Mesh {
    /// The facets of cells that no other cell shares, each as its corner nodes, outward normal by the right-hand rule.
    ///
    /// ```
    /// let mesh = emmy::mesh::l_block(1.0)?;
    /// assert_eq!(mesh.boundary().len(), 2 * 39 + 3 * 32); // two L of 39 squares, and the rim between them
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn boundary(&self) -> Vec<Vec<u32>> {
        let corners = |facet: Facet| {
            let n = self.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind.n_corners();
            self.facet_nodes(facet).take(n).collect()
        };
        self.boundary_facets().into_iter().map(corners).collect()
    }

    /// The facets of a surface: of a group, of the cells in it on the boundary, or of the whole boundary.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`].
    pub(crate) fn surface_facets(&self, group: Option<&str>) -> Result<Vec<Facet>> {
        let Some(group) = group else { return Ok(self.boundary_facets()) };
        if let Ok(facets) = self.groups().facets(group) {
            return Ok(facets.to_vec());
        }
        let mut is_meant = vec![false; self.n_cells()];
        self.groups().cells(group)?.iter().for_each(|cell| is_meant[*cell as usize] = true);
        Ok(self.boundary_facets().into_iter().filter(|facet| is_meant[facet.cell as usize]).collect())
    }

    /// The same facets, in the order of their sorted corner nodes.
    pub(crate) fn boundary_facets(&self) -> Vec<Facet> {
        let mut facets = BTreeMap::new();
        for (index, cell) in self.cells().enumerate() {
            for (local, facet) in cell.kind.facets().iter().enumerate() {
                let corners = facet.nodes[..facet.kind.n_corners()].iter();
                let mut key: Vec<u32> = corners.map(|&local| cell.nodes[local]).collect();
                key.sort_unstable();
                let own = Some(Facet { cell: index as u32, local: local as u8 });
                facets.entry(key).and_modify(|facet| *facet = None).or_insert(own);
            }
        }
        facets.into_values().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use crate::mesh::{CellKind, Mesh, MeshBuilder, block, l_block};

    fn tetrahedron() -> Mesh {
        let mut builder = MeshBuilder::new();
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let nodes = corners.map(|corner| builder.point(corner));
        builder.cell(CellKind::Tet4, &nodes).unwrap();
        builder.build().unwrap()
    }

    /// Uses Gauss' theorem on a triangle fan of each facet.
    fn enclosed_volume(mesh: &Mesh, boundary: &[Vec<u32>]) -> f64 {
        let point = |node: u32| mesh.points()[node as usize];
        let fans = boundary.iter().flat_map(|f| (1..f.len() - 1).map(|i| [f[0], f[i], f[i + 1]].map(point)));
        let triple = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        fans.map(|corners| triple(corners) / 6.0).sum()
    }

    #[test]
    fn the_boundary_is_closed_and_looks_outwards() {
        let meshes = [block([2.0, 1.0, 3.0], [2, 1, 3]).unwrap(), l_block(1.0).unwrap(), tetrahedron()];
        for (mesh, (n_facets, volume)) in meshes.iter().zip([(22, 6.0), (174, 117.0), (4, 1.0 / 6.0)]) {
            let boundary = mesh.boundary();
            assert_eq!(boundary.len(), n_facets);
            assert!((enclosed_volume(mesh, &boundary) - volume).abs() < 1e-9 * volume);
            // Every edge belongs to two facets, which run along it in opposite directions.
            let edge = |facet: &Vec<u32>, i: usize| (facet[i], facet[(i + 1) % facet.len()]);
            let edges = || boundary.iter().flat_map(|facet| (0..facet.len()).map(move |i| edge(facet, i)));
            let all: HashSet<(u32, u32)> = edges().collect();
            assert!(edges().count() == all.len() && all.iter().all(|&(a, b)| all.contains(&(b, a))));
        }
    }
}
