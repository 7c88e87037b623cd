//! Closest points of pairs.

use crate::tensor::{Mat3, cross, dot3, three};

/// A vector for each entity of a pair, `[a][i]`; zero beyond its entities.
pub type PairVectors = [[f64; 3]; 4];

/// A derivative of pair vectors by pair vectors, `[a][b][i][j]`.
pub type PairTangent = [[Mat3<f64>; 4]; 4];

/// The kind of a pair. Its *entities* are points in space, in this order.
///
/// ```
/// use emmy::internals::contact::PairKind;
/// assert_eq!(PairKind::PointTriangle.n_entities(), 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairKind {
    /// A point and the corners of a triangle.
    PointTriangle,
    /// A point and the ends of an edge.
    PointEdge,
    /// Two points.
    PointVertex,
    /// The ends of one edge and those of another.
    EdgeEdge,
}

impl PairKind {
    /// Number of entities, 2 to 4.
    pub fn n_entities(self) -> usize {
        match self {
            PairKind::PointVertex => 2,
            PairKind::PointEdge => 3,
            PairKind::PointTriangle | PairKind::EdgeEdge => 4,
        }
    }

    /// Whether an entity is on the side of the first: the point, or the first edge.
    pub fn is_first_side(self, entity: usize) -> bool {
        entity == 0 || (entity == 1 && self == PairKind::EdgeEdge)
    }
}

/// Closest weights of a pair at positions of its entities.
///
/// The weights have the sum zero: `(1, -lambda)` for a point and its opponent, `(1-s, s, -(1-t), -t)` for two edges.
/// Among all that are admissible (lambda >= 0; s and t in `[0, 1]`), they make the link shortest:
///
/// ```math
/// r = sum_a ell_a x_a,    z = min_ell |r|^2
/// ```
///
/// Those of a flat triangle are on one of its edges, and those of parallel edges at an end of one of them. Of ends
/// that are equally near, up to rounding, the first in the order of the entities counts.
///
/// ```
/// use emmy::internals::contact::{Closest, PairKind};
/// let x = [[0.25, 0.25, 0.5], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let closest = Closest::new(PairKind::PointTriangle, &x);
/// assert_eq!((closest.link, closest.squared_distance, closest.dimension), ([0.0, 0.0, 0.5], 0.25, 2));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Closest {
    /// Weights ell_a.
    pub weights: [f64; 4],
    /// Link r \[length\].
    pub link: [f64; 3],
    /// Squared distance z \[length^2\].
    pub squared_distance: f64,
    /// Dimension of the active face: 2 inside a triangle or inside both edges, 1 inside one edge, 0 at vertices.
    pub dimension: usize,
    /// Directions D_m of the weights on the active face.
    directions: [[f64; 4]; 2],
}

/// The active face of closest weights: `ell + sum_m xi_m D_m`, with at most two coordinates xi.
///
/// The closest weights satisfy `T_m . r = 0` with the tangents `T_m = sum_a D_ma x_a`, so that
///
/// ```math
/// (T^T T) dxi = - V dx,    V_ma = ell_a T_m + D_ma r,    dell_a = sum_m D_ma dxi_m
/// ```
///
/// All entries beyond the dimension are zero.
#[derive(Debug, Clone, Copy, Default)]
pub struct ActiveFace {
    /// Directions D_m.
    pub directions: [[f64; 4]; 2],
    /// Tangents T_m \[length\].
    pub tangents: [[f64; 3]; 2],
    /// V_m, the derivatives of `T_m . r` by the positions \[length\].
    pub conditions: [PairVectors; 2],
    /// Derivatives of xi_m by the positions \[1/length\].
    pub coordinates: [PairVectors; 2],
}

/// Below this squared sine, triangles are flat and edges parallel: the error of z is of the same order, 1e-16 times
/// the squared length of the edges, with the point inside and with that on an edge or at an end.
const FLAT: f64 = 1e-16;

impl Closest {
    /// The closest weights of a pair.
    pub fn new(kind: PairKind, x: &PairVectors) -> Closest {
        match kind {
            PairKind::PointTriangle => point_and_triangle(x),
            PairKind::PointEdge => point_and_edge(x, 0, [1, 2], 1.0),
            PairKind::PointVertex => Closest::with(x, [1.0, -1.0, 0.0, 0.0], &[]),
            PairKind::EdgeEdge => two_edges(x),
        }
    }

