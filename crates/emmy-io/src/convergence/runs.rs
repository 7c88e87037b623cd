//! The runs of a study: the shared start, the reference, and the members in parallel.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use emmy::motion::{ErrorNorm, MarchError, Motion, Observer, Phase, Sampler, Samples, State, StepPlan};

use super::{Measure, MemberRun, Study};
use crate::input::{Problem, StartError};

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
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::new());
    let work = || {
        while let Some(&index) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            let size = study.sizes[index];
            let row = on_one_thread(|| member(problem, study, state, samples, size));
            let row = row.unwrap_or_else(|failure| MemberRun {
                step_size: size,
                outcome: Err(failure),
                wall_seconds: 0.0,
            });
            report(&row);
            rows.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((index, row));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads().min(study.sizes.len()) {
            scope.spawn(work);
        }
    });
    let mut rows = rows.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    rows.sort_by_key(|(index, _)| *index);
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Runs a function in a pool of one thread; bodies built there always work on one thread.
///
/// # Errors
/// The message of the system, if it cannot start a thread.
pub fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| format!("cannot start a thread: {error}"))?;
    Ok(pool.install(work))
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

/// An error with its causes.
fn with_causes(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}\ncause: {}", with_causes(cause)),
        None => error.to_string(),
    }
}
