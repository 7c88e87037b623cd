//! Rigid bodies and couplings: `*COUPLING`, `*KINEMATIC COUPLING`, `*DISTRIBUTING COUPLING`, `*RIGID BODY`, and the
//! rigid beams of `*MPC`.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::super::super::entry::first_names;
use super::find::{Surface, real};
use super::{Entry, Maker, Owned, numbers, text, vector};
use crate::vector::{distance, span_a_plane};

/// An entry with a motion of its own, which joints, masses and springs name.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) name: String,
    /// The node at its point; none at the centre of mass of its nodes.
    pub(super) reference: Option<u32>,
    /// Whether it has directions.
    pub(super) can_turn: bool,
}

/// Nodes that move as one, before those that share nodes are joined.
#[derive(Debug)]
pub(super) struct Rigid {
    /// The name in the file.
    pub(super) name: Option<String>,
    /// The keyword: `*COUPLING`.
    pub(super) card: String,
    /// Its name or line in notes.
    pub(super) called: String,
    pub(super) nodes: Vec<u32>,
    pub(super) reference: Option<u32>,
    /// The group of the nodes, if it has exactly these.
    pub(super) group: Option<String>,
    /// Whether the point is the centre of mass of the nodes.
    pub(super) is_centred: bool,
    /// Whether it is a rigid beam of `*MPC`, which may end as a rod.
    pub(super) is_beam: bool,
}

/// The mean motion of some nodes.
#[derive(Debug)]
pub(super) struct Distributing {
    pub(super) name: Option<String>,
    pub(super) card: String,
    pub(super) called: String,
    pub(super) nodes: Vec<u32>,
    pub(super) reference: u32,
    pub(super) group: Option<String>,
    pub(super) weights: Option<Vec<f64>>,
}

const NO_REFERENCE: &str = "the reference node is not in the file, or not one node";

/// Whether lines `.., first dof, last dof` have all of x, y and z; without lines they have.
fn has_all<'l>(lines: impl Iterator<Item = &'l [String]> + Clone) -> bool {
    let has = |fields: &[String], wanted: u64| {
        let dofs: Vec<u64> = fields.iter().filter_map(|field| field.parse().ok()).collect();
        match dofs[..] {
            [] => true,
            [only] => only == wanted,
            [first, last, ..] => (first..=last.max(first)).contains(&wanted),
        }
    };
    lines.clone().next().is_none() || (1..=3).all(|wanted| lines.clone().any(|fields| has(fields, wanted)))
}

