//! `formulation` and `pressure` of a region: their words, their check against cells, material and scheme, and advice on
//! cells that lock.

use std::collections::BTreeMap;

use emmy::body::{Formulation, PressureSpace, Region};
use emmy::internals::mesh::quality_of;
use emmy::internals::number::short;
use emmy::mesh::{CellKind, Mesh, Worst};
use emmy::time::Scheme;

use super::description::{Kind, word};
use super::fault::Fault;
use super::groups;
use super::placed::Placed;
use super::table::Table;
use super::time::Time;

/// Formulations by their words.
const FORMULATIONS: [(&str, Formulation); 3] = [
    (Formulation::Standard.name(), Formulation::Standard),
    (PROJECTED.name(), PROJECTED),
    (Formulation::IncompatibleModes.name(), Formulation::IncompatibleModes),
];

/// Functions of the pressure by their words.
const PRESSURES: [(&str, PressureSpace); 2] = [
    (PressureSpace::Constant.name(), PressureSpace::Constant),
    (PressureSpace::Linear.name(), PressureSpace::Linear),
];

/// A projected volume with the default functions of each kind of cell.
const PROJECTED: Formulation = Formulation::ProjectedVolume(None);

/// Poisson's ratio at rest above which cells with the standard formulation lock; bulk over shear modulus is 9.67 there.
const LOCKING_POISSONS_RATIO: f64 = 0.45;

/// Number of linear cells over a thickness below which bending is too stiff.
const THIN: f64 = 4.0;

/// Scaled Jacobian below which a cell is called skewed: edges 26 degrees away from a right angle.
const SKEWED: f64 = 0.9;

/// A formulation.
pub(super) fn formulations() -> Kind {
    word("a formulation", FORMULATIONS.map(|(word, _)| word))
}

/// Functions of the pressure.
pub(super) fn pressures() -> Kind {
    word("a set of pressure functions", PRESSURES.map(|(word, _)| word))
}

/// The formulation of a region.
pub(super) fn read(table: &Table<'_>) -> Result<Formulation, Fault> {
    let formulation = table.item("formulation");
    let formulation = formulation.map_or(Formulation::Standard, |item| item.one_of(FORMULATIONS));
    let Some(item) = table.item("pressure") else { return Ok(formulation) };
    match formulation {
        Formulation::ProjectedVolume(_) => Ok(Formulation::ProjectedVolume(Some(item.one_of(PRESSURES)))),
        Formulation::Standard | Formulation::IncompatibleModes => {
            let message = "`pressure` belongs to formulation = \"projected-volume\"";
            let help = "leave `pressure` out, or give formulation = \"projected-volume\"";
            Err(item.fault(message, format!("`{}` has no pressure", formulation.name())).help(help))
        }
    }
}

/// A word on each formulation that a kind of cell has beside the standard one.
pub(super) fn described(kind: CellKind) -> Option<String> {
    let info = kind.info();
    let (default, others) = info.pressures.split_first()?;
    let others = others.iter().map(|space| format!(" or {space}")).collect::<String>();
    let modes = if info.n_modes > 0 { ", incompatible modes" } else { "" };
    Some(format!("{default}{others} pressure{modes}"))
}

/// Kinds of cells with a line on each, for `emmy list elements`.
pub fn elements() -> Vec<(&'static str, String)> {
    let line = |kind: CellKind| {
        let formulations = described(kind).map_or(String::new(), |text| format!("; {text}"));
        (kind.name(), format!("{}{formulations}", kind.info().description))
    };
    CellKind::ALL.map(line).to_vec()
}

/// The formulations of the regions, and advice on them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Formulations {
    /// A line on each region that has another formulation than the standard one.
    pub lines: Vec<String>,
    /// Cells that lock or hourglass, with the formulation to take.
    pub advice: Vec<String>,
}

impl Formulations {
    /// Checks the regions against their cells and the scheme.
    ///
    /// # Errors
    /// A kind of cell or a material that does not have the formulation of its region; a scheme without it.
    pub(super) fn new(mesh: &Mesh, regions: &[Placed<Region>], time: &Time) -> Result<Self, Fault> {
        let mut all = Formulations::default();
        for placed in regions {
            let region = RegionCells::new(mesh, placed, regions.len())?;
            all.lines.extend(region.line()?);
            if placed.value.formulation == Formulation::IncompatibleModes {
                check_scheme(placed, time)?;
            }
            if placed.value.link().is_none() {
                all.advice.extend(region.advice());
            }
        }
        Ok(all)
    }
}

