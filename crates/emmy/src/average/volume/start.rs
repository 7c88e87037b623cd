//! Derivatives of the volume and of its pressures by the deformation gradient at the start of the step, for the
//! adjoint.

#![allow(non_snake_case)]

use super::path::{right_cauchy_green, slope_correction_scale};
use super::pressure::{correction_scale, volume_at};
use super::{VolumeAverage, add_product, scaled};
use crate::average::standard::{first_elasticity, with_identity};
use crate::average::{Kind, Request, Rule, StartTangent, StressKind};
use crate::material::{VolumeLaw, VolumeMeasure};
use crate::tensor::{
    Elasticity, Mat3, Sym, green_lagrange, identity_plus_times_sym, mixed_cofactor, sym_add_scaled,
    sym_cofactor, sym_det, sym_scaled,
};

/// Derivatives of the volume along a step by the deformation gradient F_1 at its start, at fixed rates.
#[derive(Debug, Clone)]
pub struct VolumeStart {
    /// Derivative of [`VolumeAverage::start`].
    pub start: Mat3<f64>,
    /// Derivatives of [`VolumeAverage::change`], `[n_pressures]`.
    pub change: Vec<Mat3<f64>>,
    /// dB_l/dE_1 at fixed strain rates, `[n_pressures]`.
    curvature: Vec<Elasticity<f64>>,
}

impl VolumeStart {
    /// Memory for a rule.
    pub fn new(rule: &Rule) -> Self {
        let n = rule.n_pressures();
        VolumeStart {
            start: [[0.0; 3]; 3],
            change: vec![[[0.0; 3]; 3]; n],
            curvature: vec![[[0.0; 6]; 6]; n],
        }
    }
}

impl Rule {
    /// Derivatives of the volume by F_1, after [`Rule::set_volume`] with the same arguments and [`Request::Tangent`].
    ///
    /// ```math
    /// dtheta'_l = dtheta'_l/dE_1 : sym(F_1^T dF_1) + sum_m dtheta'_l/dE'_m : sym(F'_m^T dF_1)
    /// ```
    pub fn set_volume_start(
        &self,
        measure: VolumeMeasure,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        volume: &VolumeAverage<f64>,
        result: &mut VolumeStart,
    ) {
        result.start = [[0.0; 3]; 3];
        let kind = match self.kind {
            Kind::Standard => {
                self.pressure_force(volume, &mut result.change);
                result.curvature.copy_from_slice(&volume.curvature);
                return;
            }
            Kind::EnergyMomentum(kind) => kind,
        };
        let E_1 = green_lagrange(start);
        for l in 0..self.degree() {
            let (response, curvature) = match (kind, measure) {
                (StressKind::StrainingRates, _) => {
                    let whole = 1.0 / self.a[0];
                    (volume.direction[l], scaled(whole, &volume.curvature[l]))
                }
                (_, VolumeMeasure::Trace) => ([0.0; 6], [[0.0; 6]; 6]),
                (_, VolumeMeasure::Ratio) => self.ratio_start(l, &E_1, volume),
            };
            result.curvature[l] = curvature;
            result.change[l] = self.change_start(l, start, rates, &response, volume);
        }
        if kind != StressKind::StrainingRates {
            result.start = identity_plus_times_sym(start, &measure.direction(&E_1));
        }
    }

    /// `F_1 dtheta'_l/dE_1 + sum_m F'_m dtheta'_l/dE'_m`.
    fn change_start(
        &self,
        l: usize,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        response: &Sym<f64>,
        volume: &VolumeAverage<f64>,
    ) -> Mat3<f64> {
        let mut sum = [[0.0; 3]; 3];
        add_product(&mut sum, &with_identity(start), response);
        for (m, rate) in rates.iter().enumerate() {
            add_product(&mut sum, rate, &volume.response[l * self.degree() + m]);
        }
        sum
    }

    /// dJ'_i/dE_1 and dB_i/dE_1.
    ///
    /// ```math
    /// dd_i/dC_1 = C'_i x C~(c_i),      dg_i/dC_1 = sum_l dg_i/dd_l dd_l/dC_1 + dg_i/d(det C_1) cof C_1
    /// ```
    fn ratio_start(
        &self,
        i: usize,
        E_1: &Sym<f64>,
        volume: &VolumeAverage<f64>,
    ) -> (Sym<f64>, Elasticity<f64>) {
        let k = self.degree();
        let path = &volume.path;
        let C_1 = right_cauchy_green(E_1);
        let own = self.det_start(i, E_1, volume);
        let det_slope = self.slope_start(i, sym_det(&C_1), volume);
        let mut slope = sym_scaled(det_slope, &sym_cofactor(&C_1));
        for l in 0..k {
            let det_start = self.det_start(l, E_1, volume);
            slope = sym_add_scaled(&slope, path.slope_response[i * k + l], &det_start);
        }
        let response = sym_scaled(2.0 * path.slopes[i], &own);
        let response = sym_add_scaled(&response, 2.0 * path.det_rates[i], &slope);
        (response, path.curvature(i, &slope, &self.strain_at(i, E_1, volume)))
    }

