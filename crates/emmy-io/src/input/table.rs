//! Typed reading of the tree: every mismatch is a fault with its place.

use std::sync::Arc;

use emmy::body::{Field, TimeFunction};
use emmy::mesh::Mesh;

use super::description::Section;
use super::fault::{Fault, Place};
use super::suggest::{did_you_mean, listed};
use super::tree::{Entry, Node, Value};
use crate::message;

/// A table whose keys are all known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table<'a> {
    entries: &'a [Entry],
    section: &'static Section,
    place: &'a Place,
}

/// A value together with its key.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item<'a> {
    key: &'a str,
    node: &'a Node,
    /// Place of the key.
    pub(super) key_place: &'a Place,
}

impl<'a> Table<'a> {
    /// The root of the tree.
    pub(super) fn root(node: &'a Node, section: &'static Section) -> Result<Self, Fault> {
        Item { key: "input", node, key_place: &node.place }.table(section)
    }

    /// The value of an optional key.
    pub(super) fn get(&self, key: &str) -> Option<Item<'a>> {
        let entry = self.entries.iter().find(|entry| entry.key == key)?;
        Some(Item { key: &entry.key, node: &entry.node, key_place: &entry.place })
    }

    /// The values of the keys whose names are free.
    pub(super) fn others(&self) -> impl Iterator<Item = Item<'a>> + use<'a> {
        let section = self.section;
        let others = self.entries.iter().filter(|entry| section.names().all(|name| name != entry.key));
        others.map(|entry| Item { key: &entry.key, node: &entry.node, key_place: &entry.place })
    }

    /// The value of a required key.
    pub(super) fn require(&self, key: &str) -> Result<Item<'a>, Fault> {
        self.get(key).ok_or_else(|| {
            let message = format!("`{key}` is missing in {}", self.section.name);
            Fault::at(self.place, message, format!("needs `{key}`"))
        })
    }

    /// The given key of several, of which the table must have exactly one.
    pub(super) fn exactly_one(&self, what: &str) -> Result<Item<'a>, Fault> {
        let keys = self.section.choice();
        let found: Vec<Item> = keys.iter().filter_map(|key| self.get(key)).collect();
        let choice = listed(keys);
        match found[..] {
            [item] => Ok(item),
            [] => {
                let message = format!("{} needs {what}: exactly one of {choice}", self.section.name);
                Err(Fault::at(self.place, message, "none of them is here"))
            }
            _ => {
                let message =
                    format!("{} has more than {what}: give exactly one of {choice}", self.section.name);
                let labels = ["this one"].into_iter().chain(std::iter::repeat("and this one"));
                let label = |fault: Fault, (item, label): (&Item, &str)| fault.label(item.key_place, label);
                Err(found.iter().zip(labels).fold(Fault::new(message), label))
            }
        }
    }

    /// Start of the table.
    pub(super) fn place(&self) -> &'a Place {
        self.place
    }

    fn check_keys(self) -> Result<Self, Fault> {
        let Section { name, others, .. } = self.section;
        if others.is_some() {
            return Ok(self);
        }
        let unknown = |entry: &&Entry| self.section.names().all(|key| key != entry.key);
        let Some(entry) = self.entries.iter().find(unknown) else { return Ok(self) };
        let label = self.section.advice(&entry.key).unwrap_or_else(|| "not a key".to_string());
        let message = format!("unknown key `{}` in {name}", entry.key);
        let help = format!("keys of {name}: {}", listed(self.section.names()));
        Err(Fault::at(&entry.place, message, label).help(help))
    }
}

impl<'a> Item<'a> {
    /// A value that stands under a key.
    pub(super) fn of(key: &'a str, node: &'a Node) -> Self {
        Item { key, node, key_place: &node.place }
    }

    /// Whether the value is a table.
    pub(super) fn is_table(&self) -> bool {
        matches!(self.node.value, Value::Table(_))
    }

