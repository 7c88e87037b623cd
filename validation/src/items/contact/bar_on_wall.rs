//! A bar that meets a wall: the wall pushes with `rho c v A` for `2 L/c`.

use super::Measured;
use super::data::{Problem, Run};
use super::trace::Trace;

/// Exact begin and end of the contact, and force.
const CONTACT: [f64; 2] = [5e-4, 8.8545e-4];
const FORCE: f64 = 1270.827;

/// Begin, end and force of the contact, mean velocity after it, and energy of vibration over the whole.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let section = 3.14e-4f64.sqrt();
    let distance = run.distance.ok_or("a distance is needed")?;
    let set = [
        ("mesh.box", format!("{{ size = [{section}, {section}, 1.0], cells = [1, 1, {}] }}", run.cells)),
        ("contact.obstacle.plane.point", format!("[0.0, 0.0, {}]", -5e-5 - distance)),
    ];
    let trace = Trace::of(problem, run, &set)?;
    let passes = trace.passes(0.5 * FORCE);
    let duration = CONTACT[1] - CONTACT[0];
    let plateau = trace.mean(CONTACT[0] + 0.1 * duration, CONTACT[1] - 0.1 * duration);
    let end = trace.at(1e-3);
    let values = vec![
        passes[0],
        passes[passes.len() - 1],
        plateau,
        trace.velocity(end),
        trace.vibration(end) / trace.records[0].kinetic_energy,
        trace.drift(trace.records[0].kinetic_energy),
    ];
    Ok(Measured::of(values, &trace))
}
