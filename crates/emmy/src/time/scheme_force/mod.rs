//! Dissipation of a time element through its velocities, which conserves momenta and does not damp rigid motions.
//!
//! A time element of degree k with the coefficients a of Gauss' method dissipates nothing. With
//!
//! ```math
//! a_ij + beta p_i b_j p_j,    beta = chi / (2 (2 k - 1)),    chi = (1 - rho) / (1 + rho)
//! ```
//!
//! in their place, it is algebraically stable, of order 2 k - 1, and has the spectral radius rho at infinity (Hairer
//! and Wanner 1981, Algebraically stable and implementable Runge-Kutta methods of high order, SIAM Journal on Numerical
//! Analysis 18). Here p is the Legendre polynomial of degree k - 1 at the Gauss points with norm one on the unit
//! interval, `p(1) = sqrt(2 k - 1)`. The methods range from Gauss' method, rho = 1, to Radau IIA, rho = 0; for k = 1
//! from the mid-point rule to backward Euler. In a linear body the additional part consists of a strain part and a
//! velocity part. Both are used here in a form that dissipates energy in any motion of any body:
//!
//! *Strains*: the stress `beta p_i D : delta_E`, `delta_E = sum_j b_j p_j E'_j`, with the elasticity D at rest
//! ([`crate::average::Damping`]).
//!
//! *Velocities*: the rates of the displacement are no longer the velocity,
//!
//! ```math
//! x_i/h = v(c_i) + beta p_i gamma,    gamma = Pi delta_v,    delta_v = sum_j b_j p_j v'_j
//! ```
//!
//! The angular momentum also changes by `sum_A x_iA x (M v)_iA`, whose average over the step is zero if gamma is
//! M-orthogonal to the three vectors `e x delta_q`, `delta_q = sum_j b_j p_j x_j`. The centre of mass has the velocity
//! of the momentum if gamma is orthogonal to the translations e. Pi is the projection onto these conditions. The
//! dissipated energy is `beta delta_v . M Pi delta_v >= 0`. A body in a relative equilibrium, which rotates as if it
//! were rigid, has its `delta_v` in the span of those vectors for k = 1, so no energy is dissipated. (This is the aim
//! of Armero and Romero 2001, On the formulation of high-frequency dissipative time-stepping algorithms for nonlinear
//! dynamics, Computer Methods in Applied Mechanics and Engineering 190, who reach it by scaling velocities node by
//! node.)
//!
//! With `w_j = x_j/h - v_1`, gamma and the momentum follow from the unknowns alone:
//!
//! ```math
//! gamma = (delta_w - U lambda) / (1 + chi),    delta_w = sum_j eta_j w_j,    eta_j = sum_i b_i p_i (a^-1)_ij
//! ```
//!
//! where the columns of U are those six vectors and `U^T M (delta_w - U lambda) = 0`; this needs no solution with M.

#![allow(non_snake_case)]

mod damping;
mod rigid_part;

pub(crate) use self::damping::SchemeDamping;
use self::rigid_part::{RigidPart, RigidVelocity, inertia_times};
use crate::body::Body;
use crate::nodal;
use crate::tensor::cross;

/// The term that a dissipative scheme adds to the stage equations; nothing for other schemes.
#[derive(Debug)]
pub(super) struct SchemeForce {
    rigid: Option<RigidMotions>,
    /// Momentum at the start of the step.
    momentum: Vec<f64>,
}

impl SchemeForce {
    /// Memory for a body.
    pub(super) fn new(body: &Body, damping: Option<SchemeDamping>) -> Self {
        let momentum = vec![0.0; if damping.is_some() { body.n_dofs() } else { 0 }];
        let rigid = damping.map(|damping| RigidMotions::new(body, damping));
        SchemeForce { rigid, momentum }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.rigid.is_none()
    }

    /// Begins a step with a momentum.
    pub(super) fn begin(&mut self, momentum: &[f64]) {
        if !self.is_zero() {
            self.momentum.copy_from_slice(momentum);
        }
    }

    /// Adds the force at the rates x, with M x, to the residuals of the stages.
    pub(super) fn add_to_residual(
        &mut self,
        body: &Body,
        (rates, mass_rates): (&[f64], &[f64]),
        h: f64,
        residual: &mut [f64],
    ) {
        if let Some(rigid) = &mut self.rigid {
            rigid.set(body, rates, mass_rates, &self.momentum, h);
            rigid.parts.iter().for_each(|part| rigid.add(part, part.multipliers, h, residual));
        }
    }

