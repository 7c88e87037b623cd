//! Strain energies W of hyperelastic materials, one model per file.
//!
//! A material sees the deformation only through `C = F^T F`, given as the Green-Lagrange strain
//! `E = (C - I) / 2`, which keeps its digits at small strain.

#![allow(non_snake_case)]

mod arruda_boyce;
mod axes;
mod ciarlet_geymonat;
#[cfg(test)]
mod conformance;
mod distortion;
pub(crate) mod elastic;
mod formula;
mod gent;
mod hencky;
mod holzapfel_gasser_ogden;
mod invariants;
mod isochoric;
mod link;
pub(crate) mod model;
mod mooney_rivlin;
mod neo_hooke;
mod neo_hooke_isochoric;
mod ogden;
mod orthotropic;
mod polynomial;
mod principal;
pub(crate) mod response;
mod saint_venant_kirchhoff;
mod spectral;
mod volume_law;
mod volumetric;
mod yeoh;

pub use arruda_boyce::ArrudaBoyce;
pub use ciarlet_geymonat::CiarletGeymonat;
pub use formula::{EnergyFormula, Expression, Invariant};
pub use gent::Gent;
pub use hencky::Hencky;
pub use holzapfel_gasser_ogden::HolzapfelGasserOgden;
pub use link::{Link, LinkEnergy};
pub(crate) use model::{Model, Modelled, Values};
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hooke::NeoHooke;
pub use neo_hooke_isochoric::NeoHookeIsochoric;
pub use ogden::Ogden;
pub use orthotropic::{EngineeringConstants, Orthotropic};
pub use response::CompiledMaterial;
pub(crate) use response::Response;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use volume_law::{VolumeLaw, VolumeMeasure};
pub use volumetric::Volumetric;
pub use yeoh::Yeoh;

// Tensors for materials of your own.
pub use crate::tensor::{
    Elasticity, Lane, Mat3, Sym, double_dot, sym_add_scaled, sym_cofactor, sym_det, sym_scaled, trace,
};

use response::compiled_with_this_crate;

use crate::error::{Error, Result};

/// Passes the names of all materials for solid and plane cells to a macro. A new material has its line here.
macro_rules! each_material {
    ($apply:ident) => {
        $apply! {
            SaintVenantKirchhoff,
            NeoHooke,
            NeoHookeIsochoric,
            CiarletGeymonat,
            Hencky,
            MooneyRivlin,
            Yeoh,
            Gent,
            ArrudaBoyce,
            Ogden,
            Orthotropic,
            HolzapfelGasserOgden
        }
    };
}
pub(crate) use each_material;

