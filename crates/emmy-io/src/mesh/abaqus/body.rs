//! Contents of a part, an instance or the assembly.

use std::collections::{BTreeMap, HashMap, HashSet};

use emmy::mesh::CellKind;

use super::keyword::Keyword;

/// Line of one of the files of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) struct At {
    pub(in crate::mesh) file: u32,
    pub(in crate::mesh) line: u32,
}

/// Nodes, elements, sets and surfaces with the numbers and names of the file.
#[derive(Debug, Clone, Default)]
pub(in crate::mesh) struct Body {
    pub(in crate::mesh) points: Vec<[f64; 3]>,
    pub(in crate::mesh) nodes: HashMap<u64, u32>,
    pub(in crate::mesh) elements: Vec<Element>,
    pub(in crate::mesh) element_index: HashMap<u64, u32>,
    /// Faces and edges of cells that are listed as elements.
    pub(in crate::mesh) lower: Vec<Element>,
    pub(in crate::mesh) lower_index: HashMap<u64, u32>,
    /// Elements that are left out: masses, springs, beams, ...
    pub(super) left_out: Vec<LeftOut>,
    pub(super) left_out_index: HashMap<u64, u32>,
    pub(in crate::mesh) connectivity: Vec<u64>,
    /// Nodes of the links that have nodes of instances, by the starts of these elements in the connectivity.
    pub(super) joined: HashMap<usize, Vec<Member>>,
    pub(in crate::mesh) node_sets: Sets,
    pub(in crate::mesh) element_sets: Sets,
    pub(in crate::mesh) surfaces: Vec<Surface>,
    /// Constraints, masses, springs and connectors.
    pub(super) cards: Vec<Card>,
}

/// A keyword with its data lines, which are understood when all nodes, sets and surfaces are known.
#[derive(Debug, Clone)]
pub(super) struct Card {
    pub(super) keyword: Keyword,
    pub(super) at: At,
    /// Fields of the lines that are not blank.
    pub(super) lines: Vec<(At, Vec<String>)>,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct Element {
    pub(in crate::mesh) number: u64,
    pub(in crate::mesh) kind: CellKind,
    /// Nodes; a line of three nodes is an edge of kind line2.
    pub(in crate::mesh) n_nodes: usize,
    /// Start of the nodes in the connectivity.
    pub(in crate::mesh) nodes: usize,
    /// Index in [`Deck::types`](super::Deck), if the format has types.
    pub(in crate::mesh) element_type: Option<u32>,
    pub(in crate::mesh) at: At,
}

/// An element that is left out; its nodes count for the sets it belongs to.
#[derive(Debug, Clone)]
pub(super) struct LeftOut {
    /// Index in [`Deck::types`](super::Deck).
    pub(super) element_type: u32,
    pub(super) number: u64,
    pub(super) nodes: Vec<Member>,
}

/// An instance of a part; its body is a copy of the part's with its own additions.
#[derive(Debug, Clone)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) body: Body,
    pub(super) placement: super::placement::Placement,
}

/// Kind of members of a set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) enum Of {
    Nodes,
    Elements,
}

/// Sets by their names in lower case.
pub(in crate::mesh) type Sets = BTreeMap<String, Set>;

#[derive(Debug, Clone, Default)]
pub(in crate::mesh) struct Set {
    /// The name in its first spelling.
    pub(super) name: String,
    /// Made by Abaqus/CAE for its own use.
    pub(super) internal: bool,
    pub(super) members: Vec<Member>,
}

/// Numbers `first, first + step, ...` up to `last`, of this body or of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::mesh) struct Member {
    pub(super) instance: Option<u32>,
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) step: u64,
}

#[derive(Debug, Clone)]
pub(in crate::mesh) struct Surface {
    pub(super) name: String,
    pub(super) internal: bool,
    pub(super) of: Of,
    /// How it is made of the surfaces that its rows name.
    pub(super) combine: Option<Combine>,
    pub(super) rows: Vec<Row>,
}

/// Operation on surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) enum Combine {
    Union,
    Intersection,
    Difference,
}

/// Faces of the elements in a row of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) enum Face {
    /// `S1` ... `S6`.
    Number(u8),
    /// No label: faces that no second cell has.
    Free,
    /// `SPOS` or `SNEG`: the elements themselves, which are faces of cells.
    Own,
    /// `E1`, `END1`, ...: an edge of a shell or an end of a beam.
    Edge,
}

/// A line of a surface, resolved when all sets are known.
#[derive(Debug, Clone)]
pub(in crate::mesh) struct Row {
    /// Name of a set or of a surface, or a number; empty for all elements.
    pub(super) target: String,
    /// None for a surface of nodes or of surfaces.
    pub(super) face: Option<Face>,
    /// The instance named by the surface.
    pub(super) instance: Option<u32>,
    /// Area at each node of a surface of nodes, in the words of the file.
    pub(super) area: Option<String>,
    pub(super) at: At,
}

impl Body {
    pub(super) fn sets(&self, of: Of) -> &Sets {
        match of {
            Of::Nodes => &self.node_sets,
            Of::Elements => &self.element_sets,
        }
    }

    /// Number of nodes, elements and members of sets and surfaces: the cost of a copy.
    pub(super) fn size(&self) -> usize {
        let sets = self.node_sets.values().chain(self.element_sets.values());
        let members: usize = sets.map(|set| set.members.len()).sum();
        let rows: usize = self.surfaces.iter().map(|surface| surface.rows.len()).sum();
        let n_elements = self.elements.len() + self.lower.len() + self.left_out.len();
        let lines: usize = self.cards.iter().map(|card| 1 + card.lines.len()).sum();
        self.points.len() + n_elements + members + rows + lines
    }

