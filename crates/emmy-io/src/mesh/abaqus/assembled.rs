//! The mesh of an input file: placed bodies, sets and surfaces as groups.

mod entries;
mod groups;
mod surfaces;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;

use emmy::mesh::{CellKind, Facet, MeshBuilder};

use self::groups::GroupNames;
use self::surfaces::Contents;
use super::super::account::Account;
use super::super::plane::Surfaces;
use super::super::{MeshError, MeshFile, Origin, Result, finished};
use super::body::{Body, Element, Face, Member, Of, Row, Set};
use super::deck::Deck;
use super::element;
use super::faces::Faces;
use super::placement::Placement;
use crate::message::counted;

/// The mesh of all instances and of everything outside of parts.
pub(in crate::mesh) fn mesh(file: &Path, deck: &Deck) -> Result<MeshFile> {
    if deck.is_of_shells() {
        return Err(no_cells(file, deck));
    }
    let mut elements = deck.bodies().flat_map(|body| &body.elements);
    let solid = elements.clone().find(|element| element.kind.dimension() == 3);
    if let (Some(solid), Some(plane)) = (solid, elements.find(|element| element.kind.dimension() == 2)) {
        let problem = format!(
            "element {} ({}) is a cell in plane strain beside solid cells, such as element {} ({})",
            plane.number,
            deck.type_of(plane),
            solid.number,
            deck.type_of(solid)
        );
        let advice = "write the two bodies to files of their own; elements on the faces of solid cells are CPS4, M3D4 or S4";
        return Err(deck.malformed(plane.at, problem, advice));
    }
    let mut assembly = Assembly {
        file,
        deck,
        builder: MeshBuilder::new(),
        group_names: GroupNames::new(has_cards(deck)),
        starts: Vec::new(),
        placements: placements(deck).collect(),
        n_nodes: 0,
        root_surfaces: deck.root.surfaces.iter().map(|surface| surface.name.to_lowercase()).collect(),
        is_plane: solid.is_none(),
        faces: None,
        surfaces: HashMap::new(),
    };
    let mut notes: Vec<String> = deck.notes.iter().cloned().collect();
    deck.bodies().zip(placements(deck)).for_each(|(body, placement)| assembly.add_nodes(body, placement));
    deck.numbers().try_for_each(|own| assembly.add_cells(own))?;
    assembly.find_faces()?;
    let mut account = deck.account.clone();
    let mut on_groups = Vec::new();
    assembly.find_surfaces(&mut on_groups)?;
    assembly.add_groups(None, &mut on_groups);
    for index in 0..deck.instances.len() {
        assembly.add_groups(Some(index as u32), &mut on_groups);
        assembly.add_instance_group(index);
    }
    let made = assembly.entries(&mut account);
    notes.extend(assembly.account_for_elements(&mut account, &made.told));
    notes.extend(account.notes());
    notes.extend(on_groups);
    notes.extend(made.notes.iter().cloned());
    assembly.faces = None;
    let builder = assembly.builder;
    let starts = assembly.starts;
    let name = |cell: usize| element_name(deck, &starts, cell);
    let origin = Origin { file, n_nodes: assembly.n_nodes - made.n_points, name: &name };
    let finished = finished(builder, &origin, notes);
    let with_entries = |file: MeshFile| {
        let notes = file.notes.into_iter().filter_map(|note| made.on_group(note)).collect();
        MeshFile { entries: made.entries.clone(), notes, ..file }
    };
    finished.map(with_entries).map_err(|error| match error {
        MeshError::Mesh { reason: emmy::Error::EmptyMesh, .. } => no_cells(file, deck),
        MeshError::Mesh { reason: emmy::Error::NotInPlane { node, z, plane }, .. } => {
            let node = node_name(deck, &starts, node as u32);
            surfaces(deck).error(file, &node, [z, plane], [TURN, SURFACES_ALONE])
        }
        error => error,
    })
}

/// Whether some of the keywords may become entries.
fn has_cards(deck: &Deck) -> bool {
    deck.bodies().any(|body| !body.cards.is_empty())
}

