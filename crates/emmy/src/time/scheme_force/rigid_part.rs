//! Translations and rotations that a dissipative scheme spares.

#![allow(non_snake_case)]

use crate::body::Body;
use crate::nodal;
use crate::tensor::{Mat3, SYM, cross, eigen};
use crate::unknowns::Component;

/// The translations and rotations of a component, or of the body.
#[derive(Debug)]
pub(super) struct RigidPart {
    component: Component,
    /// Whether it is the whole body, of all ranks.
    is_whole: bool,
    /// Directions without a fixed node.
    translations: [bool; 3],
    /// Axes perpendicular to which every node is free, or all nodes are fixed.
    turns: [bool; 3],
    mass: f64,
    /// `sum_A arm_A (M arm)_A^T`.
    pub tensor: Mat3<f64>,
    /// lambda.
    pub multipliers: RigidVelocity,
}

/// Coefficients of the six vectors: a translation, and a rotation of the arms.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct RigidVelocity {
    pub translation: [f64; 3],
    pub turn: [f64; 3],
}

/// Rotations with less than this part of the largest moment of inertia are rounding.
const NO_TURN: f64 = 1e-13;

impl RigidPart {
    /// The parts of a body with a mass of each row.
    pub(super) fn all(body: &Body, row_sums: &[f64]) -> Vec<Self> {
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
            component: Component::whole(row_sums.len()),
            is_whole: true,
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
            component: component.clone(),
            is_whole: false,
            translations: [0, 1, 2].map(|d| !fixed().any(|node| node[d])),
            turns: [0, 1, 2].map(|axis| !fixed().any(|node| holds(&node, axis))),
            mass: component.nodes().map(|node| row_sums[node]).sum(),
            tensor: [[0.0; 3]; 3],
            multipliers: RigidVelocity::default(),
        }
    }

    /// Its nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> {
        self.component.nodes()
    }

    /// Sum of a nodal vector.
    pub(super) fn sum(&self, body: &Body, vector: &[f64]) -> [f64; 3] {
        if self.is_whole {
            return body.space.sum(vector);
        }
        let mut sum = [0.0; 3];
        for node in self.nodes() {
            (0..3).for_each(|d| sum[d] += vector[nodal::dof(node, d)]);
        }
        sum
    }

    /// `sum_A a_A x b_A`.
    pub(super) fn moment(&self, body: &Body, (a, b): (&[f64], &[f64])) -> [f64; 3] {
        if !self.is_whole {
            return moment_of(self.nodes(), a, b);
        }
        let mut sum = moment_of(body.space.counted_nodes(), a, b);
        body.space.sum_ranks("moment of a momentum", &mut sum);
        sum
    }

    /// `sum_A a_A b_A^T` of this rank.
    pub(super) fn outer(&self, a: &[f64], b: &[f64]) -> Mat3<f64> {
        self.component.products(|node| [nodal::at(a, node), nodal::at(b, node)])
    }

    /// Mean of arms in the directions without a fixed node, from their products with M.
    pub(super) fn mean(&self, body: &Body, weighted: &[f64]) -> [f64; 3] {
        let total = self.sum(body, weighted);
        [0, 1, 2].map(|d| if self.translations[d] { total[d] / self.mass } else { 0.0 })
    }

    /// Subtracts a mean from arms and from their products with M.
    pub(super) fn subtract(&self, mean: [f64; 3], row_sums: &[f64], arm: &mut [f64], weighted: &mut [f64]) {
        for node in self.nodes() {
            let (arm, weighted) = (nodal::at_mut(arm, node), nodal::at_mut(weighted, node));
            let mass = row_sums[node];
            (0..3).for_each(|d| (arm[d], weighted[d]) = (arm[d] - mean[d], weighted[d] - mass * mean[d]));
        }
    }

    /// `(U^T M U)^-1` times total and moment of a momentum.
    pub(super) fn projected(&self, total: [f64; 3], moment: [f64; 3]) -> RigidVelocity {
        let translation = [0, 1, 2].map(|d| if self.translations[d] { total[d] / self.mass } else { 0.0 });
        RigidVelocity { translation, turn: turn_of(&self.tensor, self.turns, moment) }
    }
}

/// Whether a node with fixed components holds the turn about an axis.
fn holds(fixed: &[bool; 3], axis: usize) -> bool {
    let across = [fixed[(axis + 1) % 3], fixed[(axis + 2) % 3]];
    across != [false; 2] && *fixed != [true; 3]
}

impl RigidVelocity {
    /// Velocity at an arm.
    pub(super) fn at(&self, arm: [f64; 3]) -> [f64; 3] {
        self.times(1.0, arm)
    }

    /// The same times a mass; `arm`: the arm times the mass.
    pub(super) fn times(&self, mass: f64, arm: [f64; 3]) -> [f64; 3] {
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
pub(super) fn inertia_times(T: &Mat3<f64>, v: [f64; 3]) -> [f64; 3] {
    let trace = T[0][0] + T[1][1] + T[2][2];
    [0, 1, 2].map(|i| trace * v[i] - (0..3).map(|j| T[j][i] * v[j]).sum::<f64>())
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

    fn outer(arms: &[f64]) -> Mat3<f64> {
        Component::whole(arms.len() / 3).products(|node| [nodal::at(arms, node); 2])
    }

    #[test]
    fn a_turn_has_the_moment_asked_for() {
        // Arms of unit masses: the moment of `turn x arm` equals the given moment, and a line of arms cannot rotate
        // about itself.
        let arms = [0.3, -0.2, 0.5, 0.9, 0.1, -0.4, -1.2, 0.1, -0.1];
        let turn = turn_of(&outer(&arms), [true; 3], [0.3, 0.7, -0.2]);
        let moved: Vec<f64> = arms.as_chunks().0.iter().flat_map(|arm| cross(turn, *arm)).collect();
        let found = moment_of(0..3, &arms, &moved);
        assert!((0..3).all(|d| (found[d] - [0.3, 0.7, -0.2][d]).abs() < 1e-14), "{found:?}");
        let line = [0.6, 0.0, 0.8, -1.2, 0.0, -1.6];
        let turn = turn_of(&outer(&line), [true; 3], [0.0, 5.0, 0.0]);
        assert!((turn[1] - 1.0).abs() < 1e-14 && turn[0].abs() + turn[2].abs() < 1e-14);
        assert_eq!(turn_of(&outer(&line), [true, false, true], [0.0, 5.0, 0.0]), [0.0; 3]);
    }
}
