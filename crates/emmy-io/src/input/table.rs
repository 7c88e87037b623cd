//! Values of tables that are right: their keys, kinds and rules were checked against the description (`walk`).

use std::sync::LazyLock;

use emmy::body::Field;

use super::description::{Kind, Section};
use super::fault::{Fault, Place};
use super::tree::{Entry, Node, Value};
use crate::message;

/// A table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table<'a> {
    entries: &'a [Entry],
    pub(super) section: &'static Section,
    /// Start of the table.
    pub(super) place: &'a Place,
}

/// A value together with its key and its kind.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item<'a> {
    /// The key.
    pub(super) key: &'a str,
    pub(super) node: &'a Node,
    pub(super) kind: &'static Kind,
    /// Place of the key.
    pub(super) key_place: &'a Place,
}

/// A value of a known kind. A value of another kind cannot stand in a table that is right; it reads as nothing: not a
/// number, zero or empty.
pub(super) trait Read<'a> {
    fn read(item: Item<'a>) -> Self;
}

/// Stands for a missing value.
static NOTHING: LazyLock<Node> =
    LazyLock::new(|| Node { value: Value::Table(Vec::new()), place: Place::start_of("", "") });

impl<'a> Table<'a> {
    /// The value of a key, if it is there.
    pub(super) fn item(&self, key: &str) -> Option<Item<'a>> {
        self.item_of(self.entries.iter().find(|entry| entry.key == key)?)
    }

    fn item_of(&self, entry: &'a Entry) -> Option<Item<'a>> {
        let kind = self.section.key_of(&entry.key).map(|key| &key.kind);
        let kind = kind.or(self.section.others.as_ref().map(|others| &others.kind))?;
        Some(Item { key: &entry.key, node: &entry.node, kind, key_place: &entry.place })
    }

    /// The value of an optional key.
    pub(super) fn may<T: Read<'a>>(&self, key: &str) -> Option<T> {
        self.item(key).map(T::read)
    }

    /// The value of a key that is required or has a default.
    pub(super) fn must<T: Read<'a>>(&self, key: &str) -> T {
        let item = self.item(key);
        debug_assert!(item.is_some(), "{}: `{key}` is not there", self.section.name);
        T::read(item.unwrap_or(Item { key: "", node: &NOTHING, kind: &Kind::Text, key_place: self.place }))
    }

    /// The given key of those of which exactly one must be given.
    pub(super) fn chosen(&self) -> Item<'a> {
        let given = self.section.choice().into_iter().find(|key| self.item(key).is_some());
        self.must(given.unwrap_or_default())
    }

    /// The name of the group, as files can hold it, and its place.
    pub(super) fn group(&self) -> Option<(String, Place)> {
        self.item("group").map(|item| (item.name(), item.place().clone()))
    }

    /// Keys and values.
    pub(super) fn items(&self) -> impl Iterator<Item = Item<'a>> + use<'a> {
        let table = *self;
        self.entries.iter().filter_map(move |entry| table.item_of(entry))
    }

    /// Keys and values whose names are free.
    pub(super) fn others(&self) -> impl Iterator<Item = Item<'a>> + use<'a> {
        let section = self.section;
        self.items().filter(move |item| section.key_of(item.key).is_none())
    }

    /// All keys with their places, known or not.
    pub(super) fn keys(&self) -> impl Iterator<Item = (&'a str, &'a Place)> + use<'a> {
        self.entries.iter().map(|entry| (entry.key.as_str(), &entry.place))
    }
}

impl<'a> Item<'a> {
    /// A value that stands under a key.
    pub(super) fn of(key: &'a str, node: &'a Node, kind: &'static Kind) -> Self {
        Item { key, node, kind, key_place: &node.place }
    }

