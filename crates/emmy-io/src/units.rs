//! Consistent systems of units, and the unit of every quantity in them.

use emmy::body::FieldName;
use emmy::internals::number::{short, short_vector};
use serde_json::Value;

/// The quantities in which dimensions are written, with their exponents of mass, length and time.
const QUANTITIES: [(&str, [i32; 3]); 7] = [
    ("mass", [1, 0, 0]),
    ("length", [0, 1, 0]),
    ("time", [0, 0, 1]),
    ("force", [1, 1, -2]),
    ("stress", [1, -1, -2]),
    ("energy", [1, 2, -2]),
    ("frequency", [0, 0, -1]),
];

/// SI units of force, stress, energy and frequency, which take a prefix.
const PREFIXED: [&str; 4] = ["N", "Pa", "J", "Hz"];

/// Prefixes of the SI with their powers of ten.
const PREFIXES: [(&str, i32); 8] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9)];

/// Standard acceleration of gravity \[m/s²\].
const GRAVITY: f64 = 9.80665;

/// A consistent system: units of mass, length and time, from which those of force, stress, energy and frequency follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitSystem {
    /// Name, from the units of length, mass and time, as `mm-t-s`.
    pub name: &'static str,
    /// Name with the units of force and stress, as `mm-t-s-N-MPa`.
    pub full_name: &'static str,
    /// Units of mass, length and time, with their powers of ten in kg, m and s.
    base: [(&'static str, i32); 3],
}

/// All systems. A new one has its row here.
pub static SYSTEMS: [UnitSystem; 4] = [
    UnitSystem { name: "m-kg-s", full_name: "m-kg-s-N-Pa", base: [("kg", 0), ("m", 0), ("s", 0)] },
    UnitSystem { name: "mm-kg-ms", full_name: "mm-kg-ms-kN-GPa", base: [("kg", 0), ("mm", -3), ("ms", -3)] },
    UnitSystem { name: "mm-t-s", full_name: "mm-t-s-N-MPa", base: [("t", 3), ("mm", -3), ("s", 0)] },
    UnitSystem {
        name: "um-mg-ms", full_name: "um-mg-ms-uN-MPa", base: [("mg", -6), ("µm", -6), ("ms", -3)]
    },
];

impl UnitSystem {
    /// The system of a name, with or without its units of force and stress.
    ///
    /// ```
    /// use emmy_io::units::UnitSystem;
    /// assert_eq!(UnitSystem::named("mm-t-s-N-MPa").map(|system| system.name), Some("mm-t-s"));
    /// assert_eq!(UnitSystem::named("mm-t-s-kN-MPa"), None);
    /// ```
    pub fn named(name: &str) -> Option<&'static UnitSystem> {
        SYSTEMS.iter().find(|system| [system.name, system.full_name].contains(&name))
    }

    /// Names and units of mass, length, time, force, stress, energy and frequency.
    pub fn units(&self) -> impl Iterator<Item = (&'static str, String)> {
        (0..QUANTITIES.len()).map(|index| (QUANTITIES[index].0, self.symbol(index)))
    }

    /// Unit of a quantity of [`QUANTITIES`].
    fn symbol(&self, index: usize) -> String {
        let Some(prefixed) = index.checked_sub(3) else { return self.base[index].0.to_string() };
        let power = self.power_of(QUANTITIES[index].1);
        let prefix = PREFIXES.iter().find(|(_, own)| *own == power).map_or("?", |(prefix, _)| *prefix);
        format!("{prefix}{}", PREFIXED[prefixed])
    }

    fn power_of(&self, exponents: [i32; 3]) -> i32 {
        self.base.iter().zip(exponents).map(|((_, power), exponent)| power * exponent).sum()
    }

    /// Unit of a dimension, such as `mass·length²/time`; empty for a pure number.
    ///
    /// ```
    /// use emmy_io::units::UnitSystem;
    /// let system = UnitSystem::named("mm-t-s").unwrap();
    /// assert_eq!(system.unit("mass·length²/time"), "t·mm²/s");
    /// assert_eq!(system.unit("energy/length³"), "mJ/mm³");
    /// ```
    pub fn unit(&self, dimension: &str) -> String {
        let words = (0..QUANTITIES.len()).map(|index| (QUANTITIES[index].0, self.symbol(index)));
        words.fold(dimension.to_string(), |unit, (word, symbol)| unit.replace(word, &symbol))
    }

    /// Power of ten by which a number of a dimension is multiplied in the SI.
    ///
    /// ```
    /// use emmy_io::units::UnitSystem;
    /// // 1 t/mm³ is 1e12 kg/m³.
    /// assert_eq!(UnitSystem::named("mm-t-s").unwrap().power("mass/length³"), 12);
    /// ```
    pub fn power(&self, dimension: &str) -> i32 {
        self.power_of(exponents(dimension).unwrap_or_default())
    }
}

