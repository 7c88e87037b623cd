//! The pairs that can touch on given paths.

use super::closest::{Closest, PairKind};
use super::layer::LayerOf;
use super::surface::Surface;
use super::tree::{Bounds, BoxTree};

/// A pair of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Kind.
    pub kind: PairKind,
    /// Its entities; those beyond its kind repeat the last.
    pub entities: [u32; 4],
    /// Weight, with the factor of inclusion and exclusion \[length^2\].
    pub weight: f64,
    /// Its layer.
    pub layer: LayerOf,
}

impl Candidate {
    fn new(kind: PairKind, entities: &[u32], weight: f64, layer: LayerOf) -> Self {
        let last = entities.last().copied().unwrap_or_default();
        let entities = std::array::from_fn(|a| entities.get(a).copied().unwrap_or(last));
        Candidate { kind, entities, weight, layer }
    }

    /// Whether its sides can pass each other on their paths.
    #[inline]
    pub(super) fn can_meet(&self) -> bool {
        matches!(self.kind, PairKind::PointTriangle | PairKind::EdgeEdge)
    }

    /// The vectors of its entities.
    #[inline]
    pub(super) fn vectors(&self, of_entities: &[[f64; 3]]) -> [[f64; 3]; 4] {
        self.entities.map(|entity| of_entities[entity as usize])
    }

    /// The pair of the point and the closest face alone, if that is one and the same in some configurations, else the
    /// pair itself; `None` where it is farther than a distance in all.
    ///
    /// A point has such a pair in common with all triangles and edges around the face, and their weights mostly cancel.
    pub(super) fn reduced<X: AsRef<[[f64; 3]]>>(&self, configurations: &[X], distance: f64) -> Option<Self> {
        let (mut is_near, mut common) = (false, None);
        let mut is_one = self.kind != PairKind::EdgeEdge;
        for x in configurations {
            let closest = Closest::new(self.kind, &self.vectors(x.as_ref()));
            is_near |= closest.squared_distance < distance * distance;
            let face = closest.weights.map(|weight| weight != 0.0);
            is_one &= *common.get_or_insert(face) == face;
        }
        let face = common.filter(|_| is_near)?;
        let n = (1..4).filter(|a| face[*a]).count();
        let kind = [PairKind::PointVertex, PairKind::PointEdge, PairKind::PointTriangle][n.clamp(1, 3) - 1];
        if !is_one || kind == self.kind {
            return Some(*self);
        }
        let mut entities = [self.entities[0]; 4];
        (1..4).filter(|a| face[*a]).zip(1..).for_each(|(from, to)| entities[to] = self.entities[from]);
        entities[1..=n].sort_unstable();
        Some(Candidate::new(kind, &entities[..=n], self.weight, self.layer))
    }

    /// Whether its sides stay farther apart than a distance in all of some configurations, by their boxes.
    #[inline]
    pub(super) fn is_apart<X: AsRef<[[f64; 3]]>>(&self, configurations: &[X], distance: f64) -> bool {
        let mut sides = [Bounds::NONE; 2];
        for x in configurations {
            for (a, entity) in self.entities[..self.kind.n_entities()].iter().enumerate() {
                let side = &mut sides[usize::from(!self.kind.is_first_side(a))];
                *side = side.with(Bounds::of(x.as_ref()[*entity as usize]));
            }
        }
        !sides[0].inflated(distance).meets(&sides[1])
    }
}

/// The pairs of a surface that can come nearer than a reach, in an order that does not depend on the motion.
///
/// A list holds as long as every node stays in its box, which has a margin. Pairs that are not in it are out of reach,
/// so no result depends on when the list was made.
#[derive(Debug, Clone, Default)]
pub struct Candidates {
    /// The pairs.
    pub pairs: Vec<Candidate>,
    /// Distance of each pair when the list was made.
    pub distances: Vec<f64>,
    /// Where the pairs of each point begin, and each pair of edges, and the end of all.
    pub begin: Vec<u32>,
    /// The entities of the pairs, ascending.
    pub entities: Vec<u32>,
    /// Positions of the nodes when the list was made, and of its entities.
    made_at: Vec<[f64; 3]>,
    x: Vec<[f64; 3]>,
    /// Boxes of the nodes; none before the first list.
    boxes_of_nodes: Vec<Bounds>,
    /// Boxes of the entities.
    boxes: Vec<Bounds>,
    boxes_of_triangles: Vec<Bounds>,
    boxes_of_edges: Vec<Bounds>,
    bodies: BodyTrees,
    /// Memory for what is near a point.
    near: [Vec<u32>; 3],
}

