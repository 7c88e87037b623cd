//! Central differences: explicit, with lumped mass.

use super::forces::{Forces, TimePoint, sum_reactions};
use crate::average::Request;
use crate::body::{Body, Reaction};
use crate::error::{Error, Result};
use crate::time::{Impulses, Memory, State, StepOutcome, Stepper};

/// Largest accepted step relative to the critical one: the estimate is an upper bound, and the body may stiffen.
const SAFETY: f64 = 0.98;

/// Number of steps after which the critical step is estimated again.
const STEPS_BETWEEN_ESTIMATES: usize = 50;

/// Stepper of central differences in the form with displacement and velocity at the same times (Verlet 1967):
///
/// ```math
/// p_s = p_1 + (h/2) (F - f)_1,    u_2 = u_1 + h M^-1 p_s,    p_2 = p_s + (h/2) (F - f)_2
/// ```
///
/// with the lumped mass [`Body::lumped_mass`]. The momentum of the state, and with it the kinetic energy and momenta of
/// the record, use the lumped mass. The method conserves linear and angular momentum, is symplectic, and is stable for
/// `h < 2/omega_max`; a larger step is rejected.
#[derive(Debug)]
pub struct CentralDifferences<'a> {
    forces: Forces<'a>,
    /// M a: the net force on free degrees of freedom.
    inertia: Vec<f64>,
    increment: Vec<f64>,
    start: TimePoint,
    end: TimePoint,
    reactions: Vec<Reaction>,
    limit: StabilityLimit,
}

impl<'a> CentralDifferences<'a> {
    /// The stepper of a state, whose momentum it sets with the lumped mass.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn new(body: &'a Body, state: &mut State) -> Result<Self> {
        let mut forces = Forces::new(body);
        let n = body.n_dofs();
        let limit = StabilityLimit::new(&mut forces, &state.displacement)?;
        let mut start = TimePoint::new(body);
        start.displacement.copy_from_slice(&state.displacement);
        start.evaluate(&mut forces, state.time)?;
        for (dof, p) in state.momentum.iter_mut().enumerate() {
            *p = body.lumped_mass()[dof / 3] * state.velocity[dof];
        }
        let mut stepper = CentralDifferences {
            forces,
            inertia: vec![0.0; n],
            increment: vec![0.0; n],
            start,
            end: TimePoint::new(body),
            reactions: body.space.no_reactions(),
            limit,
        };
        set_inertia(body, &mut stepper.start, &mut stepper.inertia);
        Ok(stepper)
    }

    /// The critical step `2/omega_max` of a body at a displacement `[n_nodes][3]`, and the largest accepted step
    /// \[time\].
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn critical_steps(body: &Body, displacement: &[f64]) -> Result<[f64; 2]> {
        let critical = StabilityLimit::new(&mut Forces::new(body.lumped()), displacement)?.critical_step;
        Ok([critical, SAFETY * critical])
    }

    /// The critical step of a body, at least, while all layers of its contacts are pressed to half of their thickness
    /// \[time\]: `2/sqrt(omega_max^2 + omega_c^2)` with the stiffness of the body at a displacement, and that of the
    /// layers over the mass of the nodes. At edges between facets of one surface it is too low, as only some of them
    /// are pressed. `None` without contact.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn critical_step_in_contact(body: &Body, displacement: &[f64]) -> Result<Option<f64>> {
        let Some(of_contact) = body.lumped().contact_frequency_bound() else { return Ok(None) };
        let [critical, _] = CentralDifferences::critical_steps(body, displacement)?;
        Ok(Some(2.0 / ((2.0 / critical).powi(2) + of_contact).sqrt()))
    }

    /// Last estimate of the critical step, 2/omega_max \[time\].
    pub fn critical_step(&self) -> f64 {
        self.limit.critical_step
    }
}

/// Copies the net force of a point to M a of the free degrees of freedom and sets its reactions.
fn set_inertia(body: &Body, point: &mut TimePoint, inertia: &mut [f64]) {
    for (dof, &fixed) in body.fixed().iter().enumerate() {
        inertia[dof] = if fixed { 0.0 } else { point.force[dof] };
    }
    body.space.update_guests("net force", inertia);
    point.set_reactions(body, inertia);
}

