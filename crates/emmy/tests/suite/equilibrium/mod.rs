//! Static equilibria: closed forms, literature, another code; motions that start from them.

#![allow(non_snake_case)]

mod felupe;
mod held;
mod literature;
mod motions;
mod residuals;

use std::collections::HashMap;

use emmy::body::Body;
use emmy::equilibrium::Equilibrium;
use emmy::internals::element::element;
use emmy::mesh::{CellKind, MeshBuilder};
use emmy::motion::{NewtonSettings, State};

/// Position of a point of a block, from its coordinates in `[0, 1]`.
type Map<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// Blocks of cells, joined where their points meet.
fn mapped(kind: CellKind, cells: [usize; 3], maps: &[Map<'_>]) -> MeshBuilder {
    let reference = element(kind).nodes();
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    for map in maps {
        for cell in 0..cells.iter().product() {
            let at = [cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]];
            let node = |xi: &[f64; 3]| {
                let X = map([0, 1, 2].map(|d| (at[d] as f64 + 0.5 * (xi[d] + 1.0)) / cells[d] as f64));
                *nodes.entry(X.map(|x| (1e8 * x).round() as i64)).or_insert_with(|| builder.point(X))
            };
            let corners: Vec<u32> = reference.iter().map(node).collect();
            builder.cell(kind, &corners).unwrap();
        }
    }
    builder
}

/// The equilibrium under the loads at t = 0.
fn equilibrium(body: &Body, load_steps: usize) -> State {
    let equilibrium = Equilibrium::new(body, 0.0, load_steps).unwrap();
    equilibrium.start(NewtonSettings::default(), &[], &mut []).unwrap()
}

fn displacement(body: &Body, state: &State, point: [f64; 3]) -> [f64; 3] {
    let node = body.mesh().nearest_node(point);
    [0, 1, 2].map(|d| state.displacement[3 * node + d])
}
