//! Elements that do not lock: stability, bending, near-incompressibility, conservation.

mod cantilever;
mod cook;
mod grid;
mod inf_sup;
mod silicone;

use emmy::body::{Body, Formulation, PressureSpace};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::CellKind;
use emmy::motion::NewtonSettings;

pub(super) use cantilever::item as cantilever;
pub(super) use cook::item as cook;
pub(super) use grid::{Face, Grid};
pub(super) use inf_sup::item as inf_sup;
pub(super) use silicone::item as silicone;

/// A kind of cell with a formulation.
#[derive(Debug, Clone, Copy)]
struct Element {
    label: &'static str,
    kind: CellKind,
    formulation: Formulation,
}

impl Element {
    const fn standard(label: &'static str, kind: CellKind) -> Self {
        Element { label, kind, formulation: Formulation::Standard }
    }

    const fn modes(label: &'static str, kind: CellKind) -> Self {
        Element { label, kind, formulation: Formulation::IncompatibleModes }
    }

    const fn projected(label: &'static str, kind: CellKind, space: PressureSpace) -> Self {
        Element { label, kind, formulation: Formulation::ProjectedVolume(Some(space)) }
    }
}

/// Displacement of the node at a point in the equilibrium under the loads.
fn displacement_of(body: &Body, load_steps: usize, point: [f64; 3]) -> Result<[f64; 3], String> {
    let equilibrium = Equilibrium::new(body, 0.0, load_steps).map_err(|error| error.to_string())?;
    let state = equilibrium.start(NewtonSettings::default(), &[], &mut []);
    let displacement = state.map_err(|error| error.to_string())?.displacement;
    let node = body.mesh().nearest_node(point);
    Ok([0, 1, 2].map(|d| displacement[3 * node + d]))
}
