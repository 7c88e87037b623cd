//! Integrals over a batch of cells: stage forces, their derivatives, the stored energy. Everything here is inlined into the
//! functions that are dispatched by instruction set.

use std::any::Any;

use pulp::{Arch, Simd, WithSimd};

use super::batches::{CellBatches, PointGeometry};
use super::term::StepInput;
use crate::average::{Average, Want};
use crate::material::Material;
use crate::tensor::{
    Batch, LANES, Mat3, Packed, Register, Tangent, det_of_identity_plus, dot3, green_lagrange, inlined, mat3,
    three,
};

/// Working memory of an assembly, one for each part.
#[derive(Debug)]
pub struct Scratch {
    batch: BatchMemory,
    /// For links, which have a material each.
    numbers: PointMemory<f64>,
    /// [`PointMemory`] of the registers that the machine has.
    registers: Box<dyn Any + Send + Sync>,
}

/// Fields and results of a batch.
#[derive(Debug)]
pub struct BatchMemory {
    /// Nodal displacement and rates, or what the rule sees of them, `[1 + k][n_nodes][3]`.
    pub(super) nodal: Vec<[Packed; 3]>,
    /// Weighted stresses in reference coordinates, `w P J^-T`, `[k][point][3][3]`.
    pub(super) stress: Vec<[[Packed; 3]; 3]>,
    /// Gradients of the shape functions at a point, `[n_nodes][3]`.
    pub(super) gradients: Vec<[Packed; 3]>,
    /// Stage forces, `[k][n_nodes][3]`.
    pub force: Vec<[Packed; 3]>,
    /// Stage derivatives, `[k k][A][B][3 i + k]`; B >= A only where they are symmetric.
    pub stiffness: Vec<[Packed; 9]>,
    /// Smallest determinant that the rule met.
    pub min_det: Packed,
}

/// What a rule works on at a point.
#[derive(Debug)]
pub struct PointMemory<R> {
    pub(super) average: Average<R>,
    pub(super) rates: Vec<Mat3<R>>,
}

impl<R: Register> PointMemory<R> {
    fn new(degree: usize, zero: R) -> Self {
        PointMemory { average: Average::new(degree, zero), rates: vec![[[zero; 3]; 3]; degree] }
    }
}

/// Makes the memory of a degree for the registers that the machine has.
struct NewPointMemory(usize);

impl WithSimd for NewPointMemory {
    type Output = Box<dyn Any + Send + Sync>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        Box::new(PointMemory::new(self.0, Batch::new(simd, 0.0)))
    }
}

impl Scratch {
    /// Memory for time elements of a degree and cells with up to so many nodes and quadrature points.
    pub fn new(degree: usize, n_nodes: usize, n_points: usize) -> Self {
        let zero = Packed([0.0; LANES]);
        let batch = BatchMemory {
            nodal: vec![[zero; 3]; (degree + 1) * n_nodes],
            stress: vec![[[zero; 3]; 3]; degree * n_points],
            gradients: vec![[zero; 3]; n_nodes],
            force: vec![[zero; 3]; degree * n_nodes],
            stiffness: vec![[zero; 9]; degree * degree * n_nodes * n_nodes],
            min_det: zero,
        };
        let registers = Arch::new().dispatch(NewPointMemory(degree));
        Scratch { batch, numbers: PointMemory::new(degree, 0.0), registers }
    }

    /// The memory for points that are taken one by one.
    #[inline(always)]
    pub fn numbers(&mut self) -> (&mut BatchMemory, &mut PointMemory<f64>) {
        (&mut self.batch, &mut self.numbers)
    }

    /// The memory for registers.
    #[inline(always)]
    pub fn registers<R: Register>(&mut self) -> (&mut BatchMemory, &mut PointMemory<R>) {
        let registers = self.registers.downcast_mut();
        (&mut self.batch, registers.expect("the instruction set of a machine does not change"))
    }
}

/// Copies what the rule sees of a step to the nodes of a batch; the number of fields. `wants_rates`: even if the rule does not need
/// them.
#[inline(always)]
pub fn gather(
    cells: &CellBatches,
    batch: usize,
    step: &StepInput<'_>,
    wants_rates: bool,
    memory: &mut BatchMemory,
) -> usize {
    let (n, stride, u) = (cells.n_nodes, step.displacement.len(), step.displacement.as_chunks().0);
    if let Some(passed) = step.rule.only_point().filter(|_| !wants_rates) {
        cells.gather(
            batch,
            &mut memory.nodal[..n],
            #[inline(always)]
            |node| {
                let mut value = u[node];
                for (passed, rates) in passed.iter().zip(step.rates.chunks_exact(stride)) {
                    let rate = rates.as_chunks::<3>().0[node];
                    value = [0, 1, 2].map(|i| value[i] + passed * rate[i]);
                }
                value
            },
        );
        return 1;
    }
    let k = step.rule.degree();
    cells.gather(
        batch,
        &mut memory.nodal[..n],
        #[inline(always)]
        |node| u[node],
    );
    for (j, rates) in step.rates.chunks_exact(stride).take(k).enumerate() {
        let rates = rates.as_chunks().0;
        cells.gather(
            batch,
            &mut memory.nodal[(j + 1) * n..(j + 2) * n],
            #[inline(always)]
            |node| rates[node],
        );
    }
    1 + k
}

