//! Contact: notes, warnings, events, fields and the report of `emmy check`.

use super::Place;

/// A block that falls onto a floor with the velocity 1, which is a 45th of that of sound.
const BLOCK: &str = r#"
mesh.box = { size = [1, 1, 1], cells = [2, 2, 2] }
output = { directory = "out", every = 0 }

[[region]]
density = 1.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }

[[contact]]
surfaces = "z-min"
name = "floor"
obstacle.plane = { point = [0, 0, -0.06], normal = [0, 0, 1] }
distance = 0.05

[initial]
velocity = [0, 0, -1]

[time]
scheme = "DGM"
steps = [{ until = 0.15, size = 0.005 }]
"#;

const THICK: &str = "the layer is thick for so slow an impact: `law = \"linear\"`, or a smaller `distance`";
const SOFT: &str = "the layer is too soft for this impact";

fn notes(summary: &serde_json::Value) -> String {
    summary["notes"].to_string().replace("\\\"", "\"")
}

#[test]
fn slow_impacts_on_thick_layers_have_a_note() {
    let place = Place::with(BLOCK);
    let fast = place.succeed(&["run", "box.toml"]).stderr;
    assert!(!fast.contains(THICK) && !fast.contains(SOFT), "{fast}");
    assert!(fast.contains("  floor: largest force ") && fast.contains(" in contact for "), "{fast}");
    assert!(!notes(&place.summary("out")).contains(THICK));
    let slow = ["--set", "initial.velocity=[0,0,-1e-3]", "--set", "time.steps=[{until=60,size=0.5}]"];
    let told = place.succeed(&[&["run", "box.toml", "--output", "slow"], &slow[..]].concat()).stderr;
    assert!(told.contains(&format!("note: {THICK}")), "{told}");
    let summary = place.summary("slow");
    assert!(summary["smallest_gap"].as_f64().unwrap() > 0.98 && notes(&summary).contains(THICK), "{summary}");
    // A linear layer is not thick, and a block that does not arrive has no contact.
    for more in ["contact.law=linear", "contact.obstacle.plane.point=[0,0,-9]"] {
        let other = [&["run", "box.toml", "--output", "other", "--set", more], &slow[..]].concat();
        let told = place.succeed(&other).stderr;
        assert!(!told.contains(THICK) && !notes(&place.summary("other")).contains(THICK), "{more}: {told}");
    }
    let summary = place.summary("other");
    let floor = &summary["contacts"][0];
    assert!(summary["smallest_gap"].is_null() && summary["contacts"].as_array().unwrap().len() == 1);
    assert!(floor["largest_force"].is_null() && floor["first_time"].is_null() && floor["duration"] == 0.0);
}

#[test]
fn soft_layers_have_a_warning() {
    let place = Place::with(BLOCK);
    let flags = ["--set", "contact.stiffness=5e-3", "--set", "time.steps=[{until=0.1,size=2.5e-4}]"];
    let told = place.succeed(&[&["run", "box.toml", "--output", "soft"], &flags[..]].concat()).stderr;
    assert_eq!(told.matches(SOFT).count(), 1, "{told}");
    assert!(place.summary("soft")["smallest_gap"].as_f64().unwrap() < 0.05);
    assert!(place.read("soft/report.html").contains(SOFT));
}

/// Explicit steps of five times the thickness of the layer.
#[test]
fn steps_that_would_pass_are_events() {
    let place = Place::with(BLOCK);
    let flags = ["--set", "contact.distance=0.001", "--set", "time.scheme=central-differences"];
    place.succeed(
        &[&["run", "box.toml", "--set", "time.steps=[{until=0.07,size=0.005}]"], &flags[..]].concat(),
    );
    let events = place.read("out/events.csv");
    let passed: Vec<&str> = events.lines().filter(|line| line.split(',').nth(2) == Some("passed")).collect();
    assert!(!passed.is_empty() && passed[0].contains("would pass through its opponent"), "{events}");
}

