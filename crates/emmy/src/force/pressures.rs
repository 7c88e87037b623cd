//! Pressures of cells with a projected volume: their numbers, and their results in an assembly.

use std::ops::Range;

/// Numbers of the pressures of a force.
#[derive(Debug, Clone, Default)]
pub struct PressureNumbers {
    /// Number of functions of the pressure in a cell.
    pub n_functions: usize,
    /// Position of the force among those with pressures.
    pub term: usize,
    /// Number of the first function of the first cell.
    pub first: usize,
    /// Cells whose results each part saves.
    pub saved: Vec<Range<usize>>,
}

/// Nodes and pressures of the cells of a force.
#[derive(Debug, Clone, Copy)]
pub struct PressureCells<'a> {
    /// Indices of the cells in the mesh.
    pub cells: &'a [u32],
    /// Nodes, `[cell][n_nodes]`.
    pub nodes: &'a [u32],
    /// Number of nodes of a cell.
    pub n_nodes: usize,
    /// Numbers of the pressures.
    pub numbers: &'a PressureNumbers,
    /// Time of the viscosity of the volume \[time\].
    pub viscous_time: f64,
}

/// Results of the cells of a force that a part keeps.
#[derive(Debug, Clone, Default)]
pub struct PressureResults {
    /// Pressures of the deformation, `[cell][function][l]`.
    pub pressures: Vec<f64>,
    /// Forces g of unit pressures, `[cell][function][l][n_nodes][3]`.
    pub forces: Vec<f64>,
    /// Derivatives W of the pressures by the rates, `[cell][function][l][j][n_nodes][3]`.
    pub responses: Vec<f64>,
}

impl PressureCells<'_> {
    /// Number of functions of the pressure in all cells.
    pub(crate) fn n_pressures(&self) -> usize {
        self.nodes.len() / self.n_nodes * self.numbers.n_functions
    }
}
