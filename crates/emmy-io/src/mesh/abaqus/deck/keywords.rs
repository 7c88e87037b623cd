//! Keywords; each determines the meaning of its data lines.

use super::super::super::account::Treatment;
use super::super::super::includes::included;
use super::super::super::{MeshError, Result};
use super::super::body::{At, Body, Card, Combine, Instance, Member, Of, Surface};
use super::super::element::{self, Role};
use super::super::keyword::Keyword;
use super::super::placement::Placement;
use super::super::table::{TABLE, is_card, spelled};
use super::{Deck, Elements, Scope, Section, shown};

/// Largest number of nodes, elements and members of sets in all instances together: each instance copies its part.
const MAX_COPIED: usize = 50_000_000;

impl Deck {
    pub(super) fn keyword(&mut self, keyword: &Keyword, at: At) -> Result<()> {
        if keyword.name == "INCLUDE" {
            // The lines of the file may continue the data of the previous keyword.
            return self.include(at, self.required(keyword, at, "INPUT")?);
        }
        self.close_section()?;
        self.section = Section::Skipped;
        let name = spelled(&keyword.title);
        match self.account.add(TABLE, name) {
            Some(Treatment::Read) => {}
            Some(Treatment::Refused) => {
                let problem = format!("{name} makes or moves nodes or elements and is not supported");
                let advice = "write out all nodes and elements, as Abaqus/CAE does";
                return Err(self.malformed(at, problem, advice));
            }
            Some(Treatment::LeftOut) if keyword.name == "BOUNDARY" => {
                // It says which ends of springs without cells are fixed.
                self.section = Section::Card;
                self.body_mut().cards.push(Card { keyword: keyword.clone(), at, lines: Vec::new() });
                return Ok(());
            }
            Some(Treatment::NoEffect | Treatment::LeftOut) | None => return Ok(()),
        }
        self.section = match keyword.name.as_str() {
            "PART" => self.part(keyword, at)?,
            "INSTANCE" => self.instance(keyword, at)?,
            "ENDPART" | "ENDINSTANCE" | "ASSEMBLY" | "ENDASSEMBLY" => {
                self.scope = Scope::Root;
                Section::Skipped
            }
            "NODE" => self.nodes(keyword, at)?,
            "ELEMENT" => self.elements(keyword, at)?,
            "NSET" => self.node_set(keyword, at)?,
            "ELSET" => self.set(keyword, at, Of::Elements, "ELSET")?,
            "SURFACE" => self.surface(keyword, at)?,
            _ if is_card(name) => return self.card(keyword, at),
            _ => Section::Skipped,
        };
        match keyword.value("INPUT") {
            Some(input) if !matches!(self.section, Section::Skipped) => self.include(at, input),
            _ => Ok(()),
        }
    }

    /// A card; a file of its data that is missing does not spoil the mesh.
    fn card(&mut self, keyword: &Keyword, at: At) -> Result<()> {
        self.section = Section::Card;
        self.body_mut().cards.push(Card { keyword: keyword.clone(), at, lines: Vec::new() });
        let Some(input) = keyword.value("INPUT") else { return Ok(()) };
        let path = included(&self.files, at.file, input);
        if path.is_file() {
            return self.include(at, input);
        }
        let place = self.place(at);
        let name = &keyword.title;
        self.notes.insert(format!("{place}: {name} is left out: there is no file {}", path.display()));
        Ok(())
    }