/// A hyperelastic material: stored energy, stress and elasticity as functions of the Green-Lagrange strain.
///
/// ```math
/// S = dW/dE = 2 dW/dC,      D = dS/dE = 4 d^2W/dC^2
/// ```
///
/// `W` and `S` must be evaluated without cancellation: their relative error stays at round-off for strains from 1e-8
/// to 1. Textbook forms such as `mu/2 (tr C - 3)` cancel; write them in `C - I = 2E`. Components are ordered as in
/// [`Sym`]; see [`Elasticity`] for the shears of `D`.
///
/// ```
/// use emmy::prelude::*;
/// let steel = SaintVenantKirchhoff::from_engineering(2.1e5, 0.3)?;
/// let stress = steel.stress(&[1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// assert!((stress[0] - 282.6923076923077).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
pub trait Material: Clone + Send + Sync + 'static {
    /// Whether this is a link: its energy depends on tr E alone, and det F has no meaning.
    const IS_LINK: bool = false;

    /// Stored energy W per reference volume \[energy/length^3\].
    fn strain_energy<L: Lane>(&self, strain: &Sym<L>) -> L;

    /// Second Piola-Kirchhoff stress S \[force/length^2\].
    fn stress<L: Lane>(&self, strain: &Sym<L>) -> Sym<L>;

    /// Energy change `W(E + dE) - W(E)` in closed form, free of cancellation; `None` if the material has none. Do not
    /// return a difference of two energies.
    #[inline(always)]
    fn energy_change<L: Lane>(&self, strain: &Sym<L>, change: &Sym<L>) -> Option<L> {
        let _ = (strain, change);
        None
    }

    /// Quadrature of the stress along a straight path of strains, over points `[alpha_m, w_m]`. Override it if the
    /// stresses along a path can share work.
    ///
    /// ```math
    /// sum_m w_m S(E + alpha_m dE)
    /// ```
    #[inline(always)]
    fn stress_along<L: Lane>(&self, strain: &Sym<L>, change: &Sym<L>, points: &[[f64; 2]]) -> Sym<L> {
        let zero = strain[0].splat(0.0);
        let mut sum = [zero; 6];
        for &[alpha, weight] in points {
            let stress = self.stress(&sym_add_scaled(strain, zero.splat(alpha), change));
            sum = sym_add_scaled(&sum, zero.splat(weight), &stress);
        }
        sum
    }

    /// Second Piola-Kirchhoff stress and elasticity D = dS/dE \[force/length^2\], which share most of their
    /// computation.
    fn stress_and_elasticity<L: Lane>(&self, strain: &Sym<L>) -> (Sym<L>, Elasticity<L>);

    /// Divides the energy into `W_p(C)`, as a material, and the law `U(theta)` of the volume, for cells that project
    /// the volume. `None`, the default, if there is no such law, or nothing of it to project.
    ///
    /// ```math
    /// W(C) = W_p(C) + U(theta),      theta = J - 1 or tr E
    /// ```
    ///
    /// `share`: the bulk modulus to be left in W_p over the shear modulus at rest. An energy
    /// `mu/2 (tr C - 3) - mu ln J` keeps 2/3 by itself and ignores it.
    fn split(&self, share: f64) -> Option<(Self, VolumeLaw)> {
        let _ = share;
        None
    }

    /// Tables of the material's functions, for a region. The default is compiled with the crate that makes the region,
    /// in a few seconds; the materials of this crate override it and are compiled once.
    fn compiled(&self) -> CompiledMaterial {
        CompiledMaterial::new(self)
    }
}

/// Lame parameters (lambda, mu) from Young's modulus and Poisson's ratio.
///
/// ```math
/// lambda = E nu / ((1 + nu) (1 - 2 nu)),      mu = E / (2 (1 + nu))
/// ```
///
/// ```
/// let (lambda, mu) = emmy::material::lame("rubber", 2.5, 0.25)?;
/// assert!((lambda - 1.0).abs() < 1e-15 && (mu - 1.0).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// [`Error::MaterialParameter`] unless E > 0 and -1 < nu < 1/2 and both parameters are finite.
pub fn lame(material: &'static str, youngs_modulus: f64, poissons_ratio: f64) -> Result<(f64, f64)> {
    let E = youngs_modulus;
    let nu = poissons_ratio;
    positive(material, "youngs_modulus", E)?;
    if !(nu > -1.0 && nu < 0.5) {
        let requirement = "must lie between -1 and 0.5 (0.5, an incompressible material, excluded)";
        return Err(Error::MaterialParameter {
            material,
            parameter: "poissons_ratio",
            value: nu,
            requirement,
        });
    }
    let lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let mu = E / (2.0 * (1.0 + nu));
    let requirement = "makes a Lame parameter lambda or mu that is too large for a number";
    fulfils(lambda.is_finite() && mu.is_finite(), material, "youngs_modulus", E, requirement)?;
    Ok((lambda, mu))
}

/// Checks that Lame parameters make a stable material: mu > 0 and lambda + 2/3 mu > 0.
fn stable_lame(material: &'static str, lambda: f64, mu: f64) -> Result<()> {
    positive(material, "mu", mu)?;
    if lambda.is_finite() && lambda + 2.0 / 3.0 * mu > 0.0 {
        return Ok(());
    }
    let requirement = "must be finite and larger than -2/3 mu (positive bulk modulus)";
    Err(Error::MaterialParameter { material, parameter: "lambda", value: lambda, requirement })
}

