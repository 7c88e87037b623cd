//! Nodes, elements and surfaces that cards name.

use std::collections::BTreeSet;

use emmy::mesh::Facet;

use super::super::super::body::{Body, LeftOut, Member, Of};
use super::{Maker, Owned};
use crate::vector::{Vector, minus, norm};

/// Contents of a surface.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    /// Its group in the input, if it has one of its own.
    pub(super) group: Option<String>,
    pub(super) facets: Vec<Facet>,
    /// All nodes, in ascending order.
    pub(super) nodes: Vec<u32>,
    /// Areas at these nodes, if the file has different ones.
    pub(super) weights: Option<Vec<f64>>,
}

impl Surface {
    pub(super) fn is_of_facets(&self) -> bool {
        !self.facets.is_empty()
    }
}

/// An element that is no cell: an instance and a place in [`Body::left_out`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lump {
    pub(super) instance: Option<u32>,
    pub(super) index: u32,
}

/// A number of Abaqus: an empty field is zero, and Fortran's `1.D0` is valid.
pub(super) fn real(field: &str) -> Option<f64> {
    if field.is_empty() {
        return Some(0.0);
    }
    let value: Option<f64> = field.parse().or_else(|_| field.replace(['d', 'D'], "e").parse()).ok();
    value.filter(|value| value.is_finite())
}

/// The numbers in some fields.
pub(super) fn reals(fields: &[String]) -> Option<Vec<f64>> {
    fields.iter().map(|field| real(field)).collect()
}

