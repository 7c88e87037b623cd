//! `emmy compare`: charts and table of several runs.

use serde_json::json;

use super::report::manifest;
use super::{BOX, Place};

fn two_runs() -> Place {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "conserving"]);
    let flags = ["--set", "time.scheme=FE(2)", "--set", "time.degree=2", "--output", "runs/standard"];
    place.succeed(&[&["run", "box.toml", "--quiet"], &flags[..]].concat());
    place
}

#[test]
fn runs_are_drawn_and_listed_side_by_side() {
    let place = two_runs();
    let outcome = place.succeed(&["compare", "conserving", "runs/standard"]);
    let lines: Vec<Vec<&str>> =
        outcome.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    let blank = lines.iter().position(Vec::is_empty).unwrap();
    assert_eq!(blank, 3);
    // The keys that differ, and the peaks of the probe.
    assert_eq!(lines[4], ["input", "conserving", "standard"]);
    assert_eq!(lines[5], ["time.scheme", "\"AS(2)\"", "\"FE(2)\""]);
    assert_eq!(lines[6], ["time.degree", "1", "2"]);
    assert!(
        lines[7].is_empty() && lines[8] == ["peak", "conserving", "standard", "standard,", "%"],
        "{lines:?}"
    );
    let history = ["conserving", "runs/standard"].map(|run| place.history(run));
    let peak = |run: usize, column: &str| {
        let numbers = history[run][column].iter().copied();
        numbers.reduce(|most, x| if x.abs() > most.abs() { x } else { most }).unwrap()
    };
    let size =
        ["tip_x", "tip_y", "tip_z"].map(|column| peak(0, column).abs()).into_iter().fold(0.0, f64::max);
    for column in ["tip_x", "tip_y", "tip_z"] {
        let row = lines.iter().find(|line| line.first() == Some(&column)).unwrap();
        let percent: f64 = row[3].parse().unwrap();
        let exact = 100.0 * (peak(1, column).abs() - peak(0, column).abs()) / size;
        assert!((percent - exact).abs() < 0.006, "{column}: {percent} is not {exact}");
    }
    let differences = &manifest(&place, "compare/report.html")["differences"];
    let scheme = json!({ "key": "time.scheme", "values": ["\"AS(2)\"", "\"FE(2)\""] });
    assert_eq!((&differences["inputs"][0], differences["inputs"].as_array().unwrap().len()), (&scheme, 2));
    for (row, column) in ["tip_x", "tip_y", "tip_z"].into_iter().enumerate() {
        let [a, b] = [0, 1].map(|run| peak(run, column));
        let expected =
            json!({ "column": column, "values": [a, b], "differences": [(b.abs() - a.abs()) / size] });
        assert_eq!(differences["peaks"][row], expected);
    }
    assert_eq!(lines[1][..4], ["conserving", "AS(2)", "1", "8"]);
    assert_eq!(lines[2][..4], ["standard", "FE(2)", "2", "8"]);
    let newton = place.summary("conserving")["newton_iterations"].to_string();
    assert_eq!((lines[1][4], *lines[1].last().unwrap()), (newton.as_str(), "done"));
    let names = place.names("compare");
    for chart in [
        "compare",
        "compare-total-energy",
        "compare-energy-residual",
        "compare-angular-momentum",
        "compare-angular-momentum-components",
        "compare-angular-momentum-residual",
        "compare-linear-momentum-residual",
        "compare-newton-iterations",
        "compare-step-size",
    ] {
        let svg = place.read(&format!("compare/{chart}.svg"));
        assert!(svg.contains("time t") && svg.contains("standard") && svg.contains("polyline"), "{chart}");
        let png = std::fs::read(place.path(&format!("compare/{chart}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG") && png.len() > 5000, "{chart}");
    }
    assert_eq!(names.len(), 19);
    assert!(place.read("compare/report.html").contains("<title>conserving, standard</title>"));
    // Again, to the same place; and as JSON.
    let again = place.succeed(&["compare", "conserving", "--quiet", "--json"]);
    assert!(again.stderr.is_empty());
    let json: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!((&json["run"], &json["summary"]), (&"conserving".into(), &place.summary("conserving")));
}

#[test]
fn runs_of_the_same_name_are_told_apart() {
    let place = two_runs();
    place.succeed(&["run", "box.toml", "--quiet", "--output", "standard"]);
    let table = place.succeed(&["compare", "standard", "runs/standard", "--output", "both"]).stdout;
    assert!(table.contains("runs/standard"), "{table}");
    assert!(place.path("both/compare.svg").is_file());
}

#[test]
fn other_folders_are_rejected() {
    let place = two_runs();
    place.write("empty/notes.txt", "mine");
    place.write("other/history.csv", "a,b\n1,2\n");
    place.write("damaged/history.csv", &(place.read("conserving/history.csv") + "1,2\n"));
    place.write("no-summary/history.csv", &place.read("conserving/history.csv"));
    place.write("broken/history.csv", &place.read("conserving/history.csv"));
    place.write("broken/summary.json", "{");
    for (directory, part) in [
        ("nothing", "nothing is not a directory"),
        ("box.toml", "box.toml is not a directory"),
        ("empty", "cannot read empty/history.csv"),
        ("other", "other/history.csv:1: there is no column `step`"),
        ("damaged", "damaged/history.csv:11: there are 2 numbers for 28 columns"),
        ("no-summary", "no-summary/summary.json"),
        ("broken", "not valid JSON"),
    ] {
        let outcome = place.emmy(&["compare", "conserving", directory]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{directory}");
        assert!(outcome.stderr.contains(part), "{part}\n{}", outcome.stderr);
    }
    for arguments in [&["compare"][..], &["compare", "conserving", "--output", "empty"]] {
        assert_eq!(place.emmy(arguments).code, 2);
    }
    assert_eq!((place.names("empty"), place.path("compare").exists()), (vec!["notes.txt".into()], false));
}
