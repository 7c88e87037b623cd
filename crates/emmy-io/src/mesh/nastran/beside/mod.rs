//! Rigid elements, equations, masses, springs and dampers of a deck as tables of the input.

mod body;
mod equation;
mod fields;
mod grids;
mod line;
mod mass;
mod mean;
mod pair;
mod register;
mod rigid;
mod spring;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::super::DeckEntry;
use super::super::abaqus::Of;
use super::super::entry::first_names;
use super::Reader;
use super::card::Card;
use super::range::Range;
use body::Body;
use fields::{Reason, Stored};
use grids::Grids;
use line::Line;
use mass::Mass;
use pair::Pair;
use register::Register;

/// The cards that are kept until all grid points are placed.
const CARDS: [&str; 17] = [
    "RBE2", "RBE3", "RBAR", "RROD", "MPC", "MPCADD", "CONM2", "CMASS1", "CMASS2", "PMASS", "CELAS1",
    "CELAS2", "PELAS", "CDAMP1", "CDAMP2", "PDAMP", "CBUSH",
];

/// The property of `CBUSH`.
const PBUSH: &str = "PBUSH";

/// The cards of a file besides its mesh, and their entries.
#[derive(Debug, Default)]
pub(super) struct Beside {
    cards: Vec<Stored>,
    /// Sets of equations that the case control chooses.
    pub(super) sets: Vec<u64>,
    /// Elements that are links, such as `CBUSH` in a group of links.
    pub(super) links: HashSet<u64>,
    pub(super) entries: Vec<DeckEntry>,
    /// Number of grid points without cells that they use.
    pub(super) n_used: usize,
}

impl Beside {
    /// Keeps a card if it is of these kinds.
    pub(super) fn keep(&mut self, card: &Card<'_>) -> bool {
        let Some(name) = CARDS.into_iter().chain([PBUSH]).find(|name| *name == card.name) else {
            return false;
        };
        let fields = card.from(0).into_iter().map(str::to_string).collect();
        self.cards.push(Stored { name, fields, at: card.at });
        true
    }
}

/// The sets `MPC = n` of a case control section.
pub(super) fn chosen_sets<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<u64> {
    let mut sets = Vec::new();
    for line in lines {
        let line = line.split('$').next().unwrap_or_default().trim().to_ascii_uppercase();
        if line.starts_with("BEGIN") {
            return sets;
        }
        let set = line.strip_prefix("MPC").and_then(|rest| rest.trim_start().strip_prefix('='));
        sets.extend(set.and_then(|set| set.trim().parse::<u64>().ok()));
    }
    // Without bulk data there is no case control before them.
    Vec::new()
}

/// Everything that becomes entries.
struct Work<'a> {
    grids: Grids<'a>,
    register: Register<'a>,
    cards: &'a [Stored],
    sets: &'a [u64],
    links: &'a HashSet<u64>,
    masses: Vec<Mass>,
    pairs: Vec<Pair>,
    lines: Vec<Line>,
    bodies: Vec<Body>,
    /// Index of the rigid body that a grid point moves with.
    body_of: HashMap<u64, usize>,
    /// Grid points without cells at a node that they move with.
    alias: HashMap<u64, u64>,
    /// Names of couplings by their grid points.
    means: HashMap<u64, String>,
    /// Free masses by their grid points: name, centre, and whether they turn.
    free: BTreeMap<u64, (String, [f64; 3], bool)>,
    /// Those of them that a joint or a spring holds.
    held: HashSet<u64>,
    /// Grid points without cells whose rigid element is left out.
    lost: HashSet<u64>,
    /// Cards between grid points of one rigid body.
    idle: Vec<String>,
}

