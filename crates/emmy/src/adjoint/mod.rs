//! The discrete adjoint of a motion: gradients of a goal by the initial state and by parameters, and the error of a
//! goal.
//!
//! The step of a time element takes the displacement u_1 and the velocity v_1 to those at its end by the rates x_j that
//! solve
//!
//! ```math
//! R_i = sum_j (a^-1)_ij M (x_j - h v_1) + h^2 (f_i(u_1, x) - f_i^ext) = 0
//! u_2 = u_1 + sum_j b_j x_j,      v_2 = v_1 + sum_j beta_j (x_j/h - v_1),      beta_j = sum_i b_i (a^-1)_ij
//! ```
//!
//! A goal J is a function of the state at the end of the motion. Let ubar, vbar be its derivatives by the displacement
//! and the velocity at the end of a step. With multipliers mu_i of the stage equations, the derivatives by the state at
//! the start of the step and by a parameter theta follow from one linear system with the transposed tangent:
//!
//! ```math
//! sum_i K_ij^T mu_i = b_j ubar_2 + beta_j/h vbar_2,      K_ij = (a^-1)_ij M + h^2 df_i/dx_j
//! ubar_1 = ubar_2 - h^2 sum_i (df_i/du_1)^T mu_i
//! vbar_1 = (1 - sum_j beta_j) vbar_2 + h M sum_ij (a^-1)_ij mu_i
//! dJ/dtheta -= sum_i mu_i . dR_i/dtheta
//! ```
//!
//! K is the exact tangent, which is not symmetric for AS and DGM of any degree, nor for FE with k > 1. Fixed degrees of
//! freedom are left out. With the momentum p = M v the derivatives by it are `pbar = M^-1 vbar`. The gradients belong
//! to the discrete motion, to the tolerance of Newton's iteration: an optimiser gets the gradient of the function that
//! it evaluates.
//!
//! *A start from an equilibrium* solves `f(u_0) = F`, which depends on the parameters too. With the multipliers of
//! these equations it adds
//!
//! ```math
//! K^T mu = ubar_0,      dJ/dtheta -= mu . d(f - F)/dtheta
//! ```
//!
//! with the stiffness K of the equilibrium: one more linear system for all parameters. The state of
//! [`crate::equilibrium::Equilibrium::start`] says that it is one ([`crate::motion::State::is_equilibrium`]). Any other
//! start is data.
//!
//! *Step sizes are data.* If they are chosen by the error, the gradient is the gradient of the motion with these step
//! sizes; the choice is not differentiated.
//!
//! *Checkpoints.* The steps are needed in reverse order. A [`Trajectory`] keeps the complete motion about every sqrt(N)
//! steps, and repeats the steps in between, segment by segment. (Griewank and Walther 2000, Algorithm 799: revolve, ACM
//! Transactions on Mathematical Software 26, spend more evaluations for less memory.) Memory grows with sqrt(N); the
//! cost is one more motion.
//!
//! *The error of a goal.* To first order, an error of the state at the end of step n changes the goal by its product
//! with the adjoint there. With the local error eps_n of each step, the difference of the computed step and the motion
//! from the same state,
//!
//! ```math
//! J(u_h) - J(u) ~ sum_n ubar_n . eps_u,n + vbar_n . eps_v,n
//! ```
//!
//! This is the dual-weighted estimate of Becker and Rannacher (2001, An optimal control approach to a posteriori error
//! estimation in finite element methods, Acta Numerica 10), with the discrete instead of the continuous adjoint. Local
//! errors are the differences to the element of degree k + 1 over the same step from the same state, as in
//! [`crate::time::LocalError`]. The estimate is exact in the limit of small steps and has a sign, and its terms show
//! which steps cause the error. It does not contain the error of the mesh. Because it is linear in the errors, it fails
//! if the steps lose the phase of important modes by a radian or more; then size and sign may be wrong.
//!
//! The adjoint covers time elements of every scheme and degree, dead loads, and supports at rest. It rejects driven or
//! released supports, follower pressures and other steppers ([`crate::Error::Adjoint`]).

mod goal;
mod gradient;
mod parameter;
mod segment;
mod step;
mod trajectory;

pub use goal::Goal;
pub use gradient::{GoalError, Gradient};
pub use parameter::Parameter;
pub use trajectory::Trajectory;
