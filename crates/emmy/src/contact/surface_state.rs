//! Surfaces outside of a step: energies and gaps, whether they intersect, and how far a correction may go.

#![allow(non_snake_case)]

use super::candidates::{Candidate, Candidates};
use super::closest::{Closest, PairKind, PairVectors, combination, pair_vectors};
use super::layer::LayerOf;
use super::links::PairState;
use super::path::paths_meet;
use super::surface::Surface;
use super::surface_layer::SurfaceLayer;
use super::tree::{Bounds, BoxTree};
use crate::tensor::dot3;

/// Gaps beyond this many thicknesses are not reported.
pub const NEAR: f64 = 2.0;

/// Gaps in the reference configuration beyond this many thicknesses are not looked for.
const FARTHEST_GAP: f64 = 128.0;

/// Energy and gaps at one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceState {
    /// Energy.
    pub energy: f64,
    /// Smallest distance \[length\]; infinite if nothing is nearer than two thicknesses.
    pub smallest_gap: f64,
    /// Number of points and guards in contact.
    pub n_points: usize,
}

/// Contact at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceNode {
    /// Normal force over the reference area around the node on facets that are pressed.
    pub pressure: f64,
    /// Reference area around the node on all facets \[length^2\].
    pub area: f64,
    /// Distance to the nearest opponent \[length\]; infinite if nothing is nearer than two thicknesses.
    pub gap: f64,
}

/// Memory for configurations outside of a step.
#[derive(Debug, Clone, Default)]
pub struct SurfaceSearch {
    candidates: Candidates,
    nodal: Vec<[f64; 3]>,
    /// Positions of the entities.
    x: Vec<[f64; 3]>,
    /// The same after a correction.
    corrected: Vec<[f64; 3]>,
}

impl SurfaceSearch {
    /// Sets positions of the entities from those of the nodes, by their numbers.
    fn set(
        surface: &Surface,
        nodal: &mut Vec<[f64; 3]>,
        position: impl Fn(usize) -> [f64; 3],
        x: &mut Vec<[f64; 3]>,
    ) {
        nodal.clear();
        nodal.extend((0..surface.nodes.len()).map(position));
        x.resize(surface.n_entities(), [0.0; 3]);
        surface.combine(nodal, x);
    }
}

impl SurfaceLayer {
    /// Calls a function with each pair that is nearer than two thicknesses, in its state; with points, those that are
    /// nearer than one: guards and edges have the smallest distances.
    fn for_each_near(
        &self,
        position: impl Fn(usize) -> [f64; 3],
        search: &mut SurfaceSearch,
        mut visit: impl FnMut(&Candidate, &PairState),
    ) {
        let SurfaceSearch { candidates, nodal, x, .. } = search;
        SurfaceSearch::set(&self.surface, nodal, position, x);
        let near_of = |of: LayerOf| self.layer.thickness * if of == LayerOf::Points { 1.0 } else { NEAR };
        candidates.cover(&self.surface, near_of, &[&x]);
        for candidate in &candidates.pairs {
            let near = near_of(candidate.layer);
            if !candidate.is_apart(&[&x], near) {
                let state = PairState::new(candidate.kind, candidate.vectors(x));
                if state.closest.squared_distance < near * near {
                    visit(candidate, &state);
                }
            }
        }
    }

    /// Energy and gaps at positions of the nodes, `position` by the number of a node of the surface.
    pub fn state(&self, position: impl Fn(usize) -> [f64; 3], search: &mut SurfaceSearch) -> SurfaceState {
        let mut own = SurfaceState { energy: 0.0, smallest_gap: f64::INFINITY, n_points: 0 };
        let mut last = None;
        self.for_each_near(position, search, |candidate, state| {
            let (pair, gap) = (self.pair(candidate), state.closest.squared_distance.sqrt());
            own.energy += pair.energy(state);
            own.smallest_gap = own.smallest_gap.min(gap);
            // The pairs of a point follow each other.
            let is_point = candidate.kind != PairKind::EdgeEdge;
            if is_point && gap < pair.layer.thickness && last != Some(candidate.entities[0]) {
                last = Some(candidate.entities[0]);
                own.n_points += 1;
            }
        });
        own
    }

