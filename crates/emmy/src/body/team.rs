//! The sums of the bodies of a team.

use super::system::Body;
use crate::mass::RegionSummary;

/// A region from its parts on all ranks; the centre of a part without mass has no meaning.
fn of_parts(parts: Vec<RegionSummary>) -> RegionSummary {
    if let [whole] = &parts[..] {
        return whole.clone();
    }
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
        let ranks = self.ranks().clone();
        // Whether any rank has quadratic cells.
        let [has_lumped] = ranks.any("loads on the lumped mass", [self.lumped.is_some()]);
        let own = self.lumped.take();
        let lumped = has_lumped.then(|| own.unwrap_or_else(|| Box::new(self.clone())));
        self.lumped = lumped.map(|body| Box::new(body.with_sums_of_ranks()));
        let flatten = |region: &RegionSummary| {
            let RegionSummary { n_cells, volume, mass, centre, inertia, .. } = region;
            [&[*n_cells as f64, *volume, *mass], &centre[..], inertia.as_flattened()].concat()
        };
        let parts: Vec<f64> = self.regions.iter().flat_map(flatten).collect();
        let of_ranks = ranks.gather("regions", &parts);
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
        [self.has_local] = ranks.any("cells with pressures", [self.has_local]);
        let mut of_cells = if self.is_viscous() { self.viscosity_and_stiffness() } else { [0.0; 2] };
        ranks.sum("viscosity and stiffness", &mut of_cells);
        self.viscous_time = viscous_time(of_cells);
        let read = |masses: &Vec<f64>, node: usize, mass: &mut [f64]| mass[0] = masses[node];
        let write = |masses: &mut Vec<f64>, node: usize, mass: &[f64]| masses[node] = mass[0];
        ranks.exchange("lumped masses", 1, &mut self.lumped_mass, read, write);
        self.with_supports_of_ranks()
    }

    /// The body, and its successors after the release of supports, with the axes that are fixed on any rank.
    fn with_supports_of_ranks(mut self) -> Body {
        self.space = self.space.with_sums_of_ranks();
        let lumped_mass = &self.lumped_mass;
        let (regions, viscous_time) = (&self.regions, self.viscous_time);
        let has_local = self.has_local;
        self.release = self.release.take().map(|(time, body)| {
            let body = Body {
                has_local,
                lumped_mass: lumped_mass.clone(),
                regions: regions.clone(),
                viscous_time,
                ..*body
            };
            (time, Box::new(body.with_supports_of_ranks()))
        });
        self
    }
}

/// Mean viscosity of all cells over their mean stiffness at rest \[time\], from [`Body::viscosity_and_stiffness`].
fn viscous_time([viscosity, stiffness]: [f64; 2]) -> f64 {
    if viscosity > 0.0 && stiffness > 0.0 { viscosity / stiffness } else { 0.0 }
}
