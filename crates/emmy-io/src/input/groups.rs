//! Names of groups against the groups of the mesh, and regions against its cells.

use std::collections::HashSet;

use emmy::body::{InitialVelocity, Load, Region, Support};
use emmy::mesh::Mesh;

use super::fault::{Fault, Faults, Place};
use super::mechanism::Mechanism;
use super::nodal::PlacedNodal;
use super::placed::{Members, NamedGroup, Placed};
use super::suggest::{did_you_mean, listed};
use super::tie::PlacedTie;

/// Checks that the mesh has the groups that are named, or that they are some of the names of rigid bodies.
pub(super) fn check(mesh: &Mesh, named: &[NamedGroup], bodies: &[&str], faults: &mut Faults) {
    let mut places = HashSet::new();
    for group in named {
        // A support and its spring share one name, which is checked once.
        if !faults.are_many() && places.insert(group.place.id()) {
            faults.keep(find(mesh, group, bodies));
        }
    }
}

/// Advice on a rigid body in place of a group of cells or facets.
const NO_GROUP: &str = "the name of a rigid body is a group of one node, its centre; `force` takes it, too";

fn find(mesh: &Mesh, group: &NamedGroup, bodies: &[&str]) -> Result<(), Fault> {
    let NamedGroup { name, place, members, or_body } = group;
    let (members, is_body) = (*members, bodies.contains(&name.as_str()));
    let groups = mesh.groups();
    let is_there = !groups.kinds(name).is_empty();
    if is_body && !is_there {
        let message = format!("`{name}` is a rigid body, and has neither cells nor facets");
        return if *or_body { Ok(()) } else { Err(Fault::at(place, message, "a rigid body").help(NO_GROUP)) };
    }
    let is_empty = match members {
        Members::Cells => groups.cells(name).ok().map(<[_]>::is_empty),
        Members::Facets => groups.facets(name).ok().map(<[_]>::is_empty),
        Members::FacetsOrCells => {
            let cells = || groups.cells(name).ok().map(<[_]>::is_empty);
            groups.facets(name).ok().map(<[_]>::is_empty).or_else(cells)
        }
        Members::Nodes => is_there.then(|| mesh.group_nodes(name).is_err()),
    };
    match is_empty {
        Some(true) => return Err(Fault::at(place, format!("group `{name}` is empty"), "empty")),
        Some(false) => return Ok(()),
        None => {}
    }
    let (what, known): (_, Vec<&str>) = match members {
        Members::Cells => ("cells", groups.cells.keys().map(String::as_str).collect()),
        Members::Facets => ("facets", groups.facets.keys().map(String::as_str).collect()),
        Members::FacetsOrCells => {
            let kinds = |name: &&str| groups.kinds(name).iter().any(|kind| *kind != "nodes");
            ("facets or cells", groups.names().into_iter().filter(kinds).collect())
        }
        Members::Nodes => ("nodes, facets or cells", groups.names()),
    };
    let other = is_there.then(|| format!("`{name}` exists, but has no {what}"));
    let bodies = if *or_body { bodies } else { &[] };
    let label = other.or_else(|| near(mesh, name, members));
    let label = label.or_else(|| did_you_mean(name, bodies.iter().copied()));
    let label = label.unwrap_or_else(|| "not there".into());
    let groups = format!("groups of {what}: {}", listed(known.iter().copied()));
    let (message, help) = match bodies {
        [] => (format!("the mesh has no group `{name}` of {what}"), groups),
        _ => (
            format!("there is no rigid body `{name}`, and the mesh has no such group of {what}"),
            format!("rigid bodies: {}; {groups}", listed(bodies.iter().copied())),
        ),
    };
    let known: Vec<&str> = known.iter().chain(bodies).copied().collect();
    Err(Fault::at(place, message, label).help(help).of_group(name, &known))
}

/// "did you mean ...?" with the group nearest to a name, which may choose a kind of members (`facets:left`).
pub(super) fn near(mesh: &Mesh, name: &str, members: Members) -> Option<String> {
    let groups = mesh.groups();
    let fits = |kind: &&str| match members {
        Members::Cells => *kind == "cells",
        Members::Facets => *kind == "facets",
        Members::FacetsOrCells => *kind != "nodes",
        Members::Nodes => true,
    };
    let mut known: Vec<String> = Vec::new();
    for own in groups.names() {
        let mut kinds = groups.kinds(own).into_iter().filter(fits).peekable();
        known.extend(kinds.peek().map(|_| own.to_string()));
        known.extend(kinds.filter(|_| name.contains(':')).map(|kind| format!("{kind}:{own}")));
    }
    did_you_mean(name, known.iter().map(String::as_str))
}

/// Where the nodes of a group are taken, and the kinds of its members in the order in which they are.
const NODES: [(&str, [&str; 3]); 8] = [
    ("support", ["facets", "nodes", "cells"]),
    ("tie", ["facets", "nodes", "cells"]),
    ("rigid body", ["facets", "nodes", "cells"]),
    ("force at each node", ["facets", "nodes", "cells"]),
    ("mass or spring", ["facets", "nodes", "cells"]),
    ("spread mass", ["facets", "cells", "nodes"]),
    ("initial velocity", ["cells", "facets", "nodes"]),
    ("attraction", ["cells", "facets", "nodes"]),
];

