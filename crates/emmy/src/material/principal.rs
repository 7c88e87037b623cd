//! Principal values and directions of a deformation, and changes of its strains, without iteration.
//!
//! The distortion b is traceless, so its eigenvalues are the roots of
//!
//! ```math
//! beta^3 - q beta - det b = 0,      q = b:b/2
//! beta_1 = 2 sqrt(q/3) cos phi,      beta_(2,3) = -beta_1/2 +- h
//! cos 3 phi = det b/2 (3/q)^(3/2),      h = sqrt(3/2 q c:c) / (3 beta_1^2 - q),      c = b^2 - 2 q/3 I - 3 det b/(2 q) b
//! ```
//!
//! with the root that is farthest from the others first. It is well conditioned, and c, the part of b^2 that is
//! perpendicular to I and b, gives the gap of the other two without cancellation: by 3 (b:b) (c:c), the discriminant.

#![allow(non_snake_case)]

use super::distortion::{Distortion, DistortionChange};
use crate::tensor::{Lane, Mat3, SYM_INDEX, Sym, dot3, double_dot, inlined, sym, sym_add_scaled};

/// q below which its powers leave the range of numbers. Functions of such strains are linear, for which any roots do.
const TINY: f64 = 1e-90;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Principal values of a deformation.
pub(super) struct Principal<L> {
    pub distortion: Distortion<L>,
    /// b^2.
    pub square: Sym<L>,
    /// beta_i.
    pub beta: [L; 3],
    /// h.
    half_gap: L,
    /// `1 / ((beta_1 - beta_2) (beta_1 - beta_3))`, zero if q is tiny.
    pub inverse: L,
}

impl<L: Lane> Principal<L> {
    #[inline(always)]
    pub(super) fn of(E: &Sym<L>) -> Self {
        let distortion = Distortion::of(E);
        let (b, q) = (&distortion.b, distortion.q);
        let zero = q.splat(0.0);
        let one = q.splat(1.0);
        let [size, cosine, inverse_q] = polar(q, distortion.det);
        let far = size * third_cosine(cosine.abs().min(one));
        let far = cosine.select_below(zero, -far, far);
        let inverse = q.select_below(q.splat(TINY), zero, one / (far * far * 3.0 - q));
        let square = distortion.square();
        let mut c = sym_add_scaled(&square, distortion.det * inverse_q * -1.5, b);
        for i in 0..3 {
            c[i] += q * (-2.0 / 3.0);
        }
        let half_gap = (q * double_dot(&c, &c) * 1.5).sqrt() * inverse;
        let mean = far * -0.5;
        Principal { distortion, square, beta: [far, mean + half_gap, mean - half_gap], half_gap, inverse }
    }

    /// Deviatoric logarithmic strains e_i.
    #[inline(always)]
    pub(super) fn strains(&self) -> [L; 3] {
        let mean = self.distortion.ln_det * (1.0 / 3.0);
        let strain = inlined!(|beta: L| (beta.ln_1p() - mean) * 0.5);
        let (second, third) = (strain(self.beta[1]), strain(self.beta[2]));
        [-(second + third), second, third]
    }

    /// Eigenvalues of C^-1.
    #[inline(always)]
    pub(super) fn inverse_stretches(&self) -> [L; 3] {
        let mean = self.distortion.mean;
        let one = mean.splat(1.0);
        let [a, b, c] = [one + self.beta[0], one + self.beta[1], one + self.beta[2]];
        let inverse = one / (mean * a * (b * c));
        [inverse * (b * c), inverse * (a * c), inverse * (a * b)]
    }

    /// The symmetric tensor with the same principal directions and the given eigenvalues: the polynomial in b that
    /// interpolates them.
    ///
    /// The difference of a close pair has lost its digits, but only values between the pair would show it.
    #[inline(always)]
    pub(super) fn tensor(&self, values: &[L; 3]) -> Sym<L> {
        let [far, second, third] = self.beta;
        let zero = far.splat(0.0);
        let gap = self.half_gap * 2.0;
        let equal = far.abs() * 1e-17 + far.splat(f64::MIN_POSITIVE);
        let slope = gap.select_below(equal, zero, (values[1] - values[2]) / gap);
        let curvature = (values[0] - values[2] - slope * (far - third)) * self.inverse;
        let linear = slope + curvature * far;
        let constant = values[1] - slope * second + curvature * second * third;
        let b = &self.distortion.b;
        let component = inlined!(|a: usize| linear.mul_add(b[a], curvature * self.square[a]));
        [
            component(0) + constant,
            component(1) + constant,
            component(2) + constant,
            component(3),
            component(4),
            component(5),
        ]
    }

