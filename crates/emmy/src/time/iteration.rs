//! Newton's iteration over the equations of a step, and its starting points in the order of the attempts.

use super::prediction::{Carry, Prediction};
use super::stage_system::StageSystem;
use super::{Memory, State};
use crate::error::{Error, Result};
use crate::newton::{Ending, Newton, NewtonMemory, NewtonSettings, OpenEnd, Outcome, System};
use crate::unknowns::{Blocks, Held};

/// The iteration of a step with its memory: its unknown rates, and the rates of the step before.
#[derive(Debug)]
pub(super) struct Iteration {
    settings: NewtonSettings,
    newton: Newton,
    pub unknowns: Vec<f64>,
    blocks: Blocks,
    /// Multipliers and local unknowns of the last step; empty before the first one.
    multipliers: Vec<f64>,
    local: Vec<f64>,
    prediction: Prediction,
    /// Residual at a starting point, if there is a choice, and residual of the rigid motion.
    residual: Vec<f64>,
}

/// Starting points of the iteration, in the order of the attempts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guess {
    /// Rates given by the caller.
    Given,
    /// The rigid motion of the step and the deviation of the last step.
    Continued,
    /// The rigid motion alone.
    Rigid,
    /// h v.
    Velocity,
    /// No motion.
    Rest,
}

/// Every attempt at a step: starting point, and whether a line search guards it.
const ATTEMPTS: [(Guess, bool); 8] = [
    (Guess::Given, false),
    (Guess::Continued, false),
    (Guess::Rigid, false),
    (Guess::Velocity, false),
    (Guess::Rest, false),
    (Guess::Rigid, true),
    (Guess::Velocity, true),
    (Guess::Rest, true),
];

impl Iteration {
    /// Memory for the equations of a system.
    pub(super) fn new(system: &StageSystem<'_>, settings: NewtonSettings) -> Self {
        let k = system.equations.coefficients.rule.degree();
        let blocks = system.equations.blocks;
        Iteration {
            settings,
            newton: Newton::default(),
            unknowns: vec![0.0; blocks.len()],
            multipliers: Vec::with_capacity(blocks.multipliers),
            local: Vec::with_capacity(blocks.local),
            blocks,
            prediction: Prediction::new(k, system.equations.body),
            residual: vec![0.0; blocks.len()],
        }
    }

    /// The rates x_i, `[k][n_nodes][3]`.
    pub(super) fn rates(&self) -> &[f64] {
        &self.unknowns[..self.blocks.rates]
    }

    fn rates_mut(&mut self) -> &mut [f64] {
        &mut self.unknowns[..self.blocks.rates]
    }

    /// Sets the unknowns beside the rates: multipliers to those of the last step for the same forces, after a failure
    /// to zero; local unknowns to those of the last step, or of the configuration at the start of the step.
    fn set_others(&mut self, system: &mut StageSystem<'_>, step_size: f64, has_failed: bool) -> Result<()> {
        let [_, multipliers, local] = self.blocks.split_mut(&mut self.unknowns);
        let ratio = self.prediction.last_size().filter(|_| !has_failed).map(|last| step_size / last);
        match ratio {
            Some(ratio) if self.multipliers.len() == multipliers.len() => {
                let last = multipliers.iter_mut().zip(&self.multipliers);
                last.for_each(|(multiplier, last)| *multiplier = ratio * ratio * last);
                system.equations.project(multipliers);
            }
            _ => multipliers.fill(0.0),
        }
        if self.prediction.is_first() {
            return system.equations.set_local_at_start(local);
        }
        local.copy_from_slice(&self.local);
        Ok(())
    }

