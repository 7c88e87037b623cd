//! Point masses.

use super::RegionSummary;
use crate::error::{Error, Result};
use crate::input::PointMass;
use crate::mesh::Mesh;
use crate::nodal;

/// Point mass of every node, `[n_nodes]`.
pub(crate) fn point_masses(mesh: &Mesh, masses: &[PointMass]) -> Result<Vec<f64>> {
    let mut of_node = vec![0.0; mesh.n_nodes()];
    for PointMass { group, mass } in masses {
        if !(*mass > 0.0 && mass.is_finite()) {
            return Err(Error::NotPositive { what: "point mass".into(), value: *mass });
        }
        mesh.group_nodes(group)?.into_iter().for_each(|node| of_node[node as usize] += mass);
    }
    Ok(of_node)
}

/// A node that is free to move in some direction must have a mass. Only the first nodes are checked: the row sums
/// of rigid bodies, which come last, are zero at the ends of their axes.
pub(crate) fn check_masses(mesh: &Mesh, lumped_mass: &[f64], fixed: &[bool], n_nodes: usize) -> Result<()> {
    let is_lost = |node: &usize| lumped_mass[*node] == 0.0 && nodal::at(fixed, *node).contains(&false);
    match (0..n_nodes).find(is_lost) {
        Some(node) => Err(Error::NoMass { node, position: mesh.points()[node] }),
        None => Ok(()),
    }
}

/// The first `n_own` nodes of a group.
pub(crate) fn own_nodes(mesh: &Mesh, group: &str, n_own: usize) -> Result<Vec<u32>> {
    let mut nodes = mesh.group_nodes(group)?;
    nodes.retain(|&node| (node as usize) < n_own);
    Ok(nodes)
}

/// Mass, centre and inertia of the point masses of a group at the first `n_own` nodes, like a region without cells.
pub(crate) fn summary(mesh: &Mesh, mass: &PointMass, n_own: usize) -> Result<RegionSummary> {
    let nodes = own_nodes(mesh, &mass.group, n_own)?;
    let point = |&node: &u32| RegionSummary::of_point(mass.mass, mesh.points()[node as usize]);
    let points: Vec<RegionSummary> = nodes.iter().map(point).collect();
    Ok(RegionSummary { group: Some(mass.group.clone()), ..RegionSummary::combined(&points) })
}
