//! Averages over segments, by Welch (1967), IEEE Trans. Audio Electroacoust. 15, 70-73.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

use super::window::Window;
use super::{SpectrumError, positive};

/// The part of a segment that is taken out before its transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detrend {
    /// Its mean, the default.
    #[default]
    Constant,
    /// Its straight line of least squares.
    Linear,
    /// Nothing.
    None,
}

impl Detrend {
    /// All with their names.
    pub const ALL: [(&'static str, Detrend); 3] =
        [("constant", Detrend::Constant), ("linear", Detrend::Linear), ("none", Detrend::None)];

    /// Takes it out of a segment.
    fn apply(self, segment: &mut [f64]) {
        let n = segment.len() as f64;
        let mean = segment.iter().sum::<f64>() / n;
        let centre = 0.5 * (n - 1.0);
        let moment = |segment: &[f64]| -> f64 {
            segment.iter().enumerate().map(|(i, x)| (i as f64 - centre) * (x - mean)).sum()
        };
        let slope = match self {
            Detrend::None => return,
            Detrend::Constant => 0.0,
            // The sum of (i - centre)^2 is n (n^2 - 1)/12.
            Detrend::Linear if segment.len() > 1 => moment(segment) * 12.0 / (n * (n * n - 1.0)),
            Detrend::Linear => 0.0,
        };
        segment.iter_mut().enumerate().for_each(|(i, x)| *x -= mean + slope * (i as f64 - centre));
    }
}

/// Segments over which spectra are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segments {
    /// The window.
    pub window: Window,
    /// Samples of a segment; a shorter record is one segment.
    pub length: usize,
    /// Samples that a segment shares with the next one; `None`: half of it.
    pub overlap: Option<usize>,
    /// The part that is taken out of each segment.
    pub detrend: Detrend,
}

/// 256 samples that overlap by half, a Hann window, and the mean taken out: SciPy's.
impl Default for Segments {
    fn default() -> Self {
        Segments { window: Window::Hann, length: 256, overlap: None, detrend: Detrend::Constant }
    }
}

impl Segments {
    /// Samples of a segment, and from the start of one to the start of the next, in a record of n.
    fn sizes(&self, n: usize) -> Result<(usize, usize), SpectrumError> {
        if n == 0 || self.length == 0 {
            return Err(SpectrumError::Short { n: n.min(self.length), least: 1 });
        }
        let length = self.length.min(n);
        let overlap = self.overlap.unwrap_or(length / 2);
        if overlap >= length {
            let reason = format!("segments of {length} samples cannot overlap by {overlap}");
            return Err(SpectrumError::Segments { reason });
        }
        Ok((length, length - overlap))
    }

    /// Transforms of the windowed segments of a record, one by one to a function.
    fn for_each_transform(
        &self,
        records: [&[f64]; 2],
        mut take: impl FnMut([&[Complex64]; 2]),
    ) -> Result<(), SpectrumError> {
        let n = records[0].len();
        let (length, advance) = self.sizes(n)?;
        let weights = self.window.weights(length);
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let mut scratch = transform.make_scratch_vec();
        let mut outputs = [transform.make_output_vec(), transform.make_output_vec()];
        let is_one = std::ptr::eq(records[0], records[1]);
        for start in (0..=n - length).step_by(advance) {
            for (record, output) in records.iter().zip(&mut outputs).take(if is_one { 1 } else { 2 }) {
                let mut segment = record[start..start + length].to_vec();
                self.detrend.apply(&mut segment);
                segment.iter_mut().zip(&weights).for_each(|(x, w)| *x *= w);
                let done = transform.process_with_scratch(&mut segment, output, &mut scratch);
                done.map_err(|error| SpectrumError::Segments { reason: error.to_string() })?;
            }
            take([&outputs[0], if is_one { &outputs[0] } else { &outputs[1] }]);
        }
        Ok(())
    }

