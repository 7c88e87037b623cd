//! Two grid points that a rigid bar, a rod or equations join.

use super::super::super::abaqus::At;
use super::super::super::entry::first_names;
use super::Work;
use super::fields::{Outcome, Reason, Stored};
use super::grids::Grids;
use super::register::{numbers, table, text, texts, vector};
use crate::vector::distance;
use toml::Value;

/// How two grid points move together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum How {
    /// The second one moves as the rigid body of the first one does; `turns`: its rotations, too.
    Rigid { turns: bool },
    /// They are at one place, and have the same translations.
    Meet,
    /// Their distance stays.
    Rod,
}

impl How {
    /// Whether the translations of the second one follow, and no rotation.
    pub(super) fn is_point(self) -> bool {
        matches!(self, How::Rigid { turns: false } | How::Meet)
    }
}

#[derive(Debug, Clone)]
pub(super) struct Pair {
    pub(super) card: &'static str,
    /// Its number.
    pub(super) label: String,
    /// The name of its entry.
    pub(super) name: String,
    pub(super) at: At,
    /// The independent one comes first.
    pub(super) ends: [u64; 2],
    pub(super) how: How,
}

impl Pair {
    /// The two grid points of `RBAR`, one of which has all independent components.
    pub(super) fn of_bar(card: &Stored, grids: &Grids<'_>) -> Outcome<Self> {
        let [a, b] = ends(card, grids)?;
        let independent = [card.components(3)?, card.components(4)?];
        let dependent = [card.components(5)?, card.components(6)?];
        let is_whole = [0, 1].map(|i| {
            let is_blank = card.field(4 - i).trim_start_matches('0').is_empty();
            independent[i].has_translations() && independent[i].has_rotations() && is_blank
        });
        let own = match is_whole {
            [true, false] => 0,
            [false, true] => 1,
            _ => return Err(Reason::new("neither CNA nor CNB alone is 123456")),
        };
        let follows = dependent[1 - own];
        let is_blank = card.field(6 - own).is_empty();
        if !is_blank && !follows.has_translations() {
            return Err(Reason::new("not all of 1, 2 and 3 are dependent (CMA, CMB)"));
        }
        let ends = if own == 0 { [a, b] } else { [b, a] };
        Ok(Pair::new(card, "rbar", ends, How::Rigid { turns: is_blank || follows.has_some_rotation() }))
    }

    /// The two grid points of `RROD`.
    pub(super) fn of_rod(card: &Stored, grids: &Grids<'_>) -> Outcome<Self> {
        Ok(Pair::new(card, "rrod", ends(card, grids)?, How::Rod))
    }

    fn new(card: &Stored, kind: &str, ends: [u64; 2], how: How) -> Self {
        let label = card.label();
        let name = format!("{kind}_{label}");
        Pair { card: card.name, label, name, at: card.at, ends, how }
    }
}

fn ends(card: &Stored, grids: &Grids<'_>) -> Outcome<[u64; 2]> {
    card.number(0)?;
    let ends = [card.number(1)?, card.number(2)?];
    ends.into_iter().try_for_each(|end| grids.known(end))?;
    match ends {
        [a, b] if a == b => Err(Reason::fault("its two grid points are one")),
        ends => Ok(ends),
    }
}

/// Words of the note on distances.
const DISTANCES: [&str; 2] = ["rigid link acts", "rigid links act"];

impl Work<'_> {
    /// Joins the pairs that are part of no rigid body.
    pub(super) fn join_pairs(&mut self) {
        let mut moved = Vec::new();
        let mut links = Vec::new();
        for pair in std::mem::take(&mut self.pairs) {
            let ends = pair.ends.map(|end| self.resolved(end));
            let body = ends.map(|end| self.body_of.get(&end));
            if ends[0] == ends[1] {
                moved.push(format!("{} {}", pair.card, pair.label));
            } else if body[0].is_some() && body[0] == body[1] {
                self.idle.push(format!("{} {}", pair.card, pair.label));
            } else {
                match self.join(&pair, ends) {
                    Ok(is_link) => links.extend(is_link.then(|| pair.name.clone())),
                    Err(reason) => self.register.leave_out_named(pair.card, pair.label, pair.at, reason),
                }
            }
        }
        if !links.is_empty() {
            let names = first_names(&links);
            self.register.remark(format!("rigid links keep a distance and carry no moments: {names}"));
        }
        if !moved.is_empty() {
            let names = first_names(&moved);
            self.register
                .remark(format!("grid points without cells move with the node at their place: {names}"));
        }
        if !self.idle.is_empty() {
            let names = first_names(&self.idle);
            self.register.remark(format!("within one rigid coupling, and without effect: {names}"));
        }
    }

    /// Joins two grid points, and returns whether by their distance.
    fn join(&mut self, pair: &Pair, ends: [u64; 2]) -> Outcome<bool> {
        let places = ends.map(|end| self.grids.place(end));
        let is_one = self.grids.is_near(places[0], places[1]);
        let own = (pair.card, pair.label.clone());
        if is_one && pair.how == How::Rod {
            return Err(Reason::new("its two grid points lie at one place"));
        }
        let is_node = ends.map(|end| self.grids.is_of_cell(end) && !self.body_of.contains_key(&end));
        let wanted = &pair.name;
        if is_one && is_node == [true, true] {
            let name = self.register.name(wanted);
            let leader = self.register.group(&format!("{name}-leaders"), [ends[0]]);
            let follower = self.register.group(&format!("{name}-node"), [ends[1]]);
            let rows = [
                ("follower", text(&follower)),
                ("leader", text(&leader)),
                ("kind", text("nodes")),
                ("weights", numbers([1.0])),
            ];
            self.register.add("tie", &name, own, TIES, table(rows));
            return Ok(false);
        }
        let n_groups = self.register.groups.len();
        let between = self.ends_of(ends, wanted).inspect_err(|_| self.register.groups.truncate(n_groups))?;
        let name = self.register.name(wanted);
        let joint = match is_one {
            true => {
                let rows = [("between", between), ("at", vector(self.joint_place(ends, places)))];
                ("spherical", Value::Table(table(rows)))
            }
            false => {
                let points = Value::Array(places.map(vector).to_vec());
                ("distance", Value::Table(table([("between", between), ("points", points)])))
            }
        };
        let rows = [("name", text(&name)), joint];
        let what = if is_one { ["joint acts", "joints act"] } else { DISTANCES };
        self.register.add("joint", &name, own, what, table(rows));
        Ok(!is_one && distance(places[0], places[1]) > 0.0)
    }

    /// The names `between` of a joint.
    pub(super) fn ends_of(&mut self, ends: [u64; 2], name: &str) -> Outcome<Value> {
        let first = self.end(ends[0], &format!("{name}-end-1"))?;
        let second = self.end(ends[1], &format!("{name}-end-2"))?;
        Ok(texts([&first, &second]))
    }

    /// The place of a joint of two grid points: that of a node, or else of a mass.
    fn joint_place(&self, ends: [u64; 2], places: [[f64; 3]; 2]) -> [f64; 3] {
        places[usize::from(!self.grids.is_of_cell(ends[0]))]
    }
}

/// Words of the note on ties.
pub(super) const TIES: [&str; 2] = ["tie acts", "ties act"];
