//! The point of a facet or a cell that is nearest to a given point.

#![allow(non_snake_case)]

use super::{CellKind, Facet, FacetKind, Mesh};
use crate::element::{element, facet_element};
use crate::tensor::{det, dot3, mat3};

/// Corrections of Newton's iteration for a point.
const MAX_ITERATIONS: usize = 30;

/// Change of reference coordinates at which it ends, and how far a point may be outside.
const ROUNDING: f64 = 1e-12;

/// Largest number of nodes of a facet.
const MAX_NODES: usize = 9;

/// Bound on the bulge of a curved edge, over the distance of its nodes from their mean.
const BULGE: f64 = 1.25;

/// A point as a combination of nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Nearest {
    /// Nodes with their shape functions; those of zero are left out.
    pub weights: Vec<(u32, f64)>,
    /// Distance of the given point.
    pub distance: f64,
    /// Longest edge of the facet or cell.
    pub size: f64,
}

/// A facet or a cell with its nodes.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    shape: Shape,
    nodes: Vec<u32>,
    points: Vec<[f64; 3]>,
    centre: [f64; 3],
    radius: f64,
}

#[derive(Debug, Clone, Copy)]
enum Shape {
    Facet(FacetKind),
    Solid(CellKind),
}

impl Patch {
    /// A facet of a mesh.
    pub(crate) fn of_facet(mesh: &Mesh, facet: Facet) -> Self {
        let kind = mesh.facet_kind(facet);
        Patch::new(Shape::Facet(kind), mesh.facet_nodes(facet).collect(), |node| mesh.points()[node as usize])
    }

    /// A cell of a mesh.
    pub(crate) fn of_cell(mesh: &Mesh, cell: usize) -> Self {
        let cell = mesh.cell(cell);
        let shape = match cell.kind {
            CellKind::Line2 => Shape::Facet(FacetKind::Line2),
            CellKind::Tri3 => Shape::Facet(FacetKind::Tri3),
            CellKind::Tri6 => Shape::Facet(FacetKind::Tri6),
            CellKind::Quad4 => Shape::Facet(FacetKind::Quad4),
            CellKind::Quad8 => Shape::Facet(FacetKind::Quad8),
            CellKind::Quad9 => Shape::Facet(FacetKind::Quad9),
            kind => Shape::Solid(kind),
        };
        Patch::new(shape, cell.nodes.to_vec(), |node| mesh.points()[node as usize])
    }

    fn new(shape: Shape, nodes: Vec<u32>, point: impl Fn(u32) -> [f64; 3]) -> Self {
        let points: Vec<[f64; 3]> = nodes.iter().map(|&node| point(node)).collect();
        let centre = combined(&points, &vec![1.0 / points.len() as f64; points.len()]);
        let radius = points.iter().map(|&X| distance(X, centre)).fold(0.0, f64::max);
        Patch { shape, nodes, points, centre, radius: BULGE * radius }
    }

    /// Least and largest distance that its nearest point can have from X.
    pub(crate) fn bounds(&self, X: [f64; 3]) -> [f64; 2] {
        let distance = distance(X, self.centre);
        [distance - self.radius, distance + self.radius]
    }

    /// Its point nearest to X.
    pub(crate) fn nearest(&self, X: [f64; 3]) -> Nearest {
        let (weights, distance) = match self.shape {
            Shape::Facet(kind) => on_facet(kind, &self.points, X),
            Shape::Solid(kind) => in_solid(kind, &self.points, X),
        };
        let sum: f64 = weights.iter().filter(|weight| weight.abs() > ROUNDING).sum();
        let shares = self.nodes.iter().copied().zip(weights.into_iter().map(|weight| weight / sum));
        let weights = shares.filter(|(_, weight)| weight.abs() > ROUNDING).collect();
        Nearest { weights, distance, size: self.longest_edge() }
    }

    fn longest_edge(&self) -> f64 {
        let of_facet = |corners: Vec<usize>| {
            let n = corners.len();
            let edge = |i: usize| distance(self.points[corners[i]], self.points[corners[(i + 1) % n]]);
            (0..n).map(edge).fold(0.0, f64::max)
        };
        match self.shape {
            Shape::Facet(kind) => of_facet((0..kind.n_corners()).collect()),
            Shape::Solid(kind) => {
                let facets = kind.facets().iter();
                let corners = facets.map(|facet| facet.nodes[..facet.kind.n_corners()].to_vec());
                corners.map(of_facet).fold(0.0, f64::max)
            }
        }
    }
}

/// Distance of two points.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

fn combined(points: &[[f64; 3]], weights: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (X, weight) in points.iter().zip(weights) {
        (0..3).for_each(|d| sum[d] += weight * X[d]);
    }
    sum
}

/// Shape functions of a facet at some coordinates, and their distance from X.
type Candidate = (Vec<f64>, f64);

fn nearer(a: Candidate, b: Candidate) -> Candidate {
    if b.1 < a.1 { b } else { a }
}

