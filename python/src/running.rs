//! A motion together with its body, and what is kept of its steps.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use emmy::adjoint::Trajectory;
use emmy::body::Fields;
use emmy::motion::{Event, MarchError, Motion, Observer, ObserverResult, StepPlan, View};
use emmy_io::checkpoint::Identity;
use emmy_io::history::HistoryColumns;
use emmy_io::input::{Limits, Problem, StartError};
use emmy_io::limits;
use emmy_io::results::Results;
use self_cell::self_cell;

use crate::function::{check_exception, forget_exception};

/// The parts that borrow the body.
pub(crate) struct Moving<'a> {
    pub(crate) motion: Motion<'a>,
    pub(crate) trajectory: Option<Trajectory<'a>>,
}

self_cell!(
    /// A motion with the problem whose body it moves.
    pub(crate) struct Cell {
        owner: Arc<Problem>,
        #[covariant]
        dependent: Moving,
    }
);

/// How a motion starts.
pub(crate) type Start<'s> = dyn for<'a> Fn(&'a Problem) -> Result<Motion<'a>, StartError> + Sync + 's;

/// A motion at work.
pub(crate) struct Running {
    pub(crate) cell: Cell,
    pub(crate) plan: StepPlan,
    pub(crate) recorder: Recorder,
    guard: Guard,
    pub(crate) results: Option<Results>,
    pub(crate) fields: Option<Arc<Fields>>,
    pub(crate) identity: Option<Identity>,
}

/// Rows of the history, and events.
pub(crate) struct Recorder {
    columns: HistoryColumns,
    pub(crate) names: Arc<Vec<String>>,
    pub(crate) rows: Vec<f64>,
    pub(crate) events: Vec<Event>,
    started: Instant,
}

impl Observer for Recorder {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        let row = self.columns.row(view, self.started.elapsed().as_secs_f64());
        self.rows.extend(row.numbers.iter().map(|number| number.value()));
        Ok(())
    }

    fn notice(&mut self, event: &Event) -> ObserverResult {
        self.events.push(event.clone());
        Ok(())
    }
}

/// Ends a march after an exception in a function, or beyond a limit; the last observer, so that all others have seen
/// the step.
pub(crate) struct Guard(Limits);

impl Observer for Guard {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        check_exception()?;
        Ok(limits::check(&self.0, view.motion.statistics())?)
    }

    /// A failed step is not tried again with a smaller size after an exception.
    fn notice(&mut self, _: &Event) -> ObserverResult {
        check_exception()
    }
}

/// A trajectory that observes.
struct TrajectoryObserver<'b, 'a>(&'b mut Trajectory<'a>);

impl Observer for TrajectoryObserver<'_, '_> {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        Ok(self.0.record(view.motion)?)
    }
}

impl Running {
    /// A motion at its start, of which the first row is kept.
    pub(crate) fn new(
        problem: Arc<Problem>,
        with_adjoint: bool,
        start: &Start<'_>,
    ) -> Result<Self, StartError> {
        let columns = HistoryColumns::of(&problem);
        let names = Arc::new(columns.names());
        let (limits, plan) = (problem.limits, problem.plan.clone());
        let cell = Cell::try_new(problem, |problem| -> Result<_, StartError> {
            let motion = start(problem)?;
            let trajectory = if with_adjoint { Some(Trajectory::new(&motion)?) } else { None };
            Ok(Moving { motion, trajectory })
        })?;
        let (rows, events, started) = (Vec::new(), Vec::new(), Instant::now());
        let recorder = Recorder { columns, names, rows, events, started };
        let guard = Guard(limits);
        let mut running =
            Running { cell, plan, recorder, guard, results: None, fields: None, identity: None };
        running.show()?;
        Ok(running)
    }

    pub(crate) fn motion(&self) -> &Motion<'_> {
        &self.cell.borrow_dependent().motion
    }

    /// The result of some work at the motion.
    pub(crate) fn with_motion<T>(&mut self, work: impl FnOnce(&mut Motion<'_>) -> T) -> T {
        self.cell.with_dependent_mut(|_, Moving { motion, .. }| work(motion))
    }

    pub(crate) fn problem(&self) -> &Problem {
        self.cell.borrow_owner()
    }

    /// Shows the present state to all observers, as a march does after each step.
    fn show(&mut self) -> Result<(), MarchError> {
        let (recorder, results, guard) = (&mut self.recorder, &mut self.results, &mut self.guard);
        self.cell.with_dependent_mut(|_, Moving { motion, trajectory }| {
            let mut trajectory = trajectory.as_mut().map(TrajectoryObserver);
            let view = motion.view();
            for observer in observers(recorder, results, &mut trajectory, guard) {
                observer.observe(view).map_err(MarchError::Observer)?;
            }
            Ok(())
        })
    }

    /// Shows the present state to results that begin here.
    pub(crate) fn open(&mut self, mut results: Results) -> Result<(), MarchError> {
        results.observe(self.motion().view()).map_err(MarchError::Observer)?;
        self.results = Some(results);
        Ok(())
    }

    /// Does steps of the plan until some wall time has passed, at least one, and not beyond a time; returns how many.
    pub(crate) fn advance(&mut self, slice: Duration, until: Option<f64>) -> Result<usize, MarchError> {
        let begin = Instant::now();
        let plan = match until {
            Some(until) => Cow::Owned(self.plan.clone().with_end_at(until)),
            None => Cow::Borrowed(&self.plan),
        };
        let (recorder, results, guard) = (&mut self.recorder, &mut self.results, &mut self.guard);
        self.cell.with_dependent_mut(|_, Moving { motion, trajectory }| {
            motion.follow(&plan)?;
            // A function that fails later in the plan fails when the motion comes there.
            forget_exception();
            let mut trajectory = trajectory.as_mut().map(TrajectoryObserver);
            let mut observers = observers(recorder, results, &mut trajectory, guard);
            let mut steps = 0;
            while until.is_none_or(|until| motion.time() < until - ROUNDING * until.abs()) {
                if motion.next_step(&plan, &mut observers)?.is_none() {
                    break;
                }
                steps += 1;
                if begin.elapsed() >= slice {
                    break;
                }
            }
            Ok(steps)
        })
    }

    /// Does one step of a size.
    pub(crate) fn step(&mut self, size: f64) -> Result<(), MarchError> {
        self.cell.with_dependent_mut(|_, Moving { motion, .. }| motion.step(size).map(|_| ()))?;
        self.show()
    }
}

/// Times closer together than this part of them differ by rounding.
const ROUNDING: f64 = 1e-12;

fn observers<'c, 'a: 'c>(
    recorder: &'c mut Recorder,
    results: &'c mut Option<Results>,
    trajectory: &'c mut Option<TrajectoryObserver<'_, 'a>>,
    guard: &'c mut Guard,
) -> Vec<&'c mut dyn Observer> {
    let mut observers: Vec<&mut dyn Observer> = vec![recorder];
    observers.extend(results.as_mut().map(|results| results as &mut dyn Observer));
    observers.extend(trajectory.as_mut().map(|trajectory| trajectory as &mut dyn Observer));
    observers.push(guard);
    observers
}
