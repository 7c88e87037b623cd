//! `emmy resume` of runs that cannot be resumed: exit code 2, and nothing is changed.

use super::Place;
use super::resume::even_box;

#[test]
fn checkpoints_of_another_format_are_rejected_with_both_versions() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet"]);
    for (header, words) in [
        (
            "emmy checkpoint 2\n",
            "has checkpoint format 2, which a development version before Emmy 0.1.0 reads",
        ),
        ("emmy checkpoint 9, Emmy 2.5.0\n", "has checkpoint format 9, which Emmy 2.5.0 reads"),
    ] {
        for name in place.names("out/checkpoint") {
            place.write(&format!("out/checkpoint/{name}"), header);
        }
        let before = place.read("out/history.csv");
        let outcome = place.emmy(&["resume", "out", "--until", "0.5"]);
        assert_eq!(outcome.code, 2);
        for part in [words, &format!("Emmy {} reads format 3 only", env!("CARGO_PKG_VERSION"))] {
            assert!(outcome.stderr.contains(part), "{}", outcome.stderr);
        }
        assert_eq!(place.read("out/history.csv"), before);
    }
}

#[test]
fn a_series_of_frames_keeps_its_fields() {
    let place = Place::with(&even_box(0.3, 0.05));
    let fields = |list: &str| format!("output.fields={list}");
    let both = fields(r#"["displacement", "velocity"]"#);
    place.succeed(&["run", "box.toml", "--quiet", "--set", "output.format=vtkhdf", "--set", &both]);
    let files = ["history.csv", "input.toml", "events.csv", "out.vtkhdf"];
    let bytes = || files.map(|file| std::fs::read(place.path(&format!("out/{file}"))).unwrap());
    let before = bytes();
    for other in [r#"["displacement"]"#, r#"["displacement", "velocity", "cauchy_stress"]"#] {
        let outcome = place.emmy(&["resume", "out", "--until", "0.5", "--set", &fields(other)]);
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        for part in
            ["`output.fields` is [\"displacement\"", "out.vtkhdf have [\"displacement\", \"velocity\"]"]
        {
            assert!(outcome.stderr.contains(part), "{}", outcome.stderr);
        }
        assert!(bytes() == before, "{other}");
    }
    let turned = fields(r#"["velocity", "displacement"]"#);
    place.succeed(&["resume", "out", "--quiet", "--until", "0.5", "--set", &turned]);
    assert_eq!(place.history("out")["time"].last(), Some(&0.5));
}
