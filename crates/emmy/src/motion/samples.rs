//! Displacements of a motion at given times.

use super::{Observer, View};

/// Displacements at given times, from a [`Sampler`].
///
/// ```
/// use emmy::motion::Samples;
/// let samples = Samples { times: vec![0.0, 0.5], n_dofs: 3, displacement: vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0] };
/// assert_eq!(samples.at(0.5, 1e-12), Some(&[1.0, 2.0, 3.0][..]));
/// assert!(!samples.cover(&[0.25], 1e-12));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Samples {
    /// Times, ascending.
    pub times: Vec<f64>,
    /// Number of degrees of freedom.
    pub n_dofs: usize,
    /// Displacements, `[n_times][n_dofs]` \[length\].
    pub displacement: Vec<f64>,
}

impl Samples {
    /// Displacement at a time; `None` without a sample within the tolerance.
    pub fn at(&self, time: f64, tolerance: f64) -> Option<&[f64]> {
        let index = nearest(&self.times, time, tolerance)?;
        self.displacement.get(index * self.n_dofs..(index + 1) * self.n_dofs)
    }

    /// Whether there is a sample at each of some times.
    pub fn cover(&self, times: &[f64], tolerance: f64) -> bool {
        times.iter().all(|&time| self.at(time, tolerance).is_some())
    }
}

/// Index of the sample at a time, within a tolerance.
fn nearest(times: &[f64], time: f64, tolerance: f64) -> Option<usize> {
    let after = times.partition_point(|&other| other < time - tolerance);
    times.get(after).filter(|&&other| other <= time + tolerance).map(|_| after)
}

/// Takes samples of a motion, as its observer.
///
/// Times inside a step are interpolated from displacement and velocity at its ends by cubic Hermite polynomials, whose
/// error is of the order `h^4` of the step size:
///
/// ```math
/// u(t_1 + theta h) = (1 + 2 theta) (1 - theta)^2 u_1 + theta^2 (3 - 2 theta) u_2
///                  + h theta (1 - theta)^2 v_1 - h theta^2 (1 - theta) v_2
/// ```
///
/// ```
/// let mut sampler = emmy::motion::Sampler::new(vec![0.5], 1e-12, 1);
/// sampler.add(0.0, &[0.0], &[1.0]);
/// sampler.add(1.0, &[1.0], &[1.0]);
/// assert_eq!(sampler.finish().displacement, [0.5]);
/// ```
#[derive(Debug)]
pub struct Sampler {
    times: Vec<f64>,
    tolerance: f64,
    samples: Samples,
    /// Time, displacement and velocity of the previous step.
    last: Option<(f64, Vec<f64>, Vec<f64>)>,
}

impl Sampler {
    /// A sampler at some times, in ascending order. Times within the tolerance of the end of a step are equal to that
    /// end.
    pub fn new(times: Vec<f64>, tolerance: f64, n_dofs: usize) -> Self {
        let displacement = Vec::with_capacity(times.len() * n_dofs);
        let samples = Samples { times: Vec::with_capacity(times.len()), n_dofs, displacement };
        Sampler { times, tolerance, samples, last: None }
    }

    /// The samples.
    pub fn finish(self) -> Samples {
        self.samples
    }

    /// Adds displacement and velocity at a time, and takes the samples up to it.
    pub fn add(&mut self, time: f64, displacement: &[f64], velocity: &[f64]) {
        while let Some(&wanted) = self.times.get(self.samples.times.len()) {
            if wanted > time + self.tolerance {
                break;
            }
            self.samples.times.push(wanted);
            let taken = &mut self.samples.displacement;
            match &self.last {
                Some((before, u, v)) if wanted < time - self.tolerance => {
                    let h = time - before;
                    let [a, b, c, d] = hermite((wanted - before) / h);
                    taken.extend(
                        (0..displacement.len())
                            .map(|i| a * u[i] + b * displacement[i] + h * (c * v[i] + d * velocity[i])),
                    );
                }
                _ => taken.extend_from_slice(displacement),
            }
        }
        let (before, u, v) =
            self.last.get_or_insert_with(|| (time, displacement.to_vec(), velocity.to_vec()));
        *before = time;
        u.copy_from_slice(displacement);
        v.copy_from_slice(velocity);
    }
}

/// Cubic Hermite polynomials of the two values, then of the two slopes.
fn hermite(theta: f64) -> [f64; 4] {
    let rest = 1.0 - theta;
    [
        (1.0 + 2.0 * theta) * rest * rest,
        theta * theta * (3.0 - 2.0 * theta),
        theta * rest * rest,
        -theta * theta * rest,
    ]
}

impl Observer for Sampler {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.add(view.state.time, &view.state.displacement, &view.state.velocity);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of sin(t) sampled between steps of a size.
    fn error(n_steps: i32) -> f64 {
        let h = 1.0 / f64::from(n_steps);
        let times: Vec<f64> = (0..=97).map(|i| f64::from(i) / 97.0).collect();
        let mut sampler = Sampler::new(times, 1e-14, 2);
        for t in (0..=n_steps).map(|i| f64::from(i) * h) {
            sampler.add(t, &[t.sin(), 3.0 - t], &[t.cos(), -1.0]);
        }
        let samples = sampler.finish();
        assert_eq!(samples.times.len(), 98);
        let error = |(t, u): (&f64, &[f64])| {
            assert!((u[1] - (3.0 - t)).abs() < 1e-14);
            (u[0] - t.sin()).abs()
        };
        samples.times.iter().zip(samples.displacement.chunks_exact(2)).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn interpolation_is_of_fourth_order() {
        let order = (error(5) / error(20)).log2() / 2.0;
        assert!((order - 4.0).abs() < 0.15, "{order}");
    }

    #[test]
    fn times_of_steps_are_taken_as_they_are() {
        let mut sampler = Sampler::new(vec![0.0, 0.2, 0.3], 1e-12, 1);
        for (t, u) in [(0.0, 1.0), (0.1, 7.0), (0.2 + 1e-15, 0.1), (0.3, 5.0)] {
            sampler.add(t, &[u], &[1e6]);
        }
        let samples = sampler.finish();
        assert_eq!(samples.displacement, [1.0, 0.1, 5.0]);
        assert_eq!((samples.at(0.2, 1e-12), samples.at(0.1, 1e-12)), (Some(&[0.1][..]), None));
        assert!(samples.cover(&[0.3, 0.0], 1e-12) && !samples.cover(&[0.25], 1e-12));
    }
}
