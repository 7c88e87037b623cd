//! Rigid bodies, couplings, ties, masses, springs and joints of a deck as tables of the input.

mod connector;
mod equation;
mod find;
mod ground;
mod line;
mod mass;
mod mpc;
mod names;
mod orientation;
mod report;
mod rigid;
mod spring;
mod tie;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use toml::Value;

use super::super::super::DeckEntry;
use super::super::super::account::Account;
use super::super::body::{At, Card};
use super::super::table::spelled;
use super::{Assembly, Key, Told};
use line::{Line, Rod};
use mass::PointMass;
use names::Names;
use report::Report;
use rigid::Frame;

/// The entries of a deck, with notes on the cards that are left out.
#[derive(Debug, Default)]
pub(super) struct Made {
    pub(super) entries: Vec<DeckEntry>,
    pub(super) notes: Vec<String>,
    pub(super) told: Told,
    /// Number of the nodes without cells that entries use.
    pub(super) n_points: usize,
    /// Groups that have such nodes alone, each with the entry whose point its only node is.
    pub(super) points_of: HashMap<String, Option<String>>,
}

impl Made {
    /// The note on a group without nodes of cells, which may have a point of an entry.
    pub(super) fn on_group(&self, note: String) -> Option<String> {
        let name =
            note.strip_prefix("node group \"").and_then(|rest| rest.strip_suffix(super::super::super::EMPTY));
        match name.and_then(|name| self.points_of.get(name)) {
            None => Some(note),
            Some(entry) => entry.as_ref().map(|entry| format!("{note}: it is the point of {entry}")),
        }
    }
}

/// A card and the instance that has it.
#[derive(Debug, Clone, Copy)]
struct Owned<'a> {
    instance: Option<u32>,
    card: &'a Card,
}

impl<'a> Owned<'a> {
    /// Its name in notes, as the table spells it: `*RIGID BODY`.
    fn title(&self) -> &'a str {
        spelled(&self.card.keyword.title)
    }

    /// Its name without spaces, in upper case and without the star.
    fn keyword(&self) -> &'a str {
        &self.card.keyword.name
    }

    fn value(&self, key: &str) -> Option<&'a str> {
        self.card.keyword.value(key)
    }

    fn has(&self, key: &str) -> bool {
        self.card.keyword.has(key)
    }

    /// The first field of the first line.
    fn first(&self) -> Option<&'a str> {
        Some(self.card.lines.first()?.1.first()?.as_str())
    }
}

/// Makes the entries of an assembly whose groups are complete.
struct Maker<'a, 'b> {
    assembly: &'b mut Assembly<'a>,
    account: &'b mut Account,
    cards: Vec<Owned<'a>>,
    /// Whether each node belongs to a cell.
    has_cell: Vec<bool>,
    /// First cell and instance of each body with cells.
    cell_starts: Vec<(u32, Option<u32>)>,
    /// Places of the surfaces of a name in their body.
    surfaces_of: HashMap<Key, Vec<usize>>,
    /// The number of each node in the file.
    numbers: Vec<u64>,
    /// Largest distance between nodes that rounding of the file explains.
    rounding: f64,
    names: Names,
    report: Report,
    entries: Vec<DeckEntry>,
    told: Told,
    /// Nodes that entries use.
    used: BTreeSet<u32>,
    /// Nodes without cells that are fixed.
    fixed: BTreeSet<u32>,
    frames: Vec<Frame>,
    /// The frame to which a node belongs.
    frame_of: HashMap<u32, usize>,
    /// Masses at nodes without cells.
    masses: BTreeMap<u32, PointMass>,
    /// Groups of one node that joints name.
    ends: HashMap<u32, String>,
    rods: Vec<Rod>,
    lines: Vec<Line>,
    /// Place in `lines` by the smaller and the larger end.
    line_of: HashMap<[u32; 2], usize>,
}

impl<'a> Assembly<'a> {
    /// Makes the entries of the cards of this deck, with groups of nodes for them.
    pub(super) fn entries(&mut self, account: &mut Account) -> Made {
        let deck = self.deck;
        let of_body = |(body, instance): (&'a super::Body, Option<u32>)| {
            body.cards.iter().map(move |card| Owned { instance, card })
        };
        let cards: Vec<Owned<'a>> = deck.bodies().zip(deck.numbers()).flat_map(of_body).collect();
        if cards.iter().all(|owned| owned.keyword() == "BOUNDARY") {
            return Made::default();
        }
        let mut maker = Maker::new(self, account, cards);
        maker.find_ground();
        maker.bodies();
        maker.masses();
        maker.ties();
        maker.constraints();
        maker.equations();
        maker.springs();
        maker.connectors();
        maker.rods();
        maker.line_joints();
        maker.remark_on_ground();
        let points_of = maker.groups_of_points();
        let Maker { entries, report, told, used, has_cell, .. } = maker;
        let n_points = used.iter().filter(|&&node| !has_cell[node as usize]).count();
        Made { entries, notes: report.notes(), told, n_points, points_of }
    }

    /// Names of surfaces that cards may name, in lower case.
    pub(super) fn named_by_cards(&self) -> impl Iterator<Item = String> + use<'_> {
        let cards = self.deck.bodies().flat_map(|body| &body.cards);
        cards.flat_map(|card| {
            let of_ties =
                card.lines.iter().filter(|_| card.keyword.name == "TIE").flat_map(|(_, fields)| fields);
            let names = card.keyword.value("SURFACE").into_iter().chain(of_ties.map(String::as_str));
            let both = |name: &str| {
                let of_instance = name.split_once('.').map(|(_, name)| name.to_lowercase());
                std::iter::once(name.to_lowercase()).chain(of_instance).collect::<Vec<_>>()
            };
            names.flat_map(both).collect::<Vec<_>>()
        })
    }
}

