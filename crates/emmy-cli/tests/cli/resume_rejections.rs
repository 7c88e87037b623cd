//! `emmy resume` of runs that cannot be resumed: exit code 2, and nothing is changed.

use emmy_io::checkpoint::parse;

use super::Place;
use super::resume::{assert_same_rows, even_box};

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
        for part in [words, &format!("Emmy {} reads format 4 only", env!("CARGO_PKG_VERSION"))] {
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

#[test]
fn runs_that_cannot_be_resumed_say_why() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let before = place.read("out/history.csv");
    let cases: [(&[&str], &str); 8] = [
        (&["resume", "out", "--until", "0.3"], "the run has already reached t = 0.3 (step 6)"),
        (&["resume", "out", "--until", "0.2"], "give a later end with --until T"),
        (&["resume", "nowhere", "--until", "1"], "holds no run of Emmy"),
        (
            &["resume", "out", "--until", "1", "--set", "mesh.box.cells=[2,2,1]"],
            "`mesh.box.cells.0` is 2, but 1",
        ),
        (
            &["resume", "out", "--until", "1", "--set", "region.0.density=3.0"],
            "`region.0.density` is 3.0, but 2.0",
        ),
        (
            &["resume", "out", "--until", "1", "--set", "load.0.traction.2=5.0"],
            "`load.0.traction.2` is 5.0, but 10.0",
        ),
        (&["resume", "out", "--until", "1", "--set", "output.probes=[]"], "cannot change `output.probes`"),
        (&["resume", "out", "--until", "1", "--step", "-0.1"], "--step -0.1"),
    ];
    for (arguments, part) in cases {
        let outcome = place.emmy(arguments);
        assert_eq!(outcome.code, 2, "{arguments:?}\n{}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{arguments:?}\n{}", outcome.stderr);
    }
    assert_eq!(place.read("out/history.csv"), before);
}

/// As a job that starts itself again does: there is nothing to do, which is no fault.
#[test]
fn a_complete_run_is_resumed_without_a_change() {
    let place = Place::with(&even_box(0.3, 0.05));
    place.succeed(&["run", "box.toml", "--quiet"]);
    let before =
        ["history.csv", "summary.json", "report.html"].map(|name| place.read(&format!("out/{name}")));
    let again = place.succeed(&["resume", "out", "--quiet"]);
    let note = "note: nothing to do: the run is complete, after step 6, t = 0.3; --until T extends it\n";
    assert_eq!((again.stdout.as_str(), again.stderr.as_str()), ("", note));
    let summary = place.succeed(&["resume", "out", "--json"]).stdout;
    assert_eq!(summary.parse::<serde_json::Value>().unwrap()["status"], "done");
    assert_eq!(
        ["history.csv", "summary.json", "report.html"].map(|name| place.read(&format!("out/{name}"))),
        before
    );
}

#[test]
fn damaged_checkpoints_are_not_used() {
    let place = Place::with(&even_box(0.3, 0.05).replace("every = 2", "every = 2\ncheckpoint_every = 2"));
    place.succeed(&["run", "box.toml", "--quiet", "--output", "whole", "--until", "0.5"]);
    place.succeed(&["run", "box.toml", "--quiet"]);
    assert_eq!(place.names("out/checkpoint"), ["a.checkpoint", "b.checkpoint"]);
    // The newer one is of step 6, the older one of the last synced step. A bit of the newer one is flipped.
    let file = |name: &str| place.path(&format!("out/checkpoint/{name}.checkpoint"));
    let step = |name: &str| parse(&std::fs::read(file(name)).unwrap()).unwrap().snapshot.state.step;
    let (newer, older) = if step("a") > step("b") { ("a", "b") } else { ("b", "a") };
    let left = step(older);
    assert!(step(newer) == 6 && left < 6);
    let newest = file(newer);
    let mut bytes = std::fs::read(&newest).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&newest, &bytes).unwrap();
    let outcome = place.succeed(&["resume", "out", "--until", "0.5"]);
    let note = format!("{newer}.checkpoint is damaged; the other checkpoint is used");
    for part in [note, format!("resuming after step {left}, t = ")] {
        assert!(outcome.stderr.contains(&part), "{}", outcome.stderr);
    }
    assert_same_rows(&place, "out", "whole");
    for name in ["a", "b"] {
        std::fs::write(place.path(&format!("out/checkpoint/{name}.checkpoint")), &bytes[..middle]).unwrap();
    }
    let outcome = place.emmy(&["resume", "out", "--until", "0.6"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("no checkpoint can be read"), "{}", outcome.stderr);
    place.succeed(&["run", "box.toml", "--quiet", "--set", "output.checkpoint_every=0"]);
    assert!(!place.path("out/checkpoint").exists());
    let outcome = place.emmy(&["resume", "out", "--until", "0.6"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("there is no checkpoint"), "{}", outcome.stderr);
}

#[test]
fn another_mesh_under_the_same_name_is_rejected() {
    let mesh = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../emmy-io/tests/meshes");
        std::fs::read(format!("{folder}/{name}")).unwrap()
    };
    let place = Place::new();
    let input = "mesh.file = \"body.msh\"\nregion = { density = 2.0, material.neo-hooke = { lambda = 10.0, mu = 5.0 } }\n\
                 initial.velocity = [1, 0, 0]\n[time]\nscheme = \"DGM\"\nsteps = [{ until = 0.2, size = 0.1 }]\n";
    place.write("body.toml", input);
    std::fs::write(place.path("body.msh"), mesh("hex8-41-ascii.msh")).unwrap();
    place.succeed(&["run", "body.toml", "--quiet", "--output", "out"]);
    std::fs::write(place.path("body.msh"), mesh("tet4-41-ascii.msh")).unwrap();
    let outcome = place.emmy(&["resume", "out", "--until", "0.4"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("the mesh has changed since the checkpoint"), "{}", outcome.stderr);
}
