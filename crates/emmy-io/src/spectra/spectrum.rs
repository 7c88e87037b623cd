//! A spectrum of columns, by its kind.

use std::path::Path;

use emmy::internals::number::short;
use serde_json::Value;

use super::samples::{self, Samples, Series};
use super::{Detrend, Frequencies, Segments, SpectrumError, Window};
use super::{amplitudes, derivative, frequency_response, power_spectral_density, shock_response};
use crate::comparison;
use crate::units::Units;

/// The kind of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// Power spectral density, the default.
    #[default]
    Density,
    /// Amplitudes of sines.
    Amplitude,
    /// Frequency response to an input: amplitude, phase, coherence.
    Response,
    /// Amplitude of the frequency response, and coherence.
    Transmissibility,
    /// Shock response.
    Shock,
}

impl Kind {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Kind); 5] = [
        ("psd", Kind::Density),
        ("amplitude", Kind::Amplitude),
        ("frf", Kind::Response),
        ("transmissibility", Kind::Transmissibility),
        ("srs", Kind::Shock),
    ];

    /// Heading of its page.
    pub(super) fn title(self) -> &'static str {
        match self {
            Kind::Density => "Power spectral density",
            Kind::Amplitude => "Amplitudes",
            Kind::Response => "Frequency response",
            Kind::Transmissibility => "Transmissibility",
            Kind::Shock => "Shock response spectrum",
        }
    }

    /// Whether it needs an input.
    pub fn has_input(self) -> bool {
        matches!(self, Kind::Response | Kind::Transmissibility)
    }
}

/// Number of frequencies of a shock response spectrum.
const N_SHOCK: usize = 120;

/// Samples in a period, from which on the peaks of a shock response are missed by less than 5 %.
const SAMPLES_PER_PERIOD: f64 = 10.0;

/// How a spectrum is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Its kind.
    pub kind: Kind,
    /// Number of derivatives in time that are taken first.
    pub derivative: usize,
    /// Distance of the samples; `None`: that of the series.
    pub step: Option<f64>,
    /// The window.
    pub window: Window,
    /// Samples of a segment; `None`: 256, or all for [`Kind::Amplitude`].
    pub segment: Option<usize>,
    /// Samples that segments share; `None`: half a segment.
    pub overlap: Option<usize>,
    /// The part that is taken out of each segment.
    pub detrend: Detrend,
    /// Frequencies of a shock response spectrum \[1/time\]; `None`: 120 in equal ratios from 1/(N h) to 1/(10 h).
    pub frequencies: Option<Vec<f64>>,
    /// Quality factor of its oscillators.
    pub q: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            kind: Kind::Density,
            derivative: 0,
            step: None,
            window: Window::Hann,
            segment: None,
            overlap: None,
            detrend: Detrend::Constant,
            frequencies: None,
            q: 10.0,
        }
    }
}

/// A spectrum of some columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Its kind.
    pub kind: Kind,
    /// Frequencies \[1/time\].
    pub frequencies: Vec<f64>,
    /// Name and numbers of each column beside the frequency; NaN where there is none.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Whether the input has at least a thousandth of its largest power at each frequency; empty without an input.
    pub has_power: Vec<bool>,
    /// Remarks.
    pub notes: Vec<String>,
    /// Units of the run.
    pub units: Units,
    /// The settings, in words.
    pub caption: String,
    /// Unit of the columns and of their derivatives, if the run has units and all have the same.
    pub unit: Option<String>,
}

impl Settings {
    /// The spectrum of columns of a run, with an input if the kind has one.
    ///
    /// # Errors
    /// [`SpectrumError`].
    pub fn of_run(
        &self,
        directory: &Path,
        columns: &[String],
        input: Option<&str>,
        between: [Option<f64>; 2],
    ) -> Result<Spectrum, SpectrumError> {
        let names: Vec<&str> = columns.iter().map(String::as_str).chain(input).collect();
        let series = samples::read(directory, &names, between)?;
        // A run whose summary cannot be read has no units.
        let units = comparison::units_of(&comparison::summary(directory).unwrap_or_default());
        let known = samples::known_columns(directory);
        let unit = samples::common(&known, columns, "unit").map(|unit| self.of_derivative(unit, units));
        let mut spectrum = Spectrum { units, unit, ..self.of_series(&series, columns)? };
        if self.kind == Kind::Shock {
            spectrum.notes.extend(self.on_accelerations(&known, columns));
        }
        Ok(spectrum)
    }

