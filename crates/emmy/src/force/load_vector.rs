//! Dead loads: nodal vectors with a factor over time.

use crate::error::{Error, Result};
use crate::input::{Load, LoadKind, NotFinite, SignalTarget, TimeFunction};
use crate::mass::regions::nodal_masses;
use crate::mesh::Mesh;
use crate::space::geometry::{MassKind, add_facet_areas};

/// A dead load: nodal forces at factor 1, `[n_nodes][3]`, and the factor over time.
#[derive(Debug, Clone)]
pub(crate) struct LoadVector {
    /// Number of the load.
    pub(crate) load: usize,
    pub(crate) force: Vec<f64>,
    /// Area of the own part of a surface whose whole area still divides `force`, on a team \[length^2\].
    pub(crate) area: Option<f64>,
    pub(crate) time_function: TimeFunction,
}

impl LoadVector {
    /// Equivalent nodal forces of a load; `None` if the load is not one vector times a factor. `section`: thickness of
    /// plane cells, `density`: mass per measure of each cell, `mass`: its kind, on which accelerations act, `own_nodes`: their
    /// number on a team.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`].
    pub(crate) fn new(
        mesh: &Mesh,
        index: usize,
        load: &Load,
        (section, density_of_cell, point_masses): (&[f64], &[f64], &[f64]),
        mass: MassKind,
        own_nodes: Option<usize>,
    ) -> Result<Option<Self>> {
        let mut own_area = None;
        let (weights, vector) = match &load.kind {
            LoadKind::Pressure { .. }
            | LoadKind::TractionField { .. }
            | LoadKind::BodyForceField { .. }
            | LoadKind::AccelerationField { .. } => return Ok(None),
            LoadKind::Traction { group, traction } => (facet_areas(mesh, group, section)?, *traction),
            LoadKind::Force { group, force } => {
                let areas = facet_areas(mesh, group, section)?;
                let area: f64 = match own_nodes {
                    Some(n_own) => {
                        own_area = Some(areas[..n_own].iter().sum());
                        1.0
                    }
                    None => areas.iter().sum(),
                };
                (areas.iter().map(|a| a / area).collect(), *force)
            }
            LoadKind::NodalForce { group, force } => (ones(mesh, group)?, *force),
            LoadKind::Acceleration { group, acceleration } => {
                let cells = cells_of(mesh, group.as_deref())?.into_iter();
                let mut masses = nodal_masses(mesh, cells, density_of_cell, mass);
                if group.is_none() {
                    masses.iter_mut().zip(point_masses).for_each(|(sum, mass)| *sum += mass);
                }
                (masses, *acceleration)
            }
        };
        if let Some(&value) = vector.iter().find(|value| !value.is_finite()) {
            return Err(Error::NotFinite { what: "load".into(), value });
        }
        let force = weights.iter().flat_map(|weight| vector.map(|component| weight * component)).collect();
        let time_function = load.time_function.clone();
        Ok(Some(LoadVector { load: index, force, area: own_area, time_function }))
    }

    /// The error of a factor that is not a finite number.
    pub(crate) fn not_finite(&self, found: NotFinite) -> Error {
        SignalTarget::Load(self.load).not_finite(self.time_function.text().unwrap_or_default(), found)
    }
}

/// 1 at each node of a group, 0 elsewhere.
fn ones(mesh: &Mesh, group: &str) -> Result<Vec<f64>> {
    let mut ones = vec![0.0; mesh.n_nodes()];
    mesh.group_nodes(group)?.into_iter().for_each(|node| ones[node as usize] = 1.0);
    Ok(ones)
}

/// Integrals of the shape functions over a facet group.
fn facet_areas(mesh: &Mesh, group: &str, section: &[f64]) -> Result<Vec<f64>> {
    let mut areas = vec![0.0; mesh.n_nodes()];
    add_facet_areas(mesh, mesh.groups().facets(group)?, section, &mut areas);
    Ok(areas)
}

/// Cells of a group; without a name all cells.
pub(crate) fn cells_of(mesh: &Mesh, group: Option<&str>) -> Result<Vec<u32>> {
    match group {
        Some(name) => Ok(mesh.groups().cells(name)?.to_vec()),
        None => Ok((0..mesh.n_cells() as u32).collect()),
    }
}
