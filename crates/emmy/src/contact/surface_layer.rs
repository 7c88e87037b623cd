//! The layer between surfaces, and its forces in a step.

#![allow(non_snake_case)]

use rayon::prelude::*;

use super::candidates::{Candidate, Candidates};
use super::closest::{Closest, PairKind, PairTangent, PairVectors, combination, pair_vectors};
use super::layer::{Layer, LayerOf};
use super::links::PairState;
use super::obstacle::MAX_STAGES;
use super::pair::Pair;
use super::path::paths_meet;
use super::step::PairStage;
use super::surface::Surface;
use super::tree::{Bounds, BoxTree};
use crate::average::{ContactRule, FollowerRule, Rule};
use crate::tensor::dot3;

/// Pairs that one thread takes at once: a number that does not depend on the threads.
const CHUNK: usize = 256;

/// A step in which an entity moves farther from the mean motion than this multiple of the extent of all surfaces is one
/// of an iteration that diverges; its list would have all pairs.
const FARTHEST: f64 = 2.0;

/// Gaps beyond this many thicknesses are not reported.
const NEAR: f64 = 2.0;

/// Gaps in the reference configuration beyond this many thicknesses are not looked for.
const FARTHEST_GAP: f64 = 128.0;

/// A vector of each entity, or of each node.
type Vectors = Vec<[f64; 3]>;

/// Layers on surfaces that can touch each other.
///
/// Each point and each guard forms pairs with the triangles, edges and vertices of the other bodies near it, with the
/// factor 1/2, as each surface has points and opponents. Edges form pairs with edges, which count once. Points and
/// triangles alone would let edges pass each other: sharp ones that cross, and, where facets are bent, others.
#[derive(Debug, Clone)]
pub struct SurfaceLayer {
    /// The surfaces.
    pub surface: Surface,
    /// Layer of the points.
    pub layer: Layer,
}

/// Energy and gaps at one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceState {
    /// Energy.
    pub energy: f64,
    /// Smallest distance \[length\]; infinite if nothing is nearer than two thicknesses.
    pub smallest_gap: f64,
    /// Number of points in contact.
    pub n_points: usize,
}

/// Memory for the steps of a rule.
#[derive(Debug, Clone)]
pub struct SurfaceMemory {
    rule: ContactRule,
    candidates: Candidates,
    /// Vectors of the nodes, as a memory.
    nodal: Vec<[f64; 3]>,
    /// Positions of the entities: at the start, at the end, and at the stages or the points of the rule.
    configurations: Vec<Vectors>,
    /// Rates of the entities, `[k]`.
    rates: Vec<Vectors>,
    chunks: Vec<Chunk>,
    n_chunks: usize,
    /// Stage forces on the nodes, `[k][node]`.
    forces: Vec<Vectors>,
    of_entities: Vec<[f64; 3]>,
}

#[derive(Debug, Clone, Default)]
struct Chunk {
    /// Numbers of the pairs that act.
    acting: Vec<u32>,
    /// Their forces, `[pair][k]`.
    forces: Vec<PairVectors>,
    /// Their derivatives, `[pair][i k + j]`.
    tangents: Vec<PairTangent>,
    stages: Vec<PairStage>,
    /// Where something passes.
    passed: Option<[f64; 3]>,
}

/// A pair that acts, with its derivatives, `[i k + j]`.
#[derive(Debug, Clone, Copy)]
pub struct ActingPair<'a> {
    /// The pair.
    pub pair: &'a Candidate,
    /// Stage forces on its entities, `[k]`.
    pub forces: &'a [PairVectors],
    /// Derivatives of the stage forces by the rates, `[i k + j]`; empty if they were not wanted.
    pub tangents: &'a [PairTangent],
}

impl SurfaceMemory {
    /// Memory for a rule.
    pub fn new(layer: &SurfaceLayer, rule: &Rule) -> Self {
        let (k, own) = (rule.degree(), ContactRule::new(rule));
        let n_inside = match &own {
            ContactRule::Conserving => k,
            ContactRule::Points(points) => points.n_points(),
            ContactRule::Kept => 0,
        };
        let Surface { nodes, .. } = &layer.surface;
        let of_entities = vec![[0.0; 3]; layer.surface.n_entities()];
        let of_nodes = vec![[0.0; 3]; nodes.len()];
        SurfaceMemory {
            rule: own,
            candidates: Candidates::default(),
            configurations: vec![of_entities.clone(); 2 + n_inside],
            rates: vec![of_entities.clone(); k],
            chunks: Vec::new(),
            n_chunks: 0,
            forces: vec![of_nodes.clone(); k],
            nodal: of_nodes,
            of_entities,
        }
    }

