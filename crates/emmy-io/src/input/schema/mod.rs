//! The input as a JSON schema (draft 7), for editors: completion, descriptions of keys, and marks on what is wrong.
//!
//! Each table of [`keys`](super::keys) has its entries here, in `sections` and `materials`; a test compares the two. The reader is
//! stricter: it knows the mesh, and rules that go across keys.

mod kinds;
mod materials;
mod sections;

use serde_json::{Value, json};

use super::{material, settings};

/// The JSON schema of an input file, draft 7.
///
/// ```
/// let schema = emmy_io::input::schema();
/// let density = &schema["properties"]["region"]["properties"]["density"];
/// assert_eq!(density["exclusiveMinimum"], 0);
/// ```
pub fn schema() -> Value {
    let mut schema = sections::root();
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("Input of Emmy");
    put_defaults(&mut schema["properties"], settings::DEFAULTS);
    put_defaults(&mut schema["definitions"]["material"]["properties"], material::DEFAULTS);
    schema
}

/// Puts the defaults that the reader fills in into the schemas of tables.
fn put_defaults(tables: &mut Value, defaults: &str) {
    let Ok(defaults) = defaults.parse::<toml::Table>() else { return };
    for (name, values) in defaults {
        for (key, value) in values.as_table().into_iter().flatten() {
            tables[&name]["properties"][key]["default"] = json!(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::keys::{Keys, ROOT, TABLES};
    use super::*;

    /// Every table of a schema: its title and its keys.
    fn tables(schema: &Value, found: &mut Vec<(String, BTreeSet<String>)>) {
        if let (Some(title), Some(keys)) = (schema["title"].as_str(), schema["properties"].as_object()) {
            found.push((title.to_string(), keys.keys().cloned().collect()));
        }
        match schema {
            Value::Object(entries) => entries.values().for_each(|value| tables(value, found)),
            Value::Array(items) => items.iter().for_each(|value| tables(value, found)),
            _ => {}
        }
    }

    #[test]
    fn it_has_the_keys_of_the_reader_and_no_others() {
        let mut found = Vec::new();
        tables(&sections::root(), &mut found);
        for Keys { table, keys } in TABLES {
            let keys: BTreeSet<String> = keys.iter().map(|key| key.to_string()).collect();
            let mut shown = found.iter().filter(|(title, _)| title == table).peekable();
            assert!(
                shown.peek().is_some(),
                "no table of the schema is called `{table}`: add it in input/schema/"
            );
            for (_, shown) in shown {
                let missing: Vec<_> = keys.difference(shown).collect();
                assert!(
                    missing.is_empty(),
                    "keys of {table} that input/schema/ does not describe: {missing:?}"
                );
                let unknown: Vec<_> = shown.difference(&keys).collect();
                assert!(
                    unknown.is_empty(),
                    "keys of {table} in input/schema/ that the reader lacks: {unknown:?}"
                );
            }
        }
        let known: BTreeSet<&str> = TABLES.iter().map(|table| table.table).collect();
        let unknown: Vec<_> = found.iter().filter(|(title, _)| !known.contains(title.as_str())).collect();
        assert!(unknown.is_empty(), "tables that input/keys.rs lacks: {unknown:?}");
        assert_eq!(found.iter().filter(|(title, _)| title == ROOT.table).count(), 1);
    }

    #[test]
    fn every_key_is_described() {
        fn check(schema: &Value) {
            // A rule in `anyOf` names keys of the table that it belongs to: they are described there.
            let own = schema["title"].as_str().and_then(|_| schema["properties"].as_object());
            for (key, value) in own.into_iter().flatten() {
                let described = value["description"].is_string() || value["$ref"].is_string();
                assert!(described, "`{key}` of {} has no description", schema["title"]);
            }
            match schema {
                Value::Object(entries) => entries.values().for_each(check),
                Value::Array(items) => items.iter().for_each(check),
                _ => {}
            }
        }
        check(&schema());
    }

    #[test]
    fn defaults_are_those_of_the_reader() {
        let schema = schema();
        let default =
            |section: &str, key: &str| schema["properties"][section]["properties"][key]["default"].clone();
        assert_eq!(default("newton", "tolerance"), 1e-10);
        assert_eq!(default("output", "every"), 1);
        let models = &schema["definitions"]["material"]["properties"];
        assert_eq!(models["gent"]["properties"]["volumetric"]["default"], "simo-taylor");
    }
}
