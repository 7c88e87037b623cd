//! The unit cube, divided into cells of any kind, its inner corners moved.

#![allow(non_snake_case)]

use std::collections::HashMap;

use super::cells::cells_of_a_brick;

use emmy::internals::element::element;
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};

/// A division of the unit cube.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patch {
    /// Number of bricks along each edge; a brick is one cell or is divided into several.
    pub bricks: usize,
    /// Whether quadratic cells get curved inner edges.
    pub curved: bool,
    /// Displacement of corners: 0 for none, 1 for up to 7 % of the edge of the cube.
    pub distortion: f64,
}

impl Patch {
    /// The mesh with cells of a kind; groups of facets `x-min` to `z-max`, and `surface` of all of them.
    pub(crate) fn mesh(self, kind: CellKind) -> Mesh {
        let mut draft = Draft { builder: MeshBuilder::new(), nodes: HashMap::new(), patch: self };
        let n = self.bricks;
        for (i, j, k) in (0..n * n * n).map(|at| (at / (n * n), at / n % n, at % n)) {
            for corners in cells_of_a_brick(kind) {
                let at = |c: [f64; 3]| [i as f64 + c[0], j as f64 + c[1], k as f64 + c[2]];
                draft.cell(kind, &corners.into_iter().map(at).collect::<Vec<_>>());
            }
        }
        let mesh = draft.builder.clone().build().unwrap();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for (side, end) in [("min", 0.0), ("max", 1.0)] {
                let facets = facets_on(&mesh, axis, end);
                draft.builder.facet_group("surface", facets.clone());
                draft.builder.facet_group(&format!("{name}-{side}"), facets);
            }
        }
        draft.builder.build().unwrap()
    }

    /// Position of a point of the grid: the surface of the cube stays plane, inner points move.
    fn position(self, grid: [f64; 3]) -> [f64; 3] {
        let X = grid.map(|x| x / self.bricks as f64);
        let bubble = |x: f64| 4.0 * x * (1.0 - x);
        let inside = X.map(bubble).iter().product::<f64>();
        let on_faces = |d: usize| bubble(X[d]) * (0.05 * X[(d + 1) % 3] - 0.03 * X[(d + 2) % 3]);
        [0, 1, 2].map(|d| X[d] + self.distortion * (on_faces(d) + inside * [0.07, -0.05, 0.06][d]))
    }
}

struct Draft {
    builder: MeshBuilder,
    nodes: HashMap<[i64; 3], u32>,
    patch: Patch,
}

impl Draft {
    /// Adds a cell by its corners on the undistorted grid of edge 1; its other nodes lie between them.
    fn cell(&mut self, kind: CellKind, corners: &[[f64; 3]]) {
        let linear = element(kind.linear());
        let mut N = vec![0.0; corners.len()];
        let nodes: Vec<u32> = element(kind)
            .nodes()
            .iter()
            .map(|&xi| {
                linear.shape(xi, &mut N);
                let on = |x: &dyn Fn([f64; 3]) -> [f64; 3]| {
                    let corners = corners.iter().map(|&c| x(c));
                    corners.zip(&N).fold([0.0; 3], |sum, (c, N)| [0, 1, 2].map(|i| sum[i] + N * c[i]))
                };
                let patch = self.patch;
                let (grid, straight) = (on(&|c| c), on(&|c| patch.position(c)));
                let position = if patch.curved { patch.position(grid) } else { straight };
                self.node(grid, position)
            })
            .collect();
        self.builder.cell(kind, &nodes).unwrap();
    }

    fn node(&mut self, grid: [f64; 3], position: [f64; 3]) -> u32 {
        let key = grid.map(|x| (x * 1e6).round() as i64);
        let builder = &mut self.builder;
        *self.nodes.entry(key).or_insert_with(|| builder.point(position))
    }
}

/// Facets whose nodes all lie in a plane.
fn facets_on(mesh: &Mesh, axis: usize, value: f64) -> Vec<Facet> {
    let all = (0..mesh.n_cells() as u32).flat_map(|cell| {
        (0..mesh.cell(cell as usize).kind.facets().len() as u8).map(move |local| Facet { cell, local })
    });
    let lies = |node: u32| (mesh.points()[node as usize][axis] - value).abs() < 1e-12;
    all.filter(|&facet| mesh.facet_nodes(facet).all(lies)).collect()
}
