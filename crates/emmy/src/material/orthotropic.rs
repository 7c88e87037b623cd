//! Orthotropic St. Venant-Kirchhoff material.

#![allow(non_snake_case)]

use super::model::{Bounds, Model, ModelCells, Modelled, Parameter, Values};
use super::{Material, axes, compiled_with_this_crate, fulfils, positive};
use crate::error::Result;
use crate::tensor::{Elasticity, Lane, Sym, double_dot, inlined, sym};

/// Nine engineering constants of an orthotropic material.
///
/// The index pairs of Poisson's ratios and shear moduli are 12, 23, 13. `nu_ij` is the contraction along axis j over
/// the extension along axis i, under tension along i: `nu_ij / E_i = nu_ji / E_j`.
///
/// ```
/// use emmy::material::{EngineeringConstants, Material, Orthotropic};
/// let isotropic =
///     EngineeringConstants { youngs_moduli: [2.5; 3], poissons_ratios: [0.25; 3], shear_moduli: [1.0; 3] };
/// let material = Orthotropic::new(isotropic, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])?;
/// // lambda = mu = 1: S_11 = (lambda + 2 mu) E_11.
/// assert!((material.stress(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0])[0] - 0.3).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineeringConstants {
    /// Young's moduli E_1, E_2, E_3 \[force/length^2\].
    pub youngs_moduli: [f64; 3],
    /// Poisson's ratios nu_12, nu_23, nu_13.
    pub poissons_ratios: [f64; 3],
    /// Shear moduli mu_12, mu_23, mu_13 \[force/length^2\].
    pub shear_moduli: [f64; 3],
}

/// Orthotropic St. Venant-Kirchhoff material: wood, plies, bone, in large rotation and small strain.
///
/// ```math
/// W = 1/2 E : D : E,      D^-1 from the engineering constants in the axes of the material
/// ```
///
/// Source: Jones (1999), Mechanics of Composite Materials, section 2.4, with the Green-Lagrange strain.
///
/// ```
/// use emmy::material::{EngineeringConstants, Material, Orthotropic};
/// let ply = EngineeringConstants {
///     youngs_moduli: [140e3, 10e3, 10e3],
///     poissons_ratios: [0.3, 0.45, 0.3],
///     shear_moduli: [5e3, 3.4e3, 5e3],
/// };
/// // Fibres along y. Tension of 140 along them: strains 1e-3 and -0.3e-3.
/// let material = Orthotropic::new(ply, [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
/// let stress = material.stress(&[-0.3e-3, 1e-3, -0.3e-3, 0.0, 0.0, 0.0]);
/// assert!((stress[1] - 140.0).abs() < 1e-12 && stress[0].abs() < 1e-12 && stress[2].abs() < 1e-12);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    D: Elasticity<f64>,
}

const NAME: &str = "orthotropic";
const YOUNGS_MODULI: [&str; 3] = ["youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3"];
const POISSONS_RATIOS: [&str; 3] = ["poissons_ratio_12", "poissons_ratio_23", "poissons_ratio_13"];
const SHEAR_MODULI: [&str; 3] = ["mu_12", "mu_23", "mu_13"];
const PAIRS: [(usize, usize); 3] = [(0, 1), (1, 2), (0, 2)];

impl Orthotropic {
    /// The material with engineering constants in its own axes: axis 1 along the first direction, axis 2 in the plane
    /// of both, on the side of the second, axis 3 across them. Directions need not be unit vectors.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless all moduli are positive and the elasticity is positive definite, and
    /// for directions (`axis_1`, `axis_2`) that are zero or parallel.
    pub fn new(constants: EngineeringConstants, directions: [[f64; 3]; 2]) -> Result<Self> {
        let stiffness = normal_stiffness(&constants)?;
        for (name, mu) in SHEAR_MODULI.into_iter().zip(constants.shear_moduli) {
            positive(NAME, name, mu)?;
        }
        let axes = axes::from_directions(NAME, directions)?;
        Ok(Orthotropic { D: in_axes(&stiffness, &constants.shear_moduli, &axes) })
    }
}

