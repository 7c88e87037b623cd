//! Contacts, from groups to points with their areas.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use super::ObstacleContact;
use super::surfaces::SurfaceContact;
use crate::contact::{Layer, LayerOf, ObstacleLayer, Surface, SurfaceFacet, SurfaceLayer};
use crate::error::{Error, Result};
use crate::force::contact_summary::ContactSummary;
use crate::force::facets::FacetTable;
use crate::force::interface::Force;
use crate::force::source::{ForceSource, Site};
use crate::input::{Contact, Obstacle, Opponent};
use crate::mesh::{Facet, Mesh, roots};
use crate::number::{short, short_vector};

/// Least gap at the start over the thickness of the layer.
const LEAST_GAP: f64 = 1e-6;

/// Default thickness over the median edge of the facets, and over the smallest gap at the start.
const PART_OF_EDGE: f64 = 0.1;
const PART_OF_GAP: f64 = 0.5;

impl ForceSource for Contact {
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let name = self.name(number);
        let fail = |reason: String| Error::Contact { contact: name.clone(), reason };
        let (mesh, own) = (site.mesh, site.mesh.surface_facets(self.surface.as_deref())?);
        if own.is_empty() {
            return Err(fail("its surface has no facets on the boundary".into()));
        }
        for (what, value) in [("stiffness", self.stiffness), ("distance", self.distance)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(fail(format!("its {what} must be a positive number, not {value}")));
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
                .ok_or_else(|| fail("its cells have no Young's modulus: give its stiffness".into()))?,
        };
        let distance = self.distance.unwrap_or_else(|| PART_OF_EDGE * median_edge(mesh, &all));
        let layer = Layer { modulus, thickness: distance, law: self.law };
        match &self.opponent {
            Opponent::Obstacle(obstacle) => self.of_obstacle(obstacle, layer, &own, name.clone(), site),
            Opponent::Surface(other) => {
                if of_other.is_empty() {
                    return Err(fail(format!("\"{other}\" has no facets on the boundary")));
                }
                self.of_surfaces([&own, &of_other], layer, name.clone(), site)
            }
            Opponent::Bodies => self.of_surfaces([&own, &[]], layer, name.clone(), site),
        }
    }
}

