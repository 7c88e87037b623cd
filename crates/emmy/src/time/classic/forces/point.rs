//! Forces at one configuration and time, with the book of a step, for steppers from outside.

use super::{Forces, TimePoint};
use crate::body::{Body, Reaction};
use crate::error::Result;
use crate::time::Impulses;

/// Forces of a body at one displacement and time, with the memory to evaluate them again and again, and the book that a
/// stepper keeps of a step: work and impulses of loads and reactions.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::time::PointForces;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let weight = Load::acceleration([0.0, 0.0, -10.0]);
/// let held = Support::fixed("body");
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).support(held).load(weight).build()?;
/// let mut forces = PointForces::new(&body)?;
/// let net = forces.evaluate(&[0.0; 24], 0.0)?;
/// assert!((net.iter().sum::<f64>() + 20.0).abs() < 1e-13); // m g
/// forces.begin();
/// forces.book(0.5, &[0.0; 24], None)?; // half a second, at rest
/// let impulses = forces.end(0.5);
/// // The support carries the weight: no impulse, no work.
/// assert!(impulses.linear[2].abs() < 1e-13 && impulses.work == 0.0);
/// assert!((forces.reactions()[0].force[2] - 20.0).abs() < 1e-13);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// Viscosity and drag are not among the forces; see [`Body::damping`].
#[derive(Debug)]
pub struct PointForces<'a> {
    forces: Forces<'a>,
    point: TimePoint,
    net: Vec<f64>,
    zero: Vec<f64>,
    /// Forces of the springs of supports at the point.
    springs: Vec<Reaction>,
    impulses: Impulses,
    /// Impulses of the supports in the step; their means at its end.
    reactions: Vec<Reaction>,
}

impl<'a> PointForces<'a> {
    /// The memory for a body.
    ///
    /// # Errors
    /// [`crate::Error::NotOnTeam`] for a part of a body.
    pub fn new(body: &'a Body) -> Result<Self> {
        body.space.check_whole("a scheme from outside")?;
        Ok(PointForces {
            forces: Forces::new(body),
            point: TimePoint::new(body),
            net: vec![0.0; body.n_dofs()],
            zero: vec![0.0; body.n_dofs()],
            springs: body.space.no_reactions(),
            impulses: Impulses::default(),
            reactions: body.space.no_reactions(),
        })
    }

    /// The body.
    pub fn body(&self) -> &'a Body {
        self.forces.body
    }

    /// Evaluates the forces at a displacement `[n_nodes][3]` and a time, and returns the net force on all degrees of
    /// freedom, `F(t, u) - f(u)`, `[n_nodes][3]` \[force\]. At a jump of a load the force after it counts.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`]; [`crate::Error::NotFiniteAt`] for a load; [`crate::Error::Length`].
    pub fn evaluate(&mut self, displacement: &[f64], time: f64) -> Result<&[f64]> {
        self.body().check_vector("a displacement", displacement)?;
        self.point.displacement.copy_from_slice(displacement);
        self.point.evaluate(&mut self.forces, time)?;
        self.net.copy_from_slice(&self.point.force);
        self.springs.copy_from_slice(&self.point.reactions);
        Ok(&self.net)
    }

    /// The net force evaluated last.
    pub fn net(&self) -> &[f64] {
        &self.net
    }

    /// All loads F evaluated last, `[n_nodes][3]` \[force\].
    pub fn external(&self) -> &[f64] {
        &self.point.external
    }

    /// The internal force f evaluated last, springs and attractions to the ground included, `[n_nodes][3]` \[force\].
    pub fn internal(&self) -> &[f64] {
        self.forces.internal()
    }

    /// Begins the book of a step.
    pub fn begin(&mut self) {
        self.impulses = Impulses::default();
        self.reactions.fill(Reaction::default());
    }

    /// Books that the forces evaluated last act for a time \[time\], while the body has a mean velocity v,
    /// `[n_nodes][3]`.
    ///
    /// ```math
    /// W += dt (F + lambda) . v,    I += dt (F + lambda),    J += dt q x (F + lambda),    lambda = M a + f - F
    /// ```
    ///
    /// with the reactions lambda of the held degrees of freedom; the force on springs and attractions to the ground has
    /// impulses, too. `inertia`: M a there, `[n_nodes][3]`; `None`: zero, which is right for supports at rest and the
    /// lumped mass.
    ///
    /// # Errors
    /// [`crate::Error::Length`].
    pub fn book(&mut self, duration: f64, velocity: &[f64], inertia: Option<&[f64]>) -> Result<()> {
        let body = self.body();
        let inertia = inertia.unwrap_or(&self.zero);
        body.check_vector("a velocity", velocity)?;
        body.check_vector("an inertia", inertia)?;
        let held = body.fixed().iter().enumerate().filter(|(_, fixed)| **fixed);
        let of_supports: f64 = held.map(|(dof, _)| (inertia[dof] - self.net[dof]) * velocity[dof]).sum();
        self.impulses.work += duration * (body.space.dot(&self.point.external, velocity) + of_supports);
        self.point.force.copy_from_slice(&self.net);
        self.point.reactions.copy_from_slice(&self.springs);
        self.point.set_reactions(body, inertia);
        self.impulses.add_force(body, duration, &self.point.displacement, &self.point.force);
        self.reactions.iter_mut().zip(&self.point.reactions).for_each(|(sum, own)| sum.add(duration, own));
        Ok(())
    }

    /// Ends the book of a step of a size: [`PointForces::reactions`] are then the means over the step. Returns work and
    /// impulses.
    pub fn end(&mut self, step_size: f64) -> Impulses {
        let mean = |sum: &mut Reaction| {
            let impulse = std::mem::take(sum);
            sum.add(1.0 / step_size, &impulse);
        };
        self.reactions.iter_mut().for_each(mean);
        self.impulses
    }

    /// Reactions of the step, in the order of [`Body::supported_groups`], for [`crate::time::Stepper::reactions`].
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }
}
