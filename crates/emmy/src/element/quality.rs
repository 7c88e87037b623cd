//! Quality of the cells of a mesh in the reference configuration.

use std::collections::{BTreeMap, BTreeSet};

use super::{ReferenceElement, element, jacobian};
use crate::error::{Error, Result};
use crate::mesh::{Cell, CellKind, Mesh};
use crate::tensor::det;

/// The worst value of a measure and the cell that has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// The value.
    pub value: f64,
    /// Index of the first cell with this value.
    pub cell: usize,
}

/// Quality of a mesh: the worst cell by each of three measures, the volume, the inverted cells.
///
/// ```
/// let mesh = emmy::mesh::block([2.0, 1.0, 1.0], [1, 1, 1])?;
/// let quality = emmy::element::quality(&mesh);
/// assert_eq!((quality.aspect_ratio.value, quality.volume), (2.0, 2.0));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Smallest det(dX/dxi) of a cell, at its quadrature points and nodes, by its mean over the cell: 1 for a
    /// parallelepiped, a straight tetrahedron, a pyramid over a parallelogram, less where faces are warped or curved, not
    /// positive where the map folds. (In a pyramid det is constant along a ray from the apex: the apex, where it has no
    /// single value, has those of the base; the one on the axis is taken.) In a plane det is that of the two coordinates.
    pub jacobian_ratio: Worst,
    /// Smallest volume spanned by the three edges at a corner, by the product of their lengths, relative to the cell with
    /// edges of one length (cube, regular tetrahedron, ...): 1 at best, near zero for a flat cell. At the apex of a
    /// pyramid every three successive ones of its four edges count; in a plane it is the area that two edges span. Source: Knupp (2000), IJNME 48, 1165-1185.
    pub scaled_jacobian: Worst,
    /// Largest quotient of the longest by the shortest edge of a cell (distance of the corners).
    pub aspect_ratio: Worst,
    /// Total volume \[length^3\]; of plane cells the area, of links the length.
    pub volume: f64,
    /// Cells whose det(dX/dxi) is not positive at one of their quadrature points, ascending.
    pub inverted: Vec<usize>,
}

/// Quality of the cells of a mesh, inverted ones included.
pub fn quality(mesh: &Mesh) -> Quality {
    let samples = samples();
    let measures: Vec<Measures> =
        mesh.cells().map(|cell| samples[&cell.kind].measures(&positions(mesh, cell))).collect();
    let smallest = |measure: fn(&Measures) -> f64| worst(measures.iter().map(measure), |a, b| a < b);
    let largest = |measure: fn(&Measures) -> f64| worst(measures.iter().map(measure), |a, b| a > b);
    Quality {
        jacobian_ratio: smallest(|measures| measures.jacobian_ratio),
        scaled_jacobian: smallest(|measures| measures.scaled_jacobian),
        aspect_ratio: largest(|measures| measures.aspect_ratio),
        volume: measures.iter().map(|measures| measures.volume).sum(),
        inverted: (0..measures.len()).filter(|&cell| measures[cell].is_inverted()).collect(),
    }
}

/// Checks that no cell is inverted or degenerate.
///
/// # Errors
/// [`Error::InvertedCell`] with the first cell whose det(dX/dxi) is not positive at one of its quadrature points.
///
/// ```
/// let mesh = emmy::mesh::l_block(1.0)?;
/// assert_eq!(emmy::element::check(&mesh), Ok(()));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn check(mesh: &Mesh) -> Result<()> {
    let samples = samples();
    for (index, cell) in mesh.cells().enumerate() {
        let measures = samples[&cell.kind].measures(&positions(mesh, cell));
        if measures.is_inverted() {
            return Err(Error::InvertedCell { cell: index, kind: cell.kind, det: measures.smallest_det });
        }
    }
    Ok(())
}

fn positions(mesh: &Mesh, cell: Cell) -> Vec<[f64; 3]> {
    cell.nodes.iter().map(|&node| mesh.points()[node as usize]).collect()
}

