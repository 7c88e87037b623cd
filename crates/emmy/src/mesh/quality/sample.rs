//! Points at which a cell is measured, and the measures there.

#![allow(non_snake_case)]

use std::collections::{BTreeMap, BTreeSet};

use crate::element::{CellShape, Jacobians, element};
use crate::mesh::CellKind;
use crate::tensor::{det, dot3, three};

/// Measures of one cell.
pub(super) struct Measures {
    pub smallest_det: f64,
    pub jacobian_ratio: f64,
    pub scaled_jacobian: f64,
    pub aspect_ratio: f64,
    pub volume: f64,
}

impl Measures {
    pub(super) fn is_inverted(&self) -> bool {
        self.smallest_det <= 0.0 || self.smallest_det.is_nan()
    }
}

/// Data shared by the cells of a kind: Jacobians at all sample points, and the edges.
pub(in crate::mesh) struct Sample {
    weights: Vec<f64>,
    kind: CellKind,
    /// Points of the mass quadrature, with the weights, then the other points of the internal force.
    at_quadrature: Jacobians,
    at_nodes: Jacobians,
    edges: Vec<[usize; 2]>,
    /// Corners, each with three of its neighbours in the order in which their edges span a positive volume.
    spans: Vec<[usize; 4]>,
    /// Product of the edge lengths at a corner divided by the volume that they span, in a cell with equal edges.
    ideal: f64,
}

/// The samples of all kinds.
pub(in crate::mesh) fn samples() -> BTreeMap<CellKind, Sample> {
    CellKind::ALL.into_iter().map(|kind| (kind, Sample::new(kind))).collect()
}

impl Sample {
    fn new(kind: CellKind) -> Self {
        let curved = element(kind);
        let mass = element(kind).mass_quadrature();
        let of_force = curved.quadrature().points.into_iter().filter(|point| !mass.points.contains(point));
        let points: Vec<_> = mass.points.iter().copied().chain(of_force).collect();
        Sample {
            kind,
            weights: mass.weights,
            at_quadrature: Jacobians::new(kind, &points),
            at_nodes: Jacobians::new(kind, curved.nodes()),
            edges: edges(kind),
            spans: spans(kind),
            ideal: ideal(kind),
        }
    }

    /// Whether det(dX/dxi) is negative at the first point of quadrature.
    pub(in crate::mesh) fn begins_negative(&self, X: &[[f64; 3]]) -> bool {
        self.at_quadrature.of(X).next().is_some_and(|J| det(&J) < 0.0)
    }

    /// Whether det(dX/dxi) is positive at all points of quadrature.
    pub(in crate::mesh) fn is_positive(&self, X: &[[f64; 3]]) -> bool {
        self.at_quadrature.of(X).all(|J| det(&J) > 0.0)
    }

    /// Measures of a cell by the positions of its nodes.
    pub(super) fn measures(&self, X: &[[f64; 3]]) -> Measures {
        let mut dets = Vec::new();
        self.at_quadrature.dets(X, &mut dets);
        let volume: f64 = self.weights.iter().zip(&dets).map(|(w, det)| w * det).sum();
        let mean = volume / self.weights.iter().sum::<f64>();
        let smallest_det = dets.iter().copied().reduce(smaller).unwrap_or(f64::NAN);
        self.at_nodes.dets(X, &mut dets);
        let lengths = self.edges.iter().map(|&[a, b]| length(three(|i| X[a][i] - X[b][i])));
        let both = lengths.map(|length| [length; 2]).reduce(|a, b| [smaller(a[0], b[0]), a[1].max(b[1])]);
        let [shortest, longest] = both.unwrap_or([f64::NAN; 2]);
        Measures {
            smallest_det,
            jacobian_ratio: dets.into_iter().fold(smallest_det, smaller) / mean.abs(),
            scaled_jacobian: self.scaled_jacobian(X),
            aspect_ratio: longest / shortest,
            volume,
        }
    }

    fn scaled_jacobian(&self, X: &[[f64; 3]]) -> f64 {
        if self.kind.dimension() == 1 {
            return 1.0;
        }
        let is_plane = self.kind.dimension() == 2;
        let scaled = |&[corner, a, b, c]: &[usize; 4]| {
            let edge = |end: usize| three(|i| X[end][i] - X[corner][i]);
            let edges = [edge(a), edge(b), if is_plane { [0.0, 0.0, 1.0] } else { edge(c) }];
            let product = length(edges[0]) * length(edges[1]) * length(edges[2]);
            // An edge of length zero spans no volume.
            if product == 0.0 { 0.0 } else { self.ideal * det(&edges) / product }
        };
        self.spans.iter().map(scaled).reduce(smaller).unwrap_or(f64::NAN)
    }
}

/// Product of the edge lengths at a corner divided by the volume that they span, in a cell with equal edges.
fn ideal(kind: CellKind) -> f64 {
    match kind.info().shape {
        CellShape::Tetrahedron | CellShape::Pyramid => 2f64.sqrt(),
        CellShape::Wedge | CellShape::Triangle => 2.0 / 3f64.sqrt(),
        CellShape::Hexahedron | CellShape::Quadrilateral | CellShape::Line => 1.0,
    }
}

/// Pairs of corners joined by an edge, without repetition.
fn edges(kind: CellKind) -> Vec<[usize; 2]> {
    if kind.dimension() == 1 {
        return vec![[0, 1]];
    }
    let mut edges = BTreeSet::new();
    for facet in kind.facets() {
        let corners = &facet.nodes[..facet.kind.n_corners()];
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            edges.insert([a.min(b), a.max(b)]);
        }
    }
    edges.into_iter().collect()
}

/// Corners with each three successive neighbours, anticlockwise as seen from outside; in a plane, with the next and the
/// previous corner, and the unit vector along z as third edge.
fn spans(kind: CellKind) -> Vec<[usize; 4]> {
    let mut spans = Vec::new();
    let n = kind.n_corners();
    if kind.dimension() == 1 {
        return spans;
    }
    if kind.dimension() == 2 {
        return (0..n).map(|corner| [corner, (corner + 1) % n, (corner + n - 1) % n, corner]).collect();
    }
    for corner in 0..kind.n_corners() {
        let around = neighbours(kind, corner);
        // The triples of three neighbours are one triple, rotated.
        let n = if around.len() == 3 { 1 } else { around.len() };
        let neighbour = |i: usize| around[i % around.len()];
        spans.extend((0..n).map(|i| [corner, neighbour(i), neighbour(i + 1), neighbour(i + 2)]));
    }
    spans
}

/// Corners joined to a corner by an edge, in the order of the faces around it.
fn neighbours(kind: CellKind, corner: usize) -> Vec<usize> {
    let mut following = BTreeMap::new();
    for facet in kind.facets() {
        let corners = facet.nodes;
        let n = facet.kind.n_corners();
        if let Some(at) = corners[..n].iter().position(|&node| node == corner) {
            following.insert(corners[(at + n - 1) % n], corners[(at + 1) % n]);
        }
    }
    let first = following.keys().next().copied();
    let around = std::iter::successors(first, |last| following.get(last).copied());
    around.take(following.len()).collect()
}

/// Smaller of two numbers; NaN if either is NaN.
fn smaller(a: f64, b: f64) -> f64 {
    crate::tensor::Lane::min(a, b)
}

fn length(a: [f64; 3]) -> f64 {
    dot3(a, a).sqrt()
}