impl<'a> Maker<'a, '_> {
    /// Reads rigid bodies and couplings and adds them.
    pub(super) fn bodies(&mut self) {
        let (mut rigid, mut distributing) = (Vec::new(), Vec::new());
        let mut parts = BTreeSet::new();
        for index in 0..self.cards.len() {
            let owned = self.cards[index];
            match owned.keyword() {
                "COUPLING" => {
                    let next = self.cards.get(index + 1).copied();
                    let is_kind = |next: &Owned<'_>| ["KINEMATIC", "DISTRIBUTING"].contains(&next.keyword());
                    let kind = next.filter(is_kind).filter(|next| next.instance == owned.instance);
                    parts.extend(kind.map(|_| index + 1));
                    self.coupling(owned, kind, &mut rigid, &mut distributing);
                }
                "KINEMATIC" | "DISTRIBUTING" if !parts.contains(&index) => {
                    self.leave_out(owned, &[], "it does not follow *COUPLING");
                }
                "KINEMATICCOUPLING" => rigid.extend(self.kinematic_coupling(owned)),
                "DISTRIBUTINGCOUPLING" => distributing.extend(self.distributing_coupling(owned)),
                "RIGIDBODY" => rigid.extend(self.rigid_body(owned)),
                "MPC" => rigid.extend(self.beams(owned)),
                _ => {}
            }
        }
        self.gather_masses();
        for cluster in clusters(rigid) {
            self.rigid(cluster);
        }
        distributing.into_iter().for_each(|own| self.distributing(own));
    }

    fn coupling(
        &mut self,
        owned: Owned<'a>,
        kind: Option<Owned<'a>>,
        rigid: &mut Vec<Rigid>,
        distributing: &mut Vec<Distributing>,
    ) {
        const KEYS: [&str; 2] = ["CONSTRAINTNAME", "NAME"];
        let Some(kind) = kind else {
            return self.leave_out(owned, &KEYS, "neither *KINEMATIC nor *DISTRIBUTING follows it");
        };
        let Some(reference) = self.reference(owned) else {
            return self.leave_out(owned, &KEYS, NO_REFERENCE);
        };
        let surface = owned.value("SURFACE").and_then(|name| self.surface(owned.instance, name));
        let Some(Surface { group, nodes, weights, .. }) = surface.filter(|surface| !surface.nodes.is_empty())
        else {
            return self.leave_out(owned, &KEYS, "its surface is not in the file, or is empty");
        };
        let name = KEYS.iter().find_map(|key| owned.value(key)).map(str::to_string);
        let (called, card) = (self.called(owned, &KEYS), owned.title().to_string());
        if owned.has("INFLUENCERADIUS") {
            let text = "INFLUENCE RADIUS is not read, all nodes of the surface are coupled";
            self.report.remark(&card, Some(&called), text);
        }
        if kind.keyword() == "KINEMATIC" {
            if !has_all(kind.card.lines.iter().map(|(_, fields)| fields.as_slice())) {
                return self.leave_out(owned, &KEYS, "not all of x, y and z are coupled");
            }
            let (reference, is_centred) = (Some(reference), false);
            rigid.push(Rigid { name, card, called, nodes, reference, group, is_centred, is_beam: false });
            return;
        }
        let method = kind.value("WEIGHTINGMETHOD").unwrap_or("UNIFORM").to_ascii_uppercase();
        if method != "UNIFORM" {
            let text = format!("WEIGHTING METHOD={method} is not read, the weights are uniform");
            self.report.remark(&card, Some(&called), &text);
        }
        distributing.push(Distributing { name, card, called, nodes, reference, group, weights });
    }

    /// Nodes of the data lines of a card, with the rest of each line.
    fn listed_nodes(&self, owned: Owned<'a>) -> Option<Vec<(u32, &'a [String])>> {
        let mut all = Vec::new();
        for (_, fields) in owned.card.lines.iter().filter(|(_, fields)| !fields.is_empty()) {
            let nodes = self.nodes(owned.instance, &fields[0]);
            if nodes.is_empty() {
                return None;
            }
            all.extend(nodes.into_iter().map(|node| (node, &fields[1..])));
        }
        (!all.is_empty()).then_some(all)
    }

    fn kinematic_coupling(&mut self, owned: Owned<'a>) -> Option<Rigid> {
        let Some(reference) = self.reference(owned) else {
            self.leave_out(owned, &[], NO_REFERENCE);
            return None;
        };
        let Some(nodes) = self.listed_nodes(owned) else {
            self.leave_out(owned, &[], "a node or node set is not in the file");
            return None;
        };
        let mut dofs = BTreeMap::<u32, Vec<&[String]>>::new();
        for (node, fields) in nodes {
            dofs.entry(node).or_default().push(fields);
        }
        if !dofs.values().all(|lines| has_all(lines.iter().copied())) {
            self.leave_out(owned, &[], "not all of x, y and z are coupled");
            return None;
        }
        let set = match &owned.card.lines[..] {
            [(_, fields)] => fields.first().and_then(|set| self.group_of_nodes(owned.instance, set)),
            _ => None,
        };
        Some(Rigid {
            name: None,
            card: owned.title().to_string(),
            called: self.called(owned, &[]),
            nodes: dofs.into_keys().collect(),
            reference: Some(reference),
            group: set,
            is_centred: false,
            is_beam: false,
        })
    }

    /// The reference node is that of an element DCOUP3D.
    fn distributing_coupling(&mut self, owned: Owned<'a>) -> Option<Distributing> {
        let lumps = self.lumps(owned, "DCOUP");
        let reference = match lumps[..] {
            [lump] => self.nodes_of(lump).and_then(|nodes| nodes.first().copied()),
            _ => None,
        };
        let Some(reference) = reference else {
            self.leave_out(owned, &["ELSET"], "its set has not one element DCOUP3D with a node of the file");
            return None;
        };
        lumps.iter().for_each(|&lump| _ = self.tell(lump));
        let Some(listed) = self.listed_nodes(owned) else {
            self.leave_out(owned, &["ELSET"], "a node or node set is not in the file");
            return None;
        };
        let mut weights = BTreeMap::new();
        for (node, fields) in listed {
            let weight =
                fields.first().filter(|field| !field.is_empty()).map_or(Some(1.0), |field| real(field));
            let Some(weight) = weight.filter(|weight| *weight > 0.0) else {
                self.leave_out(owned, &["ELSET"], "a weight is not a positive number");
                return None;
            };
            *weights.entry(node).or_insert(0.0) += weight;
        }
        let (nodes, weights): (Vec<u32>, Vec<f64>) = weights.into_iter().unzip();
        let differ = weights.iter().any(|weight| *weight != weights[0]);
        let called = self.called(owned, &["ELSET"]);
        let sum: f64 = weights.iter().sum();
        let points = nodes.iter().zip(&weights).map(|(&node, weight)| (self.point(node), weight / sum));
        let mean = points.fold([0.0; 3], |mean, (point, part)| [0, 1, 2].map(|i| mean[i] + part * point[i]));
        if distance(mean, self.point(reference)) > self.rounding {
            let text = "the point is the reference node, which is not at the mean of the nodes; CalculiX does not read \
                        this place";
            self.report.remark(owned.title(), Some(&called), text);
        }
        Some(Distributing {
            name: owned.value("ELSET").map(|set| format!("coupling-{set}")),
            card: owned.title().to_string(),
            called,
            nodes,
            reference,
            group: None,
            weights: differ.then_some(weights),
        })
    }

    fn rigid_body(&mut self, owned: Owned<'a>) -> Option<Rigid> {
        const KEYS: [&str; 4] = ["ELSET", "NSET", "PINNSET", "TIENSET"];
        let reference = self.reference(owned);
        if reference.is_none() && owned.has("REFNODE") {
            self.leave_out(owned, &KEYS, NO_REFERENCE);
            return None;
        }
        let (mut nodes, mut groups) = (Vec::new(), Vec::new());
        let mut is_missing = false;
        if let Some(set) = owned.value("ELSET") {
            let (own, group) = self.nodes_of_set(owned.instance, set);
            is_missing |= own.is_empty();
            nodes.extend(own);
            groups.push(group);
        }
        for set in ["NSET", "PINNSET", "TIENSET"].iter().filter_map(|key| owned.value(key)) {
            let own = self.nodes(owned.instance, set);
            is_missing |= own.is_empty();
            nodes.extend(own);
            groups.push(self.group_of_nodes(owned.instance, set));
        }
        if groups.is_empty() || is_missing {
            let reason = match owned.has("ANALYTICALSURFACE") && groups.is_empty() {
                true => "an analytical surface without nodes",
                false => "its set is not in the file, or is empty",
            };
            self.leave_out(owned, &KEYS, reason);
            return None;
        }
        let called = self.called(owned, &KEYS);
        if owned.has("ROTNODE") {
            let text = "the ROT NODE stands for the rotation, and has no entry of its own";
            self.report.remark(owned.title(), Some(&called), text);
        }
        let position = owned.value("POSITION").unwrap_or("INPUT").to_ascii_uppercase();
        let is_centred =
            reference.is_none() || position.split_whitespace().collect::<String>() == "CENTEROFMASS";
        let name = KEYS.iter().find_map(|key| owned.value(key)).map(|set| format!("rigid-{set}"));
        let card = owned.title().to_string();
        let group = if groups.len() == 1 { groups.remove(0) } else { None };
        Some(Rigid { name, card, called, nodes, reference, group, is_centred, is_beam: false })
    }

    /// Adds rigid bodies that share nodes as one.
    fn rigid(&mut self, cluster: Vec<Rigid>) {
        let mut nodes: BTreeSet<u32> = cluster.iter().flat_map(|own| &own.nodes).copied().collect();
        let of_group = nodes.clone();
        nodes.extend(cluster.iter().filter_map(|own| own.reference));
        let cells: Vec<u32> = nodes.iter().copied().filter(|&node| self.is_of_cells(node)).collect();
        let Some(first) = cluster.iter().find(|own| !own.is_beam).or(cluster.first()) else { return };
        let is_of_plane = self.assembly.is_plane && !cells.is_empty();
        let points: Vec<_> = cells.iter().map(|&node| self.point(node)).collect();
        if cells.is_empty() || is_of_plane || !span_a_plane(&points) {
            if cluster.iter().all(|own| own.is_beam) {
                return cluster.iter().for_each(|own| self.rods_of(own));
            }
            let reason = match cells.is_empty() {
                true if self.free_body(first, &nodes) => return,
                true => "no node of it belongs to a cell, and its reference node has no mass",
                false if is_of_plane => "cells in plane strain cannot be rigid",
                false => "its nodes of cells lie on one line",
            };
            for own in &cluster {
                self.report.leave_out(&own.card, reason, own.called.clone());
            }
            return;
        }
        let word = first.card.trim_start_matches('*').to_lowercase().replace(' ', "-");
        let name = self.name(first.name.as_deref(), &word);
        let named: Vec<String> =
            cluster.iter().filter(|own| !own.is_beam).map(|own| own.called.clone()).collect();
        if named.len() > 1 {
            let text = format!("{} share nodes and are one rigid body, {name}", first_names(&named));
            self.report.remark(&first.card, None, &text);
        }
        let is_whole = |own: &Rigid| {
            own.reference.is_none_or(|node| !self.is_of_cells(node) || of_group.contains(&node))
        };
        let own_group = first.group.clone().filter(|_| cluster.len() == 1 && is_whole(first));
        let group = own_group.unwrap_or_else(|| self.group(&format!("{name}-nodes"), cells.iter().copied()));
        let reference = first.reference.filter(|_| !first.is_centred);
        self.used.extend(&nodes);
        let frame = self.frames.len();
        self.frame_of.extend(nodes.iter().map(|&node| (node, frame)));
        self.frames.push(Frame { name: name.clone(), reference: first.reference, can_turn: true });
        let mut table = vec![("name", text(&name)), ("group", text(&group))];
        let (section, words) = match reference {
            Some(node) => {
                table.extend([("point", vector(self.point(node))), ("kind", text("rigid"))]);
                ("coupling", ["rigid coupling acts", "rigid couplings act"])
            }
            None => ("rigid", ["rigid body acts", "rigid bodies act"]),
        };
        self.push(Entry { name, section, card: &first.card, of: &first.called, words, table });
    }

    fn distributing(&mut self, own: Distributing) {
        let Distributing { name, card, called, nodes, reference, group, weights } = own;
        let frame = self.frame_of.get(&reference).map(|&frame| self.frames[frame].name.clone());
        let reason = if !nodes.iter().all(|&node| self.is_of_cells(node)) {
            "not all of its nodes belong to cells".to_string()
        } else if self.is_of_cells(reference) {
            "its reference node belongs to a cell".to_string()
        } else if let Some(frame) = frame {
            format!("its reference node belongs to {frame} already")
        } else {
            let name = self.name(name.as_deref(), "coupling");
            let group = group.unwrap_or_else(|| self.group(&format!("{name}-nodes"), nodes));
            self.used.insert(reference);
            self.frame_of.insert(reference, self.frames.len());
            self.frames.push(Frame { name: name.clone(), reference: Some(reference), can_turn: true });
            let mut table = vec![
                ("name", text(&name)),
                ("group", text(&group)),
                ("point", vector(self.point(reference))),
                ("kind", text("distributing")),
            ];
            table.extend(weights.map(|weights| ("weights", numbers(&weights))));
            let words = ["distributing coupling acts", "distributing couplings act"];
            self.push(Entry { name, section: "coupling", card: &card, of: &called, words, table });
            return;
        };
        self.report.leave_out(&card, &reason, called);
    }
}

