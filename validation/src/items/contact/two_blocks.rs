//! Two spinning blocks that meet in flight.

use super::Measured;
use super::data::{Problem, Run};
use super::trace::Trace;

/// Kinetic and strain energy at the end, largest energy of the layers \[energy\], and smallest gap over the thickness
/// of the layer in `reference`, another implementation of the same formulas, by degree and cells of the upper block.
const PEER: [(usize, usize, [f64; 4]); 3] = [
    (1, 2, [1.0141379100079595, 0.1125454233301228, 0.16365211327819973, 0.5476345077155592]),
    (2, 2, [1.0380569519070906, 0.08862638142650953, 0.14578490317474463, 0.4905220943118124]),
    (1, 3, [0.9954634056121302, 0.1312199277209123, 0.14661900368410352, 0.6559732814425531]),
];

/// Largest changes of H over its start, of P and L over their sizes at the start.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let trace = meeting(problem, run, 0.2)?;
    let start = &trace.records[0];
    let values = vec![trace.drift(start.total_energy), trace.momentum_change(), trace.spin_change()];
    let curve = trace.records.iter().map(|record| (record.time, record.total_energy / start.total_energy));
    let curve = curve.collect();
    Ok(Measured::of(values, &trace).with_curve(curve))
}

/// Differences from the other implementation: kinetic and strain energy and largest energy of the layers over H,
/// smallest gap over the thickness.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn peer(problem: &Problem, run: &Run) -> Result<Measured, String> {
    let own = |(degree, cells, _): &&(usize, usize, [f64; 4])| (*degree, *cells) == (run.degree, run.cells);
    let (.., [kinetic, strain, layers, gap]) = PEER.iter().find(own).ok_or("a reference is needed")?;
    let trace = meeting(problem, run, run.steps.ok_or("a number of steps is needed")? as f64 * run.size)?;
    let end = trace.at(f64::INFINITY);
    let largest = trace.records.iter().map(|record| record.contact_energy).fold(0.0, f64::max);
    let smallest = trace.records.iter().filter_map(|record| record.smallest_gap).fold(1.0, f64::min);
    let values = vec![
        (end.kinetic_energy - kinetic) / end.total_energy,
        (end.strain_energy - strain) / end.total_energy,
        (largest - layers) / end.total_energy,
        smallest - gap,
    ];
    Ok(Measured::of(values, &trace))
}

fn meeting(problem: &Problem, run: &Run, end: f64) -> Result<Trace, String> {
    let part = |name: &str, cells: usize, at: &str| {
        format!(
            "{{ name = \"{name}\", box = {{ size = [1.0, 1.0, 1.0], cells = [{cells}, {cells}, {cells}] }}{at} }}"
        )
    };
    let parts = [part("lower", 2, ""), part("upper", run.cells, ", at = [0.23, 1.07, 0.17]")].join(", ");
    let set = [
        ("mesh.parts", format!("[{parts}]")),
        ("time.steps", format!("[{{ until = {end}, size = {} }}]", run.size)),
    ];
    Trace::of(problem, run, &set)
}
