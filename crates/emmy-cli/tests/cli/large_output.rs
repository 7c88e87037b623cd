//! Defaults of the output of runs whose frames would be large.

use super::Place;

/// A bar in 30,000 explicit steps, all of whose frames would take 100 MB.
const BAR: &str = r#"[mesh]
box = { size = [2.0, 1.0, 1.0], cells = [2, 1, 1] }

[[region]]
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }

[[load]]
group = "x-max"
traction = [1.0, 0.0, 0.0]

[[support]]
group = "x-min"
fix = "all"

[time]
scheme = "central-differences"
steps = [{ until = 3.0, size = 1e-4 }]

[output]
directory = "out"
checkpoint_every = 0
log_every = 0
"#;

#[test]
fn large_frames_have_smaller_defaults() {
    let place = Place::with(BAR);
    let report = place.succeed(&["check", "box.toml"]);
    let note = "of frames; the defaults of [output] are here: every = 300, precision = \"single\", fields = [\"displacement\", \
                \"von_mises_stress\", \"largest_stretch\"]";
    let text = report.stdout + &report.stderr;
    assert!(text.contains(note), "{text}");
    place.succeed(&["run", "box.toml", "--quiet"]);
    let frames = place.names("out/frames");
    assert_eq!(frames.len(), 101, "{frames:?}");
    let frame = place.read(&format!("out/frames/{}", frames[100]));
    for (array, kind) in [("displacement", "Float32"), ("von_mises_stress", "Float32"), ("Points", "Float64")]
    {
        let line = frame.lines().find(|line| line.contains(&format!("Name=\"{array}\""))).unwrap();
        assert!(line.contains(kind), "{line}");
    }
    assert!(frame.contains("\"largest_stretch\"") && !frame.contains("\"velocity\""));
    // The input of the run has them, so that it can be resumed.
    let input = place.read("out/input.toml");
    assert!(input.contains("every = 300") && input.contains("precision = \"single\""), "{input}");
}

#[test]
fn keys_that_are_given_stay() {
    let checked = |output: &str| {
        let outcome = Place::with(&(BAR.to_string() + output)).succeed(&["check", "box.toml"]);
        outcome.stdout + &outcome.stderr
    };
    let text = checked("precision = \"double\"\nfields = [\"displacement\", \"cauchy_stress\"]\n");
    assert!(!text.contains("defaults of [output]"), "{text}");
    let text = checked("every = 1\nprecision = \"double\"\n");
    assert!(text.contains("here: fields = ["), "{text}");
    let all = "fields = [\"displacement\", \"velocity\", \"momentum_density\", \"cauchy_stress\", \
               \"second_piola_kirchhoff_stress\", \"principal_stretches\"]\n";
    let text = checked(&format!("every = 1\nprecision = \"double\"\n{all}"));
    assert!(text.contains("the frames take up to 1") && text.contains("MB: fewer of them"), "{text}");
    assert!(!checked("every = 100\n").contains("of frames"));
}
