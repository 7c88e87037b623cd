//! Nastran: bulk data with grid points and elements (MSC Nastran Quick Reference Guide, "Bulk Data Entries").

mod assembly;
mod beside;
mod card;
mod element;
mod names;
mod range;
mod repeat;
mod source;
mod system;
mod table;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use emmy::mesh::CellKind;

use super::abaqus::{At, Deck, assembled};
use super::account::{self, Account, Treatment};
use super::{MeshError, MeshFile, MeshOptions, Result};
use crate::message::counted;
use beside::Beside;
use card::{Bulk, Card};
use range::Range;
use source::Sources;
use system::{Grid, Placement, Points, Shape, System};

pub(in crate::mesh) use table::TABLE;

/// Advice for a file without a body.
const ADVICE: &str = "the body must be in it as GRID and CTETRA, CPENTA, CHEXA or CPYRAM cards";

const FIELDS: &str = "fields are 8 columns wide, 16 with a `*` after the name, or end at commas";

/// The mesh in the bytes of a bulk data file.
pub(super) fn mesh(file: &Path, bytes: &[u8], options: &MeshOptions) -> Result<MeshFile> {
    let sources = Sources::read(file, bytes)?;
    let bulk = card::bulk(sources.lines());
    let mut names = HashMap::new();
    sources.texts().for_each(|text| names.extend(names::properties(text)));
    let mut reader = Reader::default();
    reader.deck.files = sources.files.clone();
    reader.is_of_gmsh = sources.texts().any(|text| text.starts_with("$ Created by Gmsh"));
    reader.notes_on(&bulk);
    reader.beside.sets = beside::chosen_sets(sources.lines().map(|(line, _)| line));
    let read = reader.complete(bulk.cards, &names, options);
    let mesh = read.and_then(|()| assembled::mesh(file, &reader.deck));
    let mesh = mesh.map_err(|error| reader.explained(error))?;
    let n_unused = reader.deck.root.points.len() - mesh.mesh.n_nodes();
    let mut mesh = MeshFile { files: sources.files, entries: reader.beside.entries, ..mesh };
    mesh.count_unused(n_unused, n_unused.saturating_sub(reader.beside.n_used));
    Ok(mesh)
}

/// An element with its nodes in the order of VTK.
#[derive(Debug)]
struct Raw {
    number: u64,
    card: &'static str,
    kind: CellKind,
    property: u64,
    /// A missing midside node is 0.
    nodes: Vec<u64>,
    at: At,
}

/// The kind that a property gives to its triangles and quadrilaterals.
#[derive(Debug, Clone, PartialEq)]
enum Sheet {
    PlaneStrain,
    /// Shells, by this card.
    Shell(String),
}

/// Everything read so far.
#[derive(Debug, Default)]
struct Reader {
    deck: Deck,
    account: Account,
    is_of_gmsh: bool,
    /// Notes on lines that are not read.
    unread: Vec<String>,
    /// Cards with more fields than they can have: their number, and the first one.
    too_long: Option<(usize, At)>,
    grids: Vec<Grid>,
    systems: HashMap<u64, System>,
    /// `GRDSET`, for grid points that name none.
    defaults: Option<Defaults>,
    /// Constraints of grid points by themselves; none: those of `GRDSET`.
    constraints: Vec<Option<String>>,
    /// Numbers of the cards `SPC` and `SPC1`.
    n_supports: BTreeMap<String, usize>,
    /// Ranges of grid points of a group; the grid points may come before or after them.
    ranges: Vec<(String, Range)>,
    /// Properties and grid points of springs, dampers and masses.
    ends: Vec<(u64, u64)>,
    elements: Vec<Raw>,
    sheets: HashMap<u64, Sheet>,
    /// Properties of bars, beams, springs, ...
    bars: HashSet<u64>,
    /// Rigid elements, equations, masses and springs.
    beside: Beside,
}

/// System, system of displacements and constraints of grid points that name none.
#[derive(Debug)]
struct Defaults {
    system: u64,
    displacement: u64,
    components: String,
}

impl Reader {
    fn notes_on(&mut self, bulk: &Bulk<'_>) {
        let counted_at = |found, one: &str, many: &str, rest: &str| self.counted_at(found, one, many, rest);
        let [no_card, no_line] =
            ["no card, here for the first time", "that is not there, here for the first time"];
        // An included file may have the end.
        let of_file = match (bulk.end, bulk.rest) {
            (Some(end), Some((_, rest))) if end.file != rest.file => {
                format!(" of {}", self.deck.place(end))
            }
            _ => String::new(),
        };
        let [line_is, lines_are] =
            [format!("line after ENDDATA{of_file} is"), format!("lines after ENDDATA{of_file} are")];
        let unread = [
            counted_at(bulk.stray, "line continues", "lines continue", no_card),
            counted_at(bulk.rest, &line_is, &lines_are, "not read"),
        ];
        let notes = [
            counted_at(bulk.open, "line announces a continuation", "lines announce a continuation", no_line),
            bulk.end.is_none().then(|| {
                format!(
                    "{}: there is no ENDDATA at the end; is the file cut off?",
                    self.deck.files[0].display()
                )
            }),
        ];
        self.unread = unread.into_iter().flatten().collect();
        self.deck.notes.extend(self.unread.iter().cloned().chain(notes.into_iter().flatten()));
    }

