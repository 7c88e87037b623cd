//! Dead loads: nodal vectors with a factor over time; resultants of all loads.

use super::geometry::{add_facet_areas, for_each_volume_point};
use super::{Body, History, Load, LoadKind};
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::mesh::Mesh;

/// A load ready for use: nodal forces at factor 1, `[n_nodes][3]`, and the factor over time.
#[derive(Debug, Clone)]
pub struct LoadVector {
    /// Number of the load.
    pub(super) load: usize,
    pub(super) force: Vec<f64>,
    pub(super) history: History,
}

impl LoadVector {
    /// Equivalent nodal forces of a load, `None` if these are not one vector times a factor; `section`: thickness of plane cells,
    /// `density`: mass per measure of each cell.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`].
    pub fn new(
        mesh: &Mesh,
        index: usize,
        load: &Load,
        section: &[f64],
        density_of_cell: &[f64],
        point_masses: &[f64],
    ) -> Result<Option<Self>> {
        let (weights, vector) = match &load.kind {
            LoadKind::Pressure { .. } | LoadKind::TractionField { .. } | LoadKind::BodyForceField { .. } => {
                return Ok(None);
            }
            LoadKind::Traction { group, traction } => (facet_areas(mesh, group, section)?, *traction),
            LoadKind::Force { group, force } => {
                let areas = facet_areas(mesh, group, section)?;
                let area: f64 = areas.iter().sum();
                (areas.iter().map(|a| a / area).collect(), *force)
            }
            LoadKind::NodalForce { group, force } => (ones(mesh, group)?, *force),
            LoadKind::Acceleration { group, acceleration } => {
                let mut masses = nodal_masses(mesh, group.as_deref(), density_of_cell)?;
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
        Ok(Some(LoadVector { load: index, force, history: load.history.clone() }))
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
pub(super) fn cells_of(mesh: &Mesh, group: Option<&str>) -> Result<Vec<u32>> {
    match group {
        Some(name) => Ok(mesh.groups().cells(name)?.to_vec()),
        None => Ok((0..mesh.n_cells() as u32).collect()),
    }
}

/// Integrals of density times the shape functions over a cell group.
fn nodal_masses(mesh: &Mesh, group: Option<&str>, density_of_cell: &[f64]) -> Result<Vec<f64>> {
    let cells = cells_of(mesh, group)?;
    let mut masses = vec![0.0; mesh.n_nodes()];
    for_each_volume_point(mesh, cells.into_iter(), |cell, nodes, point| {
        for (&node, N) in nodes.iter().zip(point.shapes) {
            masses[node as usize] += density_of_cell[cell] * point.weight * N;
        }
    });
    Ok(masses)
}

/// Resultant of a load at factor 1 in the reference configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadResultant {
    /// Force \[force\].
    pub force: [f64; 3],
    /// Torque about the origin \[force length\].
    pub torque: [f64; 3],
}

impl Body {
    /// Stage averages of the dead loads over a step, exact for every kink of the histories; fields are integrated by
    /// [`Rule::smooth_quadrature`].
    ///
    /// ```math
    /// f_i^ext = (1/b_i) integral_0^1 l_i F_ext dalpha
    /// ```
    ///
    /// `force: [k][n_nodes][3]`; `averages`: memory for k numbers. Returns whether any load acts.
    pub fn stage_loads(
        &self,
        rule: &Rule,
        time: f64,
        step_size: f64,
        averages: &mut [f64],
        force: &mut [f64],
    ) -> bool {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            load.history.averages(time, step_size, rule, averages);
            for (&factor, force) in averages.iter().zip(force.chunks_exact_mut(self.n_dofs())) {
                if factor != 0.0 {
                    acts = true;
                    force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
                }
            }
        }
        for field in self.fields.iter() {
            acts |= field.add_averages(time, step_size, rule, averages, force);
        }
        acts
    }

    /// The first time after another at which the history of a load or of a support that moves has a kink or a jump.
    pub fn next_kink(&self, after: f64) -> Option<f64> {
        let loads = self.loads.iter().map(|load| &load.history);
        let fields = self.fields.iter().map(|field| &field.history);
        let pressures = self.pressures.iter().map(|pressure| &pressure.history);
        let drives = self.drives.iter().flat_map(|drive| drive.histories());
        let all = loads.chain(fields).chain(pressures).chain(drives);
        all.filter_map(|history| history.next_kink(after)).min_by(f64::total_cmp)
    }

    /// Dead loads at a time (after a jump of a history that falls on it), `force: [n_nodes][3]`. Returns whether any
    /// load acts.
    pub fn loads_at(&self, time: f64, force: &mut [f64]) -> bool {
        force.fill(0.0);
        let mut acts = false;
        for load in self.loads.iter() {
            let factor = load.history.value(time);
            if factor != 0.0 {
                acts = true;
                force.iter_mut().zip(&load.force).for_each(|(sum, f)| *sum += factor * f);
            }
        }
        for field in self.fields.iter() {
            acts |= field.add_at(time, force);
        }
        acts
    }

    /// Resultant of every load at factor 1 in the reference configuration; of a field, with its history, at t = 0.
    pub fn load_resultants(&self) -> Vec<LoadResultant> {
        let rest = vec![0.0; self.n_dofs()];
        let resultant = |force: &[f64]| LoadResultant {
            force: super::invariants::sum(force),
            torque: self.moment(&rest, force),
        };
        let mut resultants: Vec<(usize, LoadResultant)> =
            self.loads.iter().map(|load| (load.load, resultant(&load.force))).collect();
        for field in self.fields.iter() {
            let mut force = rest.clone();
            field.add_at(0.0, &mut force);
            resultants.push((field.load, resultant(&force)));
        }
        for pressure in self.pressures.iter() {
            let mut force = rest.clone();
            pressure.add_force(&self.mesh, &rest, 1.0, &mut force);
            resultants.push((pressure.load, resultant(&force)));
        }
        resultants.sort_by_key(|(load, _)| *load);
        resultants.into_iter().map(|(_, resultant)| resultant).collect()
    }
}
