//! Statistics of a motion: largest residuals, their sums, and the work of the solvers.

use serde::{Deserialize, Serialize};

use super::{ContactStatistics, Record, State, StepLimits};
use crate::body::{Body, Reaction};
use crate::mass::RegionSummary;
use crate::sparse::SolverChoice;

/// The largest absolute value of a quantity, and the step in which it occurred.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
/// let state = State::initial(&body, 0.0, &[flight])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// motion.step(0.1)?;
/// // Largest residual of the energy, in units of energy: round-off of the kinetic energy 9.
/// assert!(motion.statistics().worst_energy_residual.value < 1e-13);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Extreme {
    /// The absolute value; NaN exceeds every number.
    pub value: f64,
    /// Number of the step.
    pub step: usize,
}

impl Extreme {
    fn update(&mut self, value: f64, step: usize) {
        if value.abs() > self.value || (value.is_nan() && !self.value.is_nan()) {
            *self = Extreme { value: value.abs(), step };
        }
    }
}

/// The largest displacement of a node.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let flight = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
/// let state = State::initial(&body, 0.0, &[flight])?;
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
/// motion.step(0.1)?;
/// let largest = &motion.statistics().largest_displacement;
/// assert!((largest.value - 0.3).abs() < 1e-14 && largest.step == 1);
/// assert_eq!(largest.point, body.mesh().points()[largest.node]); // in the reference configuration
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LargestDisplacement {
    /// Norm of the displacement \[length\].
    pub value: f64,
    /// Number of the step.
    pub step: usize,
    /// Time \[time\].
    pub time: f64,
    /// Index of the node.
    pub node: usize,
    /// Position of the node in the reference configuration.
    pub point: [f64; 3],
}

impl LargestDisplacement {
    fn update(&mut self, body: &Body, state: &State, displacement: &[f64]) {
        // Nodes that stand for obstacles are no places of the body, either, and the last.
        let n_obstacles = body.contacts().filter(|contact| contact.obstacle.is_some()).count();
        let of_mesh = &displacement[..body.mesh().n_dofs() - 3 * n_obstacles];
        let squares = of_mesh.as_chunks().0.iter().enumerate();
        // The end of an axis of a rigid body is no place of it.
        let squares =
            squares.map(|(node, [x, y, z]): (usize, &[f64; 3])| match body.mechanism.is_end(node) {
                true => 0.0,
                false => x * x + y * y + z * z,
            });
        let (node, square) = body.space.largest_node(squares);
        if square.sqrt() > self.value {
            let point = body.space.at_node(node, |node| body.mesh().points()[node]);
            *self =
                LargestDisplacement { value: square.sqrt(), step: state.step, time: state.time, node, point };
        }
    }
}

