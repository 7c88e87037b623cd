//! `[limits]`: when a run has lost too much of what it should keep.

use emmy::number::short;

use crate::input::Limits;
use crate::tally::Tally;

/// A limit was exceeded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "step {step}, t = {}: the accumulated {quantity} residual is {drift:.3e} of the largest {of}; the limit is {}",
    short(.time),
    short(.limit)
)]
pub struct LimitExceeded {
    /// The quantity, as its key in `[limits]` spells it.
    pub quantity: &'static str,
    /// What it is measured by.
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
pub fn check(limits: &Limits, tally: &Tally) -> Result<(), LimitExceeded> {
    let (step, time) = (tally.steps, tally.time);
    let checks = [
        ("energy", "T + V", limits.energy, tally.energy_drift()),
        ("angular_momentum", "|L|", limits.angular_momentum, tally.angular_momentum_drift()),
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
        let mut tally = Tally::default();
        (tally.accumulated_energy, tally.largest_energy) = (-2e-6, 1.0);
        let limits = |energy| Limits { energy: Some(energy), angular_momentum: Some(1e-8) };
        assert!(check(&limits(1e-5), &tally).is_ok());
        assert_eq!(check(&limits(1e-6), &tally).unwrap_err().quantity, "energy");
        tally.accumulated_energy = f64::NAN;
        assert!(check(&limits(1.0), &tally).is_err() && check(&Limits::default(), &tally).is_ok());
    }
}