impl<'a, 'b> Maker<'a, 'b> {
    fn new(assembly: &'b mut Assembly<'a>, account: &'b mut Account, cards: Vec<Owned<'a>>) -> Self {
        let has_cell = assembly.builder.used_points();
        let starts = assembly.deck.bodies().zip(assembly.deck.numbers()).zip(&assembly.starts);
        let with_cells = starts.filter(|((body, _), _)| !body.elements.is_empty());
        let cell_starts = with_cells.map(|((_, instance), [_, first])| (*first, instance)).collect();
        let mut surfaces_of = HashMap::<Key, Vec<usize>>::new();
        for (body, instance) in assembly.deck.bodies().zip(assembly.deck.numbers()) {
            for (index, surface) in body.surfaces.iter().enumerate() {
                surfaces_of.entry((instance, surface.name.to_lowercase())).or_default().push(index);
            }
        }
        let mut numbers = vec![0; assembly.n_nodes];
        for (body, [first, _]) in assembly.deck.bodies().zip(&assembly.starts) {
            body.nodes.iter().for_each(|(number, index)| numbers[(first + index) as usize] = *number);
        }
        let mut maker = Maker {
            assembly,
            account,
            cards,
            has_cell,
            cell_starts,
            surfaces_of,
            numbers,
            rounding: 0.0,
            names: Names::default(),
            report: Report::default(),
            entries: Vec::new(),
            told: Told::default(),
            used: BTreeSet::new(),
            fixed: BTreeSet::new(),
            frames: Vec::new(),
            frame_of: HashMap::new(),
            masses: BTreeMap::new(),
            ends: HashMap::new(),
            rods: Vec::new(),
            lines: Vec::new(),
            line_of: HashMap::new(),
        };
        maker.rounding = 1e-6 * maker.diagonal();
        maker
    }

    /// Cards of some keywords, written without spaces.
    fn cards_of(&self, keywords: &[&str]) -> Vec<Owned<'a>> {
        self.cards.iter().copied().filter(|owned| keywords.contains(&owned.keyword())).collect()
    }

    /// `line 12`, with the file if it is an include.
    fn line(&self, at: At) -> String {
        let file = self.assembly.deck.files.get(at.file as usize).filter(|_| at.file > 0);
        let file = file.and_then(|file| file.file_name());
        let file = file.map(|file| format!("{}, ", file.to_string_lossy())).unwrap_or_default();
        format!("{file}line {}", at.line)
    }

    /// The name of a card in notes, else its line.
    fn called(&self, owned: Owned<'_>, keys: &[&str]) -> String {
        let name = keys.iter().find_map(|key| owned.value(key)).filter(|name| !name.trim().is_empty());
        name.map_or_else(|| self.line(owned.card.at), str::to_string)
    }

    fn leave_out(&mut self, owned: Owned<'_>, keys: &[&str], reason: &str) {
        let which = self.called(owned, keys);
        self.report.leave_out(owned.title(), reason, which);
    }

    /// A new name for an entry.
    fn name(&mut self, name: Option<&str>, word: &str) -> String {
        self.names.entry(name, word, &self.assembly.group_names)
    }

    /// A new group of nodes, of some name if it is free.
    fn group(&mut self, name: &str, nodes: impl IntoIterator<Item = u32>) -> String {
        let name = self.names.free(name, &self.assembly.group_names);
        self.assembly.node_group(&name, nodes);
        name
    }

    /// See [`Made::points_of`].
    fn groups_of_points(&self) -> HashMap<String, Option<String>> {
        let is_point = |node: &u32| self.used.contains(node) && !self.is_of_cells(*node);
        let groups = self.assembly.group_names.small().filter(|(_, nodes)| nodes.iter().all(is_point));
        let entry_at = |node: u32| {
            let frame = self.frame_of.get(&node).map(|&frame| &self.frames[frame]);
            frame.filter(|frame| frame.reference == Some(node)).map(|frame| frame.name.clone())
        };
        let entry = |nodes: &[u32]| match nodes {
            &[node] => entry_at(node),
            _ => None,
        };
        groups.map(|(name, nodes)| (name.to_string(), entry(nodes))).collect()
    }

    /// Adds an entry.
    fn push(&mut self, entry: Entry<'_>) {
        let Entry { name, section, card, of, words, table } = entry;
        let [section, kind, label] = [section, card, of].map(str::to_string);
        let table = table.into_iter().map(|(key, value)| (key.to_string(), value)).collect();
        self.entries.push(DeckEntry { name, section, kind, label, words: words.map(str::to_string), table });
    }
}

/// Keys and values of a table.
type Rows = Vec<(&'static str, Value)>;

/// An entry before it is recorded.
struct Entry<'e> {
    name: String,
    section: &'static str,
    /// The keyword, as in `*TIE`.
    card: &'e str,
    /// Its name or place in the file.
    of: &'e str,
    words: [&'static str; 2],
    table: Rows,
}

fn text(text: &str) -> Value {
    Value::String(text.to_string())
}

fn vector(vector: [f64; 3]) -> Value {
    Value::Array(vector.map(Value::Float).to_vec())
}

fn list(values: Vec<Value>) -> Value {
    Value::Array(values)
}

fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().copied().map(Value::Float).collect())
}

/// A table inside of the table of an entry.
fn inner(table: Rows) -> Value {
    Value::Table(table.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
}