fn candidate(kind: FacetKind, points: &[[f64; 3]], xi: [f64; 2], X: [f64; 3]) -> Candidate {
    let mut N = vec![0.0; points.len()];
    facet_element(kind).shape(xi, &mut N);
    let distance = distance(combined(points, &N), X);
    (N, distance)
}

/// Position less X at some coordinates of a facet, and the two tangents.
fn linearised(kind: FacetKind, points: &[[f64; 3]], xi: [f64; 2], X: [f64; 3]) -> ([f64; 3], [[f64; 3]; 2]) {
    let n = points.len();
    let (mut N, mut dN) = ([0.0; MAX_NODES], [[0.0; 2]; MAX_NODES]);
    facet_element(kind).shape(xi, &mut N[..n]);
    facet_element(kind).gradient(xi, &mut dN[..n]);
    let along = |axis: usize| combined(points, &dN.map(|dN| dN[axis]));
    let x = combined(points, &N);
    ([0, 1, 2].map(|d| x[d] - X[d]), [along(0), along(1)])
}

/// Coordinates of the nearest point of the surface, or line, of a facet, which may be outside of the facet: by Gauss
/// and Newton's iteration.
pub(super) fn coordinates(kind: FacetKind, points: &[[f64; 3]], X: [f64; 3]) -> [f64; 2] {
    let corners = &facet_element(kind).nodes()[..kind.n_corners()];
    let mut xi = [0, 1].map(|axis| corners.iter().map(|xi| xi[axis]).sum::<f64>() / corners.len() as f64);
    for _ in 0..MAX_ITERATIONS {
        let (r, [a, b]) = linearised(kind, points, xi, X);
        let (aa, ab, bb) = (dot3(a, a), dot3(a, b), dot3(b, b));
        let (ra, rb) = (dot3(r, a), dot3(r, b));
        let change = match corners.len() {
            2 => [-ra / aa, 0.0],
            _ => {
                let minor = aa * bb - ab * ab;
                [(ab * rb - bb * ra) / minor, (ab * ra - aa * rb) / minor]
            }
        };
        xi = [xi[0] + change[0], xi[1] + change[1]];
        let goes_on = change.iter().any(|change| change.abs() > ROUNDING);
        if !goes_on {
            break;
        }
    }
    xi
}

/// The nearest point of a facet: inside, or on an edge.
fn on_facet(kind: FacetKind, points: &[[f64; 3]], X: [f64; 3]) -> Candidate {
    let corners = &facet_element(kind).nodes()[..kind.n_corners()];
    if let [a, b] = corners {
        return on_edge(kind, points, [*a, *b], X);
    }
    let edges = (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]);
    let on_edges = edges.map(|edge| on_edge(kind, points, edge, X)).reduce(nearer);
    let xi = coordinates(kind, points, X);
    let linear = if corners.len() == 3 { FacetKind::Tri3 } else { FacetKind::Quad4 };
    let mut N = vec![0.0; corners.len()];
    facet_element(linear).shape(xi, &mut N);
    let inside = N.iter().all(|N| *N >= -ROUNDING).then(|| candidate(kind, points, xi, X));
    let found = inside.into_iter().chain(on_edges).reduce(nearer);
    found.unwrap_or_else(|| candidate(kind, points, xi, X))
}

/// The nearest point on a line between two reference points of a facet.
fn on_edge(kind: FacetKind, points: &[[f64; 3]], [from, to]: [[f64; 2]; 2], X: [f64; 3]) -> Candidate {
    let along = [to[0] - from[0], to[1] - from[1]];
    let at = |t: f64| [from[0] + t * along[0], from[1] + t * along[1]];
    let mut t: f64 = 0.5;
    for _ in 0..MAX_ITERATIONS {
        let (r, [a, b]) = linearised(kind, points, at(t), X);
        let tangent = [0, 1, 2].map(|d| along[0] * a[d] + along[1] * b[d]);
        let next = (t - dot3(r, tangent) / dot3(tangent, tangent)).clamp(0.0, 1.0);
        let goes_on = (next - t).abs() > ROUNDING;
        t = next;
        if !goes_on {
            break;
        }
    }
    [0.0, 1.0, t].map(|t| candidate(kind, points, at(t), X)).into_iter().reduce(nearer).unwrap_or_default()
}

