//! The interface of a force to a body and to a step.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use super::contact_summary::ContactSummary;
use super::integral::Scratch;
use super::pressures::PressureCells;
use super::signal::Signal;
use super::step::{Sampling, StepInput, StepStart};
use super::strain_state::{ContactAtNode, StrainState};
use crate::average::{Request, Rule};
use crate::error::{Error, Result};
use crate::input::{NotFinite, SignalTarget, TimeFunction};
use crate::sparse::{Couplings, RowPart};
use crate::team::Subdomain;

/// The term of the energy balance in which a force counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Book {
    /// Its energy is a part of that of the body.
    Stored,
    /// Its work is done from outside.
    Work,
    /// Its work is lost.
    Dissipated,
}

/// The momentum balances in which a force counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// It has neither a resultant nor a moment.
    Inside,
    /// It acts from outside.
    Outside,
}

/// A force on the nodes of a body: stage averages f_i, their derivatives, energy and dissipation.
///
/// A stored force is on the left of the equations of motion, `M a + f = F`, like that of a spring; other forces are on
/// the right. The step knows of a force only what is here; one that does not answer a question has no part in it.
pub trait Force: fmt::Debug + Send + Sync {
    /// Where its energy counts.
    fn book(&self) -> Book;

    /// Where its impulse counts.
    fn side(&self) -> Side;

    /// Whether it depends on the place of the body, not only on its shape, as a potential from outside does.
    fn depends_on_place(&self) -> bool {
        self.book() == Book::Stored && self.side() == Side::Outside
    }

    /// Whether it acts on the nodes of joints alone. Where a body has constraints, its derivatives are taken exactly
    /// together with theirs, not into the kept stiffness.
    fn acts_on_joint_nodes(&self) -> bool {
        false
    }

    /// Whether its derivatives are those of [`Force::add_couplings`]: they set in suddenly, between nodes that the
    /// pattern of the body may not couple. They are taken exactly, not into the kept stiffness.
    fn has_couplings(&self) -> bool {
        false
    }

    /// Nodes and quadrature points of a cell, for the memory of an assembly.
    fn scratch_size(&self) -> [usize; 2] {
        [0; 2]
    }

    /// Working memory in a stepper with a rule.
    fn memory(&self, _: &Rule) -> ForceMemory {
        ForceMemory::default()
    }

