//! Contacts, from groups to points with their areas.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::{Arc, Mutex};

use super::ObstacleContact;
use super::surfaces::SurfaceContact;
use crate::contact::{
    Intersection, Layer, LayerOf, ObstacleLayer, ObstacleSurface, Surface, SurfaceFacet, SurfaceLayer,
};
use crate::error::Result;
use crate::force::contact_summary::ContactSummary;
use crate::force::facets::FacetTable;
use crate::force::interface::Force;
use crate::force::source::{ForceSource, Site};
use crate::input::{Contact, ContactFault, Obstacle, Opponent};
use crate::mesh::{Facet, Mesh, roots};
use crate::number::{short, short_vector};

/// Least gap at the start over the thickness of the layer.
const LEAST_GAP: f64 = 1e-6;

/// Default thickness over the median edge of the facets, and over the smallest gap at the start.
const PART_OF_EDGE: f64 = 0.1;
const PART_OF_GAP: f64 = 0.5;

impl ForceSource for Contact {
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let fail = |key: &'static str, reason: String| self.error(number, (key, reason));
        let (mesh, own) = (site.mesh, site.mesh.surface_facets(self.surface.as_deref())?);
        if own.is_empty() {
            return Err(fail("surfaces", "its surface has no facets on the boundary".into()));
        }
        for (what, value) in [("stiffness", self.stiffness), ("distance", self.distance)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(fail(what, format!("its {what} must be a positive number, not {value}")));
            }
        }
        let of_other = match &self.opponent {
            Opponent::Surface(other) => mesh.surface_facets(Some(other))?,
            Opponent::Obstacle(_) | Opponent::Bodies => Vec::new(),
        };
        let all: Vec<Facet> = own.iter().chain(&of_other).copied().collect();
        let modulus = match self.stiffness {
            Some(stiffness) => stiffness,
            None => smallest_modulus(&all, site)
                .ok_or_else(|| fail("", "its cells have no Young's modulus: give its `stiffness`".into()))?,
        };
        let distance = self.distance.unwrap_or_else(|| PART_OF_EDGE * median_edge(mesh, &all));
        let layer = Layer { modulus, thickness: distance, law: self.law };
        match &self.opponent {
            Opponent::Obstacle(obstacle) => self.of_obstacle((obstacle, number), layer, &own, site),
            Opponent::Surface(other) => {
                if of_other.is_empty() {
                    return Err(fail("surfaces", format!("\"{other}\" has no facets on the boundary")));
                }
                self.of_surfaces([&own, &of_other], layer, number, site)
            }
            Opponent::Bodies => self.of_surfaces([&own, &[]], layer, number, site),
        }
    }
}

