//! Derivatives of the averages by the deformation gradient at the start of the step, for the adjoint.

use super::energy_momentum::times_doubled;
use super::standard::{add_geometric, first_elasticity, first_from_second, strain_response, with_identity};
use super::{Average, Kind, Request, Rule, StressKind};
use crate::material::Response;
use crate::tensor::{Elasticity, Mat3, Sym, Tangent, double_dot, green_lagrange, sym_add_scaled, sym_scaled};

/// Derivatives of a rule's averages at a material point, with their working memory.
#[derive(Debug, Clone)]
pub struct StartTangent {
    /// Derivatives dP_i/dF_1 at fixed rates, `[k]`.
    pub tangent: Vec<Tangent<f64>>,
    /// Derivatives dS_i/dE_1 at fixed strain rates, `[k]`.
    pub(super) stiffness: Vec<Elasticity<f64>>,
    pub(super) average: Average<f64>,
}

impl StartTangent {
    /// Memory for a rule of a degree.
    pub fn new(degree: usize) -> Self {
        StartTangent {
            tangent: vec![[[0.0; 9]; 9]; degree],
            stiffness: vec![[[0.0; 6]; 6]; degree],
            average: Average::new(degree, 0.0),
        }
    }
}

impl Rule {
    /// Derivatives of the stage averages by the deformation gradient at the start, at fixed rates. Arguments as in
    /// [`Rule::average`].
    ///
    /// ```math
    /// FE: dP_i = (1/b_i) sum_l w_l l_i(alpha_l) A(F(alpha_l)) dF_1
    /// AS, DGM: dP_i = dF_1 S_i + F(c_i) [dS_i/dE_1 : sym(F_1^T dF_1) + sum_m dS_i/dE'_m : sym(F'_m^T dF_1)]
    /// ```
    pub fn start_tangent(
        &self,
        material: &dyn Response<f64>,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        result: &mut StartTangent,
    ) {
        match self.kind {
            Kind::Standard => self.standard_start_tangent(material, start, rates, result),
            Kind::EnergyMomentum(StressKind::AssumedStrain | StressKind::StrainingRates) => {
                self.average(material, start, rates, Request::Tangent, &mut result.average);
                self.assumed_strain_start_stiffness(material, &green_lagrange(start), result);
                self.energy_momentum_start_tangent(start, rates, true, result);
            }
            Kind::EnergyMomentum(StressKind::DiscreteGradient) => {
                self.average(material, start, rates, Request::Tangent, &mut result.average);
                self.discrete_gradient_start_stiffness(material, start, rates, result);
                self.energy_momentum_start_tangent(start, rates, true, result);
            }
        }
    }

    fn standard_start_tangent(
        &self,
        material: &dyn Response<f64>,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        result: &mut StartTangent,
    ) {
        result.tangent.fill([[0.0; 9]; 9]);
        let mut S = [0.0; 6];
        let mut D = [[0.0; 6]; 6];
        for point in &self.points {
            let G = Rule::gradient_at(start, &point.integrals, rates);
            material.stress_and_elasticity(&green_lagrange(&G), &mut S, &mut D);
            let A = first_elasticity(&G, &S, &D);
            for (tangent, weight) in result.tangent.iter_mut().zip(&point.stage_weights) {
                let entries = tangent.as_flattened_mut().iter_mut().zip(A.as_flattened());
                entries.for_each(|(sum, entry)| *sum += weight * entry);
            }
        }
    }

    /// ```math
    /// dS_i/dE_1 = (1/b_i) sum_m w_m l_i(alpha_m) D(E~(alpha_m))
    /// ```
    fn assumed_strain_start_stiffness(
        &self,
        material: &dyn Response<f64>,
        E_1: &Sym<f64>,
        result: &mut StartTangent,
    ) {
        result.stiffness.fill([[0.0; 6]; 6]);
        let mut S = [0.0; 6];
        let mut D = [[0.0; 6]; 6];
        for point in &self.points {
            let E = self.assumed_strain_at(E_1, &point.integrals, &mut result.average);
            material.stress_and_elasticity(&E, &mut S, &mut D);
            for (stiffness, weight) in result.stiffness.iter_mut().zip(&point.stage_weights) {
                let entries = stiffness.as_flattened_mut().iter_mut().zip(D.as_flattened());
                entries.for_each(|(sum, entry)| *sum += weight * entry);
            }
        }
    }

    /// ```math
    /// dS_i/dE_1 = D(E~_i) + E'_i (x) [S_2 - S_1 - sum_j b_j D(E~_j) : E'_j] / sum_j b_j E'_j : E'_j
    /// ```
    fn discrete_gradient_start_stiffness(
        &self,
        material: &dyn Response<f64>,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        result: &mut StartTangent,
    ) {
        let average = &result.average;
        let E_1 = green_lagrange(start);
        let E_2 = green_lagrange(&Rule::gradient_at(start, &self.b, rates));
        let (mut S_1, mut S_2) = ([0.0; 6], [0.0; 6]);
        material.stress(&E_1, &mut S_1);
        material.stress(&E_2, &mut S_2);
        let mut dr = sym_add_scaled(&S_2, -1.0, &S_1);
        let mut square = 0.0;
        let mut change = [0.0; 6];
        for (j, rate) in average.strain_rates.iter().enumerate() {
            dr = sym_add_scaled(&dr, -self.b[j], &times_doubled(&average.elasticities[j], rate));
            square += self.b[j] * double_dot(rate, rate);
            change = sym_add_scaled(&change, self.b[j], rate);
        }
        // Where the rule has no correction, see there.
        let resting = 1e-36 * (double_dot(&E_1, &E_1) + double_dot(&change, &change)) + 1e-300;
        dr = sym_scaled(if square * square < resting { 0.0 } else { 1.0 / square }, &dr);
        for i in 0..self.degree() {
            let rate = average.strain_rates[i];
            for (a, b) in (0..36).map(|at| (at / 6, at % 6)) {
                result.stiffness[i][a][b] = average.elasticities[i][a][b] + rate[a] * dr[b];
            }
        }
    }

    /// The derivatives of `P_i = F(c_i) S_i` from those of S_i, set or added.
    pub(super) fn energy_momentum_start_tangent(
        &self,
        start: &Mat3<f64>,
        rates: &[Mat3<f64>],
        is_first: bool,
        result: &mut StartTangent,
    ) {
        let k = self.degree();
        let F_1 = with_identity(start);
        let average = &result.average;
        for i in 0..k {
            let mut Y = strain_response(&result.stiffness[i], &F_1);
            for (stiffness, rate) in average.stiffness[i * k..(i + 1) * k].iter().zip(rates) {
                let part = strain_response(stiffness, rate);
                let entries = Y.as_flattened_mut().iter_mut().zip(part.as_flattened());
                entries.for_each(|(sum, entry)| *sum += entry);
            }
            let mut A = first_from_second(&average.gradients[i], &Y);
            add_geometric(&mut A, 1.0, &average.stresses[i]);
            let entries = result.tangent[i].as_flattened_mut().iter_mut().zip(A.as_flattened());
            entries.for_each(|(sum, A)| *sum = if is_first { *A } else { *sum + *A });
        }
    }
}
