//! Reading of an input file, line by line.

mod data;
mod keywords;

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::iter::Peekable;
use std::path::{Path, PathBuf};

use super::super::account::Account;
use super::super::includes::{Includes, included};
use super::super::{MeshError, MeshOptions, Place, Result, without_mark};
use super::body::{At, Body, Element, Instance, Member, Of};
use super::element::Role;
use super::keyword::Keyword;
use crate::message;

/// The contents of an input file and its includes, as far as a mesh needs them.
#[derive(Debug, Default)]
pub(in crate::mesh) struct Deck {
    /// Nodes, elements, sets and surfaces outside of parts and instances.
    pub(in crate::mesh) root: Body,
    pub(super) parts: Vec<(String, Body)>,
    pub(super) instances: Vec<Instance>,
    /// Indices of parts and instances by their names in lower case.
    part_index: HashMap<String, usize>,
    instance_index: HashMap<String, u32>,
    pub(in crate::mesh) notes: BTreeSet<String>,
    /// Keywords or cards that are not read.
    pub(in crate::mesh) account: Account,
    /// Types of elements, one for each of their keywords.
    pub(in crate::mesh) types: Vec<String>,
    /// Whether elements are there that can only be faces or edges of solid cells.
    has_faces: bool,
    pub(in crate::mesh) files: Vec<PathBuf>,
    includes: Includes,
    /// Nodes, elements and set members copied from parts by the instances.
    copied: usize,
    scope: Scope,
    section: Section,
}

/// Owner of the following nodes, elements and sets.
#[derive(Debug, Clone, Copy, Default)]
enum Scope {
    #[default]
    Root,
    Part(usize),
    Instance(usize),
}

/// Meaning of the data lines.
#[derive(Debug, Default)]
enum Section {
    #[default]
    Start,
    Skipped,
    Placement,
    Nodes {
        set: Option<String>,
    },
    Elements(Elements),
    Set {
        of: Of,
        name: String,
        instance: Option<u32>,
        generate: bool,
    },
    /// Rows of the last surface.
    Surface {
        instance: Option<u32>,
    },
    /// Lines of the last card.
    Card,
}

#[derive(Debug)]
struct Elements {
    element_type: String,
    /// Index in [`Deck::types`].
    type_index: u32,
    role: Role,
    /// Whether a note says how the cells are read.
    is_noted: bool,
    set: Option<String>,
    /// Number and nodes of an element that continues in the next line.
    pending: Vec<Member>,
    at: At,
}

impl Elements {
    /// Whether a node may be missing: it is the ground.
    fn may_be_grounded(&self) -> bool {
        self.element_type.starts_with("CONN")
    }

    /// Whether the element in the last line is a connector to the ground.
    fn is_grounded(&self) -> bool {
        self.may_be_grounded() && self.pending.len() == 2
    }
}