    /// A note on lines with the place of the first one.
    fn counted_at(&self, found: Option<(usize, At)>, one: &str, many: &str, rest: &str) -> Option<String> {
        found.map(|(n, at)| format!("{}: {} {rest}", self.deck.place(at), counted(n, one, many)))
    }

    /// The error for a file without a body; it lists the elements that are there and the lines that are not read.
    fn explained(&self, error: MeshError) -> MeshError {
        let error = match (error, self.account.left_out()) {
            (MeshError::NoCells { file, .. }, Some(found)) => {
                MeshError::NothingSolid { file, found, advice: ADVICE.to_string() }
            }
            (MeshError::NoCells { file, .. }, None) => MeshError::NoCells { file, advice: ADVICE },
            (error, _) => error,
        };
        let suspects: Vec<String> = self.unread.iter().cloned().chain(self.account.suspects(TABLE)).collect();
        error.with_suspects((!suspects.is_empty()).then(|| suspects.join("; ")))
    }

    /// Reads all cards, with the copies that `=` makes of them.
    fn cards(&mut self, cards: Vec<Card<'_>>) -> Result<()> {
        let mut above: Option<Card<'_>> = None;
        let mut pattern: Option<Card<'_>> = None;
        let mut n_copies = 0_usize;
        for card in cards {
            let wanted = repeat::copies(&card);
            let is_read = || account::treatment(TABLE, &card.name) == Some(Treatment::Read);
            let is_repeated =
                repeat::repeats(&card, above.as_ref()) && (card.name.starts_with('=') || is_read());
            if wanted.is_none() && !is_repeated {
                self.card(&card)?;
                (above, pattern) = (Some(card), None);
                continue;
            }
            if wanted.is_none() {
                pattern = Some(card.clone());
            }
            let (Some(last), Some(pattern)) = (&mut above, &mut pattern) else {
                let problem =
                    format!("`{}` repeats the card above, and there is none with `=`", shown(&card.name));
                return Err(self.malformed(card.at, problem, "write the cards out"));
            };
            pattern.at = card.at;
            n_copies = n_copies.saturating_add(wanted.unwrap_or(1));
            if n_copies > repeat::MAX_COPIES {
                let problem = format!("lines with `=` ask for more than {} cards", repeat::MAX_COPIES);
                return Err(self.malformed(card.at, problem, "write the cards out"));
            }
            for _ in 0..wanted.unwrap_or(1) {
                *last = repeat::repeated(last, pattern).map_err(|what| {
                    let problem =
                        format!("the field {} of {} cannot be incremented", shown(&what), last.name);
                    self.malformed(card.at, problem, "write the cards out")
                })?;
                self.card(last)?;
            }
        }
        Ok(())
    }

    fn card(&mut self, card: &Card<'_>) -> Result<()> {
        let name = shown(&card.name);
        let is_solid = || name.starts_with('C') && table::SOLID.iter().any(|word| name.contains(word));
        match account::treatment(TABLE, &name) {
            Some(Treatment::Read) => self.read(card),
            None if is_solid() => self.refused(card),
            Some(Treatment::Refused) => self.refused(card),
            _ => {
                self.account.add(TABLE, &name);
                self.keep_ends(card);
                self.check_property(card);
                Ok(())
            }
        }
    }

    fn read(&mut self, card: &Card<'_>) -> Result<()> {
        if table::n_fields(&card.name).is_some_and(|most| card.fields.len() > most) {
            card::count(&mut self.too_long, card.at);
        }
        // CBUSH is a line, too, and PBUSH the property of one.
        if self.beside.keep(card) && !card.name.ends_with("BUSH") {
            self.keep_ends(card);
            return Ok(());
        }
        match card.name.as_str() {
            "GRID" => self.grid(card),
            "GRDSET" => self.grid_defaults(card),
            "CORD1R" => self.by_grids(card, Shape::Rectangular),
            "CORD1C" => self.by_grids(card, Shape::Cylindrical),
            "CORD1S" => self.by_grids(card, Shape::Spherical),
            "CORD2R" => self.by_points(card, Shape::Rectangular),
            "CORD2C" => self.by_points(card, Shape::Cylindrical),
            "CORD2S" => self.by_points(card, Shape::Spherical),
            "SPC" => self.constraint(card, &[card.field(1), card.field(4)]),
            "SPC1" => self.constraint(card, &card.from(2)),
            "INCLUDE" => Err(self.malformed(card.at, "INCLUDE with a comma".into(), "write INCLUDE 'FILE'")),
            "PLPLANE" => self.property(card, Sheet::PlaneStrain),
            // MID2 = -1 is plane strain.
            "PSHELL" if card.field(3) == "-1" => self.property(card, Sheet::PlaneStrain),
            "PSHELL" | "PCOMP" | "PCOMPG" => self.property(card, Sheet::Shell(card.name.clone())),
            name => match element::rows(name, self.is_of_gmsh) {
                Some((known, rows)) => self.element(card, known, rows),
                // A property of lines.
                None => {
                    self.bars.extend(card.field(0).parse::<u64>());
                    Ok(())
                }
            },
        }
    }

