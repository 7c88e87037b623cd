//! Regions: their cells, masses and summaries.

use crate::error::{Error, Result};
use crate::input::{Region, Viscosity};
use crate::mesh::{CellKind, Mesh};
use crate::space::geometry::{MassKind, for_each_cell, for_each_mass_point, for_each_volume_point};
use crate::sparse::Pattern;

/// Volume, mass, centre and inertia of a region in the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionSummary {
    /// Cell group; `None`: every cell.
    pub group: Option<String>,
    /// Number of cells.
    pub n_cells: usize,
    /// Volume \[length^3\].
    pub volume: f64,
    /// Mass \[mass\].
    pub mass: f64,
    /// Centre of mass \[length\].
    pub centre: [f64; 3],
    /// Inertia tensor about the centre of mass \[mass length^2\]; the mass of plane cells is taken to lie in the plane.
    pub inertia: [[f64; 3]; 3],
}

impl RegionSummary {
    /// A mass at a point.
    pub(crate) fn of_point(mass: f64, centre: [f64; 3]) -> RegionSummary {
        RegionSummary { group: None, n_cells: 0, volume: 0.0, mass, centre, inertia: [[0.0; 3]; 3] }
    }

    /// Several regions as one body, its group `None`; inertia tensors are moved to the common centre of mass (Steiner).
    ///
    /// ```math
    /// I = sum_r I_r + m_r (|d_r|^2 1 - d_r d_r^T),      d_r = centre_r - centre
    /// ```
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::body::RegionSummary;
    /// let rubber = NeoHooke::new(1000.0, 500.0)?;
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(Region::new(rubber, 6.0)).build()?;
    /// let whole = RegionSummary::combined(body.regions());
    /// assert!((whole.inertia[0][0] - 1.0).abs() < 1e-14); // m (b^2 + c^2) / 12
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn combined(regions: &[RegionSummary]) -> RegionSummary {
        let total = |of: fn(&RegionSummary) -> f64| regions.iter().map(of).sum::<f64>();
        let mass = total(|region| region.mass);
        let centre = [0, 1, 2].map(|i| regions.iter().map(|r| r.mass * r.centre[i]).sum::<f64>() / mass);
        let mut inertia = [[0.0; 3]; 3];
        for region in regions {
            let d = [0, 1, 2].map(|i| region.centre[i] - centre[i]);
            let square: f64 = d.iter().map(|x| x * x).sum();
            for i in 0..3 {
                for j in 0..3 {
                    let diagonal = if i == j { square } else { 0.0 };
                    inertia[i][j] += region.inertia[i][j] + region.mass * (diagonal - d[i] * d[j]);
                }
            }
        }
        let n_cells = regions.iter().map(|region| region.n_cells).sum();
        RegionSummary { group: None, n_cells, volume: total(|region| region.volume), mass, centre, inertia }
    }
}

/// Region of every cell, checked to be exactly one per cell.
pub(crate) struct RegionOfCell(Vec<u32>);

impl RegionOfCell {
    pub(crate) fn new(mesh: &Mesh, regions: &[Region]) -> Result<Self> {
        let mut count = vec![0; mesh.n_cells()];
        let mut region_of_cell = vec![0; mesh.n_cells()];
        for (index, region) in regions.iter().enumerate() {
            region.viscosity.check()?;
            if let (Some(_), Viscosity { shear, bulk, .. }) = (region.link(), region.viscosity)
                && shear + bulk > 0.0
            {
                return Err(Error::Viscosity { name: "shear or bulk of links", value: shear + bulk });
            }
            let is_massless = region.link().is_some_and(|link| link.area() == 0.0);
            for (what, value) in [("density", region.density), ("thickness", region.thickness)] {
                if !(value > 0.0 && value.is_finite() || is_massless) {
                    return Err(Error::NotPositive { what: what.into(), value });
                }
            }
            let all: Vec<u32>;
            let cells = match &region.group {
                Some(name) => mesh.groups().cells(name)?,
                None => {
                    all = (0..mesh.n_cells() as u32).collect();
                    &all
                }
            };
            for &cell in cells {
                count[cell as usize] += 1;
                region_of_cell[cell as usize] = index as u32;
                let kind = mesh.cell(cell as usize).kind;
                if region.link().is_some() != (kind.dimension() == 1) {
                    return Err(Error::WrongMaterial { cell: cell as usize, kind });
                }
                let space = region.formulation.pressure_space(kind);
                space.map_err(|reason| Error::Formulation { cell: cell as usize, reason })?;
            }
        }
        match count.iter().position(|&count| count != 1) {
            Some(cell) => Err(Error::RegionCover { cell, count: count[cell] }),
            None => Ok(RegionOfCell(region_of_cell)),
        }
    }