/// The trees of all bodies, and the bodies near each: a point looks for its opponents there alone.
#[derive(Debug, Clone, Default)]
struct BodyTrees {
    of_bodies: Vec<BodyTree>,
    tree: BoxTree,
    boxes: Vec<Bounds>,
}

/// The trees of a body.
#[derive(Debug, Clone, Default)]
struct BodyTree {
    triangles: BoxTree,
    edges: BoxTree,
    /// Bodies nearer than the reach.
    near: Vec<u32>,
}

impl BodyTrees {
    /// Sets the boxes of the triangles and edges.
    fn set(&mut self, surface: &Surface, triangles: &[Bounds], edges: &[Bounds], reach: f64) {
        let BodyTrees { of_bodies, tree, boxes } = self;
        of_bodies.resize(surface.bodies.len(), BodyTree::default());
        for (own, body) in of_bodies.iter_mut().zip(&surface.bodies) {
            own.triangles.fit(triangles, body.triangles.iter().copied());
            own.edges.fit(edges, body.edges.iter().copied());
        }
        boxes.clear();
        boxes.extend(of_bodies.iter().map(|own| own.triangles.bounds()));
        tree.fit(boxes, 0..boxes.len() as u32);
        for ((own, body), bounds) in of_bodies.iter_mut().zip(0..).zip(&*boxes) {
            own.near.clear();
            tree.for_each_meeting(boxes, &bounds.inflated(reach), &mut |other| {
                if other != body {
                    own.near.push(other);
                }
            });
        }
    }

    /// The trees of the bodies near a body.
    fn near(&self, body: u32) -> impl Iterator<Item = &BodyTree> {
        self.of_bodies[body as usize].near.iter().map(|other| &self.of_bodies[*other as usize])
    }
}

/// Margin over the reach of the points.
const MARGIN: f64 = 1.0;

/// Multiple of a step that the boxes cover ahead of its start.
const AHEAD: f64 = 2.0;

impl Candidates {
    /// Makes the list hold for paths through some configurations of the nodes, `[configuration][node]`: the start of a
    /// step, its end, and others. `reach`: the distance of interest for each layer. Returns whether the list is a new
    /// one.
    pub fn cover<X: AsRef<[[f64; 3]]>>(
        &mut self,
        surface: &Surface,
        reach: impl Fn(LayerOf) -> f64,
        configurations: &[X],
    ) -> bool {
        let boxes = &self.boxes_of_nodes;
        let holds = boxes.len() == surface.nodes.len()
            && configurations
                .iter()
                .all(|x| boxes.iter().zip(x.as_ref()).all(|(own, x)| own.contains(&Bounds::of(*x))));
        if !holds {
            self.set_boxes(surface, MARGIN * reach(LayerOf::Points), configurations);
            self.find(surface, reach);
            self.entities.clear();
            self.entities.extend(self.pairs.iter().flat_map(|pair| pair.entities));
            self.entities.sort_unstable();
            self.entities.dedup();
            self.set_distances(surface, configurations.first().map_or(&[], |x| x.as_ref()));
        }
        !holds
    }

    /// Sets the distances of the pairs at some positions of the nodes.
    fn set_distances(&mut self, surface: &Surface, made_at: &[[f64; 3]]) {
        let Candidates { pairs, distances, entities, x, .. } = self;
        x.resize(surface.n_entities(), [0.0; 3]);
        surface.combine_those(entities, made_at, x);
        distances.clear();
        let closest = |pair: &Candidate| Closest::new(pair.kind, &pair.vectors(x));
        distances.extend(pairs.iter().map(|pair| closest(pair).squared_distance.sqrt()));
        self.made_at.clear();
        self.made_at.extend_from_slice(made_at);
    }

    /// Bound on the change of every distance since the list was made, on straight paths between configurations of the
    /// nodes.
    pub fn largest_change<X: AsRef<[[f64; 3]]>>(&self, surface: &Surface, configurations: &[X]) -> f64 {
        let motions = configurations.iter().map(|x| farthest(&self.made_at, x.as_ref()).0);
        // Both sides move.
        2.0 * surface.amplification * motions.fold(0.0, f64::max)
    }