impl Stepper for CentralDifferences<'_> {
    fn advance(&mut self, state: &mut State, step_size: f64) -> Result<StepOutcome> {
        let body = self.forces.body;
        let h = step_size;
        self.limit.check(&mut self.forces, state, h)?;
        for (dof, x) in self.increment.iter_mut().enumerate() {
            let middle = state.momentum[dof] + 0.5 * h * self.inertia[dof];
            *x = if body.fixed()[dof] { 0.0 } else { h * middle / body.lumped_mass()[dof / 3] };
        }
        body.space.follow(&mut self.increment);
        let moved = state.displacement.iter().zip(&self.increment);
        self.end.displacement.iter_mut().zip(moved).for_each(|(end, (u, x))| *end = u + x);
        self.end.evaluate(&mut self.forces, state.time + h)?;
        check_finite(body, state, h, &self.end)?;
        self.limit.n_steps += 1;
        let add = |momentum: &mut [f64], inertia: &[f64]| {
            momentum.iter_mut().zip(inertia).for_each(|(p, ma)| *p += 0.5 * h * ma);
        };
        add(&mut state.momentum, &self.inertia);
        set_inertia(body, &mut self.end, &mut self.inertia);
        add(&mut state.momentum, &self.inertia);
        state.displacement.copy_from_slice(&self.end.displacement);
        for (dof, v) in state.velocity.iter_mut().enumerate() {
            *v = if body.fixed()[dof] { 0.0 } else { state.momentum[dof] / body.lumped_mass()[dof / 3] };
        }
        body.space.follow(&mut state.velocity);
        let mut impulses = Impulses::default();
        self.start.add_to(&mut impulses, body, 0.5, h, &self.increment);
        self.end.add_to(&mut impulses, body, 0.5, h, &self.increment);
        sum_reactions([(&self.start, 0.5), (&self.end, 0.5)], &mut self.reactions);
        std::mem::swap(&mut self.start, &mut self.end);
        StepOutcome::new(self.forces.body, state, impulses)
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    fn newton_history(&self) -> &[f64] {
        &[]
    }

    fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        memory.save_nodal("inertia", &self.inertia);
        self.start.save(&mut memory);
        memory.save_nodal("stability.mode", &self.limit.mode);
        memory.save_number("stability.critical_step", self.limit.critical_step);
        memory.save_number("stability.n_steps", self.limit.n_steps as f64);
        memory
    }

    fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("inertia", &mut self.inertia)?;
        self.start.restore(memory)?;
        memory.fill("stability.mode", &mut self.limit.mode)?;
        self.limit.critical_step = memory.number("stability.critical_step")?;
        self.limit.n_steps = memory.number("stability.n_steps")? as usize;
        Ok(())
    }
}

/// Rejects a step whose forces are not finite: no other check would find this.
fn check_finite(body: &Body, state: &State, h: f64, end: &TimePoint) -> Result<()> {
    let mut numbers = end.force.iter().zip(&end.displacement).take(3 * body.space.own_nodes().end);
    let own = numbers.position(|(force, u)| !(force.is_finite() && u.is_finite()));
    match body.space.lowest_node(own.map(|dof| dof / 3)) {
        None => Ok(()),
        Some(node) => Err(Error::NotANumber {
            step: state.step + 1,
            time: state.time + h,
            node,
            position: body.space.at_node(node, |node| state.position(body, node)),
        }),
    }
}

/// The critical step, estimated by power iteration.
#[derive(Debug)]
struct StabilityLimit {
    critical_step: f64,
    /// Steps since the estimate.
    n_steps: usize,
    /// Approximation of the highest mode; the next estimate starts from it.
    mode: Vec<f64>,
    product: Vec<f64>,
}

/// Relative change of omega_max^2 at which the power iteration ends.
const TOLERANCE: f64 = 1e-6;

/// Largest number of iterations.
const MAX_ITERATIONS: usize = 500;

impl StabilityLimit {
    fn new(forces: &mut Forces<'_>, displacement: &[f64]) -> Result<Self> {
        // A fixed vector with a component in every mode: fractional parts of multiples of the golden section.
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let entry = |(dof, &fixed): (usize, &bool)| {
            if fixed {
                0.0
            } else {
                ((forces.body.space.dof_of_ranks(dof) + 1) as f64 * golden).fract() - 0.5
            }
        };
        let mode: Vec<f64> = forces.body.fixed().iter().enumerate().map(entry).collect();
        let mut limit = StabilityLimit { critical_step: 0.0, n_steps: 0, product: mode.clone(), mode };
        limit.estimate(forces, displacement)?;
        Ok(limit)
    }

    /// Sets the critical step at a displacement: `omega_max^2` is the largest eigenvalue of `M^-1 K`.
    fn estimate(&mut self, forces: &mut Forces<'_>, displacement: &[f64]) -> Result<()> {
        forces.assemble(displacement, Request::Tangent)?;
        let mut square = 0.0;
        for _ in 0..MAX_ITERATIONS {
            let before = square;
            square = self.iterate(forces);
            if square == 0.0 || (square - before).abs() <= TOLERANCE * square {
                break;
            }
        }
        self.critical_step = 2.0 / square.sqrt();
        self.n_steps = 0;
        Ok(())
    }

    /// One power iteration; returns `|M^-1 K x| / |x|` in the norm of the mass, at most the largest eigenvalue.
    fn iterate(&mut self, forces: &mut Forces<'_>) -> f64 {
        let body = forces.body;
        let mode = &mut self.mode;
        body.space.update_guests("mode", mode);
        forces.assembly.matrix.multiply(body.pattern(), mode, &mut self.product);
        let (mut old, mut new) = (0.0, 0.0);
        for (dof, &fixed) in body.fixed().iter().enumerate().take(3 * body.space.own_nodes().end) {
            let mass = body.lumped_mass()[dof / 3];
            let value = if fixed { 0.0 } else { self.product[dof] / mass };
            old += mass * mode[dof] * mode[dof];
            new += mass * value * value;
            mode[dof] = value;
        }
        let mut squares = [old, new];
        body.space.sum_ranks("squares of a mode", &mut squares);
        let [old, new] = squares;
        if new == 0.0 {
            return 0.0;
        }
        let length = new.sqrt();
        mode.iter_mut().for_each(|value| *value /= length);
        length / old.sqrt()
    }

    /// Rejects a step that is too large for a state.
    fn check(&mut self, forces: &mut Forces<'_>, state: &State, step_size: f64) -> Result<()> {
        if self.n_steps >= STEPS_BETWEEN_ESTIMATES {
            self.estimate(forces, &state.displacement)?;
        }
        let limit = SAFETY * self.critical_step;
        if step_size <= limit {
            return Ok(());
        }
        let step = state.step + 1;
        let time = state.time + step_size;
        let critical = self.critical_step;
        Err(Error::StepTooLarge { step, time, step_size, critical, limit })
    }
}
