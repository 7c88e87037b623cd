//! Terms of the body: contributions to the internal force.

use std::fmt;
use std::ops::Range;

use super::integral::Scratch;
use super::pressures::PressureCells;
use super::step::StepInput;
use crate::average::Request;
use crate::error::{Error, Result};
use crate::input::Viscosity;
use crate::sparse::{Pattern, RowPart};

/// Strain energy and smallest det F of a set of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainState {
    /// Stored energy \[energy\].
    pub strain_energy: f64,
    /// Smallest det F at the quadrature points; infinite for links and springs.
    pub smallest_determinant: f64,
    /// Cell with the smallest det F.
    pub smallest_cell: usize,
}

impl StrainState {
    /// The state of an empty set of cells.
    pub const NONE: StrainState =
        StrainState { strain_energy: 0.0, smallest_determinant: f64::INFINITY, smallest_cell: 0 };

    /// The union of both sets.
    pub fn with(self, other: StrainState) -> StrainState {
        let strain_energy = self.strain_energy + other.strain_energy;
        // NaN counts as the smallest.
        let is_mine =
            self.smallest_determinant <= other.smallest_determinant || self.smallest_determinant.is_nan();
        StrainState { strain_energy, ..if is_mine { self } else { other } }
    }

    /// Returns `self`, or an error if a cell is inverted.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn check_not_inverted(self) -> Result<Self> {
        match self.smallest_determinant > 0.0 {
            true => Ok(self),
            false => Err(Error::Inverted { cell: self.smallest_cell, det: self.smallest_determinant }),
        }
    }
}

/// Terms of the cells, attached to the pattern.
#[derive(Debug)]
pub(crate) struct Terms {
    /// One for each region and kind; those of cells that count on another rank are last.
    pub(crate) all: Vec<Box<dyn Term>>,
    /// Number of terms whose cells count here.
    pub(crate) n_counted: usize,
}

/// Part of the internal force: stage averages f_i, their derivatives, and the stored energy.
pub(crate) trait Term: fmt::Debug + Send + Sync {
    /// Nodes that the term couples, one list for each coupling (such as a cell), all of the same length: `(nodes,
    /// length)`.
    fn couplings(&self) -> (&[u32], usize);

    /// Nodes and pressures of cells with a projected volume; `None` for other terms.
    fn pressure_cells(&self) -> Option<PressureCells<'_>> {
        None
    }

    /// Number of quadrature points of a coupling.
    fn n_points(&self) -> usize;

    /// Looks up the positions of the couplings in the pattern, and the couplings that touch the rows of each part.
    fn attach(&mut self, pattern: &Pattern, parts: &[Range<usize>]);

    /// Numbers the pressures of the term: `term` among those with pressures, from the function `first` on.
    fn number_pressures(&mut self, _term: usize, _first: usize, _parts: &[Range<usize>]) {}

    /// Adds stage forces (and derivatives) to the rows of a part.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`] if the determinant of a deformation gradient is not positive.
    fn assemble(
        &self,
        step: &StepInput<'_>,
        request: Request,
        part: usize,
        scratch: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()>;

    /// Gives the term a viscosity.
    fn set_viscosity(&mut self, _: &Viscosity) {}

    /// Traces of viscosity and elasticity at rest, times the number of cells.
    fn viscosity_and_stiffness(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Calls a function with the stage average of the force on the ground at each node of springs; other terms have
    /// none.
    fn for_each_spring_force(&self, _: &StepInput<'_>, _: usize, _: &mut dyn FnMut(usize, [f64; 3])) {}

    /// Energy that viscosity and the scheme dissipate in a step \[energy\].
    fn dissipated(&self, _: &StepInput<'_>, _: &mut Scratch) -> f64 {
        0.0
    }

    /// Adds the product of adjoint vectors with the derivatives of the stage forces by the displacement at the start of
    /// the step, at fixed rates; `adjoint: [k][n_nodes][3]`, `gradient: [n_nodes][3]`.
    ///
    /// ```math
    /// sum_i (df_i/du_1)^T mu_i
    /// ```
    fn add_start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]);

    /// Strain energy and smallest det F at a displacement.
    fn strain_state(&self, displacement: &[f64]) -> StrainState;
}

/// Traces of viscosity and elasticity at rest, summed over all cells.
pub(crate) fn traces<'a>(terms: impl Iterator<Item = &'a Box<dyn Term>>) -> [f64; 2] {
    let traces = terms.map(|term| term.viscosity_and_stiffness());
    traces.fold([0.0; 2], |sum, traces| [sum[0] + traces[0], sum[1] + traces[1]])
}

/// Mean viscosity of all cells over their mean stiffness at rest \[time\], from [`traces`].
pub(crate) fn time_of([viscosity, stiffness]: [f64; 2]) -> f64 {
    if viscosity > 0.0 && stiffness > 0.0 { viscosity / stiffness } else { 0.0 }
}
