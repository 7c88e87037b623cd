//! Groups in the arrays of a grid.

use std::collections::{BTreeMap, HashSet};

use emmy::mesh::Facet;

use super::super::Result;
use super::Draft;
use super::array::Numbers;
use super::file::{Array, Grid};
use crate::message::counted;
use crate::vtk::{FACETS, GROUP};

/// Array of the physical groups of Gmsh, as written by meshio, on cells of any dimension; 0: none.
const GMSH: &str = "gmsh:physical";

/// Largest number of values of an array that becomes groups.
const MAX_VALUES: usize = 64;

/// Adds the groups from the arrays; `cells`: cell of the body for each cell of the file.
pub(super) fn add(grid: &Grid<'_, '_>, draft: &mut Draft, cells: &[Option<u32>]) -> Result<()> {
    for array in grid.arrays("PointData").iter().filter(|array| is_label(array)) {
        if let Some(name) = array.name.strip_prefix(GROUP) {
            let members = indices(&whole(grid, array, grid.n_points)?, |value| value != 0);
            draft.builder.node_group(name, members.iter().map(|&node| node as u32));
        }
    }
    let mut is_used = vec![false; cells.len()];
    for array in grid.arrays("CellData").iter().filter(|array| is_label(array)) {
        let values = whole(grid, array, grid.n_cells)?;
        if let Some(name) = array.name.strip_prefix(GROUP) {
            let members = indices(&values, |value| value != 0);
            members.iter().for_each(|&member| is_used[member] = true);
            draft.add_group(name, &members, cells);
        } else if let Some(name) = array.name.strip_prefix(FACETS) {
            draft.add_facets(name, &values, cells);
        } else if !array.name.starts_with("vtk") {
            draft.add_values(array.name, &values, cells, &mut is_used);
        }
    }
    draft.note_on_unused(cells, &is_used);
    Ok(())
}

/// Whether each cell of the file is a line in one of the groups `links`.
pub(super) fn links(grid: &Grid<'_, '_>, draft: &Draft, links: &[String]) -> Result<Vec<bool>> {
    let mut is_link = vec![false; grid.n_cells];
    let links: HashSet<&str> = links.iter().map(String::as_str).collect();
    for array in grid.arrays("CellData").iter().filter(|array| is_label(array) && !links.is_empty()) {
        let values = whole(grid, array, grid.n_cells)?;
        for (index, &value) in values.iter().enumerate().filter(|(index, _)| draft.shapes[*index].1.dim == 1)
        {
            let name = match array.name.strip_prefix(GROUP) {
                Some(name) if value != 0 => name.to_string(),
                _ => format!("{}={value}", array.name),
            };
            is_link[index] |= links.contains(&*name) && draft.shapes[index].1.kind.is_some();
        }
    }
    Ok(is_link)
}

fn is_label(array: &Array<'_, '_>) -> bool {
    array.components == 1 && array.is_whole()
}

fn whole(grid: &Grid<'_, '_>, array: &Array<'_, '_>, n: usize) -> Result<Vec<i64>> {
    Ok(match grid.numbers(array, Some(n))? {
        Numbers::Whole(values) => values,
        Numbers::Real(_) => Vec::new(),
    })
}

fn indices(values: &[i64], is_member: impl Fn(i64) -> bool) -> Vec<usize> {
    (0..values.len()).filter(|&index| is_member(values[index])).collect()
}

impl Draft {
    /// A group of cells of the file: its cells of the body, facets from cells of one dimension less, and the nodes of
    /// all others.
    fn add_group(&mut self, name: &str, members: &[usize], cells: &[Option<u32>]) {
        let dim = |index: usize| self.shapes[index].1.dim;
        let of = |wanted: &dyn Fn(u8) -> bool| {
            let others = members.iter().copied().filter(|&i| cells[i].is_none());
            others.filter(|&i| wanted(dim(i))).collect::<Vec<usize>>()
        };
        let body = self.dim;
        let solids: Vec<usize> = members.iter().copied().filter(|&i| cells[i].is_some()).collect();
        let faces = of(&|dim| dim + 1 == body);
        let rest = of(&|dim| dim + 1 < body);
        let corners = |&i: &usize| self.nodes(i)[..self.shapes[i].1.n_corners].to_vec();
        let facets: Vec<Vec<u32>> = faces.iter().map(corners).collect();
        let nodes: Vec<u32> = rest.iter().flat_map(|&i| self.nodes(i).to_vec()).collect();
        if !solids.is_empty() || members.is_empty() {
            self.builder.cell_group(name, solids.iter().filter_map(|&i| cells[i]));
        }
        if !facets.is_empty() {
            self.builder.facet_group_by_nodes(name, facets);
        }
        if !nodes.is_empty() {
            self.builder.node_group(name, nodes);
        }
    }

    /// A group of facets as written by Emmy: bit i of a cell's number denotes its face i.
    fn add_facets(&mut self, name: &str, values: &[i64], cells: &[Option<u32>]) {
        let facets = values.iter().enumerate().flat_map(|(index, &bits)| {
            let n_faces = self.shapes[index].1.kind.map_or(0, |kind| kind.facets().len()) as u8;
            let local = (0..n_faces).filter(move |local| (bits >> local) & 1 == 1);
            local.filter_map(move |local| cells[index].map(|cell| Facet { cell, local }))
        });
        let facets: Vec<Facet> = facets.collect();
        self.builder.facet_group(name, facets);
    }

    /// A group `NAME=VALUE` for each value of an array, unless it numbers the cells.
    fn add_values(&mut self, name: &str, values: &[i64], cells: &[Option<u32>], is_used: &mut [bool]) {
        let mut members: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
        for (index, &value) in values.iter().enumerate() {
            if cells[index].is_some() || (name == GMSH && value != 0) {
                members.entry(value).or_default().push(index);
            }
        }
        let is_numbering = members.len() > 1 && members.values().all(|members| members.len() == 1);
        if is_numbering || members.len() > MAX_VALUES {
            return;
        }
        for (value, members) in members {
            members.iter().for_each(|&member| is_used[member] = true);
            self.add_group(&format!("{name}={value}"), &members, cells);
        }
    }

    fn note_on_unused(&mut self, cells: &[Option<u32>], is_used: &[bool]) {
        let unused = (0..cells.len()).filter(|&index| cells[index].is_none() && !is_used[index]).count();
        if unused > 0 {
            let [one, many] = match self.dim {
                3 => ["cell that is not solid is", "cells that are not solid are"],
                _ => ["line or vertex is", "lines or vertices are"],
            };
            let cells = counted(unused, one, many);
            self.notes.push(format!("{cells} in no group and ignored"));
        }
    }
}
