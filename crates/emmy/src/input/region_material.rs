//! Material of a region: of solid cells, or of links.

use crate::element::{Formulation, PressureSpace};
use crate::material::{CompiledMaterial, Link, VolumeLaw};
use crate::mesh::CellKind;
use crate::tensor::Sym;

const NO_VOLUMETRIC_PART: &str =
    "the energy of its material has no volumetric part to project; use formulation = \"standard\"";

/// Material of a region.
#[derive(Debug)]
pub(crate) enum RegionMaterial {
    /// A material of solid cells.
    Solid(CompiledMaterial),
    /// A law of links.
    Link(Link),
}

/// A projected volume: the functions of its pressure, the material at the points and the law of the volume.
pub(crate) type SplitMaterial = (PressureSpace, CompiledMaterial, VolumeLaw);

impl RegionMaterial {
    /// The material in cells of a kind that project their volume; `None` for a formulation without a projection.
    ///
    /// # Errors
    /// The reason why the kind or the material does not have the formulation, with the remedy.
    pub(crate) fn split(
        &self,
        formulation: Formulation,
        kind: CellKind,
    ) -> Result<Option<SplitMaterial>, String> {
        match (self, formulation.pressure_space(kind)?) {
            (RegionMaterial::Solid(material), Some(space)) => {
                let (points, law) = material.split(kind.info().point_share).ok_or(NO_VOLUMETRIC_PART)?;
                Ok(Some((space, points, law)))
            }
            (RegionMaterial::Solid(_) | RegionMaterial::Link(_), _) => Ok(None),
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
