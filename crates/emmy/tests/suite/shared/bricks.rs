//! Blocks of hexahedra of any kind.

use std::collections::HashMap;

use emmy::internals::element::element;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};

/// A block of hexahedra of a kind from the origin on; groups of nodes `x-min` to `z-max`, `all`, and `centre` of the
/// nodes in the middle of `x-min`.
pub(crate) fn brick(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Mesh {
    let mut builder = MeshBuilder::new();
    let mut nodes: HashMap<[usize; 3], u32> = HashMap::new();
    let [nx, ny, nz] = cells;
    for cell in (0..nx * ny * nz).map(|at| [at % nx, at / nx % ny, at / (nx * ny)]) {
        let mut node = |xi: &[f64; 3]| {
            // Twice the place on the grid of cells.
            let place = [0, 1, 2].map(|d| 2 * cell[d] + (xi[d] + 1.0).round() as usize);
            let point = [0, 1, 2].map(|d| size[d] * place[d] as f64 / (2 * cells[d]) as f64);
            *nodes.entry(place).or_insert_with(|| builder.point(point))
        };
        let cell: Vec<u32> = element(kind).nodes().iter().map(&mut node).collect();
        builder.cell(kind, &cell).unwrap();
    }
    let mut group = |name: &str, is_in: &dyn Fn(&[usize; 3]) -> bool| {
        builder.node_group(name, nodes.iter().filter(|(place, _)| is_in(place)).map(|(_, &node)| node));
    };
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        group(&format!("{letter}-min"), &|place| place[axis] == 0);
        group(&format!("{letter}-max"), &|place| place[axis] == 2 * cells[axis]);
    }
    group("centre", &|place| *place == [0, ny, nz]);
    group("all", &|_| true);
    builder.build().unwrap()
}
