//! `[equilibrium]`: static equilibrium as the start of a motion, or alone.

use emmy::time::Scheme;

use super::description::{Described, Section, whole};
use super::fault::Fault;
use super::time::Time;

/// `[equilibrium]`.
pub(super) static EQUILIBRIUM: Described = Described::new(|| {
    let doc = "Static equilibrium under the loads and driven supports at t = 0: the motion starts there; without `[time]` it is a \
               static analysis, with the load fraction as time";
    Section::new("[equilibrium]", doc)
        .may(
            "load_steps",
            whole(1),
            "",
            "Increments in which the loads grow, in proportion; one that fails is cut by two",
        )
        .default("10")
});

/// Scheme and plan of a static analysis: the load fraction takes the place of time.
pub(super) fn analysis(load_steps: usize) -> Result<Time, Fault> {
    let plan = emmy::equilibrium::increments(load_steps).map_err(|error| Fault::new(error.to_string()))?;
    Ok(Time { scheme: Scheme::Static, plan, adaptive: None, smallest_step: None })
}

/// The fault of an option for steps in time.
pub(super) fn no_time(option: &str) -> Fault {
    Fault::new(format!("{option}: there is no [time], and the load fraction of a static analysis ends at 1"))
        .help("`emmy run --set equilibrium.load_steps=20` takes other increments")
}