    /// Thickness of every plane cell, cross section of every bar, 1 for solids.
    pub(crate) fn sections(&self, mesh: &Mesh, regions: &[Region]) -> Vec<f64> {
        let cells = mesh.cells().zip(&self.0);
        cells.map(|(cell, &region)| regions[region as usize].section(cell.kind)).collect()
    }

    /// Mass per volume of solid cells, per area of plane ones, per length of links.
    pub(crate) fn densities(&self, mesh: &Mesh, regions: &[Region]) -> Vec<f64> {
        let sections = self.sections(mesh, regions);
        self.0
            .iter()
            .zip(sections)
            .map(|(&region, section)| regions[region as usize].density * section)
            .collect()
    }

    pub(crate) fn indices(&self) -> &[u32] {
        &self.0
    }

    pub(crate) fn into_indices(self) -> Vec<u32> {
        self.0
    }
}

/// Cells of each region, ascending.
pub(crate) fn cells_by_region(region_of_cell: &[u32], n_regions: usize) -> Vec<Vec<u32>> {
    let mut cells = vec![Vec::new(); n_regions];
    region_of_cell.iter().zip(0..).for_each(|(&region, cell)| cells[region as usize].push(cell));
    cells
}

impl Region {
    /// Factor from the measure of a cell to its volume: thickness of plane cells, cross section of bars (0 for links
    /// without mass), 1 for solids.
    pub(crate) fn section(&self, kind: CellKind) -> f64 {
        match self.link() {
            Some(link) => link.area(),
            None if kind.dimension() == 2 => self.thickness,
            None => 1.0,
        }
    }
}

/// Consistent mass `M_AB = integral rho N_A N_B dV + m_A delta_AB` on the pattern, with point masses m_A.
pub(crate) fn mass(
    mesh: &Mesh,
    pattern: &Pattern,
    density_of_cell: &[f64],
    point_masses: &[f64],
) -> Vec<f64> {
    let mut mass = vec![0.0; pattern.n_blocks()];
    let (mut order, mut positions, mut sums) = (Vec::new(), Vec::new(), Vec::new());
    for_each_cell(mesh, 0..mesh.n_cells() as u32, |cell, _, table, weights| {
        let nodes = mesh.cell(cell).nodes;
        find_couplings(pattern, nodes, &mut order, &mut positions);
        sums.clear();
        // A coupling that a repeated node has twice is taken once, and both sums are added.
        sums.extend(positions.iter().map(|&position| std::mem::take(&mut mass[position])));
        for (point, weight) in weights.iter().enumerate() {
            let shapes = table.shapes_at(point);
            for (sums, N_A) in sums.chunks_exact_mut(nodes.len()).zip(shapes) {
                let factor = density_of_cell[cell] * weight * N_A;
                sums.iter_mut().zip(shapes).for_each(|(sum, N_B)| *sum += factor * N_B);
            }
        }
        positions.iter().zip(&sums).for_each(|(&position, &sum)| mass[position] += sum);
    });
    for (node, point_mass) in point_masses.iter().enumerate() {
        if let Some(position) = pattern.position(node, node) {
            mass[position] += point_mass;
        }
    }
    mass
}

