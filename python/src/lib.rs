//! The private module `emmy._emmy`: the library behind the package `emmy` of Python.
//!
//! It contains no mathematics and knows no key of the input: the package hands over trees with the words of the input
//! file, which `emmy_io::input` checks. Everything that takes longer than a microsecond runs without the lock of the
//! interpreter, in a thread pool of Emmy's own.

mod adjoint;
mod body;
mod errors;
mod function;
mod mesh;
mod motion;
mod plan;
mod pool;
mod running;
mod snapshot;
mod step;
mod tree;
mod verbs;

use pyo3::prelude::*;

/// The library behind the package `emmy`.
#[pymodule(gil_used = false)]
mod _emmy {
    #[pymodule_export]
    use super::adjoint::{Goal, GoalError, Gradient, Parameter};
    #[pymodule_export]
    use super::body::{Body, Problem, check, energy, stress, version};
    #[pymodule_export]
    use super::function::{Field, Function};
    #[pymodule_export]
    use super::mesh::Mesh;
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::pool::{on_one_thread, set_threads, threads};
    #[pymodule_export]
    use super::snapshot::Snapshot;
    #[pymodule_export]
    use super::step::Step;
    #[pymodule_export]
    use super::verbs::{main, verb};
}