    /// The set of a name, created if it is new.
    pub(in crate::mesh) fn set_mut(&mut self, of: Of, name: &str) -> &mut Set {
        let sets = match of {
            Of::Nodes => &mut self.node_sets,
            Of::Elements => &mut self.element_sets,
        };
        let new = || Set { name: name.to_string(), ..Set::default() };
        sets.entry(name.to_lowercase()).or_insert_with(new)
    }

    /// Indices by number, of nodes or elements.
    pub(super) fn index(&self, of: Of) -> &HashMap<u64, u32> {
        match of {
            Of::Nodes => &self.nodes,
            Of::Elements => &self.element_index,
        }
    }

    /// Whether an element has a number.
    pub(super) fn has_element(&self, number: u64) -> bool {
        [&self.element_index, &self.lower_index, &self.left_out_index]
            .iter()
            .any(|index| index.contains_key(&number))
    }

    /// Removes all lines but the links from the elements: some types become edges of cells, the others are left out.
    pub(super) fn lower_lines(&mut self, links: &HashSet<u32>, are_edges: &[bool]) {
        for (element, index) in std::mem::take(&mut self.elements).into_iter().zip(0..) {
            match element.element_type {
                Some(element_type) if element.kind == CellKind::Line2 && !links.contains(&index) => {
                    if are_edges[element_type as usize] && !self.joined.contains_key(&element.nodes) {
                        self.lower.push(element);
                        continue;
                    }
                    let nodes = self.members_of(&element);
                    self.left_out_index.insert(element.number, self.left_out.len() as u32);
                    self.left_out.push(LeftOut { element_type, number: element.number, nodes });
                }
                _ => self.elements.push(element),
            }
        }
        self.element_index = index(&self.elements);
        self.lower_index = index(&self.lower);
    }

    /// Turns the surface elements that are listed as faces into cells.
    pub(super) fn raise_shells(&mut self) {
        let (shells, others): (Vec<Element>, _) =
            self.lower.drain(..).partition(|element| element.kind.dimension() == 2);
        self.elements.extend(shells);
        self.lower = others;
        self.element_index = index(&self.elements);
        self.lower_index = index(&self.lower);
    }

    pub(super) fn nodes_of(&self, element: &Element) -> &[u64] {
        &self.connectivity[element.nodes..][..element.n_nodes]
    }

    /// The nodes of an element, of this body or of instances.
    pub(super) fn members_of(&self, element: &Element) -> Vec<Member> {
        let own = || self.nodes_of(element).iter().map(|&node| Member::one(None, node)).collect();
        self.joined.get(&element.nodes).cloned().unwrap_or_else(own)
    }
}

fn index(elements: &[Element]) -> HashMap<u64, u32> {
    elements.iter().map(|element| element.number).zip(0..).collect()
}

impl Set {
    /// Adds a number; a run of consecutive numbers is kept as one member.
    pub(in crate::mesh) fn push(&mut self, instance: Option<u32>, number: u64) {
        match self.members.last_mut() {
            Some(run)
                if run.instance == instance && run.step == 1 && run.last.checked_add(1) == Some(number) =>
            {
                run.last = number;
            }
            _ => self.members.push(Member::one(instance, number)),
        }
    }

    /// Adds the members of another set. Repetitions are dropped; otherwise sets of sets could grow without bound.
    pub(super) fn extend(&mut self, members: Vec<Member>) {
        self.members.extend(members);
        self.members.sort_unstable();
        self.members.dedup();
    }
}

impl Member {
    /// All numbers.
    pub(super) fn all(instance: Option<u32>) -> Self {
        Member { instance, first: 0, last: u64::MAX, step: 1 }
    }

    pub(super) fn one(instance: Option<u32>, number: u64) -> Self {
        Member { instance, first: number, last: number, step: 1 }
    }

    /// The same member; of this instance if it names none.
    pub(super) fn within(self, instance: Option<u32>) -> Self {
        Member { instance: self.instance.or(instance), ..self }
    }

    /// Indices of the numbers, and the count of unknown numbers.
    pub(super) fn indices(&self, index: &HashMap<u64, u32>) -> (Vec<u32>, u64) {
        let count = (self.last - self.first) / self.step; // one less, so that it cannot overflow
        let found: Vec<u32> = if count <= index.len() as u64 {
            (0..=count).filter_map(|i| index.get(&(self.first + i * self.step)).copied()).collect()
        } else {
            index.iter().filter(|(number, _)| self.contains(**number)).map(|(_, &index)| index).collect()
        };
        let missing = count.saturating_add(1) - found.len() as u64;
        (found, missing)
    }

    fn contains(&self, number: u64) -> bool {
        (self.first..=self.last).contains(&number) && (number - self.first).is_multiple_of(self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_without_bound_costs_no_more_than_the_nodes() {
        let index = HashMap::from([(1, 0), (3, 1), (4, 2)]);
        let range = Member { instance: None, first: 1, last: u64::MAX, step: 2 };
        let (mut found, missing) = range.indices(&index);
        found.sort();
        assert_eq!(found, [0, 1]);
        assert_eq!(missing, u64::MAX / 2 + 1 - 2);
    }

    #[test]
    fn runs_are_one_member() {
        let mut set = Set::default();
        [5, 6, 7, 9].into_iter().for_each(|number| set.push(None, number));
        assert_eq!(set.members.len(), 2);
    }
}