#[test]
fn check_reports_the_critical_step_in_contact() {
    let place = Place::with(BLOCK);
    let explicit = ["--set", "time.scheme=central-differences"];
    let report = place.succeed(&[&["check", "box.toml"], &explicit[..]].concat()).stdout;
    // psi'' by differences of c (1 - y)^3/y with y = (g/d)^2, c = kappa d/8; a node has four times as much area as
    // mass.
    let modulus = 500.0 * (3.0 * 1000.0 + 2.0 * 500.0) / 1500.0;
    let energy = |g: f64| {
        let y = (g / 0.05f64).powi(2);
        modulus * 0.05 / 8.0 * (1.0 - y).powi(3) / y
    };
    let h = 1e-4;
    let layer = 4.0 * (energy(0.025 + h) - 2.0 * energy(0.025) + energy(0.025 - h)) / (h * h);
    let number = |after: &str| -> f64 {
        let rest = report.split(after).nth(1).unwrap_or_else(|| panic!("{after}\n{report}"));
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    let critical = number("critical step ");
    let expected = 2.0 / ((2.0 / critical).powi(2) + layer).sqrt();
    let pressed = number("at least ");
    assert!((pressed / expected - 1.0).abs() < 1e-3 && pressed < 0.5 * critical, "{expected}\n{report}");
    assert!(!place.succeed(&["check", "box.toml"]).stdout.contains("pressed to half"));
}

/// Fields of contact in frames, as extremes, at probes and as values of groups.
#[test]
fn fields_of_contact_are_written() {
    let place = Place::with(BLOCK);
    let output = "fields=['displacement','contact_pressure','contact_gap'], extremes=['contact_pressure'], \
                  probes=[{name='foot', point=[0,0,0], quantities=['contact_pressure','contact_gap']}]";
    let flag = format!("output={{directory='out', every=2, {output}}}");
    place.succeed(&["run", "box.toml", "--set", &flag]);
    let history = place.history("out");
    let (pressures, gaps) = (&history["foot_contact_pressure"], &history["foot_contact_gap"]);
    assert!(pressures.iter().any(|pressure| *pressure > 1.0));
    for ((pressure, gap), largest) in pressures.iter().zip(gaps).zip(&history["max_contact_pressure"]) {
        assert!(
            largest >= pressure && (*pressure > 1e-12) == (*gap < 0.05 - 1e-6),
            "{pressure} {gap} {largest}"
        );
        // Up to 2 d it is the height above the floor.
        assert!(gap.is_nan() || (*gap > 0.0 && *gap < 0.1), "{gap}");
    }
    assert!((gaps[0] - 0.06).abs() < 1e-15);
    let summary = place.summary("out");
    let largest = history["max_contact_pressure"].iter().copied().fold(0.0, f64::max);
    assert!((summary["largest_contact_pressure"].as_f64().unwrap() / largest - 1.0).abs() < 1e-12);
    let frame = place.read("out/frames/out_000000.vtu");
    assert!(frame.contains("Name=\"contact_pressure\"") && frame.contains("Name=\"contact_gap\""));
    let at = |section: &str| BLOCK.find(section).unwrap();
    place.write("alone.toml", &format!("{}{}", &BLOCK[..at("[[contact]]")], &BLOCK[at("[initial]")..]));
    let refused = place.emmy(&["check", "alone.toml", "--set", &flag]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("the body has no field `contact_pressure`: it has no contact"),
        "{}",
        refused.stderr
    );
}

/// Two blocks, the upper one with its lowest corner at a place, and contacts.
fn two_blocks(at: &str, contacts: &str) -> String {
    format!(
        r#"
mesh.parts = [
    {{ name = "lower", box = {{ size = [1, 1, 1], cells = [2, 2, 2] }} }},
    {{ name = "upper", box = {{ size = [1, 1, 1], cells = [3, 3, 3] }}, at = {at} }},
]
output = {{ directory = "out", every = 0 }}

[[region]]
density = 1.0
material.neo-hooke = {{ lambda = 1000.0, mu = 500.0 }}

{contacts}

[[initial]]
group = "upper"
velocity = [0, 0, -1]

[time]
scheme = "DGM"
steps = [{{ until = 0.1, size = 0.01 }}]
"#
    )
}

const BETWEEN: &str = "[[contact]]\nsurfaces = [\"lower\", \"upper\"]\n";
const ALL: &str = "[[contact]]\nsurfaces = \"all\"\n";

#[test]
fn impossible_contacts_of_bodies_have_a_reason() {
    for (at, contacts, words) in [
        ("[0.2, 0.3, 0.9]", BETWEEN.to_string(), " lies 0.1 inside the other body: move the bodies apart by"),
        ("[0.2, 0.3, 1.0]", ALL.to_string(), "its surfaces touch or intersect at ["),
        (
            "[0, 0, 1.1]",
            format!("{BETWEEN}\n{ALL}"),
            "facets of its surfaces are in contact by \"contact-1\", too",
        ),
        (
            "[0, 0, 1.1]",
            "[[contact]]\nsurfaces = \"upper\"".into(),
            "contact of a body with itself is not there yet: name a second surface that shares no node",
        ),
        (
            "[0, 0, 1.1]",
            "[[contact]]\nsurfaces = [\"upper-x-max\", \"upper-z-max\"]".into(),
            "its surfaces share a node at [1, 0, 2.1]",
        ),
    ] {
        let place = Place::with(&two_blocks(at, &contacts));
        let outcome = place.emmy(&["check", "box.toml"]);
        let told: Vec<&str> = outcome.stderr.split_whitespace().collect();
        assert!(outcome.code == 2, "{}", outcome.stderr);
        assert!(told.join(" ").replace("│ ", "").contains(words), "{}", outcome.stderr);
    }
}

#[test]
fn check_says_which_contacts_act_from_the_start() {
    const NOTE: &str = ": it pushes from the start";
    for (at, is_told) in [("[0, 0, 1.04]", true), ("[0, 0, 1.06]", false)] {
        let place = Place::with(&two_blocks(at, &format!("{BETWEEN}distance = 0.05")));
        let told = place.succeed(&["check", "box.toml"]).stdout;
        assert_eq!(told.contains(NOTE), is_told, "{told}");
    }
}

/// The energy of a layer that is pressed everywhere to the gap 0.04, and the notes on it.
#[test]
fn check_has_the_energy_of_layers_at_the_start() {
    const PUSHES: &str = "contact `floor` pushes from the start, where its layer stores the energy 0.6075";
    // kappa d/8 (1 - y)^3/y on the area 1, with the Young's modulus kappa and y = (0.04/0.05)^2 = 0.64.
    let modulus = 500.0 * (3.0 * 1000.0 + 2.0 * 500.0) / 1500.0;
    let energy = modulus * 0.05 / 8.0 * 0.36f64.powi(3) / 0.64;
    assert!((energy - 0.6075).abs() < 1e-12);
    let place = Place::with(BLOCK);
    let near = ["check", "box.toml", "--set", "contact.obstacle.plane.point=[0,0,-0.04]"];
    let told = place.succeed(&near);
    assert!(
        told.stdout.contains("smallest gap 0.04, stored energy 0.6075: it pushes from the start"),
        "{}",
        told.stdout
    );
    assert!(told.stderr.contains(PUSHES) && !told.stderr.contains("nothing moves"), "{}", told.stderr);
    // It moves a block at rest.
    let told = place.succeed(&[&near[..], &["--set", "initial.velocity=[0,0,0]"]].concat()).stderr;
    assert!(told.contains(PUSHES) && !told.contains("nothing moves"), "{told}");
    let told = place.succeed(&["check", "box.toml"]);
    assert!(told.stdout.contains("smallest gap 0.06, stored energy 0\n") && !told.stderr.contains("pushes"));
    // An equilibrium begins in the layer on purpose.
    let held =
        "\n[[support]]\ngroup = \"z-max\"\nfix = [\"x\", \"y\", \"z\"]\n\n[equilibrium]\nload_steps = 4\n";
    place.write("box.toml", &format!("{BLOCK}{held}"));
    let told = place.succeed(&near).stderr;
    assert!(!told.contains("pushes from the start"), "{told}");
}

/// A mean facet of both blocks has the edge sqrt(12/78) = 0.392.
#[test]
fn layers_thicker_than_facets_have_a_note() {
    for (distance, is_told) in [(0.38, false), (0.4, true)] {
        let place = Place::with(&two_blocks("[0, 0, 3]", &format!("{BETWEEN}distance = {distance}")));
        let told = place.succeed(&["check", "box.toml"]).stderr;
        let note = "its layer is thicker (`distance` 0.4) than its facets are wide (0.392232)";
        assert_eq!(told.contains(note), is_told, "{told}");
    }
}

/// The bar of the book hits twice (D. Doyen, A. Ern, S. Piperno, 2011), from 0.01 to 0.016667 and from 0.036667 to
/// 0.043333, also in a run of three parts, the second of which begins in the first hit. Between the hits, 4/27 of its
/// energy are vibration, and after them nothing.
#[test]
fn a_bar_that_bounces_twice_has_two_contacts_and_gives_its_vibration_back() {
    let page = include_str!("../../../../book/src/contact.md");
    let input = page.split("```toml bouncing-bar.toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let place = Place::with(input.unwrap());
    place.succeed(&["run", "box.toml", "--quiet"]);
    let history = place.history("bouncing-bar");
    // m g H; the mass is 10.
    let energy = 10.0 * 10.0 * 5e-4;
    let vibration = |time: f64| {
        let row = history["time"].iter().position(|t| (t - time).abs() < 1e-9).unwrap();
        let [kinetic, strain, momentum] =
            ["kinetic_energy", "strain_energy", "linear_momentum_z"].map(|name| history[name][row]);
        (kinetic + strain - momentum * momentum / (2.0 * 10.0)) / energy
    };
    // The mesh spreads the fronts, which leaves some more, as about the square root of its cells.
    assert!((vibration(0.027) - 4.0 / 27.0).abs() < 0.02, "{}", vibration(0.027));
    assert!((0.0..0.04).contains(&vibration(0.05)), "{}", vibration(0.05));
    assert!(vibration(0.005).abs() < 1e-10);
    let whole = place.summary("bouncing-bar");
    let floor = &whole["contacts"][0];
    assert_eq!(floor["intervals"], 2);
    assert!((floor["first_time"].as_f64().unwrap() - 0.01).abs() < 2e-4, "{floor}");
    assert!((floor["last_time"].as_f64().unwrap() - 0.13 / 3.0).abs() < 4e-4, "{floor}");
    place.succeed(&["run", "box.toml", "--output", "parts", "--quiet", "--until", "0.013"]);
    for (until, expected) in [("0.03", 1), ("0.055", 2)] {
        let part = place.summary("parts");
        assert_eq!(part["contacts"][0]["intervals"], 1);
        place.succeed(&["resume", "parts", "--quiet", "--until", until]);
        assert_eq!(place.summary("parts")["contacts"][0]["intervals"], expected);
    }
}

/// The surfaces of both blocks: 24 and 54 facets with four points and four triangles each, and 24 and 36 sharp edges.
#[test]
fn check_has_the_numbers_of_surfaces() {
    let place = Place::with(&two_blocks("[0, 0, 1.06]", BETWEEN));
    let told = place.succeed(&["check", "box.toml"]).stdout;
    assert!(told.contains("contact-1: 78 facets, 312 points, 312 triangles, 60 sharp edges"), "{told}");
}

/// A floor that rises meets a block at rest as one at rest meets a block that falls; a run that goes on has its rows.
#[test]
fn a_floor_that_rises_has_its_columns_and_can_be_resumed() {
    let place = Place::with(BLOCK);
    let rises = ["--set", "contact.obstacle.move.z=t", "--set", "initial.velocity=[0,0,0]"];
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.succeed(&[&["run", "box.toml", "--output", "whole", "--quiet"], &rises[..]].concat());
    let whole = place.read("whole/history.csv");
    let column = |text: &str, name: &str| -> Vec<f64> {
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let at = rows[0].iter().position(|own| *own == name).unwrap();
        rows[1..].iter().map(|row| row[at].parse().unwrap_or(0.0)).collect()
    };
    let fallen = column(&place.read("out/history.csv"), "floor_force_z");
    let [on_body, on_floor] = ["floor_force_z", "floor-obstacle_force_z"].map(|name| column(&whole, name));
    assert!(fallen.iter().any(|force| *force > 1.0));
    for (own, (fallen, floor)) in on_body.iter().zip(fallen.iter().zip(&on_floor)) {
        assert!((own - fallen).abs() < 1e-7 && (own - floor).abs() < 1e-7, "{own} {fallen} {floor}");
    }
    let shorter = ["run", "box.toml", "--output", "parts", "--quiet", "--until", "0.08"];
    place.succeed(&[&shorter[..], &rises].concat());
    place.succeed(&["resume", "parts", "--quiet", "--until", "0.15"]);
    for name in ["total_energy", "floor_force_z", "floor-obstacle_force_z", "external_work"] {
        assert_eq!(column(&place.read("parts/history.csv"), name), column(&whole, name), "{name}");
    }
    let told = place.succeed(&[&["check", "box.toml"], &rises[..]].concat());
    assert!(!told.stderr.contains("nothing moves this body"), "{}", told.stderr);
}

#[test]
fn obstacles_that_move_and_what_cannot_are_checked() {
    let refused = |text: &str, more: &[&str]| {
        let place = Place::with(text);
        let outcome = place.emmy(&[&["check", "box.toml"], more].concat());
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        let words: Vec<&str> = outcome.stderr.split_whitespace().collect();
        words.join(" ").replace("│ ", "")
    };
    let rises = "contact.obstacle.move.z=t";
    let told = refused(BLOCK, &["--set", rises, "--set", "time.scheme=Bathe"]);
    assert!(told.contains("the scheme Bathe cannot move an obstacle: this needs a time element"), "{told}");
    let held = format!("{BLOCK}\n[[support]]\ngroup = \"z-min\"\nfix = [\"x\", \"y\", \"z\"]\n");
    let told = refused(&held, &[]);
    assert!(told.contains("nothing of \"z-min\" can move"), "{told}");
    let told = refused(BLOCK, &["--set", "contact.obstacle.move.w=t"]);
    assert!(told.contains("unknown key `w`"), "{told}");
}

/// A floor that rises against a block that is held: its work in an equilibrium is the stored energy with that of the
/// layer, and the integral of its force.
#[test]
fn the_work_of_an_obstacle_in_an_equilibrium_is_that_of_its_force() {
    let held =
        "\n[[support]]\ngroup = \"z-max\"\nfix = [\"x\", \"y\", \"z\"]\n\n[equilibrium]\nload_steps = 100\n";
    let place = Place::with(&format!("{}{held}", &BLOCK[..BLOCK.find("[initial]").unwrap()]));
    let told = place.succeed(&["run", "box.toml", "--set", "contact.obstacle.move.z=\"0.16\""]).stderr;
    assert!(!told.contains("undeformed"), "{told}");
    let history = place.read("out/history.csv");
    let rows: Vec<Vec<&str>> = history.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| -> Vec<f64> {
        let at = rows[0].iter().position(|own| *own == name).unwrap();
        rows[1..].iter().map(|row| row[at].parse().unwrap()).collect()
    };
    let [fractions, forces, works] = ["time", "floor-obstacle_force_z", "external_work"].map(column);
    let [strain, layer, total] = ["strain_energy", "contact_energy", "total_energy"].map(column);
    let mean = |at: usize| 0.5 * (forces[at] + forces[at + 1]) * 0.16 * (fractions[at + 1] - fractions[at]);
    let integral: f64 = (0..fractions.len() - 1).map(mean).sum();
    let last = fractions.len() - 1;
    assert!(fractions[last] == 1.0 && layer[last] > 0.01 * strain[last] && works[last] > 1.0);
    assert!((works[last] / integral - 1.0).abs() < 1e-3, "{} {integral}", works[last]);
    assert!((works[last] - total[last]).abs() < 1e-12 * total[last]);
}

/// The undeformed body is no equilibrium: the numbers of its row are not those of the contact.
#[test]
fn statistics_of_equilibria_do_not_begin_before_the_first() {
    let held =
        "\n[[support]]\ngroup = \"z-max\"\nfix = [\"x\", \"y\", \"z\"]\n\n[equilibrium]\nload_steps = 2\n";
    let place = Place::with(&format!("{}{held}", &BLOCK[..BLOCK.find("[initial]").unwrap()]));
    let told =
        place.succeed(&["run", "box.toml", "--set", "contact.obstacle.plane.point=[0,0,-0.045]"]).stderr;
    let (history, summary) = (place.history("out"), place.summary("out"));
    let (gaps, forces) = (&history["smallest_gap"], &history["floor_force_z"]);
    let (energies, floor) = (&history["contact_energy"], &summary["contacts"][0]);
    assert!(gaps.len() == 3 && gaps[0] < gaps[1] && forces[0] > forces[1] && energies[0] > energies[1]);
    let smallest = gaps[1].min(gaps[2]);
    assert_eq!(summary["smallest_gap"].as_f64().unwrap(), smallest);
    assert!(summary["smallest_gap_step"].as_u64().unwrap() > 0, "{summary}");
    assert_eq!(summary["largest_contact_energy"].as_f64().unwrap(), energies[1].max(energies[2]));
    assert!(
        (floor["largest_force"].as_f64().unwrap() / forces[1].max(forces[2]) - 1.0).abs() < 1e-9,
        "{floor}"
    );
    assert!(told.contains(&format!("smallest gap {smallest:.3} of")), "{told}");
}

#[test]
fn equilibria_without_support_say_how_far_the_contact_is() {
    let free = format!("{}\n[equilibrium]\nload_steps = 2\n", &BLOCK[..BLOCK.find("[initial]").unwrap()]);
    let words = "the smallest gap of contact \"floor\" is 0.06, and its layer begins at a distance of 0.05: move it \
                 nearer, or hold it";
    let told = |text: &str, more: &[&str]| {
        let place = Place::with(text);
        let outcome = place.emmy(&[&["run", "box.toml"], more].concat());
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        outcome.stderr.split_whitespace().collect::<Vec<_>>().join(" ").replace("│ ", "")
    };
    let alone = told(&free, &[]);
    assert!(alone.contains("nothing holds the body") && alone.contains(words), "{alone}");
    // Before a motion, and not of a contact that touches.
    let before = told(&format!("{BLOCK}\n[equilibrium]\nload_steps = 2\n"), &[]);
    assert!(before.contains(words), "{before}");
    let touches = told(&free, &["--set", "contact.obstacle.plane.point=[0,0,-0.04]"]);
    assert!(touches.contains("translation along x") && !touches.contains("smallest gap"), "{touches}");
}

/// Explicit steps of more than the thickness of the layer, down to the smallest size.
#[test]
fn steps_that_fail_in_contact_name_it() {
    let flags = ["--set", "contact.distance=0.001", "--set", "time.scheme=central-differences"];
    let failed = |smallest: &str| {
        let place = Place::with(BLOCK);
        let more = ["--set", "contact.obstacle.plane.point=[0,0,-0.0587]", "--set", smallest];
        let outcome = place.emmy(&[&["run", "box.toml"], &flags[..], &more[..]].concat());
        assert_eq!(outcome.code, 3, "{}", outcome.stderr);
        outcome.stderr
    };
    let cut = failed("time.smallest_step=0.0025");
    let words = "down to 0.0025; in contact \"floor\" something would pass near [";
    assert!(cut.contains(words) && cut.contains("try a smaller `smallest_step`"), "{cut}");
    let whole = failed("time.smallest_step=0.005");
    assert!(
        whole.contains("contact \"floor\": its surface would pass through its opponent near ["),
        "{whole}"
    );
}

#[test]
fn bodies_that_lie_inside_others_are_refused() {
    let inside = |contacts: &str| {
        let text =
            two_blocks("[0.3, 0.3, 0.3]", contacts).replacen("size = [1, 1, 1]", "size = [3, 3, 3]", 1);
        let place = Place::with(&text);
        let outcome = place.emmy(&["check", "box.toml"]);
        (outcome.code, outcome.stderr.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    for contacts in [BETWEEN, ALL] {
        let (code, told) = inside(contacts);
        assert!(code == 2 && told.contains("\"upper\" lies inside \"lower\", at ["), "{told}");
        assert!(told.contains("these surfaces"), "{told}");
    }
    let (code, told) = inside("[[contact]]\nsurfaces = [\"lower-z-max\", \"upper\"]\n");
    assert_eq!(code, 0, "{told}");
}
