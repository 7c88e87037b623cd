//! Dual numbers as lanes: exact derivatives of the materials.

use num_dual::Dual64;

use crate::tensor::Lane;

impl Lane for Dual64 {
    fn splat(self, constant: f64) -> Self {
        Dual64::from_re(constant)
    }
    fn sqrt(self) -> Self {
        num_dual::DualNum::sqrt(&self)
    }
    fn ln_1p(self) -> Self {
        num_dual::DualNum::ln_1p(&self)
    }
    fn exp_m1(self) -> Self {
        num_dual::DualNum::exp_m1(&self)
    }
    fn abs(self) -> Self {
        if self.re < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if self.re < other.re || self.re.is_nan() { self } else { other }
    }
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        if self.re < bound.re { below } else { otherwise }
    }
}
