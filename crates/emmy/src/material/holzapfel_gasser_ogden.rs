//! Holzapfel-Gasser-Ogden material.

#![allow(non_snake_case)]

use super::invariants::{add_dyad, commuting_product};
use super::isochoric::{IsochoricStretch, SecondDerivative};
use super::model::{
    BULK_MODULUS, Bounds, IfAbsent, Model, ModelCells, Modelled, Parameter, VOLUMETRIC, Values,
};
use super::volumetric::Volume;
use super::{Material, VolumeLaw, Volumetric, axes, compiled_with_this_crate, fulfils, positive};
use crate::error::Result;
use crate::tensor::{Elasticity, Lane, SYM_INDEX, Sym, double_dot, sym, sym_add_scaled, sym_scaled};

/// Holzapfel-Gasser-Ogden material: a neo-Hooke matrix with families of stiffening fibres, for soft tissue.
///
/// ```math
/// W = mu/2 (I1bar - 3) + k1/(2 k2) sum_f [exp(k2 <E_f>^2) - 1] + W_vol(J)
/// E_f = kappa (I1bar - 3) + (1 - 3 kappa) (I4bar_f - 1),      I4bar_f = J^(-2/3) a_f . C a_f,      <x> = max(x, 0)
/// ```
///
/// Fibres of direction a_f bear tension only: S is continuous where they go slack, D is not. With one family the
/// material is transversely isotropic.
///
/// Source: Holzapfel, Gasser and Ogden (2000), J. Elast. 61; the dispersion kappa, from 0 (parallel) to 1/3
/// (isotropic), from Gasser, Ogden and Holzapfel (2006), J. R. Soc. Interface 3. mu, k1 and the bulk modulus in
/// \[force/length^2\], k2 and kappa have no dimension. The exponential magnifies rounding by 2 k2 <E_f>^2.
///
/// ```
/// use emmy::material::{HolzapfelGasserOgden, Material, Volumetric};
/// let fibres = [[1.0, 0.0, 0.0]];
/// let tissue = HolzapfelGasserOgden::new(3.0, [2.0, 0.5], 0.0, &fibres, 100.0, Volumetric::default())?;
/// // Simple shear by 0.4 along y does not stretch the fibres; along x it shears by 0.4 and stretches none either.
/// let along_y = tissue.strain_energy(&[0.08, 0.0, 0.0, 0.2, 0.0, 0.0]); // a . C a = 1 + 0.4^2
/// let along_x = tissue.strain_energy(&[0.0, 0.08, 0.0, 0.2, 0.0, 0.0]); // a . C a = 1
/// assert!((along_x - 1.5 * 0.16).abs() < 1e-15);
/// assert!((along_y - along_x - 2.0 * (0.5 * 0.16f64 * 0.16).exp_m1()).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HolzapfelGasserOgden {
    mu: f64,
    k1: f64,
    k2: f64,
    /// 1 - 3 kappa.
    alignment: f64,
    /// dev(a_f a_f^T).
    fibres: Vec<Sym<f64>>,
    volume: Volume,
}

const NAME: &str = "holzapfel-gasser-ogden";

impl HolzapfelGasserOgden {
    /// The material with the matrix's shear modulus, `[k1, k2]` of the fibres, their dispersion, the direction of each
    /// family (not necessarily a unit vector), bulk modulus, and law of volume.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless mu, k1, k2 and the bulk modulus are positive, 0 <= kappa <= 1/3, and
    /// the directions are finite and not zero.
    pub fn new(
        mu: f64,
        [k1, k2]: [f64; 2],
        kappa: f64,
        fibres: &[[f64; 3]],
        bulk_modulus: f64,
        volumetric: Volumetric,
    ) -> Result<Self> {
        positive(NAME, "mu", mu)?;
        positive(NAME, "k1", k1)?;
        positive(NAME, "k2", k2)?;
        let is_dispersion = (0.0..=1.0 / 3.0).contains(&kappa);
        fulfils(is_dispersion, NAME, "kappa", kappa, "must lie between 0 (parallel) and 1/3 (isotropic)")?;
        let fibres = fibres.iter().map(|&direction| {
            let a = axes::unit(NAME, "fibres", direction)?;
            Ok(sym(|i, j| a[i] * a[j] - if i == j { 1.0 / 3.0 } else { 0.0 }))
        });
        let fibres = fibres.collect::<Result<_>>()?;
        let volume = Volume::new(NAME, bulk_modulus, volumetric)?;
        Ok(HolzapfelGasserOgden { mu, k1, k2, alignment: 1.0 - 3.0 * kappa, fibres, volume })
    }