    /// Stage forces on the nodes as evaluated last, `[k][node]`.
    pub fn forces(&self) -> &[Vectors] {
        &self.forces
    }

    /// The pairs that act, as evaluated last.
    pub fn acting(&self) -> impl Iterator<Item = ActingPair<'_>> {
        let (k, pairs) = (self.rates.len(), &self.candidates.pairs);
        self.chunks[..self.n_chunks].iter().flat_map(move |chunk| {
            chunk.acting.iter().enumerate().map(move |(at, pair)| ActingPair {
                pair: &pairs[*pair as usize],
                forces: &chunk.forces[at * k..(at + 1) * k],
                tangents: chunk.tangents.get(at * k * k..(at + 1) * k * k).unwrap_or(&[]),
            })
        })
    }

    /// Whether some pair acts, as evaluated last.
    pub fn acts(&self) -> bool {
        self.chunks[..self.n_chunks].iter().any(|chunk| !chunk.acting.is_empty())
    }

    /// Sets the positions of the entities on the paths of the nodes: `position` and `rate`, of a stage, by the number
    /// of a node of the surface.
    fn set_paths(
        &mut self,
        surface: &Surface,
        rule: &Rule,
        position: impl Fn(usize) -> [f64; 3],
        rate: impl Fn(usize, usize) -> [f64; 3],
    ) {
        let SurfaceMemory { nodal, configurations, rates, .. } = self;
        nodal.iter_mut().enumerate().for_each(|(node, own)| *own = position(node));
        surface.combine(nodal, &mut configurations[0]);
        for (stage, rates) in rates.iter_mut().enumerate() {
            nodal.iter_mut().enumerate().for_each(|(node, own)| *own = rate(stage, node));
            surface.combine(nodal, rates);
        }
        let (start, others) = configurations.split_at_mut(1);
        let k = rule.degree();
        for (at, x) in others.iter_mut().enumerate() {
            let integrals = match (at.checked_sub(1), &self.rule) {
                (None, _) => rule.weights(),
                (Some(m), ContactRule::Points(points)) => points.integrals(m),
                (Some(i), _) => &rule.coefficients()[i * k..(i + 1) * k],
            };
            x.copy_from_slice(&start[0]);
            for (rates, integral) in rates.iter().zip(integrals) {
                for (x, rate) in x.iter_mut().zip(rates) {
                    (0..3).for_each(|d| x[d] += integral * rate[d]);
                }
            }
        }
    }
}

impl SurfaceLayer {
    fn layer_of(&self, candidate: &Candidate) -> Layer {
        self.layer.of(candidate.layer)
    }

    fn pair(&self, candidate: &Candidate) -> Pair {
        Pair { kind: candidate.kind, weight: candidate.weight, layer: self.layer_of(candidate) }
    }

