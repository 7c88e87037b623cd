//! Nastran: bulk data with grid points and elements (MSC Nastran Quick Reference Guide, "Bulk Data Entries").

mod card;
mod element;
mod names;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use emmy::mesh::CellKind;

use super::abaqus::{At, Deck, Element, Of, assembled};
use super::{MeshError, MeshFile, MeshOptions, Place, Result, without_mark};
use crate::message::counted;
use card::Card;

/// The mesh in the bytes of a bulk data file.
pub(super) fn mesh(file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<MeshFile> {
    let text = String::from_utf8_lossy(without_mark(bytes));
    let mut reader = Reader { file, deck: Deck::default(), elements: Vec::new(), omitted: BTreeMap::new() };
    reader.deck.files.push(file.to_path_buf());
    for card in card::cards(&text) {
        reader.card(&card)?;
    }
    let deck = reader.deck(&names::properties(&text), &options.links)?;
    assembled::mesh(file, &deck).map_err(|error| match error {
        MeshError::NoCells { file, .. } => MeshError::NoCells {
            file,
            advice: "the body must be in it as GRID and CTETRA, CPENTA, CHEXA or CPYRAM cards",
        },
        error => error,
    })
}

/// An element with its nodes in the order of VTK.
#[derive(Debug)]
struct Raw {
    number: u64,
    kind: CellKind,
    property: u64,
    nodes: Vec<u64>,
    at: At,
}

/// Everything read so far.
struct Reader<'a> {
    file: &'a Path,
    deck: Deck,
    elements: Vec<Raw>,
    /// Elements that are not read, counted by the names of their cards.
    omitted: BTreeMap<String, usize>,
}