    /// <E_f>, in a form in which nothing cancels at small strain.
    ///
    /// ```math
    /// E_f = (I1bar - 3)/3 + (1 - 3 kappa) g (a . b a)
    /// ```
    #[inline(always)]
    fn fibre_strain<L: Lane>(&self, of: &IsochoricStretch<L>, fibre: &Sym<f64>) -> L {
        let zero = of.mean.splat(0.0);
        let strain = of.g_m1 + of.g() * double_dot_constant(&of.b, fibre) * self.alignment;
        strain.select_below(zero, zero, strain)
    }

    /// dW/dE_f and d^2W/dE_f^2; both are zero in a slack fibre.
    #[inline(always)]
    fn fibre_derivatives<L: Lane>(&self, strain: L) -> [L; 2] {
        let one = strain.splat(1.0);
        let square = strain * strain * self.k2;
        let exp = (one + square.exp_m1()) * self.k1;
        let second = exp * (one + square * 2.0);
        let tiny = strain.splat(f64::MIN_POSITIVE);
        [exp * strain, strain.select_below(tiny, strain.splat(0.0), second)]
    }

    /// Second Piola-Kirchhoff stress of one unit of dW/dE_f.
    ///
    /// ```math
    /// 2 dE_f/dC = 2/3 g C^-1 b + 2 (1 - 3 kappa) J^(-2/3) [A - (A : C)/3 C^-1],      A = dev(a a^T)
    /// ```
    #[inline(always)]
    fn fibre_direction<L: Lane>(
        &self,
        of: &IsochoricStretch<L>,
        inverse: &Sym<L>,
        matrix: &Sym<L>,
        fibre: &Sym<f64>,
    ) -> Sym<L> {
        let scale = of.g() / of.mean * (2.0 * self.alignment);
        let stretch = of.mean * double_dot_constant(&of.b, fibre) * (-1.0 / 3.0);
        let mut N = sym_add_scaled(&sym_scaled(of.mean.splat(1.0 / 3.0), matrix), scale * stretch, inverse);
        for a in 0..6 {
            N[a] += scale * fibre[a];
        }
        N
    }

    /// 2 dI1bar/dC = 2 g C^-1 b.
    #[inline(always)]
    fn matrix_direction<L: Lane>(of: &IsochoricStretch<L>, inverse: &Sym<L>) -> Sym<L> {
        sym_scaled(of.g() * 2.0, &commuting_product(inverse, &of.b))
    }
}

/// A constant tensor in every lane.
#[inline(always)]
fn splat<L: Lane>(one: L, A: &Sym<f64>) -> Sym<L> {
    sym(
        #[inline(always)]
        |i, j| one.splat(A[SYM_INDEX[i][j]]),
    )
}

#[inline(always)]
fn double_dot_constant<L: Lane>(A: &Sym<L>, B: &Sym<f64>) -> L {
    double_dot(A, &splat(A[0], B))
}

impl Modelled for HolzapfelGasserOgden {
    const MODEL: Model = Model {
        name: NAME,
        energy: "mu/2 (I1bar - 3) + k1/(2 k2) sum_f (exp(k2 <E_f>^2) - 1) + W_vol(J)",
        purpose: "soft tissue: a matrix with fibres",
        parameters: &[&[
            Parameter::positive("mu", "stress", "Shear modulus of the matrix"),
            Parameter::positive("k1", "stress", "Stiffness of the fibres"),
            Parameter::positive("k2", "", "Growth of their stiffness with the strain"),
            Parameter::number(
                "kappa",
                Bounds::Within(0.0, 0.333_333_333_333_333_4),
                "",
                "Dispersion of the fibres: 0 parallel, 1/3 in all directions alike",
            )
            .if_absent(IfAbsent::Value("0.0")),
            Parameter::directions("fibres", "Direction of each family of fibres, such as `[[1, 0, 0]]`"),
            BULK_MODULUS,
            VOLUMETRIC,
        ]],
        cells: ModelCells::Solids,
    };

