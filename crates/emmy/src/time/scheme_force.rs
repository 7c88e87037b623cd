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

use crate::average::Rule;
use crate::body::Body;
use crate::nodal;
use crate::tensor::{Mat3, SYM, cross, eigen};
use crate::unknowns::Component;

/// The coefficients of a dissipative time element.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SchemeDamping {
    /// chi.
    strength: f64,
    /// beta.
    pub excess: f64,
    /// `b_j p_j`.
    highest_mode: Vec<f64>,
    /// eta_j.
    eta: Vec<f64>,
    /// `beta mu_i / (1 + chi)`, `mu_i = sum_j (a^-1)_ij p_j`: coefficients of U lambda in the stage equations.
    stage_weights: Vec<f64>,
    /// Coefficient of U lambda in the new velocity.
    end_weight: f64,
}

impl SchemeDamping {
    /// The dissipation of a rule with a spectral radius at infinity; `inverse`: a^-1, `[i k + j]`.
    pub(crate) fn new(rule: &Rule, inverse: &[f64], spectral_radius: f64) -> Self {
        let k = rule.degree();
        let b = rule.weights();
        let p = rule.highest_mode();
        let strength = (1.0 - spectral_radius) / (1.0 + spectral_radius);
        let excess = strength / (2 * (2 * k - 1)) as f64;
        let row = |i: usize| (0..k).map(|j| inverse[i * k + j] * p[j]).sum::<f64>();
        let stage_weights: Vec<f64> = (0..k).map(|i| excess * row(i) / (1.0 + strength)).collect();
        SchemeDamping {
            strength,
            excess,
            highest_mode: (0..k).map(|j| b[j] * p[j]).collect(),
            eta: (0..k).map(|j| (0..k).map(|i| b[i] * p[i] * inverse[i * k + j]).sum()).collect(),
            end_weight: stage_weights.iter().zip(b).map(|(weight, b)| weight * b).sum(),
            stage_weights,
        }
    }

    /// Coefficients that replace a, `[i k + j]`.
    pub(crate) fn coefficients(&self, rule: &Rule) -> Vec<f64> {
        let k = rule.degree();
        let p = rule.highest_mode();
        let excess = |n: usize| self.excess * p[n / k] * self.highest_mode[n % k];
        rule.coefficients().iter().enumerate().map(|(n, a)| a + excess(n)).collect()
    }
}

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

/// The translations and rotations of a component, or of the body.
#[derive(Debug)]
struct RigidPart {
    /// Nodes; without them all of all ranks.
    component: Option<Component>,
    /// Directions without a fixed node.
    translations: [bool; 3],
    /// Axes perpendicular to which every node is free, or all nodes are fixed.
    turns: [bool; 3],
    mass: f64,
    /// `sum_A arm_A (M arm)_A^T`.
    tensor: Mat3<f64>,
    /// lambda.
    multipliers: RigidVelocity,
}

/// Coefficients of the six vectors: a translation, and a rotation of the arms.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct RigidVelocity {
    translation: [f64; 3],
    turn: [f64; 3],
}

/// Memory for derivatives.
#[derive(Debug)]
struct Change {
    arm: Vec<f64>,
    weighted_arm: Vec<f64>,
    velocity: Vec<f64>,
    momentum: Vec<f64>,
}

/// Rotations with less than this part of the largest moment of inertia are rounding.
const NO_TURN: f64 = 1e-13;

impl RigidPart {
    /// The parts of a body with a mass of each row.
    fn all(body: &Body, row_sums: &[f64]) -> Vec<Self> {
        let components = &body.mechanism.components;
        if components.is_empty() {
            return vec![Self::whole(body, row_sums)];
        }
        components.iter().map(|component| Self::of(body, component, row_sums)).collect()
    }

    fn whole(body: &Body, row_sums: &[f64]) -> Self {
        let held = [0, 1, 2].map(|axis| body.fixed().as_chunks::<3>().0.iter().any(|node| holds(node, axis)));
        let mut held = held.map(|held| f64::from(u8::from(held)));
        body.space.largest_of_ranks("axes that supports hold", &mut held);
        let mut mass = [row_sums.iter().sum()];
        body.space.sum_ranks("mass of the rows", &mut mass);
        RigidPart {
            component: None,
            translations: body.space.held_axes().map(|held| !held),
            turns: held.map(|held| held == 0.0),
            mass: mass[0],
            tensor: [[0.0; 3]; 3],
            multipliers: RigidVelocity::default(),
        }
    }

    fn of(body: &Body, component: &Component, row_sums: &[f64]) -> Self {
        let leads = |node: &usize| body.space.ties().leaders_of(*node as u32).is_none();
        let fixed = || component.nodes().filter(leads).map(|node| nodal::at(body.fixed(), node));
        RigidPart {
            component: Some(component.clone()),
            translations: [0, 1, 2].map(|d| !fixed().any(|node| node[d])),
            turns: [0, 1, 2].map(|axis| !fixed().any(|node| holds(&node, axis))),
            mass: component.nodes().map(|node| row_sums[node]).sum(),
            tensor: [[0.0; 3]; 3],
            multipliers: RigidVelocity::default(),
        }
    }