    /// Contact at each node of the surface.
    ///
    /// A point counts with the force on it alone, twice, as its opponents count half of it.
    pub fn nodes(
        &self,
        position: impl Fn(usize) -> [f64; 3],
        search: &mut SurfaceSearch,
    ) -> Vec<SurfaceNode> {
        let mut forces = vec![[0.0; 3]; self.surface.n_entities()];
        let mut gaps = vec![f64::INFINITY; self.surface.nodes.len()];
        self.for_each_near(position, search, |candidate, state| {
            if candidate.kind == PairKind::EdgeEdge {
                return;
            }
            let (force, point) = (self.pair(candidate).gradient(state)[0], candidate.entities[0] as usize);
            (0..3).for_each(|d| forces[point][d] += 2.0 * force[d]);
            if candidate.layer == LayerOf::Guards {
                gaps[point] = gaps[point].min(state.closest.squared_distance.sqrt());
            }
        });
        let pressures = self.surface.pressures_at_nodes(|point| {
            let force = forces[point.entity as usize];
            dot3(force, force).sqrt() / point.area
        });
        let nodes = pressures.into_iter().zip(gaps);
        nodes.map(|([pressure, area], gap)| SurfaceNode { pressure, area, gap }).collect()
    }

    /// Smallest distance between two bodies in the reference configuration; infinite beyond 128 times the
    /// thickness of the layer.
    pub fn gap(&self) -> f64 {
        let mut X = vec![[0.0; 3]; self.surface.n_entities()];
        self.surface.combine(&self.surface.positions, &mut X);
        let mut reach = self.layer.thickness;
        while reach < FARTHEST_GAP * self.layer.thickness {
            let mut candidates = Candidates::default();
            candidates.cover(&self.surface, |_| reach, &[&X]);
            let pairs = candidates.pairs.iter();
            let squares = pairs.map(|own| Closest::new(own.kind, &own.vectors(&X)).squared_distance);
            let gap = squares.fold(f64::INFINITY, f64::min).sqrt();
            if gap < reach {
                return gap;
            }
            reach *= 2.0;
        }
        f64::INFINITY
    }

    /// Where an edge of one body and a triangle of another intersect in the reference configuration: an end of the edge
    /// and a corner of the triangle.
    pub fn intersection(&self) -> Option<[[f64; 3]; 2]> {
        let surface = &self.surface;
        let mut X = vec![[0.0; 3]; surface.n_entities()];
        surface.combine(&surface.positions, &mut X);
        let bounds = |entities: &[u32]| {
            entities.iter().fold(Bounds::NONE, |sum, entity| sum.with(Bounds::of(X[*entity as usize])))
        };
        let boxes: Vec<Bounds> = surface.triangles.iter().map(|triangle| bounds(&triangle.corners)).collect();
        let mut tree = BoxTree::default();
        tree.fit(&boxes);
        let mut found = None;
        for edge in &surface.edges {
            let query = bounds(&edge.ends);
            tree.for_each_meeting(&boxes, &query, &mut |number| {
                let corners = surface.triangles[number as usize].corners;
                let is_other = surface.body_of[corners[0] as usize] != surface.body_of[edge.ends[0] as usize];
                if found.is_some() || !is_other {
                    return;
                }
                // The point that moves along the edge meets the triangle.
                let [a, b, c] = corners.map(|corner| X[corner as usize]);
                let [from, to] = edge.ends.map(|end| [X[end as usize], a, b, c]);
                if paths_meet(PairKind::PointTriangle, &from, &to) {
                    found = Some([from[0], a]);
                }
            });
        }
        found
    }

    /// Largest part, up to 1, of the changes of positions at the end of a step that leaves a part of every gap.
    /// `position` and `change` by the number of a node of the surface.
    pub fn largest_part(
        &self,
        position: impl Fn(usize) -> [f64; 3],
        change: impl Fn(usize) -> [f64; 3],
        left: f64,
        search: &mut SurfaceSearch,
    ) -> f64 {
        let SurfaceSearch { candidates, nodal, x, corrected } = search;
        SurfaceSearch::set(&self.surface, nodal, position, x);
        SurfaceSearch::set(&self.surface, nodal, change, corrected);
        for (corrected, x) in corrected.iter_mut().zip(&*x) {
            (0..3).for_each(|d| corrected[d] += x[d]);
        }
        // All pairs that meet on the way are in the list, whenever it was made.
        candidates.cover(&self.surface, |of| self.layer.of(of).thickness, &[&*x, &*corrected]);
        let mut part = 1.0f64;
        for candidate in candidates.pairs.iter().filter(|candidate| candidate.can_meet()) {
            let [x, corrected]: [PairVectors; 2] = [candidate.vectors(x), candidate.vectors(corrected)];
            if !paths_meet(candidate.kind, &x, &corrected) {
                continue;
            }
            let changes = pair_vectors(|a, d| corrected[a][d] - x[a][d]);
            let closest = Closest::new(candidate.kind, &x);
            let approach = -dot3(closest.link, combination(&closest.weights, &changes));
            let most = (1.0 - left) * closest.squared_distance;
            if approach > most && most > 0.0 {
                part = part.min(most / approach);
            }
        }
        part
    }
}