impl Work<'_> {
    fn run(&mut self) {
        self.collect_masses();
        let supports = self.scalars();
        let averages = self.equations();
        self.rigid();
        self.means();
        averages.into_iter().for_each(|average| self.average(average));
        self.place_masses();
        self.join_pairs();
        supports.into_iter().for_each(|support| self.support(support));
        self.lines();
        self.note_on_free_masses();
    }

    /// A note on masses that nothing holds, such as those of beams that are left out.
    fn note_on_free_masses(&mut self) {
        let is_free = |grid: &&u64| !self.held.contains(grid);
        let names = self.free.keys().filter(is_free).map(|grid| self.free[grid].0.clone());
        let names: Vec<String> = names.collect();
        if !names.is_empty() {
            let names = first_names(&names);
            self.register
                .remark(format!("joined to nothing, as masses at grid points without cells: {names}"));
        }
    }

    /// A note on constraints of points of couplings and masses, which are no nodes of cells.
    fn note_on_constraints(&mut self, constraints: &[(String, Range)]) {
        let mut points = BTreeMap::<u64, &str>::new();
        points.extend(self.body_of.iter().map(|(grid, body)| (*grid, self.bodies[*body].name.as_str())));
        points.extend(self.means.iter().map(|(grid, name)| (*grid, name.as_str())));
        points.extend(self.free.iter().map(|(grid, (name, ..))| (*grid, name.as_str())));
        points.retain(|grid, _| self.grids.is_unused(*grid));
        let mut found = BTreeSet::new();
        for (set, range) in constraints.iter().filter(|(_, range)| range.first <= range.last) {
            let own = points.range(range.first..=range.last).filter(|(grid, _)| range.contains(**grid));
            found.extend(own.map(|(_, name)| format!("{name} ({set})")));
        }
        if !found.is_empty() {
            let names = first_names(&found.into_iter().collect::<Vec<_>>());
            let note = "constraints of points without cells fix nothing without a `support` with their names";
            self.register.remark(format!("{note}: {names}"));
        }
    }

    /// The grid point that another one moves with, or itself.
    fn resolved(&self, grid: u64) -> u64 {
        let mut grid = grid;
        // A chain is never longer than the table.
        for _ in 0..=self.alias.len() {
            match self.alias.get(&grid) {
                Some(next) => grid = *next,
                None => break,
            }
        }
        grid
    }

    /// A name for an end of a joint: a rigid body, a coupling, a mass, or a new group of one node.
    fn end(&mut self, grid: u64, group: &str) -> Result<String, Reason> {
        let own = self.resolved(grid);
        let name = self.end_of(own, group)?;
        self.register.used.extend([grid, own]);
        Ok(name)
    }

    fn end_of(&mut self, own: u64, group: &str) -> Result<String, Reason> {
        if let Some(&body) = self.body_of.get(&own) {
            return Ok(self.bodies[body].name.clone());
        }
        if let Some(name) = self.means.get(&own) {
            return Ok(name.clone());
        }
        if self.grids.is_of_cell(own) {
            return Ok(self.register.group(group, [own]));
        }
        let place = self.grids.place(own);
        match self.free.get(&own) {
            Some((_, centre, turns)) if !turns && !self.grids.is_near(*centre, place) => {
                Err(Reason::new("a grid point lies beside its mass, which has no inertia"))
            }
            Some((name, ..)) => {
                self.held.insert(own);
                Ok(name.clone())
            }
            None => {
                Err(Reason::new("a grid point of it has no cell, no rigid element that acts, and no mass"))
            }
        }
    }
}

impl Reader {
    /// Makes entries, groups and notes of the cards that are kept.
    pub(super) fn add_entries(&mut self, is_plane: bool) {
        let cards = std::mem::take(&mut self.beside.cards);
        let is_element = |card: &&Stored| card.is_element();
        if self.deck.root.elements.is_empty() {
            // The error for a file without a body lists them.
            cards.iter().filter(is_element).for_each(|card| self.account.leave_out(card.name));
            return;
        }
        let body = &self.deck.root;
        let mut is_of_cell = vec![false; body.points.len()];
        for element in &body.elements {
            let nodes = &body.connectivity[element.nodes..][..element.n_nodes];
            for index in nodes.iter().filter_map(|node| body.nodes.get(node)) {
                is_of_cell[*index as usize] = true;
            }
        }
        let defaults = self.defaults.as_ref();
        let systems = [defaults.map_or(0, |own| own.system), defaults.map_or(0, |own| own.displacement)];
        let grids = Grids::new(&self.deck, &self.systems, &self.grids, systems, is_of_cell);
        let (links, sets) = (&self.beside.links, &self.beside.sets[..]);
        let mut work = Work {
            register: Register::new(&self.deck),
            grids,
            cards: &cards,
            sets,
            links,
            masses: Vec::new(),
            pairs: Vec::new(),
            lines: Vec::new(),
            bodies: Vec::new(),
            body_of: HashMap::new(),
            alias: HashMap::new(),
            means: HashMap::new(),
            free: BTreeMap::new(),
            held: HashSet::new(),
            lost: HashSet::new(),
            idle: Vec::new(),
        };
        if is_plane {
            let why = || Reason::new("the body is in plane strain");
            for card in cards.iter().filter(is_element) {
                work.register.leave_out(card, why());
            }
        } else {
            work.run();
            work.note_on_constraints(&self.ranges);
        }
        let Work { register, grids, .. } = work;
        let n_used = register.used.iter().filter(|&&grid| grids.is_unused(grid)).count();
        let notes = register.notes();
        let Register { entries, groups, .. } = register;
        self.beside.n_used = n_used;
        self.beside.entries = entries;
        self.deck.notes.extend(notes);
        for (name, nodes) in groups {
            let set = self.deck.root.set_mut(Of::Nodes, &name);
            nodes.into_iter().for_each(|node| set.push(None, node));
        }
    }
}
