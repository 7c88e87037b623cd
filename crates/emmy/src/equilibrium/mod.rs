//! Static equilibrium of a body under the loads of a time, found with growing loads.

use crate::average::Request;
use crate::body::Body;
use crate::error::Result;
use crate::input::InitialVelocity;
use crate::motion::{MarchError, Motion, NewtonSettings, Observer, Phase, State, StepPlan};
use crate::time::Scheme;
use crate::time::classic::{Forces, solve_stiffness};

/// The static equilibrium `f(u) = F(u, t)` of a body under the loads, local unknowns and driven supports of a time t.
///
/// All of them grow in proportion to a load fraction from 0 to 1, in equal increments; an increment that fails is cut by
/// two, down to 1/1024. On a team, conjugate gradients solve the linear systems, and a path is not checked for stability
/// under follower loads. The increments are the steps of a [`Motion`] whose time is the load fraction.
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
        let displacement = motion.state().displacement.clone();
        let state = State::displaced(self.body, self.time, displacement, fields)?;
        Ok(State { is_equilibrium: true, ..state })
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

/// Internal force less loads, `f(u) - F(u, t)`, of a displacement `[n_nodes][3]` at a time: in equilibrium the reaction at
/// fixed and driven degrees of freedom, and zero but for rounding at free ones, `[n_nodes][3]` \[force\].
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
    let mut external = vec![0.0; body.n_dofs()];
    let mut net = external.clone();
    Forces::new(body).net(displacement, time, &mut external, &mut net)?;
    net.iter_mut().for_each(|force| *force = -*force);
    Ok(net)
}

/// Internal force f(u) of a displacement `[n_nodes][3]`, without loads, `[n_nodes][3]` \[force\].
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(NeoHooke::new(0.0, 500.0)?, 2.0)).build()?;
/// let stretched: Vec<f64> = body.mesh().points().iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
/// let force = emmy::equilibrium::internal_force(&body, &stretched)?;
/// // P_11 = mu (lambda - 1/lambda) with lambda = 2, on the unit area x = 1.
/// let right: f64 = (0..8).filter(|&node| body.mesh().points()[node][0] == 1.0).map(|node| force[3 * node]).sum();
/// assert!((right - 750.0).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Inverted`].
pub fn internal_force(body: &Body, displacement: &[f64]) -> Result<Vec<f64>> {
    body.space.check_whole("an internal force at a displacement")?;
    let mut forces = Forces::new(body);
    forces.assemble(displacement, Request::Stress)?;
    let mut internal = vec![0.0; body.n_dofs()];
    forces.assembly.matrix.copy_force(&mut internal);
    Ok(internal)
}

/// A row of nodes of a sparse matrix: columns in ascending order, with 3x3 blocks row by row.
pub type BlockRow = Vec<(u32, [f64; 9])>;

/// Stiffness df/du at a displacement `[n_nodes][3]` \[force/length\]: for each row of nodes, its columns in ascending order
/// and the 3x3 blocks, row by row. Supports and loads are not included.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(NeoHooke::new(0.0, 500.0)?, 2.0)).build()?;
/// let rows = emmy::equilibrium::stiffness(&body, &[0.0; 24])?;
/// // A translation needs no force.
/// let force: f64 = rows[0].iter().map(|(_, block)| block[0]).sum();
/// assert!(rows.len() == 8 && force.abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Inverted`].
pub fn stiffness(body: &Body, displacement: &[f64]) -> Result<Vec<BlockRow>> {
    body.space.check_whole("a stiffness at a displacement")?;
    let mut forces = Forces::new(body);
    forces.assemble(displacement, Request::Tangent)?;
    let matrix = &forces.assembly.matrix;
    let pattern = body.pattern();
    let block = |position: usize| std::array::from_fn(|entry| matrix.block(position)[entry]);
    let row = |row: usize| pattern.row(row).iter().copied().zip(pattern.range(row).map(block)).collect();
    Ok((0..pattern.n_rows()).map(row).collect())
}
