//! Cells, faces and groups of a complete file.

use std::collections::{BTreeSet, HashMap, HashSet};

use emmy::mesh::CellKind;

use super::super::abaqus::{Body, Element, Of};
use super::super::{MeshError, MeshOptions, Result};
use super::card::Card;
use super::element::midsides;
use super::{Raw, Reader, Sheet};
use crate::message::counted;

/// Names of groups in a note at most.
const MAX_NAMES: usize = 10;

/// Corners of a facet in ascending order.
type Corners = [u64; 4];

fn corners(nodes: impl Iterator<Item = u64>) -> Corners {
    let mut key = [u64::MAX; 4];
    key.iter_mut().zip(nodes).for_each(|(slot, node)| *slot = node);
    key.sort_unstable();
    key
}

impl Raw {
    fn corners(&self) -> Corners {
        corners(self.nodes[..self.kind.n_corners()].iter().copied())
    }
}

impl Reader {
    /// Reads all cards: cells, and elements of lower dimension as groups of facets or nodes, by the names of their
    /// properties.
    pub(super) fn complete(
        &mut self,
        cards: Vec<Card<'_>>,
        names: &HashMap<u64, String>,
        options: &MeshOptions,
    ) -> Result<()> {
        self.cards(cards)?;
        let [one, many] = ["card has", "cards have"];
        let rest = "fields after the last one of its kind, which are not read, here for the first time";
        let too_long = self.counted_at(self.too_long, one, many, rest);
        self.deck.notes.extend(too_long);
        self.place_grids()?;
        let mut elements = std::mem::take(&mut self.elements);
        let dimension = elements.iter().map(|element| element.kind.dimension()).max().unwrap_or(0).max(2);
        if dimension == 2 {
            self.check_sheets(&elements, options)?;
        }
        self.fill_midsides(&mut elements, dimension)?;
        // Links alone may be in space.
        let is_plane = dimension == 2 && elements.iter().any(|element| element.kind.dimension() == 2);
        self.name_constraints(is_plane);
        let facets = facets(&elements, dimension);
        // Gmsh gives a volume, a surface and a curve the same number.
        let mut highest = HashMap::<u64, usize>::new();
        for element in &elements {
            let dimension = highest.entry(element.property).or_default();
            *dimension = element.kind.dimension().max(*dimension);
        }
        let name_of =
            |property: u64| names.get(&property).cloned().unwrap_or_else(|| format!("pid_{property}"));
        for (property, node) in std::mem::take(&mut self.ends) {
            let mut name = name_of(property);
            // The elements of the same number have a group of this name.
            if highest.contains_key(&property) {
                name += "-ends";
            }
            if self.deck.root.nodes.contains_key(&node) {
                self.deck.root.set_mut(Of::Nodes, &name).push(None, node);
            }
        }
        let mut numbers = HashSet::new();
        let mut n_lines = 0;
        for element in elements {
            let Raw { number, card, kind, property, ref nodes, at } = element;
            let mut name = name_of(property);
            if kind.dimension() < highest[&property] {
                name += if kind.dimension() == 2 { "-faces" } else { "-lines" };
            }
            if !numbers.insert(number) {
                return Err(MeshError::Duplicate { place: self.deck.place(at), what: "element", number });
            }
            let is_cell =
                kind.dimension() == dimension || kind == CellKind::Line2 && options.links.contains(&name);
            let is_facet = kind.dimension() + 1 == dimension;
            let is_unknown = |&node: &u64| node > 0 && !self.deck.root.nodes.contains_key(&node);
            let is_alone = !is_cell
                && (is_facet && !facets.contains(&element.corners()) || nodes.iter().any(is_unknown));
            let has_stiffness = match kind {
                CellKind::Line2 => self.bars.contains(&property),
                _ => matches!(self.sheets.get(&property), Some(Sheet::Shell(_))),
            };
            if card == "CBUSH" && is_cell {
                self.beside.links.insert(number);
            }
            // Springs with a stiffness act, or have a note of their own.
            let is_spring = card == "CBUSH" && has_stiffness && !is_cell;
            if !is_spring && (is_alone || !is_cell && has_stiffness) {
                self.account.leave_out(card);
            } else if kind == CellKind::Line2 && !is_spring && !is_cell && !is_facet {
                n_lines += 1;
            }
            let body = &mut self.deck.root;
            if is_alone {
                let set = body.set_mut(Of::Nodes, &name);
                nodes.iter().filter(|&&node| node > 0).for_each(|&node| set.push(None, node));
                continue;
            }
            let (list, index) = match is_cell {
                true => (&mut body.elements, &mut body.element_index),
                false => (&mut body.lower, &mut body.lower_index),
            };
            index.insert(number, list.len() as u32);
            let start = body.connectivity.len();
            let element_type = None;
            list.push(Element { number, kind, n_nodes: nodes.len(), nodes: start, element_type, at });
            body.connectivity.extend(nodes);
            body.set_mut(Of::Elements, &name).push(None, number);
        }
        if n_lines > 0 {
            let lines = counted(n_lines, "line element is", "line elements are");
            self.deck.notes.insert(format!("{lines} read as the nodes at the ends, not as bars"));
        }
        self.add_entries(is_plane);
        self.deck.notes.extend(self.account.notes());
        Ok(())
    }

