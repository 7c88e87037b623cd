//! Parameters of each material.

use super::super::materials::good;
use super::{MATERIAL, Mistake, changed};

/// A material with one of its valid parameters changed. The message is `MODEL-NAME`.
fn parameter(model: &str, name: &str, from: &str, to: &str) -> Mistake {
    let (name, good) = (format!("{model}-{name}"), good(model));
    assert!(good.contains(from), "{name}: {from}");
    changed(&name, MATERIAL, &format!("material.{}", good.replacen(from, to, 1)))
}

pub(super) fn all() -> Vec<Mistake> {
    [keys(), kinds(), ranges(), formulas()].into_iter().flatten().collect()
}

fn keys() -> Vec<Mistake> {
    vec![
        parameter("ciarlet-geymonat", "modulus-by-two-names", "youngs_modulus", "E = 1.0, youngs_modulus"),
        parameter("hencky", "pair-and-one-more", "mu = 500", "mu = 500, poissons_ratio = 0.3"),
        parameter("mooney-rivlin", "bulk-modulus-in-a-small-letter", "bulk_modulus", "k"),
        parameter("mooney-rivlin", "parameter-missing", "c01 = 50.0, ", ""),
        parameter("mooney-rivlin", "by-half-its-name", "mooney-rivlin", "mooney"),
        parameter("yeoh", "parameter-cut-short", "c20", "c2"),
        parameter("gent", "modulus-in-other-words", "mu", "shear_modul"),
        parameter("arruda-boyce", "locking-stretch-in-words", "lambda_m", "locking_stretch"),
        parameter("ogden", "no-bulk-modulus", ", bulk_modulus = 1e3", ""),
        parameter("orthotropic", "shear-modulus-of-textbooks", "mu_23", "G23"),
        parameter("orthotropic", "ratio-missing", "poissons_ratio_13 = 0.47, ", ""),
        parameter("holzapfel-gasser-ogden", "american-fibers", "fibres", "fibers"),
        parameter("holzapfel-gasser-ogden", "by-its-letters", "holzapfel-gasser-ogden", "hgo"),
    ]
}

fn kinds() -> Vec<Mistake> {
    vec![
        parameter("mooney-rivlin", "law-misspelt", "'miehe'", "'mihe'"),
        parameter("mooney-rivlin", "law-by-number", "'miehe'", "2"),
        parameter("yeoh", "nan", "5.0", "nan"),
        parameter("ogden", "number-for-a-list", "[630.0, 1.2, -10.0]", "630.0"),
        parameter("ogden", "empty-list", "[630.0, 1.2, -10.0]", "[]"),
        parameter("ogden", "list-too-short", "[1.3, 5, -2]", "[1.3, 5]").unseen(),
        parameter("ogden", "word-in-a-list", "-2]", "'two']"),
        parameter("orthotropic", "axis-in-the-plane", "[0, 1, 0]", "[0, 1]"),
        parameter("holzapfel-gasser-ogden", "fibre-without-its-list", "[[1, 1, 0], [-1, 1, 0]]", "[1, 1, 0]"),
        parameter("holzapfel-gasser-ogden", "no-fibres", "[[1, 1, 0], [-1, 1, 0]]", "[]"),
    ]
}

