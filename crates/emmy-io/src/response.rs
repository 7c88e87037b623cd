//! Files of harmonic responses: `response.toml`, `response.csv`, `response_modes.csv` and a plot.

use std::cell::LazyCell;
use std::io;
use std::path::Path;

use emmy::body::{FieldName, Fields};
use emmy::modes::{HarmonicResponse, Quantity};
use emmy::motion::ReferenceMotion;

use crate::chart::{Axis, Figure};
use crate::directory::{self, DirectoryError, Lock, MARK};
use crate::input::{ProbeQuantity, Problem};
use crate::message::shown;
use crate::report::{Curves, write_curves};
use crate::spectra::{over_frequency, table};
use crate::units::Units;
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
    /// The quantity of the motion.
    pub quantity: Quantity,
    /// The motion of each probe.
    pub motion: Vec<Component>,
    /// The stresses that probes ask for.
    pub stresses: Vec<Component>,
    /// Names of the probes whose motion is relative to the base.
    pub relative: Vec<String>,
}

/// Components of one dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct Part<'a> {
    /// The quantity, in words.
    pub name: String,
    /// Its dimension.
    pub dimension: &'static str,
    /// Components, without those that are rounding beside the others.
    pub components: Vec<&'a Component>,
}

/// A component over the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Name, such as `tip_x` or `tip_cauchy_stress_xx`.
    pub name: String,
    /// Amplitudes.
    pub amplitudes: Vec<f64>,
    /// Phases before the excitation \[rad\].
    pub phases: Vec<f64>,
}

impl<'a> Part<'a> {
    fn new(name: &str, dimension: &'static str, all: &'a [Component]) -> Self {
        let least = SMALLEST * all.iter().map(Component::largest).fold(0.0, f64::max);
        let components = all.iter().filter(|own| own.largest() >= least).collect();
        Part { name: name.to_string(), dimension, components }
    }
}

impl Component {
    fn new(name: String, numbers: impl Iterator<Item = [f64; 2]> + Clone) -> Self {
        let amplitudes = numbers.clone().map(|[re, im]| re.hypot(im)).collect();
        // The phase of 0 is 0, not pi or -pi by the signs of its zeros.
        let phases = numbers.map(|[re, im]| (im + 0.0).atan2(re + 0.0)).collect();
        Component { name, amplitudes, phases }
    }

    fn largest(&self) -> f64 {
        self.amplitudes.iter().fold(0.0, |largest, x| largest.max(*x))
    }
}

impl ProbeResponse {
    /// The response at the probes of a problem, with the motion of the supports or relative to them; a probe that is
    /// seen from the base is relative to them in any case. Stresses are those that probes ask for.
    ///
    /// # Errors
    /// As [`HarmonicResponse::stress`].
    pub fn new(
        problem: &Problem,
        response: &HarmonicResponse,
        frequencies: Vec<f64>,
        (quantity, is_relative): (Quantity, bool),
    ) -> emmy::Result<Self> {
        let (mut motion, mut stresses, mut relative) = (Vec::new(), Vec::new(), Vec::new());
        let omegas: Vec<f64> = frequencies.iter().map(|f| std::f64::consts::TAU * f).collect();
        let base = ReferenceMotion::of_base(&problem.body).ok();
        let fields = LazyCell::new(|| Fields::new(&problem.body));
        for probe in &problem.quantities.probes {
            let own = problem.quantities.reference_of_probe(probe);
            let is_relative = is_relative || own.is_some() && own == base.as_ref();
            if is_relative {
                relative.push(probe.name.clone());
            }
            let at = |omega: &f64| match is_relative {
                true => response.relative(*omega, probe.node, quantity),
                false => response.absolute(*omega, probe.node, quantity),
            };
            let found: Vec<[[f64; 2]; 3]> = omegas.iter().map(at).collect();
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let name = format!("{}_{letter}", probe.name);
                motion.push(Component::new(name, found.iter().map(|numbers| numbers[axis])));
            }
            for field in probe.fields().filter(|field| is_harmonic(*field)) {
                let node = probe.selection(&problem.body, &fields, probe.node);
                let change = response.stress(&fields, &node, field)?;
                let found: Vec<_> =
                    omegas.iter().map(|omega| response.stress_amplitudes(*omega, &change)).collect();
                for (place, letters) in field.components().iter().enumerate() {
                    let name = format!("{}_{field}_{letters}", probe.name);
                    stresses.push(Component::new(name, found.iter().map(|numbers| numbers[place])));
                }
            }
        }
        Ok(ProbeResponse { frequencies, quantity, motion, stresses, relative })
    }

    /// All components.
    pub fn components(&self) -> impl Iterator<Item = &Component> {
        self.motion.iter().chain(&self.stresses)
    }

    /// The frequency at which the amplitude of a component is infinite, and the component.
    pub fn infinite(&self) -> Option<(f64, &str)> {
        self.components().find_map(|own| {
            let at = own.amplitudes.iter().position(|amplitude| !amplitude.is_finite())?;
            Some((self.frequencies[at], own.name.as_str()))
        })
    }

    fn csv(&self) -> String {
        let name = |own: &Component| [format!("{}_amplitude", own.name), format!("{}_phase", own.name)];
        let names: Vec<[String; 2]> = self.components().map(name).collect();
        let mut columns: Vec<(&str, &[f64])> = vec![("frequency", &self.frequencies)];
        for ([amplitude, phase], own) in names.iter().zip(self.components()) {
            columns.extend([(amplitude.as_str(), &own.amplitudes[..]), (phase.as_str(), &own.phases[..])]);
        }
        table(&columns)
    }

    /// The motion, and the stresses if there are any.
    pub fn parts(&self) -> Vec<Part<'_>> {
        let (name, dimension) = match self.quantity {
            Quantity::Displacement => ("displacement", "length"),
            Quantity::Velocity => ("velocity", "length/time"),
            Quantity::Acceleration => ("acceleration", "length/time²"),
        };
        let all = [(name, dimension, &self.motion[..]), ("stress", "stress", &self.stresses[..])];
        let all = all.into_iter().filter(|(.., components)| !components.is_empty());
        all.map(|(name, dimension, components)| Part::new(name, dimension, components)).collect()
    }

    /// The charts: amplitudes of the motion and of stresses, and their phases.
    pub fn figure(&self, units: Units) -> Figure {
        let chart = over_frequency(&self.frequencies, units, false);
        let charts = self.parts().into_iter().flat_map(|Part { name, dimension, components }| {
            let label = units.label(&format!("amplitude of the {name}"), dimension);
            let amplitudes = components.iter().map(|own| (own.name.clone(), &own.amplitudes[..]));
            let phases = components.iter().map(|own| (own.name.clone(), &own.phases[..]));
            [
                chart(Axis::log(label), &amplitudes.collect::<Vec<_>>()),
                chart(Axis::linear(format!("phase of the {name} [rad]")), &phases.collect::<Vec<_>>()),
            ]
        });
        Figure { charts: charts.collect(), columns: 1 }
    }
}

