//! The layer between surfaces, and its forces in a step.

use rayon::prelude::*;

use super::candidates::{Candidate, Candidates, farthest};
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

/// Points, or pairs of edges, that one thread takes at once: a number that does not depend on the threads.
const CHUNK: usize = 16;

/// Weights that sum up to less, relative to that of one pair, cancel.
const CANCELLED: f64 = 1e-9;

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
    /// Positions of the nodes: at the start, at the end, and at the stages or the points of the rule.
    of_nodes: Vec<Vectors>,
    /// Rates of the nodes, `[k]`.
    rates_of_nodes: Vec<Vectors>,
    /// How far these paths are evaluated.
    evaluated: Evaluated,
    /// The same of the entities in the list.
    configurations: Vec<Vectors>,
    /// Rates of the entities in the list, `[k]`.
    rates: Vec<Vectors>,
    chunks: Vec<Chunk>,
    n_chunks: usize,
    /// Stage forces on the nodes, `[k][node]`.
    forces: Vec<Vectors>,
    of_entities: Vec<[f64; 3]>,
}

/// How far the paths of a memory are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Evaluated {
    Nothing,
    Forces,
    /// Forces and their derivatives.
    Tangents,
}

#[derive(Debug, Clone, Default)]
struct Chunk {
    /// The pairs that act, reduced to closest faces.
    acting: Vec<Candidate>,
    /// The pairs of a point, as a memory.
    of_point: Vec<Candidate>,
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
    /// Derivatives of the stage forces by the rates, `[i k + j]`.
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
            of_nodes: vec![of_nodes.clone(); 2 + n_inside],
            configurations: vec![of_entities.clone(); 2 + n_inside],
            rates: vec![of_entities.clone(); k],
            chunks: Vec::new(),
            n_chunks: 0,
            forces: vec![of_nodes.clone(); k],
            rates_of_nodes: vec![of_nodes; k],
            evaluated: Evaluated::Nothing,
            of_entities,
        }
    }

    /// Stage forces on the nodes as evaluated last, `[k][node]`.
    pub fn forces(&self) -> &[Vectors] {
        &self.forces
    }

    /// The pairs that act, as evaluated last.
    pub fn acting(&self) -> impl Iterator<Item = ActingPair<'_>> {
        let k = self.rates.len();
        self.chunks[..self.n_chunks].iter().flat_map(move |chunk| {
            chunk.acting.iter().enumerate().map(move |(at, pair)| ActingPair {
                pair,
                tangents: &chunk.tangents[at * k * k..(at + 1) * k * k],
            })
        })
    }

    /// Whether some pair acts, as evaluated last.
    pub fn acts(&self) -> bool {
        self.chunks[..self.n_chunks].iter().any(|chunk| !chunk.acting.is_empty())
    }

    /// Sets the paths of the nodes: `position` and `rate`, of a stage, by the number of a node of the surface. Returns
    /// whether they change.
    fn set_paths(
        &mut self,
        position: impl Fn(usize) -> [f64; 3],
        rate: impl Fn(usize, usize) -> [f64; 3],
    ) -> bool {
        let mut changes = false;
        let mut set = |own: &mut [f64; 3], new: [f64; 3]| {
            // A number that is none is new.
            changes |= *own != new;
            *own = new;
        };
        self.of_nodes[0].iter_mut().enumerate().for_each(|(node, own)| set(own, position(node)));
        for (stage, rates) in self.rates_of_nodes.iter_mut().enumerate() {
            rates.iter_mut().enumerate().for_each(|(node, own)| set(own, rate(stage, node)));
        }
        changes
    }

    /// Sets the configurations of the nodes after the start.
    fn set_nodes(&mut self, rule: &Rule) {
        let SurfaceMemory { rule: own, of_nodes, rates_of_nodes, .. } = self;
        let k = rule.degree();
        let (start, others) = of_nodes.split_at_mut(1);
        for (at, x) in others.iter_mut().enumerate() {
            let integrals = match (at.checked_sub(1), &*own) {
                (None, _) => rule.weights(),
                (Some(m), ContactRule::Points(points)) => points.integrals(m),
                (Some(i), _) => &rule.coefficients()[i * k..(i + 1) * k],
            };
            x.copy_from_slice(&start[0]);
            for (rates, integral) in rates_of_nodes.iter().zip(integrals) {
                for (x, rate) in x.iter_mut().zip(rates) {
                    (0..3).for_each(|d| x[d] += integral * rate[d]);
                }
            }
        }
    }

    /// Sets the configurations and the rates of the entities in the list.
    fn set_entities(&mut self, surface: &Surface) {
        let SurfaceMemory { candidates, of_nodes, rates_of_nodes, configurations, rates, .. } = self;
        let nodal = of_nodes.iter().chain(&*rates_of_nodes);
        for (nodal, own) in nodal.zip(configurations.iter_mut().chain(rates)) {
            surface.combine_those(&candidates.entities, nodal, own);
        }
    }
}

