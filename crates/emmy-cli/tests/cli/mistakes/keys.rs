//! Keys that are not keys, or not there.

use super::{Mistake, changed, whole};

pub(super) fn all() -> Vec<Mistake> {
    vec![
        changed("log-interval", "every = 2", "every = 2\nlog_evry = 10"),
        changed("key-misspelt", "density", "densty"),
        changed("key-in-capitals", "density", "Density"),
        changed("key-with-a-hyphen", "max_iterations", "max-iterations"),
        changed("key-from-textbooks", "density = 2.0", "rho = 2.0"),
        changed("key-from-another-program", "size = 0.1 }", "dt = 0.1 }"),
        changed("key-of-nothing", "density = 2.0", "density = 2.0\ncolour = \"red\""),
        changed("key-of-another-section", "scheme = \"AS(2)\"", "scheme = \"AS(2)\"\nevery = 5"),
        changed("key-before-the-sections", "title = \"box\"", "title = \"box\"\nscheme = \"DGM\""),
        changed("section-misspelt", "[limits]", "[limit]"),
        changed("section-of-another-program", "[[support]]", "[[boundary]]"),
        changed("section-for-a-key", "[[load]]", "[material]\n\n[[load]]"),
        changed("gravity", "traction = [0.0, 0.0, 10.0]", "gravity = [0.0, 0.0, -9.81]"),
        changed("material-misspelt", "neo-hooke", "neohook"),
        changed("material-in-quotes", "material.neo-hooke", "\"material.neo-hooke\""),
        changed("parameter-from-textbooks", "lambda = 1000.0, mu = 500.0", "E = 1000.0, nu = 0.3"),
        changed("parameter-cut-short", "lambda = 1000.0, mu = 500.0", "youngs = 1000.0, poissons = 0.3"),
        changed("parameter-of-another-model", "lambda = 1000.0", "c10 = 1000.0"),
        changed("probe-with-another-key", "point = [0, 2, 0]", "at = [0, 2, 0]"),
        changed("viscosity-of-nothing", "density = 2.0", "density = 2.0\nviscosity = {}"),
        changed("viscosity-that-drives", "density = 2.0", "density = 2.0\nviscosity = { time = -1e-3 }"),
        changed("viscosity-with-a-number-alone", "density = 2.0", "density = 2.0\nviscosity = 0.1"),
        changed("density-missing", "density = 2.0\n", ""),
        changed("size-missing", ", size = 0.1", ""),
        changed(
            "section-missing",
            "[time]\nscheme = \"AS(2)\"\ndegree = 1\nsteps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]\n",
            "",
        ),
        whole("nothing", ""),
        whole("only-comments", "# the box\n\n"),
    ]
}