    /// Its nodes among n on this rank.
    fn nodes(&self, n: usize) -> impl Iterator<Item = usize> {
        let (own, all) = match &self.component {
            Some(component) => (Some(component.nodes()), 0..0),
            None => (None, 0..n),
        };
        own.into_iter().flatten().chain(all)
    }

    /// Sum of a nodal vector.
    fn sum(&self, body: &Body, vector: &[f64]) -> [f64; 3] {
        let Some(component) = &self.component else { return body.space.sum(vector) };
        let mut sum = [0.0; 3];
        for node in component.nodes() {
            (0..3).for_each(|d| sum[d] += vector[nodal::dof(node, d)]);
        }
        sum
    }

    /// `sum_A a_A x b_A`.
    fn moment(&self, body: &Body, (a, b): (&[f64], &[f64])) -> [f64; 3] {
        match &self.component {
            Some(component) => moment_of(component.nodes(), a, b),
            None => moment(body, (a, b)),
        }
    }

    /// `sum_A a_A b_A^T` of this rank.
    fn outer(&self, a: &[f64], b: &[f64]) -> Mat3<f64> {
        match &self.component {
            Some(component) => component.products(|node| [nodal::at(a, node), nodal::at(b, node)]),
            None => outer(a, b),
        }
    }

    /// Mean of arms in the directions without a fixed node, from their products with M.
    fn mean(&self, body: &Body, weighted: &[f64]) -> [f64; 3] {
        let total = self.sum(body, weighted);
        [0, 1, 2].map(|d| if self.translations[d] { total[d] / self.mass } else { 0.0 })
    }

    /// Subtracts a mean from arms and from their products with M.
    fn subtract(&self, mean: [f64; 3], row_sums: &[f64], arm: &mut [f64], weighted: &mut [f64]) {
        for node in self.nodes(row_sums.len()) {
            let (arm, weighted) = (nodal::at_mut(arm, node), nodal::at_mut(weighted, node));
            let mass = row_sums[node];
            (0..3).for_each(|d| (arm[d], weighted[d]) = (arm[d] - mean[d], weighted[d] - mass * mean[d]));
        }
    }

    /// `(U^T M U)^-1` times total and moment of a momentum.
    fn projected(&self, total: [f64; 3], moment: [f64; 3]) -> RigidVelocity {
        let translation = [0, 1, 2].map(|d| if self.translations[d] { total[d] / self.mass } else { 0.0 });
        RigidVelocity { translation, turn: turn_of(&self.tensor, self.turns, moment) }
    }
}

/// Whether a node with fixed components holds the turn about an axis.
fn holds(fixed: &[bool; 3], axis: usize) -> bool {
    let across = [fixed[(axis + 1) % 3], fixed[(axis + 2) % 3]];
    across != [false; 2] && *fixed != [true; 3]
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
                for node in part.nodes(self.row_sums.len()) {
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
        let nodes =
            self.parts.iter().flat_map(|part| part.nodes(self.row_sums.len()).map(move |node| (part, node)));
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
            for node in part.nodes(self.row_sums.len()) {
                let weighted = motion.times(self.row_sums[node], nodal::at(&self.weighted_arm, node));
                let value = nodal::at_mut(stage, node);
                (0..3).for_each(|d| value[d] += factor * weight * weighted[d]);
            }
        }
    }
}

impl RigidVelocity {
    /// Velocity at an arm.
    fn at(&self, arm: [f64; 3]) -> [f64; 3] {
        self.times(1.0, arm)
    }

    /// The same times a mass; `arm`: the arm times the mass.
    fn times(&self, mass: f64, arm: [f64; 3]) -> [f64; 3] {
        let turned = cross(self.turn, arm);
        [0, 1, 2].map(|d| mass * self.translation[d] + turned[d])
    }
}

/// The rotation about the allowed axes with a given moment, `sum_A arm_A x M (turn x arm)_A`: the smallest one if a
/// line of arms has no moment of inertia.
fn turn_of(tensor: &Mat3<f64>, axes: [bool; 3], moment: [f64; 3]) -> [f64; 3] {
    let trace = tensor[0][0] + tensor[1][1] + tensor[2][2];
    let inertia = |i: usize, j: usize| match axes[i] && axes[j] {
        true => (if i == j { trace } else { 0.0 }) - 0.5 * (tensor[i][j] + tensor[j][i]),
        false => 0.0,
    };
    let (values, vectors) = eigen(&SYM.map(|(i, j)| inertia(i, j)));
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(*value));
    let mut turn = [0.0; 3];
    for (m, &value) in values.iter().enumerate().filter(|(_, value)| **value > NO_TURN * largest) {
        let part: f64 = (0..3).filter(|&d| axes[d]).map(|d| vectors[d][m] * moment[d]).sum();
        (0..3).for_each(|d| turn[d] += vectors[d][m] * part / value);
    }
    turn
}

