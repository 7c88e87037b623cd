//! Every scheme with every material and degree: a run that satisfies the balances of the scheme, or a message.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::attack::{Attack, Cases, Trial};
use crate::faults;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "combinations",
    what: "schemes, materials and degrees on a tiny body: exit code 0 with the balances promised, or 2",
    share: 2.0,
    cases: Cases::Listed(|emmy| emmy.list("schemes").len() * emmy.list("materials").len() * DEGREES),
    trial,
};

/// Degrees, and one too many.
const DEGREES: usize = 9;

/// Largest residual from rounding, relative to the scale of the run.
const ROUND_OFF: f64 = 1e-11;

fn trial(trial: &mut Trial<'_>) -> Result<(), String> {
    let (schemes, materials) = (trial.emmy.list("schemes"), trial.emmy.list("materials"));
    let number = trial.number as usize;
    let (degree, rest) = (1 + number % DEGREES, number / DEGREES);
    let (name, material) = (&schemes[rest % schemes.len()], &materials[rest / schemes.len()]);
    let scheme = scheme(name, degree).ok_or_else(|| format!("unknown scheme: {name}"))?;
    let model = material_of(material).ok_or_else(|| format!("unknown material: {material}"))?;
    trial.place.write("run.toml", input(&scheme, degree, model));
    let outcome = trial.emmy.call(trial.place.path(""), ["run", "run.toml", "--quiet"]).run();
    let what = format!("{scheme}, degree {degree}, {material}");
    faults::ends_with(&outcome, &[0, 2]).map_err(|fault| format!("{fault}\n{what}"))?;
    // At least one degree of every time element must run.
    let is_expected = degree == 1 || degree <= 8 && is_time_element(name);
    if (outcome.code == Some(0)) != is_expected {
        return Err(format!("exit code {:?}: {what}\n{}", outcome.code, outcome.stderr));
    }
    if outcome.code != Some(0) {
        return Ok(());
    }
    let directory = trial.place.path("run");
    faults::is_finite(&directory.join("history.csv")).map_err(|fault| format!("{fault}\n{what}"))?;
    balances(&directory, name, &scheme, degree).map_err(|fault| format!("{fault}: {what}"))
}

/// A scheme with its arguments for a degree.
fn scheme(name: &str, degree: usize) -> Option<String> {
    Some(match name {
        "FE(n)" | "AS(n)" => name.replace('n', &degree.to_string()),
        "Lobatto(n)" => format!("Lobatto({})", degree + 1),
        "AS(n,rho)" => format!("AS({degree},0.5)"),
        "DGM(rho)" => "DGM(0.5)".into(),
        "Newmark(beta,gamma)" => "Newmark(0.25,0.5)".into(),
        "HHT(alpha)" => "HHT(0.05)".into(),
        "generalized-alpha(rho)" => "generalized-alpha(0.8)".into(),
        "DGM" | "trapezoidal" | "Bathe" | "central-differences" => name.into(),
        _ => return None,
    })
}

fn is_time_element(name: &str) -> bool {
    ["FE(", "AS(", "DGM", "Lobatto("].iter().any(|start| name.starts_with(start))
}

