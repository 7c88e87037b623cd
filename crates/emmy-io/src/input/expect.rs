//! `[expect]`: the mass and the volume that a body must have, so that a number in a wrong unit is found at once.

use emmy::body::Body;
use emmy::internals::number::short;

use super::description::{BELOW_ONE, Described, POSITIVE, Section};
use super::fault::{Fault, Faults, Place};
use super::plausible::DENSITIES;
use super::table::{Item, Read, Table};
use crate::units::{Units, shifted, written};

/// `[expect]`.
pub(super) static EXPECT: Described = Described::new(|| {
    Section::new("[expect]", "Mass and volume that the whole body must have; others are an error")
        .may("mass", POSITIVE, "mass", "Mass of cells, masses and rigid bodies together")
        .may("volume", POSITIVE, "length³", "Volume of all cells")
        .may("tolerance", BELOW_ONE, "", "Largest relative difference")
        .default("1e-3")
        .at_least_one(&["mass", "volume"])
});

/// Numbers that a body must have.
#[derive(Debug, Default)]
pub(super) struct Expected {
    mass: Option<(f64, Place)>,
    volume: Option<(f64, Place)>,
    tolerance: f64,
}

pub(super) fn read(table: &Table<'_>) -> Expected {
    let number = |key| table.item(key).map(|item: Item<'_>| (f64::read(item), item.place().clone()));
    Expected { mass: number("mass"), volume: number("volume"), tolerance: table.must("tolerance") }
}

impl Expected {
    /// Compares with a body; a call of all ranks of a team.
    pub(super) fn check(&self, body: &Body, units: Units, faults: &mut Faults) {
        let [mass, volume] = body.mass_and_volume();
        let by_volume = self.volume.as_ref().map(|(expected, _)| volume / expected);
        if let Some((expected, place)) = &self.volume {
            let advice = power_of_1000(volume / expected).map(of_lengths);
            let words = ["volume", "length³"];
            faults.keep(self.compare(words, [volume, *expected], place, units, advice));
        }
        if let Some((expected, place)) = &self.mass {
            // A wrong volume explains its part of the mass.
            // A single mass may outweigh the cells.
            let heaviest = body.regions().iter().max_by(|a, b| a.mass.total_cmp(&b.mass));
            let is_single = heaviest.is_some_and(|own| own.n_cells == 0);
            let what = if is_single { "a mass" } else { "the density" };
            let advice = power_of_1000(mass / expected / by_volume.unwrap_or(1.0)).map(|power| {
                match of_densities(what, power) {
                    density if by_volume.is_none() && power % 9 == 0 => {
                        format!("{density}; or {}", of_lengths(power))
                    }
                    density => density,
                }
            });
            faults.keep(self.compare(["mass", "mass"], [mass, *expected], place, units, advice));
        }
    }

    fn compare(
        &self,
        [what, dimension]: [&str; 2],
        [found, expected]: [f64; 2],
        place: &Place,
        units: Units,
        advice: Option<String>,
    ) -> Result<(), Fault> {
        let ratio = found / expected;
        if (ratio - 1.0).abs() <= self.tolerance {
            return Ok(());
        }
        let numbers = [found, expected].map(|value| units.number(value, dimension));
        let message = format!(
            "the {what} of the body is {}, but {} is expected: {} times as much",
            numbers[0],
            numbers[1],
            short(ratio)
        );
        let fault = Fault::at(place, message, format!("the body has {}", numbers[0]));
        Err(advice.into_iter().fold(fault, Fault::help))
    }
}

/// The power of ten of a ratio that is within a tenth of a decade of a power of 1000, but not of 1.
fn power_of_1000(ratio: f64) -> Option<i32> {
    let power = ratio.log10();
    let nearest = 3.0 * (power / 3.0).round();
    ((power - nearest).abs() < 0.1 && nearest != 0.0).then_some(nearest as i32)
}

/// Units of length, and their powers of ten in m.
const LENGTHS: [(&str, i32); 4] = [("m", 0), ("mm", -3), ("cm", -2), ("µm", -6)];

/// Advice where a volume is wrong by a power of ten.
fn of_lengths(power: i32) -> String {
    let units = mistaken(&LENGTHS, power / 3)
        .map_or(String::new(), |[given, meant]| format!(", as if they were in {given} in place of {meant}"));
    let factor = written(shifted(1.0, -power / 3));
    format!(
        "the lengths of the mesh are probably in a wrong unit{units}: `mesh.scale` multiplies them, here by {factor}"
    )
}

/// Advice where a density is wrong by a power of ten.
fn of_densities(what: &str, power: i32) -> String {
    let units = mistaken(&DENSITIES, power).filter(|_| what == "the density");
    let units = units
        .map_or(String::new(), |[given, meant]| format!(", as if it were in {given} in place of {meant}"));
    format!("{what} is probably in a wrong unit{units}: multiply it by {}", written(shifted(1.0, -power)))
}

/// The first unit in which a number is larger by a power of ten than in another one, and this one.
fn mistaken<const N: usize>(units: &[(&'static str, i32); N], power: i32) -> Option<[&'static str; 2]> {
    let pairs = units.iter().flat_map(|given| units.iter().map(move |meant| (given, meant)));
    let mut pairs = pairs.filter(|(given, meant)| meant.1 - given.1 == power);
    pairs.next().map(|(given, meant)| [given.0, meant.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_1000_are_found() {
        assert_eq!(
            [1.0, 1.2, 950.0, 1.05e-9, 5.0, 100.0].map(power_of_1000),
            [None, None, Some(3), Some(-9), None, None]
        );
    }

    #[test]
    fn units_that_were_mistaken_are_named() {
        // A length of 1 m is 1000 mm; 7850 kg/m³ is 7.85 g/cm³, and 7.85e-9 t/mm³.
        assert_eq!(mistaken(&LENGTHS, 3), Some(["mm", "m"]));
        assert_eq!(mistaken(&LENGTHS, -3), Some(["m", "mm"]));
        assert_eq!(mistaken(&LENGTHS, 2), Some(["cm", "m"]));
        assert_eq!(mistaken(&DENSITIES, 3), Some(["kg/m³", "g/cm³"]));
        assert_eq!(mistaken(&DENSITIES, 12), Some(["kg/m³", "t/mm³"]));
        assert_eq!(mistaken(&DENSITIES, -9), Some(["kg/mm³", "kg/m³"]));
        assert_eq!(mistaken(&DENSITIES, 15), None);
    }
}
