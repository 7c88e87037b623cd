//! Surfaces of the mesh: facets or nodes of rows, and combinations of them.

use std::collections::HashSet;

use emmy::mesh::Facet;

use super::super::body::{At, Combine, Face, Member, Of, Row, Surface};
use super::super::element;
use super::{Assembly, Others, Result};
use crate::message::counted;

/// Facets or nodes of a surface.
#[derive(Debug, Default, Clone)]
pub(super) struct Contents {
    pub(super) facets: Vec<Facet>,
    pub(super) nodes: Vec<u32>,
}

impl Contents {
    fn combined(how: Combine, mut parts: impl Iterator<Item = Contents>) -> Contents {
        let mut all = parts.next().unwrap_or_default();
        for mut other in parts {
            match how {
                Combine::Union => {
                    all.facets.append(&mut other.facets);
                    all.nodes.append(&mut other.nodes);
                }
                Combine::Intersection | Combine::Difference => {
                    let keep = how == Combine::Intersection;
                    let (facets, nodes) =
                        (HashSet::<Facet>::from_iter(other.facets), HashSet::<u32>::from_iter(other.nodes));
                    all.facets.retain(|facet| facets.contains(facet) == keep);
                    all.nodes.retain(|node| nodes.contains(node) == keep);
                }
            }
        }
        all.facets.sort_unstable();
        all.facets.dedup();
        all.nodes.sort_unstable();
        all.nodes.dedup();
        all
    }
}

