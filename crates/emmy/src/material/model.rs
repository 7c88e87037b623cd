//! Descriptions of material models, and the values that make a model by name.

use std::fmt;

use super::{Material, Volumetric};
use crate::error::Result;

/// A material model: its name, its energy, its parameters. [`crate::input::models::MODELS`] lists all of them.
///
/// ```
/// use emmy::internals::material::Modelled;
/// use emmy::material::Gent;
/// let names: Vec<&str> = Gent::MODEL.every_parameter().map(|parameter| parameter.name).collect();
/// assert_eq!(names[2..], ["youngs_modulus", "poissons_ratio", "bulk_modulus", "jm", "volumetric"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Key word, such as `neo-hooke`.
    pub name: &'static str,
    /// Formula of the stored energy: per reference volume of a solid, of the whole of a link.
    pub energy: &'static str,
    /// Use, in a few words.
    pub purpose: &'static str,
    /// Its parameters, in parts; isotropic models begin with [`ELASTIC_CONSTANTS`](super::elastic::ELASTIC_CONSTANTS).
    pub parameters: &'static [&'static [Parameter]],
    /// Cells that the model is for.
    pub cells: ModelCells,
}

/// Cells that a model is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelCells {
    /// Solid and plane cells.
    Solids,
    /// Links with a mass.
    Links,
    /// Links without a mass.
    MasslessLinks,
}

/// A parameter of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key word, such as `youngs_modulus`.
    pub name: &'static str,
    /// Its kind of value.
    pub kind: ParameterKind,
    /// Unit, such as `stress`; empty for a number without dimension.
    pub unit: &'static str,
    /// Meaning of a parameter that is left out.
    pub if_absent: IfAbsent,
    /// One sentence on it.
    pub doc: &'static str,
}

/// Kind of value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// A number.
    Number(Bounds),
    /// A list of numbers, one per term of the energy.
    Numbers,
    /// A direction, not necessarily a unit vector.
    Direction,
    /// A list of directions.
    Directions,
    /// A [`Volumetric`] law.
    Law,
}

/// Meaning of a value that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IfAbsent {
    /// It must be given.
    Required,
    /// The same as this value, as written in an input file.
    Value(&'static str),
    /// Described in words.
    Means(&'static str),
    /// It follows from two others with this meaning: exactly two of them are given.
    FromTwoOthers,
}

/// Numbers that a value may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounds {
    /// Every finite number.
    Any,
    /// Above this number.
    Above(f64),
    /// This number or above.
    AtLeast(f64),
    /// Between these two, without them.
    Between(f64, f64),
    /// From the first to the second.
    Within(f64, f64),
    /// Not zero.
    NotZero,
}

impl Bounds {
    /// Whether a number lies within.
    pub fn contains(self, value: f64) -> bool {
        match self {
            Bounds::Any => true,
            Bounds::Above(least) => value > least,
            Bounds::AtLeast(least) => value >= least,
            Bounds::Between(low, high) => low < value && value < high,
            Bounds::Within(low, high) => low <= value && value <= high,
            Bounds::NotZero => value != 0.0,
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bounds::Any => Ok(()),
            Bounds::Above(least) => write!(f, "> {least}"),
            Bounds::AtLeast(least) => write!(f, "≥ {least}"),
            Bounds::Between(low, high) => write!(f, "between {low} and {high}"),
            Bounds::Within(low, high) => write!(f, "from {low} to {high:.4}"),
            Bounds::NotZero => write!(f, "≠ 0"),
        }
    }
}

impl Parameter {
    /// A number that must be given.
    pub const fn number(name: &'static str, bounds: Bounds, unit: &'static str, doc: &'static str) -> Self {
        Parameter { name, kind: ParameterKind::Number(bounds), unit, if_absent: IfAbsent::Required, doc }
    }

    /// A positive number that must be given.
    pub const fn positive(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Parameter::number(name, Bounds::Above(0.0), unit, doc)
    }

    /// A list of numbers that must be given, one per term of the energy.
    pub const fn numbers(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        let kind = ParameterKind::Numbers;
        let if_absent = IfAbsent::Required;
        Parameter { name, kind, unit, if_absent, doc }
    }

    /// A direction with its default.
    pub const fn direction(name: &'static str, default: &'static str, doc: &'static str) -> Self {
        let kind = ParameterKind::Direction;
        let if_absent = IfAbsent::Value(default);
        Parameter { name, kind, unit: "", if_absent, doc }
    }

