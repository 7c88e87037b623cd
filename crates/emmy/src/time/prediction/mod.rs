//! Where Newton's iteration starts: the rigid motion of the step, and what the last step did besides its own.

pub(super) mod rigid;
pub(super) mod rotation;
#[cfg(test)]
mod tests;

use super::stage_system::{StageForm, StageSystem};
use super::{Memory, State};
use crate::body::{Body, sum};
use crate::error::Result;
use crate::tensor::Mat3;
use rigid::RigidStep;
use rotation::{exp, image};

/// How the deviation of the last step from its rigid motion is carried into this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carry {
    /// Its polynomial is continued: best for motion that the steps resolve.
    Continued,
    /// It is repeated: best for stiff bodies, whose deviation is of the step, not of the motion. The same for k = 1.
    Repeated,
    /// Not at all.
    Nothing,
}

/// Prediction of the rates of a step, with its memory.
///
/// ```math
/// x_j = X_j + D_j y + Q(c_j) sum_l e_jl z_l
/// ```
///
/// `X_j` and `D_j y` are the translation and the rotation ([`RigidStep`]) of a rigid body with the present positions, the
/// momenta and the loads of the step: neither needs the internal force. `z_l` is what the rates of the last step had besides
/// theirs, seen from the body, which turns by `Q(alpha) = exp(alpha w)`; e are the coefficients of a [`Carry`]. A body whose
/// supports leave it no rigid motion has its last polynomial continued.
#[derive(Debug)]
pub struct Prediction {
    rigid: RigidStep,
    /// Translation rates X_j.
    translation: Vec<[f64; 3]>,
    /// Positions y about the centre of mass at the start of the step.
    arm: Vec<f64>,
    /// M y.
    weighted_arm: Vec<f64>,
    /// Tensors B_i of the known vectors `G_i = g_i + s^2 f_i^ext`.
    moments: Vec<Mat3<f64>>,
    /// Sums of G_i over the nodes.
    sums: Vec<[f64; 3]>,
    /// Deviations z_l of the last step, turned with the body to the end of that step.
    deviation: Vec<f64>,
    /// Size of the last step.
    last_size: Option<f64>,
    coefficients: Vec<f64>,
}

impl Prediction {
    pub fn new(k: usize, n: usize) -> Self {
        Prediction {
            rigid: RigidStep::new(k),
            translation: vec![[0.0; 3]; k],
            arm: vec![0.0; n],
            weighted_arm: vec![0.0; n],
            moments: vec![[[0.0; 3]; 3]; k],
            sums: vec![[0.0; 3]; k],
            deviation: vec![0.0; k * n],
            last_size: None,
            coefficients: vec![0.0; k * k],
        }
    }

    /// Keeps what the next steps depend on.
    pub fn keep(&self, memory: &mut Memory) {
        memory.keep("prediction.deviation", &self.deviation);
        memory.keep("prediction.last_size", self.last_size.as_slice());
    }

