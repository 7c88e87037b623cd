//! Cells of one kind and one material (of links, one law): the assembly that every scheme, material and element shares.

use std::fmt;
use std::ops::Range;

use super::geometry::CellTable;
use super::term::{StepInput, Term};
use crate::average::{Average, Want};
use crate::error::{Error, Result};
use crate::material::Material;
use crate::sparse::{Pattern, RowPart};
use crate::tensor::{Mat3, Tangent, green_lagrange, mat3};

/// Cells of one kind and one material.
pub struct SolidTerm<M> {
    /// One for all cells, or one for each.
    materials: Vec<M>,
    table: CellTable,
    /// Position in the pattern of every pair of nodes, `[cell][A][B]`.
    positions: Vec<u32>,
    /// Cells (of the table) that touch each part's rows, ascending.
    parts: Vec<Vec<u32>>,
}

impl<M> fmt::Debug for SolidTerm<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SolidTerm<{}>({} cells)", std::any::type_name::<M>(), self.table.cells.len())
    }
}

/// Working memory of an assembly, one for each part.
#[derive(Debug, Clone)]
pub struct Scratch {
    average: Average<f64>,
    rates: Vec<Mat3<f64>>,
    /// Nodal displacement and rates of a cell, `[1 + k][3][n_nodes]`.
    nodal: Vec<f64>,
    /// Stage forces of a cell, `[k][3][n_nodes]`.
    force: Vec<f64>,
    /// Stage derivatives of a cell, `[k k][A][3][3][B]`.
    stiffness: Vec<f64>,
}

impl Scratch {
    /// Memory for time elements of a degree and cells with up to `n_nodes` nodes.
    pub fn new(degree: usize, n_nodes: usize) -> Self {
        Scratch {
            average: Average::new(degree, 0.0),
            rates: vec![[[0.0; 3]; 3]; degree],
            nodal: vec![0.0; (degree + 1) * 3 * n_nodes],
            force: vec![0.0; degree * 3 * n_nodes],
            stiffness: vec![0.0; degree * degree * 9 * n_nodes * n_nodes],
        }
    }
}

impl<M: Material> SolidTerm<M> {
    /// The term of a table of cells.
    pub fn new(material: M, table: CellTable) -> Self {
        SolidTerm::with_materials(vec![material], table)
    }

    /// The term of a table of cells with a material for each.
    pub fn with_materials(materials: Vec<M>, table: CellTable) -> Self {
        SolidTerm { materials, table, positions: Vec::new(), parts: Vec::new() }
    }

    fn material(&self, cell: usize) -> &M {
        &self.materials[if self.materials.len() == 1 { 0 } else { cell }]
    }

    fn nodes(&self, cell: usize) -> &[u32] {
        &self.table.nodes[cell * self.table.n_nodes..(cell + 1) * self.table.n_nodes]
    }

    /// Gradients of the shape functions at a point, `[3][n_nodes]`, and the weight.
    fn point(&self, cell: usize, point: usize) -> (&[f64], f64) {
        let (n, at) = (self.table.n_nodes, cell * self.table.n_points + point);
        (&self.table.gradients[3 * n * at..3 * n * (at + 1)], self.table.weights[at])
    }

    /// Stage forces and derivatives of a cell, into the scratch memory.
    fn integrate(&self, cell: usize, step: &StepInput<'_>, want: Want, scratch: &mut Scratch) -> Result<()> {
        let (n, k) = (self.table.n_nodes, step.rule.degree());
        gather(self.nodes(cell), step, k, &mut scratch.nodal);
        scratch.force[..k * 3 * n].fill(0.0);
        if want == Want::Tangent {
            scratch.stiffness[..k * k * 9 * n * n].fill(0.0);
        }
        for point in 0..self.table.n_points {
            let (gradients, weight) = self.point(cell, point);
            let start = nodal_gradient(&scratch.nodal[..3 * n], gradients, n);
            for (j, rate) in scratch.rates.iter_mut().enumerate() {
                *rate = nodal_gradient(&scratch.nodal[(j + 1) * 3 * n..(j + 2) * 3 * n], gradients, n);
            }
            step.rule.average(self.material(cell), &start, &scratch.rates, want, &mut scratch.average);
            let det = scratch.average.min_det;
            if !M::IS_LINK && (det <= 0.0 || det.is_nan()) {
                return Err(Error::Inverted { cell: self.table.cells[cell] as usize, det });
            }
            for (stress, force) in scratch.average.stress.iter().zip(scratch.force.chunks_exact_mut(3 * n)) {
                add_force(stress, gradients, weight, n, force);
            }
            if want == Want::Tangent {
                let factor = weight * step.tangent_factor;
                let blocks = scratch.stiffness.chunks_exact_mut(9 * n * n);
                for (tangent, stiffness) in scratch.average.tangent.iter().zip(blocks) {
                    add_stiffness(tangent, gradients, factor, n, stiffness);
                }
            }
        }
        Ok(())
    }

    /// Writes the rows of a cell that a part owns.
    fn scatter(&self, cell: usize, k: usize, want: Want, scratch: &Scratch, sink: &mut RowPart) {
        let n = self.table.n_nodes;
        for (A, &node) in self.nodes(cell).iter().enumerate() {
            if !sink.owns(node) {
                continue;
            }
            for stage in 0..k {
                let force = |i: usize| scratch.force[(3 * stage + i) * n + A];
                sink.add_force(stage, node, [force(0), force(1), force(2)]);
            }
            if want == Want::Stress {
                continue;
            }
            let positions = &self.positions[(cell * n + A) * n..(cell * n + A + 1) * n];
            for stages in 0..k * k {
                let rows = &scratch.stiffness[(stages * n + A) * 9 * n..(stages * n + A + 1) * 9 * n];
                for (B, &position) in positions.iter().enumerate() {
                    let block = sink.block_mut(position as usize, stages);
                    block.iter_mut().enumerate().for_each(|(entry, value)| *value += rows[entry * n + B]);
                }
            }
        }
    }
}

