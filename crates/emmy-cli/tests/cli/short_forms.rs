//! Short forms of the input and of the command line, which mean the same as the long ones; numbers that are computed or
//! expected.

use super::resume::{assert_same_rows, even_box};
use super::{BOX, Place};

const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";
const FIX: &str = "fix = [\"x\", \"y\", \"z\"]";

/// The output of `emmy check` on an input, without the sizes of files, in which the input is repeated.
fn checked(input: &str, flags: &[&str]) -> String {
    let report = Place::with(input).succeed(&[&["check", "box.toml"], flags].concat()).stdout;
    let lines = report.lines().filter(|line| !line.starts_with("files"));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn components_may_stand_in_a_word() {
    let expected = checked(BOX, &[]);
    for fix in ["\"xyz\"", "\"all\"", "\"All\"", "\"XYZ\"", "[\"X\", \"y\", \"Z\"]"] {
        assert_eq!(checked(&BOX.replace(FIX, &format!("fix = {fix}")), &[]), expected, "{fix}");
    }
    // Of 36 components, those of the four nodes of the face are fixed.
    for (fix, n) in [("\"x\"", 4), ("\"yz\"", 8), ("[\"z\"]", 4)] {
        let own = checked(&BOX.replace(FIX, &format!("fix = {fix}")), &[]);
        assert!(own.contains(&format!("36 degrees of freedom, {n} fixed")), "{fix}\n{own}");
    }
}

#[test]
fn words_may_have_any_case_but_not_groups() {
    let expected = checked(BOX, &[]);
    let shouted = BOX
        .replace("neo-hooke", "Neo-Hooke")
        .replace("\nbox = ", "\nBox = ")
        .replace("\"AS(2)\"", "\"as(2)\"")
        .replace("\"auto\"", "\"AUTO\"");
    assert_eq!(checked(&shouted, &[]), expected);
    assert_eq!(checked(BOX, &["--set", "time.scheme=dgm"]), checked(BOX, &["--set", "time.scheme=DGM"]));
    let outcome = Place::with(&BOX.replace("\"y-min\"", "\"Y-min\"")).emmy(&["check", "box.toml"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("did you mean `y-min`?"), "{}", outcome.stderr);
}

#[test]
fn elastic_constants_come_in_any_pair() {
    // lambda = 1000 and mu = 500: E = mu (3 lambda + 2 mu)/(lambda + mu), nu = lambda/(2 (lambda + mu)),
    // K = lambda + 2/3 mu.
    let (modulus, ratio, bulk) = (4000.0 / 3.0, 1.0 / 3.0, 4000.0 / 3.0);
    let expected = checked(BOX, &[]);
    for pair in [
        format!("E = {modulus:?}, nu = {ratio:?}"),
        format!("young = {modulus:?}, poisson = {ratio:?}"),
        format!("youngs_modulus = {modulus:?}, G = 500"),
        format!("E = {modulus:?}, K = {bulk:?}"),
        format!("E = {modulus:?}, lambda = 1000"),
        format!("nu = {ratio:?}, shear = 500"),
        format!("nu = {ratio:?}, bulk = {bulk:?}"),
        format!("poissons_ratio = {ratio:?}, lambda = 1000"),
        format!("shear_modulus = 500, bulk_modulus = {bulk:?}"),
        format!("K = {bulk:?}, lambda = 1000"),
    ] {
        let own = BOX.replace(MATERIAL, &format!("material.neo-hooke = {{ {pair} }}"));
        // The lowest period has six digits of the moduli.
        assert_eq!(checked(&own, &[]), expected, "{pair}");
    }
    let gent = |pair: &str| BOX.replace(MATERIAL, &format!("material.gent = {{ {pair}, jm = 30 }}"));
    let expected = checked(&gent(&format!("mu = 500, bulk_modulus = {bulk:?}")), &[]);
    assert_eq!(checked(&gent(&format!("E = {modulus:?}, nu = {ratio:?}")), &[]), expected);
}

#[test]
fn gravity_has_the_units_of_the_input() {
    let input = |system: &str, density: &str, direction: &str| {
        BOX.replace("title = \"box\"", &format!("units.system = \"{system}\""))
            .replace(
                "group = \"y-max\"\ntraction = [0.0, 0.0, 10.0]\n",
                &format!("gravity = \"{direction}\"\n"),
            )
            .replace("density = 2.0", &format!("density = {density}"))
    };
    // A box of 1 x 2 x 1: 2 m³ of 500 kg/m³ weigh 9806.65 N, and 2 mm³ of 5e-6 t/mm³ a tenth of 9806.65e-4 N.
    let own = checked(&input("m-kg-s", "500.0", "-z"), &[]);
    assert!(own.contains("force [0, 0, -9806.65] N"), "{own}");
    let own = checked(&input("mm-t-s", "5e-6", "+Y"), &[]);
    assert!(own.contains("force [0, 0.0980665, 0] N"), "{own}");
}

#[test]
fn mass_and_volume_are_compared() {
    // The box has the volume 2 and the mass 4.
    let with = |own: &str| BOX.replace("[mesh]", &format!("[expect]\n{own}\n\n[mesh]"));
    assert_eq!(checked(&with("mass = 4.003\nvolume = 1.999"), &[]), checked(BOX, &[]));
    checked(&with("mass = 4.3\ntolerance = 0.1"), &[]);
    for verb in ["check", "run"] {
        let place = Place::with(&with("mass = 4.01\nvolume = 2e9"));
        let outcome = place.emmy(&[verb, "box.toml"]);
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        for part in [
            "the volume of the body is 2, but 2e9 is expected: 1e-9 times as much",
            "as if they were in m in place of mm: `mesh.scale` multiplies them, here by 1000",
            "the mass of the body is 4, but 4.01 is expected: 0.997506 times as much",
        ] {
            let text = outcome.stderr.replace("\n  │ ", " ");
            assert!(text.contains(part), "{part}\n{}", outcome.stderr);
        }
        assert!(!place.path("out").exists());
    }
}

#[test]
fn a_single_mass_is_suspected_before_the_density() {
    // 4000 of 4004 are in the point mass.
    let heavy = format!("{BOX}\n[[mass]]\ngroup = \"y-max\"\ntotal = 4000.0\n");
    let place = Place::with(&heavy.replace("[mesh]", "[expect]\nmass = 4.0\n\n[mesh]"));
    let outcome = place.emmy(&["check", "box.toml"]);
    let text = outcome.stderr.replace("\n  │ ", " ");
    assert!(
        outcome.code == 2 && text.contains("a mass is probably in a wrong unit: multiply it by 0.001"),
        "{text}"
    );
}

#[test]
fn flags_for_steps_and_degree_are_short_forms() {
    let place = Place::with(&even_box(0.4, 0.1));
    let long = ["--set", "time.steps.size=0.02", "--set", "time.degree=2"];
    place.succeed(
        &[&["run", "box.toml", "--quiet", "--output", "long", "--until", "0.2"], &long[..]].concat(),
    );
    let short = ["--dt", "0.02", "--degree", "2", "--until", "0.2"];
    place.succeed(&[&["run", "box.toml", "--quiet", "--output", "short"], &short[..]].concat());
    assert_eq!(
        (place.summary("short")["steps"].as_u64(), place.summary("short")["degree"].as_u64()),
        (Some(10), Some(2))
    );
    assert_same_rows(&place, "short", "long");
}

#[test]
fn values_are_computed_from_parameters() {
    let input = even_box(0.4, 0.1)
        .replace("[mesh]", "[parameters]\nE = 100\nmu = \"= 5*E\"\nn = 2\n\n[mesh]")
        .replace("lambda = 1000.0, mu = 500.0", "lambda = \"= 2*mu\", mu = \"= mu\"")
        .replace("cells = [1, 2, 1]", "cells = [1, \"= n\", 1]")
        .replace("size = 0.1", "size = \"= 1/(5*n)\"");
    let place = Place::with(&input);
    place.write("plain.toml", &even_box(0.4, 0.1));
    place.succeed(&["run", "plain.toml", "--quiet", "--output", "plain"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "computed"]);
    assert_same_rows(&place, "computed", "plain");
    // The copy has the numbers, and the run continues with them.
    let copy = place.read("computed/input.toml");
    assert!(copy.contains("lambda = 1000.0, mu = 500.0") && !copy.contains("parameters"), "{copy}");
    place.succeed(&["resume", "computed", "--quiet", "--until", "0.8"]);
    place.succeed(&["run", "plain.toml", "--quiet", "--output", "longer", "--until", "0.8"]);
    assert_same_rows(&place, "computed", "longer");
    let outcome = place.emmy(&["resume", "computed", "--until", "1", "--set", "parameters.E=50"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("no value of the input depends on `E`"), "{}", outcome.stderr);

    // Flags and sweeps set parameters.
    let changed = ["--set", "parameters.E=200", "--set", "parameters.n=4"];
    place.succeed(&[&["run", "box.toml", "--quiet", "--output", "stiffer"], &changed[..]].concat());
    let long =
        ["--set", "region.material.neo-hooke={ lambda = 2000, mu = 1000 }", "--set", "time.steps.size=0.05"];
    let cells = ["--set", "mesh.box.cells=[1, 4, 1]"];
    place.succeed(&[&["run", "plain.toml", "--quiet", "--output", "by-hand"], &long[..], &cells].concat());
    assert_same_rows(&place, "stiffer", "by-hand");
    place.succeed(&["sweep", "box.toml", "--quiet", "--set", "parameters.E=100,200", "--output", "sweep"]);
    let rows = place.read("sweep/sweep.csv");
    let energies = |row: &str| row.split(',').map(str::to_string).collect::<Vec<_>>();
    let (head, rows) = rows.split_once('\n').unwrap();
    let column = head.split(',').position(|name| name == "total_energy").unwrap();
    let swept: Vec<f64> = rows.lines().map(|row| energies(row)[column].parse().unwrap()).collect();
    let first = place.history("plain")["total_energy"][4];
    assert!(
        swept.len() == 2 && (swept[0] / first - 1.0).abs() < 1e-12 && swept[1] != swept[0],
        "{swept:?} {first}"
    );
}

#[test]
fn parameters_without_effect_are_noted() {
    let outcome = Place::with(&BOX.replace("[mesh]", "[parameters]\nrho = 2\n\n[mesh]"))
        .succeed(&["check", "box.toml"]);
    assert!(
        outcome.stderr.contains("note: no value of the input depends on the parameter `rho`"),
        "{}",
        outcome.stderr
    );
}
