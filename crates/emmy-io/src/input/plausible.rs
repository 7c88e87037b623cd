//! Remarks on numbers that are a sign of mixed units: densities and moduli that no known solid has, lengths of a mesh
//! in another unit, loads beyond the stiffness of every region.

use std::ops::RangeInclusive;

use emmy::body::{Load, LoadKind, Region};
use emmy::internals::number::short;
use emmy::mesh::{Facet, Mesh};

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
pub(super) const DENSITIES: [(&str, i32); 4] = [("kg/m³", 0), ("g/cm³", 3), ("kg/mm³", 9), ("t/mm³", 12)];

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

/// Largest extent of a mesh in mm below which it is probably in m, and in m above which it is in mm.
const LENGTHS: [(i32, f64, &str, &str); 2] = [(-3, 0.3, "m", "1000"), (0, 1000.0, "mm", "0.001")];

/// A remark on a mesh that is probably in another unit of length than the input.
pub(super) fn note_on_size(mesh: &Mesh, units: Units) -> Option<String> {
    let system = units.system().filter(|_| mesh.n_cells() > 0)?;
    let power = system.power("length");
    let size = length(mesh);
    let (_, _, other, scale) = LENGTHS
        .into_iter()
        .find(|&(own, bound, ..)| own == power && if own < 0 { size < bound } else { size > bound })?;
    Some(format!(
        "the mesh is {} long, are the units right? `scale = {scale}` in `[mesh]` reads it as {other}",
        units.number(size, "length")
    ))
}

/// Stress over Young's modulus that no solid bears.
const LARGEST_STRAIN: f64 = 10.0;

/// Remarks on loads whose force per area is far beyond the stiffness of every region.
pub(super) fn notes_on_loads<'a>(
    mesh: &Mesh,
    loads: impl Iterator<Item = &'a Load>,
    regions: &[&Region],
    units: Units,
) -> Vec<String> {
    let moduli: Option<Vec<f64>> =
        regions.iter().filter(|own| own.link().is_none()).map(|own| own.youngs_modulus()).collect();
    let Some(modulus) = moduli.and_then(|own| own.into_iter().reduce(f64::max)) else { return Vec::new() };
    let density = regions.iter().map(|own| own.density).fold(0.0, f64::max);
    let size = |vector: &[f64; 3]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    let note = |load: &Load| {
        let (group, stress, over) = match &load.kind {
            LoadKind::Traction { group, traction } => (Some(group), size(traction), ""),
            LoadKind::Pressure { group, pressure } => (Some(group), pressure.abs(), ""),
            LoadKind::Force { group, force } => (Some(group), size(force) / area_of(mesh, group)?, ""),
            LoadKind::NodalForce { group, force } => {
                let force = size(force) * mesh.group_nodes(group).ok()?.len() as f64;
                match area_of(mesh, group) {
                    Some(area) => (Some(group), force / area, ""),
                    None => (Some(group), force / section(mesh), " of the largest section"),
                }
            }
            LoadKind::BodyForceField { group, field } => {
                let force = size(&field.at(mesh.points()[0], 0.0));
                (group.as_ref(), force * length(mesh), " over the length of the mesh")
            }
            LoadKind::Acceleration { group, acceleration } => {
                // The name of a rigid body is none of a group.
                group.as_ref().map_or(Ok(&[][..]), |group| mesh.groups().cells(group)).ok()?;
                let force = density * size(acceleration);
                (group.as_ref(), force * length(mesh), " over the length of the mesh")
            }
            LoadKind::Rotation { speed, .. } => {
                let stress = density * (speed * length(mesh)).powi(2);
                (None, stress, " over the length of the mesh")
            }
            LoadKind::Moment { .. }
            | LoadKind::FollowingForce { .. }
            | LoadKind::TractionField { .. }
            | LoadKind::AccelerationField { .. } => return None,
        };
        let is_too_large = stress.is_finite() && stress > LARGEST_STRAIN * modulus;
        let group = group.map_or("all cells".to_string(), |group| format!("`{group}`"));
        is_too_large.then(|| {
            format!(
                "load on {group}: {} per area{over}, and the largest Young's modulus is {}, are the units right?",
                units.number(stress, "stress"),
                units.number(modulus, "stress")
            )
        })
    };
    loads.filter_map(note).collect()
}

/// Largest extent of a mesh.
fn length(mesh: &Mesh) -> f64 {
    mesh.extent().into_iter().fold(0.0, f64::max)
}