impl Deck {
    /// Reads a file and its includes.
    pub(super) fn read(&mut self, file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<()> {
        // The first file is never included yet.
        _ = self.includes.open(file);
        self.file(file, bytes)?;
        self.close_section()?;
        if options.plane_shells {
            self.raise_shells();
        }
        self.lower_lines(&options.links);
        Ok(())
    }

    /// Makes shells the cells of a body in plane strain, if no cell is solid.
    fn raise_shells(&mut self) {
        if self.bodies().any(|body| body.elements.iter().any(|element| element.kind.dimension() == 3)) {
            return;
        }
        let mut types = BTreeSet::new();
        for body in self.bodies() {
            let shells = body.lower.iter().filter(|element| element.kind.dimension() == 2);
            types.extend(shells.map(|element| self.type_of(element)));
        }
        let note = |name| {
            format!("elements of type {name} are read as cells in plane strain, without their thickness")
        };
        let notes: Vec<String> = types.into_iter().map(note).collect();
        self.notes.extend(notes);
        self.root.raise_shells();
        self.instances.iter_mut().for_each(|instance| instance.body.raise_shells());
    }

    /// Turns trusses beside other cells into edges, and leaves out the other lines there, except those in some groups.
    fn lower_lines(&mut self, links: &[String]) {
        if !self.has_cells() {
            return;
        }
        let are_edges: Vec<bool> = self.types.iter().map(|name| name.starts_with('T')).collect();
        let links = self.lines_of(links);
        let bodies = self.instances.iter_mut().map(|instance| &mut instance.body);
        let bodies = std::iter::once(&mut self.root).chain(bodies);
        bodies.zip(&links).for_each(|(body, links)| body.lower_lines(links, &are_edges));
    }

    /// Indices of the elements in some groups, outside of instances and in each of them.
    fn lines_of(&self, groups: &[String]) -> Vec<HashSet<u32>> {
        let mut found = vec![HashSet::new(); 1 + self.instances.len()];
        if groups.is_empty() {
            return found;
        }
        let mut members = Vec::new();
        for (body, own) in self.bodies().zip(self.numbers()) {
            for (key, set) in &body.element_sets {
                let is_taken = self.root.element_sets.contains_key(key);
                if self.group_names(own, &set.name, is_taken).iter().any(|name| groups.contains(name)) {
                    members.extend(set.members.iter().map(|member| member.within(own)));
                }
            }
        }
        let instances = self.instances.iter().zip(0..);
        let named = instances.filter(|(instance, _)| groups.contains(&instance.name));
        members.extend(named.map(|(_, index)| Member::all(Some(index))));
        for member in members {
            let body = member.instance.map_or(&self.root, |index| &self.instances[index as usize].body);
            let place = member.instance.map_or(0, |index| 1 + index as usize);
            found[place].extend(member.indices(&body.element_index).0);
        }
        found
    }

    /// Names of a group: in an instance `Instance.Set`, and also `Set` if the assembly has no set of that name.
    pub(super) fn group_names(&self, instance: Option<u32>, name: &str, is_taken: bool) -> Vec<String> {
        match instance {
            None => vec![name.to_string()],
            Some(index) => {
                let qualified = format!("{}.{name}", self.instances[index as usize].name);
                if is_taken { vec![qualified] } else { vec![qualified, name.to_string()] }
            }
        }
    }

    /// The contents outside of parts, and those of the instances.
    pub(super) fn bodies(&self) -> impl Iterator<Item = &Body> + Clone {
        std::iter::once(&self.root).chain(self.instances.iter().map(|instance| &instance.body))
    }

    /// The numbers of the instances of [`Deck::bodies`].
    pub(super) fn numbers(&self) -> impl Iterator<Item = Option<u32>> + use<> {
        std::iter::once(None).chain((0..self.instances.len() as u32).map(Some))
    }

    /// Whether there are cells other than links.
    fn has_cells(&self) -> bool {
        self.bodies().any(|body| body.elements.iter().any(|element| element.kind.dimension() > 1))
    }

    /// Whether the only cells are links beside shells: the body is missing.
    pub(super) fn is_of_shells(&self) -> bool {
        self.has_faces && !self.has_cells()
    }

    /// Name of the type of an element.
    pub(super) fn type_of(&self, element: &Element) -> &str {
        let known = element.element_type.map(|index| self.types[index as usize].as_str());
        known.unwrap_or_else(|| element.kind.name())
    }

    pub(in crate::mesh) fn place(&self, at: At) -> Place {
        Place::line(&self.files[at.file as usize], at.line as usize)
    }

    /// Members of a set, or the number; either may be qualified as in `Part-1-1.Set-1`.
    pub(super) fn members(
        &self,
        body: &Body,
        of: Of,
        instance: Option<u32>,
        target: &str,
    ) -> Option<Vec<Member>> {
        if let Some(instance) = instance {
            return self.members_in(instance, of, target);
        }
        if let Ok(number) = target.parse() {
            return Some(vec![Member::one(None, number)]);
        }
        if let Some(set) = body.sets(of).get(&target.to_lowercase()) {
            return Some(set.members.clone());
        }
        let (instance, target) = target.split_once('.')?;
        self.members_in(self.instance_index(instance)?, of, target)
    }

    fn members_in(&self, index: u32, of: Of, target: &str) -> Option<Vec<Member>> {
        let instance = Some(index);
        if let Ok(number) = target.parse() {
            return Some(vec![Member::one(instance, number)]);
        }
        let set = self.instances[index as usize].body.sets(of).get(&target.to_lowercase())?;
        Some(set.members.iter().map(|&member| Member { instance, ..member }).collect())
    }

    pub(super) fn instance_index(&self, name: &str) -> Option<u32> {
        self.instance_index.get(&name.to_lowercase()).copied()
    }

    pub(super) fn malformed(&self, at: At, problem: String, advice: &'static str) -> MeshError {
        MeshError::Malformed { place: self.place(at), problem, advice }
    }

    pub(super) fn unknown_set(&self, at: At, of: Of, name: &str) -> MeshError {
        let what = if of == Of::Nodes { "node" } else { "element" };
        let problem = match name.parse::<u64>() {
            Ok(number) => format!("there is no {what} {number}"),
            Err(_) => format!("there is no {what} set \"{}\" here or above", shown(name)),
        };
        self.undefined(at, problem, "define it first, or qualify it with its instance: Instance.Set")
    }

    pub(super) fn undefined(&self, at: At, problem: String, advice: &'static str) -> MeshError {
        MeshError::Undefined { place: self.place(at), problem, advice }
    }

    fn body(&self) -> &Body {
        match self.scope {
            Scope::Root => &self.root,
            Scope::Part(part) => &self.parts[part].1,
            Scope::Instance(instance) => &self.instances[instance].body,
        }
    }

    fn body_mut(&mut self) -> &mut Body {
        match self.scope {
            Scope::Root => &mut self.root,
            Scope::Part(part) => &mut self.parts[part].1,
            Scope::Instance(instance) => &mut self.instances[instance].body,
        }
    }
}

/// Lines.
impl Deck {
    fn file(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        let file = self.files.len() as u32;
        self.files.push(path.to_path_buf());
        if !bytes.ends_with(b"\n") {
            let name = path.display();
            self.notes
                .insert(format!("{name}: the last line has no line feed at its end; is the file cut off?"));
        }
        let lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii).zip(1..);
        let mut lines = lines.filter(|(text, _)| !text.is_empty() && !text.starts_with(b"**")).peekable();
        while let Some((text, line)) = lines.next() {
            let at = At { file, line };
            if text.starts_with(b"*") {
                let keyword = self.keyword_line(at, text, &mut lines)?;
                self.keyword(&Keyword::parse(&keyword), at)?;
            } else if matches!(self.section, Section::Card) {
                // Characters that are not UTF-8 do not spoil the mesh.
                self.data(at, &message::name(&String::from_utf8_lossy(text)))?;
            } else if !matches!(self.section, Section::Skipped) {
                let text = self.text(at, text)?;
                self.data(at, &text)?;
            }
        }
        Ok(())
    }