/// Stage forces (and derivatives) of part `part` of a batch, from the nodal fields in its memory.
#[inline(always)]
pub fn integrate<R: Register, M: Material>(
    (cells, batch, part): (&CellBatches, usize, usize),
    n_fields: usize,
    (material, is_damped): (&M, bool),
    step: &StepInput<'_>,
    want: Want,
    (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
) {
    let (n, k, n_points) = (cells.n_nodes, step.rule.degree(), cells.n_points);
    let PointMemory { average, rates } = point_memory;
    let zero = average.min_det.splat(0.0);
    let mut min_det = zero.splat(f64::INFINITY);
    for (point, geometry) in cells.geometry_of(batch).iter().enumerate() {
        let (dN, inverse) = (cells.reference_gradients_at(point), inverse_jacobian(zero, geometry, part));
        let start = field_gradient(zero, &memory.nodal[..n], dN, &inverse, part);
        for j in 1..n_fields {
            rates[j - 1] = field_gradient(zero, &memory.nodal[j * n..(j + 1) * n], dN, &inverse, part);
        }
        step.rule.average(material, &start, &rates[..n_fields - 1], want, average);
        min_det = min_det.min(average.min_det);
        let weight = zero.load(&geometry.weight, part);
        for i in 0..k {
            let (P, stress) = (&average.stress[i], &mut memory.stress[i * n_points + point]);
            for r in 0..3 {
                for m in 0..3 {
                    (dot3(P[r], inverse[m]) * weight).store(&mut stress[r][m], part);
                }
            }
        }
        if want == Want::Tangent {
            let factor = weight * step.tangent_factor;
            set_gradients(zero, dN, &inverse, &mut memory.gradients[..n], part);
            let blocks = memory.stiffness.chunks_exact_mut(n * n);
            for (tangent, stiffness) in average.tangent.iter().zip(blocks) {
                let (gradients, is_first) = (&memory.gradients[..n], point == 0);
                let skips = step.rule.is_symmetric(is_damped);
                add_stiffness(tangent, gradients, factor, (is_first, skips), stiffness, part);
            }
        }
    }
    min_det.store(&mut memory.min_det, part);
    for i in 0..k {
        let stress = &memory.stress[i * n_points..(i + 1) * n_points];
        set_force(zero, cells, stress, &mut memory.force[i * n..(i + 1) * n], part);
    }
}

/// Stored energy of part `part` of a batch at a nodal displacement, and the smallest det F.
#[inline(always)]
pub fn strained<R: Register, M: Material>(
    zero: R,
    (cells, batch, part): (&CellBatches, usize, usize),
    material: &M,
    nodal: &[[Packed; 3]],
) -> (R, R) {
    let (mut energy, mut min_det) = (zero, zero.splat(f64::INFINITY));
    for (point, geometry) in cells.geometry_of(batch).iter().enumerate() {
        let (dN, inverse) = (cells.reference_gradients_at(point), inverse_jacobian(zero, geometry, part));
        let G = field_gradient(zero, nodal, dN, &inverse, part);
        let W = material.strain_energy(&green_lagrange(&G));
        energy = W.mul_add(zero.load(&geometry.weight, part), energy);
        min_det = min_det.min(det_of_identity_plus(&G));
    }
    (energy, min_det)
}

#[inline(always)]
pub(super) fn inverse_jacobian<R: Register>(zero: R, geometry: &PointGeometry, part: usize) -> Mat3<R> {
    mat3(
        #[inline(always)]
        |i, j| zero.load(&geometry.inverse_jacobian[i][j], part),
    )
}

#[inline(always)]
fn vector<R: Register>(zero: R, from: &[Packed; 3], part: usize) -> [R; 3] {
    [zero.load(&from[0], part), zero.load(&from[1], part), zero.load(&from[2], part)]
}

/// `(sum_A u_A (x) dN_A/dxi) dxi/dX` of a nodal field.
#[inline(always)]
pub(super) fn field_gradient<R: Register>(
    zero: R,
    field: &[[Packed; 3]],
    dN: &[[f64; 3]],
    inverse: &Mat3<R>,
    part: usize,
) -> Mat3<R> {
    let mut H = [[zero; 3]; 3];
    for (u, dN) in field.iter().zip(dN) {
        let u = vector(zero, u, part);
        for m in 0..3 {
            let dN = zero.splat(dN[m]);
            (0..3).for_each(
                #[inline(always)]
                |i| H[i][m] = u[i].mul_add(dN, H[i][m]),
            );
        }
    }
    let column = inlined!(|J: usize| [inverse[0][J], inverse[1][J], inverse[2][J]]);
    mat3(
        #[inline(always)]
        |i, J| dot3(H[i], column(J)),
    )
}

/// Gradients of the shape functions, `dN_A/dxi dxi/dX`.
#[inline(always)]
pub(super) fn set_gradients<R: Register>(
    zero: R,
    dN: &[[f64; 3]],
    inverse: &Mat3<R>,
    gradients: &mut [[Packed; 3]],
    part: usize,
) {
    for (dN, gradient) in dN.iter().zip(gradients) {
        let dN = [zero.splat(dN[0]), zero.splat(dN[1]), zero.splat(dN[2])];
        for J in 0..3 {
            dot3(dN, [inverse[0][J], inverse[1][J], inverse[2][J]]).store(&mut gradient[J], part);
        }
    }
}

/// Nodes whose forces are summed in registers at the same time.
const BLOCK: usize = 4;

/// Forces of one stage, `f_A = sum_points (w P J^-T) dN_A/dxi`.
#[inline(always)]
pub(super) fn set_force<R: Register>(
    zero: R,
    cells: &CellBatches,
    stress: &[[[Packed; 3]; 3]],
    force: &mut [[Packed; 3]],
    part: usize,
) {
    let whole = force.len() / BLOCK * BLOCK;
    for first in (0..whole).step_by(BLOCK) {
        set_forces::<R, BLOCK>(zero, cells, stress, first, force, part);
    }
    for first in whole..force.len() {
        set_forces::<R, 1>(zero, cells, stress, first, force, part);
    }
}

/// Forces of the nodes `first..first + N`.
#[inline(always)]
fn set_forces<R: Register, const N: usize>(
    zero: R,
    cells: &CellBatches,
    stress: &[[[Packed; 3]; 3]],
    first: usize,
    force: &mut [[Packed; 3]],
    part: usize,
) {
    let mut sums = [[zero; 3]; N];
    for (point, stress) in stress.iter().enumerate() {
        let dN = &cells.reference_gradients_at(point)[first..first + N];
        for m in 0..3 {
            let column = three(
                #[inline(always)]
                |i| zero.load(&stress[i][m], part),
            );
            for A in 0..N {
                let dN = zero.splat(dN[A][m]);
                (0..3).for_each(
                    #[inline(always)]
                    |i| sums[A][i] = column[i].mul_add(dN, sums[A][i]),
                );
            }
        }
    }
    for (force, sum) in force[first..first + N].iter_mut().zip(sums) {
        (0..3).for_each(
            #[inline(always)]
            |i| sum[i].store(&mut force[i], part),
        );
    }
}

/// Adds `w grad N_A . dP/dF . grad N_B` to the cells' stiffness, `[A][B][3 i + k]`; `is_first`: sets it instead; `skips`: leaves
/// B < A out.
#[inline(always)]
pub(super) fn add_stiffness<R: Register>(
    tangent: &Tangent<R>,
    gradients: &[[Packed; 3]],
    weight: R,
    (is_first, skips): (bool, bool),
    stiffness: &mut [[Packed; 9]],
    part: usize,
) {
    let (n, zero) = (gradients.len(), weight.splat(0.0));
    for A in 0..n {
        let g = vector(zero, &gradients[A], part);
        let g = [g[0] * weight, g[1] * weight, g[2] * weight];
        // [i][k][L]
        let mut row = [[[zero; 3]; 3]; 3];
        for i in 0..3 {
            for c in 0..9 {
                row[i][c / 3][c % 3] =
                    dot3(g, [tangent[3 * i][c], tangent[3 * i + 1][c], tangent[3 * i + 2][c]]);
            }
        }
        let first = if skips { A } else { 0 };
        let blocks = &mut stiffness[A * n + first..(A + 1) * n];
        for (block, gradient) in blocks.iter_mut().zip(&gradients[first..]) {
            let gradient = vector(zero, gradient, part);
            for entry in 0..9 {
                let row = &row[entry / 3][entry % 3];
                let old = if is_first { zero } else { zero.load(&block[entry], part) };
                let sum = row[0].mul_add(gradient[0], old);
                let sum = row[2].mul_add(gradient[2], row[1].mul_add(gradient[1], sum));
                sum.store(&mut block[entry], part);
            }
        }
    }
}
