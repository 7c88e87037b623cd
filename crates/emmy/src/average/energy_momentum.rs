//! Energy-momentum rules: the outer quadrature belongs to the time element, the stress is algorithmic (section 4.3).
//!
//! Both rules work on the strain rates `E'_i = sym(F(c_i)^T F'_i)` and the assumed strain
//! `E~(alpha) = E_1 + sum_j L_j(alpha) E'_j`, and return `P_i = F(c_i) S_i`.

use super::standard::{add_geometric, first_from_second, strain_response, with_identity};
use super::{Average, Kind, Request, Rule, StressKind};
use crate::material::Response;
use crate::tensor::{
    Elasticity, Lane, Mat3, Sym, det_of_identity_plus, double_dot, green_lagrange, identity_plus_times_sym,
    inlined, mat3, sym_add_scaled, sym_scaled, sym_transposed_product, trace,
};

impl Rule {
    /// ```math
    /// P_i = F(c_i) S_i
    /// ```
    #[inline(always)]
    pub(super) fn average_energy_momentum<L: Lane>(
        &self,
        kind: StressKind,
        material: &dyn Response<L>,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let end = Rule::gradient_at(start, &self.b, rates);
        average.min_det = det_of_identity_plus(&end);
        for i in 0..k {
            let G = Rule::gradient_at(start, &self.a[i * k..(i + 1) * k], rates);
            average.min_det = average.min_det.min(det_of_identity_plus(&G));
            let rate = sym_transposed_product(&G, &rates[i]);
            average.strain_rates[i] = if material.is_link() { trace_part(&rate) } else { rate };
            average.gradients[i] = G;
        }
        let E_1 = green_lagrange(start);
        match kind {
            StressKind::AssumedStrain | StressKind::StrainingRates => {
                self.assumed_strain_stress(material, &E_1, request, average)
            }
            StressKind::DiscreteGradient => {
                self.discrete_gradient_stress(material, &E_1, &end, request, average)
            }
        }
        for i in 0..k {
            average.stress[i] = identity_plus_times_sym(&average.gradients[i], &average.stresses[i]);
        }
        if request == Request::Tangent {
            self.energy_momentum_tangent(rates, true, average);
        }
    }

    /// Assumed strain at a point inside the step. For k >= 2 it may not be the strain of any deformation; then the
    /// smallest determinant is not positive.
    #[inline(always)]
    pub(super) fn assumed_strain_at<L: Lane>(
        &self,
        E_1: &Sym<L>,
        integrals: &[f64],
        average: &mut Average<L>,
    ) -> Sym<L> {
        let mut E = *E_1;
        for (&L_j, rate) in integrals.iter().zip(&average.strain_rates) {
            E = sym_add_scaled(&E, E_1[0].splat(L_j), rate);
        }
        if self.degree() > 1 {
            average.min_det = average.min_det.min(smallest_minor(&E));
        }
        E
    }

    /// ```math
    /// S_i = (1/b_i) sum_m w_m l_i(alpha_m) 2 DW(C~(alpha_m))
    /// ```
    #[inline(always)]
    fn assumed_strain_stress<L: Lane>(
        &self,
        material: &dyn Response<L>,
        E_1: &Sym<L>,
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let zero = E_1[0].splat(0.0);
        average.stresses.fill([zero; 6]);
        let is_straight = k == 1 && self.points.len() > 1;
        if is_straight {
            material.stress_along(E_1, &average.strain_rates[0], &self.path, &mut average.stresses[0]);
        }
        if request == Request::Tangent {
            average.stiffness.fill([[zero; 6]; 6]);
        } else if is_straight {
            return;
        }
        let mut S = [zero; 6];
        let mut D = [[zero; 6]; 6];
        for point in &self.points {
            let E = self.assumed_strain_at(E_1, &point.integrals, average);
            match request {
                Request::Stress => material.stress(&E, &mut S),
                Request::Tangent => material.stress_and_elasticity(&E, &mut S, &mut D),
            }
            if !is_straight {
                for i in 0..k {
                    average.stresses[i] =
                        sym_add_scaled(&average.stresses[i], zero.splat(point.stage_weights[i]), &S);
                }
            }
            if request == Request::Stress {
                continue;
            }
            for i in 0..k {
                for m in 0..k {
                    let weight = point.stage_weights[i] * point.integrals[m];
                    add_elasticity(&mut average.stiffness[i * k + m], weight, &D);
                }
            }
        }
    }