impl SurfaceLayer {
    pub(super) fn pair(&self, candidate: &Candidate) -> Pair {
        Pair { kind: candidate.kind, weight: candidate.weight, layer: self.layer.of(candidate.layer) }
    }

    /// Evaluates the stage forces of a step, and with `tangents` their derivatives by the rates, unless the memory has
    /// them. `position` and `rate`, of a stage, by the number of a node of the surface.
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
        if memory.set_paths(position, rate) {
            memory.evaluated = Evaluated::Nothing;
        }
        if memory.evaluated < Evaluated::Forces {
            memory.forces.iter_mut().for_each(|forces| forces.fill([0.0; 3]));
            memory.n_chunks = 0;
            memory.set_nodes(rule);
            self.find(memory)?;
            memory.set_entities(&self.surface);
            self.set_forces(rule, memory)?;
            memory.evaluated = Evaluated::Forces;
        }
        if tangents && memory.evaluated < Evaluated::Tangents {
            self.set_tangents(rule, memory);
            memory.evaluated = Evaluated::Tangents;
        }
        Ok(())
    }

    /// Sets the forces of the pairs, and their sums.
    fn set_forces(&self, rule: &Rule, memory: &mut SurfaceMemory) -> Result<(), [f64; 3]> {
        let SurfaceMemory {
            rule: own, candidates, of_nodes, configurations, rates, chunks, n_chunks, ..
        } = memory;
        let change = candidates.largest_change(&self.surface, of_nodes);
        let n_points = candidates.begin.len() - 1;
        *n_chunks = n_points.div_ceil(CHUNK);
        if chunks.len() < *n_chunks {
            chunks.resize(*n_chunks, Chunk::default());
        }
        for_each_chunk(&mut chunks[..*n_chunks], |number, chunk| {
            chunk.clear(rates.len());
            let first = number * CHUNK;
            for range in candidates.begin[first..=(first + CHUNK).min(n_points)].windows(2) {
                let range = range[0] as usize..range[1] as usize;
                let pairs = (&candidates.pairs[range.clone()], &candidates.distances[range], change);
                self.add_point(pairs, (own, rule, configurations, rates), chunk);
            }
        });
        if let Some(passed) = chunks[..*n_chunks].iter().find_map(|chunk| chunk.passed) {
            return Err(passed);
        }
        self.sum_forces(memory);
        Ok(())
    }

    /// Sets the derivatives of the forces of the pairs that act.
    fn set_tangents(&self, rule: &Rule, memory: &mut SurfaceMemory) {
        let SurfaceMemory { rule: own, configurations, rates, chunks, n_chunks, .. } = memory;
        let k = rates.len();
        for_each_chunk(&mut chunks[..*n_chunks], |_, Chunk { acting, forces, tangents, stages, .. }| {
            tangents.clear();
            tangents.resize(acting.len() * k * k, PairTangent::default());
            let results = forces.chunks_exact_mut(k).zip(tangents.chunks_exact_mut(k * k));
            for (candidate, (forces, tangents)) in acting.iter().zip(results) {
                let paths = (&*own, rule, &configurations[..], &rates[..]);
                self.set_pair(candidate, paths, stages, forces, tangents);
            }
        });
    }

    /// Makes the list of pairs hold for the paths.
    fn find(&self, memory: &mut SurfaceMemory) -> Result<(), [f64; 3]> {
        let SurfaceMemory { candidates, of_nodes, .. } = memory;
        let start = &of_nodes[0];
        let extent = start.iter().fold(Bounds::NONE, |sum, x| sum.with(Bounds::of(*x))).extent();
        let (motion, far) = farthest(start, &of_nodes[1]);
        if motion > FARTHEST * extent {
            return Err(start[far]);
        }
        candidates.cover(&self.surface, |of| self.layer.of(of).thickness, of_nodes);
        Ok(())
    }

    /// Adds the pairs of a point, or one of edges, to their chunk if they act; `pairs`: with their distances when the
    /// list was made, and the largest change of these since.
    fn add_point(
        &self,
        (pairs, distances, change): (&[Candidate], &[f64], f64),
        paths: Paths<'_>,
        chunk: &mut Chunk,
    ) {
        let (own, _, configurations, rates) = paths;
        let Chunk { acting, of_point, forces, stages, passed, .. } = chunk;
        // The configurations in which the forces take the closest points.
        let taken = match own {
            ContactRule::Points(_) => &configurations[2..],
            _ if rates.len() == 1 => &configurations[..2],
            _ => configurations,
        };
        // On straight paths, the others are in between.
        let spanning = if rates.len() == 1 { &configurations[..2] } else { configurations };
        of_point.clear();
        for (candidate, distance) in pairs.iter().zip(distances) {
            let thickness = self.layer.of(candidate.layer).thickness;
            if *distance >= thickness + change || candidate.is_apart(spanning, thickness) {
                continue;
            }
            if candidate.can_meet() {
                let [x_1, x_2] = [0, 1].map(|end| candidate.vectors(&configurations[end]));
                if paths_meet(candidate.kind, &x_1, &x_2) {
                    *passed = passed.or(Some(x_1[0]));
                    return;
                }
            }
            let Some(reduced) = candidate.reduced(taken, thickness) else { continue };
            let place = |own: &&mut Candidate| (own.kind, own.entities) == (reduced.kind, reduced.entities);
            match of_point.iter_mut().find(place) {
                Some(own) => own.weight += reduced.weight,
                None => of_point.push(reduced),
            }
        }
        // The first one is a whole one.
        let least = pairs.first().map_or(0.0, |first| CANCELLED * first.weight.abs());
        for candidate in of_point.iter().filter(|candidate| candidate.weight.abs() > least) {
            let at = forces.len();
            forces.resize(at + rates.len(), PairVectors::default());
            self.set_pair(candidate, paths, stages, &mut forces[at..], &mut []);
            if forces[at..].iter().flatten().flatten().any(|f| *f != 0.0) {
                acting.push(*candidate);
            } else {
                forces.truncate(at);
            }
        }
    }

    /// Sets the forces of a pair, and their derivatives unless `tangents` is empty.
    fn set_pair(
        &self,
        candidate: &Candidate,
        (own, rule, configurations, rates): Paths<'_>,
        stages: &mut [PairStage],
        forces: &mut [PairVectors],
        tangents: &mut [PairTangent],
    ) {
        let pair = self.pair(candidate);
        if let ContactRule::Points(points) = own {
            return set_point_forces(&pair, points, candidate, &configurations[2..], forces, tangents);
        }
        let mut x = [PairVectors::default(); MAX_STAGES];
        x.iter_mut().zip(rates).for_each(|(own, rates)| *own = candidate.vectors(rates));
        let start = PairState::new(pair.kind, candidate.vectors(&configurations[0]));
        pair.forces(rule, &start, &x[..rates.len()], stages, forces, tangents);
    }

    /// Sums the forces of all pairs, in their order.
    fn sum_forces(&self, memory: &mut SurfaceMemory) {
        let SurfaceMemory { candidates, chunks, n_chunks, forces, of_entities, rates, .. } = memory;
        let k = rates.len();
        for (stage, nodal) in forces.iter_mut().enumerate() {
            candidates.entities.iter().for_each(|entity| of_entities[*entity as usize] = [0.0; 3]);
            for chunk in &chunks[..*n_chunks] {
                for (candidate, forces) in chunk.acting.iter().zip(chunk.forces.chunks_exact(k)) {
                    let entities = &candidate.entities[..candidate.kind.n_entities()];
                    for (entity, force) in entities.iter().zip(&forces[stage]) {
                        let sum = &mut of_entities[*entity as usize];
                        (0..3).for_each(|d| sum[d] += force[d]);
                    }
                }
            }
            self.surface.spread(&candidates.entities, of_entities, nodal);
        }
    }
}

/// Rules, configurations and rates of a memory.
type Paths<'a> = (&'a ContactRule, &'a Rule, &'a [Vectors], &'a [Vectors]);

fn for_each_chunk(chunks: &mut [Chunk], work: impl Fn(usize, &mut Chunk) + Send + Sync) {
    let work = |(number, chunk): (usize, &mut Chunk)| work(number, chunk);
    if chunks.len() < 2 {
        chunks.iter_mut().enumerate().for_each(work);
    } else {
        chunks.par_iter_mut().enumerate().for_each(work);
    }
}

impl Chunk {
    fn clear(&mut self, k: usize) {
        self.acting.clear();
        self.forces.clear();
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
    forces.fill(PairVectors::default());
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
