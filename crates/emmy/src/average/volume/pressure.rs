//! Mean pressures of a step, and their stress.

#![allow(non_snake_case)]

use super::{VolumeAverage, scaled};
use crate::average::standard::first_elasticity;
use crate::average::{Average, Kind, Request, Rule, StressKind};
use crate::material::VolumeLaw;
use crate::tensor::{Lane, Mat3, add_scaled, identity_plus_times_sym, sym_scaled};

impl Rule {
    /// Mean pressures of a law at a projected volume, and with [`Request::Tangent`] their derivatives dp_l/dchange_m in
    /// `stiffness`, `[l n + m]`. `start` and `change` are the projections of [`VolumeAverage::start`] and
    /// [`VolumeAverage::change`].
    ///
    /// ```math
    /// AS: p_i = (1/b_i) sum_m w_m l_i(alpha_m) U'(theta~(alpha_m)),      theta~(alpha) = theta_1 + sum_j L_j(alpha) theta'_j
    /// DGM: p_i = U'(theta~(c_i)) + r theta'_i,      r = [U_2 - U_1 - sum_j b_j U'(theta~(c_j)) theta'_j] / sum_j b_j theta'_j^2
    /// FE: p_l = U'(theta_l)
    /// ```
    ///
    /// r is zero where U is quadratic: the outer quadrature is exact for it.
    #[inline(always)]
    pub fn mean_pressure<L: Lane>(
        &self,
        law: &VolumeLaw,
        start: L,
        change: &[L],
        request: Request,
        pressure: &mut [L],
        stiffness: &mut [L],
    ) {
        match self.kind {
            Kind::Standard | Kind::EnergyMomentum(StressKind::StrainingRates) => {
                let n = change.len();
                for l in 0..n {
                    pressure[l] = law.pressure(change[l]);
                    if request == Request::Tangent {
                        stiffness[l * n..(l + 1) * n].fill(start.splat(0.0));
                        stiffness[l * n + l] = law.stiffness(change[l]);
                    }
                }
            }
            Kind::EnergyMomentum(StressKind::AssumedStrain) => {
                self.assumed_volume_pressure(law, start, change, request, pressure, stiffness);
            }
            Kind::EnergyMomentum(StressKind::DiscreteGradient) => {
                self.outer_pressure(law, start, change, request, pressure, stiffness);
                if !law.is_quadratic() {
                    self.correct_pressure(law, start, change, request, pressure, stiffness);
                }
            }
        }
    }

    #[inline(always)]
    fn assumed_volume_pressure<L: Lane>(
        &self,
        law: &VolumeLaw,
        start: L,
        change: &[L],
        request: Request,
        pressure: &mut [L],
        stiffness: &mut [L],
    ) {
        let k = self.degree();
        pressure.fill(start.splat(0.0));
        if request == Request::Tangent {
            stiffness.fill(start.splat(0.0));
        }
        for point in &self.points {
            let theta = volume_at(start, &point.integrals, change);
            let p = law.pressure(theta);
            for i in 0..k {
                pressure[i] += p * point.stage_weights[i];
            }
            if request == Request::Tangent {
                let u = law.stiffness(theta);
                for at in 0..k * k {
                    stiffness[at] += u * (point.stage_weights[at / k] * point.integrals[at % k]);
                }
            }
        }
    }

    /// U' at the Gauss points of the time element.
    #[inline(always)]
    fn outer_pressure<L: Lane>(
        &self,
        law: &VolumeLaw,
        start: L,
        change: &[L],
        request: Request,
        pressure: &mut [L],
        stiffness: &mut [L],
    ) {
        let k = self.degree();
        for i in 0..k {
            let integrals = &self.a[i * k..(i + 1) * k];
            let theta = volume_at(start, integrals, change);
            pressure[i] = law.pressure(theta);
            if request == Request::Tangent {
                let u = law.stiffness(theta);
                for j in 0..k {
                    stiffness[i * k + j] = u * integrals[j];
                }
            }
        }
    }