/// Checks a condition on a parameter.
fn fulfils(
    condition: bool,
    material: &'static str,
    parameter: &'static str,
    value: f64,
    requirement: &'static str,
) -> Result<()> {
    if condition {
        return Ok(());
    }
    Err(Error::MaterialParameter { material, parameter, value, requirement })
}

fn positive(material: &'static str, parameter: &'static str, value: f64) -> Result<()> {
    let is_positive = value > 0.0 && value.is_finite();
    fulfils(is_positive, material, parameter, value, "must be positive and finite")
}

fn finite(material: &'static str, parameter: &'static str, value: f64) -> Result<()> {
    fulfils(value.is_finite(), material, parameter, value, "must be finite")
}

/// Implements [`Material`] by the functions of a shared module, `isochoric` or `spectral`.
macro_rules! split_material {
    ($model:ty, $room:ident) => {
        impl super::Material for $model {
            #[inline(always)]
            fn strain_energy<L: Lane>(&self, E: &crate::tensor::Sym<L>) -> L {
                super::$room::strain_energy(self, E)
            }
            #[inline(always)]
            fn energy_change<L: Lane>(
                &self,
                E: &crate::tensor::Sym<L>,
                dE: &crate::tensor::Sym<L>,
            ) -> Option<L> {
                Some(super::$room::energy_change(self, E, dE))
            }
            #[inline(always)]
            fn stress<L: Lane>(&self, E: &crate::tensor::Sym<L>) -> crate::tensor::Sym<L> {
                super::$room::stress(self, E)
            }
            #[inline(always)]
            fn stress_and_elasticity<L: Lane>(
                &self,
                E: &crate::tensor::Sym<L>,
            ) -> (crate::tensor::Sym<L>, crate::tensor::Elasticity<L>) {
                super::$room::stress_and_elasticity(self, E)
            }
            fn split(&self, share: f64) -> Option<(Self, super::VolumeLaw)> {
                super::$room::split(self, share)
            }
            super::compiled_with_this_crate!();
        }
    };
}
use split_material;

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a constructor rejects a parameter by its name.
    pub(super) fn rejects<T: std::fmt::Debug>(expected: &str, result: Result<T>) {
        match result.unwrap_err() {
            Error::MaterialParameter { parameter, .. } | Error::Direction { parameter, .. } => {
                assert_eq!(parameter, expected)
            }
            other => panic!("{other}"),
        }
    }

    #[test]
    fn bad_parameters_are_rejected_by_name() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            rejects("youngs_modulus", lame("m", bad, 0.3));
            rejects("mu", stable_lame("m", 1.0, bad));
        }
        for bad in [0.5, 0.7, -1.0, -2.0, f64::NAN] {
            rejects("poissons_ratio", lame("m", 1.0, bad));
        }
        for bad in [-2.0, -3.0, f64::NAN, f64::INFINITY] {
            rejects("lambda", stable_lame("m", bad, 3.0));
        }
        assert!(stable_lame("m", -1.99, 3.0).is_ok());
        // lambda is about 1e308 / (3 (1 - 2 nu)), beyond the largest double.
        rejects("youngs_modulus", lame("m", 1e308, 0.4999999999));
    }

    #[test]
    fn lame_parameters_match_the_formula() {
        let (lambda, mu) = lame("m", 2.5, 0.25).unwrap();
        assert!((lambda - 1.0).abs() < 1e-15 && (mu - 1.0).abs() < 1e-15);
    }

    #[test]
    fn messages_name_material_parameter_value_and_requirement() {
        let error = NeoHooke::from_engineering(1.0, 0.5).unwrap_err().to_string();
        assert!(error.starts_with("neo-hooke: poissons_ratio = 0.5 must lie between -1 and 0.5"), "{error}");
    }
}
