//! Volume of a material point along a step, and the stress of a pressure that acts on it.
//!
//! A cell that projects its volume has the energy `W_p(C) + U(theta)`. The volume follows a cascade of assumed paths,
//! each with its own rates at the Gauss points of the time element and an exact chain rule:
//!
//! ```math
//! C -> det C -> J -> theta -> U(theta),      theta'_i = B_i : E'_i,      sum_i b_i theta'_i = theta_2 - theta_1
//! ```
//!
//! With the projection of theta, which is linear, and mean pressures p_i, `S_i = p_i B_i` conserves the energy U; B_i
//! is symmetric, so `P_i = F(c_i) S_i` has no moment. The first steps are in `path`, the last is in `pressure`. A
//! standard rule takes theta, B and p at its time points.

mod damping;
mod path;
mod pressure;
mod start;
#[cfg(test)]
mod tests;

pub use damping::VolumeDamping;
pub use start::VolumeStart;

use super::{Kind, Request, Rule, StressKind};
use crate::material::VolumeMeasure;
use crate::tensor::{
    Elasticity, Lane, Mat3, SYM_INDEX, Sym, add_scaled, dot3, green_lagrange, identity_plus_times_sym,
    sym_add_scaled, sym_scaled, sym_transposed_product,
};
use path::Path;

/// Volume of a material point along a step, with its working memory.
#[derive(Debug, Clone)]
pub struct VolumeAverage<L> {
    /// theta at the start of the step; 0 for a standard rule.
    pub start: L,
    /// Rates theta'_l at the Gauss points; for a standard rule theta at time point l. `[n_pressures]`
    pub change: Vec<L>,
    /// theta'_l where `change` is not, after [`Rule::set_volume_rates`]. `[n_pressures]`
    pub rate: Vec<L>,
    /// B_l, the second Piola-Kirchhoff stress of a unit pressure l. `[n_pressures]`
    pub direction: Vec<Sym<L>>,
    /// Derivatives dchange_l/dE'_m, `[l k + m]`; for a standard rule dtheta_l/dE_l, `[l]`.
    response: Vec<Sym<L>>,
    /// Derivatives dB_l/dE'_m, `[l k + m]`; for a standard rule dB_l/dE_l, `[l]`.
    curvature: Vec<Elasticity<L>>,
    /// Displacement gradients at the Gauss points, or at the time points. `[n_pressures]`
    gradients: Vec<Mat3<L>>,
    /// E'_i of an energy-momentum rule, `[k]`.
    strain_rates: Vec<Sym<L>>,
    path: Path<L>,
}

impl<L: Lane> VolumeAverage<L> {
    /// Memory for a rule; `zero` is any number of the lane type.
    pub fn new(rule: &Rule, zero: L) -> Self {
        let zero = zero.splat(0.0);
        let n = rule.n_pressures();
        // Degree of the path of volumes: none at the time points of a standard rule.
        let k = if rule.is_energy_momentum() { rule.degree() } else { 0 };
        VolumeAverage {
            start: zero,
            change: vec![zero; n],
            rate: vec![zero; n],
            direction: vec![[zero; 6]; n],
            response: vec![[zero; 6]; n * k.max(1)],
            curvature: vec![[[zero; 6]; 6]; n * k.max(1)],
            gradients: vec![[[zero; 3]; 3]; n],
            strain_rates: vec![[zero; 6]; k],
            path: Path::new(k, zero),
        }
    }

    /// Keeps what [`Rule::add_pressure`] takes with [`Request::Stress`]: displacement gradients and B_l.
    /// `[n_pressures]`
    #[inline(always)]
    pub(crate) fn save_unit_stresses(&self, saved: &mut [(Mat3<L>, Sym<L>)]) {
        for (saved, parts) in saved.iter_mut().zip(self.gradients.iter().zip(&self.direction)) {
            *saved = (*parts.0, *parts.1);
        }
    }

    /// Takes what [`VolumeAverage::save_unit_stresses`] saved.
    #[inline(always)]
    pub(crate) fn take_unit_stresses(&mut self, saved: &[(Mat3<L>, Sym<L>)]) {
        for (l, (gradient, direction)) in saved.iter().enumerate() {
            self.gradients[l] = *gradient;
            self.direction[l] = *direction;
        }
    }

    /// Sets point l to a static state: displacement gradient and strain there. `factor`: derivative of the strain by
    /// its rate.
    #[inline(always)]
    fn set_static(
        &mut self,
        l: usize,
        measure: VolumeMeasure,
        (gradient, strain): (&Mat3<L>, &Sym<L>),
        factor: f64,
        request: Request,
    ) {
        let factor = strain[0].splat(factor);
        self.gradients[l] = *gradient;
        (self.change[l], self.direction[l]) = measure.change_and_direction(strain);
        if request == Request::Tangent {
            self.response[l] = sym_scaled(factor, &self.direction[l]);
            self.curvature[l] = scaled(factor, &measure.curvature(strain));
        }
    }
}

