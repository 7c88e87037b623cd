//! `[[region]]`: cells with a density and a material.

use emmy::body::Region;
use emmy::material::{NeoHooke, SaintVenantKirchhoff};

use super::fault::{Fault, Place};
use super::keys;
use super::table::{Item, Table};

/// A part of the input with the place of its group's name, if it has one, and its own.
#[derive(Debug)]
pub(super) struct Placed<T> {
    pub(super) value: T,
    pub(super) group: Option<(String, Place)>,
    pub(super) place: Place,
}

impl<T> Placed<T> {
    pub(super) fn new(table: &Table<'_>, value: T) -> Result<Self, Fault> {
        Ok(Placed { value, group: group(table)?, place: table.place().clone() })
    }
}

/// The group of a table, if it names one.
pub(super) fn group(table: &Table<'_>) -> Result<Option<(String, Place)>, Fault> {
    let Some(item) = table.get("group") else { return Ok(None) };
    Ok(Some((item.string()?.to_string(), item.place().clone())))
}

/// Reads one region.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Region>, Fault> {
    let table = item.table(keys::REGION)?;
    let density = table.require("density")?.positive()?;
    let name = group(&table)?.map(|(name, _)| name);
    let item = table.require("material")?;
    let materials = item.table(keys::MATERIAL)?;
    let material = materials.exactly_one("one model", keys::MATERIAL.keys)?;
    let region = match material.key() {
        "neo-hooke" => {
            let material = model(material, NeoHooke::new, NeoHooke::from_engineering)?;
            Region::new(name, density, material)
        }
        _ => {
            let material =
                model(material, SaintVenantKirchhoff::new, SaintVenantKirchhoff::from_engineering)?;
            Region::new(name, density, material)
        }
    };
    Placed::new(&table, region)
}

type Model<M> = fn(f64, f64) -> emmy::Result<M>;

const LAME: [&str; 2] = ["lambda", "mu"];
const ENGINEERING: [&str; 2] = ["youngs_modulus", "poissons_ratio"];

/// A model from one of the two pairs of parameters.
fn model<M>(item: Item<'_>, from_lame: Model<M>, from_engineering: Model<M>) -> Result<M, Fault> {
    let table = item.table(keys::PARAMETERS)?;
    let given = |names: [&str; 2]| names.map(|name| table.get(name));
    match (given(LAME), given(ENGINEERING)) {
        ([Some(a), Some(b)], [None, None]) => build([a, b], from_lame),
        ([None, None], [Some(a), Some(b)]) => build([a, b], from_engineering),
        _ => {
            let message = format!("`{}` needs exactly one pair of parameters: ", item.key());
            let pairs = "either `lambda` and `mu`, or `youngs_modulus` and `poissons_ratio`";
            Err(item.fault(message + pairs, "not one pair"))
        }
    }
}

fn build<M>(parameters: [Item<'_>; 2], model: Model<M>) -> Result<M, Fault> {
    let values = [parameters[0].number()?, parameters[1].number()?];
    model(values[0], values[1]).map_err(|error| {
        let named = |name: &str| parameters.iter().find(|item| item.key() == name).copied();
        let guilty = match &error {
            emmy::Error::MaterialParameter { parameter, .. } => named(parameter),
            _ => None,
        };
        guilty.unwrap_or(parameters[0]).fault(error.to_string(), "out of range")
    })
}