    fn required<'a>(&self, keyword: &'a Keyword, at: At, key: &str) -> Result<&'a str> {
        let missing = || {
            let problem = format!("*{} without {}=", keyword.name, key.to_lowercase());
            self.malformed(at, problem, "add it")
        };
        keyword.value(key).ok_or_else(missing)
    }

    /// The instance of a set or surface of the assembly.
    fn qualifier(&self, keyword: &Keyword, at: At) -> Result<Option<u32>> {
        let Some(name) = keyword.value("INSTANCE") else { return Ok(None) };
        let unknown = || {
            let names = listed(self.instances.iter().map(|instance| instance.name.as_str()));
            let problem = format!("there is no instance \"{name}\" above, only: {names}");
            self.undefined(at, problem, "correct the name, or move the line below the instance")
        };
        self.instance_index(name).map(Some).ok_or_else(unknown)
    }

    fn part(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        let name = self.required(keyword, at, "NAME")?;
        if self.part_index.insert(name.to_lowercase(), self.parts.len()).is_some() {
            return Err(self.malformed(
                at,
                format!("part \"{name}\" exists already"),
                "give it another name",
            ));
        }
        self.parts.push((name.to_string(), Body::default()));
        self.scope = Scope::Part(self.parts.len() - 1);
        Ok(Section::Skipped)
    }

    fn instance(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        if let Some(library) = keyword.value("LIBRARY") {
            let problem = format!("*INSTANCE of another analysis ({}) is not read", shown(library));
            return Err(self.malformed(at, problem, "write its part and its *Instance to the file"));
        }
        let name = self.required(keyword, at, "NAME")?;
        let part = self.required(keyword, at, "PART")?;
        if self.instance_index(name).is_some() {
            let problem = format!("instance \"{name}\" exists already");
            return Err(self.malformed(at, problem, "give it another name"));
        }
        let index = self.part_index.get(&part.to_lowercase()).copied();
        let Some((_, body)) = index.and_then(|index| self.parts.get(index)) else {
            let names = listed(self.parts.iter().map(|(name, _)| name.as_str()));
            let problem = format!("there is no part \"{part}\" above, only: {names}");
            return Err(self.undefined(at, problem, "correct the name, or write the part to the file"));
        };
        let size = body.size();
        if self.copied + size > MAX_COPIED {
            let problem =
                format!("the instances up to \"{name}\" have more than {MAX_COPIED} nodes and elements");
            return Err(self.malformed(at, problem, "write fewer instances, or smaller parts"));
        }
        let name = name.to_string();
        let body = body.clone();
        self.copied += size;
        self.instance_index.insert(name.to_lowercase(), self.instances.len() as u32);
        self.instances.push(Instance { name, body, placement: Placement::default() });
        self.scope = Scope::Instance(self.instances.len() - 1);
        Ok(Section::Placement)
    }

    fn nodes(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        match keyword.value("SYSTEM") {
            None | Some("R" | "r") => Ok(Section::Nodes { set: keyword.value("NSET").map(str::to_string) }),
            Some(system) => {
                let problem = format!("coordinates of system {system} are not supported");
                Err(self.malformed(at, problem, "write Cartesian coordinates, as Abaqus/CAE does"))
            }
        }
    }

    fn elements(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        let element_type = self.required(keyword, at, "TYPE")?.to_ascii_uppercase();
        let Some(role) = element::role(&element_type) else {
            let place = self.place(at);
            let supported = element::supported();
            return Err(MeshError::UnsupportedElement { place, kind: element_type, supported });
        };
        self.has_faces |= matches!(role, Role::Lower(..));
        let set = keyword.value("ELSET").map(str::to_string);
        let type_index = self.types.len() as u32;
        self.types.push(element_type.clone());
        let pending = Vec::new();
        Ok(Section::Elements(Elements { element_type, type_index, role, is_noted: false, set, pending, at }))
    }

    fn set(&mut self, keyword: &Keyword, at: At, of: Of, key: &str) -> Result<Section> {
        let name = self.required(keyword, at, key)?.to_string();
        let instance = self.qualifier(keyword, at)?;
        self.body_mut().set_mut(of, &name).internal |= keyword.has("INTERNAL") && name.starts_with('_');
        Ok(Section::Set { of, name, instance, generate: keyword.has("GENERATE") })
    }

    /// `*Nset`; with `elset=` its members are the nodes of elements, without data lines.
    fn node_set(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        let section = self.set(keyword, at, Of::Nodes, "NSET")?;
        if let (Some(elements), Section::Set { name, instance, .. }) = (keyword.value("ELSET"), &section) {
            let nodes = self.nodes_of_set(at, *instance, elements)?;
            self.body_mut().set_mut(Of::Nodes, name).extend(nodes);
        }
        Ok(section)
    }

    fn nodes_of_set(&self, at: At, instance: Option<u32>, elements: &str) -> Result<Vec<Member>> {
        let members = self.members(self.body(), Of::Elements, instance, elements);
        let members = members.ok_or_else(|| self.unknown_set(at, Of::Elements, elements))?;
        let mut nodes = Vec::new();
        for member in members {
            let body = member.instance.map_or(self.body(), |index| &self.instances[index as usize].body);
            let cells =
                member.indices(&body.element_index).0.into_iter().map(|index| &body.elements[index as usize]);
            let lower =
                member.indices(&body.lower_index).0.into_iter().map(|index| &body.lower[index as usize]);
            for element in cells.chain(lower) {
                nodes.extend(body.members_of(element).into_iter().map(|node| node.within(member.instance)));
            }
            for index in member.indices(&body.left_out_index).0 {
                let of_element = body.left_out[index as usize].nodes.iter();
                nodes.extend(of_element.map(|node| node.within(member.instance)));
            }
        }
        Ok(nodes)
    }

    fn surface(&mut self, keyword: &Keyword, at: At) -> Result<Section> {
        let name = self.required(keyword, at, "NAME")?.to_string();
        let surface_type = keyword.value("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
        let operation = keyword.value("COMBINE").map(str::to_ascii_uppercase);
        let combine = match operation.as_deref() {
            None => None,
            Some("UNION") => Some(Combine::Union),
            Some("INTERSECTION") => Some(Combine::Intersection),
            Some("DIFFERENCE") => Some(Combine::Difference),
            Some(operation) => {
                let problem =
                    format!("surfaces can be combined by UNION, INTERSECTION or DIFFERENCE, not {operation}");
                return Err(self.malformed(at, problem, "correct COMBINE="));
            }
        };
        let is_cropped = keyword.has("CROP");
        let of = match surface_type.as_str() {
            "ELEMENT" if !is_cropped => Of::Elements,
            "NODE" if !is_cropped => Of::Nodes,
            _ => {
                let why = match is_cropped {
                    true => "is cut to a box (CROP)".to_string(),
                    false => format!("is neither of elements nor of nodes (TYPE={surface_type})"),
                };
                self.notes.insert(format!("surface \"{name}\" {why}: left out"));
                return Ok(Section::Skipped);
            }
        };
        let instance = self.qualifier(keyword, at)?;
        let internal = keyword.has("INTERNAL") && name.starts_with('_');
        self.body_mut().surfaces.push(Surface { name, internal, of, combine, rows: Vec::new() });
        Ok(Section::Surface { instance })
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MAX_NAMES: usize = 60;
    let mut names = names;
    let first = names.by_ref().take(MAX_NAMES).collect::<Vec<_>>().join(", ");
    match (first.is_empty(), names.count()) {
        (true, _) => "none".to_string(),
        (false, 0) => first,
        (false, more) => format!("{first} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instances_do_not_multiply_without_end() {
        let deck = b"*Part, name=Arm\n*Node\n1, 0, 0, 0\n*End Part\n*Instance, name=Arm-1, part=Arm\n";
        let read = |copied| Deck { copied, ..Deck::default() }.file("a.inp".as_ref(), deck);
        assert!(read(MAX_COPIED - 1).is_ok());
        let message = read(MAX_COPIED).unwrap_err().to_string();
        assert!(
            message.contains("a.inp, line 5: the instances up to \"Arm-1\" have more than 50000000"),
            "{message}"
        );
    }
}
