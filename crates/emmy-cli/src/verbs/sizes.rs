//! Estimated sizes of the files of a run, as text.

use emmy_io::input::Problem;
use emmy_io::sizes::{Sizes, bytes};

/// History, logs, frames and checkpoints of a problem.
pub(super) fn text(problem: &Problem) -> String {
    let sizes = Sizes::of(problem);
    let plan = &problem.plan;
    // With an unknown number of steps, the sizes are for one step.
    let (n_steps, each) = match plan.adaptivity() {
        Some(_) => (1.0, " a step"),
        None => (plan.n_steps() as f64, ""),
    };
    let mut parts = vec![format!("history about {}{each}", bytes(sizes.row * n_steps))];
    if sizes.logged_step > 0.0 {
        parts.push(format!("newton.csv and run.log about {}{each}", bytes(sizes.logged_step * n_steps)));
    }
    match problem.output.n_frames(plan) {
        Some(0) => {}
        Some(n) => parts.push(format!("frames at most {}", bytes(sizes.frame * n as f64))),
        None => parts.push(format!("frames at most {} each", bytes(sizes.frame))),
    }
    if problem.output.checkpoint_every > 0 {
        parts.push(format!("two checkpoints of about {}", bytes(sizes.checkpoint)));
    }
    parts.join(", ")
}
