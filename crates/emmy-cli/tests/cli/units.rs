//! `[units]`, and measured materials.

use super::{BOX, Place};

/// [`BOX`] in a system of units: steel in mm, t, s unless changed.
fn steel(density: &str, youngs_modulus: &str) -> String {
    let material =
        format!("material.neo-hooke = {{ youngs_modulus = {youngs_modulus}, poissons_ratio = 0.3 }}");
    BOX.replace("title = \"box\"", "title = \"box\"\nunits.system = \"mm-t-s-N-MPa\"")
        .replace("density = 2.0", &format!("density = {density}"))
        .replace("material.neo-hooke = { lambda = 1000.0, mu = 500.0 }", &material)
}

#[test]
fn check_shows_units_and_has_no_note_on_steel() {
    let outcome = Place::with(&steel("7.85e-9", "210e3")).succeed(&["check", "box.toml"]);
    for part in [
        "units      mm-t-s: mass t, length mm, time s, force N, stress MPa, energy mJ, frequency Hz; gravity 9806.65 mm/s²",
        "volume 2 mm³, mass 1.57e-8 t, centre [0.5, 1, 0.5] mm",
        "force [0, 0, 10] N, torque about the origin [20, -5, 0] N·mm",
        "from t = 0 s to t = 0.5 s",
        "at [0, 2, 0] mm",
    ] {
        assert!(outcome.stdout.contains(part), "{part}\n{}", outcome.stdout);
    }
    // The steps of a tenth of a second are long for a piece of steel.
    assert!(!outcome.stderr.contains("solid") && outcome.stderr.lines().count() == 1, "{}", outcome.stderr);
}

#[test]
fn a_density_in_kilograms_and_metres_is_noticed_in_millimetres() {
    for verb in [&["check", "box.toml"][..], &["run", "box.toml", "--quiet", "--until", "0.1"]] {
        let outcome = Place::with(&steel("7850", "210e3")).succeed(verb);
        let expected = "note: region `body`: no known solid has a density of 7850 t/mm³ and a Young's modulus of 210000 \
                        MPa (7.85e15 kg/m³ and 2.1e11 Pa); write 7.85e-9 if the density is meant in kg/m³\n";
        assert_eq!(outcome.stderr, expected);
    }
}

#[test]
fn without_units_there_is_no_note_and_no_file() {
    let place = Place::with(BOX);
    let outcome = place.succeed(&["run", "box.toml", "--quiet"]);
    assert_eq!(outcome.stderr, "");
    assert!(!place.path("out/columns.json").exists());
    assert_eq!(place.summary("out")["units"], serde_json::Value::Null);
}

#[test]
fn results_have_units() {
    // The numbers of the box are those of a light foam in kg, m, s.
    let place = Place::with(&BOX.replace("title = \"box\"", "title = \"box\"\nunits.system = \"m-kg-s\""));
    let outcome = place.succeed(&["run", "box.toml"]);
    for part in [" J (step ", " kg·m/s (step ", " kg·m²/s (step ", " m at t = ", " to t = 0.5 s in "] {
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    assert!(!outcome.stderr.contains("no known solid"), "{}", outcome.stderr);
    let summary = place.summary("out");
    let units = serde_json::json!({
        "system": "m-kg-s", "mass": "kg", "length": "m", "time": "s", "force": "N", "stress": "Pa", "energy": "J",
        "frequency": "Hz"
    });
    assert_eq!(summary["units"], units);
    let columns: serde_json::Value = serde_json::from_str(&place.read("out/columns.json")).unwrap();
    let columns = columns.as_array().unwrap();
    let header = place.read("out/history.csv").lines().next().unwrap().to_string();
    assert_eq!(
        header,
        columns.iter().map(|own| own["column"].as_str().unwrap()).collect::<Vec<_>>().join(",")
    );
    for (name, unit) in [
        ("step", ""),
        ("time", "s"),
        ("total_energy", "J"),
        ("linear_momentum_x", "kg·m/s"),
        ("angular_momentum_residual", "kg·m²/s"),
        ("wall_seconds", "s"),
        ("smallest_determinant", ""),
        ("tip_z", "m"),
    ] {
        let own = columns.iter().find(|own| own["column"] == name).unwrap();
        assert_eq!(own["unit"], unit, "{name}");
        assert!(!own["meaning"].as_str().unwrap().is_empty());
    }
    assert!(place.read("out/run.log").contains("units: m-kg-s: mass kg"));
    // The page has the same units, and those of the fields.
    let page = place.read("out/report.html");
    assert!(page.contains("\"total_energy\":\"J\"") && page.contains("\"von_mises_stress\":\"Pa\""));
    place.succeed(&["compare", "out", "--output", "chart", "--quiet"]);
    assert!(place.read("chart/compare.svg").contains("total energy T + V [J]"));
    // A run without units does not keep the file of the run before.
    place.write("box.toml", BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert!(!place.path("out/columns.json").exists());
}

#[test]
fn measured_materials_are_listed_in_any_system() {
    let place = Place::new();
    let list = place.succeed(&["list", "materials", "--properties"]).stdout;
    let steel = "# structural steel; EN 1993-1-1 (2005), 3.2.6; EN 1991-1-1 (2002), table A.4\ndensity = 7850\n\
                 material.saint-venant-kirchhoff = { youngs_modulus = 2.1e11, poissons_ratio = 0.3 }\n";
    assert!(list.contains(steel), "{list}");
    let list = place.succeed(&["list", "materials", "--properties", "--units", "um-mg-ms"]).stdout;
    assert!(
        list.contains("density = 7.85e-9\nmaterial.saint-venant-kirchhoff = { youngs_modulus = 210000,"),
        "{list}"
    );
    let json =
        place.succeed(&["list", "materials", "--properties", "--json", "--units", "mm-t-s-N-MPa"]).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json[0]["input"].as_str().unwrap().starts_with("density = 7.85e-9\n"));
    assert_eq!(place.emmy(&["list", "schemes", "--properties"]).code, 2);
    let unknown = place.emmy(&["list", "materials", "--properties", "--units", "imperial"]);
    assert!(
        unknown.code == 2 && unknown.stderr.contains("m-kg-s, mm-kg-ms, mm-t-s, um-mg-ms"),
        "{}",
        unknown.stderr
    );
}
