//! A body in motion, and its single steps.

use std::sync::Arc;

use super::adaptive::{Control, degree_of};
use super::mechanism::MechanismRecorder;
use super::{
    ContactStatistics, Event, EventKind, PlannedStep, Record, ReferenceMotion, Resolution, RunStatistics,
    Snapshot, StepPlan, Subdivision,
};
use crate::body::{Body, JointState, Reaction};
use crate::error::{Error, Result};
use crate::newton::NewtonSettings;
use crate::number::short;
use crate::time::classic::static_reactions;
use crate::time::{Memory, Scheme, State, Stepper};

/// A body in motion: its state, and the stepper that advances it.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = NeoHooke::new(1000.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 6.0], about: [0.5; 3], ..Default::default() };
/// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?.from(State::initial(&body, 0.0, &[spin])?)?;
/// motion.step(0.05)?;
/// motion.step_to(0.1)?;
/// motion.march(&StepPlan::new(0.1, vec![Phase { until: 1.0, size: 0.1 }])?, &mut [])?;
/// assert!((motion.record().total_energy - 3.0).abs() < 1e-12); // m (a^2 + b^2) / 12 * omega^2 / 2
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Motion<'a> {
    pub(super) body: &'a Body,
    /// The given scheme, with the present degree.
    given: Scheme,
    pub(super) scheme: Scheme,
    pub(super) settings: NewtonSettings,
    pub(super) stepper: Box<dyn Stepper + 'a>,
    pub(super) state: State,
    /// The state before the last step.
    pub(super) last: State,
    /// Frame of reference of the largest relative displacement.
    reference: Option<ReferenceMotion>,
    pub(super) record: Record,
    pub(super) statistics: RunStatistics,
    /// Reactions in the last step; empty before the first.
    pub(super) reactions: Vec<Reaction>,
    pub(super) mechanism: Option<MechanismRecorder>,
    /// Smallest size of a cut step; `None`: failing steps are not cut.
    pub(super) smallest: Option<SmallestStep>,
    pub(super) subdivision: Subdivision,
    /// The control of the step sizes by the error, or its memory, to create it from.
    pub(super) control: Option<Control<'a>>,
    pub(super) control_memory: Option<Memory>,
    /// The plan that the motion follows, and whether its steps resolve the functions of time; `None` if there are none.
    pub(super) plan: Option<StepPlan>,
    pub(super) resolution: Option<Resolution>,
    /// The planned step in progress: of the plan, or the rest of one where the motion starts inside it.
    pub(super) planned: Option<PlannedStep>,
    pub(super) releases: usize,
    pub(super) was_at_rounding_floor: bool,
    /// Cuts, rejections and releases since the last good step.
    pub(super) cuts: usize,
    pub(super) rejections: usize,
    pub(super) released: usize,
    /// Events that observers have not seen yet.
    pub(super) events: Vec<Event>,
}

/// Limit for cutting a failing step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SmallestStep {
    /// Down to a size \[time\].
    Size(f64),
    /// Down to this part of the planned step, given as the number of halvings.
    Halvings(u32),
}

/// Largest number of halvings of a planned step without a smallest size: down to 1/1024 of it.
const MAX_HALVINGS: u32 = 10;

impl<'a> Motion<'a> {
    /// A motion from rest at t = 0 with default settings; see [`Motion::from`] and [`Motion::newton`].
    ///
    /// # Errors
    /// As [`Motion::starting`] and [`State::initial`].
    pub fn new(body: &'a Body, scheme: impl Into<Scheme>) -> Result<Self> {
        Motion::starting(body, scheme, NewtonSettings::default(), State::initial(body, 0.0, &[])?)
    }

    /// The motion with another start.
    ///
    /// # Errors
    /// As [`Motion::starting`].
    pub fn from(self, state: State) -> Result<Self> {
        let Motion { body, scheme, settings, stepper, .. } = self;
        match scheme {
            Scheme::Own(_) => Motion::with_own(body, scheme, stepper, state),
            _ => Motion::starting(body, scheme, settings, state),
        }
    }

    /// The motion with other settings of Newton's iteration.
    ///
    /// # Errors
    /// As [`Motion::starting`].
    pub fn newton(self, settings: NewtonSettings) -> Result<Self> {
        // A stepper from outside has its own: `starting` refuses it.
        Motion::starting(self.body, self.scheme, settings, self.state)
    }

