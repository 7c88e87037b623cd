//! Corrections of a record: a low-pass filter, and a baseline.

#![allow(non_snake_case)]

use std::f64::consts::{PI, SQRT_2};

use emmy::body::TimeFunction;
use emmy::internals::number::short;
use emmy::internals::quadrature::gauss;

/// Entries of a record: (time, value).
type Entries = Vec<(f64, f64)>;

/// Largest distance of a time from even sampling, as a part of the interval: times are often written with few digits.
const UNEVEN: f64 = 0.05;

/// Interval of a record whose rows are even in time.
///
/// # Errors
/// The reason, and the index of the first row that is not in its place.
fn interval(entries: &[(f64, f64)]) -> Result<f64, (usize, String)> {
    let [(start, _), .., (end, _)] = entries[..] else { return Err((0, "it has one row".to_string())) };
    let interval = (end - start) / (entries.len() - 1) as f64;
    let is_uneven = |(row, (time, _)): (usize, &(f64, f64))| {
        let distance = (time - (start + row as f64 * interval)).abs();
        distance.is_nan() || distance > UNEVEN * interval
    };
    match entries.iter().enumerate().position(is_uneven) {
        None => Ok(interval),
        Some(row) => {
            let [time, even] = [entries[row].0, start + row as f64 * interval].map(short);
            Err((row, format!("a filter needs rows at equal intervals, but the time {time} is not {even}")))
        }
    }
}

/// Filters a record by a Butterworth low pass of order 2, forward and backward: no phase, half the amplitude at the
/// frequency \[1/time\]. With 2.0775 CFC as the frequency it is the filter of channel class CFC in SAE J211.
///
/// Before its start and after its end, the record is continued by its reflection in the point there.
///
/// # Errors
/// The reason, and the index of the row at fault.
pub(super) fn low_pass(entries: &mut Entries, frequency: f64) -> Result<(), (usize, String)> {
    let interval = interval(entries)?;
    let nyquist = 0.5 / interval;
    if frequency >= nyquist {
        let [frequency, nyquist] = [frequency, nyquist].map(short);
        let reason = format!(
            "a filter at {frequency} needs rows at more than twice that rate; half of it is {nyquist}"
        );
        return Err((0, reason));
    }
    // As many rows as five periods, after which 2e-10 of the start is left.
    let n = entries.len();
    let n_more = ((5.0 / (frequency * interval)).ceil() as usize).min(n - 1);
    let value = |row: usize| entries[row].1;
    let before = (1..=n_more).rev().map(|row| 2.0 * value(0) - value(row));
    let after = (1..=n_more).map(|row| 2.0 * value(n - 1) - value(n - 1 - row));
    let mut values: Vec<f64> = before.chain((0..n).map(value)).chain(after).collect();
    let filter = Filter::butterworth(frequency * interval);
    filter.apply(values.iter_mut());
    filter.apply(values.iter_mut().rev());
    entries.iter_mut().zip(&values[n_more..]).for_each(|(entry, value)| entry.1 = *value);
    Ok(())
}

/// A digital filter of second order, `y_n = b_0 x_n + b_1 x_n-1 + b_2 x_n-2 - a_1 y_n-1 - a_2 y_n-2`.
struct Filter {
    b: [f64; 3],
    a: [f64; 2],
}

impl Filter {
    /// The Butterworth low pass with a corner at so many periods per sample, by the bilinear transform.
    fn butterworth(corner: f64) -> Self {
        let w = (PI * corner).tan();
        let scale = 1.0 / (1.0 + SQRT_2 * w + w * w);
        let b = w * w * scale;
        Filter { b: [b, 2.0 * b, b], a: [2.0 * (w * w - 1.0) * scale, (1.0 - SQRT_2 * w + w * w) * scale] }
    }

    /// Filters values in place, as if the first one had been there forever.
    fn apply<'a>(&self, values: impl Iterator<Item = &'a mut f64>) {
        let Filter { b, a } = self;
        let mut memory: Option<[f64; 2]> = None;
        for value in values {
            let x = *value;
            let [first, second] = memory.unwrap_or([(1.0 - b[0]) * x, (b[2] - a[1]) * x]);
            let y = b[0] * x + first;
            memory = Some([b[1] * x - a[0] * y + second, b[2] * x - a[1] * y]);
            *value = y;
        }
    }
}

