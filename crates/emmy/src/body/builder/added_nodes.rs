//! Nodes that a body adds to its mesh: points of distributing couplings, and those of rigid bodies.

use std::collections::HashSet;

use super::BodyBuilder;
use crate::error::{Error, Result};
use crate::input::{Coupling, JointEnd, PointTerms, Region, RigidBody};
use crate::mass::RegionOfCell;
use crate::mesh::{Cell, Mesh};
use crate::space::CoupledPoint;
use crate::space::geometry::for_each_volume_point;
use crate::unknowns::Frame;

impl BodyBuilder {
    /// Adds the points of the couplings to the mesh.
    pub(super) fn points(&mut self) -> Result<Vec<CoupledPoint>> {
        let BodyBuilder { mesh, couplings, regions, .. } = self;
        if couplings.is_empty() {
            return Ok(Vec::new());
        }
        let first = mesh.n_nodes() as u32;
        for Coupling { name, point, .. } in &*couplings {
            mesh.add_nodes(name, std::iter::once(*point))?;
        }
        let section = RegionOfCell::new(mesh, regions)?.sections(mesh, regions);
        // A joint of the point is one of its node.
        for end in self.joints.iter_mut().flat_map(|joint| &mut joint.between) {
            let JointEnd::Rigid(name) = end else { continue };
            if let Some(at) = couplings.iter().position(|coupling| coupling.name == *name) {
                *end = JointEnd::Node(first + at as u32);
            }
        }
        let busy = self.busy_nodes();
        let BodyBuilder { mesh, couplings, .. } = self;
        let point = |(coupling, node): (&Coupling, u32)| {
            CoupledPoint::new(coupling, node, (mesh, &section), busy.contains(&node))
        };
        couplings.iter().zip(first..).map(point).collect()
    }

    /// Nodes with a mass, a spring, a support or a joint.
    fn busy_nodes(&self) -> HashSet<u32> {
        let BodyBuilder { mesh, point_terms, supports, joints, .. } = self;
        let PointTerms { masses, spread, springs, .. } = point_terms;
        let groups = masses.iter().map(|mass| &mass.group).chain(spread.iter().map(|mass| &mass.group));
        let groups = groups.chain(springs.iter().map(|spring| &spring.group));
        let mut nodes = HashSet::new();
        for group in groups.chain(supports.iter().map(|support| &support.group)) {
            // The groups of rigid bodies are not there yet.
            nodes.extend(mesh.group_nodes(group).into_iter().flatten());
        }
        for end in joints.iter().flat_map(|joint| &joint.between) {
            nodes.extend(if let JointEnd::Node(node) = end { Some(*node) } else { None });
        }
        nodes
    }

    /// Whether each node is in the group of a support.
    pub(super) fn held_nodes(&self) -> Result<Vec<bool>> {
        let mut held = vec![false; self.mesh.n_nodes()];
        for support in self.supports.iter().filter(|_| !self.couplings.is_empty()) {
            self.mesh.group_nodes(&support.group)?.into_iter().for_each(|node| held[node as usize] = true);
        }
        Ok(held)
    }

    /// Adds the nodes of the rigid bodies to the mesh.
    pub(super) fn frames(&mut self) -> Result<Vec<Frame>> {
        let BodyBuilder { mesh, rigid, regions, .. } = self;
        let frame = |body: &RigidBody| {
            let first = mesh.n_nodes() as u32;
            let frame = match &body.group {
                None => Frame::new(body, first)?,
                Some(group) => {
                    let members = mesh.group_nodes(group)?;
                    check_members(mesh, body, &members)?;
                    let centre = centre_of_cells(mesh, regions, &members)?;
                    Frame::of_group(body, first, mesh, members, centre)?
                }
            };
            mesh.add_nodes(&body.name, frame.points())?;
            Ok(frame)
        };
        rigid.iter().map(frame).collect()
    }
}

/// Checks that the nodes of a rigid body can move as one.
fn check_members(mesh: &Mesh, body: &RigidBody, members: &[u32]) -> Result<()> {
    let fail = |reason: &str| Err(Error::Rigid { body: body.name.clone(), reason: reason.to_string() });
    let is_member = |node: &u32| members.binary_search(node).is_ok();
    if members.is_empty() {
        return fail("its group is empty");
    }
    let is_plane = |cell: &Cell<'_>| cell.kind.dimension() == 2 && cell.nodes.iter().any(is_member);
    if mesh.cells().any(|cell| is_plane(&cell)) {
        return fail(
            "cells in plane strain cannot be rigid; give mass, centre and inertia instead, and joints",
        );
    }
    Ok(())
}

/// Centre of mass of the cells all of whose nodes are some of a rigid body; `None` if there are none.
fn centre_of_cells(mesh: &Mesh, regions: &[Region], members: &[u32]) -> Result<Option<[f64; 3]>> {
    let is_inside =
        |cell: &u32| mesh.cell(*cell as usize).nodes.iter().all(|node| members.binary_search(node).is_ok());
    let density = RegionOfCell::new(mesh, regions)?.densities(mesh, regions);
    let origin = mesh.points()[members[0] as usize];
    let (mut mass, mut first) = (0.0, [0.0; 3]);
    for_each_volume_point(mesh, (0..mesh.n_cells() as u32).filter(is_inside), |cell, _, point| {
        let weight = density[cell] * point.weight;
        mass += weight;
        (0..3).for_each(|d| first[d] += weight * (point.position[d] - origin[d]));
    });
    Ok((mass > 0.0).then(|| [0, 1, 2].map(|d| origin[d] + first[d] / mass)))
}
