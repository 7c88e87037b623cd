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
    /// Whether a call is costly: it is called as rarely as possible.
    is_costly: bool,
}

/// Sets the vectors at reference positions and a time.
type Function = dyn Fn(&[[f64; 3]], f64, &mut [[f64; 3]]) + Send + Sync;

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
        let field = Field::of_points(text, move |points, time, values| {
            values.iter_mut().zip(points).for_each(|(value, &X)| *value = function(X, time));
        });
        Field { is_costly: false, ..field }
    }

    /// The field of a function of many points at once, where calls are expensive: it sets the vector at each reference
    /// position, all at one time. A load calls it once for a time, with all of its points. The check that the steps
    /// resolve a field compares this one on two panels a step only. `text` as in [`Field::named`].
    ///
    /// A step in which a vector is not finite fails with [`crate::Error::NotFiniteAt`]; vectors that the function does
    /// not set are NaN.
    ///
    /// ```
    /// use emmy::body::Field;
    /// let shear = Field::of_points("t*y, 0, 0", |points, t, values| {
    ///     values.iter_mut().zip(points).for_each(|(value, X)| *value = [t * X[1], 0.0, 0.0]);
    /// });
    /// assert_eq!(shear.at([5.0, 3.0, 1.0], 2.0), [6.0, 0.0, 0.0]);
    /// ```
    pub fn of_points(
        text: &str,
        function: impl Fn(&[[f64; 3]], f64, &mut [[f64; 3]]) + Send + Sync + 'static,
    ) -> Self {
        Field { text: text.into(), function: Arc::new(function), is_costly: true }
    }

    /// Whether a call is costly.
    pub(crate) fn is_costly(&self) -> bool {
        self.is_costly
    }

    /// Text of the field; empty for one without.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The vector at a reference position and time.
    pub fn at(&self, X: [f64; 3], time: f64) -> [f64; 3] {
        let mut value = [[0.0; 3]];
        self.set_at(&[X], time, &mut value);
        value[0]
    }

    /// Sets the vectors at reference positions and a time.
    pub(crate) fn set_at(&self, points: &[[f64; 3]], time: f64, values: &mut [[f64; 3]]) {
        values.fill([f64::NAN; 3]);
        (self.function)(points, time, values);
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
