//! Geometry tables: gradients of shape functions and weights at the quadrature points, integrals over cells and facets.

use crate::element::{Jacobians, ReferenceElement, element, facet_element, facet_tangents};
use crate::error::{Error, Result};
use crate::mesh::{Cell, CellKind, Facet, Mesh};
use crate::quadrature::Quadrature;
use crate::tensor::{Mat3, cross, det, inlined, mat3};

/// Cells of one kind with the geometry that the internal force needs.
#[derive(Debug, Clone)]
pub(crate) struct CellTable {
    /// Indices of the cells in the mesh.
    pub cells: Vec<u32>,
    /// Nodes, `[cell][n_nodes]`: those of the mesh, then the internal ones.
    pub nodes: Vec<u32>,
    /// Number of nodes of a cell.
    pub n_nodes: usize,
    /// Number of internal nodes among them.
    pub n_modes: usize,
    /// Gradients of the shape functions by the reference coordinates, `[point][n_nodes - n_modes]`.
    pub reference_gradients: Vec<[f64; 3]>,
    /// Gradients of the incompatible modes by the reference coordinates, `[cell][point][n_modes]`.
    pub mode_gradients: Vec<[f64; 3]>,
    /// dxi/dX, `[cell][point]` \[1/length\].
    pub inverse_jacobians: Vec<Mat3<f64>>,
    /// Weights times det(dX/dxi) and the thickness of plane cells, `[cell][point]` \[length^3\].
    pub weights: Vec<f64>,
}

impl CellTable {
    /// The table of some cells of a mesh, all of one kind; `section`: thickness of plane cells \[length\], 1 for
    /// solids.
    ///
    /// The cells are in the order of their first nodes, so that neighbours are close in memory.
    ///
    /// # Errors
    /// [`Error::InvertedCell`] if det(dX/dxi) is not positive at a point, [`Error::OutOfMemory`].
    pub(crate) fn new(mesh: &Mesh, kind: CellKind, mut cells: Vec<u32>, section: f64) -> Result<Self> {
        cells.sort_by_key(|&cell| mesh.cell(cell as usize).nodes.iter().min().copied());
        let reference = ReferenceTable::new(element(kind), element(kind).quadrature(), kind.n_nodes());
        let jacobians = Jacobians::new(kind, &reference.points);
        let n_points = reference.weights.len();
        let mut table = CellTable {
            nodes: reserved(cells.len() * kind.n_nodes())?,
            n_nodes: kind.n_nodes(),
            n_modes: 0,
            mode_gradients: Vec::new(),
            inverse_jacobians: reserved(cells.len() * n_points)?,
            weights: reserved(cells.len() * n_points)?,
            reference_gradients: reference.gradients.clone(),
            cells,
        };
        for &cell in &table.cells {
            let nodes = mesh.cell(cell as usize).nodes;
            let X = positions(mesh, nodes);
            table.nodes.extend_from_slice(nodes);
            for (jacobian, weight) in jacobians.of(&X).zip(&reference.weights) {
                let det = det(&jacobian);
                if det <= 0.0 || det.is_nan() {
                    return Err(Error::InvertedCell { cell: cell as usize, kind, det });
                }
                table.inverse_jacobians.push(inverse(&jacobian, det));
                table.weights.push(weight * det * section);
            }
        }
        Ok(table)
    }
}

/// An empty vector of a capacity, or an error if there is not enough memory.
pub(crate) fn reserved<T>(capacity: usize) -> Result<Vec<T>> {
    let mut vector = Vec::new();
    let bytes = capacity.saturating_mul(size_of::<T>());
    let out_of_memory = |_| Error::OutOfMemory { what: "the table of cells", gigabytes: bytes as f64 / 1e9 };
    vector.try_reserve_exact(capacity).map_err(out_of_memory)?;
    Ok(vector)
}

