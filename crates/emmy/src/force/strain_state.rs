//! Stored energy and smallest det F.

use crate::error::{Error, Result};

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
