//! A remark on densities and moduli that no known solid has: a sign of mixed units.

use std::ops::RangeInclusive;

use emmy::body::Region;
use emmy::internals::number::short;

use crate::units::{Units, shifted, written};

/// Densities \[kg/m³\] of a kind of solids, and their Young's moduli \[Pa\].
struct Solids {
    densities: [f64; 2],
    moduli: [f64; 2],
}

/// Known solids, after the chart of modulus over density in Ashby, Materials Selection in Mechanical Design.
const KNOWN: [Solids; 3] = [
    // Aerogels, foams, cork, balsa.
    Solids { densities: [1.0, 300.0], moduli: [1e2, 1e10] },
    // Gels, tissue, rubber, polymers, wood, soil, fibres and their composites.
    Solids { densities: [300.0, 2300.0], moduli: [1e2, 1.2e12] },
    // Rocks, glass, ceramics and metals.
    Solids { densities: [2300.0, 22_600.0], moduli: [1e9, 1.2e12] },
];

/// Speed \[m/s\] of sound in a thin rod that no solid exceeds; diamond has 18,000.
const LARGEST_SPEED: f64 = 20_000.0;

/// Whether some solid has a density and a Young's modulus in the SI.
fn is_known(density: f64, modulus: f64) -> bool {
    let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    let is_one = |solids: &Solids| within(solids.densities, density) && within(solids.moduli, modulus);
    KNOWN.iter().any(is_one) && (modulus / density).sqrt() <= LARGEST_SPEED
}

/// Units in which tables give densities, and their powers of ten in kg/m³.
const DENSITIES: [(&str, i32); 4] = [("kg/m³", 0), ("g/cm³", 3), ("kg/mm³", 9), ("t/mm³", 12)];

/// Units in which tables give moduli, and their powers of ten in Pa.
const MODULI: [(&str, i32); 4] = [("GPa", 9), ("MPa", 6), ("Pa", 0), ("kPa", 3)];

/// Densities \[kg/m³\] of solids other than foams: such a density is probably right.
const USUAL_DENSITIES: RangeInclusive<f64> = 300.0..=22_600.0;

/// A density and a Young's modulus in a system of units.
#[derive(Clone, Copy)]
struct Pair {
    density: f64,
    modulus: f64,
    /// Powers of ten in kg/m³ and in Pa.
    powers: [i32; 2],
}

impl Pair {
    /// Whether some solid has the numbers, read in units with other powers of ten.
    fn is_known_as(&self, density: i32, modulus: i32) -> bool {
        is_known(shifted(self.density, density), shifted(self.modulus, modulus))
    }

    fn mean_density(&self, (unit, power): (&str, i32)) -> String {
        let density = written(shifted(self.density, power - self.powers[0]));
        format!("{density} if the density is meant in {unit}")
    }

    fn mean_moduli(&self, (unit, power): (&str, i32)) -> String {
        let factor = written(shifted(1.0, power - self.powers[1]));
        format!("moduli multiplied by {factor} if they are meant in {unit}")
    }

    /// Numbers that are known if density, moduli or both are read in other units.
    fn advice(&self) -> Option<String> {
        let [density, modulus] = self.powers;
        let densities = || DENSITIES.into_iter().find(|own| self.is_known_as(own.1, modulus));
        let moduli = || MODULI.into_iter().find(|own| self.is_known_as(density, own.1));
        let by_density = || densities().map(|own| self.mean_density(own));
        let by_moduli = || moduli().map(|own| self.mean_moduli(own));
        let one = match USUAL_DENSITIES.contains(&shifted(self.density, density)) {
            true => by_moduli().or_else(by_density),
            false => by_density().or_else(by_moduli),
        };
        one.or_else(|| {
            let pairs =
                DENSITIES.iter().flat_map(|density| MODULI.iter().map(move |modulus| (*density, *modulus)));
            let (density, modulus) = pairs.into_iter().find(|own| self.is_known_as(own.0.1, own.1.1))?;
            Some(format!("{}, and {}", self.mean_density(density), self.mean_moduli(modulus)))
        })
    }
}

/// A remark on a region, if no known solid has its density and Young's modulus.
pub(super) fn note(region: &Region, units: Units) -> Option<String> {
    let system = units.system()?;
    let powers = ["mass/length³", "stress"].map(|dimension| system.power(dimension));
    let pair = Pair { density: region.density, modulus: region.youngs_modulus()?, powers };
    let [density, modulus] = powers;
    if pair.is_known_as(density, modulus) {
        return None;
    }
    let name = region.group.as_deref().unwrap_or("all cells");
    let own = [units.number(pair.density, "mass/length³"), units.number(pair.modulus, "stress")];
    let in_si = [short(shifted(pair.density, density)), short(shifted(pair.modulus, modulus))];
    let in_si = match powers {
        [0, 0] => String::new(),
        _ => format!(" ({} kg/m³ and {} Pa)", in_si[0], in_si[1]),
    };
    let advice = pair.advice().map_or(String::new(), |advice| format!("; write {advice}"));
    Some(format!(
        "region `{name}`: no known solid has a density of {} and a Young's modulus of {}{in_si}{advice}",
        own[0], own[1]
    ))
}

