//! Nodes without cells that `*BOUNDARY` fixes: the ground of springs and joints.

use std::collections::BTreeMap;

use super::super::super::super::entry::first_names;
use super::Maker;
use super::find::real;

/// Words of a line that fix x, y and z.
const FIXED: [&str; 2] = ["PINNED", "ENCASTRE"];

impl Maker<'_, '_> {
    /// Finds the nodes without cells that are fixed in x, y and z.
    pub(super) fn find_ground(&mut self) {
        let mut fixed = BTreeMap::<u32, u8>::new();
        for owned in self.cards_of(&["BOUNDARY"]) {
            // A given velocity is none.
            if ["TYPE", "AMPLITUDE", "USER", "SUBMODEL", "FIXED"].iter().any(|key| owned.has(key)) {
                continue;
            }
            for (_, fields) in &owned.card.lines {
                let field = |at: usize| fields.get(at).map(String::as_str).unwrap_or_default();
                let mask = match (field(1).parse::<u8>(), field(2).parse::<u8>()) {
                    _ if FIXED.contains(&field(1).to_ascii_uppercase().as_str()) => 0b111,
                    (Ok(first @ 1..=6), last) => {
                        let last = last.unwrap_or(first).clamp(first, 6);
                        (first..=last).fold(0, |mask, dof| mask | 1 << (dof - 1))
                    }
                    _ => 0,
                };
                if mask == 0 || real(field(3)) != Some(0.0) {
                    continue;
                }
                for node in self.nodes(owned.instance, field(0)) {
                    if !self.is_of_cells(node) {
                        *fixed.entry(node).or_default() |= mask;
                    }
                }
            }
        }
        self.fixed =
            fixed.into_iter().filter(|(_, mask)| mask & 0b111 == 0b111).map(|(node, _)| node).collect();
    }

    /// Whether a node is the ground.
    pub(super) fn is_ground(&self, node: u32) -> bool {
        self.fixed.contains(&node) && !self.frame_of.contains_key(&node)
    }

    /// A remark on the nodes that were taken as the ground.
    pub(super) fn remark_on_ground(&mut self) {
        let nodes: Vec<String> =
            self.used.iter().filter(|&&node| self.is_ground(node)).map(|&node| self.label(node)).collect();
        if nodes.is_empty() {
            return;
        }
        let [what, are] = if nodes.len() == 1 { ["node", "is"] } else { ["nodes", "are"] };
        let text = format!(
            "the {what} {} without cells {are} fixed, and the ground of springs and joints",
            first_names(&nodes)
        );
        self.report.remark("*BOUNDARY", None, &text);
    }
}
