//! The loop over the steps.

use super::adaptive::Control;
use super::degrees::degree_of;
use super::plan::SHORTEST;
use super::{
    Division, Event, EventKind, MarchError, Observer, PlannedStep, Record, Resolution, RunStatistics,
    Snapshot, State, StepPlan, View,
};
use crate::body::Body;
use crate::error::{Error, Result};
use crate::newton::NewtonSettings;
use crate::number::short;
use crate::time::{LARGEST_ROUNDING, Memory, Scheme, StepOutcome, Stepper};

/// A body in motion: its state, and the stepper that advances it.
///
/// ```
/// use emmy::{body::{Body, Region, InitialVelocity}, material::NeoHooke, mesh};
/// use emmy::{motion::{Motion, NewtonSettings, Phase, State, StepPlan}, time::Scheme};
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::new(mesh::block([1.0; 3], [1; 3])?, vec![Region::new(None, 1.0, rubber)], &[], &[])?;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 6.0], about: [0.5; 3], ..Default::default() };
/// let state = State::initial(&body, 0.0, &[spin])?;
/// let mut motion = Motion::new(&body, Scheme::DiscreteGradient, 2, NewtonSettings::default(), state)?;
/// motion.march(&StepPlan::new(0.0, vec![Phase { until: 1.0, size: 0.1 }])?, &mut []).unwrap();
/// assert!((motion.record().total_energy - 3.0).abs() < 1e-12); // m (a^2 + b^2) / 12 * omega^2 / 2
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Motion<'a> {
    pub(super) body: &'a Body,
    /// The scheme as it was given; where the degree has changed since it is that of [`Scheme::of_degree`].
    pub(super) scheme: Scheme,
    pub(super) degree: usize,
    pub(super) settings: NewtonSettings,
    pub(super) stepper: Box<dyn Stepper + 'a>,
    pub(super) state: State,
    /// The state before the last step.
    last: State,
    pub(super) record: Record,
    pub(super) statistics: RunStatistics,
    /// Smallest size that a failing step is cut down to; `None`: failing steps are not cut.
    smallest: Option<SmallestStep>,
    division: Division,
    /// What chooses the step sizes by the error, or its memory, of which it is to be made.
    pub(super) control: Option<Control<'a>>,
    pub(super) control_memory: Option<Memory>,
    /// Whether steps resolve what acts on the body; `None` where there is nothing to resolve.
    pub(super) resolution: Option<Resolution>,
    pub(super) releases: usize,
    was_at_rounding_floor: bool,
    /// Cuts, refusals and releases since the last good step.
    pub(super) cuts: usize,
    pub(super) refusals: usize,
    released: usize,
    /// Events that observers have not seen yet.
    events: Vec<Event>,
}

/// How far a failing step may be cut.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SmallestStep {
    /// Down to a size \[time\].
    Size(f64),
    /// Down to this part of the planned step, given as the number of cuts.
    Level(u32),
}

/// Cuts of a planned step by two, where no smallest size is given: down to 1/1024 of it.
const MAX_CUTS: u32 = 10;

/// Times that lie closer together than this part of a step are the same: they differ by rounding.
pub(super) const SAME_TIME: f64 = 1e-6;

impl<'a> Motion<'a> {
    /// A motion that starts from a state.
    ///
    /// # Errors
    /// Those of [`Scheme::stepper`].
    pub fn new(
        body: &'a Body,
        scheme: Scheme,
        degree: usize,
        settings: NewtonSettings,
        mut state: State,
    ) -> Result<Self> {
        let stepper = scheme.stepper(body, degree, settings, &mut state)?;
        let record =
            Record { step: state.step, time: state.time, degree, ..Record::default() }.at(body, &state);
        let mut statistics = RunStatistics::default();
        statistics.add(body, &state, &record);
        Ok(Motion {
            body,
            scheme,
            degree,
            settings,
            stepper,
            last: state.clone(),
            state,
            record,
            statistics,
            smallest: None,
            division: Division::default(),
            control: None,
            control_memory: None,
            resolution: None,
            releases: 0,
            was_at_rounding_floor: false,
            cuts: 0,
            refusals: 0,
            released: 0,
            events: Vec::new(),
        })
    }

