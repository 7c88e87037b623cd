//! Shock response spectra.

#![allow(non_snake_case)]

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::{SpectrumError, positive};

/// Peaks of a response.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peaks {
    /// Largest value, at least 0.
    pub positive: f64,
    /// Largest value of the opposite sign, at least 0.
    pub negative: f64,
}

impl Peaks {
    /// The larger of both.
    pub fn maximax(&self) -> f64 {
        self.positive.max(self.negative)
    }

    fn take(&mut self, value: f64) {
        self.positive = self.positive.max(value);
        self.negative = self.negative.max(-value);
    }
}

/// Response of an oscillator to the acceleration of its base.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShockResponse {
    /// Absolute acceleration of the mass.
    pub acceleration: Peaks,
    /// Displacement of the mass relative to the base.
    pub displacement: Peaks,
}

/// Shock response spectrum of a base acceleration: the peaks of oscillators with quality factor `q = 1/(2 zeta)`, at
/// rest at first, one for each frequency.
///
/// ```math
/// z'' + (omega/q) z' + omega^2 z = -a,    omega = 2 pi f
/// ```
///
/// Between samples a is linear, and each step is exact, as with the ramp-invariant filters of D. O. Smallwood, *Shock
/// and Vibration Bulletin* 51 (1981) and ISO 18431-4. Before the record a is 0 and grows to the first sample within one
/// step; behind it a falls as fast to 0, and stays there for a period of each oscillator.
///
/// # Errors
/// [`SpectrumError::NotPositive`] for a step, a frequency or a quality factor; [`SpectrumError::Short`] for no samples.
///
/// ```
/// use emmy_io::spectra::shock_response;
/// // A step of the acceleration: an undamped oscillator overshoots to twice the acceleration.
/// let found = shock_response(&[1.0; 1000], 1e-3, &[5.0], 1e12)?;
/// assert!((found[0].acceleration.maximax() - 2.0).abs() < 1e-3);
/// # Ok::<(), emmy_io::spectra::SpectrumError>(())
/// ```
pub fn shock_response(
    acceleration: &[f64],
    step: f64,
    frequencies: &[f64],
    q: f64,
) -> Result<Vec<ShockResponse>, SpectrumError> {
    positive("the distance of the samples", step)?;
    positive("the quality factor", q)?;
    if acceleration.is_empty() {
        return Err(SpectrumError::Short { n: 0, least: 1 });
    }
    frequencies.iter().try_for_each(|&f| positive("a frequency", f).map(|_| ()))?;
    Ok(frequencies.par_iter().map(|&f| Oscillator::new(TAU * f, q, step).response(acceleration)).collect())
}

/// Largest number of samples in a period of free vibration.
const MAX_SAMPLES: f64 = 1e4;

/// An oscillator in steps h.
struct Oscillator {
    omega: f64,
    q: f64,
    step: f64,
    /// `x_{n+1} = F x_n + g_0 a_n + g_1 (a_{n+1} - a_n)` with `x = (z, h z')`: rows of F, g_0, g_1.
    rows: [[f64; 4]; 2],
}

impl Oscillator {
    fn new(omega: f64, q: f64, step: f64) -> Self {
        let angle = omega * step;
        // The state with the acceleration and its growth, over the time in steps.
        let system = [
            [0.0, 1.0, 0.0, 0.0],
            [-angle * angle, -angle / q, -step * step, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 0.0],
        ];
        let [position, velocity, ..] = exponential(system);
        Oscillator { omega, q, step, rows: [position, velocity] }
    }

    /// The state after a step from a state, in which the acceleration goes from one value to another.
    fn after(&self, x: [f64; 2], [from, to]: [f64; 2]) -> [f64; 2] {
        let inputs = [x[0], x[1], from, to - from];
        self.rows.map(|row| row.iter().zip(&inputs).map(|(c, input)| c * input).sum())
    }

    fn take(&self, x: [f64; 2], found: &mut ShockResponse) {
        let Oscillator { omega, q, step, .. } = *self;
        found.displacement.take(x[0]);
        found.acceleration.take(-omega * omega * x[0] - omega / q * x[1] / step);
    }

    fn response(&self, acceleration: &[f64]) -> ShockResponse {
        let mut found = ShockResponse::default();
        let mut x = [0.0; 2];
        let mut before = 0.0;
        for &a in acceleration.iter().chain([&0.0]) {
            x = self.after(x, [before, a]);
            before = a;
            self.take(x, &mut found);
        }
        self.vibrate(x, &mut found);
        found
    }

    /// A period of free vibration.
    fn vibrate(&self, x: [f64; 2], found: &mut ShockResponse) {
        let Oscillator { omega, q, step, .. } = *self;
        let period = TAU / omega;
        // At low frequencies fewer samples than those of the record suffice: a peak is missed by less than 1e-7.
        let larger = (period / MAX_SAMPLES / step).max(1.0);
        let free = Oscillator::new(omega, q, larger * step);
        let mut x = [x[0], larger * x[1]];
        for _ in 0..(period / free.step).ceil() as usize {
            x = free.after(x, [0.0; 2]);
            free.take(x, found);
        }
    }
}

/// The exponential of a matrix, by its series after division by a power of 2.
fn exponential(matrix: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let norm = matrix.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = norm.max(0.25).log2().ceil() as i32 + 2;
    let small = matrix.map(|row| row.map(|x| x / 2f64.powi(halvings)));
    // With a norm of at most 1/4, fourteen terms have all digits.
    let mut sum = identity();
    for n in (1..=14).rev() {
        let product = multiplied(&small, &sum);
        sum = identity();
        for (row, product) in sum.iter_mut().zip(product) {
            row.iter_mut().zip(product).for_each(|(sum, x)| *sum += x / f64::from(n));
        }
    }
    (0..halvings).fold(sum, |root, _| multiplied(&root, &root))
}

fn identity() -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

fn multiplied(A: &[[f64; 4]; 4], B: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| A[i][k] * B[k][j]).sum()))
}
