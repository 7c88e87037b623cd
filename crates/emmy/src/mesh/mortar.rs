//! Weights that tie one surface to another so that a uniform stress passes exactly.
//!
//! On each follower facet the dual functions `psi = D M^-1 N`, with `M = integral N N^T` and `D = diag(integral N)`,
//! have `integral psi_i N_j = delta_ij D_ii`. A follower moves with the mean of the leader's motion that they weigh,
//!
//! ```math
//! u_i = 1/D_ii sum_A (integral psi_i N_A) u_A
//! ```
//!
//! with integrals over the intersections of follower and leader facets, in the plane of the follower facet; D and M
//! are those of the same points (Wohlmuth, SIAM J. Numer. Anal. 38, 2000; Puso, Int. J. Numer. Meth. Engng 59, 2004).
//!
//! The functions N at the corners of tri6 and quad8 have integrals of zero and below. There others take their place,
//!
//! ```math
//! N^_c = N_c + alpha sum_m N_m,    N^_m = (1 - 2 alpha) N_m,      alpha = 1/5
//! ```
//!
//! with the nodes m next to the corner c: they have positive integrals and sum to 1. In terms of their values u^, a
//! corner has u_c = u^_c and a node between two corners `u_m = (1 - 2 alpha) u^_m + alpha (u^_c + u^_c')` (Popp,
//! Wohlmuth, Gee and Wall, SIAM J. Sci. Comput. 34, 2012).

#![allow(non_snake_case)]

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::nearest::coordinates;
use super::{Facet, FacetKind, Mesh, distance};
use crate::element::facet_element;
use crate::quadrature::{Quadrature, gauss, triangle};
use crate::sparse::eliminate;
use crate::tensor::{cross, dot3};

/// Parts of a facet below this are rounding: of its area that a leader covers, and of a weight.
const ROUNDING: f64 = 1e-10;

/// Cosine of the largest angle between two facets that are tied.
const LEAST_COSINE: f64 = 0.5;

/// Degree of the rule on a triangle where shape functions are polynomials of the second degree: four of their products.
const DEGREE: usize = 5;

/// Points along a side of the rule on a triangle where they are not: on quadrilaterals that are no parallelograms, and
/// for shape functions of higher degrees.
const N_POINTS: usize = 8;

/// Weights of nodes by node.
type Weights = BTreeMap<u32, f64>;

/// Leaders with their weights, which sum to 1.
type Shares = Vec<(u32, f64)>;

/// Part alpha of a node between two corners that is added to them.
const SHARE: f64 = 0.2;

/// Largest number of nodes of a facet.
const MAX_NODES: usize = 9;

/// Whether corners of a kind of facet take a part of the nodes between them: their own integrals are not positive.
fn takes_share(kind: FacetKind) -> bool {
    matches!(kind, FacetKind::Tri6 | FacetKind::Quad8)
}

/// Weights of the leaders of each follower that leaders cover. Leaders further away than `tolerance` times their
/// longest edge do not count.
pub(crate) fn mortar(
    mesh: &Mesh,
    [followers, leaders]: [&[Facet]; 2],
    tolerance: f64,
) -> BTreeMap<u32, Shares> {
    let side =
        |facets: &[Facet]| -> Vec<Side> { facets.iter().map(|&facet| Side::new(mesh, facet)).collect() };
    let [followers, leaders] = [side(followers), side(leaders)];
    let of_facets: Vec<Covered> =
        followers.par_iter().map(|follower| Covered::new(follower, &leaders, tolerance)).collect();
    let mut sums: BTreeMap<u32, (f64, Weights)> = BTreeMap::new();
    for (follower, covered) in followers.iter().zip(of_facets) {
        for ((node, area), weights) in follower.nodes.iter().zip(covered.areas).zip(covered.weights) {
            let (sum, of_leaders) = sums.entry(*node).or_default();
            *sum += area;
            weights
                .into_iter()
                .for_each(|(leader, weight)| *of_leaders.entry(leader).or_insert(0.0) += weight);
        }
    }
    let shares = |(area, weights): (f64, Weights)| -> Shares {
        let own: Shares = weights.into_iter().filter(|(_, weight)| weight.abs() > ROUNDING * area).collect();
        let sum: f64 = own.iter().map(|(_, weight)| weight).sum();
        own.into_iter().map(|(leader, weight)| (leader, weight / sum)).collect()
    };
    let found = sums.into_iter().filter(|(_, (area, _))| *area > 0.0);
    let mut found: BTreeMap<u32, Shares> = found.map(|(node, own)| (node, shares(own))).collect();
    add_shares(&followers, &mut found);
    found
}

