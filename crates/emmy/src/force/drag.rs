//! Drag of a surrounding medium.

use super::interface::{Book, Force, ForceMemory, Side};
use super::step::StepStart;
use crate::error::Result;

/// An external force `-rate M v`.
#[derive(Debug)]
pub(crate) struct Drag {
    /// \[1/time\].
    pub rate: f64,
}

impl Force for Drag {
    fn book(&self) -> Book {
        Book::Dissipated
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    /// It is a part of the inertia.
    fn begin(&self, _: &StepStart<'_>, _: &mut ForceMemory, _: &mut [f64]) -> Result<bool> {
        Ok(false)
    }

    fn momentum_rate(&self) -> f64 {
        self.rate
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("viscosity and drag are not covered")
    }
}
