//! A mesh of arrays.

use std::collections::{BTreeMap, HashSet};

use emmy::mesh::{CellKind, Facet, MeshBuilder};
use emmy_io::mesh::{MeshError, MeshFile};
use numpy::{PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::{errors, pool};

/// Numbers of the members of groups by name.
pub(crate) type Groups<'py> = BTreeMap<String, PyReadonlyArrayDyn<'py, i64>>;

/// Facets of groups by name: `nodes`, by their nodes, or `faces`, as cells with the numbers of their faces.
pub(crate) type FacetGroups<'py> = BTreeMap<String, Vec<(String, PyReadonlyArray2<'py, i64>)>>;

/// Nodes of cells by kind.
pub(crate) type Cells<'py> = Vec<(String, PyReadonlyArray2<'py, i64>)>;

/// Group of all links of a mesh.
const LINKS: &str = "links";

/// The role of a row in the arrays of cells.
enum Row {
    Cell(u32, CellKind),
    /// A surface beside solid cells, by its nodes: a face for groups.
    Face(Vec<u32>),
}

/// A mesh so far.
struct Draft<'py> {
    py: Python<'py>,
    builder: MeshBuilder,
    n_nodes: usize,
    rows: Vec<Row>,
    /// Members of groups of cells that are no cells.
    faces: Vec<(String, Vec<Vec<u32>>)>,
    notes: Vec<String>,
}

/// The mesh, with the checks and the notes of a file.
pub(crate) fn mesh(
    py: Python<'_>,
    points: &PyReadonlyArray2<'_, f64>,
    cells: &Cells<'_>,
    cell_groups: &Groups<'_>,
    facet_groups: &FacetGroups<'_>,
    node_groups: &Groups<'_>,
) -> PyResult<MeshFile> {
    let mut builder = MeshBuilder::new();
    points.as_array().rows().into_iter().for_each(|row| _ = builder.point([row[0], row[1], row[2]]));
    let n_nodes = points.as_array().nrows();
    let mut draft = Draft { py, builder, n_nodes, rows: Vec::new(), faces: Vec::new(), notes: Vec::new() };
    draft.add_cells(cells)?;
    draft.add_cell_groups(cell_groups)?;
    draft.add_facet_groups(facet_groups)?;
    draft.add_node_groups(node_groups)?;
    let Draft { mut builder, faces, notes, .. } = draft;
    let made = pool::interruptible(py, move || {
        let name = "the arrays";
        // A named facet must be one; a surface among the cells may be a shell.
        builder.find_facets().map_err(|reason| MeshError::Mesh { file: name.into(), reason })?;
        faces.into_iter().for_each(|(name, faces)| builder.facet_group_by_nodes(&name, faces));
        emmy_io::mesh::from_builder(name.as_ref(), builder, notes)
    })?;
    made.map_err(|error| match error {
        MeshError::Mesh { reason, .. } => errors::library(py, &reason),
        error => errors::argument(py, "mesh", &error.to_string()),
    })
}

impl Draft<'_> {
    fn add_cells(&mut self, cells: &Cells<'_>) -> PyResult<()> {
        let known = |(name, _): &(String, _)| {
            let kind = CellKind::ALL.into_iter().find(|kind| kind.name() == name);
            kind.ok_or_else(|| {
                let known: Vec<&str> = CellKind::ALL.iter().map(|kind| kind.name()).collect();
                let message = format!("{name:?} is not a kind of cell; there is {}", known.join(", "));
                errors::argument(self.py, "mesh.cells", &message)
            })
        };
        let kinds = cells.iter().map(known).collect::<PyResult<Vec<CellKind>>>()?;
        let dimension = kinds.iter().map(|kind| kind.dimension()).max().unwrap_or(0);
        for (kind, (_, nodes)) in kinds.into_iter().zip(cells) {
            for row in nodes.as_array().rows() {
                let nodes = whole(row.iter());
                if kind.dimension() == 2 && dimension == 3 && nodes.len() == kind.n_nodes() {
                    self.rows.push(Row::Face(nodes));
                    continue;
                }
                let cell = self.builder.cell(kind, &nodes);
                let cell = cell.map_err(|error| errors::library(self.py, &error))?;
                if kind.dimension() == 1 {
                    self.builder.cell_group(LINKS, [cell]);
                }
                self.rows.push(Row::Cell(cell, kind));
            }
        }
        Ok(())
    }

    fn add_cell_groups(&mut self, groups: &Groups<'_>) -> PyResult<()> {
        let mut used: HashSet<u32> = HashSet::new();
        for (name, members) in groups {
            let (mut cells, mut faces) = (Vec::new(), Vec::new());
            for number in whole(members.as_array().iter()) {
                match self.rows.get(number as usize) {
                    Some(Row::Cell(cell, _)) => cells.push(*cell),
                    Some(Row::Face(nodes)) => {
                        used.insert(number);
                        faces.push(nodes.clone());
                    }
                    None => {
                        let message =
                            format!("there is no cell {number} among {}, counted from 0", self.rows.len());
                        return Err(errors::argument(self.py, &format!("mesh.cell_groups.{name}"), &message));
                    }
                }
            }
            if !cells.is_empty() || faces.is_empty() {
                self.builder.cell_group(name, cells);
            }
            if !faces.is_empty() {
                self.faces.push((name.clone(), faces));
            }
        }
        let n_faces = self.rows.iter().filter(|row| matches!(row, Row::Face(_))).count();
        match n_faces - used.len() {
            0 => {}
            1 => self.notes.push("1 cell that is not solid is in no group and ignored".to_string()),
            n => self.notes.push(format!("{n} cells that are not solid are in no group and ignored")),
        }
        Ok(())
    }

    fn add_node_groups(&mut self, groups: &Groups<'_>) -> PyResult<()> {
        for (name, members) in groups {
            let members = whole(members.as_array().iter());
            if let Some(node) = members.iter().find(|&&node| node as usize >= self.n_nodes) {
                let message = format!("there is no node {node} among {}, counted from 0", self.n_nodes);
                return Err(errors::argument(self.py, &format!("mesh.node_groups.{name}"), &message));
            }
            self.builder.node_group(name, members);
        }
        Ok(())
    }

    fn add_facet_groups(&mut self, groups: &FacetGroups<'_>) -> PyResult<()> {
        for (name, parts) in groups {
            for (how, rows) in parts {
                let rows = rows.as_array();
                let mut rows = rows.rows().into_iter().map(|row| whole(row.iter()));
                if how == "nodes" {
                    self.builder.facet_group_by_nodes(name, rows.collect());
                    continue;
                }
                let facet = |row: Vec<u32>| {
                    let [cell, face] = row[..] else { return None };
                    let Row::Cell(cell, kind) = self.rows.get(cell as usize)? else { return None };
                    ((face as usize) < kind.facets().len())
                        .then_some(Facet { cell: *cell, local: face as u8 })
                };
                let facets: Option<Vec<Facet>> = rows.try_fold(Vec::new(), |mut all, row| {
                    all.push(facet(row)?);
                    Some(all)
                });
                let facets = facets.ok_or_else(|| {
                    let message =
                        "a row must be the number of a cell and of one of its faces, counted from 0";
                    errors::argument(self.py, &format!("mesh.facet_groups.{name}"), message)
                })?;
                self.builder.facet_group(name, facets);
            }
        }
        Ok(())
    }
}

fn whole<'a>(row: impl Iterator<Item = &'a i64>) -> Vec<u32> {
    // A number out of range belongs to no node: the builder says so.
    row.map(|&node| u32::try_from(node).unwrap_or(u32::MAX)).collect()
}
