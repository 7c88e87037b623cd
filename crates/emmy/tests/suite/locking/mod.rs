//! Cells against locking.

#![allow(non_snake_case)]

mod conservation;
mod damping;
mod fields;
mod held;
mod patches;
mod reference;
mod rubber;
mod variety;

use std::collections::HashMap;

use emmy::internals::element::element;
use emmy::mesh::{CellKind, MeshBuilder};

/// Places of the nodes of the cells of a kind, in a square or cube that is cut into cells; simplices along its
/// diagonals.
pub(crate) fn places(kind: CellKind, cells: [usize; 3]) -> Vec<Vec<[f64; 3]>> {
    let boxes = (0..cells.iter().product())
        .map(|cell: usize| [cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]]);
    let reference = element(kind).nodes();
    let is_simplex = matches!(kind.linear(), CellKind::Tri3 | CellKind::Tet4);
    let d = kind.dimension();
    let in_box = |at: [usize; 3], x: [f64; 3]| {
        [0, 1, 2].map(|i| if i < d { (at[i] as f64 + x[i]) / cells[i] as f64 } else { 0.0 })
    };
    boxes
        .flat_map(|at| -> Vec<Vec<[f64; 3]>> {
            if !is_simplex {
                let place = |xi: &[f64; 3]| in_box(at, xi.map(|x| 0.5 * (x + 1.0)));
                return vec![reference.iter().map(place).collect()];
            }
            let of_simplex = |corners: Vec<[f64; 3]>| {
                let place = |xi: &[f64; 3]| {
                    in_box(at, [0, 1, 2].map(|i| (0..d).map(|k| xi[k] * corners[k + 1][i]).sum::<f64>()))
                };
                reference.iter().map(place).collect()
            };
            simplices(d).into_iter().map(of_simplex).collect()
        })
        .collect()
}

/// Corners of the simplices along the diagonal of the unit square or cube.
fn simplices(d: usize) -> Vec<Vec<[f64; 3]>> {
    let orders: &[&[usize]] = match d {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[1, 2, 0], &[2, 0, 1], &[0, 2, 1], &[2, 1, 0], &[1, 0, 2]],
    };
    let simplex = |(number, order): (usize, &&[usize])| {
        let mut corners = vec![[0.0; 3]];
        for &axis in *order {
            let mut next = corners[corners.len() - 1];
            next[axis] = 1.0;
            corners.push(next);
        }
        // The second half of the orders are odd permutations.
        if number >= orders.len() / 2 {
            corners.swap(1, 2);
        }
        corners
    };
    orders.iter().enumerate().map(simplex).collect()
}

/// Cells of a kind on a square or cube, its places mapped.
pub(crate) fn mapped(kind: CellKind, cells: [usize; 3], map: impl Fn([f64; 3]) -> [f64; 3]) -> MeshBuilder {
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    for of_cell in places(kind, cells) {
        let node = |place: &[f64; 3]| {
            let key = place.map(|x| (1e8 * x).round() as i64);
            *nodes.entry(key).or_insert_with(|| builder.point(map(*place)))
        };
        let of_cell: Vec<u32> = of_cell.iter().map(node).collect();
        builder.cell(kind, &of_cell).unwrap();
    }
    builder
}
