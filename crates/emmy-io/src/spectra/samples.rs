//! Samples of columns at equal distances in time.

use std::path::Path;

use serde_json::Value;

use super::{SpectrumError, positive};
use crate::comparison;
use crate::history::History;
use crate::input::suggest::nearest;
use crate::whole_file;

/// Relative difference of step sizes that counts as none.
const SAME_STEP: f64 = 1e-6;

/// Largest number of samples.
const MAX_SAMPLES: f64 = 1e8;

/// Series over the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The times, which grow.
    pub time: Vec<f64>,
    /// The values of each series at these times.
    pub values: Vec<Vec<f64>>,
}

/// Series at equal distances in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// The distance.
    pub step: f64,
    /// The samples of each series.
    pub values: Vec<Vec<f64>>,
    /// Whether they are interpolated.
    pub is_interpolated: bool,
}

/// Columns of the history of a run between two times, from the first row in which all of them have a number.
///
/// # Errors
/// [`SpectrumError`] if the run cannot be read, lacks a column, or has a later row without a number.
pub(super) fn read(
    directory: &Path,
    names: &[&str],
    [from, to]: [Option<f64>; 2],
) -> Result<Series, SpectrumError> {
    comparison::check(directory)?;
    let path = directory.join("history.csv");
    let history = History::read(&path)?;
    let place = |name: &str| {
        history.columns().iter().position(|column| column == name).ok_or_else(|| {
            let nearest = nearest(name, history.columns().iter().map(String::as_str)).map(String::from);
            SpectrumError::NoColumn { path: path.clone(), column: name.to_string(), nearest }
        })
    };
    let time = place("time")?;
    let places = names.iter().map(|name| place(name)).collect::<Result<Vec<usize>, _>>()?;
    // A time that was written with fewer digits means the row.
    let near = |t: f64| 1e-9 * t.abs();
    let is_between =
        |t: f64| from.is_none_or(|from| t >= from - near(t)) && to.is_none_or(|to| t <= to + near(t));
    let rows = history.rows().iter().filter(|row| is_between(row[time]));
    let rows = rows.skip_while(|row| places.iter().any(|&place| row[place].is_nan()));
    let mut series = Series { time: Vec::new(), values: vec![Vec::new(); names.len()] };
    for row in rows {
        series.time.push(row[time]);
        for ((values, &place), name) in series.values.iter_mut().zip(&places).zip(names) {
            if !row[place].is_finite() {
                let column = name.to_string();
                return Err(SpectrumError::Gap { path, column, time: row[time] });
            }
            values.push(row[place]);
        }
    }
    Ok(series)
}

/// Unit, dimension and meaning of the columns of a run; empty without units.
pub(super) fn known_columns(directory: &Path) -> Vec<Value> {
    let text = whole_file::read_text(&directory.join("columns.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// A property that some columns have in common.
pub(super) fn common(known: &[Value], columns: &[String], property: &str) -> Option<String> {
    let own = |name: &String| {
        known.iter().find(|own| own["column"] == **name)?[property].as_str().filter(|text| !text.is_empty())
    };
    let first = own(columns.first()?)?;
    columns.iter().all(|name| own(name) == Some(first)).then(|| first.to_string())
}

impl Series {
    /// The series at equal distances: as they are if their times have them, and no distance is given; else interpolated
    /// linearly, without a distance at the median of those of the times.
    ///
    /// # Errors
    /// [`SpectrumError`] for fewer than two times, times that do not grow, or a distance that is not positive.
    ///
    /// ```
    /// use emmy_io::spectra::Series;
    /// let series = Series { time: vec![0.0, 1.0, 2.0, 4.0], values: vec![vec![0.0, 1.0, 2.0, 8.0]] };
    /// let samples = series.sampled(None)?;
    /// assert!(samples.is_interpolated && samples.step == 1.0);
    /// assert_eq!(samples.values, [[0.0, 1.0, 2.0, 5.0, 8.0]]);
    /// # Ok::<(), emmy_io::spectra::SpectrumError>(())
    /// ```
    pub fn sampled(&self, step: Option<f64>) -> Result<Samples, SpectrumError> {
        let Series { time, values } = self;
        let n = time.len();
        if n < 2 {
            return Err(SpectrumError::Short { n, least: 2 });
        }
        if let Some(at) =
            (1..n).find(|&at| time[at].partial_cmp(&time[at - 1]) != Some(std::cmp::Ordering::Greater))
        {
            return Err(SpectrumError::Times { before: time[at - 1], after: time[at] });
        }
        let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (_, median, _) = steps.select_nth_unstable_by((n - 1) / 2, f64::total_cmp);
        let median = *median;
        let duration = time[n - 1] - time[0];
        let is_even = steps.iter().all(|size| (size - median).abs() <= SAME_STEP * median);
        if is_even && step.is_none() {
            return Ok(Samples {
                step: duration / (n - 1) as f64,
                values: values.clone(),
                is_interpolated: false,
            });
        }
        let step = positive("the distance of the samples", step.unwrap_or(median))?;
        // The end is a sample although the steps have rounding.
        let count = (duration / step * (1.0 + SAME_STEP)).floor() + 1.0;
        if count > MAX_SAMPLES {
            let reason =
                format!("a distance of {step} makes {count:.0} samples; at most {MAX_SAMPLES:.0} are taken");
            return Err(SpectrumError::Segments { reason });
        }
        let times: Vec<f64> = (0..count as usize).map(|i| time[0] + i as f64 * step).collect();
        let values = values.iter().map(|values| interpolated(time, values, &times)).collect();
        Ok(Samples { step, values, is_interpolated: true })
    }
}

/// Values at times that grow, linear between those of a series.
fn interpolated(time: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let mut right = 1;
    let value = |&t: &f64| {
        while right + 1 < time.len() && time[right] < t {
            right += 1;
        }
        let part = ((t - time[right - 1]) / (time[right] - time[right - 1])).clamp(0.0, 1.0);
        (1.0 - part) * values[right - 1] + part * values[right]
    };
    at.iter().map(value).collect()
}

/// The derivative of samples: central differences, one-sided at the ends, as `numpy.gradient`.
///
/// ```
/// assert_eq!(emmy_io::spectra::derivative(&[0.0, 1.0, 4.0], 0.5), [2.0, 4.0, 6.0]);
/// ```
pub fn derivative(samples: &[f64], step: f64) -> Vec<f64> {
    let n = samples.len();
    let slope = |i: usize| {
        let (left, right) = (i.saturating_sub(1), (i + 1).min(n - 1));
        if left == right { 0.0 } else { (samples[right] - samples[left]) / ((right - left) as f64 * step) }
    };
    (0..n).map(slope).collect()
}
