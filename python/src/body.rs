//! Bodies and problems.

use std::path::PathBuf;
use std::sync::Arc;

use emmy::body::{BlockRow, Mobility};
use emmy::mesh::MeshBuilder;
use emmy::motion::State;
use emmy_io::input::{self, Overrides, Tree};
use emmy_io::units::{SYSTEMS, UnitSystem};
use numpy::ndarray::{Array3, ArrayView2};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rayon::prelude::*;

use crate::function::{Callables, of_input};
use crate::mesh::{Mesh, table_of, vectors};
use crate::snapshot::{Snapshot, StateArrays, StateTuple, arrays, nodal, tuple};
use crate::tree::tree;
use crate::{errors, pool, spectra};

/// Checks a table of a section of the input alone.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, section: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let tree = tree(value, "", &mut Callables::default())?;
    input::check(section, &tree).map_err(|error| errors::input(py, &error))
}

/// Places of the components of a symmetric tensor in a matrix.
const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Stored energies of a material at Green-Lagrange strains `(n, 3, 3)`.
#[pyfunction]
pub(crate) fn energy<'py>(
    py: Python<'py>,
    material: &Bound<'py, PyAny>,
    strains: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let energies = responses(py, material, &strains)?.into_iter().map(|(energy, _)| energy);
    Ok(PyArray1::from_iter(py, energies))
}

/// Second Piola-Kirchhoff stresses of a material at Green-Lagrange strains, both `(n, 3, 3)`.
#[pyfunction]
pub(crate) fn stress<'py>(
    py: Python<'py>,
    material: &Bound<'py, PyAny>,
    strains: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let mut stresses = Array3::zeros(strains.as_array().dim());
    for (n, (_, stress)) in responses(py, material, &strains)?.into_iter().enumerate() {
        for ((i, j), component) in COMPONENTS.into_iter().zip(stress) {
            stresses[[n, i, j]] = component;
            stresses[[n, j, i]] = component;
        }
    }
    Ok(PyArray3::from_owned_array(py, stresses))
}

/// Energy and stress at each strain.
fn responses(
    py: Python<'_>,
    material: &Bound<'_, PyAny>,
    strains: &PyReadonlyArray3<'_, f64>,
) -> PyResult<Vec<(f64, [f64; 6])>> {
    let tree = tree(material, "", &mut Callables::default())?;
    let region = input::material_region(&tree).map_err(|error| errors::input(py, &error))?;
    let symmetric =
        |strain: ArrayView2<'_, f64>| COMPONENTS.map(|(i, j)| 0.5 * (strain[[i, j]] + strain[[j, i]]));
    let tensors: Vec<[f64; 6]> = strains.as_array().outer_iter().map(symmetric).collect();
    let response = |strain: &[f64; 6]| {
        let mut stress = [0.0; 6];
        let energy = region.strain_energy(strain, &mut stress);
        energy.map(|energy| (energy, stress))
    };
    let responses =
        pool::work(py, || tensors.par_iter().with_min_len(64).map(response).collect::<Option<Vec<_>>>())?
            .ok_or_else(|| errors::argument(py, "material", "a material of links has no strain tensor"))?;
    match responses.iter().position(|(energy, _)| !energy.is_finite()) {
        Some(at) => {
            let strain = strains.as_array().index_axis(numpy::ndarray::Axis(0), at).to_string();
            let strain = strain.split_whitespace().collect::<Vec<_>>().join(" ");
            Err(errors::argument(py, "strain", &format!("the material has no energy at the strain {strain}")))
        }
        None => Ok(responses),
    }
}

/// Standard acceleration of gravity in a system of units.
#[pyfunction]
pub(crate) fn standard_gravity(py: Python<'_>, units: &str) -> PyResult<f64> {
    let unknown = || {
        let known = SYSTEMS.each_ref().map(|system| system.name).join(", ");
        errors::argument(py, "units", &format!("{units:?} is not a system of units; there is {known}"))
    };
    UnitSystem::named(units).map(emmy_io::units::standard_gravity).ok_or_else(unknown)
}

/// Version of Emmy.
#[pyfunction]
pub(crate) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// A body; immutable.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Body {
    /// The sections of the input that describe it.
    tree: Vec<(String, Tree)>,
    pub(crate) callables: Callables,
    pub(crate) problem: Arc<input::Problem>,
}

