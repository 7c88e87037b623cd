//! Entries of a table over time.

/// Size of the deviations of a measured table that need no end of a step, as a part of its largest size.
const SMALL_DEVIATION: f64 = 0.01;

/// An entry of a table: (time, factor).
pub(super) type Entry = (f64, f64);

/// Times at which a table turns: its entries between two of them deviate from a straight line by little. Jumps are
/// corners.
pub(super) fn corners(entries: &[Entry]) -> Vec<f64> {
    let peak = entries.iter().fold(0f64, |peak, (_, factor)| peak.max(factor.abs()));
    let deviation = SMALL_DEVIATION * peak;
    let mut corners: Vec<f64> = entries.first().map(|entry| entry.0).into_iter().collect();
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    // Slopes of the lines from the last corner that pass every entry since then at a small distance.
    let (mut from, mut slopes) = (entries[0], all);
    for pair in entries.windows(2) {
        let [last, (time, factor)] = [pair[0], pair[1]];
        let bounds =
            |from: Entry| [-1.0, 1.0].map(|side| (factor - from.1 + side * deviation) / (time - from.0));
        let is_outside = |[low, high]: [f64; 2]| {
            let slope = (factor - from.1) / (time - from.0);
            !(low <= slope && slope <= high)
        };
        if time == last.0 || is_outside(slopes) {
            corners.push(last.0);
            (from, slopes) = (last, all);
        }
        if time > from.0 {
            let [low, high] = bounds(from);
            slopes = [slopes[0].max(low), slopes[1].min(high)];
        } else {
            from = (time, factor);
        }
    }
    corners.extend(entries.last().map(|entry| entry.0));
    corners.dedup();
    corners
}

/// The value of a table at a time, before a jump there.
pub(super) fn value_before(entries: &[Entry], time: f64) -> f64 {
    let from = entries.partition_point(|&(t, _)| t < time);
    match (from.checked_sub(1).map(|i| entries[i]), entries.get(from)) {
        (_, Some(&(t, value))) if t == time => value,
        (Some((a, f)), Some(&(b, g))) => f + (g - f) * (time - a) / (b - a),
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 0.0,
    }
}

/// The entries of a table before (or at) a time and after it.
pub(super) fn around(entries: &[Entry], time: f64) -> (Option<Entry>, Option<Entry>) {
    let after = entries.partition_point(|&(t, _)| t <= time);
    (after.checked_sub(1).map(|i| entries[i]), entries.get(after).copied())
}
