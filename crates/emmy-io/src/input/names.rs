//! The groups that an input names.

use emmy::body::{InitialVelocity, Load, Region, Support};

use super::contact::PlacedContact;
use super::fault::Place;
use super::mechanism::{self, Mechanism};
use super::nodal::PlacedNodal;
use super::placed::NamedGroup;
use super::placed::{Members, Placed};
use super::quantities::Requested;
use super::tie::PlacedTie;

/// Parts of an input that name groups.
pub(super) struct Naming<'a> {
    pub(super) regions: &'a [Placed<Region>],
    pub(super) loads: &'a [Placed<(Load, Members)>],
    pub(super) supports: &'a [Placed<Support>],
    pub(super) ties: &'a [PlacedTie],
    pub(super) contacts: &'a [PlacedContact],
    pub(super) initial: &'a [Placed<InitialVelocity>],
    pub(super) mechanism: &'a Mechanism,
    pub(super) nodal: &'a PlacedNodal,
    pub(super) requested: Option<&'a Requested>,
}

impl Naming<'_> {
    /// The groups with the members that they need.
    pub(super) fn groups(&self) -> Vec<NamedGroup> {
        let named = |group: &Option<(String, Place)>, members: Members, or_body: bool| {
            let (name, place) = group.clone()?;
            Some(NamedGroup { or_body, ..NamedGroup::of_mesh(name, place, members) })
        };
        let regions = self.regions.iter().map(|region| named(&region.group, Members::Cells, false));
        // The bodies of moments have their own check.
        let of_group = |load: &&Placed<(Load, Members)>| !mechanism::is_moment(&load.value.0);
        let of_load = |load: &Placed<(Load, Members)>| {
            named(&load.group, load.value.1, mechanism::is_for_bodies(&load.value.0))
        };
        let supports = self.supports.iter().map(|support| &support.group);
        let initial = self.initial.iter().map(|initial| &initial.group);
        // The centre of a rigid body is a group of one node.
        let at_nodes = supports.chain(initial).chain(self.nodal.groups());
        let at_nodes = at_nodes.map(|group| named(group, Members::Nodes, true));
        let all = regions.chain(self.loads.iter().filter(of_group).map(of_load)).chain(at_nodes).flatten();
        let tied = self.ties.iter().flat_map(PlacedTie::groups);
        let tied = tied.map(|(name, place, members)| NamedGroup::of_mesh(name, place, members));
        let surfaces = self.contacts.iter().flat_map(PlacedContact::groups);
        let surfaces = surfaces.map(|(name, place)| NamedGroup::of_mesh(name, place, Members::FacetsOrCells));
        let rigid = self.mechanism.groups();
        all.chain(tied)
            .chain(surfaces)
            .chain(rigid)
            .chain(self.requested.into_iter().flat_map(Requested::groups).cloned())
            .collect()
    }
}
