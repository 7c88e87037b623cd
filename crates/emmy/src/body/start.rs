//! Start of a motion.

use std::ops::Range;

use super::constrained_velocity::ConstrainedVelocity;
use super::system::Body;
use crate::error::{Error, Result};
use crate::input::InitialVelocity;
use crate::nodal;

/// Part of the momentum of a node at the largest velocity that rounding may change, also by the solution of
/// `M v = p` for driven bodies.
const OF_ROUNDING: f64 = 1e-8;

/// Shift to the side of a kink after it.
const SHIFT: f64 = 1e-12;

impl Body {
    /// Displacement of the incompatible modes, `[n_internal][3]`: that of the internal nodes less the mean over their
    /// cells.
    #[doc(hidden)]
    pub fn modes_of(&self, displacement: &[f64]) -> Vec<f64> {
        let mut means = displacement.to_vec();
        self.space.set_internal_means(&mut means);
        let dofs = self.mesh().n_dofs()..self.n_dofs();
        displacement[dofs.clone()].iter().zip(&means[dofs]).map(|(u, mean)| u - mean).collect()
    }

    /// The displacement of all nodes with some [`Body::modes_of`], from that of the nodes of the mesh.
    #[doc(hidden)]
    pub fn with_modes(&self, mut displacement: Vec<f64>, modes: &[f64]) -> Vec<f64> {
        let n = displacement.len();
        displacement.resize(self.n_dofs(), 0.0);
        self.space.set_internal_means(&mut displacement);
        displacement[n..].iter_mut().zip(modes).for_each(|(u, mode)| *u += mode);
        displacement
    }

    /// Momentum and velocity of an initial velocity field at a time: `(p, v)`, both `[n_nodes][3]`. Fixed components
    /// are at rest, driven ones follow their motion.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::NotFiniteAt`].
    pub(crate) fn initial_motion(
        &self,
        time: f64,
        displacement: &[f64],
        fields: &[InitialVelocity],
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut velocity = self.given_velocity(time, fields)?;
        if !self.constraints().is_empty() {
            let due = self.at(time);
            ConstrainedVelocity::new(due)?.project(due, [time, SHIFT], displacement, &mut velocity)?;
        }
        let momentum = self.momentum_of(time, &mut velocity)?;
        Ok((momentum, velocity))
    }

    /// Kinetic energies of an initial velocity field at a time: as it is given, and of what joints allow of it, with
    /// which a motion begins.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let between = [JointEnd::Rigid("ball".into()), JointEnd::Ground];
    /// let rod = Joint::new("rod", JointKind::Distance { to: [0.0; 3] }, between, [1.0, 0.0, 0.0]);
    /// let ball = RigidBody::point("ball", 2.0, [1.0, 0.0, 0.0]);
    /// let body = Body::builder(Mesh::without_cells()).rigid(ball).joint(rod).build()?;
    /// let pushed = InitialVelocity { velocity: [3.0, 4.0, 0.0], ..Default::default() };
    /// let [given, allowed] = body.initial_energies(0.0, &[pushed])?;
    /// assert!((given - 25.0).abs() < 1e-13 && (allowed - 16.0).abs() < 1e-13);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::NotFinite`], [`Error::NotFiniteAt`], [`Error::Linear`].
    pub fn initial_energies(&self, time: f64, fields: &[InitialVelocity]) -> Result<[f64; 2]> {
        let mut given = self.given_velocity(time, fields)?;
        let momentum = self.momentum_of(time, &mut given)?;
        let displacement = vec![0.0; self.n_dofs()];
        let (allowed_momentum, allowed) = self.initial_motion(time, &displacement, fields)?;
        let energy = |p: &[f64], v: &[f64]| 0.5 * self.space.dot(p, v);
        Ok([energy(&momentum, &given), energy(&allowed_momentum, &allowed)])
    }

