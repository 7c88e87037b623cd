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

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::affine::Affine;
use super::constraint::Constraint;
use crate::error::{Error, Result};
use crate::input::RigidBody;
use crate::mass::RegionSummary;
use crate::mesh::{Mesh, distance};
use crate::nodal;
use crate::space::RigidFollowers;
use crate::sparse::Pattern;
use crate::tensor::{cross, dot3, eigen};

/// A rigid body in a mesh. A point mass has a node alone.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    body: RigidBody,
    /// Position of P_0.
    centre: [f64; 3],
    /// Node of the centre; those of the axes follow.
    first: u32,
    /// s, the radius of gyration of the mass, or without it of the nodes of a group; 0 of a point mass.
    size: f64,
    /// Nodes of the group, ascending.
    members: Vec<u32>,
}

/// Position and motion of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RigidMotion {
    /// Position of the centre \[length\].
    pub position: [f64; 3],
    /// Velocity of the centre \[length/time\].
    pub velocity: [f64; 3],
    /// Angular velocity in the axes of space \[1/time\]; 0 of a point mass.
    pub spin: [f64; 3],
    /// Its axes, which are along x, y and z in the drawing; zeros of a point mass.
    pub axes: [[f64; 3]; 3],
}

impl Frame {
    /// The frame of a rigid body whose nodes begin with a number, without a group.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a mass; [`Error::Inertia`] for moments that no body has; [`Error::Rigid`] without a
    /// centre.
    pub(crate) fn new(body: &RigidBody, first: u32) -> Result<Self> {
        let RigidBody { name, mass, inertia, .. } = body;
        if !(*mass > 0.0 && mass.is_finite()) {
            let what = format!("mass of the rigid body \"{name}\"");
            return Err(Error::NotPositive { what, value: *mass });
        }
        let Some(centre) = body.centre else {
            let reason = "it needs a centre, or a group".to_string();
            return Err(Error::Rigid { body: name.clone(), reason });
        };
        let point = Frame { body: body.clone(), centre, first, size: 0.0, members: Vec::new() };
        let Some(J) = inertia else { return Ok(point) };
        let trace = J[0][0] + J[1][1] + J[2][2];
        let E = second_moments(J);
        let (moments, _) = eigen(&[E[0][0], E[1][1], E[2][2], E[0][1], E[1][2], E[0][2]]);
        let mut moments = moments;
        moments.sort_by(f64::total_cmp);
        let is_symmetric = (0..3).all(|i| (0..3).all(|j| J[i][j] == J[j][i] && J[i][j].is_finite()));
        // A flat body has a moment of zero, a rod two.
        let has_moments = moments[0] > -LEAST_MOMENT * trace && trace > 0.0;
        if !(is_symmetric && has_moments) {
            return Err(Error::Inertia { body: name.clone(), inertia: *J });
        }
        Ok(Frame { size: (0.5 * trace / mass).sqrt(), ..point })
    }

    /// The frame of a rigid body with the nodes of a group; `centre`: that of the mass of its cells, if it has any.
    ///
    /// # Errors
    /// As [`Frame::new`]; [`Error::Rigid`] for nodes that have no directions.
    pub(crate) fn of_group(
        body: &RigidBody,
        first: u32,
        mesh: &Mesh,
        members: Vec<u32>,
        centre: Option<[f64; 3]>,
    ) -> Result<Self> {
        let points = || members.iter().map(|&node| mesh.points()[node as usize]);
        let mean = || {
            points()
                .fold([0.0; 3], |sum, X| [0, 1, 2].map(|d| sum[d] + X[d]))
                .map(|x| x / members.len() as f64)
        };
        let centre = body.centre.or(centre).unwrap_or_else(mean);
        let body = RigidBody { centre: Some(centre), ..body.clone() };
        if body.mass != 0.0 || body.inertia.is_some() {
            let own = Frame::new(&body, first)?;
            if own.size > 0.0 {
                return Ok(Frame { members, ..own });
            }
        }
        let square: f64 = points().map(|X| distance(X, centre).powi(2)).sum();
        let size = (square / members.len() as f64).sqrt();
        if size == 0.0 {
            return Err(without_directions(&body));
        }
        Ok(Frame { body, centre, first, size, members })
    }

    /// Its name.
    pub(crate) fn name(&self) -> &str {
        &self.body.name
    }

    /// Position of its centre in the reference configuration.
    pub(crate) fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// Its data; those of a group with its centre.
    pub(crate) fn body(&self) -> &RigidBody {
        &self.body
    }

    /// Numbers of its nodes: the centre, and the ends of three axes if it has directions.
    pub(crate) fn nodes(&self) -> Range<u32> {
        self.first..self.first + if self.body.has_axes() { 4 } else { 1 }
    }

    /// The direction of a rod, which has second moments of its mass along it alone.
    pub(super) fn rod_axis(&self) -> [f64; 3] {
        let E = second_moments(&self.body.inertia.unwrap_or_default());
        let largest = (1..3).fold(0, |best, d| if E[d][d] > E[best][best] { d } else { best });
        let length = E[largest].iter().map(|e| e * e).sum::<f64>().sqrt();
        E[largest].map(|e| e / length)
    }

