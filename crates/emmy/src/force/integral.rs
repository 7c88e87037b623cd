//! Integrals over a batch of cells: stage forces, their derivatives, the stored energy. Everything here is inlined into
//! the functions that are dispatched by instruction set.

mod memory;
mod modes;
pub(crate) mod projected;

pub(crate) use memory::{BatchMemory, PointMemory, Scratch};

use super::batches::CellBatches;
use super::step::StepInput;
use crate::average::{Average, Damping, Request, Rule, VolumeDamping};
use crate::material::Response;
use crate::tensor::{
    Mat3, Packed, Register, Tangent, det_of_identity_plus, dot3, green_lagrange, inlined, mat3, three,
};

/// Copies the displacement and rates of a step to the nodes of a batch, `nodal: [1 + k][n_nodes][3]`, and returns the
/// number of fields: 1 if the rule has a single point and the rates are not wanted.
#[inline(always)]
pub(crate) fn gather(
    cells: &CellBatches,
    batch: usize,
    step: &StepInput<'_>,
    wants_rates: bool,
    nodal: &mut [[Packed; 3]],
) -> usize {
    let n = cells.n_nodes;
    let stride = step.displacement.len();
    let u = step.displacement.as_chunks().0;
    if let Some(integrals) = step.rule.only_point().filter(|_| !wants_rates) {
        cells.gather(
            batch,
            &mut nodal[..n],
            #[inline(always)]
            |node| {
                let mut value = u[node];
                for (L_j, rates) in integrals.iter().zip(step.rates.chunks_exact(stride)) {
                    let rate = rates.as_chunks::<3>().0[node];
                    value = [0, 1, 2].map(|i| value[i] + L_j * rate[i]);
                }
                value
            },
        );
        return 1;
    }
    let fields = std::iter::once(step.displacement).chain(step.rates.chunks_exact(stride));
    let n_fields = 1 + step.rule.degree();
    for (field, nodal) in fields.zip(nodal.chunks_exact_mut(n)).take(n_fields) {
        let field = field.as_chunks().0;
        cells.gather(
            batch,
            nodal,
            #[inline(always)]
            |node| field[node],
        );
    }
    n_fields
}

/// The cells of a batch that share a register.
#[derive(Clone, Copy)]
pub(crate) struct RegisterCells<'a, R> {
    pub cells: &'a CellBatches,
    pub batch: usize,
    /// Number of this part of the batch.
    pub part: usize,
    pub zero: R,
}