/// Stiffness between normal stresses and strains: the inverse of the compliance `s_ii = 1/E_i`, `s_ij = -nu_ij/E_i`.
fn normal_stiffness(constants: &EngineeringConstants) -> Result<[[f64; 3]; 3]> {
    let E = constants.youngs_moduli;
    let nu = constants.poissons_ratios;
    for (name, E) in YOUNGS_MODULI.into_iter().zip(E) {
        positive(NAME, name, E)?;
    }
    // Scaled to a unit diagonal: s_ij sqrt(E_i E_j).
    let s = [0, 1, 2].map(|p| -nu[p] * (E[PAIRS[p].1] / E[PAIRS[p].0]).sqrt());
    for p in 0..3 {
        let requirement = "must be smaller in size than sqrt(E_i / E_j) (positive definite elasticity)";
        fulfils(s[p] * s[p] < 1.0, NAME, POISSONS_RATIOS[p], nu[p], requirement)?;
    }
    let [a, b, c] = s;
    let det = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c;
    let requirement = "is too large together with the other two (positive definite elasticity)";
    let largest = (0..3).fold(0, |m, p| if s[p].abs() > s[m].abs() { p } else { m });
    fulfils(det > 0.0, NAME, POISSONS_RATIOS[largest], nu[largest], requirement)?;
    let cofactor = [
        [1.0 - b * b, b * c - a, a * b - c],
        [b * c - a, 1.0 - c * c, a * c - b],
        [a * b - c, a * c - b, 1.0 - a * a],
    ];
    Ok([0, 1, 2].map(|i| [0, 1, 2].map(|j| cofactor[i][j] / det * (E[i] * E[j]).sqrt())))
}

/// ```math
/// D = sum_ij c_ij (a_i a_i^T) (x) (a_j a_j^T) + sum_(i<j) 4 mu_ij q_ij (x) q_ij,      q_ij = (a_i a_j^T + a_j a_i^T) / 2
/// ```
fn in_axes(stiffness: &[[f64; 3]; 3], shear_moduli: &[f64; 3], axes: &[[f64; 3]; 3]) -> Elasticity<f64> {
    let dyad = |i: usize, j: usize| {
        let u = &axes[i];
        let v = &axes[j];
        sym(|r, c| 0.5 * (u[r] * v[c] + v[r] * u[c]))
    };
    let mut D = [[0.0; 6]; 6];
    let mut add = |s: f64, A: &Sym<f64>, B: &Sym<f64>| {
        (0..36).for_each(|n| D[n / 6][n % 6] += s * (A[n / 6] * B[n % 6] + B[n / 6] * A[n % 6]) * 0.5);
    };
    for (i, row) in stiffness.iter().enumerate() {
        for (j, &c) in row.iter().enumerate() {
            add(c, &dyad(i, i), &dyad(j, j));
        }
    }
    for (&mu, (i, j)) in shear_moduli.iter().zip(PAIRS) {
        add(4.0 * mu, &dyad(i, j), &dyad(i, j));
    }
    D
}

