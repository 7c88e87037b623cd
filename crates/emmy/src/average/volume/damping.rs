//! Damping of a projected volume: the part of a viscosity, or of a dissipative scheme, that belongs to U.

#![allow(non_snake_case)]

use super::{VolumeAverage, add_product};
use crate::average::energy_momentum::times_doubled;
use crate::average::{Kind, Rule, StressKind};
use crate::tensor::{Lane, Mat3, add_scaled, double_dot, identity_plus_times_sym, sym_transposed_product};

/// Damping of the projected volume of a cell in a step: mean pressures that are linear in the rates of the volume.
///
/// ```math
/// p_i = V theta'_i + D p_i sum_j b_j p_j theta'_j
/// ```
///
/// with the Legendre polynomial p of [`crate::average::Damping`], whose stress belongs to the rest of the material. V
/// is the stiffness U''(0) times the time of the viscosity over the step size, D the stiffness times a number. A
/// standard rule has V alone, with the rates at its time points l. The dissipated energy per volume is
///
/// ```math
/// sum_i b_i p_i theta'_i >= 0,      FE: sum_l w_l p_l theta'_l >= 0
/// ```
///
/// and because the pressures act through the same B_i as those of U, they have neither a resultant nor a moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VolumeDamping {
    /// V \[stress\].
    pub viscous: f64,
    /// D \[stress\]; 0 for a standard rule.
    pub dissipative: f64,
}

impl Rule {
    /// Whether the changes of volume are rates at the Gauss points. Otherwise they are volumes, and
    /// [`Rule::set_volume_rates`] has the rates.
    pub fn changes_are_rates(&self) -> bool {
        match self.kind {
            Kind::Standard | Kind::EnergyMomentum(StressKind::StrainingRates) => false,
            Kind::EnergyMomentum(StressKind::AssumedStrain | StressKind::DiscreteGradient) => true,
        }
    }

    /// Derivative of the pressure l of a damping by the rate m of the volume.
    pub fn volume_damping(&self, damping: &VolumeDamping, l: usize, m: usize) -> f64 {
        let viscous = if l == m { damping.viscous } else { 0.0 };
        match damping.dissipative {
            0.0 => viscous,
            D => viscous + D * self.highest_mode[l] * self.b[m] * self.highest_mode[m],
        }
    }

    /// Derivative of the pressure l of a damping by the rate j of the deformation, with one response for all stages.
    pub(crate) fn reused_volume_damping(&self, damping: &VolumeDamping, l: usize, j: usize) -> f64 {
        match self.kind {
            Kind::Standard => damping.viscous * self.points[l].basis[j],
            Kind::EnergyMomentum(_) => self.volume_damping(damping, l, j),
        }
    }

    /// Weight of pressure l times rate l in the work of a step: b_l, or w_l.
    pub fn pressure_work_weight(&self, l: usize) -> f64 {
        if self.is_energy_momentum() { self.b[l] } else { self.points[l].weight }
    }

    /// Sets the rates of the volume at the time points, after [`Rule::set_volume`] with the same `rates`.
    ///
    /// ```math
    /// theta'_l = B_l : sym(F_l^T F'(alpha_l))
    /// ```
    #[inline(always)]
    pub fn set_volume_rates<L: Lane>(&self, rates: &[Mat3<L>], volume: &mut VolumeAverage<L>) {
        for l in 0..self.n_pressures() {
            let E = sym_transposed_product(&volume.gradients[l], &self.rate_at(l, rates));
            volume.rate[l] = double_dot(&volume.direction[l], &E);
        }
    }

    /// Derivatives of these rates by the rates of the deformation gradient, dtheta'_l/dF'_j, after [`Rule::set_volume`]
    /// with the request of a tangent. `[l k + j]`
    ///
    /// ```math
    /// dtheta'_l/dF'_j = l_j F_l B_l + L_j [F'_l B_l + F_l (dB_l/dE : E'_l)]
    /// ```
    ///
    /// The symmetric part of energy-momentum rules has the first term alone.
    #[inline(always)]
    pub fn volume_rate_response<L: Lane>(
        &self,
        volume: &VolumeAverage<L>,
        rates: &[Mat3<L>],
        right: &mut [Mat3<L>],
    ) {
        let k = self.degree();
        for l in 0..self.n_pressures() {
            let (F, B) = (&volume.gradients[l], &volume.direction[l]);
            let force = identity_plus_times_sym(F, B);
            let mut own = [[volume.start.splat(0.0); 3]; 3];
            if self.kind == Kind::Standard {
                let rate = self.rate_at(l, rates);
                let E = sym_transposed_product(F, &rate);
                add_product(&mut own, &rate, B);
                let turned = identity_plus_times_sym(F, &times_doubled(&volume.curvature[l], &E));
                own = add_scaled(&own, 1.0, &turned);
            }
            for j in 0..k {
                let (basis, integral) = match self.kind {
                    Kind::Standard => (self.points[l].basis[j], self.points[l].integrals[j]),
                    Kind::EnergyMomentum(_) => (1.0, 0.0),
                };
                let zero = [[volume.start.splat(0.0); 3]; 3];
                right[l * k + j] = add_scaled(&add_scaled(&zero, basis, &force), integral, &own);
            }
        }
    }

    /// F'(alpha_l), or the only rate of a rule of degree 1.
    #[inline(always)]
    fn rate_at<L: Lane>(&self, l: usize, rates: &[Mat3<L>]) -> Mat3<L> {
        match self.kind {
            Kind::Standard => {
                let mut rate = [[rates[0][0][0].splat(0.0); 3]; 3];
                for (&l_j, own) in self.points[l].basis.iter().zip(rates) {
                    rate = add_scaled(&rate, l_j, own);
                }
                rate
            }
            Kind::EnergyMomentum(_) => rates[l],
        }
    }
}
