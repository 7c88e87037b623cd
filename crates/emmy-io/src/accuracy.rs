//! Accuracy in time: whether the steps of a run resolve its motion. Balances close with steps of any size, so this is a
//! statement of its own.

use emmy::body::{InitialVelocity, Load, LoadKind};
use emmy::internals::number::short;
use emmy::modes::{lowest_elastic_mode, lowest_elastic_mode_about};
use emmy::motion::{Phase, RunStatistics, StepPlan};
use emmy::time::{MAX_DEGREE, Scheme};

use crate::input::{Problem, Start};
use crate::units::Units;

/// The knowledge of the accuracy of a run in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AccuracyKind {
    /// Errors of its steps, or of its end, were estimated.
    Estimated,
    /// Nothing is known, or only how long the steps are.
    NotEstimated,
    /// Its steps are too long for its vibrations.
    Coarse,
}

impl AccuracyKind {
    /// The words in the summary.
    ///
    /// ```
    /// assert_eq!(emmy_io::accuracy::AccuracyKind::NotEstimated.name(), "not estimated");
    /// ```
    pub const fn name(self) -> &'static str {
        match self {
            AccuracyKind::Estimated => "estimated",
            AccuracyKind::NotEstimated => "not estimated",
            AccuracyKind::Coarse => "coarse",
        }
    }
}

/// A statement on the accuracy of a run in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Its kind.
    pub kind: AccuracyKind,
    /// The statement; it begins with the words of the kind.
    pub text: String,
    /// A note on steps that do not resolve the lowest elastic mode.
    pub note: Option<String>,
    /// Number of the largest steps in the lowest elastic period; `None` where the period was not asked for.
    pub steps_per_period: Option<f64>,
}

impl Accuracy {
    /// Accuracy of a run of a problem with some steps; `None` for a static analysis, or before the first step. `error`:
    /// the estimated error of the positions at the end \[length\]. `period`: the lowest elastic period, which is called
    /// only where it matters and is cheap. On a team, a collective call.
    pub fn of(
        problem: &Problem,
        plan: &StepPlan,
        statistics: &RunStatistics,
        error: Option<f64>,
        period: impl FnOnce() -> Option<f64>,
    ) -> Option<Self> {
        if problem.is_static() || statistics.steps == 0 {
            return None;
        }
        let estimated = |how: String| Accuracy {
            kind: AccuracyKind::Estimated,
            text: format!("estimated{how}"),
            note: None,
            steps_per_period: None,
        };
        if let Some(error) = error {
            let part = error / problem.body.radius_of_gyration();
            let part = match part.is_finite() {
                true => format!(", {part:.1e} of the radius of gyration"),
                false => String::new(),
            };
            let error = problem.units.with_unit(format!("{error:.1e}"), "length");
            return Some(estimated(format!(
                " at {error} in the root mean square of the positions at the end{part}"
            )));
        }
        if plan.adaptivity().is_some() {
            let sum = statistics.accumulated_local_error;
            return Some(estimated(format!(
                ": the errors of the steps add up to {sum:.1e} of the scales; `--estimate-error` also shows how they grow"
            )));
        }
        let step = statistics.largest_step_size;
        let period = if is_period_wanted(problem, statistics) { period() } else { None };
        let (scheme, units) = (problem.scheme, problem.units);
        let steps_per_period = period.map(|period| period / step);
        let coarse = |text: String, note| {
            let text = format!("coarse, {text}");
            Some(Accuracy { kind: AccuracyKind::Coarse, text, note, steps_per_period })
        };
        if let Some(period) = period.filter(|period| is_coarse(step, *period, scheme)) {
            return coarse(share(step, period, units), Some(note(step, period, scheme, units)));
        }
        if let Some(text) = long_step(plan, units) {
            return coarse(text, None);
        }
        let steps = steps_per_period
            .map_or(String::new(), |steps| format!(" ({} steps in the lowest elastic period)", count(steps)));
        let flag = match scheme.is_time_element() && scheme.degree() < MAX_DEGREE {
            true => " or `--estimate-error`",
            false => "",
        };
        let text = format!("not estimated{steps}; `emmy converge`{flag} measures it");
        Some(Accuracy { kind: AccuracyKind::NotEstimated, text, note: None, steps_per_period })
    }
}

/// Strain energy over kinetic energy above which strains matter for the motion. A body that moves as if rigid stays
/// below it, with steps that resolve its rotation.
const STRAIN_PART: f64 = 1e-2;

