//! What acts on the body and what holds it.

use super::{Mistake, changed};

const FIX: &str = "fix = [\"x\", \"y\", \"z\"]";
const TRACTION: &str = "traction = [0.0, 0.0, 10.0]";
const HISTORY: &str = "history = [[0.0, 0.0], [0.5, 1.0]]";

pub(super) fn all() -> Vec<Mistake> {
    vec![
        changed("two-kinds-of-load", TRACTION, "force = [1, 0, 0]\ntraction = [0, 0, 10]"),
        changed("no-kind-of-load", &format!("{TRACTION}\n"), ""),
        changed("attraction-with-a-history", TRACTION, "attraction = { centre = [0, 9, 0], strength = 1 }")
            .unseen(),
        changed(
            "attraction-without-strength",
            &format!("{TRACTION}\n{HISTORY}"),
            "attraction = { centre = [0, 9, 0], strength = 0 }",
        ),
        changed(
            "attraction-without-a-centre",
            &format!("{TRACTION}\n{HISTORY}"),
            "attraction = { strength = 1 }",
        ),
        changed("drag-on-a-group", TRACTION, "drag = 0.5").unseen(),
        changed("drag-that-pushes", &format!("group = \"y-max\"\n{TRACTION}\n{HISTORY}"), "drag = -0.5"),
        changed("history-that-goes-back", HISTORY, "history = [[0.5, 0.0], [0.0, 1.0]]").unseen(),
        changed("history-without-entries", HISTORY, "history = []"),
        changed("history-of-an-unknown-function", HISTORY, "history = \"2*sine(t)\"").unseen(),
        changed("history-of-an-unknown-variable", HISTORY, "history = \"2*x\"").unseen(),
        changed("history-with-an-open-bracket", HISTORY, "history = \"sin(2*pi*t\"").unseen(),
        changed("history-as-in-python", HISTORY, "history = \"t**2\"").unseen(),
        changed("history-with-a-product-left-out", HISTORY, "history = \"2 pi t\"").unseen(),
        changed("history-with-a-kink", HISTORY, "history = \"min(t, 1)\"").unseen(),
        changed("history-with-a-pole", HISTORY, "history = \"1/(t - 0.25)\"").unseen(),
        changed("support-without-a-kind", &format!("{FIX}\n"), ""),
        changed("component-that-is-none", FIX, "fix = [\"x\", \"w\"]"),
        changed("components-by-number", FIX, "fix = [1, 2, 3]"),
        changed("components-as-flags", FIX, "fix = [true, true, false]"),
        changed("nothing-fixed", FIX, "fix = []"),
        changed("moved-by-a-number", FIX, "move = { x = 0.1 }"),
        changed("moved-by-a-jump", FIX, "move = { y = [[0, 0], [1, 0], [1, 2]] }").unseen(),
        changed("moved-from-elsewhere", FIX, "move = { x = \"cos(t)\" }").unseen(),
        changed("fixed-and-moved", FIX, "fix = [\"x\"]\nmove = { x = \"t\" }").unseen(),
        changed("fixed-and-turned", FIX, "fix = [\"x\"]\nrotate = { axis = [0, 0, 1], angle = \"t\" }")
            .unseen(),
        changed("turned-about-no-axis", FIX, "rotate = { axis = [0, 0, 0], angle = \"t\" }").unseen(),
        changed("turned-by-no-angle", FIX, "rotate = { axis = [0, 0, 1] }"),
        changed("spring-that-is-released", FIX, "spring = 1.0\nuntil = 0.2").unseen(),
        changed("symmetry-of-a-body", FIX, "symmetry = true")
            .with(&["--set", "support.0.group=body"])
            .unseen(),
        changed("no-symmetry", FIX, "symmetry = false"),
    ]
}