/// First value that is worse than all before it; NaN is the worst of all.
fn worst(values: impl Iterator<Item = f64>, is_worse: impl Fn(f64, f64) -> bool) -> Worst {
    let values = values.enumerate().map(|(cell, value)| Worst { value, cell });
    let is_worse = |b: f64, a: f64| is_worse(b, a) || (b.is_nan() && !a.is_nan());
    let worse = |a: Worst, b: Worst| if is_worse(b.value, a.value) { b } else { a };
    values.reduce(worse).expect("a mesh has cells")
}

/// Measures of one cell.
struct Measures {
    smallest_det: f64,
    jacobian_ratio: f64,
    scaled_jacobian: f64,
    aspect_ratio: f64,
    volume: f64,
}

impl Measures {
    fn is_inverted(&self) -> bool {
        self.smallest_det <= 0.0 || self.smallest_det.is_nan()
    }
}

/// What the cells of a kind share: gradients of the shape functions at all points that are looked at, and the edges.
struct Sample {
    weights: Vec<f64>,
    kind: CellKind,
    /// Points of the mass quadrature, which the weights belong to, then those of the internal force.
    at_quadrature: Vec<Vec<[f64; 3]>>,
    at_nodes: Vec<Vec<[f64; 3]>>,
    edges: Vec<[usize; 2]>,
    /// Corners, each with three of its neighbours in the order in which their edges span a positive volume.
    spans: Vec<[usize; 4]>,
    /// Product of the edge lengths at a corner by the volume that they span, in a cell with edges of one length.
    ideal: f64,
}

fn samples() -> BTreeMap<CellKind, Sample> {
    CellKind::ALL.into_iter().map(|kind| (kind, Sample::new(kind))).collect()
}

impl Sample {
    fn new(kind: CellKind) -> Self {
        let (curved, mass) = (element(kind), element(kind).mass_quadrature());
        let mut at_quadrature = gradients(curved, &mass.points);
        at_quadrature.extend(gradients(curved, &curved.quadrature().points));
        Sample {
            kind,
            weights: mass.weights,
            at_quadrature,
            at_nodes: gradients(curved, curved.nodes()),
            edges: edges(kind),
            spans: spans(kind),
            ideal: ideal(kind),
        }
    }

    fn measures(&self, X: &[[f64; 3]]) -> Measures {
        let dets: Vec<f64> = self.at_quadrature.iter().map(|dN| det(&jacobian(self.kind, X, dN))).collect();
        let volume: f64 = self.weights.iter().zip(&dets).map(|(w, det)| w * det).sum();
        let mean = volume / self.weights.iter().sum::<f64>();
        let smallest_det = dets.into_iter().reduce(smaller).unwrap_or(f64::NAN);
        let at_nodes = self.at_nodes.iter().map(|dN| det(&jacobian(self.kind, X, dN)));
        let lengths: Vec<f64> = self.edges.iter().map(|&[a, b]| distance(X[a], X[b])).collect();
        let (shortest, longest) =
            (lengths.iter().copied().reduce(smaller), lengths.iter().copied().reduce(f64::max));
        Measures {
            smallest_det,
            jacobian_ratio: at_nodes.fold(smallest_det, smaller) / mean.abs(),
            scaled_jacobian: self.scaled_jacobian(X),
            aspect_ratio: longest.unwrap_or(f64::NAN) / shortest.unwrap_or(f64::NAN),
            volume,
        }
    }

    fn scaled_jacobian(&self, X: &[[f64; 3]]) -> f64 {
        if self.kind.dimension() == 1 {
            return 1.0;
        }
        let is_plane = self.kind.dimension() == 2;
        let scaled = |&[corner, a, b, c]: &[usize; 4]| {
            let mut edges = [a, b, c].map(|end| [0, 1, 2].map(|i| X[end][i] - X[corner][i]));
            if is_plane {
                edges[2] = [0.0, 0.0, 1.0];
            }
            let product: f64 = edges.iter().map(|edge| distance(*edge, [0.0; 3])).product();
            // An edge of no length spans no volume.
            if product == 0.0 { 0.0 } else { self.ideal * det(&edges) / product }
        };
        self.spans.iter().map(scaled).reduce(smaller).unwrap_or(f64::NAN)
    }
}

/// Product of the edge lengths at a corner by the volume that they span, where all edges of a cell have one length.
fn ideal(kind: CellKind) -> f64 {
    match kind.linear() {
        CellKind::Tet4 | CellKind::Pyramid5 => 2f64.sqrt(),
        CellKind::Wedge6 | CellKind::Tri3 => 2.0 / 3f64.sqrt(),
        _ => 1.0,
    }
}

