//! Attacks on the command from outside, and motions drawn at random that are stopped and resumed.
//!
//! An attack is a file in `attacks`: one trial of it is a function of a seed or of the number of a case. CONTRIBUTING.md says what
//! counts as a fault and how to repeat one.
#![cfg(unix)]

pub mod attack;
pub mod attacks;
pub mod base;
pub mod comparison;
pub mod draw;
pub mod emmy;
pub mod faults;
pub mod motions;
pub mod mutation;
pub mod place;
pub mod table;
