//! Sparse linear algebra: block pattern and matrix, ordering, factorisation, Krylov. The only place that names a
//! linear-algebra crate.

#![allow(non_snake_case)]

mod block_cholesky;
mod cholesky;
mod dense;
mod gmres;
mod ordering;
mod pattern;
pub mod reduce;
mod stages;

pub use block_cholesky::BlockCholesky;
pub use cholesky::Cholesky;
pub use dense::{Eigenpairs, eigenpairs, inverse};
pub use gmres::{Gmres, LinearSystem, Solution};
pub use ordering::nested_dissection;
pub use pattern::Pattern;
pub use stages::{RowPart, StageMatrix};
