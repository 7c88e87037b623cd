//! Forces of the cells of each region.

use std::ops::Range;

use super::batches::PointGeometry;
use super::interface::Force;
use super::solid::SolidForce;
use crate::element::{element, jacobian};
use crate::error::{Error, Result};
use crate::input::Region;
use crate::mass::regions::cells_by_region;
use crate::mesh::{CellKind, Mesh};
use crate::space::geometry::{ReferenceTable, positions, reserved};
use crate::space::{CellTable, InternalNodes};
use crate::tensor::{LANES, det};

/// Checks all that the forces of the cells need, but makes none: formulations, Jacobians, room for the geometry.
/// Returns whether some cells have pressures; cells of rigid bodies have no forces.
///
/// # Errors
/// [`Error::Formulation`], [`Error::InvertedCell`], [`Error::OutOfMemory`].
pub(crate) fn check(
    mesh: &Mesh,
    regions: &[Region],
    region_of_cell: &[u32],
    is_rigid: impl Fn(u32) -> bool,
) -> Result<bool> {
    let mut has_pressures = false;
    let mut n_points = 0;
    let mut tables: [Option<ReferenceTable<3>>; CellKind::ALL.len()] = Default::default();
    // Whether cells of each region and kind have pressures, once it is known.
    let mut seen = vec![[None; CellKind::ALL.len()]; regions.len()];
    for ((index, cell), &region) in mesh.cells().enumerate().zip(region_of_cell) {
        let kind = cell.kind;
        let seen = &mut seen[region as usize][kind as usize];
        if seen.is_none() {
            let region = &regions[region as usize];
            let split = region.material.split(region.formulation, kind);
            *seen = Some(split.map_err(|reason| Error::Formulation { cell: index, reason })?.is_some());
        }
        has_pressures |= !has_pressures && *seen == Some(true) && !is_rigid(index as u32);
        let table = tables[kind as usize].get_or_insert_with(|| {
            ReferenceTable::new(element(kind), element(kind).quadrature(), kind.n_nodes())
        });
        let X = positions(mesh, cell.nodes);
        n_points += table.weights.len();
        for point in 0..table.weights.len() {
            let det = det(&jacobian(kind, &X, table.gradients_at(point)));
            if det <= 0.0 || det.is_nan() {
                return Err(Error::InvertedCell { cell: index, kind, det });
            }
        }
    }
    reserved::<PointGeometry>(n_points.div_ceil(LANES))?;
    Ok(has_pressures)
}

/// One force for each region and kind of the cells that are `chosen`.
pub(crate) fn forces(
    mesh: &Mesh,
    regions: &[Region],
    region_of_cell: &[u32],
    internal: &InternalNodes,
    chosen: impl Fn(u32) -> bool,
) -> Result<Vec<SolidForce>> {
    let mut forces = Vec::new();
    for (region, of_region) in regions.iter().zip(cells_by_region(region_of_cell, regions.len())) {
        for kind in CellKind::ALL {
            let is_of_kind = |cell: &u32| mesh.cell(*cell as usize).kind == kind && chosen(*cell);
            let cells: Vec<u32> = of_region.iter().copied().filter(is_of_kind).collect();
            if !cells.is_empty() {
                // The force of a link asks for its length.
                let section = if region.link().is_some() { 1.0 } else { region.section(kind) };
                let table = CellTable::new(mesh, kind, cells, section)?.with_modes(mesh, kind, internal)?;
                let mut force = region.material.force(region.formulation, mesh, kind, table)?;
                force.set_viscosity(&region.viscosity);
                forces.push(force);
            }
        }
    }
    Ok(forces)
}

/// Numbers the pressures of all forces; `parts`: rows of each thread.
pub(crate) fn number_pressures(forces: &mut [SolidForce], parts: &[Range<usize>]) {
    let (mut index, mut first) = (0, 0);
    for force in forces {
        force.number_pressures(index, first, parts);
        if let Some(cells) = force.pressure_cells() {
            index += 1;
            first += cells.n_pressures();
        }
    }
}
