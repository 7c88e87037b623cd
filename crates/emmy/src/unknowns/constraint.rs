//! Constraints that are sums of scalar products.

use std::collections::BTreeMap;

use super::affine::Affine;
use crate::error::Result;
use crate::input::{NotFinite, SignalTarget, TimeFunction};
use crate::nodal;
use crate::tensor::dot3;

/// A constraint `Phi(q) = sum_r c_r A_r . B_r - s = 0` on points and vectors of the body: it is quadratic in the
/// positions and does not change with the frame (Betsch and Steinmann, Part III, Int. J. Numer. Meth. Engng 53, 2002).
///
/// In a step of a time element the rates obey it at the Gauss points. They integrate the rate of Phi, a polynomial of
/// degree 2k - 1, exactly, so the constraint holds at the end:
///
/// ```math
/// C_i = G(q_i) x_i + Phi(q_1) = 0,    R_i + G(q_i)^T Lambda_i = 0,    G = dPhi/dq
/// ```
///
/// With a drive, c_r and s depend on time. The constraint holds at the end whatever the quadrature integrates:
///
/// ```math
/// C_i = r_i - sum_j b_j r_j + Phi(q_2, t_2) = 0,    r_i = G(q_i, t_i) x_i + h dPhi/dt(q_i, t_i)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Constraint {
    /// `(A_r, B_r, c_r)`.
    pub pairs: Vec<(Affine, Affine, f64)>,
    /// s.
    pub value: f64,
    /// The given coordinate; pairs and value are those of a time, at first those of the drawing.
    pub drive: Option<Drive>,
}

/// A coordinate of a joint that is given over time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    pub law: TimeFunction,
    /// Number of the joint.
    pub joint: usize,
    pub coordinate: Coordinate,
    /// Time of release of the joint.
    until: Option<f64>,
    /// `(dc_r/dt, ds/dt)`.
    rates: ([f64; 2], f64),
    /// Factor of the whole constraint.
    scale: f64,
}

/// The coordinate of a joint, with its value in the drawing where it is not zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Coordinate {
    /// The angle theta of `cos theta (e_1^A . e_2^B) - sin theta (e_1^A . e_1^B) = 0`, whose pairs come in the order
    /// `(e_1^A, e_1^B)`, `(e_1^A, e_2^B)`.
    Angle,
    /// The slide s of `(p - r) . a = s`.
    Slide,
    /// The change of the distance L of `(p - r) . (p - r) / 2 = L^2 / 2`.
    Distance(f64),
}

impl Drive {
    /// The drive of a joint, by its number, up to the time of its release.
    pub(crate) fn new(law: TimeFunction, joint: usize, coordinate: Coordinate, until: Option<f64>) -> Self {
        Drive { law, joint, coordinate, until, rates: ([0.0; 2], 0.0), scale: 1.0 }
    }

    /// Whether it has a kink after a time and up to another one.
    pub(crate) fn has_kink(&self, after: f64, until: f64) -> bool {
        self.law.next_kink(after).is_some_and(|kink| kink <= until)
    }
}

impl Constraint {
    /// A constraint that does not change over time.
    pub(crate) fn new(pairs: Vec<(Affine, Affine, f64)>, value: f64) -> Self {
        Constraint { pairs, value, drive: None }
    }

    /// The same constraint, multiplied so that its gradient has unit length in the reference configuration.
    pub(crate) fn normalised(mut self) -> Self {
        let scale = self.square_of_gradient().sqrt().recip();
        self.pairs.iter_mut().for_each(|(_, _, c)| *c *= scale);
        self.value *= scale;
        if let Some(drive) = &mut self.drive {
            drive.scale *= scale;
        }
        self
    }

    /// Sets pairs and value to those at a time, and rates to those on the side of a kink that the sign of `shift`
    /// gives; at the release of the joint, on the side before it.
    ///
    /// # Errors
    /// [`crate::Error::NotFiniteAt`].
    pub(crate) fn set_time(&mut self, time: f64, shift: f64) -> Result<()> {
        let Some(Drive { law, joint, coordinate, until, rates, scale }) = &mut self.drive else {
            return Ok(());
        };
        let shift = if until.is_some_and(|until| time + shift > until) { -shift.abs() } else { shift };
        let (given, rate) = (law.value_before(time), law.rate_beside(time, shift));
        if let Some(value) = [given, rate].into_iter().find(|value| !value.is_finite()) {
            let found = NotFinite { time, value };
            return Err(SignalTarget::Joint(*joint).not_finite(law.text().unwrap_or_default(), found));
        }
        match *coordinate {
            Coordinate::Angle => {
                let (sin, cos) = given.sin_cos();
                (self.pairs[0].2, self.pairs[1].2) = (-*scale * sin, *scale * cos);
                *rates = ([-*scale * cos * rate, -*scale * sin * rate], 0.0);
            }
            Coordinate::Slide => {
                self.value = *scale * given;
                rates.1 = *scale * rate;
            }
            Coordinate::Distance(drawn) => {
                let length = drawn + given;
                self.value = 0.5 * *scale * length * length;
                rates.1 = *scale * length * rate;
            }
        }
        Ok(())
    }

