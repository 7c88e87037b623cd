//! Contact of surfaces with obstacles.

use std::sync::Arc;

use super::contact_summary::ContactSummary;
use super::facets::{FacetOfTable, FacetTable};
use super::integral::Scratch;
use super::interface::{Book, Force, ForceMemory, Side};
use super::source::{ForceSource, Site};
use super::step::StepInput;
use super::strain_state::{ContactState, StrainState};
use crate::average::{ContactRule, FollowerRule, Request, Rule};
use crate::contact::{Layer, Obstacle, ObstacleLayer, Path};
use crate::error::{Error, Result};
use crate::input::Contact;
use crate::mesh::{Facet, Mesh};
use crate::nodal;
use crate::number::short_vector;
use crate::sparse::RowPart;

/// Largest degree of a time element, with those of the estimators.
const MAX_STAGES: usize = 16;

/// Thickness of the layer of the guards, which keep nodes from passing between the points, over that of the points.
const GUARD: f64 = 0.5;

/// Default thickness over the median edge of the facets, and over the smallest gap at the start.
const PART_OF_EDGE: f64 = 0.1;
const PART_OF_GAP: f64 = 0.5;

/// Part of the gap that a correction may leave.
const LEFT: f64 = 0.2;

/// A layer on a surface that stores energy where an obstacle is near: at the quadrature points of its facets, and in a
/// thinner layer at its nodes, the guards.
#[derive(Debug)]
struct ObstacleContact {
    summary: ContactSummary,
    points: ObstacleLayer,
    guards: ObstacleLayer,
    tables: Vec<FacetTable>,
    /// Reference areas of the points, for each table `[facet][point]` \[length^2\].
    areas: Vec<Vec<f64>>,
    /// Nodes with their reference areas and their places on the diagonal of the pattern, ascending.
    nodes: Vec<(u32, f64, u32)>,
    /// Reference positions of these nodes.
    positions: Vec<[f64; 3]>,
}

