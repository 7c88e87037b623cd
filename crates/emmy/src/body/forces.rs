//! The forces of a body as one list, and what a step asks of it.

use std::sync::Arc;

use rayon::prelude::*;

use super::system::Body;
use crate::average::{FollowerRule, Request, Rule};
use crate::error::Result;
use crate::force::{
    Book, Cells, ContactSummary, Force, ForceMemory, OverTime, PressureResults, Sampling, Scratch, Side,
    StepInput, StepStart, StrainState, cells,
};
use crate::input::Span;
use crate::quadrature::Quadrature;
use crate::space::Reaction;
use crate::sparse::{Couplings, RowPart, StageMatrix};

/// Stage forces and matrix of a body, with the working memory of their assembly.
#[derive(Debug)]
pub struct Assembly {
    /// Forces and matrix.
    pub matrix: StageMatrix,
    parts: Vec<Part>,
    acting: Acting,
}

#[derive(Debug)]
struct Part {
    scratch: Scratch,
    outcome: Result<()>,
}

/// The forces other than those of cells in the steps of one stepper: their memory, and the stage averages of those on
/// the right.
#[derive(Debug)]
struct Acting {
    /// Points at which the rule of the stepper takes loads.
    points: FollowerRule,
    memories: Vec<ForceMemory>,
    /// Whether each acts in the present step.
    acts: Vec<bool>,
    /// Sum of the forces that do not depend on the motion, `[k][n_nodes][3]`.
    steady: Vec<f64>,
    /// Sum of the others, as evaluated last.
    varying: Vec<f64>,
    /// Whether there are others.
    varies: bool,
    /// History variables before the first step.
    no_history: Vec<f64>,
}

impl Assembly {
    /// Results of the cells of a force with pressures, part by part.
    pub(super) fn pressure_results(&self, force: usize) -> impl Iterator<Item = &PressureResults> {
        self.parts.iter().map(move |part| &part.scratch.pressures[force])
    }

    /// Stage average of all forces on the right, at the rates evaluated last; `at`: position in
    /// `[k][n_nodes][3]`.
    #[inline]
    pub(crate) fn external(&self, at: usize) -> f64 {
        self.acting.steady[at] + self.acting.varying[at]
    }

    /// The part of these forces that does not depend on the motion, and the rest, both `[k][n_nodes][3]`.
    #[doc(hidden)]
    pub fn external_parts(&self) -> [&[f64]; 2] {
        [&self.acting.steady, &self.acting.varying]
    }

    /// Whether some of these forces depend on the motion in the present step.
    pub(crate) fn varies(&self) -> bool {
        self.acting.varies
    }
}

/// The memory of the forces of cells.
static NO_MEMORY: ForceMemory = ForceMemory::NONE;

/// Whether a force is on the right of the equations of motion.
fn is_on_right(force: &dyn Force) -> bool {
    force.book() != Book::Stored
}

/// Whether a force connects the body to the ground by a potential.
fn is_ground(force: &dyn Force) -> bool {
    force.book() == Book::Stored && force.side() == Side::Outside
}

impl Body {
    /// Makes the forces of the cells.
    fn make_cells(&self) -> Cells {
        let counts = |cell: u32| self.ranks().counts()[cell as usize];
        let of_cells = |chosen: &dyn Fn(u32) -> bool| {
            let (mesh, internal) = (self.mesh(), self.space.internal());
            // Cells of rigid bodies are not strained.
            let chosen = |cell: u32| {
                let nodes = mesh.cell(cell as usize).nodes;
                chosen(cell) && !self.mechanism.moves(nodes, |node| self.leaders_of(node))
            };
            let forces = cells::forces(mesh, &self.made_of, &self.region_of_cell, internal, chosen);
            // The builder has checked all else.
            forces.unwrap_or_else(|error| panic!("{error}"))
        };
        let mut all = of_cells(&counts);
        let n_counted = all.len();
        if self.space.is_shared() {
            all.extend(of_cells(&|cell| !counts(cell)));
        }
        all.iter_mut().for_each(|force| force.attach(&self.pattern, &self.parts));
        cells::number_pressures(&mut all, &self.parts);
        Cells { all, n_counted }
    }

