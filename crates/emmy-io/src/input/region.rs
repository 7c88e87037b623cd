//! `[[region]]`: cells with a density and a material.

use emmy::body::{Region, Viscosity};

use super::fault::{Fault, Place};
use super::table::{Item, Table};
use super::{keys, material};

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
    Ok(Some((item.name()?, item.place().clone())))
}

/// Reads one region.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Region>, Fault> {
    let table = item.table(keys::REGION)?;
    let material = table.require("material")?;
    let density = density(&table, material)?;
    let name = group(&table)?.map(|(name, _)| name);
    let region = material::region(material, name, density)?;
    let region = match table.get("thickness") {
        Some(thickness) => region.with_thickness(thickness.positive()?),
        None => region,
    };
    let region = match table.get("viscosity") {
        Some(item) => region.with_viscosity(viscosity(item, material)?),
        None => region,
    };
    Placed::new(&table, region)
}

/// The viscosity: a time, viscosities, or both.
fn viscosity(item: Item<'_>, material: Item<'_>) -> Result<Viscosity, Fault> {
    let table = item.table(keys::VISCOSITY)?;
    let link = ["bar", "spring", "attraction"].into_iter().find(|model| material.has_key(model).is_some());
    let number = |key: &str| {
        let Some(item) = table.get(key) else { return Ok(0.0) };
        match link.filter(|_| key != "time") {
            Some(link) => {
                let message = format!(
                    "a `{link}` has no `{key}` viscosity: `time` times its stiffness is its viscosity"
                );
                Err(item.fault(message, "leave it out"))
            }
            None => item.positive(),
        }
    };
    let viscosity = Viscosity { time: number("time")?, shear: number("shear")?, bulk: number("bulk")? };
    if viscosity.is_zero() {
        return Err(item.fault("`viscosity` needs `time`, `shear` or `bulk`", "nothing is viscous here"));
    }
    Ok(viscosity)
}

/// The density, which springs and attractions do not have.
fn density(table: &Table<'_>, material: Item<'_>) -> Result<f64, Fault> {
    let massless = ["spring", "attraction"].into_iter().find(|model| material.has_key(model).is_some());
    match (massless, table.get("density")) {
        (Some(_), None) => Ok(0.0),
        (Some(model), Some(density)) => {
            let message = format!("`{model}` has no mass: `density` must be left out");
            Err(density.fault(message, "leave it out").help("`[[mass]]` puts masses at nodes"))
        }
        (None, _) => table.require("density")?.positive(),
    }
}