const TURN: &str = "all of them lie in another plane: turn the mesh into the x-y plane";

const SURFACES_ALONE: &str = "a body in plane strain lies in the x-y plane; mesh any other with solid cells";

/// The placements of [`Deck::bodies`].
fn placements(deck: &Deck) -> impl Iterator<Item = Placement> {
    let placements = deck.instances.iter().map(|instance| instance.placement);
    std::iter::once(Placement::default()).chain(placements)
}

/// The surface elements among the cells.
fn surfaces(deck: &Deck) -> Surfaces {
    let mut surfaces = Surfaces::default();
    for (body, placement) in deck.bodies().zip(placements(deck)) {
        for element in body.elements.iter().filter(|element| element.kind.dimension() == 2) {
            surfaces.has[usize::from(element.kind.n_corners() == 4)] = true;
            let indices = body.nodes_of(element).iter().filter_map(|node| body.nodes.get(node));
            surfaces.points.extend(indices.map(|&index| placement.place(body.points[index as usize])));
        }
    }
    surfaces
}

/// `node 3`, or `node 3 of instance Arm-1`.
fn node_name(deck: &Deck, starts: &[[u32; 2]], node: u32) -> String {
    let names = deck.instances.iter().map(|instance| format!(" of instance {}", instance.name));
    let bodies = deck.bodies().zip(starts).zip(std::iter::once(String::new()).chain(names));
    let own = bodies.filter(|((_, [first, _]), _)| *first <= node).last();
    let number = own.and_then(|((body, [first, _]), instance)| {
        let (number, _) = body.nodes.iter().find(|(_, index)| **index == node - first)?;
        Some(format!("node {number}{instance}"))
    });
    number.unwrap_or_else(|| format!("node {node}"))
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

/// The error for a file without cells; it lists the elements that are there, if their types are known.
fn no_cells(file: &Path, deck: &Deck) -> MeshError {
    let mut others = Account::default();
    for body in deck.bodies() {
        body.lower.iter().for_each(|element| others.leave_out(deck.type_of(element)));
        body.left_out.iter().for_each(|element| others.leave_out(&deck.types[element.element_type as usize]));
    }
    let has_parts_alone = !deck.parts.is_empty() && deck.instances.is_empty();
    if let Some(found) = others.left_out().filter(|_| !has_parts_alone && !deck.types.is_empty()) {
        let shells = match deck.is_of_shells() {
            true => {
                "shells, membranes and plane stress are not supported (`shells = \"plane-strain\"` in [mesh] makes them \
                 cells in plane strain, without their thickness); "
            }
            false => "",
        };
        let advice = format!("{shells}make the body of {}", element::supported());
        return MeshError::NothingSolid { file: file.to_path_buf(), found, advice };
    }
    let advice = match has_parts_alone {
        true => "it has parts but no *Instance of them: write the assembly too",
        false => "the body must be in it as *Node and *Element lines",
    };
    MeshError::NoCells { file: file.to_path_buf(), advice }
}

/// Indices in the mesh of those nodes of an element that the file defines.
fn known_nodes(body: &Body, element: &Element, first_node: u32) -> Vec<u32> {
    let known = body.nodes_of(element).iter().filter_map(|node| body.nodes.get(node));
    known.map(|index| first_node + index).collect()
}

/// The use of lines of two nodes that are no links.
const LINES: &str =
    "edges of the cells beside them, not as links: no region with a material for links has their group";

/// The elements of a set that are no cells.
#[derive(Debug, Default)]
struct Others {
    facets: Vec<Facet>,
    nodes_of_edges: Vec<u32>,
    /// Number of elements that are left out, and their nodes.
    n_left_out: u64,
    nodes: Vec<u32>,
}

/// Elements that became entries, or that a note names, by their instances and their places in
/// [`Body::left_out`].
type Told = HashSet<(Option<u32>, u32)>;

/// An instance (`None`: outside of all instances), and a name in lower case.
type Key = (Option<u32>, String);

/// Place of a body in [`Deck::bodies`].
fn index_of_body(instance: Option<u32>) -> usize {
    instance.map_or(0, |index| index as usize + 1)
}

struct Assembly<'a> {
    file: &'a Path,
    deck: &'a Deck,
    builder: MeshBuilder,
    group_names: GroupNames,
    /// First node and first cell of the root and of each instance.
    starts: Vec<[u32; 2]>,
    placements: Vec<Placement>,
    n_nodes: usize,
    /// Names of the surfaces of the assembly in lower case.
    root_surfaces: HashSet<String>,
    /// Whether no cell is solid: facets are edges.
    is_plane: bool,
    /// Faces of all cells, if something asks for them.
    faces: Option<Faces>,
    surfaces: HashMap<Key, Contents>,
}

