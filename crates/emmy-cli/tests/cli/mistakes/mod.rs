//! Common mistakes, each with its whole message and the verdict of the JSON schema.

mod equilibrium;
mod files;
mod flags;
mod formulations;
mod joints;
mod keys;
mod materials;
mod meshes;
mod names;
mod parameters;
mod plans;
mod ranges;
mod schema;
mod supports_and_loads;
mod types;

use std::collections::{BTreeMap, BTreeSet};

use super::{BOX, Place};

// Parts of [`BOX`] that are changed.
const MESH: &str = "box = { size = [1, 2, 1], cells = [1, 2, 1] }";
const MATERIAL: &str = "material.neo-hooke = { lambda = 1000.0, mu = 500.0 }";
const TRACTION: &str = "traction = [0.0, 0.0, 10.0]";
const HISTORY: &str = "history = [[0.0, 0.0], [0.5, 1.0]]";
const FIX: &str = "fix = [\"x\", \"y\", \"z\"]";
const STEPS: &str = "steps = [{ until = 0.2, size = 0.1 }, { until = 0.5, size = 0.05 }]";
const PROBES: &str = "probes = [{ name = \"tip\", point = [0, 2, 0] }]";

/// An input with one mistake.
struct Mistake {
    /// Name of its message in `snapshots`.
    name: String,
    input: Vec<u8>,
    /// Files beside it.
    files: Vec<(&'static str, Vec<u8>)>,
    flags: &'static [&'static str],
    verb: &'static str,
    /// Whether the schema can see it.
    seen: bool,
}

/// A complete input.
fn whole(name: &str, input: impl Into<Vec<u8>>) -> Mistake {
    let (name, input) = (name.to_string(), input.into());
    Mistake { name, input, files: Vec::new(), flags: &[], verb: "run", seen: true }
}

/// A mistake in [`BOX`].
fn changed(name: &str, from: &str, to: &str) -> Mistake {
    whole(name, BOX).and(from, to)
}

impl Mistake {
    /// The same, but invisible to a schema: a mistake in the meaning of the values, in a mesh, or in a flag.
    fn unseen(self) -> Self {
        Mistake { seen: false, ..self }
    }

    /// The same with another change.
    fn and(self, from: &str, to: &str) -> Self {
        let input = String::from_utf8(self.input).unwrap();
        assert!(input.contains(from), "{}: {from}", self.name);
        Mistake { input: input.replacen(from, to, 1).into(), ..self }
    }

    /// The same with a file beside the input.
    fn beside(mut self, name: &'static str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.push((name, bytes.into()));
        self
    }

    /// The same with flags of the command line.
    fn with(self, flags: &'static [&'static str]) -> Self {
        Mistake { flags, ..self }
    }

    /// The same with another verb than `run`.
    fn of(self, verb: &'static str) -> Self {
        Mistake { verb, ..self }
    }

    /// The input for the schema; `None` if it is not TOML, which editors report by themselves.
    fn json(&self) -> Option<serde_json::Value> {
        let table: toml::Table = std::str::from_utf8(&self.input).ok()?.parse().ok()?;
        serde_json::to_value(table).ok()
    }

    /// The whole message of the verb, which must change nothing. Without flags, `emmy check` prints the same.
    fn message(&self) -> String {
        let place = Place::new();
        std::fs::write(place.path("box.toml"), &self.input).unwrap();
        self.files.iter().for_each(|(name, bytes)| std::fs::write(place.path(name), bytes).unwrap());
        let before = place.names(".");
        let outcome = place.emmy(&[&[self.verb, "box.toml"], self.flags].concat());
        let Mistake { name, .. } = self;
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{name}\n{}", outcome.stderr);
        if self.flags.is_empty() {
            let check = place.emmy(&["check", "box.toml"]);
            assert_eq!((check.code, &check.stderr), (2, &outcome.stderr), "{name}");
        }
        assert_eq!(place.names("."), before, "{name}");
        let own = place.path("").canonicalize().unwrap().display().to_string();
        outcome.stderr.replace(own.trim_end_matches('/'), "DIRECTORY").replace('\0', "␀")
    }
}

/// Every mistake.
fn all() -> Vec<Mistake> {
    let groups = [
        keys::all(),
        types::all(),
        ranges::all(),
        materials::all(),
        formulations::all(),
        names::all(),
        parameters::all(),
        meshes::all(),
        supports_and_loads::all(),
        joints::all(),
        plans::all(),
        equilibrium::all(),
        files::all(),
        flags::all(),
    ];
    groups.into_iter().flatten().collect()
}

#[test]
fn every_mistake_has_its_message() {
    let (mistakes, mut names, mut inputs) = (all(), BTreeSet::new(), BTreeMap::new());
    assert!(mistakes.len() >= 400, "{} mistakes", mistakes.len());
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for mistake in mistakes {
            assert!(names.insert(mistake.name.clone()), "{} is there twice", mistake.name);
            let same = inputs
                .insert((mistake.input.clone(), mistake.files.clone(), mistake.flags), mistake.name.clone());
            assert_eq!(same, None, "{} is the same", mistake.name);
            insta::assert_snapshot!(mistake.name.clone(), mistake.message());
        }
    });
}