    fn with(x: &PairVectors, weights: [f64; 4], directions: &[[f64; 4]]) -> Closest {
        let link = combination(&weights, x);
        let mut all = [[0.0; 4]; 2];
        all[..directions.len()].copy_from_slice(directions);
        let (squared_distance, dimension) = (dot3(link, link), directions.len());
        Closest { weights, link, squared_distance, dimension, directions: all }
    }

    /// The active face, for the positions of the weights.
    pub fn face(&self, x: &PairVectors) -> ActiveFace {
        let directions = self.directions;
        let tangents = directions.map(|direction| combination(&direction, x));
        let [t_0, t_1] = tangents;
        let (m_00, m_01, m_11) = (dot3(t_0, t_0), dot3(t_0, t_1), dot3(t_1, t_1));
        let inverse = match self.dimension {
            0 => [[0.0; 2]; 2],
            1 => [[1.0 / m_00, 0.0], [0.0; 2]],
            _ => {
                let normal = cross(t_0, t_1);
                let det = dot3(normal, normal);
                [[m_11 / det, -m_01 / det], [-m_01 / det, m_00 / det]]
            }
        };
        let condition = |m: usize| {
            let entry =
                |a: usize, i: usize| self.weights[a] * tangents[m][i] + directions[m][a] * self.link[i];
            pair_vectors(entry)
        };
        let v = [condition(0), condition(1)];
        let coordinate =
            |m: usize| pair_vectors(|a, i| -(inverse[m][0] * v[0][a][i] + inverse[m][1] * v[1][a][i]));
        ActiveFace { directions, tangents, conditions: v, coordinates: [coordinate(0), coordinate(1)] }
    }

    /// `ell_a r`; twice of it is the gradient of z.
    pub fn spread_link(&self) -> PairVectors {
        spread(&self.weights, self.link)
    }

    /// The second derivative of z on the active face, symmetric.
    ///
    /// ```math
    /// d^2z = 2 ell (x) ell (x) I - 2 V^T (T^T T)^-1 V
    /// ```
    pub fn second_derivative(&self, face: &ActiveFace) -> PairTangent {
        let mut tangent = PairTangent::default();
        add_weights(&mut tangent, 2.0, &self.weights);
        for m in 0..self.dimension {
            add_product(&mut tangent, 2.0, &face.conditions[m], &face.coordinates[m]);
        }
        tangent
    }
}

fn point_and_triangle(x: &PairVectors) -> Closest {
    let (u, v, p) = (minus(x[2], x[1]), minus(x[3], x[1]), minus(x[0], x[1]));
    let normal = cross(u, v);
    let squared_area = dot3(normal, normal);
    let size = dot3(u, u).max(dot3(v, v));
    if squared_area > FLAT * size * size {
        let second = dot3(cross(p, v), normal) / squared_area;
        let third = dot3(cross(u, p), normal) / squared_area;
        let first = 1.0 - second - third;
        if first > 0.0 && second > 0.0 && third > 0.0 {
            let directions = [[0.0, 1.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]];
            return Closest::with(x, [1.0, -first, -second, -third], &directions);
        }
    }
    nearest([[1, 2], [2, 3], [3, 1]].map(|ends| point_and_edge(x, 0, ends, 1.0)), size)
}

/// An entity p and the edge between two others; `sign` is the weight of p.
fn point_and_edge(x: &PairVectors, p: usize, [i, j]: [usize; 2], sign: f64) -> Closest {
    let edge = minus(x[j], x[i]);
    let (along, squared) = (dot3(minus(x[p], x[i]), edge), dot3(edge, edge));
    let t = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
    let (mut weights, mut direction) = ([0.0; 4], [0.0; 4]);
    (weights[p], weights[i], weights[j]) = (sign, -sign * (1.0 - t), -sign * t);
    (direction[i], direction[j]) = (sign, -sign);
    Closest::with(x, weights, if t > 0.0 && t < 1.0 { std::slice::from_ref(&direction) } else { &[] })
}

fn two_edges(x: &PairVectors) -> Closest {
    let (u, v, p) = (minus(x[1], x[0]), minus(x[3], x[2]), minus(x[2], x[0]));
    let (uu, vv, normal) = (dot3(u, u), dot3(v, v), cross(u, v));
    let squared_area = dot3(normal, normal);
    if squared_area > FLAT * uu * vv {
        let s = dot3(cross(p, v), normal) / squared_area;
        let t = dot3(cross(p, u), normal) / squared_area;
        if s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0 {
            let directions = [[-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]];
            return Closest::with(x, [1.0 - s, s, t - 1.0, -t], &directions);
        }
    }
    let of_end = |(end, edge, sign)| point_and_edge(x, end, edge, sign);
    let ends = [(0, [2, 3], 1.0), (1, [2, 3], 1.0), (2, [0, 1], -1.0), (3, [0, 1], -1.0)];
    nearest(ends.map(of_end), uu + vv)
}