    /// Evaluates the stage forces of a step, and with `tangents` their derivatives by the rates.
    ///
    /// # Errors
    /// A position where something would pass, or from which something moves too far.
    pub fn evaluate(
        &self,
        rule: &Rule,
        position: impl Fn(usize) -> [f64; 3],
        rate: impl Fn(usize, usize) -> [f64; 3],
        tangents: bool,
        memory: &mut SurfaceMemory,
    ) -> Result<(), [f64; 3]> {
        memory.forces.iter_mut().for_each(|forces| forces.fill([0.0; 3]));
        memory.n_chunks = 0;
        if matches!(memory.rule, ContactRule::Kept) {
            return Ok(());
        }
        memory.set_paths(&self.surface, rule, position, rate);
        self.find(memory)?;
        let SurfaceMemory { rule: own, candidates, configurations, rates, chunks, n_chunks, .. } = memory;
        let chunks_of = candidates.pairs.chunks(CHUNK);
        *n_chunks = chunks_of.len();
        if chunks.len() < *n_chunks {
            chunks.resize(*n_chunks, Chunk::default());
        }
        let work = |(number, chunk): (usize, &mut Chunk)| {
            let first = number * CHUNK;
            let last = (first + CHUNK).min(candidates.pairs.len());
            chunk.clear(rates.len());
            for (at, candidate) in (first..last).zip(&candidates.pairs[first..last]) {
                let input = (&*own, rule, &configurations[..], &rates[..]);
                self.add_pair((at as u32, candidate), input, tangents, chunk);
            }
        };
        let acting = &mut chunks[..*n_chunks];
        if acting.len() < 2 {
            acting.iter_mut().enumerate().for_each(work);
        } else {
            acting.par_iter_mut().enumerate().for_each(work);
        }
        if let Some(passed) = acting.iter().find_map(|chunk| chunk.passed) {
            return Err(passed);
        }
        self.sum_forces(memory);
        Ok(())
    }

