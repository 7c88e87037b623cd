//! Masses spread over groups: per area of facets, per volume of cells, per length of links, in equal parts at nodes.

use super::regions::RegionSummary;
use crate::error::{Error, Result};
use crate::input::SpreadMass;
use crate::mesh::{Facet, Mesh};
use crate::space::geometry::{MassKind, QuadraturePoint, for_each_facet_point, for_each_volume_point};
use crate::sparse::Pattern;
use crate::team::Subdomain;

/// Facets, cells or nodes of a group: the first kind that it has.
#[derive(Debug)]
enum Over {
    Facets(Vec<Facet>),
    Cells(Vec<u32>),
    Nodes(Vec<u32>),
}

/// A facet, a cell or a node.
#[derive(Debug, Clone, Copy)]
struct Member {
    /// Its place in the group.
    index: usize,
    /// The cell to which it belongs; `None` for a node.
    cell: Option<usize>,
}

impl Over {
    fn new(mesh: &Mesh, group: &str) -> Result<Self> {
        if let Ok(facets) = mesh.groups().facets(group) {
            return Ok(Over::Facets(facets.to_vec()));
        }
        if let Ok(cells) = mesh.groups().cells(group) {
            return Ok(Over::Cells(cells.to_vec()));
        }
        Ok(Over::Nodes(mesh.group_nodes(group)?))
    }

    fn len(&self) -> usize {
        match self {
            Over::Facets(facets) => facets.len(),
            Over::Cells(cells) => cells.len(),
            Over::Nodes(nodes) => nodes.len(),
        }
    }

    /// Visits the points of all members. Weights are areas, volumes, lengths of links, or 1 at a node; `section`:
    /// thickness of plane cells.
    fn for_each_point(
        &self,
        mesh: &Mesh,
        section: &[f64],
        mut visit: impl FnMut(Member, &[u32], QuadraturePoint<'_>),
    ) {
        match self {
            Over::Facets(facets) => {
                for (index, &facet) in facets.iter().enumerate() {
                    let member = Member { index, cell: Some(facet.cell as usize) };
                    for_each_facet_point(mesh, &[facet], section, |nodes, point| visit(member, nodes, point));
                }
            }
            Over::Cells(cells) => {
                let (mut index, mut last) = (0, cells.first().map(|&cell| cell as usize));
                for_each_volume_point(mesh, cells.iter().copied(), |cell, nodes, point| {
                    index += usize::from(last != Some(cell));
                    last = Some(cell);
                    let section = if is_link(mesh, cell) { 1.0 } else { section[cell] };
                    let point = QuadraturePoint { weight: section * point.weight, ..point };
                    visit(Member { index, cell: Some(cell) }, nodes, point);
                });
            }
            Over::Nodes(nodes) => {
                for (index, &node) in nodes.iter().enumerate() {
                    let position = mesh.points()[node as usize];
                    let point = QuadraturePoint { weight: 1.0, position, shapes: &[1.0] };
                    visit(Member { index, cell: None }, &[node], point);
                }
            }
        }
    }
}

fn is_link(mesh: &Mesh, cell: usize) -> bool {
    mesh.cell(cell).kind.dimension() == 1
}

/// Whether a member counts on a rank of these ranks.
fn counts(ranks: &Subdomain, member: Member, nodes: &[u32]) -> bool {
    match member.cell {
        Some(cell) => ranks.counts()[cell],
        None => (nodes[0] as usize) < ranks.n_own,
    }
}

/// Sizes of the groups of some masses on this rank, each in two parts: total length of the links, area or volume of
/// others or number of nodes. Zeros where a group or a region is invalid, which the builder reports.
pub(crate) fn sizes(mesh: &Mesh, section: &[f64], masses: &[SpreadMass], ranks: &Subdomain) -> Vec<f64> {
    let mut sizes = vec![0.0; 2 * masses.len()];
    for (mass, size) in masses.iter().zip(sizes.chunks_exact_mut(2)) {
        let Ok(over) = Over::new(mesh, &mass.group) else { continue };
        over.for_each_point(mesh, section, |member, nodes, point| {
            if counts(ranks, member, nodes) {
                size[usize::from(member.cell.is_none_or(|cell| !is_link(mesh, cell)))] += point.weight;
            }
        });
    }
    sizes
}

/// The masses of a body that are spread, with the points at which they lie.
#[derive(Debug, Default)]
pub struct Spread {
    masses: Vec<(Over, f64)>,
}

impl Spread {
    /// The masses over their groups; `sizes`: of all ranks, see [`sizes`].
    ///
    /// # Errors
    /// [`Error::NotPositive`], [`Error::UnknownGroup`], [`Error::Mass`].
    pub(crate) fn new(mesh: &Mesh, masses: &[SpreadMass], sizes: &[f64]) -> Result<Self> {
        let spread = |(mass, size): (&SpreadMass, &[f64])| {
            let SpreadMass { group, total } = mass;
            if !(*total > 0.0 && total.is_finite()) {
                return Err(Error::NotPositive { what: "total of a mass".into(), value: *total });
            }
            let over = Over::new(mesh, group)?;
            let fault = |reason: &str| Error::Mass { group: group.clone(), reason: reason.to_string() };
            match size {
                [0.0, 0.0] => {
                    Err(fault("the group has no area, volume or length over which a mass can be spread"))
                }
                [links, others] if *links > 0.0 && *others > 0.0 => Err(fault(
                    "the group has links and other cells, lengths and volumes; use a group for each",
                )),
                _ => Ok((over, total / size.iter().sum::<f64>())),
            }
        };
        Ok(Spread { masses: masses.iter().zip(sizes.chunks_exact(2)).map(spread).collect::<Result<_>>()? })
    }

