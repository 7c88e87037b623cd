//! `emmy response FILE`: harmonic response by modes.

use std::path::PathBuf;

use clap::Args;
use emmy::modes::{Excitation, HarmonicResponse, ModalDamping, Quantity, n_modes};
use emmy_io::input::{self, NOTHING_MOVES, Overrides, Problem};
use emmy_io::report::PAGE;
use emmy_io::response::{self, Component, Part, ProbeResponse};
use emmy_io::spectra::Frequencies;

use super::{modes, named, with_ending, with_threads};
use crate::failure::Failure;
use crate::host::{Host, message};
use crate::print::{self, columns, number};

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Input file (TOML)
    file: PathBuf,
    /// Frequencies in cycles per time: A:B:N at equal distances, A:B:N:log in equal ratios
    #[arg(long, value_name = "A:B:N", allow_hyphen_values = true)]
    frequencies: Frequencies,
    /// Shake the supports along an axis with an acceleration of amplitude 1, instead of the loads
    #[arg(long, value_name = "AXIS", value_parser = named(&AXES))]
    base: Option<[f64; 3]>,
    /// Number of a load that excites the body, from 0 (repeatable) [default: all]
    #[arg(long, value_name = "I", conflicts_with = "base")]
    load: Vec<usize>,
    /// Damping ratio of every mode, or one for each mode with commas, the last of which holds for all later ones
    /// [default: viscosity and drag of the input]
    #[arg(long, value_name = "Z", value_delimiter = ',', allow_negative_numbers = true, value_parser = ratio)]
    damping: Vec<f64>,
    /// Quantity of the motion [default: that of all probes, or the displacement if they differ]
    #[arg(long, value_name = "NAME", value_parser = named(&Quantity::ALL))]
    quantity: Option<Quantity>,
    /// With --base: motion relative to the base
    #[arg(long, requires = "base")]
    relative: bool,
    /// Number of modes, the lowest first [default: 10, or all of a smaller body]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    count: Option<u32>,
    /// Output directory [default: the directory of the input, with `-response` added]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Change a value of the input, such as region.0.density=2.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Number of threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No messages on standard error
    #[arg(long)]
    quiet: bool,
}

/// Directions of the base.
const AXES: [(&str, [f64; 3]); 3] = [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])];

/// Computes, prints and writes the response.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    with_threads(arguments.threads, host, || run_here(arguments, host))?
}

fn run_here(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    let overrides = Overrides { set: arguments.set.clone(), ..Overrides::default() };
    let problem = input::read(&arguments.file, &overrides)?;
    let output = &arguments.output;
    let output = output.clone().unwrap_or_else(|| with_ending(&problem.output.directory, "-response"));
    response::check(&output, &problem)?;
    let excitation = arguments.excitation(&problem)?;
    if problem.quantities.probes.is_empty() {
        let message = "the input has no probe, so there is no place for a response".to_string();
        let help = "add `probes = [{ name = \"tip\", point = [0, 0, 0] }]` to [output]";
        return Err(Failure::Usage { message, help: Some(help.to_string()) });
    }
    let state = problem.state_of_vibration()?;
    let count = modes::n_wanted(&problem.body, arguments.count);
    let damping = match arguments.damping[..] {
        [] => ModalDamping::OfBody,
        _ => ModalDamping::Ratios(arguments.damping.clone()),
    };
    let found = HarmonicResponse::new(&problem.body, state.as_ref(), count, &damping, &excitation);
    let found = found.map_err(|error| modes::failure(error, arguments.count.is_some()))?;
    let frequencies = arguments.frequencies.values(false);
    let quantity = arguments.quantity.unwrap_or_else(|| response::quantity_of_probes(&problem));
    let probes = ProbeResponse::new(&problem, &found, frequencies, (quantity, arguments.relative));
    let probes = probes.map_err(|error| modes::failure(error, arguments.count.is_some()))?;
    if let Some((f, name)) = probes.infinite() {
        let message = format!("the amplitude of `{name}` is infinite at the frequency {}", number(f));
        let help =
            "a mode without damping is excited at its own frequency: give --damping, or other frequencies";
        return Err(Failure::Usage { message, help: Some(help.to_string()) });
    }
    let caption = arguments.caption(&problem, &found, &probes);
    response::write(&output, &problem, &found, &probes, &caption)?;
    print::result(host, &table(&problem, &probes))?;
    if !arguments.quiet {
        let notes = response::notes(&problem);
        let of_input = problem.notes.iter().filter(|note| *note != NOTHING_MOVES);
        of_input.chain(&notes).for_each(|note| message!(host, "note: {note}"));
        remarks(&problem, &found, &probes, host);
        if let Some(ratio) = arguments.damping.iter().find(|ratio| **ratio >= 1.0) {
            message!(host, "note: a damping ratio of {ratio} is not below the critical one, 1; 2 % is 0.02");
        }
        message!(host, "{caption}");
        message!(host, "written: {}", output.join(response::TABLE).display());
        message!(host, "to look at: {}", output.join(PAGE).display());
    }
    Ok(())
}