    /// A motion that goes on from a snapshot. With the stepper's memory, and the same scheme, degree and settings, every bit is that
    /// of the motion that the snapshot was taken of. Where that chose its degree it is the one of the snapshot.
    ///
    /// # Errors
    /// Those of [`Scheme::stepper`] and [`Stepper::restore`], [`Error::Memory`] for a state of another body.
    pub fn resumed(
        mut body: &'a Body,
        scheme: Scheme,
        degree: usize,
        settings: NewtonSettings,
        snapshot: Snapshot,
    ) -> Result<Self> {
        let Snapshot {
            state,
            record,
            statistics,
            division,
            control,
            releases,
            was_at_rounding_floor,
            memory,
        } = snapshot;
        for _ in 0..releases {
            let Some((_, released)) = body.release() else { break };
            body = released;
        }
        for (name, list) in [
            ("displacement", &state.displacement),
            ("momentum", &state.momentum),
            ("velocity", &state.velocity),
        ] {
            if list.len() != body.n_dofs() {
                let reason = format!("has {} numbers, not {}", list.len(), body.n_dofs());
                return Err(Error::Memory { name: name.to_string(), reason });
            }
        }
        let degree = control.as_ref().and_then(degree_of).unwrap_or(degree);
        let mut motion = Motion::new(body, scheme.of_degree(degree), degree, settings, state.clone())?;
        motion.scheme = scheme;
        match &memory {
            Some(memory) => {
                motion.stepper.restore(memory)?;
                (motion.state, motion.record) = (state, record);
            }
            // The new stepper may have set the momentum by a mass of its own.
            None => motion.record = record.at(body, &motion.state),
        }
        Ok(Motion {
            statistics,
            division,
            control_memory: control,
            releases,
            was_at_rounding_floor,
            ..motion
        })
    }

