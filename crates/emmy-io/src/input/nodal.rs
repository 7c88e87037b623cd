//! Masses and forces at single nodes: `[[mass]]`, the springs of `[[support]]`, attractions and drags of `[[load]]`.

use emmy::body::{GroundAttraction, GroundSpring, PointMass, PointTerms, Region};
use emmy::internals::time::BodyFeature;

use super::description::{Described, Kind, POSITIVE, Section};
use super::fault::{Fault, Faults, Place};
use super::region::Placed;
use super::support::SUPPORT;
use super::table::{Item, Table};
use super::time::Time;

/// `[[mass]]`.
pub(super) static MASS: Described = Described::new(|| {
    Section::new("[[mass]]", "Point masses")
        .must("group", Kind::Text, "", "Group of nodes, facets or cells")
        .must("mass", POSITIVE, "mass", "Mass at each of its nodes; several entries add up")
});

/// Point terms, with the places of the groups.
#[derive(Debug, Default)]
pub(super) struct PlacedNodal {
    masses: Vec<Placed<PointMass>>,
    springs: Vec<Placed<GroundSpring>>,
    attractions: Vec<Placed<GroundAttraction>>,
    drags: Vec<Placed<f64>>,
}

/// Reads masses and springs, to which attractions and drags are added; each failure stores its fault.
pub(super) fn read(
    root: &Table<'_>,
    attractions: Vec<Placed<GroundAttraction>>,
    drags: Vec<Placed<f64>>,
    faults: &mut Faults,
) -> PlacedNodal {
    PlacedNodal {
        masses: each(root, "mass", None, mass, faults),
        springs: each(root, "support", Some("spring"), spring, faults),
        attractions,
        drags,
    }
}

impl PlacedNodal {
    /// The named groups with their places.
    pub(super) fn groups(&self) -> impl Iterator<Item = &Option<(String, Place)>> {
        let masses = self.masses.iter().map(|mass| &mass.group);
        let springs = self.springs.iter().map(|spring| &spring.group);
        masses.chain(springs).chain(self.attractions.iter().map(|attraction| &attraction.group))
    }

    /// Places of the point masses.
    pub(super) fn places_of_masses(&self) -> impl Iterator<Item = &Place> {
        self.masses.iter().map(|mass| &mass.place)
    }

    /// Sum of the rates of all drags.
    pub(super) fn drag(&self) -> f64 {
        self.drags.iter().map(|drag| drag.value).sum()
    }

    /// Checks that the scheme permits damping.
    pub(super) fn check_damping(&self, regions: &[Placed<Region>], time: &Time) -> Result<(), Fault> {
        if time.scheme.check_feature(BodyFeature::Damping).is_ok() {
            return Ok(());
        }
        let viscous = regions.iter().filter(|region| !region.value.viscosity.is_zero());
        let places = viscous.map(|region| (&region.place, "has a `viscosity`"));
        let Some((place, label)) = places.chain(self.drags.iter().map(|drag| (&drag.place, "a drag"))).next()
        else {
            return Ok(());
        };
        let message = format!("the scheme {} has no damping, which needs a time element", time.scheme.name());
        Err(Fault::at(place, message, label).help("such as scheme = \"DGM\""))
    }

    /// The values without their places.
    pub(super) fn values(self) -> PointTerms {
        PointTerms {
            masses: self.masses.into_iter().map(|mass| mass.value).collect(),
            springs: self.springs.into_iter().map(|spring| spring.value).collect(),
            attractions: self.attractions.into_iter().map(|attraction| attraction.value).collect(),
        }
    }
}

/// Reads the tables of a section, or only the tables with a key.
fn each<T>(
    root: &Table<'_>,
    section: &str,
    key: Option<&str>,
    read: fn(Item<'_>) -> Result<Placed<T>, Fault>,
    faults: &mut Faults,
) -> Vec<Placed<T>> {
    let Some(Ok(items)) = root.get(section).map(|item| item.one_or_more()) else { return Vec::new() };
    let has_key = |item: &Item<'_>| key.is_none_or(|key| item.has_key(key).is_some());
    items.into_iter().filter(has_key).filter_map(|item| faults.keep(read(item))).collect()
}

/// Checks a point mass alone.
pub(super) fn check_mass(item: Item<'_>) -> Result<(), Fault> {
    mass(item).map(drop)
}

/// Checks the spring of a support alone.
pub(super) fn check_spring(item: Item<'_>) -> Result<(), Fault> {
    spring(item).map(drop)
}

fn mass(item: Item<'_>) -> Result<Placed<PointMass>, Fault> {
    let table = item.table(&MASS)?;
    let group = table.require("group")?.name()?;
    let mass = table.require("mass")?.positive()?;
    Placed::new(&table, PointMass { group, mass })
}

/// Whether a support consists of springs only.
pub(super) fn is_spring_alone(item: &Item<'_>) -> bool {
    let has = |key: &str| item.has_key(key).is_some();
    has("spring") && !["fix", "move", "accelerate", "rotate", "symmetry"].into_iter().any(has)
}

fn spring(item: Item<'_>) -> Result<Placed<GroundSpring>, Fault> {
    let table = item.table(&SUPPORT)?;
    let group = table.require("group")?.name()?;
    let stiffness = table.require("spring")?.positive()?;
    if let Some(until) = table.get("until") {
        let message = "`until` cannot be used with `spring`: springs to the ground stay; use a separate support for the components that are released";
        return Err(until.fault(message, "with a spring"));
    }
    Placed::new(&table, GroundSpring { group, stiffness })
}