/// Statistics of all steps of a motion, from [`super::Motion::statistics`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunStatistics {
    /// Number of steps.
    pub steps: usize,
    /// Time reached \[time\].
    pub time: f64,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// The linear solver of the last step that had one.
    pub solver: Option<SolverChoice>,
    /// Number of refactorizations of the linear solver.
    pub refactorizations: usize,
    /// Steps that needed the exact tangent.
    pub steps_with_exact_tangent: usize,
    /// Steps that ended at the rounding floor instead of the tolerance.
    pub steps_at_rounding_floor: usize,
    /// Relative effect of rounding on energy and momenta: the sum over the steps that ended at the rounding floor.
    pub rounding: f64,
    /// Number of halvings of failed steps.
    pub cuts: usize,
    /// Number of repetitions of a step because of its error.
    pub rejections: usize,
    /// Steps whose degree differs from the previous step.
    pub degree_changes: usize,
    /// Degree of the last step; 0 before the first.
    pub last_degree: usize,
    /// Times at which supports or joints were released.
    pub releases: usize,
    /// Size up to which roundings of the positions in all steps may add up in a constraint, over the size of the
    /// whole; `None` without constraints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraint_rounding: Option<f64>,
    /// Largest residual of the energy balance of a step \[energy\].
    pub worst_energy_residual: Extreme,
    /// Largest residual of the linear momentum balance of a step \[mass length/time\].
    pub worst_linear_momentum_residual: Extreme,
    /// Largest residual of the angular momentum balance of a step \[mass length^2/time\].
    pub worst_angular_momentum_residual: Extreme,
    /// Sum of the energy residuals \[energy\].
    pub accumulated_energy_residual: f64,
    /// Sum of the angular momentum residuals, without round-off.
    pub accumulated_angular_momentum_residual: f64,
    /// Largest T + |V| + V_c \[energy\]: the total energy, except where an attraction makes V negative.
    pub largest_energy: f64,
    /// Largest kinetic energy \[energy\].
    pub largest_kinetic_energy: f64,
    /// Largest norm of the linear momentum.
    pub largest_linear_momentum: f64,
    /// Largest norm of the angular momentum.
    pub largest_angular_momentum: f64,
    /// Work of the largest force of a joint over the size of the mechanism \[energy\]; 0 without joints. A scale for
    /// the energy of a mechanism at rest, whose T and V are round-off although joints carry loads.
    #[serde(default)]
    pub energy_scale: f64,
    /// Largest linear momentum possible if the energy of [`RunStatistics::energy_size`] were kinetic energy,
    /// `sqrt(2 (T + |V|) m)`.
    pub linear_momentum_scale: f64,
    /// The same for the angular momentum in the reference configuration, `sqrt(2 (T + |V|) I)`.
    pub angular_momentum_scale: f64,
    /// Total energy after the last step \[energy\].
    pub total_energy: f64,
    /// Work of the loads since the start \[energy\].
    pub external_work: f64,
    /// Energy dissipated by viscosity, drag and the scheme since the start \[energy\].
    pub dissipated_energy: f64,
    /// Largest displacement of a node.
    pub largest_displacement: LargestDisplacement,
    /// Largest displacement relative to another motion ([`super::Motion::relative_to`]); `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_relative_displacement: Option<LargestDisplacement>,
    /// Steps that did not resolve a load or a given motion.
    pub unresolved_loads: usize,
    /// Steps in which a rigid body turned further than they can follow: more than half a turn, or so far that a tenth
    /// of the turn is lost, 1.1 rad at degree 1 and 2.9 rad at degree 2.
    #[serde(default)]
    pub unresolved_turns: usize,
    /// Size of the largest step \[time\].
    #[serde(default)]
    pub largest_step_size: f64,
    /// Largest |V| \[energy\].
    #[serde(default)]
    pub largest_strain_energy: f64,
    /// Largest energy of the layers of contact \[energy\]; `None` without contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_contact_energy: Option<f64>,
    /// Smallest gap over the thickness of its layer; `None` without contact, or where nothing was near.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest_gap: Option<Extreme>,
    /// Forces of the contacts, in the order of [`Body::contacts`]; empty without contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactStatistics>,
    /// Sum of the estimated errors of the steps, relative to the scales of [`super::Adaptivity`]; 0 without adaptive
    /// steps.
    #[serde(default)]
    pub accumulated_local_error: f64,
    /// Numbers of adaptive steps by what set their sizes.
    #[serde(default)]
    pub step_limits: StepLimits,
}

/// An angular momentum residual below this part of its scale is round-off. Neither |L| nor T is a measure: a body at
/// rest under loads has both only up to rounding.
const ROUND_OFF: f64 = 1e-13;

/// A momentum below this part of its scale is round-off.
const AT_REST: f64 = 1e-9;

/// An energy below this part of its scale is round-off: impulses of joints are rounded, so that a mechanism at rest has
/// velocities of 1e-16 of those that its loads could give it, and energies of the square of it. A pendulum that swings
/// by 1e-12 rad has more.
const ENERGY_AT_REST: f64 = 1e-24;

