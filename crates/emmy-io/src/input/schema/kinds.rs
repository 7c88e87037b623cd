//! Kinds of values, and tables of them, as JSON schemas.

use serde_json::{Map, Value, json};

use super::super::keys::Keys;

/// Schema of a table whose keys are all known.
#[derive(Debug)]
pub(super) struct Table {
    keys: Keys,
    what: String,
    properties: Map<String, Value>,
    required: Vec<&'static str>,
    rules: Map<String, Value>,
}

impl Table {
    /// A table without keys; `what` describes it.
    pub(super) fn new(keys: Keys, what: &str) -> Self {
        let (properties, rules) = (Map::new(), Map::new());
        Table { keys, what: what.to_string(), properties, required: Vec::new(), rules }
    }

    /// The same with a key that may be left out.
    pub(super) fn may(mut self, key: &str, schema: Value) -> Self {
        self.properties.insert(key.to_string(), schema);
        self
    }

    /// The same with a key that must be there.
    pub(super) fn must(mut self, key: &'static str, schema: Value) -> Self {
        self.required.push(key);
        self.may(key, schema)
    }

    /// The same with a rule of JSON schema, such as `oneOf`.
    pub(super) fn rule(mut self, rule: &str, value: Value) -> Self {
        self.rules.insert(rule.to_string(), value);
        self
    }

    /// The same where exactly one of these sets of keys is there.
    pub(super) fn one_of(self, choices: &[&[&str]]) -> Self {
        let choices: Vec<Value> = choices.iter().map(|keys| json!({ "required": keys })).collect();
        self.rule("oneOf", choices.into())
    }

    /// The schema.
    pub(super) fn schema(self) -> Value {
        let mut schema = json!({
            "title": self.keys.table,
            "description": self.what,
            "type": "object",
            "properties": self.properties,
            "additionalProperties": false,
        });
        if !self.required.is_empty() {
            schema["required"] = json!(self.required);
        }
        self.rules.into_iter().for_each(|(rule, value)| schema[rule] = value);
        schema
    }

    /// The schema of one such table or a list of them. Written without a choice of two schemas, because a validator can only say
    /// of a choice that none of it fits, and not which key is wrong.
    pub(super) fn one_or_more(self) -> Value {
        let rules = Value::from(self.rules.clone());
        let one = self.schema();
        let mut schema = one.clone();
        // A list fits all of the choices between keys, which is too many for `oneOf`: they are for tables only.
        rules.as_object().into_iter().flatten().for_each(|(rule, _)| {
            schema.as_object_mut().and_then(|schema| schema.remove(rule));
        });
        schema["if"] = json!({ "type": "object" });
        schema["then"] = rules;
        schema["type"] = json!(["object", "array"]);
        schema["items"] = one;
        schema
    }
}

/// Any finite number.
pub(super) fn number(what: &str) -> Value {
    json!({ "description": what, "type": "number" })
}

/// A number above zero.
pub(super) fn positive(what: &str) -> Value {
    json!({ "description": what, "type": "number", "exclusiveMinimum": 0 })
}

/// A whole number from a least one on.
pub(super) fn whole(least: usize, what: &str) -> Value {
    json!({ "description": what, "type": "integer", "minimum": least })
}

/// A text that is not empty.
pub(super) fn text(what: &str) -> Value {
    json!({ "description": what, "type": "string", "pattern": "\\S" })
}

/// One of several words.
pub(super) fn words(words: &[&str], what: &str) -> Value {
    json!({ "description": what, "type": "string", "enum": words })
}

/// A list of any length from a least one on.
pub(super) fn list(least: usize, items: Value, what: &str) -> Value {
    json!({ "description": what, "type": "array", "items": items, "minItems": least })
}

/// A list of a fixed length.
pub(super) fn exactly(length: usize, items: Value, what: &str) -> Value {
    json!({ "description": what, "type": "array", "items": items, "minItems": length, "maxItems": length })
}

/// Three numbers.
pub(super) fn vector(what: &str) -> Value {
    exactly(3, json!({ "type": "number" }), what)
}

/// A factor, a displacement or an angle over time.
pub(super) fn history(what: &str) -> Value {
    let entry = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    let form = "a list of [time, value], or an expression of the time t such as \"sin(2*pi*t)\"";
    json!({
        "description": format!("{what}: {form}"),
        "type": ["string", "array"],
        "pattern": "\\S",
        "items": entry,
        "minItems": 1,
    })
}