impl<'a> Assembly<'a> {
    fn add_nodes(&mut self, body: &Body, placement: Placement) {
        for &point in &body.points {
            self.builder.point(placement.place(point));
        }
        self.starts.push([self.n_nodes as u32, 0]);
        self.n_nodes += body.points.len();
    }

    fn add_cells(&mut self, instance: Option<u32>) -> Result<()> {
        let mut first_cell = None;
        for element in &self.body(instance).elements {
            let nodes = self.node_indices(instance, element)?;
            let cell = self.builder.cell(element.kind, &nodes);
            let cell = cell.map_err(|reason| MeshError::Mesh { file: self.file.to_path_buf(), reason })?;
            first_cell.get_or_insert(cell);
        }
        self.starts[index_of_body(instance)][1] = first_cell.unwrap_or(0);
        Ok(())
    }

    fn body(&self, instance: Option<u32>) -> &'a Body {
        instance.map_or(&self.deck.root, |index| &self.deck.instances[index as usize].body)
    }

    fn start(&self, instance: Option<u32>, of: Of) -> u32 {
        let [node, cell] = self.starts[index_of_body(instance)];
        if of == Of::Nodes { node } else { cell }
    }

    fn add_groups(&mut self, instance: Option<u32>, notes: &mut Vec<String>) {
        let body = self.body(instance);
        for of in [Of::Nodes, Of::Elements] {
            for (key, set) in body.sets(of).iter().filter(|(_, set)| !set.internal) {
                let is_taken = self.deck.root.sets(of).contains_key(key);
                self.add_set(of, instance, set, is_taken, notes);
            }
        }
        for surface in body.surfaces.iter().filter(|surface| !surface.internal) {
            self.add_surface(instance, surface);
        }
    }

    fn add_set(&mut self, of: Of, instance: Option<u32>, set: &Set, is_taken: bool, notes: &mut Vec<String>) {
        let mut indices = Vec::new();
        let mut others = Others::default();
        let mut n_missing = 0_u64;
        for &member in &set.members {
            let (found, missing) = self.indices(of, instance, member);
            indices.extend(found);
            let n_others =
                if of == Of::Elements { self.add_others(instance, member, &mut others) } else { 0 };
            n_missing = n_missing.saturating_add(missing - n_others);
        }
        let names = self.deck.group_names(instance, &set.name, is_taken);
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
                Of::Nodes => self.node_group(&name, indices.iter().copied()),
                Of::Elements => {
                    let has_facets = !others.facets.is_empty();
                    let has_edges = !others.nodes_of_edges.is_empty();
                    let is_of_left_out = indices.is_empty() && !has_facets && others.n_left_out > 0;
                    if !indices.is_empty() || !(has_facets || has_edges || is_of_left_out) {
                        self.cell_group(&name, indices.iter().copied());
                    }
                    if has_facets {
                        self.facet_group(&name, others.facets.iter().copied());
                    }
                    if has_edges {
                        self.node_group(&name, others.nodes_of_edges.iter().copied());
                    }
                    // With cells or facets, nodes of the same name would make it ambiguous.
                    if is_of_left_out {
                        self.node_group(&name, others.nodes.iter().copied());
                    }
                }
            }
        }
    }

    /// Whether elements of a kind are facets of the body's cells.
    fn are_facets(&self, kind: CellKind) -> bool {
        kind.dimension() + 1 == if self.is_plane { 2 } else { 3 }
    }

    /// Finds the faces of all cells, if a surface element or a surface asks for them.
    fn find_faces(&mut self) -> Result<()> {
        let deck = self.deck;
        let is_free = |row: &Row| row.face == Some(Face::Free);
        let asks = |body: &Body| {
            let mut surfaces = body.surfaces.iter();
            !body.lower.is_empty()
                || surfaces.any(|surface| surface.rows.is_empty() || surface.rows.iter().any(is_free))
        };
        if !deck.bodies().any(asks) {
            return Ok(());
        }
        let mut faces = Faces::default();
        for instance in deck.numbers() {
            let first_cell = self.start(instance, Of::Elements);
            for (element, cell) in self.body(instance).elements.iter().zip(first_cell..) {
                faces.add(cell, element.kind, &self.node_indices(instance, element)?);
            }
        }
        self.faces = Some(faces);
        Ok(())
    }

    /// The facet that a surface element is, if it is one.
    fn facet(&self, body: &Body, element: &Element, first_node: u32) -> Option<Facet> {
        let nodes = known_nodes(body, element, first_node);
        let faces = self.faces.as_ref().filter(|_| nodes.len() == element.n_nodes)?;
        match nodes[..] {
            [a, b, c] if element.kind == CellKind::Line2 => faces.edge([a, b, c]),
            _ => faces.facet(&nodes[..element.kind.n_corners()]),
        }
    }

    /// Counts the elements that are left out by their types, and notes which types are read as faces, edges or links.
    fn account_for_elements(&self, account: &mut Account, told: &Told) -> Vec<String> {
        let mut read = BTreeMap::<&str, &str>::new();
        let mut links = BTreeSet::<&str>::new();
        let edges = self.edges_at_lines();
        for ((body, instance), &[first_node, _]) in
            self.deck.bodies().zip(self.deck.numbers()).zip(&self.starts)
        {
            let lines = body.elements.iter().filter(|element| element.kind == CellKind::Line2);
            let named = lines.filter(|element| element.element_type.is_some());
            links.extend(named.map(|element| self.deck.type_of(element)));
            for element in &body.lower {
                let name = self.deck.type_of(element);
                let is_named = element.element_type.is_some();
                let nodes = known_nodes(body, element, first_node);
                let is_whole = nodes.len() == element.n_nodes;
                let is_edge = || nodes.iter().any(|&a| nodes.iter().any(|&b| edges.contains(&[a, b])));
                match self.are_facets(element.kind) {
                    _ if !is_whole => account.leave_out(name),
                    true if self.facet(body, element, first_node).is_none() => account.leave_out(name),
                    false if element.kind.dimension() > 1 => account.leave_out(name),
                    _ if !is_named => {}
                    false if !is_edge() => account.leave_out(name),
                    _ if element.kind.dimension() > 1 => {
                        _ = read.insert(name, "faces of the solid cells beside them")
                    }
                    _ if element.n_nodes > 2 => _ = read.insert(name, "edges of the cells beside them"),
                    _ => _ = read.insert(name, LINES),
                }
            }
            let others =
                body.left_out.iter().zip(0..).filter(|(_, index)| !told.contains(&(instance, *index)));
            for (element, _) in others {
                account.leave_out(&self.deck.types[element.element_type as usize]);
            }
        }
        let note = |(name, parts)| format!("elements of type {name} are read as {parts}");
        let links = links.into_iter().filter_map(|name| element::note(name, CellKind::Line2));
        links.chain(read.into_iter().map(note)).collect()
    }

    /// Edges of solid cells, with the smaller node first, between nodes of lines with a type.
    fn edges_at_lines(&self) -> HashSet<[u32; 2]> {
        let mut is_at_line = vec![false; self.n_nodes];
        let mut edges = HashSet::new();
        for (body, &[first_node, _]) in self.deck.bodies().zip(&self.starts) {
            let is_line =
                |element: &&Element| element.kind == CellKind::Line2 && element.element_type.is_some();
            let lines = body.lower.iter().filter(is_line);
            let nodes = lines.flat_map(|line| known_nodes(body, line, first_node));
            nodes.for_each(|node| is_at_line[node as usize] = true);
        }
        if self.is_plane || !is_at_line.contains(&true) {
            return edges;
        }
        for (body, &[first_node, _]) in self.deck.bodies().zip(&self.starts) {
            for element in body.elements.iter().filter(|element| element.kind.dimension() == 3) {
                let nodes = known_nodes(body, element, first_node);
                for facet in element.kind.facets() {
                    let n = facet.kind.n_corners();
                    let ends = |i: usize| [i, (i + 1) % n].map(|i| nodes[facet.nodes[i]]);
                    let at_lines =
                        (0..n).map(ends).filter(|ends| ends.iter().all(|&end| is_at_line[end as usize]));
                    edges.extend(at_lines.map(|[a, b]| [a.min(b), a.max(b)]));
                }
            }
        }
        edges
    }

    /// Adds the elements of a member of a set that are no cells, and returns their number.
    fn add_others(&self, instance: Option<u32>, member: Member, others: &mut Others) -> u64 {
        let instance = member.instance.or(instance);
        let body = self.body(instance);
        let first_node = self.start(instance, Of::Nodes);
        let (lower, _) = member.indices(&body.lower_index);
        for &index in &lower {
            let element = &body.lower[index as usize];
            if self.are_facets(element.kind)
                && let Some(facet) = self.facet(body, element, first_node)
            {
                others.facets.push(facet);
                continue;
            }
            let nodes = known_nodes(body, element, first_node);
            if element.kind == CellKind::Line2 && !self.is_plane && nodes.len() == element.n_nodes {
                others.nodes_of_edges.extend(nodes);
            } else {
                others.n_left_out += 1;
                others.nodes.extend(nodes);
            }
        }
        let (left_out, _) = member.indices(&body.left_out_index);
        for &index in &left_out {
            others.n_left_out += 1;
            for &node in &body.left_out[index as usize].nodes {
                others.nodes.extend(self.indices(Of::Nodes, instance, node).0);
            }
        }
        (lower.len() + left_out.len()) as u64
    }

    /// Indices in the mesh of the nodes of an element.
    fn node_indices(&self, instance: Option<u32>, element: &Element) -> Result<Vec<u32>> {
        let (body, first) = (self.body(instance), self.start(instance, Of::Nodes));
        let unknown = |node: u64| MeshError::UnknownNode {
            place: self.deck.place(element.at),
            element: element.number,
            node,
        };
        if let Some(nodes) = body.joined.get(&element.nodes) {
            let index = |node: &Member| self.indices(Of::Nodes, instance, *node).0.first().copied();
            return nodes.iter().map(|node| index(node).ok_or_else(|| unknown(node.first))).collect();
        }
        let index = |node: &u64| body.nodes.get(node).map(|index| first + index);
        body.nodes_of(element).iter().map(|node| index(node).ok_or_else(|| unknown(*node))).collect()
    }

    /// Mesh indices of a set's member in a body, and the number of missing ones.
    fn indices(&self, of: Of, instance: Option<u32>, member: Member) -> (Vec<u32>, u64) {
        let instance = member.within(instance).instance;
        let (mut indices, missing) = member.indices(self.body(instance).index(of));
        indices.iter_mut().for_each(|index| *index += self.start(instance, of));
        (indices, missing)
    }

    /// All cells of an instance, under its name.
    fn add_instance_group(&mut self, index: usize) {
        let deck = self.deck;
        let instance = &deck.instances[index];
        let is_taken = deck.root.element_sets.contains_key(&instance.name.to_lowercase());
        if !is_taken && !instance.body.elements.is_empty() {
            let first = self.start(Some(index as u32), Of::Elements);
            self.cell_group(&instance.name, first..first + instance.body.elements.len() as u32);
        }
    }
}
