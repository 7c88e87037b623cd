//! `[[coupling]]`: a point that moves with a group, rigidly or with its mean.

use emmy::body::{Coupling, RigidBody};

use super::description::{Described, Kind, POSITIVE, Section, TAKEN, list, vector};
use super::fault::{Fault, Place};
use super::placed::{Members, NamedGroup};
use super::rigid::{self, PlacedRigid};
use super::table::{Item, Table};

/// Kinds of couplings.
pub(super) const KINDS: [&str; 2] = ["rigid", "distributing"];

/// `[[coupling]]`.
pub(super) static COUPLING: Described = Described::new(|| {
    Section::new("[[coupling]]", "A point that moves with a group of the mesh")
        .must(
            "name",
            Kind::Column(&TAKEN),
            "",
            "Its name, and that of a group of one node, the point: letters, digits, `_` and `-`",
        )
        .must("group", Kind::Text, "", "Group of facets, nodes or cells")
        .must("point", vector(), "length", "The point, on the group or off it")
        .must(
            "kind",
            Kind::Word("a kind of coupling", KINDS.to_vec(), |_| None),
            "",
            "`rigid`: the group and the point are one rigid body (RBE2); `distributing`: the point follows the mean of \
             the group, which keeps its freedom to deform (RBE3)",
        )
        .may(
            "weights",
            list(1, POSITIVE),
            "",
            "With `distributing`: weights of the nodes, in the order of their numbers",
        )
        .absent("areas of facets, else equal")
});

/// A distributing coupling with the places of its table, its name and its group.
#[derive(Debug)]
pub(super) struct PlacedCoupling {
    pub(super) coupling: Coupling,
    pub(super) place: Place,
    pub(super) name: Place,
    group: Place,
}

/// A coupling of either kind.
#[derive(Debug)]
pub(super) enum Read {
    Rigid(PlacedRigid),
    Distributing(PlacedCoupling),
}

impl PlacedCoupling {
    /// The coupling of a table in which the name stands, or not.
    pub(super) fn new(table: &Table<'_>, name: String, point: [f64; 3]) -> Self {
        let group: Item<'_> = table.must("group");
        PlacedCoupling {
            coupling: Coupling::new(name, group.name(), point),
            name: table.item("name").map_or(table.place, |item| item.place()).clone(),
            place: table.place.clone(),
            group: group.place().clone(),
        }
    }

    /// Its group.
    pub(super) fn group(&self) -> NamedGroup {
        NamedGroup::of_mesh(self.coupling.group.clone(), self.group.clone(), Members::Nodes)
    }
}

/// Reads one coupling.
pub(super) fn read(table: &Table<'_>) -> Result<Read, Fault> {
    let name = rigid::name(table)?;
    let point = table.must("point");
    let weights = table.item("weights");
    if table.must::<Item<'_>>("kind").text() == Some("distributing") {
        let own = PlacedCoupling::new(table, name, point);
        let weights = weights.and_then(|_| table.may::<Vec<f64>>("weights"));
        return Ok(Read::Distributing(PlacedCoupling {
            coupling: Coupling { weights, ..own.coupling },
            ..own
        }));
    }
    if let Some(weights) = weights {
        let message = "`weights` are those of a distributing coupling; a rigid one has none";
        return Err(weights.fault(message, "of no use here"));
    }
    let group: Item<'_> = table.must("group");
    let body = RigidBody { centre: Some(point), ..RigidBody::group(name, group.name()) };
    Ok(Read::Rigid(PlacedRigid::of_coupling(table, body)))
}

/// The fault of an impossible coupling.
pub(super) fn fault(error: &emmy::Error, placed: &[PlacedCoupling]) -> Option<Fault> {
    let emmy::Error::Coupling { coupling, .. } = error else { return None };
    let own = placed.iter().find(|own| own.coupling.name == *coupling)?;
    Some(Fault::at(&own.place, error.to_string(), "this coupling"))
}