/// Largest face of the box around a mesh; of a mesh in a plane its length, times the thickness 1.
fn section(mesh: &Mesh) -> f64 {
    let mut extent = mesh.extent();
    extent.sort_by(f64::total_cmp);
    if extent[0] > 0.0 { extent[1] * extent[2] } else { extent[2] }
}

/// Area of a group of facets.
fn area_of(mesh: &Mesh, group: &str) -> Option<f64> {
    let facets = mesh.groups().facets(group).ok()?;
    Some(facets.iter().map(|&facet| area(mesh, facet)).sum())
}

/// Area of the polygon of a facet's corners; of an edge its length, times the thickness 1.
fn area(mesh: &Mesh, facet: Facet) -> f64 {
    let n = mesh.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind.n_corners();
    let corners: Vec<[f64; 3]> =
        mesh.facet_nodes(facet).take(n).map(|node| mesh.points()[node as usize]).collect();
    let from = |i: usize| [0, 1, 2].map(|d| corners[i][d] - corners[0][d]);
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if n == 2 {
        return length(from(1));
    }
    let normals = (2..n).map(|i| {
        let (a, b) = (from(i - 1), from(i));
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    });
    0.5 * length(normals.fold([0.0; 3], |sum, own| [0, 1, 2].map(|d| sum[d] + own[d])))
}

#[cfg(test)]
mod tests {
    use emmy::body::Field;
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

    #[test]
    fn lengths_in_another_unit_are_told() {
        let note = |system: &str, edge: f64| {
            let mesh = emmy::mesh::block([edge; 3], [1; 3]).unwrap();
            note_on_size(&mesh, Units::from(UnitSystem::named(system).unwrap()))
        };
        // A volume of 2e-6 mm^3, and a beam of 12 m in mm.
        let tiny = note("mm-t-s", 2e-6f64.cbrt()).unwrap();
        assert!(tiny.contains("are the units right? `scale = 1000` in `[mesh]` reads it as m"), "{tiny}");
        assert!(note("m-kg-s", 12_000.0).unwrap().contains("`scale = 0.001` in `[mesh]` reads it as mm"));
        for (system, edge) in [("mm-t-s", 0.5), ("mm-t-s", 1e5), ("m-kg-s", 1e-6), ("um-mg-ms", 0.05)] {
            assert_eq!(note(system, edge), None, "{system} {edge}");
        }
        assert_eq!(note_on_size(&emmy::mesh::block([1e-9; 3], [1; 3]).unwrap(), Units::default()), None);
    }

    #[test]
    fn loads_beyond_every_stiffness_are_told() {
        let steel = Region::new(SaintVenantKirchhoff::from_engineering(2.1e5, 0.3).unwrap(), 7.85e-9);
        // Areas of 1 and 1e12: the rule is one for small and large bodies.
        for edge in [1.0, 1e6] {
            let mesh = emmy::mesh::block([edge; 3], [2; 3]).unwrap();
            let notes = |load: Load| notes_on_loads(&mesh, [load].iter(), &[&steel], Units::default());
            let force = |stress: f64| Load::force("x-max", [0.0, 0.0, stress * edge * edge]);
            assert_eq!(notes(force(1e9)).len(), 1);
            assert!(notes(force(1e9))[0].ends_with("are the units right?"));
            assert_eq!(notes(force(1e5)), [""; 0]);
            assert_eq!(notes(Load::pressure("x-max", 3e6)).len(), 1);
            assert_eq!(notes(Load::traction("x-max", [1e6, 0.0, 0.0])), [""; 0]);
            // 9 nodes of a face, 27 of all cells, a weight over the length.
            let nodal = |group: &str, stress: f64| Load::nodal_force(group, [stress * edge * edge, 0.0, 0.0]);
            assert_eq!(notes(nodal("x-max", 3e6 / 9.0)).len(), 1);
            assert_eq!(notes(nodal("x-max", 1e6 / 9.0)), [""; 0]);
            assert_eq!(notes(nodal("body", 3e6 / 27.0)).len(), 1);
            assert_eq!(notes(nodal("body", 1e6 / 27.0)), [""; 0]);
            let pull = |stress: f64| Load::acceleration([0.0, 0.0, stress / 7.85e-9 / edge]);
            assert_eq!(notes(pull(3e6)).len(), 1);
            assert_eq!(notes(pull(1e6)), [""; 0]);
            let force = |stress: f64| {
                let field = Field::new(move |_, _| [0.0, stress / edge, 0.0]);
                Load::new(LoadKind::BodyForceField { group: None, field })
            };
            assert_eq!(notes(force(3e6)).len(), 1);
            assert_eq!(notes(force(1e6)), [""; 0]);
        }
    }
}
