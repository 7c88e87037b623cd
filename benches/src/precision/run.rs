//! The runs of a case: their errors, counts and times.

use emmy::body::Body;
use emmy::motion::{
    Adaptivity, GlobalError, Motion, NewtonSettings, Observer, Phase, Record, State, StepPlan,
};
use emmy::time::TimeElement;

use super::cases::Case;
use crate::process::cpu_time;

/// Name of the scheme of all runs.
pub(super) const SCHEME: &str = "DGM";

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Choice {
    /// This number of equal steps.
    Equal(usize),
    /// Steps within this tolerance.
    Adaptive(f64),
}

/// One run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// Degree in time.
    pub degree: usize,
    /// How steps are chosen.
    pub choice: Choice,
    /// Steps done.
    pub steps: usize,
    /// Repetitions of steps, because of their error or a failure.
    pub repeated: usize,
    /// Newton corrections of the steps done.
    pub corrections: usize,
    /// Refactorizations of the approximate tangent in these steps.
    pub refactorizations: usize,
    /// Error of the positions at the end: mean over the mass, relative to the radius of gyration.
    pub error: f64,
    /// The same, estimated.
    pub estimate: f64,
    /// CPU time \[s\], the fastest of the rounds.
    pub seconds: f64,
}

/// All runs of a case.
#[derive(Debug)]
pub(super) struct Sweep {
    /// Equal steps from large to small, adaptive ones from large tolerances to small ones, degree by degree.
    pub runs: Vec<Run>,
    /// Distance of the two references, measured like the errors.
    pub doubt: f64,
    /// Failures with their reasons.
    pub failures: Vec<String>,
}

/// A run shorter than this is repeated until this time has passed \[s\].
const LEAST_SECONDS: f64 = 0.03;

/// Largest distance of the references, relative to the smallest error.
const DOUBT: f64 = 0.2;

impl Sweep {
    /// Computes everything once, then measures the times of all runs, which take turns.
    ///
    /// # Errors
    /// A message if a reference or an adaptive run fails.
    pub(super) fn measure(case: &Case, rounds: usize) -> Result<Self, String> {
        let [reference, other] = case.references.map(|(degree, n)| reference(case, degree, n));
        let (reference, other) = (reference?, other?);
        let mut sweep =
            Sweep { runs: Vec::new(), doubt: distance(&case.body, &other, &reference), failures: Vec::new() };
        eprintln!("{}: references differ by {:.1e}", case.name, sweep.doubt);
        for degree in 1..=3 {
            let equal = case.counts[degree - 1].iter().map(|&n| Choice::Equal(n));
            let adaptive = case.tolerances[degree - 1].iter().map(|&tolerance| Choice::Adaptive(tolerance));
            for choice in equal.chain(adaptive) {
                match Run::count(case, degree, choice, &reference) {
                    Ok(run) => sweep.runs.push(run),
                    Err(message) => sweep.failures.push(message),
                }
            }
        }
        // Errors below the accuracy of the reference are left out.
        sweep.runs.retain(|run| run.error * DOUBT > sweep.doubt);
        for round in 1..=rounds {
            eprintln!("{}: round {round} of {rounds}", case.name);
            for run in &mut sweep.runs {
                run.seconds = run.seconds.min(run.timed(case)?);
            }
        }
        Ok(sweep)
    }
}

/// Counts the steps of a march and their work.
#[derive(Debug, Default)]
struct Counts {
    steps: usize,
    repeated: usize,
    corrections: usize,
    refactorizations: usize,
}

impl Observer for Counts {
    fn observe(
        &mut self,
        view: emmy::motion::View<'_>,
    ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let Record { newton_iterations, refactorizations, rejections, cuts, .. } = *view.record;
        self.steps += usize::from(view.record.step > 0);
        self.repeated += rejections + cuts;
        self.corrections += newton_iterations;
        self.refactorizations += refactorizations;
        Ok(())
    }
}