/// Exponents of mass, length and time of a dimension; `None` if it is not a product of powers of [`QUANTITIES`].
pub(crate) fn exponents(dimension: &str) -> Option<[i32; 3]> {
    let (above, below) = dimension.split_once('/').unwrap_or((dimension, ""));
    let below = below.trim_start_matches('(').trim_end_matches(')');
    let mut sum = [0; 3];
    for (part, sign) in [(above, 1), (below, -1)] {
        for factor in part.split('·').filter(|factor| !["", "1", "radian"].contains(factor)) {
            let word = factor.trim_end_matches(['²', '³']);
            let (_, own) = QUANTITIES.iter().find(|(name, _)| *name == word)?;
            let exponent = match &factor[word.len()..] {
                "" => 1,
                "²" => 2,
                "³" => 3,
                _ => return None,
            };
            sum = [0, 1, 2].map(|i| sum[i] + sign * exponent * own[i]);
        }
    }
    Some(sum)
}

/// The units of an input: a system, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units(Option<&'static UnitSystem>);

impl From<&'static UnitSystem> for Units {
    fn from(system: &'static UnitSystem) -> Self {
        Units(Some(system))
    }
}

impl Units {
    /// The system, if there is one.
    pub fn system(self) -> Option<&'static UnitSystem> {
        self.0
    }

    /// A number with six digits and the unit of its dimension.
    ///
    /// ```
    /// use emmy_io::units::{UnitSystem, Units};
    /// let units = Units::from(UnitSystem::named("mm-t-s").unwrap());
    /// assert_eq!(units.number(2.5, "stress"), "2.5 MPa");
    /// assert_eq!(Units::default().number(2.5, "stress"), "2.5");
    /// ```
    pub fn number(self, value: f64, dimension: &str) -> String {
        self.with_unit(short(value), dimension)
    }

    /// The components of a vector with the unit of their dimension.
    pub fn vector(self, vector: [f64; 3], dimension: &str) -> String {
        self.with_unit(short_vector(vector), dimension)
    }

    /// A text of a number with the unit of its dimension behind it.
    pub fn with_unit(self, number: String, dimension: &str) -> String {
        match self.0.map(|system| system.unit(dimension)) {
            Some(unit) if !unit.is_empty() => format!("{number} {unit}"),
            _ => number,
        }
    }

    /// The label of an axis, such as `time [s]`.
    pub fn label(self, text: &str, dimension: &str) -> String {
        match self.0.map(|system| system.unit(dimension)) {
            Some(unit) if !unit.is_empty() => format!("{text} [{unit}]"),
            _ => text.to_string(),
        }
    }

    /// Name of the system, and its units by the names of the quantities.
    pub fn json(self) -> Option<Value> {
        let system = self.0?;
        let units = system.units().map(|(name, unit)| (name.to_string(), unit.into()));
        Some(Value::Object([("system".to_string(), system.name.into())].into_iter().chain(units).collect()))
    }

    /// The system with all its units and the acceleration of gravity, in a line.
    pub fn description(self) -> Option<String> {
        let system = self.0?;
        let units: Vec<String> = system.units().map(|(name, unit)| format!("{name} {unit}")).collect();
        Some(format!("{}: {}; gravity {}", system.name, units.join(", "), gravity(system)))
    }
}

/// Description of a field with its dimension in brackets.
pub fn described(field: FieldName) -> String {
    match (field.description(), field.dimension()) {
        (description, "") => description.to_string(),
        (description, dimension) => format!("{description} [{dimension}]"),
    }
}

/// The standard acceleration of gravity in a system.
pub fn gravity(system: &UnitSystem) -> String {
    format!("{} {}", written(standard_gravity(system)), system.unit(ACCELERATION))
}

