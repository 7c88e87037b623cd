//! Measures over runs.

use emmy::motion::Record;

/// Euclidean norm.
pub fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Largest relative change of the total energy over records, against the first.
pub fn energy_drift(records: &[Record]) -> f64 {
    let first = records[0].total_energy;
    records.iter().map(|r| ((r.total_energy - first) / first).abs()).fold(0.0, f64::max)
}

/// Largest change of the angular momentum over records, against the first.
pub fn momentum_drift(records: &[Record]) -> f64 {
    let first = records[0].angular_momentum;
    let change = |r: &Record| norm([0, 1, 2].map(|i| r.angular_momentum[i] - first[i]));
    records.iter().map(change).fold(0.0, f64::max) / norm(first)
}

/// Slope between two points of a log-log plot.
pub fn order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln()
}
