//! The input: TOML, checked key by key; every fault knows its line.
//!
//! The text becomes a tree whose keys and values know their places (`tree`); `--set` changes the tree (`set`). Each
//! section has its own file with its description and its reader, which returns types of the library. One walk (`walk`)
//! checks a table against its description and reports every fault; readers see only tables that are right (`table`),
//! and check meaning. The descriptions (`description`, all in `catalogue`) also yield the defaults, the JSON schema
//! for editors (`schema`) and the key tables of `book/src/input.md` (`reference`).

mod adaptive;
mod canonical;
mod catalogue;
mod complete;
mod contact;
mod context;
mod coupling;
mod deck;
mod derived;
mod description;
mod energy;
mod equilibrium;
mod excerpt;
mod expect;
mod expression;
mod fault;
mod finite;
mod formulation;
mod groups;
mod history;
mod initial;
mod joint;
mod large_output;
mod load;
mod material;
mod measured;
mod mechanism;
mod memory;
mod names;
mod nodal;
mod parameters;
mod placed;
mod plane_strain;
mod plausible;
mod problem;
mod quantities;
mod reading;
mod record;
#[cfg(test)]
mod reference;
mod region;
mod rigid;
mod root;
mod schema;
mod sections;
mod set;
mod settings;
mod shape;
mod source;
mod start;
mod start_state;
pub(crate) mod suggest;
mod support;
mod synonyms;
mod syntax;
mod table;
mod tie;
mod time;
mod tree;
mod units;
mod walk;
mod write;

pub(crate) use complete::MESH_FILE;
pub use contact::PUSHES;
pub use derived::{END_OF_RUN, NOTHING_MOVES, UNLOADED};
pub use excerpt::Excerpt;
pub use fault::{Fault, InputError, MissingGroup, Place};
pub use formulation::{Formulations, elements};
pub use material::materials;
pub(crate) use memory::resolved;
pub use memory::{Tree, build, check, material_region};
pub use problem::{Overrides, Problem};
pub(crate) use quantities::relation;
pub use quantities::{GroupValue, Measure, Probe, ProbeQuantity, Quantities};
pub use reading::{read, read_mesh, read_on_team};
pub use schema::schema;
pub(crate) use set::alternatives;
pub use settings::{Limits, Output};
pub use shape::meshes;
pub use start::Start;
pub use start_state::StartError;
pub use tie::shift_of_followers;
pub use write::body_sections;