    /// Keeps the memory that the next steps depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        self.prediction.save(memory);
        memory.save_local("pressures", &self.local);
        if self.blocks.multipliers > 0 {
            memory.save("multipliers", &self.multipliers);
        }
        let NewtonMemory { fresh, excess, forcing, renewed } = self.newton.memory();
        memory.save_option("newton.fresh", fresh.map(|corrections| corrections as f64));
        memory.save_number("newton.excess", excess as f64);
        memory.save_number("newton.forcing", forcing);
        memory.save_option("newton.renewed", renewed);
    }

    /// Restores the data of [`Iteration::save`].
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        self.prediction.restore(memory)?;
        self.local.clear();
        self.local.extend_from_slice(memory.list("pressures")?);
        if self.blocks.multipliers > 0 {
            self.multipliers.clear();
            self.multipliers.extend_from_slice(memory.list("multipliers")?);
        }
        self.newton.restore(NewtonMemory {
            fresh: memory.option("newton.fresh")?.map(|corrections| corrections as usize),
            excess: memory.number("newton.excess")? as usize,
            forcing: memory.number("newton.forcing")?,
            renewed: memory.option("newton.renewed")?,
        });
        Ok(())
    }

    /// Norms of Newton's residuals in the last step.
    pub(super) fn history(&self) -> &[f64] {
        self.newton.history()
    }

    /// Begins a step whose equations are set: finds its rigid motion, which rotates the approximate tangent. Loads that
    /// depend on the motion are evaluated along h v, not at the last iterate: a resumed motion has no such memory.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(super) fn begin(
        &mut self,
        system: &mut StageSystem<'_>,
        state: &State,
        step_size: f64,
    ) -> Result<()> {
        if system.equations.assembly.varies() {
            self.set_straight(state, step_size);
            system.equations.drive(self.rates_mut());
            system.equations.evaluate_external(self.rates())?;
        }
        self.prediction.start(&system.equations, state);
        system.turn(self.prediction.rotation());
        Ok(())
    }

    /// Sets the rates of the step, and the local unknowns of its start.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub(super) fn set_rates(&mut self, given: &[f64], system: &mut StageSystem<'_>) -> Result<()> {
        self.rates_mut().copy_from_slice(given);
        system.equations.drive(self.rates_mut());
        system.equations.set_local_at_start(&mut self.unknowns[self.blocks.n_global()..])
    }

    /// Solves the equations of a step, once more if more constraints are independent at its end than at its start.
    ///
    /// # Errors
    /// [`Error::NoConvergence`], [`Error::ConstraintsLost`].
    pub(super) fn solve(
        &mut self,
        system: &mut StageSystem<'_>,
        state: &State,
        step_size: f64,
        given: Option<&[f64]>,
    ) -> Result<Outcome> {
        let outcome = self.solve_in_range(system, state, step_size, given)?;
        let Held::No { .. } = system.equations.constraints_hold(self.rates()) else { return Ok(outcome) };
        let outcome = self.solve_in_range(system, state, step_size, given)?;
        match system.equations.constraints_hold(self.rates()) {
            Held::Yes => Ok(outcome),
            Held::No { residual } => {
                let end = (state.step + 1, state.time + step_size);
                Err(system.equations.constraints_lost(end, residual, self.rates()))
            }
        }
    }

    /// Solves the equations of a step from the first starting point with a solution; given rates come first.
    ///
    /// # Errors
    /// [`Error::NoConvergence`].
    fn solve_in_range(
        &mut self,
        system: &mut StageSystem<'_>,
        state: &State,
        step_size: f64,
        given: Option<&[f64]>,
    ) -> Result<Outcome> {
        self.begin(system, state, step_size)?;
        let (mut failure, mut cause) = (None, None);
        for (guess, line_search) in ATTEMPTS {
            self.set_others(system, step_size, failure.is_some() || cause.is_some())?;
            if !self.predict(guess, system, state, step_size, given) {
                continue;
            }
            match self.solve_and_balance(system, state, line_search) {
                Ok(outcome) if outcome.converged => {
                    if outcome.rounding <= LARGEST_ROUNDING {
                        return Ok(outcome);
                    }
                    failure = Some(no_digits(outcome.rounding, state, step_size));
                }
                Ok(outcome) => failure = Some(self.no_convergence(outcome, system, state, step_size)),
                Err(error) => cause = Some(Box::new(error)),
            }
        }
        self.newton.forget();
        let step = state.step + 1;
        let time = state.time + step_size;
        let has_cells = system.equations.body.has_cells();
        let could_not_start = |cause| Error::StepFailed { step, time, has_cells, cause };
        // An iteration that ran is more informative than one that could not start, unless a force has refused it.
        Err(match (failure, cause) {
            (_, Some(cause)) if matches!(*cause, Error::Refused { .. }) => could_not_start(cause),
            (Some(failure), _) => failure,
            (None, Some(cause)) => could_not_start(cause),
            (None, None) => Error::Linear { reason: format!("no starting point for step {step}") },
        })
    }

    /// Newton's iteration from the present unknowns, and the balances that it leaves open.
    fn solve_and_balance(
        &mut self,
        system: &mut StageSystem<'_>,
        state: &State,
        line_search: bool,
    ) -> Result<Outcome> {
        system.ending = system.equations.ending();
        let mut outcome = self.solve_from_here(system, line_search)?;
        for ending in [system.ending, Ending::Rounding] {
            if self.newton.open_end().is_none() || self.balance_all(system, state, &mut outcome)? {
                break;
            }
            system.ending = ending;
            let next = self.newton.resume(system, &mut self.unknowns, &self.settings, line_search)?;
            outcome = outcome.followed_by(next);
        }
        if !outcome.converged {
            return Ok(outcome);
        }
        let is_balanced = self.newton.open_end().is_some();
        if !is_balanced && (outcome.at_rounding_floor || system.ending != Ending::Rounding) {
            let (rates, memory) = (&mut self.unknowns[..self.blocks.rates], &mut self.residual);
            self.prediction.balance(&mut system.equations, rates, &mut memory[..self.blocks.rates])?;
        }
        if outcome.at_rounding_floor {
            outcome.rounding = self.rounding(system, state)?;
        }
        Ok(outcome)
    }

    /// Closes the balances of momenta and energy after an iteration with an open end: a rigid motion those of the
    /// momenta, a part of the last correction that of the energy; false if that is not enough.
    ///
    /// The imbalance of the energy is the work of the residual. It is linear in so small a change, so the residuals
    /// before and after the correction give the part. Both are taken with the momenta balanced.
    fn balance_all(
        &mut self,
        system: &mut StageSystem<'_>,
        state: &State,
        outcome: &mut Outcome,
    ) -> Result<bool> {
        let Iteration { newton, unknowns, residual, prediction, .. } = self;
        let Some(OpenEnd { residual: before, correction: direction, memory }) = newton.open_end() else {
            return Ok(true);
        };
        // The residual before the correction may return by this part.
        let space = &system.equations.body.space;
        let square: f64 = before.chunks_exact(state.velocity.len()).map(|r| space.dot(r, r)).sum();
        let largest_part = 0.5 * outcome.target / square.sqrt();
        let kinetic = 0.5 * space.dot(&state.momentum, &state.velocity);
        let negligible = NEGLIGIBLE_IMBALANCE * system.equations.time_scale.powi(2) * kinetic;

        memory.copy_from_slice(unknowns);
        prediction.balance(&mut system.equations, unknowns, residual)?;
        let turned = unknowns.iter().zip(&*memory);
        direction.iter_mut().zip(turned).for_each(|(d, (new, old))| *d += new - old);
        prediction.take_resultants(&mut system.equations, unknowns, [before, direction], [memory, residual]);
        let mut work_before = prediction.deforming_work(&system.equations, unknowns, before);
        let mut part = 1.0;
        for pass in 0..BALANCES {
            let sizes = system.residual(unknowns, residual)?;
            if pass == 0 && sizes.residual > NOISE * outcome.target {
                return Ok(false);
            }
            outcome.residual = sizes.residual;
            let work = prediction.deforming_work(&system.equations, unknowns, residual);
            if work.abs() <= negligible {
                break;
            }
            part *= work / (work_before - work);
            if part.is_nan() || part.abs() > largest_part {
                return Ok(pass > 0);
            }
            unknowns.iter_mut().zip(&*direction).for_each(|(x, d)| *x += part * d);
            prediction.balance(&mut system.equations, unknowns, residual)?;
            // A second balance would be one of rounding.
            if outcome.at_rounding_floor || ERROR_OF_BALANCE * work.abs() <= negligible {
                break;
            }
            work_before = work;
        }
        Ok(true)
    }

    /// Newton's iteration from the present unknowns.
    fn solve_from_here(&mut self, system: &mut StageSystem<'_>, line_search: bool) -> Result<Outcome> {
        let outcome = self.newton.solve(system, &mut self.unknowns, &self.settings, line_search)?;
        if !outcome.converged || outcome.iterations > 0 || !system.equations.body.has_local() {
            return Ok(outcome);
        }
        // Nothing moves freely, so no correction has taken the local unknowns to those of the rates.
        let local = &mut self.unknowns[self.blocks.n_global()..];
        system.equations.body.copy_local(&system.equations.assembly, local);
        self.newton.solve(system, &mut self.unknowns, &self.settings, line_search)
    }

    /// Change of energy and momenta by the residual of the step, relative to them.
    fn rounding(&mut self, system: &mut StageSystem<'_>, state: &State) -> Result<f64> {
        system.residual(&self.unknowns, &mut self.residual)?;
        let rates = &self.unknowns[..self.blocks.rates];
        let residual = &self.residual[..self.blocks.rates];
        let [work, impulse, moment] = self.prediction.imbalance(&system.equations, rates, residual);
        let kinetic = 0.5 * system.equations.body.space.dot(&state.momentum, &state.velocity);
        let moved = system.equations.mean_kinetic_energy(rates);
        let energy = kinetic.max(moved) + system.equations.strain_energy_at_start().abs();
        if energy == 0.0 {
            return Ok(0.0);
        }
        let of_momenta = self.prediction.momentum_scales(system.equations.body, energy);
        let work = work + system.rounding_energy(self.rates());
        let parts = [work / energy, impulse / of_momenta[0], moment / of_momenta[1]];
        Ok(parts.into_iter().filter(|part| part.is_finite()).fold(0.0, f64::max))
    }

    /// The error of an iteration that did not converge, at the node with the largest residual.
    fn no_convergence(
        &self,
        failed: Outcome,
        system: &StageSystem<'_>,
        state: &State,
        step_size: f64,
    ) -> Error {
        let size = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        if failed.residual.is_nan() {
            return not_a_number(self.newton.residual(), system, state, step_size);
        }
        let sizes = self.newton.residual()[..state.displacement.len()].chunks_exact(3).map(size);
        let (node, _) = system.equations.body.space.largest_node(sizes);
        Error::NoConvergence {
            step: state.step + 1,
            time: state.time + step_size,
            iterations: failed.iterations,
            residual: failed.residual,
            target: failed.target,
            node,
            position: Box::new(
                system.equations.body.space.at_node(node, |node| state.position(system.equations.body, node)),
            ),
            rigid: system.equations.body.mechanism.name_at(node).map(Box::from),
            contact: None,
        }
    }

    /// Keeps what the next step needs of this one.
    pub(super) fn remember(&mut self, system: &StageSystem<'_>, step_size: f64) {
        let rates = &self.unknowns[..self.blocks.rates];
        self.prediction.remember(&system.equations.coefficients, rates, step_size);
        let [_, multipliers, local] = self.blocks.split(&self.unknowns);
        self.multipliers.clear();
        self.multipliers.extend_from_slice(multipliers);
        self.local.clear();
        self.local.extend_from_slice(local);
    }

    /// Predicts the rates by the carry of the last deviation with the smaller residual; for k = 1 they are equal.
    fn predict_better(&mut self, system: &mut StageSystem<'_>, step_size: f64) {
        if system.equations.coefficients.rule.degree() == 1 {
            return self.carry(Carry::Repeated, system, step_size);
        }
        let mut sizes = [f64::INFINITY; 2];
        for (carry, size) in [Carry::Repeated, Carry::Continued].into_iter().zip(&mut sizes) {
            self.carry(carry, system, step_size);
            self.make_admissible(system);
            system.begin_iteration(self.rates());
            if let Ok(sizes) = system.residual(&self.unknowns, &mut self.residual) {
                *size = sizes.residual;
            }
        }
        if sizes[0] <= sizes[1] {
            self.carry(Carry::Repeated, system, step_size);
        }
    }

    /// Shortens a starting point beyond the bound of a force, and inserts the given motions.
    fn make_admissible(&mut self, system: &mut StageSystem<'_>) {
        let part = system.largest_part_from_rest(self.rates());
        if part < 1.0 {
            self.rates_mut().iter_mut().for_each(|x| *x *= SHORTENED * part);
        }
        system.equations.drive(self.rates_mut());
    }

    /// Predicts the rates by a carry of the last deviation.
    fn carry(&mut self, carry: Carry, system: &StageSystem<'_>, step_size: f64) {
        let rates = &mut self.unknowns[..self.blocks.rates];
        self.prediction.predict(carry, &system.equations.coefficients, step_size, rates);
    }

    /// Sets the rates to h v.
    fn set_straight(&mut self, state: &State, step_size: f64) {
        for rates in self.rates_mut().chunks_exact_mut(state.velocity.len()) {
            rates.iter_mut().zip(&state.velocity).for_each(|(x, v)| *x = step_size * v);
        }
    }

    /// Sets the rates to a starting point; false if there is none of this kind.
    fn predict(
        &mut self,
        guess: Guess,
        system: &mut StageSystem<'_>,
        state: &State,
        step_size: f64,
        given: Option<&[f64]>,
    ) -> bool {
        match guess {
            Guess::Given => match given {
                Some(given) => self.rates_mut().copy_from_slice(given),
                None => return false,
            },
            Guess::Continued => self.predict_better(system, step_size),
            Guess::Rigid => self.carry(Carry::Nothing, system, step_size),
            Guess::Velocity => self.set_straight(state, step_size),
            Guess::Rest => self.rates_mut().fill(0.0),
        }
        self.make_admissible(system);
        system.begin_iteration(self.rates());
        true
    }
}

