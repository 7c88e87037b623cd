//! Points that move as the mean of nodes: `RBE3`, and equations of several grid points.

use emmy::internals::body::affine_weights;

use super::super::super::abaqus::At;
use super::super::card::real;
use super::Work;
use super::fields::{Components, Outcome, Reason, Stored, components, grid_points, number};
use super::grids::Grids;
use super::pair::TIES;
use super::register::{numbers, table, text, texts, vector};
use toml::Value;

/// A grid point that moves as a weighted sum of others.
#[derive(Debug, Clone)]
pub(super) struct Average {
    pub(super) card: &'static str,
    pub(super) label: String,
    /// The name of its entry.
    pub(super) name: String,
    pub(super) at: At,
    pub(super) grid: u64,
    pub(super) weights: Vec<(u64, f64)>,
}

/// Grid points of `RBE3` and its components at the point.
fn parsed(card: &Stored, grids: &Grids<'_>) -> Outcome<(Average, Components)> {
    let label = card.number(0)?.to_string();
    let grid = card.number(2)?;
    grids.known(grid)?;
    let follows = card.components(3)?;
    if !follows.has_translations() {
        return Err(Reason::new("not all of 1, 2 and 3 are in REFC"));
    }
    let fields: Vec<&str> =
        card.fields.iter().skip(4).map(String::as_str).filter(|f| !f.is_empty()).collect();
    let is_word = |field: &&str, word: &str| field.eq_ignore_ascii_case(word);
    if fields.iter().any(|field| is_word(field, "UM")) {
        return Err(Reason::new("it chooses its dependent components (UM)"));
    }
    // ALPHA and TREF end the list.
    let end = fields.iter().position(|field| is_word(field, "ALPHA")).unwrap_or(fields.len());
    let mut rest = &fields[..end];
    let mut weights = Vec::new();
    while let [weight, of, more @ ..] = rest {
        let bad = || Reason::fault(format!("\"{}\" is not a weight", super::super::shown(weight)));
        let weight = real(weight).filter(|weight| weight.is_finite()).ok_or_else(bad)?;
        if weight <= 0.0 {
            return Err(Reason::new("a weight is not above 0"));
        }
        if !components(of)?.has_translations() {
            return Err(Reason::new("not all of 1, 2 and 3 are in its components Ci"));
        }
        // The next weight has a point.
        let is_next = |field: &&str| number(field).is_err() && real(field).is_some();
        let n = more.iter().position(is_next).unwrap_or(more.len());
        let (points, others) = grid_points(&more[..n], grids)?;
        if let Some(word) = others.first() {
            return Err(Reason::fault(format!("\"{}\" is not a grid point", super::super::shown(word))));
        }
        weights.extend(points.into_iter().map(|point| (point, weight)));
        rest = &more[n..];
    }
    if weights.is_empty() || !rest.is_empty() {
        return Err(Reason::fault("its weights and grid points are not complete"));
    }
    let name = format!("rbe3_{label}");
    Ok((Average { card: card.name, label, name, at: card.at, grid, weights }, follows))
}