/// Size up to which the lowest period of a body takes some hundredths of a second.
const DOFS_OF_SMALL_BODY: usize = 3_000;

/// For larger bodies it takes about as long as two steps, which is little in a run of many steps.
const LARGEST: usize = 30_000;
const MANY_STEPS: usize = 20;

/// Whether the lowest elastic period of a body says something about its motion, and is cheap.
fn is_period_wanted(problem: &Problem, statistics: &RunStatistics) -> bool {
    let n_dofs = problem.body.n_dofs();
    let is_cheap = n_dofs <= DOFS_OF_SMALL_BODY || n_dofs <= LARGEST && statistics.steps >= MANY_STEPS;
    let is_strained = statistics.largest_strain_energy > STRAIN_PART * statistics.largest_kinetic_energy;
    // The potential of an attraction is no strain energy, but counts among it.
    let is_known = problem.body.ranks().size() == 1 && problem.nodal.attractions.is_empty();
    is_cheap && is_strained && is_known
}

/// Largest product of degrees of freedom and increments of an equilibrium that is computed for a period alone: a second
/// or two.
const MAX_INCREMENTS: usize = 30_000;

/// Whether the equilibrium from which a motion starts, if any, is cheap compared with its lowest period.
pub fn has_cheap_equilibrium(problem: &Problem) -> bool {
    let n_increments = match problem.start {
        Start::Equilibrium { load_steps } => load_steps,
        Start::Undeformed if problem.is_static() => problem.plan.n_steps(),
        Start::Undeformed | Start::Run(_) => 0,
    };
    problem.body.n_dofs().saturating_mul(n_increments) <= MAX_INCREMENTS
}

/// The lowest elastic period of a problem at its start; `None` if it is not found, or would take long.
pub fn lowest_period(problem: &Problem) -> Option<f64> {
    if !has_cheap_equilibrium(problem) {
        return None;
    }
    let found = match problem.state_of_vibration().ok()? {
        Some(state) => lowest_elastic_mode_about(&problem.body, &state),
        None => lowest_elastic_mode(&problem.body),
    };
    found.ok()?.map(|(mode, _)| mode.period())
}

/// Whether a step is too long for a period: a vibration of this period then has a phase error of about 1 % or more with
/// degree 2 and higher ones, `(omega h)^(2k)/C` with C = 720 and 100800, and above 10 % with degree 1, C = 12.
pub fn is_coarse(step: f64, period: f64, scheme: Scheme) -> bool {
    let longest = match scheme.degree() {
        1 => 0.2,
        2 => 0.25,
        _ => 0.5,
    };
    step > longest * period
}

/// Steps in a period with a relative phase error of 1e-3: `(omega h)^2/12` with degree 1, `(omega h)^4/720` with degree
/// 2, less with higher ones.
pub fn steps_per_period(scheme: Scheme) -> f64 {
    if scheme.degree() == 1 { 58.0 } else { 8.0 }
}

/// The step size of [`steps_per_period`], with two digits.
pub fn suggested_size(period: f64, scheme: Scheme) -> f64 {
    rounded_down(period / steps_per_period(scheme))
}

/// `0.25 of` or `10 times`.
pub fn part(step: f64, period: f64) -> String {
    format!("{} {}", two_digits(step / period), if step > period { "times" } else { "of" })
}

/// A step over the lowest elastic period, in words.
pub fn share(step: f64, period: f64, units: Units) -> String {
    let [step_size, lowest] = [step, period].map(|time| units.number(time, "time"));
    format!("a step of {step_size} is {} the lowest elastic period {lowest}", part(step, period))
}

/// The note on steps that are too long for the lowest elastic period.
pub fn note(step: f64, period: f64, scheme: Scheme, units: Units) -> String {
    let size = short(suggested_size(period, scheme));
    let share = share(step, period, units);
    format!(
        "{share}: vibrations are not resolved; about `size = {size}` resolves them, if loads and supports do not change slowly"
    )
}

/// Whether a body with rigid modes may vibrate: its loads are more than a uniform acceleration, or it does not start as
/// if rigid.
pub fn may_vibrate(problem: &Problem) -> bool {
    let is_uniform = |load: &Load| matches!(load.kind, LoadKind::Acceleration { group: None, .. });
    let is_rigid = |own: &InitialVelocity| own.group.is_none() && own.gradient == [[0.0; 3]; 3];
    let nodal = &problem.nodal;
    problem.start != Start::Undeformed
        || problem.body.is_driven()
        || !problem.loads.iter().all(is_uniform)
        || !problem.initial.iter().all(is_rigid)
        || !nodal.springs.is_empty()
        || !problem.joints.is_empty()
}