/// The quantity of the motion that all probes ask for, if it is the only one; else the displacement.
pub fn quantity_of_probes(problem: &Problem) -> Quantity {
    let of = |quantity: &ProbeQuantity| match quantity {
        ProbeQuantity::Field(FieldName::Velocity) => Some(Quantity::Velocity),
        ProbeQuantity::Field(FieldName::Acceleration) => Some(Quantity::Acceleration),
        ProbeQuantity::Field(FieldName::Displacement) | ProbeQuantity::Position => {
            Some(Quantity::Displacement)
        }
        ProbeQuantity::Field(_) => None,
    };
    let mut all = problem.quantities.probes.iter().flat_map(|probe| &probe.quantities).filter_map(of);
    let first = all.next().unwrap_or_default();
    if all.all(|quantity| quantity == first) { first } else { Quantity::default() }
}

/// Whether a field is linear in the motion, so that it has an amplitude and a phase.
fn is_harmonic(field: FieldName) -> bool {
    matches!(field, FieldName::CauchyStress | FieldName::SecondPiolaKirchhoffStress)
}

/// Remarks on fields of probes that a harmonic response does not have.
pub fn notes(problem: &Problem) -> Vec<String> {
    let probes = problem.quantities.probes.iter();
    let all = probes.flat_map(|probe| probe.fields().map(move |field| (probe, field)));
    let left_out = all.filter(|(_, field)| !field.is_of_motion() && !is_harmonic(*field));
    left_out
        .map(|(probe, field)| {
            let name = &probe.name;
            format!("{field} of the probe {name} is left out, as it is not harmonic: ask for cauchy_stress instead")
        })
        .collect()
}

/// Checks that a response may be written into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check(directory: &Path, problem: &Problem) -> Result<(), DirectoryError> {
    directory::check_kind(directory, KIND, WITNESS)?;
    directory::check_sources(directory, &problem.files)
}

/// Writes a response into a directory, in place of an earlier one. `caption`: excitation and damping, in words.
///
/// # Errors
/// [`DirectoryError`].
pub fn write(
    directory: &Path,
    problem: &Problem,
    response: &HarmonicResponse,
    probes: &ProbeResponse,
    caption: &str,
) -> Result<(), DirectoryError> {
    check(directory, problem)?;
    directory::prepare_kind(directory, KIND, WITNESS)?;
    let _lock = Lock::take(directory)?;
    let written = || -> io::Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let about = shown(caption);
        let input = format!(
            "{MARK} {version}: the input of this harmonic response.\n# {about}.\n\n{}",
            problem.resolved
        );
        replace(&directory.join(WITNESS), input.as_bytes())?;
        let mut figure = probes.figure(problem.units);
        figure.charts.iter_mut().take(1).for_each(|chart| chart.title = about.to_string());
        figure.write(&directory.join("response"))?;
        let name = problem.title.as_deref().unwrap_or("Harmonic response");
        let curves = Curves {
            heading: name,
            caption,
            figure: &figure,
            input: Some(&input),
            files: &[TABLE, MODES, "response.svg", WITNESS],
        };
        write_curves(directory, &curves)?;
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
