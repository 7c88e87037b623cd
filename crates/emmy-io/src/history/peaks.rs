//! Peaks: last, smallest and largest numbers of columns, with their times.

use std::path::Path;

use super::{HistoryColumns, HistoryError, Number, Rows};

/// The last, smallest and largest number of a column over the rows of a history. NaN and empty cells are neither
/// smallest nor largest; of equal numbers the first one counts. A number without a value is NaN.
///
/// ```
/// use emmy_io::history::Peak;
/// let mut peak = Peak::default();
/// [(0.0, f64::NAN), (0.1, 3.0), (0.2, -1.0), (0.3, 2.0)].map(|(time, number)| peak.add(time, number));
/// assert_eq!((peak.last, peak.smallest, peak.largest), (2.0, -1.0, 3.0));
/// assert_eq!((peak.smallest_time, peak.largest_time), (0.2, 0.1));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Number in the last row.
    pub last: f64,
    /// The smallest number.
    pub smallest: f64,
    /// Its time \[time\].
    pub smallest_time: f64,
    /// The largest number.
    pub largest: f64,
    /// Its time \[time\].
    pub largest_time: f64,
}

impl Default for Peak {
    fn default() -> Self {
        let none = f64::NAN;
        Peak { last: none, smallest: none, smallest_time: none, largest: none, largest_time: none }
    }
}

/// Endings of the names of a column's peak: last, smallest, largest.
const ENDINGS: [&str; 5] = ["", "_min", "_min_time", "_max", "_max_time"];

impl Peak {
    /// Adds the number of the next row.
    pub fn add(&mut self, time: f64, number: f64) {
        self.last = number;
        // A comparison with NaN is false.
        if number < self.smallest || self.smallest.is_nan() && !number.is_nan() {
            (self.smallest, self.smallest_time) = (number, time);
        }
        if number > self.largest || self.largest.is_nan() && !number.is_nan() {
            (self.largest, self.largest_time) = (number, time);
        }
    }

    /// Names of the numbers of a column X: `X`, `X_min`, `X_min_time`, `X_max`, `X_max_time`.
    pub(crate) fn names(column: &str) -> [String; 5] {
        ENDINGS.map(|ending| format!("{column}{ending}"))
    }

    /// The numbers in the order of their names.
    fn numbers(&self) -> [f64; 5] {
        let Peak { last, smallest, smallest_time, largest, largest_time } = *self;
        [last, smallest, smallest_time, largest, largest_time]
    }
}

/// The column whose smallest or largest number, or its time, has a name.
pub(crate) fn column_of_peak(name: &str) -> Option<&str> {
    ENDINGS[1..].iter().find_map(|ending| name.strip_suffix(ending))
}

/// Peaks of the columns after those of the whole body: probes, reactions, joints, rigid bodies, extremes, values.
#[derive(Debug, Default)]
pub struct Peaks {
    names: Vec<String>,
    /// Index of the first of these columns in a row; they are the last ones.
    first: usize,
    /// Place of the time in a row.
    time: usize,
    peaks: Vec<Peak>,
}

impl Peaks {
    /// Peaks of no rows yet.
    pub fn of(columns: &HistoryColumns) -> Self {
        let mut all = columns.names();
        let first = all.len() - columns.n_asked();
        let time = all.iter().position(|name| name == "time").unwrap_or(0);
        let names = all.split_off(first);
        Peaks { first, time, peaks: vec![Peak::default(); names.len()], names }
    }

    /// Peaks of the rows in a file.
    ///
    /// # Errors
    /// [`HistoryError`].
    pub(crate) fn read(columns: &HistoryColumns, path: &Path) -> Result<Self, HistoryError> {
        let mut peaks = Peaks::of(columns);
        if !peaks.is_empty() {
            for row in Rows::open(path)? {
                let row = row?;
                peaks.add_numbers(|place| row[place]);
            }
        }
        Ok(peaks)
    }

    /// Whether there is no such column.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Adds the next row.
    pub fn add(&mut self, row: &[Number]) {
        self.add_numbers(|place| row[place].value());
    }

    fn add_numbers(&mut self, number: impl Fn(usize) -> f64) {
        let time = number(self.time);
        for (place, peak) in self.peaks.iter_mut().enumerate() {
            peak.add(time, number(self.first + place));
        }
    }

    /// The peak of a column.
    pub(crate) fn of_column(&self, name: &str) -> Option<&Peak> {
        self.iter().find(|(own, _)| *own == name).map(|(_, peak)| peak)
    }

    /// The columns with their peaks.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Peak)> {
        self.names.iter().map(String::as_str).zip(&self.peaks)
    }

    /// All numbers with their names: `X`, `X_min`, `X_min_time`, `X_max`, `X_max_time` of each column X.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = (String, f64)> {
        self.iter().flat_map(|(name, peak)| Peak::names(name).into_iter().zip(peak.numbers()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undefined_numbers_are_no_peaks_and_the_first_of_equal_ones_counts() {
        let peak = |numbers: &[f64]| {
            let mut peak = Peak::default();
            numbers.iter().enumerate().for_each(|(time, number)| peak.add(time as f64, *number));
            peak.numbers()
        };
        assert!(peak(&[]).iter().all(|number| number.is_nan()));
        assert!(peak(&[f64::NAN, f64::NAN]).iter().all(|number| number.is_nan()));
        assert_eq!(peak(&[f64::NAN, 2.0, 5.0, f64::NAN, 2.0, 5.0]), [5.0, 2.0, 1.0, 5.0, 2.0]);
        let [last, rest @ ..] = peak(&[1.0, f64::NEG_INFINITY, f64::NAN]);
        assert!(last.is_nan() && rest == [f64::NEG_INFINITY, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn names_of_peaks_lead_to_their_column() {
        let own = Peak::names("tip_x");
        assert_eq!(own, ["tip_x", "tip_x_min", "tip_x_min_time", "tip_x_max", "tip_x_max_time"]);
        own[1..].iter().for_each(|name| assert_eq!(column_of_peak(name), Some("tip_x")));
        assert_eq!((column_of_peak("tip_x"), column_of_peak("max_velocity")), (None, None));
    }
}
