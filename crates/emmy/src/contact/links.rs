//! The two links of a pair in a step.

use super::closest::{
    ActiveFace, Closest, PairKind, PairTangent, PairVectors, add_product, add_weights, combination,
    pair_vectors, spread,
};
use crate::tensor::{dot3, three};

/// Positions of the entities of a pair, and the closest weights there.
///
/// ```
/// use emmy::internals::contact::{PairKind, PairState};
/// let mut x = [[0.0; 3]; 4];
/// x[1] = [3.0, 4.0, 0.0];
/// assert_eq!(PairState::new(PairKind::PointVertex, x).closest.squared_distance, 25.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairState {
    /// Positions \[length\].
    pub positions: PairVectors,
    /// Closest weights.
    pub closest: Closest,
}

impl PairState {
    /// The state at positions.
    pub fn new(kind: PairKind, positions: PairVectors) -> PairState {
        PairState { positions, closest: Closest::new(kind, &positions) }
    }

    /// The active face of the closest weights.
    pub fn face(&self) -> ActiveFace {
        self.closest.face(&self.positions)
    }
}

/// The links with the closest weights of the start, ell_1, and with those of the end, ell_2.
///
/// Let phi_1 and phi_2 be the changes of `|r|^2` over the step with these weights held. As no weights are closer than
/// the closest ones, neither at the start nor at the end,
///
/// ```math
/// phi_1 - (z_2 - z_1) = |r_1(q_2)|^2 - z_2 >= 0,    z_2 - z_1 - phi_2 = |r_2(q_1)|^2 - z_1 >= 0,
/// z_2 - z_1 = (1-s) phi_1 + s phi_2  with s in [0, 1]
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Links {
    first: [f64; 4],
    second: [f64; 4],
    /// Share s of the second link.
    share: f64,
    /// `phi_1 - phi_2`, regularised.
    width: f64,
    /// `z_2 - z_1` \[length^2\].
    pub(super) change: f64,
}

/// Added to `phi_1 - phi_2` over `z_1 + z_2`, so that s goes to 1/2, its limit for short steps, where both are equal.
/// The force stays continuous, and the error of `z_2 - z_1` is of this order.
const EQUAL: f64 = 1e-16;

impl Links {
    /// The links of a step with a displacement, which has more digits than the difference of the positions.
    pub(super) fn new(start: &PairState, end: &PairState, displacement: &PairVectors) -> Links {
        let (first, second) = (start.closest.weights, end.closest.weights);
        let change = |weights: &[f64; 4]| {
            let (r_1, r_2) = (combination(weights, &start.positions), combination(weights, &end.positions));
            dot3(three(|i| r_1[i] + r_2[i]), combination(weights, displacement))
        };
        // Not as differences of squares: |r + u|^2 - |r|^2 = u . (u + 2 r).
        let excess = |closest: &Closest, other: &[f64; 4], x: &PairVectors| {
            let difference: [f64; 4] = std::array::from_fn(|a| other[a] - closest.weights[a]);
            let u = combination(&difference, x);
            dot3(u, three(|i| u[i] + 2.0 * closest.link[i])).max(0.0)
        };
        let at_end = excess(&end.closest, &first, &end.positions);
        let at_start = excess(&start.closest, &second, &start.positions);
        let sum = start.closest.squared_distance + end.closest.squared_distance;
        let equal = EQUAL * sum;
        let width = at_start + at_end + equal;
        let share = if width > 0.0 { (at_end + 0.5 * equal) / width } else { 0.5 };
        let change = (1.0 - share) * change(&first) + share * change(&second);
        Links { first, second, share, width, change }
    }

    /// `(1-s) ell_1 r_1 + s ell_2 r_2` at positions: half the gradient of the two squares.
    pub(super) fn spread(&self, q: &PairVectors) -> PairVectors {
        let (r_1, r_2) = (combination(&self.first, q), combination(&self.second, q));
        let s = self.share;
        pair_vectors(|a, i| (1.0 - s) * self.first[a] * r_1[i] + s * self.second[a] * r_2[i])
    }

    /// The derivative of s by the positions at the end, with the active face there.
    pub(super) fn share_derivative(
        &self,
        start: &PairState,
        end: &PairState,
        face: &ActiveFace,
    ) -> PairVectors {
        if self.width == 0.0 {
            return PairVectors::default();
        }
        let s = self.share;
        let first = spread(&self.first, combination(&self.first, &end.positions));
        let second = end.closest.spread_link();
        let r_2 = combination(&self.second, &start.positions);
        let slope = face.directions.map(|direction| dot3(r_2, combination(&direction, &start.positions)));
        pair_vectors(|a, i| {
            let at_end = first[a][i] - second[a][i];
            let at_start = slope[0] * face.coordinates[0][a][i] + slope[1] * face.coordinates[1][a][i];
            2.0 * ((1.0 - s) * at_end - s * at_start) / self.width
        })
    }

    /// Adds the derivative of [`Links::spread`] at q: `of_point` by q, `of_end` by the positions at the end, where the
    /// active face is `face`.
    pub(super) fn add_derivative(
        &self,
        q: &PairVectors,
        (of_point, of_end): (f64, f64),
        face: &ActiveFace,
        share_derivative: &PairVectors,
        tangent: &mut PairTangent,
    ) {
        let s = self.share;
        add_weights(tangent, of_point * (1.0 - s), &self.first);
        add_weights(tangent, of_point * s, &self.second);
        let (r_1, r_2) = (combination(&self.first, q), combination(&self.second, q));
        for m in 0..2 {
            let (direction, t) = (&face.directions[m], combination(&face.directions[m], q));
            let left = pair_vectors(|a, i| self.second[a] * t[i] + direction[a] * r_2[i]);
            add_product(tangent, of_end * s, &left, &face.coordinates[m]);
        }
        let turned = pair_vectors(|a, i| self.second[a] * r_2[i] - self.first[a] * r_1[i]);
        add_product(tangent, of_end, &turned, share_derivative);
    }
}