    /// A motion that starts from a state, with all settings. Its momentum must be M v with the mass of the body,
    /// consistent or lumped: a state whose velocity was changed, and one of a body with other masses, come from
    /// [`State::transferred`].
    ///
    /// ```
    /// # use emmy::prelude::*;
    /// # let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// # let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// # let scheme = TimeElement::discrete_gradient(1)?;
    /// let mut kicked = State::initial(&body, 0.0, &[])?;
    /// kicked.velocity.iter_mut().step_by(3).for_each(|v| *v += 3.0);
    /// assert!(Motion::new(&body, scheme)?.from(kicked.clone()).is_err()); // p = 0
    /// let motion = Motion::new(&body, scheme)?.from(kicked.transferred(&body, 0.0)?)?;
    /// assert!((motion.record().kinetic_energy - 9.0).abs() < 1e-14); // m v^2/2
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Scheme::stepper`]; [`Error::Memory`], [`Error::StartMomentum`] or [`Error::StartHeld`] for a state of
    /// another body.
    pub fn starting(
        body: &'a Body,
        scheme: impl Into<Scheme>,
        settings: NewtonSettings,
        state: State,
    ) -> Result<Self> {
        let scheme = scheme.into();
        scheme.check()?;
        let body = scheme.body(body);
        Motion::made(body, (scheme, settings), state, |state| scheme.stepper(body, settings, state))
    }

    /// A motion that starts from a state, with a stepper that is made for it.
    pub(super) fn made(
        body: &'a Body,
        (scheme, settings): (Scheme, NewtonSettings),
        mut state: State,
        stepper: impl FnOnce(&mut State) -> Result<Box<dyn Stepper + 'a>>,
    ) -> Result<Self> {
        body.space.agree(check_state(body, &state))?;
        // Central differences, whose state it may be, have momenta at guests.
        body.space.clear_guests(&mut state.momentum);
        body.mechanism.fit_coordinates(&state.displacement, &mut state.coordinates);
        // Nodes that supports held until then may move.
        let released = |now: &&'a Body| due_release(now, state.time, 0.0).map(|(_, next)| next);
        let due = std::iter::successors(Some(body), released).last().unwrap_or(body);
        due.fit_momentum(&state.velocity, &mut state.momentum)?;
        let stepper = stepper(&mut state)?;
        let degree = scheme.degree();
        let mut record =
            Record { step: state.step, time: state.time, degree, ..Record::default() }.at(body, &state);
        record.joints = vec![JointState::default(); body.joints().len()];
        let mut mechanism = MechanismRecorder::new(body)?;
        if let Some(recorder) = &mut mechanism {
            recorder.set(body, &state, &mut record);
        }
        let mut statistics = RunStatistics::default();
        statistics.add(body, &state, &record_of_start(scheme, &state, &record), &[]);
        Ok(Motion {
            body,
            given: scheme,
            scheme,
            settings,
            stepper,
            last: state.clone(),
            reference: None,
            state,
            record,
            statistics,
            reactions: Vec::with_capacity(body.supported_groups().len()),
            mechanism,
            smallest: None,
            subdivision: Subdivision::default(),
            control: None,
            control_memory: None,
            plan: None,
            resolution: None,
            planned: None,
            releases: 0,
            was_at_rounding_floor: false,
            cuts: 0,
            rejections: 0,
            released: 0,
            events: Vec::new(),
        })
    }

    /// A motion that continues from a snapshot. With the stepper's memory, and the same scheme and settings, it is
    /// bit-identical to the motion of the snapshot. A degree chosen by the control is taken from the snapshot.
    ///
    /// # Errors
    /// As [`Motion::starting`] and [`Stepper::restore`].
    pub fn resumed(
        body: &'a Body,
        scheme: impl Into<Scheme>,
        settings: NewtonSettings,
        snapshot: Snapshot,
    ) -> Result<Self> {
        let given = scheme.into();
        let mut body = given.body(body);
        for _ in 0..snapshot.releases {
            let Some((_, released)) = body.release() else { break };
            body = released;
        }
        let degree = snapshot.control.as_ref().and_then(degree_of);
        let scheme = degree.map_or(Ok(given), |degree| given.at_degree(degree))?;
        let motion = Motion::starting(body, scheme, settings, snapshot.state.clone())?;
        Motion { given, ..motion }.continued(snapshot)
    }

    /// The motion that started from the state of a snapshot, with the rest of the snapshot.
    pub(super) fn continued(mut self, snapshot: Snapshot) -> Result<Self> {
        let Snapshot {
            state,
            record,
            statistics,
            subdivision,
            control,
            releases,
            was_at_rounding_floor,
            memory,
        } = snapshot;
        match &memory {
            Some(memory) => {
                self.stepper.restore(memory)?;
                self.state = state;
                self.record = record;
            }
            // The new stepper may have set the momentum with its own mass matrix.
            None => self.record = record.at(self.body, &self.state),
        }
        Ok(Motion {
            statistics,
            subdivision,
            control_memory: control,
            releases,
            was_at_rounding_floor,
            ..self
        })
    }

    /// The whole state of the motion between two steps; see [`Motion::resumed`].
    pub fn snapshot(&self) -> Snapshot {
        let control = self.control.as_ref().map(|control| control.memory(self.scheme.degree()));
        Snapshot {
            state: self.state.clone(),
            record: self.record.clone(),
            statistics: self.statistics.clone(),
            subdivision: self.subdivision,
            control: control.or(self.control_memory.clone()),
            releases: self.releases,
            was_at_rounding_floor: self.was_at_rounding_floor,
            memory: Some(self.stepper.memory()),
        }
    }

    /// Allows a march to cut failing steps by two (see [`Subdivision`]), down to a size; without one, to 1/1024 of the
    /// planned step.
    pub fn allow_cuts(&mut self, smallest_step: Option<f64>) {
        self.smallest = Some(smallest_step.map_or(SmallestStep::Halvings(MAX_HALVINGS), SmallestStep::Size));
    }

    /// The motion with a frame of reference for outputs and for [`RunStatistics::largest_relative_displacement`]. A
    /// motion that is started anew ([`Motion::from`], [`Motion::newton`]) has none.
    pub fn relative_to(self, reference: Option<ReferenceMotion>) -> Self {
        let mut motion = Motion { reference, ..self };
        motion.count_relative_displacement();
        motion
    }

    /// The frame of reference of outputs; `None`: at rest.
    pub fn reference(&self) -> Option<&ReferenceMotion> {
        self.reference.as_ref()
    }

    /// Adds the last step to the statistics.
    pub(super) fn count_step(&mut self) {
        self.statistics.add(self.body, &self.state, &self.record, &self.reactions);
        self.count_relative_displacement();
    }

    fn count_relative_displacement(&mut self) {
        if let Some(reference) = &self.reference {
            let [relative, _] = reference.seen(self.body, &self.state.displacement, &self.state.velocity);
            self.statistics.add_relative(self.body, &self.state, &relative);
        }
    }

    /// Present time \[time\].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Present state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The body, without the supports and joints that have been released.
    pub fn body(&self) -> &'a Body {
        self.body
    }

    /// The scheme, with the present degree.
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

    /// Statistics of all steps so far, including those before the motion was resumed.
    ///
    /// ```
    /// # use emmy::prelude::*;
    /// # let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// # let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
    /// let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
    /// motion.step(0.1)?;
    /// assert_eq!(motion.statistics().worst_energy_residual.value, 0.0); // at rest
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn statistics(&self) -> &RunStatistics {
        &self.statistics
    }

