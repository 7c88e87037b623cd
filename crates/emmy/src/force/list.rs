//! The list of the forces of a body.

use std::sync::{Arc, OnceLock};

use super::interface::Force;
use super::solid::SolidForce;

/// The forces of a body: those of its cells, which are made on first use, then the others.
#[derive(Debug, Clone)]
pub(crate) struct Forces {
    pub(crate) cells: Arc<OnceLock<Cells>>,
    pub(crate) others: Arc<Vec<Arc<dyn Force>>>,
}

/// Forces of the cells, one for each region and kind; those of cells that count on another rank are last.
#[derive(Debug)]
pub(crate) struct Cells {
    pub all: Vec<SolidForce>,
    /// Number of forces whose cells count here.
    pub n_counted: usize,
}

impl Forces {
    /// The forces under the loads of a time, all in proportion to a load fraction that takes the place of time.
    pub(crate) fn in_proportion(&self, time: f64, n_dofs: usize) -> Forces {
        let grown = |force: &Arc<dyn Force>| match force.over_time() {
            Some(load) => load.in_proportion(time, n_dofs),
            None => force.clone(),
        };
        Forces { others: Arc::new(self.others.iter().map(grown).collect()), ..self.clone() }
    }
}
