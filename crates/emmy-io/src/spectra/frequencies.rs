//! Lists of frequencies.

use std::str::FromStr;

/// Frequencies from `start` to `stop`, written `A:B:N`, `A:B:N:log` or `A:B:N:linear`.
///
/// ```
/// use emmy_io::spectra::Frequencies;
/// let text: Frequencies = "1:100:3:log".parse().unwrap();
/// let values = text.values(false);
/// assert!(values.iter().zip([1.0, 10.0, 100.0]).all(|(f, exact)| (f / exact - 1.0).abs() < 1e-15));
/// assert!("100:1:3".parse::<Frequencies>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// The first one.
    pub start: f64,
    /// The last one.
    pub stop: f64,
    /// Their number.
    pub count: usize,
    /// Whether they grow in equal ratios; `None` if the text does not say.
    pub is_log: Option<bool>,
}

/// Largest number of frequencies.
const MAX_COUNT: usize = 10_000_000;

impl Frequencies {
    /// The frequencies \[1/time\]; `log`: whether they grow in equal ratios if the text does not say.
    pub fn values(&self, log: bool) -> Vec<f64> {
        let Frequencies { start, stop, count, is_log } = *self;
        let value = |i: usize| {
            let part = i as f64 / (count - 1).max(1) as f64;
            match is_log.unwrap_or(log) {
                _ if i == 0 => start,
                _ if i + 1 == count => stop,
                true => start * (stop / start).powf(part),
                false => start + part * (stop - start),
            }
        };
        (0..count).map(value).collect()
    }
}

impl FromStr for Frequencies {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(':').map(str::trim).collect();
        let form = "frequencies are written A:B:N, with :log or :linear behind if wanted";
        let (numbers, is_log) = match parts[..] {
            [_, _, _] => (&parts[..], None),
            [_, _, _, "log"] => (&parts[..3], Some(true)),
            [_, _, _, "linear"] => (&parts[..3], Some(false)),
            [_, _, _, word] => return Err(format!("`{word}` is neither `log` nor `linear`; {form}")),
            _ => return Err(form.to_string()),
        };
        let number =
            |text: &str| text.parse::<f64>().map_err(|_| format!("`{text}` is not a number; {form}"));
        let (start, stop) = (number(numbers[0])?, number(numbers[1])?);
        let count: usize =
            numbers[2].parse().map_err(|_| format!("`{}` is not a whole number; {form}", numbers[2]))?;
        if !(start > 0.0 && start.is_finite() && stop.is_finite()) {
            return Err(format!("frequencies must be positive, but begin with {start}"));
        }
        if !(1..=MAX_COUNT).contains(&count) {
            return Err(format!("there must be from 1 to {MAX_COUNT} frequencies, not {count}"));
        }
        match (count, stop > start) {
            (1, _) if stop == start => {}
            (1, _) => return Err(format!("one frequency cannot run from {start} to {stop}")),
            (_, true) => {}
            (_, false) => return Err(format!("frequencies must grow, but run from {start} to {stop}")),
        }
        Ok(Frequencies { start, stop, count, is_log })
    }
}
