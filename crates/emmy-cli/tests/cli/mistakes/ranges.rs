//! Values out of range, mainly of materials.

use super::{Mistake, TRACTION, changed};

const MATERIAL: &str = "neo-hooke = { lambda = 1000.0, mu = 500.0 }";
const PAIR: &str = "lambda = 1000.0, mu = 500.0";

fn model(name: &str, model: &str) -> Mistake {
    changed(name, MATERIAL, model)
}

pub(super) fn all() -> Vec<Mistake> {
    vec![
        changed("negative-density", "density = 2.0", "density = -2.0"),
        changed("no-density", "density = 2.0", "density = 0.0"),
        changed("incompressible", PAIR, "youngs_modulus = 1000.0, poissons_ratio = 0.5"),
        changed("percent", PAIR, "youngs_modulus = 1000.0, poissons_ratio = 30"),
        changed("negative-modulus", "mu = 500.0", "mu = -500.0"),
        changed("lambda-too-small", "lambda = 1000.0", "lambda = -400.0").unseen(),
        changed("half-a-pair", PAIR, "youngs_modulus = 1000.0"),
        changed("constants-of-no-solid", PAIR, "youngs_modulus = 1000.0, mu = 300.0").unseen(),
        changed("both-pairs", PAIR, "lambda = 1.0, mu = 1.0, youngs_modulus = 2.5, poissons_ratio = 0.25"),
        changed("two-models", MATERIAL, "hencky = { lambda = 1.0, mu = 1.0 }\nmaterial.neo-hooke = { lambda = 1.0, mu = 1.0 }"),
        changed("modulus-too-large", PAIR, "youngs_modulus = 1e308, poissons_ratio = 0.4999999999").unseen(),
        changed("mass-too-small", "density = 2.0", "density = 1e-300").unseen(),
        changed("load-too-large", TRACTION, "traction = [0.0, 0.0, 1e308]").unseen(),
        changed("velocity-too-large", "[initial]\nvelocity = [0, 0, 0]", "[initial]\ngroup = \"y-max\"\nvelocity = [1e200, 0, 0]").unseen(),
        model("no-bulk-modulus", "yeoh = { c10 = 1.0, c20 = 0.0, c30 = 0.0 }"),
        model("no-such-law-of-volume", "gent = { mu = 1.0, jm = 50.0, bulk_modulus = 9.0, volumetric = \"mihe\" }"),
        model("terms-without-partners", "ogden = { mu = [1.0, 2.0], alpha = [2.0], bulk_modulus = 9.0 }").unseen(),
        model("ogden-with-numbers", "ogden = { mu = 1.0, alpha = 2.0, bulk_modulus = 9.0 }"),
        model("locked-from-the-start", "arruda-boyce = { mu = 1.0, lambda_m = 1.0, bulk_modulus = 9.0 }"),
        model("too-much-dispersion", "holzapfel-gasser-ogden = { mu = 1.0, k1 = 1.0, k2 = 1.0, kappa = 0.5, fibres = [[1, 0, 0]], bulk_modulus = 9.0 }"),
        model("fibre-without-a-direction", "holzapfel-gasser-ogden = { mu = 1.0, k1 = 1.0, k2 = 1.0, fibres = [[0, 0, 0]], bulk_modulus = 9.0 }").unseen(),
        model("fibre-not-in-a-list", "holzapfel-gasser-ogden = { mu = 1.0, k1 = 1.0, k2 = 1.0, fibres = [1, 0, 0], bulk_modulus = 9.0 }"),
        model("not-positive-definite", "orthotropic = { youngs_modulus_1 = 1.0, youngs_modulus_2 = 1.0, youngs_modulus_3 = 1.0, poissons_ratio_12 = 1.2, poissons_ratio_23 = 0.0, poissons_ratio_13 = 0.0, mu_12 = 1.0, mu_23 = 1.0, mu_13 = 1.0 }").unseen(),
        model("spring-with-a-density", "spring = { stiffness = 1.0 }").unseen(),
        changed("thickness-of-a-solid", "density = 2.0", "density = 2.0\nthickness = 0.5").unseen(),
        changed("tolerance-that-is-none", "tolerance = 1e-10", "tolerance = 2"),
        changed("no-iterations", "max_iterations = 20", "max_iterations = 0"),
        changed("frames-backwards", "every = 2", "every = -1"),
        changed("log-backwards", "every = 2", "every = 2\nlog_every = -1"),
        changed("no-limit", "energy = 1e-2", "energy = 0"),
        changed("solver-of-another-program", "kind = \"auto\"", "kind = \"pardiso\""),
        changed("zero-density", "density = 2.0", "density = 0"),
        changed("large-negative-density", "density = 2.0", "density = -1e300"),
        changed("no-thickness", "density = 2.0", "density = 2.0\nthickness = 0"),
        changed("incompressible-and-soft", PAIR, "youngs_modulus = 1.0, poissons_ratio = 0.5"),
        changed("lambda-and-a-negative-ratio", "mu = 500.0", "poissons_ratio = -0.3").unseen(),
        changed("three-constants", "mu = 500.0", "mu = 500.0, K = 1.0"),
        changed("mu-alone", "lambda = 1000.0, mu", "mu"),
        changed("negative-limit", "energy = 1e-2", "energy = -1"),
    ]
}