impl<'a> Assembly<'a> {
    /// Finds the contents of all surfaces: those of instances first, because the assembly may combine them.
    pub(super) fn find_surfaces(&mut self, notes: &mut Vec<String>) -> Result<()> {
        let deck = self.deck;
        let parts_of =
            |surface: &'a Surface| surface.combine.map(|_| surface.rows.iter()).into_iter().flatten();
        let parts = deck.bodies().flat_map(|body| &body.surfaces).flat_map(parts_of);
        let names_of = |row: &'a Row| {
            let of_instance = row.target.split_once('.').map(|(_, name)| name);
            std::iter::once(row.target.as_str()).chain(of_instance).map(str::to_lowercase)
        };
        let used: HashSet<String> = parts.flat_map(names_of).collect();
        let named: HashSet<String> = self.named_by_cards().collect();
        let instances = (0..deck.instances.len() as u32).map(Some);
        for instance in instances.chain([None]) {
            for surface in &self.body(instance).surfaces {
                let name = surface.name.to_lowercase();
                let is_needed = !surface.internal || used.contains(&name);
                if is_needed || named.contains(&name) {
                    let mut contents = match self.contents(instance, surface, notes) {
                        Ok(contents) => contents,
                        Err(error) if is_needed => return Err(error),
                        // The card that names it is left out, with a note.
                        Err(_) => continue,
                    };
                    let known = self.surfaces.entry((instance, name)).or_default();
                    known.facets.append(&mut contents.facets);
                    known.nodes.append(&mut contents.nodes);
                }
            }
        }
        Ok(())
    }

    /// Adds a surface as groups of facets, or of nodes.
    pub(super) fn add_surface(&mut self, instance: Option<u32>, surface: &Surface) {
        let name = surface.name.to_lowercase();
        let is_taken = self.root_surfaces.contains(&name);
        let names = self.deck.group_names(instance, &surface.name, is_taken);
        let Some(contents) = self.surfaces.get(&(instance, name)).cloned() else { return };
        for name in names {
            if surface.of == Of::Elements && (contents.nodes.is_empty() || !contents.facets.is_empty()) {
                self.facet_group(&name, contents.facets.iter().copied());
            } else {
                self.node_group(&name, contents.nodes.iter().copied());
            }
        }
    }

    fn contents(
        &self,
        instance: Option<u32>,
        surface: &Surface,
        notes: &mut Vec<String>,
    ) -> Result<Contents> {
        if let Some(how) = surface.combine {
            let parts =
                surface.rows.iter().map(|row| self.part(instance, row)).collect::<Result<Vec<_>>>()?;
            return Ok(Contents::combined(how, parts.into_iter()));
        }
        let mut contents = Contents::default();
        let mut others = Others::default();
        let mut has_edges = false;
        // A surface without rows has all free faces of the model.
        let at = At { file: 0, line: 0 };
        let all = Row { target: String::new(), face: Some(Face::Free), instance: None, area: None, at };
        let is_blank = surface.rows.is_empty() && surface.of == Of::Elements;
        for row in surface.rows.iter().chain(is_blank.then_some(&all)) {
            if row.face == Some(Face::Edge) {
                has_edges = true;
                continue;
            }
            let of = if row.face.is_some() { Of::Elements } else { Of::Nodes };
            for member in self.row_members(instance, row)? {
                let (indices, missing) = self.indices(of, instance, member);
                let n_others =
                    if of == Of::Elements { self.add_others(instance, member, &mut others) } else { 0 };
                if missing > 0 && indices.is_empty() && n_others == 0 && !row.target.is_empty() {
                    return Err(self.deck.unknown_set(row.at, of, &row.target));
                }
                self.add_row(member.instance.or(instance), row, &indices, &mut contents)?;
            }
        }
        contents.facets.extend(others.facets);
        if has_edges {
            notes.push(format!(
                "surface \"{}\": edges of shells and ends of beams are left out",
                surface.name
            ));
        }
        if others.n_left_out > 0 {
            let elements = counted(others.n_left_out as usize, "element that is", "elements that are");
            notes.push(format!("surface \"{}\" has {elements} left out", surface.name));
        }
        if contents.facets.is_empty() {
            contents.nodes.extend(others.nodes);
        }
        Ok(contents)
    }

    /// The surface that a row names, of this body or of an instance.
    fn part(&self, instance: Option<u32>, row: &Row) -> Result<Contents> {
        let own = (instance, row.target.to_lowercase());
        let of_instance = || {
            let (instance, name) = row.target.split_once('.')?;
            self.surfaces.get(&(Some(self.deck.instance_index(instance)?), name.to_lowercase()))
        };
        let unknown = || {
            let problem = format!("there is no surface \"{}\" above", row.target);
            self.deck.undefined(
                row.at,
                problem,
                "define it first, or qualify it with its instance: Instance.Surface",
            )
        };
        self.surfaces.get(&own).or_else(of_instance).cloned().ok_or_else(unknown)
    }

    fn row_members(&self, instance: Option<u32>, row: &Row) -> Result<Vec<Member>> {
        if row.target.is_empty() && row.face == Some(Face::Free) {
            let instances = instance.is_none().then_some(0..self.deck.instances.len() as u32);
            let others = instances.into_iter().flatten().map(|index| Member::all(Some(index)));
            return Ok(std::iter::once(Member::all(instance)).chain(others).collect());
        }
        let of = if row.face.is_some() { Of::Elements } else { Of::Nodes };
        let members = self.deck.members(self.body(instance), of, row.instance, &row.target);
        members.ok_or_else(|| self.deck.unknown_set(row.at, of, &row.target))
    }

    /// Adds the faces or nodes of the cells or nodes in a row.
    fn add_row(
        &self,
        instance: Option<u32>,
        row: &Row,
        indices: &[u32],
        contents: &mut Contents,
    ) -> Result<()> {
        let first = self.start(instance, Of::Elements);
        let body = self.body(instance);
        for &index in indices {
            let element = || body.elements[(index - first) as usize];
            match row.face {
                None => contents.nodes.push(index),
                Some(Face::Number(face)) => {
                    let kind = element().kind;
                    let problem = || format!("element {} ({kind}) has no face S{face}", element().number);
                    let missing =
                        || self.deck.malformed(row.at, problem(), "correct the face of the surface");
                    let local = element::local_facet(kind, face).ok_or_else(missing)?;
                    contents.facets.push(Facet { cell: index, local });
                }
                Some(Face::Free) => {
                    let element = element();
                    let nodes = self.node_indices(instance, &element)?;
                    let is_free = |&local: &u8| {
                        self.faces.as_ref().is_some_and(|faces| faces.is_free(element.kind, &nodes, local))
                    };
                    let free = (0..element.kind.facets().len() as u8).filter(is_free);
                    contents.facets.extend(free.map(|local| Facet { cell: index, local }));
                }
                Some(Face::Own) => return Err(self.deck.unknown_face(row.at, "SPOS")),
                Some(Face::Edge) => {}
            }
        }
        Ok(())
    }
}
