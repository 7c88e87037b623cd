//! The energy of a pair and its derivatives by the positions.

use super::closest::{Closest, PairKind, PairTangent, PairVectors, add_product, scale, scaled};
use super::layer::Layer;
use super::links::PairState;

/// A pair with the energy `w psi(z)` of its layer.
///
/// Forces are derivatives of the energy by the positions of the entities, so they have the sign of internal forces.
/// Nothing is finite where the distance is zero.
///
/// ```
/// use emmy::body::LayerLaw;
/// use emmy::internals::contact::{Layer, Pair, PairKind, PairState};
/// let layer = Layer { modulus: 100.0, thickness: 0.5, law: LayerLaw::Linear };
/// let pair = Pair { kind: PairKind::PointVertex, weight: 2.0, layer };
/// let mut x = [[0.0; 3]; 4];
/// x[1][0] = 0.25;
/// let state = PairState::new(pair.kind, x);
/// assert!((pair.energy(&state) - 2.0 * 6.25 * 0.5625 / 0.25).abs() < 1e-13);
/// // dy/dx = 2 * 0.25/0.5^2
/// assert!((pair.gradient(&state)[0][0] - 2.0 * 6.25 * 0.9375 / 0.0625 * 2.0).abs() < 1e-11);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Kind.
    pub kind: PairKind,
    /// Weight w: an area in the reference configuration, with the factor of inclusion and exclusion \[length^2\].
    pub weight: f64,
    /// Layer.
    pub layer: Layer,
}

impl Pair {
    fn y(&self, z: f64) -> f64 {
        z / (self.layer.thickness * self.layer.thickness)
    }

    /// `w psi` \[energy\].
    pub fn energy(&self, state: &PairState) -> f64 {
        self.weight * self.layer.energy(self.y(state.closest.squared_distance))
    }

    /// The gradient of the energy by the positions, `2 w psi'(z) ell_a r` \[force\].
    pub fn gradient(&self, state: &PairState) -> PairVectors {
        scaled(2.0 * self.weight * self.slope(&state.closest), &state.closest.spread_link())
    }

    /// The second derivative of the energy by the positions, symmetric \[force/length\].
    pub fn second_derivative(&self, state: &PairState) -> PairTangent {
        let closest = &state.closest;
        let mut tangent = closest.second_derivative(&state.face());
        scale(&mut tangent, self.weight * self.slope(closest));
        let link = closest.spread_link();
        add_product(&mut tangent, 4.0 * self.weight * self.curvature(closest), &link, &link);
        tangent
    }

    /// `dpsi/dz`.
    pub(super) fn slope(&self, closest: &Closest) -> f64 {
        self.layer.slope(self.y(closest.squared_distance)) / self.layer.thickness.powi(2)
    }

    /// `d^2psi/dz^2`.
    pub(super) fn curvature(&self, closest: &Closest) -> f64 {
        self.layer.curvature(self.y(closest.squared_distance)) / self.layer.thickness.powi(4)
    }

    /// `(psi_2 - psi_1)/(z_2 - z_1)`.
    pub(super) fn quotient(&self, start: &PairState, end: &PairState) -> f64 {
        let [y_1, y_2] = [start, end].map(|state| self.y(state.closest.squared_distance));
        self.layer.quotient(y_1, y_2) / self.layer.thickness.powi(2)
    }

    /// Derivative of [`Pair::quotient`] by z_2.
    pub(super) fn quotient_slope(&self, start: &PairState, end: &PairState) -> f64 {
        let [y_1, y_2] = [start, end].map(|state| self.y(state.closest.squared_distance));
        self.layer.quotient_slope(y_1, y_2) / self.layer.thickness.powi(4)
    }
}
