//! Terms of the body: what contributes internal forces.

use std::fmt;
use std::ops::Range;

use super::geometry::CellTable;
use super::integral::Scratch;
use super::solid::SolidTerm;
use crate::average::{Rule, Want};
use crate::error::Result;
use crate::material::{Link, Material};
use crate::sparse::{Pattern, RowPart};

/// A step as the terms see it.
#[derive(Debug, Clone, Copy)]
pub struct StepInput<'a> {
    /// Averaging rule.
    pub rule: &'a Rule,
    /// Factor on the derivatives df_i/dx_j (h^2 in the stage equations).
    pub tangent_factor: f64,
    /// Displacement at the start, `[n_nodes][3]`.
    pub displacement: &'a [f64],
    /// Rates x_j of the displacement, `[k][n_nodes][3]`.
    pub rates: &'a [f64],
}

/// Part of the internal force: stage averages f_i, their derivatives, and the stored energy.
pub trait Term: fmt::Debug + Send + Sync {
    /// Nodes that the term couples, one list for each coupling (a cell, say), all of one length: `(nodes, length)`.
    fn couplings(&self) -> (&[u32], usize);

    /// Number of quadrature points of a coupling.
    fn n_points(&self) -> usize;

    /// Looks up where the couplings stand in the pattern, and which of them touch the rows of each part.
    fn attach(&mut self, pattern: &Pattern, parts: &[Range<usize>]);

    /// Adds stage forces (and derivatives) to the rows of a part.
    ///
    /// # Errors
    /// [`crate::Error::Inverted`] if a deformation gradient has a determinant that is not positive.
    fn assemble(
        &self,
        step: &StepInput<'_>,
        want: Want,
        part: usize,
        scratch: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()>;

    /// Stored energy at a displacement \[energy\].
    fn strain_energy(&self, displacement: &[f64]) -> f64;
}

/// A material before its cells are known: makes the term of a table of cells.
pub trait Solid: fmt::Debug + Send + Sync {
    /// The term.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn term(&self, table: CellTable) -> Result<Box<dyn Term>>;

    /// The link, if it is one.
    fn link(&self) -> Option<Link> {
        None
    }
}

/// Wraps a material.
pub fn solid<M: Material>(material: M) -> Box<dyn Solid> {
    Box::new(Model(material))
}

struct Model<M>(M);

impl<M> fmt::Debug for Model<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(std::any::type_name::<M>())
    }
}

impl Solid for Link {
    fn term(&self, mut table: CellTable) -> Result<Box<dyn Term>> {
        // The measure of a link is its length; its energy is that of the whole link.
        let energies = table.weights.iter().map(|&length| self.with_length(length)).collect();
        table.weights.fill(1.0);
        Ok(Box::new(SolidTerm::with_materials(energies, table)?))
    }

    fn link(&self) -> Option<Link> {
        Some(*self)
    }
}

impl<M: Material> Solid for Model<M> {
    fn term(&self, table: CellTable) -> Result<Box<dyn Term>> {
        Ok(Box::new(SolidTerm::new(self.0.clone(), table)?))
    }
}