fn ranges() -> Vec<Mistake> {
    vec![
        parameter("ciarlet-geymonat", "incompressible", "0.3", "0.5"),
        parameter("hencky", "no-shear-modulus", "mu = 500", "mu = 0"),
        parameter("hencky", "lambda-too-small", "lambda = 1000", "lambda = -400").unseen(),
        parameter("mooney-rivlin", "negative-sum", "c01 = 50.0", "c01 = -200.0").unseen(),
        parameter("mooney-rivlin", "no-bulk-stiffness", "1e3", "0"),
        parameter("yeoh", "negative-c10", "200.0", "-200.0"),
        parameter("gent", "no-locking", "30.0", "0.0"),
        parameter("gent", "negative-modulus", "500.0", "-1"),
        parameter("arruda-boyce", "locked", "3.0", "1.0"),
        parameter("ogden", "exponent-of-nothing", "[1.3, 5, -2]", "[1.3, 0, -2]").unseen(),
        parameter("ogden", "negative-term", "630.0", "-630.0").unseen(),
        parameter("orthotropic", "negative-modulus", "youngs_modulus_2 = 800", "youngs_modulus_2 = -800"),
        parameter("orthotropic", "ratio-too-large", "0.37", "4.0").unseen(),
        parameter("orthotropic", "ratios-too-large-together", "0.43", "1.32").unseen(),
        parameter("orthotropic", "no-shear", "mu_23 = 30", "mu_23 = 0"),
        parameter("orthotropic", "axis-of-nothing", "[0, 1, 0]", "[0, 0, 0]").unseen(),
        parameter("orthotropic", "axes-in-one-line", "[0, 0, 1]", "[0, -2, 0]").unseen(),
        parameter("orthotropic", "second-axis-missing", ", axis_2 = [0, 0, 1]", "").unseen(),
        parameter("holzapfel-gasser-ogden", "no-stiffness-of-fibres", "k1 = 200.0", "k1 = 0"),
        parameter("holzapfel-gasser-ogden", "negative-exponent", "k2 = 0.8", "k2 = -0.8"),
        parameter("holzapfel-gasser-ogden", "too-much-dispersion", "kappa = 0.1", "kappa = 0.34"),
        parameter("holzapfel-gasser-ogden", "fibre-of-nothing", "[-1, 1, 0]", "[0, 0, 0]").unseen(),
    ]
}

/// Mistakes in the formula of an energy.
fn formulas() -> Vec<Mistake> {
    let formula = |name: &str, from: &str, to: &str| parameter("energy", name, from, to);
    vec![
        formula("formula-missing", "formula", "formla"),
        formula("formula-of-nothing", "'mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2 + k*(I4 - 1)^2'", "' '"),
        formula("formula-by-number", "'mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2 + k*(I4 - 1)^2'", "3"),
        formula("invariant-misspelt", "I1 - 3", "I1bar - 3").unseen(),
        formula("parameter-misspelt", "lambda/2", "lamda/2").unseen(),
        formula("parameter-missing", "k = 20, ", "").unseen(),
        formula("parameter-without-use", "k = 20", "k = 20, c10 = 3").unseen(),
        formula("parameter-in-words", "k = 20", "k = 'twenty'"),
        formula("parameter-named-as-an-invariant", "k = 20", "k = 20, I3 = 2").unseen(),
        formula("kink", "(I4 - 1)^2", "max(I4 - 1, 0)^2").unseen(),
        formula("oscillation", "(I4 - 1)^2", "sin(I4 - 1)^2").unseen(),
        formula("american-fiber", "fibre", "fiber"),
        formula("fibre-missing", ", fibre = [1, 2, 0]", "").unseen(),
        formula("fibre-without-use", " + k*(I4 - 1)^2", " + k*ln(J)^2").unseen(),
        formula("stress-at-rest", " - mu*ln(J)", "").unseen(),
        formula("stress-along-the-fibre", "k*(I4 - 1)^2", "k*I4").unseen(),
        formula("no-shear-modulus", "mu = 500", "mu = 0").unseen(),
        formula("soft-fibre", "k = 20", "k = -1000").unseen(),
        formula("root-of-zero", "(I4 - 1)^2", "sqrt(I4 - 1)").unseen(),
        formula("volume-that-is-no-law", "lambda/2*ln(J)^2", "lambda*(J - 1)^4 + lambda*ln(J)^2")
            .and("density = 2.0", "density = 2.0\nformulation = 'projected-volume'")
            .unseen(),
        formula("bracket-missing", "(I4 - 1)^2", "(I4 - 1^2").unseen(),
    ]
}