    /// Principal directions, in columns.
    ///
    /// ```math
    /// (b - beta_2) (b - beta_3) = (beta_1 - beta_2) (beta_1 - beta_3) q_1 q_1^T
    /// ```
    ///
    /// Its largest column is the direction of the far root. One rotation in the plane that is perpendicular to it gives
    /// the others, however close they are.
    #[inline(always)]
    pub(super) fn directions(&self) -> Mat3<L> {
        let b = &self.distortion.b;
        let [far, second, third] = self.beta;
        let (zero, one) = (far.splat(0.0), far.splat(1.0));
        let dyad = sym(
            #[inline(always)]
            |i, j| {
                let a = SYM_INDEX[i][j];
                let sum = far.mul_add(b[a], self.square[a]);
                if i == j { (sum + second * third) * self.inverse } else { sum * self.inverse }
            },
        );
        // A strain that is zero up to rounding has no direction: it gets the first axis.
        let [mut x, mut y, mut z] = [one, zero, zero];
        let mut largest = far.splat(0.25);
        for i in 0..3 {
            let column = inlined!(|j: usize| dyad[SYM_INDEX[i][j]]);
            let keep = inlined!(|old: L, new: L| largest.select_below(dyad[i], new, old));
            (x, y, z) = (keep(x, column(0)), keep(y, column(1)), keep(z, column(2)));
            largest = keep(largest, dyad[i]);
        }
        let length = one / (x * x + y * y + z * z).sqrt();
        let [x, y, z] = [x * length, y * length, z * length];
        // Duff et al. (2017), J. Comput. Graph. Tech. 6: an orthonormal basis with a given vector.
        let side = z.select_below(zero, -one, one);
        let a = -one / (side + z);
        let u = [one + side * x * x * a, side * x * y * a, -side * x];
        let v = [x * y * a, side + y * y * a, -y];
        let row = inlined!(|i: usize, w: &[L; 3]| dot3(
            [b[SYM_INDEX[i][0]], b[SYM_INDEX[i][1]], b[SYM_INDEX[i][2]]],
            *w
        ));
        let of_v = [row(0, &v), row(1, &v), row(2, &v)];
        let (uu, uv, vv) = (dot3(u, [row(0, &u), row(1, &u), row(2, &u)]), dot3(u, of_v), dot3(v, of_v));
        // The larger eigenvalue first: cos 2t and sin 2t of the rotation by t.
        let half = (uu - vv) * 0.5;
        let radius = (half * half + uv * uv).sqrt();
        let cosine = radius.select_below(far.splat(TINY), one, half / radius);
        let sine = radius.select_below(far.splat(TINY), zero, uv / radius);
        let long = ((one + cosine.abs()) * 0.5).sqrt();
        let short = sine / (long * 2.0);
        let (c, s) = (
            cosine.select_below(zero, short.abs(), long),
            cosine.select_below(zero, short.select_below(zero, -long, long), short),
        );
        let second = inlined!(|i: usize| c * u[i] + s * v[i]);
        let third = inlined!(|i: usize| c * v[i] - s * u[i]);
        [[x, second(0), third(0)], [y, second(1), third(1)], [z, second(2), third(2)]]
    }
}

/// `2 sqrt(q/3)`, `cos 3 phi` and 1/q; the last two are zero if q is tiny.
#[inline(always)]
fn polar<L: Lane>(q: L, det: L) -> [L; 3] {
    let inverse = q.select_below(q.splat(TINY), q.splat(0.0), q.splat(1.0) / q);
    let root = inverse.sqrt();
    [q * root * (2.0 / SQRT_3), det * inverse * root * (1.5 * SQRT_3), inverse]
}

