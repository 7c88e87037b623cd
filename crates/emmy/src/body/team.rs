//! The sums of the bodies of a team.

use std::sync::Arc;

use super::system::Body;
use crate::error::{Error, Result};
use crate::force::field_load::{POINTS_OF_SIGNALS, samples};
use crate::force::term::{time_of, traces};
use crate::mass::RegionSummary;
use crate::team::Subdomain;

/// A region from its parts on all ranks; the centre of a part without mass has no meaning.
fn of_parts(parts: Vec<RegionSummary>) -> RegionSummary {
    let n_cells = parts.iter().map(|part| part.n_cells).sum();
    let volume = parts.iter().map(|part| part.volume).sum();
    let (with_mass, without): (Vec<_>, Vec<_>) = parts.into_iter().partition(|part| part.mass > 0.0);
    let first = without.into_iter().find(|part| part.n_cells > 0).filter(|_| with_mass.is_empty());
    let whole = first.unwrap_or_else(|| RegionSummary::combined(&with_mass));
    RegionSummary { n_cells, volume, ..whole }
}

impl Body {
    /// The body with the sums of all ranks where its builder had those of this one.
    pub(super) fn with_sums_of_ranks(mut self) -> Body {
        let Some(subdomain) = self.subdomain.clone() else { return self };
        // Whether any rank has quadratic cells.
        let mut has_lumped = [f64::from(u8::from(self.lumped.is_some()))];
        subdomain.largest("loads on the lumped mass", &mut has_lumped);
        let own = self.lumped.take();
        let lumped = (has_lumped[0] > 0.0).then(|| own.unwrap_or_else(|| Box::new(self.clone())));
        self.lumped = lumped.map(|body| Box::new(body.with_sums_of_ranks()));
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
            *region = RegionSummary { group: region.group.take(), ..of_parts(parts) };
        }
        let mut n_internal = [self.internal.counted().len() as f64];
        subdomain.sum("internal nodes", &mut n_internal);
        self.n_dofs_of_ranks = 3 * (subdomain.n_nodes_of_ranks + n_internal[0] as usize);
        let mut has = [self.has_pressures, self.has_plane_cells].map(|has| f64::from(u8::from(has)));
        subdomain.largest("cells with pressures and plane cells", &mut has);
        [self.has_pressures, self.has_plane_cells] = has.map(|has| has > 0.0);
        let mut of_cells = if self.is_viscous() { traces(self.counted_terms()) } else { [0.0; 2] };
        subdomain.sum("viscosity and stiffness", &mut of_cells);
        self.viscous_time = time_of(of_cells);
        let read = |masses: &Vec<f64>, node: usize, mass: &mut [f64]| mass[0] = masses[node];
        let write = |masses: &mut Vec<f64>, node: usize, mass: &[f64]| masses[node] = mass[0];
        subdomain.exchange("lumped masses", 1, &mut self.lumped_mass, read, write);
        let mut loads = (*self.loads).clone();
        for load in &mut loads {
            if let Some(area) = load.area {
                let mut area = [area];
                subdomain.sum("area of a load", &mut area);
                load.force.iter_mut().for_each(|force| *force /= area[0]);
            }
        }
        self.loads = Arc::new(loads);
        let mut fields = (*self.fields).clone();
        for field in &mut fields {
            let mut own = [[f64::NAN; 3]; POINTS_OF_SIGNALS];
            own.iter_mut().zip(&field.samples).for_each(|(own, X)| *own = *X);
            let of_ranks = subdomain.gather("points of a field", own.as_flattened());
            let is_point = |X: &[f64; 3]| X[0].is_finite();
            field.samples =
                samples(&of_ranks.as_chunks().0.iter().copied().filter(is_point).collect::<Vec<_>>());
        }
        self.fields = Arc::new(fields);
        self.with_supports_of_ranks(&subdomain)
    }

    /// The body, and its successors after the release of supports, with the axes that are fixed on any rank.
    fn with_supports_of_ranks(mut self, subdomain: &Subdomain) -> Body {
        let mut held = self.held_axes.map(|held| f64::from(u8::from(held)));
        subdomain.largest("fixed axes", &mut held);
        self.held_axes = held.map(|held| held > 0.0);
        for drive in &mut self.drives {
            let mut radius = [drive.radius];
            subdomain.largest("radius of a support that turns", &mut radius);
            drive.radius = radius[0];
        }
        for group in &mut self.supported {
            group.dofs.retain(|&dof| dof < 3 * subdomain.n_own);
        }
        let (lumped_mass, loads, fields) = (&self.lumped_mass, &self.loads, &self.fields);
        let (regions, viscous_time) = (&self.regions, self.viscous_time);
        let (has_pressures, has_plane_cells) = (self.has_pressures, self.has_plane_cells);
        let n_dofs_of_ranks = self.n_dofs_of_ranks;
        self.release = self.release.take().map(|(time, body)| {
            let body = Body {
                has_pressures,
                has_plane_cells,
                n_dofs_of_ranks,
                lumped_mass: lumped_mass.clone(),
                loads: loads.clone(),
                fields: fields.clone(),
                regions: regions.clone(),
                viscous_time,
                ..*body
            };
            (time, Box::new(body.with_supports_of_ranks(subdomain)))
        });
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
