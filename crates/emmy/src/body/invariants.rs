//! Energies and momenta of a state (section 2). On a team all of them are calls of all ranks.

use super::system::Body;
use crate::error::Result;
use crate::force::StrainState;
use crate::mass::spread::centre_sums;

impl Body {
    /// Root mean square of a nodal field `[n_nodes][3]`, weighted by the lumped mass, and with the inertia of rigid
    /// bodies.
    ///
    /// ```math
    /// sqrt(sum_a m_a |u_a|^2 / sum_a m_a)
    /// ```
    pub fn mass_weighted_rms(&self, field: &[f64]) -> f64 {
        let squares = field.as_chunks::<3>().0.iter().zip(&self.lumped_mass()[self.space.own_nodes()]);
        let of_nodes = squares.map(|(u, mass)| mass * u.iter().map(|u| u * u).sum::<f64>()).sum::<f64>();
        let mut sum =
            [of_nodes + self.mechanism.frames.iter().map(|frame| frame.turning_square(field)).sum::<f64>()];
        self.space.sum_ranks("mass-weighted squares", &mut sum);
        (sum[0] / self.total_lumped_mass()).sqrt()
    }

    /// Radius of gyration of the lumped masses about their centre, in the reference configuration \[length\]. Errors
    /// ([`Body::mass_weighted_rms`], also with the lumped masses) are relative to it. In a coarse mesh it exceeds the
    /// radius of the body itself.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0, 2.0, 2.0], [1; 3])?).region(rubber).build()?;
    /// assert!((body.radius_of_gyration() - 1.5).abs() < 1e-14); // all mass in the corners
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn radius_of_gyration(&self) -> f64 {
        let points = self.mesh().points();
        let mass = self.total_lumped_mass();
        let mut centre = [0.0; 3];
        for (X, m) in points.iter().zip(&self.lumped_mass()[self.space.own_nodes()]) {
            (0..3).for_each(|d| centre[d] += m * X[d] / mass);
        }
        self.space.sum_ranks("centre of mass", &mut centre);
        let arms: Vec<f64> = points.iter().flat_map(|X| [0, 1, 2].map(|d| X[d] - centre[d])).collect();
        match self.mass_weighted_rms(&arms) {
            // A mass alone is as large as its joints.
            0.0 if !self.constraints().is_empty() => self.constraints().size(),
            radius => radius,
        }
    }

    /// Total of the lumped masses \[mass\].
    pub(crate) fn total_lumped_mass(&self) -> f64 {
        let mut sum = [self.lumped_mass()[self.space.own_nodes()].iter().sum()];
        self.space.sum_ranks("lumped mass", &mut sum);
        sum[0]
    }

    /// Mass and volume of all regions, masses and rigid bodies, on a team those of all ranks \[mass, length^3\].
    #[doc(hidden)]
    pub fn mass_and_volume(&self) -> [f64; 2] {
        let regions = self.regions();
        [regions.iter().map(|region| region.mass).sum(), regions.iter().map(|region| region.volume).sum()]
    }

    /// Total of the consistent mass \[mass\].
    pub(crate) fn total_mass(&self) -> f64 {
        let end = self.pattern().range(self.space.own_nodes().end - 1).end;
        let mut sum = [self.mass()[..end].iter().sum()];
        self.space.sum_ranks("mass", &mut sum);
        sum[0]
    }

    /// Strain energy V of a displacement, with the potential of springs and attractions to the ground, and of the
    /// springs of joints, whose angles are within half a turn \[energy\].
    pub fn strain_energy(&self, displacement: &[f64]) -> f64 {
        self.strain_state(displacement).strain_energy
    }

    /// Strain energy and smallest det F of a displacement; det F is infinite for a body of links.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = NeoHooke::new(1000.0, 500.0)?;
    /// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?).region(Region::new(rubber, 1.0)).build()?;
    /// let squeezed: Vec<f64> = body.mesh().points().iter().flat_map(|X| [0.0, 0.0, -0.2 * X[2]]).collect();
    /// assert!((body.strain_state(&squeezed).smallest_determinant - 0.8).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    #[doc(hidden)]
    pub fn strain_state(&self, displacement: &[f64]) -> StrainState {
        self.strain_state_near(displacement, &[])
    }

    /// The same with the coordinates of the joints to half a turn, `[n_joints]`.
    pub(crate) fn strain_state_near(&self, displacement: &[f64], coordinates: &[f64]) -> StrainState {
        self.strain_state_of_ranks(self.own_strain_state(displacement, coordinates))
    }

    /// The strain state of all ranks from that of the cells that count here; the cell is one of the whole mesh.
    fn strain_state_of_ranks(&self, own: StrainState) -> StrainState {
        let ranks = self.ranks();
        let mut energy = [own.strain_energy];
        ranks.sum("strain energy", &mut energy);
        let negative = -own.smallest_determinant;
        let mut most = [negative];
        ranks.largest("smallest determinant", &mut most);
        let is_here = negative == most[0] || negative.is_nan();
        // A rank without cells has none that counts.
        let cell = ranks.cells.get(own.smallest_cell).filter(|_| is_here).map(|&cell| cell as usize);
        let smallest_cell = ranks.lowest("cell of the smallest determinant", cell).unwrap_or(0);
        StrainState {
            strain_energy: energy[0],
            smallest_determinant: -most[0],
            smallest_cell,
            contact: own.contact,
        }
    }

    /// Centre of a group: of the area of its facets, else of the volume of its cells (of links the length), else of its
    /// nodes \[length\]. On a team a call of all ranks.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`].
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [1, 2, 1])?).region(rubber).build()?;
    /// let centre = body.centre_of("y-max")?;
    /// assert!((0..3).all(|i| (centre[i] - [0.5, 2.0, 0.5][i]).abs() < 1e-15));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn centre_of(&self, group: &str) -> Result<[f64; 3]> {
        let mesh = self.mesh();
        let cells = mesh.cells().zip(self.region_of_cell());
        let section: Vec<f64> =
            cells.map(|(cell, &region)| self.made_of[region as usize].section(cell.kind)).collect();
        let mut sums = centre_sums(mesh, &section, group, self.ranks())?;
        self.space.sum_ranks("centre of a group", &mut sums);
        Ok([0, 1, 2].map(|i| sums[i] / sums[3]))
    }
}
