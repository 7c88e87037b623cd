//! Problems with exact numbers and their runs, from `data/contact.toml`, whose first lines explain the keys.

use emmy::body::LayerLaw;
use emmy::internals::contact::Layer;
use serde::Deserialize;

use crate::case::Case;

/// A problem with its exact numbers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Problem {
    /// Key word, also the stem of its input.
    pub name: String,
    /// Heading of its table.
    pub title: String,
    /// Where it is from.
    pub source: String,
    /// Its data in words.
    pub data: String,
    /// Reasons that keep the results from the exact numbers, and by how much.
    pub limits: String,
    /// The compared quantities, in the order in which its measurement returns them.
    pub quantity: Vec<Quantity>,
    /// The runs.
    pub run: Vec<Run>,
}

/// A quantity with its exact value.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quantity {
    pub title: String,
    pub exact: f64,
    /// The error is counted in this, if not in the exact value.
    pub scale: Option<f64>,
    /// Largest error of the checked runs; a quantity without one is only shown.
    pub within: Option<f64>,
}

/// A run; a problem uses the keys that it needs.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    #[serde(default = "dgm")]
    pub scheme: String,
    #[serde(default = "one")]
    pub degree: usize,
    /// Step size; zero in statics.
    #[serde(default)]
    pub size: f64,
    /// Number of cells along the body, or from the centre to the surface.
    #[serde(default)]
    pub cells: usize,
    /// Number of bodies, where the problem leaves it open.
    #[serde(default)]
    pub bodies: usize,
    /// Kind of the cells, if not hex8.
    pub kind: Option<String>,
    /// Velocity of the impact, or force, where the problem has several.
    pub load: Option<f64>,
    /// Law, thickness and modulus of the layer.
    #[serde(default = "linear")]
    pub law: String,
    pub distance: Option<f64>,
    pub stiffness: Option<f64>,
    /// Number of steps, where the problem leaves it open.
    pub steps: Option<usize>,
    /// Whether its errors are claims.
    #[serde(default)]
    pub checked: bool,
    /// Whether it belongs to the quick set.
    #[serde(default)]
    pub quick: bool,
    /// Whether the picture shows it.
    #[serde(default)]
    pub drawn: bool,
    /// Whether it takes minutes.
    #[serde(default)]
    pub long: bool,
}

fn dgm() -> String {
    "DGM".into()
}

fn one() -> usize {
    1
}

fn linear() -> String {
    "linear".into()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    problem: Vec<Problem>,
}

/// The problems.
///
/// # Errors
/// The message of a file that cannot be read.
pub(super) fn problems() -> Result<Vec<Problem>, String> {
    let text = include_str!("../../../data/contact.toml");
    let file: File = toml::from_str(text).map_err(|error| format!("data/contact.toml: {error}"))?;
    Ok(file.problem)
}

impl Problem {
    /// The input of a run.
    pub(super) fn case(&self, run: &Run) -> Case {
        let mut case = Case::new(format!("contact/{}", self.name)).scheme(&run.scheme);
        if ["DGM", "AS", "FE"].iter().any(|name| run.scheme.starts_with(name)) {
            case = case.with("time.degree", run.degree);
        }
        case = case.with("contact.law", &run.law);
        for (key, value) in [("distance", run.distance), ("stiffness", run.stiffness)] {
            if let Some(value) = value {
                case = case.with(&format!("contact.{key}"), format!("{value:?}"));
            }
        }
        case
    }
}

impl Quantity {
    /// Error of a value, in the scale.
    pub(super) fn error(&self, value: f64) -> f64 {
        (value - self.exact) / self.scale.unwrap_or(if self.exact == 0.0 { 1.0 } else { self.exact.abs() })
    }

    /// A value with its error.
    pub(super) fn words(&self, value: f64) -> String {
        let error = self.error(value);
        match self.exact == 0.0 {
            true => format!("{value:.1e}"),
            false if error.abs() < 1e-4 => format!("{} ({error:+.1e})", significant(value)),
            false => format!("{} ({:+.2} %)", significant(value), 100.0 * error),
        }
    }
}

/// Four significant digits at most.
fn short(value: f64) -> String {
    let text = format!("{value:.3e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// Five significant digits.
fn significant(value: f64) -> String {
    let digits = 4 - value.abs().log10().floor() as i32;
    match digits {
        0..=6 => format!("{value:.*}", digits as usize),
        _ => format!("{value:.4e}"),
    }
}

impl Run {
    /// Its layer, with the modulus of the body unless it has its own.
    ///
    /// # Errors
    /// The message of a run without a distance.
    pub(super) fn layer(&self, modulus: f64) -> Result<Layer, String> {
        let thickness = self.distance.ok_or("a distance is needed")?;
        let law = if self.law == "smooth" { LayerLaw::Smooth } else { LayerLaw::Linear };
        Ok(Layer { modulus: self.stiffness.unwrap_or(modulus), thickness, law })
    }

    /// The run in words.
    pub(super) fn label(&self) -> String {
        let mut words = Vec::new();
        if self.size > 0.0 {
            words.push(self.scheme.clone());
            if ["DGM", "AS", "FE"].iter().any(|name| self.scheme.starts_with(name)) {
                words.push(format!("k = {}", self.degree));
            }
        }
        words.extend(self.kind.clone());
        if self.bodies > 0 {
            words.push(format!("{} bodies", self.bodies));
        }
        if self.cells > 0 {
            words.push(format!("{} cells", self.cells));
        }
        if self.size > 0.0 {
            words.push(format!("h = {}", short(self.size)));
        }
        words.extend(self.load.map(|load| format!("load {load}")));
        if self.law != "linear" {
            words.push(format!("{} law", self.law));
        }
        words.extend(self.distance.map(|distance| format!("d = {}", short(distance))));
        words.extend(self.stiffness.map(|stiffness| format!("modulus {stiffness:e}")));
        words.join(", ")
    }
}