/// The first of the nearest candidates, up to the rounding of positions with differences of the squared `size`.
fn nearest<const N: usize>(candidates: [Closest; N], size: f64) -> Closest {
    let nearer = |best: Closest, next: Closest| {
        let z = best.squared_distance;
        let rounding = 8.0 * f64::EPSILON * (z + (z * size).sqrt());
        if next.squared_distance < z - rounding { next } else { best }
    };
    candidates.into_iter().reduce(nearer).unwrap_or_default()
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    three(|i| a[i] - b[i])
}

pub(super) fn pair_vectors(entry: impl Fn(usize, usize) -> f64) -> PairVectors {
    let vector = |a: usize| [entry(a, 0), entry(a, 1), entry(a, 2)];
    [vector(0), vector(1), vector(2), vector(3)]
}

/// `sum_a ell_a x_a` for weights with the sum zero, from differences: a translation cancels before it is multiplied.
pub(super) fn combination(weights: &[f64; 4], x: &PairVectors) -> [f64; 3] {
    three(|i| (1..4).map(|a| weights[a] * (x[a][i] - x[0][i])).sum())
}

/// `ell_a v`.
pub(super) fn spread(weights: &[f64; 4], v: [f64; 3]) -> PairVectors {
    pair_vectors(|a, i| weights[a] * v[i])
}

/// `factor v_a`.
pub(super) fn scaled(factor: f64, v: &PairVectors) -> PairVectors {
    v.map(|vector| vector.map(|component| factor * component))
}

/// Multiplies a tangent by a factor.
pub(super) fn scale(tangent: &mut PairTangent, factor: f64) {
    tangent
        .as_flattened_mut()
        .as_flattened_mut()
        .as_flattened_mut()
        .iter_mut()
        .for_each(|entry| *entry *= factor);
}

/// Adds `scale left (x) right`.
pub(super) fn add_product(tangent: &mut PairTangent, scale: f64, left: &PairVectors, right: &PairVectors) {
    for (row, left) in tangent.iter_mut().zip(left) {
        for (block, right) in row.iter_mut().zip(right) {
            for i in 0..3 {
                (0..3).for_each(|j| block[i][j] += scale * left[i] * right[j]);
            }
        }
    }
}

