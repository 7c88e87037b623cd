//! `emmy report`: the page of a run.

use super::{BOX, Place};

/// JSON data in the page.
pub(super) fn manifest(place: &Place, page: &str) -> serde_json::Value {
    let page = place.read(page);
    let text = page.split_once("id=\"manifest\">").unwrap().1;
    serde_json::from_str(text.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_page_has_the_summary_digit_for_digit_and_the_loaded_interval() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let manifest = manifest(&place, "out/report.html");
    let run = &manifest["runs"][0];
    assert_eq!((&run["name"], &run["summary"]), (&"out".into(), &place.summary("out")));
    assert_eq!(
        run["loads"],
        serde_json::json!([{ "label": "traction on y-max", "intervals": [[0.0, null]] }])
    );
    assert_eq!((&run["history"]["kept"], &run["frames"]["regions"]), (&9.into(), &serde_json::json!([])));
    assert_eq!((&run["frames"]["kept"], &run["frames"]["n_nodes"]), (&5.into(), &12.into()));
    assert_eq!(run["input"].as_str(), Some(place.read("out/input.toml").as_str()));
}

#[test]
fn a_page_is_written_again_from_the_directory_alone() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let mut expected = manifest(&place, "out/report.html");
    std::fs::remove_file(place.path("out/report.html")).unwrap();
    // The directory may have been moved.
    std::fs::rename(place.path("out"), place.path("moved")).unwrap();
    let outcome = place.succeed(&["report", "moved"]);
    assert_eq!(outcome.stdout, "moved/report.html\n");
    expected["runs"][0]["name"] = "moved".into();
    assert_eq!(manifest(&place, "moved/report.html"), expected);
}

/// Surface, motion and colours have the same numbers for all formats of the frames.
#[test]
fn frames_in_one_file_are_seen_as_those_in_many() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    place.succeed(&["run", "box.toml", "--quiet", "--output", "one", "--set", "output.format=vtkhdf"]);
    let [many, one] =
        ["out", "one"].map(|name| manifest(&place, &format!("{name}/report.html"))["runs"][0].clone());
    assert!(one["files"].as_array().unwrap().contains(&"one.vtkhdf".into()));
    assert_eq!(one["frames"], many["frames"]);
    assert!(one["frames"]["fields"].as_array().unwrap().len() > 3, "{}", one["frames"]);
    // The boundary between history and frames depends only on their numbers.
    assert_eq!(one["arrays"], many["arrays"]);
}

/// A killed run leaves a frame that is not listed, and half a row.
#[test]
fn a_run_that_is_going_on_has_a_page() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    for file in ["history.csv", "newton.csv"] {
        let text = place.read(&format!("out/{file}"));
        std::fs::write(place.path(&format!("out/{file}")), &text[..text.len() - 40]).unwrap();
    }
    place.succeed(&["report", "out"]);
    assert_eq!(manifest(&place, "out/report.html")["runs"][0]["history"]["kept"], 8);
    std::fs::remove_file(place.path("out/newton.csv")).unwrap();
    std::fs::remove_file(place.path("out/out.pvd")).unwrap();
    place.succeed(&["report", "out"]);
    assert!(manifest(&place, "out/report.html")["runs"][0]["frames"].is_null());
}

#[test]
fn other_folders_get_no_page() {
    let place = Place::with(BOX);
    std::fs::create_dir(place.path("mine")).unwrap();
    std::fs::write(place.path("mine/input.toml"), "title = 1").unwrap();
    for (directory, message) in [("mine", "no run of Emmy"), ("nothing", "not a directory")] {
        let outcome = place.emmy(&["report", directory]);
        assert_eq!(outcome.code, 2);
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
    assert!(!place.path("mine/report.html").exists());
}
