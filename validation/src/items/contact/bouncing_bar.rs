//! A bar that falls on a floor and bounces with a period: after every second contact it is undeformed again.

use super::Measured;
use super::data::{Problem, Run};
use super::trace::{Trace, crossings};

/// Begin and end of both contacts, two pressures in the first one, vibration between and after them over the whole
/// energy, and period.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let distance = run.distance.ok_or("a distance is needed")?;
    let set = [
        ("mesh.box", format!("{{ size = [1.0, 1.0, 10.0], cells = [1, 1, {}] }}", run.cells)),
        ("contact.obstacle.plane.point", format!("[0.0, 0.0, {}]", -5e-4 - distance)),
    ];
    let trace = Trace::of(problem, run, &set)?;
    let passes = trace.passes(200.0);
    let [first, last] = [passes.first(), passes.last()].map(|time| time.copied().unwrap_or(f64::NAN));
    let middle = |up: bool| {
        let flight =
            passes.iter().copied().filter(|time| (up == (*time < 0.0267)) && *time != first && *time != last);
        let found = if up { flight.reduce(f64::max) } else { flight.reduce(f64::min) };
        found.unwrap_or(f64::NAN)
    };
    let energy = trace.mass * 10.0 * 5e-4;
    let velocities = trace.records.iter().map(|record| (record.time, trace.velocity(record)));
    let highest = crossings(velocities, 0.0);
    let values = vec![
        first,
        middle(true),
        trace.mean(0.0115, 0.0135),
        trace.mean(0.014, 0.016),
        trace.vibration(trace.at(0.0266667)) / energy,
        middle(false),
        last,
        trace.vibration(trace.at(0.0533333)) / energy,
        highest.last().copied().unwrap_or(f64::NAN),
        trace.drift(energy),
    ];
    Ok(Measured::of(values, &trace).with_curve(trace.normal().collect()))
}
