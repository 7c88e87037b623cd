//! The mesh of an input file: placed bodies, sets and surfaces as groups.

use std::collections::HashSet;
use std::path::Path;

use emmy::mesh::{Facet, MeshBuilder};

use super::super::{MeshError, MeshFile, Origin, Result, finished};
use super::body::{Body, Element, Member, Of, Row, Set, Surface};
use super::deck::Deck;
use super::element;
use super::placement::Placement;
use crate::message::counted;

/// The mesh of all instances and of everything outside of parts.
pub(in crate::mesh) fn mesh(file: &Path, deck: &Deck) -> Result<MeshFile> {
    let surfaces = deck.root.surfaces.iter().map(|surface| surface.name.to_lowercase()).collect();
    let bodies = std::iter::once(&deck.root).chain(deck.instances.iter().map(|instance| &instance.body));
    let mut elements = bodies.flat_map(|body| &body.elements);
    let is_plane = !elements.any(|element| element.kind.dimension() == 3);
    let mut assembly = Assembly {
        file,
        deck,
        builder: MeshBuilder::new(),
        starts: Vec::new(),
        n_nodes: 0,
        surfaces,
        is_plane,
    };
    let mut notes: Vec<String> = deck.notes.iter().cloned().collect();
    assembly.add_body(&deck.root, Placement::default())?;
    for instance in &deck.instances {
        assembly.add_body(&instance.body, instance.placement)?;
    }
    assembly.add_groups(None, &mut notes)?;
    for index in 0..deck.instances.len() {
        assembly.add_groups(Some(index as u32), &mut notes)?;
        assembly.add_instance_group(index);
    }
    let builder = assembly.builder;
    let starts = assembly.starts;
    let name = |cell: usize| element_name(deck, &starts, cell);
    let origin = Origin { file, n_nodes: assembly.n_nodes, name: &name };
    finished(builder, &origin, notes).map_err(|error| match error {
        MeshError::Mesh { reason: emmy::Error::EmptyMesh, .. } => no_cells(file, deck),
        MeshError::Mesh { reason: emmy::Error::FacetWithoutCell { group, nodes }, file } => {
            let nodes = nodes.iter().map(|&node| node_number(deck, &starts, node)).collect();
            MeshError::FacetWithoutCell { file, group, nodes }
        }
        error => error,
    })
}

/// `element 3`, or `element 3 of instance Arm-1`.
fn element_name(deck: &Deck, starts: &[[u32; 2]], cell: usize) -> String {
    let instances = deck.instances.iter().map(|instance| (&instance.body, Some(&instance.name)));
    for ((body, instance), [_, first]) in std::iter::once((&deck.root, None)).chain(instances).zip(starts) {
        let element = cell.checked_sub(*first as usize).and_then(|index| body.elements.get(index));
        match (element, instance) {
            (Some(element), Some(instance)) => {
                return format!("element {} of instance {instance}", element.number);
            }
            (Some(element), None) => return format!("element {}", element.number),
            _ => {}
        }
    }
    format!("cell {cell}")
}

/// Number in the file of a node of the mesh, in its own body.
fn node_number(deck: &Deck, starts: &[[u32; 2]], node: u32) -> u64 {
    let bodies = std::iter::once(&deck.root).chain(deck.instances.iter().map(|instance| &instance.body));
    let of_body = |(body, [first, _]): (&Body, &[u32; 2])| {
        let index = node.checked_sub(*first).filter(|&index| (index as usize) < body.points.len())?;
        body.nodes.iter().find(|(_, known)| **known == index).map(|(number, _)| *number)
    };
    bodies.zip(starts).find_map(of_body).unwrap_or(node.into())
}

fn no_cells(file: &Path, deck: &Deck) -> MeshError {
    let advice = match (deck.parts.is_empty(), deck.instances.is_empty()) {
        (false, true) => "it has parts but no *Instance of them: write the assembly too",
        _ => "the body must be in it as *Node and *Element lines",
    };
    MeshError::NoCells { file: file.to_path_buf(), advice }
}

/// Faces, by their corners, and nodes of edges of a set of elements.
#[derive(Debug, Default)]
struct Lower {
    faces: Vec<Vec<u32>>,
    nodes_of_edges: Vec<u32>,
}

