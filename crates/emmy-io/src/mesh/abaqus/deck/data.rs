//! Data lines.

use std::cmp::Ordering;

use super::super::super::{MeshError, Result};
use super::super::body::{At, Element, Member, Of, Row};
use super::super::keyword::fields;
use super::{Deck, Elements, Scope, Section, shown};

/// Numbers in a full line of Abaqus: after these, an element continues in the next line, with or without a comma.
const FULL_LINE: usize = 16;

impl Deck {
    pub(super) fn data(&mut self, at: At, line: &str) -> Result<()> {
        let mut section = std::mem::replace(&mut self.section, Section::Skipped);
        match &mut section {
            Section::Start => {
                let problem =
                    format!("expected a keyword such as *Heading or *Node, found \"{}\"", shown(line));
                return Err(self.malformed(at, problem, "is it an Abaqus input file?"));
            }
            Section::Skipped => {}
            Section::Placement => self.placement(at, line)?,
            Section::Nodes { set } => self.node(at, line, set.as_deref())?,
            Section::Elements(elements) => self.element_line(at, line, elements)?,
            Section::Set { of, name, instance, generate: true } => {
                self.range(at, line, *of, name, *instance)?
            }
            Section::Set { of, name, instance, .. } => self.set_line(at, line, *of, name, *instance)?,
            Section::Surface { of, instance } => self.row(at, line, *of, *instance)?,
        }
        self.section = section;
        Ok(())
    }

    /// An element must be complete when its keyword ends.
    pub(super) fn close_section(&mut self) -> Result<()> {
        match &self.section {
            Section::Elements(elements) if !elements.pending.is_empty() => {
                Err(self.wrong_node_count(elements))
            }
            _ => Ok(()),
        }
    }

    fn placement(&mut self, at: At, line: &str) -> Result<()> {
        let values = fields(line).iter().map(|field| self.real(at, field)).collect::<Result<Vec<f64>>>()?;
        let Scope::Instance(instance) = self.scope else { return Ok(()) };
        let added = self.instances[instance].placement.add(&values);
        added.map_err(|problem| self.malformed(at, problem.to_string(), "correct the data of *Instance"))
    }

    fn node(&mut self, at: At, line: &str, set: Option<&str>) -> Result<()> {
        let mut fields = line.split(',').map(str::trim);
        let number = self.number(at, fields.next().unwrap_or_default())?;
        let mut point = [0.0; 3];
        for (axis, x) in point.iter_mut().enumerate() {
            let Some(field) = fields.next() else {
                // The third coordinate of a model in the plane is left out.
                if axis == 2 {
                    break;
                }
                let problem = format!("node {number} has fewer than two coordinates");
                return Err(self.malformed(at, problem, "is the file cut off?"));
            };
            *x = self.real(at, field)?;
        }
        if point.iter().any(|x| !x.is_finite()) {
            return Err(MeshError::CoordinateNotFinite { place: self.place(at), node: number });
        }
        let body = self.body_mut();
        if body.nodes.insert(number, body.points.len() as u32).is_some() {
            return Err(MeshError::Duplicate { place: self.place(at), what: "node", number });
        }
        body.points.push(point);
        if let Some(set) = set {
            body.set_mut(Of::Nodes, set).push(None, number);
        }
        Ok(())
    }

    fn element_line(&mut self, at: At, line: &str, elements: &mut Elements) -> Result<()> {
        if elements.pending.is_empty() {
            elements.at = at;
        }
        let before = elements.pending.len();
        let comma = line.ends_with(',');
        for field in line.trim_end_matches(',').split(',') {
            elements.pending.push(self.number(at, field.trim())?);
        }
        let n_numbers = elements.pending.len();
        let goes_on = comma || n_numbers - before >= FULL_LINE;
        match n_numbers.cmp(&(1 + elements.n_nodes)) {
            Ordering::Less if goes_on => Ok(()),
            Ordering::Equal => self.element(elements),
            _ => Err(self.wrong_node_count(elements)),
        }
    }

    fn wrong_node_count(&self, elements: &Elements) -> MeshError {
        let Elements { element_type, n_nodes: wanted, pending, at, .. } = elements;
        let number = pending[0];
        let found = pending.len() - 1;
        let problem =
            format!("element {number} of type {element_type} has {found} nodes instead of {wanted}");
        self.malformed(*at, problem, "correct its type or its nodes; a line that continues ends with a comma")
    }

