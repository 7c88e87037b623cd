//! Rates of det C and of J along an assumed strain.
//!
//! det C is cubic in C and integrated exactly; J = sqrt(det C) has a scalar discrete gradient.
//!
//! ```math
//! M_i = (1/b_i) sum_m w_m l_i(alpha_m) cof C~(alpha_m),      d_i = M_i : C'_i,      sum_i b_i d_i = det C_2 - det C_1
//! g_i = phi(d~(c_i)) + r d_i,      J'_i = g_i d_i,      sum_i b_i J'_i = J_2 - J_1,      phi(d) = 1/(2 sqrt d)
//! r = sum_j b_j d_j (1/(J_1 + J_2) - phi(d~(c_j))) / sum_j b_j d_j^2
//! ```
//!
//! with `C' = 2 E'` and `B_i = 2 g_i M_i`.

#![allow(non_snake_case)]

use super::{VolumeAverage, scaled};
use crate::average::{Request, Rule};
use crate::material::VolumeMeasure;
use crate::tensor::{
    Elasticity, Lane, Sym, cofactor_derivative, double_dot, mixed_cofactor, sym_add_scaled, sym_cofactor,
    sym_det, sym_scaled, trace,
};

/// Memory of the rates of det C and J.
#[derive(Debug, Clone)]
pub(super) struct Path<L> {
    /// M_i, `[k]`.
    pub cofactors: Vec<Sym<L>>,
    /// Means of the strains `(1/b_i) sum_m w_m l_i L_j C~`, `[i k + j]`: the derivatives of the cofactors.
    pub strains: Vec<Sym<L>>,
    /// d_i, `[k]`.
    pub det_rates: Vec<L>,
    /// Derivatives dd_i/dC'_j, `[i k + j]`.
    pub det_response: Vec<Sym<L>>,
    /// g_i, `[k]`.
    pub slopes: Vec<L>,
    /// Derivatives dg_i/dd_j, `[i k + j]`.
    pub slope_response: Vec<L>,
}

impl<L: Lane> Path<L> {
    pub(super) fn new(k: usize, zero: L) -> Self {
        Path {
            cofactors: vec![[zero; 6]; k],
            strains: vec![[zero; 6]; k * k],
            det_rates: vec![zero; k],
            det_response: vec![[zero; 6]; k * k],
            slopes: vec![zero; k],
            slope_response: vec![zero; k * k],
        }
    }
}

/// C = I + 2 E.
#[inline(always)]
pub(super) fn right_cauchy_green<L: Lane>(E: &Sym<L>) -> Sym<L> {
    let one = E[0].splat(1.0);
    let zero = one.splat(0.0);
    sym_add_scaled(&[one, one, one, zero, zero, zero], one.splat(2.0), E)
}

/// `1 / sum_j b_j d_j^2`, or 0 where the correction of the order d^2 is lost in rounding.
#[inline(always)]
pub(super) fn slope_correction_scale<L: Lane>(det_1: L, square: L) -> L {
    square.select_below(det_1 * det_1 * 1e-16, det_1.splat(0.0), det_1.splat(1.0) / square)
}

impl Rule {
    /// Rates of the volume along the assumed strain from E_1.
    #[inline(always)]
    pub(super) fn set_path<L: Lane>(
        &self,
        measure: VolumeMeasure,
        E_1: &Sym<L>,
        request: Request,
        volume: &mut VolumeAverage<L>,
    ) {
        volume.start = measure.change(E_1);
        match measure {
            VolumeMeasure::Trace => self.set_traces(E_1, request, volume),
            VolumeMeasure::Ratio => {
                self.set_det_rates(E_1, request, volume);
                self.set_slopes(sym_det(&right_cauchy_green(E_1)), request, &mut volume.path);
                self.set_ratios(request, volume);
            }
        }
    }

    /// theta = tr E is linear in the strain.
    #[inline(always)]
    fn set_traces<L: Lane>(&self, E_1: &Sym<L>, request: Request, volume: &mut VolumeAverage<L>) {
        let unit = VolumeMeasure::Trace.direction(E_1);
        let zero = [E_1[0].splat(0.0); 6];
        let k = self.degree();
        for i in 0..k {
            volume.change[i] = trace(&volume.strain_rates[i]);
            volume.direction[i] = unit;
            if request == Request::Tangent {
                for j in 0..k {
                    volume.response[i * k + j] = if i == j { unit } else { zero };
                    volume.curvature[i * k + j] = [zero; 6];
                }
            }
        }
    }

    /// M_i and d_i.
    #[inline(always)]
    fn set_det_rates<L: Lane>(&self, E_1: &Sym<L>, request: Request, volume: &mut VolumeAverage<L>) {
        let zero = E_1[0].splat(0.0);
        let k = self.degree();
        let path = &mut volume.path;
        path.cofactors.fill([zero; 6]);
        if request == Request::Tangent {
            path.strains.fill([zero; 6]);
        }
        for point in &self.det_points {
            let mut E = *E_1;
            for (&L_j, rate) in point.integrals.iter().zip(&volume.strain_rates) {
                E = sym_add_scaled(&E, zero.splat(L_j), rate);
            }
            let C = right_cauchy_green(&E);
            let cofactor = sym_cofactor(&C);
            for i in 0..k {
                let weight = point.stage_weights[i];
                path.cofactors[i] = sym_add_scaled(&path.cofactors[i], zero.splat(weight), &cofactor);
                if request == Request::Tangent {
                    for j in 0..k {
                        let strain = &mut path.strains[i * k + j];
                        *strain = sym_add_scaled(strain, zero.splat(weight * point.integrals[j]), &C);
                    }
                }
            }
        }
        for i in 0..k {
            path.det_rates[i] = double_dot(&path.cofactors[i], &volume.strain_rates[i]) * 2.0;
        }
    }

