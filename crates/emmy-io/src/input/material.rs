//! `material.MODEL = { ... }`: the models of the library, read by their descriptions.

use std::sync::LazyLock;

use emmy::body::Region;
use emmy::internals::body::{MODELS, RegionModel};
use emmy::internals::material::{IfAbsent, Model, Parameter, ParameterKind, Value, Values};
use emmy::material::Volumetric;

use super::description::{Described, Key, Kind, Rule, Section};
use super::fault::Fault;
use super::table::{Item, Table};
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
    let is_choice = model.parameters.len() > 1;
    let add = |section: Section, parameter: &Parameter| {
        let key = Key::from(parameter);
        let if_absent = if is_choice { IfAbsent::Means("") } else { key.if_absent };
        section.key(Key { if_absent, ..key })
    };
    let section = model.every_parameter().fold(section, add);
    let rule = if is_choice { Rule::OneSet(model.parameters) } else { Rule::Free };
    Section { rule, ..section }
}

/// Models with a line on each, for `emmy list materials`.
pub fn materials() -> Vec<(&'static str, String)> {
    let parameter = |parameter: &Parameter| match parameter.if_absent {
        IfAbsent::Required => parameter.name.to_string(),
        IfAbsent::Value(value) | IfAbsent::Means(value) => {
            format!("{} = {}", parameter.name, value.replace('\'', "\""))
        }
    };
    let set = |set: &&[Parameter]| set.iter().map(parameter).collect::<Vec<_>>().join(", ");
    let line = |RegionModel { model, .. }: &RegionModel| {
        let energy = if model.is_link() { "V" } else { "W" };
        let parameters = model.parameters.iter().map(set).collect::<Vec<_>>().join(" or ");
        let text = format!("{energy} = {}; parameters {parameters}; {}", model.energy, model.purpose);
        (model.name, text)
    };
    let mut lines: Vec<(&str, String)> = MODELS.iter().map(line).collect();
    let text =
        format!("W = {}; parameters formula, fibre, and any others; {}", energy::ENERGY, energy::PURPOSE);
    lines.insert(n_solids(), (energy::NAME, text));
    lines
}

/// Models named by a material, despite other faults.
pub(super) fn given(material: &Item<'_>) -> impl Iterator<Item = &'static Model> {
    MODELS.iter().map(|model| &model.model).filter(|model| material.has_key(model.name).is_some())
}

/// Reads the one model of a material and creates its region.
pub(super) fn region(item: Item<'_>, density: f64) -> Result<Region, Fault> {
    let item = item.table(&MATERIAL)?.exactly_one("one model")?;
    if item.key() == energy::NAME {
        return energy::region(&item, density);
    }
    let found = MODELS.iter().zip(SECTIONS.iter()).find(|(model, _)| model.model.name == item.key());
    let (model, section) =
        found.ok_or_else(|| item.fault(format!("`{}` is not a model", item.key()), "not known"))?;
    let table = item.table(section)?;
    let parameters = parameters(&item, &table, &model.model)?;
    let values: Vec<(&str, Value)> = parameters
        .iter()
        .filter_map(|parameter| value(&table, parameter).transpose())
        .collect::<Result<_, _>>()?;
    check_terms(&table, &values)?;
    let values = Values::from_iter(values);
    let engineering = values.optional("youngs_modulus").zip(values.optional("poissons_ratio"));
    engineering.map_or(Ok(()), |(youngs, poissons)| finite::check_lame(&item, youngs, poissons))?;
    model.region(density, &values).map_err(|error| {
        let guilty = match &error {
            emmy::Error::MaterialParameter { parameter, .. } | emmy::Error::Direction { parameter, .. } => {
                table.get(parameter)
            }
            _ => None,
        };
        guilty.unwrap_or(item).fault(error.to_string(), "out of range")
    })
}

/// The given set of parameters.
fn parameters(item: &Item<'_>, table: &Table<'_>, model: &Model) -> Result<&'static [Parameter], Fault> {
    if let [only] = model.parameters {
        return Ok(only);
    }
    let is_given = |parameter: &Parameter| table.get(parameter.name).is_some();
    let n_given = model.every_parameter().filter(|parameter| is_given(parameter)).count();
    let whole = |set: &&&[Parameter]| set.len() == n_given && set.iter().all(is_given);
    model.parameters.iter().find(whole).copied().ok_or_else(|| {
        let name = |parameter: &Parameter| format!("`{}`", parameter.name);
        let names = |set: &&[Parameter]| set.iter().map(name).collect::<Vec<_>>().join(" and ");
        let sets: Vec<String> = model.parameters.iter().map(names).collect();
        let message = format!("`{}` needs exactly one pair of parameters: either ", item.key());
        item.fault(message + &sets.join(", or "), "not one pair")
    })
}

/// The value of a parameter, if it is given or required.
fn value(table: &Table<'_>, parameter: &Parameter) -> Result<Option<(&'static str, Value)>, Fault> {
    let item = match (table.get(parameter.name), parameter.if_absent) {
        (None, IfAbsent::Means(_)) => return Ok(None),
        _ => table.require(parameter.name)?,
    };
    let value = match parameter.kind {
        ParameterKind::Number(_) => Value::Number(finite::within(&item, item.number()?)?),
        ParameterKind::Numbers => Value::Numbers(each(&item, |entry| entry.number())?),
        ParameterKind::Direction => Value::Direction(item.numbers()?),
        ParameterKind::Directions => Value::Directions(each(&item, |entry| entry.numbers())?),
        ParameterKind::Law => {
            Value::Law(item.one_of("a law of volume", &Volumetric::ALL.map(|law| (law.name(), law)))?)
        }
    };
    Ok(Some((parameter.name, value)))
}

/// The entries of a list, at least one.
fn each<T>(item: &Item<'_>, read: impl Fn(&Item<'_>) -> Result<T, Fault>) -> Result<Vec<T>, Fault> {
    match item.list()? {
        entries if entries.is_empty() => Err(item.fault(format!("`{}` is empty", item.key()), "empty")),
        entries => entries.iter().map(read).collect(),
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
            Err(table.require(name)?.fault(message, format!("not as many as `{first}`")))
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