    fn cells(&self) -> &Cells {
        self.forces.cells.get_or_init(|| self.make_cells())
    }

    /// All forces.
    pub(super) fn forces(&self) -> impl Iterator<Item = &dyn Force> {
        self.cells().all.iter().map(|force| force as &dyn Force).chain(self.others())
    }

    /// The forces that count here: not those of cells that count on another rank.
    pub(super) fn counted_forces(&self) -> impl Iterator<Item = &dyn Force> {
        let Cells { all, n_counted } = self.cells();
        all[..*n_counted].iter().map(|force| force as &dyn Force).chain(self.others())
    }

    /// The forces that are not those of cells.
    fn others(&self) -> impl Iterator<Item = &dyn Force> {
        self.forces.others.iter().map(|force| &**force)
    }

    /// The forces that are given over time.
    pub(super) fn over_time(&self) -> impl Iterator<Item = &dyn OverTime> {
        self.others().filter_map(|force| force.over_time())
    }

    /// Traces of viscosity and elasticity at rest, summed over all cells that count here.
    pub(super) fn viscosity_and_stiffness(&self) -> [f64; 2] {
        let Cells { all, n_counted } = self.cells();
        let traces = all[..*n_counted].iter().map(|force| force.viscosity_and_stiffness());
        traces.fold([0.0; 2], |sum, traces| [sum[0] + traces[0], sum[1] + traces[1]])
    }

    /// Memory for the steps of a rule.
    #[doc(hidden)]
    pub fn assembly(&self, rule: &Rule) -> Assembly {
        let degree = rule.degree();
        let largest = |at: usize| self.forces().map(|force| force.scratch_size()[at]).max().unwrap_or(0);
        let [n_nodes, n_points] = [0, 1].map(largest);
        let n_pressure_forces = self.forces().filter(|force| force.pressure_cells().is_some()).count();
        let scratch = || Scratch::new(degree, n_nodes, n_points, n_pressure_forces);
        Assembly {
            matrix: StageMatrix::new(&self.pattern, &self.parts, degree),
            parts: self.parts.iter().map(|_| Part { scratch: scratch(), outcome: Ok(()) }).collect(),
            acting: self.acting(rule),
        }
    }

    /// Memory for a stiffness that is kept while bodies turn against each other: without the forces whose derivatives
    /// are taken exactly, with those of the constraints or with their couplings.
    pub(crate) fn assembly_to_keep(&self, rule: &Rule) -> Assembly {
        let mut assembly = self.assembly(rule);
        let is_constrained = !self.constraints().is_empty();
        for (force, acts) in self.others().zip(&mut assembly.acting.acts) {
            *acts = !(force.has_couplings() || is_constrained && force.acts_on_joint_nodes());
        }
        assembly
    }

    fn acting(&self, rule: &Rule) -> Acting {
        let memories: Vec<ForceMemory> = self.others().map(|force| force.memory(rule)).collect();
        let [steady, varying] = [(); 2].map(|()| vec![0.0; rule.degree() * self.n_dofs()]);
        Acting {
            points: FollowerRule::new(rule),
            acts: vec![true; memories.len()],
            memories,
            steady,
            varying,
            varies: false,
            no_history: vec![0.0; self.n_history()],
        }
    }

    /// Begins a step: evaluates what is given over time. Returns whether some force on the right acts. `history`: that
    /// of the state, `[n_history]`; empty for zeros.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    #[doc(hidden)]
    pub fn begin(
        &self,
        rule: &Rule,
        (span, sampling): (Span, Sampling),
        history: &[f64],
        assembly: &mut Assembly,
    ) -> Result<bool> {
        self.begin_acting(rule, (span, sampling), history, &mut assembly.acting)
    }

