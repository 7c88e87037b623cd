//! The cells of a grid: those of the body, and the roles of the others.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use emmy::mesh::{CellKind, MeshBuilder};

use super::super::account::Account;
use super::cell::Type;
use super::{Grid, MeshError, Result, kinds};
use crate::message::counted;

/// The role of a grid cell in the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A cell of the body.
    Cell(u32),
    /// A face of a cell (in a plane body an edge).
    Facet,
    /// A line or a vertex on the body: its nodes.
    Nodes,
    /// A shell, a beam, or another cell that cannot be in the body; its nodes stay in its groups.
    LeftOut,
    /// A ghost.
    Absent,
}

/// Type and kind of a cell of the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub(super) of: &'static Type,
    pub(super) kind: Option<CellKind>,
}

/// A mesh from a grid, so far.
pub(super) struct Draft<'a> {
    file: &'a Path,
    pub(super) builder: MeshBuilder,
    points: &'a [[f64; 3]],
    pub(super) shapes: Vec<Shape>,
    is_ghost: Vec<bool>,
    /// Dimension of the body: 3; 2 without solid cells; 1 with only lines.
    pub(super) dim: u8,
    /// End of the nodes of each cell in the connectivity.
    ends: Vec<usize>,
    connectivity: Vec<u32>,
    pub(super) roles: Vec<Role>,
    pub(super) notes: Vec<String>,
}

impl<'a> Draft<'a> {
    pub(super) fn new(file: &'a Path, grid: &'a Grid) -> Result<Self> {
        let fault = |problem: String| MeshError::Grid { file: file.to_path_buf(), problem, advice: DAMAGED };
        let (types, n_points) = (known(&grid.types).map_err(fault)?, grid.points.len());
        let ends = ends(&types, grid).map_err(fault)?;
        let node = |&node: &i64| u32::try_from(node).ok().filter(|&node| (node as usize) < n_points);
        let unknown = |id: &i64| fault(format!("a cell names node {id}, of {n_points}"));
        let connectivity: Vec<u32> =
            grid.connectivity.iter().map(|id| node(id).ok_or_else(|| unknown(id))).collect::<Result<_>>()?;
        for (arrays, n, what) in
            [(&grid.cell_arrays, types.len(), "cells"), (&grid.point_arrays, n_points, "points")]
        {
            let wrong = arrays
                .iter()
                .find_map(|own| Some((own, own.numbers.as_ref()?.len())).filter(|own| own.1 != n));
            if let Some((array, found)) = wrong {
                return Err(fault(format!("array \"{}\" has {found} numbers for {n} {what}", array.name)));
            }
        }
        let is_ghost = grid.ghosts();
        let mut begin = 0;
        let shape = |(of, &end): (&'static Type, &usize)| {
            let n_nodes = end - std::mem::replace(&mut begin, end);
            Shape { of, kind: of.kind(n_nodes) }
        };
        let shapes: Vec<Shape> = types.into_iter().zip(&ends).map(shape).collect();
        let present = shapes.iter().zip(&is_ghost).filter(|(_, ghost)| !**ghost);
        let dim = present.map(|(shape, _)| shape.of.dim).fold(0, u8::max);
        let mut builder = MeshBuilder::new();
        grid.points.iter().for_each(|&point| {
            builder.point(point);
        });
        let roles = Vec::with_capacity(shapes.len());
        let mut draft = Draft {
            file,
            builder,
            points: &grid.points,
            shapes,
            is_ghost,
            dim,
            ends,
            connectivity,
            roles,
            notes: Vec::new(),
        };
        draft.note_on_ghosts();
        if dim == 0 {
            return Err(draft.nothing());
        }
        Ok(draft)
    }

    fn note_on_ghosts(&mut self) {
        let n = self.is_ghost.iter().filter(|is_ghost| **is_ghost).count();
        if n > 0 {
            self.notes.push(format!(
                "{} left out",
                counted(n, "ghost or hidden cell is", "ghost or hidden cells are")
            ));
        }
    }

