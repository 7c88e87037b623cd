//! `[limits]`: bounds on the accumulated residuals of a run.

use emmy::internals::number::short;
use emmy::motion::RunStatistics;

use crate::input::Limits;

/// A limit was exceeded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "step {step}, t = {}: the accumulated {} residual is {drift:.3e} of the largest {of}; the limit is {}",
    short(.time),
    quantity.replace('_', " "),
    short(.limit)
)]
pub struct LimitExceeded {
    /// The quantity, as its key in `[limits]` spells it.
    pub quantity: &'static str,
    /// The quantity that it is relative to.
    pub of: &'static str,
    /// Number of the step.
    pub step: usize,
    /// Time at its end.
    pub time: f64,
    /// Accumulated residual, relative.
    pub drift: f64,
    /// The limit.
    pub limit: f64,
}

/// Checks the limits after a step.
///
/// # Errors
/// [`LimitExceeded`] for the first one that is exceeded; NaN exceeds every limit.
pub fn check(limits: &Limits, statistics: &RunStatistics) -> Result<(), LimitExceeded> {
    let step = statistics.steps;
    let time = statistics.time;
    let checks = [
        ("energy", statistics.energy_size().1, limits.energy, statistics.energy_drift()),
        (
            "angular_momentum",
            statistics.angular_momentum_size().1,
            limits.angular_momentum,
            statistics.angular_momentum_drift(),
        ),
    ];
    for (quantity, of, limit, drift) in checks {
        match limit {
            Some(limit) if drift > limit || drift.is_nan() => {
                return Err(LimitExceeded { quantity, of, step, time, drift, limit });
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_counts_against_the_largest_value() {
        let mut statistics = RunStatistics::default();
        (statistics.accumulated_energy_residual, statistics.largest_energy) = (-2e-6, 1.0);
        let limits = |energy| Limits { energy: Some(energy), angular_momentum: Some(1e-8) };
        assert!(check(&limits(1e-5), &statistics).is_ok());
        assert_eq!(check(&limits(1e-6), &statistics).unwrap_err().quantity, "energy");
        statistics.accumulated_energy_residual = f64::NAN;
        assert!(check(&limits(1.0), &statistics).is_err() && check(&Limits::default(), &statistics).is_ok());
    }
}