/// `cos(phi)` from `cos(3 phi)` in [-1/4, 1], where phi is at most 0.61: the root of `4 y^3 - 3 y = cos 3 phi`.
#[inline(always)]
fn third_cosine<L: Lane>(cosine: L) -> L {
    // The cubic with the values and slopes at 0 and 1 has an error of 7e-4; Halley's step leaves 1e-9, Newton's 1e-17.
    const RISE: f64 = 1.0 - SQRT_3 / 2.0;
    let start = cosine.mul_add(cosine.splat(5.0 / 18.0 - 2.0 * RISE), cosine.splat(3.0 * RISE - 4.0 / 9.0));
    let start = cosine.mul_add(start, cosine.splat(1.0 / 6.0));
    let y = cosine.mul_add(start, cosine.splat(SQRT_3 / 2.0));
    let value = inlined!(|y: L| (y * y * 4.0 - y.splat(3.0)) * y - cosine);
    let slope = inlined!(|y: L| y * y * 12.0 - y.splat(3.0));
    let (f, g) = (value(y), slope(y));
    let y = y - f * g / (g * g - f * y * 12.0);
    y - value(y) / slope(y)
}

/// Change of the strains e_1 and `e_(2,3) = -e_1/2 +- d`, each number without cancellation.
pub(super) struct StrainChange<L> {
    /// Mean of e_2 and e_3, at the start.
    pub mean: L,
    /// Its change.
    pub mean_change: L,
    /// d at the end plus d at the start.
    pub sum: L,
    /// d at the end less d at the start.
    pub difference: L,
}

impl<L: Lane> StrainChange<L> {
    /// ```math
    /// sinh^2 2 d = h^2 / ((1 + beta_2) (1 + beta_3)) = Y,      sinh(2 d' + 2 d) sinh(2 d' - 2 d) = Y' - Y
    /// ```
    #[inline(always)]
    pub(super) fn of(start: &Principal<L>, change: &DistortionChange<L>) -> Self {
        let Distortion { q, ln_det, .. } = start.distortion;
        let (zero, one) = (q.splat(0.0), q.splat(1.0));
        let [far, second, third] = start.beta;
        let rise = far_change(start, change);
        let strain = (far.ln_1p() - ln_det * (1.0 / 3.0)) * 0.5;
        let strain_change = ((rise / (one + far)).ln_1p() - change.ln_det * (1.0 / 3.0)) * 0.5;
        let of_square = rise * (far * 2.0 + rise);
        let product = (one + second) * (one + third);
        let product_change = of_square - rise - change.q;
        let Y = start.half_gap * start.half_gap / product;
        let Y_change = (change.q - of_square * 0.75 - Y * product_change) / (product + product_change);
        let Y_end = Y + Y_change;
        let Y_end = Y_end.select_below(zero, zero, Y_end);
        let sum = (Y * (one + Y_end)).sqrt() + (Y_end * (one + Y)).sqrt();
        // Rounding can make both gaps zero, but not their change.
        let least = Y_change.abs().sqrt() + one * f64::MIN_POSITIVE;
        let sum = sum.select_below(least, least, sum);
        let difference = asinh(Y_change.abs() / sum);
        StrainChange {
            mean: strain * -0.5,
            mean_change: strain_change * -0.5,
            sum: asinh(sum) * 0.5,
            difference: Y_change.select_below(zero, -difference, difference) * 0.5,
        }
    }
}

/// Change of beta_1.
#[inline(always)]
fn far_change<L: Lane>(start: &Principal<L>, change: &DistortionChange<L>) -> L {
    let Distortion { q, det, .. } = start.distortion;
    let far = start.beta[0];
    let (zero, one) = (q.splat(0.0), q.splat(1.0));
    let q_end = q + change.q;
    let [size, cosine, _] = polar(q_end, det + change.det);
    // The same root, unless it has come close to another one.
    let side = det.select_below(zero, -one, one);
    let side = (side * cosine).select_below(q.splat(-0.25), -side, side);
    let end = side * size * third_cosine((side * cosine).min(one));
    // A step of Newton's for the change alone, whose terms are small.
    let rise = end - far;
    let right = change.q * far + change.det;
    let value = rise * (far * far * 3.0 - q_end + rise * (far * 3.0 + rise)) - right;
    let slope = end * end * 3.0 - q_end;
    rise - q_end.select_below(q.splat(TINY), zero, value / slope)
}

/// Inverse hyperbolic sine of a number that is not negative.
#[inline(always)]
fn asinh<L: Lane>(x: L) -> L {
    let one = x.splat(1.0);
    let square = x * x;
    (x + square / (one + (one + square).sqrt())).ln_1p()
}