/// Shape functions and their gradients at the points of a quadrature.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceTable<const D: usize> {
    pub(crate) n_nodes: usize,
    shapes: Vec<f64>,
    gradients: Vec<[f64; D]>,
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) weights: Vec<f64>,
}

impl<const D: usize> ReferenceTable<D> {
    pub(crate) fn new(element: &dyn ReferenceElement<D>, quadrature: Quadrature<D>, n_nodes: usize) -> Self {
        let mut shapes = vec![0.0; quadrature.points.len() * n_nodes];
        let mut gradients = vec![[0.0; D]; quadrature.points.len() * n_nodes];
        for (point, &xi) in quadrature.points.iter().enumerate() {
            let nodes = point * n_nodes..(point + 1) * n_nodes;
            element.shape(xi, &mut shapes[nodes.clone()]);
            element.gradient(xi, &mut gradients[nodes]);
        }
        ReferenceTable { n_nodes, shapes, gradients, points: quadrature.points, weights: quadrature.weights }
    }

    pub(crate) fn gradients_at(&self, point: usize) -> &[[f64; D]] {
        &self.gradients[point * self.n_nodes..(point + 1) * self.n_nodes]
    }

    pub(crate) fn shapes(&self) -> &[f64] {
        &self.shapes
    }

    pub(crate) fn shapes_at(&self, point: usize) -> &[f64] {
        &self.shapes[point * self.n_nodes..(point + 1) * self.n_nodes]
    }
}

/// dxi/dX, `[xi component][X component]`.
#[inline(always)]
pub(crate) fn inverse(A: &Mat3<f64>, det: f64) -> Mat3<f64> {
    mat3(inlined!(|i: usize, j: usize| {
        let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        (A[j1][i1] * A[j2][i2] - A[j1][i2] * A[j2][i1]) / det
    }))
}

/// A point of an integral over a cell or facet: weight, position, and the shape functions of its nodes.
pub(crate) struct QuadraturePoint<'a> {
    /// Weight times det(dX/dxi), or times the area element \[length^3 or length^2\]; of plane cells \[length^2\],
    /// without their thickness.
    pub weight: f64,
    /// Reference position.
    pub position: [f64; 3],
    /// Shape functions N, `[n_nodes]`.
    pub shapes: &'a [f64],
}

/// Visits the points of some cells with the quadrature that integrates products of shape functions exactly.
pub(crate) fn for_each_volume_point(
    mesh: &Mesh,
    cells: impl Iterator<Item = u32>,
    visit: impl FnMut(usize, &[u32], QuadraturePoint<'_>),
) {
    for_each_mass_point(mesh, cells, MassKind::Consistent, visit);
}

/// How mass and body forces act on the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassKind {
    /// By the shape functions N_A.
    Consistent,
    /// By the functions whose integrals are the lumped masses; those of quadratic cells are no shape functions:
    ///
    /// ```math
    /// N_A^2 V / sum_B integral N_B^2 dV
    /// ```
    Lumped,
}