    fn from_values(values: &Values) -> Result<Self> {
        let [mu, k1, k2, kappa] = ["mu", "k1", "k2", "kappa"].map(|name| values.number(name));
        let (bulk_modulus, law) = values.volume();
        HolzapfelGasserOgden::new(mu, [k1, k2], kappa, values.directions("fibres"), bulk_modulus, law)
    }
}

impl Material for HolzapfelGasserOgden {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let of = IsochoricStretch::of(E);
        let mut W = of.x() * (0.5 * self.mu) + self.volume.energy(of.ln_J);
        for fibre in &self.fibres {
            let strain = self.fibre_strain(&of, fibre);
            W += (strain * strain * self.k2).exp_m1() * (0.5 * self.k1 / self.k2);
        }
        W
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let of = IsochoricStretch::of(E);
        let inverse = of.inverse();
        let matrix = Self::matrix_direction(&of, &inverse);
        let mut S = sym_scaled(of.mean.splat(0.5 * self.mu), &matrix);
        S = sym_add_scaled(&S, self.volume.pressure(of.ln_J), &inverse);
        for fibre in &self.fibres {
            let slope = self.fibre_derivatives(self.fibre_strain(&of, fibre))[0];
            S = sym_add_scaled(&S, slope, &self.fibre_direction(&of, &inverse, &matrix, fibre));
        }
        S
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let of = IsochoricStretch::of(E);
        let inverse = of.inverse();
        let scale = of.g() / of.mean;
        let one = of.mean.splat(1.0);
        let zero = of.mean.splat(0.0);
        let matrix = Self::matrix_direction(&of, &inverse);
        let unit = [one, one, one, zero, zero, zero];
        let trace = of.mean * 3.0;
        let mut second = SecondDerivative::of_volume(&self.volume, of.ln_J);
        second.add_first(one * (0.5 * self.mu), scale, trace, &unit);
        for fibre in &self.fibres {
            let slope = self.fibre_derivatives(self.fibre_strain(&of, fibre))[0];
            second.add_first(slope * (1.0 / 3.0), scale, trace, &unit);
            let A = splat(one, fibre);
            let stretch = of.mean * double_dot_constant(&of.b, fibre);
            second.add_first(slope * self.alignment, scale, stretch, &A);
        }
        let mut D = second.elasticity(&inverse);
        for fibre in &self.fibres {
            let curvature = self.fibre_derivatives(self.fibre_strain(&of, fibre))[1];
            add_dyad(&mut D, curvature, &self.fibre_direction(&of, &inverse, &matrix, fibre));
        }
        (self.stress(E), D)
    }

    fn split(&self, share: f64) -> Option<(Self, VolumeLaw)> {
        let (volume, law) = self.volume.split(share * self.mu)?;
        Some((HolzapfelGasserOgden { volume, ..self.clone() }, law))
    }
}

#[cfg(test)]
mod tests {
    use super::super::conformance::{
        Big, big, big_det, big_isochoric, big_trace, conforms_with_symmetry, half_turn,
    };
    use super::super::tests::rejects;
    use super::super::volumetric::tests::energy;
    use super::*;
    use crate::tensor::{Mat3, mat3, trace};

    const MU: f64 = 3.0;
    const K1: f64 = 2.3632;
    /// A quarter of the k2 of the artery: the exponential magnifies the rounding of E_f by 2 k2 E_f^2, which is 34 for
    /// the artery at the largest strain of the test (E_f = 4.5) and would hide errors in the formula.
    const K2: f64 = 0.21;
    const K: f64 = 20.0;

    /// The media of a carotid artery of a rabbit, by Holzapfel et al. (2000), in kPa, made compressible.
    fn artery(kappa: f64, fibres: &[[f64; 3]]) -> HolzapfelGasserOgden {
        HolzapfelGasserOgden::new(MU, [K1, K2], kappa, fibres, K, Volumetric::SimoTaylor).unwrap()
    }

