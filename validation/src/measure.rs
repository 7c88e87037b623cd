//! Measures over runs.

#![allow(non_snake_case)]

use emmy::motion::Record;

/// Euclidean norm.
pub(crate) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Largest relative change of the total energy over records, against the first.
pub(crate) fn energy_drift(records: &[Record]) -> f64 {
    let first = records[0].total_energy;
    records.iter().map(|r| ((r.total_energy - first) / first).abs()).fold(0.0, f64::max)
}

/// Relative change of the total energy from the first record to the last.
pub(crate) fn energy_change(records: &[Record]) -> f64 {
    records[records.len() - 1].total_energy / records[0].total_energy - 1.0
}

/// Change of the angular momentum of a record, relative to another's.
pub(crate) fn momentum_change(first: &Record, record: &Record) -> f64 {
    let L = first.angular_momentum;
    norm([0, 1, 2].map(|i| record.angular_momentum[i] - L[i])) / norm(L)
}

/// Largest relative change of the angular momentum over records, against the first.
pub(crate) fn momentum_drift(records: &[Record]) -> f64 {
    records.iter().map(|r| momentum_change(&records[0], r)).fold(0.0, f64::max)
}

/// Slope between two points of a log-log plot.
pub(crate) fn order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln()
}

/// CPU time of the process so far, all threads together \[s\].
#[cfg(unix)]
pub(crate) fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Wall time since the first call: other systems have no portable clock of CPU time.
#[cfg(not(unix))]
pub(crate) fn cpu_seconds() -> f64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
