//! Files of Emmy: the input, meshes of other programs, and results.
//!
//! | module | file |
//! |---|---|
//! | [`input`] | the input (TOML), checked key by key; every fault knows its line |
//! | [`mesh`] | meshes of Gmsh and Abaqus |
//! | [`results`] | everything that a run writes, as one observer of a motion |
//! | [`directory`] | the output directory, and what in it is Emmy's |
//! | [`history`] | `history.csv` |
//! | [`newton`] | `newton.csv` |
//! | [`report`] | `report.html` |
//! | [`vtk`] | frames (`.vtu`) and their collection (`.pvd`), or one file of them all (`.vtkhdf`) |
//! | [`checkpoint`] | `checkpoint/`: what a run needs to go on |
//! | [`events`] | `events.csv` |
//! | [`log`] | `run.log` |
//! | [`lock`] | one run at a time in a directory |
//! | [`summary`] | `summary.json` |
//! | [`chart`] | charts as `.svg` and `.png` |
//! | [`drawing`] | deformed configurations of a mesh as `.svg` and `.png` |
//! | [`comparison`] | runs read back and drawn side by side |
//! | [`convergence`] | convergence studies: `convergence.csv`, kept references |
//! | [`tally`] | balances over a whole run |
//! | [`limits`] | `[limits]` |
//! | [`sizes`] | how large the files of a run become |
//! | [`message`] | texts as a terminal may have them |

#![deny(clippy::print_stderr, clippy::print_stdout)]

pub mod chart;
pub mod checkpoint;
pub mod comparison;
pub mod convergence;
pub mod directory;
pub mod drawing;
pub mod events;
mod file;
pub mod history;
pub mod input;
pub mod limits;
pub mod lock;
pub mod log;
pub mod mesh;
pub mod message;
pub mod newton;
mod picture;
pub mod report;
pub mod results;
mod rows;
pub mod sizes;
mod sources;
pub mod summary;
pub mod tally;
pub mod vtk;