/// The number of the standard acceleration of gravity in a system.
///
/// ```
/// use emmy_io::units::{UnitSystem, standard_gravity};
/// assert_eq!(standard_gravity(UnitSystem::named("mm-t-s").unwrap()), 9806.65);
/// ```
pub fn standard_gravity(system: &UnitSystem) -> f64 {
    shifted(GRAVITY, -system.power(ACCELERATION))
}

const ACCELERATION: &str = "length/time²";

/// A number times a power of ten, rounded once.
///
/// ```
/// use emmy_io::units::shifted;
/// assert_eq!(shifted(7850.0, -12), 7.85e-9);
/// ```
pub fn shifted(value: f64, power: i32) -> f64 {
    let text = format!("{value:e}");
    let shifted = text.split_once('e').and_then(|(digits, exponent)| {
        let exponent: i32 = exponent.parse().ok()?;
        format!("{digits}e{}", exponent + power).parse().ok()
    });
    shifted.unwrap_or(value)
}

/// A number as TOML with all its digits; below 1e-4 and above 1e6, with an exponent.
pub fn written(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_force_stress_and_energy_follow() {
        for system in &SYSTEMS {
            let [length, mass, time, force, stress] =
                ["length", "mass", "time", "force", "stress"].map(|name| system.unit(name).replace('µ', "u"));
            assert_eq!(system.name, format!("{length}-{mass}-{time}"));
            assert_eq!(system.full_name, format!("{}-{force}-{stress}", system.name));
        }
        assert_eq!(SYSTEMS.each_ref().map(|system| system.unit("energy")), ["J", "J", "mJ", "pJ"]);
        assert_eq!(SYSTEMS.each_ref().map(|system| system.unit("frequency")), ["Hz", "kHz", "Hz", "kHz"]);
        assert_eq!(
            SYSTEMS.each_ref().map(gravity),
            ["9.80665 m/s²", "0.00980665 mm/ms²", "9806.65 mm/s²", "9.80665 µm/ms²"]
        );
        // Steel, from tables of LS-DYNA and Abaqus: 7.85e-9 t/mm³ and 7.85e-6 kg/mm³.
        let steel = SYSTEMS.each_ref().map(|system| shifted(7850.0, -system.power("mass/length³")));
        assert_eq!(steel, [7850.0, 7.85e-6, 7.85e-9, 7.85e-9]);
        // Energy per volume is a stress, force times length an energy.
        for system in &SYSTEMS {
            assert_eq!(system.power("energy/length³"), system.power("stress"));
            assert_eq!(system.power("force·length"), system.power("energy"));
            assert_eq!(system.power("mass·length²/time"), system.power("energy") + system.power("time"));
        }
    }

    #[test]
    fn every_dimension_of_a_field_is_known() {
        for field in FieldName::ALL {
            assert!(exponents(field.dimension()).is_some(), "{field}: {}", field.dimension());
        }
        assert_eq!(exponents("mass/(length²·time)"), Some([1, -2, -1]));
        assert_eq!([exponents("weight"), exponents("length^2"), exponents("length²³")], [None; 3]);
    }

    #[test]
    fn numbers_without_a_system_have_no_unit() {
        let none = Units::default();
        assert_eq!(
            (none.vector([1.0; 3], "length"), none.label("time", "time")),
            ("[1, 1, 1]".into(), "time".into())
        );
        let some = Units::from(&SYSTEMS[2]);
        assert_eq!(
            (some.vector([1.0; 3], "length"), some.label("time", "time")),
            ("[1, 1, 1] mm".into(), "time [s]".into())
        );
        assert_eq!(some.number(3.0, ""), "3");
        assert_eq!(
            some.description().unwrap(),
            "mm-t-s: mass t, length mm, time s, force N, stress MPa, energy mJ, frequency Hz; gravity 9806.65 mm/s²"
        );
    }

    #[test]
    fn numbers_are_shifted_without_rounding_and_written_with_all_digits() {
        assert_eq!([shifted(2.1e11, -6), shifted(0.1, 3), shifted(0.0, 5)], [210_000.0, 100.0, 0.0]);
        assert_eq!(
            [7850.0, 2.1e11, 7.85e-9, -0.3, 0.0].map(written),
            ["7850", "2.1e11", "7.85e-9", "-0.3", "0"]
        );
    }
}
