//! Starting point of Newton's iteration: the rigid motion of the step, plus the deviation of the last step from its
//! rigid motion.

mod balance;
mod component;
#[cfg(test)]
mod tests;

use self::component::ComponentMotion;
use super::equations::Equations;
use super::rigid_step::{self, RigidStep};
use super::stage_coefficients::StageCoefficients;
use super::{Memory, State};
use crate::body::Body;
use crate::error::Result;
use crate::nodal;
use crate::tensor::Mat3;
use crate::tensor::rotation::{exp, image, skew};

/// Extrapolation of the last step's deviation from its rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carry {
    /// Its polynomial is continued: best for motion that the steps resolve.
    Continued,
    /// It is repeated: best for stiff bodies, whose deviation depends on the step, not on the motion. The same for k =
    /// 1.
    Repeated,
    /// It is left out.
    Nothing,
}

/// Prediction of the rates of a step, with its memory.
///
/// ```math
/// x_j = X_j + D_j y + Q(c_j) sum_l e_jl z_l
/// ```
///
/// `X_j` and `D_j y` are the translation and the rotation ([`RigidStep`]) of a rigid body with the present positions,
/// momenta and loads; neither needs the internal force. `z_l` is the deviation of the last step's rates from its rigid
/// motion, in the frame of the body, which rotates by `Q(alpha) = exp(alpha w)`; e are the coefficients of a [`Carry`].
/// If the supports permit no rigid motion, the last polynomial is continued.
///
/// Between joints, whose forces are unknown, each component has a rigid motion of its own: its translation and spins of
/// the last step are continued as polynomials.
#[derive(Debug)]
pub(super) struct Prediction {
    /// Rigid motions of the components; without joints the body is one.
    motions: Vec<ComponentMotion>,
    /// Whether there are joints.
    has_joints: bool,
    /// Axes that supports leave free, for translations and rotations.
    free: Free,
    /// Mass of the body; 0 if it has no rigid motion.
    mass: f64,
    /// Positions y about the centre of mass at the start of the step.
    arm: Vec<f64>,
    /// M y.
    weighted_arm: Vec<f64>,
    /// Tensors B_i of the known vectors `G_i = g_i + s^2 f_i^ext`.
    moments: Vec<Mat3<f64>>,
    /// Sums of G_i over the nodes.
    sums: Vec<[f64; 3]>,
    /// Deviations z_l of the last step, rotated with the body to the end of that step.
    deviation: Vec<f64>,
    /// Size of the last step.
    last_size: Option<f64>,
    continuation: Vec<f64>,
    /// Changes of the rotation in a balance of moments, and the moments of the stages.
    changes: Vec<Mat3<f64>>,
    moment: Vec<[f64; 3]>,
}

/// Free axes for translations and for rotations of a body.
#[derive(Debug, Clone, Copy, Default)]
struct Free {
    shifts: [bool; 3],
    turns: [bool; 3],
}

impl Free {
    /// Axes that the supports of a body leave free. A rotation about an axis moves all points off the axis.
    fn of(body: &Body) -> Self {
        let shifts = body.space.held_axes().map(|held| !held);
        let turns = [0, 1, 2].map(|axis| (0..3).all(|d| d == axis || shifts[d]));
        Free { shifts, turns }
    }
}

impl Prediction {
    pub(super) fn new(k: usize, body: &Body) -> Self {
        let n = body.n_dofs();
        Prediction {
            motions: ComponentMotion::all(k, body),
            has_joints: !body.mechanism.components.is_empty(),
            free: Free::default(),
            mass: 0.0,
            arm: vec![0.0; n],
            weighted_arm: vec![0.0; n],
            moments: vec![[[0.0; 3]; 3]; k],
            sums: vec![[0.0; 3]; k],
            deviation: vec![0.0; k * n],
            last_size: None,
            continuation: vec![0.0; k * k],
            changes: vec![[[0.0; 3]; 3]; k],
            moment: vec![[0.0; 3]; k],
        }
    }

    /// Whether there was no step before.
    pub(super) fn is_first(&self) -> bool {
        self.last_size.is_none()
    }

    /// Size of the last step.
    pub(super) fn last_size(&self) -> Option<f64> {
        self.last_size
    }