impl Lower {
    fn is_empty(&self) -> bool {
        self.faces.is_empty() && self.nodes_of_edges.is_empty()
    }
}

struct Assembly<'a> {
    file: &'a Path,
    deck: &'a Deck,
    builder: MeshBuilder,
    /// First node and first cell of the root and of each instance.
    starts: Vec<[u32; 2]>,
    n_nodes: usize,
    /// Names of the surfaces of the assembly in lower case.
    surfaces: HashSet<String>,
    /// Whether no cell is solid: facets are edges.
    is_plane: bool,
}

impl<'a> Assembly<'a> {
    fn add_body(&mut self, body: &Body, placement: Placement) -> Result<()> {
        let first_node = self.n_nodes as u32;
        for &point in &body.points {
            self.builder.point(placement.place(point));
        }
        self.n_nodes += body.points.len();
        let mut first_cell = None;
        for element in &body.elements {
            let nodes = self.node_indices(body, element, body.nodes_of(element), first_node)?;
            let cell = self.builder.cell(element.kind, &nodes);
            let cell = cell.map_err(|reason| MeshError::Mesh { file: self.file.to_path_buf(), reason })?;
            first_cell.get_or_insert(cell);
        }
        self.starts.push([first_node, first_cell.unwrap_or(0)]);
        Ok(())
    }

