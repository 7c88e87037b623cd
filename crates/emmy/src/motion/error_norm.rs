//! The distance of a motion from a reference.

use super::{Observer, Samples, View};

/// Distance of a motion from the samples of a reference, Betsch and Steinmann (2001), equation (80):
///
/// ```math
/// ||e|| = ( int_ta^tb sum_A |q_A(t) - q*_A(t)|^2 dt )^(1/2)
/// ```
///
/// The sum is over the nodes; the integral is taken by the trapezoidal rule at the times of the motion. As an observer,
/// it sees every step of a march.
///
/// ```
/// use emmy::motion::{ErrorNorm, Samples};
/// let reference = Samples { times: vec![0.0, 2.0], n_dofs: 3, displacement: vec![0.0; 6] };
/// let mut norm = ErrorNorm::new(&reference, 0.0, 1e-12);
/// assert!(norm.add(0.0, &[1.0, 0.0, 0.0]) && norm.add(2.0, &[1.0, 0.0, 0.0]));
/// assert_eq!((norm.error(), norm.relative_error()), (f64::sqrt(2.0), None));
/// assert!(!norm.add(3.0, &[1.0, 0.0, 0.0])); // no sample
/// ```
#[derive(Debug)]
pub struct ErrorNorm<'a> {
    samples: &'a Samples,
    /// Start of the integral.
    start: f64,
    tolerance: f64,
    /// Time and integrands of the previous step.
    last: Option<(f64, [f64; 2])>,
    integrals: [f64; 2],
}

impl<'a> ErrorNorm<'a> {
    /// The norm from a time on; times closer than the tolerance are equal.
    pub fn new(samples: &'a Samples, start: f64, tolerance: f64) -> Self {
        ErrorNorm { samples, start, tolerance, last: None, integrals: [0.0; 2] }
    }

    /// The norm of the error so far \[length time^(1/2)\].
    pub fn error(&self) -> f64 {
        self.integrals[0].sqrt()
    }

    /// The error over the norm of the displacement of the reference; `None` if that is zero.
    pub fn relative_error(&self) -> Option<f64> {
        (self.integrals[1] > 0.0).then(|| (self.integrals[0] / self.integrals[1]).sqrt())
    }

    /// Adds a displacement at a time; false if there is no sample at that time.
    pub fn add(&mut self, time: f64, displacement: &[f64]) -> bool {
        if time < self.start - self.tolerance {
            return true;
        }
        let Some(reference) = self.samples.at(time, self.tolerance) else { return false };
        let error = displacement.iter().zip(reference).map(|(u, r)| (u - r) * (u - r)).sum::<f64>();
        let now = [error, reference.iter().map(|r| r * r).sum()];
        if let Some((before, last)) = self.last {
            (0..2).for_each(|i| self.integrals[i] += 0.5 * (time - before) * (last[i] + now[i]));
        }
        self.last = Some((time, now));
        true
    }
}

impl Observer for ErrorNorm<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        view.body.space.check_whole("a distance from samples")?;
        match self.add(view.state.time, &view.state.displacement) {
            true => Ok(()),
            false => Err(format!("the reference has no state at t = {}", view.state.time).into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_analytic_motions_have_their_known_distance() {
        // Two nodes; u - u* = (cos t, 0, sin t) and (0, 2 t, 0) on 0..3, of which 1..3 counts:
        // integral of 1 + 4 t^2 = 2 + 4 (27 - 1) / 3.
        let times: Vec<f64> = (0..=3000).map(|i| f64::from(i) / 1000.0).collect();
        let reference = |t: f64| [1.0, 0.0, 0.0, 0.0, t, 0.0];
        let motion = |t: f64| [1.0 + t.cos(), 0.0, t.sin(), 0.0, 3.0 * t, 0.0];
        let displacement = times.iter().flat_map(|&t| reference(t)).collect();
        let samples = Samples { times: times.clone(), n_dofs: 6, displacement };
        let mut norm = ErrorNorm::new(&samples, 1.0, 1e-12);
        assert!(times.iter().all(|&t| norm.add(t, &motion(t))));
        assert!((norm.error().powi(2) - (2.0 + 104.0 / 3.0)).abs() < 1e-5, "{}", norm.error());
        // |u*|^2 = 1 + t^2: integral 2 + 26 / 3.
        let relative = ((2.0 + 104.0 / 3.0) / (2.0 + 26.0 / 3.0f64)).sqrt();
        assert!((norm.relative_error().unwrap() - relative).abs() < 1e-6);
        assert!(!norm.add(2.9995, &motion(2.9995)));
    }
}