    fn begin_acting(
        &self,
        rule: &Rule,
        (span, sampling): (Span, Sampling),
        history: &[f64],
        acting: &mut Acting,
    ) -> Result<bool> {
        let Acting { points, memories, acts, steady, varying, varies, no_history } = acting;
        let mut histories = if history.is_empty() { &no_history[..] } else { history };
        steady.fill(0.0);
        if std::mem::take(varies) {
            varying.fill(0.0);
        }
        let (mut outcome, mut is_loaded) = (Ok(()), false);
        for ((force, memory), acts) in self.others().zip(memories).zip(acts) {
            let (history, others) = histories.split_at(force.n_history());
            histories = others;
            let start = StepStart { rule, points, span, sampling, history };
            match force.begin(&start, memory, steady) {
                Ok(begun) => *acts = begun,
                Err(error) => outcome = outcome.and(Err(error)),
            }
            is_loaded |= *acts && is_on_right(force);
            *varies |= *acts && is_on_right(force) && !force.is_steady();
        }
        self.space.gather(steady);
        // A field may fail at a point of one rank alone; whether it acts depends on the time alone.
        self.space.agree(outcome).map(|()| is_loaded)
    }

    /// Stage averages of the stored forces; with [`Request::Tangent`] also the stage matrix
    /// `mass_coefficients_ij M + tangent_factor df_i/dx_j`.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`] if a cell is inverted, and the reasons of other forces.
    #[doc(hidden)]
    pub fn assemble(
        &self,
        step: &StepInput<'_>,
        request: Request,
        mass_coefficients: &[f64],
        assembly: &mut Assembly,
    ) -> Result<()> {
        let mass = (request == Request::Tangent).then_some(mass_coefficients);
        self.assemble_those(|force| force.book() == Book::Stored, (step, request), mass, assembly)
    }