/// Takes nodes between two corners, which have shared with these, from the values u^ to those of u. Without both
/// corners they are not covered.
fn add_shares(followers: &[Side], found: &mut BTreeMap<u32, Shares>) {
    let sides = followers.iter().filter(|side| takes_share(side.kind));
    let between: BTreeMap<u32, [u32; 2]> = sides
        .flat_map(|side| {
            let n = side.kind.n_corners();
            (0..n).map(move |i| (side.nodes[n + i], [side.nodes[i], side.nodes[(i + 1) % n]]))
        })
        .collect();
    let mut own: Vec<(u32, Option<Shares>)> = Vec::new();
    for (node, ends) in between {
        let parts = [(node, 1.0 - 2.0 * SHARE), (ends[0], SHARE), (ends[1], SHARE)];
        let mut sum = Weights::new();
        let is_whole = parts.into_iter().all(|(part, factor)| {
            let weights = found.get(&part);
            let mut weights = weights.into_iter().flatten().peekable();
            let is_there = weights.peek().is_some();
            weights.for_each(|(leader, weight)| *sum.entry(*leader).or_insert(0.0) += factor * weight);
            is_there
        });
        own.push((node, is_whole.then(|| sum.into_iter().collect())));
    }
    for (node, weights) in own {
        match weights {
            Some(weights) => _ = found.insert(node, weights),
            None => _ = found.remove(&node),
        }
    }
}

/// A facet of one of the surfaces.
struct Side {
    kind: FacetKind,
    nodes: Vec<u32>,
    points: Vec<[f64; 3]>,
    centre: [f64; 3],
    radius: f64,
    /// Longest edge.
    size: f64,
    /// Unit normal; of an edge the direction along it.
    normal: [f64; 3],
    /// Whether its shape functions are polynomials of the place, of at most the second degree.
    is_affine: bool,
}

impl Side {
    fn new(mesh: &Mesh, facet: Facet) -> Self {
        let kind = mesh.facet_kind(facet);
        let nodes: Vec<u32> = mesh.facet_nodes(facet).collect();
        let points: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.points()[node as usize]).collect();
        let n = kind.n_corners();
        let corners = &points[..n];
        let centre = [0, 1, 2].map(|d| corners.iter().map(|X| X[d]).sum::<f64>() / n as f64);
        let radius = points.iter().map(|&X| distance(X, centre)).fold(0.0, f64::max);
        let size = (0..n).map(|i| distance(points[i], points[(i + 1) % n])).fold(0.0, f64::max);
        let along = |a: usize, b: usize| less(points[b], points[a]);
        let normal = match n {
            2 => along(0, 1),
            3 => cross(along(0, 1), along(0, 2)),
            _ => cross(along(0, 2), along(1, 3)),
        };
        let is_affine = is_affine(kind, &points, size);
        Side { kind, nodes, points, centre, radius, size, normal: unit(normal), is_affine }
    }

    /// The same with its points in the plane, or on the line, of another facet.
    fn projected(&self, onto: &Side) -> Vec<[f64; 3]> {
        let arm = |X: &[f64; 3]| less(*X, onto.centre);
        let part = |X: &[f64; 3]| {
            let along = dot3(arm(X), onto.normal);
            let factor = if onto.is_edge() { along } else { -along };
            let base = if onto.is_edge() { onto.centre } else { *X };
            [0, 1, 2].map(|d| base[d] + factor * onto.normal[d])
        };
        self.points.iter().map(part).collect()
    }

    fn is_edge(&self) -> bool {
        self.kind.n_corners() == 2
    }

    /// Shape functions at a point X of the plane of some points of the facet.
    fn shape(&self, points: &[[f64; 3]], X: [f64; 3]) -> [f64; MAX_NODES] {
        let mut N = [0.0; MAX_NODES];
        facet_element(self.kind).shape(coordinates(self.kind, points, X), &mut N[..points.len()]);
        N
    }

    /// The functions N^ of a follower for its shape functions.
    fn shared(&self, N: [f64; MAX_NODES]) -> [f64; MAX_NODES] {
        let n = self.kind.n_corners();
        let mut shared = N;
        for i in (0..n).filter(|_| takes_share(self.kind)) {
            shared[n + i] = (1.0 - 2.0 * SHARE) * N[n + i];
            shared[i] += SHARE * N[n + i];
            shared[(i + 1) % n] += SHARE * N[n + i];
        }
        shared
    }
}