    /// Means of `X^* X`, `X^* Y` and `Y^* Y` over the segments of two records, one-sided: doubled but at 0 and, with an
    /// even length, at the last frequency.
    fn products(&self, x: &[f64], y: &[f64]) -> Result<Products, SpectrumError> {
        if x.len() != y.len() {
            return Err(SpectrumError::Lengths { input: x.len(), response: y.len() });
        }
        let (length, _) = self.sizes(x.len())?;
        let mut products = Products { length, own: Vec::new(), cross: Vec::new(), response: Vec::new() };
        let n = length / 2 + 1;
        products.own.resize(n, 0.0);
        products.response.resize(n, 0.0);
        products.cross.resize(n, Complex64::ZERO);
        let mut count = 0.0;
        self.for_each_transform([x, y], |[x, y]| {
            count += 1.0;
            for k in 0..n {
                products.own[k] += x[k].norm_sqr();
                products.response[k] += y[k].norm_sqr();
                products.cross[k] += x[k].conj() * y[k];
            }
        })?;
        for k in 0..n {
            let factor = if is_single(k, length) { 1.0 / count } else { 2.0 / count };
            products.own[k] *= factor;
            products.response[k] *= factor;
            products.cross[k] *= factor;
        }
        Ok(products)
    }
}

/// Whether the frequency k of a transform of n samples stands for itself alone, not also for a negative one.
fn is_single(k: usize, n: usize) -> bool {
    k == 0 || 2 * k == n
}

/// Means of products of transforms.
struct Products {
    length: usize,
    own: Vec<f64>,
    cross: Vec<Complex64>,
    response: Vec<f64>,
}

impl Products {
    fn frequencies(&self, step: f64) -> Vec<f64> {
        (0..self.own.len()).map(|k| k as f64 / (self.length as f64 * step)).collect()
    }
}

/// One-sided power spectral density of a record, `(frequencies, density)` \[1/time; unit² time\], as
/// `scipy.signal.welch`.
///
/// ```math
/// S_k = 2 h <|X_k|^2> / sum_i w_i^2
/// ```
///
/// # Errors
/// [`SpectrumError`] for a step that is not positive, no samples, or an overlap of whole segments.
///
/// ```
/// use emmy_io::spectra::{Detrend, Segments, Window, power_spectral_density};
/// let segments = Segments { window: Window::Boxcar, detrend: Detrend::None, ..Segments::default() };
/// // Four samples of sin(pi i/2): the mean square 1/2, in the band 1/(n h) around a quarter of the samples' frequency.
/// let (frequencies, density) = power_spectral_density(&[0.0, 1.0, 0.0, -1.0], 0.5, &segments)?;
/// assert!(frequencies == [0.0, 0.5, 1.0] && (density[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), emmy_io::spectra::SpectrumError>(())
/// ```
pub fn power_spectral_density(
    record: &[f64],
    step: f64,
    segments: &Segments,
) -> Result<(Vec<f64>, Vec<f64>), SpectrumError> {
    positive("the distance of the samples", step)?;
    let products = segments.products(record, record)?;
    let squares: f64 = segments.window.weights(products.length).iter().map(|w| w * w).sum();
    Ok((products.frequencies(step), products.own.iter().map(|power| power * step / squares).collect()))
}

/// Amplitude spectrum of a record, `(frequencies, amplitudes)`: a sine of amplitude A and a frequency of the transform
/// has A there.
///
/// ```math
/// A_k = 2 sqrt(<|X_k|^2>) / sum_i w_i
/// ```
///
/// without the 2 at the frequency 0 and, with segments of even length, at the last one.
///
/// # Errors
/// As [`power_spectral_density`].
///
/// ```
/// use emmy_io::spectra::{Segments, Window, amplitudes};
/// let wave: Vec<f64> = (0..40).map(|i| 1.0 + 3.0 * (0.2 * std::f64::consts::PI * f64::from(i)).sin()).collect();
/// let segments = Segments { length: 40, ..Segments::default() };
/// let (frequencies, amplitudes) = amplitudes(&wave, 0.1, &segments)?;
/// assert!((frequencies[4] - 1.0).abs() < 1e-15 && (amplitudes[4] - 3.0).abs() < 1e-14);
/// # Ok::<(), emmy_io::spectra::SpectrumError>(())
/// ```
pub fn amplitudes(
    record: &[f64],
    step: f64,
    segments: &Segments,
) -> Result<(Vec<f64>, Vec<f64>), SpectrumError> {
    positive("the distance of the samples", step)?;
    let products = segments.products(record, record)?;
    let sum: f64 = segments.window.weights(products.length).iter().sum();
    let amplitude = |(k, power): (usize, &f64)| {
        let doubled = if is_single(k, products.length) { *power } else { 2.0 * power };
        doubled.sqrt() / sum
    };
    let amplitudes = products.own.iter().enumerate().map(amplitude).collect();
    Ok((products.frequencies(step), amplitudes))
}

/// Power over its largest value up to which it is rounding.
const ROUNDING: f64 = 1e-26;

/// Frequency response of a record to another.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Frequencies \[1/time\].
    pub frequencies: Vec<f64>,
    /// `H_1 = S_xy/S_xx`, `[real, imaginary]`; NaN where the input has no power but rounding.
    pub gain: Vec<[f64; 2]>,
    /// Coherence, `|S_xy|^2/(S_xx S_yy)`, from 0 to 1; NaN where the input has no power but rounding, or the response
    /// none.
    pub coherence: Vec<f64>,
    /// Power of the input over the largest; NaN where it is rounding.
    pub power: Vec<f64>,
}