    fn set_boxes<X: AsRef<[[f64; 3]]>>(&mut self, surface: &Surface, margin: f64, configurations: &[X]) {
        self.boxes_of_nodes.clear();
        self.boxes_of_nodes.extend((0..surface.nodes.len()).map(|node| {
            let at = |x: &X| x.as_ref()[node];
            let path = configurations.iter().fold(Bounds::NONE, |sum, x| sum.with(Bounds::of(at(x))));
            let ahead = match configurations {
                [start, end, ..] => {
                    let (start, end) = (at(start), at(end));
                    Bounds::of([0, 1, 2].map(|d| start[d] + AHEAD * (end[d] - start[d])))
                }
                _ => Bounds::NONE,
            };
            path.with(ahead).inflated(0.5 * margin)
        }));
        let of_nodes = &self.boxes_of_nodes;
        self.boxes.clear();
        self.boxes.extend((0..surface.n_entities() as u32).map(|entity| {
            let terms = surface.entity(entity).map(|(node, share)| of_nodes[node].scaled(share));
            terms.fold(Bounds::of([0.0; 3]), Bounds::sum)
        }));
    }

    fn find(&mut self, surface: &Surface, reach: impl Fn(LayerOf) -> f64) {
        let Candidates { pairs, begin, boxes, boxes_of_triangles, boxes_of_edges, bodies, near, .. } = self;
        let hull = |entities: &[u32]| {
            entities.iter().fold(Bounds::NONE, |sum, entity| sum.with(boxes[*entity as usize]))
        };
        boxes_of_triangles.clear();
        boxes_of_triangles.extend(surface.triangles.iter().map(|triangle| hull(&triangle.corners)));
        boxes_of_edges.clear();
        boxes_of_edges.extend(surface.edges.iter().map(|edge| hull(&edge.ends)));
        pairs.clear();
        begin.clear();
        let body_of = |entity: u32| surface.body_of[entity as usize];
        let layers = [LayerOf::Points, LayerOf::Guards, LayerOf::BluntEdges];
        let farthest = layers.into_iter().map(&reach).fold(0.0, f64::max);
        bodies.set(surface, boxes_of_triangles, boxes_of_edges, farthest);
        let [faces, edges, vertices] = near;
        for point in &surface.points {
            let layer = if point.is_guard { LayerOf::Guards } else { LayerOf::Points };
            let query = boxes[point.entity as usize].inflated(reach(layer));
            [&mut *faces, &mut *edges, &mut *vertices].into_iter().for_each(Vec::clear);
            for other in bodies.near(body_of(point.entity)) {
                other.triangles.for_each_meeting(boxes_of_triangles, &query, &mut |number| {
                    let triangle = &surface.triangles[number as usize];
                    faces.push(number);
                    edges.extend(triangle.edges);
                    vertices.extend(triangle.corners.map(|corner| surface.vertex_of[corner as usize]));
                });
            }
            if faces.is_empty() {
                continue;
            }
            begin.push(pairs.len() as u32);
            for list in [&mut *faces, &mut *edges, &mut *vertices] {
                list.sort_unstable();
                list.dedup();
            }
            let mut add = |kind, entities: &[u32], factor: f64| {
                if factor != 0.0 && hull(&entities[1..]).meets(&query) {
                    pairs.push(Candidate::new(kind, entities, 0.5 * factor * point.area, layer));
                }
            };
            for face in &*faces {
                let [a, b, c] = surface.triangles[*face as usize].corners;
                add(PairKind::PointTriangle, &[point.entity, a, b, c], 1.0);
            }
            for edge in &*edges {
                let edge = &surface.edges[*edge as usize];
                add(PairKind::PointEdge, &[point.entity, edge.ends[0], edge.ends[1]], edge.factor);
            }
            for vertex in &*vertices {
                let (entity, factor) = surface.vertices[*vertex as usize];
                add(PairKind::PointVertex, &[point.entity, entity], factor);
            }
        }
        for (number, edge) in (0..).zip(&surface.edges) {
            let farthest = reach(if edge.is_sharp { LayerOf::Guards } else { LayerOf::BluntEdges });
            let query = boxes_of_edges[number as usize].inflated(farthest);
            faces.clear();
            for other in bodies.near(body_of(edge.ends[0])) {
                other.edges.for_each_meeting(boxes_of_edges, &query, &mut |other| {
                    if other > number {
                        faces.push(other);
                    }
                });
            }
            faces.sort_unstable();
            for other in &*faces {
                let other = &surface.edges[*other as usize];
                let are_sharp = edge.is_sharp && other.is_sharp;
                let layer = if are_sharp { LayerOf::Guards } else { LayerOf::BluntEdges };
                let entities = [edge.ends[0], edge.ends[1], other.ends[0], other.ends[1]];
                begin.push(pairs.len() as u32);
                pairs.push(Candidate::new(PairKind::EdgeEdge, &entities, edge.area.min(other.area), layer));
            }
        }
        begin.push(pairs.len() as u32);
    }
}