    /// Adds the derivatives of the force along dx.
    pub(super) fn add_derivative(&mut self, body: &Body, h: f64, dx: &[f64], residual: &mut [f64]) {
        if let Some(rigid) = &mut self.rigid {
            rigid.add_derivative(body, h, dx, residual);
        }
    }

    /// Corrects a right-hand side for the approximate tangent, which does not know the force.
    pub(super) fn correct(&mut self, body: &Body, right: &mut [f64]) {
        if let Some(rigid) = &mut self.rigid {
            rigid.correct(body, right);
            body.space.clear_inactive(right);
        }
    }

    /// Completes the new velocity by that of the force at the rates x, with M x, and returns the energy dissipated
    /// through velocities; `velocity`: at the start of the step.
    pub(super) fn complete_end_velocity(
        &mut self,
        body: &Body,
        (rates, mass_rates): (&[f64], &[f64]),
        velocity: &[f64],
        h: f64,
        new: &mut [f64],
    ) -> f64 {
        let Some(rigid) = &mut self.rigid else { return 0.0 };
        rigid.set(body, rates, mass_rates, &self.momentum, h);
        rigid.complete_end_velocity(body, rates, velocity, h, new)
    }
}

/// Projection on translations and rotations without dissipation, for the unknowns of a step. Each component between
/// joints has its own: joints let them move relative to each other without strain.
#[derive(Debug)]
struct RigidMotions {
    damping: SchemeDamping,
    parts: Vec<RigidPart>,
    /// `sum_B M_AB`, one number per node.
    row_sums: Vec<f64>,
    /// delta_q minus its mean, and M times this vector.
    arm: Vec<f64>,
    weighted_arm: Vec<f64>,
    /// M delta_w.
    momentum: Vec<f64>,
    change: Change,
}

/// Memory for derivatives.
#[derive(Debug)]
struct Change {
    arm: Vec<f64>,
    weighted_arm: Vec<f64>,
    velocity: Vec<f64>,
    momentum: Vec<f64>,
}

impl RigidMotions {
    /// Memory for a body.
    fn new(body: &Body, damping: SchemeDamping) -> Self {
        let n = body.n_dofs();
        let mut row_sums = vec![0.0; n];
        body.mass_product(&vec![1.0; n], &mut row_sums);
        let row_sums: Vec<f64> = row_sums.into_iter().step_by(3).collect();
        let zero = vec![0.0; n];
        let change = [(); 4].map(|()| zero.clone());
        let [arm, weighted_arm, velocity, momentum] = change;
        RigidMotions {
            damping,
            parts: RigidPart::all(body, &row_sums),
            row_sums,
            arm: zero.clone(),
            weighted_arm: zero.clone(),
            momentum: zero,
            change: Change { arm, weighted_arm, velocity, momentum },
        }
    }

    /// Finds lambda for the rates x; `mass_rates`: M x, `[k][dof]`; `momentum`: p_1.
    fn set(&mut self, body: &Body, rates: &[f64], mass_rates: &[f64], momentum: &[f64], h: f64) {
        let RigidMotions { damping, parts, row_sums, arm, weighted_arm, momentum: own, .. } = self;
        let SchemeDamping { highest_mode, eta, .. } = damping;
        combine(highest_mode, rates, arm);
        combine(highest_mode, mass_rates, weighted_arm);
        combine(eta, mass_rates, own);
        let start: f64 = eta.iter().sum();
        own.iter_mut().zip(momentum).for_each(|(m, p)| *m = *m / h - start * p);
        for part in parts {
            let mean = part.mean(body, weighted_arm);
            part.subtract(mean, row_sums, arm, weighted_arm);
            part.tensor = part.outer(arm, weighted_arm);
            body.space.sum_ranks("tensor of the arms", part.tensor.as_flattened_mut());
            part.multipliers = part.projected(part.sum(body, own), part.moment(body, (arm, own)));
        }
    }

