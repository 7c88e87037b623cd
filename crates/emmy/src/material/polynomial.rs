//! Polynomials in I1bar - 3, for several models.

use crate::tensor::Lane;

/// `c_1 x + c_2 x^2 + ... + c_N x^N`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Polynomial<const N: usize>(pub [f64; N]);

impl<const N: usize> Polynomial<N> {
    /// Its value.
    #[inline(always)]
    pub(super) fn value<L: Lane>(&self, x: L) -> L {
        let mut sum = x.splat(0.0);
        for &c in self.0.iter().rev() {
            sum = (sum + x.splat(c)) * x;
        }
        sum
    }

    /// Its value at `x + dx` less that at x, without cancellation.
    #[inline(always)]
    pub(super) fn change<L: Lane>(&self, x: L, dx: L) -> L {
        let end = x + dx;
        let (mut value, mut quotient) = (x.splat(0.0), x.splat(0.0));
        for &c in self.0.iter().rev() {
            quotient = quotient * end + (value + x.splat(c));
            value = (value + x.splat(c)) * x;
        }
        quotient * dx
    }

    /// Its first and second derivative.
    #[inline(always)]
    pub(super) fn derivatives<L: Lane>(&self, x: L) -> [L; 2] {
        let (mut first, mut second) = (x.splat(0.0), x.splat(0.0));
        for (n, &c) in self.0.iter().enumerate().rev() {
            let n = n as f64 + 1.0;
            first = first * x + x.splat(n * c);
            if n > 1.0 {
                second = second * x + x.splat(n * (n - 1.0) * c);
            }
        }
        [first, second]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_derivatives_match_the_powers() {
        let polynomial = Polynomial([2.0, -3.0, 5.0]);
        assert_eq!(polynomial.value(2.0), 4.0 - 12.0 + 40.0);
        assert_eq!(polynomial.change(2.0, 1.0), 6.0 - 27.0 + 135.0 - polynomial.value(2.0));
        assert_eq!(polynomial.derivatives(2.0), [2.0 - 12.0 + 60.0, -6.0 + 60.0]);
    }
}
