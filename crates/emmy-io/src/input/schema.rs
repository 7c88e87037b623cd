//! JSON schema (draft 7) of the input, for editors: completion, descriptions of keys, and marks on mistakes.
//!
//! It is generated from the descriptions of the tables. The reader is stricter: it knows the mesh, and rules that
//! involve several tables.

use emmy::body::Formulation;
use emmy::internals::material::{Bounds, IfAbsent, ModelCells};
use serde_json::{Map, Value, json};

use super::description::{ENTRY, Key, Kind, MEMBERS, Rule, Section};
use super::{catalogue, material, synonyms};

/// The JSON schema of an input file, draft 7.
///
/// ```
/// let schema = emmy_io::input::schema();
/// let density = &schema["properties"]["region"]["properties"]["density"];
/// assert_eq!(density["exclusiveMinimum"], 0);
/// ```
pub fn schema() -> Value {
    let mut schema = table(&catalogue::ROOT);
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("Input of Emmy");
    schema["definitions"] = json!({ "material": table(&material::MATERIAL) });
    schema
}

/// Schema of a table.
fn table(section: &Section) -> Value {
    let is_required = |key: &&Key| key.if_absent == IfAbsent::Required;
    let required: Vec<&str> = section.keys.iter().filter(is_required).map(|key| key.name).collect();
    let named = |key: &Key| std::iter::once(key.name).chain(synonyms::accepted(key.name));
    let properties =
        section.keys.iter().flat_map(|key| named(key).map(|name| (name.to_string(), property(key))));
    let properties: Map<String, Value> = properties.collect();
    let mut schema = json!({
        "title": section.name,
        "description": section.doc,
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if let Some(others) = &section.others {
        schema["additionalProperties"] = of(&others.kind);
        schema["additionalProperties"]["description"] = json!(others.doc);
    }
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    rules(section).into_iter().for_each(|(rule, value)| schema[rule] = value);
    schema
}

/// Schema of one table or a list of them. It is not a choice of two schemas, because a validator can only report that
/// no alternative fits, and not which key is wrong.
fn tables(least: usize, section: &Section) -> Value {
    let one = table(section);
    let rules = rules(section);
    let mut schema = one.clone();
    // A list fits all of the choices between keys, which is too many for `oneOf`: they apply to tables only.
    schema.as_object_mut().into_iter().for_each(|schema| schema.retain(|rule, _| !rules.contains_key(rule)));
    schema["if"] = json!({ "type": "object" });
    schema["then"] = rules.into();
    schema["type"] = json!(["object", "array"]);
    schema["items"] = one;
    schema["minItems"] = json!(least);
    schema
}

/// Rules between keys.
fn rules(section: &Section) -> Map<String, Value> {
    let required = |keys: &[&str]| json!({ "required": keys });
    let rules = match &section.rule {
        Rule::Free => json!({}),
        // A table with nothing but the keys of the choice.
        Rule::ExactlyOne(sets) if sets.len() == section.keys.len() => {
            json!({ "minProperties": 1, "maxProperties": 1 })
        }
        Rule::ExactlyOne(sets) => {
            json!({ "oneOf": sets.iter().map(|keys| required(keys)).collect::<Vec<_>>() })
        }
        // Each constant has several names, too many for a list of the pairs.
        Rule::TwoElasticConstants => {
            let count = |is_one: fn(&IfAbsent) -> bool| {
                section.keys.iter().filter(|key| is_one(&key.if_absent)).count()
            };
            let least = 2 + count(|own| *own == IfAbsent::Required);
            let optional = count(|own| matches!(own, IfAbsent::Value(_) | IfAbsent::Means(_)));
            json!({ "minProperties": least, "maxProperties": least + optional })
        }
        Rule::AtLeastOne(keys) if keys.len() == section.keys.len() => json!({ "minProperties": 1 }),
        Rule::AtLeastOne(keys) => {
            json!({ "anyOf": keys.iter().map(|key| required(&[key])).collect::<Vec<_>>() })
        }
        Rule::Input(keys) => {
            let bodies = [&["mesh", "region"][..], &["rigid"]];
            let all =
                bodies.iter().flat_map(|body| keys.iter().map(|key| required(&[*body, &[*key]].concat())));
            let with = |other: &str| required(&[other]);
            json!({
                "anyOf": all.collect::<Vec<_>>(),
                "dependencies": { "mesh": with("region"), "region": with("mesh") },
            })
        }
        Rule::Region => {
            let massless = emmy::internals::body::MODELS.iter().map(|model| &model.model);
            let massless = massless.filter(|model| model.cells == ModelCells::MasslessLinks);
            let massless: Vec<Value> = massless.map(|model| required(&[model.name])).collect();
            let without_mass = json!({ "properties": { "material": { "anyOf": massless } } });
            let projected = Formulation::ProjectedVolume(None).name();
            let projected = json!({
                "properties": { "formulation": { "const": projected } },
                "required": ["formulation"]
            });
            json!({
                "anyOf": [required(&["density"]), without_mass],
                "dependencies": { "pressure": projected }
            })
        }
    };
    rules.as_object().cloned().unwrap_or_default()
}

/// Schema of the value of a key.
fn property(key: &Key) -> Value {
    let mut schema = match &key.kind {
        Kind::Table(section) if section.name == material::MATERIAL.name => {
            return json!({ "$ref": "#/definitions/material" });
        }
        kind => of(kind),
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    let absent = match key.if_absent {
        IfAbsent::Means(meaning) if !meaning.is_empty() => format!("; left out: {meaning}"),
        _ => String::new(),
    };
    if !matches!(key.kind, Kind::Table(_) | Kind::Tables(..)) {
        schema["description"] = json!(format!("{}{unit}{absent}", key.doc).replace('`', ""));
        if let IfAbsent::Value(value) = key.if_absent {
            schema["default"] = default(value);
        }
    }
    schema
}

/// A value as written in TOML.
fn default(value: &str) -> Value {
    let table = format!("value = {value}").parse::<toml::Table>().unwrap_or_default();
    json!(table.get("value"))
}

/// Schema of a kind of value.
fn of(kind: &Kind) -> Value {
    match kind {
        Kind::Text => json!({ "type": "string", "pattern": "\\S" }),
        Kind::Column(taken) => json!({ "type": "string", "pattern": r"^[\w-]+$", "not": { "enum": taken } }),
        Kind::Number(bounds) => number(*bounds),
        Kind::Whole(least, None) => number_or_text("integer", json!({ "minimum": least })),
        Kind::Whole(least, Some(most)) => {
            number_or_text("integer", json!({ "minimum": least, "maximum": most }))
        }
        Kind::Word(_, words, _) => json!({ "type": "string", "enum": words }),
        Kind::Words(least, word) => {
            json!({ "type": "array", "items": of(word), "minItems": least, "uniqueItems": true })
        }
        Kind::Scheme(_) => scheme(),
        Kind::True => json!({ "const": true }),
        Kind::List(least, entry) => json!({ "type": "array", "items": of(entry), "minItems": least }),
        Kind::Exactly(length, entry) => {
            json!({ "type": "array", "items": of(entry), "minItems": length, "maxItems": length })
        }
        Kind::Groups => json!({ "type": "object", "additionalProperties": of(&MEMBERS) }),
        Kind::TimeFunction(section) => history(section),
        Kind::Expression => json!({ "type": ["number", "string"], "pattern": "\\S" }),
        Kind::Field(vector) => of(vector),
        Kind::Either(kinds) => json!({ "anyOf": kinds.each_ref().map(of) }),
        Kind::Table(section) => table(section),
        Kind::Tables(least, one) => one.section().map_or(Value::Null, |section| tables(*least, section)),
    }
}

/// A number, or a text that is computed; the bounds apply to numbers and the pattern to texts.
fn number_or_text(number: &str, bounds: Value) -> Value {
    let mut schema = bounds;
    schema["type"] = json!([number, "string"]);
    schema["pattern"] = json!(r"^\s*=");
    schema
}

fn number(bounds: Bounds) -> Value {
    let bounds = match bounds {
        Bounds::Any => json!({}),
        Bounds::Above(least) => json!({ "exclusiveMinimum": bound(least) }),
        Bounds::AtLeast(least) => json!({ "minimum": bound(least) }),
        Bounds::Between(low, high) => {
            json!({ "exclusiveMinimum": bound(low), "exclusiveMaximum": bound(high) })
        }
        Bounds::Within(low, high) => json!({ "minimum": bound(low), "maximum": bound(high) }),
        Bounds::NotZero => json!({ "not": { "const": 0 } }),
    };
    number_or_text("number", bounds)
}

/// A bound, without a decimal point if it is a whole number.
fn bound(value: f64) -> Value {
    if value.fract() == 0.0 { json!(value as i64) } else { json!(value) }
}

/// A table of the time, here or in a file, or an expression.
fn history(measured: &Section) -> Value {
    let mut schema = table(measured);
    let rules = [
        ("type", json!(["string", "array", "object"])),
        ("pattern", json!("\\S")),
        ("items", of(&ENTRY)),
        ("minItems", json!(1)),
    ];
    rules.into_iter().for_each(|(rule, value)| schema[rule] = value);
    schema
}

/// Schemes offered by an editor; their numbers may differ.
const SCHEMES: [&str; 15] = [
    "DGM",
    "DGM(0.8)",
    "AS(5, 0.8)",
    "AS(1)",
    "AS(2)",
    "AS(5)",
    "FE(1)",
    "FE(2)",
    "trapezoidal",
    "Lobatto(2)",
    "Newmark(0.25, 0.5)",
    "HHT(0.05)",
    "generalized-alpha(0.8)",
    "Bathe",
    "central-differences",
];

fn scheme() -> Value {
    let number = r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*";
    let points = r"(FE|AS|Lobatto)\(\+?0*[1-9]\d*\)";
    let dissipative = format!(r"AS\(\s*\+?0*[1-9]\d*\s*,{number}\)|DGM\({number}\)");
    let pattern = format!(
        r"^({points}|{dissipative}|DGM|trapezoidal|Bathe|central-differences|Newmark\({number},{number}\)|(HHT|generalized-alpha)\({number}\))$"
    );
    let what =
        "Scheme in time; `emmy list schemes` explains them. Of n Gauss points: FE(n), AS(n), Lobatto(n)";
    // An editor takes the word from the one branch and its description from either.
    let branch = |key: &str, value: Value| json!({ "description": what, "type": "string", key: value });
    json!({ "type": "string", "anyOf": [branch("enum", json!(SCHEMES)), branch("pattern", json!(pattern))] })
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn defaults_match_the_reader() {
        let schema = schema();
        let default =
            |section: &str, key: &str| schema["properties"][section]["properties"][key]["default"].clone();
        assert_eq!(default("newton", "tolerance"), 1e-10);
        assert_eq!(default("output", "every"), 1);
        let models = &schema["definitions"]["material"]["properties"];
        assert_eq!(models["gent"]["properties"]["volumetric"]["default"], "simo-taylor");
        assert_eq!(models["orthotropic"]["properties"]["axis_2"]["default"], json!([0, 1, 0]));
    }
}
