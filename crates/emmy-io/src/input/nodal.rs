//! Masses and forces at single nodes: `[[mass]]`, the springs of `[[support]]`, attractions and drags of `[[load]]`.

use emmy::body::{GroundAttraction, GroundSpring, PointMass, PointTerms, Region, SpreadMass};
use emmy::time::BodyFeature;

use super::description::{Described, Kind, POSITIVE, Section};
use super::fault::{Fault, Faults, Place};
use super::region::Placed;
use super::support::SUPPORT;
use super::table::{Item, Table};
use super::time::Time;

/// `[[mass]]`.
pub(super) static MASS: Described = Described::new(|| {
    Section::new("[[mass]]", "Masses besides those of the cells")
        .must("group", Kind::Text, "", "Group of nodes, facets or cells")
        .may("mass", POSITIVE, "mass", "Mass at each of its nodes; several entries add up")
        .may(
            "total",
            POSITIVE,
            "mass",
            "Mass of the whole group, spread evenly over the area of its facets, else over the volume of its cells (the \
             length of links), else over its nodes",
        )
        .exactly_one(&["mass", "total"])
});

/// A mass at each node of a group, or spread over it.
#[derive(Debug)]
enum Mass {
    Point(PointMass),
    Spread(SpreadMass),
}

/// Point terms, with the places of the groups.
#[derive(Debug, Default)]
pub(super) struct PlacedNodal {
    masses: Vec<Placed<Mass>>,
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

    /// The groups of point masses and springs.
    pub(super) fn at_nodes(&self) -> impl Iterator<Item = &Option<(String, Place)>> {
        let points = self.masses.iter().filter(|mass| matches!(mass.value, Mass::Point(_)));
        points.map(|mass| &mass.group).chain(self.springs.iter().map(|spring| &spring.group))
    }

    /// The groups of masses that are spread.
    pub(super) fn spread(&self) -> impl Iterator<Item = &Option<(String, Place)>> {
        self.masses.iter().filter(|mass| matches!(mass.value, Mass::Spread(_))).map(|mass| &mass.group)
    }

    /// The groups of the attractions to the ground.
    pub(super) fn attracted(&self) -> impl Iterator<Item = &Option<(String, Place)>> {
        self.attractions.iter().map(|attraction| &attraction.group)
    }

    /// Places of the masses in their order in the body: point masses, then those that are spread.
    pub(super) fn places_of_masses(&self) -> impl Iterator<Item = &Place> {
        let (points, spread): (Vec<_>, Vec<_>) =
            self.masses.iter().partition(|mass| matches!(mass.value, Mass::Point(_)));
        points.into_iter().chain(spread).map(|mass| &mass.place)
    }

    /// Groups of the masses that are spread, with their places.
    pub(super) fn spread_groups(&self) -> Vec<(String, Place)> {
        self.spread().flatten().cloned().collect()
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
        let (mut masses, mut spread) = (Vec::new(), Vec::new());
        for mass in self.masses {
            match mass.value {
                Mass::Point(mass) => masses.push(mass),
                Mass::Spread(mass) => spread.push(mass),
            }
        }
        PointTerms {
            masses,
            spread,
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

fn mass(item: Item<'_>) -> Result<Placed<Mass>, Fault> {
    let table = item.table(&MASS)?;
    let group = table.require("group")?.name()?;
    let value = table.exactly_one("one size")?;
    let size = value.positive()?;
    let mass = match value.key() {
        "total" => Mass::Spread(SpreadMass { group, total: size }),
        _ => Mass::Point(PointMass { group, mass: size }),
    };
    Placed::new(&table, mass)
}

/// The fault of a mass that cannot be spread, at its group.
pub(super) fn fault(error: &emmy::Error, spread: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Mass { group, .. } = error else { return None };
    let (_, place) = spread.iter().find(|(name, _)| name == group)?;
    Some(Fault::at(place, error.to_string(), "cannot be spread over this group"))
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
