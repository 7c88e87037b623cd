//! Comparison of adaptive steps with equal ones of the same error.

use super::run::{Choice, Run};

/// Cost of equal steps of the same degree and error, relative to the cost of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Advantage {
    /// In CPU time.
    pub seconds: f64,
    /// In steps; repeated steps count each time.
    pub steps: f64,
}

impl Advantage {
    /// The ratios of an adaptive run; `None` unless its error lies between the errors of two runs with equal steps.
    pub(super) fn of(run: &Run, runs: &[Run]) -> Option<Self> {
        let is_equal = |other: &&Run| other.degree == run.degree && matches!(other.choice, Choice::Equal(_));
        let equal: Vec<&Run> = runs.iter().filter(is_equal).collect();
        let need = |cost: fn(&Run) -> f64| {
            let points: Vec<(f64, f64)> = equal.iter().map(|run| (run.error, cost(run))).collect();
            least(&points, run.error).map(|needed| needed / cost(run))
        };
        match run.choice {
            Choice::Equal(_) => None,
            Choice::Adaptive(_) => {
                Some(Advantage { seconds: need(|run| run.seconds)?, steps: need(Run::attempts)? })
            }
        }
    }
}

/// The least cost at which a curve of (error, cost) reaches an error, by straight lines between the logarithms of its
/// points.
fn least(curve: &[(f64, f64)], error: f64) -> Option<f64> {
    let costs = curve.windows(2).filter_map(|pair| {
        let [(e0, c0), (e1, c1)] = [pair[0], pair[1]].map(|(e, c)| (e.ln(), c.ln()));
        let part = (error.ln() - e0) / (e1 - e0);
        (0.0..=1.0).contains(&part).then(|| (c0 + part * (c1 - c0)).exp())
    });
    costs.reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_between_two_runs_follow_a_power() {
        // cost = error^(-1/2)
        let curve = [(1e-2, 10.0), (1e-4, 100.0), (1e-6, 1000.0)];
        assert!((least(&curve, 1e-5).unwrap() - 10f64.powf(2.5)).abs() < 1e-9);
        assert_eq!(least(&curve, 1e-7), None);
        // Errors may cancel at one size; the cheaper of two ways to an error counts.
        let dip = [(1e-2, 10.0), (1e-5, 20.0), (1e-3, 40.0), (1e-6, 80.0)];
        assert!(least(&dip, 1e-4).unwrap() < 20.0);
    }
}