    /// Adds the derivatives of `h weight_i M U lambda` along dx, `[k][dof]`.
    ///
    /// ```math
    /// d(M U lambda) = M U dlambda + lambda x M d(arm)
    /// ```
    fn add_derivative(&mut self, body: &Body, h: f64, dx: &[f64], residual: &mut [f64]) {
        let Change { arm, weighted_arm, velocity, momentum } = &mut self.change;
        combine(&self.damping.highest_mode, dx, arm);
        combine(&self.damping.eta, dx, velocity);
        velocity.iter_mut().for_each(|v| *v /= h);
        body.mass_product(arm, weighted_arm);
        body.mass_product(velocity, momentum);
        let n = self.arm.len();
        for part in &self.parts {
            let Change { arm, weighted_arm, momentum, .. } = &mut self.change;
            let mean = part.mean(body, weighted_arm);
            part.subtract(mean, &self.row_sums, arm, weighted_arm);
            let first = part.outer(arm, &self.weighted_arm);
            let second = part.outer(&self.arm, weighted_arm);
            let mut change = [0, 1, 2].map(|i| [0, 1, 2].map(|j| first[i][j] + second[i][j]));
            body.space.sum_ranks("change of the tensor of the arms", change.as_flattened_mut());
            let turned = inertia_times(&change, part.multipliers.turn);
            let own = part.moment(body, (&self.arm, momentum));
            let other = part.moment(body, (arm, &self.momentum));
            let right = [0, 1, 2].map(|d| own[d] + other[d] - turned[d]);
            let change = part.projected(part.sum(body, momentum), right);
            self.add(part, change, h, residual);
            let weighted_arm = &self.change.weighted_arm;
            for (stage, weight) in residual.chunks_exact_mut(n).zip(&self.damping.stage_weights) {
                for node in part.nodes() {
                    let across = cross(part.multipliers.turn, nodal::at(weighted_arm, node));
                    let value = nodal::at_mut(stage, node);
                    (0..3).for_each(|d| value[d] += h * weight * across[d]);
                }
            }
        }
    }

    /// Corrects a right-hand side for the approximate tangent, which also damps rigid motions: it becomes `(A^-1 a) r`
    /// in that subspace, where the strain response is neglected.
    fn correct(&mut self, body: &Body, right: &mut [f64]) {
        combine(&self.damping.highest_mode, right, &mut self.change.momentum);
        let momentum = &self.change.momentum;
        for part in &self.parts {
            let motion = part.projected(part.sum(body, momentum), part.moment(body, (&self.arm, momentum)));
            self.add(part, motion, -1.0, right);
        }
    }

    /// Adds `end_weight U lambda` to the new velocity, which already has its first part, and returns the energy
    /// dissipated through velocities, `beta gamma . M gamma`; `velocity`: v_1.
    fn complete_end_velocity(
        &mut self,
        body: &Body,
        rates: &[f64],
        velocity: &[f64],
        h: f64,
        new: &mut [f64],
    ) -> f64 {
        let SchemeDamping { eta, end_weight, excess, strength, .. } = &self.damping;
        combine(eta, rates, &mut self.change.velocity);
        let start: f64 = eta.iter().sum();
        let mut square = 0.0;
        let nodes = self.parts.iter().flat_map(|part| part.nodes().map(move |node| (part, node)));
        for (part, node) in nodes {
            let at = |values: &[f64]| nodal::at(values, node);
            let moved = part.multipliers.at(at(&self.arm));
            let weighted = part.multipliers.times(self.row_sums[node], at(&self.weighted_arm));
            for d in 0..3 {
                let dof = nodal::dof(node, d);
                let delta = self.change.velocity[dof] / h - start * velocity[dof];
                square += (delta - moved[d]) * (self.momentum[dof] - weighted[d]);
                new[dof] += end_weight * moved[d];
            }
        }
        let mut square = [square];
        body.space.sum_ranks("energy dissipated by velocities", &mut square);
        excess * square[0] / (1.0 + strength).powi(2)
    }

    /// Adds `factor weight_i M U motion` of a part to the stages.
    fn add(&self, part: &RigidPart, motion: RigidVelocity, factor: f64, stages: &mut [f64]) {
        let n = self.arm.len();
        for (stage, weight) in stages.chunks_exact_mut(n).zip(&self.damping.stage_weights) {
            for node in part.nodes() {
                let weighted = motion.times(self.row_sums[node], nodal::at(&self.weighted_arm, node));
                let value = nodal::at_mut(stage, node);
                (0..3).for_each(|d| value[d] += factor * weight * weighted[d]);
            }
        }
    }
}

/// `sum_j factors_j stages_j`.
fn combine(factors: &[f64], stages: &[f64], result: &mut [f64]) {
    result.fill(0.0);
    for (factor, stage) in factors.iter().zip(stages.chunks_exact(result.len())) {
        result.iter_mut().zip(stage).for_each(|(sum, x)| *sum += factor * x);
    }
}