/// Parameters of a material.
fn material_of(name: &str) -> Option<&'static str> {
    Some(match name {
        "saint-venant-kirchhoff" => {
            "saint-venant-kirchhoff = { youngs_modulus = 100.0, poissons_ratio = 0.3 }"
        }
        "neo-hooke" => "neo-hooke = { lambda = 80.0, mu = 40.0 }",
        "ciarlet-geymonat" => "ciarlet-geymonat = { lambda = 80.0, mu = 40.0 }",
        "hencky" => "hencky = { lambda = 80.0, mu = 40.0 }",
        "neo-hooke-isochoric" => "neo-hooke-isochoric = { mu = 40.0, bulk_modulus = 90.0 }",
        "mooney-rivlin" => "mooney-rivlin = { c10 = 15.0, c01 = 5.0, bulk_modulus = 90.0 }",
        "yeoh" => "yeoh = { c10 = 20.0, c20 = 1.0, c30 = 0.1, bulk_modulus = 90.0 }",
        "gent" => "gent = { mu = 40.0, jm = 20.0, bulk_modulus = 90.0 }",
        "arruda-boyce" => "arruda-boyce = { mu = 40.0, lambda_m = 3.0, bulk_modulus = 90.0 }",
        "ogden" => "ogden = { mu = [40.0, -1.0], alpha = [1.3, -2.0], bulk_modulus = 90.0 }",
        "orthotropic" => {
            "orthotropic = { youngs_modulus_1 = 100.0, youngs_modulus_2 = 60.0, youngs_modulus_3 = 50.0, \
             poissons_ratio_12 = 0.3, poissons_ratio_23 = 0.2, poissons_ratio_13 = 0.25, mu_12 = 30.0, mu_23 = 20.0, \
             mu_13 = 25.0 }"
        }
        "holzapfel-gasser-ogden" => {
            "holzapfel-gasser-ogden = { mu = 30.0, k1 = 10.0, k2 = 1.0, fibres = [[1, 1, 0]], bulk_modulus = 90.0 }"
        }
        "energy" => "energy = { formula = 'mu/2*(I1 - 3) - mu*ln(J) + K/2*(J - 1)^2', mu = 40.0, K = 90.0 }",
        "bar" => "bar = { youngs_modulus = 100.0, area = 1.0 }",
        "spring" => "spring = { stiffness = 50.0 }",
        "attraction" => "attraction = { strength = 2.0 }",
        _ => return None,
    })
}

/// A free body that rotates and vibrates.
fn input(scheme: &str, degree: usize, model: &str) -> String {
    let is_link = ["bar", "spring", "attraction"].iter().any(|name| model.starts_with(name));
    let mesh = match is_link {
        true => {
            "network = { points = [[0, 0, 0], [2, 0, 0], [0, 2, 0]], links = [[0, 1], [1, 2], [2, 0]] }\n"
        }
        false => "box = { size = [1, 2, 1], cells = [1, 2, 1] }\n",
    };
    let density =
        if model.starts_with("spring") || model.starts_with("attraction") { "" } else { "density = 1.0\n" };
    let mass = if is_link { "[[mass]]\ngroup = \"links\"\nmass = 1.0\n" } else { "" };
    let size = if scheme == "central-differences" { 0.002 } else { 0.02 };
    format!(
        "[mesh]\n{mesh}[[region]]\n{density}material.{model}\n{mass}[initial]\nvelocity = [0.1, 0.2, 0.3]\n\
         angular_velocity = [0.2, -0.1, 1.0]\nabout = [0.5, 1.0, 0.5]\n\
         gradient = [[0.3, 0.1, 0.0], [0.0, -0.2, 0.1], [0.1, 0.0, 0.2]]\n[time]\nscheme = \"{scheme}\"\n\
         degree = {degree}\nsteps = [{{ until = {}, size = {size} }}]\n[output]\nevery = 0\ncheckpoint_every = 0\n",
        8.0 * size
    )
}

/// Checks the balances of a scheme for a free body.
fn balances(directory: &Path, name: &str, scheme: &str, degree: usize) -> Result<(), String> {
    let text = fs::read_to_string(directory.join("summary.json")).map_err(|error| error.to_string())?;
    let summary: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let number = |key: &str| summary[key].as_f64().unwrap_or(f64::NAN);
    let keeps_energy = name.starts_with("DGM");
    // Gauss collocation with as many points as the degree; AS and DGM always.
    let is_collocation = scheme == format!("FE({degree})") || name == "central-differences";
    let keeps_turn = name.starts_with("AS") || keeps_energy || is_collocation;
    let promises = [
        (keeps_energy, "worst_energy_residual", "largest_energy"),
        (true, "worst_linear_momentum_residual", "linear_momentum_scale"),
        (keeps_turn, "worst_angular_momentum_residual", "angular_momentum_scale"),
    ];
    for (_, residual, scale) in promises.iter().filter(|(holds, ..)| *holds) {
        let relative = number(residual).abs() / number(scale);
        if relative.is_nan() || relative > ROUND_OFF {
            return Err(format!("{residual} is {relative:.1e} of {scale}"));
        }
    }
    Ok(())
}
