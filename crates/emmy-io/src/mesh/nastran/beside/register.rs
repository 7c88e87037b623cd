//! The entries made so far, with their groups of nodes and notes.

use std::collections::{BTreeMap, HashSet};

use toml::{Table, Value};

use super::super::super::DeckEntry;
use super::super::super::abaqus::{At, Deck};
use super::super::super::entry::first_names;
use super::fields::{Reason, Stored};
use crate::message::counted;

/// Cards that are left out for one reason.
#[derive(Debug)]
struct LeftOut {
    n: usize,
    /// Several in a row may have one name.
    names: Vec<String>,
    /// The first one.
    at: At,
    is_fault: bool,
}

pub(super) struct Register<'a> {
    deck: &'a Deck,
    pub(super) entries: Vec<DeckEntry>,
    /// Groups of nodes.
    pub(super) groups: Vec<(String, Vec<u64>)>,
    /// Grid points that entries use.
    pub(super) used: HashSet<u64>,
    /// Names of entries and groups, in lower case.
    taken: HashSet<String>,
    /// By the card, or a part of it, and the reason.
    left_out: BTreeMap<(String, String), LeftOut>,
    remarks: Vec<String>,
}

impl<'a> Register<'a> {
    pub(super) fn new(deck: &'a Deck) -> Self {
        let body = &deck.root;
        let taken = body.node_sets.keys().chain(body.element_sets.keys()).cloned().collect();
        Register {
            deck,
            entries: Vec::new(),
            groups: Vec::new(),
            used: HashSet::new(),
            taken,
            left_out: BTreeMap::new(),
            remarks: Vec::new(),
        }
    }

    /// A name that nothing in the file has.
    pub(super) fn name(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_string();
        let mut count = 1;
        while !self.taken.insert(name.clone()) {
            count += 1;
            name = format!("{wanted}-{count}");
        }
        name
    }

    /// A new group of nodes.
    pub(super) fn group(&mut self, wanted: &str, nodes: impl IntoIterator<Item = u64>) -> String {
        let name = self.name(wanted);
        self.groups.push((name.clone(), nodes.into_iter().collect()));
        name
    }

    /// Adds an entry with its card and label, and with words for one and for several of its kind.
    pub(super) fn add(
        &mut self,
        section: &'static str,
        name: &str,
        (kind, label): (&'static str, String),
        words: [&'static str; 2],
        table: Table,
    ) {
        let [name, section, kind] = [name, section, kind].map(str::to_string);
        self.entries.push(DeckEntry { name, section, kind, label, words: words.map(str::to_string), table });
    }

    /// Leaves out a card.
    pub(super) fn leave_out(&mut self, card: &Stored, reason: Reason) {
        self.leave_out_named(card.name, card.label(), card.at, reason);
    }

    /// Leaves out a card, or a part of it, under a name.
    pub(super) fn leave_out_named(&mut self, card: &str, name: String, at: At, reason: Reason) {
        let Reason { text, is_fault } = reason;
        let new = || LeftOut { n: 0, names: Vec::new(), at, is_fault };
        let own = self.left_out.entry((card.to_string(), text.into_owned())).or_insert_with(new);
        // Several cards may be one thing.
        for name in name.split(", ").map(str::to_string) {
            own.n += 1;
            own.names.extend((own.names.last() != Some(&name)).then_some(name));
        }
    }

    pub(super) fn remark(&mut self, note: String) {
        self.remarks.push(note);
    }

    /// Sentences on the cards that are left out, with the reasons, and the remarks.
    pub(super) fn notes(&self) -> Vec<String> {
        let left_out = |((card, reason), own): (&(String, String), &LeftOut)| {
            let place = match own.is_fault {
                true => format!("{}: ", self.deck.place(own.at)),
                false => String::new(),
            };
            let are = counted(own.n, "is", "are");
            format!("{place}{card}: {are} left out ({}): {reason}", first_names(&own.names))
        };
        self.left_out.iter().map(left_out).chain(self.remarks.iter().cloned()).collect()
    }
}

/// A table of keys and values.
pub(super) fn table<const N: usize>(rows: [(&str, Value); N]) -> Table {
    rows.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

pub(super) fn vector(x: [f64; 3]) -> Value {
    Value::Array(x.map(Value::Float).to_vec())
}

pub(super) fn matrix(rows: [[f64; 3]; 3]) -> Value {
    Value::Array(rows.map(vector).to_vec())
}

pub(super) fn numbers(numbers: impl IntoIterator<Item = f64>) -> Value {
    Value::Array(numbers.into_iter().map(Value::Float).collect())
}

pub(super) fn text(text: &str) -> Value {
    Value::String(text.to_string())
}

pub(super) fn texts(texts: [&str; 2]) -> Value {
    Value::Array(texts.map(text).to_vec())
}
