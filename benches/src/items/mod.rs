//! The items: measurements with their goals.

mod assembly;
mod check;
mod comparison;
mod contact;
mod degrees;
mod ensembles;
mod large;
mod locking;
mod real;
mod schemes;
mod shake;
mod side_by_side;
mod solvers;
mod step;
mod stiff;
mod threads;

use crate::peers::Interpreters;
use crate::report::Report;
use crate::session::Session;

/// Options of the command line for the items.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    /// Options of the runs.
    pub session: Session,
    /// Interpreters of the other programs, if they should run.
    pub peers: Option<Interpreters>,
    /// Cells per unit length for `step`, `stiff` and `large`, ascending, instead of the defaults.
    pub cells: Option<Vec<u32>>,
    /// Whether `large` uses the mesh of 1.5 million degrees of freedom.
    pub million: bool,
}

/// One item.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Item {
    /// Key word.
    pub name: &'static str,
    /// Measures it.
    pub measure: fn(&Settings) -> Result<Vec<Report>, String>,
}

/// All items; the first is the default.
pub(crate) const ALL: [Item; 14] = [
    Item { name: "step", measure: step::measure },
    Item { name: "schemes", measure: schemes::measure },
    Item { name: "degrees", measure: degrees::measure },
    Item { name: "stiff", measure: stiff::measure },
    Item { name: "real", measure: real::measure },
    Item { name: "solvers", measure: solvers::measure },
    Item { name: "locking", measure: locking::measure },
    Item { name: "large", measure: large::measure },
    Item { name: "assembly", measure: assembly::measure },
    Item { name: "ensembles", measure: ensembles::measure },
    Item { name: "threads", measure: threads::measure },
    Item { name: "shake", measure: shake::measure },
    Item { name: "check", measure: check::measure },
    Item { name: "contact", measure: contact::measure },
];
