//! Groups in the arrays of a grid.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use emmy::mesh::Facet;

use super::super::Result;
use super::super::account::{Treatment, treatment};
use super::draft::{Draft, Role};
use super::grid::{Grid, GridArray, Numbers, TABLE, has_no_effect, has_tags};
use crate::message;
use crate::vtk::{CELL, FACETS, GROUP};

/// Largest number of values of an array that becomes groups, unless it has tags.
const MAX_VALUES: usize = 64;

/// Numbers of an array as labels.
type Labels = Vec<Option<i64>>;

/// The use of an array.
enum Use<'a> {
    /// A group: members have another number than 0.
    Group(&'a str, Labels),
    /// A group of facets, by the bits of the numbers.
    Facets(&'a str, Labels),
    /// A group for each value.
    Values(Labels),
    NoEffect,
    LeftOut,
}

fn use_of(array: &GridArray) -> Use<'_> {
    if has_no_effect(&array.name) {
        return Use::NoEffect;
    }
    let Some(labels) = array.numbers.as_ref().and_then(Numbers::labels) else { return Use::LeftOut };
    if let Some(name) = array.name.strip_prefix(GROUP) {
        return Use::Group(name, labels);
    }
    if let Some(name) = array.name.strip_prefix(FACETS) {
        return Use::Facets(name, labels);
    }
    match treatment(TABLE, &array.name.to_uppercase()) {
        Some(Treatment::Read) if !has_tags(&array.name) => Use::NoEffect,
        _ => Use::Values(labels),
    }
}

/// Adds the groups from the arrays, and notes those that give none.
pub(super) fn add(grid: &Grid, draft: &mut Draft<'_>) -> Result<()> {
    let (mut left_out, mut hidden, mut misplaced) = (Vec::new(), Vec::new(), Vec::new());
    let names: HashSet<&str> = grid.cell_arrays.iter().map(|array| &*array.name).collect();
    for array in &grid.point_arrays {
        let name = || message::name(&array.name).to_string();
        match use_of(array) {
            Use::Group(name, labels) => {
                draft.builder.node_group(name, members(&labels).map(|node| node as u32));
            }
            Use::NoEffect => {}
            Use::Facets(..) => misplaced.push(name()),
            Use::Values(_) if names.contains(&*array.name) => hidden.push(name()),
            Use::Values(labels) if draft.add_nodes(&array.name, &labels) => {}
            Use::Values(_) | Use::LeftOut => left_out.push(format!("{} (points)", name())),
        }
    }
    let mut is_used = vec![false; grid.types.len()];
    for array in &grid.cell_arrays {
        let is_read = match use_of(array) {
            Use::Group(name, labels) => {
                draft.add_group(name, &members(&labels).collect::<Vec<usize>>(), &mut is_used);
                true
            }
            Use::Facets(name, labels) => {
                draft.add_facets(name, &labels);
                true
            }
            Use::NoEffect => true,
            Use::Values(labels) => draft.add_values(&array.name, &labels, &mut is_used),
            Use::LeftOut => false,
        };
        if !is_read {
            left_out.push(message::name(&array.name).to_string());
        }
    }
    draft.note_on_others(&is_used);
    let values = format!("they have other values than up to {MAX_VALUES} whole numbers");
    draft.note_on_arrays(&left_out, &values);
    draft.note_on_arrays(&hidden, "they are on points, and cells have arrays of the same names");
    draft.note_on_arrays(&misplaced, "they are on points, and facets are told by arrays on cells");
    Ok(())
}

/// Whether each cell of the grid is a line in one of the groups `links`, or in a grid of lines alone.
pub(super) fn links(grid: &Grid, draft: &Draft<'_>, links: &[String]) -> Vec<bool> {
    let mut is_link = vec![false; grid.types.len()];
    let links: HashSet<&str> = links.iter().map(String::as_str).collect();
    for array in grid.cell_arrays.iter().filter(|_| !links.is_empty()) {
        let (prefix, labels) = match use_of(array) {
            Use::Group(name, labels) => (Some(name), labels),
            Use::Values(labels) => (None, labels),
            _ => continue,
        };
        for (index, label) in labels.iter().enumerate() {
            let (Some(label), Some(kind)) = (label, draft.shapes[index].kind) else { continue };
            let name = match prefix {
                Some(name) if *label != 0 => name.to_string(),
                _ => format!("{}={label}", array.name),
            };
            is_link[index] |= kind.dimension() == 1 && links.contains(&*name);
        }
    }
    is_link
}

