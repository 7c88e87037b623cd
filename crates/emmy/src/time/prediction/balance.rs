//! Balances of the momenta by a rigid motion, and the work of what an iteration leaves.

use super::Prediction;
use super::component::ComponentMotion;
use crate::body::Body;
use crate::error::Result;
use crate::nodal;
use crate::tensor::cross;
use crate::tensor::rotation::image;
use crate::time::equations::Equations;
use crate::time::stage_coefficients::StageCoefficients;

/// Largest and smallest number of passes of a balance: each leaves a part of the previous residual, as large as the
/// relative deformation in the step.
const BALANCES: usize = 4;
const MIN_BALANCES: usize = 2;

/// A pass that leaves more than this part of the previous residual has reached rounding.
const ROUNDING: f64 = 0.25;

impl Prediction {
    /// Balances resultants and moments of a solution by an additional rigid motion, to rounding.
    ///
    /// Internal forces have no resultants and moments, so inertia and loads alone decide, and the rounding of the
    /// stiffness, which may exceed the inertia, has no effect. The error of an iteration would act like a constant
    /// force. `residual`: memory for k n numbers.
    ///
    /// # Errors
    /// As [`Equations::unbalanced`].
    pub(in crate::time) fn balance(
        &mut self,
        equations: &mut Equations<'_>,
        rates: &mut [f64],
        residual: &mut [f64],
    ) -> Result<()> {
        if self.mass == 0.0 || !equations.is_self_balanced() {
            return Ok(());
        }
        let turns = self.free.turns.map(|free| free && equations.coefficients.rule.has_no_moment());
        let mut last = f64::INFINITY;
        for pass in 0..BALANCES {
            equations.unbalanced(rates, residual)?;
            self.set_resultants(equations, rates, residual);
            let left = self.resultant_size(equations.body, turns);
            if left == 0.0 || pass >= MIN_BALANCES && left > ROUNDING * last {
                break;
            }
            last = left;
            self.remove_resultants(&equations.coefficients, turns, rates);
        }
        Ok(())
    }

    /// Removes the rigid motion with the present sums and moments of the stages from rates.
    fn remove_resultants(&mut self, stage: &StageCoefficients, turns: [bool; 3], rates: &mut [f64]) {
        let k = self.changes.len();
        self.motions[0].rigid.balance(&self.moment, turns, &mut self.changes);
        for (j, rates) in rates.chunks_exact_mut(self.arm.len()).enumerate() {
            let shift = [0, 1, 2].map(|d| {
                let total: f64 = (0..k).map(|i| stage.inverse_mass[j * k + i] * self.sums[i][d]).sum();
                if self.free.shifts[d] { -total / self.mass } else { 0.0 }
            });
            for (x, y) in rates.chunks_exact_mut(3).zip(self.arm.chunks_exact(3)) {
                let turned = image(&self.changes[j], y);
                (0..3).for_each(|d| x[d] += shift[d] + turned[d]);
            }
        }
    }

    /// Removes the resultants of a residual at the rates x by the inertia of a rigid motion, and that motion from a
    /// change of the rates. `memory`: for two such vectors.
    pub(in crate::time) fn take_resultants(
        &mut self,
        equations: &mut Equations<'_>,
        x: &[f64],
        [residual, change]: [&mut [f64]; 2],
        [motion, inertia]: [&mut [f64]; 2],
    ) {
        for _ in 0..MIN_BALANCES {
            self.set_resultants(equations, x, residual);
            motion.fill(0.0);
            self.remove_resultants(&equations.coefficients, self.free.turns, motion);
            equations.inertia(motion, inertia);
            change.iter_mut().zip(&*motion).for_each(|(change, motion)| *change -= motion);
            residual.iter_mut().zip(&*inertia).for_each(|(residual, inertia)| *residual += inertia);
        }
    }