    /// The motion with the reactions of a body at rest, for a start from an equilibrium.
    ///
    /// ```
    /// # use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let held = Support::fixed("body");
    /// let weight = Load::acceleration([0.0, 0.0, -10.0]);
    /// let body =
    ///     Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).support(held).load(weight).build()?;
    /// let motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.with_static_reactions()?;
    /// assert!((motion.reactions()[0].force[2] - 20.0).abs() < 1e-13); // m g
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn with_static_reactions(mut self) -> Result<Self> {
        let (reactions, joints) = static_reactions(self.body, &self.state)?;
        (self.reactions, self.record.joints, self.record.has_joint_forces) = (reactions, joints, true);
        if is_balanced(self.scheme, &self.state) {
            let (contacts, time) = (&mut self.statistics.contacts, self.state.time);
            ContactStatistics::add_all(contacts, self.body, [time, time, 0.0], &self.reactions);
        }
        let State { displacement, coordinates, .. } = &self.state;
        let joints = &mut self.record.joints;
        self.body.mechanism.set_coordinates(&|dof| displacement[dof], coordinates, joints);
        Ok(self)
    }

    /// Reactions of the supports, in the order of [`Body::supported_groups`]: means over the last step. Empty before
    /// the first step, also after the motion was resumed, except after [`Motion::with_static_reactions`].
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// The stepper.
    pub fn stepper(&self) -> &(dyn Stepper + 'a) {
        &*self.stepper
    }

