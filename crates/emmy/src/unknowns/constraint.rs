//! Constraints that are sums of scalar products.

use std::collections::BTreeMap;

use super::affine::Affine;
use crate::nodal;

/// A constraint `Phi(q) = sum_r c_r A_r . B_r - s = 0` on points and vectors of the body: it is quadratic in the
/// positions and does not change with the frame (Betsch and Steinmann, Part III, Int. J. Numer. Meth. Engng 53, 2002).
///
/// In a step of a time element the rates obey it at the Gauss points. They integrate the rate of Phi, a polynomial of
/// degree 2k - 1, exactly, so the constraint holds at the end:
///
/// ```math
/// C_i = G(q_i) x_i + Phi(q_1) = 0,    R_i + G(q_i)^T Lambda_i = 0,    G = dPhi/dq
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// `(A_r, B_r, c_r)`.
    pub pairs: Vec<(Affine, Affine, f64)>,
    /// s.
    pub value: f64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Constraint {
    /// The same constraint on the nodes that tied nodes follow.
    pub(crate) fn on_leaders<'t>(self, leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]>) -> Self {
        let pairs = self.pairs.into_iter();
        let pairs = pairs.map(|(a, b, c)| (a.on_leaders(&leaders), b.on_leaders(&leaders), c)).collect();
        Constraint { pairs, ..self }
    }

    /// Nodes, some of them more than once.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        self.pairs.iter().flat_map(|(a, b, _)| a.nodes.iter().chain(&b.nodes)).copied()
    }

    /// Phi at displacements of the nodes.
    pub fn value(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let products = self.pairs.iter().map(|(a, b, c)| c * dot(a.value(u), b.value(u)));
        products.sum::<f64>() - self.value
    }

    /// `G(q) x`.
    pub fn rate(&self, u: &dyn Fn(usize) -> f64, x: &dyn Fn(usize) -> f64) -> f64 {
        let terms = self
            .pairs
            .iter()
            .map(|(a, b, c)| c * (dot(a.change(x), b.value(u)) + dot(a.value(u), b.change(x))));
        terms.sum()
    }

    /// Calls a function with each entry of `G(q)`, some of them more than once: degree of freedom and number.
    pub fn for_each_gradient(&self, u: &dyn Fn(usize) -> f64, visit: &mut dyn FnMut(usize, f64)) {
        for (a, b, c) in &self.pairs {
            for (own, other) in [(a, b.value(u)), (b, a.value(u))] {
                for (&node, weight) in own.nodes.iter().zip(&own.weights) {
                    (0..3).for_each(|d| visit(nodal::dof(node as usize, d), c * weight * other[d]));
                }
            }
        }
    }

    /// |G|^2 in the reference configuration.
    pub fn square_of_gradient(&self) -> f64 {
        let mut gradient = BTreeMap::new();
        self.for_each_gradient(&|_| 0.0, &mut |dof, value| *gradient.entry(dof).or_insert(0.0) += value);
        gradient.into_values().map(|value: f64| value * value).sum()
    }

    /// Calls a function with each entry of the second derivative, which is a number times the identity for each pair of
    /// nodes.
    pub fn for_each_curvature(&self, visit: &mut dyn FnMut([u32; 2], f64)) {
        for (a, b, c) in &self.pairs {
            for (&node, weight) in a.nodes.iter().zip(&a.weights) {
                for (&other, other_weight) in b.nodes.iter().zip(&b.weights) {
                    visit([node, other], c * weight * other_weight);
                    visit([other, node], c * weight * other_weight);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(p - r) . (p - r) / 2 - 1/2` of two nodes, and of one node and the ground.
    fn links() -> [Constraint; 2] {
        let link = |nodes: Vec<u32>, weights: Vec<f64>| {
            let arm = Affine { nodes, weights, reference: [0.6, 0.0, -0.8] };
            Constraint { pairs: vec![(arm.clone(), arm, 0.5)], value: 0.5 }
        };
        [link(vec![0, 1], vec![1.0, -1.0]), link(vec![1], vec![1.0])]
    }

    #[test]
    fn derivatives_are_differences() {
        let noise = |seed: f64| move |dof: usize| ((dof as f64 + seed) * 0.618_034).fract() - 0.5;
        let (u, x) = (noise(1.0), noise(2.0));
        for link in links() {
            let along = |step: f64| link.value(&|dof| u(dof) + step * x(dof));
            // The constraint is quadratic: central differences are exact.
            let rate = 0.5 * (along(1.0) - along(-1.0));
            assert!((link.rate(&u, &x) - rate).abs() < 1e-15);
            let mut gradient = 0.0;
            link.for_each_gradient(&u, &mut |dof, value| gradient += value * x(dof));
            assert!((gradient - rate).abs() < 1e-15);
            let mut curvature = 0.0;
            link.for_each_curvature(&mut |[a, b], value| {
                let product = (0..3).map(|d| x(3 * a as usize + d) * x(3 * b as usize + d)).sum::<f64>();
                curvature += value * product;
            });
            assert!((curvature - (along(1.0) - 2.0 * along(0.0) + along(-1.0))).abs() < 1e-15);
        }
    }

    #[test]
    fn gradients_are_arms() {
        let [between, ground] = links();
        assert!((between.square_of_gradient() - 2.0).abs() < 1e-15);
        assert!((ground.square_of_gradient() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn links_do_not_see_the_frame() {
        // A quarter turn about z and a shift of both nodes.
        let moved = |dof: usize| [-0.6 - 0.6 + 0.6, 0.6, 0.0][dof % 3];
        let arm = links()[0].pairs[0].0.clone();
        let q = [[0.6, 0.0, -0.8], [0.0; 3]];
        let turned = |dof: usize| if dof < 3 { moved(dof) } else { 0.0 };
        let now = arm.value(turned);
        let length = now.iter().map(|x| x * x).sum::<f64>();
        let before = q[0].iter().map(|x: &f64| x * x).sum::<f64>();
        assert!((length - before).abs() < 1e-15, "{now:?}");
        assert!(links()[0].value(&turned).abs() < 1e-15);
    }
}
