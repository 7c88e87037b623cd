//! Meshes in memory.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use emmy::mesh::{self, CellKind, Placement};
use emmy_io::mesh::{DeckEntry, Grid, GridArray, MeshFile, MeshOptions, Numbers, acting_entries};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{self, Cells, FacetGroups, Groups};
use crate::{errors, pool};

/// A mesh; immutable.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Mesh {
    pub(crate) mesh: Arc<mesh::Mesh>,
    notes: Vec<String>,
    entries: Vec<DeckEntry>,
}

impl Mesh {
    fn new(mesh: mesh::Mesh, notes: Vec<String>) -> Self {
        Mesh { mesh: Arc::new(mesh), notes, entries: Vec::new() }
    }

    fn of_file(file: MeshFile) -> Self {
        Mesh { entries: file.entries, ..Mesh::new(file.mesh, file.notes) }
    }

    /// The mesh, its notes and its entries, as of a file.
    fn file(&self) -> MeshFile {
        MeshFile {
            mesh: mesh::Mesh::clone(&self.mesh),
            notes: self.notes.clone(),
            entries: self.entries.clone(),
            files: Vec::new(),
        }
    }

    /// A mesh of the library.
    pub(crate) fn of(mesh: mesh::Mesh) -> Self {
        Mesh::new(mesh, Vec::new())
    }

    /// Kinds of cells in the order of their first cells.
    fn kinds(&self) -> Vec<CellKind> {
        let mut kinds: Vec<CellKind> = Vec::new();
        self.mesh.cells().for_each(|cell| {
            if !kinds.contains(&cell.kind) {
                kinds.push(cell.kind);
            }
        });
        kinds
    }

    /// A mesh of the library, or its error.
    fn made(
        py: Python<'_>,
        mesh: impl FnOnce() -> emmy::Result<mesh::Mesh> + Send + 'static,
    ) -> PyResult<Self> {
        pool::interruptible(py, mesh)?
            .map(|mesh| Mesh::new(mesh, Vec::new()))
            .map_err(|error| errors::library(py, &error))
    }
}

#[pymethods]
impl Mesh {
    /// A mesh of arrays; numbers of nodes and cells must have been checked to be in the range of 32 bits.
    #[staticmethod]
    fn from_arrays(
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        cells: Cells<'_>,
        cell_groups: Groups<'_>,
        facet_groups: FacetGroups<'_>,
        node_groups: Groups<'_>,
    ) -> PyResult<Self> {
        let file = arrays::mesh(py, &points, &cells, &cell_groups, &facet_groups, &node_groups)?;
        Ok(Mesh::new(file.mesh, file.notes))
    }