/// A plan that a problem needs and a body does not have.
fn any_time() -> (String, Tree) {
    let phase = vec![("until".to_string(), Tree::Number(1.0)), ("size".to_string(), Tree::Number(1.0))];
    let steps = Tree::List(vec![Tree::Table(phase)]);
    let time = vec![("scheme".to_string(), Tree::Text("DGM".to_string())), ("steps".to_string(), steps)];
    ("time".to_string(), Tree::Table(time))
}

/// A body may have loads that its equilibria alone have.
fn of_body() -> Overrides {
    Overrides { is_of_body: true, ..Overrides::default() }
}

/// A start that permits every motion of the supports; the motion says what its start is.
fn any_start() -> (String, Tree) {
    ("equilibrium".to_string(), Tree::Table(Vec::new()))
}

/// The entries of a table.
pub(crate) fn entries(tree: Tree) -> Vec<(String, Tree)> {
    match tree {
        Tree::Table(entries) => entries,
        _ => Vec::new(),
    }
}

impl Body {
    /// The problem of the body with further sections of the input; it shares the body.
    pub(crate) fn problem(
        &self,
        py: Python<'_>,
        further: Vec<(String, Tree)>,
    ) -> PyResult<Arc<input::Problem>> {
        self.problem_of(py, further, &Overrides::default())
    }

    /// The same without a motion: a plan among the sections does not count.
    fn problem_at_rest(&self, py: Python<'_>, further: Vec<(String, Tree)>) -> PyResult<Arc<input::Problem>> {
        self.problem_of(py, further, &of_body())
    }

    fn problem_of(
        &self,
        py: Python<'_>,
        further: Vec<(String, Tree)>,
        overrides: &Overrides,
    ) -> PyResult<Arc<input::Problem>> {
        let tree = Tree::Table([self.tree.clone(), further].concat());
        let problem = pool::work(py, || of_input(|| input::build(&tree, overrides, Some(&self.problem))))?;
        problem.map(Arc::new).map_err(|error| errors::input(py, &error))
    }

    pub(crate) fn inner(&self) -> &emmy::body::Body {
        &self.problem.body
    }

    /// Degrees of freedom of the nodes of the mesh; incompatible modes have further ones.
    pub(crate) fn n_mesh_dofs(&self) -> usize {
        self.inner().mesh().n_dofs()
    }

    /// A displacement `(n, 3)` as the library has it.
    pub(crate) fn displacement(
        &self,
        py: Python<'_>,
        u: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Vec<f64>> {
        self.check_nodes(py)?;
        u.map_or(Ok(vec![0.0; self.n_mesh_dofs()]), |u| nodal(py, self.inner(), &u, "u"))
    }

    /// Rejects internal nodes, which no array of the mesh contains.
    pub(crate) fn check_nodes(&self, py: Python<'_>) -> PyResult<()> {
        if self.n_mesh_dofs() < self.inner().n_dofs() {
            let message = "a body with incompatible modes has internal nodes, which no array of the mesh \
                           contains; emmy.modes and emmy.equilibrium take them into account";
            return Err(errors::argument(py, "regions", message));
        }
        Ok(())
    }
}

/// Numbers of rigid bodies, joints and constraints, degrees of freedom, driven ones; names of joints.
type Counts<'py> = (
    (usize, usize, usize, usize, Option<usize>, usize),
    Bound<'py, PyTuple>,
    Bound<'py, PyTuple>,
    Bound<'py, PyTuple>,
);

/// Driven degrees of freedom with their displacements and velocities.
type Prescribed<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Rows of a sparse matrix: numbers, columns, ends of the rows, number of rows.
pub(crate) type Sparse<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, usize);

/// The matrix of 3x3 blocks, by rows.
pub(crate) fn sparse<'py>(py: Python<'py>, rows: &[BlockRow]) -> PyResult<Sparse<'py>> {
    let (numbers, columns, ends) = pool::work(py, || {
        let (mut numbers, mut columns, mut ends) = (Vec::new(), Vec::new(), vec![0]);
        for row in rows {
            for i in 0..3 {
                for (column, block) in row {
                    for j in 0..3 {
                        numbers.push(block[3 * i + j]);
                        columns.push(i64::from(3 * column) + j as i64);
                    }
                }
                ends.push(numbers.len() as i64);
            }
        }
        (numbers, columns, ends)
    })?;
    let [columns, ends] = [columns, ends].map(|list| PyArray1::from_vec(py, list));
    Ok((PyArray1::from_vec(py, numbers), columns, ends, 3 * rows.len()))
}

