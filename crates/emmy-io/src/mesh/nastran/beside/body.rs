//! Grid points that move as one rigid body.

use std::collections::{HashMap, HashSet};

use super::super::super::abaqus::At;
use super::super::super::entry::first_names;
use super::fields::Reason;
use super::pair::{How, Pair};
use super::register::{table, text, texts, vector};
use super::{Mass, Work};
use crate::vector::span_a_plane;
use toml::Value;

/// A rigid element of several grid points.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub(super) card: &'static str,
    pub(super) label: String,
    pub(super) name: String,
    pub(super) at: At,
    pub(super) hub: u64,
    pub(super) members: Vec<u64>,
    /// Whether the rotations of the members follow.
    pub(super) turns: bool,
}

impl Link {
    fn of_pair(pair: Pair) -> Self {
        let Pair { card, label, name, at, ends: [hub, member], .. } = pair;
        Link { card, label, name, at, hub, members: vec![member], turns: true }
    }

    pub(super) fn into_pair(self) -> Pair {
        let Link { card, label, name, at, hub, turns, .. } = self;
        let member = self.members[0];
        Pair { card, label, name, at, ends: [hub, member], how: How::Rigid { turns } }
    }
}

/// A rigid body of grid points.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) name: String,
    pub(super) card: &'static str,
    /// Numbers of its cards.
    pub(super) label: String,
    pub(super) place: [f64; 3],
    /// Its grid points of cells, in the order of the file.
    pub(super) nodes: Vec<u64>,
}

/// A point in common of two rigid bodies, at the second grid point.
#[derive(Debug)]
struct Hinge {
    card: &'static str,
    label: String,
    name: String,
    at: At,
    ends: [u64; 2],
    /// Whether it is all of its card.
    is_alone: bool,
}

/// Sets of grid points that are joined.
#[derive(Debug, Default)]
struct Joined(HashMap<u64, u64>);

impl Joined {
    fn has(&self, grid: u64) -> bool {
        self.0.contains_key(&grid)
    }

    /// The grid point that stands for a set.
    fn root(&mut self, grid: u64) -> u64 {
        let mut root = grid;
        while let Some(next) = self.0.get(&root).copied().filter(|next| *next != root) {
            root = next;
        }
        let mut own = grid;
        while own != root {
            own = self.0.insert(own, root).unwrap_or(root);
        }
        root
    }

    fn join(&mut self, a: u64, b: u64) {
        [a, b].into_iter().for_each(|grid| _ = self.0.entry(grid).or_insert(grid));
        let [a, b] = [a, b].map(|grid| self.root(grid));
        self.0.insert(b, a);
    }
}