    /// Takes over what [`Prediction::keep`] kept.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("prediction.deviation", &mut self.deviation)?;
        self.last_size = memory.option("prediction.last_size")?;
        Ok(())
    }

    /// Finds the rigid motion of a step whose known vectors and loads are set, those that follow included.
    pub fn start(&mut self, system: &StageSystem<'_>, state: &State) {
        let (body, form) = (system.body, &system.form);
        let k = form.rule.degree();
        let mut held = [false; 3];
        body.fixed().iter().enumerate().for_each(|(dof, fixed)| held[dof % 3] |= fixed);
        // A turn about an axis moves all but what lies along it.
        let turns = [0, 1, 2].map(|axis| (0..3).all(|d| d == axis || !held[d]));
        let mass: f64 = body.mass().iter().sum();
        self.translation.fill([0.0; 3]);
        self.rigid.stay();
        if mass <= 0.0 || held == [true; 3] {
            return;
        }
        self.set_arm(body, state, mass);
        self.set_known(system);
        for (j, rate) in self.translation.iter_mut().enumerate() {
            for d in (0..3).filter(|d| !held[*d]) {
                let total: f64 = (0..k).map(|i| form.inverse_mass[j * k + i] * self.sums[i][d]).sum();
                rate[d] = total / mass;
            }
        }
        let mut inertia = [[0.0; 3]; 3];
        for (my, y) in self.weighted_arm.chunks_exact(3).zip(self.arm.chunks_exact(3)) {
            (0..3).for_each(|d| (0..3).for_each(|e| inertia[d][e] += my[d] * y[e]));
        }
        self.rigid.solve(form, &inertia, &self.moments, turns);
    }

    /// Sets y and M y.
    fn set_arm(&mut self, body: &Body, state: &State, mass: f64) {
        let points = body.mesh().points().iter().zip(state.displacement.chunks_exact(3));
        for ((X, u), y) in points.zip(self.arm.chunks_exact_mut(3)) {
            (0..3).for_each(|d| y[d] = X[d] + u[d]);
        }
        // Twice: a body far from the origin hides its centre in rounding the first time.
        for _ in 0..2 {
            body.mass_product(&self.arm, &mut self.weighted_arm);
            let centre = sum(&self.weighted_arm).map(|sum| sum / mass);
            self.arm.chunks_exact_mut(3).for_each(|y| (0..3).for_each(|d| y[d] -= centre[d]));
        }
        body.mass_product(&self.arm, &mut self.weighted_arm);
    }

    /// Sets the sums and the moments of G.
    fn set_known(&mut self, system: &StageSystem<'_>) {
        let (n, s) = (self.arm.len(), system.time_scale);
        for (i, (moments, sum)) in self.moments.iter_mut().zip(&mut self.sums).enumerate() {
            (*moments, *sum) = ([[0.0; 3]; 3], [0.0; 3]);
            for (node, y) in self.arm.chunks_exact(3).enumerate() {
                for d in 0..3 {
                    let at = i * n + 3 * node + d;
                    let force = system.known[at] + s * s * system.external_force(at);
                    sum[d] += force;
                    (0..3).for_each(|e| moments[d][e] += force * y[e]);
                }
            }
        }
    }

    /// The rotation of the rigid motion.
    pub fn rotation(&self) -> &RigidStep {
        &self.rigid
    }

    /// Predicts the rates of the step that was started; false if there was none before.
    pub fn predict(&mut self, carry: Carry, form: &StageForm, step_size: f64, rates: &mut [f64]) -> bool {
        let Some(last_size) = self.last_size else { return false };
        let (k, n) = (form.rule.degree(), self.arm.len());
        self.set_coefficients(carry, form, step_size / last_size);
        for (i, rates) in rates.chunks_exact_mut(n).enumerate() {
            let turn = exp(&self.rigid.rotation.map(|w| form.rule.nodes()[i] * w));
            let (move_on, D) = (self.translation[i], &self.rigid.rates[i]);
            let nodes = rates.chunks_exact_mut(3).zip(self.arm.chunks_exact(3)).enumerate();
            for (node, (x, y)) in nodes {
                let mut carried = [0.0; 3];
                for (e, z) in self.coefficients[i * k..].iter().zip(self.deviation.chunks_exact(n)) {
                    (0..3).for_each(|d| carried[d] += e * z[3 * node + d]);
                }
                let (rigid, carried) = (image(D, y), image(&turn, &carried));
                (0..3).for_each(|d| x[d] = move_on[d] + rigid[d] + carried[d]);
            }
        }
        true
    }

    /// Sets e for a ratio of step sizes, new over old.
    fn set_coefficients(&mut self, carry: Carry, form: &StageForm, ratio: f64) {
        match carry {
            Carry::Continued => form.rule.continuation(ratio, &mut self.coefficients),
            Carry::Repeated => {
                self.coefficients.fill(0.0);
                self.coefficients.iter_mut().step_by(form.rule.degree() + 1).for_each(|e| *e = ratio);
            }
            Carry::Nothing => self.coefficients.fill(0.0),
        }
    }

    /// Keeps what the rates of the step that was started have besides its rigid motion.
    pub fn remember(&mut self, form: &StageForm, rates: &[f64], step_size: f64) {
        let n = self.arm.len();
        let stages = rates.chunks_exact(n).zip(self.deviation.chunks_exact_mut(n)).enumerate();
        for (i, (rates, deviation)) in stages {
            let turn = exp(&self.rigid.rotation.map(|w| (1.0 - form.rule.nodes()[i]) * w));
            let (move_on, D) = (self.translation[i], &self.rigid.rates[i]);
            let nodes = rates.chunks_exact(3).zip(self.arm.chunks_exact(3));
            for (z, (x, y)) in deviation.chunks_exact_mut(3).zip(nodes) {
                let rigid = image(D, y);
                let difference = [0, 1, 2].map(|d| x[d] - move_on[d] - rigid[d]);
                z.copy_from_slice(&image(&turn, &difference));
            }
        }
        self.last_size = Some(step_size);
    }
}