#[pymethods]
impl Body {
    #[new]
    fn new(py: Python<'_>, sections: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut callables = Callables::default();
        let sections = entries(tree(sections, "", &mut callables)?);
        let whole = Tree::Table([sections.clone(), vec![any_time(), any_start()]].concat());
        let problem = pool::work(py, || of_input(|| input::build(&whole, &of_body(), None)))?;
        let problem = problem.map_err(|error| errors::input(py, &error))?;
        Ok(Body { tree: sections, callables, problem: Arc::new(problem) })
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.callables.traverse(&visit)
    }

    fn __clear__(&self) {
        self.callables.clear();
    }

    #[getter]
    fn n_dofs(&self) -> usize {
        self.inner().n_dofs()
    }

    /// Held and tied components of the nodes.
    #[getter]
    fn fixed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        table_of(py, self.inner().fixed()[..self.n_mesh_dofs()].to_vec(), 3)
    }

    /// Number of degrees of freedom of nodes that follow others.
    #[getter]
    fn n_tied(&self) -> usize {
        3 * self.inner().ties().iter().map(|tie| tie.n_followers).sum::<usize>()
    }

    /// Number of nodes, with those of rigid bodies.
    #[getter]
    fn n_nodes(&self) -> usize {
        self.inner().mesh().n_nodes()
    }

    /// How many ways the mechanism can move.
    fn mobility<'py>(&self, py: Python<'py>) -> PyResult<Counts<'py>> {
        let Mobility {
            n_bodies,
            n_joints,
            n_constraints,
            n_redundant,
            degrees_of_freedom,
            n_driven,
            redundant,
            indeterminate,
            indeterminate_drives,
        } = pool::work(py, || self.inner().mobility())?;
        let numbers = (n_bodies, n_joints, n_constraints, n_redundant, degrees_of_freedom, n_driven);
        Ok((
            numbers,
            PyTuple::new(py, redundant)?,
            PyTuple::new(py, indeterminate)?,
            PyTuple::new(py, indeterminate_drives)?,
        ))
    }

    #[getter]
    fn total_mass(&self) -> f64 {
        self.inner().lumped_mass().iter().sum()
    }

    /// Centre of mass in the reference configuration.
    #[getter]
    fn center_of_mass(&self) -> [f64; 3] {
        let body = self.inner();
        let mut sum = [0.0; 3];
        let mut mass = 0.0;
        for (m, point) in body.lumped_mass().iter().zip(body.mesh().points()) {
            mass += m;
            (0..3).for_each(|d| sum[d] += m * point[d]);
        }
        sum.map(|sum| sum / mass)
    }

    #[getter]
    fn mesh(&self) -> Mesh {
        Mesh::of(self.inner().mesh().clone())
    }

    /// Static equilibrium under the loads at t = 0.
    fn equilibrium<'py>(
        &self,
        py: Python<'py>,
        load_steps: usize,
        settings: &Bound<'py, PyAny>,
    ) -> PyResult<StateTuple<'py>> {
        let mut further = entries(tree(settings, "", &mut Callables::default())?);
        let load_steps = vec![("load_steps".to_string(), Tree::Whole(load_steps as i64))];
        further.push(("equilibrium".to_string(), Tree::Table(load_steps)));
        further.push(any_time());
        let problem = self.problem_at_rest(py, further)?;
        let state = pool::work(py, || problem.start_state(&mut []))?;
        tuple(py, &self.problem.body, &state.map_err(|error| errors::start(py, error))?)
    }

    /// The output of `emmy check` on the body.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        pool::work(py, || emmy_cli::report_on_body(&self.problem))
    }

    /// The sections of the body as TOML.
    #[getter]
    fn toml(&self) -> String {
        input::body_sections(&self.problem.resolved)
    }

    /// Remarks of the reader on the body; that nothing moves it concerns a motion.
    #[getter]
    pub(crate) fn notes(&self) -> Vec<String> {
        let notes = self.problem.notes.iter();
        let of_motion = [input::NOTHING_MOVES, input::UNLOADED];
        let is_of_motion = |note: &str| {
            of_motion.contains(&note)
                || [input::END_OF_RUN, input::PUSHES].iter().any(|part| note.contains(part))
        };
        notes.filter(|note| !is_of_motion(note)).cloned().collect()
    }

    /// Consistent mass matrix of the nodes of the mesh; internal nodes of incompatible modes are massless.
    fn mass<'py>(&self, py: Python<'py>) -> PyResult<Sparse<'py>> {
        let body = self.inner();
        let pattern = body.pattern();
        let n_nodes = body.mesh().n_nodes();
        let block = |position: usize| {
            let mass = body.mass()[position];
            std::array::from_fn(|entry| if entry % 4 == 0 { mass } else { 0.0 })
        };
        let row = |row: usize| {
            let row = pattern.row(row).iter().copied().zip(pattern.range(row).map(block));
            row.filter(|&(column, _)| (column as usize) < n_nodes).collect()
        };
        let rows: Vec<BlockRow> = pool::work(py, || (0..n_nodes).map(row).collect())?;
        sparse(py, &rows)
    }

    /// Stiffness at a displacement.
    #[pyo3(signature = (u=None))]
    fn stiffness<'py>(
        &self,
        py: Python<'py>,
        u: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Sparse<'py>> {
        let displacement = self.displacement(py, u)?;
        let rows = pool::work(py, || self.inner().stiffness(&displacement))?;
        sparse(py, &rows.map_err(|error| errors::library(py, &error))?)
    }

    /// Internal force of a displacement.
    fn internal_force<'py>(
        &self,
        py: Python<'py>,
        u: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let displacement = self.displacement(py, Some(u))?;
        let force = pool::work(py, || self.inner().internal_force(&displacement))?;
        vectors(py, &force.map_err(|error| errors::library(py, &error))?)
    }

    /// All loads at a time and a displacement.
    #[pyo3(signature = (time, u=None))]
    fn external_force<'py>(
        &self,
        py: Python<'py>,
        time: f64,
        u: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let displacement = self.displacement(py, u)?;
        let force = pool::work(py, || of_input(|| self.inner().external_force(time, &displacement)))?;
        vectors(py, &force.map_err(|error| errors::library(py, &error))?)
    }

    /// Given displacements and velocities at a time.
    fn prescribed<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Prescribed<'py>> {
        let given = pool::work(py, || of_input(|| self.inner().prescribed(time)))?;
        let given = given.map_err(|error| errors::library(py, &error))?;
        let dofs = PyArray1::from_iter(py, given.dofs.iter().map(|&dof| dof as i64));
        let [u, v] = [given.displacement, given.velocity].map(|list| PyArray1::from_vec(py, list));
        Ok((dofs, u, v))
    }

    /// Damping matrix at rest.
    fn damping<'py>(&self, py: Python<'py>) -> PyResult<Sparse<'py>> {
        self.check_nodes(py)?;
        let rows = pool::work(py, || self.inner().damping())?;
        sparse(py, &rows.map_err(|error| errors::library(py, &error))?)
    }

    /// Strain energy of a displacement.
    fn strain_energy(&self, py: Python<'_>, u: PyReadonlyArray2<'_, f64>) -> PyResult<f64> {
        let displacement = self.displacement(py, Some(u))?;
        let state = pool::work(py, || self.inner().strain_state(&displacement))?;
        if state.smallest_determinant > 0.0 {
            return Ok(state.strain_energy);
        }
        let inverted = emmy::Error::Inverted { cell: state.smallest_cell, det: state.smallest_determinant };
        Err(errors::library(py, &inverted))
    }

    /// Harmonic response about the reference, or about a state, as [`spectra::response`].
    #[pyo3(signature = (request, state=None))]
    fn response<'py>(
        &self,
        py: Python<'py>,
        request: spectra::Request,
        state: Option<About<'py>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let state = state.map(|about| about.state(py, self.inner())).transpose()?;
        spectra::response(py, self.inner(), state.as_ref(), request)
    }

    /// Natural modes about the reference, or about a state: `frequencies`, `shapes`, `effective_masses`, `residuals`,
    /// `rigid`.
    #[pyo3(signature = (count, state=None))]
    fn modes<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        state: Option<About<'py>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let state = state.map(|about| about.state(py, self.inner())).transpose()?;
        let found = pool::work(py, || match &state {
            Some(state) => emmy::modes::modes_about(self.inner(), state, count),
            None => emmy::modes::modes(self.inner(), count),
        })?;
        let modes = found.map_err(|error| match error {
            emmy::Error::Modes { .. } | emmy::Error::Linear { .. } | emmy::Error::Rotation { .. } => {
                errors::step(py, &error)
            }
            error => errors::library(py, &error),
        })?;
        let table = PyDict::new(py);
        let list = |number: fn(&emmy::modes::Mode) -> f64| PyArray1::from_iter(py, modes.iter().map(number));
        table.set_item("frequencies", list(|mode| mode.frequency()))?;
        table.set_item("residuals", list(|mode| mode.residual))?;
        table.set_item("rigid", modes.iter().filter(|mode| mode.angular_frequency == 0.0).count())?;
        let masses = modes.iter().flat_map(|mode| mode.effective_mass).collect();
        table.set_item("effective_masses", table_of(py, masses, 3)?)?;
        let n = self.n_mesh_dofs();
        let shapes: Vec<f64> = modes.iter().flat_map(|mode| mode.shape[..n].iter().copied()).collect();
        table.set_item("shapes", PyArray1::from_vec(py, shapes).reshape([modes.len(), n / 3, 3])?)?;
        Ok(table)
    }

    /// Whether a load, support, mass or region refers to a function.
    #[getter]
    fn has_functions(&self) -> bool {
        !self.callables.is_empty()
    }
}