impl<R: Register> RegisterCells<'_, R> {
    /// Gradients of nodal fields at a quadrature point, `nodal: [n_fields][n_nodes][3]`: displacement gradients of
    /// displacements.
    ///
    /// ```math
    /// (sum_A u_A (x) dN_A/dxi) dxi/dX
    /// ```
    #[inline(always)]
    pub(crate) fn set_field_gradients(&self, point: usize, nodal: &[[Packed; 3]], gradients: &mut [Mat3<R>]) {
        let dN = self.cells.reference_gradients_at(point);
        let modes = self.cells.mode_gradients_at(self.batch, point);
        let inverse = self.inverse_jacobian(point);
        for (gradient, field) in gradients.iter_mut().zip(nodal.chunks_exact(self.cells.n_nodes)) {
            *gradient = self.field_gradient(field, (dN, modes), &inverse);
        }
    }

    #[inline(always)]
    fn field_gradient(
        &self,
        field: &[[Packed; 3]],
        (dN, modes): (&[[f64; 3]], &[[Packed; 3]]),
        inverse: &Mat3<R>,
    ) -> Mat3<R> {
        let zero = self.zero;
        let mut H = [[zero; 3]; 3];
        for (u, dN) in field.iter().zip(dN) {
            let u = vector(zero, u, self.part);
            for m in 0..3 {
                let dN = zero.splat(dN[m]);
                (0..3).for_each(
                    #[inline(always)]
                    |i| H[i][m] = u[i].mul_add(dN, H[i][m]),
                );
            }
        }
        for (a, gradient) in field[dN.len()..].iter().zip(modes) {
            let (a, gradient) = (vector(zero, a, self.part), vector(zero, gradient, self.part));
            for m in 0..3 {
                (0..3).for_each(
                    #[inline(always)]
                    |i| H[i][m] = a[i].mul_add(gradient[m], H[i][m]),
                );
            }
        }
        let column = inlined!(|J: usize| [inverse[0][J], inverse[1][J], inverse[2][J]]);
        mat3(
            #[inline(always)]
            |i, J| dot3(H[i], column(J)),
        )
    }

    /// Gradients of the shape functions at a quadrature point, `dN_A/dxi dxi/dX`.
    #[inline(always)]
    pub(crate) fn set_shape_gradients(&self, point: usize, gradients: &mut [[Packed; 3]]) {
        self.set_corner_gradients(point, gradients);
        if self.cells.n_modes > 0 {
            self.add_mode_gradients(point, gradients);
        }
    }

    #[inline(always)]
    fn set_corner_gradients(&self, point: usize, gradients: &mut [[Packed; 3]]) {
        let zero = self.zero;
        let inverse = self.inverse_jacobian(point);
        for (dN, gradient) in self.cells.reference_gradients_at(point).iter().zip(gradients) {
            let dN = [zero.splat(dN[0]), zero.splat(dN[1]), zero.splat(dN[2])];
            for J in 0..3 {
                dot3(dN, [inverse[0][J], inverse[1][J], inverse[2][J]]).store(&mut gradient[J], self.part);
            }
        }
    }

    #[inline(always)]
    fn inverse_jacobian(&self, point: usize) -> Mat3<R> {
        let geometry = &self.cells.geometry_of(self.batch)[point];
        mat3(
            #[inline(always)]
            |i, j| self.zero.load(&geometry.inverse_jacobian[i][j], self.part),
        )
    }

    /// Weight of a quadrature point.
    #[inline(always)]
    pub(crate) fn weight(&self, point: usize) -> R {
        self.zero.load(&self.cells.geometry_of(self.batch)[point].weight, self.part)
    }
}

/// Material and damping of the cells of a register.
#[derive(Clone, Copy)]
pub(crate) struct CellLaw<'a, R> {
    pub material: &'a dyn Response<R>,
    pub damping: Option<&'a Damping>,
    /// Damping of a projected volume.
    pub volume_damping: Option<VolumeDamping>,
}

impl<R: Register> CellLaw<'_, R> {
    /// Stage averages of the stress at a point.
    #[inline(always)]
    fn average(
        &self,
        rule: &Rule,
        start: &Mat3<R>,
        rates: &[Mat3<R>],
        request: Request,
        average: &mut Average<R>,
    ) {
        rule.average(self.material, start, rates, request, average);
        if let Some(damping) = self.damping {
            rule.add_damping(damping, start, rates, request, average);
        }
    }
}

