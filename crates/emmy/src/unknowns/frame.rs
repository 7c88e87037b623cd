//! Rigid bodies as frames of four nodes.
//!
//! A frame has its centre P_0 and the ends of three axes, `P_i = P_0 + s e_i`. Every point and direction of the rigid
//! body is linear in these nodes, so there are no rotations:
//!
//! ```math
//! p(X) = P_0 + sum_i c_i (P_i - P_0),    c_i = e_i . (X - P_0) / s
//! ```
//!
//! Six constraints keep it rigid, `(P_i - P_0) . (P_j - P_0) = s^2 delta_ij`. With mass m and inertia J about the
//! centre its kinetic energy is that of the mass matrix
//!
//! ```math
//! M = m e_0 e_0^T + B^T E B / s^2,    E = tr(J)/2 1 - J,    B = [-1 1 0 0; -1 0 1 0; -1 0 0 1]
//! ```
//!
//! (Betsch and Steinmann, Comput. Methods Appl. Mech. Engrg. 191 (2001) 467.)

use super::affine::Affine;
use super::constraint::Constraint;
use crate::error::{Error, Result};
use crate::input::RigidBody;
use crate::mass::RegionSummary;
use crate::sparse::Pattern;
use crate::tensor::eigen;

/// Number of nodes of a frame.
pub(crate) const NODES_OF_FRAME: usize = 4;

/// A rigid body in a mesh.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    body: RigidBody,
    /// Node of the centre; those of the axes follow.
    first: u32,
    /// s, the radius of gyration, so that constraints have like sizes.
    size: f64,
}

impl Frame {
    /// The frame of a rigid body whose nodes begin with a number.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a mass; [`Error::Inertia`] for moments that no body has.
    pub(crate) fn new(body: &RigidBody, first: u32) -> Result<Self> {
        let RigidBody { mass, inertia: J, .. } = body;
        if !(*mass > 0.0 && mass.is_finite()) {
            return Err(Error::NotPositive {
                what: format!("mass of the rigid body \"{}\"", body.name),
                value: *mass,
            });
        }
        let trace = J[0][0] + J[1][1] + J[2][2];
        let frame = Frame { body: body.clone(), first, size: (0.5 * trace / mass).sqrt() };
        let E = frame.second_moments();
        let (moments, _) = eigen(&[E[0][0], E[1][1], E[2][2], E[0][1], E[1][2], E[0][2]]);
        let least = moments.into_iter().fold(f64::INFINITY, f64::min);
        let is_symmetric = (0..3).all(|i| (0..3).all(|j| J[i][j] == J[j][i] && J[i][j].is_finite()));
        if !(is_symmetric && least > LEAST_MOMENT * trace) {
            return Err(Error::Inertia { body: body.name.clone(), inertia: *J });
        }
        Ok(frame)
    }

    /// Its name.
    pub(crate) fn name(&self) -> &str {
        &self.body.name
    }

    /// Its data.
    pub(crate) fn body(&self) -> &RigidBody {
        &self.body
    }

