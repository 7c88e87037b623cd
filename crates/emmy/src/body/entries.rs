//! Numbers of nodes and pressures in the whole body, which do not depend on its division among ranks.

use serde::{Deserialize, Serialize};

use super::system::Body;

/// The entities that the numbers of a list belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Entries {
    /// Nodes, internal ones included: `[k][n_nodes][3]`.
    Nodes,
    /// Local unknowns, functions of the pressure in cells: `[function][n]`.
    #[serde(rename = "Pressures")]
    Local,
}

/// Largest number of internal nodes of a cell.
const MAX_MODES: u64 = 3;

/// Largest number of functions of the pressure in a cell.
const MAX_FUNCTIONS: u64 = 4;

impl Body {
    /// The entries of lists of this rank, in their order: the number of each in the whole body, and whether it counts
    /// here. Nodes of the mesh have their number in the whole mesh; an internal node and a function of the pressure
    /// have one by their cell. Guests and entries of cells that count elsewhere do not count.
    #[doc(hidden)]
    pub fn entries(&self, entries: Entries) -> Box<dyn Iterator<Item = (u64, bool)> + '_> {
        match entries {
            Entries::Nodes => Box::new(self.nodes_of_mesh().chain(self.internal_numbers())),
            Entries::Local => Box::new(self.pressure_numbers()),
        }
    }

    fn nodes_of_mesh(&self) -> impl Iterator<Item = (u64, bool)> {
        let n_own = self.ranks().n_own();
        let numbers = self.ranks().nodes().iter().enumerate();
        numbers.map(move |(node, &number)| (u64::from(number), node < n_own))
    }

    fn internal_numbers(&self) -> impl Iterator<Item = (u64, bool)> {
        let first = self.ranks().n_nodes_of_ranks() as u64;
        let of_one_cell = |a: &u32, b: &u32| a == b;
        self.space.internal().cells().chunk_by(of_one_cell).flat_map(move |nodes| {
            let (cell, counts) = self.cell_of_ranks(nodes[0]);
            (0..nodes.len() as u64).map(move |mode| (first + MAX_MODES * cell + mode, counts))
        })
    }

    fn pressure_numbers(&self) -> impl Iterator<Item = (u64, bool)> {
        self.pressure_cells().flat_map(move |of_term| {
            of_term.cells.iter().flat_map(move |&cell| {
                let (cell, counts) = self.cell_of_ranks(cell);
                let functions = 0..of_term.numbers.n_functions as u64;
                functions.map(move |function| (MAX_FUNCTIONS * cell + function, counts))
            })
        })
    }

    /// Number of a cell in the whole mesh, and whether it counts here.
    fn cell_of_ranks(&self, cell: u32) -> (u64, bool) {
        let cell = cell as usize;
        (u64::from(self.ranks().cells()[cell]), self.ranks().counts()[cell])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::PressureSpace;
    use crate::prelude::*;

    #[test]
    fn entries_of_cells_are_numbered_by_their_cells() {
        let rubber = || Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
        let mesh = || mesh::block([1.0; 3], [2, 1, 1]).unwrap();
        let formulated = |formulation| {
            Body::builder(mesh()).region(rubber().with_formulation(formulation)).build().unwrap()
        };
        let body = formulated(crate::body::Formulation::IncompatibleModes);
        let numbers: Vec<u64> = body.entries(Entries::Nodes).map(|(number, _)| number).collect();
        // Two cells with three modes each.
        assert!(numbers.iter().copied().eq(0..12 + 6));
        assert_eq!(body.entries(Entries::Local).count(), 0);
        let body = formulated(crate::body::Formulation::ProjectedVolume(Some(PressureSpace::Constant)));
        let mut numbers: Vec<(u64, bool)> = body.entries(Entries::Local).collect();
        numbers.sort_unstable();
        assert_eq!(numbers, [(0, true), (4, true)]);
    }
}