/// Positions of the couplings of the nodes of a cell, `[n_nodes][n_nodes]`; `order` is memory for their order.
fn find_couplings(pattern: &Pattern, nodes: &[u32], order: &mut Vec<usize>, positions: &mut Vec<usize>) {
    let n = nodes.len();
    order.clear();
    order.extend(0..n);
    order.sort_unstable_by_key(|&local| nodes[local]);
    positions.resize(n * n, 0);
    for (row, own) in nodes.iter().zip(positions.chunks_exact_mut(n)) {
        let (columns, begin) = (pattern.row(*row as usize), pattern.range(*row as usize).start);
        let mut at = 0;
        for &local in &*order {
            while columns[at] < nodes[local] {
                at += 1;
            }
            own[local] = begin + at;
        }
    }
}

/// Mass of every node in some cells: row sums of the consistent mass, or the lumped mass, which are scaled diagonals
/// for quadratic cells.
pub(crate) fn nodal_masses(
    mesh: &Mesh,
    cells: impl Iterator<Item = u32>,
    density_of_cell: &[f64],
    kind: MassKind,
) -> Vec<f64> {
    let mut masses = vec![0.0; mesh.n_nodes()];
    for_each_mass_point(mesh, cells, kind, |cell, nodes, point| {
        let mass = density_of_cell[cell] * point.weight;
        for (&node, share) in nodes.iter().zip(point.shapes) {
            masses[node as usize] += mass * share;
        }
    });
    masses
}

/// Summaries of the regions, from the cells that are `chosen`.
pub(crate) fn summaries(
    mesh: &Mesh,
    regions: &[Region],
    of_cell: &RegionOfCell,
    chosen: impl Fn(u32) -> bool,
) -> Vec<RegionSummary> {
    let mut cells = cells_by_region(of_cell.indices(), regions.len());
    cells.iter_mut().for_each(|cells| cells.retain(|&cell| chosen(cell)));
    regions.iter().zip(cells).map(|(region, cells)| summary(mesh, region, cells)).collect()
}