impl Work<'_> {
    /// Makes rigid bodies of rigid elements and of pairs that are part of one.
    pub(super) fn join_links(&mut self, mut links: Vec<Link>) {
        let hubs: HashSet<u64> = links.iter().map(|link| link.hub).collect();
        let mut joined = Joined::default();
        let mut hinges = Vec::new();
        for link in &links {
            joined.join(link.hub, link.hub);
            for &member in &link.members {
                // Only its translations follow: a point in common with the body that turns there.
                if !link.turns && hubs.contains(&member) {
                    let Link { card, label, name, at, hub, .. } = link.clone();
                    hinges.push(Hinge { card, label, name, at, ends: [hub, member], is_alone: false });
                } else {
                    joined.join(link.hub, member);
                }
            }
        }
        let turning = self.turning();
        let turns = |joined: &Joined, grid: u64| joined.has(grid) || turning.contains(&grid);
        loop {
            let n_links = links.len();
            for pair in std::mem::take(&mut self.pairs) {
                let [a, b] = pair.ends;
                let turns = [a, b].map(|grid| turns(&joined, grid));
                let is_member = match pair.how {
                    How::Rigid { turns: true } => turns[0] || turns[1],
                    How::Rigid { turns: false } | How::Meet => turns == [true, false],
                    How::Rod => false,
                };
                if is_member && !(joined.has(a) && joined.has(b) && joined.root(a) == joined.root(b)) {
                    joined.join(a, b);
                    links.push(Link::of_pair(pair));
                } else if pair.how.is_point() && turns == [true, true] {
                    let Pair { card, label, name, at, ends, .. } = pair;
                    hinges.push(Hinge { card, label, name, at, ends, is_alone: true });
                } else {
                    self.pairs.push(pair);
                }
            }
            if links.len() == n_links {
                break;
            }
        }
        self.find_aliases(|grid| turns(&joined, grid));
        self.make_bodies(links, &mut joined);
        hinges.into_iter().for_each(|hinge| self.hinge(hinge));
    }

    /// Grid points that turn: several rigid bars meet there, or a mass at one without cells has an inertia or lies
    /// beside it.
    fn turning(&self) -> HashSet<u64> {
        let is_wide = |mass: &&Mass| {
            mass.inertia.is_some() || !self.grids.is_near(mass.centre, self.grids.place(mass.grid))
        };
        let mut n_bars = HashMap::<u64, usize>::new();
        for pair in &self.pairs {
            let n = match pair.how {
                How::Rigid { turns: true } => 2,
                How::Rigid { turns: false } => 1,
                How::Meet | How::Rod => 0,
            };
            pair.ends[..n].iter().for_each(|end| *n_bars.entry(*end).or_default() += 1);
        }
        let several = n_bars.into_iter().filter(|(_, n)| *n > 1).map(|(grid, _)| grid);
        let wide = self.masses.iter().filter(is_wide).map(|mass| mass.grid);
        several.chain(wide.filter(|&grid| self.grids.is_unused(grid))).collect()
    }

    /// Grid points without cells at a node that a pair joins them to.
    fn find_aliases(&mut self, turns: impl Fn(u64) -> bool) {
        for pair in self.pairs.iter().filter(|pair| pair.how != How::Rod) {
            let [a, b] = pair.ends.map(|end| self.resolved(end));
            let is_free = |grid: u64| self.grids.is_unused(grid) && !turns(grid);
            if a == b || !self.grids.is_near(self.grids.place(a), self.grids.place(b)) {
                continue;
            }
            if is_free(b) {
                self.alias.insert(b, a);
            } else if is_free(a) {
                self.alias.insert(a, b);
            }
        }
    }

    fn make_bodies(&mut self, links: Vec<Link>, joined: &mut Joined) {
        let mut order = Vec::new();
        let mut of_body = HashMap::<u64, Vec<Link>>::new();
        for link in links {
            let root = joined.root(link.hub);
            if !of_body.contains_key(&root) {
                order.push(root);
            }
            of_body.entry(root).or_default().push(link);
        }
        let mut members = HashMap::<u64, Vec<u64>>::new();
        let all: Vec<u64> = joined.0.keys().copied().collect();
        for grid in all {
            members.entry(joined.root(grid)).or_default().push(grid);
        }
        for root in order {
            let links = of_body.remove(&root).unwrap_or_default();
            self.make_body(links, members.remove(&root).unwrap_or_default());
        }
    }

    fn make_body(&mut self, links: Vec<Link>, mut grids: Vec<u64>) {
        let Some(first) = links.first() else { return };
        grids.sort_unstable_by_key(|&grid| self.grids.index(grid));
        let nodes: Vec<u64> = grids.iter().copied().filter(|&grid| self.grids.is_of_cell(grid)).collect();
        if let Err(reason) = self.check_body(&grids, &nodes) {
            self.lost.extend(grids.into_iter().filter(|&grid| self.grids.is_unused(grid)));
            for link in links {
                self.register.leave_out_named(link.card, link.label, link.at, reason.clone());
            }
            return;
        }
        let own = links.iter().filter(|link| link.card == first.card).map(|link| link.label.clone());
        let others = links.iter().filter(|link| link.card != first.card);
        let others = others.map(|link| format!("{} {}", link.card, link.label));
        let labels: Vec<String> = own.chain(others).collect();
        let label = labels.join(", ");
        let name = self.register.name(&first.name);
        if links.len() > 1 {
            let remark = format!(
                "{name} is one rigid body of {} {}: they share grid points",
                first.card,
                first_names(&labels)
            );
            self.register.remark(remark);
        }
        let place = self.grids.place(first.hub);
        if !nodes.is_empty() {
            let group = self.register.group(&format!("{name}-nodes"), nodes.iter().copied());
            let rows = [
                ("name", text(&name)),
                ("kind", text("rigid")),
                ("group", text(&group)),
                ("point", vector(place)),
            ];
            let what = ["rigid coupling acts", "rigid couplings act"];
            self.register.add("coupling", &name, (first.card, label.clone()), what, table(rows));
        }
        self.register.used.extend(&grids);
        self.body_of.extend(grids.iter().map(|&grid| (grid, self.bodies.len())));
        self.bodies.push(Body { name, card: first.card, label, place, nodes });
    }

    /// Whether grid points make a rigid body that has a mass and turns about no line without inertia.
    fn check_body(&self, grids: &[u64], nodes: &[u64]) -> Result<(), Reason> {
        let mut places: Vec<[f64; 3]> = nodes.iter().map(|&node| self.grids.place(node)).collect();
        let is_own = |mass: &&Mass| grids.contains(&self.resolved(mass.grid)) && mass.mass > 0.0;
        let masses: Vec<&Mass> = match nodes.len() {
            // A search among many grid points has no effect on a body of many nodes.
            n if n > 2 && span_a_plane(&places) => return Ok(()),
            _ => self.masses.iter().filter(is_own).collect(),
        };
        if nodes.is_empty() {
            return match masses.is_empty() {
                true => Err(Reason::new("no grid point of it belongs to a cell or has a mass")),
                false => Ok(()),
            };
        }
        let has_inertia = masses.iter().any(|mass| mass.inertia.is_some());
        places.extend(masses.iter().map(|mass| mass.centre));
        match has_inertia || span_a_plane(&places) {
            true => Ok(()),
            false => Err(Reason::new("its nodes lie on a line, about which nothing holds it")),
        }
    }

    /// Joins two rigid bodies at a point.
    fn hinge(&mut self, hinge: Hinge) {
        let Hinge { card, label, name, at, ends, is_alone } = hinge;
        let bodies = ends.map(|end| self.body_of.get(&end).copied());
        let [Some(a), Some(b)] = bodies else {
            // The reason of the body stands in its own note.
            let reason = Reason::new("a rigid body of it is left out");
            return self.register.leave_out_named(&format!("the joint of {card}"), label, at, reason);
        };
        if a == b {
            return self.idle.extend(is_alone.then(|| format!("{card} {label}")));
        }
        let between = texts([&self.bodies[a].name, &self.bodies[b].name]);
        let place = vector(self.grids.place(ends[1]));
        let name = self.register.name(&format!("{name}-joint"));
        let joint = Value::Table(table([("between", between), ("at", place)]));
        let rows = table([("name", text(&name)), ("spherical", joint)]);
        self.register.add("joint", &name, (card, label), ["joint acts", "joints act"], rows);
    }

    /// Masses by the rigid body or the grid point that has them, in the order of the file.
    pub(super) fn masses_of(&self, masses: Vec<Mass>) -> Vec<(Of, Vec<Mass>)> {
        let mut all: Vec<(Of, Vec<Mass>)> = Vec::new();
        let mut index = HashMap::new();
        for mass in masses {
            let grid = self.resolved(mass.grid);
            let of = self.body_of.get(&grid).map_or(Of::Grid(grid), |&body| Of::Body(body));
            let own = *index.entry(of).or_insert_with(|| {
                all.push((of, Vec::new()));
                all.len() - 1
            });
            all[own].1.push(mass);
        }
        all
    }
}

/// The owner of a mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Of {
    Body(usize),
    Grid(u64),
}
