//! Surfaces: contact points, guards, and the triangles that are their opponents.

#![allow(non_snake_case)]

use std::collections::BTreeMap;

use super::closest::minus;
use crate::element::facet_element;
use crate::mesh::FacetKind;
use crate::tensor::{cross, dot3};

/// Edges whose triangles have normals farther apart are sharp: the cosine of 30 degrees.
const SHARP: f64 = 0.866_025_403_784_438_6;

/// A facet of a surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceFacet<'a> {
    /// Kind, one with an area.
    pub kind: FacetKind,
    /// Nodes.
    pub nodes: &'a [u32],
    /// Reference positions of the nodes, `[n_nodes]`.
    pub positions: &'a [[f64; 3]],
    /// Shape functions at the quadrature points, `[point][n_nodes]`.
    pub shapes: &'a [f64],
    /// Reference areas of the quadrature points, `[point]` \[length^2\].
    pub areas: &'a [f64],
    /// Number of the body to which the facet belongs: facets of one body are not in contact with each other.
    pub body: u32,
}

/// A point of a surface, or a guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Entity.
    pub entity: u32,
    /// Reference area \[length^2\].
    pub area: f64,
    /// Whether it is a guard, at a node.
    pub is_guard: bool,
}

/// A triangle of a surface, outward normal by the right-hand rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceTriangle {
    /// Entities at its corners.
    pub corners: [u32; 3],
    /// Its edges.
    pub edges: [u32; 3],
}

/// An edge of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceEdge {
    /// Entities at its ends, ascending.
    pub ends: [u32; 2],
    /// Factor as an opponent.
    pub factor: f64,
    /// A third of the reference areas of its triangles \[length^2\].
    pub area: f64,
    /// Whether its triangles have normals more than 30 degrees apart, or it is a border.
    pub is_sharp: bool,
}

/// The triangles and edges of a body, by their numbers.
#[derive(Debug, Clone, Default)]
pub struct SurfaceBody {
    /// Triangles, ascending.
    pub triangles: Vec<u32>,
    /// Edges, ascending.
    pub edges: Vec<u32>,
}

/// Facets of one or several bodies as points and triangles.
///
/// Everything consists of *entities*, fixed combinations of nodes. The points are the quadrature points of the facets,
/// and the nodes as guards. The opponents are triangles: of a quadrilateral four about its middle; a quadratic facet is
/// divided through its edge middles and its centre before. Inclusion and exclusion count one opponent wherever a point
/// is: with `n_T` incident triangles, a triangle has the factor 1, an edge `1 - n_T(e)` and a vertex
///
/// ```math
/// 1 - n_T(v) + sum_e (n_T(e) - 1)   over its edges e
/// ```
///
/// so that the sum over all opponents is continuous with its derivative.
///
/// ```
/// use emmy::internals::contact::{Surface, SurfaceFacet};
/// use emmy::mesh::FacetKind;
/// let square = SurfaceFacet {
///     kind: FacetKind::Quad4,
///     nodes: &[0, 1, 2, 3],
///     positions: &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
///     shapes: &[0.25; 4],
///     areas: &[1.0],
///     body: 0,
/// };
/// let surface = Surface::new(&[square]);
/// assert_eq!((surface.triangles.len(), surface.edges.len(), surface.n_sharp_edges()), (4, 8, 4));
/// assert_eq!((surface.points.len(), surface.entity(surface.points[4].entity).count()), (5, 4));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// Where the terms of each entity begin, and the end of all.
    begin: Vec<u32>,
    /// Nodes of the entities, as numbers of [`Surface::nodes`], with their shares.
    terms: Vec<(u32, f64)>,
    /// Largest length of the vector of an entity over that of the nodes: 1 unless shares are negative.
    pub amplification: f64,
    /// Body of each entity.
    pub body_of: Vec<u32>,
    /// Nodes of the mesh, ascending.
    pub nodes: Vec<u32>,
    /// Reference positions of the nodes.
    pub positions: Vec<[f64; 3]>,
    /// Guards, in the order of the nodes, then the points, facet by facet.
    pub points: Vec<SurfacePoint>,
    /// Where the points of each facet begin, and the end of all.
    pub facets: Vec<usize>,
    /// Triangles.
    pub triangles: Vec<SurfaceTriangle>,
    /// Edges.
    pub edges: Vec<SurfaceEdge>,
    /// Bodies with triangles.
    pub bodies: Vec<SurfaceBody>,
    /// Vertices of triangles with their factors as opponents.
    pub vertices: Vec<(u32, f64)>,
    /// The number of each entity among the vertices, if it is one.
    pub vertex_of: Vec<u32>,
}