    /// Remarks on columns that are no accelerations, as far as their dimensions are known.
    fn on_accelerations(&self, known: &[Value], columns: &[String]) -> Vec<String> {
        if known.is_empty() {
            let note = "the columns are taken as accelerations; --derivative takes those of others";
            return if self.derivative == 0 { vec![note.to_string()] } else { Vec::new() };
        }
        let note = |column: &String| {
            let dimension = known.iter().find(|own| own["column"] == **column)?["dimension"].as_str()?;
            let needed = ["length/time²", "length/time", "length"].iter().position(|own| *own == dimension);
            match needed {
                Some(n) if n == self.derivative => None,
                Some(n) => Some(format!("`{column}` is no acceleration: it needs --derivative {n}")),
                None => {
                    Some(format!("`{column}` is no motion: its shock response is that of no acceleration"))
                }
            }
        };
        columns.iter().filter_map(note).collect()
    }

    /// The settings for a record of n samples, in words.
    fn caption(&self, n: usize) -> String {
        let derivative = match self.derivative {
            0 => String::new(),
            n => format!("derivative {n}, "),
        };
        let name = Window::ALL.iter().find(|(_, window)| *window == self.window).map_or("", |own| own.0);
        match (self.kind, self.segments(n)) {
            (Kind::Shock, _) => format!("{derivative}maximax of oscillators with Q = {}", short(self.q)),
            (_, Ok(Segments { length, .. })) => {
                format!("{derivative}window {name}, segments of {length} of {n} samples")
            }
            (_, Err(_)) => derivative,
        }
    }

    /// The unit of derivatives of columns with a unit.
    fn of_derivative(&self, unit: String, units: Units) -> String {
        let time = units.system().map_or(String::new(), |system| system.unit("time"));
        match self.derivative {
            0 => unit,
            1 => format!("{unit}/{time}"),
            2 => format!("{unit}/{time}²"),
            n => format!("{unit}/{time}^{n}"),
        }
    }

    /// The spectrum of series with names; a further series without a name is the input.
    ///
    /// # Errors
    /// [`SpectrumError`].
    ///
    /// ```
    /// use emmy_io::spectra::{Kind, Series, Settings};
    /// let time: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
    /// let values = vec![time.iter().map(|t| 3.0 * (std::f64::consts::TAU * t).cos()).collect()];
    /// let settings = Settings { kind: Kind::Amplitude, ..Settings::default() };
    /// let spectrum = settings.of_series(&Series { time, values }, &["x".to_string()])?;
    /// let (name, amplitudes) = &spectrum.columns[0];
    /// assert!(name == "x_amplitude" && (amplitudes[10] - 3.0).abs() < 1e-12);
    /// # Ok::<(), emmy_io::spectra::SpectrumError>(())
    /// ```
    pub fn of_series(&self, series: &Series, names: &[String]) -> Result<Spectrum, SpectrumError> {
        let Samples { step, mut values, is_interpolated } = series.sampled(self.step)?;
        for values in &mut values {
            (0..self.derivative).for_each(|_| *values = derivative(values, step));
        }
        let mut notes = Vec::new();
        if is_interpolated && self.step.is_none() {
            notes.push(format!(
                "the steps differ: the columns are interpolated at distances of {}",
                short(step)
            ));
        }
        let mut spectrum = Spectrum {
            kind: self.kind,
            frequencies: Vec::new(),
            columns: Vec::new(),
            has_power: Vec::new(),
            notes,
            units: Units::default(),
            caption: self.caption(values[0].len()),
            unit: None,
        };
        match self.kind {
            Kind::Shock => self.shock(step, names, &values, &mut spectrum)?,
            _ => self.averaged(step, names, &values, &mut spectrum)?,
        }
        Ok(spectrum)
    }

