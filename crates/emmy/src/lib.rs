//! Non-linear elastodynamics by time finite elements that conserve energy and angular momentum.
//!
//! The method is described in P. Betsch and P. Steinmann, *Conservation properties of a time FE method. Part II:
//! Time-stepping schemes for non-linear elastodynamics*, Int. J. Numer. Meth. Engng 50, 1931-1955 (2001). Emmy
//! implements it for any degree in time.
//!
//! Two cells of rubber, held on the left, are pulled and released:
//!
//! ```
//! use emmy::prelude::*;
//!
//! fn main() -> emmy::Result<()> {
//!     let layer = |x| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]];
//!     let points = [layer(0.0), layer(1.0), layer(2.0)].concat();
//!     let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]];
//!     let mesh = Mesh::from_cells(CellKind::Hex8, &points, &cells)?
//!         .with_node_group("left", [0, 1, 2, 3])?
//!         .with_node_group("right", [8, 9, 10, 11])?;
//!
//!     let body = Body::builder(mesh)
//!         .region(Region::new(NeoHooke::from_engineering(1000.0, 0.3)?, 1.0))
//!         .support(Support::fixed("left"))
//!         .load(Load::nodal_force("right", [0.0, 0.0, -2.0]).over([(0.0, 0.0), (0.1, 1.0), (0.2, 0.0)])?)
//!         .build()?;
//!
//!     let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?;
//!     while motion.time() < 1.0 {
//!         let record = motion.step(0.01)?;
//!         println!("{:5.2} {:.15e} {:9.2e}", record.time, record.total_energy, record.energy_residual);
//!     }
//!     Ok(())
//! }
//! ```
//!
//! A [`body::Body`] has a [`mesh::Mesh`], regions of [`material`]s, supports and loads. A [`motion::Motion`] advances
//! its [`motion::State`] by a [`time::Scheme`] and returns a [`motion::Record`] of each step: energies, momenta and the
//! residuals of their balances. [`prelude`] has the names of most programs. [`internals`] has the parts that may change
//! in any release.

pub mod adjoint;
mod average;
pub mod body;
mod contact;
mod element;
pub mod equilibrium;
mod error;
mod force;
mod input;
pub mod internals;
mod mass;
pub mod material;
pub mod mesh;
pub mod modes;
pub mod motion;
mod newton;
mod nodal;
mod number;
mod polynomial;
pub mod prelude;
mod quadrature;
mod space;
mod sparse;
pub mod team;
mod tensor;
pub mod time;
mod unknowns;

pub use error::{Error, Result};