    /// a . C a, for the exact direction of a after rounding.
    fn stretched(fibre: &[f64; 3], C: &Mat3<Big>) -> Big {
        let entry = |n: usize| big(fibre[n / 3]) * &C[n / 3][n % 3] * big(fibre[n % 3]);
        let square = fibre.iter().fold(big(0.0), |sum, a| sum + big(*a) * big(*a));
        (0..9).fold(big(0.0), |sum, n| sum + entry(n)) / square
    }

    fn textbook(kappa: f64, fibres: &[[f64; 3]], C: &Mat3<Big>) -> Big {
        let I1 = big_isochoric(C)[0].clone();
        let scale = &I1 / big_trace(C);
        let x = I1 - big(3.0);
        let mut W = big(MU / 2.0) * &x + energy(Volumetric::SimoTaylor, K, &big_det(C));
        for fibre in fibres {
            let strain = big(kappa) * &x + big(1.0 - 3.0 * kappa) * (stretched(fibre, C) * &scale - big(1.0));
            if strain > big(0.0) {
                W += big(0.5 * K1 / K2) * ((big(K2) * &strain * &strain).exp() - big(1.0));
            }
        }
        W
    }

    /// Matrix 2 mu dev E + K tr E, fibres k1 (1 - 3 kappa)^2 <2 a . dev E a> 2 dev(a a^T).
    fn small_strain_stress(kappa: f64, fibres: &[[f64; 3]], E: &Sym<f64>) -> Sym<f64> {
        let dev = |A: &Sym<f64>| [0, 1, 2, 3, 4, 5].map(|a| A[a] - if a < 3 { trace(A) / 3.0 } else { 0.0 });
        let mut S = dev(E).map(|e| 2.0 * MU * e);
        (0..3).for_each(|i| S[i] += K * trace(E));
        for a in fibres {
            let A = dev(&sym(|i, j| a[i] * a[j]));
            let strain = (1.0 - 3.0 * kappa) * 2.0 * double_dot(E, &A);
            S = sym_add_scaled(&S, 2.0 * (1.0 - 3.0 * kappa) * K1 * strain.max(0.0), &A);
        }
        S
    }

    /// Rotation about x.
    fn turn(angle: f64) -> Mat3<f64> {
        let (s, c) = angle.sin_cos();
        [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    }

    #[test]
    fn one_family_is_transversely_isotropic() {
        let fibres = [[1.0, 0.0, 0.0]];
        let symmetry =
            [turn(0.7), turn(2.0), half_turn([0.0, 1.0, 0.0]), mat3(|i, j| if i == j { -1.0 } else { 0.0 })];
        conforms_with_symmetry(
            &artery(0.0, &fibres),
            &symmetry,
            |E| small_strain_stress(0.0, &fibres, E),
            |C| textbook(0.0, &fibres, C),
        );
    }

    #[test]
    fn two_dispersed_families_are_orthotropic() {
        let fibres = [[0.8, 0.6, 0.0], [0.8, -0.6, 0.0]];
        let symmetry = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(half_turn);
        conforms_with_symmetry(
            &artery(0.226, &fibres),
            &symmetry,
            |E| small_strain_stress(0.226, &fibres, E),
            |C| textbook(0.226, &fibres, C),
        );
    }

    #[test]
    fn bad_parameters_are_rejected() {
        let new = |mu, k, kappa, fibre, bulk| {
            HolzapfelGasserOgden::new(mu, k, kappa, &[fibre], bulk, Volumetric::default())
        };
        let x = [1.0, 0.0, 0.0];
        rejects("mu", new(0.0, [1.0, 1.0], 0.0, x, 1.0));
        rejects("k1", new(1.0, [-1.0, 1.0], 0.0, x, 1.0));
        rejects("k2", new(1.0, [1.0, 0.0], 0.0, x, 1.0));
        rejects("kappa", new(1.0, [1.0, 1.0], 0.34, x, 1.0));
        rejects("kappa", new(1.0, [1.0, 1.0], -0.1, x, 1.0));
        rejects("fibres", new(1.0, [1.0, 1.0], 0.0, [0.0; 3], 1.0));
        rejects("bulk_modulus", new(1.0, [1.0, 1.0], 0.0, x, 0.0));
    }
}
