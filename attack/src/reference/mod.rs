//! Motions computed a second time: a small and slow implementation from the formulas of the documentation, which shares
//! no code with the library.

pub mod body;
pub mod cells;
pub mod dual;
pub mod element;
pub mod energies;
pub mod history;
pub mod mesh;
pub mod motion;
pub mod numbers;
