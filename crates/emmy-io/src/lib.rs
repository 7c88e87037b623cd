//! Files of Emmy: the input, meshes of other programs, and results.
//!
//! | module | file |
//! |---|---|
//! | [`input`] | the input (TOML); every error names its line |
//! | [`mesh`] | meshes of Gmsh, Abaqus and VTK |
//! | [`results`] | all files of a run, written by one observer of the motion |
//! | [`directory`] | the output directory, its lock, and which files in it are Emmy's |
//! | [`history`] | `history.csv` |
//! | [`newton`] | `newton.csv` |
//! | [`report`] | `report.html`, `pictures/` |
//! | [`vtk`] | frames (`.vtu`) and their collection (`.pvd`), or all frames in one file (`.vtkhdf`) |
//! | [`checkpoint`] | `checkpoint/`: everything that a run needs to resume |
//! | [`mod@shares`] | shares of a mesh for the ranks of a team |
//! | [`events`] | `events.csv` |
//! | [`log`] | `run.log` |
//! | [`summary`] | `summary.json` |
//! | [`accuracy`] | how well the steps of a run resolve its motion |
//! | [`chart`] | charts as `.svg` and `.png` |
//! | [`drawing`] | deformed configurations of a mesh as `.svg` and `.png` |
//! | [`comparison`] | charts of several runs side by side |
//! | [`convergence`] | convergence studies: `convergence.csv`, kept references |
//! | [`sweep`](mod@sweep) | sweeps over the values of keys: `sweep.csv` |
//! | [`modes`] | natural modes: `modes.csv`, a frame for each mode |
//! | [`response`] | harmonic responses: `response.csv` and its plot |
//! | [`spectra`] | spectra of columns of a run: `spectrum.csv` and its plot |
//! | [`limits`] | `[limits]` |
//! | [`sizes`] | estimated sizes of the files of a run |
//! | [`properties`] | measured materials with their sources |
//! | [`units`] | systems of units, and the unit of every quantity in them |
//! | [`message`] | text prepared for a terminal |

#![deny(clippy::print_stderr, clippy::print_stdout)]

pub mod accuracy;
pub mod chart;
pub mod checkpoint;
pub mod comparison;
pub mod convergence;
pub mod differences;
pub mod directory;
pub mod drawing;
pub mod events;
pub mod history;
pub mod input;
pub mod limits;
mod link;
pub mod log;
pub mod mesh;
pub mod message;
pub mod modes;
pub mod newton;
mod picture;
pub mod properties;
mod recording;
pub mod report;
pub mod response;
pub mod results;
mod rows;
pub mod shares;
mod side_by_side;
pub mod sizes;
pub mod spectra;
mod stored;
pub mod summary;
pub mod sweep;
pub mod team;
pub mod units;
mod vector;
pub mod vtk;
mod whole_file;

pub use sweep::sweep;
