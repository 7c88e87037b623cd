//! Drag of a surrounding medium.

use super::interface::{Book, Force, Side};

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

    fn momentum_rate(&self) -> f64 {
        self.rate
    }

    fn dissipates(&self) -> bool {
        true
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("viscosity and drag are not covered")
    }
}
