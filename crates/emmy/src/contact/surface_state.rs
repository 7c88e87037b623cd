//! Surfaces outside of a step: energies and gaps, and how far a correction may go.

#![allow(non_snake_case)]

use super::candidates::{Candidate, Candidates};
use super::closest::{Closest, PairKind, PairVectors, combination, pair_vectors};
use super::layer::LayerOf;
use super::links::PairState;
use super::path::paths_meet;
use super::surface::Surface;
use super::surface_layer::SurfaceLayer;
use crate::tensor::dot3;

/// Gaps beyond this many thicknesses are not reported.
pub const NEAR: f64 = 2.0;

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
    /// Positions of the nodes, before and after a correction.
    nodal: [Vec<[f64; 3]>; 2],
    /// Positions of the entities in the list.
    x: [Vec<[f64; 3]>; 2],
}

impl SurfaceSearch {
    /// Sets the positions of the nodes, by their numbers, before a correction.
    fn set(&mut self, surface: &Surface, position: impl Fn(usize) -> [f64; 3]) {
        self.nodal[0].clear();
        self.nodal[0].extend((0..surface.nodes.len()).map(position));
    }

    /// Makes the list hold for the first n configurations, and sets the entities in them. Returns a bound on the change
    /// of every distance since the list was made.
    fn cover(&mut self, n: usize, surface: &Surface, reach: impl Fn(LayerOf) -> f64) -> f64 {
        let SurfaceSearch { candidates, nodal, x } = self;
        candidates.cover(surface, reach, &nodal[..n]);
        for (nodal, x) in nodal[..n].iter().zip(x) {
            x.resize(surface.n_entities(), [0.0; 3]);
            surface.combine_those(&candidates.entities, nodal, x);
        }
        candidates.largest_change(surface, &nodal[..n])
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
        let near_of = |of: LayerOf| self.layer.thickness * if of == LayerOf::Points { 1.0 } else { NEAR };
        search.set(&self.surface, position);
        let change = search.cover(1, &self.surface, near_of);
        let SurfaceSearch { candidates, x: [x, _], .. } = search;
        for (candidate, distance) in candidates.pairs.iter().zip(&candidates.distances) {
            let near = near_of(candidate.layer);
            if *distance >= near + change || candidate.is_apart(&[&x], near) {
                continue;
            }
            let state = PairState::new(candidate.kind, candidate.vectors(x));
            if state.closest.squared_distance < near * near {
                visit(candidate, &state);
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

    /// Largest part, up to 1, of the changes of positions at the end of a step that leaves a part of every gap.
    /// `position` and `change` by the number of a node of the surface.
    pub fn largest_part(
        &self,
        position: impl Fn(usize) -> [f64; 3],
        change: impl Fn(usize) -> [f64; 3],
        left: f64,
        search: &mut SurfaceSearch,
    ) -> f64 {
        search.set(&self.surface, position);
        let [before, after] = &mut search.nodal;
        after.clear();
        after.extend(before.iter().enumerate().map(|(node, x)| {
            let dx = change(node);
            [0, 1, 2].map(|d| x[d] + dx[d])
        }));
        // All pairs that meet on the way are in the list, whenever it was made.
        let largest_change = search.cover(2, &self.surface, |of| self.layer.of(of).thickness);
        let SurfaceSearch { candidates, x: [x, corrected], .. } = search;
        let mut part = 1.0f64;
        for (candidate, distance) in candidates.pairs.iter().zip(&candidates.distances) {
            if *distance > largest_change || !candidate.can_meet() {
                continue;
            }
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