    /// A mesh from a grid of VTK with a name for messages; lines in the groups `links` are cells.
    #[staticmethod]
    #[allow(clippy::too_many_arguments)]
    fn from_grid(
        py: Python<'_>,
        name: PathBuf,
        points: PyReadonlyArray2<'_, f64>,
        types: PyReadonlyArray1<'_, i64>,
        ends: PyReadonlyArray1<'_, i64>,
        connectivity: PyReadonlyArray1<'_, i64>,
        cell_arrays: Vec<(String, Option<Bound<'_, PyAny>>)>,
        point_arrays: Vec<(String, Option<Bound<'_, PyAny>>)>,
        links: Vec<String>,
    ) -> PyResult<Self> {
        let list = |array: &PyReadonlyArray1<'_, i64>| array.as_array().to_vec();
        let arrays = |all: Vec<(String, Option<Bound<'_, PyAny>>)>| {
            let array = |(name, values): (String, Option<Bound<'_, PyAny>>)| {
                let Some(values) = values else { return Ok(GridArray { name, numbers: None }) };
                let numbers = match values.extract::<PyReadonlyArray1<'_, i64>>() {
                    Ok(whole) => Numbers::Whole(list(&whole)),
                    Err(_) => {
                        let real: PyReadonlyArray1<'_, f64> = values.extract()?;
                        Numbers::Real(real.as_array().to_vec())
                    }
                };
                Ok(GridArray { name, numbers: Some(numbers) })
            };
            all.into_iter().map(array).collect::<PyResult<Vec<GridArray>>>()
        };
        let grid = Grid {
            points: points.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect(),
            types: list(&types),
            ends: list(&ends),
            connectivity: list(&connectivity),
            cell_arrays: arrays(cell_arrays)?,
            point_arrays: arrays(point_arrays)?,
        };
        let file = pool::interruptible(py, move || emmy_io::mesh::from_grid(&name, grid, &links))?;
        let file = file.map_err(|error| errors::argument(py, "mesh", &error.to_string()))?;
        Ok(Mesh::new(file.mesh, file.notes))
    }

    /// A mesh from a file; lines in the groups `links` are cells, and so are shells with `plane_shells`.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, links: Vec<String>, plane_shells: bool) -> PyResult<Self> {
        let options = MeshOptions { links, plane_shells };
        let file = pool::interruptible(py, move || emmy_io::mesh::read_with(&path, &options))?;
        let file = file.map_err(|error| errors::argument(py, "mesh", &error.to_string()))?;
        Ok(Mesh::of_file(file))
    }

    /// A mesh from the bytes of a VTU file; lines in the groups `links` are cells.
    #[staticmethod]
    fn from_vtu(py: Python<'_>, bytes: &[u8], links: Vec<String>) -> PyResult<Self> {
        let bytes = bytes.to_vec();
        let options = MeshOptions { links, ..MeshOptions::default() };
        let parse = move || emmy_io::mesh::parse_with("mesh.vtu".as_ref(), &bytes, &options);
        let file = pool::interruptible(py, parse)?;
        let file = file.map_err(|error| errors::argument(py, "mesh", &error.to_string()))?;
        Ok(Mesh::new(file.mesh, file.notes))
    }

    /// A mesh without cells, for rigid bodies alone.
    #[staticmethod]
    fn empty() -> Self {
        Mesh::of(mesh::Mesh::without_cells())
    }

    #[staticmethod]
    fn l_block(py: Python<'_>, cell_size: f64) -> PyResult<Self> {
        Mesh::made(py, move || mesh::l_block(cell_size))
    }

