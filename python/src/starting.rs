//! The start of a motion.

use emmy::motion::{Motion, State, StepPlan};
use emmy_io::checkpoint::{Checkpoint, Identity};
use emmy_io::input::{self, Problem, StartError, Tree};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::body::{Body, entries};
use crate::function::Callables;
use crate::running::{Running, Start};
use crate::snapshot::{Snapshot, StateArrays, arrays, nodal};
use crate::tree::tree;
use crate::work::Work;
use crate::{errors, plan, pool};

/// Where a motion starts, as Python gives it.
#[derive(FromPyObject)]
pub(crate) enum Given<'py> {
    Snapshot(Py<Snapshot>),
    State(StateArrays<'py>),
    /// Velocities of the undeformed body.
    Velocity(PyReadonlyArray2<'py, f64>),
}

/// Where a motion starts.
pub(crate) enum Begin {
    /// As the input says.
    Input,
    State(State),
    Snapshot(Box<Checkpoint>),
}

impl Begin {
    pub(crate) fn new(py: Python<'_>, body: &Body, given: Option<Given<'_>>) -> PyResult<Self> {
        let inner = body.inner();
        Ok(match given {
            None => Begin::Input,
            Some(Given::State(given)) => Begin::State(arrays(py, inner, given)?),
            Some(Given::Snapshot(snapshot)) => {
                let mut own = snapshot.get().checkpoint.clone();
                // It may come from another body, whose equilibrium is data here.
                own.snapshot.state.is_equilibrium = false;
                Begin::Snapshot(Box::new(own))
            }
            Some(Given::Velocity(array)) => {
                let velocity = nodal(py, inner, &array, "initial")?;
                let state = pool::work(py, || {
                    let mut state = State::initial(inner, 0.0, &[])?;
                    state.velocity[..velocity.len()].copy_from_slice(&velocity);
                    state.transferred(inner, 0.0)
                })?;
                Begin::State(state.map_err(|error| errors::library(py, &error))?)
            }
        })
    }

    fn state(&self) -> Option<&State> {
        match self {
            Begin::Input => None,
            Begin::State(state) => Some(state),
            Begin::Snapshot(own) => Some(&own.snapshot.state),
        }
    }

    fn time(&self) -> f64 {
        self.state().map_or(0.0, |state| state.time)
    }

    /// The time at which a motion starts that does not follow the grid of a plan.
    fn time_off_grid(&self, plan: &StepPlan) -> Option<f64> {
        let time = self.state()?.time;
        let is_in_step = match self {
            Begin::Snapshot(own) => own.snapshot.subdivision.substep > 0,
            _ => false,
        };
        // The plan's own time if they differ by rounding.
        let next = plan.steps_from(time).next()?;
        let is_on_grid = plan.on_grid(time) == next.start || plan.adaptivity().is_some();
        (!is_in_step && !is_on_grid).then_some(time)
    }

    /// The motion at its start; without a plan there are no steps to check.
    fn motion<'a>(&self, problem: &'a Problem, has_plan: bool) -> Result<Motion<'a>, StartError> {
        let (body, scheme, settings) = (&problem.body, problem.scheme, problem.newton);
        let motion = match self {
            Begin::Input if has_plan => return problem.motion(&mut []),
            Begin::Input => return problem.motion_from(problem.start_state(&mut [])?),
            Begin::State(state) => Motion::starting(body, scheme, settings, state.clone())?,
            Begin::Snapshot(own) => Motion::resumed(body, scheme, settings, own.snapshot.clone())?,
        };
        Ok(problem.settled(motion))
    }
}

/// A motion of a body at its start. `sections`: those of the input that describe the motion.
pub(crate) fn start(
    py: Python<'_>,
    body: &Body,
    sections: &Bound<'_, PyAny>,
    begin: Begin,
    adjoint: bool,
) -> PyResult<Work> {
    let mut sections = entries(tree(sections, "", &mut Callables::default())?);
    let has_plan = plan::complete(&mut sections, begin.time());
    with_sections(py, body, sections, has_plan, begin, adjoint)
}

/// A motion that continues from the present state of another one, with the same plan.
pub(crate) fn copy(py: Python<'_>, body: &Body, work: &mut Work) -> PyResult<Work> {
    let is_start = |key: &str| ["initial", "equilibrium"].contains(&key);
    let is_static = !work.sections.iter().any(|(key, _)| key == "time");
    let sections = work.sections.iter().filter(|(key, _)| is_static || !is_start(key)).cloned().collect();
    let adjoint = work.running.cell.borrow_dependent().trajectory.is_some();
    let begin = Begin::Snapshot(Box::new(work.checkpoint()));
    with_sections(py, body, sections, work.has_plan, begin, adjoint)
}

fn with_sections(
    py: Python<'_>,
    body: &Body,
    mut sections: Vec<(String, Tree)>,
    has_plan: bool,
    begin: Begin,
    adjoint: bool,
) -> PyResult<Work> {
    let time = begin.time();
    if has_plan && time < 0.0 {
        let message = format!("a plan begins at t = 0, but the state is one at t = {time}");
        return Err(errors::argument(py, "start", &message));
    }
    let mut problem = body.problem(py, sections.clone())?;
    if let Some(time) = begin.time_off_grid(&problem.plan).filter(|_| has_plan) {
        plan::begin_at(&mut sections, time);
        problem = body.problem(py, sections.clone())?;
    }
    let begin = match begin {
        Begin::Snapshot(snapshot) => Begin::Snapshot(Box::new(fitting(py, &problem, *snapshot)?)),
        begin => begin,
    };
    if has_plan && !matches!(begin, Begin::Snapshot(_)) {
        let stable = pool::work(py, || problem.critical_step(begin.state()))?;
        stable.map_err(|error| errors::input(py, &error))?;
    }
    let is_of_motion = |note: &&String| {
        // The input does not say whether a body moves, or what pushes, in a given state; without a plan nothing moves.
        let is_of_start = note.as_str() == input::NOTHING_MOVES || note.contains(input::PUSHES);
        let is_moot = (begin.state().is_some() || !has_plan) && is_of_start
            || !has_plan && note.contains(input::END_OF_RUN);
        !is_moot && !body.notes().contains(note)
    };
    let notes = problem.notes.iter().filter(is_of_motion).cloned().collect();
    let begin: &Start<'_> = &|problem: &Problem| begin.motion(problem, has_plan);
    let running = pool::work(py, || Running::new(problem.clone(), adjoint, begin))?;
    let running = running.map_err(|error| errors::start(py, error))?;
    Ok(Work::new(running, sections, has_plan, notes))
}

/// A snapshot for a problem; the memory of another scheme, degree or solver is left out.
fn fitting(py: Python<'_>, problem: &Problem, mut snapshot: Checkpoint) -> PyResult<Checkpoint> {
    let now = Identity::new(problem);
    if now.mesh != snapshot.identity.mesh {
        let message =
            format!("the snapshot belongs to another mesh: {}, here {}", snapshot.identity.mesh, now.mesh);
        return Err(errors::argument(py, "start", &message));
    }
    if !snapshot.identity.has_same_stepper(&now) {
        (snapshot.snapshot.memory, snapshot.snapshot.control) = (None, None);
    }
    Ok(snapshot)
}