fn summary(mesh: &Mesh, region: &Region, cells: Vec<u32>) -> RegionSummary {
    let n_cells = cells.len();
    let mut volume = 0.0;
    let mut first = [0.0; 3];
    let mut second = [[0.0; 3]; 3];
    // Moments about a point of the region, so that a body far from the origin keeps its digits.
    let origin =
        cells.first().map_or([0.0; 3], |&cell| mesh.points()[mesh.cell(cell as usize).nodes[0] as usize]);
    for_each_volume_point(mesh, cells.into_iter(), |cell, _, point| {
        let x = [0, 1, 2].map(|i| point.position[i] - origin[i]);
        let weight = point.weight * region.section(mesh.cell(cell).kind);
        volume += weight;
        (0..3).for_each(|i| first[i] += weight * x[i]);
        (0..3).for_each(|i| (0..3).for_each(|j| second[i][j] += weight * x[i] * x[j]));
    });
    // The centre of a region without volume is its first node.
    let offset = first.map(|x| if volume > 0.0 { x / volume } else { 0.0 });
    let central = [0, 1, 2].map(|i| [0, 1, 2].map(|j| second[i][j] - volume * offset[i] * offset[j]));
    let trace: f64 = (0..3).map(|i| central[i][i]).sum();
    let inertia = [0, 1, 2]
        .map(|i| [0, 1, 2].map(|j| region.density * (if i == j { trace } else { 0.0 } - central[i][j])));
    RegionSummary {
        group: region.group.clone(),
        n_cells,
        volume,
        mass: region.density * volume,
        centre: [0, 1, 2].map(|i| origin[i] + offset[i]),
        inertia,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Body;
    use crate::material::NeoHooke;
    use crate::mesh::{Mesh, MeshBuilder, block};

    fn region(group: &str, density: f64) -> Region {
        Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), density).on(group)
    }

    /// A block whose cells are the groups `lower` and `upper` along y.
    fn halves(size: [f64; 3]) -> Mesh {
        let whole = block(size, [2, 2, 2]).unwrap();
        let mut builder = MeshBuilder::new();
        whole.points().iter().for_each(|&point| {
            builder.point(point);
        });
        for cell in whole.cells() {
            let index = builder.cell(cell.kind, cell.nodes).unwrap();
            let y = cell.nodes.iter().map(|&node| whole.points()[node as usize][1]).fold(0.0, f64::max);
            builder.cell_group(if y > 0.5 * size[1] { "upper" } else { "lower" }, [index]);
        }
        builder.build().unwrap()
    }

    #[test]
    fn a_cell_with_repeated_nodes_has_its_whole_mass() {
        // Half of a unit cube: a brick whose edges at x = 1 are one edge each.
        let mut builder = MeshBuilder::new();
        for z in [0.0, 1.0] {
            for point in [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]] {
                builder.point(point);
            }
        }
        builder.cell(CellKind::Hex8, &[0, 1, 1, 2, 3, 4, 4, 5]).unwrap();
        let mesh = builder.build().unwrap();
        let pattern = Pattern::new(6, mesh.cells().map(|cell| cell.nodes));
        let mass = mass(&mesh, &pattern, &[4.0], &[0.0; 6]);
        let lumped = nodal_masses(&mesh, 0..1, &[4.0], MassKind::Lumped);
        for (row, lumped) in lumped.iter().enumerate() {
            assert!((mass[pattern.range(row)].iter().sum::<f64>() - lumped).abs() < 1e-15);
            assert!((mass[pattern.position(row, 1).unwrap()] > 0.0) && (lumped - 1.0 / 3.0).abs() < 1e-15);
        }
    }

    fn assert_box(summary: &RegionSummary, mass: f64, size: [f64; 3], centre: [f64; 3]) {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * mass, "{a} is not {b}");
        near(summary.volume, size.iter().product());
        near(summary.mass, mass);
        for i in 0..3 {
            near(summary.centre[i], centre[i]);
            for j in 0..3 {
                let square = size.iter().map(|x| x * x).sum::<f64>() - size[i] * size[i];
                near(summary.inertia[i][j], if i == j { mass * square / 12.0 } else { 0.0 });
            }
        }
    }

    /// Inertia of a box with edges a, b, c about its centre: m (b^2 + c^2) / 12.
    #[test]
    fn two_halves_are_the_box_that_they_make() {
        let size = [1.0, 4.0, 2.0];
        let body = Body::builder(halves(size))
            .region(region("lower", 3.0))
            .region(region("upper", 3.0))
            .build()
            .unwrap();
        assert_box(&body.regions()[1], 12.0, [1.0, 2.0, 2.0], [0.5, 3.0, 1.0]);
        assert_box(&RegionSummary::combined(body.regions()), 24.0, size, [0.5, 2.0, 1.0]);
    }

    #[test]
    fn halves_of_different_density_in_turns_the_common_centre() {
        // Cubes of edge 2, masses 8 and 24, centres 2 apart: I_xx = (8 + 24) 8/12 + 8 24/32 2^2, I_yy = 32 8/12.
        let body = Body::builder(halves([2.0, 4.0, 2.0]))
            .region(region("lower", 1.0))
            .region(region("upper", 3.0))
            .build();
        let whole = RegionSummary::combined(body.unwrap().regions());
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
        (0..3).for_each(|i| near(whole.centre[i], [1.0, 2.5, 1.0][i]));
        near(whole.inertia[0][0], 64.0 / 3.0 + 24.0);
        near(whole.inertia[1][1], 64.0 / 3.0);
        near(whole.inertia[2][2], 64.0 / 3.0 + 24.0);
        near(whole.inertia[0][1], 0.0);
    }
}
