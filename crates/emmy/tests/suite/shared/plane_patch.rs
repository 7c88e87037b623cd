//! The unit square, divided into plane cells of any kind, its inner corners moved.

#![allow(non_snake_case)]

use std::collections::HashMap;

use emmy::internals::element::element;
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};

/// The unit square in the plane z = 0.7, n x n quadrilaterals or twice as many triangles, its inner corners moved.
/// Groups of edges `x-min`, `x-max`, `y-min`, `y-max`.
pub(crate) fn plane_patch(kind: CellKind, n: u32) -> Mesh {
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    for at in (0..n * n).map(|i| [f64::from(i / n), f64::from(i % n)]) {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let cells: &[&[usize]] =
            if kind.linear() == CellKind::Quad4 { &[&[0, 1, 2, 3]] } else { &[&[0, 1, 2], &[0, 2, 3]] };
        for corners in cells {
            let corners: Vec<[f64; 2]> =
                corners.iter().map(|&c| [at[0] + square[c][0], at[1] + square[c][1]]).collect();
            let mut N = vec![0.0; corners.len()];
            let mut node = |xi: [f64; 3]| {
                element(kind.linear()).shape(xi, &mut N);
                let on = |x: &dyn Fn([f64; 2]) -> [f64; 2]| {
                    let sum = |i: usize| corners.iter().zip(&N).map(|(&c, N)| N * x(c)[i]).sum::<f64>();
                    [sum(0), sum(1)]
                };
                let key = on(&|c| c).map(|x| (x * 1e6).round() as i64);
                let [x, y] = on(&|grid| distorted(grid.map(|x| x / f64::from(n))));
                *nodes.entry(key).or_insert_with(|| builder.point([x, y, 0.7]))
            };
            let nodes: Vec<u32> = element(kind).nodes().iter().map(|&xi| node(xi)).collect();
            builder.cell(kind, &nodes).unwrap();
        }
    }
    let mesh = builder.clone().build().unwrap();
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        for (side, end) in [("min", 0.0), ("max", 1.0)] {
            builder.facet_group(&format!("{name}-{side}"), facets_on(&mesh, axis, end));
        }
    }
    builder.build().unwrap()
}

/// Position of a point of the square: its edges stay straight, inner points move.
fn distorted(X: [f64; 2]) -> [f64; 2] {
    let bubble = |x: f64| 4.0 * x * (1.0 - x);
    let inside = bubble(X[0]) * bubble(X[1]);
    [0, 1].map(|d| X[d] + 0.06 * bubble(X[d]) * X[1 - d] + inside * [0.08, -0.06][d])
}

fn facets_on(mesh: &Mesh, axis: usize, value: f64) -> Vec<Facet> {
    let all = (0..mesh.n_cells() as u32).flat_map(|cell| {
        (0..mesh.cell(cell as usize).kind.facets().len() as u8).map(move |local| Facet { cell, local })
    });
    let lies = |node: u32| (mesh.points()[node as usize][axis] - value).abs() < 1e-12;
    all.filter(|&facet| mesh.facet_nodes(facet).all(lies)).collect()
}