impl Modelled for Orthotropic {
    const MODEL: Model = Model {
        name: NAME,
        energy: "E : D : E / 2",
        purpose: "wood, plies, bone; large rotation, small strain",
        parameters: &[&[
            Parameter::positive("youngs_modulus_1", "stress", "Young's modulus E_1 along axis 1"),
            Parameter::positive("youngs_modulus_2", "stress", "Young's modulus E_2 along axis 2"),
            Parameter::positive("youngs_modulus_3", "stress", "Young's modulus E_3 along axis 3"),
            Parameter::number(
                "poissons_ratio_12",
                Bounds::Any,
                "",
                "Contraction along axis 2 over extension along axis 1, under tension along 1",
            ),
            Parameter::number(
                "poissons_ratio_23",
                Bounds::Any,
                "",
                "Contraction along axis 3 over extension along axis 2, under tension along 2",
            ),
            Parameter::number(
                "poissons_ratio_13",
                Bounds::Any,
                "",
                "Contraction along axis 3 over extension along axis 1, under tension along 1",
            ),
            Parameter::positive("mu_12", "stress", "Shear modulus in the plane of axes 1 and 2"),
            Parameter::positive("mu_23", "stress", "Shear modulus in the plane of axes 2 and 3"),
            Parameter::positive("mu_13", "stress", "Shear modulus in the plane of axes 1 and 3"),
            Parameter::direction("axis_1", "[1, 0, 0]", "Direction of axis 1"),
            Parameter::direction(
                "axis_2",
                "[0, 1, 0]",
                "A direction in the plane of axes 1 and 2, on the side of axis 2; axis 3 is across them",
            ),
        ]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let numbers = |names: [&str; 3]| names.map(|name| values.number(name));
        let constants = EngineeringConstants {
            youngs_moduli: numbers(YOUNGS_MODULI),
            poissons_ratios: numbers(POISSONS_RATIOS),
            shear_moduli: numbers(SHEAR_MODULI),
        };
        Orthotropic::new(constants, ["axis_1", "axis_2"].map(|name| values.direction(name)))
    }
}

impl Material for Orthotropic {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        double_dot(&self.stress(E), E) * 0.5
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let row = inlined!(|a: usize| {
            let d = &self.D[a];
            let shear = E[3] * d[3] + E[4] * d[4] + E[5] * d[5];
            E[0] * d[0] + E[1] * d[1] + E[2] * d[2] + shear * 2.0
        });
        [row(0), row(1), row(2), row(3), row(4), row(5)]
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let mut D = [[E[0]; 6]; 6];
        for a in 0..6 {
            for b in 0..6 {
                D[a][b] = E[0].splat(self.D[a][b]);
            }
        }
        (self.stress(E), D)
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::{Big, big, conforms_with_symmetry, half_turn};
    use super::super::tests::rejects;
    use super::*;
    use crate::tensor::{Mat3, SYM_INDEX};

    const SPRUCE: EngineeringConstants = EngineeringConstants {
        youngs_moduli: [10.0, 0.8, 0.45],
        poissons_ratios: [0.37, 0.43, 0.47],
        shear_moduli: [0.64, 0.03, 0.58],
    };

    /// Stiffness of the normal components, in the closed form of Jones (1999), section 2.4.
    fn closed_form() -> [[Big; 3]; 3] {
        let [e1, e2, e3] = SPRUCE.youngs_moduli.map(big);
        let [nu12, nu23, nu13] = SPRUCE.poissons_ratios.map(big);
        let (nu21, nu32, nu31) = (&nu12 * &e2 / &e1, &nu23 * &e3 / &e2, &nu13 * &e3 / &e1);
        let one = big(1.0);
        let delta = &one - &nu12 * &nu21 - &nu23 * &nu32 - &nu13 * &nu31 - big(2.0) * &nu21 * &nu32 * &nu13;
        let c = |numerator: Big, e: &Big| numerator * e / &delta;
        let c12 = c(&nu21 + &nu31 * &nu23, &e1);
        let c13 = c(&nu31 + &nu21 * &nu32, &e1);
        let c23 = c(&nu32 + &nu12 * &nu31, &e2);
        [
            [c(&one - &nu23 * &nu32, &e1), c12.clone(), c13.clone()],
            [c12, c(&one - &nu13 * &nu31, &e2), c23.clone()],
            [c13, c23, c(&one - &nu12 * &nu21, &e3)],
        ]
    }