impl Work<'_> {
    /// Reads all `RBE3`.
    pub(super) fn means(&mut self) {
        for card in self.cards.iter().filter(|card| card.name == "RBE3") {
            let own = parsed(card, &self.grids).and_then(|(own, follows)| self.mean(own, follows));
            if let Err(reason) = own {
                self.register.leave_out(card, reason);
            }
        }
    }

    fn mean(&mut self, own: Average, follows: Components) -> Outcome<()> {
        let weights = self.nodes(&own.weights)?;
        let grid = self.resolved(own.grid);
        if let Some(&body) = self.body_of.get(&grid) {
            if follows.has_some_rotation() {
                return Err(Reason::new("its point turns with a rigid coupling"));
            }
            let name = self.coupling(&own, &weights)?;
            let joint = self.register.name(&format!("{name}-joint"));
            let between = texts([&name, &self.bodies[body].name]);
            let at = vector(self.grids.place(own.grid));
            let row = Value::Table(table([("between", between), ("at", at)]));
            let rows = table([("name", text(&joint)), ("spherical", row)]);
            self.register.add("joint", &joint, (own.card, own.label), ["joint acts", "joints act"], rows);
            return Ok(());
        }
        if self.grids.is_of_cell(grid) {
            let places: Vec<[f64; 3]> = weights.iter().map(|(node, _)| self.grids.place(*node)).collect();
            let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
            let parts: Vec<f64> = weights.iter().map(|(_, weight)| weight / total).collect();
            let Ok(affine) = affine_weights(self.grids.place(grid), &places, &parts, 0.0) else {
                let why = "its point is a node, and lies off the plane or line of the others";
                return Err(Reason::new(why));
            };
            let weights: Vec<(u64, f64)> = weights.iter().map(|(node, _)| *node).zip(affine).collect();
            return self.tie(&own, grid, &weights);
        }
        let name = self.coupling(&own, &weights)?;
        self.means.insert(grid, name);
        Ok(())
    }

    /// A grid point that follows an equation of several others.
    pub(super) fn average(&mut self, own: Average) {
        let Average { card, label, at, .. } = own.clone();
        let made = self.nodes(&own.weights).and_then(|weights| {
            let grid = self.resolved(own.grid);
            if self.grids.is_of_cell(grid) {
                return self.tie(&own, grid, &weights);
            }
            if self.body_of.contains_key(&grid) {
                return Err(Reason::new("its grid point moves with a rigid coupling"));
            }
            if weights.iter().any(|(_, weight)| *weight <= 0.0) {
                return Err(Reason::new("its grid point has no cell, and not all weights are above 0"));
            }
            let name = self.coupling(&own, &weights)?;
            self.means.insert(grid, name);
            Ok(())
        });
        if let Err(reason) = made {
            self.register.leave_out_named(card, label, at, reason);
        }
    }

    /// Nodes with their weights, each once, in the order of the file.
    fn nodes(&self, weights: &[(u64, f64)]) -> Outcome<Vec<(u64, f64)>> {
        let mut all: Vec<(u64, f64)> =
            weights.iter().map(|&(grid, weight)| (self.resolved(grid), weight)).collect();
        all.sort_by_key(|(grid, _)| self.grids.index(*grid));
        all.dedup_by(|next, own| {
            let is_same = next.0 == own.0;
            own.1 += if is_same { next.1 } else { 0.0 };
            is_same
        });
        match all.iter().all(|(grid, _)| self.grids.is_of_cell(*grid)) {
            true => Ok(all),
            false => Err(Reason::new("an independent grid point belongs to no cell")),
        }
    }

    fn coupling(&mut self, own: &Average, weights: &[(u64, f64)]) -> Outcome<String> {
        if self.means.contains_key(&self.resolved(own.grid)) {
            return Err(Reason::new("another one moves its point"));
        }
        let name = self.register.name(&own.name);
        let group = self.register.group(&format!("{name}-nodes"), weights.iter().map(|(node, _)| *node));
        let mut rows = table([
            ("name", text(&name)),
            ("kind", text("distributing")),
            ("group", text(&group)),
            ("point", vector(self.grids.place(own.grid))),
        ]);
        if weights.iter().any(|(_, weight)| *weight != weights[0].1) {
            rows.insert("weights".to_string(), numbers(weights.iter().map(|(_, weight)| *weight)));
        }
        let what = ["distributing coupling acts", "distributing couplings act"];
        self.register.used.extend([own.grid].into_iter().chain(own.weights.iter().map(|(node, _)| *node)));
        self.register.add("coupling", &name, (own.card, own.label.clone()), what, rows);
        Ok(name)
    }

    /// A node that moves with a weighted sum of others.
    fn tie(&mut self, own: &Average, node: u64, weights: &[(u64, f64)]) -> Outcome<()> {
        if self.body_of.contains_key(&node) {
            return Err(Reason::new("its grid point moves with a rigid coupling"));
        }
        if weights.iter().any(|(leader, _)| *leader == node) {
            return Err(Reason::new("its grid point is among the others"));
        }
        let name = self.register.name(&own.name);
        let leader = self.register.group(&format!("{name}-leaders"), weights.iter().map(|(node, _)| *node));
        let follower = self.register.group(&format!("{name}-node"), [node]);
        let rows = [
            ("follower", text(&follower)),
            ("leader", text(&leader)),
            ("kind", text("nodes")),
            ("weights", numbers(weights.iter().map(|(_, weight)| *weight))),
        ];
        self.register.used.extend([own.grid].into_iter().chain(own.weights.iter().map(|(node, _)| *node)));
        self.register.add("tie", &name, (own.card, own.label.clone()), TIES, table(rows));
        Ok(())
    }
}
