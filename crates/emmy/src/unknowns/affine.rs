//! Points and vectors of a body.

use crate::nodal;

/// An affine combination of nodes, `A = A_0 + sum_a w_a u_a`: a point if the weights sum to 1, a vector that turns with
/// the body if they sum to 0. Without nodes it is a point or a vector of the ground.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Affine {
    pub nodes: Vec<u32>,
    pub weights: Vec<f64>,
    /// A_0, the value in the reference configuration.
    pub reference: [f64; 3],
}

impl Affine {
    /// A point or a vector of the ground.
    pub(crate) fn constant(reference: [f64; 3]) -> Self {
        Affine { nodes: Vec::new(), weights: Vec::new(), reference }
    }

    /// The vector from another point to this one.
    pub(crate) fn less(&self, other: &Affine) -> Self {
        let negative = other.weights.iter().map(|weight| -weight);
        Affine {
            nodes: self.nodes.iter().chain(&other.nodes).copied().collect(),
            weights: self.weights.iter().copied().chain(negative).collect(),
            reference: [0, 1, 2].map(|d| self.reference[d] - other.reference[d]),
        }
    }

    /// The same point or vector on the nodes that tied nodes follow.
    pub(crate) fn on_leaders<'t>(&self, leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]>) -> Self {
        let own = self.nodes.iter().zip(&self.weights).flat_map(|(&node, &weight)| match leaders(node) {
            None => vec![(node, weight)],
            Some(leaders) => leaders.iter().map(|(leader, share)| (*leader, weight * share)).collect(),
        });
        let (nodes, weights) = own.unzip();
        Affine { nodes, weights, reference: self.reference }
    }

    /// Its value at displacements of the nodes.
    pub(crate) fn value(&self, displacement: impl Fn(usize) -> f64) -> [f64; 3] {
        let change = self.change(displacement);
        [0, 1, 2].map(|d| self.reference[d] + change[d])
    }

    /// Its change with some nodal vectors, by degree of freedom.
    pub(crate) fn change(&self, vectors: impl Fn(usize) -> f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (&node, weight) in self.nodes.iter().zip(&self.weights) {
            (0..3).for_each(|d| sum[d] += weight * vectors(nodal::dof(node as usize, d)));
        }
        sum
    }
}