    fn refused(&self, card: &Card<'_>) -> Result<()> {
        let name = shown(&card.name);
        let what = match name.starts_with('C') && name != "CGEN" {
            true => format!("solid cells of the kind {name} are not read"),
            false => format!("{name} makes grid points or cells, and is not read"),
        };
        let advice = match name.ends_with("_*") {
            true => {
                "meshio changes the order of their nodes in large fields; write `cell_format=\"fixed-small\"` or a .vtu with it"
            }
            false => "write GRID and CTETRA, CPENTA, CHEXA or CPYRAM cards, all in one bulk data section",
        };
        Err(self.malformed(card.at, what, advice))
    }

    fn grid(&mut self, card: &Card<'_>) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of a grid point")?;
        let system = self.system(card, card.field(1))?;
        let mut coordinates = [0.0; 3];
        for (axis, x) in coordinates.iter_mut().enumerate() {
            *x = self.real(card, card.field(2 + axis))?;
        }
        // -1 is a point of a fluid.
        let displacement = match card.field(5) {
            "-1" => Some(0),
            field => self.system(card, field)?,
        };
        let components = self.components(card, card.field(6))?;
        let body = &mut self.deck.root;
        if body.nodes.insert(number, body.points.len() as u32).is_some() {
            return Err(MeshError::Duplicate { place: self.deck.place(card.at), what: "node", number });
        }
        body.points.push(coordinates);
        self.grids.push(Grid { number, system, coordinates, displacement, at: card.at });
        self.constraints.push(components);
        Ok(())
    }

    /// `GRDSET`.
    fn grid_defaults(&mut self, card: &Card<'_>) -> Result<()> {
        let system = self.system(card, card.field(1))?.unwrap_or(0);
        let displacement = self.system(card, card.field(5)).ok().flatten().unwrap_or(0);
        let components = self.components(card, card.field(6))?.unwrap_or_default();
        match self.defaults.replace(Defaults { system, displacement, components }) {
            None => Ok(()),
            Some(_) => Err(self.malformed(card.at, "a second GRDSET".into(), "remove one of the two")),
        }
    }

    /// A coordinate system; none for a blank field.
    fn system(&self, card: &Card<'_>, field: &str) -> Result<Option<u64>> {
        let number = |field| self.number(card, field, "the number of a coordinate system");
        (!field.is_empty()).then(|| number(field)).transpose()
    }

    /// The translations x, y, z (1, 2, 3) among constrained components; none for a blank field.
    fn components(&self, card: &Card<'_>, field: &str) -> Result<Option<String>> {
        if field.is_empty() {
            return Ok(None);
        }
        if field.bytes().any(|c| !(b'0'..=b'6').contains(&c)) {
            let problem =
                format!("expected constrained components in {}, found \"{}\"", card.name, shown(field));
            return Err(self.malformed(card.at, problem, FIELDS));
        }
        Ok(Some(['1', '2', '3'].into_iter().filter(|&c| field.contains(c)).collect()))
    }

    /// One or two systems by three grid points each.
    fn by_grids(&mut self, card: &Card<'_>, shape: Shape) -> Result<()> {
        for first in [0, 4].into_iter().filter(|&first| first == 0 || !card.field(first).is_empty()) {
            let number = self.number(card, card.field(first), "the number of a coordinate system")?;
            let mut points = [0; 3];
            for (i, point) in points.iter_mut().enumerate() {
                *point = self.number(card, card.field(first + 1 + i), "a grid point")?;
            }
            self.add_system(card, number, System { shape, points: Points::Grids(points), at: card.at })?;
        }
        Ok(())
    }

    fn by_points(&mut self, card: &Card<'_>, shape: Shape) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of a coordinate system")?;
        let system = self.system(card, card.field(1))?.unwrap_or(0);
        let mut points = [[0.0; 3]; 3];
        for (i, x) in points.iter_mut().flatten().enumerate() {
            *x = self.real(card, card.field(2 + i))?;
        }
        self.add_system(card, number, System { shape, points: Points::Given(system, points), at: card.at })
    }

