//! Sparse linear algebra: block pattern and matrix, ordering, factorisation, Krylov methods. Only this module uses
//! linear-algebra crates.

#![allow(non_snake_case)]

mod block_cholesky;
mod blocks;
mod condensation;
mod conjugate_gradients;
mod couplings;
mod dense;
mod direct;
mod eigen;
mod factor;
mod gmres;
mod incomplete_cholesky;
mod kernel;
mod lower;
mod lu;
mod metis;
mod multigrid;
mod ordering;
mod pattern;
mod real;
pub mod reduce;
mod row_couplings;
mod shared_rows;
mod shifted;
mod shifted_solver;
mod solver;
mod stages;
mod sweep;
mod symmetric;
mod team_solver;
mod triangular;
mod widened;

pub use block_cholesky::BlockCholesky;
pub(crate) use condensation::Condensation;
pub(crate) use conjugate_gradients::{Approximate, ConjugateGradients};
pub use couplings::Couplings;
pub(crate) use dense::{DenseLu, antisymmetric_eigenpairs, eigenvalues, largest_eigenvalue};
pub use dense::{
    Eigenpairs, accurate_inverse, accurate_sum, eigenpairs, eliminate, inverse, null_space,
    null_space_within, split,
};
pub(crate) use direct::{Direct, DirectPair};
pub(crate) use eigen::{BLOCK, Eigenmodes, Pencil, smallest};
pub use gmres::{Gmres, LinearSystem, Solution};
pub(crate) use incomplete_cholesky::IncompleteCholesky;
pub use lu::SparseLu;
pub(crate) use multigrid::Multigrid;
pub use ordering::{nested_dissection, partition};
pub use pattern::Pattern;
pub(crate) use real::Real;
pub(crate) use shared_rows::SharedRows;
pub(crate) use shifted::ShiftedMatrix;
pub(crate) use shifted_solver::{Iterative, Shifted, ShiftedSolver};
pub use solver::{SOLVERS, Solver, SolverChoice, SolverKind};
pub use stages::{BlockRow, RowPart, StageMatrix};
pub(crate) use sweep::SweepOrder;
pub(crate) use team_solver::TeamSolver;
pub(crate) use widened::CoupledCholesky;
pub use widened::Widened;