    /// A list of directions that must be given.
    pub const fn directions(name: &'static str, doc: &'static str) -> Self {
        let kind = ParameterKind::Directions;
        let if_absent = IfAbsent::Required;
        Parameter { name, kind, unit: "", if_absent, doc }
    }

    /// The same parameter with another meaning if it is left out.
    pub const fn if_absent(self, if_absent: IfAbsent) -> Self {
        Parameter { if_absent, ..self }
    }
}

/// Bulk modulus of the materials with a law of volume.
pub(super) const BULK_MODULUS: Parameter = Parameter::positive(
    "bulk_modulus",
    "stress",
    "Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu)",
);

/// Law of volume.
pub(super) const VOLUMETRIC: Parameter = Parameter {
    name: "volumetric",
    kind: ParameterKind::Law,
    unit: "",
    if_absent: IfAbsent::Value("'simo-taylor'"),
    doc: "Law of volume W_vol(J)",
};

impl Model {
    /// All parameters.
    pub fn every_parameter(&self) -> impl Iterator<Item = &'static Parameter> + use<> {
        self.parameters.iter().copied().flatten()
    }

    /// Whether the model takes two of the elastic constants.
    pub fn has_elastic_constants(&self) -> bool {
        self.every_parameter().any(|parameter| parameter.if_absent == IfAbsent::FromTwoOthers)
    }

    /// Whether the model is for links.
    pub fn is_link(&self) -> bool {
        self.cells != ModelCells::Solids
    }
}

/// A material that can be made by the name of its model.
pub trait Modelled: Material {
    /// The model.
    const MODEL: Model;

    /// The material with values of the parameters.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] for values that are out of range or missing.
    fn from_values(values: &Values) -> Result<Self>;
}

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Of [`ParameterKind::Number`].
    Number(f64),
    /// Of [`ParameterKind::Numbers`].
    Numbers(Vec<f64>),
    /// Of [`ParameterKind::Direction`].
    Direction([f64; 3]),
    /// Of [`ParameterKind::Directions`].
    Directions(Vec<[f64; 3]>),
    /// Of [`ParameterKind::Law`].
    Law(Volumetric),
}

/// Values of parameters by name. A missing number is NaN, a missing direction zero and a missing list empty, and
/// materials reject these; only the law of volume has a default.
///
/// ```
/// use emmy::internals::material::{Modelled, Value, Values};
/// use emmy::material::NeoHooke;
/// let values = Values::from_iter([("lambda", Value::Number(1000.0)), ("mu", Value::Number(500.0))]);
/// assert_eq!(NeoHooke::from_values(&values), NeoHooke::new(1000.0, 500.0));
/// assert!(NeoHooke::from_values(&Values::default()).is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Values(Vec<(&'static str, Value)>);

impl FromIterator<(&'static str, Value)> for Values {
    fn from_iter<I: IntoIterator<Item = (&'static str, Value)>>(values: I) -> Self {
        Values(values.into_iter().collect())
    }
}

impl Values {
    fn get(&self, name: &str) -> Option<&Value> {
        self.0.iter().find(|(other, _)| *other == name).map(|(_, value)| value)
    }

    /// A number, if it is given.
    pub fn optional(&self, name: &str) -> Option<f64> {
        match self.get(name) {
            Some(Value::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// A number.
    pub fn number(&self, name: &str) -> f64 {
        self.optional(name).unwrap_or(f64::NAN)
    }

    /// A list of numbers.
    pub fn numbers(&self, name: &str) -> &[f64] {
        match self.get(name) {
            Some(Value::Numbers(values)) => values,
            _ => &[],
        }
    }

    /// A direction.
    pub fn direction(&self, name: &str) -> [f64; 3] {
        match self.get(name) {
            Some(Value::Direction(direction)) => *direction,
            _ => [0.0; 3],
        }
    }

    /// A list of directions.
    pub fn directions(&self, name: &str) -> &[[f64; 3]] {
        match self.get(name) {
            Some(Value::Directions(directions)) => directions,
            _ => &[],
        }
    }

    /// Bulk modulus and law of volume.
    pub(super) fn volume(&self) -> (f64, Volumetric) {
        (self.number(BULK_MODULUS.name), self.law())
    }

    /// Law of volume.
    pub(super) fn law(&self) -> Volumetric {
        match self.get(VOLUMETRIC.name) {
            Some(Value::Law(law)) => *law,
            _ => Volumetric::default(),
        }
    }
}