impl ForceSource for Contact {
    fn force(&self, number: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let name = self.name(number);
        let fail = |reason: String| Error::Contact { contact: name.clone(), reason };
        check_obstacle(&self.obstacle).map_err(fail)?;
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
        let gaps = positions.iter().map(|X| self.obstacle.gap(*X));
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
        let layer = |thickness: f64| ObstacleLayer {
            obstacle: self.obstacle,
            layer: Layer { modulus, thickness, law: self.law },
        };
        let (points, guards) = (layer(thickness), layer(GUARD * thickness));
        let summary = ContactSummary {
            name,
            n_facets: facets.len(),
            n_points: areas.iter().map(Vec::len).sum(),
            area: areas.iter().flatten().sum(),
            stiffness: modulus,
            distance: thickness,
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

/// Checks the numbers of an obstacle; the error is the reason.
fn check_obstacle(obstacle: &Obstacle) -> Result<(), String> {
    let (place, direction, radius) = match *obstacle {
        Obstacle::Plane { point, normal } => (point, Some(("normal", normal)), None),
        Obstacle::Sphere { centre, radius, .. } => (centre, None, Some(radius)),
        Obstacle::Cylinder { point, axis, radius, .. } => (point, Some(("axis", axis)), Some(radius)),
    };
    if let Some(value) = place.iter().find(|value| !value.is_finite()) {
        return Err(format!("the place of its obstacle must be finite numbers, not {value}"));
    }
    if let Some((what, direction)) = direction {
        let size = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(size > 0.0 && size.is_finite()) {
            return Err(format!("the {what} of its obstacle has no direction"));
        }
    }
    match radius {
        Some(radius) if !(radius > 0.0 && radius.is_finite()) => {
            Err(format!("the radius of its obstacle must be a positive number, not {radius}"))
        }
        _ => Ok(()),
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

/// Forces of a point and their derivatives, as wide as any step.
struct PointForces {
    forces: [[f64; 3]; MAX_STAGES],
    derivatives: [[[f64; 3]; 3]; MAX_STAGES * MAX_STAGES],
}

impl ObstacleContact {
    /// The path of a point that is a combination of nodes.
    fn path<'a>(
        step: &StepInput<'a>,
        rates: &'a mut [[f64; 3]; MAX_STAGES],
        terms: impl Iterator<Item = (u32, [f64; 3], f64)>,
    ) -> Path<'a> {
        let (n, k) = (step.displacement.len(), step.rule.degree());
        let mut start = [0.0; 3];
        rates[..k].fill([0.0; 3]);
        for (node, X, share) in terms {
            for d in 0..3 {
                let dof = nodal::dof(node as usize, d);
                start[d] += share * (X[d] + step.displacement[dof]);
                (0..k).for_each(|i| rates[i][d] += share * step.rates[i * n + dof]);
            }
        }
        Path {
            start,
            rates: &rates[..k],
            coefficients: step.rule.coefficients(),
            weights: step.rule.weights(),
        }
    }

    /// The error of a path that leads through the obstacle.
    fn check_path(&self, path: &Path<'_>, rule: &ContactRule) -> Result<()> {
        let obstacle = &self.points.obstacle;
        let mut from = path.start;
        let mut visit = |to: [f64; 3]| {
            let passes = obstacle.gap(to) <= 0.0 || obstacle.is_passed(from, to);
            from = to;
            if passes { Err(Error::Passed { contact: self.summary.name.clone(), at: to }) } else { Ok(()) }
        };
        match rule {
            ContactRule::Conserving => (0..path.rates.len()).try_for_each(|i| visit(path.stage(i)))?,
            ContactRule::Points(points) => {
                (0..points.n_points()).try_for_each(|m| visit(path.at(points.integrals(m))))?;
            }
            ContactRule::Kept => {}
        }
        visit(path.end())
    }

    /// Sets the stage averages of the force on a point per area, with their derivatives if they are wanted. Returns
    /// whether one is not zero.
    fn set_forces(
        layer: &ObstacleLayer,
        (path, rule, request): (&Path<'_>, &ContactRule, Request),
        PointForces { forces, derivatives }: &mut PointForces,
    ) -> bool {
        let k = path.rates.len();
        let forces = &mut forces[..k];
        let derivatives =
            if request == Request::Tangent { &mut derivatives[..k * k] } else { &mut derivatives[..0] };
        match rule {
            ContactRule::Conserving => layer.conserving_forces(path, forces, derivatives),
            ContactRule::Kept => layer.kept_force(path, forces, derivatives),
            ContactRule::Points(points) => add_point_forces(layer, (path, &**points), forces, derivatives),
        }
    }

    /// Calls a function with the stage averages of the force on each point that has one, times its area: nodes, their
    /// shares, places of their pairs in the pattern, area, forces and derivatives. Only facets and nodes of which some
    /// are wanted are evaluated.
    fn for_each_point(
        &self,
        (step, rule, request): (&StepInput<'_>, &ContactRule, Request),
        is_wanted: impl Fn(u32) -> bool,
        visit: &mut dyn FnMut(PointOfSurface<'_>, &PointForces),
    ) -> Result<()> {
        let mut rates = [[0.0; 3]; MAX_STAGES];
        let mut own = PointForces {
            forces: [[0.0; 3]; MAX_STAGES],
            derivatives: [[[0.0; 3]; 3]; MAX_STAGES * MAX_STAGES],
        };
        for (table, areas) in self.tables.iter().zip(&self.areas) {
            for (facet, areas) in table.facets().zip(areas.chunks_exact(table.n_points())) {
                if !facet.nodes.iter().any(|node| is_wanted(*node)) {
                    continue;
                }
                for (point, &area) in areas.iter().enumerate() {
                    let shares = table.shapes_at(point);
                    let path = Self::path(step, &mut rates, terms(&facet, shares));
                    self.check_path(&path, rule)?;
                    if Self::set_forces(&self.points, (&path, rule, request), &mut own) {
                        visit(PointOfSurface { nodes: facet.nodes, shares, pairs: facet.pairs, area }, &own);
                    }
                }
            }
        }
        for (&(node, area, place), X) in self.nodes.iter().zip(&self.positions) {
            if is_wanted(node) {
                let path = Self::path(step, &mut rates, std::iter::once((node, *X, 1.0)));
                self.check_path(&path, rule)?;
                if Self::set_forces(&self.guards, (&path, rule, request), &mut own) {
                    let nodes = &[node];
                    visit(PointOfSurface { nodes, shares: &[1.0], pairs: &[place], area }, &own);
                }
            }
        }
        Ok(())
    }

    /// Calls a function with each point at a displacement: its layer, area and position.
    fn for_each_position(&self, displacement: &[f64], visit: &mut dyn FnMut(&ObstacleLayer, f64, [f64; 3])) {
        let position = |terms: &mut dyn Iterator<Item = (u32, [f64; 3], f64)>| {
            let mut q = [0.0; 3];
            for (node, X, share) in terms {
                let u = nodal::at(displacement, node as usize);
                (0..3).for_each(|d| q[d] += share * (X[d] + u[d]));
            }
            q
        };
        for (table, areas) in self.tables.iter().zip(&self.areas) {
            for (facet, areas) in table.facets().zip(areas.chunks_exact(table.n_points())) {
                for (point, &area) in areas.iter().enumerate() {
                    let q = position(&mut terms(&facet, table.shapes_at(point)));
                    visit(&self.points, area, q);
                }
            }
        }
        for (&(node, area, _), X) in self.nodes.iter().zip(&self.positions) {
            visit(&self.guards, area, position(&mut std::iter::once((node, *X, 1.0))));
        }
    }
}

/// A point of a surface: nodes with their shares, the places of their pairs in the pattern, and its reference area.
struct PointOfSurface<'a> {
    nodes: &'a [u32],
    shares: &'a [f64],
    pairs: &'a [u32],
    area: f64,
}

/// Nodes of a facet with their reference positions and shares.
fn terms<'a>(
    facet: &FacetOfTable<'a>,
    shares: &'a [f64],
) -> impl Iterator<Item = (u32, [f64; 3], f64)> + use<'a> {
    let nodes = facet.nodes.iter().zip(facet.points);
    nodes.zip(shares).map(|((node, X), share)| (*node, *X, *share))
}

/// The forces by the gradient of the energy at points of the step. Returns whether one is not zero.
fn add_point_forces(
    layer: &ObstacleLayer,
    (path, points): (&Path<'_>, &FollowerRule),
    forces: &mut [[f64; 3]],
    derivatives: &mut [[[f64; 3]; 3]],
) -> bool {
    let k = forces.len();
    forces.fill([0.0; 3]);
    derivatives.fill([[0.0; 3]; 3]);
    let mut acts = false;
    for m in 0..points.n_points() {
        let integrals = points.integrals(m);
        let q = path.at(integrals);
        if layer.obstacle.gap(q) >= layer.layer.thickness {
            continue;
        }
        acts = true;
        let (gradient, stiffness) = layer.gradient(q);
        for (i, weight) in points.stage_weights(m).iter().enumerate() {
            (0..3).for_each(|d| forces[i][d] += weight * gradient[d]);
            for (j, integral) in integrals.iter().enumerate().take(if derivatives.is_empty() { 0 } else { k })
            {
                for (sum, row) in derivatives[i * k + j].iter_mut().zip(&stiffness) {
                    sum.iter_mut().zip(row).for_each(|(sum, entry)| *sum += weight * integral * entry);
                }
            }
        }
    }
    acts
}

impl Force for ObstacleContact {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        Side::Outside
    }

    fn memory(&self, rule: &Rule) -> ForceMemory {
        ForceMemory::new(ContactRule::new(rule))
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        memory: &ForceMemory,
        _: usize,
        _: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let (k, rows) = (step.rule.degree(), sink.rows());
        let is_wanted = |node: u32| rows.contains(&(node as usize));
        self.for_each_point((step, memory.of(), request), is_wanted, &mut |point, own| {
            let n = point.nodes.len();
            for (A, (&node, share)) in point.nodes.iter().zip(point.shares).enumerate() {
                if !is_wanted(node) {
                    continue;
                }
                let weight = share * point.area;
                (0..k).for_each(|i| sink.add_force(i, node, own.forces[i].map(|f| weight * f)));
                if request == Request::Stress {
                    continue;
                }
                for (B, other) in point.shares.iter().enumerate() {
                    let weight = step.tangent_factor * weight * other;
                    for (stages, derivative) in own.derivatives[..k * k].iter().enumerate() {
                        let block = sink.block_mut(point.pairs[A * n + B] as usize, stages);
                        let entries = block.iter_mut().zip(derivative.as_flattened());
                        entries.for_each(|(sum, entry)| *sum += weight * entry);
                    }
                }
            }
        })
    }

    fn strain_state(&self, displacement: &[f64], _: &[f64]) -> StrainState {
        let mut contact = ContactState::NONE;
        self.for_each_position(displacement, &mut |layer, area, q| {
            let gap = layer.obstacle.gap(q);
            // Of points beyond the layer, too, but for those that are far away.
            if gap < NEAR * self.points.layer.thickness {
                contact.smallest_gap = contact.smallest_gap.min(gap / self.points.layer.thickness);
            }
            if gap < layer.layer.thickness {
                contact.n_points += 1;
                contact.energy += area * layer.by_gap(gap)[0];
            }
        });
        StrainState { contact, ..StrainState::NONE }
    }

    fn for_each_reaction(
        &self,
        (step, memory): (&StepInput<'_>, &ForceMemory),
        stage: usize,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        let input = (step, memory.of(), Request::Stress);
        // A step that is solved leads through no obstacle.
        let _ = self.for_each_point(input, |_| true, &mut |point, own| {
            for (&node, share) in point.nodes.iter().zip(point.shares) {
                visit(node as usize, own.forces[stage].map(|f| -share * point.area * f));
            }
        });
    }

    fn bounds(&self) -> bool {
        true
    }

    fn largest_part(&self, step: &StepInput<'_>, memory: &ForceMemory, correction: &[f64]) -> f64 {
        let rule: &ContactRule = memory.of();
        let obstacle = &self.points.obstacle;
        let (mut rates, mut changes) = ([[0.0; 3]; MAX_STAGES], [[0.0; 3]; MAX_STAGES]);
        let change = StepInput { rates: correction, ..*step };
        let mut part = 1.0f64;
        let mut bound = |q: [f64; 3], dq: [f64; 3]| {
            let n = obstacle.gradient(q);
            let approach = -(0..3).map(|d| n[d] * dq[d]).sum::<f64>();
            let most = (1.0 - LEFT) * obstacle.gap(q);
            if approach > most && most > 0.0 {
                part = part.min(most / approach);
            }
        };
        for (&(node, ..), X) in self.nodes.iter().zip(&self.positions) {
            let path = Self::path(step, &mut rates, std::iter::once((node, *X, 1.0)));
            let moved = Self::path(&change, &mut changes, std::iter::once((node, *X, 1.0)));
            let mut at = |integrals: &[f64]| {
                let [q, changed] = [path.at(integrals), moved.at(integrals)];
                bound(q, [0, 1, 2].map(|d| changed[d] - moved.start[d]));
            };
            match rule {
                ContactRule::Points(points) => (0..points.n_points()).for_each(|m| at(points.integrals(m))),
                _ => path.coefficients.chunks_exact(path.rates.len()).for_each(&mut at),
            }
            at(path.weights);
        }
        part
    }

    fn is_sudden(&self, step: &StepInput<'_>, memory: &ForceMemory) -> bool {
        let mut acts = false;
        let input = (step, memory.of(), Request::Stress);
        self.for_each_point(input, |_| true, &mut |_, _| acts = true).is_err() || acts
    }

    fn contact(&self) -> Option<&ContactSummary> {
        Some(&self.summary)
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        Some("contact is not covered")
    }
}

/// Gaps beyond this many thicknesses are not reported.
const NEAR: f64 = 2.0;