/// Adds the parabola over time to a record of an acceleration that makes the mean square of its velocity least
/// (N. M. Newmark, 1973). The record is linear between its rows, and starts from rest.
///
/// # Errors
/// The reason, if the record is too short.
pub(super) fn correct_baseline(entries: &mut Entries) -> Result<(), String> {
    let [(start, _), .., (end, _)] = entries[..] else { return Err("it has one row".to_string()) };
    let length = end - start;
    let times = entries.iter().map(|(time, _)| *time);
    let mut distinct: Vec<f64> = times.collect();
    distinct.dedup();
    if distinct.len() < 4 {
        return Err("a baseline correction needs four rows at different times".to_string());
    }
    let powers = |time: f64| {
        let s = (time - start) / length;
        [1.0, s, s * s]
    };
    // Velocities of the record and of the three powers are parabolas between two rows; Gauss points integrate their
    // products exactly.
    let points = gauss(3);
    let (mut matrix, mut side) = ([[0.0; 3]; 3], [0.0; 3]);
    let mut velocities = [0.0; 4];
    for pair in entries.windows(2) {
        let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
        let h = t1 - t0;
        let [from, to] = [(t0, a0), (t1, a1)].map(|(t, a)| {
            let [one, s, square] = powers(t);
            [a, one, s, square]
        });
        let after = |i: usize, s: f64| velocities[i] + h * s * (from[i] + 0.5 * s * (to[i] - from[i]));
        for (&[s], w) in points.iter() {
            let v: [f64; 4] = std::array::from_fn(|i| after(i, s));
            for i in 0..3 {
                side[i] -= w * h * v[1 + i] * v[0];
                (0..3).for_each(|j| matrix[i][j] += w * h * v[1 + i] * v[1 + j]);
            }
        }
        velocities = std::array::from_fn(|i| after(i, 1.0));
    }
    let factors = solved(matrix, side);
    for (time, value) in entries {
        *value += powers(*time).iter().zip(factors).map(|(power, factor)| factor * power).sum::<f64>();
    }
    Ok(())
}

/// The solution of three equations with a positive definite matrix.
fn solved(mut A: [[f64; 3]; 3], mut b: [f64; 3]) -> [f64; 3] {
    for i in 0..3 {
        for j in i + 1..3 {
            let factor = A[j][i] / A[i][i];
            (i..3).for_each(|k| A[j][k] -= factor * A[i][k]);
            b[j] -= factor * b[i];
        }
    }
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|k| A[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / A[i][i];
    }
    b
}

/// How a correction changes a record, in words.
pub(super) fn change(before: &[(f64, f64)], after: &[(f64, f64)]) -> String {
    let peak = |entries: &[(f64, f64)]| entries.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    let changes = before.iter().zip(after).map(|((_, a), (_, b))| (b - a).abs());
    let (most, largest) = (changes.fold(0.0, f64::max), [before, after].map(peak));
    let part = 100.0 * most / largest[0];
    let [most, part, before, after] = [most, part, largest[0], largest[1]].map(short);
    format!(
        "values change by up to {most} ({part} % of the largest), and the largest from {before} to {after}"
    )
}

