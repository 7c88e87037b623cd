//! The start of a motion.

use emmy::motion::{Motion, State};
use emmy_io::checkpoint::{Checkpoint, Identity};
use emmy_io::input::{self, Problem, StartError};
use pyo3::prelude::*;

use crate::body::{Body, entries};
use crate::function::Callables;
use crate::running::{Running, Start};
use crate::snapshot::{Snapshot, StateArrays, arrays};
use crate::tree::tree;
use crate::work::Work;
use crate::{errors, plan, pool};

/// Where a motion starts.
#[derive(FromPyObject)]
pub(crate) enum Given<'py> {
    Snapshot(Py<Snapshot>),
    State(StateArrays<'py>),
}

/// The same, apart from Python.
enum Begin {
    /// As the input says.
    Input,
    State(State),
    Snapshot(Box<Checkpoint>),
}

impl Begin {
    fn state(&self) -> Option<&State> {
        match self {
            Begin::Input => None,
            Begin::State(state) => Some(state),
            Begin::Snapshot(own) => Some(&own.snapshot.state),
        }
    }

    fn motion<'a>(&self, problem: &'a Problem) -> Result<Motion<'a>, StartError> {
        let (body, scheme, settings) = (&problem.body, problem.scheme, problem.newton);
        let mut motion = match self {
            Begin::Input => return problem.motion(&mut []),
            Begin::State(state) => Motion::starting(body, scheme, settings, state.clone())?,
            Begin::Snapshot(own) => Motion::resumed(body, scheme, settings, own.snapshot.clone())?,
        };
        motion.allow_cuts(problem.smallest_step);
        Ok(motion)
    }
}

/// A motion of a body at its start. `sections`: those of the input that describe the motion.
pub(crate) fn start(
    py: Python<'_>,
    body: &Body,
    sections: &Bound<'_, PyAny>,
    given: Option<Given<'_>>,
    adjoint: bool,
) -> PyResult<Work> {
    let mut further = entries(tree(sections, "", &mut Callables::default())?);
    let begin = match given {
        None => Begin::Input,
        Some(Given::State(given)) => Begin::State(arrays(py, body.inner(), given)?),
        Some(Given::Snapshot(snapshot)) => Begin::Snapshot(Box::new(snapshot.get().checkpoint.clone())),
    };
    let has_plan = plan::begin_at(&mut further, begin.state().map(|state| state.time));
    let problem = body.problem(py, further.clone())?;
    let begin = match begin {
        Begin::Snapshot(snapshot) => Begin::Snapshot(Box::new(fitting(py, &problem, *snapshot)?)),
        begin => begin,
    };
    if !matches!(begin, Begin::Snapshot(_)) {
        let stable = pool::work(py, || problem.critical_step(begin.state()))?;
        stable.map_err(|error| errors::input(py, &error))?;
    }
    let is_of_motion = |note: &&String| {
        let is_known = body.notes().contains(note);
        // Whether it moves is not known from the input then.
        let is_moot = begin.state().is_some() && note.as_str() == input::NOTHING_MOVES;
        !is_known && !is_moot
    };
    let notes = problem.notes.iter().filter(is_of_motion).cloned().collect();
    let begin: &Start<'_> = &|problem: &Problem| begin.motion(problem);
    let running = pool::work(py, || Running::new(problem.clone(), body.callables.clone(), adjoint, begin))?;
    let failed = |error| body.callables.take_raised().unwrap_or_else(|| errors::start(py, error));
    let running = running.map_err(failed)?;
    let statistics = running.motion().statistics();
    let told = (statistics.steps, statistics.cuts);
    Ok(Work { running, further, has_plan, notes, told })
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