    /// Begins a step. Adds the stage averages that do not depend on the motion to `steady: [k][n_nodes][3]`, and
    /// returns whether the force acts in the step; one that does not is not assembled.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    fn begin(&self, _: &StepStart<'_>, _: &mut ForceMemory, _steady: &mut [f64]) -> Result<bool> {
        Ok(true)
    }

    /// Whether all its stage averages are set by [`Force::begin`].
    fn is_steady(&self) -> bool {
        false
    }

    /// Evaluates what all rows share, before they are assembled.
    ///
    /// # Errors
    /// As [`Force::assemble`].
    fn prepare(&self, _: (&StepInput<'_>, Request), _: &mut ForceMemory) -> Result<()> {
        Ok(())
    }

    /// Adds stage forces to the rows of a part, and with [`Request::Tangent`] their derivatives, those of forces on the
    /// right with the opposite sign.
    ///
    /// # Errors
    /// The reason why the force refuses the step, such as [`crate::Error::Inverted`].
    fn assemble(
        &self,
        _: (&StepInput<'_>, Request),
        _: &ForceMemory,
        _part: usize,
        _: &mut Scratch,
        _: &mut RowPart,
    ) -> Result<()> {
        Ok(())
    }

    /// Adds the derivatives of the stage forces, as prepared, if [`Force::has_couplings`].
    fn add_couplings(&self, _: &StepInput<'_>, _: &ForceMemory, _: &mut Couplings) {}

    /// Rate r of a force `-r M v` \[1/time\], which the equations take into the inertia.
    fn momentum_rate(&self) -> f64 {
        0.0
    }

    /// Whether it can dissipate energy.
    fn dissipates(&self) -> bool {
        self.book() == Book::Dissipated
    }

    /// Energy that a stored force dissipates in a step \[energy\].
    fn dissipated(&self, _: &StepInput<'_>, _: &mut Scratch) -> f64 {
        0.0
    }

    /// Stored energy, and smallest det F, at a displacement; `coordinates` of the joints as in [`StepInput`], to half a
    /// turn.
    fn strain_state(&self, _displacement: &[f64], _coordinates: &[f64]) -> StrainState {
        StrainState::NONE
    }

    /// Whether its derivative by the displacement is symmetric.
    fn is_symmetric(&self) -> bool {
        true
    }

    /// Adds the product of adjoint vectors with the derivatives of the stage forces by the displacement at the start of
    /// the step, at fixed rates; `adjoint: [k][n_nodes][3]`, `gradient: [n_nodes][3]`.
    ///
    /// ```math
    /// sum_i (df_i/du_1)^T mu_i
    /// ```
    fn add_start_gradient(&self, _: &StepInput<'_>, _adjoint: &[f64], _gradient: &mut [f64]) {}

    /// Angular velocity of the observer that sees the force \[1/time\]; `None` for an observer at rest.
    fn observer_spin(&self) -> Option<[f64; 3]> {
        None
    }

    /// Why adjoints do not cover the force.
    fn without_adjoint(&self) -> Option<&'static str> {
        None
    }

    /// Calls a function with the stage average of the force of a support or an obstacle on the body at each node.
    fn for_each_reaction(
        &self,
        _: (&StepInput<'_>, &ForceMemory),
        _stage: usize,
        _: &mut dyn FnMut(usize, [f64; 3]),
    ) {
    }

    /// Whether it bounds corrections.
    fn bounds(&self) -> bool {
        false
    }

    /// Largest part, up to 1, of a correction of the rates that the force admits.
    fn largest_part(&self, _: &StepInput<'_>, _: &ForceMemory, _correction: &[f64]) -> f64 {
        1.0
    }

    /// Whether it sets in within the step at these rates, or may: its derivatives at the start are then of no use.
    fn is_sudden(&self, _: &StepInput<'_>, _: &ForceMemory) -> bool {
        false
    }

    /// Number of its history variables, on which later steps depend. They are zero at first and the same on all ranks.
    /// They belong to the state of the motion ([`crate::time::State::history`]), so a step that is given up leaves no
    /// trace.
    fn n_history(&self) -> usize {
        0
    }

    /// Takes the history variables, `[n_history]`, from the start of a step with some rates to its end.
    fn update_history(&self, _: &StepInput<'_>, _: &ForceMemory, _history: &mut [f64]) {}

    /// Its interface as a load; `None` for a force that does not depend on time.
    fn over_time(&self) -> Option<&dyn OverTime> {
        None
    }

    /// The contact that exerts it; `None` for other forces.
    fn contact(&self) -> Option<&ContactSummary> {
        None
    }

    /// Calls a function with contact at each node of its surfaces at a displacement. Of a node with several calls the
    /// pressures add up, and the smallest gap counts.
    fn for_each_contact_node(&self, _displacement: &[f64], _: &mut dyn FnMut(usize, ContactAtNode)) {}

    /// Nodes and pressures of cells with a projected volume; `None` for other forces.
    fn pressure_cells(&self) -> Option<PressureCells<'_>> {
        None
    }
}

/// The interface of a load, a force that is given as a function of time.
pub trait OverTime {
    /// Number of the load.
    fn number(&self) -> usize;

    /// Its factor over time.
    fn time_function(&self) -> &TimeFunction;

    /// The factor at a time.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    fn factor(&self, time: f64) -> Result<f64> {
        let value = self.time_function().value(time);
        if value.is_finite() { Ok(value) } else { Err(self.not_finite(NotFinite { time, value })) }
    }

    /// Sets the factor of each stage of a step, `factors: [k]`; returns whether one is not zero.
    ///
    /// # Errors
    /// [`Error::NotFiniteAt`].
    fn stage_factors(&self, start: &StepStart<'_>, factors: &mut [f64]) -> Result<bool> {
        let span = start.span;
        match start.sampling {
            Sampling::Averages => {
                let found = self.time_function().averages(span.start, span.size, start.rule, factors);
                found.map_err(|found| self.not_finite(found))?;
            }
            Sampling::Points => {
                for (factor, &alpha) in factors.iter_mut().zip(start.rule.nodes()) {
                    *factor = self.factor(span.time(alpha))?;
                }
            }
        }
        Ok(factors.iter().any(|&factor| factor != 0.0))
    }

    /// The error of a factor that is not a finite number.
    fn not_finite(&self, found: NotFinite) -> Error {
        let text = self.time_function().text().unwrap_or_default();
        SignalTarget::Load(self.number()).not_finite(text, found)
    }

    /// The smooth function of time in it. A call of all ranks.
    fn signal(&self, _: &Subdomain) -> Option<Signal> {
        Signal::of(self.time_function(), SignalTarget::Load(self.number()), None, 0.0)
    }

    /// The load of a time, before a jump there, in proportion to a fraction from 0 to 1 that takes the place of time.
    fn in_proportion(&self, time: f64, n_dofs: usize) -> Arc<dyn Force>;

    /// Adds the force at factor 1 in the reference configuration, `force: [n_nodes][3]`; of a field, with its time
    /// function, at t = 0, or NaN if it is not finite there.
    fn add_unit_force(&self, force: &mut [f64]);

    /// A point and a time of a span at which a field is not a finite number.
    fn find_not_finite(&self, _span: [f64; 2]) -> Option<([f64; 3], f64)> {
        None
    }
}

/// Working memory of a force in a stepper: a type of its own choice.
#[derive(Default)]
pub struct ForceMemory(Option<Box<dyn Any + Send + Sync>>);

impl ForceMemory {
    /// No memory.
    pub const NONE: ForceMemory = ForceMemory(None);

    /// Memory of a type.
    pub fn new(memory: impl Any + Send + Sync) -> Self {
        ForceMemory(Some(Box::new(memory)))
    }

    /// The memory.
    ///
    /// # Panics
    /// If it is not of this type, which the force itself has chosen.
    pub fn of<T: 'static>(&self) -> &T {
        self.0.as_ref().and_then(|memory| memory.downcast_ref()).expect(OWN_MEMORY)
    }

    /// The memory.
    ///
    /// # Panics
    /// As [`ForceMemory::of`].
    pub fn of_mut<T: 'static>(&mut self) -> &mut T {
        self.0.as_mut().and_then(|memory| memory.downcast_mut()).expect(OWN_MEMORY)
    }
}

const OWN_MEMORY: &str = "a force has the memory that it has made";

impl fmt::Debug for ForceMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "ForceMemory(..)" } else { "ForceMemory" })
    }
}
