//! Masses at nodes: `*MASS` and `*ROTARY INERTIA` with their elements.

use std::collections::{BTreeMap, BTreeSet};

use super::find::{Lump, reals};
use super::rigid::{Frame, Rigid};
use super::{Entry, Maker, Owned, Rows, inner, list, text, vector};
use crate::vector::Vector;

type Matrix = [[f64; 3]; 3];

/// Mass at a node that belongs to no cell.
#[derive(Debug, Default)]
pub(super) struct PointMass {
    mass: f64,
    inertia: Option<Matrix>,
    /// Its elements of mass and of inertia.
    lumps: Vec<Lump>,
    is_done: bool,
}

const WORDS: [&str; 2] = ["mass acts", "masses act"];

impl<'a> Maker<'a, '_> {
    /// Reads the masses at nodes without cells.
    pub(super) fn gather_masses(&mut self) {
        for owned in self.cards_of(&["MASS"]) {
            let lumps = self.lumps_of_card(owned, "MASS");
            let Some(mass) = self.mass_of(owned, &lumps) else { continue };
            for lump in lumps {
                let Some(node) = self.only_node(lump) else { continue };
                if !self.is_of_cells(node) && self.tell(lump) {
                    let own = self.masses.entry(node).or_default();
                    own.mass += mass;
                    own.lumps.push(lump);
                }
            }
        }
        for owned in self.cards_of(&["ROTARYINERTIA"]) {
            let lumps = self.lumps_of_card(owned, "ROTARYI");
            let inertia = owned.card.lines.first().and_then(|(_, fields)| reals(fields));
            let inertia = inertia.and_then(|values| match values[..] {
                [a, b, c, ref rest @ ..] if rest.len() <= 3 => {
                    let off = |i: usize| rest.get(i).copied().unwrap_or(0.0);
                    Some([[a, off(0), off(1)], [off(0), b, off(2)], [off(1), off(2), c]])
                }
                _ => None,
            });
            let reason = match inertia {
                _ if owned.has("ORIENTATION") => Some("its directions are not read (ORIENTATION)"),
                Some(inertia) if is_possible(&inertia) => None,
                _ => Some("no mass has such moments of inertia"),
            };
            for lump in lumps {
                let Some(node) = self.only_node(lump) else { continue };
                match (reason, inertia) {
                    (Some(reason), _) => self.leave_out_lump(lump, reason),
                    (None, _) if self.is_of_cells(node) => {
                        self.leave_out_lump(lump, "a node of a cell has no rotation");
                    }
                    (None, Some(inertia)) if self.tell(lump) => {
                        // The components are along the axes of the part.
                        let inertia = self.turned(inertia, lump.instance);
                        let own = self.masses.entry(node).or_default();
                        let sum = own.inertia.get_or_insert_default();
                        (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += inertia[i][j]));
                        own.lumps.push(lump);
                    }
                    _ => {}
                }
            }
        }
    }

    /// Elements of a card, which is counted as left out if it has none.
    pub(super) fn lumps_of_card(&mut self, owned: Owned<'a>, element_type: &str) -> Vec<Lump> {
        let lumps = self.lumps(owned, element_type);
        if lumps.is_empty() {
            self.account.leave_out(owned.title());
        }
        lumps
    }

    /// The mass of each element of a card.
    fn mass_of(&mut self, owned: Owned<'a>, lumps: &[Lump]) -> Option<f64> {
        let mass = owned
            .card
            .lines
            .first()
            .and_then(|(_, fields)| reals(fields))
            .and_then(|values| values.first().copied().filter(|mass| *mass >= 0.0));
        let is_isotropic = owned.value("TYPE").is_none_or(|own| own.eq_ignore_ascii_case("ISOTROPIC"));
        let reason = match mass {
            _ if !is_isotropic => "the mass is not alike in x, y and z",
            Some(mass) => return Some(mass),
            None => "its mass is not a number from 0 on",
        };
        lumps.iter().for_each(|&lump| self.leave_out_lump(lump, reason));
        None
    }

    /// The node of an element; the element is left out if it is not in the file.
    pub(super) fn only_node(&mut self, lump: Lump) -> Option<u32> {
        let node = self.nodes_of(lump).and_then(|nodes| nodes.first().copied());
        if node.is_none() {
            self.leave_out_lump(lump, "its node is not in the file");
        }
        node
    }

    fn turned(&self, inertia: Matrix, instance: Option<u32>) -> Matrix {
        let place = instance.map_or(0, |index| index as usize + 1);
        let placement = self.assembly.placements[place];
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| placement.turned(axis));
        let at = |i: usize, j: usize| {
            let mut sum = 0.0;
            for (k, row) in inertia.iter().enumerate() {
                sum += row.iter().enumerate().map(|(l, value)| axes[k][i] * value * axes[l][j]).sum::<f64>();
            }
            sum
        };
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i, j)))
    }

    /// Adds a rigid body without cells by the mass at its reference node; whether it has one.
    pub(super) fn free_body(&mut self, rigid: &Rigid, nodes: &BTreeSet<u32>) -> bool {
        let Some(reference) = rigid.reference else { return false };
        let Some(own) = self.masses.get_mut(&reference).filter(|own| own.mass > 0.0) else { return false };
        own.is_done = true;
        let (mass, inertia) = (own.mass, own.inertia);
        let name = self.name(rigid.name.as_deref(), "rigid-body");
        let frame = self.frames.len();
        self.frame_of.extend(nodes.iter().map(|&node| (node, frame)));
        self.used.extend(nodes);
        let can_turn = inertia.is_some();
        self.frames.push(Frame { name: name.clone(), reference: Some(reference), can_turn });
        let table = free(&name, mass, self.point(reference), inertia);
        let words = ["rigid body without cells acts", "rigid bodies without cells act"];
        self.push(Entry { name, section: "rigid", card: &rigid.card, of: &rigid.called, words, table });
        true
    }

    /// Adds the masses that no rigid body has yet.
    pub(super) fn masses(&mut self) {
        self.masses_of_cells();
        for (node, own) in std::mem::take(&mut self.masses).into_iter().filter(|(_, own)| !own.is_done) {
            let Some(&lump) = own.lumps.first() else { continue };
            if own.mass == 0.0 {
                for &lump in own.lumps.iter().filter(|_| own.inertia.is_some()) {
                    let (element_type, which) =
                        (self.type_of(lump), format!("element {}", self.number_of(lump)));
                    self.report.leave_out(element_type, "inertia without a mass", which);
                }
                continue;
            }
            let of = format!("of element {}", self.number_of(lump));
            let frame = self.frame_of.get(&node).copied();
            let is_at_point = frame.is_some_and(|frame| self.frames[frame].reference == Some(node));
            let body = frame.map(|frame| self.frames[frame].name.clone());
            if let Some(body) = body.as_ref().filter(|_| is_at_point) {
                let name = self.name(Some(&format!("{body}-mass")), "mass");
                let mut table = vec![("group", text(body)), ("mass", toml::Value::Float(own.mass))];
                table.extend(own.inertia.map(|inertia| ("inertia", matrix(inertia))));
                self.push(Entry { name, section: "mass", card: "*MASS", of: &of, words: WORDS, table });
                continue;
            }
            let name = self.name(Some(&format!("mass-{}", self.number_of(lump))), "mass");
            let point = self.point(node);
            self.used.insert(node);
            let table = free(&name, own.mass, point, own.inertia);
            let words = ["point mass acts", "point masses act"];
            self.push(Entry { name: name.clone(), section: "rigid", card: "*MASS", of: &of, words, table });
            match body {
                // It moves with the rigid body that has its node.
                Some(body) => {
                    let kind = if own.inertia.is_some() { "fixed" } else { "spherical" };
                    let between = list(vec![text(&name), text(&body)]);
                    let joint = self.name(Some(&format!("{name}-joint")), "joint");
                    let table = vec![
                        ("name", text(&joint)),
                        (kind, inner(vec![("between", between), ("at", vector(point))])),
                    ];
                    let words = ["joint of a mass acts", "joints of masses act"];
                    self.push(Entry { name: joint, section: "joint", card: "*MASS", of: &of, words, table });
                }
                None => {
                    self.frame_of.insert(node, self.frames.len());
                    self.frames.push(Frame { name, reference: Some(node), can_turn: own.inertia.is_some() });
                }
            }
        }
    }

    /// Masses at nodes of cells, one entry for each card.
    fn masses_of_cells(&mut self) {
        for owned in self.cards_of(&["MASS"]) {
            let lumps = self.lumps(owned, "MASS");
            let Some(mass) = self.mass_of(owned, &lumps) else { continue };
            let mut counts = BTreeMap::<u32, usize>::new();
            for lump in lumps {
                let Some(node) = self.only_node(lump).filter(|&node| self.is_of_cells(node)) else {
                    continue;
                };
                if self.tell(lump) {
                    *counts.entry(node).or_default() += 1;
                }
            }
            let mut nodes_of = BTreeMap::<usize, Vec<u32>>::new();
            counts.into_iter().for_each(|(node, count)| nodes_of.entry(count).or_default().push(node));
            for (count, nodes) in nodes_of.into_iter().filter(|_| mass > 0.0) {
                let set = owned.value("ELSET").unwrap_or_default();
                let name = self.name(Some(&format!("mass-{set}")), "mass");
                let group = self.group(&format!("{name}-nodes"), nodes);
                let table = vec![("group", text(&group)), ("mass", toml::Value::Float(mass * count as f64))];
                self.push(Entry { name, section: "mass", card: "*MASS", of: set, words: WORDS, table });
            }
        }
    }
}

