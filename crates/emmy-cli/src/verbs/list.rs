//! `emmy list WORD`: one item per line, its key word first.

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use emmy::body::FieldName;
use emmy::internals::sparse::SOLVERS;
use emmy::internals::time::{ESTIMATORS, SCHEMES};
use emmy_io::input::{elements, materials, meshes};
use emmy_io::properties::{MeasuredMaterial, measured};
use emmy_io::units::{SYSTEMS, UnitSystem};
use serde_json::json;

use super::new::TEMPLATES;
use crate::failure::Failure;
use crate::host::Host;
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// List to print; without it, the names of the lists are printed
    what: Option<What>,
    /// As JSON: a list of objects with `name` and `description`
    #[arg(long)]
    json: bool,
    /// With `materials`: measured materials with their sources, as lines for an input
    #[arg(long)]
    properties: bool,
    /// Units of the measured materials
    #[arg(long, value_name = "SYSTEM", requires = "properties", default_value = "m-kg-s", value_parser = system)]
    units: &'static UnitSystem,
}

/// A system of units by its name.
fn system(name: &str) -> Result<&'static UnitSystem, String> {
    let names = || SYSTEMS.map(|system| system.name).join(", ");
    UnitSystem::named(name).ok_or_else(|| format!("there is {}", names()))
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// Schemes in time
    Schemes,
    /// Estimators of the error of a step
    Estimators,
    /// Material models
    Materials,
    /// Elements of meshes
    Elements,
    /// Where a mesh may come from
    Meshes,
    /// Solvers of the linear systems
    Solvers,
    /// Fields that frames may hold
    Fields,
    /// Examples that `emmy new` writes
    Templates,
}

type Item = (&'static str, String);

fn described<const N: usize>(items: [(&'static str, &'static str); N]) -> Vec<Item> {
    Vec::from(items.map(|(name, description)| (name, description.to_string())))
}

/// Prints the list.
pub(super) fn run(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    if arguments.properties {
        return properties(arguments, host);
    }
    let Some(what) = arguments.what else { return words(arguments.json, host) };
    let items: Vec<Item> = match what {
        What::Schemes => described(SCHEMES.map(|row| (row.form, row.description))),
        What::Estimators => described(ESTIMATORS.map(|(name, _, description)| (name, description))),
        What::Materials => materials(),
        What::Elements => elements(),
        What::Meshes => meshes(),
        What::Solvers => described(SOLVERS.map(|(name, _, description)| (name, description))),
        What::Fields => FieldName::ALL.map(|field| (field.name(), emmy_io::units::described(field))).into(),
        What::Templates => described(TEMPLATES.map(|template| (template.name, template.title()))),
    };
    print::result(host, &if arguments.json { as_json(&items) } else { as_lines(&items) })
}

/// Prints the measured materials.
fn properties(arguments: &Arguments, host: &dyn Host) -> Result<(), Failure> {
    if !matches!(arguments.what, None | Some(What::Materials)) {
        let message = "`--properties` belongs to the list of materials".to_string();
        return Err(Failure::Usage { message, help: Some("emmy list materials --properties".to_string()) });
    }
    let system = arguments.units;
    let text = |own: &MeasuredMaterial| format!("# {}; {}\n{}\n", own.name, own.origin(), own.input(system));
    let object = |own: &MeasuredMaterial| json!({ "name": own.name, "input": own.input(system), "source": own.source, "note": own.note });
    print::result(
        host,
        &match arguments.json {
            true => format!("{:#}\n", serde_json::Value::Array(measured().iter().map(object).collect())),
            false => {
                format!("# Units: {}\n\n{}", system.name, measured().iter().map(text).collect::<String>())
            }
        },
    )
}

/// Prints the available lists.
fn words(as_json: bool, host: &dyn Host) -> Result<(), Failure> {
    let values: Vec<_> = What::value_variants().iter().filter_map(What::to_possible_value).collect();
    let help = |value: &PossibleValue| value.get_help().map(ToString::to_string).unwrap_or_default();
    let items: Vec<(&str, String)> = values.iter().map(|value| (value.get_name(), help(value))).collect();
    print::result(host, &if as_json { self::as_json(&items) } else { as_lines(&items) })
}

fn as_lines(items: &[(&str, String)]) -> String {
    let width = items.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    items.iter().map(|(name, description)| format!("{name:width$}  {description}\n")).collect()
}

fn as_json(items: &[(&str, String)]) -> String {
    let object = |(name, description): &(&str, String)| json!({ "name": name, "description": description });
    format!("{:#}\n", serde_json::Value::Array(items.iter().map(object).collect()))
}