    /// Place of the value.
    pub(super) fn place(&self) -> &'a Place {
        &self.node.place
    }

    /// The key.
    pub(super) fn key(&self) -> &'a str {
        self.key
    }

    /// A fault at the value.
    pub(super) fn fault(&self, message: impl Into<String>, label: impl Into<String>) -> Fault {
        Fault::at(self.place(), message, label)
    }

    fn mismatch(&self, wanted: &str) -> Fault {
        let found = self.node.value.kind();
        self.fault(format!("`{}` must be {wanted}, not {found}", self.key), format!("this is {found}"))
    }

    /// A table whose keys are all known.
    pub(super) fn table(&self, section: &'static Section) -> Result<Table<'a>, Fault> {
        match &self.node.value {
            Value::Table(entries) => Table { entries, section, place: &self.node.place }.check_keys(),
            _ => {
                let all = listed(section.names());
                Err(self.mismatch(&format!("a table with the keys {all}")))
            }
        }
    }

    /// Keys and values of a table with arbitrary keys.
    pub(super) fn any_table(&self) -> Result<Vec<(String, Item<'a>)>, Fault> {
        let Value::Table(entries) = &self.node.value else { return Err(self.mismatch("a table")) };
        let item = |entry: &'a Entry| Item { key: &entry.key, node: &entry.node, key_place: &entry.place };
        Ok(entries.iter().map(|entry| (entry.key.clone(), item(entry))).collect())
    }

    /// Place of a key of a table, even if other keys are unknown.
    pub(super) fn has_key(&self, key: &str) -> Option<&'a Place> {
        match &self.node.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key).map(|entry| &entry.place),
            _ => None,
        }
    }

    /// One table or a list of them.
    pub(super) fn one_or_more(&self) -> Result<Vec<Item<'a>>, Fault> {
        match &self.node.value {
            Value::Table(_) => Ok(vec![*self]),
            Value::Array(_) => self.list(),
            _ => Err(self.mismatch("a table or a list of tables")),
        }
    }

    /// The items of a list.
    pub(super) fn list(&self) -> Result<Vec<Item<'a>>, Fault> {
        self.list_or("a list")
    }

    /// The items of a list; `wanted` describes the value in the message.
    pub(super) fn list_or(&self, wanted: &str) -> Result<Vec<Item<'a>>, Fault> {
        let Value::Array(nodes) = &self.node.value else {
            let fault = self.mismatch(wanted);
            return Err(match self.node.value {
                Value::Table(_) => fault.help("put square brackets around it"),
                _ => fault,
            });
        };
        Ok(nodes.iter().map(|node| Item { node, ..*self }).collect())
    }

    /// The text, if the value is a string.
    pub(super) fn text(&self) -> Option<&'a str> {
        match &self.node.value {
            Value::String(text) => Some(text),
            _ => None,
        }
    }

    /// The mesh in memory, if the value is one.
    pub(super) fn mesh(&self) -> Option<&'a Arc<Mesh>> {
        match &self.node.value {
            Value::Mesh(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// The function of time of a program, if the value is one.
    pub(super) fn time_function(&self) -> Option<&'a TimeFunction> {
        match &self.node.value {
            Value::TimeFunction(function) => Some(function),
            _ => None,
        }
    }

    /// The field of a program, if the value is one.
    pub(super) fn field(&self) -> Option<&'a Field> {
        match &self.node.value {
            Value::Field(field) => Some(field),
            _ => None,
        }
    }

    /// A string that is not empty.
    pub(super) fn string(&self) -> Result<&'a str, Fault> {
        match &self.node.value {
            Value::String(text) if text.trim().is_empty() => {
                Err(self.fault(format!("`{}` must not be empty", self.key), "empty"))
            }
            Value::String(text) => Ok(text),
            _ => Err(self.mismatch("a string")),
        }
    }

    /// A name that files can hold, read like the names in meshes.
    pub(super) fn name(&self) -> Result<String, Fault> {
        Ok(message::name(self.string()?).into_owned())
    }

    /// True or false.
    pub(super) fn boolean(&self) -> Result<bool, Fault> {
        match self.node.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.mismatch("true or false")),
        }
    }

    /// One of the known words.
    pub(super) fn word(&self, what: &str, known: &[&str]) -> Result<&'a str, Fault> {
        if self.text().is_none() {
            return Err(self.mismatch(&format!("one of {}", listed(known.iter().copied()))));
        }
        let text = self.string()?;
        if known.contains(&text) {
            return Ok(text);
        }
        let label = did_you_mean(text, known.iter().copied()).unwrap_or_else(|| format!("not {what}"));
        let message = format!("`{text}` is not {what}; there is {}", listed(known.iter().copied()));
        Err(self.fault(message, label))
    }

    /// The value meant by one of the known words.
    pub(super) fn one_of<T: Copy>(&self, what: &str, known: &[(&str, T)]) -> Result<T, Fault> {
        let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        let word = self.word(what, &words)?;
        let found = known.iter().find(|(other, _)| *other == word);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| self.fault(format!("`{word}` is not {what}"), "not known"))
    }

    /// A finite number; whole numbers are numbers too.
    pub(super) fn number(&self) -> Result<f64, Fault> {
        match self.node.value {
            Value::Float(value) if !value.is_finite() => {
                Err(self.fault(format!("`{}` must be a finite number, not {value}", self.key), "not finite"))
            }
            Value::Float(value) => Ok(value),
            Value::Integer(value) => Ok(value as f64),
            _ => Err(self.not_a_number("a number")),
        }
    }

    /// The fault of a value that is not a number; text that contains one gets advice.
    fn not_a_number(&self, wanted: &str) -> Fault {
        let fault = self.mismatch(wanted);
        match self.text().map(str::trim) {
            Some(text) if text.parse::<f64>().is_ok() => fault.help("numbers stand without quotes"),
            Some(text) if text.starts_with(|c: char| c.is_ascii_digit() || ".+-".contains(c)) => fault.help(
                "give the number alone: units are any consistent set, such as m, kg, s, and are not written",
            ),
            _ => fault,
        }
    }

    /// A positive finite number.
    pub(super) fn positive(&self) -> Result<f64, Fault> {
        match self.number()? {
            value if value > 0.0 => Ok(value),
            value => {
                let message = format!("`{}` must be positive, not {}", self.key, spelled(value));
                Err(self.fault(message, "not positive"))
            }
        }
    }

    /// A whole number not below a smallest one.
    pub(super) fn whole(&self, least: usize) -> Result<usize, Fault> {
        let value = match self.node.value {
            Value::Integer(value) => value,
            Value::Float(value) => {
                let message = format!("`{}` must be a whole number, not {}", self.key, decimal(value));
                return Err(self.fault(message, "not whole"));
            }
            _ => return Err(self.not_a_number("a whole number")),
        };
        let fits = usize::try_from(value).ok().filter(|&value| value >= least);
        fits.ok_or_else(|| {
            self.fault(format!("`{}` must be at least {least}, not {value}", self.key), "too small")
        })
    }

    /// The given number of values.
    pub(super) fn exactly<const N: usize>(&self, what: &str) -> Result<[Item<'a>; N], Fault> {
        let Value::Array(nodes) = &self.node.value else {
            return Err(self.mismatch(&format!("a list of {N} {what}")));
        };
        let items: Vec<Item> = nodes.iter().map(|node| Item { node, ..*self }).collect();
        items.try_into().map_err(|items: Vec<Item>| {
            let message = format!("`{}` must have {N} {what}, not {}", self.key, items.len());
            self.fault(message, format!("{} here", items.len()))
        })
    }

    /// Finite numbers in a list of fixed length.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], Fault> {
        each(self.exactly("numbers")?, |item| item.number())
    }

    /// Whole numbers in a list of fixed length.
    pub(super) fn wholes<const N: usize>(&self, least: usize) -> Result<[usize; N], Fault> {
        each(self.exactly("whole numbers")?, |item| item.whole(least))
    }

    /// A 3x3 tensor, row by row.
    pub(super) fn tensor(&self) -> Result<[[f64; 3]; 3], Fault> {
        each(self.exactly("rows")?, |row| row.numbers())
    }
}

/// A number, with an exponent if it would otherwise have many digits.
pub(super) fn spelled(value: f64) -> String {
    let text = decimal(value);
    text.strip_suffix(".0").unwrap_or(&text).to_string()
}

/// A number that is recognizably not whole: `2.0`.
fn decimal(value: f64) -> String {
    format!("{value:?}")
}

/// The results of all items, or the first fault.
fn each<const N: usize, T: Copy + Default>(
    items: [Item<'_>; N],
    read: impl Fn(&Item<'_>) -> Result<T, Fault>,
) -> Result<[T; N], Fault> {
    let mut values = [T::default(); N];
    for (value, item) in values.iter_mut().zip(&items) {
        *value = read(item)?;
    }
    Ok(values)
}