    /// ```math
    /// S_i = S(C~_i) + r E'_i,    r = [W_2 - W_1 - sum_j b_j S(C~_j) : E'_j] / sum_j b_j E'_j : E'_j
    /// ```
    ///
    /// (in C: equation (64), with 2 DW = S and C' = 2 E').
    #[inline(always)]
    fn discrete_gradient_stress<L: Lane>(
        &self,
        material: &dyn Response<L>,
        E_1: &Sym<L>,
        end: &Mat3<L>,
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let zero = E_1[0].splat(0.0);
        let mut work = zero;
        let mut square = zero;
        let mut change = [zero; 6];
        for i in 0..k {
            let E = self.assumed_strain_at(E_1, &self.a[i * k..(i + 1) * k], average);
            let rate = average.strain_rates[i];
            change = sym_add_scaled(&change, zero.splat(self.b[i]), &rate);
            let stress = &mut average.stresses[i];
            let elasticity = &mut average.elasticities[i];
            match request {
                Request::Stress => material.stress(&E, stress),
                Request::Tangent => material.stress_and_elasticity(&E, stress, elasticity),
            }
            work += double_dot(&average.stresses[i], &rate) * self.b[i];
            square += double_dot(&rate, &rate) * self.b[i];
        }
        // Along the change E_2 - E_1 = sum_j b_j E'_j, which is exact.
        let energy_change = match material.energy_change(E_1, &change) {
            Some(energy_change) => energy_change,
            None => self.energy_difference(material, E_1, &green_lagrange(end), average),
        };
        let numerator = energy_change - work;
        // The correction r E' is of the order |E'|^2, the rounding of S of the order eps |E|: below this rate the
        // correction is lost in rounding. The constant only keeps the division from overflowing.
        let strain_square = double_dot(E_1, E_1) + double_dot(&change, &change);
        let resting = strain_square * 1e-36 + zero.splat(1e-300);
        let inverse = (square * square).select_below(resting, zero, zero.splat(1.0) / square);
        let r = numerator * inverse;
        if request == Request::Tangent {
            let mut S_2 = [zero; 6];
            material.stress(&green_lagrange(end), &mut S_2);
            self.discrete_gradient_stiffness(&S_2, r, inverse, material.is_link(), average);
        }
        for i in 0..k {
            average.stresses[i] = sym_add_scaled(&average.stresses[i], r, &average.strain_rates[i]);
        }
    }

    /// W_2 - W_1 of a material without a closed form: the difference, or the Gauss quadrature along the assumed strain
    /// if both agree within the rounding of the difference, because the quadrature is then less noisy.
    #[inline(always)]
    fn energy_difference<L: Lane>(
        &self,
        material: &dyn Response<L>,
        E_1: &Sym<L>,
        E_2: &Sym<L>,
        average: &mut Average<L>,
    ) -> L {
        let zero = E_1[0].splat(0.0);
        let (W_1, W_2) = (material.strain_energy(E_1), material.strain_energy(E_2));
        let mut integral = zero;
        let mut stress_norm = zero;
        let mut S = [zero; 6];
        for point in &self.points {
            let E = self.assumed_strain_at(E_1, &point.integrals, average);
            material.stress(&E, &mut S);
            let mut rate = [zero; 6];
            for (&l_j, r) in point.basis.iter().zip(&average.strain_rates) {
                rate = sym_add_scaled(&rate, zero.splat(l_j), r);
            }
            integral += double_dot(&S, &rate) * point.weight;
            stress_norm += double_dot(&S, &S).sqrt() * point.weight;
        }
        // Strains have an absolute error of eps times the products whose difference they are, C ~ 1 + |E|.
        let strain_size = zero.splat(1.0) + (trace(E_1) + trace(E_2)).abs();
        let rounding = (W_1.abs() + W_2.abs() + stress_norm * strain_size) * (4.0 * f64::EPSILON);
        let direct = W_2 - W_1;
        (direct - integral).abs().select_below(rounding, integral, direct)
    }

    /// dS_i/dE'_m of the discrete gradient: r and the stresses differentiated (equation (79)).
    #[inline(always)]
    fn discrete_gradient_stiffness<L: Lane>(
        &self,
        S_2: &Sym<L>,
        r: L,
        inverse: L,
        is_link: bool,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let zero = r.splat(0.0);
        for m in 0..k {
            let mut dr = sym_add_scaled(
                &sym_scaled(zero.splat(self.b[m]), S_2),
                zero.splat(-self.b[m]),
                &average.stresses[m],
            );
            for j in 0..k {
                let response = times_doubled(&average.elasticities[j], &average.strain_rates[j]);
                dr = sym_add_scaled(&dr, zero.splat(-self.b[j] * self.a[j * k + m]), &response);
            }
            dr = sym_add_scaled(&dr, r * (-2.0 * self.b[m]), &average.strain_rates[m]);
            dr = sym_scaled(inverse, &dr);
            for i in 0..k {
                let rate = average.strain_rates[i];
                let X = &mut average.stiffness[i * k + m];
                for a in 0..6 {
                    for b in 0..6 {
                        X[a][b] = average.elasticities[i][a][b] * self.a[i * k + m] + rate[a] * dr[b];
                    }
                }
                if i == m {
                    add_derivative_of_rate(X, r, is_link);
                }
            }
        }
    }

