//! Dead loads: nodal vectors with a factor over time.

use std::sync::Arc;

use super::interface::{Book, Force, ForceMemory, OverTime, Side};
use super::source::Site;
use super::step::{Sampling, StepStart};
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::input::{Load, LoadKind, TimeFunction};
use crate::mass::regions::nodal_masses;
use crate::mesh::Mesh;
use crate::space::geometry::add_facet_areas;

/// A dead load: nodal forces at factor 1, `[n_nodes][3]`, and the factor over time.
#[derive(Debug)]
pub(crate) struct DeadLoad {
    pub(super) number: usize,
    pub(super) force: Vec<f64>,
    pub(super) time_function: TimeFunction,
}

impl DeadLoad {
    /// The load with some weights of the nodes, `[n_nodes]`, times a vector.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    fn new(number: usize, load: &Load, weights: &[f64], vector: [f64; 3]) -> Result<Self> {
        if let Some(&value) = vector.iter().find(|value| !value.is_finite()) {
            return Err(Error::NotFinite { what: "load".into(), value });
        }
        let force = weights.iter().flat_map(|weight| vector.map(|component| weight * component)).collect();
        Ok(DeadLoad { number, force, time_function: load.time_function.clone() })
    }

    /// A force per area of a facet group.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`].
    pub(super) fn traction(
        number: usize,
        load: &Load,
        group: &str,
        traction: [f64; 3],
        site: &Site<'_>,
    ) -> Result<Self> {
        DeadLoad::new(number, load, &facet_areas(site.mesh, group, site.section)?, traction)
    }

    /// A total force, spread over a facet group.
    ///
    /// # Errors
    /// As [`DeadLoad::traction`].
    pub(super) fn total(
        number: usize,
        load: &Load,
        group: &str,
        force: [f64; 3],
        site: &Site<'_>,
    ) -> Result<Self> {
        let mut areas = facet_areas(site.mesh, group, site.section)?;
        areas.iter_mut().for_each(|area| *area /= site.areas[number]);
        DeadLoad::new(number, load, &areas, force)
    }

    /// A force on each node of a group.
    ///
    /// # Errors
    /// As [`DeadLoad::traction`].
    pub(super) fn nodal(
        number: usize,
        load: &Load,
        group: &str,
        force: [f64; 3],
        site: &Site<'_>,
    ) -> Result<Self> {
        let mut ones = vec![0.0; site.mesh.n_nodes()];
        site.mesh.group_nodes(group)?.into_iter().for_each(|node| ones[node as usize] = 1.0);
        DeadLoad::new(number, load, &ones, force)
    }

    /// An acceleration of the mass of a group of cells, or of all mass.
    ///
    /// # Errors
    /// As [`DeadLoad::traction`].
    pub(super) fn acceleration(
        number: usize,
        load: &Load,
        group: Option<&str>,
        acceleration: [f64; 3],
        site: &Site<'_>,
    ) -> Result<Self> {
        let cells = cells_of(site.mesh, group)?.into_iter();
        let mut masses = nodal_masses(site.mesh, cells, site.density_of_cell, site.kind);
        if group.is_none() {
            masses.iter_mut().zip(site.other_masses).for_each(|(sum, mass)| *sum += mass);
        }
        DeadLoad::new(number, load, &masses, acceleration)
    }
}

impl Force for DeadLoad {
    fn book(&self) -> Book {
        Book::Work
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(vec![0.0; rule.degree()])
    }

    fn begin(&self, start: &StepStart<'_>, memory: &mut ForceMemory, steady: &mut [f64]) -> Result<bool> {
        let factors = memory.of_mut::<Vec<f64>>();
        match start.sampling {
            Sampling::Averages => {
                let averages =
                    self.time_function.averages(start.span.start, start.span.size, start.rule, factors);
                averages.map_err(|found| self.not_finite(found))?;
            }
            Sampling::Points => start.average_values(|time| self.factor(time), factors)?,
        }
        let n_dofs = steady.len() / factors.len();
        let mut acts = false;
        for (&factor, stage) in factors.iter().zip(steady.chunks_exact_mut(n_dofs)) {
            if factor != 0.0 {
                acts = true;
                stage.iter_mut().zip(&self.force).for_each(|(sum, f)| *sum += factor * f);
            }
        }
        Ok(acts)
    }

    fn is_steady(&self) -> bool {
        true
    }

    fn over_time(&self) -> Option<&dyn OverTime> {
        Some(self)
    }
}

impl OverTime for DeadLoad {
    fn number(&self) -> usize {
        self.number
    }

    fn time_function(&self) -> &TimeFunction {
        &self.time_function
    }

    fn in_proportion(&self, time: f64, _: usize) -> Arc<dyn Force> {
        let (number, force) = (self.number, self.force.clone());
        let time_function = TimeFunction::ramp(self.time_function.value_before(time));
        Arc::new(DeadLoad { number, force, time_function })
    }

    fn add_unit_force(&self, force: &mut [f64]) {
        force.iter_mut().zip(&self.force).for_each(|(sum, f)| *sum += f);
    }
}

/// Area of the first `n_own` nodes on which a load acts by its total force; 0 for other loads, and without such facets.
pub(crate) fn area(mesh: &Mesh, load: &Load, section: &[f64], n_own: usize) -> f64 {
    match &load.kind {
        LoadKind::Force { group, .. } => {
            facet_areas(mesh, group, section).map_or(0.0, |areas| areas[..n_own].iter().sum())
        }
        _ => 0.0,
    }
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