impl RunStatistics {
    /// Adds a step, or the start, from its record, its reactions and the state after it.
    pub(super) fn add(&mut self, body: &Body, state: &State, record: &Record, reactions: &[Reaction]) {
        let step = [self.time, record.time, record.step_size];
        ContactStatistics::add_all(&mut self.contacts, body, step, reactions);
        self.steps = record.step;
        self.time = record.time;
        self.newton_iterations += record.newton_iterations;
        self.linear_iterations += record.linear_iterations;
        self.solver = record.solver.or(self.solver);
        self.refactorizations += record.refactorizations;
        self.steps_with_exact_tangent += usize::from(record.took_exact_tangent);
        self.steps_at_rounding_floor += usize::from(record.at_rounding_floor);
        self.rounding = record.rounding;
        self.cuts += record.cuts;
        self.rejections += record.rejections;
        self.degree_changes += usize::from(self.last_degree != 0 && self.last_degree != record.degree);
        self.last_degree = record.degree;
        self.releases += record.releases;
        self.total_energy = record.total_energy;
        self.external_work = record.external_work;
        self.dissipated_energy = record.dissipated_energy;
        self.unresolved_loads += usize::from(record.is_unresolved);
        self.unresolved_turns += usize::from(record.is_turned_over);
        self.largest_step_size = self.largest_step_size.max(record.step_size);
        self.accumulated_local_error += record.local_error;
        record.step_limit.into_iter().for_each(|limit| self.step_limits.add(limit));
        self.largest_displacement.update(body, state, &state.displacement);
        let constraints = body.constraints();
        if !constraints.is_empty() {
            let way = self.largest_displacement.value / constraints.size();
            let rounding = f64::EPSILON * (1.0 + way) * self.steps as f64;
            self.constraint_rounding = Some(rounding.max(self.constraint_rounding.unwrap_or(0.0)));
        }
        self.add_scales(body, record);
        self.add_residuals(record);
    }

    /// Adds a relative displacement, `[n_nodes][3]`.
    pub(super) fn add_relative(&mut self, body: &Body, state: &State, displacement: &[f64]) {
        self.largest_relative_displacement.get_or_insert_default().update(body, state, displacement);
    }

    fn add_scales(&mut self, body: &Body, record: &Record) {
        let stored = record.strain_energy.abs() + record.contact_energy;
        self.largest_energy = self.largest_energy.max(record.kinetic_energy + stored);
        if body.contacts().next().is_some() {
            let largest = self.largest_contact_energy.unwrap_or(0.0);
            self.largest_contact_energy = Some(largest.max(record.contact_energy));
        }
        let is_smaller = |gap: &f64| self.smallest_gap.is_none_or(|own| *gap < own.value);
        if let Some(gap) = record.smallest_gap.filter(is_smaller) {
            self.smallest_gap = Some(Extreme { value: gap, step: record.step });
        }
        self.largest_kinetic_energy = self.largest_kinetic_energy.max(record.kinetic_energy);
        self.largest_strain_energy = self.largest_strain_energy.max(record.strain_energy.abs());
        self.largest_linear_momentum = self.largest_linear_momentum.max(norm(record.linear_momentum));
        self.largest_angular_momentum = self.largest_angular_momentum.max(norm(record.angular_momentum));
        let size = body.constraints().size();
        let works = record.joints.iter().map(|joint| norm(joint.force) * size + norm(joint.moment));
        self.energy_scale = works.fold(self.energy_scale, f64::max);
        let mass = body.regions().iter().map(|region| region.mass).sum::<f64>();
        let (energy, _) = self.energy_size();
        self.linear_momentum_scale = (2.0 * energy * mass).sqrt();
        self.angular_momentum_scale = (2.0 * energy * polar_inertia(body)).sqrt();
    }

