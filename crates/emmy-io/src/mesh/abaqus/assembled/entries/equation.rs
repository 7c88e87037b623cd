//! `*EQUATION`: nodes that follow others with the same weights in x, y and z.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::find::real;
use super::{Entry, Maker, Owned, numbers, text};
use crate::vector::distance;

/// A linear equation, solved for its first term: `u = sum w u_i` in one component.
#[derive(Debug)]
struct Equation {
    follower: u32,
    dof: u64,
    weights: Vec<(u32, f64)>,
    called: String,
}

const CARD: &str = "*EQUATION";

const NOT_ALIKE: &str = "not of one node in x, y and z with the same weights";

impl<'a> Maker<'a, '_> {
    pub(super) fn equations(&mut self) {
        let mut all: Vec<Equation> = Vec::new();
        for owned in self.cards_of(&["EQUATION"]) {
            self.read_equations(owned, &mut all);
        }
        let mut order = Vec::new();
        let mut of = HashMap::<u32, Vec<Equation>>::new();
        for equation in all {
            let own = of.entry(equation.follower).or_default();
            if own.is_empty() {
                order.push(equation.follower);
            }
            own.push(equation);
        }
        let mut pairs = Vec::new();
        let mut called_of = HashMap::new();
        for follower in order {
            let equations = of.remove(&follower).unwrap_or_default();
            match self.weights(follower, &equations) {
                Ok(weights) if weights.len() == 1 => {
                    called_of.insert(follower, equations[0].called.clone());
                    pairs.push([follower, weights[0].0]);
                }
                Ok(weights) => self.follow(follower, weights, &equations[0].called),
                Err(reason) => {
                    equations.into_iter().for_each(|own| self.report.leave_out(CARD, reason, own.called));
                }
            }
        }
        let whole = without_chains(&pairs);
        let kept: HashSet<u32> = whole.iter().map(|[node, _]| *node).collect();
        for [node, _] in pairs.iter().filter(|[node, _]| !kept.contains(node)) {
            let called = called_of.get(node).cloned().unwrap_or_default();
            self.report.leave_out(CARD, "its nodes follow one another in a ring", called);
        }
        if let Some([first, _]) = whole.first() {
            let called = called_of.get(first).cloned().unwrap_or_default();
            let name = self.name(None, "equation");
            self.tie_nodes(name, CARD, &called, whole);
        }
    }

    /// Reads the equations of a card: each has a line with the number of its terms, then these.
    fn read_equations(&mut self, owned: Owned<'a>, all: &mut Vec<Equation>) {
        let filled =
            |fields: &'a [String]| fields.iter().map(String::as_str).filter(|field| !field.is_empty());
        let lines = owned.card.lines.iter().map(|(at, fields)| (at, filled(fields).collect::<Vec<&str>>()));
        let mut lines = lines.filter(|(_, fields)| !fields.is_empty()).peekable();
        if lines.peek().is_none() {
            self.leave_out(owned, &[], "it has no data");
        }
        while let Some((&at, fields)) = lines.next() {
            let called = self.line(at);
            let n_terms =
                fields[0].parse::<usize>().ok().filter(|n| fields.len() == 1 && (1..100_000).contains(n));
            let Some(n_terms) = n_terms else {
                let reason = "the number of its terms is missing";
                self.report.leave_out(CARD, reason, called);
                // The rest of the card has no beginning.
                return;
            };
            let mut terms: Vec<&str> = Vec::new();
            while terms.len() < 3 * n_terms {
                let Some((_, fields)) = lines.next() else { break };
                terms.extend(fields);
            }
            match self.equation(owned, &terms, n_terms, called.clone()) {
                Ok(equation) => all.push(equation),
                Err(reason) => self.report.leave_out(CARD, reason, called),
            }
        }
    }

    fn equation(
        &self,
        owned: Owned<'a>,
        terms: &[&str],
        n_terms: usize,
        called: String,
    ) -> Result<Equation, &'static str> {
        if terms.len() != 3 * n_terms {
            return Err("it has another number of terms than it says");
        }
        let mut found = Vec::new();
        for term in terms.chunks_exact(3) {
            let nodes = self.nodes(owned.instance, term[0]);
            let dof = term[1].parse::<u64>().map_err(|_| "a component is not a number")?;
            let factor = real(term[2]).ok_or("a coefficient is not a number")?;
            match nodes[..] {
                [node] => found.push((node, dof, factor)),
                [] => return Err("a node or node set is not in the file"),
                _ => return Err("a set of several nodes"),
            }
        }
        let Some(&(follower, dof, factor)) = found.first() else { return Err(NOT_ALIKE) };
        let is_alike = found.iter().all(|&(_, own, _)| own == dof);
        if !is_alike || factor == 0.0 || !(1..=3).contains(&dof) {
            return Err(NOT_ALIKE);
        }
        let mut weights = BTreeMap::new();
        for &(node, _, own) in &found[1..] {
            *weights.entry(node).or_insert(0.0) -= own / factor;
        }
        let weights = weights.into_iter().filter(|(_, weight)| *weight != 0.0).collect();
        Ok(Equation { follower, dof, weights, called })
    }

    /// The weights of the equations of a node, if they are those of one point of the body.
    fn weights(&self, follower: u32, equations: &[Equation]) -> Result<Vec<(u32, f64)>, &'static str> {
        let mut dofs: Vec<u64> = equations.iter().map(|own| own.dof).collect();
        dofs.sort_unstable();
        let is_whole = dofs == [1, 2, 3] || self.assembly.is_plane && dofs == [1, 2];
        let weights = &equations[0].weights;
        let same = |other: &Equation| {
            other.weights.len() == weights.len()
                && other.weights.iter().zip(weights).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= 1e-9)
        };
        if !is_whole || !equations.iter().all(same) {
            return Err(NOT_ALIKE);
        }
        let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
        // Coefficients of a file have a few digits.
        if (sum - 1.0).abs() > 1e-5 {
            return Err("its weights do not sum to one");
        }
        let mut mean = [0.0; 3];
        for &(node, weight) in weights {
            let point = self.point(node);
            (0..3).for_each(|i| mean[i] += weight / sum * point[i]);
        }
        if distance(mean, self.point(follower)) > self.rounding {
            return Err("its node does not lie at the weighted mean of the others");
        }
        let mut nodes = weights.iter().map(|(node, _)| *node).chain([follower]);
        if !nodes.all(|node| self.is_of_cells(node)) {
            return Err("not all of its nodes belong to cells");
        }
        Ok(weights.iter().map(|&(node, weight)| (node, weight / sum)).collect())
    }

    fn follow(&mut self, follower: u32, weights: Vec<(u32, f64)>, called: &str) {
        let name = self.name(None, "equation");
        let (nodes, weights): (Vec<u32>, Vec<f64>) = weights.into_iter().unzip();
        let follower = self.group(&format!("{name}-nodes"), [follower]);
        let leader = self.group(&format!("{name}-leaders"), nodes);
        let table =
            vec![("follower", text(&follower)), ("leader", text(&leader)), ("weights", numbers(&weights))];
        let words = ["tie by weights acts", "ties by weights act"];
        self.push(Entry { name, section: "tie", card: CARD, of: called, words, table });
    }
}

/// Pairs of a node and the one that it follows, in which none that is followed follows another one.
fn without_chains(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    /// Longest chain that is followed to its end.
    const MAX_LENGTH: usize = 1000;

    let leader_of: HashMap<u32, u32> = pairs.iter().map(|&[node, leader]| (node, leader)).collect();
    let last = |mut node: u32| {
        // A ring has no end.
        for _ in 0..MAX_LENGTH.min(pairs.len()) {
            match leader_of.get(&node) {
                Some(&next) => node = next,
                None => break,
            }
        }
        node
    };
    let last_pairs = pairs.iter().map(|&[node, leader]| [node, last(leader)]);
    last_pairs.filter(|[node, leader]| node != leader && !leader_of.contains_key(leader)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_end_at_the_last_node() {
        assert_eq!(without_chains(&[[1, 2], [2, 3], [4, 3]]), [[1, 3], [2, 3], [4, 3]]);
        assert!(without_chains(&[[1, 2], [2, 1]]).is_empty());
    }
}
