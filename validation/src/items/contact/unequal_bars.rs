//! A short bar that hits a long one at rest, both of one section and material: Saint-Venant's restitution.

use super::data::{Problem, Run};
use super::row::{Member, Row};
use super::{Measured, ball};

/// Length of the short bar and its velocity; E, density and section are 1.
const LENGTH: f64 = 10.0;
const VELOCITY: f64 = 2e-3;

/// Force and duration of the push, restitution over `L_1/L_2`, velocity of the short bar after it over that before,
/// vibration over that of the theory, changes of H and P; the load of the run is `L_2/L_1`.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let ratio = run.load.ok_or("a ratio of lengths is needed")?;
    let short = Member { length: LENGTH, cells: run.cells, velocity: VELOCITY, gap: VELOCITY };
    let cells = (ratio * run.cells as f64).round() as usize;
    let long = Member { length: ratio * LENGTH, cells, velocity: 0.0, gap: 0.0 };
    // The wave has been to the end of the long bar and back, and the bars are apart.
    let end = 2.0 * ratio * LENGTH + 8.0;
    let row = Row::of(&[short, long], ball::rubber(1.0, 0.0, 1.0)?, 1.0, run, end)?;
    let trace = &row.trace;
    let passes = trace.pushes(0.25 * VELOCITY);
    let [first, last] = [passes.first(), passes.last()].map(|time| time.copied().unwrap_or(f64::NAN));
    let energy = trace.records[0].total_energy;
    let values = vec![
        -trace.mean(3.0, 19.0) / (0.5 * VELOCITY),
        (last - first) / (2.0 * LENGTH),
        ratio * (row.velocities[1] - row.velocities[0]) / VELOCITY,
        row.velocities[0] / VELOCITY,
        row.vibration / energy / (1.0 - 1.0 / ratio),
        trace.drift(energy),
        trace.momentum_change() / (LENGTH * VELOCITY),
    ];
    Ok(Measured::of(values, trace))
}