/// `sinh x` and `cosh x - 1`.
#[inline(always)]
pub(super) fn sinh_cosh_m1<L: Lane>(x: L) -> [L; 2] {
    let rise = x.exp_m1();
    let fall = rise / (rise + x.splat(1.0)); // 1 - e^-x
    [(rise + fall) * 0.5, rise * fall * 0.5]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{Batch, LANES, Packed, Register, SYM};
    use proptest::prelude::*;
    use pulp::{Arch, Simd, WithSimd};

    /// Q diag(beta) Q^T = b and Q^T Q = I, up to a few roundings of the strain.
    fn assert_decomposed(E: &Sym<f64>) {
        let principal = Principal::of(E);
        let Q = principal.directions();
        let size = E.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for (component, (i, j)) in SYM.into_iter().enumerate() {
            let product: f64 = (0..3).map(|k| Q[i][k] * principal.beta[k] * Q[j][k]).sum();
            let error = product - principal.distortion.b[component];
            assert!(error.abs() < 1e-14 * size, "{E:?}: {error:e}");
            let unit: f64 = (0..3).map(|k| Q[k][i] * Q[k][j]).sum();
            assert!((unit - f64::from(u8::from(i == j))).abs() < 2e-15, "{E:?}");
        }
        let tensor = principal.tensor(&principal.beta);
        (0..6).for_each(|a| assert!((tensor[a] - principal.distortion.b[a]).abs() < 1e-14 * size, "{E:?}"));
        assert!(principal.beta[1] >= principal.beta[2]);
    }

    /// Strains with two or three equal eigenvalues.
    const EQUAL: [Sym<f64>; 3] =
        [[0.1, 0.1, 0.1, 0.0, 0.0, 0.0], [0.1, 0.1, -0.2, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.1, 0.1, 0.1]];

    proptest! {
        #[test]
        fn the_distortion_is_put_together_again(
            a in prop::array::uniform6(-0.2..0.2f64), power in -12..1i32,
        ) {
            assert_decomposed(&a);
            assert_decomposed(&a.map(|x| x * 1e-8));
            let scale = 10f64.powi(power);
            for mut near in EQUAL {
                (0..6).for_each(|i| near[i] += scale * a[i]);
                assert_decomposed(&near);
                assert_decomposed(&near.map(|x| -x));
            }
        }
    }

    #[test]
    fn strains_without_a_direction_have_axes() {
        for E in [[0.0; 6], [1e-60; 6], [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]] {
            let Q = Principal::of(&E).directions();
            assert!(Q.iter().flatten().all(|x| x.is_finite()), "{Q:?}");
        }
        assert_decomposed(&[0.1, -0.05, -0.05, 0.0, 0.0, 0.0]);
        assert_decomposed(&[-0.05, 0.1, -0.05, 0.0, 0.0, 0.0]);
        assert!(Principal::of(&[f64::NAN; 6]).directions()[0][1].is_nan());
    }

    /// Sum over the principal values and directions of the point in the first lane.
    struct First([Packed; 6]);

    impl WithSimd for First {
        type Output = u64;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> u64 {
            let zero = Batch::new(simd, 0.0);
            let principal = Principal::of(&[0, 1, 2, 3, 4, 5].map(|a| zero.load(&self.0[a], 0)));
            let (Q, e) = (principal.directions(), principal.strains());
            let mut sum = dot3(Q[0], Q[1]);
            for i in 0..3 {
                sum += dot3(Q[i], e) + principal.beta[i];
            }
            let mut result = Packed([0.0; LANES]);
            sum.store(&mut result, 0);
            result.0[0].to_bits()
        }
    }

    #[test]
    fn a_point_does_not_depend_on_its_neighbours() {
        let E = [0.1, -0.05, 0.02, 0.03, -0.01, 0.04];
        let first = |neighbour: Sym<f64>| {
            let lane = |a: usize, lane: usize| if lane == 0 { E[a] } else { neighbour[a] };
            let packed = |a: usize| Packed(std::array::from_fn(|n| lane(a, n)));
            Arch::new().dispatch(First([0, 1, 2, 3, 4, 5].map(packed)))
        };
        let others =
            [[0.0; 6], [f64::NAN; 6], [9.0, 1.0, 1.0, 0.0, 0.0, 0.0], [-0.4, 0.3, 0.0, 0.0, 0.1, 0.0]];
        for neighbour in others {
            assert_eq!(first(neighbour), first(E));
        }
    }
}
