//! Gradients by the discrete adjoint against differences of whole motions and formulae, and the error of a goal against the true one.

#[path = "../shared/blocks.rs"]
mod blocks;
mod checkpoints;
mod goal_error;
mod parameters;
#[path = "../shared/points.rs"]
mod points;
mod problems;
mod refusals;
mod state;