impl Arguments {
    /// Excitation, modes and damping, in words.
    fn caption(&self, problem: &Problem, found: &HarmonicResponse, probes: &ProbeResponse) -> String {
        let excitation = match (self.base, &self.load[..]) {
            (Some(direction), _) => {
                let axis = AXES.iter().find(|(_, own)| *own == direction).map_or("", |(name, _)| name);
                format!("base along {axis}, {}", problem.units.number(1.0, "length/time²"))
            }
            (None, []) => "all loads at factor 1".to_string(),
            (None, numbers) => format!("loads {} at factor 1", listed(numbers)),
        };
        let damping = match &self.damping[..] {
            [] => "damping of the input".to_string(),
            ratios => format!("damping ratio {}", listed(ratios)),
        };
        let relative = match &probes.relative[..] {
            [] => String::new(),
            names => format!("; relative to the base: {}", names.join(", ")),
        };
        let n = found.modes().len();
        format!("{excitation}; {n} mode{}, {damping}{relative}", if n == 1 { "" } else { "s" })
    }

    fn excitation(&self, problem: &Problem) -> Result<Excitation, Failure> {
        let n_loads = problem.body.load_resultants().len();
        let missing =
            |message: String, help: &str| Err(Failure::Usage { message, help: Some(help.to_string()) });
        match (self.base, &self.load[..]) {
            (Some(acceleration), _) => Ok(Excitation::Base(acceleration)),
            (None, []) if n_loads == 0 => missing(
                "the input has no load to excite the body".to_string(),
                "--base z shakes the supports",
            ),
            (None, []) => Ok(Excitation::Loads((0..n_loads).collect())),
            (None, numbers) => match numbers.iter().find(|number| **number >= n_loads) {
                Some(number) => {
                    let help = format!("its loads have the numbers 0 to {}", n_loads.saturating_sub(1));
                    let help = if n_loads == 0 { "--base z shakes the supports".to_string() } else { help };
                    missing(format!("--load: the input has no load with the number {number}"), &help)
                }
                None => Ok(Excitation::Loads(numbers.to_vec())),
            },
        }
    }
}

/// A damping ratio.
fn ratio(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a number: a ratio of 2 % is written 0.02"))
}

/// The largest amplitude of each component, with its frequency.
fn table(problem: &Problem, probes: &ProbeResponse) -> String {
    let units = problem.units;
    let frequency = units.label("frequency", "frequency");
    let rows = probes.parts().into_iter().flat_map(|Part { name, dimension, components }| {
        let head = vec![format!("largest {name} of"), units.label("amplitude", dimension), frequency.clone()];
        let row = |own: &Component| {
            let numbers = own.amplitudes.iter().zip(&probes.frequencies);
            let largest = numbers.max_by(|(a, _), (b, _)| a.total_cmp(b));
            let cells = largest.map(|(value, f)| [number(*value), number(*f)]).into_iter().flatten();
            std::iter::once(own.name.clone()).chain(cells).collect()
        };
        std::iter::once(head).chain(components.into_iter().map(row)).collect::<Vec<_>>()
    });
    columns(rows.collect())
}

fn listed(values: &[impl ToString]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Remarks on the modes.
fn remarks(problem: &Problem, found: &HarmonicResponse, probes: &ProbeResponse, host: &dyn Host) {
    let highest = found.modes().last().map_or(0.0, |mode| mode.frequency());
    let last = probes.frequencies.last().copied().unwrap_or(0.0);
    if highest < last && found.modes().len() < n_modes(&problem.body) {
        let highest = problem.units.number(highest, "frequency");
        message!(
            host,
            "note: the highest mode has a frequency of {highest}: a larger --count has resonances beyond it"
        );
    }
    if found.damping_rates().iter().all(|rate| *rate == 0.0) {
        message!(host, "note: there is no damping: --damping 0.02 gives every mode 2 %");
    }
}