    /// Replaces the stepper by a new one of another degree.
    pub(super) fn set_degree(&mut self, degree: usize) -> Result<()> {
        self.scheme = self.given.at_degree(degree)?;
        self.stepper = self.scheme.stepper(self.body, self.settings, &mut self.state)?;
        Ok(())
    }

    /// The scheme with another degree than the present one.
    pub(super) fn scheme_of(&self, degree: usize) -> Result<Scheme> {
        self.given.at_degree(degree)
    }

    /// Continues with the body without the supports and joints released by now; times closer together than `same_time`
    /// are equal. The state does not change; the energy of a spring that is released leaves as work.
    pub(super) fn release(&mut self, same_time: f64) -> Result<()> {
        while let Some((time, body)) = due_release(self.body, self.state.time, same_time) {
            self.stepper = self.scheme.stepper(body, self.settings, &mut self.state)?;
            let message = format!("{} released (until = {})", what_ends(self.body, body, time), short(time));
            if !Arc::ptr_eq(&self.body.mechanism, &body.mechanism) {
                let [before, after] = [self.body, body].map(|body| {
                    let State { displacement, coordinates, .. } = &self.state;
                    body.strain_state_near(displacement, coordinates).strain_energy
                });
                self.record.strain_energy += after - before;
                self.record.total_energy += after - before;
                self.record.external_work += after - before;
            }
            self.mechanism = MechanismRecorder::new(body)?;
            self.body = body;
            self.releases += 1;
            self.released += 1;
            self.note(EventKind::Release, self.state.step + 1, message);
        }
        Ok(())
    }

    /// Notes an event at the present time.
    pub(super) fn note(&mut self, kind: EventKind, step: usize, message: String) {
        self.events.push(Event { step, time: self.state.time, kind, message });
    }
}

/// Whether a state at the start of a motion is one of it. Static analyses begin at a configuration that is no
/// equilibrium under their loads, unless it is known as one.
fn is_balanced(scheme: Scheme, state: &State) -> bool {
    scheme != Scheme::Static || state.is_equilibrium
}

/// The record of the start for the statistics: what contacts do there counts only if it belongs to the motion.
fn record_of_start(scheme: Scheme, state: &State, record: &Record) -> Record {
    match is_balanced(scheme, state) {
        true => record.clone(),
        false => Record { contact_energy: 0.0, smallest_gap: None, contact_points: 0, ..record.clone() },
    }
}

/// Checks that a state has the degrees of freedom of a body; the low part of the displacement may be empty.
pub(super) fn check_state(body: &Body, state: &State) -> Result<()> {
    let low = Some(&state.displacement_low).filter(|low| !low.is_empty());
    let lists = [
        ("displacement", Some(&state.displacement)),
        ("displacement_low", low),
        ("momentum", Some(&state.momentum)),
        ("velocity", Some(&state.velocity)),
    ];
    let lists = lists.map(|(name, list)| (name, list, body.n_dofs()));
    for (name, list, expected) in
        lists.into_iter().chain([("history", Some(&state.history), body.n_history())])
    {
        if let Some(list) = list.filter(|list| list.len() != expected) {
            let reason = format!("has {} numbers, not {expected}", list.len());
            return Err(Error::Memory { name: name.to_string(), reason });
        }
    }
    Ok(())
}

/// A sentence without its end on what is released at a time.
fn what_ends(before: &Body, after: &Body, time: f64) -> String {
    let joints = before.joints().iter().filter(|joint| joint.until == Some(time));
    let names: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
    let support = names.is_empty() || before.fixed() != after.fixed();
    let joints = match names.as_slice() {
        [] => None,
        [name] => Some(format!("the joint {name} was")),
        names => Some(format!("the joints {} were", names.join(", "))),
    };
    let all: Vec<String> = support.then(|| "a support was".to_string()).into_iter().chain(joints).collect();
    all.join(" and ")
}

/// The time of the next release of supports and joints and the body afterwards, if the motion has reached it; times
/// closer together than `same_time` are equal.
pub(super) fn due_release(body: &Body, now: f64, same_time: f64) -> Option<(f64, &Body)> {
    body.release().filter(|(time, _)| now >= time - same_time)
}
