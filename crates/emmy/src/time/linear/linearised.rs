//! The linear system of a Newton iteration with the exact tangent.

use super::approximate_tangent::ApproximateTangent;
use super::border::Border;
use crate::body::{Assembly, Body};
use crate::sparse::LinearSystem;
use crate::time::scheme_force::SchemeForce;

/// The linear system of a Newton iteration, on the free degrees of freedom.
pub(crate) struct LinearisedStages<'a> {
    pub body: &'a Body,
    pub assembly: &'a mut Assembly,
    pub approximate_tangent: &'a mut ApproximateTangent,
    pub scheme_force: &'a mut SchemeForce,
    /// Constraints; their multipliers follow the rates in all vectors.
    pub border: &'a mut Border,
    pub time_scale: f64,
    /// Memory for a right-hand side.
    pub right: &'a mut [f64],
}

impl LinearSystem for LinearisedStages<'_> {
    fn product(&mut self, x: &[f64], y: &mut [f64]) {
        let n_rates = self.right.len();
        let (x, multipliers) = x.split_at(n_rates);
        let (y, rows) = y.split_at_mut(n_rates);
        self.assembly.matrix.multiply(self.body.pattern(), x, y);
        self.scheme_force.add_derivative(self.body, self.time_scale, x, y);
        if !multipliers.is_empty() {
            self.border.add_product((x, multipliers), (y, rows));
        }
        self.body.space.clear_inactive(y);
    }

    fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
        let LinearisedStages { body, approximate_tangent, scheme_force, border, right, .. } = self;
        let n_rates = right.len();
        let (y, multipliers) = y.split_at_mut(n_rates);
        let mut precondition = |x: &[f64], y: &mut [f64]| {
            right.copy_from_slice(x);
            scheme_force.correct(body, right);
            approximate_tangent.precondition(right, y);
        };
        precondition(&x[..n_rates], y);
        if !multipliers.is_empty() {
            multipliers.copy_from_slice(&x[n_rates..]);
            let solve = |x: &[f64], y: &mut [f64], _: f64| {
                precondition(x, y);
                Ok(1)
            };
            // A singular border leaves a preconditioner without it.
            if border.solve(solve, 0.0, y, multipliers).is_err() {
                multipliers.fill(0.0);
            }
        }
        // A product follows.
        body.space.complete("preconditioned vector", y);
    }

    fn is_shared(&self) -> bool {
        self.body.space.is_shared()
    }

    fn products(&self, known: &[Vec<f64>], x: &[f64], products: &mut [f64]) {
        self.body.space.dots(known.iter().map(|known| &known[..]).chain([x]), x, products);
    }

    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        let n_rates = self.right.len();
        let ((x, of_x), (y, of_y)) = (x.split_at(n_rates), y.split_at(n_rates));
        self.body.space.dot(x, y) + of_x.iter().zip(of_y).map(|(x, y)| x * y).sum::<f64>()
    }
}
