//! Vector fields over position and time.

use std::fmt;
use std::sync::Arc;

/// A vector field over reference position and time.
///
/// ```
/// use emmy::body::Field;
/// let wave = Field::new(|X, t| [0.0, (X[0] - 2.0 * t).sin(), 0.0]);
/// assert_eq!(wave.at([2.0, 0.0, 0.0], 1.0), [0.0; 3]);
/// ```
#[derive(Clone)]
pub struct Field {
    text: Arc<str>,
    function: Arc<Function>,
}

type Function = dyn Fn([f64; 3], f64) -> [f64; 3] + Send + Sync;

impl Field {
    /// The field of a function of reference position and time.
    pub fn new(function: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Field::named("", function)
    }

    /// The field of a function with a text that messages call it by; fields with equal texts count as equal.
    ///
    /// ```
    /// use emmy::body::Field;
    /// assert_eq!(Field::named("0, 0, t", |_, t| [0.0, 0.0, t]).text(), "0, 0, t");
    /// ```
    pub fn named(text: &str, function: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Field { text: text.into(), function: Arc::new(function) }
    }

    /// Text of the field; empty for one without.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The vector at a reference position and time.
    pub fn at(&self, X: [f64; 3], time: f64) -> [f64; 3] {
        (self.function)(X, time)
    }
}

impl fmt::Debug for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Field").field(&self.text).finish()
    }
}

/// Fields are equal if they are the same function or have the same text, not if they have the same values.
impl PartialEq for Field {
    fn eq(&self, other: &Field) -> bool {
        Arc::ptr_eq(&self.function, &other.function) || (!self.text.is_empty() && self.text == other.text)
    }
}