    /// Evaluates the forces on the right that depend on the motion.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    #[doc(hidden)]
    pub fn evaluate_external(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> Result<()> {
        if assembly.acting.varies {
            let is_wanted = |force: &dyn Force| is_on_right(force) && !force.is_steady();
            self.assemble_those(is_wanted, (step, Request::Stress), None, assembly)?;
            assembly.matrix.copy_force(&mut assembly.acting.varying);
        }
        Ok(())
    }

    /// Adds the derivatives of these forces to the stage matrix, times `-tangent_factor`: they have the opposite sign
    /// in the equations.
    ///
    /// # Errors
    /// As [`Body::evaluate_external`].
    #[doc(hidden)]
    pub fn add_external_tangent(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> Result<()> {
        if !assembly.acting.varies {
            return Ok(());
        }
        let is_wanted = |force: &dyn Force| is_on_right(force) && !force.is_steady();
        self.assemble_those(is_wanted, (step, Request::Tangent), None, assembly)
    }

    /// Stage averages of the force of the body on the ground through potentials, `force: [k][n_nodes][3]`. Its negative
    /// is an external force in the momentum balances.
    ///
    /// # Errors
    /// As [`Body::assemble`].
    pub(crate) fn ground_force(
        &self,
        step: &StepInput<'_>,
        assembly: &mut Assembly,
        force: &mut [f64],
    ) -> Result<()> {
        self.assemble_those(is_ground, (step, Request::Stress), None, assembly)?;
        assembly.matrix.copy_force(force);
        Ok(())
    }

    /// Stage averages of the forces of contact between bodies, `force: [k][n_nodes][3]`.
    ///
    /// # Errors
    /// As [`Body::assemble`].
    pub(super) fn touching_force_at(
        &self,
        step: &StepInput<'_>,
        assembly: &mut Assembly,
        force: &mut [f64],
    ) -> Result<()> {
        let is_wanted = |force: &dyn Force| force.side() == Side::Inside && force.contact().is_some();
        self.assemble_those(is_wanted, (step, Request::Stress), None, assembly)?;
        assembly.matrix.copy_force(force);
        Ok(())
    }

    /// Stage averages of the forces whose work is lost, `force: [k][n_nodes][3]`; false if there are none.
    ///
    /// # Errors
    /// As [`Body::evaluate_external`].
    pub(crate) fn loss_force(
        &self,
        step: &StepInput<'_>,
        assembly: &mut Assembly,
        force: &mut [f64],
    ) -> Result<bool> {
        let loses = |force: &dyn Force| force.book() == Book::Dissipated;
        let mut others = self.others().zip(&assembly.acting.acts);
        if !others.any(|(force, acts)| *acts && loses(force)) {
            return Ok(false);
        }
        self.assemble_those(loses, (step, Request::Stress), None, assembly)?;
        assembly.matrix.copy_force(force);
        Ok(true)
    }

    /// Assembles some of the forces, rows by rows, beside a multiple of the mass if it is given.
    fn assemble_those(
        &self,
        is_wanted: impl Fn(&dyn Force) -> bool + Sync,
        input: (&StepInput<'_>, Request),
        mass: Option<&[f64]>,
        assembly: &mut Assembly,
    ) -> Result<()> {
        let Assembly { matrix, parts, acting } = assembly;
        let n_cells = self.cells().all.len();
        self.prepare(&is_wanted, input, acting)?;
        let work = |(index, (sink, part)): (usize, (&mut RowPart, &mut Part))| {
            sink.clear_force();
            if let Some(coefficients) = mass {
                sink.set_blocks(&self.mass, coefficients);
            }
            let mut forces = self.forces().enumerate().filter(|(_, force)| is_wanted(*force));
            part.outcome = forces.try_for_each(|(at, force)| {
                let memory = match at.checked_sub(n_cells) {
                    Some(other) if !acting.acts[other] => return Ok(()),
                    Some(other) => &acting.memories[other],
                    None => &NO_MEMORY,
                };
                force.assemble(input, memory, index, &mut part.scratch, sink)
            });
        };
        let rows = matrix.parts_mut();
        if rows.len() == 1 {
            rows.iter_mut().zip(&mut *parts).enumerate().for_each(work);
        } else {
            rows.par_iter_mut().zip(&mut *parts).enumerate().for_each(work);
        }
        self.space.agree(parts.iter().try_for_each(|part| part.outcome.clone()))?;
        if mass.is_some() {
            self.set_couplings(input.0, acting, &mut matrix.couplings);
        }
        self.space.ties().fold(&self.pattern, matrix, input.1 == Request::Tangent);
        Ok(())
    }

    /// Whether some force has couplings.
    pub(crate) fn has_couplings(&self) -> bool {
        self.others().any(|force| force.has_couplings())
    }

    /// Sets the couplings of a stage matrix to those at the rates of a step; all else in it stays.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(crate) fn renew_couplings(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> Result<()> {
        let Assembly { matrix, acting, .. } = assembly;
        self.prepare(|force| force.has_couplings(), (step, Request::Tangent), acting)?;
        self.set_couplings(step, acting, &mut matrix.couplings);
        Ok(())
    }

    /// Sets the couplings of all forces, as prepared, without nodes that follow others.
    fn set_couplings(&self, step: &StepInput<'_>, acting: &Acting, couplings: &mut Couplings) {
        couplings.clear();
        let forces = self.others().zip(&acting.memories).zip(&acting.acts);
        for ((force, memory), _) in forces.filter(|((force, _), acts)| **acts && force.has_couplings()) {
            force.add_couplings(step, memory, couplings);
        }
        self.space.ties().fold_couplings(couplings);
    }

    /// Lets forces evaluate what all rows share; those that do are refused on a team.
    fn prepare(
        &self,
        is_wanted: impl Fn(&dyn Force) -> bool,
        input: (&StepInput<'_>, Request),
        acting: &mut Acting,
    ) -> Result<()> {
        let mut forces = self.others().zip(&mut acting.memories).zip(&acting.acts);
        forces.try_for_each(|((force, memory), acts)| match *acts && is_wanted(force) {
            true => force.prepare(input, memory),
            false => Ok(()),
        })
    }

    /// Whether some force bounds corrections.
    pub(crate) fn has_bounds(&self) -> bool {
        self.others().any(|force| force.bounds())
    }

    /// Largest part, up to 1, of a correction of the rates that the forces admit, on all ranks.
    pub(crate) fn largest_part(&self, step: &StepInput<'_>, assembly: &Assembly, correction: &[f64]) -> f64 {
        if !self.has_bounds() {
            return 1.0;
        }
        let forces = self.others().zip(&assembly.acting.memories);
        let parts = forces.map(|(force, memory)| force.largest_part(step, memory, correction));
        let mut most = [-parts.fold(1.0, f64::min)];
        self.space.largest_of_ranks("part of a correction", &mut most);
        -most[0]
    }

    /// Whether some force sets in within the step, with derivatives unlike those at its start.
    pub(crate) fn has_sudden_force(&self, step: &StepInput<'_>, assembly: &Assembly) -> bool {
        let mut forces = self.others().zip(&assembly.acting.memories);
        forces.any(|(force, memory)| force.is_sudden(step, memory))
    }

    /// Number of history variables of all forces.
    pub(crate) fn n_history(&self) -> usize {
        self.others().map(|force| force.n_history()).sum()
    }

    /// Takes the history variables of all forces from the start of a step to its end.
    pub(crate) fn update_history(&self, step: &StepInput<'_>, assembly: &Assembly, mut history: &mut [f64]) {
        for (force, memory) in self.others().zip(&assembly.acting.memories) {
            let (own, others) = history.split_at_mut(force.n_history());
            force.update_history(step, memory, own);
            history = others;
        }
    }

    /// The contacts, in the order of the builder.
    pub fn contacts(&self) -> impl Iterator<Item = &ContactSummary> {
        self.others().filter_map(|force| force.contact())
    }

    /// The forces of the contacts.
    pub(super) fn forces_of_contact(&self) -> Vec<Arc<dyn Force>> {
        self.forces.others.iter().filter(|force| force.contact().is_some()).cloned().collect()
    }

    /// Name of the first contact in which something is near a node at a displacement.
    pub(crate) fn contact_near(&self, node: usize, displacement: &[f64]) -> Option<&str> {
        let is_near = |force: &&dyn Force| {
            let mut is_near = false;
            force.for_each_contact_node(displacement, &mut |own, at_node| {
                is_near |= own == node && (at_node.gap.is_finite() || at_node.pressure > 0.0);
            });
            is_near
        };
        self.others().find(is_near)?.contact().map(|contact| contact.name.as_str())
    }

    /// Rate of the drag \[1/time\].
    pub fn drag(&self) -> f64 {
        self.others().map(|force| force.momentum_rate()).sum()
    }

    /// Whether some force dissipates energy: of viscosity, drag or a damper in a joint.
    pub fn dissipates(&self) -> bool {
        self.is_viscous() || self.has_dampers()
    }

    /// Whether forces beside those of the cells dissipate energy.
    pub(crate) fn has_dampers(&self) -> bool {
        self.others().any(|force| force.dissipates())
    }

    /// Energy that viscosity and the scheme dissipate through strain rates in a step \[energy\].
    ///
    /// ```math
    /// sum_i b_i integral S_i : E'_i dV
    /// ```
    pub(crate) fn dissipated(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> f64 {
        let scratch = &mut assembly.parts[0].scratch;
        let mut sum = [self.counted_forces().map(|force| force.dissipated(step, scratch)).sum()];
        self.space.sum_ranks("dissipated energy", &mut sum);
        sum[0]
    }

    /// Product of adjoint vectors with the derivatives of the stage averages by the displacement at the start of the
    /// step, at fixed rates; `adjoint: [k][n_nodes][3]`, `gradient: [n_nodes][3]`. Loads are not included.
    ///
    /// ```math
    /// sum_i (df_i/du_1)^T mu_i
    /// ```
    pub(crate) fn start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        gradient.fill(0.0);
        self.forces().for_each(|force| force.add_start_gradient(step, adjoint, gradient));
    }

    /// Why adjoints do not cover some force; `None` if they cover all.
    pub(crate) fn without_adjoint(&self) -> Option<&'static str> {
        let history = "forces with a history are not covered";
        let follows = "forces that follow the motion are not covered; dead loads are";
        self.forces().find_map(|force| {
            let has_history = (force.n_history() > 0).then_some(history);
            let is_varying = is_on_right(force) && !force.is_steady() && force.momentum_rate() == 0.0;
            force.without_adjoint().or(has_history).or(is_varying.then_some(follows))
        })
    }

    /// Angular velocity of the observer, in whose axes the body is at rest in equilibrium \[1/time\]; `None` for an
    /// observer at rest.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let spun = Load::rotation([0.0, 0.0, 2.0], [0.0; 3], 5.0); // an axis of any length
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(spun).build()?;
    /// assert_eq!(body.observer_spin(), Some([0.0, 0.0, 5.0]));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn observer_spin(&self) -> Option<[f64; 3]> {
        self.others().find_map(|force| force.observer_spin())
    }

    /// Whether the forces of the body, with those on the right, have symmetric derivatives.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.others().all(|force| force.is_symmetric())
    }