    /// The value.
    pub(super) fn value(&self) -> &'a Value {
        &self.node.value
    }

    /// Place of the value.
    pub(super) fn place(&self) -> &'a Place {
        &self.node.place
    }

    /// A fault at the value.
    pub(super) fn fault(&self, message: impl Into<String>, label: impl Into<String>) -> Fault {
        Fault::at(self.place(), message, label)
    }

    /// The table, if it is one.
    pub(super) fn table(&self) -> Option<Table<'a>> {
        let section = self.kind.section()?;
        match self.value() {
            Value::Table(entries) => Some(Table { entries, section, place: self.place() }),
            _ => None,
        }
    }

    /// The entries of a list or of a table with free names; of a single value where there may be several, this value.
    pub(super) fn items(&self) -> Vec<Item<'a>> {
        let kind = self.kind.inner();
        match (self.kind, self.value()) {
            (_, Value::Array(nodes)) => nodes.iter().map(|node| Item { node, kind, ..*self }).collect(),
            (Kind::Groups, Value::Table(entries)) => {
                let of = |Entry { key, node, place }: &'a Entry| Item { key, node, kind, key_place: place };
                entries.iter().map(of).collect()
            }
            _ => vec![Item { kind, ..*self }],
        }
    }

    /// The text, if the value is a string.
    pub(super) fn text(&self) -> Option<&'a str> {
        match self.value() {
            Value::String(text) => Some(text),
            _ => None,
        }
    }

    /// The same value as one of the kind whose form it has, where there are two; `None` if it has neither form.
    pub(super) fn of_one_kind(self) -> Option<Item<'a>> {
        match self.kind {
            Kind::Either(kinds) => {
                let kind = kinds.iter().find(|kind| has_form(kind, self.value()))?;
                Some(Item { kind, ..self })
            }
            _ => Some(self),
        }
    }

    /// A name that files can hold, read like the names in meshes.
    pub(super) fn name(&self) -> String {
        message::name(self.text().unwrap_or_default()).into_owned()
    }

    /// The value meant by a word.
    pub(super) fn one_of<T: Copy, const N: usize>(&self, known: [(&str, T); N]) -> T {
        let found = known.iter().find(|(word, _)| Some(*word) == self.text());
        debug_assert!(found.is_some(), "`{}`: {:?}", self.key, self.text());
        found.unwrap_or(&known[0]).1
    }

    /// The field of a program, if the value is one.
    pub(super) fn field(&self) -> Option<&'a Field> {
        match self.value() {
            Value::Field(field) => Some(field),
            _ => None,
        }
    }
}

impl<'a> Read<'a> for Item<'a> {
    fn read(item: Item<'a>) -> Self {
        item
    }
}

impl<'a> Read<'a> for Table<'a> {
    fn read(item: Item<'a>) -> Self {
        let place = item.place();
        debug_assert!(item.table().is_some(), "`{}` is not a table", item.key);
        item.table().unwrap_or(Table { entries: &[], section: &EMPTY, place })
    }
}

/// A table without keys.
static EMPTY: LazyLock<Section> = LazyLock::new(|| Section::new("", ""));

impl<'a> Read<'a> for &'a str {
    fn read(item: Item<'a>) -> Self {
        item.text().unwrap_or_default()
    }
}

impl Read<'_> for f64 {
    fn read(item: Item<'_>) -> Self {
        match *item.value() {
            Value::Float(value) => value,
            Value::Integer(value) => value as f64,
            _ => f64::NAN,
        }
    }
}

impl Read<'_> for usize {
    fn read(item: Item<'_>) -> Self {
        match *item.value() {
            Value::Integer(value) => usize::try_from(value).unwrap_or(0),
            _ => 0,
        }
    }
}

/// Whether a value has the form of numbers, texts, words, histories, or lists of such a form.
fn has_form(kind: &Kind, value: &Value) -> bool {
    match (kind, value) {
        (Kind::Number(_), Value::Integer(_) | Value::Float(_))
        | (Kind::Text | Kind::Word(..), Value::String(_))
        | (Kind::Words(..), Value::Array(_)) => true,
        (
            Kind::TimeFunction(_),
            Value::String(_) | Value::Array(_) | Value::Table(_) | Value::TimeFunction(_),
        ) => true,
        (Kind::Exactly(_, of), Value::Array(items)) => {
            items.first().is_none_or(|first| has_form(of, &first.value))
        }
        _ => false,
    }
}

impl<'a, T: Read<'a>> Read<'a> for Vec<T> {
    fn read(item: Item<'a>) -> Self {
        item.items().into_iter().map(T::read).collect()
    }
}

impl<'a, T: Read<'a>, const N: usize> Read<'a> for [T; N] {
    fn read(item: Item<'a>) -> Self {
        let items = item.items();
        debug_assert_eq!(items.len(), N, "`{}`", item.key);
        std::array::from_fn(|i| T::read(items.get(i).copied().unwrap_or(Item { node: &NOTHING, ..item })))
    }
}

/// A number, with an exponent if it would otherwise have many digits.
pub(super) fn spelled(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_string()
}