impl<M: Material> Term for SolidTerm<M> {
    fn couplings(&self) -> (&[u32], usize) {
        (&self.table.nodes, self.table.n_nodes)
    }

    fn attach(&mut self, pattern: &Pattern, parts: &[Range<usize>]) {
        let n = self.table.n_nodes;
        self.positions = Vec::with_capacity(self.table.nodes.len() * n);
        for nodes in self.table.nodes.chunks_exact(n) {
            for &row in nodes {
                let position = |&column: &u32| pattern.position(row as usize, column as usize);
                self.positions.extend(nodes.iter().filter_map(position).map(|position| position as u32));
            }
        }
        let touches = |cell: &usize, rows: &Range<usize>| {
            self.nodes(*cell).iter().any(|&node| rows.contains(&(node as usize)))
        };
        let cells = 0..self.table.cells.len();
        self.parts = parts
            .iter()
            .map(|rows| cells.clone().filter(|cell| touches(cell, rows)).map(|cell| cell as u32).collect())
            .collect();
    }

    fn assemble(
        &self,
        step: &StepInput<'_>,
        want: Want,
        part: usize,
        scratch: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        for &cell in &self.parts[part] {
            self.integrate(cell as usize, step, want, scratch)?;
            self.scatter(cell as usize, step.rule.degree(), want, scratch, sink);
        }
        Ok(())
    }

    fn strain_energy(&self, displacement: &[f64]) -> f64 {
        let n = self.table.n_nodes;
        let cell_energy = |cell: usize| -> f64 {
            let energies = (0..self.table.n_points).map(|point| {
                let (gradients, weight) = self.point(cell, point);
                let mut G = [[0.0; 3]; 3];
                for (A, &node) in self.nodes(cell).iter().enumerate() {
                    let u = &displacement[3 * node as usize..3 * node as usize + 3];
                    (0..3).for_each(|i| (0..3).for_each(|J| G[i][J] += u[i] * gradients[J * n + A]));
                }
                weight * self.material(cell).strain_energy(&green_lagrange(&G))
            });
            energies.sum()
        };
        (0..self.table.cells.len()).map(cell_energy).sum()
    }
}

/// Copies displacement and rates of a cell's nodes to `nodal: [1 + k][3][n_nodes]`.
fn gather(nodes: &[u32], step: &StepInput<'_>, k: usize, nodal: &mut [f64]) {
    let (n, stride) = (nodes.len(), step.displacement.len());
    for (A, &node) in nodes.iter().enumerate() {
        for i in 0..3 {
            nodal[i * n + A] = step.displacement[3 * node as usize + i];
            for j in 0..k {
                nodal[((j + 1) * 3 + i) * n + A] = step.rates[j * stride + 3 * node as usize + i];
            }
        }
    }
}

/// `sum_A u_A (x) grad N_A` of a nodal field `[3][n_nodes]`.
#[inline(always)]
fn nodal_gradient(field: &[f64], gradients: &[f64], n: usize) -> Mat3<f64> {
    let component = |i: usize, J: usize| {
        let (u, g) = (&field[i * n..(i + 1) * n], &gradients[J * n..(J + 1) * n]);
        u.iter().zip(g).map(|(u, g)| u * g).sum()
    };
    mat3(component)
}

/// Adds `w P grad N_A` to the cell's force, `[3][n_nodes]`.
#[inline(always)]
fn add_force(P: &Mat3<f64>, gradients: &[f64], weight: f64, n: usize, force: &mut [f64]) {
    for i in 0..3 {
        let p = [P[i][0] * weight, P[i][1] * weight, P[i][2] * weight];
        let force = &mut force[i * n..(i + 1) * n];
        for A in 0..n {
            force[A] += p[0] * gradients[A] + p[1] * gradients[n + A] + p[2] * gradients[2 * n + A];
        }
    }
}

/// Adds `w grad N_A . dP/dF . grad N_B` to the cell's stiffness, `[A][3][3][B]`: the innermost loop runs over B, contiguous.
#[inline(always)]
fn add_stiffness(tangent: &Tangent<f64>, gradients: &[f64], weight: f64, n: usize, stiffness: &mut [f64]) {
    let (g0, rest) = gradients.split_at(n);
    let (g1, g2) = rest.split_at(n);
    for A in 0..n {
        let g = [weight * g0[A], weight * g1[A], weight * g2[A]];
        for i in 0..3 {
            let mut row = [0.0; 9];
            for c in 0..9 {
                row[c] =
                    g[0] * tangent[3 * i][c] + g[1] * tangent[3 * i + 1][c] + g[2] * tangent[3 * i + 2][c];
            }
            for k in 0..3 {
                let at = ((A * 3 + i) * 3 + k) * n;
                let values = &mut stiffness[at..at + n];
                let d = [row[3 * k], row[3 * k + 1], row[3 * k + 2]];
                for (B, value) in values.iter_mut().enumerate() {
                    *value += d[0] * g0[B] + d[1] * g1[B] + d[2] * g2[B];
                }
            }
        }
    }
}
