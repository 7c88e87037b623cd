//! Energy and momentum of a block that is thrown at a plane and tumbles.

use super::Measured;
use super::data::{Problem, Run};
use super::trace::Trace;

/// Largest change of the energy over that at the start, and of the momentum along the plane over its size.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let trace = Trace::of(problem, run, &[])?;
    let start = &trace.records[0];
    let change = |record: &emmy::motion::Record| {
        let moves = |d: usize| record.linear_momentum[d] - start.linear_momentum[d];
        moves(0).hypot(moves(1))
    };
    let along = trace.records.iter().map(change).fold(0.0, f64::max);
    let values = vec![
        trace.drift(start.total_energy),
        along / start.linear_momentum[0].hypot(start.linear_momentum[1]),
    ];
    let curve = trace.records.iter().map(|record| (record.time, record.total_energy / start.total_energy));
    let curve = curve.collect();
    Ok(Measured::of(values, &trace).with_curve(curve))
}
