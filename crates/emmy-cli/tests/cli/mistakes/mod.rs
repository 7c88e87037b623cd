//! Mistakes that people make, each with its whole message, and what the JSON schema says of them.

mod files;
mod flags;
mod keys;
mod meshes;
mod names;
mod plans;
mod ranges;
mod schema;
mod supports_and_loads;
mod types;

use std::collections::BTreeSet;

use super::{BOX, Place};

/// An input that is wrong in one way.
struct Mistake {
    /// Name of its message in `snapshots`.
    name: String,
    input: Vec<u8>,
    /// Files beside it.
    files: Vec<(&'static str, Vec<u8>)>,
    flags: &'static [&'static str],
    /// Whether the schema can see it.
    seen: bool,
}

/// An input of its own.
fn whole(name: &str, input: impl Into<Vec<u8>>) -> Mistake {
    Mistake { name: name.to_string(), input: input.into(), files: Vec::new(), flags: &[], seen: true }
}

/// A mistake in [`BOX`].
fn changed(name: &str, from: &str, to: &str) -> Mistake {
    assert!(BOX.contains(from), "{name}: {from}");
    whole(name, BOX.replacen(from, to, 1))
}

impl Mistake {
    /// The same as one that a schema cannot see: it is in the sense of the values, in a mesh, or in a flag.
    fn unseen(self) -> Self {
        Mistake { seen: false, ..self }
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

    /// The input as the schema sees it; nothing if it is no TOML, which editors find without one.
    fn json(&self) -> Option<serde_json::Value> {
        let table: toml::Table = std::str::from_utf8(&self.input).ok()?.parse().ok()?;
        serde_json::to_value(table).ok()
    }

    /// The whole message of `emmy run`, which must change nothing.
    fn message(&self) -> String {
        let place = Place::new();
        std::fs::write(place.path("box.toml"), &self.input).unwrap();
        self.files.iter().for_each(|(name, bytes)| std::fs::write(place.path(name), bytes).unwrap());
        let before = place.names(".");
        let outcome = place.emmy(&[&["run", "box.toml"], self.flags].concat());
        let Mistake { name, .. } = self;
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{name}\n{}", outcome.stderr);
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
        names::all(),
        meshes::all(),
        supports_and_loads::all(),
        plans::all(),
        files::all(),
        flags::all(),
    ];
    groups.into_iter().flatten().collect()
}

#[test]
fn every_mistake_has_its_message() {
    let (mistakes, mut names) = (all(), BTreeSet::new());
    assert!(mistakes.len() >= 120, "{} mistakes", mistakes.len());
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for mistake in mistakes {
            assert!(names.insert(mistake.name.clone()), "{} is there twice", mistake.name);
            insta::assert_snapshot!(mistake.name.clone(), mistake.message());
        }
    });
}