    /// `C'_i x C~(c_i)`: the Gauss points of the time element integrate `l_i C~` exactly.
    fn det_start(&self, i: usize, E_1: &Sym<f64>, volume: &VolumeAverage<f64>) -> Sym<f64> {
        sym_scaled(2.0, &mixed_cofactor(&volume.strain_rates[i], &self.strain_at(i, E_1, volume)))
    }

    /// C~(c_i).
    fn strain_at(&self, i: usize, E_1: &Sym<f64>, volume: &VolumeAverage<f64>) -> Sym<f64> {
        let k = self.degree();
        let mut E = *E_1;
        for (&a, rate) in self.a[i * k..(i + 1) * k].iter().zip(&volume.strain_rates) {
            E = sym_add_scaled(&E, a, rate);
        }
        right_cauchy_green(&E)
    }

    /// dg_i/d(det C_1) at fixed d_j.
    ///
    /// ```math
    /// phi'(d~_i) + d_i dr,      dr = -sum_j b_j d_j [1/(2 J_1 J_2 (J_1 + J_2)) + phi'(d~_j)] / sum_j b_j d_j^2
    /// ```
    fn slope_start(&self, i: usize, det_1: f64, volume: &VolumeAverage<f64>) -> f64 {
        let k = self.degree();
        let path = &volume.path;
        let J_1 = det_1.sqrt();
        let J_2 = self.det_at(det_1, &self.b, path).sqrt();
        let chord = 0.5 / (J_1 * J_2 * (J_1 + J_2));
        if k == 1 {
            return -chord;
        }
        let curvature = |j: usize| -0.25 * self.det_at(det_1, &self.a[j * k..(j + 1) * k], path).powf(-1.5);
        let sum = |term: &dyn Fn(usize) -> f64| (0..k).map(|j| self.b[j] * term(j)).sum::<f64>();
        let numerator = -sum(&|j| path.det_rates[j] * (chord + curvature(j)));
        let square = sum(&|j| path.det_rates[j] * path.det_rates[j]);
        curvature(i) + path.det_rates[i] * numerator * slope_correction_scale(det_1, square)
    }

    /// Derivatives of [`Rule::mean_pressure`] by `start`, at fixed changes. `[n_pressures]`
    ///
    /// ```math
    /// AS: (1/b_i) sum_m w_m l_i(alpha_m) U''(theta~(alpha_m))
    /// DGM: U''(theta~_i) + theta'_i [U_2' - U_1' - sum_j b_j U''(theta~_j) theta'_j] / sum_j b_j theta'_j^2
    /// ```
    pub fn mean_pressure_start(&self, law: &VolumeLaw, start: f64, change: &[f64], slope: &mut [f64]) {
        slope.fill(0.0);
        match self.kind {
            Kind::Standard | Kind::EnergyMomentum(StressKind::StrainingRates) => {}
            Kind::EnergyMomentum(StressKind::AssumedStrain) => {
                for point in &self.points {
                    let u = law.stiffness(volume_at(start, &point.integrals, change));
                    slope.iter_mut().zip(&point.stage_weights).for_each(|(sum, weight)| *sum += weight * u);
                }
            }
            Kind::EnergyMomentum(StressKind::DiscreteGradient) => {
                let k = self.degree();
                let end = volume_at(start, &self.b, change);
                let mut numerator = law.pressure(end) - law.pressure(start);
                let mut square = 0.0;
                for j in 0..k {
                    slope[j] = law.stiffness(volume_at(start, &self.a[j * k..(j + 1) * k], change));
                    numerator -= self.b[j] * slope[j] * change[j];
                    square += self.b[j] * change[j] * change[j];
                }
                if !law.is_quadratic() {
                    let dr = numerator * correction_scale(start, end, square);
                    slope.iter_mut().zip(change).for_each(|(slope, change)| *slope += change * dr);
                }
            }
        }
    }

    /// Adds the derivatives of the stress of fixed pressures by F_1 to the result of [`Rule::start_tangent`], which
    /// takes the same `start` and `rates`.
    pub fn add_pressure_start(
        &self,
        pressure: &[f64],
        volume: &VolumeAverage<f64>,
        volume_start: &VolumeStart,
        (start, rates): (&Mat3<f64>, &[Mat3<f64>]),
        result: &mut StartTangent,
    ) {
        match self.kind {
            Kind::Standard => {
                for (l, point) in self.points.iter().enumerate() {
                    let S = sym_scaled(pressure[l], &volume.direction[l]);
                    let D = scaled(pressure[l], &volume.curvature[l]);
                    let A = first_elasticity(&volume.gradients[l], &S, &D);
                    for (tangent, weight) in result.tangent.iter_mut().zip(&point.stage_weights) {
                        let entries = tangent.as_flattened_mut().iter_mut().zip(A.as_flattened());
                        entries.for_each(|(sum, entry)| *sum += weight * entry);
                    }
                }
            }
            Kind::EnergyMomentum(_) => {
                self.add_pressure(pressure, volume, rates, Request::Tangent, &mut result.average);
                for (i, stiffness) in result.stiffness.iter_mut().enumerate() {
                    *stiffness = scaled(pressure[i], &volume_start.curvature[i]);
                }
                self.energy_momentum_start_tangent(start, rates, false, result);
            }
        }
    }
}
