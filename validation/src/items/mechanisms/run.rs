//! Runs of the problems, and periods.

use emmy::motion::{Motion, Record, State};
use emmy::time::Scheme;
use emmy_io::input::Problem as Input;

use super::data::{Period, Problem};
use crate::measure::cpu_seconds;

/// Result of a run.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// Degree.
    pub degree: usize,
    /// Step size.
    pub size: f64,
    /// Number of steps.
    pub steps: usize,
    /// Error at the last time.
    pub error: f64,
    /// The quantity at the last time.
    pub value: Vec<f64>,
    /// Errors at all times of the data.
    pub errors: Vec<f64>,
    /// Largest residual of the energy balance since the start.
    pub energy: f64,
    /// Largest kinetic energy.
    pub scale: f64,
    /// Largest opening of a joint or change of a body's shape, over the size of the whole.
    pub constraints: f64,
    /// Energy with the potential of gravity, and angular momentum, at the end.
    pub end: (f64, [f64; 3]),
    /// CPU time of the steps \[s\].
    pub seconds: f64,
}

impl Outcome {
    /// Residual of the energy over the largest kinetic energy.
    pub(super) fn drift(&self) -> f64 {
        self.energy / self.scale
    }
}

/// Largest drifts over a motion.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Drifts {
    /// Energy less work and dissipation, against the start.
    pub energy: f64,
    /// Largest kinetic energy.
    pub scale: f64,
    /// Openings of joints and changes of shape.
    pub constraints: f64,
}

impl Drifts {
    /// Adds a record to those since the start.
    pub(super) fn add(&mut self, start: f64, record: &Record) {
        let energy = record.total_energy - record.external_work + record.dissipated_energy - start;
        self.energy = self.energy.max(energy.abs());
        self.scale = self.scale.max(record.kinetic_energy);
        self.constraints = self.constraints.max(record.constraint_residual);
    }
}

/// The motion of an input at its start.
///
/// # Errors
/// The message of an invalid start.
pub(super) fn started(input: &Input, degree: usize) -> Result<Motion<'_>, String> {
    let text = |error: emmy::Error| error.to_string();
    let scheme = input.scheme.with_degree(degree).map_err(text)?;
    let state = State::initial(&input.body, 0.0, &input.initial).map_err(text)?;
    Motion::starting(&input.body, scheme, input.newton, state).map_err(text)
}

/// Runs a problem to the last of its times.
///
/// # Errors
/// The message of a step that fails.
pub(super) fn run(problem: &Problem, input: &Input, degree: usize, size: f64) -> Result<Outcome, String> {
    let failed = |error: emmy::Error| format!("{}, k = {degree}, h = {size}: {error}", problem.name);
    let mut motion = started(input, degree)?;
    let start = motion.record().total_energy;
    let (mut drifts, mut steps, mut errors) = (Drifts::default(), 0, Vec::new());
    let begin = cpu_seconds();
    for state in &problem.state {
        while steps < (state.time / size).round() as usize {
            drifts.add(start, motion.step(size).map_err(failed)?);
            steps += 1;
        }
        errors.push(problem.error(&input.body, motion.record(), &state.value));
    }
    let (record, seconds) = (motion.record(), cpu_seconds() - begin);
    Ok(Outcome {
        degree,
        size,
        steps,
        error: *errors.last().ok_or("a problem has a state")?,
        value: problem.quantity.value(&input.body, record, &problem.start),
        errors,
        energy: drifts.energy,
        scale: drifts.scale,
        constraints: drifts.constraints,
        end: (problem.energy_with_gravity(input, record), record.angular_momentum),
        seconds,
    })
}

/// A period by DGM of degree 4: steps of a size up to each zero, and one that ends there.
///
/// # Errors
/// The message of a step that fails.
pub(super) fn period(input: &Input, period: &Period, size: f64) -> Result<f64, String> {
    let text = |error: emmy::Error| error.to_string();
    let value = |record: &Record| period.of.value(&input.body, record);
    let mut motion = started(input, 4)?;
    let mut zeros = vec![0.0];
    let mut last = value(motion.record());
    while zeros.len() <= period.zeros[1] {
        let before = motion.snapshot();
        let now = value(motion.step(size).map_err(text)?);
        // The start itself may be a zero, up to rounding.
        if last * now < 0.0 && before.state.step > 0 {
            let scheme: Scheme = input.scheme.with_degree(4).map_err(text)?;
            let at = |part: f64| -> Result<f64, String> {
                let again = Motion::resumed(&input.body, scheme, input.newton, before.clone());
                Ok(value(again.map_err(text)?.step(part).map_err(text)?))
            };
            zeros.push(before.state.time + zero((size, now), last, at)?);
        }
        last = now;
    }
    Ok(period.factor * (zeros[period.zeros[1]] - zeros[period.zeros[0]]))
}

/// Zero of a function by secants, from its value at 0 and a point beyond the zero.
fn zero(beyond: (f64, f64), at_zero: f64, at: impl Fn(f64) -> Result<f64, String>) -> Result<f64, String> {
    let (mut a, mut b) = ((0.0, at_zero), beyond);
    for _ in 0..20 {
        let next = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        if !next.is_finite() || (next - b.0).abs() < 1e-13 {
            break;
        }
        (a, b) = (b, (next, at(next)?));
    }
    Ok(b.0)
}