    /// Adds the correction `r theta'` of the discrete gradient. With `U_2'` the pressure at the end:
    ///
    /// ```math
    /// dr_j = [b_j (U_2' - U'(theta~_j)) - sum_l b_l a_lj U''(theta~_l) theta'_l - 2 r b_j theta'_j] / sum_l b_l theta'_l^2
    /// ```
    #[inline(always)]
    fn correct_pressure<L: Lane>(
        &self,
        law: &VolumeLaw,
        start: L,
        change: &[L],
        request: Request,
        pressure: &mut [L],
        stiffness: &mut [L],
    ) {
        let zero = start.splat(0.0);
        let k = self.degree();
        let whole = volume_at(zero, &self.b, change);
        let end = start + whole;
        let mut numerator = law.energy_change(start, whole);
        let mut square = zero;
        for j in 0..k {
            numerator += pressure[j] * change[j] * -self.b[j];
            square += change[j] * change[j] * self.b[j];
        }
        let inverse = correction_scale(start, end, square);
        let r = numerator * inverse;
        if request == Request::Tangent {
            let p_2 = law.pressure(end);
            for j in 0..k {
                let mut dr = (p_2 - pressure[j] - r * change[j] * 2.0) * self.b[j];
                for l in 0..k {
                    dr += stiffness[l * k + j] * change[l] * -self.b[l];
                }
                dr = dr * inverse;
                for i in 0..k {
                    stiffness[i * k + j] += change[i] * dr;
                }
                stiffness[j * k + j] += r;
            }
        }
        for i in 0..k {
            pressure[i] += r * change[i];
        }
    }

    /// Adds the stage averages of the stress of pressures to the result of [`Rule::average`], and with
    /// [`Request::Tangent`] their derivatives at fixed pressures. `volume`: of [`Rule::set_volume`] with the same
    /// request; `rates` as given there.
    ///
    /// ```math
    /// P_i += sum_l weight_il F_l p_l B_l
    /// ```
    #[inline(always)]
    pub fn add_pressure<L: Lane>(
        &self,
        pressure: &[L],
        volume: &VolumeAverage<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        match self.kind {
            Kind::Standard => self.add_standard_pressure(pressure, volume, request, average),
            Kind::EnergyMomentum(_) => {
                self.add_energy_momentum_pressure(pressure, volume, rates, request, average)
            }
        }
    }

    #[inline(always)]
    fn add_standard_pressure<L: Lane>(
        &self,
        pressure: &[L],
        volume: &VolumeAverage<L>,
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        for (l, point) in self.points.iter().enumerate() {
            let G = &volume.gradients[l];
            let S = sym_scaled(pressure[l], &volume.direction[l]);
            let P = identity_plus_times_sym(G, &S);
            for i in 0..k {
                average.stress[i] = add_scaled(&average.stress[i], point.stage_weights[i], &P);
            }
            if request == Request::Stress {
                continue;
            }
            let A = first_elasticity(G, &S, &scaled(pressure[l], &volume.curvature[l]));
            for at in 0..k * k {
                let weight = pressure[l].splat(point.stage_weights[at / k] * point.integrals[at % k]);
                let entries = average.tangent[at].as_flattened_mut().iter_mut();
                for (sum, A) in entries.zip(A.as_flattened()) {
                    *sum = A.mul_add(weight, *sum);
                }
            }
        }
    }

    #[inline(always)]
    fn add_energy_momentum_pressure<L: Lane>(
        &self,
        pressure: &[L],
        volume: &VolumeAverage<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        for i in 0..k {
            average.gradients[i] = volume.gradients[i];
            average.stresses[i] = sym_scaled(pressure[i], &volume.direction[i]);
            let P = identity_plus_times_sym(&average.gradients[i], &average.stresses[i]);
            average.stress[i] = add_scaled(&average.stress[i], 1.0, &P);
        }
        if request == Request::Tangent {
            for at in 0..k * k {
                average.stiffness[at] = scaled(pressure[at / k], &volume.curvature[at]);
            }
            self.energy_momentum_tangent(rates, false, average);
        }
    }
}

/// `theta_1 + sum_j L_j theta'_j`.
#[inline(always)]
pub(super) fn volume_at<L: Lane>(start: L, integrals: &[f64], change: &[L]) -> L {
    let mut theta = start;
    for (&L_j, &rate) in integrals.iter().zip(change) {
        theta += rate * L_j;
    }
    theta
}

/// `1 / sum_j b_j theta'_j^2`, or 0 where the correction of the order |theta'|^2 is below the rounding of the pressure,
/// of the order eps |theta|. The constant only keeps the division from overflowing.
#[inline(always)]
pub(super) fn correction_scale<L: Lane>(start: L, end: L, square: L) -> L {
    let resting = (start * start + end * end) * 1e-36 + start.splat(1e-300);
    (square * square).select_below(resting, start.splat(0.0), start.splat(1.0) / square)
}