impl Run {
    /// The run without its time: counts, error, estimate.
    fn count(case: &Case, degree: usize, choice: Choice, reference: &State) -> Result<Run, String> {
        let fail = |error: &dyn std::fmt::Display| format!("k = {degree}, {choice}: {error}");
        let settings = NewtonSettings::default();
        let mut estimate =
            GlobalError::new(&case.body, element(degree).map_err(|e| fail(&e))?, settings, &case.start)
                .map_err(|e| fail(&e))?;
        let (mut counts, plan) = (Counts::default(), choice.plan(case.end).map_err(|error| fail(&error))?);
        let mut motion = motion(case, degree).map_err(|error| fail(&error))?;
        motion.march(&plan, &mut [&mut counts, &mut estimate]).map_err(|error| fail(&error))?;
        let length = case.body.radius_of_gyration();
        Ok(Run {
            degree,
            choice,
            steps: counts.steps,
            repeated: counts.repeated,
            corrections: counts.corrections,
            refactorizations: counts.refactorizations,
            error: distance(&case.body, motion.state(), reference),
            estimate: case.body.mass_weighted_rms(estimate.displacement()) / length,
            seconds: f64::INFINITY,
        })
    }

    /// CPU time of the whole motion from its start, repeated \[s\].
    fn timed(&self, case: &Case) -> Result<f64, String> {
        let plan = self.choice.plan(case.end).map_err(|error| error.to_string())?;
        let (start, mut times) = (cpu_time(), 0);
        loop {
            let mut motion = motion(case, self.degree).map_err(|error| error.to_string())?;
            motion.march(&plan, &mut []).map_err(|error| error.to_string())?;
            times += 1;
            let seconds = (cpu_time() - start).as_secs_f64();
            if seconds > LEAST_SECONDS {
                return Ok(seconds / f64::from(times));
            }
        }
    }

    /// Number of steps; repeated steps count each time.
    pub(super) fn attempts(&self) -> f64 {
        (self.steps + self.repeated) as f64
    }
}

impl Choice {
    fn plan(self, end: f64) -> emmy::Result<StepPlan> {
        match self {
            Choice::Equal(n) => StepPlan::new(0.0, vec![Phase { until: end, size: end / n as f64 }]),
            Choice::Adaptive(tolerance) => StepPlan::adaptive(0.0, end, Adaptivity::new(tolerance)),
        }
    }
}

impl std::fmt::Display for Choice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Choice::Equal(n) => write!(f, "{n} equal steps"),
            Choice::Adaptive(tolerance) => write!(f, "tolerance {tolerance:.0e}"),
        }
    }
}

fn element(degree: usize) -> emmy::Result<TimeElement> {
    TimeElement::discrete_gradient(degree)
}

fn motion(case: &Case, degree: usize) -> emmy::Result<Motion<'_>> {
    Motion::new(&case.body, element(degree)?)?.from(case.start.clone())
}

/// The state at the end of equal steps of a high degree.
fn reference(case: &Case, degree: usize, n: usize) -> Result<State, String> {
    let settings = NewtonSettings { tolerance: 1e-13, max_iterations: 40, ..NewtonSettings::default() };
    let motion = element(degree)
        .and_then(|element| Motion::starting(&case.body, element, settings, case.start.clone()));
    let mut motion = motion.map_err(|error| error.to_string())?;
    let plan = Choice::Equal(n).plan(case.end).map_err(|error| error.to_string())?;
    motion.march(&plan, &mut []).map_err(|error| format!("reference of degree {degree}: {error}"))?;
    Ok(motion.state().clone())
}

/// Distance of the positions of two states: mean over the mass, relative to the radius of gyration.
fn distance(body: &Body, a: &State, b: &State) -> f64 {
    let difference: Vec<f64> = a.displacement.iter().zip(&b.displacement).map(|(a, b)| a - b).collect();
    body.mass_weighted_rms(&difference) / body.radius_of_gyration()
}
