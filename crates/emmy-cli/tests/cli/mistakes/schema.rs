//! The JSON schema on the mistakes, and on valid inputs.

use regex_lite::Regex;
use serde_json::Value;

use super::super::{BOX, Place};
use super::all;

/// The part of JSON schema (draft 7) that `emmy schema` uses. A library for all of it would be the heaviest crate of
/// the tests; unknown keywords fail, so that nothing is ignored.
struct Validator {
    schema: Value,
}

impl Validator {
    fn new() -> Self {
        Validator { schema: serde_json::from_str(&Place::new().succeed(&["schema"]).stdout).unwrap() }
    }

    /// Faults of an input.
    fn errors(&self, input: &Value) -> Vec<String> {
        let mut errors = Vec::new();
        self.check(&self.schema, input, "", &mut errors);
        errors
    }

    fn fits(&self, schema: &Value, value: &Value) -> bool {
        let mut errors = Vec::new();
        self.check(schema, value, "", &mut errors);
        errors.is_empty()
    }

    fn check(&self, schema: &Value, value: &Value, path: &str, errors: &mut Vec<String>) {
        for (keyword, wanted) in schema.as_object().unwrap() {
            if keyword == "$ref" {
                let pointer = wanted.as_str().unwrap().strip_prefix('#').unwrap();
                self.check(self.schema.pointer(pointer).unwrap(), value, path, errors);
            } else if !self.holds(schema, keyword, wanted, value, path, errors) {
                errors.push(format!("{path}: {keyword}"));
            }
        }
    }

    fn holds(
        &self,
        schema: &Value,
        keyword: &str,
        wanted: &Value,
        value: &Value,
        path: &str,
        errors: &mut Vec<String>,
    ) -> bool {
        let schemas = || wanted.as_array().unwrap().iter().filter(|schema| self.fits(schema, value)).count();
        let number =
            |holds: fn(f64, f64) -> bool| value.as_f64().is_none_or(|x| holds(x, wanted.as_f64().unwrap()));
        let count = |n: Option<usize>, holds: fn(usize, usize) -> bool| {
            n.is_none_or(|n| holds(n, wanted.as_u64().unwrap() as usize))
        };
        let (items, entries) = (value.as_array(), value.as_object());
        match keyword {
            "$schema" | "title" | "description" | "default" | "definitions" | "then" => true,
            "type" => match wanted {
                Value::Array(kinds) => kinds.iter().any(|kind| is_kind(value, kind)),
                kind => is_kind(value, kind),
            },
            "properties" => {
                for (key, value) in entries.into_iter().flatten() {
                    if let Some(schema) = wanted.get(key) {
                        self.check(schema, value, &format!("{path}.{key}"), errors);
                    }
                }
                true
            }
            "additionalProperties" => {
                let is_known = |key: &String| schema["properties"].get(key).is_some();
                let mut others = entries.into_iter().flatten().filter(|(key, _)| !is_known(key));
                match wanted {
                    Value::Bool(allowed) => *allowed || others.next().is_none(),
                    schema => others.all(|(_, value)| self.fits(schema, value)),
                }
            }
            "items" => {
                for (index, value) in items.into_iter().flatten().enumerate() {
                    self.check(wanted, value, &format!("{path}.{index}"), errors);
                }
                true
            }
            "required" => {
                let is_there =
                    |key: &Value| entries.is_none_or(|entries| entries.contains_key(key.as_str().unwrap()));
                wanted.as_array().unwrap().iter().all(is_there)
            }
            "dependencies" => {
                let is_there = |key: &String| entries.is_some_and(|entries| entries.contains_key(key));
                let mut wanted = wanted.as_object().unwrap().iter();
                wanted.all(|(key, schema)| !is_there(key) || self.fits(schema, value))
            }
            "oneOf" => schemas() == 1,
            "anyOf" => schemas() > 0,
            "not" => !self.fits(wanted, value),
            "if" => !self.fits(wanted, value) || self.fits(&schema["then"], value),
            "enum" => wanted.as_array().unwrap().contains(value),
            "const" => value == wanted || value.as_f64().is_some() && value.as_f64() == wanted.as_f64(),
            "pattern" => {
                let pattern = Regex::new(wanted.as_str().unwrap()).unwrap();
                value.as_str().is_none_or(|text| pattern.is_match(text))
            }
            "minimum" => number(|x, bound| x >= bound),
            "maximum" => number(|x, bound| x <= bound),
            "exclusiveMinimum" => number(|x, bound| x > bound),
            "exclusiveMaximum" => number(|x, bound| x < bound),
            "uniqueItems" => {
                let items = items.map(Vec::as_slice).unwrap_or_default();
                (1..items.len()).all(|index| !items[..index].contains(&items[index]))
            }
            "minItems" => count(items.map(Vec::len), |n, least| n >= least),
            "maxItems" => count(items.map(Vec::len), |n, most| n <= most),
            "minProperties" => count(entries.map(|entries| entries.len()), |n, least| n >= least),
            "maxProperties" => count(entries.map(|entries| entries.len()), |n, most| n <= most),
            other => panic!("the keyword {other} at {path} is not known here"),
        }
    }
}

fn is_kind(value: &Value, kind: &Value) -> bool {
    match kind.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
        kind => panic!("values of kind {kind}"),
    }
}

/// An input as passed by a language server to a validator.
fn json(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn the_schema_marks_the_mistakes_that_it_can_see() {
    let validator = Validator::new();
    let mut wrong = Vec::new();
    for mistake in all() {
        let Some(json) = mistake.json() else { continue };
        let errors = validator.errors(&json);
        if errors.is_empty() == mistake.seen {
            wrong.push(format!("{} (marked as seen: {}): {errors:?}", mistake.name, mistake.seen));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_schema_takes_every_input_of_the_repository() {
    let (validator, mut count) = (Validator::new(), 0);
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    for folder in ["examples", "validation/inputs"] {
        for entry in std::fs::read_dir(format!("{root}/{folder}")).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let errors = validator.errors(&json(&std::fs::read_to_string(&path).unwrap()));
                assert!(errors.is_empty(), "{}: {errors:?}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= 30, "{count} inputs");
}

#[test]
fn the_schema_takes_the_resolved_input_of_a_run() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet"]);
    let errors = Validator::new().errors(&json(&place.read("out/input.toml")));
    assert!(errors.is_empty(), "{errors:?}");
}
