//! The stage equations at any rates, for schemes and analyses from outside.

use super::StageSystem;
use crate::error::Result;
use crate::sparse::BlockRow;

impl StageSystem<'_> {
    /// Residual at rates, with the local unknowns that belong to them, on all degrees of freedom.
    ///
    /// # Errors
    /// The reason of a force that refuses the step.
    pub(in crate::time) fn residual_at(&mut self, rates: &[f64]) -> Result<Vec<f64>> {
        let unknowns = self.unknowns_at(rates)?;
        let mut residual = vec![0.0; unknowns.len()];
        self.equations.full_residual(&unknowns, &mut residual)?;
        residual.truncate(rates.len());
        Ok(residual)
    }

    /// Derivative of this residual, without the projection of a dissipative scheme.
    ///
    /// # Errors
    /// As [`StageSystem::residual_at`].
    pub(in crate::time) fn tangent_at(&mut self, rates: &[f64]) -> Result<Vec<BlockRow>> {
        let unknowns = self.unknowns_at(rates)?;
        self.equations.assemble_tangent(&unknowns)?;
        Ok(self.equations.assembly.matrix.block_rows(self.equations.body.pattern()))
    }

    /// The unknowns that belong to rates; multipliers are zero.
    fn unknowns_at(&mut self, rates: &[f64]) -> Result<Vec<f64>> {
        let mut unknowns = rates.to_vec();
        unknowns.resize(self.equations.blocks.len(), 0.0);
        if self.equations.blocks.local > 0 {
            // Their residual at zero is the negative of what belongs to the rates.
            let mut residual = vec![0.0; unknowns.len()];
            self.equations.full_residual(&unknowns, &mut residual)?;
            let first = unknowns.len() - self.equations.blocks.local;
            unknowns[first..].iter_mut().zip(&residual[first..]).for_each(|(own, r)| *own = -r);
        }
        Ok(unknowns)
    }
}