    fn body(&self, instance: Option<u32>) -> &'a Body {
        instance.map_or(&self.deck.root, |index| &self.deck.instances[index as usize].body)
    }

    fn start(&self, instance: Option<u32>, of: Of) -> u32 {
        let [node, cell] = self.starts[instance.map_or(0, |index| index as usize + 1)];
        if of == Of::Nodes { node } else { cell }
    }

    fn add_groups(&mut self, instance: Option<u32>, notes: &mut Vec<String>) -> Result<()> {
        let body = self.body(instance);
        for of in [Of::Nodes, Of::Elements] {
            for (key, set) in body.sets(of).iter().filter(|(_, set)| !set.internal) {
                let is_taken = self.deck.root.sets(of).contains_key(key);
                self.add_set(of, instance, set, is_taken, notes)?;
            }
        }
        for surface in body.surfaces.iter().filter(|surface| !surface.internal) {
            self.add_surface(instance, surface)?;
        }
        Ok(())
    }

    /// Names of a group: in an instance `Instance.Set`, and also `Set` unless the assembly has a set of that name.
    fn names(&self, instance: Option<u32>, name: &str, is_taken: bool) -> Vec<String> {
        match instance {
            None => vec![name.to_string()],
            Some(index) => {
                let qualified = format!("{}.{name}", self.deck.instances[index as usize].name);
                if is_taken { vec![qualified] } else { vec![qualified, name.to_string()] }
            }
        }
    }

    fn add_set(
        &mut self,
        of: Of,
        instance: Option<u32>,
        set: &Set,
        is_taken: bool,
        notes: &mut Vec<String>,
    ) -> Result<()> {
        let mut indices = Vec::new();
        let mut lower = Lower::default();
        let mut n_missing = 0_u64;
        for &member in &set.members {
            let (found, missing) = self.indices(of, instance, member);
            indices.extend(found);
            let n_lower = if of == Of::Elements { self.add_lower(instance, member, &mut lower)? } else { 0 };
            n_missing = n_missing.saturating_add(missing - n_lower);
        }
        let names = self.names(instance, &set.name, is_taken);
        if n_missing > 0 {
            let [one, what, many] = match of {
                Of::Nodes => ["node", "node", "nodes"],
                Of::Elements => ["element", "element", "elements"],
            };
            let missing = counted(n_missing as usize, one, many);
            notes.push(format!("{what} set \"{}\" names {missing} that the file does not have", names[0]));
        }
        for name in names {
            match of {
                Of::Nodes => self.builder.node_group(&name, indices.iter().copied()),
                Of::Elements => {
                    if !indices.is_empty() || lower.is_empty() {
                        self.builder.cell_group(&name, indices.iter().copied());
                    }
                    if !lower.faces.is_empty() {
                        self.builder.facet_group_by_nodes(&name, lower.faces.clone());
                    }
                    if !lower.nodes_of_edges.is_empty() {
                        self.builder.node_group(&name, lower.nodes_of_edges.iter().copied());
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds the faces and edges of a member of a set, and returns their number.
    fn add_lower(&self, instance: Option<u32>, member: Member, lower: &mut Lower) -> Result<u64> {
        let instance = member.instance.or(instance);
        let body = self.body(instance);
        let (found, _) = member.indices(&body.lower_index);
        for &index in &found {
            let element = &body.lower[index as usize];
            let is_facet = self.is_plane || element.kind.dimension() == 2;
            let count = if is_facet { element.kind.n_corners() } else { element.n_nodes };
            let nodes = &body.nodes_of(element)[..count];
            let nodes = self.node_indices(body, element, nodes, self.start(instance, Of::Nodes))?;
            match is_facet {
                true => lower.faces.push(nodes),
                false => lower.nodes_of_edges.extend(nodes),
            }
        }
        Ok(found.len() as u64)
    }

    /// Indices in the mesh of nodes of an element.
    fn node_indices(&self, body: &Body, element: &Element, nodes: &[u64], first: u32) -> Result<Vec<u32>> {
        let index = |&node: &u64| {
            let place = || self.deck.place(element.at);
            let unknown = || MeshError::UnknownNode { place: place(), element: element.number, node };
            body.nodes.get(&node).map(|index| first + index).ok_or_else(unknown)
        };
        nodes.iter().map(index).collect()
    }

    /// Indices in the mesh of a member of a set of a body, and the number of missing ones.
    fn indices(&self, of: Of, instance: Option<u32>, member: Member) -> (Vec<u32>, u64) {
        let instance = member.instance.or(instance);
        let (mut indices, missing) = member.indices(self.body(instance).index(of));
        indices.iter_mut().for_each(|index| *index += self.start(instance, of));
        (indices, missing)
    }

    fn add_surface(&mut self, instance: Option<u32>, surface: &Surface) -> Result<()> {
        let is_taken = self.surfaces.contains(&surface.name.to_lowercase());
        let names = self.names(instance, &surface.name, is_taken);
        for row in &surface.rows {
            for member in self.row_members(instance, row)? {
                let of = if row.face.is_some() { Of::Elements } else { Of::Nodes };
                let (indices, missing) = self.indices(of, instance, member);
                if missing > 0 && indices.is_empty() {
                    return Err(self.deck.unknown_set(row.at, of, &row.target));
                }
                for name in &names {
                    self.add_row(name, member.instance.or(instance), row, &indices)?;
                }
            }
        }
        Ok(())
    }

    fn row_members(&self, instance: Option<u32>, row: &Row) -> Result<Vec<Member>> {
        let of = if row.face.is_some() { Of::Elements } else { Of::Nodes };
        let members = self.deck.members(self.body(instance), of, row.instance, &row.target);
        members.ok_or_else(|| self.deck.unknown_set(row.at, of, &row.target))
    }

    fn add_row(&mut self, name: &str, instance: Option<u32>, row: &Row, indices: &[u32]) -> Result<()> {
        let Some(face) = row.face else {
            self.builder.node_group(name, indices.iter().copied());
            return Ok(());
        };
        let first = self.start(instance, Of::Elements);
        let elements = &self.body(instance).elements;
        let facet = |&cell: &u32| {
            let element = elements[(cell - first) as usize];
            let problem = || format!("element {} ({}) has no face S{face}", element.number, element.kind);
            let missing = || self.deck.malformed(row.at, problem(), "correct the face of the surface");
            let local = element::local_facet(element.kind, face).ok_or_else(missing)?;
            Ok(Facet { cell, local })
        };
        let facets = indices.iter().map(facet).collect::<Result<Vec<Facet>>>()?;
        self.builder.facet_group(name, facets);
        Ok(())
    }

    /// All cells of an instance, under its name.
    fn add_instance_group(&mut self, index: usize) {
        let deck = self.deck;
        let instance = &deck.instances[index];
        let is_taken = deck.root.element_sets.contains_key(&instance.name.to_lowercase());
        if !is_taken && !instance.body.elements.is_empty() {
            let first = self.start(Some(index as u32), Of::Elements);
            self.builder.cell_group(&instance.name, first..first + instance.body.elements.len() as u32);
        }
    }
}