/// Part of a starting point at the bound of a force from which the iteration starts.
const SHORTENED: f64 = 0.5;

/// Largest number of balances of the energy, and the part of the imbalance that each leaves.
const BALANCES: usize = 4;
const ERROR_OF_BALANCE: f64 = 3e-4;

/// A residual up to this multiple of the target ends an iteration: at the floor it is rounding.
const NOISE: f64 = 2.0;

/// Imbalance of a step over the kinetic energy that may remain: of one sign in every step, it would drift by 4e-14 in
/// ten thousand.
const NEGLIGIBLE_IMBALANCE: f64 = 4e-18;

/// Largest effect of rounding on energy or momenta of a step: three digits are left.
pub(crate) const LARGEST_ROUNDING: f64 = 1e-3;

fn no_digits(rounding: f64, state: &State, step_size: f64) -> Error {
    let step = state.step + 1;
    let time = state.time + step_size;
    Error::NoDigits { step, time, digits: -rounding.log10() }
}

/// The error of an iteration whose residual is not a number, at the first such node.
fn not_a_number(residual: &[f64], system: &StageSystem<'_>, state: &State, step_size: f64) -> Error {
    let body = system.equations.body;
    let of_rates = residual.iter().take(system.equations.blocks.rates);
    let dofs = of_rates.enumerate().filter(|(_, r)| !r.is_finite()).map(|(at, _)| at % body.n_dofs());
    let own = dofs.map(|dof| dof / 3).find(|node| body.space.own_nodes().contains(node));
    let node = body.space.lowest_node(own).unwrap_or(0);
    Error::NotANumber {
        step: state.step + 1,
        time: state.time + step_size,
        node,
        position: body.space.at_node(node, |node| state.position(body, node)),
    }
}
