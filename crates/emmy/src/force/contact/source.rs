//! Contacts with obstacles, from groups to points with their areas.

use std::sync::Arc;

use super::ObstacleContact;
use crate::contact::{Layer, ObstacleLayer};
use crate::error::{Error, Result};
use crate::force::contact_summary::ContactSummary;
use crate::force::facets::FacetTable;
use crate::force::interface::Force;
use crate::force::source::{ForceSource, Site};
use crate::input::Contact;
use crate::mesh::{Facet, Mesh};
use crate::number::short_vector;

/// Thickness of the layer of the guards over that of the points.
const GUARD: f64 = 0.5;

/// Default thickness over the median edge of the facets, and over the smallest gap at the start.
const PART_OF_EDGE: f64 = 0.1;
const PART_OF_GAP: f64 = 0.5;

impl ForceSource for Contact {
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let name = self.name(number);
        let fail = |reason: String| Error::Contact { contact: name.clone(), reason };
        let surface = self.obstacle.surface().map_err(fail)?;
        let (mesh, facets) = (site.mesh, self.facets(site.mesh)?);
        if facets.is_empty() {
            return Err(fail("its surface has no facets on the boundary".into()));
        }
        for (what, value) in [("stiffness", self.stiffness), ("distance", self.distance)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(fail(format!("its {what} must be a positive number, not {value}")));
            }
        }
        let modulus = match self.stiffness {
            Some(stiffness) => stiffness,
            None => smallest_modulus(&facets, site)
                .ok_or_else(|| fail("its cells have no Young's modulus: give its stiffness".into()))?,
        };
        let tables = FacetTable::of(mesh, site.pattern, &facets, site.section);
        let areas: Vec<Vec<f64>> = tables.iter().map(FacetTable::areas).collect();
        let nodes = nodes_with_areas(&tables, &areas, site);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|(node, ..)| mesh.points()[*node as usize]).collect();
        let gaps = positions.iter().map(|X| surface.gap(*X));
        let (nearest, gap) =
            gaps.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY));
        if gap <= 0.0 {
            let at = short_vector(positions[nearest]);
            return Err(fail(format!(
                "its surface is not outside of the obstacle at {at}: move the body away"
            )));
        }
        let thickness = self.distance.unwrap_or_else(|| {
            let edge = median_edge(mesh, &facets);
            (PART_OF_EDGE * edge).min(PART_OF_GAP * gap)
        });
        let layer =
            |thickness: f64| ObstacleLayer { surface, layer: Layer { modulus, thickness, law: self.law } };
        let (points, guards) = (layer(thickness), layer(GUARD * thickness));
        let summary = ContactSummary {
            name,
            n_facets: facets.len(),
            n_points: areas.iter().map(Vec::len).sum(),
            area: areas.iter().flatten().sum(),
            stiffness: modulus,
            distance: thickness,
            law: self.law,
            smallest_gap: gap,
        };
        Ok(Arc::new(ObstacleContact { summary, points, guards, tables, areas, nodes, positions }))
    }
}

impl Contact {
    /// The facets of its surface.
    fn facets(&self, mesh: &Mesh) -> Result<Vec<Facet>> {
        let Some(group) = &self.surface else { return Ok(mesh.boundary_facets()) };
        if let Ok(facets) = mesh.groups().facets(group) {
            return Ok(facets.to_vec());
        }
        let mut is_meant = vec![false; mesh.n_cells()];
        mesh.groups().cells(group)?.iter().for_each(|cell| is_meant[*cell as usize] = true);
        Ok(mesh.boundary_facets().into_iter().filter(|facet| is_meant[facet.cell as usize]).collect())
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