    /// Whether the triangles and quadrilaterals of a file without solid cells are in plane strain.
    fn check_sheets(&mut self, elements: &[Raw], options: &MeshOptions) -> Result<()> {
        let [mut n_unknown, mut n_shells] = [0; 2];
        for element in elements.iter().filter(|element| element.kind.dimension() == 2) {
            match self.sheets.get(&element.property) {
                _ if element.card.starts_with("CPLSTN") => {}
                Some(Sheet::PlaneStrain) => {}
                Some(Sheet::Shell(_)) if options.plane_shells => n_shells += 1,
                Some(Sheet::Shell(card)) => {
                    let Raw { number, card: name, property, at, .. } = element;
                    let problem = format!(
                        "element {number} ({name}) is a shell with {card} {property}, and shells are not supported"
                    );
                    let advice = "mesh the body with solid cells; `shells = \"plane-strain\"` of `mesh` reads shells as cells in plane strain, without their thickness";
                    return Err(self.malformed(*at, problem, advice));
                }
                None => n_unknown += 1,
            }
        }
        if n_unknown > 0 {
            let [one, many] = ["element without PSHELL or PCOMP is", "elements without PSHELL or PCOMP are"];
            let elements = counted(n_unknown, one, many);
            self.deck.notes.insert(format!("{elements} read as cells in plane strain"));
        }
        if n_shells > 0 {
            let shells = counted(n_shells, "shell is", "shells are");
            self.deck
                .notes
                .insert(format!("{shells} read as cells in plane strain; their thickness is not read"));
        }
        Ok(())
    }

    /// Puts missing midside nodes of cells at the middle of their edges, one for all cells at an edge.
    fn fill_midsides(&mut self, elements: &mut [Raw], dimension: usize) -> Result<()> {
        let mut edges_of = HashMap::<&'static str, Vec<(usize, [usize; 2])>>::new();
        let mut known = HashMap::<[u64; 2], u64>::new();
        let has_gaps = elements
            .iter()
            .any(|element| element.kind.dimension() == dimension && element.nodes.contains(&0));
        for element in elements.iter().filter(|element| element.kind.dimension() == dimension) {
            let edges = edges_of.entry(element.kind.name()).or_insert_with(|| midsides(element.kind));
            let corners = &element.nodes[..element.kind.n_corners()];
            for &(local, [a, b]) in edges.iter() {
                let (node, ends) = (element.nodes[local], edge(corners[a], corners[b]));
                // The midside node of an edge that is collapsed may be its corner.
                if corners.contains(&node) && ends[0] != ends[1] {
                    let Raw { number, card, at, .. } = element;
                    let problem = format!(
                        "element {number} ({card}) names node {node} as a corner and as a midside node"
                    );
                    return Err(self.malformed(*at, problem, "leave midside nodes blank that do not exist"));
                }
                if has_gaps && node > 0 {
                    known.insert(ends, node);
                }
            }
        }
        if !has_gaps {
            return Ok(());
        }
        let mut made = HashSet::new();
        let mut number = 1;
        for element in elements.iter_mut().filter(|element| element.kind.dimension() == dimension) {
            let body = &mut self.deck.root;
            for &(local, [a, b]) in &edges_of[element.kind.name()] {
                let ends = edge(element.nodes[a], element.nodes[b]);
                // A corner without grid point is found later.
                let [Some(a), Some(b)] = ends.map(|end| body.nodes.get(&end).copied()) else { continue };
                if element.nodes[local] > 0 {
                    continue;
                }
                element.nodes[local] = *known.entry(ends).or_insert_with(|| {
                    while body.nodes.contains_key(&number) {
                        number += 1;
                    }
                    let [a, b] = [a, b].map(|index| body.points[index as usize]);
                    body.nodes.insert(number, body.points.len() as u32);
                    body.points.push([0, 1, 2].map(|i| a[i] / 2.0 + b[i] / 2.0));
                    made.insert(ends);
                    number
                });
            }
        }
        let nodes =
            counted(made.len(), "midside node was missing, and is", "midside nodes were missing, and are");
        let is_beside = |element: &&Raw| {
            element.kind.n_nodes() == element.kind.n_corners()
                && element.kind.facets().iter().any(|facet| {
                    let n = facet.kind.n_corners();
                    let end = |i: usize| element.nodes[facet.nodes[i % n]];
                    (0..n).any(|i| made.contains(&edge(end(i), end(i + 1))))
                })
        };
        let cells = elements.iter().filter(|element| element.kind.dimension() == dimension);
        let linear = match cells.filter(is_beside).count() {
            0 => String::new(),
            n => format!(
                "; {} at these edges, not joined to the new nodes",
                counted(n, "linear cell lies", "linear cells lie")
            ),
        };
        self.deck.notes.insert(format!("{nodes} put at the middle of the edge{linear}"));
        Ok(())
    }

