//! Energies of the isochoric invariants: stress and elasticity of all these materials.
//!
//! With the mean m and the distortion b of [`super::distortion`] and `g = (1 - w)^(-1/3)`
//!
//! ```math
//! I1bar - 3 = 3 (g - 1),      I2bar - 3 = 3 (g^2 - 1) - g^2 b:b/2
//! ```

#![allow(non_snake_case)]

use std::ops::Deref;

use super::VolumeLaw;
use super::distortion::{Distortion, DistortionChange};
use super::invariants::{add_dyad, add_dyads, commuting_product, inverse_dyads};
use super::volumetric::Volume;
use crate::tensor::{Elasticity, Lane, Sym, sym, sym_scaled};

/// A material whose energy is one of the isochoric invariants and one of the volume.
///
/// ```math
/// W = f(x) + c y + W_vol(J),      x = I1bar - 3,      y = I2bar - 3
/// ```
pub(super) trait Isochoric {
    /// Law of volume.
    fn volume(&self) -> &Volume;
    /// The same material with another law of volume.
    fn with_volume(&self, volume: Volume) -> Self;
    /// f.
    fn energy<L: Lane>(&self, x: L) -> L;
    /// f(x + dx) - f(x), without cancellation.
    fn energy_change<L: Lane>(&self, x: L, dx: L) -> L;
    /// First and second derivative of f.
    fn derivatives<L: Lane>(&self, x: L) -> [L; 2];
    /// c.
    fn second_modulus(&self) -> f64 {
        0.0
    }
}

/// [`super::Material::split`], with the shear modulus `2 (f'(0) + c)`.
pub(super) fn split<M: Isochoric>(material: &M, share: f64) -> Option<(M, VolumeLaw)> {
    let shear_modulus = 2.0 * (material.derivatives(0.0)[0] + material.second_modulus());
    let (kept, law) = material.volume().split(share * shear_modulus)?;
    Some((material.with_volume(kept), law))
}

/// A distortion with its power g.
pub(super) struct IsochoricStretch<L> {
    distortion: Distortion<L>,
    /// g - 1.
    pub g_m1: L,
}

impl<L> Deref for IsochoricStretch<L> {
    type Target = Distortion<L>;
    #[inline(always)]
    fn deref(&self) -> &Distortion<L> {
        &self.distortion
    }
}

impl<L: Lane> IsochoricStretch<L> {
    #[inline(always)]
    pub(super) fn of(E: &Sym<L>) -> Self {
        let distortion = Distortion::of(E);
        let g_m1 = (distortion.ln_det * (-1.0 / 3.0)).exp_m1();
        IsochoricStretch { distortion, g_m1 }
    }

    /// g.
    #[inline(always)]
    pub(super) fn g(&self) -> L {
        self.mean.splat(1.0) + self.g_m1
    }

    /// I1bar - 3.
    #[inline(always)]
    pub(super) fn x(&self) -> L {
        self.g_m1 * 3.0
    }

    /// g^2 - 1.
    #[inline(always)]
    fn square_m1(&self) -> L {
        self.g_m1 * (self.g_m1 + self.mean.splat(2.0))
    }

    /// I2bar - 3.
    #[inline(always)]
    fn y(&self) -> L {
        let square_m1 = self.square_m1();
        square_m1 * 3.0 - self.q * (square_m1 + self.mean.splat(1.0))
    }

    /// Changes of I1bar and I2bar.
    #[inline(always)]
    fn change(&self, change: &DistortionChange<L>) -> [L; 2] {
        let g = self.g();
        let of_g = g * (change.ln_det * (-1.0 / 3.0)).exp_m1();
        let of_square = of_g * (g * 2.0 + of_g);
        let square = self.square_m1() + self.mean.splat(1.0) + of_square;
        [of_g * 3.0, of_square * (self.mean.splat(3.0) - self.q) - square * change.q]
    }

    /// b - dev(b^2), which belongs to I2bar as b belongs to I1bar.
    #[inline(always)]
    fn second_direction(&self) -> Sym<L> {
        let b = &self.b;
        let square = self.square();
        let third = self.q * (2.0 / 3.0);
        sym(
            #[inline(always)]
            |i, j| {
                let a = crate::tensor::SYM_INDEX[i][j];
                if i == j { b[a] - square[a] + third } else { b[a] - square[a] }
            },
        )
    }
}

/// The second derivative of a material of this kind, as sums over its invariants. With B = C^-1:
///
/// ```math
/// D = alpha B (x) B + beta (B_ik B_jl + B_il B_jk) + A (x) B + B (x) A + ...
/// ```
pub(super) struct SecondDerivative<L> {
    alpha: L,
    beta: L,
    A: Sym<L>,
}

impl<L: Lane> SecondDerivative<L> {
    /// Second derivative of the volumetric law.
    #[inline(always)]
    pub(super) fn of_volume(volume: &Volume, ln_J: L) -> Self {
        let zero = ln_J.splat(0.0);
        SecondDerivative { alpha: volume.stiffness(ln_J), beta: -volume.pressure(ln_J), A: [zero; 6] }
    }

