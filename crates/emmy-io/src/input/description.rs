//! Description of the input: tables, their keys with kinds, defaults and a sentence each, and the rules between keys.
//!
//! Every table is described once, in the file that reads it. The check of keys and values, the defaults, the JSON
//! schema and the tables of `book/src/input.md` come from these descriptions.

use std::sync::LazyLock;

use emmy::internals::material::{Bounds, IfAbsent, Parameter, ParameterKind};
use emmy::material::Volumetric;

use super::fault::Fault;
use super::tree::{Entry, Node, Value};

/// A table of the input. Its description is created on first use.
pub(super) type Described = LazyLock<Section>;

/// A table of the input, such as `[mesh]` or `box`.
#[derive(Debug)]
pub(super) struct Section {
    /// Its key, its heading in brackets, or words.
    pub(super) name: &'static str,
    /// One sentence on it.
    pub(super) doc: String,
    pub(super) keys: Vec<Key>,
    /// Rule between the keys.
    pub(super) rule: Rule,
    /// Further keys, whose names are free.
    pub(super) others: Option<Others>,
}

/// Keys of a table whose names are free.
#[derive(Debug)]
pub(super) struct Others {
    /// Kind of their values.
    pub(super) kind: Kind,
    /// One sentence on them.
    pub(super) doc: &'static str,
}

/// A key of a table.
#[derive(Debug, Clone)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    /// Unit, such as `length`; empty for a number without dimension and for other values.
    pub(super) unit: &'static str,
    pub(super) if_absent: IfAbsent,
    /// One sentence on it.
    pub(super) doc: String,
}

