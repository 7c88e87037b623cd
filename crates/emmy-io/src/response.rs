//! Files of harmonic responses: `response.toml`, `response.csv`, `response_modes.csv` and a plot.

use std::io;
use std::path::Path;

use emmy::modes::{HarmonicResponse, Quantity};
use emmy::motion::ReferenceMotion;

use crate::chart::{Axis, Figure};
use crate::directory::{self, DirectoryError, Lock, MARK};
use crate::input::Problem;
use crate::spectra::{over_frequency, table};
use crate::whole_file::replace;

/// Kind of the directory, in messages.
const KIND: &str = "harmonic response";

/// The file by which the directory is recognized: the input.
const WITNESS: &str = "response.toml";

/// The table of amplitudes and phases.
pub const TABLE: &str = "response.csv";

/// The table of the modes.
const MODES: &str = "response_modes.csv";

/// Components without larger amplitudes, over the largest of all, are rounding and are not drawn.
const SMALLEST: f64 = 1e-9;

/// Amplitudes of the probes of a problem over the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeResponse {
    /// Frequencies \[1/time\].
    pub frequencies: Vec<f64>,
    /// The quantity.
    pub quantity: Quantity,
    /// Name of each component, such as `tip_x`, with its amplitudes and its phases \[rad\].
    pub components: Vec<(String, Vec<f64>, Vec<f64>)>,
}

impl ProbeResponse {
    /// The response at the probes of a problem, with the motion of the supports or relative to them; a probe that is
    /// seen from the base is relative to them in any case.
    pub fn new(
        problem: &Problem,
        response: &HarmonicResponse,
        frequencies: Vec<f64>,
        (quantity, is_relative): (Quantity, bool),
    ) -> Self {
        let mut components = Vec::new();
        let base = ReferenceMotion::of_base(&problem.body).ok();
        for probe in &problem.quantities.probes {
            let own = problem.quantities.reference_of_probe(probe);
            let is_relative = is_relative || own.is_some() && own == base.as_ref();
            let at = |f: &f64| {
                let omega = std::f64::consts::TAU * f;
                match is_relative {
                    true => response.relative(omega, probe.node, quantity),
                    false => response.absolute(omega, probe.node, quantity),
                }
            };
            let found: Vec<[[f64; 2]; 3]> = frequencies.iter().map(at).collect();
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let amplitudes = found.iter().map(|u| u[axis][0].hypot(u[axis][1])).collect();
                // The phase of 0 is 0, not pi or -pi by the signs of its zeros.
                let phases = found.iter().map(|u| (u[axis][1] + 0.0).atan2(u[axis][0] + 0.0)).collect();
                components.push((format!("{}_{letter}", probe.name), amplitudes, phases));
            }
        }
        ProbeResponse { frequencies, quantity, components }
    }

    /// The frequency at which the amplitude of a component is infinite, and the component.
    pub fn infinite(&self) -> Option<(f64, &str)> {
        self.components.iter().find_map(|(name, amplitudes, _)| {
            let at = amplitudes.iter().position(|amplitude| !amplitude.is_finite())?;
            Some((self.frequencies[at], name.as_str()))
        })
    }

    fn csv(&self) -> String {
        let names: Vec<[String; 2]> = self
            .components
            .iter()
            .map(|(name, ..)| [format!("{name}_amplitude"), format!("{name}_phase")])
            .collect();
        let mut columns: Vec<(&str, &[f64])> = vec![("frequency", &self.frequencies)];
        for ([amplitude, phase], (_, amplitudes, phases)) in names.iter().zip(&self.components) {
            columns.extend([(amplitude.as_str(), &amplitudes[..]), (phase.as_str(), &phases[..])]);
        }
        table(&columns)
    }

    fn figure(&self, problem: &Problem) -> Figure {
        let units = problem.units;
        let label = match self.quantity {
            Quantity::Displacement => units.label("amplitude of the displacement", "length"),
            Quantity::Velocity => units.label("amplitude of the velocity", "length/time"),
            Quantity::Acceleration => units.label("amplitude of the acceleration", "length/time²"),
        };
        let largest = |(_, amplitudes, _): &&(String, Vec<f64>, Vec<f64>)| {
            amplitudes.iter().fold(0.0f64, |largest, x| largest.max(*x))
        };
        let least = SMALLEST * self.components.iter().map(|own| largest(&own)).fold(0.0, f64::max);
        let shown = || self.components.iter().filter(|own| largest(own) > least);
        let amplitudes = shown().map(|(name, amplitudes, _)| (name.clone(), &amplitudes[..]));
        let phases = shown().map(|(name, _, phases)| (name.clone(), &phases[..]));
        let chart = over_frequency(&self.frequencies, units, false);
        let amplitudes = chart(Axis::log(label), &amplitudes.collect::<Vec<_>>());
        let phases = chart(Axis::linear("phase [rad]"), &phases.collect::<Vec<_>>());
        Figure { charts: vec![amplitudes, phases], columns: 1 }
    }
}

/// Checks that a response may be written into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check(directory: &Path, problem: &Problem) -> Result<(), DirectoryError> {
    directory::check_kind(directory, KIND, WITNESS)?;
    directory::check_sources(directory, &problem.files)
}

/// Writes a response into a directory, in place of an earlier one.
///
/// # Errors
/// [`DirectoryError`].
pub fn write(
    directory: &Path,
    problem: &Problem,
    response: &HarmonicResponse,
    probes: &ProbeResponse,
) -> Result<(), DirectoryError> {
    check(directory, problem)?;
    directory::prepare_kind(directory, KIND, WITNESS)?;
    let _lock = Lock::take(directory)?;
    let written = || -> io::Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let input = format!("{MARK} {version}: the input of this harmonic response.\n\n{}", problem.resolved);
        replace(&directory.join(WITNESS), input.as_bytes())?;
        probes.figure(problem).write(&directory.join("response"))?;
        replace(&directory.join(MODES), modes(response).as_bytes())?;
        replace(&directory.join(TABLE), probes.csv().as_bytes())
    };
    written().map_err(|error| DirectoryError::System { path: directory.to_path_buf(), error })
}

/// The table of the modes.
fn modes(response: &HarmonicResponse) -> String {
    let modes = response.modes();
    let numbers: Vec<f64> = (1..=modes.len()).map(|number| number as f64).collect();
    let frequencies: Vec<f64> = modes.iter().map(|mode| mode.angular_frequency).collect();
    table(&[
        ("mode", &numbers),
        ("angular_frequency", &frequencies),
        ("damping_ratio", &response.damping_ratios()),
        ("modal_force", response.modal_forces()),
    ])
}