#[cfg(test)]
mod tests {
    use emmy::material::SaintVenantKirchhoff;

    use super::*;
    use crate::units::UnitSystem;

    fn advice(system: &str, density: f64, modulus: f64) -> Option<String> {
        let material = SaintVenantKirchhoff::from_engineering(modulus, 0.3).unwrap();
        let note = note(&Region::new(material, density), UnitSystem::named(system).unwrap().into())?;
        Some(note.split_once("; write ").map_or(String::new(), |(_, advice)| advice.to_string()))
    }

    #[test]
    fn sound_pairs_have_no_note() {
        // Steel, rubber, a soft gel, diamond, osmium (22,590 kg/m³, 550 GPa), a light foam, lead.
        for (density, modulus) in [
            (7850.0, 2.1e11),
            (1000.0, 1e6),
            (1000.0, 2e2),
            (3515.0, 1.14e12),
            (22_590.0, 5.5e11),
            (20.0, 5e6),
            (11_340.0, 1.6e10),
        ] {
            assert_eq!(advice("m-kg-s", density, modulus), None, "{density} {modulus}");
        }
        assert_eq!(advice("mm-kg-ms", 7.85e-6, 210.0), None);
        assert_eq!(advice("um-mg-ms", 2.33e-9, 1.6e5), None);
    }

    #[test]
    fn mixed_units_are_noticed_and_the_number_that_was_meant_is_told() {
        let density = "if the density is meant in";
        let moduli = "if they are meant in";
        for (system, own, modulus, expected) in [
            // Steel, then rubber, with kg/m³ in millimetres.
            ("mm-t-s", 7850.0, 2.1e5, format!("7.85e-9 {density} kg/m³")),
            ("mm-t-s", 1000.0, 1.0, format!("1e-9 {density} kg/m³")),
            ("mm-kg-ms", 7850.0, 210.0, format!("7.85e-6 {density} kg/m³")),
            ("um-mg-ms", 2329.0, 1.3e5, format!("2.329e-9 {density} kg/m³")),
            // g/cm³, also in metres, where 7.85 kg/m³ alone would be a foam.
            ("mm-t-s", 7.85, 2.1e5, format!("7.85e-9 {density} g/cm³")),
            ("m-kg-s", 7.85, 2.1e11, format!("7850 {density} g/cm³")),
            ("m-kg-s", 1.2, 3e9, format!("1200 {density} g/cm³")),
            // The density of another system in millimetres.
            ("mm-kg-ms", 7.85e-9, 210.0, format!("7.85e-6 {density} t/mm³")),
            // GPa, Pa and MPa instead of the unit of stress.
            ("mm-t-s", 7.85e-9, 210.0, format!("moduli multiplied by 1000 {moduli} GPa")),
            ("mm-t-s", 2.7e-9, 70.0, format!("moduli multiplied by 1000 {moduli} GPa")),
            ("mm-t-s", 7.85e-9, 2.1e11, format!("moduli multiplied by 1e-6 {moduli} Pa")),
            ("mm-t-s", 1e-9, 1e6, format!("moduli multiplied by 1e-6 {moduli} Pa")),
            ("m-kg-s", 7850.0, 210.0, format!("moduli multiplied by 1e9 {moduli} GPa")),
            ("m-kg-s", 7850.0, 2.1e5, format!("moduli multiplied by 1e6 {moduli} MPa")),
            ("mm-kg-ms", 7.85e-6, 2.1e5, format!("moduli multiplied by 0.001 {moduli} MPa")),
            // Both.
            (
                "mm-t-s",
                7850.0,
                210.0,
                format!("7.85e-9 {density} kg/m³, and moduli multiplied by 1000 {moduli} GPa"),
            ),
            // Nothing that would make sense.
            ("m-kg-s", 1e-30, 1e30, String::new()),
        ] {
            assert_eq!(advice(system, own, modulus), Some(expected), "{system} {own} {modulus}");
        }
    }

    #[test]
    fn gels_and_polymers_cannot_be_told_apart_and_have_no_note() {
        // PMMA in GPa instead of MPa, and a time in ms: no mistake that can be seen.
        assert_eq!(advice("mm-t-s", 1.19e-9, 3.3), None);
    }
}
