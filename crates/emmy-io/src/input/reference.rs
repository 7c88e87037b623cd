//! Tables of `book/src/input.md`, `book/src/results.md` and `book/src/materials.md`, written from the descriptions.
//!
//! A table stands between `<!-- table: NAME -->` and `<!-- end of table -->`; NAME is the name of a table of the input,
//! or one of [`TABLES`]. `EMMY_UPDATE_DOCS=1 cargo test -p emmy-io --lib reference` writes them, and the classes of the
//! materials in Python.

mod python;

use emmy::body::FieldName;
use emmy::internals::body::MODELS;
use emmy::internals::element::element;
use emmy::internals::material::{IfAbsent, Parameter};
use emmy::internals::time::SCHEMES;
use emmy::mesh::CellKind;

use super::description::{Key, Kind, Others, Rule, Section};
use super::{catalogue, energy, formulation, material, synonyms};
use crate::history::{ColumnInfo, every_column};
use crate::mesh::ENTRIES;
use crate::mesh::account::{Entries, Treatment};
use crate::properties::{MeasuredMaterial, measured};
use crate::units::{SYSTEMS, UnitSystem, described, exponents, gravity, shifted, written};

/// Writes a table as Markdown.
type Table = fn() -> String;

/// Tables that are not the keys of a table of the input.
const TABLES: [(&str, Table); 12] = [
    ("models", models),
    ("parameters", parameters),
    ("cells", cells),
    ("schemes", schemes),
    ("fields", fields),
    ("columns", columns),
    ("units", units),
    ("gmsh sections", || entries("Gmsh")),
    ("nastran cards", || entries("Nastran")),
    ("abaqus keywords", || entries("Abaqus")),
    ("vtk arrays", || entries("VTK")),
    ("measured materials", measured_materials),
];

fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | ").replace("|V|", "\\|V\\|"));
    let head_line = line(head.iter().map(|title| title.to_string()).collect());
    let rule = line(head.iter().map(|_| "---".to_string()).collect()).replace(' ', "");
    head_line + &rule + &rows.into_iter().map(line).collect::<String>()
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

/// Keys of a table of the input.
fn keys(section: &Section) -> String {
    let choice = section.choice();
    let row = |key: &Key| {
        let absent = match key.if_absent {
            _ if choice.contains(&key.name) => chosen(section).to_string(),
            IfAbsent::Required => "required".to_string(),
            IfAbsent::Value("{}") => "as below".to_string(),
            IfAbsent::Value(value) => shortened(value),
            IfAbsent::Means(meaning) => meaning.to_string(),
            IfAbsent::FromTwoOthers => TWO.to_string(),
        };
        vec![code(key.name), value(&key.kind, key.unit), absent, key.doc.clone()]
    };
    let other = |others: &Others| {
        vec!["any other name".to_string(), value(&others.kind, ""), String::new(), others.doc.to_string()]
    };
    let rows = section.keys.iter().map(row).chain(section.others.as_ref().map(other));
    table(&["key", "value", "default", "meaning"], rows)
}

fn chosen(section: &Section) -> &'static str {
    match section.rule {
        Rule::AtLeastOne(_) | Rule::Input(_) => "at least one of these",
        Rule::ExactlyOne(_) => "exactly one of these",
        Rule::Free | Rule::Region | Rule::TwoElasticConstants => "",
    }
}

/// A default; the page describes long lists in its text.
fn shortened(value: &str) -> String {
    match value.len() {
        0..60 => code(&value.replace('\'', "\"")),
        _ => "see below".to_string(),
    }
}

/// A kind of value with its unit.
fn value(kind: &Kind, unit: &str) -> String {
    let kind = of(kind);
    if unit.is_empty() { kind } else { format!("{kind} \\[{unit}\\]") }
}