/// Incompatible modes have no mass, which an explicit scheme divides by.
fn check_scheme(region: &Placed<Region>, time: &Time) -> Result<(), Fault> {
    if time.scheme != Scheme::CentralDifferences {
        return Ok(());
    }
    let message = format!("incompatible modes have no mass, which {} needs", time.scheme.name());
    let help = "take an implicit scheme, such as scheme = \"DGM\", or formulation = \"projected-volume\"";
    Err(Fault::at(&region.place, message, "has incompatible modes").help(help))
}

/// A region with its cells by kind.
struct RegionCells<'a> {
    mesh: &'a Mesh,
    placed: &'a Placed<Region>,
    cells: BTreeMap<CellKind, Vec<usize>>,
}

impl<'a> RegionCells<'a> {
    fn new(mesh: &'a Mesh, placed: &'a Placed<Region>, n_regions: usize) -> Result<Self, Fault> {
        let mut cells = BTreeMap::<CellKind, Vec<usize>>::new();
        for cell in groups::cells(mesh, placed, n_regions)? {
            cells.entry(mesh.cell(cell).kind).or_default().push(cell);
        }
        Ok(RegionCells { mesh, placed, cells })
    }

    fn region(&self) -> &Region {
        &self.placed.value
    }

    fn name(&self) -> &str {
        self.region().group.as_deref().unwrap_or("all cells")
    }

    /// The formulation of each kind of cell; `None` for the standard one.
    fn line(&self) -> Result<Option<String>, Fault> {
        let own = self.region().formulation;
        let mut parts = Vec::new();
        for (kind, cells) in &self.cells {
            let space = self.region().pressure_space(own, *kind).map_err(|reason| {
                let message = format!("formulation = \"{}\", cell {}: {reason}", own.name(), cells[0]);
                let help = "a formulation holds for all cells of a region: change it, or make another region for these cells";
                Fault::at(&self.placed.place, message, format!("has {} {kind}", cells.len())).help(help)
            })?;
            let n = cells.len();
            parts.push(space.map_or(format!("{n} {kind}"), |space| format!("{n} {kind} ({space} pressure)")));
        }
        let line = || format!("{}: {}, {}", self.name(), own.name(), parts.join(", "));
        Ok((own != Formulation::Standard).then(line))
    }

    fn advice(&self) -> Vec<String> {
        let advice = match self.region().formulation {
            Formulation::Standard => vec![self.volumetric_locking(), self.constant_strain(), self.bending()],
            Formulation::ProjectedVolume(_) => vec![self.projected_bending()],
            Formulation::IncompatibleModes => {
                vec![self.modes_near_incompressibility(), Some(self.compression()), self.skewed_cells()]
            }
        };
        advice.into_iter().flatten().map(|text| format!("region `{}`: {text}", self.name())).collect()
    }

    /// Whether the material hardly changes its volume, with the numbers that say so.
    fn near_incompressibility(&self) -> Option<String> {
        let [bulk, shear] = self.region().moduli()?;
        let poissons_ratio = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
        let numbers = || {
            let [ratio, poissons_ratio] = [bulk / shear, poissons_ratio].map(short);
            format!("Poisson's ratio {poissons_ratio}, bulk over shear modulus {ratio}")
        };
        (poissons_ratio > LOCKING_POISSONS_RATIO).then(numbers)
    }

    fn volumetric_locking(&self) -> Option<String> {
        let numbers = self.near_incompressibility()?;
        let (mut curable, mut others) = (Vec::new(), Vec::new());
        for kind in self.cells.keys() {
            match self.region().pressure_space(PROJECTED, *kind) {
                Ok(_) => curable.push(kind.name()),
                Err(reason) => others.push(reason),
            }
        }
        let own_region = if others.is_empty() { "" } else { ", in a region of their own" };
        let cure =
            || format!("give {} formulation = \"{}\"{own_region}", curable.join(" and "), PROJECTED.name());
        let remedies = (!curable.is_empty()).then(cure).into_iter().chain(others);
        let remedies = remedies.collect::<Vec<_>>().join("; ");
        Some(format!(
            "{numbers}: cells with the standard formulation lock, that is, are too stiff; {remedies}"
        ))
    }

