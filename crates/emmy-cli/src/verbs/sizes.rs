//! Estimated sizes of the files of a run, as text.

use emmy_io::input::Problem;
use emmy_io::sizes::Sizes;

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

/// A number of bytes with two or three digits.
fn bytes(n: f64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB"];
    let power =
        (0..units.len() - 1).find(|&power| n < 1000f64.powi(power as i32 + 1)).unwrap_or(units.len() - 1);
    let value = n / 1000f64.powi(power as i32);
    let digits = usize::from(value < 10.0 && power > 0);
    format!("{value:.digits$} {}", units[power])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_their_unit() {
        let texts = [12.0, 1234.0, 385e6, 4.04e9, 385e12].map(bytes);
        assert_eq!(texts, ["12 B", "1.2 kB", "385 MB", "4.0 GB", "385 TB"]);
    }
}