/// Kind of the value of a key.
#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// A text that is not empty.
    Text,
    /// Name of a column: letters, digits, `_` and `-`, except these names.
    Column(&'static [&'static str]),
    Number(Bounds),
    /// A whole number from the first to the second.
    Whole(usize, Option<usize>),
    /// One of several words: what they are, the words, and what is wrong with another one.
    Word(&'static str, Vec<&'static str>, Doubt),
    /// A list of different words, with a least number of them.
    Words(usize, Box<Kind>),
    /// A scheme in time.
    Scheme(Doubt),
    /// `true`.
    True,
    /// A list with a least number of entries.
    List(usize, Box<Kind>),
    /// A list of a fixed length.
    Exactly(usize, Box<Kind>),
    /// Lists of whole numbers by name.
    Groups,
    /// A table of the time, here or in a file as this table says, or an expression.
    TimeFunction(&'static Section),
    /// A number, or an expression of position and time.
    Expression,
    /// A vector of this kind, or the field of a program.
    Field(Box<Kind>),
    /// A value of one of two kinds, which its form tells apart.
    Either(Box<[Kind; 2]>),
    /// A table.
    Table(&'static Section),
    /// One table, or a list with a least number of them.
    Tables(usize, Box<Kind>),
}

/// The fault of a text, and a label for its place.
pub(super) type Doubt = fn(&str) -> Option<(Fault, String)>;

/// An entry of a table of the time.
pub(super) static ENTRY: LazyLock<Kind> = LazyLock::new(|| exactly(2, NUMBER));

/// Members of a group.
pub(super) static MEMBERS: LazyLock<Kind> = LazyLock::new(|| list(0, whole(0)));

/// Rules between the keys of a table.
#[derive(Debug, Clone)]
pub(super) enum Rule {
    /// No rule.
    Free,
    /// Exactly one of these must be given, each with the keys that it needs.
    ExactlyOne(Vec<Vec<&'static str>>),
    /// Exactly two of the elastic constants must be given.
    TwoElasticConstants,
    /// At least one of these must be given.
    AtLeastOne(Vec<&'static str>),
    /// `density` must be given unless the material has no mass; `pressure` belongs to a projected volume.
    Region,
    /// `mesh` and `region` must be given, or neither of them but `rigid`; at least one of these keys, too.
    Input(&'static [&'static str]),
}

/// Names that would repeat columns of the whole body.
pub(super) const TAKEN: [&str; 2] = ["linear_momentum", "angular_momentum"];

/// A number.
pub(super) const NUMBER: Kind = Kind::Number(Bounds::Any);

/// A number above zero.
pub(super) const POSITIVE: Kind = Kind::Number(Bounds::Above(0.0));

/// A part of something.
pub(super) const BELOW_ONE: Kind = Kind::Number(Bounds::Between(0.0, 1.0));

/// One of several words; `what` they are.
pub(super) fn word(what: &'static str, words: impl IntoIterator<Item = &'static str>) -> Kind {
    Kind::Word(what, words.into_iter().collect(), |_| None)
}

/// A list of different words; `what` they are.
pub(super) fn words(what: &'static str, words: impl IntoIterator<Item = &'static str>) -> Kind {
    Kind::Words(0, Box::new(word(what, words)))
}

/// One table, or a list with a least number of them.
pub(super) fn tables(least: usize, section: &'static Section) -> Kind {
    Kind::Tables(least, Box::new(Kind::Table(section)))
}

/// A whole number from a smallest one on.
pub(super) const fn whole(least: usize) -> Kind {
    Kind::Whole(least, None)
}

/// Three numbers.
pub(super) fn vector() -> Kind {
    exactly(3, NUMBER)
}

/// A list of a fixed length.
pub(super) fn exactly(length: usize, of: Kind) -> Kind {
    Kind::Exactly(length, Box::new(of))
}

/// A value of one of two kinds.
pub(super) fn either(first: Kind, second: Kind) -> Kind {
    Kind::Either(Box::new([first, second]))
}

/// A list with a least number of entries.
pub(super) fn list(least: usize, of: Kind) -> Kind {
    Kind::List(least, Box::new(of))
}

impl Kind {
    /// Kind of the entries of a list, of the values of a table with free names, or of one of several tables.
    pub(super) fn inner(&'static self) -> &'static Kind {
        match self {
            Kind::Words(_, of) | Kind::List(_, of) | Kind::Exactly(_, of) | Kind::Tables(_, of) => of,
            Kind::Field(of) => of.inner(),
            Kind::TimeFunction(_) => &ENTRY,
            Kind::Groups => &MEMBERS,
            Kind::Either(kinds) => kinds[0].inner(),
            _ => self,
        }
    }

    /// The description of a table that a value is or contains.
    pub(super) fn section(&self) -> Option<&'static Section> {
        match self {
            Kind::Table(section) | Kind::TimeFunction(section) => Some(section),
            Kind::List(_, of) | Kind::Tables(_, of) => of.section(),
            Kind::Either(kinds) => kinds.iter().find_map(Kind::section),
            _ => None,
        }
    }
}

impl Key {
    /// A required key.
    pub(super) fn new(name: &'static str, kind: Kind, unit: &'static str, doc: &str) -> Self {
        Key { name, kind, unit, if_absent: IfAbsent::Required, doc: doc.to_string() }
    }
}

impl From<&Parameter> for Key {
    fn from(parameter: &Parameter) -> Self {
        let kind = match parameter.kind {
            ParameterKind::Number(bounds) => Kind::Number(bounds),
            ParameterKind::Numbers => list(1, NUMBER),
            ParameterKind::Direction => vector(),
            ParameterKind::Directions => list(1, vector()),
            ParameterKind::Law => word("a law of volume", Volumetric::ALL.map(Volumetric::name)),
        };
        let if_absent = parameter.if_absent;
        Key { if_absent, ..Key::new(parameter.name, kind, parameter.unit, parameter.doc) }
    }
}

impl Section {
    /// A table without keys.
    pub(super) fn new(name: &'static str, doc: &str) -> Self {
        Section { name, doc: doc.to_string(), keys: Vec::new(), rule: Rule::Free, others: None }
    }

    /// The same table with a required key.
    pub(super) fn must(self, name: &'static str, kind: Kind, unit: &'static str, doc: &str) -> Self {
        self.key(Key::new(name, kind, unit, doc))
    }

    /// The same table with an optional key, which has no effect if it is left out.
    pub(super) fn may(self, name: &'static str, kind: Kind, unit: &'static str, doc: &str) -> Self {
        self.key(Key { if_absent: IfAbsent::Means(""), ..Key::new(name, kind, unit, doc) })
    }

    /// The same table with a key.
    pub(super) fn key(mut self, key: Key) -> Self {
        self.keys.push(key);
        self
    }

    /// The same table, where the last key has a default: a value as in TOML, which is inserted if the key is left out.
    pub(super) fn default(self, value: &'static str) -> Self {
        self.last(IfAbsent::Value(value))
    }

    /// The same table, where leaving out the last key has this meaning.
    pub(super) fn absent(self, meaning: &'static str) -> Self {
        self.last(IfAbsent::Means(meaning))
    }

    fn last(mut self, if_absent: IfAbsent) -> Self {
        self.keys.iter_mut().last().into_iter().for_each(|key| key.if_absent = if_absent);
        self
    }

    /// The same table with further keys, whose names are free.
    pub(super) fn others(self, others: Others) -> Self {
        Section { others: Some(others), ..self }
    }

    /// The same table, where exactly one of some keys must be given.
    pub(super) fn exactly_one(self, of: &[&'static str]) -> Self {
        let rule = Rule::ExactlyOne(of.iter().map(|&key| vec![key]).collect());
        Section { rule, ..self }
    }

    /// The same table, where at least one of some keys must be given.
    pub(super) fn at_least_one(self, of: &[&'static str]) -> Self {
        Section { rule: Rule::AtLeastOne(of.to_vec()), ..self }
    }

    /// The keys of which the rule requires one.
    pub(super) fn choice(&self) -> Vec<&'static str> {
        match &self.rule {
            Rule::ExactlyOne(sets) => sets.iter().filter_map(|keys| keys.first().copied()).collect(),
            Rule::AtLeastOne(keys) => keys.clone(),
            Rule::Input(keys) => keys.to_vec(),
            Rule::Free | Rule::Region | Rule::TwoElasticConstants => Vec::new(),
        }
    }

    /// Name of the table in messages: a key in back-quotes.
    pub(super) fn title(&self) -> String {
        if self.name.contains(['[', ' ']) { self.name.to_string() } else { format!("`{}`", self.name) }
    }

    /// A key by its name.
    pub(super) fn key_of(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// Names of the keys.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.keys.iter().map(|key| key.name)
    }
}

/// Visits a value and the values in it with their kinds, each before those in it. A value that may be of two kinds, or
/// one table or several, is visited with each.
pub(super) fn for_each_value(
    node: &mut Node,
    kind: &'static Kind,
    visit: &mut impl FnMut(&mut Node, &'static Kind),
) {
    visit(node, kind);
    match (kind, &mut node.value) {
        (Kind::Either(kinds), _) => kinds.iter().for_each(|kind| for_each_value(node, kind, visit)),
        (Kind::Tables(..), Value::Table(_)) => for_each_value(node, kind.inner(), visit),
        (_, Value::Array(items)) => {
            items.iter_mut().for_each(|item| for_each_value(item, kind.inner(), visit))
        }
        (_, Value::Table(entries)) => {
            let Some(section) = kind.section() else { return };
            for Entry { key, node, .. } in entries {
                let own = section.key_of(key).map(|key| &key.kind);
                let own = own.or(section.others.as_ref().map(|others| &others.kind));
                own.into_iter().for_each(|kind| for_each_value(node, kind, visit));
            }
        }
        _ => {}
    }
}