impl Surface {
    /// The surface of some facets.
    pub fn new(facets: &[SurfaceFacet<'_>]) -> Surface {
        let mut surface = Surface::without_triangles(facets);
        facets.iter().for_each(|facet| surface.add_triangles(facet));
        surface.connect();
        surface
    }

    /// The points and guards of some facets, which are no opponents.
    pub fn without_triangles(facets: &[SurfaceFacet<'_>]) -> Surface {
        let mut surface = Surface { begin: vec![0], ..Surface::default() };
        surface.add_guards(facets);
        for facet in facets {
            surface.facets.push(surface.points.len());
            surface.add_points(facet);
        }
        surface.facets.push(surface.points.len());
        surface
    }

    /// Number of sharp edges.
    pub fn n_sharp_edges(&self) -> usize {
        self.edges.iter().filter(|edge| edge.is_sharp).count()
    }

    /// Number of entities.
    pub fn n_entities(&self) -> usize {
        self.body_of.len()
    }

    /// The nodes of an entity, as numbers of [`Surface::nodes`], with their shares.
    #[inline]
    pub fn entity(&self, entity: u32) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.begin[entity as usize] as usize..self.begin[entity as usize + 1] as usize;
        self.terms[range].iter().map(|&(node, share)| (node as usize, share))
    }

    /// Sets the vectors of all entities from those of the nodes, `[n_nodes]`.
    pub fn combine(&self, nodal: &[[f64; 3]], vectors: &mut [[f64; 3]]) {
        (0..).zip(vectors).for_each(|(entity, vector)| *vector = self.combined(entity, |node| nodal[node]));
    }

    /// Sets the vectors of some entities from those of the nodes, `[n_nodes]`.
    pub fn combine_those(&self, entities: &[u32], nodal: &[[f64; 3]], vectors: &mut [[f64; 3]]) {
        for &entity in entities {
            vectors[entity as usize] = self.combined(entity, |node| nodal[node]);
        }
    }

    /// The vector of an entity from those of the nodes, by their numbers.
    #[inline]
    pub fn combined(&self, entity: u32, nodal: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        let mut vector = [0.0; 3];
        for (node, share) in self.entity(entity) {
            let own = nodal(node);
            (0..3).for_each(|d| vector[d] += share * own[d]);
        }
        vector
    }

    /// Adds forces on some entities to those on the nodes; `forces`: of all entities.
    pub fn spread(&self, entities: &[u32], forces: &[[f64; 3]], nodal: &mut [[f64; 3]]) {
        for &entity in entities {
            let force = forces[entity as usize];
            for (node, share) in self.entity(entity) {
                (0..3).for_each(|d| nodal[node][d] += share * force[d]);
            }
        }
    }

    /// The pressure at each node, and the reference area around it \[length^2\], from the pressures on points and
    /// guards: the normal force on the node over the area around it on facets that are pressed.
    pub fn pressures_at_nodes(&self, pressure: impl Fn(&SurfacePoint) -> f64) -> Vec<[f64; 2]> {
        // Force, area, and the area of facets that are pressed, of each node.
        let mut sums = vec![[0.0; 3]; self.nodes.len()];
        for range in self.facets.windows(2) {
            let points = &self.points[range[0]..range[1]];
            let is_pressed = points.iter().any(|point| pressure(point) > 0.0);
            for point in points {
                for (node, share) in self.entity(point.entity) {
                    // Shares of nodes of quadratic facets have a mean of zero, or less than that.
                    let area = share.abs() * point.area;
                    sums[node][0] += area * pressure(point);
                    sums[node][1] += area;
                    sums[node][2] += if is_pressed { area } else { 0.0 };
                }
            }
        }
        let of_node = |(guard, [force, area, pressed]): (&SurfacePoint, [f64; 3])| {
            let around = if pressed > 0.0 { pressed } else { area };
            [(force + guard.area * pressure(guard)) / around, area]
        };
        self.points.iter().zip(sums).map(of_node).collect()
    }

    fn add_entity(&mut self, body: u32, terms: impl Iterator<Item = (u32, f64)>) -> u32 {
        let first = self.terms.len();
        self.terms.extend(terms.filter(|(_, share)| *share != 0.0));
        let sum: f64 = self.terms[first..].iter().map(|(_, share)| share.abs()).sum();
        self.amplification = self.amplification.max(sum);
        self.begin.push(self.terms.len() as u32);
        self.body_of.push(body);
        self.body_of.len() as u32 - 1
    }

    /// Adds the nodes, which are entities with the same numbers, and guards there: each facet gives its area in equal
    /// parts.
    fn add_guards(&mut self, facets: &[SurfaceFacet<'_>]) {
        let mut nodes: BTreeMap<u32, ([f64; 3], f64, u32)> = BTreeMap::new();
        for facet in facets {
            let part = facet.areas.iter().sum::<f64>() / facet.nodes.len() as f64;
            for (node, X) in facet.nodes.iter().zip(facet.positions) {
                nodes.entry(*node).or_insert((*X, 0.0, facet.body)).1 += part;
            }
        }
        for (number, (node, (X, area, body))) in (0..).zip(nodes) {
            self.nodes.push(node);
            self.positions.push(X);
            let entity = self.add_entity(body, std::iter::once((number, 1.0)));
            self.points.push(SurfacePoint { entity, area, is_guard: true });
        }
    }

    fn number_of(&self, node: u32) -> u32 {
        self.nodes.binary_search(&node).map_or(0, |number| number as u32)
    }

    fn add_points(&mut self, facet: &SurfaceFacet<'_>) {
        let numbers: Vec<u32> = facet.nodes.iter().map(|node| self.number_of(*node)).collect();
        for (shapes, &area) in facet.shapes.chunks_exact(facet.nodes.len()).zip(facet.areas) {
            let terms = numbers.iter().copied().zip(shapes.iter().copied());
            let entity = self.add_entity(facet.body, terms);
            self.points.push(SurfacePoint { entity, area, is_guard: false });
        }
    }

    fn add_triangles(&mut self, facet: &SurfaceFacet<'_>) {
        let numbers: Vec<u32> = facet.nodes.iter().map(|node| self.number_of(*node)).collect();
        let mut shapes = vec![0.0; numbers.len()];
        let mut at = |surface: &mut Surface, xi: [f64; 2]| {
            facet_element(facet.kind).shape(xi, &mut shapes);
            let rounding = |share: f64| if share.abs() < 1e-14 { 0.0 } else { share };
            let terms = numbers.iter().copied().zip(shapes.iter().copied().map(rounding));
            surface.add_entity(facet.body, terms)
        };
        let mut about_middle = |surface: &mut Surface, around: &[u32], xi: [f64; 2]| {
            let middle = at(surface, xi);
            for (i, &a) in around.iter().enumerate() {
                let corners = [a, around[(i + 1) % around.len()], middle];
                surface.triangles.push(SurfaceTriangle { corners, edges: [0; 3] });
            }
            middle
        };
        let n = |local: usize| numbers[local];
        match facet.kind {
            FacetKind::Line2 | FacetKind::Line3 => {}
            FacetKind::Tri3 => {
                self.triangles.push(SurfaceTriangle { corners: [n(0), n(1), n(2)], edges: [0; 3] });
            }
            FacetKind::Quad4 => {
                about_middle(self, &numbers, [0.0; 2]);
            }
            FacetKind::Tri6 => {
                let third = 1.0 / 6.0;
                about_middle(self, &[n(0), n(3), n(5)], [third, third]);
                about_middle(self, &[n(3), n(1), n(4)], [4.0 * third, third]);
                about_middle(self, &[n(5), n(4), n(2)], [third, 4.0 * third]);
                about_middle(self, &[n(3), n(4), n(5)], [2.0 * third, 2.0 * third]);
            }
            FacetKind::Quad8 | FacetKind::Quad9 => {
                let centre = match facet.kind {
                    FacetKind::Quad9 => n(8),
                    _ => {
                        let mut shapes = vec![0.0; numbers.len()];
                        facet_element(facet.kind).shape([0.0; 2], &mut shapes);
                        self.add_entity(facet.body, numbers.iter().copied().zip(shapes))
                    }
                };
                about_middle(self, &[n(0), n(4), centre, n(7)], [-0.5, -0.5]);
                about_middle(self, &[n(4), n(1), n(5), centre], [0.5, -0.5]);
                about_middle(self, &[centre, n(5), n(2), n(6)], [0.5, 0.5]);
                about_middle(self, &[n(7), centre, n(6), n(3)], [-0.5, 0.5]);
            }
        }
    }

    /// Finds edges and vertices with their factors.
    fn connect(&mut self) {
        let mut X = vec![[0.0; 3]; self.n_entities()];
        self.combine(&self.positions, &mut X);
        let normals: Vec<[f64; 3]> = (self.triangles.iter())
            .map(|triangle| {
                let [a, b, c] = triangle.corners.map(|corner| X[corner as usize]);
                cross(minus(b, a), minus(c, a))
            })
            .collect();
        let mut incident: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (number, triangle) in (0..).zip(&self.triangles) {
            for i in 0..3 {
                incident.entry(ends(triangle.corners, i)).or_default().push(number);
            }
        }
        let mut factors: BTreeMap<u32, f64> = BTreeMap::new();
        for corner in self.triangles.iter().flat_map(|triangle| triangle.corners) {
            *factors.entry(corner).or_insert(1.0) -= 1.0;
        }
        for (number, (ends_of, triangles)) in (0..).zip(&incident) {
            let excess = triangles.len() as f64 - 1.0;
            ends_of.iter().for_each(|end| *factors.entry(*end).or_insert(1.0) += excess);
            for &triangle in triangles {
                let own = &mut self.triangles[triangle as usize];
                let place = (0..3).find(|&i| ends(own.corners, i) == *ends_of);
                own.edges[place.unwrap_or(0)] = number;
            }
            let area = triangles.iter().map(|&triangle| norm(normals[triangle as usize]) / 6.0).sum();
            let is_sharp = match triangles[..] {
                [a, b] => {
                    let [a, b] = [a, b].map(|triangle| normals[triangle as usize]);
                    dot3(a, b) < SHARP * norm(a) * norm(b)
                }
                _ => true,
            };
            self.edges.push(SurfaceEdge { ends: *ends_of, factor: -excess, area, is_sharp });
        }
        self.vertex_of = vec![0; self.n_entities()];
        for (number, vertex) in (0..).zip(factors.keys()) {
            self.vertex_of[*vertex as usize] = number;
        }
        self.vertices = factors.into_iter().collect();
        let n_bodies = self.body_of.iter().max().map_or(0, |body| *body as usize + 1);
        self.bodies.resize(n_bodies, SurfaceBody::default());
        for (number, triangle) in (0..).zip(&self.triangles) {
            self.bodies[self.body_of[triangle.corners[0] as usize] as usize].triangles.push(number);
        }
        for (number, edge) in (0..).zip(&self.edges) {
            self.bodies[self.body_of[edge.ends[0] as usize] as usize].edges.push(number);
        }
    }
}

/// Ends of the edge that begins at a corner of a triangle, ascending.
fn ends(corners: [u32; 3], i: usize) -> [u32; 2] {
    let (a, b) = (corners[i], corners[(i + 1) % 3]);
    [a.min(b), a.max(b)]
}

fn norm(v: [f64; 3]) -> f64 {
    dot3(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::super::{Layer, LayerLaw, Pair, PairKind, PairState};
    use super::*;

    /// A square of n x n cells of a kind in the plane z = 0, with its middle as the only quadrature point of each.
    fn square(kind: FacetKind, n: u32) -> Surface {
        let nodes_of = facet_element(kind).nodes();
        let is_triangle = matches!(kind, FacetKind::Tri3 | FacetKind::Tri6);
        let mut known: BTreeMap<[i64; 2], u32> = BTreeMap::new();
        let (mut nodes, mut positions) = (Vec::new(), Vec::new());
        for cell in (0..n * n).map(|cell| [cell % n, cell / n]) {
            for half in 0..if is_triangle { 2 } else { 1 } {
                for xi in nodes_of.iter().take(kind.n_nodes()) {
                    let [mut s, mut t] = match is_triangle {
                        true => [xi[0], xi[1]],
                        false => [0.5 + 0.5 * xi[0], 0.5 + 0.5 * xi[1]],
                    };
                    if half == 1 {
                        (s, t) = (1.0 - s, 1.0 - t);
                    }
                    let X = [(cell[0] as f64 + s) / n as f64, (cell[1] as f64 + t) / n as f64, 0.0];
                    let key = [X[0], X[1]].map(|x| (x * 1e6).round() as i64);
                    let next = known.len() as u32;
                    nodes.push(*known.entry(key).or_insert(next));
                    positions.push(X);
                }
            }
        }
        let k = kind.n_nodes();
        let (shapes, areas) = (vec![1.0 / k as f64; k], [1.0 / (nodes.len() / k) as f64]);
        let facets: Vec<SurfaceFacet<'_>> = (nodes.chunks_exact(k).zip(positions.chunks_exact(k)))
            .map(|(nodes, positions)| SurfaceFacet {
                kind,
                nodes,
                positions,
                shapes: &shapes,
                areas: &areas,
                body: 0,
            })
            .collect();
        Surface::new(&facets)
    }

    /// Wherever a point is over the inside of a plane surface, it is counted once.
    #[test]
    fn inclusion_and_exclusion_count_one_opponent() {
        let layer = Layer { modulus: 10.0, thickness: 0.2, law: LayerLaw::Smooth };
        let mut random = Random(5);
        for kind in [FacetKind::Quad4, FacetKind::Quad8, FacetKind::Quad9, FacetKind::Tri3, FacetKind::Tri6] {
            let surface = square(kind, 3);
            let mut X = vec![[0.0; 3]; surface.n_entities()];
            surface.combine(&surface.positions, &mut X);
            let area: f64 = (surface.triangles.iter())
                .map(|triangle| triangle.corners.map(|corner| X[corner as usize]))
                .map(|[a, b, c]| 0.5 * norm(cross(minus(b, a), minus(c, a))))
                .sum();
            assert!((area - 1.0).abs() < 1e-12, "{kind:?}");
            assert!((surface.points.iter().map(|point| point.area).sum::<f64>() - 2.0).abs() < 1e-12);
            // The border alone is sharp.
            assert!(surface.edges.iter().all(|edge| !edge.is_sharp || edge.factor == 0.0));
            for _ in 0..50 {
                let [x, y] = [(); 2].map(|()| 0.5 + 0.25 * random.number());
                let point = [x, y, 0.02 + 0.1 * random.number().abs()];
                let energy = |kind: PairKind, entities: &[u32], weight: f64| {
                    let mut q = [point; 4];
                    q[1..].iter_mut().zip(entities).for_each(|(q, entity)| *q = X[*entity as usize]);
                    let pair = Pair { kind, weight, layer };
                    if weight == 0.0 { 0.0 } else { pair.energy(&PairState::new(kind, q)) }
                };
                let of_triangles = surface.triangles.iter();
                let of_triangles: f64 =
                    of_triangles.map(|own| energy(PairKind::PointTriangle, &own.corners, 1.0)).sum();
                let of_edges = surface.edges.iter();
                let of_edges: f64 =
                    of_edges.map(|own| energy(PairKind::PointEdge, &own.ends, own.factor)).sum();
                let of_vertices = surface.vertices.iter();
                let of_vertices: f64 =
                    of_vertices.map(|(own, factor)| energy(PairKind::PointVertex, &[*own], *factor)).sum();
                let expected = layer.energy((point[2] / layer.thickness).powi(2));
                let sum = of_triangles + of_edges + of_vertices;
                assert!(
                    (sum - expected).abs() < 1e-11 * (1.0 + expected),
                    "{kind:?} {point:?}: {sum} {expected}"
                );
            }
        }
    }
}