    /// W in the axes of the material; the axes are rows of numbers.
    fn energy(C: &Mat3<Big>, axes: &[[f64; 3]; 3], stiffness: &[[Big; 3]; 3]) -> Big {
        let half = |i: usize, j: usize| (&C[i][j] - big(if i == j { 1.0 } else { 0.0 })) / big(2.0);
        let strain = |a: usize, b: usize| -> Big {
            (0..9)
                .fold(big(0.0), |sum, n| sum + big(axes[a][n / 3]) * half(n / 3, n % 3) * big(axes[b][n % 3]))
        };
        let mut W = big(0.0);
        for i in 0..3 {
            for j in 0..3 {
                W += &stiffness[i][j] * strain(i, i) * strain(j, j) / big(2.0);
            }
        }
        for ((i, j), mu) in PAIRS.into_iter().zip(SPRUCE.shear_moduli) {
            let shear = strain(i, j);
            W += big(2.0 * mu) * &shear * &shear;
        }
        W
    }

    #[test]
    fn conforms_to_its_textbook_form() {
        let material = Orthotropic::new(SPRUCE, [[1.0, 2.0, -0.5], [0.0, 1.0, 1.0]]).unwrap();
        let axes = axes::from_directions("test", [[1.0, 2.0, -0.5], [0.0, 1.0, 1.0]]).unwrap();
        let stiffness = closed_form();
        let plain = [0, 1, 2].map(|i| [0, 1, 2].map(|j| stiffness[i][j].to_f64().value()));
        let small_strain_stress = |E: &Sym<f64>| {
            let strain = |a: usize, b: usize| -> f64 {
                (0..9).map(|n| axes[a][n / 3] * E[SYM_INDEX[n / 3][n % 3]] * axes[b][n % 3]).sum()
            };
            let mut S = [[0.0; 3]; 3];
            (0..9).for_each(|n| S[n / 3][n / 3] += plain[n / 3][n % 3] * strain(n % 3, n % 3));
            for ((i, j), mu) in PAIRS.into_iter().zip(SPRUCE.shear_moduli) {
                (S[i][j], S[j][i]) = (2.0 * mu * strain(i, j), 2.0 * mu * strain(i, j));
            }
            sym(|r, c| (0..9).map(|n| axes[n / 3][r] * S[n / 3][n % 3] * axes[n % 3][c]).sum())
        };
        let symmetry = axes.map(half_turn);
        conforms_with_symmetry(&material, &symmetry, small_strain_stress, |C| energy(C, &axes, &stiffness));
    }

    #[test]
    fn an_isotropic_one_is_saint_venant_kirchhoff() {
        let constants = EngineeringConstants {
            youngs_moduli: [1000.0; 3],
            poissons_ratios: [0.3; 3],
            shear_moduli: [1000.0 / 2.6; 3],
        };
        let material = Orthotropic::new(constants, [[1.0, 2.0, 3.0], [3.0, -2.0, 1.0]]).unwrap();
        let isotropic = super::super::SaintVenantKirchhoff::from_engineering(1000.0, 0.3).unwrap();
        let E = [0.1, -0.2, 0.3, 0.05, 0.15, -0.25];
        for (a, b) in material.stress(&E).into_iter().zip(isotropic.stress(&E)) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let changed = |change: fn(&mut EngineeringConstants)| {
            let mut constants = SPRUCE;
            change(&mut constants);
            Orthotropic::new(constants, frame)
        };
        rejects("youngs_modulus_2", changed(|c| c.youngs_moduli[1] = 0.0));
        rejects("mu_13", changed(|c| c.shear_moduli[2] = -1.0));
        rejects("poissons_ratio_12", changed(|c| c.poissons_ratios[0] = 3.6));
        rejects("poissons_ratio_23", changed(|c| c.poissons_ratios[1] = f64::NAN));
        rejects(
            "poissons_ratio_23",
            changed(|c| {
                *c = EngineeringConstants {
                    youngs_moduli: [1.0; 3],
                    poissons_ratios: [0.6, 0.61, 0.6],
                    shear_moduli: [1.0; 3],
                }
            }),
        );
        rejects("axis_1", Orthotropic::new(SPRUCE, [[0.0; 3], [1.0, 0.0, 0.0]]));
        rejects("axis_2", Orthotropic::new(SPRUCE, [[1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]]));
    }
}
