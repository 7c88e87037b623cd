//! Material of a region: of solid cells, or of links.

use super::SolidTerm;
use crate::body::CellTable;
use crate::error::Result;
use crate::material::{CompiledMaterial, Link};
use crate::tensor::Sym;

/// Material of a region.
#[derive(Debug)]
pub(crate) enum RegionMaterial {
    /// A material of solid cells.
    Solid(CompiledMaterial),
    /// A law of links.
    Link(Link),
}

impl RegionMaterial {
    /// The term of a table of cells.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    pub(crate) fn term(&self, mut table: CellTable) -> Result<SolidTerm> {
        match self {
            RegionMaterial::Solid(material) => SolidTerm::new(material.clone(), table),
            RegionMaterial::Link(link) => {
                // The measure of a link is its length; its energy belongs to the whole link.
                let energies = table.weights.iter().map(|&length| link.with_length(length)).collect();
                table.weights.fill(1.0);
                SolidTerm::links(energies, table)
            }
        }
    }

    /// Stored energy per reference volume and second Piola-Kirchhoff stress at a Green-Lagrange strain; `None` for a
    /// link, which has no volume.
    pub(crate) fn response(&self, strain: &Sym<f64>) -> Option<(f64, Sym<f64>)> {
        let RegionMaterial::Solid(material) = self else { return None };
        let material = material.response::<f64>();
        let mut stress = [0.0; 6];
        material.stress(strain, &mut stress);
        Some((material.strain_energy(strain), stress))
    }
}
