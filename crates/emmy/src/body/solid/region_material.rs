//! Material of a region: of solid cells, or of links.

use super::SolidTerm;
use crate::body::projection::Projection;
use crate::body::{CellTable, Region};
use crate::error::{Error, Result};
use crate::material::{CompiledMaterial, Link};
use crate::mesh::{CellKind, Mesh};
use crate::tensor::Sym;

/// Material of a region.
#[derive(Debug)]
pub(crate) enum RegionMaterial {
    /// A material of solid cells.
    Solid(CompiledMaterial),
    /// A law of links.
    Link(Link),
}

impl Region {
    /// The term of a table of its cells of a kind.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Formulation`] if there is nothing to project.
    pub(in crate::body) fn term(
        &self,
        mesh: &Mesh,
        kind: CellKind,
        mut table: CellTable,
    ) -> Result<SolidTerm> {
        let no_formulation = |reason| Error::Formulation { cell: table.cells[0] as usize, reason };
        let space = self.formulation.pressure_space(kind).map_err(no_formulation)?;
        match (&self.material, space) {
            (RegionMaterial::Solid(material), None) => SolidTerm::new(material.clone(), table),
            (RegionMaterial::Solid(material), Some(space)) => {
                let split = material.split(kind.info().point_share);
                let (points, law) = split.ok_or_else(|| no_formulation(NO_VOLUMETRIC_PART.to_string()))?;
                let projection = Projection::new(mesh, kind, space, law, &table);
                Ok(SolidTerm::new(points, table)?.with_projection(projection))
            }
            (RegionMaterial::Link(link), _) => {
                // The measure of a link is its length; its energy belongs to the whole link.
                let energies = table.weights.iter().map(|&length| link.with_length(length)).collect();
                table.weights.fill(1.0);
                SolidTerm::links(energies, table)
            }
        }
    }
}

/// Reason why a material has no projected volume.
pub(crate) const NO_VOLUMETRIC_PART: &str =
    "the energy of its material has no volumetric part to project; use formulation = \"standard\"";

impl RegionMaterial {
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