fn of(kind: &Kind) -> String {
    match kind {
        Kind::Text => "text".to_string(),
        Kind::Column(_) => "name".to_string(),
        Kind::Number(bounds) => format!("number {bounds}").trim_end().to_string(),
        Kind::Whole(least, None) => format!("whole number ≥ {least}"),
        Kind::Whole(least, Some(most)) => format!("whole number from {least} to {most}"),
        Kind::Word(_, words, _) => {
            words.iter().map(|word| code(&format!("\"{word}\""))).collect::<Vec<_>>().join(", ")
        }
        Kind::Words(_, of) if matches!(**of, Kind::Text) => "list of texts".to_string(),
        Kind::Words(0, _) => "list of words".to_string(),
        Kind::Words(_, words) => format!("list of {}", of(words)),
        Kind::Scheme(_) => "scheme, see below".to_string(),
        Kind::True => code("true"),
        Kind::List(_, entry) if matches!(**entry, Kind::Table(_)) => "list of tables".to_string(),
        Kind::List(_, entry) if matches!(**entry, Kind::Number(_)) => "list of numbers".to_string(),
        Kind::List(_, entry) => format!("list: {} each", of(entry)),
        Kind::Exactly(length, entry) => match &**entry {
            Kind::Number(bounds) => format!("{length} numbers {bounds}").trim_end().to_string(),
            Kind::Whole(least, _) => format!("{length} whole numbers ≥ {least}"),
            Kind::Expression => format!("{length} numbers or [expressions](#loadbody_force)"),
            Kind::Text => format!("{length} names"),
            Kind::Exactly(inner, _) => format!("{length} × {inner} numbers"),
            entry => format!("{length} times {}", of(entry)),
        },
        Kind::Groups => "table of lists of whole numbers".to_string(),
        Kind::TimeFunction(_) => "[history](#loadhistory)".to_string(),
        Kind::Expression => "number or [expression](#loadbody_force)".to_string(),
        Kind::Field(vector) => of(vector),
        Kind::Either(kinds) => kinds.each_ref().map(of).join(", or "),
        Kind::Table(_) => "table".to_string(),
        Kind::Tables(..) => "table, or list of tables".to_string(),
    }
}

fn models() -> String {
    let row = |model: &emmy::internals::body::RegionModel| {
        let model = &model.model;
        vec![code(model.name), code(model.energy), model.purpose.to_string()]
    };
    let of_links = MODELS.iter().filter(|model| model.model.is_link()).map(row);
    let solids = MODELS.iter().filter(|model| !model.model.is_link()).map(row);
    let formula = vec![code(energy::NAME), energy::ENERGY.to_string(), energy::PURPOSE.to_string()];
    table(&["model", "strain energy", "for"], solids.chain([formula]).chain(of_links))
}

/// The default of an elastic constant.
const TWO: &str = "two of the elastic constants are given";

/// Parameters of all models; parameters shared by several models are listed once.
fn parameters() -> String {
    let mut rows: Vec<(Parameter, Vec<&str>)> = Vec::new();
    for model in MODELS.iter().map(|model| &model.model) {
        for parameter in model.every_parameter() {
            match rows.iter_mut().find(|row| row.0 == *parameter) {
                Some((_, names)) => names.push(model.name),
                None => rows.push((*parameter, vec![model.name])),
            }
        }
    }
    table(&["model", "parameter", "value", "default", "meaning"], rows.into_iter().map(parameter))
}

fn parameter((parameter, models): (Parameter, Vec<&str>)) -> Vec<String> {
    let key = Key::from(&parameter);
    let absent = match key.if_absent {
        IfAbsent::FromTwoOthers => TWO.to_string(),
        IfAbsent::Required => "required".to_string(),
        IfAbsent::Value(value) => shortened(value),
        IfAbsent::Means(meaning) => meaning.to_string(),
    };
    let models = models.into_iter().map(code).collect::<Vec<_>>().join(", ");
    let names = std::iter::once(key.name).chain(synonyms::accepted(key.name));
    let names = names.map(code).collect::<Vec<_>>().join(", ");
    vec![models, names, value(&key.kind, key.unit), absent, key.doc]
}

fn cells() -> String {
    let row = |kind: CellKind| {
        let (gmsh, abaqus) = crate::mesh::numbers(kind);
        let points = element(kind).quadrature().points.len();
        let gmsh = gmsh.map(|id| id.to_string()).unwrap_or_default();
        let vtk = crate::vtk::cell_type(kind);
        let description = kind.info().description.to_string();
        let numbers = [gmsh, abaqus.join(", "), vtk.to_string(), points.to_string()];
        let formulations = formulation::described(kind).unwrap_or_default();
        [code(kind.name()), description].into_iter().chain(numbers).chain([formulations]).collect()
    };
    let head = ["cell", "description", "Gmsh", "Abaqus", "VTK", "points", "against locking"];
    table(&head, CellKind::ALL.map(row))
}

fn schemes() -> String {
    table(&["scheme", "description"], SCHEMES.map(|row| vec![code(row.form), row.description.to_string()]))
}

fn fields() -> String {
    table(&["field", "at the", "numbers", "description"], FieldName::ALL.map(field))
}

fn field(field: FieldName) -> Vec<String> {
    let place = match field.place() {
        emmy::body::Place::Nodes => "nodes",
        emmy::body::Place::Cells => "cells",
    };
    let n = field.components().len();
    vec![
        code(field.name()),
        place.to_string(),
        n.to_string(),
        described(field).replace('[', "\\[").replace(']', "\\]"),
    ]
}

