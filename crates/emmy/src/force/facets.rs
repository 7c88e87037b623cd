//! Moving facets: force and stiffness of a pressure on their current surface.

use crate::element::facet_element;
use crate::mesh::{Facet, FacetKind, Mesh};
use crate::space::geometry::ReferenceTable;
use crate::sparse::Pattern;
use crate::tensor::cross;

/// Largest number of nodes of a facet.
const MAX_NODES: usize = 9;

/// A vector at each node of a facet.
pub(super) type NodalVectors = [[f64; 3]; MAX_NODES];

/// A vector for each pair A, B of a facet's nodes.
pub(super) type PairVectors = [NodalVectors; MAX_NODES];

/// Facets of one kind.
#[derive(Debug, Clone)]
pub(super) struct FacetTable {
    kind: FacetKind,
    /// Nodes, `[facet][n_nodes]`.
    pub nodes: Vec<u32>,
    /// Position in the pattern of every pair of nodes, `[facet][A][B]`.
    pub positions: Vec<u32>,
    /// Reference positions of the nodes.
    points: Vec<[f64; 3]>,
    /// Thickness of the plane cell of each facet; 1 for solids.
    sections: Vec<f64>,
    reference: ReferenceTable<2>,
    /// Second tangent of an edge, along z; zero for a surface, whose shape functions give both tangents.
    across: [f64; 3],
}

/// A facet of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct FacetOfTable<'a> {
    pub nodes: &'a [u32],
    /// Reference positions of the nodes.
    pub points: &'a [[f64; 3]],
    /// Position in the pattern of every pair of nodes, `[A][B]`.
    pub pairs: &'a [u32],
    /// Thickness.
    pub section: f64,
}

impl FacetTable {
    /// Tables of facets, one for each kind; `section`: thickness of each cell of the mesh.
    pub(super) fn of(mesh: &Mesh, pattern: &Pattern, facets: &[Facet], section: &[f64]) -> Vec<FacetTable> {
        let mut tables: Vec<FacetTable> = Vec::new();
        for &facet in facets {
            let kind = mesh.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind;
            let at = tables.iter().position(|table| table.kind == kind).unwrap_or_else(|| {
                tables.push(FacetTable::new(kind));
                tables.len() - 1
            });
            tables[at].push(mesh, pattern, mesh.facet_nodes(facet).collect(), section[facet.cell as usize]);
        }
        tables
    }

    fn new(kind: FacetKind) -> Self {
        let element = facet_element(kind);
        let reference = ReferenceTable::new(element, element.quadrature(), kind.n_nodes());
        let is_edge = matches!(kind, FacetKind::Line2 | FacetKind::Line3);
        let across = [0.0, 0.0, if is_edge { 1.0 } else { 0.0 }];
        let (nodes, positions, points, sections) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        FacetTable { kind, nodes, positions, points, sections, reference, across }
    }

    fn push(&mut self, mesh: &Mesh, pattern: &Pattern, nodes: Vec<u32>, section: f64) {
        for &row in &nodes {
            let position = |&column: &u32| pattern.position(row as usize, column as usize);
            self.positions.extend(nodes.iter().filter_map(position).map(|position| position as u32));
        }
        self.points.extend(nodes.iter().map(|&node| mesh.points()[node as usize]));
        self.nodes.extend(nodes);
        self.sections.push(section);
    }

    /// Kind of the facets.
    pub(super) fn kind(&self) -> FacetKind {
        self.kind
    }

    /// Shape functions, `[point][node]`.
    pub(super) fn shapes(&self) -> &[f64] {
        self.reference.shapes()
    }

    /// Number of nodes of a facet.
    pub(super) fn n_nodes(&self) -> usize {
        self.reference.n_nodes
    }

    /// Number of quadrature points of a facet.
    pub(super) fn n_points(&self) -> usize {
        self.reference.weights.len()
    }

    /// Reference areas of the quadrature points, `[facet][point]` \[length^2\].
    pub(super) fn areas(&self) -> Vec<f64> {
        let mut areas = Vec::with_capacity(self.sections.len() * self.n_points());
        for facet in self.facets() {
            let mut X = NodalVectors::default();
            X.iter_mut().zip(facet.points).for_each(|(own, X)| *own = *X);
            for point in 0..self.n_points() {
                let [a, b] = self.tangents(&X, point);
                let size = cross(a, b).iter().map(|n| n * n).sum::<f64>().sqrt();
                areas.push(facet.section * self.reference.weights[point] * size);
            }
        }
        areas
    }

