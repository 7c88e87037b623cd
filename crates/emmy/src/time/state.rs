//! State of a motion.

use serde::{Deserialize, Serialize};

use crate::body::Body;
use crate::error::Result;
use crate::input::InitialVelocity;
use crate::nodal;
use crate::tensor::cross;

/// State of a body in motion.
///
/// It holds the displacement, not the position, which would lose the digits of small strains
/// (`book/src/design/cells.md`).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Time \[time\].
    pub time: f64,
    /// Number of steps done.
    pub step: usize,
    /// Displacement u = q - X, `[n_nodes][3]` \[length\].
    pub displacement: Vec<f64>,
    /// Momentum p = M v, `[n_nodes][3]` \[mass length/time\]; M is the consistent mass, for central differences the
    /// lumped one.
    pub momentum: Vec<f64>,
    /// Velocity v = M^-1 p, `[n_nodes][3]` \[length/time\].
    pub velocity: Vec<f64>,
    /// Low part of the displacement, `[n_nodes][3]` \[length\]; empty: zero. The sum of both parts has twice the
    /// digits, so that a body keeps the digits of its strains in a long flight.
    pub displacement_low: Vec<f64>,
    /// Linear momentum that rounding has added to a free body \[mass length/time\]; the next steps remove it. Far from
    /// the origin it would have a long lever.
    pub momentum_error: [f64; 3],
    /// Whether the displacement is the equilibrium under the loads of the time, from which a motion starts
    /// ([`crate::equilibrium::Equilibrium::start`]): it then depends on the parameters of the body. A step ends this.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_equilibrium: bool,
    /// History variables of the forces, in their order; later steps depend on them besides the motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub history: Vec<f64>,
    /// Angles \[rad\], slides and distances \[length\] of the joints, in their order; angles are counted on over full
    /// turns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coordinates: Vec<f64>,
}