/// Columns of the history; columns with the same meaning share a row.
fn columns() -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for ColumnInfo { name, dimension, meaning } in every_column() {
        match rows.last_mut().filter(|row| row[1] == meaning) {
            Some(row) => row[0] += &format!(", {}", code(&name)),
            None => rows.push(vec![code(&name), meaning, dimension.to_string()]),
        }
    }
    table(&["column", "content", "unit"], rows)
}

fn units() -> String {
    let head =
        ["system", "mass", "length", "time", "force", "stress", "energy", "frequency", "steel", "gravity"];
    let row = |system: &UnitSystem| {
        let names = format!("{}, {}", code(system.name), code(system.full_name));
        let density = "mass/length³";
        let steel = written(shifted(7850.0, -system.power(density)));
        let steel = format!("{steel} {}", system.unit(density));
        [names]
            .into_iter()
            .chain(system.units().map(|(_, unit)| unit))
            .chain([steel, gravity(system)])
            .collect()
    };
    table(&head, SYSTEMS.iter().map(row))
}

fn measured_materials() -> String {
    let head = ["material", "density", "parameters", "source"];
    let row = |own: &MeasuredMaterial| {
        let [density, line] = [written(own.density), own.line(&SYSTEMS[0])];
        vec![own.name.clone(), density, code(&line), own.origin()]
    };
    table(&head, measured().iter().map(row))
}

/// The table of a name.
fn named(name: &str) -> Option<String> {
    let section = catalogue::all().into_iter().find(|section| section.name == name).map(keys);
    section.or_else(|| TABLES.iter().find(|(own, _)| *own == name).map(|(_, table)| table()))
}

/// Entries of a format of meshes, and what its reader does with them.
fn entries(format: &str) -> String {
    let of_format = ENTRIES.iter().filter(|(own, _)| *own == format).flat_map(|(_, all)| *all);
    let all: Vec<&Entries> = of_format.collect();
    let rows = Treatment::ALL.into_iter().flat_map(|treatment| {
        let own = all.iter().filter(move |entries| entries.treatment == treatment);
        own.map(move |entries| {
            let names: Vec<String> = entries.names.iter().map(|name| code(name)).collect();
            vec![treatment.name().to_string(), entries.what.to_string(), names.join(", ")]
        })
    });
    table(&["treatment", "what", "names"], rows)
}

const START: &str = "<!-- table: ";
const END: &str = "<!-- end of table -->";

/// A page with its tables written again, and their names.
fn filled(page: &str) -> (String, Vec<String>) {
    let mut parts = page.split(START);
    let mut names = Vec::new();
    let mut text = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let (name, rest) = part.split_once(" -->").expect("the name ends");
        let (_, rest) = rest.split_once(END).expect("the table ends");
        let table = named(name).unwrap_or_else(|| panic!("there is no table `{name}`"));
        text += &format!("{START}{name} -->\n{table}{END}{rest}");
        names.push(name.to_string());
    }
    (text, names)
}

/// Fills a file, or checks that this changes nothing. Returns the names of its filled parts.
fn updated(path: &str, filled: fn(&str) -> (String, Vec<String>)) -> Vec<String> {
    let place = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
    let own = std::fs::read_to_string(&place).unwrap();
    let (filled, names) = filled(&own);
    if std::env::var_os("EMMY_UPDATE_DOCS").is_some() {
        std::fs::write(&place, &filled).unwrap();
    } else {
        assert!(own == filled, "{path}: EMMY_UPDATE_DOCS=1 cargo test -p emmy-io --lib reference writes it");
    }
    names
}

#[test]
fn every_unit_of_a_description_is_a_dimension() {
    let of_columns = every_column().map(|column| column.dimension);
    let of_keys =
        catalogue::all().into_iter().flat_map(|section| section.keys.iter().map(|key| key.unit.to_string()));
    for dimension in of_columns.chain(of_keys) {
        assert!(exponents(&dimension).is_some(), "{dimension}");
    }
}

#[test]
fn the_tables_of_the_reference_match_the_program() {
    let pages = ["input", "results", "materials"].iter();
    let all: Vec<String> = pages.flat_map(|page| updated(&format!("book/src/{page}.md"), filled)).collect();
    let is_model = |section: &&Section| {
        let is_formula = section.name == energy::NAME;
        !is_formula
            && (section.name == "material" || material::sections().any(|own| own.name == section.name))
    };
    let sections = catalogue::all().into_iter().filter(|section| !is_model(section));
    for name in sections.map(|section| section.name).chain(TABLES.map(|(name, _)| name)) {
        assert!(all.iter().any(|shown| shown == name), "no page shows the table `{name}`");
    }
}