/// Adds `scale ell (x) ell (x) I`.
pub(super) fn add_weights(tangent: &mut PairTangent, scale: f64, weights: &[f64; 4]) {
    for a in 0..4 {
        for b in 0..4 {
            (0..3).for_each(|i| tangent[a][b][i][i] += scale * weights[a] * weights[b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{KINDS, Random, product};
    use super::*;

    /// Weights of the corners of the admissible set.
    fn corners(kind: PairKind) -> Vec<[f64; 4]> {
        let point = [[1.0, -1.0, 0.0, 0.0], [1.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, -1.0]];
        let edges = [[1., 0., -1., 0.], [1., 0., 0., -1.], [0., 1., -1., 0.], [0., 1., 0., -1.]];
        if kind == PairKind::EdgeEdge { edges.to_vec() } else { point[..kind.n_entities() - 1].to_vec() }
    }

    /// The problem is convex: weights are closest if no corner is downhill, `r . r_corner >= r . r`.
    fn assert_closest(kind: PairKind, x: &PairVectors) -> Closest {
        let closest = Closest::new(kind, x);
        let r = closest.link;
        let size = (1..4).map(|a| minus(x[a], x[0])).map(|v| dot3(v, v)).fold(0.0, f64::max);
        for corner in corners(kind) {
            let slope = dot3(r, combination(&corner, x)) - closest.squared_distance;
            // Of a pair with a sine of 1e-8 inside, the foot has an error of 1e-8.
            assert!(slope >= -1e-7 * size, "{kind:?} {x:?}: {slope:e}");
        }
        assert!(closest.weights.iter().sum::<f64>().abs() < 1e-15);
        closest
    }

    #[test]
    fn no_corner_is_downhill() {
        let mut random = Random(1);
        let mut found = [[0; 3]; 4];
        for _ in 0..2000 {
            for (n, kind) in KINDS.into_iter().enumerate() {
                found[n][assert_closest(kind, &random.vectors(kind, 1.0)).dimension] += 1;
            }
        }
        // Triangle, edge, vertex, two edges: every face that there is.
        assert!(
            found[0].iter().chain(&found[1][..2]).chain(&found[2][..1]).chain(&found[3]).all(|n| *n > 50)
        );
    }

    #[test]
    fn flat_triangles_and_parallel_edges_have_closest_points() {
        let mut random = Random(2);
        for _ in 0..500 {
            // Heights and angles from nothing to small; the foot of the point is inside, edges cross.
            for height in [0.0, 1e-20, 1e-12, 1e-9, 1e-7, 1e-4] {
                let [origin, u, v, _] = random.vectors(PairKind::PointTriangle, 1.0);
                let (t, normal) = (random.number(), cross(u, v));
                let at = |s: f64, t: f64, z: f64| three(|i| origin[i] + s * u[i] + t * v[i] + z * normal[i]);
                let corners = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(t, height, 0.0)];
                let point = at((1.0 + t) / 3.0, height / 3.0, 0.3);
                let triangle =
                    assert_closest(PairKind::PointTriangle, &[point, corners[0], corners[1], corners[2]]);
                assert!(triangle.dimension < 2 || height > 1e-10);
                let [third, fourth] = [at(0.2 - t, -height, 0.3), at(0.8 + t, height, 0.3)];
                let edges = assert_closest(PairKind::EdgeEdge, &[corners[0], corners[1], third, fourth]);
                assert!(edges.dimension < 2 || height > 1e-10);
            }
            // Edges and triangles without extent.
            let p = random.vectors(PairKind::PointVertex, 1.0);
            let edge = assert_closest(PairKind::EdgeEdge, &[p[0], p[0], p[1], p[1]]);
            let triangle = assert_closest(PairKind::PointTriangle, &[p[0], p[1], p[1], p[1]]);
            assert!((edge.squared_distance - triangle.squared_distance).abs() < 1e-15);
        }
    }

    #[test]
    fn ends_of_parallel_edges_are_chosen_in_a_fixed_order() {
        // The edges overlap from 0.25 to 1; rounding does not decide between the ends.
        for shift in [0.0, 1e-16, -1e-16, 3e-16] {
            let x = [[0.0, 0.1, 0.1], [1.0, 0.1, 0.1 + shift], [0.25, 0.0, shift], [1.5, 0.0, 0.0]];
            let closest = Closest::new(PairKind::EdgeEdge, &x);
            assert_eq!((closest.weights[0], closest.weights[1], closest.dimension), (0.0, 1.0, 1));
        }
    }

    #[test]
    fn derivatives_are_those_on_the_active_face() {
        let mut random = Random(3);
        for kind in KINDS {
            for _ in 0..200 {
                let x = random.vectors(kind, 1.0);
                let u = random.vectors(kind, 1.0);
                let at = |h: f64| Closest::new(kind, &pair_vectors(|a, i| x[a][i] + h * u[a][i]));
                let (h, closest) = (1e-5, at(0.0));
                let (before, after) = (at(-h), at(h));
                let face = closest.face(&x);
                let tangent_sizes = face.tangents.map(|t| dot3(t, t));
                let normal = cross(face.tangents[0], face.tangents[1]);
                let is_flat = closest.dimension == 2
                    && dot3(normal, normal) < 0.01 * tangent_sizes[0] * tangent_sizes[1];
                let is_short = tangent_sizes[..closest.dimension].iter().any(|size| *size < 0.01);
                let faces = [before.directions, after.directions];
                if is_flat || is_short || faces != [closest.directions; 2] {
                    continue;
                }
                let second = closest.second_derivative(&face);
                for a in 0..4 {
                    let own: f64 =
                        (0..2).map(|m| face.directions[m][a] * product(&face.coordinates[m], &u)).sum();
                    let difference = (after.weights[a] - before.weights[a]) / (2.0 * h);
                    assert!((own - difference).abs() < 1e-6 * (1.0 + own.abs()), "{own} {difference}");
                    for i in 0..3 {
                        let difference = 2.0 * (after.spread_link()[a][i] - before.spread_link()[a][i]);
                        let own: f64 = (0..4).map(|b| dot3(second[a][b][i], u[b])).sum();
                        assert!((own - difference / (2.0 * h)).abs() < 1e-6 * (1.0 + own.abs()));
                    }
                }
                let slope = 2.0 * product(&closest.spread_link(), &u);
                let difference = (after.squared_distance - before.squared_distance) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-7 * (1.0 + slope.abs()));
            }
        }
    }
}
