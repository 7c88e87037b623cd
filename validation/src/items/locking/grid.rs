//! Meshes of any kind of cell: a grid of bricks or squares, each divided into cells, mapped to a shape.

#![allow(non_snake_case)]

use std::collections::HashMap;

use emmy::internals::element::{CellShape, LocalFacet, element};
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};

/// Position of a point of the grid.
pub(in crate::items) type Map<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// A group of facets by the reference positions of their nodes.
pub(in crate::items) type Face<'a> = (&'a str, &'a dyn Fn([f64; 3]) -> bool);

/// A grid of bricks (squares of a plane kind) of edge 1. All nodes, those between corners as well, lie where the map
/// places them.
pub(in crate::items) struct Grid<'a> {
    pub kind: CellKind,
    /// Bricks along each axis; squares do not use the third.
    pub n: [usize; 3],
    pub map: Map<'a>,
}

impl Grid<'_> {
    /// The mesh, with groups of facets.
    pub(in crate::items) fn mesh(&self, faces: &[Face<'_>]) -> Result<Mesh, String> {
        let mut builder = self.cells()?;
        let mesh = builder.clone().build().map_err(|error| error.to_string())?;
        for (name, is_on) in faces {
            builder.facet_group(name, facets_on(&mesh, is_on));
        }
        builder.build().map_err(|error| error.to_string())
    }

    fn cells(&self) -> Result<MeshBuilder, String> {
        let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
        let corners = cells_of_a_brick(self.kind);
        let linear = element(self.kind.linear());
        let n = if self.kind.dimension() == 2 { [self.n[0], self.n[1], 1] } else { self.n };
        for brick in 0..n.iter().product() {
            let at = [brick % n[0], brick / n[0] % n[1], brick / n[0] / n[1]].map(|i| i as f64);
            for corners in &corners {
                let mut shape = vec![0.0; corners.len()];
                let mut node = |&xi: &[f64; 3]| {
                    linear.shape(xi, &mut shape);
                    let on = |d: usize| corners.iter().zip(&shape).map(|(c, N)| N * (at[d] + c[d])).sum();
                    let point: [f64; 3] = [0, 1, 2].map(on);
                    let key = point.map(|x| (1e6 * x).round() as i64);
                    *nodes.entry(key).or_insert_with(|| builder.point((self.map)(point)))
                };
                let cell: Vec<u32> = element(self.kind).nodes().iter().map(&mut node).collect();
                builder.cell(self.kind, &cell).map_err(|error| error.to_string())?;
            }
        }
        Ok(builder)
    }
}

/// Corners of the cells that form a brick.
fn cells_of_a_brick(kind: CellKind) -> Vec<Vec<[f64; 3]>> {
    let cube: Vec<[f64; 3]> =
        element(CellKind::Hex8).nodes().iter().map(|x| x.map(|x| 0.5 * x + 0.5)).collect();
    let of = |cells: &[&[usize]]| cells.iter().map(|cell| cell.iter().map(|&c| cube[c]).collect()).collect();
    match kind.info().shape {
        CellShape::Hexahedron => vec![cube],
        CellShape::Wedge => of(&[&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]]),
        CellShape::Tetrahedron => {
            of(&[&[0, 1, 2, 6], &[0, 2, 3, 6], &[0, 3, 7, 6], &[0, 7, 4, 6], &[0, 4, 5, 6], &[0, 5, 1, 6]])
        }
        CellShape::Pyramid => {
            // A face is seen anticlockwise from outside, the base of a pyramid from its apex.
            let pyramid =
                |face: &LocalFacet| face.nodes.iter().rev().map(|&c| cube[c]).chain([[0.5; 3]]).collect();
            CellKind::Hex8.facets().iter().map(pyramid).collect()
        }
        CellShape::Quadrilateral => of(&[&[0, 1, 2, 3]]),
        CellShape::Triangle => of(&[&[0, 1, 2], &[0, 2, 3]]),
        CellShape::Line => of(&[&[0, 1]]),
    }
}

fn facets_on(mesh: &Mesh, is_on: &dyn Fn([f64; 3]) -> bool) -> Vec<Facet> {
    let locals = |cell: u32| 0..mesh.cell(cell as usize).kind.facets().len() as u8;
    (0..mesh.n_cells() as u32)
        .flat_map(|cell| locals(cell).map(move |local| Facet { cell, local }))
        .filter(|&facet| mesh.facet_nodes(facet).all(|node| is_on(mesh.points()[node as usize])))
        .collect()
}
