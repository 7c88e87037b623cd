//! `emmy spectrum DIR --column C`: spectra of columns of a run.

use std::path::PathBuf;

use clap::Args;
use emmy_io::report;
use emmy_io::spectra::{self, Detrend, Frequencies, Kind, Settings, Spectrum, SpectrumError, Window};

use super::{named, with_ending};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print::{self, columns, number};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output directory of a run
    directory: PathBuf,
    /// Column of history.csv (repeatable)
    #[arg(long, value_name = "C", required = true)]
    column: Vec<String>,
    /// Power spectral density, amplitudes, frequency response or transmissibility from --input, or shock response
    #[arg(long, value_name = "KIND", default_value = "psd", value_parser = named(&Kind::ALL))]
    kind: Kind,
    /// Column that is the input of `frf` and `transmissibility`
    #[arg(long, value_name = "C")]
    input: Option<String>,
    /// Take the N-th derivative in time, by central differences
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
    derivative: u8,
    /// Time from which on samples are taken
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    from: Option<f64>,
    /// Time up to which samples are taken
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Distance of the samples, between which columns are interpolated [default: the step of the run, or the median of
    /// its steps]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Window of the segments
    #[arg(long, value_name = "NAME", default_value = "hann", value_parser = named(&Window::ALL))]
    window: Window,
    /// Samples of a segment [default: 256, or all of a shorter run; with `amplitude` all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    segment: Option<u32>,
    /// Samples that a segment shares with the next one [default: half a segment]
    #[arg(long, value_name = "N")]
    overlap: Option<u32>,
    /// Trend that is taken out of each segment
    #[arg(long, value_name = "NAME", default_value = "constant", value_parser = named(&Detrend::ALL))]
    detrend: Detrend,
    /// Frequencies of `srs`, A:B:N in equal ratios, A:B:N:linear at equal distances
    #[arg(long, value_name = "A:B:N", allow_hyphen_values = true)]
    frequencies: Option<Frequencies>,
    /// Quality factor 1/(2 zeta) of the oscillators of `srs`
    #[arg(long, value_name = "Q", default_value_t = 10.0, allow_negative_numbers = true)]
    q: f64,
    /// Output directory [default: the directory of the run, with `-spectrum` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// No messages on standard error
    #[arg(long)]
    quiet: bool,
}

/// Computes and writes the spectrum.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let Arguments { directory, column, input, .. } = arguments;
    check(arguments)?;
    let output =
        arguments.output.clone().unwrap_or_else(|| match (directory.file_name(), directory.canonicalize()) {
            // `.` has no name to which an ending could be added.
            (None, Ok(named)) => with_ending(&named, "-spectrum"),
            _ => with_ending(directory, "-spectrum"),
        });
    spectra::check(&output)?;
    let between = [arguments.from, arguments.to];
    let spectrum = arguments.settings().of_run(directory, column, input.as_deref(), between)?;
    let run = directory.canonicalize().unwrap_or_else(|_| directory.clone());
    let run = run.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    spectra::write(&output, &run, &spectrum)?;
    print::result(host, &table(&spectrum))?;
    if !arguments.quiet {
        spectrum.notes.iter().for_each(|note| message!(host, "note: {note}"));
        message!(host, "written: {}", output.join(spectra::TABLE).display());
        message!(host, "to look at: {}", output.join(report::PAGE).display());
    }
    Ok(())
}

/// Checks that flags fit each other.
fn check(arguments: &Arguments) -> Result<(), Failure> {
    let usage = |message: &str, help: &str| {
        Err(Failure::Usage { message: message.to_string(), help: Some(help.to_string()) })
    };
    match (arguments.kind.has_input(), &arguments.input) {
        (true, None) => usage("this kind needs an input", "--input names the column that excites the others"),
        (false, Some(_)) => usage("--input has no effect", "take --kind frf or transmissibility with it"),
        _ if arguments.kind != Kind::Shock && arguments.frequencies.is_some() => {
            usage("--frequencies has no effect", "the segments set the frequencies of all kinds but `srs`")
        }
        _ => Ok(()),
    }
}

impl Arguments {
    fn settings(&self) -> Settings {
        Settings {
            kind: self.kind,
            derivative: self.derivative.into(),
            step: self.step,
            window: self.window,
            segment: self.segment.map(|n| n as usize),
            overlap: self.overlap.map(|n| n as usize),
            detrend: self.detrend,
            frequencies: self.frequencies.map(|frequencies| frequencies.values(true)),
            q: self.q,
        }
    }
}

/// The largest number of each column with its frequency, where the input has power; phases and coherences have none of
/// interest.
fn table(spectrum: &Spectrum) -> String {
    let frequency = spectrum.units.label("frequency", "frequency");
    let head = vec!["largest of".to_string(), "value".to_string(), frequency];
    let shown = |name: &str| !["_phase", "_coherence"].iter().any(|ending| name.ends_with(ending));
    let rows = spectrum.columns.iter().filter(|(name, _)| shown(name)).map(|(name, numbers)| {
        let numbered = numbers.iter().zip(&spectrum.frequencies).enumerate();
        let has_power = |row: usize| spectrum.has_power.get(row).is_none_or(|has| *has);
        let numbered = numbered.filter(|(row, (value, _))| has_power(*row) && !value.is_nan());
        let largest = numbered.map(|(_, pair)| pair).max_by(|(a, _), (b, _)| a.total_cmp(b));
        let cells =
            largest.map_or(["-".to_string(), "-".to_string()], |(value, f)| [number(*value), number(*f)]);
        [name.clone()].into_iter().chain(cells).collect()
    });
    columns(std::iter::once(head).chain(rows).collect())
}

impl From<SpectrumError> for Failure {
    fn from(error: SpectrumError) -> Self {
        let message = error.to_string();
        match error {
            SpectrumError::NoColumn { nearest, .. } => {
                let help = nearest.map(|name| format!("did you mean `{name}`?"));
                Failure::Files { message, help }
            }
            SpectrumError::Short { .. } => {
                let help = "take a longer run, or other times by --from and --to";
                Failure::Usage { message, help: Some(help.to_string()) }
            }
            SpectrumError::Gap { .. } => {
                let help = "--from and --to choose times at which it has numbers";
                Failure::Files { message, help: Some(help.to_string()) }
            }
            SpectrumError::Run(_) | SpectrumError::History(_) => Failure::Files { message, help: None },
            _ => Failure::Usage { message, help: None },
        }
    }
}