/// The first step of a plan that is longer than its phase, in words.
pub(crate) fn long_step(plan: &StepPlan, units: Units) -> Option<String> {
    if plan.adaptivity().is_some() {
        return None;
    }
    let mut begin = plan.start();
    let mut phases = plan.phases().iter().peekable();
    while let Some(&Phase { until, size }) = phases.next() {
        // A phase is split where a support is released.
        if phases.peek().is_some_and(|next| next.size == size) {
            continue;
        }
        if size > (until - begin) * (1.0 + 1e-6) {
            let [size, until] = [size, until].map(|time| units.number(time, "time"));
            return Some(format!(
                "a step of {size} is longer than its phase, which ends at t = {until} after one shorter step"
            ));
        }
        begin = until;
    }
    None
}

/// A number with two digits.
fn two_digits(value: f64) -> String {
    format!("{value:.1e}").parse::<f64>().map_or_else(|_| short(value), short)
}

/// A number of steps, with one decimal if it is small.
pub fn count(steps: f64) -> String {
    if steps < 10.0 { format!("{steps:.1}") } else { format!("{steps:.0}") }
}

/// The number with two digits, rounded down.
fn rounded_down(value: f64) -> f64 {
    let digit = 10f64.powi(value.log10().floor() as i32 - 1);
    // The small excess keeps a number that already has two digits.
    (value / digit * (1.0 + 1e-12)).floor() * digit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scheme(degree: usize) -> Scheme {
        Scheme::from_name("DGM").unwrap().with_degree(degree).unwrap()
    }

    fn plan(phases: &[(f64, f64)]) -> StepPlan {
        StepPlan::new(0.0, phases.iter().map(|&(until, size)| Phase { until, size }).collect()).unwrap()
    }

    #[test]
    fn suggested_sizes_have_two_digits() {
        for (value, expected) in [(0.012345, "0.012"), (7.99e-6, "0.0000079"), (31.0, "31"), (0.025, "0.025")]
        {
            assert_eq!(short(rounded_down(value)), short(expected.parse::<f64>().unwrap()));
        }
    }

    /// (omega h)^2/12, (omega h)^4/720 and (omega h)^6/100800 for h = T/n.
    #[test]
    fn phase_errors_of_the_suggestions_and_of_coarse_steps() {
        let error = |angle: f64, degree: usize| match degree {
            1 => angle.powi(2) / 12.0,
            2 => angle.powi(4) / 720.0,
            _ => angle.powi(6) / 100_800.0,
        };
        for degree in [1, 2, 3] {
            let tau = std::f64::consts::TAU;
            assert!(error(tau / steps_per_period(scheme(degree)), degree) < 1e-3);
            let longest =
                (1..1000).map(|i| f64::from(i) * 1e-3).find(|step| is_coarse(*step, 1.0, scheme(degree)));
            let wrong = error(tau * longest.unwrap(), degree);
            let range = if degree == 1 { 0.10..0.15 } else { 0.007..0.011 };
            assert!(range.contains(&wrong), "{degree}: {wrong}");
        }
    }

    #[test]
    fn steps_longer_than_their_phase_are_seen() {
        let units = Units::default();
        assert_eq!(long_step(&plan(&[(1.0, 1.0)]), units), None);
        assert_eq!(long_step(&plan(&[(1.0, 0.3), (1.5, 0.5)]), units), None);
        // Split at a release.
        assert_eq!(long_step(&plan(&[(0.1, 0.5), (1.0, 0.5)]), units), None);
        let text = long_step(&plan(&[(1.0, 0.1), (1.25, 0.5), (3.0, 0.1)]), units).unwrap();
        assert!(
            text.starts_with("a step of 0.5 is longer than its phase, which ends at t = 1.25 "),
            "{text}"
        );
    }

    #[test]
    fn shares_are_told_in_words() {
        let told = |step| share(step, 2.0, Units::default());
        assert_eq!(told(20.0), "a step of 20 is 10 times the lowest elastic period 2");
        assert_eq!(told(0.5), "a step of 0.5 is 0.25 of the lowest elastic period 2");
    }
}