    /// All that the motion is now; see [`Motion::resumed`].
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            state: self.state.clone(),
            record: self.record.clone(),
            statistics: self.statistics.clone(),
            division: self.division,
            control: self
                .control
                .as_ref()
                .map(|control| control.memory(self.degree))
                .or(self.control_memory.clone()),
            releases: self.releases,
            was_at_rounding_floor: self.was_at_rounding_floor,
            memory: Some(self.stepper.memory()),
        }
    }

    /// Has failing steps of a march cut by two (see [`Division`]), down to a size; without one, to 1/1024 of the planned step.
    pub fn allow_cuts(&mut self, smallest_step: Option<f64>) {
        self.smallest = Some(smallest_step.map_or(SmallestStep::Level(MAX_CUTS), SmallestStep::Size));
    }

    /// The state reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The body, without the supports that are released by now.
    pub fn body(&self) -> &'a Body {
        self.body
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// Settings of Newton's iteration.
    pub fn settings(&self) -> NewtonSettings {
        self.settings
    }

    /// The record of the last step.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Statistics of all steps so far, those before a resumption included.
    ///
    /// ```
    /// # use emmy::{body::{Body, Region}, material::NeoHooke, mesh};
    /// # use emmy::{motion::{Motion, NewtonSettings, State}, time::Scheme};
    /// # let rubber = Region::new(None, 1.0, NeoHooke::new(1000.0, 500.0)?);
    /// # let body = Body::new(mesh::block([1.0; 3], [1; 3])?, vec![rubber], &[], &[])?;
    /// # let state = State::initial(&body, 0.0, &[])?;
    /// let mut motion = Motion::new(&body, Scheme::DiscreteGradient, 1, NewtonSettings::default(), state)?;
    /// motion.step(0.1, 0.1)?;
    /// assert_eq!(motion.statistics().worst_energy_residual.value, 0.0); // at rest
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn statistics(&self) -> &RunStatistics {
        &self.statistics
    }

    /// Degree of the elements now.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The stepper.
    pub fn stepper(&self) -> &(dyn Stepper + 'a) {
        &*self.stepper
    }

    /// Goes over to the body without the supports that are released by now; times that lie closer together than `same_time` are the
    /// same. The state goes on as it is.
    pub(super) fn release(&mut self, same_time: f64) -> Result<()> {
        while let Some((time, body)) = due_release(self.body, self.state.time, same_time) {
            let scheme = self.scheme.of_degree(self.degree);
            self.stepper = scheme.stepper(body, self.degree, self.settings, &mut self.state)?;
            self.body = body;
            self.releases += 1;
            self.released += 1;
            let message = format!("a support was released (until = {})", short(time));
            self.note(EventKind::Release, self.state.step + 1, message);
        }
        Ok(())
    }

    /// Notes an event at the present time.
    pub(super) fn note(&mut self, kind: EventKind, step: usize, message: String) {
        self.events.push(Event { step, time: self.state.time, kind, message });
    }

    /// Advances by one step of a size and records it. A support that is released holds until the first step that starts at the
    /// time of the release or after it.
    ///
    /// # Errors
    /// Those of [`Stepper::advance`], after a release those of [`Scheme::stepper`]; state and record are then those of the last
    /// good step.
    pub fn step(&mut self, step_size: f64, end: f64) -> Result<&Record> {
        self.release(SAME_TIME * step_size)?;
        let outcome = self.advance(step_size);
        let outcome = outcome.map_err(|error| placed(error, self.body, &self.state, step_size))?;
        let missed =
            self.resolution.as_ref().and_then(|resolution| resolution.unresolved(self.state.time, step_size));
        self.conclude(step_size, end, &outcome);
        self.record.is_unresolved = missed.is_some();
        self.statistics.add(self.body, &self.state, &self.record);
        Ok(&self.record)
    }

    /// Advances the state. One that is not finite is not accepted, whatever its residual says.
    ///
    /// # Errors
    /// Those of [`Stepper::advance`], [`Error::NoDuration`], [`Error::NotANumber`]; the state is then unchanged.
    pub(super) fn advance(&mut self, step_size: f64) -> Result<StepOutcome> {
        let time = self.state.time;
        if !(step_size > SHORTEST * time.abs() && step_size.is_finite()) {
            return Err(Error::NoDuration { time, step_size });
        }
        self.last.copy_from(&self.state);
        let outcome = self.stepper.advance(&mut self.state, step_size)?;
        let lists = [&self.state.displacement, &self.state.velocity, &self.state.momentum];
        let dof = lists.iter().find_map(|list| list.iter().position(|value| !value.is_finite()));
        if dof.is_none() && outcome.strained.strain_energy.is_finite() {
            return Ok(outcome);
        }
        self.state.copy_from(&self.last);
        let node = dof.unwrap_or(0) / 3;
        let position = self.state.position(self.body, node);
        Err(Error::NotANumber { step: self.state.step + 1, time: time + step_size, node, position })
    }

    /// Records a step that the state has done.
    pub(super) fn conclude(&mut self, step_size: f64, end: f64, outcome: &StepOutcome) {
        self.state.time = end;
        self.state.step += 1;
        self.record = self.record.after(self.body, &self.state, step_size, outcome);
        (self.record.cuts, self.record.rejections) = (self.cuts, self.refusals);
        self.record.releases = self.released;
        self.record.degree = self.degree;
        (self.cuts, self.refusals, self.released) = (0, 0, 0);
        if self.record.at_rounding_floor && !self.was_at_rounding_floor {
            self.was_at_rounding_floor = true;
            let message = "Newton's iteration ended at the rounding floor, above the tolerance: the body is too stiff for it";
            self.note(EventKind::RoundingFloor, self.state.step, message.to_string());
        }
    }

    /// Marches through a plan. Observers see the start and every step.
    ///
    /// # Errors
    /// [`MarchError::Step`] if a step fails, [`MarchError::Observer`] if an observer does.
    pub fn march(&mut self, plan: &StepPlan, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.notify(observers)?;
        self.resolution = Resolution::new(self.body, self.scheme, self.degree, plan);
        if let Some(adaptivity) = plan.adaptivity() {
            return self.march_adaptively(plan, adaptivity, observers);
        }
        plan.steps().try_for_each(|step| self.march_through(&step, observers))
    }

    /// Marches on through what is left of a plan. Observers see every step, but not the present state. The time may differ from
    /// the plan's grid by rounding; one that lies inside a planned step goes to its end first.
    ///
    /// # Errors
    /// As those of [`Motion::march`].
    pub fn march_on(
        &mut self,
        plan: &StepPlan,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        self.resolution = Resolution::new(self.body, self.scheme, self.degree, plan);
        if let Some(adaptivity) = plan.adaptivity() {
            return self.march_adaptively(plan, adaptivity, observers);
        }
        for mut step in plan.steps_from(self.state.time) {
            let sliver = SAME_TIME * step.size;
            if (self.division.start(&step) - self.state.time).abs() > sliver {
                self.division = Division { part: 0, ..self.division };
                let start = self.state.time;
                if (step.start - start).abs() > sliver {
                    step = PlannedStep { start, size: step.end - start, ..step };
                }
            }
            self.march_through(&step, observers)?;
        }
        Ok(())
    }

    /// Does what is left of a planned step, in parts where it fails.
    fn march_through(
        &mut self,
        step: &PlannedStep,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), MarchError> {
        loop {
            let (size, end) = self.division.next(step);
            if let Err(error) = self.step(size, end) {
                let cut = self.cut(step, size, error);
                self.tell(observers)?;
                cut?;
                continue;
            }
            let passed = self.division.pass();
            if passed.has_grown {
                self.note(EventKind::Grown, self.state.step, format!("step size back to {}", 2.0 * size));
            }
            self.notify(observers)?;
            self.check_digits()?;
            if passed.is_done {
                return Ok(());
            }
        }
    }

    /// Cuts a step that failed by two.
    ///
    /// # Errors
    /// The error of the step, if it may not be cut; as [`Error::SmallestStep`], if it has been.
    fn cut(&mut self, step: &PlannedStep, size: f64, error: Error) -> Result<(), MarchError> {
        let may_be_cut = match self.smallest {
            None => false,
            Some(SmallestStep::Level(level)) => self.division.level < level,
            Some(SmallestStep::Size(smallest)) => 0.5 * size >= smallest * (1.0 - SAME_TIME),
        };
        if !may_be_cut {
            return Err(MarchError::Step(match size < step.size {
                true => Error::SmallestStep {
                    step: self.state.step + 1,
                    start: self.state.time,
                    step_size: size,
                    cause: Box::new(error),
                },
                false => error,
            }));
        }
        self.division.cut();
        self.cuts += 1;
        self.note(EventKind::Cut, self.state.step + 1, format!("step cut to {}: {error}", short(0.5 * size)));
        Ok(())
    }

    /// Ends a march in which rounding has used up all digits but three: smaller steps would not bring them back.
    ///
    /// # Errors
    /// [`Error::NoDigits`].
    pub(super) fn check_digits(&self) -> Result<()> {
        let Record { step, time, rounding, .. } = self.record;
        if rounding <= LARGEST_ROUNDING {
            return Ok(());
        }
        Err(Error::NoDigits { step, time, digits: -rounding.log10() })
    }

    /// Tells observers of the events that they have not seen yet.
    pub(super) fn tell(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        for event in self.events.drain(..) {
            let told = observers.iter_mut().try_for_each(|observer| observer.notice(&event));
            told.map_err(MarchError::Observer)?;
        }
        Ok(())
    }

    pub(super) fn notify(&mut self, observers: &mut [&mut dyn Observer]) -> Result<(), MarchError> {
        self.tell(observers)?;
        let (body, state, record) = (self.body, &self.state, &self.record);
        let newton_residuals = self.stepper.newton_history();
        let view = View { body, state, record, newton_residuals, motion: self };
        observers.iter_mut().try_for_each(|observer| observer.observe(view)).map_err(MarchError::Observer)
    }
}

/// The time of the next release of supports and the body from then on, if a motion has come there; times that lie closer together than
/// `same_time` are the same.
pub(super) fn due_release(body: &Body, now: f64, same_time: f64) -> Option<(f64, &Body)> {
    body.release().filter(|(time, _)| now >= time - same_time)
}

/// The error of a step, with the place of the cell if one was turned inside out.
pub(super) fn placed(error: Error, body: &Body, state: &State, step_size: f64) -> Error {
    let inner = match &error {
        Error::StepFailed { cause, .. } => cause,
        error => error,
    };
    let Error::Inverted { cell, det } = *inner else { return error };
    let Some(found) = body.mesh().cells().nth(cell) else { return error };
    let position = |node: &u32| state.position(body, *node as usize);
    let mut centre = [0.0; 3];
    for corner in found.nodes.iter().map(position) {
        (0..3).for_each(|d| centre[d] += corner[d] / found.nodes.len() as f64);
    }
    Error::CellInverted {
        step: state.step + 1,
        time: state.time + step_size,
        cell,
        kind: found.kind,
        position: centre,
        det,
    }
}
