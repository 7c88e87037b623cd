//! Stored energy and smallest det F.

use crate::error::{Error, Result};

/// Layers of contact at one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Stored energy \[energy\].
    pub energy: f64,
    /// Smallest gap over the thickness of its layer; infinite where nothing is near.
    pub smallest_gap: f64,
    /// Number of points whose layer stores energy.
    pub n_points: usize,
}

impl ContactState {
    /// The state without contact.
    pub const NONE: ContactState = ContactState { energy: 0.0, smallest_gap: f64::INFINITY, n_points: 0 };

    /// The union of both states.
    pub fn with(self, other: ContactState) -> ContactState {
        ContactState {
            energy: self.energy + other.energy,
            smallest_gap: self.smallest_gap.min(other.smallest_gap),
            n_points: self.n_points + other.n_points,
        }
    }
}

/// Layers of contact at a node at one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactAtNode {
    /// Normal force on the node, positive towards the body, over the reference area around it on facets that are
    /// pressed \[force/length^2\].
    pub pressure: f64,
    /// Reference area around the node on all facets of the surface \[length^2\].
    pub area: f64,
    /// Distance to the nearest opponent \[length\]; NaN where none is near.
    pub gap: f64,
}

impl ContactAtNode {
    /// The state without contact.
    pub const NONE: ContactAtNode = ContactAtNode { pressure: 0.0, area: 0.0, gap: f64::NAN };

    /// The union of both states.
    pub fn with(self, other: ContactAtNode) -> ContactAtNode {
        ContactAtNode {
            pressure: self.pressure + other.pressure,
            area: self.area + other.area,
            // NaN is none.
            gap: self.gap.min(other.gap),
        }
    }
}

/// Strain energy and smallest det F of a set of cells, and the layers of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainState {
    /// Stored energy \[energy\].
    pub strain_energy: f64,
    /// Smallest det F at the quadrature points; infinite for links and springs.
    pub smallest_determinant: f64,
    /// Cell with the smallest det F.
    pub smallest_cell: usize,
    /// Layers of contact.
    pub contact: ContactState,
}

impl StrainState {
    /// The state of an empty set of cells.
    pub const NONE: StrainState = StrainState {
        strain_energy: 0.0,
        smallest_determinant: f64::INFINITY,
        smallest_cell: 0,
        contact: ContactState::NONE,
    };

    /// Stored energy with that of layers in contact \[energy\].
    pub(crate) fn stored(&self) -> f64 {
        self.strain_energy + self.contact.energy
    }

    /// The union of both sets.
    pub fn with(self, other: StrainState) -> StrainState {
        let strain_energy = self.strain_energy + other.strain_energy;
        // NaN counts as the smallest.
        let is_mine =
            self.smallest_determinant <= other.smallest_determinant || self.smallest_determinant.is_nan();
        let contact = self.contact.with(other.contact);
        StrainState { strain_energy, contact, ..if is_mine { self } else { other } }
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