    /// An initial velocity field at a time, as it is given; [`Body::initial_motion`] takes what joints allow of it.
    fn given_velocity(&self, time: f64, fields: &[InitialVelocity]) -> Result<Vec<f64>> {
        let mut velocity = vec![0.0; self.n_dofs()];
        for field in fields {
            let nodes = match &field.group {
                Some(name) => match self.nodes_of_rigid_body(name) {
                    Some(nodes) => nodes.collect(),
                    None => self.mesh().volume_nodes(name)?,
                },
                None => (0..self.mesh().n_nodes() as u32).collect(),
            };
            let mut set = nodes.into_iter().map(|node| {
                let v = field.at(self.mesh().points()[node as usize]);
                *nodal::at_mut(&mut velocity, node as usize) = v;
                let wrong = v.into_iter().find(|value| !value.is_finite());
                wrong.map_or(Ok(()), |value| Err(Error::NotFinite { what: "initial velocity".into(), value }))
            });
            self.space.agree(set.find(Result::is_err).unwrap_or(Ok(())))?;
        }
        self.space.ties().set_points(&mut velocity);
        self.space.complete("initial velocity", &mut velocity);
        self.space.set_internal_means(&mut velocity);
        let ends = self.rigid_bodies().filter_map(|own| self.nodes_of_rigid_body(&own.name));
        let centre = |nodes: Range<u32>| (nodal::at(&velocity, nodes.start as usize), nodes);
        let bodies: Vec<([f64; 3], Range<u32>)> = ends.map(centre).collect();
        self.space.set_given_velocity(time, 0.0, &mut velocity)?;
        // A rigid body whose centre has a given motion keeps its spin.
        for (before, mut nodes) in bodies {
            let now = nodes.next().map_or(before, |centre| nodal::at(&velocity, centre as usize));
            for end in nodes {
                let own = nodal::at_mut(&mut velocity, end as usize);
                (0..3).for_each(|d| own[d] += now[d] - before[d]);
            }
        }
        self.space.follow(&mut velocity);
        Ok(velocity)
    }

    /// Momentum of a velocity whose fixed and driven components are set to their given motion at a time.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    pub(crate) fn momentum_of(&self, time: f64, velocity: &mut [f64]) -> Result<Vec<f64>> {
        self.space.set_given_velocity(time, 0.0, velocity)?;
        let mut momentum = vec![0.0; self.n_dofs()];
        self.mass_product(velocity, &mut momentum);
        Ok(momentum)
    }

    /// Checks that the motion at a start belongs to the body: p = M v, and nodes that a support holds are at rest.
    /// Momenta of the lumped mass, which central differences have, become M v.
    ///
    /// # Errors
    /// [`Error::StartMomentum`], [`Error::StartHeld`].
    pub(crate) fn fit_momentum(&self, velocity: &[f64], momentum: &mut [f64]) -> Result<()> {
        let norm = |vector: [f64; 3]| vector.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let at = |field: &[f64], node: usize| nodal::at(field, node);
        let nodes = || 0..self.mesh().n_nodes();
        let (_, fastest) = self.space.largest_node(nodes().map(|node| norm(at(velocity, node))));

        let mut held = self.fixed().to_vec();
        self.space.driven_dofs().for_each(|dof| held[dof] = false);
        self.space.ties().dofs().for_each(|dof| held[dof] = false);
        let at_held = |node: usize| nodal::at(&held, node);
        let held_velocity =
            |node| [0, 1, 2].map(|d| if at_held(node)[d] { at(velocity, node)[d] } else { 0.0 });
        let (node, speed) = self.space.largest_node(nodes().map(|node| norm(held_velocity(node))));
        if speed > OF_ROUNDING * fastest {
            return Err(Error::StartHeld {
                node,
                velocity: self.space.at_node(node, |node| at(velocity, node)),
            });
        }

        let mut product = vec![0.0; self.n_dofs()];
        self.mass_product(velocity, &mut product);
        let lumped = |node: usize| at(velocity, node).map(|v| self.lumped_mass[node] * v);
        let worst = |momentum: &[f64], of_velocity: &dyn Fn(usize) -> [f64; 3]| {
            self.space.largest_node(nodes().map(|node| {
                let (p, other) = (at(momentum, node), of_velocity(node));
                let differences = [0, 1, 2].map(|d| (p[d] - other[d]).abs());
                let fits = |difference| difference <= OF_ROUNDING * self.lumped_mass[node] * fastest;
                // A number that is not finite fits nothing.
                if differences.into_iter().all(fits) { 0.0 } else { norm(differences).max(f64::MIN_POSITIVE) }
            }))
        };
        let (node, excess) = worst(momentum, &|node| at(&product, node));
        if excess == 0.0 {
            return Ok(());
        }
        if worst(momentum, &lumped).1 == 0.0 {
            momentum.copy_from_slice(&product);
            return Ok(());
        }
        let [momentum, product] =
            [&*momentum, &product].map(|p| self.space.at_node(node, |node| at(p, node)));
        Err(Error::StartMomentum { node, momentum, product })
    }

    /// Checks that driven nodes are where their motion begins.
    ///
    /// # Errors
    /// [`Error::DrivenStart`].
    pub(crate) fn check_start(&self, time: f64, displacement: &[f64]) -> Result<()> {
        if !self.is_driven() {
            return Ok(());
        }
        let distance = self.space.driven_distance(time, displacement);
        let size = self.mesh().bounds().iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
        // Rounding in an expression that is exactly zero is not a displacement.
        if distance <= 1e-12 * size {
            return Ok(());
        }
        Err(Error::DrivenStart { time, distance })
    }
}
