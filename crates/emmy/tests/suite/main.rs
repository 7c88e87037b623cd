//! The tests of the library from outside, in one binary, because linking the library takes longer than most of them.

mod adaptive_steps;
mod adjoint;
mod allocations;
mod architecture;
mod balances;
mod classic_steppers;
mod damping;
mod driven_supports;
mod fields;
mod linear_oscillator;
mod links;
mod long_flight;
mod manufactured;
mod materials;
mod order_of_accuracy;
mod plane_elements;
mod pressure;
mod reactions;
mod reference_cases;
mod resumed_motions;
mod shared;
mod solid_elements;
mod solvers;
mod stiff_bodies;
mod tuning_fork;
