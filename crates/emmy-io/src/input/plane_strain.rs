//! Remarks on what would move cells in plane strain out of their plane.

use emmy::body::{InitialVelocity, Load, LoadKind};
use emmy::mesh::Mesh;

/// Remarks on loads and initial velocities along z on cells in plane strain, whose nodes do not move along z.
pub(super) fn notes<'a>(
    mesh: &Mesh,
    loads: impl Iterator<Item = &'a Load>,
    initial: impl Iterator<Item = &'a InitialVelocity>,
) -> Vec<String> {
    let mut is_plane = vec![false; mesh.n_nodes()];
    for cell in mesh.cells().filter(|cell| cell.kind.dimension() == 2) {
        cell.nodes.iter().for_each(|node| is_plane[*node as usize] = true);
    }
    if !is_plane.contains(&true) {
        return Vec::new();
    }
    let note = |what: &str, group: Option<&String>, along_z: &dyn Fn(usize) -> bool| {
        let nodes = match group {
            // A name of a rigid body is none of a group.
            Some(group) => mesh.group_nodes(group).ok()?,
            None => (0..mesh.n_nodes() as u32).collect(),
        };
        let acting: Vec<usize> =
            nodes.into_iter().map(|node| node as usize).filter(|&node| along_z(node)).collect();
        if acting.is_empty() || acting.iter().any(|&node| !is_plane[node]) {
            return None;
        }
        let group = group.map_or(String::new(), |group| format!(" of `{group}`"));
        Some(format!("{what}{group}: z is without effect, since cells in plane strain do not move along it"))
    };
    let load = |load: &Load| {
        let point = |node: usize| mesh.points()[node];
        let (group, along_z): (_, &dyn Fn(usize) -> bool) = match &load.kind {
            LoadKind::Traction { group, traction: vector }
            | LoadKind::Force { group, force: vector }
            | LoadKind::NodalForce { group, force: vector } => (Some(group), &|_| vector[2] != 0.0),
            LoadKind::Acceleration { group, acceleration } => (group.as_ref(), &|_| acceleration[2] != 0.0),
            LoadKind::TractionField { group, field } => {
                (Some(group), &|node| field.at(point(node), 0.0)[2] != 0.0)
            }
            LoadKind::BodyForceField { group, field } | LoadKind::AccelerationField { group, field } => {
                (group.as_ref(), &|node| field.at(point(node), 0.0)[2] != 0.0)
            }
            _ => return None,
        };
        note("load", group, along_z)
    };
    let start = |own: &InitialVelocity| {
        note("initial velocity", own.group.as_ref(), &|node| own.at(mesh.points()[node])[2] != 0.0)
    };
    loads.filter_map(load).chain(initial.filter_map(start)).collect()
}
