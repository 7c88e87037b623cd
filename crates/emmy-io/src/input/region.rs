//! `[[region]]`: cells with a density and a material.

use emmy::body::{Region, Viscosity};
use emmy::internals::material::ModelCells;

use super::description::{Described, Kind, POSITIVE, Rule, Section};
use super::fault::Fault;
use super::placed::{Placed, group};
use super::table::{Item, Table};
use super::{formulation, material};

/// `[[region]]`.
pub(super) static REGION: Described = Described::new(|| {
    let section = Section::new("[[region]]", "Cells with a density and a material")
        .may("group", Kind::Text, "", "Group of cells; with several regions each cell must be in exactly one")
        .absent("with one region every cell")
        .may("density", POSITIVE, "mass/length³", "Mass per reference volume")
        .absent("none: for springs and attractions only")
        .may(
            "thickness",
            POSITIVE,
            "length",
            "Thickness of cells in plane strain; energies, masses and forces are proportional to it",
        )
        .absent("1")
        .must("material", Kind::Table(&material::MATERIAL), "", "Exactly one model with its parameters")
        .may("viscosity", Kind::Table(&VISCOSITY), "", "Viscosity of Kelvin and Voigt")
        .absent("none")
        .may(
            "formulation",
            Kind::Word(formulation::formulations()),
            "",
            "Formulation of the cells: `projected-volume` for rubber and other materials that hardly change their volume, \
             `incompatible-modes` for bending of hex8 and quad4",
        )
        .absent("`\"standard\"`")
        .may(
            "pressure",
            Kind::Word(formulation::pressures()),
            "",
            "With `projected-volume`: functions of the pressure in each cell",
        )
        .absent("by the kind of cell, see [below](#regionformulation)");
    Section { rule: Rule::Region, ..section }
});

pub(super) static VISCOSITY: Described = Described::new(|| {
    let doc = "Viscosity of Kelvin and Voigt: a stress linear in the strain rate; links have `time` alone";
    Section::new("`viscosity`", doc)
        .may(
            "time",
            POSITIVE,
            "time",
            "Time by which the stiffness at rest is multiplied: stiffness-proportional (Rayleigh) damping; a mode of angular \
             frequency omega has the damping ratio `time` omega/2",
        )
        .may("shear", POSITIVE, "stress·time", "Shear viscosity")
        .may("bulk", POSITIVE, "stress·time", "Bulk viscosity")
        .at_least_one(&["time", "shear", "bulk"])
});

/// Reads one region.
pub(super) fn read(item: Item<'_>) -> Result<Placed<Region>, Fault> {
    let table = item.table(&REGION)?;
    let material = table.require("material")?;
    let density = density(&table, material)?;
    let region = material::region(material, density)?;
    let region = match group(&table)? {
        Some((name, _)) => region.on(name),
        None => region,
    };
    let region = match table.get("thickness") {
        Some(thickness) => region.with_thickness(thickness.positive()?),
        None => region,
    };
    let region = match table.get("viscosity") {
        Some(item) => {
            let link = material::given(&material).find(|model| model.is_link());
            region.with_viscosity(viscosity(item, link.map(|model| model.name))?)
        }
        None => region,
    };
    let region = region.with_formulation(formulation::read(&table)?);
    Placed::new(&table, region)
}

/// The viscosity: a time, viscosities, or both; of a material of links, by its name, a time.
pub(super) fn viscosity(item: Item<'_>, link: Option<&str>) -> Result<Viscosity, Fault> {
    let table = item.table(&VISCOSITY)?;
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
    let massless = material::given(&material).find(|model| model.cells == ModelCells::MasslessLinks);
    match (massless, table.get("density")) {
        (Some(_), None) => Ok(0.0),
        (Some(model), Some(density)) => {
            let message = format!("`{}` has no mass: `density` must be left out", model.name);
            Err(density.fault(message, "leave it out").help("`[[mass]]` puts masses at nodes"))
        }
        (None, _) => table.require("density")?.positive(),
    }
}