    /// The error of a grid in which no cell can be one of a body.
    fn nothing(&self) -> MeshError {
        let mut found: BTreeMap<String, usize> = BTreeMap::new();
        for (index, _) in self.is_ghost.iter().enumerate().filter(|(_, is_ghost)| !**is_ghost) {
            *found.entry(self.described(index)).or_default() += 1;
        }
        if found.is_empty() {
            return super::no_cells(self.file);
        }
        let found: Vec<String> = found.iter().map(|(name, count)| format!("{count} of {name}")).collect();
        MeshError::Grid {
            file: self.file.to_path_buf(),
            problem: format!("the mesh has no solid or plane cells, only {}", found.join(", ")),
            advice: "save the volume, not only its surface",
        }
    }

    pub(super) fn nodes(&self, index: usize) -> &[u32] {
        let begin = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.connectivity[begin..self.ends[index]]
    }

    pub(super) fn corners(&self, index: usize) -> &[u32] {
        let nodes = self.nodes(index);
        &nodes[..self.shapes[index].of.n_corners(nodes.len())]
    }

    /// The cell of the body that a cell of the file is.
    pub(super) fn cell(&self, index: usize) -> Option<u32> {
        match self.roles[index] {
            Role::Cell(cell) => Some(cell),
            _ => None,
        }
    }

    fn described(&self, index: usize) -> String {
        self.shapes[index].of.described(self.nodes(index).len())
    }

    /// Adds the cells of the body, and finds the roles of all cells of the file.
    pub(super) fn add_cells(&mut self, is_link: &[bool]) -> Result<()> {
        for index in 0..self.shapes.len() {
            let Shape { of, kind } = self.shapes[index];
            let role = match kind {
                _ if self.is_ghost[index] => Role::Absent,
                Some(kind) if of.dim == self.dim || is_link[index] => {
                    let mut nodes = self.nodes(index).to_vec();
                    if let Some(order) = of.order() {
                        nodes = order.iter().map(|&local| nodes[local]).collect();
                    }
                    let cell = self.builder.cell(kind, &nodes);
                    let mesh_error = |reason| MeshError::Mesh { file: self.file.to_path_buf(), reason };
                    let cell = cell.map_err(mesh_error)?;
                    if kind.dimension() == 1 {
                        self.builder.cell_group(LINKS, [cell]);
                    }
                    Role::Cell(cell)
                }
                None if of.dim == self.dim => return Err(self.unsupported(index)),
                _ => Role::LeftOut,
            };
            self.roles.push(role);
        }
        self.find_other_roles();
        Ok(())
    }

    fn unsupported(&self, index: usize) -> MeshError {
        let supported = kinds();
        MeshError::Grid {
            file: self.file.to_path_buf(),
            problem: format!(
                "cell {index} (counted from 0) is of {}, which is not supported; make the body of {supported}",
                self.described(index)
            ),
            advice: self.shapes[index].of.cure(self.nodes(index).len()),
        }
    }

    /// Finds which of the other cells are faces, and which lie on the body.
    fn find_other_roles(&mut self) {
        let others: Vec<usize> =
            (0..self.roles.len()).filter(|&index| self.roles[index] == Role::LeftOut).collect();
        if others.is_empty() {
            return;
        }
        let mut is_of_body = vec![false; self.points.len()];
        let mut faces: HashSet<[u32; 4]> = HashSet::new();
        let has_faces = others.iter().any(|&index| self.shapes[index].of.dim + 1 == self.dim);
        for index in (0..self.roles.len()).filter(|&index| self.cell(index).is_some()) {
            let nodes = self.nodes(index);
            nodes.iter().for_each(|&node| is_of_body[node as usize] = true);
            let Shape { of, kind: Some(kind) } = self.shapes[index] else { continue };
            let order = |local: usize| of.order().map_or(local, |order| order[local]);
            for facet in kind.facets().iter().filter(|_| has_faces && of.dim == self.dim) {
                let corners = &facet.nodes[..facet.kind.n_corners()];
                faces.insert(key(corners.iter().map(|&corner| nodes[order(corner)])));
            }
        }
        let on_edges = self.are_on_edges(&others);
        for (index, is_on_edges) in others.into_iter().zip(on_edges) {
            let (dim, corners) = (self.shapes[index].of.dim, self.corners(index));
            let is_facet = dim + 1 == self.dim && (2..=4).contains(&corners.len());
            if is_facet && faces.contains(&key(corners.iter().copied())) {
                self.roles[index] = Role::Facet;
            } else if dim == 0
                || is_on_edges && self.nodes(index).iter().all(|&node| is_of_body[node as usize])
            {
                self.roles[index] = Role::Nodes;
            }
        }
    }