/// `(tr T 1 - T) v` of a symmetric T.
fn inertia_times(T: &Mat3<f64>, v: [f64; 3]) -> [f64; 3] {
    let trace = T[0][0] + T[1][1] + T[2][2];
    [0, 1, 2].map(|i| trace * v[i] - (0..3).map(|j| T[j][i] * v[j]).sum::<f64>())
}

/// `sum_j factors_j stages_j`.
fn combine(factors: &[f64], stages: &[f64], result: &mut [f64]) {
    result.fill(0.0);
    for (factor, stage) in factors.iter().zip(stages.chunks_exact(result.len())) {
        result.iter_mut().zip(stage).for_each(|(sum, x)| *sum += factor * x);
    }
}

/// `sum_A a_A b_A^T`.
fn outer(a: &[f64], b: &[f64]) -> Mat3<f64> {
    let mut sum = [[0.0; 3]; 3];
    for (a, b) in a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0) {
        (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += a[i] * b[j]));
    }
    sum
}

/// `sum_A a_A x b_A` over the nodes of all ranks.
fn moment(body: &Body, (a, b): (&[f64], &[f64])) -> [f64; 3] {
    let mut sum = moment_of(body.space.counted_nodes(), a, b);
    body.space.sum_ranks("moment of a momentum", &mut sum);
    sum
}

/// `sum_A a_A x b_A` over some nodes.
fn moment_of(nodes: impl Iterator<Item = usize>, a: &[f64], b: &[f64]) -> [f64; 3] {
    let (a, b) = (a.as_chunks::<3>().0, b.as_chunks::<3>().0);
    let mut sum = [0.0; 3];
    for node in nodes {
        let part = cross(a[node], b[node]);
        (0..3).for_each(|d| sum[d] += part[d]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::inverse;

    /// `1 + z b^T (1 - z a)^-1 1` for a real z, by the inverse of the matrix.
    fn stability(rule: &Rule, a: &[f64], z: f64) -> f64 {
        let k = rule.degree();
        let matrix: Vec<f64> =
            (0..k * k).map(|n| (if n / k == n % k { 1.0 } else { 0.0 }) - z * a[n]).collect();
        let inverse = inverse(&matrix);
        let rows = (0..k).map(|i| rule.weights()[i] * (0..k).map(|j| inverse[i * k + j]).sum::<f64>());
        1.0 + z * rows.sum::<f64>()
    }

    fn dissipation(k: usize, radius: f64) -> (Rule, SchemeDamping) {
        let rule = Rule::discrete_gradient(k);
        let dissipation = SchemeDamping::new(&rule, &inverse(rule.coefficients()), radius);
        (rule, dissipation)
    }

    #[test]
    fn the_spectral_radius_at_infinity_matches_the_request() {
        for (k, radius) in (1..=5).flat_map(|k| [0.0, 0.3, 0.8, 1.0].map(|radius| (k, radius))) {
            let (rule, dissipation) = dissipation(k, radius);
            let found = stability(&rule, &dissipation.coefficients(&rule), -1e9).abs();
            assert!((found - radius).abs() < 1e-6, "{k}: {found} is not {radius}");
        }
    }

    #[test]
    fn full_dissipation_is_radau_iia() {
        // Its stability functions are the subdiagonal Pade approximants of exp: 1/(1 - z), (1 + z/3)/(1 - 2 z/3 +
        // z^2/6).
        for z in [-3.0, -0.7, 0.4] {
            let (rule, full) = dissipation(1, 0.0);
            assert!((stability(&rule, &full.coefficients(&rule), z) - 1.0 / (1.0 - z)).abs() < 1e-14);
            let (rule, full) = dissipation(2, 0.0);
            let pade = (1.0 + z / 3.0) / (1.0 - 2.0 / 3.0 * z + z * z / 6.0);
            assert!((stability(&rule, &full.coefficients(&rule), z) - pade).abs() < 1e-14);
        }
    }

    #[test]
    fn a_turn_has_the_moment_asked_for() {
        // Arms of unit masses: the moment of `turn x arm` equals the given moment, and a line of arms cannot rotate
        // about itself.
        let arms = [0.3, -0.2, 0.5, 0.9, 0.1, -0.4, -1.2, 0.1, -0.1];
        let turn = turn_of(&outer(&arms, &arms), [true; 3], [0.3, 0.7, -0.2]);
        let moved: Vec<f64> = arms.as_chunks().0.iter().flat_map(|arm| cross(turn, *arm)).collect();
        let found = moment_of(0..3, &arms, &moved);
        assert!((0..3).all(|d| (found[d] - [0.3, 0.7, -0.2][d]).abs() < 1e-14), "{found:?}");
        let line = [0.6, 0.0, 0.8, -1.2, 0.0, -1.6];
        let turn = turn_of(&outer(&line, &line), [true; 3], [0.0, 5.0, 0.0]);
        assert!((turn[1] - 1.0).abs() < 1e-14 && turn[0].abs() + turn[2].abs() < 1e-14);
        assert_eq!(turn_of(&outer(&line, &line), [true, false, true], [0.0, 5.0, 0.0]), [0.0; 3]);
    }
}
