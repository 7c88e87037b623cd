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

/// Error norm (80) of a run against a reference that has a state at each of its times.
///
/// ```math
/// ||e|| = ( integral sum_A |q_A - q*_A|^2 dt )^(1/2)
/// ```
///
/// The integral is the trapezoidal rule over the run's own steps.
pub fn error_norm(states: &[emmy::motion::State], reference: &[emmy::motion::State]) -> f64 {
    let square = |state: &emmy::motion::State| -> f64 {
        let at = reference.partition_point(|other| other.time < state.time - 1e-9);
        let pairs = state.displacement.iter().zip(&reference[at.min(reference.len() - 1)].displacement);
        pairs.map(|(a, b)| (a - b).powi(2)).sum()
    };
    let squares: Vec<(f64, f64)> = states.iter().map(|state| (state.time, square(state))).collect();
    squares.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum::<f64>().sqrt()
}