impl Rule {
    /// Number of pressures in a step: k for an energy-momentum rule, the number of time points for a standard one.
    ///
    /// ```
    /// use emmy::internals::average::Rule;
    /// assert_eq!(Rule::assumed_strain(2, 5).n_pressures(), 2);
    /// assert_eq!(Rule::standard(1, &emmy::internals::quadrature::gauss(3)).n_pressures(), 3);
    /// ```
    pub fn n_pressures(&self) -> usize {
        if self.is_energy_momentum() { self.degree() } else { self.points.len() }
    }

    /// Coefficient of pressure l in stage force i: `delta_il`, or `w_l l_i(alpha_l) / b_i`.
    pub fn pressure_weight(&self, i: usize, l: usize) -> f64 {
        match self.kind {
            Kind::Standard => self.points[l].stage_weights[i],
            Kind::EnergyMomentum(_) if i == l => 1.0,
            Kind::EnergyMomentum(_) => 0.0,
        }
    }

    /// Coefficient of rate j in the configuration that pressure l belongs to: a_lj, or `L_j(alpha_l)`.
    pub fn pressure_integral(&self, l: usize, j: usize) -> f64 {
        match self.kind {
            Kind::Standard => self.points[l].integrals[j],
            Kind::EnergyMomentum(_) => self.a[l * self.degree() + j],
        }
    }

    /// Volume of a material point along a step, and its derivatives if wanted. `start` and `rates` as in
    /// [`Rule::average`].
    #[inline(always)]
    pub fn set_volume<L: Lane>(
        &self,
        measure: VolumeMeasure,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        request: Request,
        volume: &mut VolumeAverage<L>,
    ) {
        volume.start = start[0][0].splat(0.0);
        let kind = match self.kind {
            Kind::Standard => {
                for (l, point) in self.points.iter().enumerate() {
                    let G = Rule::gradient_at(start, &point.integrals, rates);
                    volume.set_static(l, measure, (&G, &green_lagrange(&G)), 1.0, request);
                }
                return;
            }
            Kind::EnergyMomentum(kind) => kind,
        };
        let k = self.degree();
        for i in 0..k {
            let G = Rule::gradient_at(start, &self.a[i * k..(i + 1) * k], rates);
            volume.strain_rates[i] = sym_transposed_product(&G, &rates[i]);
            volume.gradients[i] = G;
        }
        let E_1 = green_lagrange(start);
        match kind {
            StressKind::StrainingRates => {
                let half = self.a[0];
                let mean = sym_add_scaled(&E_1, E_1[0].splat(half), &volume.strain_rates[0]);
                let G = volume.gradients[0];
                volume.set_static(0, measure, (&G, &mean), half, request);
            }
            StressKind::AssumedStrain | StressKind::DiscreteGradient => {
                self.set_path(measure, &E_1, request, volume);
            }
        }
    }

    /// F_l B_l, the first Piola-Kirchhoff stress of a unit pressure l. `[n_pressures]`
    #[inline(always)]
    pub fn pressure_force<L: Lane>(&self, volume: &VolumeAverage<L>, left: &mut [Mat3<L>]) {
        for (left, (G, B)) in left.iter_mut().zip(volume.gradients.iter().zip(&volume.direction)) {
            *left = identity_plus_times_sym(G, B);
        }
    }

    /// Derivatives of the changes of volume by the rates, dchange_l/dF'_j, after [`Rule::set_volume`] with
    /// [`Request::Tangent`]. `[l k + j]`
    ///
    /// ```math
    /// dtheta'_l/dF'_j = sum_m H_mj dtheta'_l/dE'_m,      dtheta_l/dF'_j = L_j(alpha_l) F_l B_l
    /// ```
    #[inline(always)]
    pub fn volume_response<L: Lane>(
        &self,
        volume: &VolumeAverage<L>,
        rates: &[Mat3<L>],
        right: &mut [Mat3<L>],
    ) {
        let k = self.degree();
        for l in 0..self.n_pressures() {
            for j in 0..k {
                let mut sum = [[volume.start.splat(0.0); 3]; 3];
                match self.kind {
                    Kind::Standard => {
                        let force = identity_plus_times_sym(&volume.gradients[l], &volume.direction[l]);
                        sum = add_scaled(&sum, self.points[l].integrals[j], &force);
                    }
                    Kind::EnergyMomentum(_) => {
                        for m in 0..k {
                            let H = self.rate_response(rates, &volume.gradients, m, j);
                            add_product(&mut sum, &H, &volume.response[l * k + m]);
                        }
                    }
                }
                right[l * k + j] = sum;
            }
        }
    }
}

/// Adds `A S` with a symmetric tensor.
#[inline(always)]
fn add_product<L: Lane>(sum: &mut Mat3<L>, A: &Mat3<L>, S: &Sym<L>) {
    for r in 0..3 {
        for c in 0..3 {
            let s = SYM_INDEX[c];
            sum[r][c] += dot3(A[r], [S[s[0]], S[s[1]], S[s[2]]]);
        }
    }
}

/// Elasticity times a number.
#[inline(always)]
fn scaled<L: Lane>(s: L, D: &Elasticity<L>) -> Elasticity<L> {
    let mut D = *D;
    for row in &mut D {
        for entry in row {
            *entry = *entry * s;
        }
    }
    D
}
