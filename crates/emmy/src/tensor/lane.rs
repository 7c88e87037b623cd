//! Numbers at a material point.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number at one material point (`f64`) or at a batch of points in the lanes of a SIMD register.
///
/// All code between the mesh and a material is written once over this trait. Constants are made from an existing number
/// ([`Lane::splat`]), because a SIMD type may carry a proof of the instruction set.
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + Send
    + Sync
    + 'static
{
    /// The constant in every lane.
    fn splat(self, constant: f64) -> Self;
    /// `self * factor + addend`, fused where that is free; operators alone are never fused.
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    /// Square root.
    fn sqrt(self) -> Self;
    /// Logarithm of 1 + self, accurate for small self.
    fn ln_1p(self) -> Self;
    /// `z - ln(1 + z)` without cancellation: a series where z is small.
    ///
    /// ```math
    /// z - ln(1 + z) = z^2 / 2 - z^3 / 3 + z^4 / 4 - ...
    /// ```
    ///
    /// ```
    /// use emmy::internals::tensor::Lane;
    /// let z = 1e-9;
    /// assert!((z.minus_ln_1p() - 0.5e-18 * (1.0 - 2e-9 / 3.0)).abs() < 1e-33);
    /// ```
    #[inline(always)]
    fn minus_ln_1p(self) -> Self {
        // 14 terms reach 1e-17 of the sum at |z| = 0.06; beyond, the direct form has lost less than two digits.
        let mut sum = self.splat(1.0 / 15.0);
        for n in (2..15).rev() {
            sum = (-self).mul_add(sum, self.splat(1.0 / n as f64));
        }
        self.abs().select_below(self.splat(0.06), self * self * sum, self - self.ln_1p())
    }
    /// Exponential less 1, accurate for small self.
    fn exp_m1(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Smaller of two numbers; NaN if either is NaN, so that failures are not lost.
    fn min(self, other: Self) -> Self;
    /// `below` where `self < bound`, `otherwise` elsewhere (also where self is NaN).
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self;
    /// Calls a function compiled for the instruction set of the lanes. Functions behind a table need it, because their
    /// caller cannot inline them.
    #[inline(always)]
    fn vectorize<T>(self, mut function: impl FnMut() -> T) -> T {
        function()
    }
}

impl Lane for f64 {
    #[inline(always)]
    fn splat(self, constant: f64) -> f64 {
        constant
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn ln_1p(self) -> f64 {
        f64::ln_1p(self)
    }
    #[inline(always)]
    fn exp_m1(self) -> f64 {
        f64::exp_m1(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self < other || self.is_nan() { self } else { other }
    }
    #[inline(always)]
    fn select_below(self, bound: f64, below: f64, otherwise: f64) -> f64 {
        if self < bound { below } else { otherwise }
    }
}
