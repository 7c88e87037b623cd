//! Spectra of a finished run: power spectral density, frequency response, amplitudes and shock response of columns.
//!
//! All take samples at equal distances in time, `step`. Averages over segments are those of SciPy's `signal.welch` and
//! `signal.csd`; the shock response spectrum is that of ISO 18431-4.

mod files;
mod frequencies;
mod samples;
mod shock;
mod spectrum;
mod welch;
mod window;

use std::path::PathBuf;

pub use files::{TABLE, check, write};
pub(crate) use files::{over_frequency, table};
pub use frequencies::Frequencies;
pub use samples::{Samples, Series, derivative};
pub use shock::{Peaks, ShockResponse, shock_response};
pub use spectrum::{Kind, Settings, Spectrum};
pub use welch::{
    Detrend, FrequencyResponse, Segments, amplitudes, frequency_response, power_spectral_density,
};
pub use window::Window;

use crate::comparison::RunError;
use crate::history::HistoryError;

/// Why there is no spectrum.
#[derive(Debug, thiserror::Error)]
pub enum SpectrumError {
    /// The run cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Its history cannot be read.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// It has no such column.
    #[error("{path}: there is no column `{column}`")]
    NoColumn {
        /// The history.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// The most similar name.
        nearest: Option<String>,
    },
    /// A number is missing inside a column.
    #[error("{path}: the column `{column}` has no number at the time {time}")]
    Gap {
        /// The history.
        path: PathBuf,
        /// Name of the column.
        column: String,
        /// Time of the row.
        time: f64,
    },
    /// There are too few samples.
    #[error("there are {n} samples, but {least} are needed")]
    Short {
        /// Number of samples.
        n: usize,
        /// Number that is needed.
        least: usize,
    },
    /// Segments that samples do not fill, or that do not advance.
    #[error("{reason}")]
    Segments {
        /// The reason.
        reason: String,
    },
    /// A number that must be positive.
    #[error("{name} is {value}, but must be a positive number")]
    NotPositive {
        /// Its name.
        name: &'static str,
        /// The number.
        value: f64,
    },
    /// Times that do not grow.
    #[error("times must grow, but {after} follows {before}")]
    Times {
        /// A time.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// Series of different lengths.
    #[error("the input has {input} samples, the response {response}")]
    Lengths {
        /// Samples of the input.
        input: usize,
        /// Samples of the response.
        response: usize,
    },
}

/// Checks that a number is positive and finite.
fn positive(name: &'static str, value: f64) -> Result<f64, SpectrumError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(SpectrumError::NotPositive { name, value }),
    }
}