/// Whether shape functions of a facet are polynomials of the place, of at most the second degree: of triangles with
/// straight edges and nodes in their middle, of bilinear parallelograms and of edges.
fn is_affine(kind: FacetKind, points: &[[f64; 3]], size: f64) -> bool {
    let n = kind.n_corners();
    let mean = |a: usize, b: usize| [0, 1, 2].map(|d| 0.5 * (points[a][d] + points[b][d]));
    match kind {
        FacetKind::Line2 | FacetKind::Line3 | FacetKind::Tri3 => true,
        FacetKind::Tri6 => (0..n).all(|i| distance(points[n + i], mean(i, (i + 1) % n)) <= ROUNDING * size),
        FacetKind::Quad4 => distance(mean(0, 2), mean(1, 3)) <= 0.5 * ROUNDING * size,
        FacetKind::Quad8 | FacetKind::Quad9 => false,
    }
}

/// The integrals of a follower facet over the leaders.
struct Covered {
    /// D_ii, zeros if leaders cover next to nothing.
    areas: Vec<f64>,
    /// `integral psi_i N_A`.
    weights: Vec<Weights>,
}

impl Covered {
    fn new(follower: &Side, leaders: &[Side], tolerance: f64) -> Self {
        let n = follower.nodes.len();
        let mut areas = vec![0.0; n];
        let mut mass = vec![0.0; n * n];
        let mut products: BTreeMap<u32, [f64; MAX_NODES]> = BTreeMap::new();
        let plane = Plane::new(follower);
        let own = follower.projected(follower);
        let polygon = plane.polygon(&own[..follower.kind.n_corners()]);
        let (polynomial, rational, on_edge) = (triangle(DEGREE), collapsed(N_POINTS), gauss(3));
        for leader in leaders {
            let apart = distance(follower.centre, leader.centre);
            let reach = tolerance * leader.size;
            if apart > follower.radius + leader.radius + reach
                || dot3(follower.normal, leader.normal).abs() < LEAST_COSINE
            {
                continue;
            }
            let other = leader.projected(follower);
            let overlap = clipped(plane.polygon(&other[..leader.kind.n_corners()]), &polygon);
            let on_triangle = if follower.is_affine && leader.is_affine { &polynomial } else { &rational };
            plane.for_each_point(&overlap, (on_triangle, &on_edge), |x, weight| {
                let X = plane.point(x);
                let (N, N_A) = (follower.shape(&own, X), leader.shape(&other, X));
                let place = |side: &Side, N: &[f64; MAX_NODES]| {
                    [0, 1, 2].map(|d| side.points.iter().zip(N).map(|(X, N)| N * X[d]).sum::<f64>())
                };
                if distance(place(follower, &N), place(leader, &N_A)) > reach + ROUNDING * leader.size {
                    return;
                }
                let N = follower.shared(N);
                for i in 0..n {
                    areas[i] += weight * N[i];
                    (0..n).for_each(|j| mass[i * n + j] += weight * N[i] * N[j]);
                }
                for (&node, N_A) in leader.nodes.iter().zip(N_A) {
                    let sums = products.entry(node).or_default();
                    (0..n).for_each(|i| sums[i] += weight * N[i] * N_A);
                }
            });
        }
        let covered: f64 = areas.iter().sum();
        // M^-1 of the products with each leader.
        let columns = products.len();
        let mut dual = vec![0.0; n * columns];
        for (column, of_leader) in products.values().enumerate() {
            (0..n).for_each(|i| dual[i * columns + column] = of_leader[i]);
        }
        if covered <= ROUNDING * plane.area(&polygon) || !eliminate(&mut mass, &mut dual, columns) {
            return Covered { areas: vec![0.0; n], weights: vec![Weights::new(); n] };
        }
        let row = |i: usize| -> Weights {
            let own = dual[i * columns..(i + 1) * columns].iter().map(|weight| areas[i] * weight);
            products.keys().copied().zip(own).collect()
        };
        Covered { weights: (0..n).map(row).collect(), areas }
    }
}

/// Coordinates in the plane of a facet, or along an edge.
struct Plane {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
    is_edge: bool,
}