impl FrequencyResponse {
    /// Amplitudes of the gain.
    pub fn amplitudes(&self) -> Vec<f64> {
        self.gain.iter().map(|[re, im]| re.hypot(*im)).collect()
    }

    /// Phases of the gain, from -pi to pi.
    pub fn phases(&self) -> Vec<f64> {
        self.gain.iter().map(|[re, im]| im.atan2(*re)).collect()
    }
}

/// Frequency response `H_1 = S_xy/S_xx` of a record y to an input x, with `scipy.signal.csd` and `welch`, and their
/// coherence.
///
/// # Errors
/// As [`power_spectral_density`], and for records of different lengths.
///
/// ```
/// use emmy_io::spectra::{Segments, frequency_response};
/// let x: Vec<f64> = (0..64).map(|i| f64::from(i * i % 17)).collect();
/// let y: Vec<f64> = x.iter().map(|x| -2.0 * x).collect();
/// let found = frequency_response(&x, &y, 0.1, &Segments { length: 16, ..Segments::default() })?;
/// assert!((found.gain[3][0] + 2.0).abs() < 1e-14 && (found.coherence[3] - 1.0).abs() < 1e-14);
/// # Ok::<(), emmy_io::spectra::SpectrumError>(())
/// ```
pub fn frequency_response(
    input: &[f64],
    response: &[f64],
    step: f64,
    segments: &Segments,
) -> Result<FrequencyResponse, SpectrumError> {
    positive("the distance of the samples", step)?;
    let mut products = segments.products(input, response)?;
    let largest = products.own.iter().fold(0.0, |largest: f64, power| largest.max(*power));
    let floor = ROUNDING * largest;
    products.own.iter_mut().filter(|power| **power <= floor).for_each(|power| *power = f64::NAN);
    let own = products.cross.iter().zip(&products.own);
    let gain = own.map(|(cross, own)| [cross.re / own, cross.im / own]).collect();
    let all = products.cross.iter().zip(products.own.iter().zip(&products.response));
    let coherence = all.map(|(cross, (own, response))| cross.norm_sqr() / own / response).collect();
    let power = products.own.iter().map(|own| own / largest).collect();
    Ok(FrequencyResponse { frequencies: products.frequencies(step), gain, coherence, power })
}
