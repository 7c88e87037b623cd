//! The layer between surfaces, and its forces in a step.

use rayon::prelude::*;

use super::candidates::{Candidate, Candidates};
use super::closest::{PairTangent, PairVectors};
use super::layer::Layer;
use super::links::PairState;
use super::obstacle::MAX_STAGES;
use super::pair::Pair;
use super::path::paths_meet;
use super::step::PairStage;
use super::surface::Surface;
use super::tree::Bounds;
use crate::average::{ContactRule, FollowerRule, Rule};

/// Pairs that one thread takes at once: a number that does not depend on the threads.
const CHUNK: usize = 256;

/// A step in which an entity moves farther from the mean motion than this multiple of the extent of all surfaces is one
/// of an iteration that diverges; its list would have all pairs.
const FARTHEST: f64 = 2.0;

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
    /// Derivatives of the stage forces by the rates, `[i k + j]`; empty if they were not wanted.
    pub tangents: &'a [PairTangent],
}

impl SurfaceMemory {
    /// Memory for a rule.
    pub fn new(layer: &SurfaceLayer, rule: &Rule) -> Self {
        let (k, own) = (rule.degree(), ContactRule::new(rule));
        let n_inside = match &own {
            ContactRule::Points(points) => points.n_points(),
            _ => k,
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
    pub(super) fn pair(&self, candidate: &Candidate) -> Pair {
        Pair { kind: candidate.kind, weight: candidate.weight, layer: self.layer.of(candidate.layer) }
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
        candidates.cover(&self.surface, |of| self.layer.of(of).thickness, configurations);
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
        if candidate.is_apart(configurations, pair.layer.thickness) {
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
                pair.forces(rule, &start, &x[..k], &mut chunk.stages, forces, tangents);
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
