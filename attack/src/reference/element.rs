//! Time elements: their points and weights, and how they average forces.

use super::numbers::{Matrix, gauss, lagrange, lagrange_integral};

/// How a time element averages forces.
#[derive(Debug, Clone)]
pub enum Average {
    /// At points of the step.
    Points(Vec<(f64, f64)>),
    /// Assumed strain, with a number of inner points.
    Assumed(usize),
    /// Discrete gradient.
    Gradient,
}

/// A time element.
#[derive(Debug, Clone)]
pub struct Element {
    /// Gauss points.
    pub c: Vec<f64>,
    /// Weights.
    pub b: Vec<f64>,
    /// Integrals of the Lagrange polynomials up to the points.
    pub a: Matrix,
    /// Averages of forces.
    pub average: Average,
    /// `(beta, p_i)` of numerical dissipation.
    pub dissipation: Option<(f64, Vec<f64>)>,
}

impl Element {
    /// The element of a degree.
    pub fn new(degree: usize, average: Average, spectral_radius: Option<f64>) -> Self {
        let (c, b): (Vec<f64>, Vec<f64>) = gauss(degree).into_iter().unzip();
        let a = c.iter().map(|&x| (0..degree).map(|j| lagrange_integral(&c, j, x)).collect()).collect();
        let root = ((2 * degree - 1) as f64).sqrt();
        let polynomial = |x: f64| match degree {
            1 => 1.0,
            2 => root * (2.0 * x - 1.0),
            _ => root * (6.0 * x * x - 6.0 * x + 1.0),
        };
        let dissipation = spectral_radius.map(|rho| {
            let chi = (1.0 - rho) / (1.0 + rho);
            (chi / (2 * (2 * degree - 1)) as f64, c.iter().map(|&x| polynomial(x)).collect())
        });
        Element { c, b, a, average, dissipation }
    }

    /// Lagrange polynomial i over its weight.
    pub(super) fn weighted(&self, i: usize, alpha: f64) -> f64 {
        lagrange(&self.c, i, alpha) / self.b[i]
    }

    /// A path at a fraction of the step.
    pub fn path(&self, start: &[f64], rates: &[Vec<f64>], alpha: f64) -> Vec<f64> {
        let mut at = start.to_vec();
        for (j, rate) in rates.iter().enumerate() {
            let integral = lagrange_integral(&self.c, j, alpha);
            at.iter_mut().zip(rate).for_each(|(sum, x)| *sum += integral * x);
        }
        at
    }
}