fn free(name: &str, mass: f64, centre: Vector, inertia: Option<Matrix>) -> Rows {
    let mut table =
        vec![("name", text(name)), ("mass", toml::Value::Float(mass)), ("centre", vector(centre))];
    table.extend(inertia.map(|inertia| ("inertia", matrix(inertia))));
    table
}

fn matrix(matrix: Matrix) -> toml::Value {
    list(matrix.map(vector).to_vec())
}

/// Whether a mass can have these moments of inertia: the second moments, tr(J)/2 - J, have no negative principal value.
fn is_possible(inertia: &Matrix) -> bool {
    let trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
    let rounding = 1e-9 * trace;
    let e = |i: usize, j: usize| if i == j { trace / 2.0 + rounding - inertia[i][j] } else { -inertia[i][j] };
    let minor = |i: usize, j: usize| e(i, i) * e(j, j) - e(i, j) * e(i, j);
    let det = e(0, 0) * minor(1, 2) - e(0, 1) * (e(0, 1) * e(2, 2) - e(1, 2) * e(0, 2))
        + e(0, 2) * (e(0, 1) * e(1, 2) - e(1, 1) * e(0, 2));
    let minors = [minor(0, 1), minor(0, 2), minor(1, 2)];
    trace > 0.0 && (0..3).all(|i| e(i, i) >= 0.0) && minors.iter().all(|minor| *minor >= 0.0) && det >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_inertia_obey_the_triangle_inequality() {
        let of = |[a, b, c]: [f64; 3]| [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]];
        assert!(is_possible(&of([1.0, 1.0, 2.0])) && is_possible(&of([2.0, 3.0, 4.0])));
        assert!(
            !is_possible(&of([1.0, 1.0, 2.1]))
                && !is_possible(&of([0.0; 3]))
                && !is_possible(&of([1.0, -1.0, 1.0]))
        );
        // Two equal masses on the diagonal of x and y.
        assert!(is_possible(&[[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 2.0]]));
        assert!(!is_possible(&[[1.0, -1.5, 0.0], [-1.5, 1.0, 0.0], [0.0, 0.0, 2.0]]));
    }
}