/// Indices of the labels that are not 0.
fn members(labels: &Labels) -> impl Iterator<Item = usize> + '_ {
    let is_member = |label: &Option<i64>| label.is_some_and(|label| label != 0);
    labels.iter().enumerate().filter(move |own| is_member(own.1)).map(|own| own.0)
}

impl Draft<'_> {
    /// A group of cells of the grid: its cells of the body, its facets, and the nodes of all others.
    fn add_group(&mut self, name: &str, members: &[usize], is_used: &mut [bool]) {
        let (mut cells, mut facets, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
        for &index in members {
            is_used[index] = true;
            match self.roles[index] {
                Role::Cell(cell) => cells.push(cell),
                Role::Facet => facets.push(self.corners(index).to_vec()),
                Role::Nodes | Role::LeftOut => nodes.extend_from_slice(self.nodes(index)),
                Role::Absent => {}
            }
        }
        if !cells.is_empty() || members.is_empty() {
            self.builder.cell_group(name, cells);
        }
        if !facets.is_empty() {
            self.builder.facet_group_by_nodes(name, facets);
        }
        if !nodes.is_empty() {
            self.builder.node_group(name, nodes);
        }
    }

    /// A group of facets as written by Emmy: bit i of a cell's number denotes its face i.
    fn add_facets(&mut self, name: &str, labels: &Labels) {
        let mut facets = Vec::new();
        for (index, bits) in labels.iter().enumerate() {
            let (Some(cell), Some(kind)) = (self.cell(index), self.shapes[index].kind) else { continue };
            let local = (0..kind.facets().len() as u8).filter(|local| (bits.unwrap_or(0) >> local) & 1 == 1);
            facets.extend(local.map(|local| Facet { cell, local }));
        }
        self.builder.facet_group(name, facets);
    }

    /// A group `NAME=VALUE` for each value of an array on the cells; `false` if some cells have too many values. Values
    /// that number the cells give no groups.
    fn add_values(&mut self, name: &str, labels: &Labels, is_used: &mut [bool]) -> bool {
        let are_tags = has_tags(name);
        let of_body = |index: usize| self.cell(index).is_some();
        let is_present = |index: usize, value: i64| {
            self.roles[index] != Role::Absent && (of_body(index) || !are_tags || value != 0)
        };
        let mut all: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
        let mut is_read = true;
        // Values on cells of the body, and values on others, each by its own number of values.
        for part in [true, false] {
            let mut values: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
            for (index, value) in labels.iter().enumerate() {
                if let Some(value) = value.filter(|&value| is_present(index, value) && of_body(index) == part)
                {
                    values.entry(value).or_default().push(index);
                }
            }
            let are_many = values.len() > MAX_VALUES && !are_tags;
            let is_numbering = values.values().all(|members| members.len() == 1);
            if is_numbering && (are_many || name == CELL) {
                continue;
            }
            if are_many {
                is_read = false;
                continue;
            }
            values.into_iter().for_each(|(value, members)| all.entry(value).or_default().extend(members));
        }
        for (value, members) in all {
            self.add_group(&format!("{name}={value}"), &members, is_used);
        }
        is_read
    }

    /// A group of nodes `NAME=VALUE` for each value of an array on the points, unless it numbers them; `false` if there
    /// are too many values.
    fn add_nodes(&mut self, name: &str, labels: &Labels) -> bool {
        let are_tags = has_tags(name);
        let values: BTreeSet<i64> = labels.iter().flatten().copied().collect();
        let n_labels = labels.iter().flatten().count();
        if n_labels > 1 && values.len() == n_labels {
            return true;
        }
        if values.len() > MAX_VALUES && !are_tags {
            return false;
        }
        for value in values.into_iter().filter(|&value| !are_tags || value != 0) {
            let nodes = labels.iter().enumerate().filter(|own| *own.1 == Some(value)).map(|own| own.0 as u32);
            self.builder.node_group(&format!("{name}={value}"), nodes);
        }
        true
    }

    fn note_on_arrays(&mut self, left_out: &[String], reason: &str) {
        const MAX_NAMES: usize = 20;
        if left_out.is_empty() {
            return;
        }
        let more = left_out.len().saturating_sub(MAX_NAMES);
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        let names = left_out[..left_out.len() - more].join(", ");
        self.notes.push(format!("arrays that are left out, because {reason}: {names}{rest}"));
    }
}