    fn element(&mut self, elements: &mut Elements) -> Result<()> {
        let Elements { kind, n_nodes, is_face, at, .. } = *elements;
        let body = self.body_mut();
        let number = elements.pending[0];
        let other = if is_face { &body.element_index } else { &body.lower_index };
        let is_known = other.contains_key(&number);
        let (list, index) = match is_face {
            true => (&mut body.lower, &mut body.lower_index),
            false => (&mut body.elements, &mut body.element_index),
        };
        if index.insert(number, list.len() as u32).is_some() || is_known {
            return Err(MeshError::Duplicate { place: self.place(at), what: "element", number });
        }
        list.push(Element { number, kind, n_nodes, nodes: body.connectivity.len(), at });
        body.connectivity.extend_from_slice(&elements.pending[1..]);
        if let Some(set) = &elements.set {
            body.set_mut(Of::Elements, set).push(None, number);
        }
        elements.pending.clear();
        Ok(())
    }

    /// A line `first, last[, step]` of a set with `generate`.
    fn range(&mut self, at: At, line: &str, of: Of, name: &str, instance: Option<u32>) -> Result<()> {
        let numbers =
            fields(line).iter().map(|field| self.number(at, field)).collect::<Result<Vec<u64>>>()?;
        let (first, last, step) = match numbers[..] {
            [first, last] => (first, last, 1),
            [first, last, step] if step > 0 => (first, last, step),
            _ => (1, 0, 1),
        };
        if first > last {
            let problem = format!("expected first, last and step of a set, found \"{}\"", shown(line));
            return Err(self.malformed(at, problem, "or leave out `generate` to list the members"));
        }
        self.body_mut().set_mut(of, name).members.push(Member { instance, first, last, step });
        Ok(())
    }

    fn set_line(&mut self, at: At, line: &str, of: Of, name: &str, instance: Option<u32>) -> Result<()> {
        for field in fields(line).iter().filter(|field| !field.is_empty()) {
            if let Ok(number) = field.parse() {
                self.body_mut().set_mut(of, name).push(instance, number);
                continue;
            }
            let members = self.members(self.body(), of, instance, field);
            let members = members.ok_or_else(|| self.unknown_set(at, of, field))?;
            self.body_mut().set_mut(of, name).extend(members);
        }
        Ok(())
    }

    fn row(&mut self, at: At, line: &str, of: Of, instance: Option<u32>) -> Result<()> {
        let fields = fields(line);
        let target = fields.first().cloned().unwrap_or_default();
        let face = match of {
            Of::Nodes => None,
            Of::Elements => Some(self.face(at, fields.get(1))?),
        };
        if let Some(surface) = self.body_mut().surfaces.last_mut() {
            surface.rows.push(Row { target, face, instance, at });
        }
        Ok(())
    }

    /// Number of a face `S1` ... `S6`.
    fn face(&self, at: At, field: Option<&String>) -> Result<u8> {
        let label = field.map(|field| field.to_ascii_uppercase()).unwrap_or_default();
        let number = label.strip_prefix('S').and_then(|digits| digits.parse().ok());
        let problem = || format!("expected a face S1 ... S6 of solid elements, found \"{}\"", shown(&label));
        number.ok_or_else(|| self.malformed(at, problem(), "name the face of each element or element set"))
    }

    fn number(&self, at: At, field: &str) -> Result<u64> {
        let problem = || format!("expected a whole number, found \"{}\"", shown(field));
        field.parse().map_err(|_| self.malformed(at, problem(), "is a comma or a line missing?"))
    }

    /// A number; an empty field is zero, and Fortran's `1.D0` is valid.
    fn real(&self, at: At, field: &str) -> Result<f64> {
        if field.is_empty() {
            return Ok(0.0);
        }
        let value = field.parse().or_else(|_| field.replace(['d', 'D'], "e").parse());
        let problem = || format!("expected a number, found \"{}\"", shown(field));
        value.map_err(|_| self.malformed(at, problem(), "is a comma or a line missing?"))
    }
}