/// X itself if the cell contains it, else the nearest point of its facets.
fn in_solid(kind: CellKind, points: &[[f64; 3]], X: [f64; 3]) -> Candidate {
    let (mut N, mut dN) = (vec![0.0; points.len()], vec![[0.0; 3]; points.len()]);
    let corners = &element(kind).nodes()[..kind.n_corners()];
    let mut xi = [0, 1, 2].map(|axis| corners.iter().map(|xi| xi[axis]).sum::<f64>() / corners.len() as f64);
    for _ in 0..MAX_ITERATIONS {
        element(kind).shape(xi, &mut N);
        element(kind).gradient(xi, &mut dN);
        let x = combined(points, &N);
        let r = [0, 1, 2].map(|d| x[d] - X[d]);
        let J = mat3(|i, j| points.iter().zip(&dN).map(|(X, dN)| X[i] * dN[j]).sum::<f64>());
        let determinant = det(&J);
        // Cramer's rule.
        let change =
            [0, 1, 2].map(|axis| -det(&mat3(|i, j| if j == axis { r[i] } else { J[i][j] })) / determinant);
        (0..3).for_each(|axis| xi[axis] += change[axis]);
        let goes_on = change.iter().any(|change| change.abs() > ROUNDING);
        if !goes_on {
            break;
        }
    }
    let mut of_corners = vec![0.0; corners.len()];
    element(kind.linear()).shape(xi, &mut of_corners);
    if of_corners.iter().all(|N| *N >= -ROUNDING) {
        element(kind).shape(xi, &mut N);
        let distance = distance(combined(points, &N), X);
        return (N, distance);
    }
    let of_facet = |facet: &crate::element::LocalFacet| {
        let own: Vec<[f64; 3]> = facet.nodes.iter().map(|&local| points[local]).collect();
        let (of_facet, distance) = on_facet(facet.kind, &own, X);
        let mut N = vec![0.0; points.len()];
        facet.nodes.iter().zip(of_facet).for_each(|(&local, weight)| N[local] = weight);
        (N, distance)
    };
    kind.facets().iter().map(of_facet).reduce(nearer).unwrap_or((N, f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshBuilder, block};

    fn close(found: &Nearest, mesh: &Mesh, expected: [f64; 3]) {
        let sum: f64 = found.weights.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-15);
        let mut x = [0.0; 3];
        for (node, weight) in &found.weights {
            (0..3).for_each(|d| x[d] += weight * mesh.points()[*node as usize][d]);
        }
        assert!(distance(x, expected) < 1e-12, "{x:?} {expected:?}");
    }

    #[test]
    fn points_above_beside_and_at_a_corner_of_a_facet() {
        let mesh = block([2.0, 1.0, 1.0], [1; 3]).unwrap();
        let facet = mesh.groups().facets("z-max").unwrap()[0];
        let patch = Patch::of_facet(&mesh, facet);
        for (X, nearest, gap) in [
            ([0.3, 0.6, 1.2], [0.3, 0.6, 1.0], 0.2),
            ([0.3, 1.4, 1.3], [0.3, 1.0, 1.0], 0.5),
            ([2.0, 1.0, 1.0], [2.0, 1.0, 1.0], 0.0),
            ([-0.3, -0.4, 1.0], [0.0, 0.0, 1.0], 0.5),
        ] {
            let found = patch.nearest(X);
            close(&found, &mesh, nearest);
            assert!((found.distance - gap).abs() < 1e-12 && found.size == 2.0);
        }
        assert_eq!(patch.nearest([2.0, 1.0, 1.0]).weights.len(), 1);
        assert_eq!(patch.nearest([0.3, 1.4, 1.3]).weights.len(), 2);
    }

    /// The shape functions of every kind of cell reproduce a point of a distorted cell, and X outside is taken to its
    /// surface.
    #[test]
    fn every_kind_of_cell_has_its_points() {
        for kind in CellKind::ALL {
            let reference = element(kind).nodes();
            let bend = |[x, y, z]: [f64; 3]| match kind.dimension() {
                3 => [x + 0.1 * y * z, y + 0.05 * x * x, z + 0.1 * x],
                _ => [x + 0.05 * x * y, y, 0.0],
            };
            let mut builder = MeshBuilder::new();
            let nodes: Vec<u32> = reference.iter().map(|&xi| builder.point(bend(xi))).collect();
            builder.cell(kind, &nodes).unwrap();
            let mesh = builder.build().unwrap();
            let patch = Patch::of_cell(&mesh, 0);
            let n = kind.n_corners() as f64;
            let corners = &reference[..kind.n_corners()];
            let inner = [0, 1, 2].map(|d| corners.iter().map(|xi| xi[d]).sum::<f64>() / n + 0.05);
            let inner = if kind.dimension() == 1 { [inner[0], 0.0, 0.0] } else { inner };
            let mut N = vec![0.0; kind.n_nodes()];
            element(kind).shape(inner, &mut N);
            let X = combined(mesh.points(), &N);
            let found = patch.nearest(X);
            assert!(found.distance < 1e-12, "{kind} {found:?}");
            close(&found, &mesh, X);
            let far = [X[0] + 5.0, X[1], X[2]];
            let found = patch.nearest(far);
            let nearest_node = mesh.points().iter().map(|&X| distance(X, far)).fold(f64::INFINITY, f64::min);
            assert!(found.distance > 1.0 && found.distance <= nearest_node + 1e-12, "{kind}");
        }
    }
}