    /// The segments of a record of n samples.
    fn segments(&self, n: usize) -> Result<Segments, SpectrumError> {
        let length = self.segment.unwrap_or(if self.kind == Kind::Amplitude { n } else { 256.min(n) });
        if length > n {
            let reason = format!("segments of {length} samples are longer than the record, which has {n}");
            return Err(SpectrumError::Segments { reason });
        }
        Ok(Segments { window: self.window, length, overlap: self.overlap, detrend: self.detrend })
    }

    fn averaged(
        &self,
        step: f64,
        names: &[String],
        values: &[Vec<f64>],
        spectrum: &mut Spectrum,
    ) -> Result<(), SpectrumError> {
        let segments = self.segments(values[0].len())?;
        for (name, record) in names.iter().zip(values) {
            let mut add =
                |ending: &str, numbers| spectrum.columns.push((format!("{name}_{ending}"), numbers));
            spectrum.frequencies = match self.kind {
                Kind::Amplitude => {
                    let (frequencies, amplitudes) = amplitudes(record, step, &segments)?;
                    add("amplitude", amplitudes);
                    frequencies
                }
                Kind::Response | Kind::Transmissibility => {
                    let found = frequency_response(&values[values.len() - 1], record, step, &segments)?;
                    if self.kind == Kind::Response {
                        add("amplitude", found.amplitudes());
                        add("phase", found.phases());
                    } else {
                        add("transmissibility", found.amplitudes());
                    }
                    add("coherence", found.coherence);
                    spectrum.has_power = found.power.iter().map(|own| *own >= POWER).collect();
                    found.frequencies
                }
                Kind::Density | Kind::Shock => {
                    let (frequencies, density) = power_spectral_density(record, step, &segments)?;
                    add("psd", density);
                    frequencies
                }
            };
        }
        if self.kind.has_input() && segments.length == values[0].len() {
            let note = "one segment alone: its coherence is 1 everywhere, and says nothing";
            spectrum.notes.push(note.to_string());
        }
        let n = values[0].len();
        let is_whole = segments.length == n && self.window == Window::Boxcar && self.detrend == Detrend::None;
        if self.kind.has_input() && !is_whole && dies_out(&values[values.len() - 1]) {
            spectrum.notes.push(format!(
                "the input dies out: such a transient is distorted, unless one segment of all {n} samples has the window \
                 `boxcar` and keeps its trend (detrend `none`)"
            ));
        }
        Ok(())
    }

    fn shock(
        &self,
        step: f64,
        names: &[String],
        values: &[Vec<f64>],
        spectrum: &mut Spectrum,
    ) -> Result<(), SpectrumError> {
        let duration = values[0].len() as f64 * step;
        let highest = 1.0 / (SAMPLES_PER_PERIOD * step);
        let all = Frequencies {
            start: (1.0 / duration).min(0.1 * highest),
            stop: highest,
            count: N_SHOCK,
            is_log: Some(true),
        };
        let frequencies = self.frequencies.clone().unwrap_or_else(|| all.values(true));
        for (name, record) in names.iter().zip(values) {
            let found = shock_response(record, step, &frequencies, self.q)?;
            for (quantity, of) in [("acceleration", 0), ("displacement", 1)] {
                let peaks = || found.iter().map(move |own| [own.acceleration, own.displacement][of]);
                let mut add = |ending: &str, numbers| {
                    spectrum.columns.push((format!("{name}_{quantity}_{ending}"), numbers));
                };
                add("maximax", peaks().map(|own| own.maximax()).collect());
                add("positive", peaks().map(|own| own.positive).collect());
                add("negative", peaks().map(|own| own.negative).collect());
            }
        }
        if frequencies.iter().any(|f| *f > highest * (1.0 + 1e-9)) {
            let note = format!(
                "frequencies above {} have fewer than {SAMPLES_PER_PERIOD} samples in a period: peaks may be missed by more \
                 than 5 %",
                short(highest)
            );
            spectrum.notes.push(note);
        }
        spectrum.frequencies = frequencies;
        Ok(())
    }
}

/// Power of an input below which a quotient says little, as a part of the largest.
const POWER: f64 = 1e-3;

/// Whether the last quarter of a record is as good as zero.
fn dies_out(record: &[f64]) -> bool {
    let peak = |part: &[f64]| part.iter().fold(0f64, |peak, x| peak.max(x.abs()));
    peak(&record[record.len() - record.len() / 4..]) <= 1e-2 * peak(record)
}
