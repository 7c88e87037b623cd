//! Data lines.

use std::cmp::Ordering;

use emmy::mesh::CellKind;

use super::super::super::{MeshError, Result};
use super::super::body::{At, Element, Face, LeftOut, Member, Of, Row};
use super::super::element::{self, Role};
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
            Section::Surface { instance } => self.row(at, line, *instance)?,
            Section::Card => {
                if let Some(card) = self.body_mut().cards.last_mut() {
                    card.lines.push((at, fields(line)));
                }
            }
        }
        self.section = section;
        Ok(())
    }

    /// An element must be complete when its keyword ends.
    pub(super) fn close_section(&mut self) -> Result<()> {
        let Section::Elements(mut elements) = std::mem::replace(&mut self.section, Section::Skipped) else {
            return Ok(());
        };
        match elements.role {
            _ if elements.pending.is_empty() => Ok(()),
            Role::Cell(kind) => Err(self.wrong_node_count(&elements, kind.n_nodes())),
            Role::Lower(_, n_nodes) => Err(self.wrong_node_count(&elements, n_nodes)),
            Role::LeftOut(_) => self.element(&mut elements),
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
        // Beams have empty fields for nodes that they do not need; that of a connector is the ground.
        let may_be_empty = elements.may_be_grounded() || matches!(elements.role, Role::LeftOut(_));
        for field in line.trim_end_matches(',').split(',').map(str::trim) {
            if !(may_be_empty && field.is_empty()) {
                elements.pending.push(self.node_of_element(at, field)?);
            }
        }
        let n_numbers = elements.pending.len();
        let goes_on = comma || n_numbers - before >= FULL_LINE;
        let wanted = match elements.role {
            Role::Cell(kind) => kind.n_nodes(),
            Role::Lower(_, n_nodes) => n_nodes,
            // An element that is left out may have more or fewer nodes.
            Role::LeftOut(n_nodes) if n_numbers == 0 || goes_on && n_nodes.is_none_or(|n| n_numbers <= n) => {
                return Ok(());
            }
            Role::LeftOut(_) => return self.element(elements),
        };
        match n_numbers.cmp(&(1 + wanted)) {
            Ordering::Less if elements.is_grounded() => self.element(elements),
            Ordering::Less if goes_on => Ok(()),
            Ordering::Equal => self.element(elements),
            _ => Err(self.wrong_node_count(elements, wanted)),
        }
    }

    /// The number of an element or of its node; of a node of an instance in an element of the assembly: `Arm-1.7`.
    fn node_of_element(&self, at: At, field: &str) -> Result<Member> {
        let of_instance = || {
            let (instance, number) = field.rsplit_once('.')?;
            Some(Member::one(Some(self.instance_index(instance)?), number.parse().ok()?))
        };
        match field.parse() {
            Ok(number) => Ok(Member::one(None, number)),
            Err(_) => of_instance()
                .map_or_else(|| self.number(at, field).map(|number| Member::one(None, number)), Ok),
        }
    }

    fn wrong_node_count(&self, elements: &Elements, wanted: usize) -> MeshError {
        let Elements { element_type, pending, at, .. } = elements;
        let number = pending[0].first;
        let found = pending.len() - 1;
        let problem =
            format!("element {number} of type {element_type} has {found} nodes instead of {wanted}");
        self.malformed(*at, problem, "correct its type or its nodes; a line that continues ends with a comma")
    }

    fn element(&mut self, elements: &mut Elements) -> Result<()> {
        let number = elements.pending[0].first;
        if self.body().has_element(number) {
            return Err(MeshError::Duplicate { place: self.place(elements.at), what: "element", number });
        }
        let joins_instances = elements.pending.iter().any(|node| node.instance.is_some());
        match elements.role {
            Role::Cell(kind) if joins_instances && kind.dimension() > 1 => {
                let problem =
                    format!("element {number} of type {} has nodes of an instance", elements.element_type);
                let advice = "write solid elements into the part that they belong to";
                return Err(self.malformed(elements.at, problem, advice));
            }
            Role::Cell(kind) if !elements.is_grounded() => {
                if kind != CellKind::Line2 && !std::mem::replace(&mut elements.is_noted, true) {
                    self.notes.extend(element::note(&elements.element_type, kind));
                }
                let element = self.new_element(elements, kind);
                let body = self.body_mut();
                body.element_index.insert(number, body.elements.len() as u32);
                body.elements.push(element);
            }
            Role::Lower(kind, _) if !joins_instances => {
                let element = self.new_element(elements, kind);
                let body = self.body_mut();
                body.lower_index.insert(number, body.lower.len() as u32);
                body.lower.push(element);
            }
            _ => {
                let nodes = elements.pending[1..].to_vec();
                let body = self.body_mut();
                body.left_out_index.insert(number, body.left_out.len() as u32);
                body.left_out.push(LeftOut { element_type: elements.type_index, number, nodes });
            }
        }
        if let Some(set) = &elements.set {
            self.body_mut().set_mut(Of::Elements, set).push(None, number);
        }
        elements.pending.clear();
        Ok(())
    }

    /// An element of this body, with its nodes in the connectivity.
    fn new_element(&mut self, elements: &Elements, kind: CellKind) -> Element {
        let (number, nodes) = (elements.pending[0].first, &elements.pending[1..]);
        let body = self.body_mut();
        let start = body.connectivity.len();
        body.connectivity.extend(nodes.iter().map(|node| node.first));
        if nodes.iter().any(|node| node.instance.is_some()) {
            body.joined.insert(start, nodes.to_vec());
        }
        let element_type = Some(elements.type_index);
        Element { number, kind, n_nodes: nodes.len(), nodes: start, element_type, at: elements.at }
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

    fn row(&mut self, at: At, line: &str, instance: Option<u32>) -> Result<()> {
        let fields = fields(line);
        let fields_after = fields.get(1).cloned();
        let Some(surface) = self.body().surfaces.last() else { return Ok(()) };
        let rows = match (surface.combine, surface.of) {
            (Some(_), _) => {
                fields.into_iter().filter(|name| !name.is_empty()).map(|name| (name, None)).collect()
            }
            (None, Of::Nodes) => vec![(fields.first().cloned().unwrap_or_default(), None)],
            (None, Of::Elements) => {
                let face = self.face(at, fields.get(1))?;
                vec![(fields.first().cloned().unwrap_or_default(), Some(face))]
            }
        };
        let is_of_nodes = surface.combine.is_none() && surface.of == Of::Nodes;
        let area = fields_after.filter(|area| is_of_nodes && !area.is_empty());
        let rows =
            rows.into_iter().map(|(target, face)| Row { target, face, instance, area: area.clone(), at });
        if let Some(surface) = self.body_mut().surfaces.last_mut() {
            surface.rows.extend(rows);
        }
        Ok(())
    }

    /// The faces of a label: `S1` ... `S6` of solid elements, `SPOS` and `SNEG` of shells, `E1` of edges, `END1` of
    /// ends of beams.
    fn face(&self, at: At, field: Option<&String>) -> Result<Face> {
        let label = field.map(|field| field.to_ascii_uppercase()).unwrap_or_default();
        let number = |prefix| label.strip_prefix(prefix).and_then(|digits| digits.parse().ok());
        match label.as_str() {
            "" => return Ok(Face::Free),
            "SPOS" | "SNEG" => return Ok(Face::Own),
            _ => {}
        }
        let edge = || number("END").or_else(|| number("E")).map(|_: u8| Face::Edge);
        number("S").map(Face::Number).or_else(edge).ok_or_else(|| self.unknown_face(at, &label))
    }

    pub(in crate::mesh::abaqus) fn unknown_face(&self, at: At, label: &str) -> MeshError {
        let problem = format!("expected a face S1 ... S6 of solid elements, found \"{}\"", shown(label));
        self.malformed(
            at,
            problem,
            "name the face of each element or element set, or none for all free faces",
        )
    }

    fn number(&self, at: At, field: &str) -> Result<u64> {
        field.parse().map_err(|_| self.not_a_number(at, "a whole number", field))
    }

    /// A number; an empty field is zero, and Fortran's `1.D0` is valid.
    fn real(&self, at: At, field: &str) -> Result<f64> {
        if field.is_empty() {
            return Ok(0.0);
        }
        let value = field.parse().or_else(|_| field.replace(['d', 'D'], "e").parse());
        value.map_err(|_| self.not_a_number(at, "a number", field))
    }

    fn not_a_number(&self, at: At, wanted: &str, field: &str) -> MeshError {
        let field = shown(field);
        if field.starts_with('<') {
            let advice = "write its value; Abaqus writes the file with all values when it checks the data";
            return self.malformed(at, format!("the parameter {field} is not evaluated"), advice);
        }
        let problem = format!("expected {wanted}, found \"{field}\"");
        self.malformed(at, problem, "is a comma or a line missing?")
    }
}
