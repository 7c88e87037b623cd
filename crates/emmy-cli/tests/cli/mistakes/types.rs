//! Values of the wrong kind.

use super::{Mistake, changed};

const TRACTION: &str = "traction = [0.0, 0.0, 10.0]";
const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";
const STEPS: &str = "steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]";

pub(super) fn all() -> Vec<Mistake> {
    vec![
        changed("number-in-quotes", "density = 2.0", "density = \"2.0\""),
        changed("number-with-a-unit-in-quotes", "density = 2.0", "density = \"7850 kg/m3\""),
        changed("number-with-a-unit", "density = 2.0", "density = 7850 kg/m3"),
        changed("decimal-comma", "density = 2.0", "density = 2,5"),
        changed("fraction", "density = 2.0", "density = 1/2"),
        changed("power-of-ten", "density = 2.0", "density = 2*10^3"),
        changed("number-without-a-leading-zero", "density = 2.0", "density = .5"),
        changed("text-without-quotes", "scheme = \"AS(2)\"", "scheme = AS(2)"),
        changed("word-without-quotes", "kind = \"auto\"", "kind = auto"),
        changed("curly-quotes", "kind = \"auto\"", "kind = “auto”"),
        changed("colon", "degree = 1", "degree: 1"),
        changed("no-value", "degree = 1", "degree ="),
        changed("nan", "density = 2.0", "density = nan"),
        changed("infinity", "density = 2.0", "density = inf"),
        // Read as infinity, which JSON has no word for.
        changed("too-large-for-a-number", "density = 2.0", "density = 1e999"),
        changed("too-large-for-a-whole-number", "density = 2.0", "density = 99999999999999999999"),
        changed("date", "title = \"box\"", "title = 2001-02-03"),
        changed("number-for-a-vector", TRACTION, "traction = 10.0"),
        changed("vector-for-a-number", TRACTION, "pressure = [0.0, 0.0, 10.0]"),
        changed("two-components", TRACTION, "traction = [0.0, 10.0]"),
        changed("component-in-quotes", TRACTION, "traction = [0.0, 0.0, \"10.0\"]"),
        changed("vector-in-round-brackets", TRACTION, "traction = (0.0, 0.0, 10.0)"),
        changed("two-rows", "velocity = [0, 0, 0]", "gradient = [[0, 0, 0], [0, 0, 0]]"),
        changed("switch-for-a-log", "every = 2", "every = 2\nlog_every = false"),
        changed("half-a-degree", "degree = 1", "degree = 1.5"),
        changed("degree-in-quotes", "degree = 1", "degree = \"1\""),
        changed("text-for-a-table", MATERIAL, "material = \"neo-hooke\""),
        changed("table-for-a-list", STEPS, "steps = { until = 0.5, size = 0.1 }"),
        changed("number-for-a-list", STEPS, "steps = 0.1"),
        changed("text-for-a-list", "fix = [\"x\", \"y\", \"z\"]", "fix = \"xyz\""),
        changed("list-for-a-section", "[mesh]", "[[mesh]]"),
        changed("number-for-a-section", "title = \"box\"", "title = \"box\"\nmass = 5.0"),
        changed("text-for-yes", "fix = [\"x\", \"y\", \"z\"]", "symmetry = \"yes\""),
        changed("number-for-a-history", "history = [[0.0, 0.0], [0.5, 1.0]]", "history = 1.0"),
        changed("three-numbers-in-a-history", "[0.5, 1.0]]", "[0.5, 1.0, 2.0]]"),
    ]
}
