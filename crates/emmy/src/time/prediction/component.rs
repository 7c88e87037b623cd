//! Rigid motions of components in a step.

use crate::body::Body;
use crate::nodal;
use crate::tensor::cross;
use crate::time::best_fit;
use crate::time::rigid_step::RigidStep;
use crate::time::stage_coefficients::StageCoefficients;
use crate::unknowns::Component;

/// The rigid motion of a component in a step.
#[derive(Debug)]
pub(super) struct ComponentMotion {
    component: Component,
    /// Whether supports hold some of it: then it has no rigid motion.
    is_held: bool,
    pub rigid: RigidStep,
    /// Translation rates X_j.
    pub translation: Vec<[f64; 3]>,
    /// Translation rates and spins that fitted the last step, `[k]`.
    last: [Vec<[f64; 3]>; 2],
}

impl ComponentMotion {
    /// Memory for the components of a body between its joints, or for the body.
    pub(super) fn all(k: usize, body: &Body) -> Vec<Self> {
        let motion = |component: Component, is_held: bool| ComponentMotion {
            component,
            is_held,
            rigid: RigidStep::new(k),
            translation: vec![[0.0; 3]; k],
            last: [vec![[0.0; 3]; k], vec![[0.0; 3]; k]],
        };
        let components = &body.mechanism.components;
        if components.is_empty() {
            return vec![motion(Component::whole(body.n_dofs() / 3), false)];
        }
        components.iter().map(|component| motion(component.clone(), body.holds(component))).collect()
    }

    /// Its nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        self.component.nodes()
    }

    /// No motion.
    pub(super) fn set_rest(&mut self) {
        self.translation.fill([0.0; 3]);
        self.rigid.set_rest();
    }

    /// Sets the positions of its nodes about their mean.
    pub(super) fn set_arm(&self, body: &Body, displacement: &[f64], arm: &mut [f64]) {
        let position = |node: usize| body.space.position(displacement, node);
        let centre = self.component.mean(position);
        for node in self.nodes() {
            let x = position(node);
            *nodal::at_mut(arm, node) = [0, 1, 2].map(|d| x[d] - centre[d]);
        }
    }

    /// Fits the motion to a velocity, the same at all stages.
    pub(super) fn fit_velocity(&mut self, arm: &[f64], velocity: &[f64]) {
        if !self.is_held {
            let fitted = best_fit::rates(
                &self.component,
                |node| nodal::at(arm, node),
                |node| nodal::at(velocity, node),
            );
            self.last.iter_mut().zip(fitted).for_each(|(last, own)| last.fill(own));
        }
    }

    /// Takes the motion that fits a velocity from that.
    pub(super) fn take_velocity(&self, arm: &[f64], velocity: &mut [f64]) {
        let [rate, spin] = self.last.each_ref().map(|last| last[0]);
        for node in self.nodes() {
            let turned = cross(spin, nodal::at(arm, node));
            let own = nodal::at_mut(velocity, node);
            (0..3).for_each(|d| own[d] -= rate[d] + turned[d]);
        }
    }

    /// Continues the last motion with the coefficients `e_jl`.
    pub(super) fn continue_last(&mut self, stage: &StageCoefficients, continuation: &[f64]) {
        let k = self.translation.len();
        let [rates, spins] = &self.last;
        let continued = |last: &[[f64; 3]], j: usize| {
            let terms = continuation[j * k..].iter().zip(last);
            terms.fold([0.0; 3], |sum, (e, own)| [0, 1, 2].map(|d| sum[d] + e * own[d]))
        };
        (0..k).for_each(|j| self.translation[j] = continued(rates, j));
        self.rigid.follow(stage, (0..k).map(|j| continued(spins, j)));
    }

    /// Fits the motion to the rates of a step from some arms.
    pub(super) fn fit(&mut self, stage: &StageCoefficients, arm: &[f64], rates: &[f64]) {
        if self.is_held {
            return;
        }
        let (n, k) = (arm.len(), self.translation.len());
        let a = stage.rule.coefficients();
        for i in 0..k {
            let position = |node: usize| {
                let mut q = nodal::at(arm, node);
                for (a, rates) in a[i * k..].iter().zip(rates.chunks_exact(n)) {
                    let x = nodal::at(rates, node);
                    (0..3).for_each(|d| q[d] += a * x[d]);
                }
                q
            };
            let of_stage = &rates[i * n..];
            let fitted = best_fit::rates(&self.component, position, |node| nodal::at(of_stage, node));
            self.last.iter_mut().zip(fitted).for_each(|(last, own)| last[i] = own);
        }
        self.translation.copy_from_slice(&self.last[0]);
        self.rigid.follow(stage, self.last[1].iter().copied());
    }

    /// Translation rates and spins that fitted the last step.
    pub(super) fn last(&self) -> impl Iterator<Item = f64> + '_ {
        self.last.iter().flatten().flatten().copied()
    }

    /// Restores those of [`ComponentMotion::last`].
    pub(super) fn restore(&mut self, last: &[f64]) {
        self.last.iter_mut().flatten().flatten().zip(last).for_each(|(own, last)| *own = *last);
    }
}