    /// The facets.
    pub(super) fn facets(&self) -> impl Iterator<Item = FacetOfTable<'_>> {
        let n = self.n_nodes();
        let nodes = self.nodes.chunks_exact(n).zip(self.points.chunks_exact(n));
        let pairs = self.positions.chunks_exact(n * n).zip(&self.sections);
        nodes.zip(pairs).map(|((nodes, points), (pairs, &section))| FacetOfTable {
            nodes,
            points,
            pairs,
            section,
        })
    }

    /// Force of the unit pressure on a facet (of unit thickness) with nodes at `q`, which pushes against the outward
    /// normal:
    ///
    /// ```math
    /// F_A = - integral N_A (q_,xi x q_,eta) dxi deta
    /// ```
    ///
    /// The quadrature is exact for every kind of facet (see [`crate::element`]), so that on a closed surface
    /// `F_A = - dV/dq_A` with the enclosed volume V.
    pub(super) fn force(&self, q: &NodalVectors) -> NodalVectors {
        let mut force = [[0.0; 3]; MAX_NODES];
        for point in 0..self.reference.weights.len() {
            let [a, b] = self.tangents(q, point);
            let normal = cross(a, b).map(|n| -self.reference.weights[point] * n);
            for (force, N) in force.iter_mut().zip(self.reference.shapes_at(point)) {
                (0..3).for_each(|i| force[i] += N * normal[i]);
            }
        }
        force
    }

    /// Derivatives of [`FacetTable::force`]: `dF_A = sum_B c_AB x dq_B`.
    ///
    /// ```math
    /// c_AB = integral N_A (N_B,xi q_,eta - N_B,eta q_,xi) dxi deta
    /// ```
    pub(super) fn derivative(&self, q: &NodalVectors) -> PairVectors {
        let mut c = [[[0.0; 3]; MAX_NODES]; MAX_NODES];
        for point in 0..self.reference.weights.len() {
            let [a, b] = self.tangents(q, point);
            let weight = self.reference.weights[point];
            for (row, N) in c.iter_mut().zip(self.reference.shapes_at(point)) {
                for (c, dN) in row.iter_mut().zip(self.reference.gradients_at(point)) {
                    (0..3).for_each(|i| c[i] += weight * N * (dN[0] * b[i] - dN[1] * a[i]));
                }
            }
        }
        c
    }

    /// Tangents q_,xi and q_,eta at a quadrature point. Positions are taken from the first node: the gradients sum to
    /// zero, and a body far from the origin keeps its digits.
    fn tangents(&self, q: &NodalVectors, point: usize) -> [[f64; 3]; 2] {
        let mut a = [0.0; 3];
        let mut b = self.across;
        for (q_B, dN) in q.iter().zip(self.reference.gradients_at(point)) {
            for i in 0..3 {
                a[i] += (q_B[i] - q[0][i]) * dN[0];
                b[i] += (q_B[i] - q[0][i]) * dN[1];
            }
        }
        [a, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::facet_element;

    const KINDS: [FacetKind; 7] = [
        FacetKind::Line2,
        FacetKind::Line3,
        FacetKind::Tri3,
        FacetKind::Tri6,
        FacetKind::Quad4,
        FacetKind::Quad8,
        FacetKind::Quad9,
    ];

    /// A facet of a kind in the plane z = 0, moved by a quadratic field with `bend`.
    fn facet(kind: FacetKind, bend: f64) -> NodalVectors {
        let mut q = [[0.0; 3]; MAX_NODES];
        for (q, &[x, y]) in q.iter_mut().zip(facet_element(kind).nodes()) {
            *q = [x + bend * x * y, y - bend * x * x, bend * (x * x - 2.0 * x * y + 0.5 * y)];
        }
        q
    }

    #[test]
    fn flat_facets_are_pushed_down_with_pressure_times_area() {
        for &kind in &KINDS[2..] {
            let force = FacetTable::new(kind).force(&facet(kind, 0.0));
            let total = force.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]));
            let area = if matches!(kind, FacetKind::Tri3 | FacetKind::Tri6) { 0.5 } else { 4.0 };
            assert!((total[2] + area).abs() < 1e-14 && total[0] == 0.0 && total[1] == 0.0, "{kind:?}");
        }
    }

    /// The outward normal of an edge from (-1, 0) to (1, 0), the lower one of its cell, is -y.
    #[test]
    fn edges_are_pushed_inwards_with_pressure_times_length() {
        for &kind in &KINDS[..2] {
            let force = FacetTable::new(kind).force(&facet(kind, 0.0));
            let total = force.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]));
            assert!((total[1] - 2.0).abs() < 1e-14 && total[0] == 0.0 && total[2] == 0.0, "{kind:?}");
        }
    }

    /// The force is quadratic in q: its central difference equals its derivative for any step.
    #[test]
    fn derivative_matches_differences_of_the_force() {
        for kind in KINDS {
            let table = FacetTable::new(kind);
            let q = facet(kind, 0.3);
            let c = table.derivative(&q);
            for (B, i) in (0..kind.n_nodes()).flat_map(|B| (0..3).map(move |i| (B, i))) {
                let at = |step: f64| {
                    let mut q = q;
                    q[B][i] += step;
                    table.force(&q)
                };
                let plus = at(0.5);
                let minus = at(-0.5);
                let mut unit = [0.0; 3];
                unit[i] = 1.0;
                for A in 0..kind.n_nodes() {
                    let derivative = cross(c[A][B], unit);
                    for j in 0..3 {
                        assert!((plus[A][j] - minus[A][j] - derivative[j]).abs() < 1e-14, "{kind:?}");
                    }
                }
            }
        }
    }
}