    fn add_system(&mut self, card: &Card<'_>, number: u64, system: System) -> Result<()> {
        match self.systems.insert(number, system) {
            None if number > 0 => Ok(()),
            _ => {
                let place = self.deck.place(card.at);
                Err(MeshError::Duplicate { place, what: "coordinate system", number })
            }
        }
    }

    fn property(&mut self, card: &Card<'_>, sheet: Sheet) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of a property")?;
        self.sheets.insert(number, sheet);
        Ok(())
    }

    fn element(&mut self, card: &Card<'_>, name: &'static str, rows: &'static [element::Row]) -> Result<()> {
        let number = self.number(card, card.field(0), "the number of an element")?;
        // A property that is left out has the number of the element.
        let property = match card.field(1) {
            "" => number,
            field => self.number(card, field, "a property")?,
        };
        let fields = card.from(2);
        let (kind, order) = match element::row(rows, &fields) {
            Ok(row) => row,
            // A spring to the ground.
            Err(1) if rows[0].0 == CellKind::Line2 => {
                if name != "CBUSH" {
                    self.account.leave_out(name);
                }
                self.keep_ends(card);
                return Ok(());
            }
            Err(count) => {
                let counts: Vec<String> = rows.iter().map(|(kind, _)| kind.n_nodes().to_string()).collect();
                let counts = counts.join(" or ");
                let problem = format!("element {number} ({name}) has {count} nodes instead of {counts}");
                return Err(self.malformed(card.at, problem, "no corner may be missing"));
            }
        };
        let node = |&local: &usize| match fields.get(local).copied().unwrap_or_default() {
            field if element::is_blank(field) => Ok(0),
            field => self.number(card, field, "a grid point"),
        };
        let nodes = order.iter().map(node).collect::<Result<Vec<u64>>>()?;
        self.elements.push(Raw { number, card: name, kind, property, nodes, at: card.at });
        Ok(())
    }

    /// The grid points of a spring, damper or mass with a property, as a group of nodes.
    fn keep_ends(&mut self, card: &Card<'_>) {
        let ends = match card.name.as_str() {
            "CELAS1" | "CDAMP1" | "CMASS1" => [2, 4],
            "CBUSH" | "CBUSH1D" | "CGAP" | "CVISC" => [2, 3],
            _ => return,
        };
        let Ok(property) = card.field(1).parse::<u64>() else { return };
        let nodes = ends.iter().filter_map(|&end| card.field(end).parse().ok());
        self.ends.extend(nodes.map(|node| (property, node)));
    }

    /// A fluid has solid cells, too.
    fn check_property(&mut self, card: &Card<'_>) {
        if card.name == "PSOLID" && card.field(6).to_ascii_uppercase().ends_with("FLUID") {
            self.account.leave_out("PSOLID of a fluid");
        }
    }

    /// Grid points of a set of constraints: numbers, and ranges `FIRST THRU LAST`, of which `EXCEPT` takes some out.
    fn constraint(&mut self, card: &Card<'_>, fields: &[&str]) -> Result<()> {
        let set = self.number(card, card.field(0), "the number of a set")?;
        let name = format!("spc_{set}");
        *self.n_supports.entry(card.name.clone()).or_default() += 1;
        let (ranges, others) = range::ranges(fields);
        let not_read = |field: &str| {
            let place = self.deck.place(card.at);
            format!("{place}: the field {} of {} is not read", shown(field), card.name)
        };
        let notes: Vec<String> = others.into_iter().map(not_read).collect();
        self.deck.notes.extend(notes);
        self.ranges.extend(ranges.into_iter().map(|range| (name.clone(), range)));
        Ok(())
    }

    fn number(&self, card: &Card<'_>, field: &str, what: &str) -> Result<u64> {
        field.parse().map_err(|_| {
            let problem = format!("expected {what} in {}, found \"{}\"", card.name, shown(field));
            self.malformed(card.at, problem, FIELDS)
        })
    }

    fn real(&self, card: &Card<'_>, field: &str) -> Result<f64> {
        card::real(field).ok_or_else(|| {
            let problem = format!("expected a coordinate in {}, found \"{}\"", card.name, shown(field));
            self.malformed(card.at, problem, FIELDS)
        })
    }

    fn malformed(&self, at: At, problem: String, advice: &'static str) -> MeshError {
        MeshError::Malformed { place: self.deck.place(at), problem, advice }
    }

    /// Places the grid points, when all coordinate systems are known.
    fn place_grids(&mut self) -> Result<()> {
        let default = self.defaults.as_ref().map_or(0, |defaults| defaults.system);
        let points = Placement::new(&self.deck, &self.systems, &self.grids, default).points()?;
        self.deck.root.points = points;
        Ok(())
    }
}

/// The text found, short enough for a message.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
