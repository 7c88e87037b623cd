//! Energies and momenta of a state (section 2). On a team all of them are calls of all ranks.

use super::system::Body;
use crate::error::Result;
use crate::force::StrainState;
use crate::mass::spread::centre_sums;
use crate::tensor::cross;

/// Sum of a nodal vector, `[n_nodes][3]`.
pub fn sum(vector: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for v in vector.chunks_exact(3) {
        (0..3).for_each(|i| sum[i] += v[i]);
    }
    sum
}

impl Body {
    /// Root mean square of a nodal field `[n_nodes][3]`, weighted by the lumped mass.
    ///
    /// ```math
    /// sqrt(sum_a m_a |u_a|^2 / sum_a m_a)
    /// ```
    pub fn mass_weighted_rms(&self, field: &[f64]) -> f64 {
        let squares = field.as_chunks::<3>().0.iter().zip(&self.lumped_mass()[self.own_nodes()]);
        let mut sum = [squares.map(|(u, mass)| mass * u.iter().map(|u| u * u).sum::<f64>()).sum::<f64>()];
        self.sum_ranks("mass-weighted squares", &mut sum);
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
        for (X, m) in points.iter().zip(&self.lumped_mass()[self.own_nodes()]) {
            (0..3).for_each(|d| centre[d] += m * X[d] / mass);
        }
        self.sum_ranks("centre of mass", &mut centre);
        let arms: Vec<f64> = points.iter().flat_map(|X| [0, 1, 2].map(|d| X[d] - centre[d])).collect();
        self.mass_weighted_rms(&arms)
    }

    /// Moment `sum_A q_A x v_A` about the origin of a nodal vector at a displacement, both `[n_nodes][3]`.
    pub fn moment(&self, displacement: &[f64], vector: &[f64]) -> [f64; 3] {
        let mut moment = [0.0; 3];
        let (u, v) = (displacement.as_chunks::<3>().0, vector.as_chunks::<3>().0);
        for node in self.counted_nodes().take_while(|&node| node < u.len().min(v.len())) {
            let (X, u) = (self.point(node), u[node]);
            let q = [X[0] + u[0], X[1] + u[1], X[2] + u[2]];
            let arm_cross_v = cross(q, v[node]);
            (0..3).for_each(|i| moment[i] += arm_cross_v[i]);
        }
        self.sum_ranks("moment", &mut moment);
        moment
    }

    /// Strain energy V of a displacement, with the potential of springs and attractions to the ground \[energy\].
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
        let terms = self.counted_terms().chain(self.ground.iter());
        let own = terms.fold(StrainState::NONE, |sum, term| sum.with(term.strain_state(displacement)));
        self.strain_state_of_ranks(own)
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
        let (mesh, subdomain) = (self.mesh(), self.subdomain().map(|subdomain| &**subdomain));
        let cells = mesh.cells().zip(self.region_of_cell());
        let section: Vec<f64> =
            cells.map(|(cell, &region)| self.made_of[region as usize].section(cell.kind)).collect();
        let mut sums = centre_sums(mesh, &section, group, subdomain)?;
        if let Some(subdomain) = subdomain {
            subdomain.sum("centre of a group", &mut sums);
        }
        Ok([0, 1, 2].map(|i| sums[i] / sums[3]))
    }
}
