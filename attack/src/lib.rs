//! Attacks on the command from outside, and random motions that are stopped and resumed.
//!
//! Each attack is a file in `attacks`. One of its trials is a function of a seed or of the number of a case.
//! CONTRIBUTING.md describes faults and how to repeat them.
#![cfg(unix)]

pub mod agreement;
pub mod attack;
pub mod attacks;
pub mod base;
pub mod case;
pub mod comparison;
pub mod draw;
pub mod emmy;
pub mod faults;
pub mod features;
pub mod motions;
pub mod mutation;
pub mod place;
pub mod reference;
pub mod table;
