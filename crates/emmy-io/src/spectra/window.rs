//! Windows of segments.

use std::f64::consts::TAU;

/// A periodic window, as `scipy.signal.get_window` has it.
///
/// ```
/// use emmy_io::spectra::Window;
/// let weights = Window::Hann.weights(4);
/// assert!(weights.iter().zip([0.0, 0.5, 1.0, 0.5]).all(|(w, exact)| (w - exact).abs() < 1e-15));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Window {
    /// `(1 - cos x)/2`, the default.
    #[default]
    Hann,
    /// 1 everywhere.
    Boxcar,
    /// A window with an error of up to 0.12 % in amplitudes between two frequencies of the transform.
    FlatTop,
    /// Blackman's.
    Blackman,
}

impl Window {
    /// All windows with their names.
    pub const ALL: [(&'static str, Window); 4] = [
        ("hann", Window::Hann),
        ("boxcar", Window::Boxcar),
        ("flattop", Window::FlatTop),
        ("blackman", Window::Blackman),
    ];

    /// Coefficients a of `sum_k (-1)^k a_k cos(k x)`.
    fn coefficients(self) -> &'static [f64] {
        match self {
            Window::Hann => &[0.5, 0.5],
            Window::Boxcar => &[1.0],
            Window::FlatTop => &[0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368],
            Window::Blackman => &[0.42, 0.5, 0.08],
        }
    }

    /// Weights at the n samples of a segment, `x = 2 pi i/n`.
    pub fn weights(self, n: usize) -> Vec<f64> {
        if n == 1 {
            return vec![1.0];
        }
        let weight = |i: usize| {
            let x = TAU * i as f64 / n as f64;
            let terms = self.coefficients().iter().enumerate();
            terms
                .map(|(k, a)| if k % 2 == 0 { a * (k as f64 * x).cos() } else { -a * (k as f64 * x).cos() })
                .sum()
        };
        (0..n).map(weight).collect()
    }
}
