//! Materials of the input: each one runs, and appears in the resolved input.

use super::{BOX, Place};

const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";

/// Every model with valid parameters.
const GOOD: [&str; 13] = [
    "saint-venant-kirchhoff = { lambda = 1000.0, mu = 500.0 }",
    "neo-hooke = { lambda = 1000.0, mu = 500.0 }",
    "neo-hooke-isochoric = { mu = 500.0, bulk_modulus = 1e3, volumetric = 'liu' }",
    "ciarlet-geymonat = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }",
    "hencky = { lambda = 1000, mu = 500 }",
    "mooney-rivlin = { c10 = 200.0, c01 = 50.0, bulk_modulus = 1e3, volumetric = 'miehe' }",
    "yeoh = { c10 = 200.0, c20 = -10.0, c30 = 5.0, bulk_modulus = 1e3, volumetric = 'quadratic' }",
    "gent = { mu = 500.0, jm = 30.0, bulk_modulus = 1e3, volumetric = 'logarithmic' }",
    "arruda-boyce = { mu = 500.0, lambda_m = 3.0, bulk_modulus = 1e3, volumetric = 'liu' }",
    "ogden = { mu = [630.0, 1.2, -10.0], alpha = [1.3, 5, -2], bulk_modulus = 1e3 }",
    "orthotropic = { youngs_modulus_1 = 1e4, youngs_modulus_2 = 800, youngs_modulus_3 = 450, poissons_ratio_12 = 0.37, \
     poissons_ratio_23 = 0.43, poissons_ratio_13 = 0.47, mu_12 = 640, mu_23 = 30, mu_13 = 580, axis_1 = [0, 1, 0], \
     axis_2 = [0, 0, 1] }",
    "holzapfel-gasser-ogden = { mu = 300.0, k1 = 200.0, k2 = 0.8, kappa = 0.1, fibres = [[1, 1, 0], [-1, 1, 0]], \
     bulk_modulus = 1e3, volumetric = 'simo-taylor' }",
    "energy = { formula = 'mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2 + k*(I4 - 1)^2', mu = 500, lambda = 1000.0, k = 20, \
     fibre = [1, 2, 0] }",
];

/// The valid parameters of a model.
pub(crate) fn good(model: &str) -> &'static str {
    let is_model = |text: &&str| text.split(' ').next() == Some(model);
    GOOD.into_iter().find(is_model).unwrap_or_else(|| panic!("no model {model}"))
}

/// [`BOX`] with another material.
fn with_material(material: &str) -> String {
    BOX.replacen(MATERIAL, &format!("material.{material}"), 1)
}

#[test]
fn every_model_runs_with_good_parameters() {
    for material in GOOD {
        let place = Place::with(&with_material(material));
        place.succeed(&["run", "box.toml", "--quiet"]);
        // The resolved input gives the same run.
        place.succeed(&["run", "out/input.toml", "--quiet", "--output", "again"]);
        assert_eq!(
            place.history("out")["total_energy"],
            place.history("again")["total_energy"],
            "{material}"
        );
    }
}

#[test]
fn a_run_with_a_formula_is_resumed_with_the_same_bits() {
    let place = Place::with(&with_material(good("energy")));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.3"]);
    place.succeed(&["resume", "out", "--until", "0.5", "--quiet"]);
    for column in ["total_energy", "strain_energy", "angular_momentum_x", "tip_x", "tip_z"] {
        assert_eq!(place.history("out")[column], place.history("whole")[column], "{column}");
    }
}

#[test]
fn values_that_are_left_out_are_written_down() {
    let orthotropic = good("orthotropic").replace(", axis_1 = [0, 1, 0], axis_2 = [0, 0, 1]", "");
    for (material, values) in [
        (good("ogden"), "volumetric = \"simo-taylor\""),
        (&orthotropic, "axis_1 = [1, 0, 0], axis_2 = [0, 1, 0]"),
        (
            &good("holzapfel-gasser-ogden").replace(", volumetric = 'simo-taylor'", ""),
            "volumetric = \"simo-taylor\"",
        ),
        (&good("holzapfel-gasser-ogden").replace("kappa = 0.1, ", ""), "kappa = 0.0"),
    ] {
        let place = Place::with(&with_material(material));
        place.succeed(&["run", "box.toml", "--quiet"]);
        assert!(place.read("out/input.toml").contains(values), "{}", place.read("out/input.toml"));
    }
}

#[test]
fn the_list_has_the_models_that_are_read() {
    let list = Place::new().succeed(&["list", "materials"]).stdout;
    let named: Vec<&str> = list.lines().filter_map(|line| line.split(' ').next()).collect();
    let solids = GOOD.iter().filter_map(|material| material.split(' ').next());
    let known: Vec<&str> = solids.chain(["bar", "spring", "attraction"]).collect();
    assert_eq!(named, known);
}
