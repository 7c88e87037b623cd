//! Numbers of the iterative solvers: `f32` if the solution is corrected later, `f64` otherwise.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use wide::{f32x4, f64x4};

/// A real number type.
pub(crate) trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// Four numbers in one register.
    type Four: Copy + Add<Output = Self::Four> + Mul<Output = Self::Four> + AddAssign;
    /// A register of four numbers.
    fn four(values: [Self; 4]) -> Self::Four;
    /// The numbers of a register.
    fn array(four: Self::Four) -> [Self; 4];
    /// The nearest number of the type.
    fn of(value: f64) -> Self;
    /// The number as `f64`.
    fn wide(self) -> f64;
}

impl Real for f32 {
    type Four = f32x4;
    #[inline(always)]
    fn four(values: [f32; 4]) -> f32x4 {
        f32x4::new(values)
    }
    #[inline(always)]
    fn array(four: f32x4) -> [f32; 4] {
        four.to_array()
    }
    #[inline(always)]
    fn of(value: f64) -> f32 {
        value as f32
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    type Four = f64x4;
    #[inline(always)]
    fn four(values: [f64; 4]) -> f64x4 {
        f64x4::new(values)
    }
    #[inline(always)]
    fn array(four: f64x4) -> [f64; 4] {
        four.to_array()
    }
    #[inline(always)]
    fn of(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
}