/// Stage forces (and derivatives) of the cells of a register, from the nodal fields in their memory.
#[inline(always)]
pub(crate) fn integrate<R: Register>(
    cells: RegisterCells<'_, R>,
    n_fields: usize,
    law: CellLaw<'_, R>,
    (step, request): (&StepInput<'_>, Request),
    (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
) {
    let n = cells.cells.n_nodes;
    let PointMemory { average, gradients, .. } = point_memory;
    let mut min_det = cells.zero.splat(f64::INFINITY);
    for point in 0..cells.cells.n_points {
        cells.set_field_gradients(point, &memory.nodal[..n_fields * n], &mut gradients[..n_fields]);
        law.average(step.rule, &gradients[0], &gradients[1..n_fields], request, average);
        min_det = min_det.min(average.min_det);
        cells.add_average(point, average, &law, (step, request), memory);
    }
    min_det.store(&mut memory.min_det, cells.part);
    set_forces_of_stages(cells, step.rule.degree(), memory);
}

/// Stage forces from the stresses at all points.
#[inline(always)]
fn set_forces_of_stages<R: Register>(cells: RegisterCells<'_, R>, k: usize, memory: &mut BatchMemory) {
    let n = cells.cells.n_nodes;
    let n_points = cells.cells.n_points;
    for i in 0..k {
        let stress = &memory.stress[i * n_points..(i + 1) * n_points];
        let (corners, internal) = memory.force[i * n..(i + 1) * n].split_at_mut(cells.cells.n_corners());
        set_force(cells.zero, cells.cells, stress, corners, cells.part);
        if !internal.is_empty() {
            modes::set_forces(cells, stress, corners, internal);
        }
    }
}

impl<R: Register> RegisterCells<'_, R> {
    /// Keeps the stage averages of the stress at a point, and adds their derivatives to the cells' stiffness.
    #[inline(always)]
    fn add_average(
        &self,
        point: usize,
        average: &Average<R>,
        law: &CellLaw<'_, R>,
        (step, request): (&StepInput<'_>, Request),
        memory: &mut BatchMemory,
    ) {
        let n = self.cells.n_nodes;
        let n_points = self.cells.n_points;
        let inverse = self.inverse_jacobian(point);
        let weight = self.weight(point);
        for (i, P) in average.stress.iter().enumerate() {
            let stress = &mut memory.stress[i * n_points + point];
            for r in 0..3 {
                for m in 0..3 {
                    (dot3(P[r], inverse[m]) * weight).store(&mut stress[r][m], self.part);
                }
            }
        }
        if request == Request::Tangent {
            let factor = weight * step.tangent_factor;
            self.set_shape_gradients(point, &mut memory.gradients[..n]);
            let blocks = memory.stiffness.chunks_exact_mut(n * n);
            for (tangent, stiffness) in average.tangent.iter().zip(blocks) {
                let gradients = &memory.gradients[..n];
                let skips = step.rule.is_symmetric(law.damping.is_some());
                add_stiffness(tangent, gradients, factor, (point == 0, skips), stiffness, self.part);
            }
        }
    }
}

/// Stored energy of the cells of a register at a nodal displacement, and the smallest det F.
#[inline(always)]
pub(crate) fn strain_state<R: Register>(
    cells: RegisterCells<'_, R>,
    material: &dyn Response<R>,
    nodal: &[[Packed; 3]],
) -> (R, R) {
    let mut energy = cells.zero;
    let mut min_det = cells.zero.splat(f64::INFINITY);
    let mut G = [[[cells.zero; 3]; 3]];
    for point in 0..cells.cells.n_points {
        cells.set_field_gradients(point, nodal, &mut G);
        let W = material.strain_energy(&green_lagrange(&G[0]));
        energy = W.mul_add(cells.weight(point), energy);
        min_det = min_det.min(det_of_identity_plus(&G[0]));
    }
    (energy, min_det)
}

/// Energy that a damping dissipates in the cells of a register in a step, from the nodal fields in their memory.
#[inline(always)]
pub(crate) fn dissipated<R: Register>(
    cells: RegisterCells<'_, R>,
    damping: &Damping,
    step: &StepInput<'_>,
    (memory, point_memory): (&BatchMemory, &mut PointMemory<R>),
) -> R {
    let PointMemory { average, gradients, .. } = point_memory;
    let mut energy = cells.zero;
    for point in 0..cells.cells.n_points {
        cells.set_field_gradients(point, &memory.nodal, gradients);
        let density = step.rule.dissipated(damping, &gradients[0], &gradients[1..], average);
        energy = density.mul_add(cells.weight(point), energy);
    }
    energy
}

#[inline(always)]
fn vector<R: Register>(zero: R, from: &[Packed; 3], part: usize) -> [R; 3] {
    [zero.load(&from[0], part), zero.load(&from[1], part), zero.load(&from[2], part)]
}

/// Nodes whose forces are summed in registers at the same time.
const BLOCK: usize = 4;

/// Forces of one stage, `f_A = sum_points (w P J^-T) dN_A/dxi`.
#[inline(always)]
fn set_force<R: Register>(
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

/// Adds `w grad N_A . dP/dF . grad N_B` to the cells' stiffness, `[A][B][3 i + k]`; `is_first`: sets it instead;
/// `skips`: leaves out B < A.
#[inline(always)]
fn add_stiffness<R: Register>(
    tangent: &Tangent<R>,
    gradients: &[[Packed; 3]],
    weight: R,
    (is_first, skips): (bool, bool),
    stiffness: &mut [[Packed; 9]],
    part: usize,
) {
    let n = gradients.len();
    let zero = weight.splat(0.0);
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