impl<'a> Maker<'a, '_> {
    pub(super) fn point(&self, node: u32) -> Vector {
        let starts = &self.assembly.starts;
        let place = starts.partition_point(|[first, _]| *first <= node).saturating_sub(1);
        let body = self.assembly.body(place.checked_sub(1).map(|index| index as u32));
        let point = body.points[(node - starts[place][0]) as usize];
        self.assembly.placements[place].place(point)
    }

    /// Instance that has a node.
    fn instance_of(&self, node: u32) -> Option<u32> {
        let place = self.assembly.starts.partition_point(|[first, _]| *first <= node).saturating_sub(1);
        place.checked_sub(1).map(|index| index as u32)
    }

    /// Number of a node, with its instance if there is one: `Arm-1.7`.
    pub(super) fn label(&self, node: u32) -> String {
        let number = self.numbers[node as usize];
        match self.instance_of(node) {
            Some(index) => format!("{}.{number}", self.assembly.deck.instances[index as usize].name),
            None => number.to_string(),
        }
    }

    /// Longest diagonal of the box around the nodes of cells.
    pub(super) fn diagonal(&self) -> f64 {
        let nodes = (0..self.has_cell.len() as u32).filter(|&node| self.has_cell[node as usize]);
        let [mut low, mut high] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for node in nodes {
            let point = self.point(node);
            low = [0, 1, 2].map(|i| low[i].min(point[i]));
            high = [0, 1, 2].map(|i| high[i].max(point[i]));
        }
        let length = norm(minus(high, low));
        if length.is_finite() { length } else { 0.0 }
    }

    /// Nodes of a set, or the node of a number, in the order of the file; empty if there is none.
    pub(super) fn nodes(&self, instance: Option<u32>, target: &str) -> Vec<u32> {
        let members = self.assembly.deck.members(self.assembly.body(instance), Of::Nodes, None, target);
        let members = members.unwrap_or_default();
        members.into_iter().flat_map(|member| self.assembly.indices(Of::Nodes, instance, member).0).collect()
    }

    /// The node of a number, or the only one of a set.
    pub(super) fn node(&self, instance: Option<u32>, target: &str) -> Option<u32> {
        match self.nodes(instance, target)[..] {
            [node] => Some(node),
            _ => None,
        }
    }

    /// The reference node of a card; Abaqus reads shorter names of parameters, too.
    pub(super) fn reference(&self, owned: Owned<'_>) -> Option<u32> {
        let names = ["REFNODE", "REFNOD", "REFNO", "REFN", "REF"];
        self.node(owned.instance, names.iter().find_map(|key| owned.value(key))?)
    }

    /// Members of an element set.
    fn members(&self, instance: Option<u32>, set: &str) -> Vec<Member> {
        let members = self.assembly.deck.members(self.assembly.body(instance), Of::Elements, None, set);
        members.unwrap_or_default().into_iter().map(|member| member.within(instance)).collect()
    }

    /// Elements of a set that are no cells, of types that begin with a name.
    pub(super) fn lumps(&self, owned: Owned<'_>, element_type: &str) -> Vec<Lump> {
        let mut lumps = Vec::new();
        for member in owned.value("ELSET").map(|set| self.members(owned.instance, set)).unwrap_or_default() {
            let body = self.assembly.body(member.instance);
            let mut indices = member.indices(&body.left_out_index).0;
            indices.sort_unstable();
            let lump = |index| Lump { instance: member.instance, index };
            lumps.extend(
                indices.into_iter().map(lump).filter(|&lump| self.type_of(lump).starts_with(element_type)),
            );
        }
        lumps
    }

    pub(super) fn element(&self, lump: Lump) -> &'a LeftOut {
        let body: &'a Body = self.assembly.body(lump.instance);
        &body.left_out[lump.index as usize]
    }

    pub(super) fn type_of(&self, lump: Lump) -> &'a str {
        let deck = self.assembly.deck;
        &deck.types[self.element(lump).element_type as usize]
    }

    /// Nodes of an element; `None` if the file lacks one of them.
    pub(super) fn nodes_of(&self, lump: Lump) -> Option<Vec<u32>> {
        let node =
            |member: &Member| self.assembly.indices(Of::Nodes, lump.instance, *member).0.first().copied();
        self.element(lump).nodes.iter().map(node).collect()
    }

    /// `12`, or `Arm-1.12`.
    pub(super) fn number_of(&self, lump: Lump) -> String {
        let number = self.element(lump).number;
        match lump.instance {
            Some(index) => format!("{}.{number}", self.assembly.deck.instances[index as usize].name),
            None => number.to_string(),
        }
    }

    /// Marks an element as told, and returns whether it was not yet.
    pub(super) fn tell(&mut self, lump: Lump) -> bool {
        self.told.insert((lump.instance, lump.index))
    }

    /// Leaves an element out, with the reason.
    pub(super) fn leave_out_lump(&mut self, lump: Lump, reason: &str) {
        if self.tell(lump) {
            let (element_type, which) = (self.type_of(lump), format!("element {}", self.number_of(lump)));
            self.report.leave_out(element_type, reason, which);
        }
    }

    /// Nodes of the elements in a set, and the group of its cells if it has nothing else.
    pub(super) fn nodes_of_set(&self, instance: Option<u32>, set: &str) -> (Vec<u32>, Option<String>) {
        let mut nodes = BTreeSet::new();
        let mut has_others = false;
        for member in self.members(instance, set) {
            let body = self.assembly.body(member.instance);
            let own = |node: &Member| self.assembly.indices(Of::Nodes, member.instance, *node).0;
            let cells = member.indices(&body.element_index).0;
            let lower = member.indices(&body.lower_index).0;
            let others = member.indices(&body.left_out_index).0;
            has_others |= !lower.is_empty() || !others.is_empty();
            let elements = cells.into_iter().map(|index| &body.elements[index as usize]);
            let elements = elements.chain(lower.into_iter().map(|index| &body.lower[index as usize]));
            for element in elements {
                nodes.extend(body.members_of(element).iter().flat_map(own));
            }
            for index in others {
                nodes.extend(body.left_out[index as usize].nodes.iter().flat_map(own));
            }
        }
        let group = self.group_of_set(instance, set).filter(|_| !has_others);
        (nodes.into_iter().collect(), group)
    }

    fn group_of_set(&self, instance: Option<u32>, set: &str) -> Option<String> {
        let (owner, name) = self.owner(instance, set, |body, name| body.element_sets.contains_key(name))?;
        let own = self.assembly.body(owner).element_sets.get(&name).filter(|set| !set.internal)?;
        self.assembly.group_names.of_cells(&self.qualified(owner, &own.name))
    }

    /// The group of a set of nodes.
    pub(super) fn group_of_nodes(&self, instance: Option<u32>, set: &str) -> Option<String> {
        let (owner, name) = self.owner(instance, set, |body, name| body.node_sets.contains_key(name))?;
        let own = self.assembly.body(owner).node_sets.get(&name).filter(|set| !set.internal)?;
        self.assembly.group_names.of_nodes(&self.qualified(owner, &own.name))
    }

    /// The instance that has what a card names, and its name in lower case without that of the instance.
    fn owner(
        &self,
        instance: Option<u32>,
        target: &str,
        has: impl Fn(&Body, &str) -> bool,
    ) -> Option<(Option<u32>, String)> {
        let own = target.to_lowercase();
        if has(self.assembly.body(instance), &own) {
            return Some((instance, own));
        }
        let (owner, name) = own.split_once('.')?;
        let owner = Some(self.assembly.deck.instance_index(owner)?);
        has(self.assembly.body(owner), name).then(|| (owner, name.to_string()))
    }

    fn qualified(&self, instance: Option<u32>, name: &str) -> String {
        self.assembly.deck.group_names(instance, name, true).swap_remove(0)
    }

    /// The surface of a name; `None`: there is none.
    pub(super) fn surface(&self, instance: Option<u32>, name: &str) -> Option<Surface> {
        let own = |key: &(Option<u32>, String)| self.assembly.surfaces.contains_key(key);
        let lower = name.to_lowercase();
        let in_instance = || {
            let (owner, name) = lower.split_once('.')?;
            Some((Some(self.assembly.deck.instance_index(owner)?), name.to_string()))
        };
        let key = Some((instance, lower.clone())).filter(own).or_else(|| in_instance().filter(own))?;
        let contents = self.assembly.surfaces.get(&key)?;
        let mut nodes: BTreeSet<u32> = contents.nodes.iter().copied().collect();
        contents.facets.iter().for_each(|&facet| nodes.extend(self.nodes_of_facet(facet)));
        let body = self.assembly.body(key.0);
        let places = self.surfaces_of.get(&key).map(Vec::as_slice).unwrap_or_default();
        let rows = places.iter().map(|&at| &body.surfaces[at]);
        let first = rows.clone().next()?;
        let group = self.qualified(key.0, &first.name);
        let names = &self.assembly.group_names;
        let is_of_facets = !contents.facets.is_empty();
        let group = if is_of_facets { names.of_facets(&group) } else { names.of_nodes(&group) };
        let mut areas = std::collections::BTreeMap::new();
        for row in rows.flat_map(|surface| &surface.rows).filter(|row| row.face.is_none()) {
            let area = row.area.as_deref().and_then(real).unwrap_or(1.0);
            let own = row.instance.or(key.0);
            areas.extend(self.nodes(own, &row.target).into_iter().map(|node| (node, area)));
        }
        let nodes: Vec<u32> = nodes.into_iter().collect();
        let weights: Option<Vec<f64>> = nodes.iter().map(|node| areas.get(node).copied()).collect();
        let differ = |weights: &Vec<f64>| weights.iter().any(|area| *area != weights[0]);
        Some(Surface {
            group: group.filter(|_| !first.internal),
            facets: contents.facets.clone(),
            nodes,
            weights: weights.filter(|_| !is_of_facets).filter(differ),
        })
    }

    fn nodes_of_facet(&self, facet: Facet) -> Vec<u32> {
        let at = self.cell_starts.partition_point(|(first, _)| *first <= facet.cell);
        let Some(&(first, instance)) = at.checked_sub(1).and_then(|at| self.cell_starts.get(at)) else {
            return Vec::new();
        };
        let body = self.assembly.body(instance);
        let Some(element) = body.elements.get((facet.cell - first) as usize) else { return Vec::new() };
        let nodes = self.assembly.node_indices(instance, element).unwrap_or_default();
        let local = element.kind.facets().get(usize::from(facet.local));
        local
            .map(|local| local.nodes.iter().filter_map(|&at| nodes.get(at).copied()).collect())
            .unwrap_or_default()
    }

    pub(super) fn is_of_cells(&self, node: u32) -> bool {
        self.has_cell[node as usize]
    }
}
