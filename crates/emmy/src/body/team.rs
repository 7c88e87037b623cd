//! What a team of ranks computes, and the sums of its bodies.

use super::term::{time_of, traces};
use super::{Body, Formulation, Load, LoadKind, PointTerms, Region, RegionSummary, Support};
use crate::error::{Error, Result};

/// Checks that a team can compute a body of some parts.
///
/// # Errors
/// [`Error::NotOnTeam`] names what it cannot.
pub(super) fn check(
    regions: &[Region],
    nodal: &PointTerms,
    supports: &[Support],
    loads: &[Load],
) -> Result<()> {
    let of_points = [
        ("a point mass", nodal.masses.is_empty()),
        ("a spring to the ground", nodal.springs.is_empty()),
        ("an attraction to a point", nodal.attractions.is_empty()),
    ];
    let of_points = of_points.into_iter().filter(|(_, is_empty)| !is_empty).map(|(what, _)| what.to_string());
    let formulation = |region: &Region| match region.formulation {
        Formulation::Standard => None,
        Formulation::ProjectedVolume(_) => Some("a projected volume".to_string()),
        Formulation::IncompatibleModes => Some("a cell with incompatible modes".to_string()),
    };
    let support = |support: &Support| {
        let what = match support {
            _ if support.is_driven() => "a support that moves",
            Support { until: Some(_), .. } => "a support that is released",
            Support { symmetry: true, .. } => "a plane of symmetry",
            _ => return None,
        };
        Some(what.to_string())
    };
    let load = |load: &Load| {
        let what = match load.kind {
            LoadKind::Traction { .. } | LoadKind::NodalForce { .. } | LoadKind::Acceleration { .. } => {
                return None;
            }
            LoadKind::Force { .. } => "a force over a surface",
            LoadKind::Pressure { .. } => "a follower pressure",
            _ => "a load by a field",
        };
        Some(what.to_string())
    };
    let regions = regions.iter().filter_map(formulation);
    let mut found = of_points
        .chain(regions)
        .chain(supports.iter().filter_map(support))
        .chain(loads.iter().filter_map(load));
    found.next().map_or(Ok(()), |what| Err(Error::NotOnTeam { what }))
}

impl Body {
    /// The body with the sums of all ranks where its builder had those of this one.
    pub(super) fn with_sums_of_ranks(mut self) -> Body {
        let Some(subdomain) = self.subdomain.clone() else { return self };
        let flatten = |region: &RegionSummary| {
            let RegionSummary { n_cells, volume, mass, centre, inertia, .. } = region;
            [&[*n_cells as f64, *volume, *mass], &centre[..], inertia.as_flattened()].concat()
        };
        let parts: Vec<f64> = self.regions.iter().flat_map(flatten).collect();
        let of_ranks = subdomain.gather("regions", &parts);
        for (index, region) in self.regions.iter_mut().enumerate() {
            let part = |of_rank: &[f64]| {
                let of_region = &of_rank[15 * index..15 * (index + 1)];
                RegionSummary {
                    group: None,
                    n_cells: of_region[0] as usize,
                    volume: of_region[1],
                    mass: of_region[2],
                    centre: [0, 1, 2].map(|i| of_region[3 + i]),
                    inertia: [0, 1, 2].map(|i| [0, 1, 2].map(|j| of_region[6 + 3 * i + j])),
                }
            };
            let parts: Vec<RegionSummary> = of_ranks.chunks_exact(parts.len()).map(part).collect();
            *region = RegionSummary { group: region.group.take(), ..RegionSummary::combined(&parts) };
        }
        let mut held = self.held_axes.map(|held| f64::from(u8::from(held)));
        subdomain.largest("fixed axes", &mut held);
        self.held_axes = held.map(|held| held > 0.0);
        let mut of_cells = traces(self.counted_terms());
        subdomain.sum("viscosity and stiffness", &mut of_cells);
        self.viscous_time = time_of(of_cells);
        let read = |masses: &Vec<f64>, node: usize, mass: &mut [f64]| mass[0] = masses[node];
        let write = |masses: &mut Vec<f64>, node: usize, mass: &[f64]| masses[node] = mass[0];
        subdomain.exchange("lumped masses", 1, &mut self.lumped_mass, read, write);
        for group in &mut self.supported {
            group.dofs.retain(|&dof| dof < 3 * subdomain.n_own);
        }
        self
    }

    /// Checks that the whole body is here.
    ///
    /// # Errors
    /// [`Error::NotOnTeam`].
    pub(crate) fn check_whole(&self, what: impl Into<String>) -> Result<()> {
        match self.subdomain() {
            Some(_) => Err(Error::NotOnTeam { what: what.into() }),
            None => Ok(()),
        }
    }
}
