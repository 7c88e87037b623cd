//! Values of Python as a tree of the input.

use emmy_io::input::Tree;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::errors;
use crate::function::{Callables, Field, Function};
use crate::mesh::Mesh;

/// Deeper trees are not inputs: they contain themselves.
const DEEPEST: usize = 32;

/// The tree of a value at a path; its functions are added to `callables`.
///
/// # Errors
/// `TypeError` for a value that no input holds.
pub(crate) fn tree(value: &Bound<'_, PyAny>, path: &str, callables: &mut Callables) -> PyResult<Tree> {
    read(value, path, callables, 0)
}

fn read(value: &Bound<'_, PyAny>, path: &str, callables: &mut Callables, depth: usize) -> PyResult<Tree> {
    if depth > DEEPEST {
        return Err(PyTypeError::new_err(format!("{path}: lists and tables are nested too deeply")));
    }
    if let Ok(value) = value.cast::<PyBool>() {
        return Ok(Tree::Boolean(value.is_true()));
    }
    if let Ok(value) = value.cast::<PyInt>() {
        return value.extract().map(Tree::Whole).or_else(|_| value.extract().map(Tree::Number));
    }
    if let Ok(value) = value.cast::<PyFloat>() {
        return Ok(Tree::Number(value.value()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Tree::Text(text.to_str()?.to_string()));
    }
    let items = |items: &mut dyn Iterator<Item = Bound<'_, PyAny>>, callables: &mut Callables| {
        let item =
            |(i, item): (usize, Bound<'_, PyAny>)| read(&item, &format!("{path}[{i}]"), callables, depth + 1);
        items.enumerate().map(item).collect::<PyResult<Vec<_>>>().map(Tree::List)
    };
    if let Ok(list) = value.cast::<PyList>() {
        return items(&mut list.iter(), callables);
    }
    if let Ok(tuple) = value.cast::<PyTuple>() {
        return items(&mut tuple.iter(), callables);
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let key: String = key.extract()?;
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            Ok((key, read(&value, &path, callables, depth + 1)?))
        };
        return table.iter().map(entry).collect::<PyResult<Vec<_>>>().map(Tree::Table);
    }
    if let Ok(mesh) = value.cast::<Mesh>() {
        return Ok(Tree::Mesh(mesh.get().mesh.clone()));
    }
    if let Ok(function) = value.cast::<Function>() {
        return Ok(Tree::TimeFunction(function.get().time_function(value.py(), path, callables)));
    }
    if let Ok(field) = value.cast::<Field>() {
        return Ok(Tree::Field(field.get().field(value.py(), path, callables)));
    }
    // Arrays and numbers of NumPy.
    if value.hasattr("tolist")? {
        let list = value.call_method0("tolist")?;
        if !list.is(value) && !list.hasattr("tolist")? {
            return read(&list, path, callables, depth + 1);
        }
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{}: {kind} is not a value of an input",
        errors::place(value.py(), path)?
    )))
}