impl Contact {
    /// The contact with an obstacle; `layer`: with the thickness before it is limited by the gap.
    fn of_obstacle(
        &self,
        obstacle: &Obstacle,
        layer: Layer,
        facets: &[Facet],
        name: String,
        site: &Site<'_>,
    ) -> Result<Arc<dyn Force>> {
        let fail = |reason: String| Error::Contact { contact: name.clone(), reason };
        let surface = obstacle.surface().map_err(fail)?;
        let tables = FacetTable::of(site.mesh, site.pattern, facets, site.section);
        let areas: Vec<Vec<f64>> = tables.iter().map(FacetTable::areas).collect();
        let nodes = nodes_with_areas(&tables, &areas, site);
        let positions: Vec<[f64; 3]> =
            nodes.iter().map(|(node, ..)| site.mesh.points()[*node as usize]).collect();
        let gaps = positions.iter().map(|X| surface.gap(*X));
        let (nearest, gap) =
            gaps.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY));
        if gap <= 0.0 {
            let at = short_vector(positions[nearest]);
            let reason = format!("its surface is not outside of the obstacle at {at}: move the body away");
            return Err(Error::Contact { contact: name, reason });
        }
        let layer = self.limited(layer, gap);
        let points = ObstacleLayer { surface, layer };
        let guards = ObstacleLayer { surface, layer: layer.of(LayerOf::Guards) };
        let summary = ContactSummary {
            name,
            n_facets: facets.len(),
            n_points: areas.iter().map(Vec::len).sum(),
            n_triangles: 0,
            n_sharp_edges: 0,
            area: areas.iter().flatten().sum(),
            stiffness: layer.modulus,
            distance: layer.thickness,
            law: layer.law,
            smallest_gap: gap,
        };
        Ok(Arc::new(ObstacleContact { summary, points, guards, tables, areas, nodes, positions }))
    }

    /// The contact between two surfaces, or between the bodies of the first if the second is empty.
    fn of_surfaces(
        &self,
        facets: [&[Facet]; 2],
        layer: Layer,
        name: String,
        site: &Site<'_>,
    ) -> Result<Arc<dyn Force>> {
        let fail = |reason: String| Error::Contact { contact: name.clone(), reason };
        let mesh = site.mesh;
        let is_plane = |facet: &Facet| mesh.cell(facet.cell as usize).kind.dimension() < 3;
        if facets.iter().copied().flatten().any(is_plane) {
            return Err(fail("contact between plane bodies is not there yet; with an obstacle it is".into()));
        }
        let tables = facets.map(|facets| FacetTable::of(mesh, site.pattern, facets, site.section));
        let areas: Vec<Vec<f64>> = tables.iter().flatten().map(FacetTable::areas).collect();
        let body_of = self.bodies(&tables, site).map_err(fail)?;
        let of_tables = tables.iter().flatten().zip(&areas).zip(&body_of);
        let all = of_tables.flat_map(|((table, areas), bodies)| {
            let areas = areas.chunks_exact(table.n_points());
            table.facets().zip(areas).zip(bodies).map(|((facet, areas), &body)| SurfaceFacet {
                kind: table.kind(),
                nodes: facet.nodes,
                positions: facet.points,
                shapes: table.shapes(),
                areas,
                body,
            })
        });
        let surface = Surface::new(&all.collect::<Vec<_>>());
        let mut layer = SurfaceLayer { surface, layer };
        if let Some([at, other]) = layer.intersection() {
            return Err(fail(format!(
                "its surfaces touch or intersect at {}, near the node at {}: move the bodies apart",
                short_vector(at),
                short_vector(other),
            )));
        }
        let gap = layer.gap();
        layer.layer = self.limited(layer.layer, gap);
        if gap < LEAST_GAP * layer.layer.thickness {
            return Err(fail(format!(
                "its smallest gap is {}, and the energy of the layer is infinite at contact: move the bodies apart",
                short(gap)
            )));
        }
        let summary = ContactSummary {
            name,
            n_facets: facets.iter().map(|facets| facets.len()).sum(),
            n_points: areas.iter().map(Vec::len).sum(),
            n_triangles: layer.surface.triangles.len(),
            n_sharp_edges: layer.surface.n_sharp_edges(),
            area: areas.iter().flatten().sum(),
            stiffness: layer.layer.modulus,
            distance: layer.layer.thickness,
            law: layer.layer.law,
            smallest_gap: gap,
        };
        let first_body = body_of.iter().flatten().copied().min().unwrap_or(0);
        Ok(Arc::new(SurfaceContact {
            summary,
            layer,
            first_body,
            search: Mutex::default(),
            bound: Mutex::default(),
        }))
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
                     of \"{group}\" with itself is not there yet"
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
                          another surface or an obstacle"
                    .to_string(),
            ),
            _ => Ok(all),
        }
    }

    /// The layer with a default thickness of at most half of the smallest gap.
    fn limited(&self, layer: Layer, gap: f64) -> Layer {
        let thickness = self.distance.unwrap_or(layer.thickness.min(PART_OF_GAP * gap));
        Layer { thickness, ..layer }
    }
}

/// The smallest Young's modulus of the cells of some facets.
fn smallest_modulus(facets: &[Facet], site: &Site<'_>) -> Option<f64> {
    let mut regions: Vec<u32> = facets.iter().map(|facet| site.region_of_cell[facet.cell as usize]).collect();
    regions.sort_unstable();
    regions.dedup();
    let moduli = regions.iter().filter_map(|&region| site.regions[region as usize].youngs_modulus());
    moduli.reduce(f64::min)
}

/// Nodes of some facets, each with an equal part of the area of its facets and its place on the diagonal of the
/// pattern.
fn nodes_with_areas(tables: &[FacetTable], areas: &[Vec<f64>], site: &Site<'_>) -> Vec<(u32, f64, u32)> {
    let mut all: Vec<(u32, f64)> = Vec::new();
    for (table, areas) in tables.iter().zip(areas) {
        for (facet, areas) in table.facets().zip(areas.chunks_exact(table.n_points())) {
            let part = areas.iter().sum::<f64>() / facet.nodes.len() as f64;
            all.extend(facet.nodes.iter().map(|node| (*node, part)));
        }
    }
    all.sort_by_key(|(node, _)| *node);
    let mut nodes: Vec<(u32, f64, u32)> = Vec::new();
    for (node, part) in all {
        match nodes.last_mut() {
            Some(last) if last.0 == node => last.1 += part,
            _ => nodes.push((node, part, site.pattern.coupling(node as usize, node as usize) as u32)),
        }
    }
    nodes
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
