//! Masses that carry massless directions of rigid bodies through linear solvers.
//!
//! The nodes of a plane face leave the direction off the plane of their frame without mass: M n = 0 for the motion n of
//! the four nodes that vanishes on the plane. The constraints of the frame determine it, but the approximate inverse of
//! the equations of a step has no finite value there. The same holds for two directions of a rod, whose spin about
//! itself a joint holds. A carrier S = sigma n n^T is added to the mass in the factors, and the exact derivative of the
//! equations of the joint nodes takes it off again. It is in no momentum and no energy.

use super::frame::{Frame, without_directions};
use crate::error::{Error, Result};
use crate::nodal;
use crate::sparse::{Pattern, null_space_within};

/// A mass in a direction of a frame without mass.
#[derive(Debug, Clone)]
pub(crate) struct Carrier {
    nodes: Vec<u32>,
    /// sqrt(sigma) n.
    weights: Vec<f64>,
}

/// Part of the largest mass of a direction below which there is none.
const LEAST: f64 = 1e-9;

impl Carrier {
    /// The carriers of a frame: none, one of a flat body, two of a rod.
    ///
    /// # Errors
    /// [`crate::Error::Rigid`] for a group whose nodes lie on a line, or have no mass.
    pub(crate) fn of(frame: &Frame, pattern: &Pattern, mass: &[f64]) -> Result<Vec<Self>> {
        let nodes: Vec<u32> = frame.nodes().collect();
        if nodes.len() == 1 {
            return Ok(Vec::new());
        }
        let entry = |a: &u32, b: &u32| mass[pattern.coupling(*a as usize, *b as usize)];
        let own: Vec<f64> = nodes.iter().flat_map(|a| nodes.iter().map(move |b| entry(a, b))).collect();
        let largest = own.iter().fold(0.0f64, |most, m| most.max(m.abs()));
        if largest == 0.0 {
            let reason = "its nodes have no mass".to_string();
            return Err(Error::Rigid { body: frame.name().to_string(), reason });
        }
        let scaled: Vec<f64> = own.iter().map(|m| m / largest).collect();
        let massless = null_space_within(&scaled, LEAST)?;
        if massless.len() > 1 && frame.has_members() {
            return Err(without_directions(frame.body()));
        }
        let carrier = |n: Vec<f64>| Carrier {
            nodes: nodes.clone(),
            weights: n.iter().map(|n| largest.sqrt() * n).collect(),
        };
        Ok(massless.into_iter().map(carrier).collect())
    }

    /// Its nodes with their weights.
    pub(crate) fn weights(&self) -> impl Iterator<Item = (u32, f64)> {
        self.nodes.iter().copied().zip(self.weights.iter().copied())
    }

    /// Whether its direction is free along an axis: a node of it that is held determines the motion in it.
    pub(crate) fn is_free(&self, axis: usize, is_held: impl Fn(usize) -> bool) -> bool {
        let largest = self.weights.iter().fold(0.0f64, |most, weight| most.max(weight.abs()));
        self.weights().all(|(node, weight)| {
            weight.abs() <= LEAST * largest || !is_held(nodal::dof(node as usize, axis))
        })
    }

    /// Adds it to a mass of each coupling.
    pub(crate) fn add_to(&self, pattern: &Pattern, mass: &mut [f64]) {
        for ((a, own), (b, other)) in self.weights().flat_map(|a| self.weights().map(move |b| (a, b))) {
            mass[pattern.coupling(a as usize, b as usize)] += own * other;
        }
    }
}