    /// The text of a line, without characters that names cannot hold.
    fn text<'a>(&mut self, at: At, bytes: &'a [u8]) -> Result<Cow<'a, str>> {
        let text = std::str::from_utf8(bytes).map_err(|_| {
            self.malformed(at, "text that is not UTF-8".to_string(), "save the file as UTF-8")
        })?;
        let read = message::name(text);
        if matches!(read, Cow::Owned(_)) {
            let place = self.place(at);
            self.notes.insert(format!("{place}: control characters are read as `_`"));
        }
        Ok(read)
    }

    /// A keyword line, with the next lines if it ends with a comma.
    fn keyword_line<'a>(
        &mut self,
        at: At,
        text: &'a [u8],
        lines: &mut Peekable<impl Iterator<Item = (&'a [u8], u32)>>,
    ) -> Result<String> {
        let mut keyword = self.text(at, text)?.into_owned();
        while keyword.ends_with(',') {
            let Some((text, line)) = lines.next_if(|(text, _)| !text.starts_with(b"*")) else { break };
            keyword.push_str(&self.text(At { line, ..at }, text)?);
        }
        Ok(keyword)
    }

    fn include(&mut self, at: At, input: &str) -> Result<()> {
        let path = included(&self.files, at.file, input);
        let opened = self.includes.open(&path);
        opened.map_err(|(problem, advice)| self.malformed(at, problem, advice))?;
        let bytes = crate::whole_file::read(&path).map_err(|reason| {
            let problem = format!("the file {} cannot be read: {reason}", path.display());
            self.malformed(at, problem, "paths are relative to the file that includes, or to the first one")
        })?;
        self.file(&path, without_mark(&bytes))?;
        self.includes.close();
        Ok(())
    }
}

/// The text found, short enough for a message.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