    /// E, the second moments of its mass.
    fn second_moments(&self) -> [[f64; 3]; 3] {
        let J = &self.body.inertia;
        let half = 0.5 * (J[0][0] + J[1][1] + J[2][2]);
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { half - J[i][j] } else { -J[i][j] }))
    }

    /// Numbers of its nodes.
    pub(crate) fn nodes(&self) -> [u32; NODES_OF_FRAME] {
        [0, 1, 2, 3].map(|own| self.first + own)
    }

    /// Reference positions of its nodes.
    pub(crate) fn points(&self) -> [[f64; 3]; NODES_OF_FRAME] {
        let along = |axis: usize| {
            let mut point = self.body.centre;
            point[axis] += self.size;
            point
        };
        [self.body.centre, along(0), along(1), along(2)]
    }

    /// The mass of each pair of its nodes.
    pub(crate) fn masses(&self) -> [[f64; NODES_OF_FRAME]; NODES_OF_FRAME] {
        let E = self.second_moments().map(|row| row.map(|entry| entry / (self.size * self.size)));
        let mut masses = [[0.0; NODES_OF_FRAME]; NODES_OF_FRAME];
        masses[0][0] = self.body.mass;
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            masses[0][0] += E[i][j];
            masses[0][j + 1] -= E[i][j];
            masses[i + 1][0] -= E[i][j];
            masses[i + 1][j + 1] += E[i][j];
        }
        masses
    }

    /// Adds the inertia to the mass of each coupling; the mass of the centre is a point mass.
    pub(crate) fn add_inertia(&self, pattern: &Pattern, mass: &mut [f64]) {
        let (nodes, masses) = (self.nodes(), self.masses());
        for (i, j) in (0..NODES_OF_FRAME).flat_map(|i| (0..NODES_OF_FRAME).map(move |j| (i, j))) {
            let point_mass = if i + j == 0 { self.body.mass } else { 0.0 };
            mass[pattern.coupling(nodes[i] as usize, nodes[j] as usize)] += masses[i][j] - point_mass;
        }
    }

    /// Mass, centre and inertia.
    pub(crate) fn summary(&self) -> RegionSummary {
        let RigidBody { name, mass, centre, inertia } = self.body.clone();
        let point = RegionSummary::of_point(mass, centre);
        RegionSummary { group: Some(name), inertia, ..point }
    }

    /// A direction that turns with the body.
    pub(crate) fn vector(&self, direction: [f64; 3]) -> Affine {
        let c = direction.map(|d| d / self.size);
        let weights = vec![-(c[0] + c[1] + c[2]), c[0], c[1], c[2]];
        Affine { nodes: self.nodes().to_vec(), weights, reference: direction }
    }

    /// A point of the body.
    pub(crate) fn point(&self, point: [f64; 3]) -> Affine {
        let arm = [0, 1, 2].map(|d| point[d] - self.body.centre[d]);
        let mut affine = self.vector(arm);
        affine.weights[0] += 1.0;
        Affine { reference: point, ..affine }
    }

    /// The constraints that keep it rigid.
    pub(crate) fn constraints(&self) -> Vec<Constraint> {
        let axis = |i: usize| {
            let mut direction = [0.0; 3];
            direction[i] = self.size;
            self.vector(direction)
        };
        let pairs = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
        let constraint = |(i, j)| {
            let factor = if i == j { 0.5 } else { 1.0 };
            let value = if i == j { 0.5 * self.size * self.size } else { 0.0 };
            Constraint { pairs: vec![(axis(i), axis(j), factor)], value }
        };
        pairs.map(constraint).collect()
    }
}

/// Least second moment of the mass over the trace of the inertia: below, a direction of the frame has no mass.
const LEAST_MOMENT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_have_the_kinetic_energy_of_a_rigid_body() {
        let mut body = RigidBody::new("top", 2.0, [0.3, -0.2, 1.0], [0.4, 0.5, 0.7]);
        (body.inertia[0][1], body.inertia[1][0]) = (0.05, 0.05);
        let frame = Frame::new(&body, 0).unwrap();
        let (spin, drift) = ([0.3, -1.1, 0.7], [0.5, 0.1, -0.4]);
        let velocity = |X: [f64; 3]| {
            let r = [0, 1, 2].map(|d| X[d] - body.centre[d]);
            let turned = crate::tensor::cross(spin, r);
            [0, 1, 2].map(|d| drift[d] + turned[d])
        };
        let v = frame.points().map(velocity);
        let masses = frame.masses();
        let mut energy = 0.0;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            energy += 0.5 * masses[i][j] * (0..3).map(|d| v[i][d] * v[j][d]).sum::<f64>();
        }
        let of_spin: f64 =
            (0..3).map(|i| (0..3).map(|j| spin[i] * body.inertia[i][j] * spin[j]).sum::<f64>()).sum();
        let of_drift: f64 = drift.iter().map(|v| v * v).sum();
        assert!((energy - (0.5 * of_spin + of_drift)).abs() < 1e-14);
        let points = frame.points();
        let tip = frame.point([1.0, 2.0, -3.0]);
        for d in 0..3 {
            let own: f64 = tip.weights.iter().zip(&points).map(|(w, X)| w * X[d]).sum();
            assert!((own - tip.reference[d]).abs() < 1e-14);
        }
        assert!(frame.constraints().iter().all(|row| row.value(&|_| 0.0).abs() < 1e-15));
    }

    #[test]
    fn moments_that_no_body_has_are_refused() {
        for moments in [[0.9, 0.3, 0.4], [0.0, 0.1, 0.1], [-0.1, 0.2, 0.2], [f64::NAN, 0.1, 0.1]] {
            let body = RigidBody::new("rod", 1.0, [0.0; 3], moments);
            assert!(matches!(Frame::new(&body, 0), Err(Error::Inertia { .. })), "{moments:?}");
        }
    }
}