impl State {
    /// The undeformed body with an initial velocity field (at rest without one).
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], [`crate::Error::NotFinite`], [`crate::Error::DrivenStart`].
    pub fn initial(body: &Body, time: f64, fields: &[InitialVelocity]) -> Result<Self> {
        State::displaced(body, time, vec![0.0; body.n_dofs()], fields)
    }

    /// The body at a displacement `[n_nodes][3]` with an initial velocity field. A displacement of the nodes of the
    /// mesh alone has incompatible modes of zero.
    ///
    /// # Errors
    /// As [`State::initial`]; [`crate::Error::DrivenStart`] if a driven node is not where its motion begins.
    pub fn displaced(
        body: &Body,
        time: f64,
        mut displacement: Vec<f64>,
        fields: &[InitialVelocity],
    ) -> Result<Self> {
        let has_modes = displacement.len() != body.mesh().n_dofs();
        if !has_modes {
            displacement.resize(body.n_dofs(), 0.0);
        }
        if displacement.len() == body.n_dofs() {
            body.space.complete("displacement", &mut displacement);
        }
        if !has_modes {
            body.space.set_internal_means(&mut displacement);
        }
        body.check_start(time, &displacement)?;
        let (momentum, velocity) = body.initial_motion(time, &displacement, fields)?;
        let displacement_low = vec![0.0; body.n_dofs()];
        let coordinates = body.mechanism.coordinates(&displacement);
        Ok(State {
            time,
            step: 0,
            displacement,
            momentum,
            velocity,
            displacement_low,
            momentum_error: [0.0; 3],
            is_equilibrium: false,
            history: vec![0.0; body.n_history()],
            coordinates,
        })
    }

    /// The same displacement and velocity as the start of a motion of another body with the same mesh, from a time on:
    /// momentum `p = M v` of that body, velocity zero where it is fixed. Other incompatible modes, and forces with a
    /// history, start from zero, and angles of joints within half a turn.
    ///
    /// # Errors
    /// [`crate::Error::DrivenStart`] if a driven node is not where its motion begins; [`crate::Error::NotFiniteAt`] for
    /// a given motion whose rate is not a finite number there.
    pub fn transferred(mut self, body: &Body, time: f64) -> Result<Self> {
        if self.displacement.len() != body.n_dofs() {
            for field in [&mut self.displacement, &mut self.velocity, &mut self.displacement_low] {
                body.space.fit_without_modes(field);
            }
        }
        body.check_start(time, &self.displacement)?;
        let mut velocity = self.velocity;
        let momentum = body.momentum_of(time, &mut velocity)?;
        // The joints may be others.
        let coordinates = body.mechanism.coordinates(&self.displacement);
        Ok(State {
            time,
            step: 0,
            momentum,
            velocity,
            momentum_error: [0.0; 3],
            is_equilibrium: false,
            history: vec![0.0; body.n_history()],
            coordinates,
            ..self
        })
    }

    /// Copies another state of the same body without allocation.
    pub fn copy_from(&mut self, other: &State) {
        (self.time, self.step) = (other.time, other.step);
        self.displacement.copy_from_slice(&other.displacement);
        self.momentum.copy_from_slice(&other.momentum);
        self.velocity.copy_from_slice(&other.velocity);
        self.displacement_low.clone_from(&other.displacement_low);
        self.momentum_error = other.momentum_error;
        self.is_equilibrium = other.is_equilibrium;
        self.history.clone_from(&other.history);
        self.coordinates.clone_from(&other.coordinates);
    }

    /// Current position of a node.
    pub fn position(&self, body: &Body, node: usize) -> [f64; 3] {
        body.space.position(&self.displacement, node)
    }

    /// Displacement of the first node of a free body (on a team, of the first rank), zero for any other body: strains
    /// and forces do not depend on it.
    pub fn origin(&self, body: &Body) -> [f64; 3] {
        if body.is_free() { body.space.first_displacement(&self.displacement) } else { [0.0; 3] }
    }

    /// Sets the displacement relative to [`State::origin`], its low part included.
    pub fn set_relative_displacement(&self, body: &Body, relative: &mut [f64]) {
        let origin = self.origin(body);
        let low = self.displacement_low.iter().chain(std::iter::repeat(&0.0));
        for (dof, (relative, (u, low))) in
            relative.iter_mut().zip(self.displacement.iter().zip(low)).enumerate()
        {
            *relative = (u - origin[dof % 3]) + low;
        }
    }

    /// Angular momentum about the origin of space, the low part of the displacement included \[mass length^2/time\].
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let flies = InitialVelocity { velocity: [0.0, 3.0, 0.0], ..Default::default() };
    /// let state = State::initial(&body, 0.0, &[flies])?;
    /// assert!((state.angular_momentum(&body)[2] - 0.5 * 2.0 * 3.0).abs() < 1e-14); // arm, mass, velocity
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn angular_momentum(&self, body: &Body) -> [f64; 3] {
        let origin = self.origin(body);
        let mut total = [0.0; 3];
        let mut moment = [0.0; 3];
        // Internal nodes have no momentum.
        let nodes = body.mesh().points().iter().zip(self.momentum.as_chunks::<3>().0).enumerate();
        for (node, (X, p)) in nodes.take(body.space.own_nodes().end) {
            let low = self.displacement_low.as_chunks::<3>().0.get(node).copied().unwrap_or_default();
            let at = nodal::dof(node, 0);
            let q = [0, 1, 2].map(|d| X[d] + ((self.displacement[at + d] - origin[d]) + low[d]));
            add(&mut moment, cross(q, *p));
            add(&mut total, *p);
        }
        add(&mut moment, cross(origin, total));
        body.space.sum_ranks("angular momentum", &mut moment);
        moment
    }

    /// Adds an increment of the displacement at a degree of freedom, to both parts.
    pub(super) fn displace(&mut self, dof: usize, increment: f64) {
        let (high, error) = two_sum(self.displacement[dof], increment);
        let low = self.displacement_low[dof] + error;
        (self.displacement[dof], self.displacement_low[dof]) = two_sum(high, low);
    }

    /// Adds the change of the momentum since `before`, less an impulse, to the error of the momentum.
    pub(super) fn note_momentum_error(&mut self, body: &Body, before: &[f64], impulse: [f64; 3]) {
        let (mut high, mut low) = ([0.0; 3], [0.0; 3]);
        // A resumed motion begins with momenta of guests, which M v does not give.
        let nodes = self.momentum.as_chunks::<3>().0.iter().zip(before.as_chunks::<3>().0);
        for (p, before) in nodes.take(body.space.own_nodes().end) {
            for d in 0..3 {
                let (change, error) = two_sum(p[d], -before[d]);
                let (sum, rounding) = two_sum(high[d], change);
                (high[d], low[d]) = (sum, low[d] + error + rounding);
            }
        }
        body.space.sum_ranks("change of momentum", &mut high);
        body.space.sum_ranks("rounding of the change of momentum", &mut low);
        (0..3).for_each(|d| self.momentum_error[d] += (high[d] - impulse[d]) + low[d]);
    }
}

/// Sum and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

fn add(sum: &mut [f64; 3], vector: [f64; 3]) {
    (0..3).for_each(|d| sum[d] += vector[d]);
}
