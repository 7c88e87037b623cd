//! Terms of the body: what contributes internal forces.

use std::fmt;
use std::ops::Range;

use super::geometry::CellTable;
use super::integral::Scratch;
use super::solid::SolidTerm;
use super::viscosity::Viscosity;
use crate::average::{Rule, Want};
use crate::error::{Error, Result};
use crate::material::{
    ArrudaBoyce, CiarletGeymonat, Gent, Hencky, HolzapfelGasserOgden, Link, Material, MooneyRivlin, NeoHooke,
    Ogden, Orthotropic, SaintVenantKirchhoff, Yeoh,
};
use crate::sparse::{Pattern, RowPart};
use crate::tensor::Sym;

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
    /// What strain rates do.
    pub damping: StepDamping,
}

/// How the strain rates of a step count; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepDamping {
    /// Factor on viscosities: one over the step size \[1/time\].
    pub rate: f64,
    /// Factor beta on the elasticity at rest, for a scheme that dissipates.
    pub excess: f64,
}

/// What a displacement does to cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strained {
    /// Stored energy \[energy\].
    pub strain_energy: f64,
    /// Smallest det F at the quadrature points; infinite where there is no F that means something (links, springs).
    pub smallest_determinant: f64,
    /// The cell that it belongs to.
    pub smallest_cell: usize,
}

impl Strained {
    /// Nothing at all.
    pub const NONE: Strained =
        Strained { strain_energy: 0.0, smallest_determinant: f64::INFINITY, smallest_cell: 0 };

    /// Both together.
    pub fn with(self, other: Strained) -> Strained {
        let strain_energy = self.strain_energy + other.strain_energy;
        // One that is not a number counts as the smallest.
        let is_mine =
            self.smallest_determinant <= other.smallest_determinant || self.smallest_determinant.is_nan();
        Strained { strain_energy, ..if is_mine { self } else { other } }
    }

    /// The same, if no cell is turned inside out.
    ///
    /// # Errors
    /// [`Error::Inverted`].
    pub fn upright(self) -> Result<Self> {
        match self.smallest_determinant > 0.0 {
            true => Ok(self),
            false => Err(Error::Inverted { cell: self.smallest_cell, det: self.smallest_determinant }),
        }
    }
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

    /// Gives the term a viscosity.
    fn set_viscosity(&mut self, _: &Viscosity) {}

    /// What viscosity and dissipation take out of the term in a step \[energy\].
    fn dissipated(&self, _: &StepInput<'_>, _: &mut Scratch) -> f64 {
        0.0
    }

    /// What a displacement does to the term.
    fn strained(&self, displacement: &[f64]) -> Strained;
}

/// What a region can be made of: it makes the term of a table of cells.
///
/// Implemented for every material of this crate, whose kernels are compiled with it, once. [`Custom`] makes one of a material of
/// another crate, which is then compiled with that.
pub trait Solid: fmt::Debug + Send + Sync {
    /// The term.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn term(&self, table: CellTable) -> Result<Box<dyn Term>>;

    /// Stored energy per reference volume and second Piola-Kirchhoff stress at a Green-Lagrange strain; `None` of a link, which has
    /// no volume.
    fn response(&self, strain: &Sym<f64>) -> Option<(f64, Sym<f64>)>;

    /// The link, if it is one.
    fn link(&self) -> Option<Link> {
        None
    }
}

/// A material of another crate.
#[derive(Debug, Clone)]
pub struct Custom<M>(pub M);

impl<M: Material + fmt::Debug> Solid for Custom<M> {
    fn term(&self, table: CellTable) -> Result<Box<dyn Term>> {
        Ok(Box::new(SolidTerm::new(self.0.clone(), table)?))
    }

    fn response(&self, strain: &Sym<f64>) -> Option<(f64, Sym<f64>)> {
        Some((self.0.strain_energy(strain), self.0.stress(strain)))
    }
}

macro_rules! solids {
    ($($material:ty),+) => { $(
        impl Solid for $material {
            fn term(&self, table: CellTable) -> Result<Box<dyn Term>> {
                Ok(Box::new(SolidTerm::new(self.clone(), table)?))
            }

            fn response(&self, strain: &Sym<f64>) -> Option<(f64, Sym<f64>)> {
                Some((self.strain_energy(strain), self.stress(strain)))
            }
        }
    )+ };
}

solids!(
    ArrudaBoyce,
    CiarletGeymonat,
    Gent,
    Hencky,
    HolzapfelGasserOgden,
    MooneyRivlin,
    NeoHooke,
    Ogden,
    Orthotropic,
    SaintVenantKirchhoff,
    Yeoh
);

impl Solid for Link {
    fn term(&self, mut table: CellTable) -> Result<Box<dyn Term>> {
        // The measure of a link is its length; its energy is that of the whole link.
        let energies = table.weights.iter().map(|&length| self.with_length(length)).collect();
        table.weights.fill(1.0);
        Ok(Box::new(SolidTerm::with_materials(energies, table)?))
    }

    fn response(&self, _: &Sym<f64>) -> Option<(f64, Sym<f64>)> {
        None
    }

    fn link(&self) -> Option<Link> {
        Some(*self)
    }
}
