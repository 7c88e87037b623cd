//! Batches of points in the lanes of a SIMD register of the instruction set found at run time.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use pulp::{Simd, WithSimd};

use super::Lane;

/// Points of a batch: the number of lanes of the widest register. Narrower ones process a batch in parts.
pub const LANES: usize = 8;

/// One number for each point of a batch, in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))] // no register's load crosses a cache line
pub struct Packed(pub [f64; LANES]);

/// A lane type that is loaded from batches: it holds `WIDTH` points, and `LANES / WIDTH` registers cover a batch.
pub trait Register: Lane {
    /// Number of points.
    const WIDTH: usize;
    /// Part `part` of a batch, in `0..LANES / WIDTH`.
    fn load(self, from: &Packed, part: usize) -> Self;
    /// Writes part `part` of a batch.
    fn store(self, to: &mut Packed, part: usize);
}

impl Register for f64 {
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(self, from: &Packed, part: usize) -> f64 {
        from.0[part]
    }
    #[inline(always)]
    fn store(self, to: &mut Packed, part: usize) {
        to.0[part] = self;
    }
}

/// The points in one register of the instruction set `S`.
///
/// Every function called from a dispatched one must be inlined into it; otherwise it is compiled for the oldest
/// instruction set.
///
/// ```
/// use emmy::internals::tensor::{Batch, Lane, Packed, Register};
/// struct Halves;
/// impl pulp::WithSimd for Halves {
///     type Output = f64;
///     fn with_simd<S: pulp::Simd>(self, simd: S) -> f64 {
///         let mut memory = Packed([8.0; 8]);
///         (Batch::new(simd, 8.0) * 0.5).store(&mut memory, 0);
///         memory.0[0]
///     }
/// }
/// assert_eq!(pulp::Arch::new().dispatch(Halves), 4.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Batch<S: Simd> {
    simd: S,
    lanes: S::f64s,
}

impl<S: Simd> Batch<S> {
    /// The constant in every lane.
    #[inline(always)]
    pub fn new(simd: S, constant: f64) -> Self {
        Batch { simd, lanes: simd.splat_f64s(constant) }
    }

    #[inline(always)]
    fn with(self, lanes: S::f64s) -> Self {
        Batch { simd: self.simd, lanes }
    }

    /// `below` where the first number is less than the second, `otherwise` elsewhere.
    #[inline(always)]
    fn select(self, mask: S::m64s, yes: Self, no: Self) -> Self {
        self.with(self.simd.select_f64s(mask, yes.lanes, no.lanes))
    }

    #[inline(always)]
    fn is_any(self, mask: S::m64s) -> bool {
        self.simd.first_true_m64s(mask) < S::F64_LANES
    }

    /// Lanes outside the bounds, NaN included.
    #[inline(always)]
    fn outside(self, lower: f64, upper: f64) -> S::m64s {
        let simd = self.simd;
        let above = simd.less_than_or_equal_f64s(simd.splat_f64s(lower), self.lanes);
        let below = simd.less_than_or_equal_f64s(self.lanes, simd.splat_f64s(upper));
        simd.not_m64s(simd.and_m64s(above, below))
    }

    /// Sum of `coefficients[n] self^n`, with separate sums of even and odd terms.
    #[inline(always)]
    fn polynomial(self, coefficients: &[f64]) -> Self {
        let square = self * self;
        let (rest, last) = coefficients.split_at((coefficients.len() - 1) / 2 * 2);
        let mut even = self.splat(last[0]);
        let mut odd = self.splat(last.get(1).copied().unwrap_or(0.0));
        for pair in rest.as_chunks::<2>().0.iter().rev() {
            even = even.mul_add(square, self.splat(pair[0]));
            odd = odd.mul_add(square, self.splat(pair[1]));
        }
        odd.mul_add(self, even)
    }

    /// A function of numbers, lane by lane.
    #[inline(always)]
    fn each(self, function: impl Fn(f64) -> f64) -> Self {
        let mut memory = Packed([0.0; LANES]);
        self.store(&mut memory, 0);
        memory.0[..S::F64_LANES].iter_mut().for_each(
            #[inline(always)]
            |x| *x = function(*x),
        );
        self.load(&memory, 0)
    }

    /// x and n with `self = 2^n x` and x between the roots of 1/2 and 2, for positive numbers.
    #[inline(always)]
    fn scaled(self) -> (Self, Self) {
        let mut x = self;
        let mut n = self.splat(0.0);
        for power in [512, 256, 128, 64, 32, 16, 8, 4, 2, 1] {
            let scale = 2f64.powi(power);
            let bound = 2f64.powi(power) * std::f64::consts::FRAC_1_SQRT_2;
            let power = self.splat(f64::from(power));
            let is_large = self.simd.greater_than_f64s(x.lanes, self.simd.splat_f64s(bound));
            (x, n) = (self.select(is_large, x * scale.recip(), x), self.select(is_large, n + power, n));
            let is_small = self.simd.less_than_f64s(x.lanes, self.simd.splat_f64s(bound.recip()));
            (x, n) = (self.select(is_small, x * scale, x), self.select(is_small, n - power, n));
        }
        (x, n)
    }

    /// ln(1 + z) where z is not close to zero.
    #[inline(always)]
    fn ln_1p_of_any(self) -> Self {
        let simd = self.simd;
        let one = self.splat(1.0);
        let y = self + one;
        let (x, n) = y.scaled();
        // The rounding of a small z in 1 + z.
        let lost = (self - (y - one)) / y;
        let lost = lost.abs().select_below(one, lost, self.splat(0.0));
        let ln = n.mul_add(self.splat(std::f64::consts::LN_2), (x - one).ln_1p_of_small() + lost);
        let ln = self.select(simd.less_than_f64s(y.lanes, simd.splat_f64s(0.0)), self.splat(f64::NAN), ln);
        let is_zero = simd.equal_f64s(y.lanes, simd.splat_f64s(0.0));
        let ln = self.select(is_zero, self.splat(f64::NEG_INFINITY), ln);
        let is_infinite = simd.equal_f64s(y.lanes, simd.splat_f64s(f64::INFINITY));
        self.select(is_infinite, self.splat(f64::INFINITY), ln)
    }

