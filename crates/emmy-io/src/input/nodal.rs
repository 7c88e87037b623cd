//! Masses and forces at single nodes: `[[mass]]`, the springs of `[[support]]`, attractions and drags of `[[load]]`.

use emmy::body::{GroundAttraction, GroundSpring, PointMass, PointTerms, Region, SpreadMass};
use emmy::time::BodyFeature;

use super::description::{Described, Kind, POSITIVE, Section};
use super::fault::{Fault, Place};
use super::placed::{self, Placed};
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
pub(super) enum Mass {
    Point(PointMass),
    Spread(SpreadMass),
}

/// Point terms, with the places of the groups.
#[derive(Debug, Default)]
pub(super) struct PlacedNodal {
    pub(super) masses: Vec<Placed<Mass>>,
    pub(super) springs: Vec<Placed<GroundSpring>>,
    pub(super) attractions: Vec<Placed<GroundAttraction>>,
    pub(super) drags: Vec<Placed<f64>>,
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

    /// Places of the point masses, and of those that are spread.
    pub(super) fn places_of_masses(&self) -> [Vec<&Place>; 2] {
        let is_point = |mass: &&Placed<Mass>| matches!(mass.value, Mass::Point(_));
        let (points, spread): (Vec<_>, Vec<_>) = self.masses.iter().partition(is_point);
        [points, spread].map(|masses| masses.into_iter().map(|mass| &mass.place).collect())
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

/// Reads one mass.
pub(super) fn read(table: &Table<'_>) -> Placed<Mass> {
    let group = table.must::<Item<'_>>("group").name();
    let mass = match table.may("total") {
        Some(total) => Mass::Spread(SpreadMass { group, total }),
        None => Mass::Point(PointMass { group, mass: table.must("mass") }),
    };
    Placed::new(table, mass)
}

/// The fault of a mass that cannot be spread.
pub(super) fn fault(error: &emmy::Error, groups: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Mass { group, .. } = error else { return None };
    placed::fault(error, group, groups, "cannot be spread over this group")
}