    fn bending(&self) -> Option<String> {
        let thickness = self.thickness()?;
        let remedies = match self.near_incompressibility() {
            Some(_) => {
                format!("hex27 or hex20 (quad9 in a plane) with formulation = \"{}\"", PROJECTED.name())
            }
            None => {
                let word = Formulation::IncompatibleModes.name();
                format!("formulation = \"{word}\", quadratic cells, or four cells")
            }
        };
        Some(format!("{thickness}: too stiff in bending; take {remedies}"))
    }

    /// Cells that are too stiff in any formulation; [`RegionCells::volumetric_locking`] names them for rubber.
    fn constant_strain(&self) -> Option<String> {
        if self.near_incompressibility().is_some() {
            return None;
        }
        let quadratic = |(kind, better)| {
            let given = self.cells.contains_key(&kind).then_some(kind)?;
            Some(format!(
                "{given} cells are too stiff, above all in bending, and no formulation helps; mesh with {better}"
            ))
        };
        [(CellKind::Tet4, "tet10"), (CellKind::Tri3, "tri6")].into_iter().find_map(quadratic)
    }

    /// Incompatible modes cure bending, not a constrained volume.
    fn modes_near_incompressibility(&self) -> Option<String> {
        let numbers = self.near_incompressibility()?;
        let word = PROJECTED.name();
        Some(format!(
            "{numbers}: incompatible modes lock in volume near clamps; take hex27 or hex20 (quad9 in a plane) with \
             formulation = \"{word}\""
        ))
    }

    fn projected_bending(&self) -> Option<String> {
        let thickness = self.thickness()?;
        Some(format!(
            "{thickness}: too few for bending; take hex27 or hex20 (quad9 in a plane), or four cells"
        ))
    }

    /// Number of linear cells over the edge of their bounding box that has the fewest, or the shortest of those, if it
    /// is below [`THIN`].
    fn thickness(&self) -> Option<String> {
        let linear = self.cells.iter().filter(|(kind, _)| kind.info().n_modes > 0);
        let (kinds, cells): (Vec<&str>, Vec<&Vec<usize>>) =
            linear.map(|(kind, cells)| (kind.name(), cells)).unzip();
        let cells = || cells.iter().copied().flatten().copied();
        let whole = Extent::of(self.mesh, cells())?;
        let mut sums = [0.0; 3];
        for cell in cells() {
            let extent = Extent::of(self.mesh, [cell])?.lengths();
            (0..3).for_each(|i| sums[i] += extent[i]);
        }
        let n_cells = cells().count() as f64;
        let over = |i: usize| (whole.lengths()[i] * n_cells / sums[i]).round();
        let (axis, n, _) = (0..3)
            .filter(|&i| sums[i] > 0.0)
            .map(|i| (["x", "y", "z"][i], over(i), whole.lengths()[i]))
            .min_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)))?;
        let kinds = kinds.join(" and ");
        let cells = if n == 1.0 { "cell" } else { "cells" };
        (n < THIN).then(|| format!("about {n} {cells} ({kinds}) over its thickness along {axis}"))
    }

    fn compression(&self) -> String {
        "incompatible modes hourglass where cells are compressed below about 0.68 of their length".to_string()
    }

    fn skewed_cells(&self) -> Option<String> {
        let cells: Vec<usize> = self.cells.values().flatten().copied().collect();
        let Worst { value: worst, cell } = quality_of(self.mesh, &cells).scaled_jacobian;
        (worst < SKEWED).then(|| {
            let worst = short(worst);
            format!("cell {cell} is skewed (scaled Jacobian {worst}): incompatible modes gain less there")
        })
    }
}

/// Bounding box.
struct Extent {
    least: [f64; 3],
    largest: [f64; 3],
}

impl Extent {
    /// The box of some cells; `None` without cells.
    fn of(mesh: &Mesh, cells: impl IntoIterator<Item = usize>) -> Option<Extent> {
        let nodes = cells.into_iter().flat_map(|cell| mesh.cell(cell).nodes);
        let points = nodes.map(|&node| mesh.points()[node as usize]);
        let points = points.map(|point| Extent { least: point, largest: point });
        points.reduce(|a, b| Extent {
            least: [0, 1, 2].map(|i| a.least[i].min(b.least[i])),
            largest: [0, 1, 2].map(|i| a.largest[i].max(b.largest[i])),
        })
    }

    fn lengths(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.largest[i] - self.least[i])
    }
}
