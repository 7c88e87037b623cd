//! The input as a tree whose keys and values know their places.

use std::path::Path;
use std::sync::Arc;

use emmy::body::{Field, TimeFunction};
use emmy::mesh::Mesh;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{Fault, InputError, Place};
use super::syntax;

/// A value and its place.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) place: Place,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub(super) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime(String),
    Array(Vec<Node>),
    Table(Vec<Entry>),
    /// A mesh in memory, in place of `[mesh]`.
    Mesh(Arc<Mesh>),
    /// A function of a program, in place of a history.
    TimeFunction(TimeFunction),
    /// A function of a program, in place of a vector.
    Field(Field),
}

/// A key of a table with its value.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) place: Place,
    pub(super) node: Node,
}

impl Value {
    /// Description of the value, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Value::String(_) => "a string",
            Value::Integer(_) => "a whole number",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime(_) => "a date",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
            Value::Mesh(_) => "a mesh",
            Value::TimeFunction(_) | Value::Field(_) => "a function",
        }
    }
}

impl Node {
    /// The entries, if the node is a table.
    pub(super) fn entries_mut(&mut self) -> Option<&mut Vec<Entry>> {
        match &mut self.value {
            Value::Table(entries) => Some(entries),
            _ => None,
        }
    }

    /// The value of a key, if the node is a table that has it.
    pub(super) fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries_mut()?.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    /// Sets a key of the first table of a list, or of the table itself.
    pub(super) fn put_in_first(&mut self, key: &str, node: Node) {
        match &mut self.value {
            Value::Array(items) => items.iter_mut().take(1).for_each(|item| item.put(key, node.clone())),
            _ => self.put(key, node),
        }
    }

    /// Sets a key of a table; any other node is unchanged.
    pub(super) fn put(&mut self, key: &str, node: Node) {
        let Some(entries) = self.entries_mut() else { return };
        match entries.iter_mut().find(|entry| entry.key == key) {
            Some(entry) => entry.node = node,
            None => entries.push(Entry { key: key.to_string(), place: node.place.clone(), node }),
        }
    }
}

/// The tree of a file.
pub(super) fn read(path: &Path) -> Result<Node, InputError> {
    let name = path.display().to_string();
    let bytes = crate::whole_file::read(path).map_err(|error| unreadable(path, &error))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
        Fault::new(format!("{name}:{line}: the file is not UTF-8 text")).help(match error.as_bytes() {
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "it is UTF-16: save it as UTF-8",
            bytes if bytes.contains(&0) => {
                "an input is a TOML text file; `emmy new l-block` writes an example"
            }
            _ => "save it as UTF-8; an older encoding such as Latin-1 is not read",
        })
    })?;
    parse(&name, &text)
}

fn unreadable(path: &Path, error: &std::io::Error) -> Fault {
    let fault = Fault::new(format!("cannot read {}: {error}", path.display()));
    let with_extension = path.with_extension("toml");
    if path.is_dir() {
        return fault.help("it is a directory; the input is a TOML file");
    }
    match with_extension != path && with_extension.is_file() {
        true => fault.help(format!("did you mean {}?", with_extension.display())),
        false => fault.help("`emmy new l-block` writes an example"),
    }
}

/// The tree of a text; `name` is its name in messages.
pub(super) fn parse(name: &str, text: &str) -> Result<Node, InputError> {
    let start = Place::start_of(name, text);
    let table = DeTable::parse(text).map_err(|error| syntax_fault(&start, &error))?;
    Ok(node(&start, Spanned::new(0..0, DeValue::Table(table.into_inner())))?)
}

fn syntax_fault(start: &Place, error: &toml::de::Error) -> Fault {
    let message = error.message();
    match error.span() {
        Some(span) => {
            let advice = syntax::advice(message, start.text(), span.start);
            let fault = Fault::at(&start.at(span), format!("not valid TOML: {message}"), "here");
            advice.into_iter().fold(fault, Fault::help)
        }
        None => Fault::new(format!("{}: not valid TOML: {message}", start.source_name())),
    }
}

fn node(start: &Place, spanned: Spanned<DeValue<'_>>) -> Result<Node, Fault> {
    let place = start.at(spanned.span());
    let value = match spanned.into_inner() {
        DeValue::String(text) => Value::String(text.into_owned()),
        DeValue::Integer(integer) => {
            let value = i64::from_str_radix(integer.as_str(), integer.radix());
            Value::Integer(value.map_err(|_| number_fault(&place))?)
        }
        DeValue::Float(float) => Value::Float(float.as_str().parse().map_err(|_| number_fault(&place))?),
        DeValue::Boolean(value) => Value::Boolean(value),
        DeValue::Datetime(date) => Value::Datetime(date.to_string()),
        DeValue::Array(items) => {
            Value::Array(items.into_iter().map(|item| node(start, item)).collect::<Result<_, _>>()?)
        }
        DeValue::Table(table) => {
            Value::Table(table.into_iter().map(|item| entry(start, item)).collect::<Result<_, _>>()?)
        }
    };
    Ok(Node { value, place })
}

fn entry(
    start: &Place,
    (key, value): (Spanned<std::borrow::Cow<'_, str>>, Spanned<DeValue<'_>>),
) -> Result<Entry, Fault> {
    let place = start.at(key.span());
    Ok(Entry { key: key.into_inner().into_owned(), place, node: node(start, value)? })
}

fn number_fault(place: &Place) -> Fault {
    Fault::at(place, "a number that is too large", "whole numbers reach to 9223372036854775807")
}
