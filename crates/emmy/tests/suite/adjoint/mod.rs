//! Gradients by the discrete adjoint against differences of whole motions and formulae, and the error of a goal against
//! the true one.

mod checkpoints;
mod equilibrium;
mod goal_error;
mod parameters;
mod problems;
mod rejections;
mod state;