    /// Visits all points with their masses as weights, and with the functions of a kind of mass, as in cells
    /// ([`MassKind`]).
    pub(crate) fn for_each_point(
        &self,
        mesh: &Mesh,
        section: &[f64],
        kind: MassKind,
        mut visit: impl FnMut(&[u32], QuadraturePoint<'_>),
    ) {
        let mut scaled = Vec::new();
        for (over, density) in &self.masses {
            let mut sums = vec![[0.0; 2]; if kind == MassKind::Lumped { over.len() } else { 0 }];
            over.for_each_point(mesh, section, |member, _, point| {
                if let Some([whole, diagonal]) = sums.get_mut(member.index) {
                    *whole += point.weight;
                    *diagonal += point.weight * point.shapes.iter().map(|N| N * N).sum::<f64>();
                }
            });
            over.for_each_point(mesh, section, |member, nodes, point| {
                let weight = density * point.weight;
                let is_quadratic = member.cell.is_some_and(|cell| {
                    let cell = mesh.cell(cell);
                    cell.nodes.len() > cell.kind.n_corners()
                });
                let mut shapes = point.shapes;
                if let Some([whole, diagonal]) = sums.get(member.index).filter(|_| is_quadratic) {
                    scaled.clear();
                    scaled.extend(shapes.iter().map(|N| N * N * whole / diagonal));
                    shapes = &scaled;
                }
                visit(nodes, QuadraturePoint { weight, position: point.position, shapes });
            });
        }
    }

    /// Adds the consistent mass `integral rho N_A N_B` to the blocks of a pattern.
    pub(crate) fn add_to(&self, mesh: &Mesh, section: &[f64], pattern: &Pattern, mass: &mut [f64]) {
        self.for_each_point(mesh, section, MassKind::Consistent, |nodes, point| {
            for (&row, N_A) in nodes.iter().zip(point.shapes) {
                for (&column, N_B) in nodes.iter().zip(point.shapes) {
                    if let Some(position) = pattern.position(row as usize, column as usize) {
                        mass[position] += point.weight * N_A * N_B;
                    }
                }
            }
        });
    }

    /// Mass, centre and inertia of each mass on this rank, like regions without cells.
    pub(crate) fn summaries(
        &self,
        mesh: &Mesh,
        section: &[f64],
        names: &[SpreadMass],
        ranks: &Subdomain,
    ) -> Vec<RegionSummary> {
        let summary = |((over, density), SpreadMass { group, .. }): (&(Over, f64), &SpreadMass)| {
            let mut points = Vec::new();
            over.for_each_point(mesh, section, |member, nodes, point| {
                if counts(ranks, member, nodes) {
                    points.push(RegionSummary::of_point(density * point.weight, point.position));
                }
            });
            RegionSummary { group: Some(group.clone()), ..RegionSummary::combined(&points) }
        };
        self.masses.iter().zip(names).map(summary).collect()
    }
}

/// Integral of the position over the members of a group that count on this rank, and of 1.
pub(crate) fn centre_sums(mesh: &Mesh, section: &[f64], group: &str, ranks: &Subdomain) -> Result<[f64; 4]> {
    let mut sums = [0.0; 4];
    Over::new(mesh, group)?.for_each_point(mesh, section, |member, nodes, point| {
        if counts(ranks, member, nodes) {
            (0..3).for_each(|i| sums[i] += point.weight * point.position[i]);
            sums[3] += point.weight;
        }
    });
    Ok(sums)
}
