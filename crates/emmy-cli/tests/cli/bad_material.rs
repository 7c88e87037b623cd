//! Materials of the input: each one runs, and every bad parameter is refused by its name, on its line.

use super::{BOX, Place};

const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";

/// Every model with good parameters.
const GOOD: [&str; 11] = [
    "saint-venant-kirchhoff = { lambda = 1000.0, mu = 500.0 }",
    "neo-hooke = { lambda = 1000.0, mu = 500.0 }",
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
];

/// What is changed in the model of that number in [`GOOD`], and what the message must say.
const CASES: &[(usize, &str, &str, &[&str])] = &[
    // Keys.
    (2, "youngs_modulus", "E", &["unknown key `E`", "did you mean `youngs_modulus`?"]),
    (3, "mu = 500", "mu = 500, poissons_ratio = 0.3", &["`hencky` needs exactly one pair"]),
    (4, "bulk_modulus", "K", &["unknown key `K` in mooney-rivlin", "did you mean `bulk_modulus`?"]),
    (4, "c01 = 50.0, ", "", &["`c01` is missing in mooney-rivlin"]),
    (4, "mooney-rivlin", "mooney", &["unknown key `mooney`", "did you mean `mooney-rivlin`?"]),
    (5, "c20", "c2", &["unknown key `c2` in yeoh"]),
    (6, "mu", "shear_modulus", &["did you mean `mu`?"]),
    (7, "lambda_m", "locking_stretch", &["did you mean `lambda_m`?"]),
    (8, ", bulk_modulus = 1e3", "", &["`bulk_modulus` is missing in ogden"]),
    (9, "mu_23", "G23", &["did you mean `mu_23`?"]),
    (9, "poissons_ratio_13 = 0.47, ", "", &["`poissons_ratio_13` is missing in orthotropic"]),
    (10, "fibres", "fibers", &["did you mean `fibres`?"]),
    (10, "holzapfel-gasser-ogden", "hgo", &["did you mean `holzapfel-gasser-ogden`?"]),
    // Kinds of values.
    (4, "'miehe'", "'mihe'", &["`mihe` is not a law of volume", "did you mean `miehe`?", "`simo-taylor`"]),
    (4, "'miehe'", "2", &["`volumetric` must be one of `logarithmic`", "not a whole number"]),
    (5, "5.0", "nan", &["`c30` must be a finite number"]),
    (8, "[630.0, 1.2, -10.0]", "630.0", &["`mu` must be a list"]),
    (8, "[630.0, 1.2, -10.0]", "[]", &["`mu` is empty"]),
    (8, "[1.3, 5, -2]", "[1.3, 5]", &["`mu` has 3 entries and `alpha` 2"]),
    (8, "-2]", "'two']", &["`alpha` must be a number, not a string"]),
    (9, "[0, 1, 0]", "[0, 1]", &["`axis_1` must have 3 numbers"]),
    (
        10,
        "[[1, 1, 0], [-1, 1, 0]]",
        "[1, 1, 0]",
        &["`fibres` must be a list of 3 numbers, not a whole number"],
    ),
    (10, "[[1, 1, 0], [-1, 1, 0]]", "[]", &["`fibres` is empty"]),
    // Out of range.
    (2, "0.3", "0.5", &["ciarlet-geymonat: poissons_ratio = 0.5"]),
    (3, "mu = 500", "mu = 0", &["hencky: mu = 0 must be positive"]),
    (3, "lambda = 1000", "lambda = -400", &["hencky: lambda = -400"]),
    (4, "c01 = 50.0", "c01 = -200.0", &["c01 = -200 must make c10 + c01 positive"]),
    (4, "1e3", "0", &["mooney-rivlin: bulk_modulus = 0 must be positive"]),
    (5, "200.0", "-200.0", &["yeoh: c10 = -200 must be positive"]),
    (6, "30.0", "0.0", &["gent: jm = 0 must be positive"]),
    (6, "500.0", "-1", &["gent: mu = -1 must be positive"]),
    (7, "3.0", "1.0", &["arruda-boyce: lambda_m = 1 must be finite and larger than 1"]),
    (8, "[1.3, 5, -2]", "[1.3, 0, -2]", &["ogden: alpha = 0 must be finite and not zero"]),
    (8, "630.0", "-630.0", &["is the sum of mu alpha"]),
    (9, "youngs_modulus_2 = 800", "youngs_modulus_2 = -800", &["orthotropic: youngs_modulus_2 = -800"]),
    (9, "0.37", "4.0", &["orthotropic: poissons_ratio_12 = 4 must be smaller in size"]),
    (9, "0.43", "1.32", &["orthotropic: poissons_ratio_23 = 1.32 is too large together"]),
    (9, "mu_23 = 30", "mu_23 = 0", &["orthotropic: mu_23 = 0 must be positive"]),
    (9, "[0, 1, 0]", "[0, 0, 0]", &["orthotropic: axis_1 = 0", "not zero"]),
    (9, "[0, 0, 1]", "[0, -2, 0]", &["orthotropic: axis_2 = 0", "differ in direction"]),
    (9, ", axis_2 = [0, 0, 1]", "", &["orthotropic: axis_2 = 0", "differ in direction"]),
    (10, "k1 = 200.0", "k1 = 0", &["holzapfel-gasser-ogden: k1 = 0 must be positive"]),
    (10, "k2 = 0.8", "k2 = -0.8", &["holzapfel-gasser-ogden: k2 = -0.8 must be positive"]),
    (10, "kappa = 0.1", "kappa = 0.34", &["kappa = 0.34 must lie between 0 (parallel) and 1/3"]),
    (10, "[-1, 1, 0]", "[0, 0, 0]", &["holzapfel-gasser-ogden: fibres = 0", "not zero"]),
];