/// Rigid bodies in lists of those that share nodes, in the order of the file.
fn clusters(all: Vec<Rigid>) -> Vec<Vec<Rigid>> {
    fn root(parents: &mut [usize], mut of: usize) -> usize {
        while parents[of] != of {
            parents[of] = parents[parents[of]];
            of = parents[of];
        }
        of
    }
    let mut parents: Vec<usize> = (0..all.len()).collect();
    let mut first = HashMap::<u32, usize>::new();
    for (index, own) in all.iter().enumerate() {
        for &node in own.nodes.iter().chain(&own.reference) {
            let other = *first.entry(node).or_insert(index);
            let [a, b] = [root(&mut parents, other), root(&mut parents, index)];
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut clusters = BTreeMap::<usize, Vec<Rigid>>::new();
    for (index, own) in all.into_iter().enumerate() {
        clusters.entry(root(&mut parents, index)).or_default().push(own);
    }
    clusters.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_in_ranges_on_several_lines() {
        let all = |lines: &[&str]| {
            let lines: Vec<Vec<String>> = lines
                .iter()
                .map(|line| line.split(',').map(|field| field.trim().to_string()).collect())
                .collect();
            has_all(lines.iter().map(Vec::as_slice))
        };
        assert!(all(&[]) && all(&["1, 6"]) && all(&["1, 3"]) && all(&["1, 1", "2", "3, 3"]));
        assert!(!all(&["1"]) && !all(&["1, 2"]) && !all(&["2, 6"]) && !all(&["4, 6"]));
    }
}
