//! Reading any input file ends with a problem or with faults, never with a panic.

use emmy_io::input::{self, Overrides};
use miette::Diagnostic;
use proptest::prelude::*;

const INPUT: &str = r#"title = "bøx ∑"
[mesh]
box = { size = [1, 2, 1], cells = [1, 2, 1] }
scale = 2.0
[[region]]
group = "body"
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }
[[load]]
group = "y-max"
traction = [0.0, 0.0, 10.0]
history = [[0.0, 0.0], [0.5, 1.0]]
[[support]]
group = "y-min"
fix = ["x", "y", "z"]
[initial]
angular_velocity = [0, 0, 1]
[time]
scheme = "AS(2)"
degree = 1
steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]
[output]
probes = [{ name = "tip", point = [0, 2, 0] }]
"#;

/// Reads a text and renders its faults.
fn read(text: &str, set: Vec<String>) {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("input.toml");
    std::fs::write(&file, text).unwrap();
    match input::read(&file, &Overrides { set, ..Default::default() }) {
        Ok(problem) => assert!(problem.plan.n_steps() > 0),
        Err(error) => {
            assert!(!error.to_string().is_empty() && !error.faults().is_empty());
            for fault in error.faults() {
                let fault = fault.excerpt();
                let Some(code) = fault.source_code() else { continue };
                let labels = fault.labels().unwrap();
                labels.for_each(|label| assert!(code.read_span(label.inner(), 1, 1).is_ok(), "{text}"));
            }
        }
    }
}

/// Characters of inputs.
fn character() -> impl Strategy<Value = char> {
    prop::sample::select("[]{}=\"'\n .,#-+einx0157_ø∑\u{feff}\u{0}".chars().collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    #[test]
    fn changed_characters(edits in prop::collection::vec((0..700_usize, character(), any::<bool>()), 1..4)) {
        let mut text: Vec<char> = INPUT.chars().collect();
        for (at, character, replace) in edits {
            let at = at % text.len();
            if replace { text[at] = character } else { text.insert(at, character) }
        }
        read(&text.into_iter().collect::<String>(), vec![]);
    }

    #[test]
    fn lines_left_out_and_doubled(line in 0..23_usize, other in 0..23_usize) {
        let mut lines: Vec<&str> = INPUT.lines().collect();
        lines.remove(line % lines.len());
        lines.insert(other % lines.len(), lines[(line + other) % lines.len()]);
        read(&lines.join("\n"), vec![]);
    }

    #[test]
    fn flags(key in "(time|load|mesh|region|.)(\\.[0-2])?(\\.(scheme|steps|traction|box|ø))?", value in ".{0,12}") {
        read(INPUT, vec![format!("{key}={value}")]);
        read(INPUT, vec![format!("{key}{value}")]);
    }
}