/// Largest distance of a node between two configurations, beside the mean motion, and its number. A coordinate that is
/// no number is infinitely far.
pub(super) fn farthest(from: &[[f64; 3]], to: &[[f64; 3]]) -> (f64, usize) {
    let moved = || from.iter().zip(to).map(|(x, y)| [0, 1, 2].map(|d| y[d] - x[d]));
    let sum = moved().fold([0.0; 3], |sum, u| [0, 1, 2].map(|d| sum[d] + u[d]));
    let mean = sum.map(|sum| sum / from.len() as f64);
    let square = |u: [f64; 3]| (0..3).map(|d| (u[d] - mean[d]).powi(2)).sum::<f64>();
    let (mut most, mut far) = (0.0, 0);
    for (node, square) in moved().map(square).enumerate() {
        if square > most || square.is_nan() {
            (most, far) = (if square.is_nan() { f64::INFINITY } else { square }, node);
        }
    }
    (most.sqrt(), far)
}

#[cfg(test)]
mod tests {
    #![allow(non_snake_case)]

    use super::super::tests::Random;
    use super::super::{Closest, SurfaceFacet};
    use super::*;
    use crate::mesh::FacetKind;

    /// Two squares of one facet on top of each other, at random places, with nodes in the middle of their edges if they
    /// are quadratic.
    fn surface(is_quadratic: bool) -> Surface {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let middles = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];
        let n = if is_quadratic { 8 } else { 4 };
        let kind = if is_quadratic { FacetKind::Quad8 } else { FacetKind::Quad4 };
        let at = |z: f64| -> Vec<[f64; 3]> {
            corners.iter().chain(&middles).map(|[x, y]| [*x, *y, z]).take(n).collect()
        };
        let (lower, upper, nodes) = (at(0.0), at(0.14), Vec::from_iter(0..2 * n as u32));
        // In the middle.
        let shapes = if is_quadratic { [[-0.25; 4], [0.5; 4]].concat() } else { vec![0.25; 4] };
        let facet = |nodes, positions, body| SurfaceFacet {
            kind,
            nodes,
            positions,
            shapes: &shapes,
            areas: &[1.0],
            body,
        };
        Surface::new(&[facet(&nodes[..n], &lower, 0), facet(&nodes[n..], &upper, 1)])
    }

    /// On random paths, the list has every pair whose distance is at some time below that of its layer, in one order; a
    /// list that holds is kept, and no distance changes by more than its bound.
    #[test]
    fn lists_have_all_pairs_that_come_near() {
        const THICKNESS: f64 = 0.15;
        for is_quadratic in [false, true] {
            let surface = surface(is_quadratic);
            assert_eq!(surface.amplification, if is_quadratic { 3.0 } else { 1.0 });
            let mut random = Random(11);
            let mut all = Candidates::default();
            // A list of everything.
            all.cover(&surface, |_| 1e3, &[&surface.positions]);
            let n_points = surface.points.len();
            assert!(all.pairs.len() > 8 * n_points);
            let mut list = Candidates::default();
            let reach = |layer: LayerOf| layer.part() * THICKNESS;
            let (mut n_new, mut n_near) = (0, 0);
            for _ in 0..200 {
                let moved = |random: &mut Random, size: f64| -> Vec<[f64; 3]> {
                    (surface.positions.iter()).map(|X| X.map(|x| x + size * random.number())).collect()
                };
                let nodal = [moved(&mut random, 0.02), moved(&mut random, 0.05)];
                n_new += usize::from(list.cover(&surface, reach, &nodal));
                assert!(!list.cover(&surface, reach, &nodal));
                let largest_change = list.largest_change(&surface, &nodal);
                let configurations = nodal.map(|nodal| {
                    let mut x = vec![[0.0; 3]; surface.n_entities()];
                    surface.combine(&nodal, &mut x);
                    x
                });
                let distance = |pair: &Candidate, x: &Vec<[f64; 3]>| {
                    Closest::new(pair.kind, &pair.vectors(x)).squared_distance.sqrt()
                };
                let mut expected = all
                    .pairs
                    .iter()
                    .filter(|pair| configurations.iter().any(|x| distance(pair, x) < reach(pair.layer)));
                // Both lists have one order.
                let mut own = list.pairs.iter();
                assert!(expected.all(|pair| {
                    n_near += 1;
                    own.any(|own| own == pair)
                }));
                for (pair, before) in list.pairs.iter().zip(&list.distances) {
                    assert!(pair.entities.iter().all(|entity| list.entities.contains(entity)));
                    let change = |x| (distance(pair, x) - before).abs();
                    assert!(configurations.iter().all(|x| change(x) <= largest_change + 1e-15));
                }
            }
            assert!(n_new < 200 && n_near > 500, "{n_new} {n_near}");
        }
    }
}
