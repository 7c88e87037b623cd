//! `material.MODEL = { ... }`: the models of the library, read by their descriptions.

use std::sync::LazyLock;

use emmy::body::Region;
use emmy::internals::body::{MODELS, RegionModel};
use emmy::internals::material::{
    ELASTIC_CONSTANTS, IfAbsent, Model, ModelCells, Parameter, ParameterKind, Value, Values,
};
use emmy::material::Volumetric;

use super::description::{Described, Key, Kind, Rule, Section};
use super::fault::Fault;
use super::table::{Item, Read, Table};
use super::{energy, finite};

/// `material`.
pub(super) static MATERIAL: Described = Described::new(|| {
    let names: Vec<&str> = sections().map(|section| section.name).collect();
    let section = Section::new("material", "Exactly one model with its parameters").exactly_one(&names);
    sections().fold(section, |section, own| section.may(own.name, Kind::Table(own), "", &own.doc))
});

/// Tables of the models, in the order of [`MODELS`].
static SECTIONS: LazyLock<Vec<Section>> =
    LazyLock::new(|| MODELS.iter().map(|model| section(&model.model)).collect());

/// Tables of the models: of solids, the formula, and those of links.
pub(super) fn sections() -> impl Iterator<Item = &'static Section> {
    let (solids, links) = SECTIONS.split_at(n_solids());
    solids.iter().chain([&*energy::SECTION]).chain(links)
}

/// Number of models for solids, which stand before those for links.
fn n_solids() -> usize {
    MODELS.iter().filter(|model| !model.model.is_link()).count()
}

fn section(model: &Model) -> Section {
    let section = Section::new(model.name, &format!("{}: {}", model.energy, model.purpose));
    let section = model.every_parameter().fold(section, |section, own| section.key(Key::from(own)));
    let rule = if model.has_elastic_constants() { Rule::TwoElasticConstants } else { Rule::Free };
    Section { rule, ..section }
}

/// Models with a line on each, for `emmy list materials`.
pub fn materials() -> Vec<(&'static str, String)> {
    let parameter = |parameter: &Parameter| match parameter.if_absent {
        IfAbsent::Required | IfAbsent::FromTwoOthers => parameter.name.to_string(),
        IfAbsent::Value(value) | IfAbsent::Means(value) => {
            format!("{} = {}", parameter.name, value.replace('\'', "\""))
        }
    };
    let set = |set: &&[Parameter]| set.iter().map(parameter).collect::<Vec<_>>().join(", ");
    let line = |RegionModel { model, .. }: &RegionModel| {
        let energy = if model.is_link() { "V" } else { "W" };
        let two = if model.has_elastic_constants() { "two of " } else { "" };
        let parameters = format!("{two}{}", model.parameters.iter().map(set).collect::<Vec<_>>().join("; "));
        let text = format!("{energy} = {}; parameters {parameters}; {}", model.energy, model.purpose);
        (model.name, text)
    };
    let mut lines: Vec<(&str, String)> = MODELS.iter().map(line).collect();
    let text =
        format!("W = {}; parameters formula, fibre, and any others; {}", energy::ENERGY, energy::PURPOSE);
    lines.insert(n_solids(), (energy::NAME, text));
    lines
}

/// The cells for the models that a material names, even if it has faults.
pub(super) fn cells(material: Item<'_>) -> impl Iterator<Item = ModelCells> {
    let of = |name: &str| MODELS.iter().find(|model| model.model.name == name).map(|model| model.model.cells);
    let models = material.table().into_iter().flat_map(|table| table.items());
    models.map(move |model| of(model.key).unwrap_or(ModelCells::Solids))
}

/// Whether a material names models, even if it has faults, and all of them have a mass.
pub(super) fn has_mass(material: Item<'_>) -> bool {
    let mut cells = cells(material).peekable();
    cells.peek().is_some() && cells.all(|cells| cells != ModelCells::MasslessLinks)
}

/// Reads the one model of a material and creates its region.
pub(super) fn region(material: &Table<'_>, density: f64) -> Result<Region, Fault> {
    let item = material.chosen();
    let Some(model) = MODELS.iter().find(|model| model.model.name == item.key) else {
        return energy::region(&material.must(energy::NAME), density);
    };
    let table: Table<'_> = material.must(item.key);
    let given = |parameter: &Parameter| Some((parameter.name, value(table.item(parameter.name)?, parameter)));
    let values: Vec<(&str, Value)> = model.model.every_parameter().filter_map(given).collect();
    check_terms(&table, &values)?;
    let values = Values::from_iter(values);
    // Constants out of their ranges have their own fault.
    values.elastic(model.model.name).map_or(Ok(()), |own| finite::check_lame(&item, own))?;
    model.region(density, &values).map_err(|error| {
        let parameter = match &error {
            emmy::Error::MaterialParameter { parameter, .. } | emmy::Error::Direction { parameter, .. } => {
                Some(*parameter)
            }
            _ => None,
        };
        match parameter.and_then(|name| table.item(name)) {
            Some(guilty) => guilty.fault(error.to_string(), "out of range"),
            None => given_constants(&table).fold(Fault::new(error.to_string()), |fault, own| {
                fault.label(own.place(), format!("with this `{}`", own.key))
            }),
        }
    })
}

/// The elastic constants of a table.
pub(super) fn given_constants<'a>(table: &Table<'a>) -> impl Iterator<Item = Item<'a>> + use<'a> {
    let table = *table;
    ELASTIC_CONSTANTS.iter().filter_map(move |constant| table.item(constant.name))
}

/// The value of a parameter.
fn value(item: Item<'_>, parameter: &Parameter) -> Value {
    match parameter.kind {
        ParameterKind::Number(_) => Value::Number(Read::read(item)),
        ParameterKind::Numbers => Value::Numbers(Read::read(item)),
        ParameterKind::Direction => Value::Direction(Read::read(item)),
        ParameterKind::Directions => Value::Directions(Read::read(item)),
        ParameterKind::Law => Value::Law(item.one_of(Volumetric::ALL.map(|law| (law.name(), law)))),
    }
}

/// Checks that all lists of numbers have one entry per term.
fn check_terms(table: &Table<'_>, values: &[(&'static str, Value)]) -> Result<(), Fault> {
    let mut lists = values.iter().filter_map(|(name, value)| match value {
        Value::Numbers(list) => Some((*name, list.len())),
        _ => None,
    });
    let Some((first, n)) = lists.next() else { return Ok(()) };
    match lists.find(|(_, other)| *other != n) {
        Some((name, other)) => {
            let message = format!("`{first}` has {n} entries and `{name}` {other}; a term has one of each");
            Err(table.must::<Item<'_>>(name).fault(message, format!("not as many as `{first}`")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_law_of_volume_matches_the_library() {
        let is_law = |parameter: &&Parameter| parameter.kind == ParameterKind::Law;
        let laws = MODELS.iter().flat_map(|model| model.model.every_parameter().filter(is_law));
        let defaults: Vec<IfAbsent> = laws.map(|law| law.if_absent).collect();
        let name = format!("'{}'", Volumetric::default().name());
        assert!(!defaults.is_empty());
        assert!(defaults.iter().all(|default| matches!(default, IfAbsent::Value(value) if *value == name)));
    }
}