    /// Whether it has a group.
    pub(crate) fn has_members(&self) -> bool {
        !self.members.is_empty()
    }

    /// The nodes of its group with their weights.
    pub(crate) fn followers(&self, mesh: &Mesh) -> RigidFollowers {
        let follower = |&node: &u32| {
            let Affine { nodes, weights, .. } = self.point(mesh.points()[node as usize])?;
            Some((node, nodes.into_iter().zip(weights).collect()))
        };
        RigidFollowers {
            body: self.body.name.clone(),
            nodes: self.members.iter().filter_map(follower).collect(),
        }
    }

    /// Whether it moves all of some nodes, those of a cell: then the cell is not strained.
    pub(crate) fn moves<'t>(&self, nodes: &[u32], leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]>) -> bool {
        let own = self.nodes();
        let is_own =
            |node: u32| leaders(node).is_some_and(|all| all.iter().all(|(leader, _)| own.contains(leader)));
        !self.members.is_empty() && nodes.iter().all(|&node| is_own(node))
    }

    /// Reference positions of its nodes.
    pub(crate) fn points(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.nodes().map(|node| {
            let mut point = self.centre;
            if let Some(axis) = (node - self.first).checked_sub(1) {
                point[axis as usize] += self.size;
            }
            point
        })
    }

    /// The mass of each pair of its nodes, `[n][n]`.
    pub(crate) fn masses(&self) -> Vec<f64> {
        let n = self.nodes().len();
        let mut masses = vec![0.0; n * n];
        masses[0] = self.body.mass;
        let Some(J) = &self.body.inertia else { return masses };
        let E = second_moments(J).map(|row| row.map(|entry| entry / (self.size * self.size)));
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            masses[0] += E[i][j];
            masses[j + 1] -= E[i][j];
            masses[(i + 1) * n] -= E[i][j];
            masses[(i + 1) * n + j + 1] += E[i][j];
        }
        masses
    }

    /// The product `u . M u` of a nodal field `[n_nodes][3]` less that of the mass in the centre.
    pub(crate) fn turning_square(&self, field: &[f64]) -> f64 {
        let at = |node: u32| nodal::at(field, node as usize);
        let pairs = self.nodes().flat_map(|a| self.nodes().map(move |b| (a, b)));
        let products = pairs.zip(self.masses()).map(|((a, b), mass)| mass * dot3(at(a), at(b)));
        let centre = at(self.first);
        products.sum::<f64>() - self.body.mass * dot3(centre, centre)
    }

    /// Adds the inertia to the mass of each coupling; the mass of the centre is a point mass.
    pub(crate) fn add_inertia(&self, pattern: &Pattern, mass: &mut [f64]) {
        let pairs = self.nodes().flat_map(|a| self.nodes().map(move |b| (a, b)));
        for (at, ((a, b), own)) in pairs.zip(self.masses()).enumerate() {
            let point_mass = if at == 0 { self.body.mass } else { 0.0 };
            mass[pattern.coupling(a as usize, b as usize)] += own - point_mass;
        }
    }

    /// Mass, centre and inertia; of a group what is added to the masses of its nodes.
    pub(crate) fn summary(&self) -> RegionSummary {
        let RigidBody { name, mass, inertia, .. } = self.body.clone();
        let point = RegionSummary::of_point(mass, self.centre);
        RegionSummary { group: Some(name), inertia: inertia.unwrap_or(point.inertia), ..point }
    }

    /// Position and motion at displacements and velocities of the nodes.
    pub(crate) fn motion(&self, u: &dyn Fn(usize) -> f64, v: &dyn Fn(usize) -> f64) -> RigidMotion {
        let at = |vectors: &dyn Fn(usize) -> f64, node: usize| {
            [0, 1, 2].map(|d| vectors(nodal::dof(self.first as usize + node, d)))
        };
        let centre = at(u, 0);
        let position = [0, 1, 2].map(|d| self.centre[d] + centre[d]);
        let velocity = at(v, 0);
        if !self.body.has_axes() {
            return RigidMotion { position, velocity, ..RigidMotion::default() };
        }
        let (mut axes, mut spin) = ([[0.0; 3]; 3], [0.0; 3]);
        for i in 0..3 {
            let (end, rate) = (at(u, i + 1), at(v, i + 1));
            axes[i] = [0, 1, 2].map(|d| (end[d] - centre[d]) / self.size + if d == i { 1.0 } else { 0.0 });
            // omega = 1/2 sum_i a_i x a_i'
            let turning = cross(axes[i], [0, 1, 2].map(|d| (rate[d] - velocity[d]) / self.size));
            (0..3).for_each(|d| spin[d] += 0.5 * turning[d]);
        }
        RigidMotion { position, velocity, spin, axes }
    }

    /// A direction that turns with the body; `None` of a point mass.
    pub(crate) fn vector(&self, direction: [f64; 3]) -> Option<Affine> {
        if !self.body.has_axes() {
            return None;
        }
        let c = direction.map(|d| d / self.size);
        let weights = vec![-(c[0] + c[1] + c[2]), c[0], c[1], c[2]];
        Some(Affine { nodes: self.nodes().collect(), weights, reference: direction })
    }

    /// A point of the body; of a point mass `None` but for the centre.
    pub(crate) fn point(&self, point: [f64; 3]) -> Option<Affine> {
        let arm = [0, 1, 2].map(|d| point[d] - self.centre[d]);
        let mut affine = self.vector(arm).or_else(|| {
            let size = |vector: [f64; 3]| vector.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let is_centre = size(arm) <= ROUNDING * size(point);
            is_centre.then(|| Affine { nodes: vec![self.first], weights: vec![0.0], reference: point })
        })?;
        affine.weights[0] += 1.0;
        Some(Affine { reference: point, ..affine })
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
            Some(Constraint::new(vec![(axis(i)?, axis(j)?, factor)], value))
        };
        pairs.filter_map(constraint).collect()
    }
}

