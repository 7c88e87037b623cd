//! Damping of a batch of cells: the part of its forces that knows no material, compiled once for all of them.

use pulp::{Arch, Simd, WithSimd};

use super::batches::CellBatches;
use super::integral::{
    self, BatchMemory, PointMemory, Scratch, add_stiffness, field_gradient, inverse_jacobian, set_force,
    set_gradients,
};
use super::term::StepInput;
use crate::average::{Damping, Want};
use crate::tensor::{Batch, LANES, Mat3, Packed, Register, dot3};

/// Damping of the cells of a term.
#[derive(Clone, Copy)]
pub struct OfCells<'a> {
    /// That of a cell.
    pub of: &'a dyn Fn(usize) -> Damping,
    /// Whether it differs from cell to cell, as that of links does: then cells are taken one by one.
    pub differs: bool,
}

/// Adds stresses, forces and derivatives of the damping of a batch to those of its material, which are in the memory with the nodal
/// fields.
pub fn add(
    cells: &CellBatches,
    batch: usize,
    damping: OfCells<'_>,
    step: &StepInput<'_>,
    want: Want,
    scratch: &mut Scratch,
) {
    if damping.differs {
        return add_in(cells, batch, damping, step, want, scratch.numbers());
    }
    Arch::new().dispatch(Added { cells, batch, damping, step, want, scratch });
}

/// What the damping of all cells takes out of them in a step, one batch after the other \[energy\].
pub fn dissipated(
    cells: &CellBatches,
    damping: OfCells<'_>,
    step: &StepInput<'_>,
    scratch: &mut Scratch,
) -> f64 {
    if damping.differs {
        return dissipated_in(cells, damping, step, scratch.numbers());
    }
    Arch::new().dispatch(Dissipated { cells, damping, step, scratch })
}

struct Added<'a> {
    cells: &'a CellBatches,
    batch: usize,
    damping: OfCells<'a>,
    step: &'a StepInput<'a>,
    want: Want,
    scratch: &'a mut Scratch,
}

impl WithSimd for Added<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Added { cells, batch, damping, step, want, scratch } = self;
        let memory = scratch.registers::<Batch<S>>();
        add_in(cells, batch, damping, step, want, memory);
    }
}

struct Dissipated<'a> {
    cells: &'a CellBatches,
    damping: OfCells<'a>,
    step: &'a StepInput<'a>,
    scratch: &'a mut Scratch,
}

impl WithSimd for Dissipated<'_> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        dissipated_in(self.cells, self.damping, self.step, self.scratch.registers::<Batch<S>>())
    }
}

/// Parts of a batch that a register takes at once, with the first cell of each.
#[inline(always)]
fn parts<R: Register>(cells: &CellBatches, batch: usize) -> impl Iterator<Item = (usize, usize)> {
    cells.cells_of(batch).step_by(R::WIDTH).enumerate()
}

/// Displacement gradient at the start of a step, and rates, at a point.
#[inline(always)]
fn set_point<R: Register>(
    (cells, point, part): (&CellBatches, usize, usize),
    inverse: &Mat3<R>,
    memory: &BatchMemory,
    rates: &mut [Mat3<R>],
) -> Mat3<R> {
    let (n, zero, dN) = (cells.n_nodes, inverse[0][0].splat(0.0), cells.reference_gradients_at(point));
    for (j, rate) in rates.iter_mut().enumerate() {
        *rate = field_gradient(zero, &memory.nodal[(j + 1) * n..(j + 2) * n], dN, inverse, part);
    }
    field_gradient(zero, &memory.nodal[..n], dN, inverse, part)
}

#[inline(always)]
fn add_in<R: Register>(
    cells: &CellBatches,
    batch: usize,
    damping: OfCells<'_>,
    step: &StepInput<'_>,
    want: Want,
    (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
) {
    let (n, k, n_points) = (cells.n_nodes, step.rule.degree(), cells.n_points);
    let PointMemory { average, rates } = point_memory;
    let zero = average.min_det.splat(0.0);
    for (part, cell) in parts::<R>(cells, batch) {
        let damping = (damping.of)(cell);
        for (point, geometry) in cells.geometry_of(batch).iter().enumerate() {
            let inverse = inverse_jacobian(zero, geometry, part);
            let start = set_point((cells, point, part), &inverse, memory, rates);
            step.rule.average_damping(&damping, &start, rates, want, average);
            let weight = zero.load(&geometry.weight, part);
            for (i, P) in average.stress.iter().enumerate() {
                let stress = &mut memory.stress[i * n_points + point];
                for r in 0..3 {
                    for m in 0..3 {
                        let old = zero.load(&stress[r][m], part);
                        dot3(P[r], inverse[m]).mul_add(weight, old).store(&mut stress[r][m], part);
                    }
                }
            }
            if want == Want::Tangent {
                let (factor, skips) = (weight * step.tangent_factor, step.rule.is_symmetric(true));
                let dN = cells.reference_gradients_at(point);
                set_gradients(zero, dN, &inverse, &mut memory.gradients[..n], part);
                let blocks = memory.stiffness.chunks_exact_mut(n * n);
                for (tangent, stiffness) in average.tangent.iter().zip(blocks) {
                    add_stiffness(tangent, &memory.gradients[..n], factor, (false, skips), stiffness, part);
                }
            }
        }
        for i in 0..k {
            let stress = &memory.stress[i * n_points..(i + 1) * n_points];
            set_force(zero, cells, stress, &mut memory.force[i * n..(i + 1) * n], part);
        }
    }
}

#[inline(always)]
fn dissipated_in<R: Register>(
    cells: &CellBatches,
    damping: OfCells<'_>,
    step: &StepInput<'_>,
    (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
) -> f64 {
    let PointMemory { average, rates } = point_memory;
    let (zero, mut sum, mut energies) = (average.min_det.splat(0.0), 0.0, Packed([0.0; LANES]));
    for batch in 0..cells.len() {
        integral::gather(cells, batch, step, true, memory);
        for (part, cell) in parts::<R>(cells, batch) {
            let (damping, mut energy) = ((damping.of)(cell), zero);
            for (point, geometry) in cells.geometry_of(batch).iter().enumerate() {
                let inverse = inverse_jacobian(zero, geometry, part);
                let start = set_point((cells, point, part), &inverse, memory, rates);
                let density = step.rule.dissipated(&damping, &start, rates, average);
                energy = density.mul_add(zero.load(&geometry.weight, part), energy);
            }
            energy.store(&mut energies, part);
        }
        sum += energies.0[..cells.cells_of(batch).len()].iter().sum::<f64>();
    }
    sum
}
