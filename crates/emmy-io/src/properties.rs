//! Measured materials: density, parameters of a model, and the source of each.
//!
//! `properties/measured.toml` holds them in kg, m and s, written as in an input; `emmy list materials --properties` and
//! `book/src/materials.md` show them.

use std::sync::LazyLock;

use emmy::internals::body::RegionModel;
use emmy::internals::material::Model;
use serde::Deserialize;
use toml::Value;

use crate::units::{UnitSystem, shifted, written};

/// A material that was measured.
///
/// ```
/// use emmy_io::{properties::measured, units::UnitSystem};
/// let steel = &measured()[0];
/// assert_eq!((steel.name.as_str(), steel.density), ("structural steel", 7850.0));
/// assert_eq!(
///     steel.input(UnitSystem::named("mm-t-s").unwrap()),
///     "density = 7.85e-9\nmaterial.saint-venant-kirchhoff = { youngs_modulus = 210000, poissons_ratio = 0.3 }\n"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct MeasuredMaterial {
    /// Name.
    pub name: String,
    /// Density \[kg/m³\].
    pub density: f64,
    /// The model and its parameters in the SI, as in an input.
    material: toml::Table,
    /// Author, journal or handbook, and year.
    pub source: String,
    /// Parts that were derived or chosen, and the axes.
    #[serde(default)]
    pub note: String,
}

#[derive(Deserialize)]
struct File {
    measured: Vec<MeasuredMaterial>,
}

/// All measured materials.
pub fn measured() -> &'static [MeasuredMaterial] {
    static ALL: LazyLock<Vec<MeasuredMaterial>> = LazyLock::new(|| {
        let file: Result<File, _> = toml::from_str(include_str!("properties/measured.toml"));
        file.map(|file| file.measured).unwrap_or_default()
    });
    &ALL
}

impl MeasuredMaterial {
    /// Density and material as lines for `[[region]]`, in a system of units.
    pub fn input(&self, system: &UnitSystem) -> String {
        let density = written(shifted(self.density, -system.power("mass/length³")));
        format!("density = {density}\n{}\n", self.line(system))
    }

    /// The material as a line for `[[region]]`.
    pub fn line(&self, system: &UnitSystem) -> String {
        let model = |(name, parameters): (&String, &Value)| {
            let model = RegionModel::named(name).map(|model| &model.model);
            let parameters = parameters.as_table().into_iter().flatten();
            let pair = |(key, value): (&String, &Value)| {
                let power =
                    model.and_then(|model| dimension(model, key)).map_or(0, |unit| system.power(unit));
                format!("{key} = {}", toml(value, -power))
            };
            format!("material.{name} = {{ {} }}", parameters.map(pair).collect::<Vec<_>>().join(", "))
        };
        self.material.iter().map(model).collect()
    }

    /// Source and note in a line.
    pub fn origin(&self) -> String {
        if self.note.is_empty() { self.source.clone() } else { format!("{} ({})", self.source, self.note) }
    }
}

/// Dimension of a parameter of a model.
fn dimension(model: &Model, parameter: &str) -> Option<&'static str> {
    model.every_parameter().find(|own| own.name == parameter).map(|own| own.unit)
}

/// A value as TOML, its numbers times a power of ten.
fn toml(value: &Value, power: i32) -> String {
    match value {
        Value::Integer(number) => written(shifted(*number as f64, power)),
        Value::Float(number) => written(shifted(*number, power)),
        Value::Array(entries) => {
            let entries: Vec<String> = entries.iter().map(|entry| toml(entry, power)).collect();
            format!("[{}]", entries.join(", "))
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests;
