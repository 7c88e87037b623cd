//! Parameters of the input, and numbers that a body must have.

use super::{Mistake, changed};

/// [`super::BOX`] with a density that is computed.
fn density(name: &str, parameters: &str, density: &str) -> Mistake {
    changed(name, "density = 2.0", &format!("density = \"{density}\""))
        .and("[mesh]", &format!("[parameters]\n{parameters}\n\n[mesh]"))
}

fn expected(name: &str, own: &str) -> Mistake {
    changed(name, "[mesh]", &format!("[expect]\n{own}\n\n[mesh]")).unseen()
}

pub(super) fn all() -> Vec<Mistake> {
    vec![
        density("parameter-in-an-expression-misspelt", "steel = 7850.0", "= 2*stell").unseen(),
        density("parameters-in-a-circle", "a = \"= 2*b\"\nb = \"= a/2\"", "= a").unseen(),
        density("parameter-that-is-a-constant", "e = 2.0", "= 2*e").unseen(),
        density("parameter-in-words", "rho = \"7850\"", "= rho"),
        density("expression-without-an-end", "rho = 2.0", "= 2*(rho").unseen(),
        density("expression-without-a-sign", "rho = 2.0", "2*rho"),
        density("expression-out-of-range", "rho = 2.0", "= -rho").unseen(),
        density("expression-of-zero", "rho = 0", "= 1/rho").unseen(),
        changed("half-a-computed-step", "every = 2", "every = \"= 5/2\"").unseen(),
        // The box has the volume 2 and the mass 4.
        expected("volume-in-another-unit", "volume = 2e-9"),
        expected("mass-in-another-unit", "mass = 4e-12"),
        expected("mass-of-another-mesh", "mass = 4e9"),
        expected("mass-of-another-body", "mass = 5.0\ntolerance = 0.1"),
        expected("volume-and-mass-in-other-units", "volume = 2e9\nmass = 4e12"),
        changed("nothing-expected", "[mesh]", "[expect]\n\n[mesh]"),
    ]
}