impl Contact {
    /// The contact with an obstacle; `layer`: with the thickness before it is limited by the gap.
    fn of_obstacle(
        &self,
        (obstacle, number): (&Obstacle, usize),
        layer: Layer,
        facets: &[Facet],
        site: &Site<'_>,
    ) -> Result<Arc<dyn Force>> {
        let surface = obstacle.surface().map_err(|fault| self.error(number, fault))?;
        let tables = FacetTable::of(site.mesh, site.pattern, facets, site.section);
        let bodies: Vec<Vec<u32>> = tables.iter().map(|table| vec![0; table.facets().count()]).collect();
        let own = surface_of(tables.iter().zip(&bodies), Surface::without_triangles);
        let gaps = own.positions.iter().map(|X| (surface.gap(*X), *X));
        let (gap, at) = gaps.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, [0.0; 3]));
        if gap <= 0.0 {
            let whole = largest_gap(&surface, &own.nodes, site);
            return Err(self.error(number, not_outside(obstacle, [gap, whole], at, layer.thickness)));
        }
        let layer = self.limited(layer, gap);
        let points = ObstacleLayer { surface, layer };
        let guards = ObstacleLayer { surface, layer: layer.of(LayerOf::Guards) };
        let moving = self.moves().then(|| site.mesh.group_nodes(&self.group_of_obstacle(number)));
        let obstacle = moving.transpose()?.and_then(|nodes| nodes.first().copied());
        let summary =
            ContactSummary { obstacle, ..summary(self.name(number), facets.len(), &own, layer, gap) };
        let mut contact = ObstacleContact { summary, surface: own, points, guards };
        contact.summary.energy = energy_at_rest(&contact, site);
        Ok(Arc::new(contact))
    }

    /// The contact between two surfaces, or between the bodies of the first if the second is empty.
    fn of_surfaces(
        &self,
        facets: [&[Facet]; 2],
        layer: Layer,
        number: usize,
        site: &Site<'_>,
    ) -> Result<Arc<dyn Force>> {
        let fail = |reason: String| self.error(number, ("surfaces", reason));
        let mesh = site.mesh;
        let is_plane = |facet: &Facet| mesh.cell(facet.cell as usize).kind.dimension() < 3;
        if facets.iter().copied().flatten().any(is_plane) {
            return Err(fail("contact between plane bodies is not there yet; with an obstacle it is".into()));
        }
        let tables = facets.map(|facets| FacetTable::of(mesh, site.pattern, facets, site.section));
        let bodies = self.bodies(&tables, site).map_err(fail)?;
        let surface = surface_of(tables.iter().flatten().zip(&bodies), Surface::new);
        let mut layer = SurfaceLayer { surface, layer };
        let apart =
            format!("leave a gap of about the distance of the layer, {}", short(layer.layer.thickness));
        if let Some(Intersection { at, deepest }) = layer.intersection() {
            return Err(fail(match deepest {
                Some((node, depth)) => format!(
                    "its surfaces intersect at {}, and {} lies {} inside the other body: move the bodies apart by \
                     more than that",
                    short_vector(at),
                    short_vector(node),
                    short(depth)
                ),
                None => format!("its surfaces touch or intersect at {}: {apart}", short_vector(at)),
            }));
        }
        if let Some(([inner, outer], at)) = layer.enclosed(whole_parts(mesh, &facets.concat())) {
            let [inner, outer] = [inner, outer].map(|body| self.name_of_body(body, &tables, &bodies, mesh));
            return Err(fail(format!(
                "{inner} lies inside {outer}, at {}: bodies in contact begin outside of each other, or in a cavity",
                short_vector(at)
            )));
        }
        let nearest = layer.gap();
        let gap = nearest.map_or(f64::INFINITY, |(gap, _)| gap);
        layer.layer = self.limited(layer.layer, gap);
        if let Some((gap, at)) = nearest.filter(|(gap, _)| *gap < LEAST_GAP * layer.layer.thickness) {
            return Err(fail(format!(
                "its smallest gap is {} at {}, and the energy of the layer is infinite at contact: {apart}",
                short(gap),
                short_vector(at)
            )));
        }
        let n_facets = facets.iter().map(|facets| facets.len()).sum();
        let summary = summary(self.name(number), n_facets, &layer.surface, layer.layer, gap);
        let [search, bound] = [Mutex::default(), Mutex::default()];
        let mut contact = SurfaceContact { summary, layer, search, bound };
        if gap < contact.summary.distance {
            contact.summary.energy = energy_at_rest(&contact, site);
        }
        Ok(Arc::new(contact))
    }

    /// The body of each facet, `[table][facet]`: the two surfaces, or the connected parts of the first if there is no
    /// second. The error is the reason why they cannot be in contact.
    fn bodies(&self, [own, other]: &[Vec<FacetTable>; 2], site: &Site<'_>) -> Result<Vec<Vec<u32>>, String> {
        if let Opponent::Surface(group) = &self.opponent {
            let nodes = |tables: &[FacetTable]| -> BTreeSet<u32> {
                tables.iter().flat_map(|table| table.nodes.iter().copied()).collect()
            };
            if let Some(node) = nodes(own).intersection(&nodes(other)).next() {
                let at = short_vector(site.mesh.points()[*node as usize]);
                return Err(format!(
                    "its surfaces share a node at {at}: bodies that are to touch need nodes of their own, and contact \
                     of \"{group}\" with itself is not there yet; two surfaces of one body may meet if they share none"
                ));
            }
            let of = |tables: &[FacetTable], body: u32| -> Vec<Vec<u32>> {
                tables.iter().map(|table| vec![body; table.facets().count()]).collect()
            };
            return Ok([of(own, 0), of(other, 1)].concat());
        }
        let pattern = site.pattern;
        let roots = roots(pattern.n_rows(), (0..pattern.n_rows()).map(|row| pattern.row(row)));
        let root = |nodes: &[u32]| roots[nodes[0] as usize];
        let all: Vec<Vec<u32>> =
            own.iter().map(|table| table.facets().map(|facet| root(facet.nodes)).collect()).collect();
        let different: BTreeSet<u32> = all.iter().flatten().copied().collect();
        match different.len() {
            0 | 1 => Err(
                "its surface is that of one body, and contact of a body with itself is not there yet: name \
                          a second surface that shares no node with it, or an `obstacle`"
                    .to_string(),
            ),
            _ => {
                let numbers: BTreeMap<u32, u32> = different.into_iter().zip(0..).collect();
                Ok(all.iter().map(|of_table| of_table.iter().map(|body| numbers[body]).collect()).collect())
            }
        }
    }

    /// The name of a body, as the input or the mesh has it. `tables`, `bodies`: the facets, and the body of each.
    fn name_of_body(
        &self,
        body: u32,
        tables: &[Vec<FacetTable>; 2],
        bodies: &[Vec<u32>],
        mesh: &Mesh,
    ) -> String {
        let own = match (&self.opponent, body) {
            (Opponent::Surface(other), 1) => Some(other),
            (Opponent::Surface(_), _) => self.surface.as_ref(),
            _ => None,
        };
        if let Some(own) = own {
            return format!("\"{own}\"");
        }
        let facets = tables.iter().flatten().zip(bodies).flat_map(|(table, of)| table.facets().zip(of));
        let node = facets.filter(|(_, own)| **own == body).map(|(facet, _)| facet.nodes[0]).next();
        let cells = mesh.parts().into_iter().find(|cells| {
            cells.iter().any(|cell| node.is_some_and(|node| mesh.cell(*cell as usize).nodes.contains(&node)))
        });
        let cells = cells.unwrap_or_default();
        let has_all = |group: &&Vec<u32>| cells.iter().all(|cell| group.binary_search(cell).is_ok());
        let groups = mesh.groups().cells.iter().filter(|(_, group)| has_all(group));
        match (groups.min_by_key(|(_, group)| group.len()), cells.first()) {
            (Some((name, group)), _) if group.len() < mesh.n_cells() => format!("\"{name}\""),
            (_, Some(cell)) => format!("the part with cell {cell}"),
            _ => "a part".to_string(),
        }
    }

    /// The layer with a default thickness of at most half of the smallest gap.
    fn limited(&self, layer: Layer, gap: f64) -> Layer {
        let thickness = self.distance.unwrap_or(layer.thickness.min(PART_OF_GAP * gap));
        Layer { thickness, ..layer }
    }
}