/// The state about which a body vibrates.
#[derive(FromPyObject)]
enum About<'py> {
    Snapshot(Py<Snapshot>),
    State(StateArrays<'py>),
}

impl About<'_> {
    fn state(self, py: Python<'_>, body: &emmy::body::Body) -> PyResult<State> {
        match self {
            About::State(given) => arrays(py, body, given),
            About::Snapshot(snapshot) => {
                let state = snapshot.get().checkpoint.state(body);
                let state = state.map_err(|error| errors::argument(py, "state", &error.to_string()))?;
                let time = state.time;
                state.transferred(body, time).map_err(|error| errors::library(py, &error))
            }
        }
    }
}

/// A mesh without the nodes that some rigid bodies have at its end, and without their groups.
fn without_rigid_bodies(mesh: &emmy::mesh::Mesh, names: &[&str]) -> emmy::Result<emmy::mesh::Mesh> {
    if mesh.n_cells() == 0 {
        return Ok(emmy::mesh::Mesh::without_cells());
    }
    let groups = mesh.groups();
    let first = names.iter().filter_map(|name| groups.nodes.get(*name)?.first()).min();
    let mut builder = MeshBuilder::new();
    let n_nodes = first.map_or(mesh.n_nodes(), |&first| first as usize);
    mesh.points()[..n_nodes].iter().for_each(|&point| _ = builder.point(point));
    for cell in mesh.cells() {
        builder.cell(cell.kind, cell.nodes)?;
    }
    groups.cells.iter().for_each(|(name, cells)| builder.cell_group(name, cells.iter().copied()));
    groups.facets.iter().for_each(|(name, facets)| builder.facet_group(name, facets.iter().copied()));
    let own = groups.nodes.iter().filter(|(name, _)| !names.contains(&name.as_str()));
    own.for_each(|(name, nodes)| builder.node_group(name, nodes.iter().copied()));
    builder.build()
}

