//! Masses and forces at single nodes: `[[mass]]`, the springs of `[[support]]`, attractions and drags of `[[load]]`.

use emmy::body::{GroundAttraction, GroundSpring, PointMass, PointTerms, Region, RigidBody, SpreadMass};
use emmy::internals::material::Bounds;
use emmy::time::BodyFeature;

use super::coupling::{self, PlacedCoupling};
use super::description::{Described, Kind, POSITIVE, Section, TAKEN, either, exactly, vector};
use super::fault::{Fault, Place};
use super::placed::{self, Placed};
use super::rigid::{self, PlacedRigid};
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
        .may("at", vector(), "length", "Place of one mass that is coupled to the group, as an engine to its plate")
        .absent("at the nodes of the group")
        .may(
            "coupling",
            Kind::Word("a kind of coupling", coupling::KINDS.to_vec(), |_| None),
            "",
            "With `at`: `rigid`, the group moves as one with the mass; `distributing`, the mass follows the mean of the group",
        )
        .absent("`rigid`")
        .may(
            "inertia",
            either(exactly(3, Kind::Number(Bounds::AtLeast(0.0))), exactly(3, vector())),
            "mass·length²",
            "Inertia about `at`, or about the centre of a rigid body that `group` names: principal moments along x, y and \
             z, or a symmetric matrix",
        )
        .absent("a point")
        .may("name", Kind::Column(&TAKEN), "", "With `at`: its name in joints and as a group, of one node, its place")
        .absent("`mass-1`, `mass-2`, .. by its place")
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

/// The parts of a body that a table of a mass gives.
#[derive(Debug)]
pub(super) enum Read {
    /// A mass at nodes, or spread.
    AtNodes(Placed<Mass>),
    /// A mass that moves rigidly with a group.
    Rigid(PlacedRigid),
    /// A mass that follows the mean of a group.
    Distributing(PlacedCoupling, Placed<Mass>),
    /// Mass and inertia of the rigid body that the group names.
    OfBody { name: String, mass: f64, inertia: [[f64; 3]; 3], place: Place },
}

/// Name of a mass beside its group that has none, by its number from 1.
pub(super) fn name_of(number: usize) -> String {
    format!("mass-{number}")
}

/// Reads one mass; `number` counts masses from 1.
pub(super) fn read(table: &Table<'_>, number: usize) -> Result<Read, Fault> {
    let group = table.must::<Item<'_>>("group").name();
    let [at, coupling, inertia, name] = ["at", "coupling", "inertia", "name"].map(|key| table.item(key));
    if let Some(total) = table.item("total") {
        return match [at, coupling, inertia, name].into_iter().flatten().next() {
            Some(item) => {
                let message =
                    format!("`{}` is a key of one `mass`; `total` is spread over the group", item.key);
                Err(item.fault(message, "not with `total`").label(total.place(), "spread"))
            }
            None => {
                let total = table.must("total");
                Ok(Read::AtNodes(Placed::new(table, Mass::Spread(SpreadMass { group, total }))))
            }
        };
    }
    let mass: f64 = table.must("mass");
    let tensor = inertia.map(rigid::inertia_of).transpose()?;
    let Some(at) = at.and(table.may::<[f64; 3]>("at")) else {
        if let Some(item) = [coupling, name].into_iter().flatten().next() {
            let message = format!("`{}` is a key of a mass with a place", item.key);
            return Err(item.fault(message, "without `at`").help("give its place in `at`"));
        }
        return Ok(match tensor {
            Some(inertia) => Read::OfBody { name: group, mass, inertia, place: table.place.clone() },
            None => Read::AtNodes(Placed::new(table, Mass::Point(PointMass { group, mass }))),
        });
    };
    let name = match name {
        Some(_) => rigid::name(table)?,
        None => name_of(number),
    };
    if coupling.and_then(|item| item.text()) != Some("distributing") {
        let body = RigidBody { mass, centre: Some(at), inertia: tensor, ..RigidBody::group(name, group) };
        return Ok(Read::Rigid(PlacedRigid::of_coupling(table, body)));
    }
    if let Some(inertia) = inertia {
        let message = "a distributing coupling has no rotation, so `inertia` has no effect";
        let help = "take coupling = \"rigid\", or leave `inertia` out";
        return Err(inertia.fault(message, "needs a rigid coupling").help(help));
    }
    let own = Placed::new(table, Mass::Point(PointMass { group: name.clone(), mass }));
    // The group of the mass is the point itself.
    let own = Placed { group: None, ..own };
    Ok(Read::Distributing(PlacedCoupling::new(table, name, at), own))
}

/// The fault of a mass that cannot be spread.
pub(super) fn fault(error: &emmy::Error, groups: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Mass { group, .. } = error else { return None };
    placed::fault(error, group, groups, "cannot be spread over this group")
}
