//! Degrees of freedom under supports: free, at rest, or driven.

use std::ops::Range;

use super::drive::Drive;
use super::internal_nodes::InternalNodes;
use super::ties::Ties;
use crate::error::{Error, Result};
use crate::input::{Rotation, Support};
use crate::mesh::Mesh;
use crate::nodal;
use crate::number::{short, short_vector};
use crate::team::Subdomain;

/// Degrees of freedom with a given motion, the motions, and the groups that are held.
#[derive(Debug, Clone, Default)]
pub(crate) struct Supports {
    /// Whether each is given: at rest, driven or tied, `[n_nodes][3]`.
    pub fixed: Vec<bool>,
    /// Fixed ones, and those of guests.
    pub inactive: Vec<bool>,
    /// Axes along which some node is fixed.
    pub held_axes: [bool; 3],
    /// Motions of the driven ones.
    pub drives: Vec<Drive>,
    /// The groups with supports or springs, in their order.
    pub groups: Vec<SupportedGroup>,
}

impl Supports {
    /// The supports of a mesh that `hold`, and the places of all supports, and of forces of the ground that count as
    /// those of a group with their indices, among the supported groups;
    /// `guests`: nodes that other ranks own; `ties`: nodes that follow others.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::Support`] if a motion jumps, an axis has no direction, or two supports of one
    /// degree of freedom disagree.
    pub(crate) fn new(
        mesh: &Mesh,
        (internal, guests, ties): (&InternalNodes, Range<usize>, &Ties),
        all: (&[Support], &[(String, usize)]),
        holds: impl Fn(&Support) -> bool,
    ) -> Result<Self> {
        let held = || all.0.iter().enumerate().filter(|(_, support)| holds(support));
        let mut supports = Supports { fixed: vec![false; internal.dofs().end], ..Supports::default() };
        for (_, support) in held() {
            if let Some(time) = support.until.filter(|time| !time.is_finite()) {
                return Err(Error::NotFinite { what: "time of a release".into(), value: time });
            }
            supports.fix(mesh, support)?;
        }
        for (number, support) in held().filter(|(_, support)| support.is_driven()) {
            supports.drive(mesh, number, support)?;
        }
        supports.fix_planes(mesh, internal, ties);
        supports.fixed.iter().enumerate().for_each(|(dof, fixed)| supports.held_axes[dof % 3] |= fixed);
        supports.check_tied(mesh, held().map(|(_, support)| support), ties)?;
        ties.dofs().for_each(|dof| supports.fixed[dof] = true);
        supports.inactive = supports.fixed.clone();
        supports.inactive[3 * guests.start..3 * guests.end].fill(true);
        supports.groups = supported_groups(mesh, guests.start, all, &holds)?;
        Ok(supports)
    }

    /// Takes what is true of all ranks: the axes along which some node is fixed, the radii of rotations.
    pub(super) fn sum_ranks(&mut self, ranks: &Subdomain) {
        self.held_axes = ranks.any("fixed axes", self.held_axes);
        for drive in &mut self.drives {
            let mut radius = [drive.radius];
            ranks.largest("radius of a support that turns", &mut radius);
            drive.radius = radius[0];
        }
    }

    fn fix(&mut self, mesh: &Mesh, support: &Support) -> Result<()> {
        let fixed = support.fixed_components(mesh)?;
        for node in mesh.group_nodes(&support.group)? {
            (0..3).for_each(|i| self.fixed[nodal::dof(node as usize, i)] |= fixed[i]);
        }
        Ok(())
    }

    /// Plane strain: nodes of plane cells stay in the plane.
    fn fix_planes(&mut self, mesh: &Mesh, internal: &InternalNodes, ties: &Ties) {
        for cell in mesh.cells().filter(|cell| cell.kind.dimension() == 2) {
            cell.nodes.iter().for_each(|&node| self.fixed[nodal::dof(node as usize, 2)] = true);
        }
        if mesh.cells().any(|cell| cell.kind.dimension() == 2) {
            ties.points().iter().for_each(|point| self.fixed[nodal::dof(point.node as usize, 2)] = true);
        }
        for (node, _) in internal.with_cells(mesh).filter(|(_, cell)| cell.kind.dimension() == 2) {
            self.fixed[nodal::dof(node, 2)] = true;
        }
    }