fn with_material(material: &str) -> String {
    BOX.replacen(MATERIAL, &format!("material.{material}"), 1)
}

#[test]
fn every_model_runs_with_good_parameters() {
    for material in GOOD {
        let place = Place::with(&with_material(material));
        place.succeed(&["run", "box.toml", "--quiet"]);
        // What holds is written down, and gives the same run.
        place.succeed(&["run", "out/input.toml", "--quiet", "--output", "again"]);
        assert_eq!(
            place.history("out")["total_energy"],
            place.history("again")["total_energy"],
            "{material}"
        );
    }
}

#[test]
fn values_that_are_left_out_are_written_down() {
    let orthotropic = GOOD[9].replace(", axis_1 = [0, 1, 0], axis_2 = [0, 0, 1]", "");
    for (material, values) in [
        (GOOD[8], "volumetric = \"simo-taylor\""),
        (&orthotropic, "axis_1 = [1, 0, 0], axis_2 = [0, 1, 0]"),
        (&GOOD[10].replace(", volumetric = 'simo-taylor'", ""), "volumetric = \"simo-taylor\""),
        (&GOOD[10].replace("kappa = 0.1, ", ""), "kappa = 0.0"),
    ] {
        let place = Place::with(&with_material(material));
        place.succeed(&["run", "box.toml", "--quiet"]);
        assert!(place.read("out/input.toml").contains(values), "{}", place.read("out/input.toml"));
    }
}

#[test]
fn bad_parameters_are_refused_on_their_line() {
    let line = BOX.lines().position(|line| line == MATERIAL).unwrap() + 1;
    for (model, from, to, says) in CASES {
        assert!(GOOD[*model].contains(from), "{from}");
        let input = with_material(&GOOD[*model].replacen(from, to, 1));
        let place = Place::with(&input);
        let outcome = place.emmy(&["run", "box.toml"]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{to}: {}", outcome.stderr);
        for part in says.iter().copied().chain([format!("box.toml:{line}:").as_str()]) {
            assert!(outcome.stderr.contains(part), "\"{part}\" is not in\n{}", outcome.stderr);
        }
        assert_eq!(place.names("."), ["box.toml"], "{to}");
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
