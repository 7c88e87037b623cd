//! The linearised stage equations: an approximate tangent from one stiffness, decoupled into one system for each mode.

mod approximate_tangent;
mod border;
mod decoupling;
mod linearised;
mod mode_solvers;
mod solver_choice;
mod strain_rates;
mod turning;

#[cfg(test)]
mod multigrid_tests;

pub(crate) use approximate_tangent::ApproximateTangent;
pub(super) use border::Border;
pub(super) use linearised::LinearisedStages;