    /// dPhi/dt at displacements of the nodes.
    pub(crate) fn rate_of_time(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let Some(Drive { rates: (of_pairs, of_value), .. }) = &self.drive else { return 0.0 };
        let pairs = self.pairs.iter().zip(of_pairs);
        pairs.map(|((a, b, _), rate)| rate * dot3(a.value(u), b.value(u))).sum::<f64>() - of_value
    }

    /// The same constraint on the nodes that tied nodes follow.
    pub(crate) fn on_leaders<'t>(self, leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]>) -> Self {
        let pairs = self.pairs.into_iter();
        let pairs = pairs.map(|(a, b, c)| (a.on_leaders(&leaders), b.on_leaders(&leaders), c)).collect();
        Constraint { pairs, ..self }
    }

    /// Nodes, some of them more than once.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.pairs.iter().flat_map(|(a, b, _)| a.nodes.iter().chain(&b.nodes)).copied()
    }

    /// Phi at displacements of the nodes.
    pub(crate) fn value(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let products = self.pairs.iter().map(|(a, b, c)| c * dot3(a.value(u), b.value(u)));
        products.sum::<f64>() - self.value
    }

    /// `G(q) x`.
    pub(crate) fn rate(&self, u: &dyn Fn(usize) -> f64, x: &dyn Fn(usize) -> f64) -> f64 {
        let terms = self
            .pairs
            .iter()
            .map(|(a, b, c)| c * (dot3(a.change(x), b.value(u)) + dot3(a.value(u), b.change(x))));
        terms.sum()
    }

    /// Whether a given angle is half a turn off: then its constraint holds, too.
    pub(crate) fn is_opposed(&self, u: &dyn Fn(usize) -> f64) -> bool {
        let Some(Drive { coordinate: Coordinate::Angle, .. }) = &self.drive else { return false };
        let [cos, sin] = [0, 1].map(|at| dot3(self.pairs[at].0.value(u), self.pairs[at].1.value(u)));
        self.pairs[1].2 * cos - self.pairs[0].2 * sin < 0.0
    }

    /// dPhi over the change of the given coordinate at displacements of the nodes; 0 without a drive.
    pub(crate) fn drive_arm(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let Some(Drive { coordinate, scale, .. }) = &self.drive else { return 0.0 };
        match coordinate {
            Coordinate::Angle | Coordinate::Slide => *scale,
            Coordinate::Distance(_) => {
                let arm = self.pairs[0].0.value(u);
                scale * dot3(arm, arm).sqrt()
            }
        }
    }

    /// Calls a function with each entry of `G(q)`, some of them more than once: degree of freedom and number.
    pub(crate) fn for_each_gradient(&self, u: &dyn Fn(usize) -> f64, visit: &mut dyn FnMut(usize, f64)) {
        for (a, b, c) in &self.pairs {
            for (own, other) in [(a, b.value(u)), (b, a.value(u))] {
                for (&node, weight) in own.nodes.iter().zip(&own.weights) {
                    (0..3).for_each(|d| visit(nodal::dof(node as usize, d), c * weight * other[d]));
                }
            }
        }
    }

    /// |G|^2 in the reference configuration.
    pub(crate) fn square_of_gradient(&self) -> f64 {
        let mut gradient = BTreeMap::new();
        self.for_each_gradient(&|_| 0.0, &mut |dof, value| *gradient.entry(dof).or_insert(0.0) += value);
        gradient.into_values().map(|value: f64| value * value).sum()
    }

    /// Calls a function with each entry of the second derivative, which is a number times the identity for each pair of
    /// nodes.
    pub(crate) fn for_each_curvature(&self, visit: &mut dyn FnMut([u32; 2], f64)) {
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
            Constraint::new(vec![(arm.clone(), arm, 0.5)], 0.5)
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
