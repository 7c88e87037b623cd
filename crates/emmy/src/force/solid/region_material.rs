//! The force of the cells of a region.

use super::SolidForce;
use crate::element::Formulation;
use crate::error::{Error, Result};
use crate::force::projection::Projection;
use crate::input::RegionMaterial;
use crate::mesh::{CellKind, Mesh};
use crate::space::CellTable;

impl RegionMaterial {
    /// The force of a table of cells of a kind.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Formulation`] if there is nothing to project.
    pub(crate) fn force(
        &self,
        formulation: Formulation,
        mesh: &Mesh,
        kind: CellKind,
        mut table: CellTable,
    ) -> Result<SolidForce> {
        let split = self.split(formulation, kind);
        let split = split.map_err(|reason| Error::Formulation { cell: table.cells[0] as usize, reason })?;
        match (self, split) {
            (RegionMaterial::Solid(material), None) => SolidForce::new(material.clone(), table),
            (RegionMaterial::Solid(_), Some((space, points, law))) => {
                let projection = Projection::new(mesh, kind, space, law, &table);
                Ok(SolidForce::new(points, table)?.with_projection(projection))
            }
            (RegionMaterial::Link(link), _) => {
                // The measure of a link is its length; its energy belongs to the whole link.
                let energies = table.weights.iter().map(|&length| link.with_length(length)).collect();
                table.weights.fill(1.0);
                SolidForce::links(energies, table)
            }
        }
    }
}