fn gradients(element: &dyn ReferenceElement<3>, points: &[[f64; 3]]) -> Vec<Vec<[f64; 3]>> {
    let at = |&xi: &[f64; 3]| {
        let mut dN = vec![[0.0; 3]; element.nodes().len()];
        element.gradient(xi, &mut dN);
        dN
    };
    points.iter().map(at).collect()
}

/// Pairs of corners that an edge joins, each once.
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

/// Corners with each three successive neighbours, anticlockwise as seen from outside; in a plane with the next corner and the
/// one before, the third edge being the unit vector along z.
fn spans(kind: CellKind) -> Vec<[usize; 4]> {
    let (mut spans, n) = (Vec::new(), kind.n_corners());
    if kind.dimension() == 1 {
        return spans;
    }
    if kind.dimension() == 2 {
        return (0..n).map(|corner| [corner, (corner + 1) % n, (corner + n - 1) % n, corner]).collect();
    }
    for corner in 0..kind.n_corners() {
        let around = neighbours(kind, corner);
        // The triples of three neighbours are one triple, turned.
        let n = if around.len() == 3 { 1 } else { around.len() };
        let neighbour = |i: usize| around[i % around.len()];
        spans.extend((0..n).map(|i| [corner, neighbour(i), neighbour(i + 1), neighbour(i + 2)]));
    }
    spans
}

/// Corners that are joined to a corner by an edge, in the order in which the faces around it follow each other.
fn neighbours(kind: CellKind, corner: usize) -> Vec<usize> {
    let mut following = BTreeMap::new();
    for facet in kind.facets() {
        let (corners, n) = (facet.nodes, facet.kind.n_corners());
        if let Some(at) = corners[..n].iter().position(|&node| node == corner) {
            following.insert(corners[(at + n - 1) % n], corners[(at + 1) % n]);
        }
    }
    let first = following.keys().next().copied();
    let around = std::iter::successors(first, |last| following.get(last).copied());
    around.take(following.len()).collect()
}