/// Velocity and displacement at the end of a record of an acceleration, and the largest velocity at its rows.
pub(super) fn drift(entries: &[(f64, f64)]) -> emmy::Result<[f64; 3]> {
    let span = [entries[0].0, entries[entries.len() - 1].0];
    let path = TimeFunction::from_acceleration(&TimeFunction::new(entries.to_vec())?, span)?;
    let largest = entries.iter().map(|(time, _)| path.rate(*time).abs()).fold(0.0, f64::max);
    Ok([path.rate(span[1]), path.value(span[1]), largest])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(n: usize, interval: f64, value: impl Fn(f64) -> f64) -> Entries {
        (0..n).map(|row| (row as f64 * interval, value(row as f64 * interval))).collect()
    }

    #[test]
    fn the_filter_has_the_gain_of_two_passes() {
        // |H|^2 = 1/(1 + (tan(pi f/r)/tan(pi f_c/r))^4) at the rate r.
        for frequency in [5.0, 50.0, 100.0, 180.0] {
            let mut entries = record(4001, 1e-3, |t| (2.0 * PI * frequency * t).cos());
            low_pass(&mut entries, 100.0).unwrap();
            let ratio: f64 = (PI * frequency * 1e-3).tan() / (PI * 0.1).tan();
            let gain = 1.0 / (1.0 + ratio.powi(4));
            assert!((entries[2000].1 - gain).abs() < 1e-12, "{frequency}: {} {gain}", entries[2000].1);
        }
        // A straight line passes, up to its ends.
        let mut entries = record(200, 1e-3, |t| 3.0 + 2.0 * t);
        low_pass(&mut entries, 60.0).unwrap();
        assert!(entries.iter().all(|(t, value)| (value - 3.0 - 2.0 * t).abs() < 1e-11), "{entries:?}");
    }

    #[test]
    fn the_filter_is_that_of_scipy() {
        // sosfiltfilt(butter(2, 60, fs=1000, output="sos"), x, padlen=39), x_n = (n mod 7) - n^2/400, 40 samples.
        let mut entries = record(40, 1e-3, |t| {
            let n = (t * 1e3).round();
            n % 7.0 - n * n / 400.0
        });
        low_pass(&mut entries, 60.0).unwrap();
        for (row, value) in SCIPY {
            assert!((entries[row].1 - value).abs() < 1e-12, "{row}: {} {value}", entries[row].1);
        }
    }

    const SCIPY: [(usize, f64); 4] = [
        (0, -1.1479628596572367e-5),
        (7, 3.0274528102330613),
        (20, 2.018606611595481),
        (39, 0.19753089077345118),
    ];

    #[test]
    fn rows_must_be_even_and_close() {
        let mut entries = record(20, 1e-3, |t| t);
        assert!(low_pass(&mut entries, 500.0).unwrap_err().1.contains("half of it is 500"));
        entries[7].0 += 2e-4;
        let (row, reason) = low_pass(&mut entries, 60.0).unwrap_err();
        assert!(row == 7 && reason.contains("0.0072 is not 0.007"), "{row} {reason}");
    }

    #[test]
    fn a_parabola_is_taken_out_of_a_record() {
        // An acceleration whose velocity sin^3(pi t) has no part like those of the powers: on [0, 1] a polynomial of
        // the acceleration alone is corrected to zero.
        let mut entries = record(101, 0.01, |t| 1.0 - 3.0 * t + 2.0 * t * t);
        correct_baseline(&mut entries).unwrap();
        assert!(entries.iter().all(|(_, value)| value.abs() < 1e-12), "{entries:?}");
        // A correction leaves nothing for a second one.
        let mut entries = record(201, 0.01, |t| (7.0 * t).sin() + 0.2);
        correct_baseline(&mut entries).unwrap();
        let once = entries.clone();
        correct_baseline(&mut entries).unwrap();
        assert!(entries.iter().zip(&once).all(|(a, b)| (a.1 - b.1).abs() < 1e-12));
        // The velocity is orthogonal to those of the powers, here t: the integral of v t vanishes.
        let path =
            TimeFunction::from_acceleration(&TimeFunction::new(once.clone()).unwrap(), [0.0, 2.0]).unwrap();
        let n = 20_000;
        let times = (0..n).map(|i| 2.0 * (f64::from(i) + 0.5) / f64::from(n));
        let [product, square] =
            times.fold([0.0; 2], |[p, q], t| [p + path.rate(t) * t, q + path.rate(t).powi(2)]);
        assert!(product.abs() < 1e-6 * square, "{product} {square}");
        assert!(correct_baseline(&mut record(3, 1.0, |t| t)).is_err());
    }

    #[test]
    fn drift_is_exact() {
        let [velocity, displacement, largest] = drift(&record(11, 0.1, |t| 6.0 * t)).unwrap();
        assert!((velocity - 3.0).abs() < 1e-14 && (displacement - 1.0).abs() < 1e-14);
        assert_eq!(largest, velocity);
    }
}