/// The largest gap of all nodes of the bodies to which some nodes belong.
fn largest_gap(surface: &ObstacleSurface, nodes: &[u32], site: &Site<'_>) -> f64 {
    let mesh = site.mesh;
    let roots = roots(mesh.n_nodes(), mesh.cells().map(|cell| cell.nodes));
    let own: BTreeSet<u32> = nodes.iter().map(|node| roots[*node as usize]).collect();
    let of_bodies = mesh.points().iter().zip(&roots).filter(|(_, root)| own.contains(root));
    of_bodies.map(|(X, _)| surface.gap(*X)).fold(f64::NEG_INFINITY, f64::max)
}

/// The fault of a surface that is not outside of an obstacle: the smallest gap of its nodes, at a place, and the
/// largest one of the whole body.
fn not_outside(obstacle: &Obstacle, [gap, of_body]: [f64; 2], at: [f64; 3], thickness: f64) -> ContactFault {
    let (at, depth) = (short_vector(at), short(-gap));
    let lies = format!("its surface is not outside of the obstacle: the node at {at} lies {depth} behind it");
    match obstacle {
        _ if gap == 0.0 => {
            let reason = format!(
                "its surface touches the obstacle at {at}: leave a gap of about the distance of the layer, {}",
                short(thickness)
            );
            ("obstacle", reason)
        }
        Obstacle::Plane { normal, .. } if of_body <= 0.0 => {
            let opposite = short_vector(normal.map(|x| 0.0 - x));
            let reason = format!(
                "{lies}, as the whole body does, and `normal` points from the plane to the body: take the opposite \
                 one, {opposite}"
            );
            ("normal", reason)
        }
        Obstacle::Sphere { inside: false, .. } | Obstacle::Cylinder { inside: false, .. }
            if of_body <= 0.0 =>
        {
            ("obstacle", format!("{lies}, as the whole body does: if it is to be inside, say so by `inside`"))
        }
        Obstacle::Sphere { inside: true, .. } | Obstacle::Cylinder { inside: true, .. } if of_body <= 0.0 => {
            ("inside", format!("{lies}, as the whole body does: if it is to be outside, leave out `inside`"))
        }
        _ => ("obstacle", format!("{lies}: move the body or the obstacle by more than that")),
    }
}

