//! The runs of a study: the shared start, the reference, and the members in parallel.

use std::time::Instant;

use emmy::motion::{ErrorNorm, MarchError, Motion, Observer, Phase, Sampler, Samples, State, StepPlan};

use super::{Measure, MemberRun, Study};
use crate::input::{Problem, StartError};
use crate::message::with_causes;
use crate::side_by_side::{on_one_thread, side_by_side};

/// The state at a time, reached with scheme and plan of the input; steps are counted from there.
///
/// # Errors
/// [`StartError`] of the start, or of the first step that fails.
pub fn start(problem: &Problem, from: f64, observers: &mut [&mut dyn Observer]) -> Result<State, StartError> {
    let state = problem.start_state(&mut [])?;
    let mut motion = Motion::starting(&problem.body, problem.scheme, problem.newton, state)?;
    if from > problem.plan.start() {
        motion.march(&until(&problem.plan, from)?, observers)?;
    }
    Ok(State { step: 0, ..motion.state().clone() })
}

/// The part of a plan before a time.
///
/// # Errors
/// [`emmy::Error::Plan`] if the time is not after the plan's start.
pub fn until(plan: &StepPlan, time: f64) -> emmy::Result<StepPlan> {
    let mut phases: Vec<Phase> = Vec::new();
    for phase in plan.phases() {
        phases.push(Phase { until: phase.until.min(time), ..*phase });
        if phase.until >= time {
            break;
        }
    }
    plan.with_phases(phases)
}

/// The reference at some times.
///
/// # Errors
/// [`MarchError`] of the first step that fails.
pub fn reference(
    problem: &Problem,
    study: &Study,
    state: &State,
    times: &[f64],
    observer: &mut dyn Observer,
) -> Result<Samples, MarchError> {
    let body = &problem.body;
    let mut motion = Motion::starting(body, study.reference_scheme, problem.newton, state.clone())?;
    let mut sampler = Sampler::new(times.to_vec(), study.tolerance(), body.n_dofs());
    motion.march(&study.plan(study.reference_size)?, &mut [&mut sampler, observer])?;
    Ok(sampler.finish())
}

/// All members in parallel, the longest first. They are reported when they are done, and returned in the order of their
/// sizes.
///
/// Every member has one thread, so the body must have been built for one ([`on_one_thread`]).
pub fn members(
    problem: &Problem,
    study: &Study,
    state: &State,
    samples: &Samples,
    report: impl Fn(&MemberRun) + Sync,
) -> Vec<MemberRun> {
    let mut order: Vec<usize> = (0..study.sizes.len()).collect();
    order.sort_by(|&a, &b| study.sizes[a].total_cmp(&study.sizes[b]));
    let run = |place: usize| {
        let size = study.sizes[order[place]];
        let row = on_one_thread(|| member(problem, study, state, samples, size));
        let row = row.unwrap_or_else(|failure| MemberRun {
            step_size: size,
            outcome: Err(failure),
            wall_seconds: 0.0,
        });
        report(&row);
        (order[place], row)
    };
    let mut rows = side_by_side(order.len(), run);
    rows.sort_by_key(|(index, _)| *index);
    rows.into_iter().map(|(_, row)| row).collect()
}

fn member(problem: &Problem, study: &Study, state: &State, samples: &Samples, step_size: f64) -> MemberRun {
    let started = Instant::now();
    let outcome = measure(problem, study, state, samples, step_size).map_err(|error| with_causes(&error));
    MemberRun { step_size, outcome, wall_seconds: started.elapsed().as_secs_f64() }
}

fn measure(
    problem: &Problem,
    study: &Study,
    state: &State,
    samples: &Samples,
    step_size: f64,
) -> Result<Measure, MarchError> {
    let mut motion = Motion::starting(&problem.body, study.scheme, problem.newton, state.clone())?;
    let mut norm = ErrorNorm::new(samples, study.window.0, study.tolerance());
    motion.march(&study.plan(step_size)?, &mut [&mut norm])?;
    let error = norm.error();
    let relative_error = norm.relative_error();
    Ok(Measure { error, relative_error, newton_iterations: motion.statistics().newton_iterations })
}
