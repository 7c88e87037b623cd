//! Forces of a pair in a step, and their derivatives by the rates.

use super::closest::{
    PairTangent, PairVectors, add_product, combination, minus, pair_vectors, scale, scaled,
};
use super::correction::{Correction, GaussPoint};
use super::links::{Links, PairState};
use super::pair::Pair;
use crate::average::Rule;
use crate::tensor::dot3;

/// Memory of a pair for one Gauss point of a step.
///
/// One memory serves all pairs in turn.
#[derive(Debug, Clone, Copy, Default)]
pub struct PairStage {
    state: PairState,
    /// `ell r`, half the gradient of z.
    spread: PairVectors,
    /// Rate zeta of z.
    rate: f64,
    /// `dpsi/dz`.
    slope: f64,
    /// `d^2psi/dz^2`, for tangents.
    curvature: f64,
    /// The second derivative of z, for tangents.
    second: PairTangent,
    /// Its product with the rates, for tangents.
    second_rate: PairVectors,
}

/// Numbers that all stages of a step share.
struct Step {
    end: PairState,
    links: Links,
    /// `G = (psi_2 - psi_1)/(z_2 - z_1)`.
    quotient: f64,
    correction: Correction,
}

impl Pair {
    /// Stage forces f_i of a step from a start with rates x_i, both `[k]`; the result is the state at the end.
    /// `tangents`: the derivatives `df_i/dx_j` as `[i k + j]` \[force/length\], not symmetric; empty if they are not
    /// wanted.
    ///
    /// The coefficients and weights of the rule's time element give the positions: `q_1 + sum_j a_ij x_j` at the Gauss
    /// points and `q_1 + sum_j b_j x_j` at the end. The forces do the work `sum_i b_i f_i . x_i = w (psi_2 - psi_1)`
    /// and have neither resultant nor moment, for any step and any path of the closest point. For k = 1 they are those
    /// of two links, with the closest weights ell_1 of the start and ell_2 of the end, at the mid-point:
    ///
    /// ```math
    /// f = 2 w G [(1-s) ell_1 r_1 + s ell_2 r_2],    G = (psi_2 - psi_1)/(z_2 - z_1),
    /// z_2 - z_1 = (1-s) phi_1 + s phi_2
    /// ```
    ///
    /// with the changes phi of `|r|^2` at fixed weights. Higher degrees take the gradients at the Gauss points, and
    /// correct their work by forces along the rates `zeta_i = dz/dalpha` and along the links:
    ///
    /// ```math
    /// f_i = 2 w (psi'(z_i) + c zeta_i) ell_i r_i + 2 w c (z_2-z_1) [(1-s) ell_1 r_1 + s ell_2 r_2]
    /// c = D/N,    D = psi_2 - psi_1 - sum_i b_i psi'(z_i) zeta_i,    N = sum_i b_i zeta_i^2 + (z_2 - z_1)^2
    /// ```
    ///
    /// No factor of `2 w ell r` exceeds `1 + sqrt(2/b_i)` times the largest of `|G|` and `|psi'(z_i)|`.
    pub fn forces(
        &self,
        rule: &Rule,
        start: &PairState,
        rates: &[PairVectors],
        stages: &mut [PairStage],
        forces: &mut [PairVectors],
        tangents: &mut [PairTangent],
    ) -> PairState {
        let step = self.step(rule, start, rates, stages);
        for (stage, force) in stages.iter().zip(forces) {
            let links = step.links.spread(&stage.state.positions);
            let (of_gradient, of_links) = step.factors(stage, rates.len());
            *force = pair_vectors(|a, c| {
                2.0 * self.weight * (of_gradient * stage.spread[a][c] + of_links * links[a][c])
            });
        }
        if !tangents.is_empty() {
            self.set_tangents(rule, start, (rates, stages), &step, tangents);
        }
        step.end
    }

    fn set_tangents(
        &self,
        rule: &Rule,
        start: &PairState,
        (rates, stages): (&[PairVectors], &mut [PairStage]),
        step: &Step,
        tangents: &mut [PairTangent],
    ) {
        let (a, b, k) = (rule.coefficients(), rule.weights(), rates.len());
        if step.quotient == 0.0 && stages.iter().all(|stage| stage.slope == 0.0) {
            tangents.fill(PairTangent::default());
            return;
        }
        if k > 1 {
            self.differentiate(stages, rates);
        }
        let face = step.end.face();
        let share = step.links.share_derivative(start, &step.end, &face);
        for j in 0..k {
            let (correction, of_links) = self.factor_derivatives(rule, start, step, stages, j);
            for (i, stage) in stages.iter().enumerate() {
                let (tangent, a_ij) = (&mut tangents[i * k + j], a[i * k + j]);
                *tangent = PairTangent::default();
                let (of_gradient, factor) = step.factors(stage, k);
                if k > 1 {
                    let rate = stage.rate_derivative(a_ij, i == j);
                    let of_factor = pair_vectors(|a, c| {
                        let slope = 2.0 * stage.curvature * a_ij * stage.spread[a][c];
                        slope + step.correction.factor * rate[a][c] + stage.rate * correction[a][c]
                    });
                    *tangent = stage.second;
                    scale(tangent, 0.5 * a_ij * of_gradient);
                    add_product(tangent, 1.0, &stage.spread, &of_factor);
                }
                let q = &stage.state.positions;
                add_product(tangent, 1.0, &step.links.spread(q), &of_links);
                step.links.add_derivative(q, (a_ij * factor, b[j] * factor), &face, &share, tangent);
                scale(tangent, 2.0 * self.weight);
            }
        }
    }