    #[staticmethod]
    fn r#box(py: Python<'_>, size: [f64; 3], cells: [usize; 3]) -> PyResult<Self> {
        Mesh::made(py, move || mesh::block(size, cells))
    }

    #[staticmethod]
    fn ring(py: Python<'_>, radii: [f64; 2], height: f64, cells: [usize; 3]) -> PyResult<Self> {
        Mesh::made(py, move || mesh::ring(radii, height, cells))
    }

    #[staticmethod]
    fn cylinder(py: Python<'_>, radius: f64, height: f64, cells: [usize; 2]) -> PyResult<Self> {
        Mesh::made(py, move || mesh::cylinder(radius, height, cells))
    }

    #[staticmethod]
    fn ball(py: Python<'_>, radius: f64, cells: usize) -> PyResult<Self> {
        Mesh::made(py, move || mesh::ball(radius, cells))
    }

    /// One mesh of parts with names.
    #[staticmethod]
    fn joined(py: Python<'_>, parts: Vec<(String, PyRef<'_, Mesh>)>) -> PyResult<Self> {
        let parts = parts.into_iter().map(|(name, part)| (name, part.file())).collect();
        let file = pool::work(py, || emmy_io::mesh::joined(parts))?;
        Ok(Mesh::of_file(file.map_err(|error| errors::argument(py, "parts", &error.to_string()))?))
    }

    #[staticmethod]
    fn rectangle(py: Python<'_>, size: [f64; 2], cells: [usize; 2]) -> PyResult<Self> {
        Mesh::made(py, move || mesh::rectangle(size, cells))
    }

    /// The mesh as a VTU file with all groups.
    fn vtu<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let text = pool::work(py, || emmy_io::vtk::mesh_file(&self.mesh))?;
        Ok(PyBytes::new(py, text.as_bytes()))
    }

    /// Links between points, with the group `links` of all of them.
    #[staticmethod]
    fn network<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        links: PyReadonlyArray2<'py, i64>,
        groups: Groups<'py>,
        link_groups: Groups<'py>,
    ) -> PyResult<Self> {
        let cells = vec![(CellKind::Line2.name().to_string(), links)];
        Mesh::from_arrays(py, points, cells, link_groups, FacetGroups::new(), groups)
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, self.mesh.points().as_flattened())
    }

    /// Nodes of the cells by kind.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        for kind in self.kinds() {
            let cells = self.mesh.cells().filter(|cell| cell.kind == kind);
            let nodes = cells.flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node)));
            table.set_item(kind.name(), table_of(py, nodes.collect(), kind.n_nodes())?)?;
        }
        Ok(table)
    }

    /// Numbers of the cells by kind.
    #[getter]
    fn cell_numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        for kind in self.kinds() {
            let cells = self.mesh.cells().enumerate().filter(|(_, cell)| cell.kind == kind);
            table.set_item(kind.name(), PyArray1::from_iter(py, cells.map(|(number, _)| number as i64)))?;
        }
        Ok(table)
    }

    #[getter]
    fn n_nodes(&self) -> usize {
        self.mesh.n_nodes()
    }

    #[getter]
    fn n_cells(&self) -> usize {
        self.mesh.n_cells()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Names of the groups with the kinds of their members.
    #[getter]
    fn group_names(&self) -> BTreeMap<String, Vec<&'static str>> {
        let groups = self.mesh.groups();
        let kinds = |name: &str| {
            let has = [
                ("cells", groups.cells.contains_key(name)),
                ("facets", groups.facets.contains_key(name)),
                ("nodes", groups.nodes.contains_key(name)),
            ];
            has.into_iter().filter(|(_, has)| *has).map(|(kind, _)| kind).collect()
        };
        groups.names().into_iter().map(|name| (name.to_string(), kinds(name))).collect()
    }

    /// Names of the groups of cells with links.
    #[getter]
    fn link_groups(&self) -> Vec<String> {
        let is_link = |&cell: &u32| self.mesh.cell(cell as usize).kind.dimension() == 1;
        let groups = self.mesh.groups().cells.iter().filter(|(_, cells)| cells.iter().any(is_link));
        groups.map(|(name, _)| name.clone()).collect()
    }

    fn cell_group<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<i64>>> {
        numbers(py, self.mesh.groups().cells(name))
    }

    fn node_group<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let nodes = self.mesh.groups().nodes.get(name);
        let nodes = nodes.ok_or_else(|| PyKeyError::new_err(name.to_string()))?;
        numbers(py, Ok(nodes))
    }

    /// Cells and faces of a group of facets, `(n, 2)`.
    fn facet_group<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let facets =
            self.mesh.groups().facets(name).map_err(|error| PyKeyError::new_err(error.to_string()))?;
        let pairs = facets.iter().flat_map(|facet| [i64::from(facet.cell), i64::from(facet.local)]);
        table_of(py, pairs.collect(), 2)
    }

    /// Nodes of each facet of a group.
    fn facet_nodes(&self, name: &str) -> PyResult<Vec<Vec<u32>>> {
        let facets =
            self.mesh.groups().facets(name).map_err(|error| PyKeyError::new_err(error.to_string()))?;
        Ok(facets.iter().map(|&facet| self.mesh.facet_nodes(facet).collect()).collect())
    }

    /// Nodes of a group with members of any kind.
    fn group_nodes<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let nodes = self.mesh.group_nodes(name).map_err(|error| PyKeyError::new_err(error.to_string()))?;
        numbers(py, Ok(&nodes))
    }

    fn nearest_node(&self, point: [f64; 3]) -> usize {
        self.mesh.nearest_node(point)
    }

    /// Nodes of each facet on the boundary.
    fn boundary(&self, py: Python<'_>) -> PyResult<Vec<Vec<u32>>> {
        pool::work(py, || self.mesh.boundary())
    }

    fn scaled(&self, py: Python<'_>, factor: f64) -> PyResult<Self> {
        let file = pool::work(py, || self.file().scaled(factor))?;
        Ok(Mesh::of_file(file.map_err(|error| errors::library(py, &error))?))
    }

    /// The mesh at another place: a rotation by an angle about an axis through a point, and then a shift.
    fn placed(
        &self,
        py: Python<'_>,
        turn: Option<([f64; 3], f64, [f64; 3])>,
        at: [f64; 3],
    ) -> PyResult<Self> {
        let turned = |(axis, angle, about)| Placement::default().turned(axis, angle, about);
        let placement = turn.map_or(Ok(Placement::default()), turned);
        let placement = placement.map_err(|error| errors::argument(py, "turn", &error.to_string()))?;
        let file = pool::work(py, || self.file().placed(&placement.shifted(at)))?;
        Ok(Mesh::of_file(file.map_err(|error| errors::argument(py, "turn", &error.to_string()))?))
    }

    fn merged(&self, py: Python<'_>, within: f64) -> PyResult<Self> {
        let file = pool::work(py, || self.file().merged(within))?;
        Ok(Mesh::of_file(file.map_err(|error| errors::library(py, &error))?))
    }

    /// Entries of a deck besides the mesh, each as TOML.
    #[getter]
    fn entries(&self) -> PyResult<Vec<String>> {
        let text = |own: &DeckEntry| own.to_text().map_err(|error| PyValueError::new_err(error.to_string()));
        self.entries.iter().map(text).collect()
    }

    /// The same mesh with other entries, as [`Mesh::entries`] gives them.
    fn with_entries(&self, entries: Vec<String>) -> PyResult<Self> {
        let entry = |text: &String| {
            DeckEntry::of_text(text).map_err(|error| PyValueError::new_err(error.to_string()))
        };
        let entries = entries.iter().map(entry).collect::<PyResult<_>>()?;
        Ok(Mesh { mesh: self.mesh.clone(), notes: self.notes.clone(), entries })
    }

    /// The same mesh with the entries that act when some are switched off, and with notes on them.
    fn acting(&self, switched_off: Vec<String>) -> Self {
        let (entries, notes) = acting_entries(&self.entries, &self.mesh, &switched_off);
        Mesh { mesh: self.mesh.clone(), notes: [&self.notes[..], &notes].concat(), entries }
    }

    /// Worst values of the measures of quality, with their cells.
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let quality = pool::work(py, || mesh::quality(&self.mesh))?;
        let table = PyDict::new(py);
        for (name, worst) in [
            ("jacobian_ratio", quality.jacobian_ratio),
            ("scaled_jacobian", quality.scaled_jacobian),
            ("aspect_ratio", quality.aspect_ratio),
        ] {
            table.set_item(name, (worst.value, worst.cell))?;
        }
        table.set_item("volume", quality.volume)?;
        table.set_item("inverted", quality.inverted)?;
        Ok(table)
    }
}

fn numbers<'py>(py: Python<'py>, members: emmy::Result<&[u32]>) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let members = members.map_err(|error| PyKeyError::new_err(error.to_string()))?;
    Ok(PyArray1::from_iter(py, members.iter().map(|&member| i64::from(member))))
}

/// An array of three columns.
pub(crate) fn vectors<'py>(py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    table_of(py, numbers.to_vec(), 3)
}

/// An array of a number of columns.
pub(crate) fn table_of<T: numpy::Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}