    /// The derivatives of `P_i = F(c_i) S_i`.
    ///
    /// ```math
    /// dP_i = a_ij dF'_j S_i + F(c_i) sum_m dS_i/dE'_m : sym(H_mj^T dF'_j),    H_mj = F(c_j) delta_mj + a_mj F'_m
    /// ```
    #[inline(always)]
    pub(super) fn energy_momentum_tangent<L: Lane>(
        &self,
        rates: &[Mat3<L>],
        is_first: bool,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        for i in 0..k {
            for j in 0..k {
                let mut Y = [[rates[0][0][0]; 9]; 6];
                for m in 0..k {
                    let H = self.rate_response(rates, &average.gradients, m, j);
                    let part = strain_response(&average.stiffness[i * k + m], &H);
                    for a in 0..6 {
                        for c in 0..9 {
                            Y[a][c] = if m == 0 { part[a][c] } else { Y[a][c] + part[a][c] };
                        }
                    }
                }
                let mut A = first_from_second(&average.gradients[i], &Y);
                add_geometric(&mut A, self.a[i * k + j], &average.stresses[i]);
                let sum = &mut average.tangent[i * k + j];
                for (sum, A) in sum.as_flattened_mut().iter_mut().zip(A.as_flattened()) {
                    *sum = if is_first { *A } else { *sum + *A };
                }
            }
        }
    }

    /// H_mj of `dE'_m = sym(H_mj^T dF'_j)`, the response of the strain rates.
    #[inline(always)]
    pub(super) fn rate_response<L: Lane>(
        &self,
        rates: &[Mat3<L>],
        gradients: &[Mat3<L>],
        m: usize,
        j: usize,
    ) -> Mat3<L> {
        let turned = if self.kind == Kind::EnergyMomentum(StressKind::StrainingRates) {
            0.0
        } else {
            self.a[m * self.degree() + j]
        };
        let mut H = mat3(
            #[inline(always)]
            |r, c| rates[m][r][c] * turned,
        );
        if m == j {
            let F = with_identity(&gradients[j]);
            for r in 0..3 {
                for c in 0..3 {
                    H[r][c] += F[r][c];
                }
            }
        }
        H
    }
}

/// `1/3 tr E' I`, the strain rate of a link: its energy depends on tr E alone. A correction along it is a multiple of
/// I, which pulls along the link and has no moment.
#[inline(always)]
fn trace_part<L: Lane>(rate: &Sym<L>) -> Sym<L> {
    let third = trace(rate) * (1.0 / 3.0);
    let zero = rate[0].splat(0.0);
    [third, third, third, zero, zero, zero]
}

/// Adds the derivative of `r E'` by E' at fixed r.
#[inline(always)]
fn add_derivative_of_rate<L: Lane>(X: &mut Elasticity<L>, r: L, is_link: bool) {
    if is_link {
        for a in 0..3 {
            for b in 0..3 {
                X[a][b] += r * (1.0 / 3.0);
            }
        }
        return;
    }
    for a in 0..6 {
        X[a][a] += r * if a < 3 { 1.0 } else { 0.5 };
    }
}

#[inline(always)]
fn add_elasticity<L: Lane>(X: &mut Elasticity<L>, weight: f64, D: &Elasticity<L>) {
    for a in 0..6 {
        for b in 0..6 {
            X[a][b] += D[a][b] * weight;
        }
    }
}

/// `D : E` with E in plain components, whose shears are doubled here.
#[inline(always)]
pub(super) fn times_doubled<L: Lane>(D: &Elasticity<L>, E: &Sym<L>) -> Sym<L> {
    let row = inlined!(|a: usize| double_dot(&D[a], E));
    [row(0), row(1), row(2), row(3), row(4), row(5)]
}

/// The smallest leading minor of C = I + 2 E: positive where C is a right Cauchy-Green tensor.
#[inline(always)]
fn smallest_minor<L: Lane>(E: &Sym<L>) -> L {
    let one = E[0].splat(1.0);
    let C = [E[0] * 2.0 + one, E[1] * 2.0 + one, E[2] * 2.0 + one, E[3] * 2.0, E[4] * 2.0, E[5] * 2.0];
    C[0].min(C[0] * C[1] - C[3] * C[3]).min(crate::tensor::sym_det(&C))
}