impl Reader<'_> {
    fn card(&mut self, card: &Card<'_>) -> Result<()> {
        match card.name.as_str() {
            "GRID" => self.grid(card),
            "GRDSET" => self.check_system(card, card.field(1)),
            "SPC" => self.constraint(card, &[card.field(1), card.field(4)]),
            "SPC1" => self.constraint(card, card.fields.get(2..).unwrap_or_default()),
            "INCLUDE" => {
                Err(self.malformed(card, "INCLUDE is not supported".into(), "join the files into one"))
            }
            name => match element::rows(name) {
                Some(rows) => self.element(card, rows),
                None => {
                    if element::is_omitted(name) {
                        *self.omitted.entry(name.to_string()).or_default() += 1;
                    }
                    Ok(())
                }
            },
        }
    }

    fn grid(&mut self, card: &Card<'_>) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of a grid point")?;
        self.check_system(card, card.field(1))?;
        let mut point = [0.0; 3];
        for (axis, x) in point.iter_mut().enumerate() {
            *x = self.real(card, card.field(2 + axis))?;
        }
        if point.iter().any(|x| !x.is_finite()) {
            return Err(MeshError::CoordinateNotFinite { place: self.place(card), node: number });
        }
        let body = &mut self.deck.root;
        if body.nodes.insert(number, body.points.len() as u32).is_some() {
            return Err(MeshError::Duplicate { place: self.place(card), what: "node", number });
        }
        body.points.push(point);
        Ok(())
    }

    fn check_system(&self, card: &Card<'_>, system: &str) -> Result<()> {
        if matches!(system, "" | "0") {
            return Ok(());
        }
        let problem = format!("coordinates in system {system} are not supported");
        Err(self.malformed(card, problem, "write all grid points in the basic system, which has number 0"))
    }

    fn element(&mut self, card: &Card<'_>, rows: &'static [element::Row]) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of an element")?;
        // A property that is left out has the number of the element.
        let property = match card.field(1) {
            "" => number,
            field => self.number(card, field, "a property")?,
        };
        let nodes = card.fields.get(2..).unwrap_or_default();
        let Some((kind, order)) = element::row(rows, nodes) else {
            let count = nodes.iter().filter(|field| !field.is_empty()).count();
            let counts =
                rows.iter().map(|(kind, _)| kind.n_nodes().to_string()).collect::<Vec<_>>().join(" or ");
            let problem = format!("element {number} ({}) has {count} nodes instead of {counts}", card.name);
            return Err(self.malformed(
                card,
                problem,
                "midside nodes must be there for every edge, or for none",
            ));
        };
        let nodes = order.iter().map(|&local| self.number(card, nodes[local], "a grid point"));
        let nodes = nodes.collect::<Result<Vec<u64>>>()?;
        self.elements.push(Raw { number, kind, property, nodes, at: at(card) });
        Ok(())
    }

    /// Grid points of a set of constraints: numbers, or `FIRST THRU LAST`.
    fn constraint(&mut self, card: &Card<'_>, fields: &[&str]) -> Result<()> {
        let set = self.number(card, card.field(0), "the number of a set")?;
        let name = format!("spc_{set}");
        if let [first, thru, last, ..] = fields
            && thru.eq_ignore_ascii_case("THRU")
        {
            let first = self.number(card, first, "a grid point")?;
            let last = self.number(card, last, "a grid point")?;
            // Numbers without a grid point are left out.
            let known = self.deck.root.nodes.keys().copied().filter(|node| (first..=last).contains(node));
            let mut known: Vec<u64> = known.collect();
            known.sort_unstable();
            known.into_iter().for_each(|node| self.deck.root.set_mut(Of::Nodes, &name).push(None, node));
            return Ok(());
        }
        for field in fields.iter().filter(|field| !field.is_empty()) {
            let node = self.number(card, field, "a grid point")?;
            self.deck.root.set_mut(Of::Nodes, &name).push(None, node);
        }
        Ok(())
    }

    fn number(&self, card: &Card<'_>, field: &str, what: &str) -> Result<u64> {
        field.parse().map_err(|_| {
            let problem = format!("expected {what} in {}, found \"{}\"", card.name, shown(field));
            self.malformed(
                card,
                problem,
                "fields are 8 columns wide, 16 with a `*` after the name, or end at commas",
            )
        })
    }

    fn real(&self, card: &Card<'_>, field: &str) -> Result<f64> {
        card::real(field).ok_or_else(|| {
            let problem = format!("expected a coordinate in {}, found \"{}\"", card.name, shown(field));
            self.malformed(
                card,
                problem,
                "fields are 8 columns wide, 16 with a `*` after the name, or end at commas",
            )
        })
    }

    fn place(&self, card: &Card<'_>) -> Place {
        Place::line(self.file, card.line as usize)
    }

    fn malformed(&self, card: &Card<'_>, problem: String, advice: &'static str) -> MeshError {
        MeshError::Malformed { place: self.place(card), problem, advice }
    }

    /// Cells, and elements of lower dimension as groups of facets or nodes, by the names of their properties.
    fn deck(mut self, names: &HashMap<u64, String>, links: &[String]) -> Result<Deck> {
        let elements = std::mem::take(&mut self.elements);
        let dimension = elements.iter().map(|element| element.kind.dimension()).max().unwrap_or(0).max(2);
        // Gmsh gives a volume, a surface and a curve the same number.
        let mut highest = HashMap::<u64, usize>::new();
        for element in &elements {
            let dimension = highest.entry(element.property).or_default();
            *dimension = element.kind.dimension().max(*dimension);
        }
        let mut n_lines = 0;
        for Raw { number, kind, property, nodes, at } in elements {
            let mut name = names.get(&property).cloned().unwrap_or_else(|| format!("pid_{property}"));
            if kind.dimension() < highest[&property] {
                name += if kind.dimension() == 2 { "-faces" } else { "-lines" };
            }
            let is_cell = kind.dimension() == dimension || kind == CellKind::Line2 && links.contains(&name);
            n_lines += usize::from(kind == CellKind::Line2 && !is_cell);
            let body = &mut self.deck.root;
            let is_repeated =
                body.element_index.contains_key(&number) || body.lower_index.contains_key(&number);
            if is_repeated {
                return Err(MeshError::Duplicate { place: self.deck.place(at), what: "element", number });
            }
            let (list, index) = match is_cell {
                true => (&mut body.elements, &mut body.element_index),
                false => (&mut body.lower, &mut body.lower_index),
            };
            index.insert(number, list.len() as u32);
            list.push(Element { number, kind, n_nodes: nodes.len(), nodes: body.connectivity.len(), at });
            body.connectivity.extend(nodes);
            body.set_mut(Of::Elements, &name).push(None, number);
        }
        self.note(n_lines, dimension);
        Ok(self.deck)
    }

    fn note(&mut self, n_lines: usize, dimension: usize) {
        if n_lines > 0 && dimension == 3 {
            let lines = counted(n_lines, "line element is", "line elements are");
            self.deck.notes.insert(format!("{lines} read as the nodes at the ends, not as bars"));
        }
        if !self.omitted.is_empty() {
            let all: Vec<String> =
                self.omitted.iter().map(|(name, count)| format!("{count} {name}")).collect();
            self.deck.notes.insert(format!("elements that are not read: {}", all.join(", ")));
        }
    }
}

fn at(card: &Card<'_>) -> At {
    At { file: 0, line: card.line }
}

/// The text found, short enough for a message.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
