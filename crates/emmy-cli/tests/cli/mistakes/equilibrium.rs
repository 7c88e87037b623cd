//! `[equilibrium]` and `initial.state`.

use super::{FIX, HISTORY, Mistake, changed};

/// The section before `[time]`.
fn with(name: &str, equilibrium: &str) -> Mistake {
    changed(name, "[time]", &format!("{equilibrium}\n\n[time]"))
}

/// A static analysis of the box.
fn alone(name: &str) -> Mistake {
    let time = "[time]\nscheme = \"AS(2)\"\ndegree = 1\nsteps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]";
    changed(name, time, "[equilibrium]")
}

fn state(name: &str, initial: &str) -> Mistake {
    changed(name, "velocity = [0, 0, 0]", initial)
}

pub(super) fn all() -> Vec<Mistake> {
    let support = "[[support]]\ngroup = \"y-min\"\nfix = [\"x\", \"y\", \"z\"]\n\n";
    vec![
        with("equilibrium-without-increments", "[equilibrium]\nload_steps = 0"),
        with("equilibrium-in-half-increments", "[equilibrium]\nload_steps = 2.5"),
        with("equilibrium-with-a-misspelt-key", "[equilibrium]\nload_step = 5"),
        with("equilibrium-misspelt", "[equilibrum]\nload_steps = 5"),
        with("equilibrium-without-support", "[equilibrium]").and(support, "").unseen(),
        with("equilibrium-that-may-turn", "[equilibrium]").and(FIX, "fix = [\"y\"]").unseen(),
        with("equilibrium-under-a-history-that-has-a-pole", "[equilibrium]")
            .and(HISTORY, "history = \"1/t\"")
            .unseen(),
        alone("static-with-velocities").unseen(),
        alone("static-with-an-end")
            .and("[initial]\nvelocity = [0, 0, 0]\n\n", "")
            .with(&["--until", "0.5"])
            .unseen(),
        alone("static-without-support")
            .and("[initial]\nvelocity = [0, 0, 0]\n\n", "")
            .and(support, "")
            .unseen(),
        state("state-and-velocity", "state = \"other\"\nvelocity = [0, 0, 1]").unseen(),
        state("state-that-is-a-number", "state = 3"),
        state("state-of-no-run", "state = \"other\"").unseen(),
        state("state-and-equilibrium", "state = \"other\"").and("[time]", "[equilibrium]\n\n[time]").unseen(),
        changed(
            "state-and-more",
            "[initial]\nvelocity = [0, 0, 0]",
            "[[initial]]\nstate = \"other\"\n\n[[initial]]\nvelocity = [0, 0, 1]",
        )
        .unseen(),
    ]
}
