//! The short report at the end of a run, on standard error.

use std::path::Path;

use emmy::body::Body;
use emmy_io::results::Results;
use emmy_io::summary::Status;
use emmy_io::tally::{Tally, Worst};

use crate::message::message;
use crate::print::{number, vector};

/// Fewer digits than these are worth a warning.
const FEW_DIGITS: f64 = 6.0;

/// Prints how far the run came, its worst balances, and where the files are.
pub fn report(results: &Results, status: Status, page: Option<&Path>) {
    let tally = results.tally();
    let (steps, time, seconds) = (tally.steps, number(tally.time), results.wall_seconds());
    let iterations = tally.newton_iterations;
    message!(
        "{}: {steps} steps to t = {time} in {seconds:.2} s, {iterations} Newton iterations",
        status.name()
    );
    if let Some(solver) = tally.solver {
        let (renewals, exact) = (tally.renewals, tally.steps_with_exact_tangent);
        message!(
            "linear solver: {solver}; stiffness made anew {renewals} times, exact tangent in {exact} steps"
        );
    }
    if tally.steps_at_rounding_floor > 0 {
        let floor = tally.steps_at_rounding_floor;
        message!("steps that ended at the rounding floor, above the tolerance: {floor}");
    }
    let part = |worst: Worst, whole: f64| if whole > 0.0 { worst.value / whole } else { 0.0 };
    message!("worst balance of a step:");
    worst("energy", tally.energy, Some((part(tally.energy, tally.largest_energy), "T + V")));
    worst("linear momentum", tally.linear_momentum, None);
    let angular = part(tally.angular_momentum, tally.largest_angular_momentum);
    worst("angular momentum", tally.angular_momentum, Some((angular, "|L|")));
    let most = tally.displacement;
    if most.value > 0.0 {
        let (value, time, at) = (number(most.value), number(most.time), vector(most.point));
        message!("largest displacement: {value} at t = {time}, node {} at {at}", most.node);
    }
    let directory = results.directory();
    let mut files = vec![directory.join("history.csv"), directory.join("summary.json")];
    files.extend(results.collection());
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    message!("written: {}", files.join(", "));
    if let Some(page) = page {
        message!("to look at: {}", page.display());
    }
}

/// Prints what makes the results less than they seem, if anything does.
pub fn warnings(tally: &Tally) {
    if tally.digits_left() < FEW_DIGITS {
        let digits = tally.digits_left();
        message!(
            "warning: rounding leaves {digits:.1} correct digits of energy and momenta: the body is very stiff for steps of this size"
        );
    }
    if tally.unresolved_loads > 0 {
        let (missed, steps) = (tally.unresolved_loads, tally.steps);
        message!(
            "warning: {missed} of {steps} steps did not resolve a load or a moving support; `emmy check` says which, and near which time"
        );
    }
}

/// Prints the estimated error of the positions.
pub fn error(body: &Body, error: f64) {
    let part = error / body.radius_of_gyration();
    let part =
        if part.is_finite() { format!(", {part:.1e} of the radius of gyration") } else { String::new() };
    message!("estimated error of the positions at the end: {error:.1e} in the mean{part}");
}

fn worst(name: &str, worst: Worst, relative: Option<(f64, &str)>) {
    let relative = relative.map_or(String::new(), |(part, of)| format!(", {part:.1e} of the largest {of}"));
    message!("  {name:<17}{:.2e} (step {}{relative})", worst.value, worst.step);
}