/// An input file, read and checked.
#[pyclass(frozen, module = "emmy._emmy")]
pub(crate) struct Problem {
    pub(crate) problem: Arc<input::Problem>,
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (path, set, until=None))]
    fn new(py: Python<'_>, path: PathBuf, set: Vec<String>, until: Option<f64>) -> PyResult<Self> {
        let overrides = Overrides { set, until, ..Overrides::default() };
        let problem = pool::work(py, || input::read(&path, &overrides))?;
        Ok(Problem { problem: Arc::new(problem.map_err(|error| errors::input(py, &error))?) })
    }

    /// The input with all values in effect.
    #[getter]
    fn toml(&self) -> &str {
        &self.problem.resolved
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.problem.notes.clone()
    }

    #[getter]
    fn title(&self) -> Option<&str> {
        self.problem.title.as_deref()
    }

    /// Its mesh, without the nodes of rigid bodies and couplings.
    fn mesh(&self, py: Python<'_>) -> PyResult<Mesh> {
        let body = &self.problem.body;
        let rigid = self.problem.rigid.iter().map(|own| own.name.as_str());
        let names: Vec<&str> =
            rigid.chain(self.problem.couplings.iter().map(|own| own.name.as_str())).collect();
        if names.is_empty() {
            return Ok(Mesh::of(body.mesh().clone()));
        }
        without_rigid_bodies(body.mesh(), &names).map(Mesh::of).map_err(|error| errors::library(py, &error))
    }
}