impl Plane {
    fn new(facet: &Side) -> Self {
        let is_edge = facet.is_edge();
        let axes = match is_edge {
            true => [facet.normal, [0.0; 3]],
            false => {
                let first = unit(less(facet.points[1], facet.points[0]));
                let second = unit(cross(facet.normal, first));
                [cross(second, facet.normal), second]
            }
        };
        Plane { origin: facet.centre, axes, is_edge }
    }

    fn point(&self, x: [f64; 2]) -> [f64; 3] {
        [0, 1, 2].map(|d| self.origin[d] + x[0] * self.axes[0][d] + x[1] * self.axes[1][d])
    }

    /// The corners, counter-clockwise, or the ends in their order along the edge.
    fn polygon(&self, points: &[[f64; 3]]) -> Vec<[f64; 2]> {
        let coordinates = |X: &[f64; 3]| self.axes.map(|axis| dot3(less(*X, self.origin), axis));
        let mut corners: Vec<[f64; 2]> = points.iter().map(coordinates).collect();
        let is_reversed = match self.is_edge {
            true => corners[0][0] > corners[1][0],
            false => signed_area(&corners) < 0.0,
        };
        if is_reversed {
            corners.reverse();
        }
        corners
    }

    fn area(&self, polygon: &[[f64; 2]]) -> f64 {
        if self.is_edge { polygon[1][0] - polygon[0][0] } else { signed_area(polygon) }
    }

    /// Calls a function with the points and weights of a rule on the triangles of a convex polygon, or on an interval.
    /// Facets that touch along an edge have a polygon of two corners, and no area.
    fn for_each_point(
        &self,
        polygon: &[[f64; 2]],
        (on_triangle, on_edge): (&Quadrature<2>, &Quadrature<1>),
        mut visit: impl FnMut([f64; 2], f64),
    ) {
        let [origin, others @ ..] = polygon else { return };
        for pair in others.windows(2) {
            let area = signed_area(&[*origin, pair[0], pair[1]]);
            on_triangle.iter().for_each(|(xi, weight)| {
                let along = |end: [f64; 2], d: usize| end[d] - origin[d];
                let x = [0, 1].map(|d| origin[d] + xi[0] * along(pair[0], d) + xi[1] * along(pair[1], d));
                visit(x, 2.0 * area * weight);
            });
        }
        if let ([end], true) = (others, self.is_edge) {
            let length = end[0] - origin[0];
            on_edge.iter().for_each(|(xi, weight)| visit([origin[0] + xi[0] * length, 0.0], weight * length));
        }
    }
}

/// The part of a polygon within a convex one, both counter-clockwise (Sutherland and Hodgman); of intervals theirs.
fn clipped(mut polygon: Vec<[f64; 2]>, within: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if let [[from, _], [to, _]] = *within {
        let [begin, end] = [polygon[0][0].max(from), polygon[1][0].min(to)];
        return if begin < end { vec![[begin, 0.0], [end, 0.0]] } else { Vec::new() };
    }
    for (i, &from) in within.iter().enumerate() {
        let to = within[(i + 1) % within.len()];
        let side = |x: [f64; 2]| (to[0] - from[0]) * (x[1] - from[1]) - (to[1] - from[1]) * (x[0] - from[0]);
        let corners = std::mem::take(&mut polygon);
        for (j, &a) in corners.iter().enumerate() {
            let b = corners[(j + 1) % corners.len()];
            let (of_a, of_b) = (side(a), side(b));
            if of_a >= 0.0 {
                polygon.push(a);
            }
            if of_a * of_b < 0.0 {
                let t = of_a / (of_a - of_b);
                polygon.push([0, 1].map(|d| a[d] + t * (b[d] - a[d])));
            }
        }
    }
    polygon
}

/// A product of rules of n points on the triangle (0,0), (1,0), (0,1), whose side y = 0 to 1 at x = 1 is collapsed.
fn collapsed(n: usize) -> Quadrature<2> {
    let line = gauss(n);
    let pairs = || line.iter().flat_map(|(x, a)| line.iter().map(move |(y, b)| ((x[0], a), (y[0], b))));
    Quadrature {
        points: pairs().map(|((x, _), (y, _))| [x, y * (1.0 - x)]).collect(),
        weights: pairs().map(|((x, a), (_, b))| a * b * (1.0 - x)).collect(),
    }
}

fn signed_area(polygon: &[[f64; 2]]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot3(v, v).sqrt();
    v.map(|x| x / length)
}
