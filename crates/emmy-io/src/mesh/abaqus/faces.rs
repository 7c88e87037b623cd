//! Faces of the cells of a body.

use std::collections::HashMap;

use emmy::mesh::{CellKind, Facet};

/// Every face of every cell by its sorted corners; facets of a body in the plane are edges.
#[derive(Debug, Default)]
pub(super) struct Faces(HashMap<[u32; 4], Face>);

#[derive(Debug)]
struct Face {
    /// In the first cell that has it.
    facet: Facet,
    is_shared: bool,
    /// Midside node of the edge of a plane cell.
    middle: Option<u32>,
}

impl Faces {
    /// Adds the faces of a cell.
    pub(super) fn add(&mut self, cell: u32, kind: CellKind, nodes: &[u32]) {
        for local in 0..kind.facets().len() as u8 {
            let shape = &kind.facets()[usize::from(local)];
            let middle = if shape.kind.n_corners() == 2 { shape.nodes.get(2) } else { None };
            let middle = middle.map(|&middle| nodes[middle]);
            let new = Face { facet: Facet { cell, local }, is_shared: false, middle };
            let face = self.0.entry(corners(kind, nodes, local)).or_insert(new);
            face.is_shared |= face.facet.cell != cell;
        }
    }

    /// The face with some corners.
    pub(super) fn facet(&self, corners: &[u32]) -> Option<Facet> {
        let by = |corners: &[u32]| self.0.get(&key(corners)).map(|face| face.facet);
        // A triangle may be a quadrilateral with a repeated corner.
        let is_triangle = corners.len() == 4 && corners[3] == corners[2];
        by(corners).or_else(|| if is_triangle { by(&corners[..3]) } else { None })
    }

    /// The edge of a plane cell with three nodes; its middle is the second or the third one.
    pub(super) fn edge(&self, [a, b, c]: [u32; 3]) -> Option<Facet> {
        let with = |ends: [u32; 2], middle: u32| {
            let face = self.0.get(&key(&ends))?;
            face.middle.is_none_or(|own| own == middle).then_some(face.facet)
        };
        with([a, b], c).or_else(|| with([a, c], b))
    }

    /// Whether no other cell has a face of a cell.
    pub(super) fn is_free(&self, kind: CellKind, nodes: &[u32], local: u8) -> bool {
        self.0.get(&corners(kind, nodes, local)).is_some_and(|face| !face.is_shared)
    }
}

fn corners(kind: CellKind, nodes: &[u32], local: u8) -> [u32; 4] {
    let facet = &kind.facets()[usize::from(local)];
    let mut corners = [u32::MAX; 4];
    for (slot, &corner) in corners.iter_mut().zip(&facet.nodes[..facet.kind.n_corners()]) {
        *slot = nodes[corner];
    }
    corners.sort_unstable();
    corners
}

fn key(corners: &[u32]) -> [u32; 4] {
    let mut key = [u32::MAX; 4];
    for (slot, &corner) in key.iter_mut().zip(corners) {
        *slot = corner;
    }
    key.sort_unstable();
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_of_two_cells_is_not_free() {
        // Two tetrahedra on both sides of the triangle 1, 2, 3.
        let cells = [[0, 1, 2, 3], [4, 1, 3, 2]];
        let mut faces = Faces::default();
        cells.iter().zip(0..).for_each(|(nodes, cell)| faces.add(cell, CellKind::Tet4, nodes));
        let free =
            |nodes: &[u32]| (0..4).filter(|&local| faces.is_free(CellKind::Tet4, nodes, local)).count();
        assert_eq!(cells.map(|nodes| free(&nodes)), [3, 3]);
        assert_eq!(faces.facet(&[3, 1, 2]).map(|facet| facet.cell), Some(0));
        assert_eq!(faces.facet(&[1, 3, 4, 4]).map(|facet| facet.cell), Some(1));
        assert_eq!(faces.facet(&[0, 1, 4]), None);
    }
}