    /// Checks that supports hold a tied node only as the nodes that it follows are held.
    ///
    /// # Errors
    /// [`Error::Support`].
    fn check_tied<'s>(
        &self,
        mesh: &Mesh,
        supports: impl Iterator<Item = &'s Support>,
        ties: &Ties,
    ) -> Result<()> {
        for support in supports.filter(|_| !ties.is_empty()) {
            let (group, fixed) = (&support.group, support.fixed_components(mesh)?);
            let is_free = |node: &u32| {
                let leaders = ties.leaders_of(*node).unwrap_or_default();
                let held =
                    |d: usize| leaders.iter().all(|(leader, _)| self.fixed[nodal::dof(*leader as usize, d)]);
                !leaders.is_empty() && (0..3).any(|d| support.drives(d) || fixed[d] && !held(d))
            };
            if let Some(node) = mesh.group_nodes(group)?.into_iter().find(is_free) {
                let point = short_vector(mesh.points()[node as usize]);
                let reason = match ties.body_of(node) {
                    Some(body) => format!(
                        "its node at {point} belongs to the rigid body \"{body}\"; hold the body instead, as by a \
                         fixed joint to the ground"
                    ),
                    None => format!(
                        "its node at {point} is tied to others; hold these instead; by mortar let the finer mesh \
                         follow, or tie with kind = \"nodes\""
                    ),
                };
                return Err(Error::Support { group: group.clone(), reason });
            }
        }
        Ok(())
    }

    fn drive(&mut self, mesh: &Mesh, number: usize, support: &Support) -> Result<()> {
        let fail = |reason: String| Error::Support { group: support.group.clone(), reason };
        if let Some(time) = support.time_functions().find_map(|time_function| time_function.first_jump()) {
            return Err(fail(format!("its motion jumps at t = {}; give the jump a duration", short(time))));
        }
        if let Some(unknown) = support.time_functions().find(|time_function| !time_function.has_rate()) {
            let text = unknown.text().unwrap_or_default();
            return Err(fail(format!(
                "the rate of its motion \"{text}\" is not known; give it by `with_rate`"
            )));
        }
        let rotation = support.rotation.as_ref().map(normalised).transpose().map_err(fail)?;
        let nodes = mesh.group_nodes(&support.group)?;
        if support.leaves_plane() && mesh.cells().any(|cell| cell.kind.dimension() == 2) {
            return Err(fail(
                "plane cells stay in their plane: move x and y, turn about the z axis".to_string(),
            ));
        }
        let displacement = support.displacement.clone();
        let drive = Drive::new(number, displacement, rotation, support.until, nodes, mesh.points());
        for dof in drive.dofs() {
            if std::mem::replace(&mut self.fixed[dof], true) {
                let component = ["x", "y", "z"][dof % 3];
                let point = short_vector(mesh.points()[dof / 3]);
                let reason = "is fixed or driven by another support too";
                return Err(fail(format!("component {component} of the node at {point} {reason}")));
            }
        }
        self.drives.push(drive);
        Ok(())
    }
}

/// A group with supports: the degrees of freedom that it holds before any other group, and its springs to the ground.
#[derive(Debug, Clone)]
pub(crate) struct SupportedGroup {
    pub name: String,
    pub dofs: Vec<usize>,
    /// Indices of its springs and contacts among the forces beside those of cells.
    pub springs: Vec<usize>,
}

/// The groups of all supports and springs, each once and in their order; supports that no longer hold have no degrees
/// of freedom, and only those of the first `n_own` nodes count.
fn supported_groups(
    mesh: &Mesh,
    n_own: usize,
    (supports, springs): (&[Support], &[(String, usize)]),
    holds: impl Fn(&Support) -> bool,
) -> Result<Vec<SupportedGroup>> {
    let mut groups: Vec<SupportedGroup> = Vec::new();
    let mut is_held = vec![false; mesh.n_dofs()];
    for support in supports {
        let group = entry(&mut groups, &support.group);
        if !holds(support) {
            continue;
        }
        let fixed = support.fixed_components(mesh)?;
        for node in mesh.group_nodes(&support.group)? {
            let dofs =
                (0..3).filter(|&d| fixed[d] || support.drives(d)).map(|d| nodal::dof(node as usize, d));
            let own = dofs.filter(|&dof| dof < 3 * n_own && !std::mem::replace(&mut is_held[dof], true));
            group.dofs.extend(own);
        }
    }
    for (group, index) in springs {
        entry(&mut groups, group).springs.push(*index);
    }
    Ok(groups)
}

/// The group of a name, added at the end if it is new.
fn entry<'a>(groups: &'a mut Vec<SupportedGroup>, name: &str) -> &'a mut SupportedGroup {
    let index = groups.iter().position(|group| group.name == name).unwrap_or(groups.len());
    if index == groups.len() {
        let name = name.to_string();
        groups.push(SupportedGroup { name, dofs: Vec::new(), springs: Vec::new() });
    }
    &mut groups[index]
}

/// The rotation with an axis of unit length.
fn normalised(rotation: &Rotation) -> Result<Rotation, String> {
    let length = rotation.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err("the axis of its rotation has no direction".to_string());
    }
    if let Some(value) = rotation.about.iter().find(|value| !value.is_finite()) {
        return Err(format!("`about` of its rotation must be finite numbers, not {value}"));
    }
    Ok(Rotation { axis: rotation.axis.map(|x| x / length), ..rotation.clone() })
}
