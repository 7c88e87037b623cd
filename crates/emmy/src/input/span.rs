//! The times of a step.

/// Times closer together than this part of a step are equal: they differ by rounding.
pub(crate) const SAME_TIME: f64 = 1e-6;

/// The times of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Time at the start.
    pub start: f64,
    /// Step size.
    pub size: f64,
    /// Time at the end: `start + size` but for rounding.
    pub end: f64,
}

impl Span {
    /// A step of a size.
    pub fn new(start: f64, size: f64) -> Self {
        Span { start, size, end: start + size }
    }

    /// A single time.
    pub fn at(time: f64) -> Self {
        Span::new(time, 0.0)
    }

    /// The time at a point alpha in `[0, 1]`.
    pub fn time(&self, alpha: f64) -> f64 {
        if alpha == 1.0 { self.end } else { self.start + alpha * self.size }
    }
}
