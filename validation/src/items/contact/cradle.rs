//! Newton's cradle: the first of a row of equal bodies strikes, the last one leaves with its velocity.

use super::data::{Problem, Run};
use super::row::{Member, Row};
use super::{Measured, ball};

/// Velocity of the last body over that of the first before, largest velocity of the others over it, vibration, changes
/// of H and P, for blocks of one cell; the load of the run is the velocity.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn blocks(_: &Problem, run: &Run) -> Result<Measured, String> {
    let thrown = run.load.ok_or("a velocity is needed")?;
    let block = |velocity| Member { length: 1.0, cells: 1, velocity, gap: 0.2 * thrown };
    // E, Poisson's ratio of lambda = 1000, mu = 500.
    let region = ball::rubber(4000.0 / 3.0, 1.0 / 3.0, 1.0)?;
    // The smooth layer stores the cube of the path by which it gives way.
    let end = (0.5 * run.bodies as f64 - 0.3) * (0.01 / thrown).cbrt();
    row(block, (region, 4000.0 / 3.0), (thrown, end), run)
}

/// The same for bars of length 10 with E, density and section 1; the load of the run is the time that a bar with the
/// velocity of the first takes to the next one, over `2 L/c`.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn bars(_: &Problem, run: &Run) -> Result<Measured, String> {
    let (length, velocity) = (10.0, 1e-3);
    let apart = run.load.unwrap_or(0.0) * 2.0 * length;
    let gap = |own: f64| if own > 0.0 { velocity } else { apart * velocity };
    let bar = |own: f64| Member { length, cells: run.cells, velocity: own, gap: gap(own) };
    let waves = if apart > 0.0 { run.bodies as f64 - 1.0 } else { 0.5 * run.bodies as f64 };
    let end = 1.0 + waves * 2.0 * length + (run.bodies as f64 - 2.0) * apart + 10.0;
    row(bar, (ball::rubber(1.0, 0.0, 1.0)?, 1.0), (velocity, end), run)
}

fn row(
    member: impl Fn(f64) -> Member,
    (region, young): (emmy::prelude::Region, f64),
    (velocity, end): (f64, f64),
    run: &Run,
) -> Result<Measured, String> {
    let velocities = std::iter::once(velocity).chain(std::iter::repeat(0.0)).take(run.bodies);
    let members: Vec<Member> = velocities.map(member).collect();
    let row = Row::of(&members, region, young, run, end)?;
    let [others @ .., last] = &row.velocities[..] else { return Err("bodies are needed".into()) };
    let energy = row.trace.records[0].total_energy;
    let momentum = row.trace.records[0].linear_momentum[2];
    let values = vec![
        last / velocity,
        others.iter().map(|own| own.abs()).fold(0.0, f64::max) / velocity,
        row.vibration / energy,
        row.trace.drift(energy),
        row.trace.momentum_change() / momentum,
    ];
    Ok(Measured::of(values, &row.trace))
}
