//! The linear system of a Newton iteration with the exact tangent.

use super::approximate_tangent::ApproximateTangent;
use crate::body::{Assembly, Body};
use crate::sparse::LinearSystem;
use crate::time::dissipation::RigidProjection;

/// The linear system of a Newton iteration, on the free degrees of freedom.
pub(crate) struct LinearisedStages<'a> {
    pub body: &'a Body,
    pub assembly: &'a mut Assembly,
    pub approximate_tangent: &'a mut ApproximateTangent,
    pub projection: Option<&'a mut RigidProjection>,
    pub time_scale: f64,
    /// Memory for a right-hand side.
    pub right: &'a mut [f64],
}

impl LinearSystem for LinearisedStages<'_> {
    fn product(&mut self, x: &[f64], y: &mut [f64]) {
        self.assembly.matrix.multiply(self.body.pattern(), x, y);
        if let Some(projection) = &mut self.projection {
            projection.add_derivative(self.body, self.time_scale, x, y);
        }
        self.body.space.clear_inactive(y);
    }

    fn precondition(&mut self, x: &[f64], y: &mut [f64]) {
        match &mut self.projection {
            Some(projection) => {
                self.right.copy_from_slice(x);
                projection.correct(self.body, self.right);
                self.body.space.clear_inactive(self.right);
                self.approximate_tangent.precondition(self.right, y);
            }
            None => self.approximate_tangent.precondition(x, y),
        }
        // A product follows.
        self.body.space.update_guests("preconditioned vector", y);
    }

    fn is_shared(&self) -> bool {
        self.body.space.is_shared()
    }

    fn products(&self, known: &[Vec<f64>], x: &[f64], products: &mut [f64]) {
        self.body.space.dots(known.iter().map(|known| &known[..]).chain([x]), x, products);
    }

    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        self.body.space.dot(x, y)
    }
}
