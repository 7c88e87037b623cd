//! Schemes and steps.

use super::{Mistake, STEPS, changed};

fn scheme(name: &str, to: &str) -> Mistake {
    changed(name, "\"AS(2)\"", &format!("\"{to}\""))
}

fn adaptive(name: &str, settings: &str) -> Mistake {
    changed(name, STEPS, &format!("adaptive = {{ {settings} }}\nuntil = 0.5"))
}

pub(super) fn all() -> Vec<Mistake> {
    vec![
        scheme("scheme-in-small-letters", "as2"),
        scheme("scheme-misspelt", "DMG"),
        scheme("scheme-by-its-other-name", "midpoint"),
        scheme("scheme-that-is-none", "leapfrog"),
        scheme("scheme-without-points", "AS(0)"),
        scheme("scheme-with-half-its-numbers", "Newmark(0.25)"),
        scheme("scheme-with-numbers-out-of-range", "HHT(0.9)").unseen(),
        scheme("scheme-with-a-radius-out-of-range", "DGM(1.2)").unseen(),
        scheme("scheme-that-dissipates-by-nothing", "AS(5,)"),
        scheme("scheme-that-dissipates-beside-motion", "DGM(0.5)")
            .with(&["--set", "support.0={ group = 'y-min', move = { x = 't' } }"])
            .unseen(),
        scheme("scheme-without-damping", "Bathe")
            .with(&["--set", "region.0.viscosity={ time = 0.1 }"])
            .unseen(),
        changed("scheme-with-too-few-points", "degree = 1", "degree = 3").unseen(),
        scheme("scheme-of-degree-one", "trapezoidal").with(&["--set", "time.degree=2"]).unseen(),
        scheme("scheme-that-cannot-move-supports", "Bathe")
            .with(&["--set", "support.0={ group = 'y-min', move = { x = 't' } }"])
            .unseen(),
        changed("degree-too-high", "degree = 1", "degree = 9"),
        scheme("scheme-with-a-number-too-large", "AS(9, 2)").unseen(),
        changed("degree-of-nothing", "degree = 1", "degree = 0"),
        scheme("explicit-steps-beyond-the-critical-one", "central-differences").unseen(),
        changed(
            "steps-lost-in-the-rounding-of-the-time",
            STEPS,
            "steps = [{ until = 0.2, size = 0.1 }, { until = 0.20000000000000004, size = 1e-17 }]",
        )
        .unseen(),
        changed("no-steps", STEPS, "steps = []"),
        changed(
            "plan-that-goes-back",
            STEPS,
            "steps = [{ until = 0.5, size = 0.1 }, { until = 0.2, size = 0.1 }]",
        )
        .unseen(),
        changed("plan-that-stands-still", STEPS, "steps = [{ until = 0, size = 0.1 }]").unseen(),
        changed("step-backwards", STEPS, "steps = [{ until = 0.5, size = -0.1 }]"),
        changed("step-of-no-size", STEPS, "steps = [{ until = 0.5, size = 0 }]"),
        changed("more-steps-than-anyone-waits-for", STEPS, "steps = [{ until = 1.0, size = 1e-300 }]")
            .unseen(),
        changed("adaptive-steps-without-an-end", STEPS, "adaptive = { tolerance = 1e-4 }").unseen(),
        changed("adaptive-steps-without-a-tolerance", STEPS, "adaptive = { max_size = 0.1 }\nuntil = 0.5"),
        adaptive("adaptive-tolerance-of-nothing", "tolerance = 0"),
        adaptive("adaptive-tolerance-misspelt", "tol = 1e-4"),
        adaptive("adaptive-sizes-that-contradict", "tolerance = 1e-4, min_size = 0.2, max_size = 0.1")
            .unseen(),
        adaptive("adaptive-first-size-too-large", "tolerance = 1e-4, first_size = 0.2, max_size = 0.1")
            .unseen(),
        adaptive("adaptive-end-inside", "tolerance = 1e-4, until = 2.0"),
        adaptive("estimator-misspelt", "tolerance = 1e-4, estimator = 'residuals'"),
        adaptive("estimator-of-degree-one", "tolerance = 1e-4, estimator = 'difference'")
            .with(&["--set", "time.degree=2"])
            .unseen(),
        adaptive("degrees-the-wrong-way-round", "tolerance = 1e-4, min_degree = 3, max_degree = 2").unseen(),
        adaptive("lowest-degree-without-a-highest", "tolerance = 1e-4, min_degree = 1").unseen(),
        adaptive("first-degree-outside", "tolerance = 1e-4, max_degree = 3")
            .with(&["--set", "time.degree=4", "--set", "time.scheme=DGM"])
            .unseen(),
        changed("frames-by-steps-and-by-time", "every = 2", "every = 2\ninterval = 0.1").unseen(),
        changed("frames-between-steps", "every = 2", "interval = 0.03").unseen(),
        changed("frames-at-no-interval", "every = 2", "interval = 0"),
        adaptive("adaptive-steps-of-another-method", "tolerance = 1e-4")
            .with(&["--set", "time.scheme=Bathe"])
            .unseen(),
        adaptive("adaptive-steps-beside-a-plan", "tolerance = 1e-4")
            .with(&["--set", "time.steps=[{ until = 1, size = 0.1 }]"])
            .unseen(),
        adaptive("adaptive-steps-with-a-smallest-step", "tolerance = 1e-4")
            .with(&["--set", "time.smallest_step=0.1"])
            .unseen(),
        changed("end-of-a-plan-with-ends", STEPS, &format!("{STEPS}\nuntil = 1.0")).unseen(),
        changed("plan-without-an-end", STEPS, "steps = [{ until = 1e100, size = 0.1 }]").unseen(),
        changed("end-without-steps", STEPS, "until = 0.5"),
        adaptive("adaptive-tolerance-below-nothing", "tolerance = -1e-3"),
        changed(
            "adaptive-steps-that-end-before-the-start",
            STEPS,
            "adaptive = { tolerance = 1e-4 }\nuntil = -0.5",
        )
        .unseen(),
        adaptive("adaptive-steps-beside-a-smallest-step", "tolerance = 1e-4")
            .and("until = 0.5", "until = 0.5\nsmallest_step = 0.1")
            .unseen(),
        adaptive("adaptive-steps-and-a-plan", "tolerance = 1e-4")
            .and("until = 0.5", &format!("until = 0.5\n{STEPS}"))
            .unseen(),
    ]
}
