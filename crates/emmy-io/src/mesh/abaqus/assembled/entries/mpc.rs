//! `*MPC`: pins, ties, rigid links and rigid beams between nodes.

use super::line::Rod;
use super::rigid::Rigid;
use super::{Entry, Maker, Owned, inner, list, text, vector};
use crate::vector::distance;

/// A constraint of a card: its type in upper case, and the nodes of its fields.
struct Constraint {
    kind: String,
    fields: Vec<String>,
    called: String,
}

impl<'a> Maker<'a, '_> {
    fn of_card(&self, owned: Owned<'a>) -> Vec<Constraint> {
        let mut all: Vec<Constraint> = Vec::new();
        for (at, fields) in
            owned.card.lines.iter().filter(|(_, fields)| fields.iter().any(|own| !own.is_empty()))
        {
            let fields = || fields.iter().map(String::as_str);
            let nodes = fields().skip(1).filter(|field| !field.is_empty()).map(str::to_string);
            match (fields().next().unwrap_or_default(), all.last_mut()) {
                // Nodes of the constraint in the line before.
                ("0" | "", Some(last)) => last.fields.extend(nodes),
                (kind, _) => all.push(Constraint {
                    kind: kind.to_ascii_uppercase(),
                    fields: nodes.collect(),
                    called: self.line(*at),
                }),
            }
        }
        all
    }

    /// The nodes on the two sides of a constraint, or the reason why it is left out.
    fn sides(&self, owned: Owned<'a>, constraint: &Constraint) -> Result<[Vec<u32>; 2], &'static str> {
        let [a, b] = &constraint.fields[..] else { return Err("it has not two nodes or sets") };
        let sides = [a, b].map(|field| self.nodes(owned.instance, field));
        match sides.iter().any(Vec::is_empty) {
            true => Err("a node or node set is not in the file"),
            false => Ok(sides),
        }
    }

    /// The rigid beams of a card.
    pub(super) fn beams(&mut self, owned: Owned<'a>) -> Vec<Rigid> {
        let mut rigid = Vec::new();
        for constraint in
            self.of_card(owned).into_iter().filter(|own| own.kind == "BEAM" && !owned.has("USER"))
        {
            let card = "*MPC BEAM".to_string();
            let called = constraint.called.clone();
            let (nodes, reference) = match self.sides(owned, &constraint) {
                Ok([nodes, others]) if others.len() == 1 => (nodes, others[0]),
                Ok(_) => {
                    self.report.leave_out(&card, "several nodes on both sides", called);
                    continue;
                }
                Err(reason) => {
                    self.report.leave_out(&card, reason, called);
                    continue;
                }
            };
            rigid.push(Rigid {
                name: None,
                card,
                called,
                nodes,
                reference: Some(reference),
                group: None,
                is_centred: false,
                is_beam: true,
            });
        }
        rigid
    }

    /// Takes the beams of a body that is too slender to turn as rigid links.
    pub(super) fn rods_of(&mut self, beam: &Rigid) {
        const WORDS: [&str; 2] =
            ["rigid link in the place of a beam acts", "rigid links in the place of beams act"];
        let Some(reference) = beam.reference else { return };
        for &node in beam.nodes.iter().filter(|&&node| node != reference) {
            let (card, called) = (beam.card.clone(), beam.called.clone());
            self.rods.push(Rod { nodes: [node, reference], card, called, words: WORDS });
        }
    }

    /// Reads the constraints other than beams.
    pub(super) fn constraints(&mut self) {
        for owned in self.cards_of(&["MPC"]) {
            let all = self.of_card(owned);
            if all.is_empty() {
                self.leave_out(owned, &[], "it has no data");
            }
            for constraint in all {
                let kind = constraint.kind.as_str();
                let is_known = ["LINK", "PIN", "TIE"].contains(&kind) && !owned.has("USER");
                if kind == "BEAM" && !owned.has("USER") {
                    continue;
                }
                let card = format!("*MPC {kind}");
                let sides = match is_known {
                    true => self.sides(owned, &constraint),
                    false => Err("it is not PIN, TIE, LINK or BEAM"),
                };
                match sides {
                    Ok([nodes, others]) if kind == "LINK" => self.links(&constraint, &nodes, &others),
                    Ok([nodes, others]) => self.pins(&constraint, &nodes, &others),
                    Err(reason) => self.report.leave_out(&card, reason, constraint.called),
                }
            }
        }
    }

    fn links(&mut self, constraint: &Constraint, nodes: &[u32], others: &[u32]) {
        let (card, called) = ("*MPC LINK".to_string(), constraint.called.clone());
        let &[other] = others else {
            return self.report.leave_out(&card, "several nodes on both sides", called);
        };
        for &node in nodes {
            let words = ["rigid link acts", "rigid links act"];
            self.rods.push(Rod { nodes: [node, other], card: card.clone(), called: called.clone(), words });
        }
    }

    /// Joins each node to the one of the others that lies at its place. At another place it would have its translation
    /// in every rotation of the body, which the energy of a body that turns does not allow.
    fn pins(&mut self, constraint: &Constraint, nodes: &[u32], others: &[u32]) {
        let card = format!("*MPC {}", constraint.kind);
        let mut pairs = Vec::new();
        for &node in nodes {
            let point = self.point(node);
            let near = others.iter().map(|&other| (distance(self.point(other), point), other));
            match near.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((length, other)) if length <= self.rounding => pairs.push([node, other]),
                _ => {
                    let reason = "its nodes do not lie at one place";
                    return self.report.leave_out(&card, reason, constraint.called.clone());
                }
            }
        }
        pairs.retain(|[a, b]| a != b);
        let is_tie = |&[a, b]: &[u32; 2]| {
            let has_cells = self.is_of_cells(a) && self.is_of_cells(b);
            has_cells && !(self.frame_of.contains_key(&a) || self.frame_of.contains_key(&b))
        };
        let (ties, joints): (Vec<[u32; 2]>, Vec<[u32; 2]>) = pairs.into_iter().partition(is_tie);
        if !ties.is_empty() {
            let name = self.name(None, "mpc");
            self.tie_nodes(name, &card, &constraint.called, ties);
        }
        for nodes in joints {
            self.join(&card, &constraint.called, nodes, constraint.kind == "TIE");
        }
    }

    /// Adds a tie of pairs of nodes, each at one place.
    pub(super) fn tie_nodes(&mut self, name: String, card: &str, of: &str, pairs: Vec<[u32; 2]>) {
        let follower = self.group(&format!("{name}-nodes"), pairs.iter().map(|[node, _]| *node));
        let leader = self.group(&format!("{name}-leaders"), pairs.iter().map(|[_, other]| *other));
        let table = vec![("follower", text(&follower)), ("leader", text(&leader)), ("kind", text("nodes"))];
        let words = ["tie of nodes at one place acts", "ties of nodes at one place act"];
        self.push(Entry { name, section: "tie", card, of, words, table });
    }

    /// Joins two nodes at one place, of which one belongs to a rigid body.
    fn join(&mut self, card: &str, called: &str, nodes: [u32; 2], with_rotation: bool) {
        let can_turn = |node: &u32| self.frame_of.get(node).is_some_and(|&frame| self.frames[frame].can_turn);
        let kind = if with_rotation && nodes.iter().all(can_turn) { "fixed" } else { "spherical" };
        // The place of a node is exact.
        let at = nodes.iter().find(|node| !self.frame_of.contains_key(node)).unwrap_or(&nodes[0]);
        let at = vector(self.point(*at));
        match self.ends(nodes) {
            Ok([a, b]) => {
                let name = self.name(None, "mpc");
                let between = list(vec![text(&a), text(&b)]);
                let table =
                    vec![("name", text(&name)), (kind, inner(vec![("between", between), ("at", at)]))];
                let words = ["joint acts", "joints act"];
                self.push(Entry { name, section: "joint", card, of: called, words, table });
            }
            Err(reason) => self.report.leave_out(card, reason, called.to_string()),
        }
    }
}