    /// Groups of constrained grid points, with a note: nothing is fixed by them.
    fn name_constraints(&mut self, is_plane: bool) {
        let body = &mut self.deck.root;
        for (name, range) in &self.ranges {
            let set = |body: &mut Body, node| body.set_mut(Of::Nodes, name).push(None, node);
            if range.first == range.last {
                set(body, range.first);
                continue;
            }
            // Numbers of a longer one without a grid point are left out.
            let mut known: Vec<u64> =
                body.nodes.keys().copied().filter(|&node| range.contains(node)).collect();
            known.sort_unstable();
            known.into_iter().for_each(|node| set(body, node));
        }
        let mut names: BTreeSet<String> = body.node_sets.keys().cloned().collect();
        let default = self.defaults.as_ref().map_or("", |defaults| defaults.components.as_str());
        let mut counts = std::mem::take(&mut self.n_supports);
        for (grid, own) in self.grids.iter().zip(&self.constraints) {
            // A plane body does not move along z.
            let components = own.as_deref().unwrap_or(default);
            let components = if is_plane { components.trim_end_matches('3') } else { components };
            if !components.is_empty() {
                let name = format!("ps_{components}");
                body.set_mut(Of::Nodes, &name).push(None, grid.number);
                names.insert(name);
                *counts.entry("GRID".to_string()).or_default() += 1;
            }
        }
        let n = counts.values().sum();
        if n > 0 {
            let cards = counts.into_keys().collect::<Vec<_>>().join(", ");
            let [one, many] = [format!("constraint ({cards}) fixes"), format!("constraints ({cards}) fix")];
            let constraints = counted(n, &one, &many);
            let more = names.len().saturating_sub(MAX_NAMES);
            let more = if more > 0 { format!(" and {more} others") } else { String::new() };
            let names: Vec<String> = names.into_iter().take(MAX_NAMES).collect();
            let names = names.join(", ");
            self.deck
                .notes
                .insert(format!("{constraints} nothing without a `support`: groups {names}{more}"));
        }
    }
}

fn edge(a: u64, b: u64) -> [u64; 2] {
    [a.min(b), a.max(b)]
}

/// Faces of solid cells, or edges of plane ones, if the file has such elements.
fn facets(elements: &[Raw], dimension: usize) -> HashSet<Corners> {
    let has_some = elements.iter().any(|element| element.kind.dimension() + 1 == dimension);
    let cells = elements.iter().filter(|element| has_some && element.kind.dimension() == dimension);
    let of_cell = |element: &Raw| {
        let key = |nodes: &[usize]| corners(nodes.iter().map(|&local| element.nodes[local]));
        let facets = element.kind.facets().iter();
        facets.map(|facet| key(&facet.nodes[..facet.kind.n_corners()])).collect::<Vec<_>>()
    };
    cells.flat_map(of_cell).collect()
}
