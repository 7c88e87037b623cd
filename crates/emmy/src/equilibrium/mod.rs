//! Static equilibrium of a body under the loads of a time, found with growing loads.

use crate::average::Request;
use crate::body::Body;
use crate::error::Result;
use crate::input::InitialVelocity;
use crate::motion::{MarchError, Motion, NewtonSettings, Observer, Phase, State, StepPlan};
use crate::time::Scheme;
use crate::time::classic::{Forces, solve_stiffness};
use crate::unknowns::LinearConstraints;

/// The static equilibrium `f(u) = F(u, t)` of a body under the loads, pressures and driven supports of a time t.
///
/// All of them grow in proportion to a load fraction from 0 to 1, in equal increments; an increment that fails is cut
/// by two, down to 1/1024. On a team, conjugate gradients solve the linear systems, and a path is not checked for
/// stability under follower loads. The increments are the steps of a [`Motion`] whose time is the load fraction. Rigid
/// bodies and joints have multipliers, and their given motions and motors grow as well.
///
/// A bar under its own weight:
///
/// ```
/// use emmy::prelude::*;
/// use emmy::equilibrium::Equilibrium;
/// let steel = Region::new(SaintVenantKirchhoff::new(0.0, 1e9)?, 2.0); // Young's modulus 2e9, no lateral strain
/// let body = Body::builder(mesh::block([1.0, 1.0, 4.0], [1, 1, 4])?)
///     .region(steel)
///     .support(Support::fixed("z-max"))
///     .load(Load::acceleration([0.0, 0.0, -10.0]))
///     .build()?;
/// let state = Equilibrium::new(&body, 0.0, 1)?.start(NewtonSettings::default(), &[], &mut [])?;
/// let tip = 3 * body.mesh().nearest_node([0.0; 3]) + 2;
/// let exact = -2.0 * 10.0 * 4.0 * 4.0 / 2.0 / 2e9; // rho g L^2 / (2 E)
/// assert!((state.displacement[tip] / exact - 1.0).abs() < 1e-7);
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// assert!(motion.step(0.1)?.kinetic_energy < 1e-20); // it stays at rest
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Equilibrium<'a> {
    body: &'a Body,
    time: f64,
    /// The body under the loads of that time, in proportion to the load fraction.
    loaded: Body,
    plan: StepPlan,
}

impl<'a> Equilibrium<'a> {
    /// The equilibrium under the loads of a time, with a number of increments.
    ///
    /// # Errors
    /// [`crate::Error::Plan`] for no increments.
    pub fn new(body: &'a Body, time: f64, load_steps: usize) -> Result<Self> {
        Ok(Equilibrium { body, time, loaded: body.in_proportion(time), plan: increments(load_steps)? })
    }

    /// The increments, as steps from 0 to 1.
    pub fn plan(&self) -> &StepPlan {
        &self.plan
    }

    /// Checks that nothing is free to move as a rigid body.
    ///
    /// # Errors
    /// [`crate::Error::NotHeld`].
    pub fn check(&self) -> Result<()> {
        self.loaded.check_held()
    }

    /// The start of a motion from the equilibrium, with an initial velocity field (at rest without one). Observers see
    /// every increment.
    ///
    /// # Errors
    /// [`crate::Error::NotHeld`] if the body is free to move; [`crate::Error::NoEquilibrium`] if there is none;
    /// [`crate::Error::Singular`]; [`MarchError::Observer`] if an observer fails.
    pub fn start(
        &self,
        settings: NewtonSettings,
        fields: &[InitialVelocity],
        observers: &mut [&mut dyn Observer],
    ) -> Result<State, MarchError> {
        let rest = State::initial(&self.loaded, 0.0, &[])?;
        let mut motion = Motion::starting(&self.loaded, Scheme::Static, settings, rest)?;
        motion.allow_cuts(None);
        motion.march(&self.plan, observers)?;
        let State { displacement, coordinates, .. } = motion.state().clone();
        let state = State::displaced(self.body, self.time, displacement, fields)?;
        Ok(State { is_equilibrium: true, coordinates, ..state })
    }
}

/// Multipliers mu of the equations of equilibrium at a state, `K mu = g` at the free degrees of freedom; `gradient`: a
/// derivative g by the displacement, `[n_nodes][3]`. The change of the equilibrium with a parameter changes the goal by
/// `-mu . d(f - F)`. Without follower loads K is symmetric.
///
/// # Errors
/// [`crate::Error::Inverted`], [`crate::Error::Linear`].
pub(crate) fn multipliers(body: &Body, state: &State, gradient: &[f64]) -> Result<Vec<f64>> {
    let mut forces = Forces::new(body);
    forces.assemble(&state.displacement, Request::Tangent)?;
    solve_stiffness(body, &mut forces.assembly.matrix, gradient)
}

/// The plan of a number of equal increments, from load fraction 0 to 1.
///
/// # Errors
/// [`crate::Error::Plan`] for no increments.
pub fn increments(load_steps: usize) -> Result<StepPlan> {
    StepPlan::new(0.0, vec![Phase { until: 1.0, size: 1.0 / load_steps as f64 }])
}

/// Internal force less loads, `f(u) - F(u, t)`, of a displacement `[n_nodes][3]` at a time: in equilibrium the reaction
/// at fixed and driven degrees of freedom, and zero but for rounding at free ones, `[n_nodes][3]` \[force\]. Rigid
/// bodies and joints carry as much of it as they can.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
///     .region(rubber)
///     .support(Support::fixed("body"))
///     .load(Load::acceleration([0.0, 0.0, -10.0]))
///     .build()?;
/// let force = emmy::equilibrium::unbalanced_force(&body, &[0.0; 24], 0.0)?;
/// let carried: f64 = force.iter().skip(2).step_by(3).sum();
/// assert!((carried - 20.0).abs() < 1e-13); // m g
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Inverted`].
pub fn unbalanced_force(body: &Body, displacement: &[f64], time: f64) -> Result<Vec<f64>> {
    body.space.check_whole("an unbalanced force")?;
    let mut force = Forces::new(body).unbalanced(displacement, Some(time))?;
    let joints = (body.constraints(), body.space.inactive());
    let mut joints = LinearConstraints::new(joints, displacement, Some(time))?;
    let multipliers = joints.balancing(&force);
    joints.add_force((body.constraints(), displacement), &multipliers, &mut force);
    Ok(force)
}
