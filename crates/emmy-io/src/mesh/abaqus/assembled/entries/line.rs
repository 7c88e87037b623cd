//! Joints between two points: springs and dampers along a line, and rigid links.

use toml::Value;

use super::{Entry, Maker, inner, list, text, vector};
use crate::vector::distance;

/// A spring, a damper or both between two nodes.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) nodes: [u32; 2],
    pub(super) name: String,
    pub(super) card: String,
    /// Its element in the file.
    pub(super) of: String,
    pub(super) stiffness: Option<f64>,
    pub(super) damping: Option<f64>,
}

/// A rigid link between two nodes.
#[derive(Debug)]
pub(super) struct Rod {
    pub(super) nodes: [u32; 2],
    /// The keyword with its type: `*MPC LINK`.
    pub(super) card: String,
    pub(super) called: String,
    pub(super) words: [&'static str; 2],
}

impl Maker<'_, '_> {
    /// The name of the body at a node in joints: a rigid body, a coupling or a group of this node; `None`: nothing
    /// moves the node.
    pub(super) fn end(&mut self, node: u32) -> Option<String> {
        if let Some(&frame) = self.frame_of.get(&node) {
            self.used.insert(node);
            return Some(self.frames[frame].name.clone());
        }
        if self.is_ground(node) {
            self.used.insert(node);
            return Some("ground".to_string());
        }
        if !self.is_of_cells(node) {
            return None;
        }
        if let Some(name) = self.ends.get(&node) {
            return Some(name.clone());
        }
        let name = super::names::safe(&format!("node-{}", self.label(node)));
        let name = self.group(&name, [node]);
        self.ends.insert(node, name.clone());
        Some(name)
    }

    /// The two ends of a joint, or the reason why there is none.
    pub(super) fn ends(&mut self, [a, b]: [u32; 2]) -> Result<[String; 2], &'static str> {
        if let (Some(one), Some(two)) = (self.frame_of.get(&a), self.frame_of.get(&b))
            && one == two
        {
            return Err("both of its nodes belong to one rigid body");
        }
        let is_moved = |node| self.frame_of.contains_key(&node) || self.is_of_cells(node);
        if [a, b].iter().any(|&node| !is_moved(node) && !self.is_ground(node)) {
            return Err("one of its nodes belongs to no cell, coupling or mass");
        }
        if !is_moved(a) && !is_moved(b) {
            return Err("both of its nodes are fixed");
        }
        let ends = [self.end(a), self.end(b)];
        match ends {
            [Some(a), Some(b)] => Ok([a, b]),
            _ => Err("one of its nodes belongs to no cell, coupling or mass"),
        }
    }

    /// Adds a spring or a damper to the line between two nodes.
    pub(super) fn add_line(&mut self, line: Line) {
        let [a, b] = line.nodes;
        let key = [a.min(b), a.max(b)];
        let known = self.line_of.get(&key).and_then(|&at| self.lines.get_mut(at));
        let Some(known) = known else {
            self.line_of.insert(key, self.lines.len());
            self.lines.push(line);
            return;
        };
        let sum = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(|a, b| a + b);
        known.stiffness = sum(known.stiffness, line.stiffness);
        known.damping = sum(known.damping, line.damping);
        if known.card != line.card && !known.card.contains(&line.card) {
            known.card = format!("{}, {}", known.card, line.card);
        }
    }

    /// Adds the springs and dampers.
    pub(super) fn line_joints(&mut self) {
        for line in std::mem::take(&mut self.lines) {
            let Line { nodes, name, card, of, stiffness, damping } = line;
            let points = nodes.map(|node| self.point(node));
            let is_positive = |value: Option<f64>| value.is_none_or(|value| value > 0.0);
            let ends = if distance(points[0], points[1]) <= self.rounding * 1e-3 {
                Err("its nodes lie at one place")
            } else if !(is_positive(stiffness) && is_positive(damping)) {
                Err("its stiffness or damping is not positive")
            } else {
                self.ends(nodes)
            };
            let [a, b] = match ends {
                Ok(ends) => ends,
                Err(reason) => {
                    self.report.leave_out(&card, reason, of);
                    continue;
                }
            };
            let name = self.name(Some(&name), "joint");
            let between = list(vec![text(&a), text(&b)]);
            let points = list(points.map(vector).to_vec());
            let mut table =
                vec![("name", text(&name)), ("line", inner(vec![("between", between), ("points", points)]))];
            let spring = |stiffness| ("spring", inner(vec![("stiffness", Value::Float(stiffness))]));
            table.extend(stiffness.map(spring));
            table.extend(damping.map(|damping| ("damping", Value::Float(damping))));
            let words = match (stiffness, damping) {
                (Some(_), Some(_)) => ["spring with a damper acts", "springs with dampers act"],
                (None, _) => ["damper acts", "dampers act"],
                _ => ["spring acts", "springs act"],
            };
            self.push(Entry { name, section: "joint", card: &card, of: &of, words, table });
        }
    }

    /// Adds the rigid links.
    pub(super) fn rods(&mut self) {
        for rod in std::mem::take(&mut self.rods) {
            let Rod { nodes, card, called, words } = rod;
            let points = nodes.map(|node| self.point(node));
            let ends = match distance(points[0], points[1]) > self.rounding * 1e-3 {
                true => self.ends(nodes),
                false => Err("its nodes lie at one place"),
            };
            match ends {
                Ok([a, b]) => {
                    let name = self.name(None, "link");
                    let between = list(vec![text(&a), text(&b)]);
                    let points = list(points.map(vector).to_vec());
                    let table = vec![
                        ("name", text(&name)),
                        ("distance", inner(vec![("between", between), ("points", points)])),
                    ];
                    self.push(Entry { name, section: "joint", card: &card, of: &called, words, table });
                }
                Err(reason) => self.report.leave_out(&card, reason, called),
            }
        }
    }
}