    /// ```math
    /// ln(1 + z) = 2 artanh(s) = 2 (s + s^3/3 + s^5/5 + ...),    s = z / (2 + z)
    /// ```
    #[inline(always)]
    fn ln_1p_of_small(self) -> Self {
        let (s, rest) = self.artanh();
        rest.mul_add(s, s + s)
    }

    /// s, and the series without its first term, divided by s.
    #[inline(always)]
    fn artanh(self) -> (Self, Self) {
        // |s| <= 0.172: the omitted terms are below 1e-18 of the sum.
        let s = self / (self + self.splat(2.0));
        let square = s * s;
        (s, (square + square) * square.polynomial(&ARTANH))
    }
}

/// Bounds within which ln(1 + z) is taken from its series: 1 + z between the roots of 1/2 and 2.
const LN_BOUNDS: [f64; 2] = [std::f64::consts::FRAC_1_SQRT_2 - 1.0, std::f64::consts::SQRT_2 - 1.0];

/// Bound within which e^x - 1 is taken from its series, after halving x twice.
const EXP_BOUND: f64 = 1.4;

/// `1 / (2 n + 3)`.
const ARTANH: [f64; 11] = {
    let mut terms = [0.0; 11];
    let mut n = 0;
    while n < terms.len() {
        terms[n] = 1.0 / (2 * n + 3) as f64;
        n += 1;
    }
    terms
};

/// `1 / (n + 2)!`.
const EXP: [f64; 14] = {
    let mut terms = [0.0; 14];
    let mut term = 1.0;
    let mut n = 0;
    while n < terms.len() {
        term /= (n + 2) as f64;
        terms[n] = term;
        n += 1;
    }
    terms
};

macro_rules! operator {
    ($trait:ident, $method:ident, $function:ident) => {
        impl<S: Simd> $trait for Batch<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$function(self.lanes, other.lanes))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Batch<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.lanes))
    }
}

impl<S: Simd> Mul<f64> for Batch<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * self.splat(factor)
    }
}

impl<S: Simd> AddAssign for Batch<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> Register for Batch<S> {
    const WIDTH: usize = S::F64_LANES;
    #[inline(always)]
    fn load(self, from: &Packed, part: usize) -> Self {
        self.with(S::as_simd_f64s(&from.0).0[part])
    }
    #[inline(always)]
    fn store(self, to: &mut Packed, part: usize) {
        S::as_mut_simd_f64s(&mut to.0).0[part] = self.lanes;
    }
}

impl<S: Simd> Lane for Batch<S> {
    #[inline(always)]
    fn splat(self, constant: f64) -> Self {
        Batch::new(self.simd, constant)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self.with(self.simd.mul_add_e_f64s(self.lanes, factor.lanes, addend.lanes))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.lanes))
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        let near = self.ln_1p_of_small();
        let is_far = self.outside(LN_BOUNDS[0], LN_BOUNDS[1]);
        // Lane by lane, so that no point depends on its neighbours.
        if self.is_any(is_far) { self.select(is_far, self.ln_1p_of_any(), near) } else { near }
    }
    /// ```math
    /// z - ln(1 + z) = s (z - 2 (s^2/3 + s^4/5 + ...)),    s = z / (2 + z)
    /// ```
    #[inline(always)]
    fn minus_ln_1p(self) -> Self {
        let (s, rest) = self.artanh();
        let near = s * (self - rest);
        let is_far = self.outside(LN_BOUNDS[0], LN_BOUNDS[1]);
        if self.is_any(is_far) { self.select(is_far, self - self.ln_1p_of_any(), near) } else { near }
    }
    /// ```math
    /// e^2x - 1 = (e^x - 1) (2 + (e^x - 1))
    /// ```
    #[inline(always)]
    fn exp_m1(self) -> Self {
        // |x| <= 0.35: 14 terms reach 1e-17 of the sum; two doublings lose less than two digits of the last place.
        let x = self * 0.25;
        let two = self.splat(2.0);
        let quarter = (x * x).mul_add(x.polynomial(&EXP), x);
        let half = quarter * (two + quarter);
        let near = half * (two + half);
        let is_far = self.outside(-EXP_BOUND, EXP_BOUND);
        if self.is_any(is_far) { self.select(is_far, self.each(f64::exp_m1), near) } else { near }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self.simd.abs_f64s(self.lanes))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let simd = self.simd;
        let a = self.lanes;
        let b = other.lanes;
        let is_number = simd.equal_f64s(a, a);
        self.select(simd.or_m64s(simd.less_than_f64s(a, b), simd.not_m64s(is_number)), self, other)
    }
    #[inline(always)]
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        self.select(self.simd.less_than_f64s(self.lanes, bound.lanes), below, otherwise)
    }
    #[inline(always)]
    fn vectorize<T>(self, function: impl FnMut() -> T) -> T {
        self.simd.vectorize(Call(function))
    }
}

/// A function to be called in the instruction set of registers. Not `FnOnce`: a closure that could be called again
/// would be compiled as a separate function, not inlined.
struct Call<F>(F);

impl<T, F: FnMut() -> T> WithSimd for Call<F> {
    type Output = T;
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> T {
        (self.0)()
    }
}

#[cfg(test)]
mod tests;