    /// Adds `slope` times the second derivative of `J^(-2/3) H:C`, for a structure tensor H and the value `I = H:C`.
    ///
    /// ```math
    /// 4 J^(-2/3) [I/9 B (x) B + I/6 (B_ik B_jl + B_il B_jk) - 1/3 (H (x) B + B (x) H)]
    /// ```
    #[inline(always)]
    pub(super) fn add_first(&mut self, slope: L, scale: L, I: L, H: &Sym<L>) {
        let factor = slope * scale * 4.0;
        self.alpha += factor * I * (1.0 / 9.0);
        self.beta += factor * I * (1.0 / 6.0);
        for a in 0..6 {
            self.A[a] += factor * H[a] * (-1.0 / 3.0);
        }
    }

    /// Adds c times the second derivative of I2bar without its constant part, whose factor is returned.
    ///
    /// ```math
    /// 4 J^(-4/3) [4/9 I2 B (x) B + I2/3 (B_ik B_jl + B_il B_jk) - 2/3 (X (x) B + B (x) X) + I (x) I - 1],  X = I1 I - C
    /// ```
    #[inline(always)]
    fn add_second(&mut self, c: f64, of: &IsochoricStretch<L>) -> L {
        let g = of.g();
        let isochoric = g * g * (of.mean.splat(3.0) - of.q) * (4.0 * c); // 4 c J^(-4/3) I2
        self.alpha += isochoric * (4.0 / 9.0);
        self.beta += isochoric * (1.0 / 3.0);
        let factor = g * g / of.mean * (-8.0 / 3.0 * c); // of X = m (2 I - b)
        for a in 0..6 {
            let twice = of.mean.splat(if a < 3 { 2.0 } else { 0.0 });
            self.A[a] += factor * (twice - of.b[a]);
        }
        g * g / (of.mean * of.mean) * (4.0 * c)
    }

    /// The sum.
    #[inline(always)]
    pub(super) fn elasticity(&self, inverse: &Sym<L>) -> Elasticity<L> {
        let mut D = inverse_dyads(inverse, self.alpha, self.beta);
        add_dyads(&mut D, &self.A, inverse);
        D
    }
}

#[inline(always)]
pub(super) fn strain_energy<L: Lane>(material: &impl Isochoric, E: &Sym<L>) -> L {
    let distortion = IsochoricStretch::of(E);
    let energy = material.energy(distortion.x()) + material.volume().energy(distortion.ln_J);
    match material.second_modulus() {
        0.0 => energy,
        c => energy + distortion.y() * c,
    }
}

#[inline(always)]
pub(super) fn energy_change<L: Lane>(material: &impl Isochoric, E: &Sym<L>, dE: &Sym<L>) -> L {
    let start = IsochoricStretch::of(E);
    let change = start.distortion.change(dE);
    let [dx, dy] = start.change(&change);
    let energy =
        material.energy_change(start.x(), dx) + material.volume().energy_change(start.ln_J, change.ln_J);
    match material.second_modulus() {
        0.0 => energy,
        c => energy + dy * c,
    }
}

#[inline(always)]
pub(super) fn stress<L: Lane>(material: &impl Isochoric, E: &Sym<L>) -> Sym<L> {
    let distortion = IsochoricStretch::of(E);
    let slope = material.derivatives(distortion.x())[0];
    stress_of(material, &distortion, slope, &distortion.inverse())
}

/// ```math
/// S = C^-1 [2 f' g b + 2 c g^2 (b - dev b^2) + dW_vol/d(ln J) I]
/// ```
#[inline(always)]
fn stress_of<L: Lane>(
    material: &impl Isochoric,
    of: &IsochoricStretch<L>,
    slope: L,
    inverse: &Sym<L>,
) -> Sym<L> {
    let g = of.g();
    let mut M = sym_scaled(slope * g * 2.0, &of.b);
    let c = material.second_modulus();
    if c != 0.0 {
        let direction = of.second_direction();
        for a in 0..6 {
            M[a] += g * g * direction[a] * (2.0 * c);
        }
    }
    if !material.volume().is_zero() {
        let pressure = material.volume().pressure(of.ln_J);
        for i in 0..3 {
            M[i] += pressure;
        }
    }
    commuting_product(inverse, &M)
}

#[inline(always)]
pub(super) fn stress_and_elasticity<L: Lane>(
    material: &impl Isochoric,
    E: &Sym<L>,
) -> (Sym<L>, Elasticity<L>) {
    let of = IsochoricStretch::of(E);
    let [slope, curvature] = material.derivatives(of.x());
    let inverse = of.inverse();
    let one = of.mean.splat(1.0);
    let scale = of.g() / of.mean;
    let c = material.second_modulus();
    let mut second = SecondDerivative::of_volume(material.volume(), of.ln_J);
    let zero = one.splat(0.0);
    second.add_first(slope, scale, of.mean * 3.0, &[one, one, one, zero, zero, zero]);
    let constant = if c == 0.0 { zero } else { second.add_second(c, &of) };
    let mut D = second.elasticity(&inverse);
    add_dyad(&mut D, curvature, &sym_scaled(of.g() * 2.0, &commuting_product(&inverse, &of.b)));
    if c != 0.0 {
        // I (x) I - 1: the second derivative of I2.
        for a in 0..6 {
            for b in 0..3 {
                if a < 3 && a != b {
                    D[a][b] += constant;
                }
            }
            if a >= 3 {
                D[a][a] += constant * -0.5;
            }
        }
    }
    (stress_of(material, &of, slope, &inverse), D)
}
