//! The runs of a study: the shared start, the reference, the members side by side.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use emmy::motion::{MarchError, Motion, Observer, Phase, State, StepPlan};
use emmy_io::convergence::kept::{self, Found, Key};
use emmy_io::convergence::{ErrorNorm, Measure, Row, Sampler, Samples, Study};
use emmy_io::input::Problem;

use super::not_written;
use crate::failure::{Failure, with_causes};
use crate::print::number;
use crate::progress::Progress;

/// The reference, at the times of the members.
#[derive(Debug)]
pub struct Reference {
    /// Its samples.
    pub samples: Samples,
    /// Whether it was kept from an earlier study.
    pub is_kept: bool,
    /// Seconds it took; 0 if it was kept.
    pub wall_seconds: f64,
    /// Number of samples inside a step, which are interpolated.
    pub n_interpolated: usize,
}

/// The state that all runs start from, reached by the input's own plan.
pub fn start(problem: &Problem, study: &Study, quiet: bool) -> Result<State, Failure> {
    let state = State::initial(&problem.body, problem.plan.start(), &problem.initial)?;
    let mut motion = Motion::new(&problem.body, problem.scheme, problem.degree, problem.newton, state)?;
    if study.from > problem.plan.start() {
        let plan = until(&problem.plan, study.from)?;
        let mut progress = Progress::of("start: ", &plan, quiet);
        let outcome = motion.march(&plan, &mut [&mut progress]);
        progress.end();
        outcome.map_err(|error| stopped("the run to the common start", &error, "steps of the input"))?;
    }
    Ok(State { step: 0, ..motion.state().clone() })
}

/// The part of a plan before a time.
fn until(plan: &StepPlan, time: f64) -> Result<StepPlan, Failure> {
    let mut phases: Vec<Phase> = Vec::new();
    for phase in plan.phases() {
        phases.push(Phase { until: phase.until.min(time), ..*phase });
        if phase.until >= time {
            break;
        }
    }
    Ok(StepPlan::new(plan.start(), phases)?)
}

fn stopped(what: &str, error: &MarchError, smaller: &str) -> Failure {
    let message = format!("{what} did not converge: {}", with_causes(error));
    Failure::Study { message, help: format!("nothing was measured; try smaller {smaller}") }
}

/// The reference: kept from an earlier study, or else computed and kept.
pub fn reference(
    problem: &Problem,
    study: &Study,
    state: &State,
    times: &[f64],
    directory: &Path,
    quiet: bool,
) -> Result<Reference, Failure> {
    let key = Key::new(problem, study, state).map_err(|error| not_written(directory, &error))?;
    let n_interpolated = study.n_interpolated(times)?;
    let path = key.path(directory);
    if n_interpolated > 0 {
        eprintln!(
            "note: {n_interpolated} of {} times lie inside a step of the reference and are interpolated (order 4 in its \
             step); a --reference that divides the sizes has them all",
            times.len()
        );
    }
    match kept::find(directory, &key, times, study.tolerance()) {
        Found::Samples(samples) => {
            if !quiet {
                eprintln!("reference: kept from an earlier study in {}", path.display());
            }
            return Ok(Reference { samples, is_kept: true, wall_seconds: 0.0, n_interpolated });
        }
        Found::Unusable(reason) => eprintln!("note: {} {reason}; it is computed anew", path.display()),
        Found::Nothing => {}
    }
    let started = Instant::now();
    let samples = march_reference(problem, study, state, times, quiet)?;
    kept::keep(directory, &key, &samples).map_err(|error| not_written(&path, &error))?;
    let wall_seconds = started.elapsed().as_secs_f64();
    Ok(Reference { samples, is_kept: false, wall_seconds, n_interpolated })
}

fn march_reference(
    problem: &Problem,
    study: &Study,
    state: &State,
    times: &[f64],
    quiet: bool,
) -> Result<Samples, Failure> {
    let (body, degree) = (&problem.body, study.reference_degree);
    let mut motion = Motion::new(body, study.scheme, degree, problem.newton, state.clone())?;
    let plan = study.plan(study.reference_size)?;
    let mut sampler = Sampler::new(times.to_vec(), study.tolerance(), body.n_dofs());
    let mut progress = Progress::of("reference: ", &plan, quiet);
    let outcome = motion.march(&plan, &mut [&mut sampler, &mut progress]);
    progress.end();
    outcome.map_err(|error| stopped("the reference", &error, "--reference"))?;
    Ok(sampler.finish())
}

/// All members, side by side; the longest ones begin. Rows stand in the order of the sizes.
pub fn members(problem: &Problem, study: &Study, state: &State, samples: &Samples, quiet: bool) -> Vec<Row> {
    let mut order: Vec<usize> = (0..study.sizes.len()).collect();
    order.sort_by(|&a, &b| study.sizes[a].total_cmp(&study.sizes[b]));
    let (next, rows) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(&index) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            let row = on_one_thread(|| member(problem, study, state, samples, study.sizes[index]));
            let row = row.unwrap_or_else(|failure| failed(study.sizes[index], failure.message()));
            if !quiet {
                report(&row);
            }
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

/// Does something in a pool of one thread: what is built there works on one thread, whoever calls.
pub fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| Failure::Other(format!("cannot start a thread: {error}")))?;
    Ok(pool.install(work))
}

fn failed(step_size: f64, message: String) -> Row {
    Row { step_size, outcome: Err(message), wall_seconds: 0.0 }
}

fn member(problem: &Problem, study: &Study, state: &State, samples: &Samples, step_size: f64) -> Row {
    let started = Instant::now();
    let outcome = measure(problem, study, state, samples, step_size);
    Row { step_size, outcome, wall_seconds: started.elapsed().as_secs_f64() }
}

fn measure(
    problem: &Problem,
    study: &Study,
    state: &State,
    samples: &Samples,
    step_size: f64,
) -> Result<Measure, String> {
    let text = |error: emmy::Error| with_causes(&error);
    let motion = Motion::new(&problem.body, study.scheme, study.degree, problem.newton, state.clone());
    let (mut motion, plan) = (motion.map_err(text)?, study.plan(step_size).map_err(text)?);
    let mut norm = ErrorNorm::new(samples, study.window.0, study.tolerance());
    let mut newton = Newton(0);
    motion.march(&plan, &mut [&mut norm, &mut newton]).map_err(|error| with_causes(&error))?;
    let (error, relative_error) = (norm.error(), norm.relative_error());
    Ok(Measure { error, relative_error, newton_iterations: newton.0 })
}

/// Counts Newton iterations.
struct Newton(usize);

impl Observer for Newton {
    fn observe(
        &mut self,
        view: emmy::motion::View<'_>,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.0 += view.record.newton_iterations;
        Ok(())
    }
}

fn report(row: &Row) {
    let size = number(row.step_size);
    match row.error() {
        Some(error) => eprintln!("h = {size}: error {error:.3e} in {:.2} s", row.wall_seconds),
        None => eprintln!("h = {size}: no convergence"),
    }
}