    /// For each cell of the file whether it is a line along edges of cells of a solid body.
    fn are_on_edges(&self, others: &[usize]) -> Vec<bool> {
        let ends = |index: usize| {
            let is_line = self.shapes[index].of.dim == 1 && self.dim == 3;
            if is_line { self.corners(index) } else { &[] }
        };
        let segments = others.iter().flat_map(|&index| ends(index).windows(2));
        let lines: Vec<[u32; 2]> = segments.map(|ends| [ends[0], ends[1]]).collect();
        let mut are_edges = self.builder.are_edges(&lines).into_iter();
        let on_edges = |&index: &usize| {
            let n = ends(index).len().saturating_sub(1);
            n > 0 && are_edges.by_ref().take(n).filter(|is_edge| *is_edge).count() == n
        };
        others.iter().map(on_edges).collect()
    }

    /// Notes on the cells that are in no group or left out.
    pub(super) fn note_on_others(&mut self, is_used: &[bool]) {
        let is_unused =
            |index: &usize| matches!(self.roles[*index], Role::Facet | Role::Nodes) && !is_used[*index];
        let unused = (0..self.roles.len()).filter(is_unused).count();
        if unused > 0 {
            let [one, many] = match self.dim {
                3 => ["cell that is not solid is", "cells that are not solid are"],
                _ => ["line or vertex is", "lines or vertices are"],
            };
            self.notes.push(format!("{} in no group and ignored", counted(unused, one, many)));
        }
        let mut account = Account::default();
        for index in (0..self.roles.len()).filter(|&index| self.roles[index] == Role::LeftOut) {
            account.leave_out(&self.described(index));
        }
        self.notes.extend(account.notes());
    }
}

/// Group of all links.
const LINKS: &str = "links";

const DAMAGED: &str = "the file is damaged or cut off, write it again";

/// Sorted corners of a facet.
fn key(corners: impl Iterator<Item = u32>) -> [u32; 4] {
    let mut key = [u32::MAX; 4];
    for (slot, corner) in key.iter_mut().zip(corners) {
        *slot = corner;
    }
    key.sort_unstable();
    key
}

fn known(types: &[i64]) -> Result<Vec<&'static Type>, String> {
    let unknown = |(index, id): (usize, &i64)| format!("cell {index} is of the unknown VTK type {id}");
    types.iter().enumerate().map(|own| Type::of(*own.1).ok_or_else(|| unknown(own))).collect()
}

/// End of the nodes of each cell, checked against its type.
fn ends(types: &[&'static Type], grid: &Grid) -> Result<Vec<usize>, String> {
    let n = grid.connectivity.len();
    if grid.ends.len() != types.len() {
        return Err(format!("{} cells with {} types", grid.ends.len(), types.len()));
    }
    let mut begin = 0;
    let checked = |(index, (&end, own)): (usize, (&i64, &&Type))| {
        let wanted = begin + own.n_nodes;
        let found = usize::try_from(end)
            .ok()
            .filter(|&end| (own.n_nodes == 0 || end == wanted) && end >= begin && end <= n);
        let wrong = || match own.n_nodes {
            0 => format!("cell {index} of type {} begins at {begin} and ends at {end}, of {n}", own.id),
            _ => format!("cell {index} of type {} ends at {end} instead of {wanted}", own.id),
        };
        begin = found.ok_or_else(wrong)?;
        Ok(begin)
    };
    grid.ends.iter().zip(types).enumerate().map(checked).collect()
}
