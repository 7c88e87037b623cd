//! A bar that meets a wall slowly, with both laws of the layer.

use super::Measured;
use super::data::{Problem, Run};
use super::trace::Trace;

/// Force over `rho c v A`, duration over `2 L/c`, and velocity after the contact over that before.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let (c, v) = (1000f64.sqrt(), 0.01);
    let distance = run.distance.ok_or("a distance is needed")?;
    let set = [
        ("mesh.box", format!("{{ size = [0.1, 0.1, 1.0], cells = [1, 1, {}] }}", run.cells)),
        ("contact.obstacle.plane.point", format!("[0.0, 0.0, {}]", -1e-4 - distance)),
    ];
    let trace = Trace::of(problem, run, &set)?;
    let force = c * v * 0.01;
    let passes = trace.passes(0.5 * force);
    let [first, last] = [passes.first(), passes.last()].map(|time| time.copied().unwrap_or(f64::NAN));
    let inset = 0.1 * (last - first);
    let end = trace.at(f64::INFINITY);
    let values = vec![
        trace.mean(first + inset, last - inset) / force,
        (last - first) / (2.0 / c),
        trace.velocity(end) / v,
        trace.vibration(end) / trace.records[0].kinetic_energy,
        trace.drift(trace.records[0].kinetic_energy),
    ];
    Ok(Measured::of(values, &trace))
}