    /// Evaluates the stages and the end.
    fn step(&self, rule: &Rule, start: &PairState, rates: &[PairVectors], stages: &mut [PairStage]) -> Step {
        let (a, b, k) = (rule.coefficients(), rule.weights(), rates.len());
        let sum = |weights: &[f64]| {
            pair_vectors(|e, c| weights.iter().zip(rates).map(|(weight, rate)| weight * rate[e][c]).sum())
        };
        let moved = |u: &PairVectors| pair_vectors(|e, c| start.positions[e][c] + u[e][c]);
        let displacement = sum(b);
        let end = PairState::new(self.kind, moved(&displacement));
        let links = Links::new(start, &end, &displacement);
        let quotient = self.quotient(start, &end);
        if k == 1 {
            stages[0].state.positions = moved(&sum(a));
            (stages[0].spread, stages[0].slope) = Default::default();
            return Step { end, links, quotient, correction: Correction { factor: 0.0, norm: 0.0 } };
        }
        let extent = largest(&start.positions).max(largest(&end.positions));
        for (i, stage) in stages.iter_mut().enumerate() {
            stage.state = PairState::new(self.kind, moved(&sum(&a[i * k..(i + 1) * k])));
            let closest = &stage.state.closest;
            stage.spread = closest.spread_link();
            stage.slope = self.slope(closest);
            stage.rate = 2.0 * dot3(closest.link, combination(&closest.weights, &rates[i]));
        }
        let points = stages.iter().zip(rates).zip(b).map(|((stage, x), &weight)| {
            let closest = &stage.state.closest;
            let (link_rate, length) = (combination(&closest.weights, x), closest.squared_distance.sqrt());
            let size = extent * dot3(link_rate, link_rate).sqrt() + length * largest(&relative(x));
            GaussPoint { weight, slope: stage.slope, rate: stage.rate, size }
        });
        let correction = Correction::new(quotient, links.change, points);
        Step { end, links, quotient, correction }
    }

    /// Second derivatives at the stages.
    fn differentiate(&self, stages: &mut [PairStage], rates: &[PairVectors]) {
        for (stage, rate) in stages.iter_mut().zip(rates) {
            let closest = &stage.state.closest;
            stage.curvature = self.curvature(closest);
            stage.second = closest.second_derivative(&stage.state.face());
            let second = &stage.second;
            stage.second_rate = pair_vectors(|a, i| (0..4).map(|b| dot3(second[a][b][i], rate[b])).sum());
        }
    }

    /// Derivatives of c and of the factor of the links by x_j.
    fn factor_derivatives(
        &self,
        rule: &Rule,
        start: &PairState,
        step: &Step,
        stages: &[PairStage],
        j: usize,
    ) -> (PairVectors, PairVectors) {
        let (a, b, k) = (rule.coefficients(), rule.weights(), stages.len());
        // dz_2
        let change = scaled(2.0 * b[j], &step.end.closest.spread_link());
        if k == 1 {
            return (PairVectors::default(), scaled(self.quotient_slope(start, &step.end), &change));
        }
        let Correction { factor: c, norm } = step.correction;
        if c == 0.0 {
            return Default::default();
        }
        // dD - c dN
        let mut defect = scaled(self.slope(&step.end.closest) - 2.0 * c * step.links.change, &change);
        for (i, stage) in stages.iter().enumerate() {
            let a_ij = a[i * k + j];
            let rate = stage.rate_derivative(a_ij, i == j);
            let of_rate = stage.slope + 2.0 * c * stage.rate;
            let of_gradient = 2.0 * stage.curvature * a_ij * stage.rate;
            for e in 0..4 {
                for d in 0..3 {
                    defect[e][d] -= b[i] * (of_gradient * stage.spread[e][d] + of_rate * rate[e][d]);
                }
            }
        }
        let correction = scaled(1.0 / norm, &defect);
        let of_links = pair_vectors(|e, d| step.links.change * correction[e][d] + c * change[e][d]);
        (correction, of_links)
    }
}

impl PairStage {
    /// Derivative of the rate zeta_i by x_j.
    fn rate_derivative(&self, a_ij: f64, is_own: bool) -> PairVectors {
        let own = if is_own { 2.0 } else { 0.0 };
        pair_vectors(|e, c| own * self.spread[e][c] + a_ij * self.second_rate[e][c])
    }
}

impl Step {
    /// Factors of `2 w ell_i r_i` and of the links in a stage force.
    fn factors(&self, stage: &PairStage, k: usize) -> (f64, f64) {
        if k == 1 {
            (0.0, self.quotient)
        } else {
            (stage.slope + self.correction.factor * stage.rate, self.correction.factor * self.links.change)
        }
    }
}

/// Vectors without that of the first entity.
fn relative(v: &PairVectors) -> PairVectors {
    v.map(|vector| minus(vector, v[0]))
}

/// Largest component.
fn largest(v: &PairVectors) -> f64 {
    v.as_flattened().iter().fold(0.0, |size: f64, component| size.max(component.abs()))
}