/// The fault of nodes that leave a direction without a mass and without a constraint.
pub(super) fn without_directions(body: &RigidBody) -> Error {
    let group = body.group.as_deref().unwrap_or_default();
    let reason = format!(
        "the nodes of \"{group}\" lie on a line, about which nothing holds the body; add a node off it, or give mass, \
         centre and inertia"
    );
    Error::Rigid { body: body.name.clone(), reason }
}

/// E, the second moments of the mass of a body with an inertia.
fn second_moments(J: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let half = 0.5 * (J[0][0] + J[1][1] + J[2][2]);
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { half - J[i][j] } else { -J[i][j] }))
}

/// Distance of a joint from a point mass, over the coordinates, that is rounding.
const ROUNDING: f64 = 1e-12;

/// Rounding of a second moment of the mass over the trace of the inertia.
const LEAST_MOMENT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_have_the_kinetic_energy_of_a_rigid_body() {
        let centre = [0.3, -0.2, 1.0];
        let mut body = RigidBody::new("top", 2.0, centre, [0.4, 0.5, 0.7]);
        let mut inertia = body.inertia.unwrap();
        (inertia[0][1], inertia[1][0]) = (0.05, 0.05);
        body.inertia = Some(inertia);
        let frame = Frame::new(&body, 0).unwrap();
        let (spin, drift) = ([0.3, -1.1, 0.7], [0.5, 0.1, -0.4]);
        let velocity = |X: [f64; 3]| {
            let r = [0, 1, 2].map(|d| X[d] - centre[d]);
            let turned = cross(spin, r);
            [0, 1, 2].map(|d| drift[d] + turned[d])
        };
        let v: Vec<[f64; 3]> = frame.points().map(velocity).collect();
        let masses = frame.masses();
        let mut energy = 0.0;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            energy += 0.5 * masses[4 * i + j] * (0..3).map(|d| v[i][d] * v[j][d]).sum::<f64>();
        }
        let of_spin: f64 =
            (0..3).map(|i| (0..3).map(|j| spin[i] * inertia[i][j] * spin[j]).sum::<f64>()).sum();
        let of_drift: f64 = drift.iter().map(|v| v * v).sum();
        assert!((energy - (0.5 * of_spin + of_drift)).abs() < 1e-14);
        let points: Vec<[f64; 3]> = frame.points().collect();
        let tip = frame.point([1.0, 2.0, -3.0]).unwrap();
        for d in 0..3 {
            let own: f64 = tip.weights.iter().zip(&points).map(|(w, X)| w * X[d]).sum();
            assert!((own - tip.reference[d]).abs() < 1e-14);
        }
        assert!(frame.constraints().iter().all(|row| row.value(&|_| 0.0).abs() < 1e-15));
    }

    #[test]
    fn a_point_mass_has_no_other_point() {
        let mass = RigidBody { inertia: None, ..RigidBody::new("mass", 1.0, [1.0, 0.0, -2.0], [0.0; 3]) };
        let mass = Frame::new(&mass, 0).unwrap();
        assert!(mass.point([1.0, 1e-13, -2.0]).is_some());
        for other in
            [[1.0, 0.0, 0.0], [0.0, 0.0, -2.0], [1.0, 5.0, -2.0], [1.0 + 1e-9, 0.0, -2.0], [1.0, 0.0, -2.5]]
        {
            assert!(mass.point(other).is_none(), "{other:?}");
        }
    }

    #[test]
    fn moments_that_no_body_has_are_refused() {
        for moments in [[0.9, 0.3, 0.4], [0.0; 3], [-0.1, 0.2, 0.2], [f64::NAN, 0.1, 0.1]] {
            let body = RigidBody::new("rod", 1.0, [0.0; 3], moments);
            assert!(matches!(Frame::new(&body, 0), Err(Error::Inertia { .. })), "{moments:?}");
        }
    }
}