/// The same with the functions of a kind of mass in place of the shape functions. Not over `dyn FnMut`: positions that
/// a visitor does not use are not computed.
pub(crate) fn for_each_mass_point(
    mesh: &Mesh,
    cells: impl Iterator<Item = u32>,
    mass: MassKind,
    mut visit: impl FnMut(usize, &[u32], QuadraturePoint<'_>),
) {
    let mut scaled = Vec::new();
    for_each_cell(mesh, cells, |cell, X, table, weights| {
        let Cell { kind, nodes } = mesh.cell(cell);
        let is_scaled = mass == MassKind::Lumped && nodes.len() > kind.n_corners();
        let (mut volume, mut diagonal) = (0.0, 0.0);
        for (point, weight) in weights.iter().enumerate().filter(|_| is_scaled) {
            volume += weight;
            diagonal += weight * table.shapes_at(point).iter().map(|N| N * N).sum::<f64>();
        }
        for (point, &weight) in weights.iter().enumerate() {
            let mut shapes = table.shapes_at(point);
            let position = interpolated(X, shapes);
            if is_scaled {
                scaled.clear();
                scaled.extend(shapes.iter().map(|N| N * N * volume / diagonal));
                shapes = &scaled;
            }
            visit(cell, nodes, QuadraturePoint { weight, position, shapes });
        }
    });
}

/// Visits some cells with the positions of their nodes, and the quadrature of [`for_each_volume_point`]: shape
/// functions, and weights times det(dX/dxi).
pub(crate) fn for_each_cell(
    mesh: &Mesh,
    cells: impl Iterator<Item = u32>,
    mut visit: impl FnMut(usize, &[[f64; 3]], &ReferenceTable<3>, &[f64]),
) {
    let mut tables: [Option<(ReferenceTable<3>, Jacobians)>; CellKind::ALL.len()] = Default::default();
    let (mut X, mut weights) = (Vec::new(), Vec::new());
    for cell in cells {
        let Cell { kind, nodes } = mesh.cell(cell as usize);
        let (table, jacobians) = tables[kind as usize].get_or_insert_with(|| {
            let table = ReferenceTable::new(element(kind), element(kind).mass_quadrature(), kind.n_nodes());
            let jacobians = Jacobians::new(kind, &table.points);
            (table, jacobians)
        });
        X.clear();
        X.extend(nodes.iter().map(|&node| mesh.points()[node as usize]));
        jacobians.dets(&X, &mut weights);
        weights.iter_mut().zip(&table.weights).for_each(|(det, weight)| *det *= weight);
        visit(cell as usize, &X, table, &weights);
    }
}

/// Reference positions of some nodes.
pub(crate) fn positions(mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 3]> {
    nodes.iter().map(|&node| mesh.points()[node as usize]).collect()
}

fn interpolated(X: &[[f64; 3]], shapes: &[f64]) -> [f64; 3] {
    let mut position = [0.0; 3];
    for (X, N) in X.iter().zip(shapes) {
        (0..3).for_each(|i| position[i] += N * X[i]);
    }
    position
}

/// Integrals of the shape functions over facets, `integral N_A dA`, added to `areas: [n_nodes]`; `section`: thickness
/// of each cell, which turns the length of an edge into an area.
pub(crate) fn add_facet_areas(mesh: &Mesh, facets: &[Facet], section: &[f64], areas: &mut [f64]) {
    for_each_facet_point(mesh, facets, section, |nodes, point| {
        for (&node, N) in nodes.iter().zip(point.shapes) {
            areas[node as usize] += point.weight * N;
        }
    });
}

/// Visits the points of some facets with their quadrature; the weights are times the area element \[length^2\],
/// `section` as in [`add_facet_areas`].
pub(crate) fn for_each_facet_point(
    mesh: &Mesh,
    facets: &[Facet],
    section: &[f64],
    mut visit: impl FnMut(&[u32], QuadraturePoint<'_>),
) {
    for &facet in facets {
        let kind = mesh.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind;
        let table =
            ReferenceTable::new(facet_element(kind), facet_element(kind).quadrature(), kind.n_nodes());
        let nodes: Vec<u32> = mesh.facet_nodes(facet).collect();
        let X = positions(mesh, &nodes);
        for point in 0..table.weights.len() {
            let area = norm_of_product(facet_tangents(kind, &X, table.gradients_at(point)));
            let weight = table.weights[point] * area * section[facet.cell as usize];
            let shapes = table.shapes_at(point);
            let position = interpolated(&X, shapes);
            visit(&nodes, QuadraturePoint { weight, position, shapes });
        }
    }
}

/// Norm of the cross product of two vectors.
fn norm_of_product([a, b]: [[f64; 3]; 2]) -> f64 {
    cross(a, b).iter().map(|n| n * n).sum::<f64>().sqrt()
}