/// Notes on names of several kinds of members, which would be other nodes.
pub(super) fn notes<'a>(
    mesh: &Mesh,
    loads: &'a [Placed<(Load, Members)>],
    supports: &'a [Placed<Support>],
    ties: &'a [PlacedTie],
    mechanism: &'a Mechanism,
    initial: &'a [Placed<InitialVelocity>],
    nodal: &'a PlacedNodal,
) -> Vec<String> {
    let [support, tie, rigid, force, mass, spread, velocity, attraction] = NODES;
    let nodal_forces = loads.iter().filter(|load| load.value.1 == Members::Nodes);
    let mut named: Vec<(&str, &'a str, [&str; 3])> = Vec::new();
    let name = |group: &'a Option<(String, Place)>| group.as_ref().map(|(name, _)| name.as_str());
    let of = |(what, order): (&'static str, _)| move |name| (what, name, order);
    named.extend(supports.iter().filter_map(|support| name(&support.group)).map(of(support)));
    named.extend(ties.iter().flat_map(PlacedTie::names).map(of(tie)));
    named.extend(mechanism.names_of_groups().map(of(rigid)));
    named.extend(nodal_forces.filter_map(|load| name(&load.group)).map(of(force)));
    named.extend(nodal.at_nodes().filter_map(name).map(of(mass)));
    named.extend(nodal.spread().filter_map(name).map(of(spread)));
    named.extend(initial.iter().filter_map(|initial| name(&initial.group)).map(of(velocity)));
    named.extend(nodal.attracted().filter_map(name).map(of(attraction)));
    named.sort_unstable();
    named.dedup();
    named.into_iter().filter_map(|(what, name, order)| note(mesh, what, name, order)).collect()
}

fn note(mesh: &Mesh, what: &str, name: &str, order: [&str; 3]) -> Option<String> {
    let kinds = mesh.groups().kinds(name);
    let nodes = |kind: &str| mesh.group_nodes(&format!("{kind}:{name}")).ok();
    let mut found =
        order.into_iter().filter(|kind| kinds.contains(kind)).filter_map(|kind| Some((kind, nodes(kind)?)));
    let (meant, own) = found.next()?;
    let others = found.filter(|(_, nodes)| *nodes != own);
    let others: Vec<&str> = others.map(|(kind, _)| kind).collect();
    let other = *others.first()?;
    Some(format!(
        "`{name}` is a group of {meant} and of {}: {what} means the {meant}; `{other}:{name}` would be the {other}",
        others.join(" and of ")
    ))
}

/// Checks that every cell is in exactly one region.
pub(super) fn check_regions(mesh: &Mesh, regions: &[Placed<Region>]) -> Result<(), Fault> {
    const NONE: u32 = u32::MAX;
    let mut region_of = vec![NONE; mesh.n_cells()];
    for (index, region) in regions.iter().enumerate() {
        let members = cells(mesh, region, regions.len())?;
        if region.value.thickness != 1.0 && members.iter().all(|&cell| mesh.cell(cell).kind.dimension() != 2)
        {
            let message = "`thickness` needs cells in plane strain, and this region has none";
            return Err(Fault::at(&region.place, message, "leave `thickness` out"));
        }
        for cell in members {
            let kind = mesh.cell(cell).kind;
            if region.value.link().is_some() != (kind.dimension() == 1) {
                let message = format!("cell {cell} is a {kind}");
                let help = "links (line2) need `bar`, `spring` or `attraction` as their material, and no other cells do";
                return Err(Fault::at(&region.place, message, "not for this material").help(help));
            }
            let before = std::mem::replace(&mut region_of[cell], index as u32);
            if before != NONE {
                let message = format!("cell {cell} belongs to two regions");
                let fault = Fault::at(&region.place, message, "second");
                return Err(fault.label(&regions[before as usize].place, "first"));
            }
        }
    }
    let outside = region_of.iter().filter(|&&region| region == NONE).count();
    match outside {
        0 => Ok(()),
        n => {
            let last = &regions[regions.len() - 1].place;
            let message = format!("{n} of {} cells belong to no region", mesh.n_cells());
            let help = format!("groups of cells: {}", listed(mesh.groups().cells.keys().map(String::as_str)));
            Err(Fault::at(last, message, "the last region").help(help))
        }
    }
}

/// Cells of a region.
pub(super) fn cells(mesh: &Mesh, region: &Placed<Region>, n_regions: usize) -> Result<Vec<usize>, Fault> {
    match &region.group {
        Some((name, _)) => {
            Ok(mesh.groups().cells(name).into_iter().flatten().map(|&cell| cell as usize).collect())
        }
        None if n_regions == 1 => Ok((0..mesh.n_cells()).collect()),
        None => {
            let message = "`group` may be left out only where there is one region";
            Err(Fault::at(&region.place, message, "needs `group`"))
        }
    }
}
