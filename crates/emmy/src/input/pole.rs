//! Poles of functions of time.

/// Samples of the span, between which poles are looked for.
const SAMPLES: usize = 1000;

/// Distances from a pole at which the function is compared, each a tenth of the one before.
const DISTANCES: usize = 5;

/// Least growth from one to the next: 10 at a simple pole, 1 where the function is regular, in between where its
/// integral exists.
const LEAST_GROWTH: f64 = 9.0;

/// Parts of an interval around the largest value, in the search for it.
const PARTS: usize = 16;

/// A time of a span near which a function grows like 1/(t - t_0) or faster. Its value there may be a finite number,
/// because the time is rounded: `tan(pi*t/2)` is 1.6e16 at t = 1.
///
/// ```
/// use emmy::internals::body::pole;
/// let time = pole(|t| (std::f64::consts::PI * t / 2.0).tan(), [0.0, 1.0]).unwrap();
/// assert!((time - 1.0).abs() < 1e-12);
/// assert_eq!(pole(|t| (std::f64::consts::PI * t / 2.0).tan(), [0.0, 0.999]), None);
/// assert_eq!(pole(|t| (-((t - 0.3) / 1e-4f64).powi(2)).exp(), [0.0, 1.0]), None);
/// ```
pub fn pole(function: impl Fn(f64) -> f64, [start, end]: [f64; 2]) -> Option<f64> {
    let scale = start.abs().max(end.abs());
    let spacing = (end - start) / SAMPLES as f64;
    let farthest = (0.1 * spacing).min(1e-7 * scale);
    let nearest = farthest * 0.1f64.powi(DISTANCES as i32 - 1);
    // A hundred roundings of the time are as near as the distance is still known to a percent.
    if nearest < 100.0 * f64::EPSILON * scale {
        return None;
    }
    let size = |time: f64| function(time).abs();
    let at = |i: usize| if i == SAMPLES { end } else { start + spacing * i as f64 };
    let sizes: Vec<f64> = (0..=SAMPLES).map(|i| size(at(i))).collect();
    let is_peak = |i: &usize| {
        let before = sizes[i.saturating_sub(1)];
        let after = sizes[(i + 1).min(SAMPLES)];
        sizes[*i] >= before.max(after) && sizes[*i] >= 2.0 * before.min(after)
    };
    let is_pole = |time: &f64| {
        let beside = |distance: f64| {
            let sides = [time - distance, time + distance].into_iter().filter(|t| (start..=end).contains(t));
            sides.map(size).fold(0.0, f64::max)
        };
        let near: [f64; DISTANCES] = std::array::from_fn(|k| beside(farthest * 0.1f64.powi(k as i32)));
        // Their differences are free of the regular part, and those of a function without a pole are rounding.
        let grows = |three: &[f64]| three[2] - three[1] >= LEAST_GROWTH * (three[1] - three[0]).abs();
        near[DISTANCES - 1] > 2.0 * near[0] && near.windows(3).all(grows)
    };
    let around = |i: usize| [at(i.saturating_sub(1)), at((i + 1).min(SAMPLES))];
    let peaks = (0..=SAMPLES).filter(is_peak);
    peaks.map(|i| largest(size, around(i), 0.01 * nearest)).find(is_pole)
}

/// The time of the largest value in an interval, to a distance.
fn largest(size: impl Fn(f64) -> f64, [mut from, mut to]: [f64; 2], distance: f64) -> f64 {
    let mut time = from;
    while to - from > distance {
        let [start, part] = [from, (to - from) / PARTS as f64];
        let at = |i: usize| if i == PARTS { to } else { start + part * i as f64 };
        let best = (0..=PARTS).max_by(|&i, &j| size(at(i)).total_cmp(&size(at(j)))).unwrap_or(0);
        time = at(best);
        [from, to] = [at(best.saturating_sub(1)), at((best + 1).min(PARTS))];
    }
    time
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn poles_are_found_wherever_they_are() {
        let tan = |t: f64| (PI * t / 2.0).tan();
        for (span, expected) in [([0.0, 1.0], 1.0), ([0.0, 2.0], 1.0), ([1.0, 1.9], 1.0), ([0.0, 1.3], 1.0)] {
            let time = pole(tan, span).unwrap();
            assert!((time - expected).abs() < 1e-11, "{span:?}: {time}");
        }
        // Beside a larger regular part, of higher order, at the start, and between the samples.
        assert!(pole(|t| 1e3 + 1e-3 * tan(t), [0.0, 1.0]).is_some());
        assert!(pole(|t| (PI * t / 2.0).cos().powi(-2), [0.0, 1.0]).is_some());
        assert!(pole(|t| tan(t + 1.0), [0.0, 1.0]).is_some());
        assert!((pole(|t| 1.0 / (t - 0.5_f64.sqrt()), [0.0, 1.0]).unwrap() - 0.5_f64.sqrt()).abs() < 1e-11);
        assert!((pole(|t| 1.0 / (t - 0.2e-3), [0.0, 1e-3]).unwrap() - 0.2e-3).abs() < 1e-14);
    }

    #[test]
    fn regular_functions_have_none() {
        let functions: [fn(f64) -> f64; 10] = [
            |_| 0.0,
            |t| t,
            |t| (1e5 * t).sin(),
            |t| (2000.0 * (t - 1.0)).exp(),
            |t| t.powi(200),
            |t| (-((t - 0.7) / 1e-5).powi(2)).exp(),
            |t| ((t - 0.5) * 1e9).tanh(),
            // Integrable.
            |t| (1.0 - t + 1e-17).powf(-0.5),
            |t| (1.0 - t + 1e-17).ln(),
            |t| 1.0 / (1e-9 + (t - 0.3_f64).powi(2)),
        ];
        for (number, function) in functions.into_iter().enumerate() {
            for span in [[0.0, 1.0], [0.0, 0.3], [0.7, 1.0]] {
                assert_eq!(pole(function, span), None, "{number} {span:?}");
            }
        }
    }
}
