//! Two equal bars that fly against each other: they push with `rho c v A` for `2 L/c` and exchange their velocities.

use super::data::{Problem, Run};
use super::row::{Member, Row};
use super::{Measured, ball};

/// Length and velocity; E, density and section are 1.
const LENGTH: f64 = 10.0;
const VELOCITY: f64 = 1e-3;

/// Begin, end and force of the contact, velocities of both bars after it over that before, vibration, changes of H and
/// P.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let bar = |velocity: f64| Member { length: LENGTH, cells: run.cells, velocity, gap: 2.0 * VELOCITY };
    let row = Row::of(&[bar(VELOCITY), bar(-VELOCITY)], ball::rubber(1.0, 0.0, 1.0)?, 1.0, run, 26.0)?;
    let trace = &row.trace;
    let passes = trace.pushes(0.5 * VELOCITY);
    let [first, last] = [passes.first(), passes.last()].map(|time| time.copied().unwrap_or(f64::NAN));
    let energy = trace.records[0].total_energy;
    let values = vec![
        first,
        last,
        -trace.mean(3.0, 19.0) / VELOCITY,
        -row.velocities[0] / VELOCITY,
        row.velocities[1] / VELOCITY,
        row.vibration / energy,
        trace.drift(energy),
        trace.momentum_change() / (LENGTH * VELOCITY),
    ];
    Ok(Measured::of(values, trace))
}