    /// Makes the list of pairs hold for the paths.
    fn find(&self, memory: &mut SurfaceMemory) -> Result<(), [f64; 3]> {
        let SurfaceMemory { candidates, configurations, .. } = memory;
        let mut all: [&[[f64; 3]]; 3 * MAX_STAGES + 2] = [&[]; 3 * MAX_STAGES + 2];
        let n = configurations.len();
        all.iter_mut().zip(&*configurations).for_each(|(own, x)| *own = x);
        let [start, end] = [&configurations[0], &configurations[1]];
        let moved = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|d| b[d] - a[d]);
        let mut mean = [0.0; 3];
        for motion in start.iter().zip(end).map(moved) {
            (0..3).for_each(|d| mean[d] += motion[d] / start.len() as f64);
        }
        let farthest = FARTHEST * start.iter().fold(Bounds::NONE, |sum, x| sum.with(Bounds::of(*x))).extent();
        // A position that is no number is far, too.
        let is_near = |motion: [f64; 3]| (0..3).all(|d| (motion[d] - mean[d]).abs() <= farthest);
        if let Some(far) = start.iter().zip(end).map(moved).position(|motion| !is_near(motion)) {
            return Err(start[far]);
        }
        candidates.cover(&self.surface, self.layer.thickness, &all[..n]);
        Ok(())
    }

    /// Adds a pair to its chunk, if it acts.
    fn add_pair(
        &self,
        (number, candidate): (u32, &Candidate),
        (own, rule, configurations, rates): (&ContactRule, &Rule, &[Vectors], &[Vectors]),
        wants_tangents: bool,
        chunk: &mut Chunk,
    ) {
        let pair = self.pair(candidate);
        let [start, end] = [&configurations[0], &configurations[1]];
        let all = configurations.iter().map(|x| &x[..]);
        if candidate.is_apart(all, pair.layer.thickness) {
            return;
        }
        let (x_1, x_2) = (candidate.vectors(start), candidate.vectors(end));
        if candidate.can_meet() && paths_meet(pair.kind, &x_1, &x_2) {
            chunk.passed = chunk.passed.or(Some(x_1[0]));
            return;
        }
        let k = rates.len();
        let mut x = [PairVectors::default(); MAX_STAGES];
        x.iter_mut().zip(rates).for_each(|(own, rates)| *own = candidate.vectors(rates));
        let (at, of_tangents) = (chunk.forces.len(), chunk.tangents.len());
        chunk.forces.resize(at + k, PairVectors::default());
        if wants_tangents {
            chunk.tangents.resize(of_tangents + k * k, PairTangent::default());
        }
        let (forces, tangents) = (&mut chunk.forces[at..], &mut chunk.tangents[of_tangents..]);
        match own {
            ContactRule::Points(points) => {
                set_point_forces(&pair, points, candidate, &configurations[2..], forces, tangents);
            }
            _ => {
                let start = PairState::new(pair.kind, x_1);
                pair.forces(rule, &start, &x[..k], &mut chunk.stages, forces);
                if wants_tangents {
                    pair.tangents(rule, &start, &x[..k], &mut chunk.stages, tangents);
                }
            }
        }
        if forces.iter().flatten().flatten().any(|f| *f != 0.0) {
            chunk.acting.push(number);
        } else {
            chunk.forces.truncate(at);
            chunk.tangents.truncate(of_tangents);
        }
    }

    /// Sums the forces of all pairs, in their order.
    fn sum_forces(&self, memory: &mut SurfaceMemory) {
        let SurfaceMemory { candidates, chunks, n_chunks, forces, of_entities, rates, .. } = memory;
        let k = rates.len();
        for (stage, nodal) in forces.iter_mut().enumerate() {
            of_entities.fill([0.0; 3]);
            for chunk in &chunks[..*n_chunks] {
                for (pair, forces) in chunk.acting.iter().zip(chunk.forces.chunks_exact(k)) {
                    let candidate = &candidates.pairs[*pair as usize];
                    let entities = &candidate.entities[..candidate.kind.n_entities()];
                    for (entity, force) in entities.iter().zip(&forces[stage]) {
                        let sum = &mut of_entities[*entity as usize];
                        (0..3).for_each(|d| sum[d] += force[d]);
                    }
                }
            }
            self.surface.spread(of_entities, nodal);
        }
    }

    /// Energy and gaps at positions of the nodes, `position` by the number of a node of the surface.
    pub fn state(&self, position: impl Fn(usize) -> [f64; 3], search: &mut SurfaceSearch) -> SurfaceState {
        let SurfaceSearch { candidates, nodal, x, .. } = search;
        nodal.clear();
        nodal.extend((0..self.surface.nodes.len()).map(position));
        x.resize(self.surface.n_entities(), [0.0; 3]);
        self.surface.combine(nodal, x);
        // Pairs nearer than two thicknesses.
        candidates.cover(&self.surface, NEAR * self.layer.thickness, &[x]);
        let mut state = SurfaceState { energy: 0.0, smallest_gap: f64::INFINITY, n_points: 0 };
        let mut last = None;
        for candidate in &candidates.pairs {
            if candidate.is_apart([&x[..]].into_iter(), NEAR * self.layer.thickness) {
                continue;
            }
            let pair = self.pair(candidate);
            let own = PairState::new(pair.kind, candidate.vectors(x));
            state.energy += pair.energy(&own);
            let gap = own.closest.squared_distance.sqrt();
            if gap < NEAR * self.layer.thickness {
                state.smallest_gap = state.smallest_gap.min(gap);
            }
            // The pairs of a point follow each other.
            if gap < pair.layer.thickness && last != Some(candidate.entities[0]) {
                last = Some(candidate.entities[0]);
                state.n_points += 1;
            }
        }
        state
    }

    /// Calls a function with the number of each node, the normal force on it over the reference area around it on
    /// facets that are pressed, this area on all facets, and the distance to the nearest opponent, infinite beyond
    /// two thicknesses.
    ///
    /// A point counts with the force on it alone, twice, as its opponents count half of it.
    pub fn for_each_node(
        &self,
        position: impl Fn(usize) -> [f64; 3],
        search: &mut SurfaceSearch,
        visit: &mut dyn FnMut(usize, [f64; 3]),
    ) {
        self.state(position, search);
        let surface = &self.surface;
        let n = surface.nodes.len();
        let mut forces = vec![[0.0; 3]; surface.n_entities()];
        let mut gaps = vec![f64::INFINITY; n];
        let pairs = search.candidates.pairs.iter().filter(|candidate| candidate.kind != PairKind::EdgeEdge);
        for candidate in pairs {
            let (pair, point) = (self.pair(candidate), candidate.entities[0] as usize);
            let state = PairState::new(pair.kind, candidate.vectors(&search.x));
            let force = pair.gradient(&state)[0];
            (0..3).for_each(|d| forces[point][d] += 2.0 * force[d]);
            let gap = state.closest.squared_distance.sqrt();
            if candidate.layer == LayerOf::Guards && gap < NEAR * self.layer.thickness {
                gaps[point] = gaps[point].min(gap);
            }
        }
        let size = |entity: u32| dot3(forces[entity as usize], forces[entity as usize]).sqrt();
        // Force, area, and the area of facets that are pressed, of each node.
        let mut sums = vec![[0.0; 3]; n];
        for range in surface.facets.windows(2) {
            let points = &surface.points[range[0]..range[1]];
            let is_pressed = points.iter().any(|point| size(point.entity) > 0.0);
            for point in points {
                for (node, share) in surface.entity(point.entity) {
                    // Shares of nodes of quadratic facets have a mean of zero, or less than that.
                    let area = share.abs() * point.area;
                    sums[node][0] += share.abs() * size(point.entity);
                    sums[node][1] += area;
                    sums[node][2] += if is_pressed { area } else { 0.0 };
                }
            }
        }
        for (node, ([force, area, pressed], gap)) in sums.into_iter().zip(gaps).enumerate() {
            let pressed = if pressed > 0.0 { pressed } else { area };
            visit(node, [(force + size(node as u32)) / pressed, area, gap]);
        }
    }

    /// Smallest distance between two bodies in the reference configuration; infinite beyond 128 times the
    /// thickness of the layer.
    pub fn gap(&self) -> f64 {
        let mut wider = SurfaceLayer { surface: self.surface.clone(), layer: self.layer };
        let mut search = SurfaceSearch::default();
        while wider.layer.thickness < FARTHEST_GAP * self.layer.thickness {
            let state = wider.state(|node| self.surface.positions[node], &mut search);
            if state.smallest_gap.is_finite() {
                return state.smallest_gap;
            }
            wider.layer.thickness *= 2.0;
            search = SurfaceSearch::default();
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
        let SurfaceSearch { candidates, nodal, x, changed } = search;
        let n = self.surface.nodes.len();
        for (vectors, is_changed) in [(&mut *x, false), (&mut *changed, true)] {
            nodal.clear();
            nodal.extend((0..n).map(|node| {
                let (own, moved) = (position(node), if is_changed { change(node) } else { [0.0; 3] });
                [0, 1, 2].map(|d| own[d] + moved[d])
            }));
            vectors.resize(self.surface.n_entities(), [0.0; 3]);
            self.surface.combine(nodal, vectors);
        }
        // All pairs that meet on the way are in the list, whenever it was made.
        candidates.cover(&self.surface, self.layer.thickness, &[x, changed]);
        let mut part = 1.0f64;
        for candidate in candidates.pairs.iter().filter(|candidate| candidate.can_meet()) {
            let (x, corrected) = (candidate.vectors(x), candidate.vectors(changed));
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

/// Memory for configurations outside of a step.
#[derive(Debug, Clone, Default)]
pub struct SurfaceSearch {
    candidates: Candidates,
    nodal: Vec<[f64; 3]>,
    x: Vec<[f64; 3]>,
    changed: Vec<[f64; 3]>,
}

impl Chunk {
    fn clear(&mut self, k: usize) {
        self.acting.clear();
        self.forces.clear();
        self.tangents.clear();
        self.stages.resize(k, PairStage::default());
        self.passed = None;
    }
}

/// Sets the forces of a pair by the gradient of its energy at points of the step.
fn set_point_forces(
    pair: &Pair,
    points: &FollowerRule,
    candidate: &Candidate,
    configurations: &[Vectors],
    forces: &mut [PairVectors],
    tangents: &mut [PairTangent],
) {
    let k = forces.len();
    for (m, x) in configurations.iter().enumerate() {
        let state = PairState::new(pair.kind, candidate.vectors(x));
        if state.closest.squared_distance >= pair.layer.thickness.powi(2) {
            continue;
        }
        let gradient = pair.gradient(&state);
        let second =
            if tangents.is_empty() { PairTangent::default() } else { pair.second_derivative(&state) };
        for (i, weight) in points.stage_weights(m).iter().enumerate() {
            let sum = forces[i].as_flattened_mut().iter_mut();
            sum.zip(gradient.as_flattened()).for_each(|(sum, f)| *sum += weight * f);
            // None, if they are not wanted.
            for (tangent, integral) in tangents.iter_mut().skip(i * k).zip(points.integrals(m)) {
                let sum = tangent.as_flattened_mut().as_flattened_mut().as_flattened_mut().iter_mut();
                let own = second.as_flattened().as_flattened().as_flattened();
                sum.zip(own).for_each(|(sum, entry)| *sum += weight * integral * entry);
            }
        }
    }
}