    /// Whether all stored energy is that of cells.
    pub(super) fn stores_energy_in_cells_alone(&self) -> bool {
        self.others().all(|force| force.book() != Book::Stored)
    }

    /// Whether springs or attractions connect the body to the ground.
    pub(crate) fn has_ground(&self) -> bool {
        self.others().any(is_ground)
    }

    /// Whether the body is free: no supports, no forces and constraints that depend on its place.
    pub(crate) fn is_free(&self) -> bool {
        let is_placed = self.others().any(|force| force.depends_on_place());
        !is_placed && !self.space.is_supported() && !self.constraints().is_grounded()
    }

    /// Strain energy and smallest det F of the forces that count here.
    pub(super) fn own_strain_state(&self, displacement: &[f64], coordinates: &[f64]) -> StrainState {
        let states = self.counted_forces().map(|force| force.strain_state(displacement, coordinates));
        states.fold(StrainState::NONE, StrainState::with)
    }

    /// Whether some force counts among the reactions.
    pub(crate) fn has_reactions_of_forces(&self) -> bool {
        self.space.groups().iter().any(|group| !group.springs.is_empty())
    }

    /// Evaluates what the forces among the reactions need.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(crate) fn prepare_reactions(&self, step: &StepInput<'_>, assembly: &mut Assembly) -> Result<()> {
        for &force in self.space.groups().iter().flat_map(|group| &group.springs) {
            let memory = &mut assembly.acting.memories[force];
            self.forces.others[force].prepare((step, Request::Stress), memory)?;
        }
        Ok(())
    }

    /// Adds the forces of the springs of supports on the body in a stage, times a weight; `displacement`: in the stage.
    pub(crate) fn add_spring_reactions(
        &self,
        (step, assembly): (&StepInput<'_>, &Assembly),
        stage: usize,
        weight: f64,
        displacement: &[f64],
        reactions: &mut [Reaction],
    ) {
        for (group, reaction) in self.space.groups().iter().zip(reactions) {
            for &spring in &group.springs {
                let input = (step, &assembly.acting.memories[spring]);
                self.forces.others[spring].for_each_reaction(input, stage, &mut |node, force| {
                    reaction.add_at(self.space.position(displacement, node), force.map(|f| weight * f));
                });
            }
        }
    }
}

/// The rule that takes the loads of one time.
fn of_one_time() -> Rule {
    Rule::standard(1, &Quadrature { points: vec![[1.0]], weights: vec![1.0] })
}

impl Body {
    /// Dead loads at a time (after a jump of a time function at this time), `force: [n_nodes][3]`. Returns whether any
    /// load acts.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub fn loads_at(&self, time: f64, force: &mut [f64]) -> Result<bool> {
        let rule = of_one_time();
        let mut acting = self.acting(&rule);
        let acts = self.begin_acting(&rule, (Span::at(time), Sampling::Points), &[], &mut acting)?;
        force.copy_from_slice(&acting.steady);
        Ok(acts)
    }
}

#[cfg(test)]
mod tests;