/// The smaller of two numbers, NaN if one of them is.
fn smaller(a: f64, b: f64) -> f64 {
    crate::tensor::Lane::min(a, b)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshBuilder, block};

    fn mesh_of(kind: CellKind, points: &[[f64; 3]]) -> Mesh {
        let mut builder = MeshBuilder::new();
        let nodes: Vec<u32> = points.iter().map(|&point| builder.point(point)).collect();
        builder.cell(kind, &nodes).unwrap();
        builder.build().unwrap()
    }

    /// Nodes of the unit cube.
    fn unit_cube(kind: CellKind) -> Vec<[f64; 3]> {
        element(kind).nodes().iter().map(|xi| xi.map(|x| 0.5 * (x + 1.0))).collect()
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-14, "{a} is not {b}");
    }

    #[test]
    fn a_block_of_equal_bricks_is_perfect_but_for_its_aspect() {
        let mesh = block([2.0, 2.0, 4.0], [2, 2, 2]).unwrap();
        let quality = quality(&mesh);
        near(quality.volume, 16.0);
        near(quality.jacobian_ratio.value, 1.0);
        near(quality.scaled_jacobian.value, 1.0);
        assert_eq!((quality.aspect_ratio, quality.inverted), (Worst { value: 2.0, cell: 0 }, vec![]));
        assert_eq!(check(&mesh), Ok(()));
    }

    /// Volume, scaled Jacobian and aspect ratio of the reference cell itself.
    fn reference(kind: CellKind) -> [f64; 3] {
        match kind.linear() {
            CellKind::Tet4 => [1.0 / 6.0, 0.5f64.sqrt(), 2f64.sqrt()],
            // Corner (1, 0): edges of lengths 1 and sqrt 2 span 1.
            CellKind::Tri3 => [0.5, 0.5f64.sqrt() * 2.0 / 3f64.sqrt(), 2f64.sqrt()],
            CellKind::Quad4 => [4.0, 1.0, 1.0],
            CellKind::Line2 => [2.0, 1.0, 1.0],
            // Corner (1, 0): edges of lengths 1, sqrt 2 and 2 span a prism of volume 2.
            CellKind::Wedge6 => [1.0, 0.5f64.sqrt() * 2.0 / 3f64.sqrt(), 2.0],
            // Corner of the base: edges of lengths 2, 2 and sqrt 3 span 4.
            CellKind::Pyramid5 => [4.0 / 3.0, (2.0f64 / 3.0).sqrt(), 2.0 / 3f64.sqrt()],
            _ => [8.0, 1.0, 1.0],
        }
    }

    #[test]
    fn undistorted_kinds_have_the_numbers_of_their_reference_cells() {
        for kind in CellKind::ALL {
            let quality = quality(&mesh_of(kind, element(kind).nodes()));
            let [volume, scaled_jacobian, aspect_ratio] = reference(kind);
            near(quality.volume, volume);
            near(quality.jacobian_ratio.value, 1.0);
            near(quality.scaled_jacobian.value, scaled_jacobian);
            near(quality.aspect_ratio.value, aspect_ratio);
        }
    }

    #[test]
    fn wedges_and_pyramids_with_edges_of_one_length_are_perfect() {
        let wedge = element(CellKind::Wedge6).nodes();
        let wedge: Vec<_> =
            wedge.iter().map(|&[x, y, z]| [x + 0.5 * y, 0.75f64.sqrt() * y, 0.5 * z]).collect();
        let pyramid = element(CellKind::Pyramid5).nodes();
        let pyramid: Vec<_> = pyramid.iter().map(|&[x, y, z]| [x, y, 2f64.sqrt() * z]).collect();
        for (kind, points) in [(CellKind::Wedge6, wedge), (CellKind::Pyramid5, pyramid)] {
            let quality = quality(&mesh_of(kind, &points));
            near(quality.scaled_jacobian.value, 1.0);
            near(quality.aspect_ratio.value, 1.0);
        }
    }

    #[test]
    fn a_steep_pyramid_is_bad_at_its_apex_and_a_flat_one_at_its_base() {
        // Height h over the base [-1, 1]^2: edges sqrt(2 + h^2); three span 4 h at the apex, 4 h at the base.
        let with_height = |h: f64| {
            let mut points = element(CellKind::Pyramid5).nodes().to_vec();
            points[4][2] = h;
            quality(&mesh_of(CellKind::Pyramid5, &points)).scaled_jacobian.value
        };
        near(with_height(10.0), 2f64.sqrt() * 40.0 / 102f64.powf(1.5));
        near(with_height(0.1), 2f64.sqrt() * 0.1 / 2.01f64.sqrt());
    }

    #[test]
    fn a_pyramid_folded_over_its_base_is_inverted() {
        // The apex below the base: det(dX/dxi) is minus its height everywhere.
        let mut points = element(CellKind::Pyramid5).nodes().to_vec();
        points[4][2] = -0.25;
        let mesh = mesh_of(CellKind::Pyramid5, &points);
        assert_eq!(check(&mesh), Err(Error::InvertedCell { cell: 0, kind: CellKind::Pyramid5, det: -0.25 }));
        // A corner of the base drawn beyond the diagonal between its neighbours.
        let mut points = element(CellKind::Pyramid5).nodes().to_vec();
        points[0] = [0.2, 0.2, 0.0];
        let folded = quality(&mesh_of(CellKind::Pyramid5, &points));
        assert!(folded.jacobian_ratio.value < 0.0 && folded.scaled_jacobian.value < 0.0);
    }

    #[test]
    fn a_wedge_with_its_ends_exchanged_is_inverted() {
        let nodes = element(CellKind::Wedge15).nodes();
        let mirrored: Vec<_> = nodes.iter().map(|&[x, y, z]| [x, y, -z]).collect();
        assert!(matches!(
            check(&mesh_of(CellKind::Wedge15, &mirrored)),
            Err(Error::InvertedCell { cell: 0, .. })
        ));
    }

    #[test]
    fn a_corner_pushed_in_gives_the_numbers_worked_out_by_hand() {
        // X = u - 0.2 u v w (1, 1, 1), so det = 1 - 0.2 (v w + u w + u v): 0.4 at the corner, 0.85 on average.
        let mut points = unit_cube(CellKind::Hex8);
        points[6] = [0.8; 3];
        let quality = quality(&mesh_of(CellKind::Hex8, &points));
        near(quality.volume, 0.85);
        near(quality.jacobian_ratio.value, 0.4 / 0.85);
        near(quality.scaled_jacobian.value, 0.4 / 0.72f64.powf(1.5));
        near(quality.aspect_ratio.value, 1.0 / 0.72f64.sqrt());
    }

    #[test]
    fn a_curved_edge_gives_the_numbers_worked_out_by_hand() {
        // X = xi + d N_4 with d = (0, 0, -0.1) and N_4 = 4 b_0 xi_1, so det = 1 + 0.4 xi_1.
        let mut points = element(CellKind::Tet10).nodes().to_vec();
        points[4][2] = -0.1;
        let quality = quality(&mesh_of(CellKind::Tet10, &points));
        near(quality.volume, 1.0 / 6.0 + 0.4 / 24.0);
        near(quality.jacobian_ratio.value, 1.0 / 1.1);
        near(quality.scaled_jacobian.value, 0.5f64.sqrt());
    }

    #[test]
    fn the_regular_tetrahedron_is_perfect_and_a_flat_one_is_not() {
        let regular = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];
        let best = quality(&mesh_of(CellKind::Tet4, &regular));
        near(best.scaled_jacobian.value, 1.0);
        near(best.aspect_ratio.value, 1.0);
        // Four corners of a square, two of them lifted by 1/100: all edges alike, but hardly any volume.
        let flat = [[0.0; 3], [1.0, 0.0, 0.01], [1.0, 1.0, 0.0], [0.0, 1.0, 0.01]];
        let sliver = quality(&mesh_of(CellKind::Tet4, &flat));
        assert!(sliver.scaled_jacobian.value.abs() < 0.03 && sliver.aspect_ratio.value < 1.5);
    }

    #[test]
    fn an_inverted_cell_is_named() {
        let mut builder = MeshBuilder::new();
        for point in element(CellKind::Tet4).nodes() {
            builder.point(*point);
        }
        builder.cell(CellKind::Tet4, &[0, 1, 2, 3]).unwrap();
        builder.cell(CellKind::Tet4, &[0, 2, 1, 3]).unwrap();
        let mesh = builder.build().unwrap();
        let expected = Error::InvertedCell { cell: 1, kind: CellKind::Tet4, det: -1.0 };
        assert_eq!(check(&mesh).unwrap_err(), expected);
        let quality = quality(&mesh);
        assert_eq!((quality.inverted, quality.jacobian_ratio), (vec![1], Worst { value: -1.0, cell: 1 }));
        assert_eq!(quality.volume, 0.0);
    }

    #[test]
    fn a_cell_without_volume_is_refused() {
        let mut points = unit_cube(CellKind::Hex8);
        points.iter_mut().for_each(|point| point[2] = 0.0);
        let mesh = mesh_of(CellKind::Hex8, &points);
        assert!(matches!(check(&mesh), Err(Error::InvertedCell { det: 0.0, .. })));
        assert_eq!(quality(&mesh).inverted, [0]);
    }

    #[test]
    fn a_wedge_made_of_a_hexahedron_is_allowed_but_bad() {
        let mut points = unit_cube(CellKind::Hex8);
        (points[3], points[7]) = (points[2], points[6]);
        let mesh = mesh_of(CellKind::Hex8, &points);
        let quality = quality(&mesh);
        assert_eq!(check(&mesh), Ok(()));
        near(quality.volume, 0.5);
        assert_eq!((quality.jacobian_ratio.value, quality.scaled_jacobian.value), (0.0, 0.0));
        assert_eq!(quality.aspect_ratio.value, f64::INFINITY);
    }

    #[test]
    fn a_corner_folded_inside_out_shows_at_the_node_before_it_does_inside() {
        // det = 1 - 0.5 (v w + u w + u v): -0.5 at the corner, but positive at all Gauss points (0.07 at the nearest).
        let mut points = unit_cube(CellKind::Hex8);
        points[6] = [0.5; 3];
        let mesh = mesh_of(CellKind::Hex8, &points);
        assert_eq!(check(&mesh), Ok(()));
        near(quality(&mesh).jacobian_ratio.value, -0.5 / 0.625);
    }
}