    /// Work of stage forces `[k][n_nodes][3]` on the part of the rates x that deforms the body: without the velocity of
    /// the rigid motion at the positions of the stage. Forces without resultants and moments do no other work.
    ///
    /// ```math
    /// sum_i b_i f_i . (x_i - X_i - w_i x (y + sum_j a_ij (x_j - X_j)))
    /// ```
    pub(in crate::time) fn deforming_work(
        &self,
        equations: &Equations<'_>,
        x: &[f64],
        forces: &[f64],
    ) -> f64 {
        let space = &equations.body.space;
        let rule = &equations.coefficients.rule;
        let (n, k) = (self.arm.len(), self.moment.len());
        // With joints no iteration ends here.
        let ComponentMotion { rigid, translation, .. } = &self.motions[0];
        // Incompatible modes are not points of the body.
        let n_moving = equations.body.mesh().n_nodes();
        let mut work = 0.0;
        for (i, (forces, b)) in forces.chunks_exact(n).zip(rule.weights()).enumerate() {
            let a = &rule.coefficients()[i * k..(i + 1) * k];
            for node in space.counted_nodes() {
                let at = nodal::dof(node, 0);
                let mut rate = [0, 1, 2].map(|d| x[i * n + at + d]);
                if node < n_moving {
                    let mut q = [0, 1, 2].map(|d| self.arm[at + d]);
                    for (j, (a, shift)) in a.iter().zip(translation).enumerate() {
                        (0..3).for_each(|d| q[d] += a * (x[j * n + at + d] - shift[d]));
                    }
                    let turned = cross(rigid.spins[i], q);
                    (0..3).for_each(|d| rate[d] -= translation[i][d] + turned[d]);
                }
                work += b * (0..3).map(|d| forces[at + d] * rate[d]).sum::<f64>();
            }
        }
        let mut sum = [work];
        space.sum_ranks("work of a residual", &mut sum);
        sum[0]
    }

    /// Sets the sums and moments of a residual in every stage, moments about the centre of mass at the start of the
    /// step.
    fn set_resultants(&mut self, equations: &Equations<'_>, rates: &[f64], residual: &[f64]) {
        let a = equations.coefficients.rule.coefficients();
        let k = self.moment.len();
        let n = self.arm.len();
        for (i, residual) in residual.chunks_exact(n).enumerate() {
            (self.sums[i], self.moment[i]) = ([0.0; 3], [0.0; 3]);
            let residual = residual.as_chunks::<3>().0;
            for node in equations.body.space.counted_nodes() {
                let (at, r) = (nodal::dof(node, 0), residual[node]);
                let mut q = [0, 1, 2].map(|d| self.arm[at + d]);
                for j in 0..k {
                    (0..3).for_each(|d| q[d] += a[i * k + j] * rates[j * n + at + d]);
                }
                let moment = cross(q, [r[0], r[1], r[2]]);
                (0..3).for_each(|d| self.sums[i][d] += r[d]);
                (0..3).for_each(|d| self.moment[i][d] += moment[d]);
            }
        }
        equations.body.space.sum_ranks("resultants", self.sums.as_flattened_mut());
        equations.body.space.sum_ranks("moments of a residual", self.moment.as_flattened_mut());
    }

    /// Size of the sums and moments of all stages along free axes and about some, relative to mass and inertia.
    fn resultant_size(&self, body: &Body, turns: [bool; 3]) -> f64 {
        let shifts = self.free.shifts;
        let size =
            |v: &[f64; 3], free: [bool; 3]| (0..3).filter(|&d| free[d]).map(|d| v[d].abs()).sum::<f64>();
        let sums: f64 = self.sums.iter().map(|sum| size(sum, shifts)).sum();
        let moments: f64 = self.moment.iter().map(|moment| size(moment, turns)).sum();
        let [mass, inertia] = self.momentum_scales(body, 0.5);
        sums / mass + moments / inertia.max(f64::MIN_POSITIVE)
    }

    /// Work, impulse and moment of a residual over the step; impulse and moment along and about the free axes.
    pub(in crate::time) fn imbalance(
        &mut self,
        equations: &Equations<'_>,
        rates: &[f64],
        residual: &[f64],
    ) -> [f64; 3] {
        let n = self.arm.len();
        let s = equations.time_scale;
        let rule = &equations.coefficients.rule;
        let mut work = 0.0;
        let (mut impulse, mut moment) = ([0.0; 3], [0.0; 3]);
        if self.mass > 0.0 {
            self.set_resultants(equations, rates, residual);
        }
        let stages = residual.chunks_exact(n).zip(rates.chunks_exact(n)).zip(rule.weights()).enumerate();
        for (i, ((residual, rates), b)) in stages {
            work += b * equations.body.space.dot(residual, rates) / (s * s);
            for d in (0..3).filter(|_| self.mass > 0.0) {
                impulse[d] += if self.free.shifts[d] { b / s * self.sums[i][d] } else { 0.0 };
                moment[d] += if self.free.turns[d] { b / s * self.moment[i][d] } else { 0.0 };
            }
        }
        let norm = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        [work.abs(), norm(impulse), norm(moment)]
    }

    /// Largest linear and angular momentum possible with a kinetic energy, `sqrt(2 T m)` and `sqrt(2 T I)`; infinite if
    /// the body has no rigid motion.
    pub(in crate::time) fn momentum_scales(&self, body: &Body, energy: f64) -> [f64; 2] {
        if self.mass == 0.0 {
            return [f64::INFINITY; 2];
        }
        [
            (2.0 * energy * self.mass).sqrt(),
            (2.0 * energy * body.space.dot(&self.arm, &self.weighted_arm)).sqrt(),
        ]
    }
}