    /// Keeps the memory that the next steps depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        memory.save_nodal("prediction.deviation", &self.deviation);
        memory.save_option("prediction.last_size", self.last_size);
        if self.has_joints {
            let last: Vec<f64> = self.motions.iter().flat_map(ComponentMotion::last).collect();
            memory.save("prediction.components", &last);
        }
    }

    /// Restores the data of [`Prediction::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("prediction.deviation", &mut self.deviation)?;
        self.last_size = memory.option("prediction.last_size")?;
        if self.has_joints {
            let k = self.moment.len();
            let mut last = vec![0.0; 6 * k * self.motions.len()];
            memory.fill("prediction.components", &mut last)?;
            let of_each = last.chunks_exact(6 * k);
            self.motions.iter_mut().zip(of_each).for_each(|(motion, last)| motion.restore(last));
        }
        Ok(())
    }

    /// Finds the rigid motion of a step whose known vectors and loads, including followers, are set.
    pub(super) fn start(&mut self, equations: &Equations<'_>, state: &State) {
        let body = equations.body;
        let stage = &equations.coefficients;
        let k = stage.rule.degree();
        self.free = Free::of(body);
        let mass = body.total_mass();
        self.mass = 0.0;
        self.motions.iter_mut().for_each(ComponentMotion::set_rest);
        let is_first = self.is_first();
        if is_first {
            self.deviation
                .chunks_exact_mut(state.velocity.len())
                .for_each(|z| z.copy_from_slice(&state.velocity));
        }
        if self.has_joints {
            return self.start_components(body, &equations.displacement, &state.velocity);
        }
        let Free { shifts, turns } = self.free;
        if mass <= 0.0 || shifts == [false; 3] {
            return;
        }
        self.mass = mass;
        self.set_arm(body, &equations.displacement, mass);
        self.set_known(equations);
        let Prediction { motions, sums, .. } = self;
        for (j, rate) in motions[0].translation.iter_mut().enumerate() {
            for d in (0..3).filter(|d| shifts[*d]) {
                let total: f64 = (0..k).map(|i| stage.inverse_mass[j * k + i] * sums[i][d]).sum();
                rate[d] = total / mass;
            }
        }
        let inertia = self.tensor(body, &self.weighted_arm);
        self.motions[0].rigid.solve(stage, &inertia, &self.moments, turns);
        if is_first {
            let linear = body.space.sum(&state.momentum).map(|p| p / mass);
            let drift = [0, 1, 2].map(|d| if shifts[d] { linear[d] } else { 0.0 });
            self.subtract_rigid_velocity(body, &inertia, &state.momentum, drift, turns);
        }
    }

    /// `sum_A v_A y_A^T` of a nodal vector that is zero at guests.
    fn tensor(&self, body: &Body, vector: &[f64]) -> Mat3<f64> {
        let mut tensor = [[0.0; 3]; 3];
        for (v, y) in vector.chunks_exact(3).zip(self.arm.chunks_exact(3)) {
            (0..3).for_each(|d| (0..3).for_each(|e| tensor[d][e] += v[d] * y[e]));
        }
        body.space.sum_ranks("tensor of a nodal vector", tensor.as_flattened_mut());
        tensor
    }

    /// Subtracts from the deviation the velocity of the rigid motion with the momentum of the state.
    fn subtract_rigid_velocity(
        &mut self,
        body: &Body,
        inertia: &Mat3<f64>,
        momentum: &[f64],
        drift: [f64; 3],
        turns: [bool; 3],
    ) {
        let moments = self.tensor(body, momentum);
        let Some(spin) = rigid_step::spin(inertia, &moments, turns) else { return };
        let turn = skew(&spin);
        let n = self.arm.len();
        for z in self.deviation.chunks_exact_mut(n) {
            for (z, y) in z.chunks_exact_mut(3).zip(self.arm.chunks_exact(3)) {
                let turned = image(&turn, y);
                (0..3).for_each(|d| z[d] -= drift[d] + turned[d]);
            }
        }
    }

    /// Sets y and M y.
    fn set_arm(&mut self, body: &Body, displacement: &[f64], mass: f64) {
        let points = body.space.points().zip(displacement.chunks_exact(3));
        for ((X, u), y) in points.zip(self.arm.chunks_exact_mut(3)) {
            (0..3).for_each(|d| y[d] = X[d] + u[d]);
        }
        // Twice: for a body far from the origin, the first result has rounding errors.
        for _ in 0..2 {
            body.mass_product(&self.arm, &mut self.weighted_arm);
            let centre = body.space.sum(&self.weighted_arm).map(|sum| sum / mass);
            self.arm.chunks_exact_mut(3).for_each(|y| (0..3).for_each(|d| y[d] -= centre[d]));
        }
        body.mass_product(&self.arm, &mut self.weighted_arm);
    }

    /// Sets the sums and the moments of G.
    fn set_known(&mut self, equations: &Equations<'_>) {
        let n = self.arm.len();
        let s = equations.time_scale;
        for (i, (moments, sum)) in self.moments.iter_mut().zip(&mut self.sums).enumerate() {
            (*moments, *sum) = ([[0.0; 3]; 3], [0.0; 3]);
            for (node, y) in self.arm.chunks_exact(3).enumerate().take(equations.body.space.own_nodes().end) {
                for d in 0..3 {
                    let at = i * n + nodal::dof(node, d);
                    let force = equations.known[at] + s * s * equations.load(at);
                    sum[d] += force;
                    (0..3).for_each(|e| moments[d][e] += force * y[e]);
                }
            }
        }
        equations.body.space.sum_ranks("sums of known vectors", self.sums.as_flattened_mut());
        equations
            .body
            .space
            .sum_ranks("moments of known vectors", self.moments.as_flattened_mut().as_flattened_mut());
    }

    /// Sets the arms of the components, and before the first step their rigid motions and deviations to those of the
    /// velocity.
    fn start_components(&mut self, body: &Body, displacement: &[f64], velocity: &[f64]) {
        let (n, is_first) = (self.arm.len(), self.is_first());
        for motion in &mut self.motions {
            motion.set_arm(body, displacement, &mut self.arm);
            if is_first {
                motion.fit_velocity(&self.arm, velocity);
                self.deviation.chunks_exact_mut(n).for_each(|z| motion.take_velocity(&self.arm, z));
            }
        }
    }

    /// The rotation of the rigid motion of a body without joints.
    pub(super) fn rotation(&self) -> &RigidStep {
        &self.motions[0].rigid
    }

    /// Predicts the rates of the step that was started.
    pub(super) fn predict(
        &mut self,
        carry: Carry,
        stage: &StageCoefficients,
        step_size: f64,
        rates: &mut [f64],
    ) {
        let k = stage.rule.degree();
        let n = self.arm.len();
        if self.has_joints {
            match self.last_size {
                Some(last_size) => self.set_continuation(Carry::Continued, stage, step_size / last_size),
                None => self.set_continuation(Carry::Repeated, stage, step_size),
            }
            self.motions.iter_mut().for_each(|motion| motion.continue_last(stage, &self.continuation));
        }
        match self.last_size {
            Some(last_size) => self.set_continuation(carry, stage, step_size / last_size),
            // The deviation is a velocity, equal in all stages.
            None if carry == Carry::Nothing => self.set_continuation(carry, stage, 0.0),
            None => self.set_continuation(Carry::Repeated, stage, step_size),
        }
        for motion in &self.motions {
            for (i, rates) in rates.chunks_exact_mut(n).enumerate() {
                let turn = exp(&motion.rigid.rotation.map(|w| stage.rule.nodes()[i] * w));
                let move_on = motion.translation[i];
                let D = &motion.rigid.rates[i];
                for node in motion.nodes() {
                    let at = nodal::dof(node, 0);
                    let (x, y) = (&mut rates[at..at + 3], &self.arm[at..at + 3]);
                    let mut carried = [0.0; 3];
                    for (e, z) in self.continuation[i * k..].iter().zip(self.deviation.chunks_exact(n)) {
                        (0..3).for_each(|d| carried[d] += e * z[at + d]);
                    }
                    let rigid = image(D, y);
                    let carried = image(&turn, &carried);
                    (0..3).for_each(|d| x[d] = move_on[d] + rigid[d] + carried[d]);
                }
            }
        }
    }

    /// Sets e for a ratio of step sizes, new over old.
    fn set_continuation(&mut self, carry: Carry, stage: &StageCoefficients, ratio: f64) {
        match carry {
            Carry::Continued => stage.rule.continuation(ratio, &mut self.continuation),
            Carry::Repeated => {
                self.continuation.fill(0.0);
                self.continuation.iter_mut().step_by(stage.rule.degree() + 1).for_each(|e| *e = ratio);
            }
            Carry::Nothing => self.continuation.fill(0.0),
        }
    }

    /// Keeps the deviation of the rates of the present step from its rigid motion.
    pub(super) fn remember(&mut self, stage: &StageCoefficients, rates: &[f64], step_size: f64) {
        let n = self.arm.len();
        for motion in &mut self.motions {
            if self.has_joints {
                motion.fit(stage, &self.arm, rates);
            }
            let stages = rates.chunks_exact(n).zip(self.deviation.chunks_exact_mut(n)).enumerate();
            for (i, (rates, deviation)) in stages {
                let turn = exp(&motion.rigid.rotation.map(|w| (1.0 - stage.rule.nodes()[i]) * w));
                let move_on = motion.translation[i];
                let D = &motion.rigid.rates[i];
                for node in motion.nodes() {
                    let at = nodal::dof(node, 0);
                    let rigid = image(D, &self.arm[at..at + 3]);
                    let difference = [0, 1, 2].map(|d| rates[at + d] - move_on[d] - rigid[d]);
                    deviation[at..at + 3].copy_from_slice(&image(&turn, &difference));
                }
            }
        }
        self.last_size = Some(step_size);
    }
}