    /// g_i, and its derivatives by d_j:
    ///
    /// ```math
    /// dg_i/dd_j = phi'(d~_i) a_ij + r delta_ij + d_i dr_j
    /// dr_j = [b_j (1/(2 J_2) - phi_j) - sum_l b_l phi'(d~_l) a_lj d_l - 2 r b_j d_j] / sum_l b_l d_l^2
    /// ```
    ///
    /// For k = 1, `g = 1/(J_1 + J_2)`.
    #[inline(always)]
    fn set_slopes<L: Lane>(&self, det_1: L, request: Request, path: &mut Path<L>) {
        let one = det_1.splat(1.0);
        let zero = det_1.splat(0.0);
        let k = self.degree();
        let J_2 = self.det_at(det_1, &self.b, path).sqrt();
        let chord = one / (det_1.sqrt() + J_2);
        if k == 1 {
            path.slopes[0] = chord;
            if request == Request::Tangent {
                path.slope_response[0] = -chord * chord * (one / J_2) * 0.5;
            }
            return;
        }
        let mut numerator = zero;
        let mut square = zero;
        for i in 0..k {
            let det = self.det_at(det_1, &self.a[i * k..(i + 1) * k], path);
            let phi = one / det.sqrt() * 0.5;
            let curvature = phi / det * -0.5;
            path.slopes[i] = phi;
            for j in 0..k {
                path.slope_response[i * k + j] = curvature * self.a[i * k + j];
            }
            numerator += path.det_rates[i] * (chord - phi) * self.b[i];
            square += path.det_rates[i] * path.det_rates[i] * self.b[i];
        }
        let inverse = slope_correction_scale(det_1, square);
        let r = numerator * inverse;
        if request == Request::Tangent {
            let end = one / J_2 * 0.5;
            for j in 0..k {
                let mut dr = (end - path.slopes[j] - r * path.det_rates[j] * 2.0) * self.b[j];
                for l in 0..k {
                    dr += path.slope_response[l * k + j] * path.det_rates[l] * -self.b[l];
                }
                dr = dr * inverse;
                for i in 0..k {
                    path.slope_response[i * k + j] += path.det_rates[i] * dr;
                }
                path.slope_response[j * k + j] += r;
            }
        }
        for i in 0..k {
            path.slopes[i] += r * path.det_rates[i];
        }
    }

    /// `det C_1 + sum_j L_j d_j`.
    #[inline(always)]
    pub(super) fn det_at<L: Lane>(&self, det_1: L, integrals: &[f64], path: &Path<L>) -> L {
        let mut det = det_1;
        for (&L_j, &rate) in integrals.iter().zip(&path.det_rates) {
            det += rate * L_j;
        }
        det
    }

    /// J'_i and B_i, and their derivatives:
    ///
    /// ```math
    /// dd_i/dC'_j = M_i delta_ij + C'_i x C^_ij,      G_ij = sum_l dg_i/dd_l dd_l/dC'_j
    /// dJ'_i/dE'_j = 2 (g_i dd_i/dC'_j + d_i G_ij),      dB_i/dE'_j = 4 (M_i (x) G_ij + g_i C^_ij x)
    /// ```
    #[inline(always)]
    fn set_ratios<L: Lane>(&self, request: Request, volume: &mut VolumeAverage<L>) {
        let k = self.degree();
        let path = &mut volume.path;
        for i in 0..k {
            volume.change[i] = path.slopes[i] * path.det_rates[i];
            volume.direction[i] = sym_scaled(path.slopes[i] * 2.0, &path.cofactors[i]);
        }
        if request == Request::Stress {
            return;
        }
        for i in 0..k {
            for j in 0..k {
                let rate = &volume.strain_rates[i];
                let half = mixed_cofactor(rate, &path.strains[i * k + j]);
                let mut response = sym_add_scaled(&half, rate[0].splat(1.0), &half);
                if i == j {
                    response = sym_add_scaled(&response, rate[0].splat(1.0), &path.cofactors[i]);
                }
                path.det_response[i * k + j] = response;
            }
        }
        for i in 0..k {
            for j in 0..k {
                let slope = path.slope_derivative(i, j);
                let own = sym_scaled(path.slopes[i] * 2.0, &path.det_response[i * k + j]);
                volume.response[i * k + j] = sym_add_scaled(&own, path.det_rates[i] * 2.0, &slope);
                volume.curvature[i * k + j] = path.curvature(i, &slope, &path.strains[i * k + j]);
            }
        }
    }
}

impl<L: Lane> Path<L> {
    /// `G_ij = sum_l dg_i/dd_l dd_l/dC'_j`.
    #[inline(always)]
    fn slope_derivative(&self, i: usize, j: usize) -> Sym<L> {
        let k = self.slopes.len();
        let mut sum = sym_scaled(self.slope_response[i * k], &self.det_response[j]);
        for l in 1..k {
            sum = sym_add_scaled(&sum, self.slope_response[i * k + l], &self.det_response[l * k + j]);
        }
        sum
    }

    /// `4 (M_i (x) G + g_i C x)`.
    #[inline(always)]
    pub(super) fn curvature(&self, i: usize, G: &Sym<L>, C: &Sym<L>) -> Elasticity<L> {
        let mut D = scaled(self.slopes[i] * 4.0, &cofactor_derivative(C));
        for a in 0..6 {
            for b in 0..6 {
                D[a][b] += self.cofactors[i][a] * G[b] * 4.0;
            }
        }
        D
    }
}