    fn add_residuals(&mut self, record: &Record) {
        let step = record.step;
        self.worst_energy_residual.update(record.energy_residual, step);
        self.worst_linear_momentum_residual.update(record.linear_momentum_residual, step);
        self.worst_angular_momentum_residual.update(record.angular_momentum_residual, step);
        self.accumulated_energy_residual += record.energy_residual;
        let residual = record.angular_momentum_residual;
        if residual > ROUND_OFF * self.angular_momentum_scale || residual.is_nan() {
            self.accumulated_angular_momentum_residual += residual;
        }
    }

    /// Correct digits of energy and momenta left by rounding over all steps.
    ///
    /// ```
    /// assert!(emmy::motion::RunStatistics { rounding: 1e-6, ..Default::default() }.digits_left() == 6.0);
    /// ```
    pub fn digits_left(&self) -> f64 {
        -self.rounding.clamp(f64::EPSILON, 1.0).log10()
    }

    /// Accumulated energy residual over the largest T + |V|, or over the possible one of a mechanism at rest.
    pub fn energy_drift(&self) -> f64 {
        ratio(self.accumulated_energy_residual.abs(), self.energy_size().0)
    }

    /// The scale of energy residuals, and its name: the largest T + |V| + V_c, or a possible one where a mechanism is
    /// at rest and T + |V| is round-off.
    ///
    /// ```
    /// use emmy::motion::RunStatistics;
    /// let at_rest = RunStatistics { largest_energy: 2e-41, energy_scale: 400.0, ..Default::default() };
    /// assert_eq!(at_rest.energy_size(), (400.0, "possible T + V"));
    /// let moving = RunStatistics { largest_energy: 2e-20, ..at_rest };
    /// assert_eq!(moving.energy_size(), (2e-20, "T + V"));
    /// ```
    pub fn energy_size(&self) -> (f64, &'static str) {
        match self.largest_energy < ENERGY_AT_REST * self.energy_scale {
            true => (self.energy_scale, "possible T + V"),
            false if self.largest_contact_energy.is_some() => (self.largest_energy, "T + V + V_c"),
            false => (self.largest_energy, "T + V"),
        }
    }

    /// Accumulated angular momentum residual over the largest |L|, or over the largest possible one of a body that does
    /// not turn.
    pub fn angular_momentum_drift(&self) -> f64 {
        ratio(self.accumulated_angular_momentum_residual, self.angular_momentum_size().0)
    }

    /// The scale of angular momentum residuals, and its name: the largest |L|, or the largest possible one where |L| is
    /// round-off.
    ///
    /// ```
    /// use emmy::motion::RunStatistics;
    /// let at_rest = RunStatistics { largest_angular_momentum: 1e-14, angular_momentum_scale: 2.0, ..Default::default() };
    /// assert_eq!(at_rest.angular_momentum_size(), (2.0, "possible |L|"));
    /// ```
    pub fn angular_momentum_size(&self) -> (f64, &'static str) {
        match self.largest_angular_momentum > AT_REST * self.angular_momentum_scale {
            true => (self.largest_angular_momentum, "|L|"),
            false => (self.angular_momentum_scale, "possible |L|"),
        }
    }
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn ratio(part: f64, whole: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / whole }
}

/// Integral of density times squared distance from the origin, in the reference configuration.
fn polar_inertia(body: &Body) -> f64 {
    let of_region = |region: &RegionSummary| {
        let about_centre = (0..3).map(|i| region.inertia[i][i]).sum::<f64>() / 2.0;
        about_centre + region.mass * region.centre.iter().map(|x| x * x).sum::<f64>()
    };
    body.regions().iter().map(of_region).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_keep_their_step_and_nan_exceeds_every_number() {
        let mut extreme = Extreme::default();
        for (step, value) in [(1, 0.5), (2, -2.0), (3, 1.0)] {
            extreme.update(value, step);
        }
        assert_eq!(extreme, Extreme { value: 2.0, step: 2 });
        extreme.update(f64::NAN, 4);
        extreme.update(9.0, 5);
        assert!(extreme.value.is_nan() && extreme.step == 4);
    }
}
