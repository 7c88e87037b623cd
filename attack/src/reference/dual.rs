//! Numbers with six partial derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its derivatives by six variables.
#[derive(Debug, Clone, Copy)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its partial derivatives.
    pub by: [f64; 6],
}

impl Dual {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Dual { value, by: [0.0; 6] }
    }

    /// The variable of a number.
    pub fn variable(value: f64, number: usize) -> Self {
        let mut by = [0.0; 6];
        by[number] = 1.0;
        Dual { value, by }
    }

    /// A function of the number, from its value and derivative there.
    fn chain(self, value: f64, rate: f64) -> Self {
        Dual { value, by: self.by.map(|d| rate * d) }
    }

    /// The natural logarithm.
    pub fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    /// The exponential function.
    pub fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }

    /// The square root.
    pub fn sqrt(self) -> Self {
        self.chain(self.value.sqrt(), 0.5 / self.value.sqrt())
    }

    /// A power with a constant exponent.
    pub fn power(self, exponent: f64) -> Self {
        self.chain(self.value.powf(exponent), exponent * self.value.powf(exponent - 1.0))
    }

    /// The square.
    pub fn square(self) -> Self {
        self * self
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, by: std::array::from_fn(|i| self.by[i] + other.by[i]) }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        other.chain(self.value * other.value, self.value)
            + Dual { value: 0.0, by: self.by.map(|by| by * other.value) }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self * other.chain(1.0 / other.value, -1.0 / (other.value * other.value))
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        Dual { value: self.value + other, by: self.by }
    }
}

impl Sub<f64> for Dual {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        self + -other
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}
