//! `[[region]]`: cells with a density and a material.

use emmy::body::{Region, Viscosity};
use emmy::internals::material::ModelCells;

use super::description::{Described, Kind, POSITIVE, Rule, Section};
use super::fault::{Fault, Faults};
use super::placed::Placed;
use super::table::Table;
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
            formulation::formulations(),
            "",
            "Formulation of the cells: `projected-volume` for rubber and other materials that hardly change their volume, \
             `incompatible-modes` for bending of hex8 and quad4",
        )
        .absent("`\"standard\"`")
        .may(
            "pressure",
            formulation::pressures(),
            "",
            "With `projected-volume`: functions of the pressure in each cell",
        )
        .absent("by the kind of cell, see [below](#regionformulation)");
    Section { rule: Rule::Region, ..section }
});

pub(super) static VISCOSITY: Described = Described::new(|| {
    let doc = "Viscosity of Kelvin and Voigt: a stress linear in the strain rate; links have `time` alone";
    Section::new("viscosity", doc)
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
pub(super) fn read(table: &Table<'_>, faults: &mut Faults) -> Option<Placed<Region>> {
    let material: Table<'_> = table.must("material");
    let model = material.chosen().key;
    let cells = material::cells(table.must("material")).next().unwrap_or(ModelCells::Solids);
    if let (ModelCells::MasslessLinks, Some(density)) = (cells, table.item("density")) {
        let message = format!("`{model}` has no mass: `density` must be left out");
        faults.push(density.fault(message, "leave it out").help("`[[mass]]` puts masses at nodes"));
    }
    let region = faults.keep(material::region(&material, table.may("density").unwrap_or(0.0)));
    let link = (cells != ModelCells::Solids).then_some(model);
    let viscosity = table.may("viscosity").map(|own: Table<'_>| faults.keep(viscosity(&own, link)));
    let formulation = faults.keep(formulation::read(table));
    let mut region = region?.with_formulation(formulation?);
    if let Some((name, _)) = table.group() {
        region = region.on(name);
    }
    if let Some(thickness) = table.may("thickness") {
        region = region.with_thickness(thickness);
    }
    if let Some(viscosity) = viscosity {
        region = region.with_viscosity(viscosity?);
    }
    Some(Placed::new(table, region))
}

/// The viscosity: a time, viscosities, or both; of a material of links, by its name, a time.
pub(super) fn viscosity(table: &Table<'_>, link: Option<&str>) -> Result<Viscosity, Fault> {
    let item = ["shear", "bulk"].into_iter().find_map(|key| table.item(key));
    if let (Some(link), Some(item)) = (link, item) {
        let key = item.key;
        let message =
            format!("a `{link}` has no `{key}` viscosity: `time` times its stiffness is its viscosity");
        return Err(item.fault(message, "leave it out"));
    }
    let number = |key: &str| table.may(key).unwrap_or(0.0);
    Ok(Viscosity { time: number("time"), shear: number("shear"), bulk: number("bulk") })
}
