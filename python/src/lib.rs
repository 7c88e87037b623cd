//! The private module `emmy._emmy`: the library behind the package `emmy` of Python.
//!
//! This layer only translates. The package passes trees with the words of the input file, and `emmy_io::input` checks
//! them. All work of more than a microsecond releases the lock of the interpreter and runs in Emmy's own thread pool.

mod adjoint;
mod arrays;
mod body;
mod errors;
mod function;
mod mesh;
mod motion;
mod plan;
mod pool;
mod running;
mod snapshot;
mod spectra;
mod starting;
mod step;
mod tree;
mod verbs;
mod work;

use pyo3::prelude::*;

/// The library behind the package `emmy`.
#[pymodule(gil_used = false)]
mod _emmy {
    #[pymodule_export]
    use super::adjoint::{Goal, GoalError, Gradient, Parameter};
    #[pymodule_export]
    use super::body::{Body, Problem, check, energy, standard_gravity, stress, version};
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
    use super::spectra::spectrum;
    #[pymodule_export]
    use super::step::Step;
    #[pymodule_export]
    use super::verbs::{main, verb};
}
