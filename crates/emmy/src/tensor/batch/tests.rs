//! Every operation of a batch against `f64`, with and without the vector instructions of this machine.

use super::*;
use proptest::prelude::*;
use pulp::{Arch, WithSimd};

/// A function of three numbers in the registers of the best instruction set, for eight points.
struct Apply<F>(F, [Packed; 3]);

/// The function, generic over the lane type.
trait Function {
    fn of<L: Lane>(&self, x: [L; 3]) -> L;
}

impl<F: Function> WithSimd for Apply<F> {
    type Output = [f64; LANES];
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; LANES] {
        let mut result = Packed([0.0; LANES]);
        let zero = Batch::new(simd, 0.0);
        for part in 0..LANES / S::F64_LANES {
            let x = [0, 1, 2].map(|n| zero.load(&self.1[n], part));
            self.0.of(x).store(&mut result, part);
        }
        result.0
    }
}

/// Registers of every available instruction set against numbers: the largest relative difference.
fn difference<F: Function + Copy>(function: F, x: [[f64; LANES]; 3]) -> f64 {
    let results = [Arch::new(), Arch::Scalar].map(|arch| arch.dispatch(Apply(function, x.map(Packed))));
    let mut largest = 0f64;
    for lane in 0..LANES {
        let expected = function.of([x[0][lane], x[1][lane], x[2][lane]]);
        for result in &results {
            let value = result[lane];
            let is_same = value == expected || value.is_nan() && expected.is_nan();
            let difference = if is_same { 0.0 } else { ((value - expected) / expected).abs() };
            assert!(!difference.is_nan(), "{value} is not {expected} at {}", x[0][lane]);
            largest = largest.max(difference);
        }
    }
    largest
}

macro_rules! function {
    ($name:ident, |$a:ident, $b:ident, $c:ident| $body:expr) => {
        #[derive(Clone, Copy)]
        struct $name;
        impl Function for $name {
            #[inline(always)]
            fn of<L: Lane>(&self, [$a, $b, $c]: [L; 3]) -> L {
                let _ = ($b, $c);
                $body
            }
        }
    };
}

function!(Operators, |a, b, c| -(a + b) * c / (a - b) * 3.0);
function!(Root, |a, b, c| a.abs().sqrt());
function!(Smaller, |a, b, c| a.min(b));
function!(Chosen, |a, b, c| a.select_below(b, c, a));
function!(Logarithm, |a, b, c| a.ln_1p());
function!(LessLogarithm, |a, b, c| a.minus_ln_1p());
function!(Exponential, |a, b, c| a.exp_m1());

fn numbers() -> impl Strategy<Value = [[f64; LANES]; 3]> {
    let number = prop_oneof![-3.0..3.0f64, Just(f64::NAN), Just(1.0), Just(f64::INFINITY)];
    prop::array::uniform3(prop::array::uniform8(number))
}

proptest! {
    #[test]
    fn operations_match_plain_numbers(x in numbers()) {
        prop_assert_eq!(difference(Operators, x), 0.0);
        prop_assert_eq!(difference(Root, x), 0.0);
        prop_assert_eq!(difference(Smaller, x), 0.0);
        prop_assert_eq!(difference(Chosen, x), 0.0);
    }

    #[test]
    fn functions_have_a_few_roundings(
        x in prop::array::uniform8(-1.0..1.0f64), exponent in prop::array::uniform8(-300..300i32),
    ) {
        let mut z = x;
        z.iter_mut().zip(exponent).for_each(|(z, exponent)| *z *= 10f64.powi(exponent / 2));
        let positive = z.map(f64::abs);
        for argument in [x, positive, x.map(|x| 0.5 * x), x.map(|x| -x.abs())] {
            let error = difference(Logarithm, [argument; 3]);
            prop_assert!(error < 4.0 * f64::EPSILON, "{error:e} at {argument:?}");
            // The direct form, used by numbers from 0.06 on, loses up to two digits.
            let error = difference(LessLogarithm, [argument; 3]);
            prop_assert!(error < 64.0 * f64::EPSILON, "{error:e} at {argument:?}");
        }
        for argument in [x, x.map(|x| 1.4 * x), x.map(|x| 700.0 * x), x.map(|x| 1e-9 * x)] {
            let error = difference(Exponential, [argument; 3]);
            prop_assert!(error < 8.0 * f64::EPSILON, "{error:e} at {argument:?}");
        }
    }
}

#[test]
fn functions_at_their_limits_match_plain_numbers() {
    let limits = [-1.0, -1.0 + 1.2e-16, -1.5, f64::INFINITY, 1e300, f64::NAN, 1e-300, -0.0];
    assert!(difference(Logarithm, [limits; 3]) < 4.0 * f64::EPSILON);
    let roots = [0.41421356, 0.41421357, -0.29289321, -0.29289322, 1.0, 3.0, -0.5, -1e-300];
    assert!(difference(Logarithm, [roots; 3]) < 4.0 * f64::EPSILON);
    assert!(
        difference(LessLogarithm, [limits.map(|z| if z.abs() > 1e-200 { z } else { 0.5 }); 3])
            < 8.0 * f64::EPSILON
    );
    assert!(
        difference(LessLogarithm, [roots.map(|z| if z.abs() > 1e-200 { z } else { 0.0 }); 3])
            < 8.0 * f64::EPSILON
    );
    let limits = [-1e3, 1e3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, 1e-300, -1.4];
    assert!(difference(Exponential, [limits; 3]) < 8.0 * f64::EPSILON);
}

#[test]
fn a_point_does_not_depend_on_its_neighbours() {
    let of = |z: [f64; LANES]| Arch::new().dispatch(Apply(Logarithm, [Packed(z); 3]))[0];
    assert_eq!(of([0.1; 8]), of([0.1, 1e9, -2.0, f64::NAN, 7.0, 0.0, 0.0, 0.0]));
}