/// The part of a node by the connections of solid cells; `None` unless some facets are its whole boundary.
fn whole_parts(mesh: &Mesh, facets: &[Facet]) -> impl Fn(u32) -> Option<u32> {
    let solids = mesh.cells().filter(|cell| cell.kind.dimension() == 3).map(|cell| cell.nodes);
    let roots = roots(mesh.n_nodes(), solids);
    let (own, boundary): (HashSet<Facet>, HashSet<Facet>) =
        (facets.iter().copied().collect(), mesh.boundary_facets().into_iter().collect());
    let root = |facet: &Facet| mesh.facet_nodes(*facet).next().map(|node| roots[node as usize]);
    let open: HashSet<u32> = own.symmetric_difference(&boundary).filter_map(root).collect();
    move |node| Some(roots[node as usize]).filter(|root| !open.contains(root))
}

/// The smallest Young's modulus of the cells of some facets.
fn smallest_modulus(facets: &[Facet], site: &Site<'_>) -> Option<f64> {
    let mut regions: Vec<u32> = facets.iter().map(|facet| site.region_of_cell[facet.cell as usize]).collect();
    regions.sort_unstable();
    regions.dedup();
    let moduli = regions.iter().filter_map(|&region| site.regions[region as usize].youngs_modulus());
    moduli.reduce(f64::min)
}

/// A surface of tables of facets with the body of each facet.
fn surface_of<'a>(
    tables: impl Iterator<Item = (&'a FacetTable, &'a Vec<u32>)>,
    make: impl Fn(&[SurfaceFacet<'_>]) -> Surface,
) -> Surface {
    let tables: Vec<_> = tables.map(|(table, bodies)| (table, table.areas(), bodies)).collect();
    let facets = tables.iter().flat_map(|(table, areas, bodies)| {
        let areas = areas.chunks_exact(table.n_points());
        table.facets().zip(areas).zip(*bodies).map(|((facet, areas), &body)| SurfaceFacet {
            kind: table.kind(),
            nodes: facet.nodes,
            positions: facet.points,
            shapes: table.shapes(),
            areas,
            body,
        })
    });
    make(&facets.collect::<Vec<_>>())
}

/// The summary of a contact on a surface.
fn summary(name: String, n_facets: usize, surface: &Surface, layer: Layer, gap: f64) -> ContactSummary {
    let points = || surface.points.iter().filter(|point| !point.is_guard);
    ContactSummary {
        name,
        n_facets,
        n_points: points().count(),
        n_triangles: surface.triangles.len(),
        n_sharp_edges: surface.n_sharp_edges(),
        area: points().map(|point| point.area).sum(),
        stiffness: layer.modulus,
        distance: layer.thickness,
        law: layer.law,
        smallest_gap: gap,
        energy: 0.0,
        obstacle: None,
    }
}

/// Energy of the layer of a contact in the reference configuration \[energy\].
fn energy_at_rest(contact: &dyn Force, site: &Site<'_>) -> f64 {
    contact.strain_state(&vec![0.0; 3 * site.mesh.n_nodes()], &[]).contact.energy
}

/// Median length of the edges of some facets.
fn median_edge(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let mut lengths: Vec<f64> = Vec::new();
    for &facet in facets {
        let n = mesh.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind.n_corners();
        let corners: Vec<[f64; 3]> =
            mesh.facet_nodes(facet).take(n).map(|node| mesh.points()[node as usize]).collect();
        let n_edges = if n == 2 { 1 } else { n };
        lengths.extend((0..n_edges).map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % n]);
            (0..3).map(|d| (b[d] - a[d]).powi(2)).sum::<f64>().sqrt()
        }));
    }
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f64::total_cmp).1
}
