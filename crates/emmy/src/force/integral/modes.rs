//! Gradients and forces of incompatible modes, see [`crate::space::internal_nodes`].

use super::{RegisterCells, vector};
use crate::tensor::{Packed, Register, dot3};

impl<R: Register> RegisterCells<'_, R> {
    /// Adds the gradients of the internal nodes, `G_m`, and subtracts their mean share from those of the corners.
    #[inline(always)]
    pub(super) fn add_mode_gradients(&self, point: usize, gradients: &mut [[Packed; 3]]) {
        let zero = self.zero;
        let inverse = self.inverse_jacobian(point);
        let (corners, internal) = gradients.split_at_mut(self.cells.n_corners());
        for (mode, gradient) in self.cells.mode_gradients_at(self.batch, point).iter().zip(&mut *internal) {
            let mode = vector(zero, mode, self.part);
            for J in 0..3 {
                dot3(mode, [inverse[0][J], inverse[1][J], inverse[2][J]]).store(&mut gradient[J], self.part);
            }
        }
        share_out(zero, corners, internal, self.part);
    }
}

/// Forces of the internal nodes of one stage, `sum_points (w P J^-T) J^T G_m`, and their shares in those of the
/// corners.
#[inline(always)]
pub(super) fn set_forces<R: Register>(
    cells: RegisterCells<'_, R>,
    stress: &[[[Packed; 3]; 3]],
    corners: &mut [[Packed; 3]],
    internal: &mut [[Packed; 3]],
) {
    let RegisterCells { cells, batch, part, zero } = cells;
    for (mode, force) in internal.iter_mut().enumerate() {
        let mut sum = [zero; 3];
        for (point, stress) in stress.iter().enumerate() {
            let gradient = vector(zero, &cells.mode_gradients_at(batch, point)[mode], part);
            for i in 0..3 {
                sum[i] += dot3(vector(zero, &stress[i], part), gradient);
            }
        }
        (0..3).for_each(
            #[inline(always)]
            |i| sum[i].store(&mut force[i], part),
        );
    }
    share_out(zero, corners, internal, part);
}

/// Subtracts the sum of the vectors of the internal nodes from those of the corners, in equal shares: the displacement
/// of a mode is relative to the mean over the corners.
#[inline(always)]
fn share_out<R: Register>(zero: R, corners: &mut [[Packed; 3]], internal: &[[Packed; 3]], part: usize) {
    let share = zero.splat(1.0 / corners.len() as f64);
    for i in 0..3 {
        let mut sum = zero;
        for vector in internal {
            sum += zero.load(&vector[i], part);
        }
        let sum = sum * share;
        for corner in &mut *corners {
            (zero.load(&corner[i], part) - sum).store(&mut corner[i], part);
        }
    }
}
