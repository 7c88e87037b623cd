//! Numbers in messages.

use std::borrow::Borrow;

/// A number with at most six significant digits and without trailing zeros; with an exponent outside of 1e-4 to 1e6.
///
/// ```
/// use emmy::internals::number::short;
/// assert_eq!(short(0.00045000000000000004), "0.00045");
/// assert_eq!(short(9.497169926235665e-8), "9.49717e-8");
/// assert_eq!(short(-1234567.0), "-1.23457e6");
/// ```
pub fn short(value: impl Borrow<f64>) -> String {
    let value: &f64 = value.borrow();
    let value = *value;
    if !value.is_finite() {
        return value.to_string();
    }
    // Rounding comes first: it may carry into another digit.
    let rounded = format!("{value:.5e}");
    let (digits, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value != 0.0 && !(-4..6).contains(&exponent) {
        return format!("{}e{exponent}", trimmed(digits));
    }
    let text = format!("{value:.*}", (5 - exponent).max(0) as usize);
    match trimmed(&text) {
        "-0" => "0".to_string(),
        digits => digits.to_string(),
    }
}

/// As [`short`], but rounded down, for limits that must not be exceeded.
///
/// ```
/// use emmy::internals::number::{short, short_below};
/// assert_eq!((short(2.0 / 3.0), short_below(2.0 / 3.0)), ("0.666667".into(), "0.666666".into()));
/// ```
pub fn short_below(value: f64) -> String {
    let rounded = short(value);
    if rounded.parse().is_ok_and(|rounded: f64| rounded <= value) {
        return rounded;
    }
    let last_digit = 10f64.powi(value.abs().log10().floor() as i32 - 5);
    short(value - last_digit)
}

/// The components of a vector in brackets, each by [`short`].
pub fn short_vector(vector: impl Borrow<[f64; 3]>) -> String {
    let vector: &[f64; 3] = vector.borrow();
    format!("[{}]", vector.map(short).join(", "))
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_are_shown_and_no_zeros_behind_them() {
        let numbers = [0.0, -0.0, 58.49999999999, -1.5, 100.0, 0.3, 999999.0, 0.0001, 0.1 + 0.2];
        let texts = ["0", "0", "58.5", "-1.5", "100", "0.3", "999999", "0.0001", "0.3"];
        assert_eq!(numbers.map(short), texts);
    }

    #[test]
    fn limits_are_not_rounded_up() {
        for value in [0.123_456_7, 0.123_456_4, 9.999_999_9e-7, 1.0, 3e5, 2.0 / 3.0, 1e-300 / 3.0] {
            let shown: f64 = short_below(value).parse().unwrap();
            assert!(shown <= value && shown > value * (1.0 - 2e-5), "{value:e}: {shown:e}");
        }
    }

    #[test]
    fn numbers_out_of_range_have_an_exponent() {
        let numbers = [1e6, 999999.7, 0.00009999994, 0.000099999996, 1e-300, 1.25e12, -1e-12];
        let texts = ["1e6", "1e6", "9.99999e-5", "0.0001", "1e-300", "1.25e12", "-1e-12"];
        assert_eq!(numbers.map(short), texts);
        assert_eq!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(short), ["NaN", "inf", "-inf"]);
    }

    #[test]
    fn vectors_stand_in_brackets() {
        assert_eq!(short_vector([0.0, 1e20, 1.0 / 3.0]), "[0, 1e20, 0.333333]");
    }
}
