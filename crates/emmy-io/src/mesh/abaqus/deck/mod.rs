//! Reading of an input file, line by line.

mod data;
mod keywords;

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::iter::Peekable;
use std::path::{Path, PathBuf};

use emmy::mesh::CellKind;

use super::super::account::Account;
use super::super::{MeshError, MeshOptions, Place, Result, included, without_mark};
use super::body::{At, Body, Instance, Member, Of};
use super::element::{self, Role};
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
    depth: usize,
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

/// Depth of nested includes; deeper ones are taken for a cycle.
const MAX_DEPTH: usize = 16;

/// Largest number of files of one input; a few lines could request very many.
const MAX_FILES: usize = 1000;

impl Deck {
    /// Reads a file and its includes.
    pub(super) fn read(file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<Self> {
        let mut deck = Deck::default();
        deck.file(file, bytes)?;
        deck.close_section()?;
        if options.plane_shells {
            deck.raise_shells();
        }
        deck.lower_lines(&options.links);
        Ok(deck)
    }

    /// Makes shells the cells of a body in plane strain, if no cell is solid.
    fn raise_shells(&mut self) {
        if self.bodies().any(|body| body.elements.iter().any(|element| element.kind.dimension() == 3)) {
            return;
        }
        let mut types = BTreeSet::new();
        for body in self.bodies() {
            let shells = (0..body.lower.len()).filter(|&index| body.lower[index].kind.dimension() == 2);
            types.extend(shells.map(|index| self.lower_type(body, index)));
        }
        let note = |name| {
            format!("elements of type {name} are read as cells in plane strain, without their thickness")
        };
        let notes: Vec<String> = types.into_iter().map(note).collect();
        self.notes.extend(notes);
        self.root.raise_shells();
        self.instances.iter_mut().for_each(|instance| instance.body.raise_shells());
    }

    /// Leaves out lines beside other cells, unless links are requested; where meshers have written faces, trusses are edges.
    fn lower_lines(&mut self, links: &[String]) {
        let lines = self.bodies().flat_map(|body| &body.line_types);
        let lines: BTreeSet<&str> = lines.map(|&index| &*self.types[index as usize]).collect();
        if !links.is_empty() || !self.has_cells() {
            let notes: Vec<String> =
                lines.into_iter().filter_map(|name| element::note(name, CellKind::Line2)).collect();
            self.notes.extend(notes);
            return;
        }
        let is_edge = |name: &str| self.has_faces && name.starts_with('T');
        let left_out: Vec<&str> = lines.into_iter().filter(|name| !is_edge(name)).collect();
        let note = format!(
            "{} beside other cells would be links, if a region had a material for links",
            left_out.join(", ")
        );
        let are_edges: Vec<bool> = self.types.iter().map(|name| is_edge(name)).collect();
        self.notes.extend((!left_out.is_empty()).then_some(note));
        let lower = |body: &mut Body| body.lower_lines(|index| are_edges[index as usize]);
        lower(&mut self.root);
        self.instances.iter_mut().for_each(|instance| lower(&mut instance.body));
    }

    /// The contents outside of parts, and those of the instances.
    pub(super) fn bodies(&self) -> impl Iterator<Item = &Body> {
        std::iter::once(&self.root).chain(self.instances.iter().map(|instance| &instance.body))
    }

    /// Whether there are cells other than links.
    fn has_cells(&self) -> bool {
        self.bodies().any(|body| body.elements.iter().any(|element| element.kind.dimension() > 1))
    }

    /// Whether the only cells are links beside shells: the body is missing.
    pub(super) fn is_of_shells(&self) -> bool {
        self.has_faces && !self.has_cells()
    }

    /// Name of the type of an element of lower dimension.
    pub(super) fn lower_type(&self, body: &Body, index: usize) -> &str {
        let known = body.lower_types.get(index).map(|&index| self.types[index as usize].as_str());
        known.unwrap_or_else(|| body.lower[index].kind.name())
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
        self.malformed(at, problem, "define it first, or qualify it with its instance: Instance.Set")
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
        if self.depth == MAX_DEPTH {
            let problem = format!("more than {MAX_DEPTH} files that include each other");
            return Err(self.malformed(at, problem, "does a file include itself?"));
        }
        if self.files.len() == MAX_FILES {
            let problem = format!("more than {MAX_FILES} files are included");
            return Err(self.malformed(at, problem, "join them, or include each of them once"));
        }
        let bytes = crate::whole_file::read(&path).map_err(|reason| {
            let problem = format!("the file {} cannot be read: {reason}", path.display());
            self.malformed(at, problem, "paths are relative to the file that includes, or to the first one")
        })?;
        self.depth += 1;
        self.file(&path, without_mark(&bytes))?;
        self.depth -= 1;
        Ok(())
    }
}

/// The text found, short enough for a message.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
