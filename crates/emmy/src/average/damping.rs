//! Dissipative stress of a viscosity, and of a dissipative scheme.

use super::{Average, Request, Rule};
use crate::tensor::{
    Elasticity, Lane, Mat3, Sym, add_scaled, double_dot, identity_plus_times_sym, inlined, sym_add_scaled,
    sym_transposed_product,
};

/// Damping of a material point in a step: linear in the strain rates at the Gauss points of the time element.
///
/// ```math
/// S_i = V : E'_i + p_i D : sum_j b_j p_j E'_j,    E'_i = sym(F(c_i)^T F'_i)
/// ```
///
/// with the Legendre polynomial p of degree k - 1, `sum_j b_j p_j^2 = 1`. V is the tensor of Kelvin and Voigt's
/// viscosity over the step size. D acts on the highest Legendre mode of the strain rates, which is of order k in the
/// step size; a dissipative scheme uses a multiple of the elasticity at rest. The dissipated energy per volume is
///
/// ```math
/// sum_i b_i S_i : E'_i >= 0
/// ```
///
/// for positive semidefinite tensors. Because `P_i = F(c_i) S_i`, neither V nor D has a resultant or a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// V \[stress\].
    pub viscous: Elasticity<f64>,
    /// D \[stress\].
    pub dissipative: Elasticity<f64>,
}

impl Rule {
    /// Adds the stage averages of a damping, and their derivatives if wanted, to the result of [`Rule::average`]. Takes
    /// the same `start`, `rates` and `average`; all rates must be given.
    #[inline(always)]
    pub fn add_damping<L: Lane>(
        &self,
        damping: &Damping,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        let zero = start[0][0].splat(0.0);
        self.set_strain_rates(start, rates, average);
        average.stresses.fill([zero; 6]);
        average.stiffness.fill([[zero; 6]; 6]);
        self.add_damping_stress(damping, request, average);
        for i in 0..self.degree() {
            let P = identity_plus_times_sym(&average.gradients[i], &average.stresses[i]);
            average.stress[i] = add_scaled(&average.stress[i], 1.0, &P);
        }
        if request == Request::Tangent {
            self.energy_momentum_tangent(rates, false, average);
        }
    }

    /// Adds the second Piola-Kirchhoff stress of a damping and its derivatives by the strain rates, which must be set
    /// in `average`.
    #[inline(always)]
    pub(super) fn add_damping_stress<L: Lane>(
        &self,
        damping: &Damping,
        request: Request,
        average: &mut Average<L>,
    ) {
        let k = self.degree();
        let stress = self.highest_mode_stress(damping, average);
        for i in 0..k {
            let viscous = times(&damping.viscous, &average.strain_rates[i]);
            let sum = sym_add_scaled(&average.stresses[i], stress[0].splat(self.highest_mode[i]), &stress);
            average.stresses[i] = sym_add_scaled(&sum, stress[0].splat(1.0), &viscous);
        }
        if request == Request::Stress {
            return;
        }
        for i in 0..k {
            for m in 0..k {
                let factor = self.highest_mode[i] * self.b[m] * self.highest_mode[m];
                let is_own = if i == m { 1.0 } else { 0.0 };
                let X = &mut average.stiffness[i * k + m];
                for a in 0..6 {
                    for b in 0..6 {
                        let entry = factor * damping.dissipative[a][b] + is_own * damping.viscous[a][b];
                        X[a][b] += stress[0].splat(entry);
                    }
                }
            }
        }
    }

    /// Energy dissipated per reference volume in a step, `sum_i b_i S_i : E'_i`.
    #[inline(always)]
    pub fn dissipated<L: Lane>(
        &self,
        damping: &Damping,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        average: &mut Average<L>,
    ) -> L {
        let zero = start[0][0].splat(0.0);
        self.set_strain_rates(start, rates, average);
        average.stresses.fill([zero; 6]);
        self.add_damping_stress(damping, Request::Stress, average);
        let mut sum = zero;
        for i in 0..self.degree() {
            sum += double_dot(&average.stresses[i], &average.strain_rates[i]) * self.b[i];
        }
        sum
    }

    /// Sets the displacement gradients and the strain rates at the Gauss points.
    #[inline(always)]
    fn set_strain_rates<L: Lane>(&self, start: &Mat3<L>, rates: &[Mat3<L>], average: &mut Average<L>) {
        let k = self.degree();
        for i in 0..k {
            let G = Rule::gradient_at(start, &self.a[i * k..(i + 1) * k], rates);
            average.strain_rates[i] = sym_transposed_product(&G, &rates[i]);
            average.gradients[i] = G;
        }
    }

    /// `D : sum_j b_j p_j E'_j`.
    #[inline(always)]
    fn highest_mode_stress<L: Lane>(&self, damping: &Damping, average: &Average<L>) -> Sym<L> {
        let zero = average.strain_rates[0][0].splat(0.0);
        let mut rate = [zero; 6];
        for j in 0..self.degree() {
            let weight = zero.splat(self.b[j] * self.highest_mode[j]);
            rate = sym_add_scaled(&rate, weight, &average.strain_rates[j]);
        }
        times(&damping.dissipative, &rate)
    }
}

/// `D : E` with E in plain components.
#[inline(always)]
fn times<L: Lane>(D: &Elasticity<f64>, E: &Sym<L>) -> Sym<L> {
    let row = inlined!(|a: usize| {
        let mut sum = E[0].splat(0.0);
        for b in 0..6 {
            sum += E[b] * (if b < 3 { D[a][b] } else { 2.0 * D[a][b] });
        }
        sum
    });
    [row(0), row(1), row(2), row(3), row(4), row(5)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss;

    const START: Mat3<f64> = [[0.1, 0.2, 0.0], [0.0, -0.1, 0.3], [0.1, 0.0, 0.2]];

    fn rates(k: usize) -> Vec<Mat3<f64>> {
        (0..k)
            .map(|j| [0, 1, 2].map(|r| [0, 1, 2].map(|c| 0.2 * ((7 * j + 3 * r + c) as f64 * 1.7).sin())))
            .collect()
    }

    /// A positive definite tensor that is not isotropic: `B B^T` of the elasticity's form.
    fn tensor(seed: f64) -> Elasticity<f64> {
        let b = |i: usize, j: usize| (seed + (i * 5 + j) as f64).cos();
        std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|m| b(i, m) * b(j, m)).sum()))
    }

    fn rules(k: usize) -> [Rule; 3] {
        [Rule::standard(k, &gauss(k)), Rule::assumed_strain(k, k + 1), Rule::discrete_gradient(k)]
    }

    fn averaged(rule: &Rule, damping: &Damping, rates: &[Mat3<f64>], request: Request) -> Average<f64> {
        let mut average = Average::new(rule.degree(), 0.0);
        rule.add_damping(damping, &START, rates, request, &mut average);
        average
    }

    #[test]
    fn damping_takes_energy_out_and_has_no_moment() {
        let damping = Damping { viscous: tensor(0.3), dissipative: tensor(1.1) };
        for k in 1..=4 {
            for rule in rules(k) {
                let rates = rates(k);
                let stress = averaged(&rule, &damping, &rates, Request::Stress).stress;
                let mut work = 0.0;
                let mut moment = [[0.0; 3]; 3];
                for i in 0..k {
                    let G = Rule::gradient_at(&START, &rule.a[i * k..(i + 1) * k], &rates);
                    for (r, c) in (0..9).map(|n| (n / 3, n % 3)) {
                        let P = stress[i][r][c];
                        work += rule.b[i] * P * rates[i][r][c];
                        for row in 0..3 {
                            let F = G[row][c] + if row == c { 1.0 } else { 0.0 };
                            moment[r][row] += rule.b[i] * P * F;
                        }
                    }
                }
                let mut memory = Average::new(k, 0.0);
                let dissipated = rule.dissipated(&damping, &START, &rates, &mut memory);
                assert!(dissipated > 0.0 && (work - dissipated).abs() < 1e-13 * work, "{work} {dissipated}");
                let skew = (moment[0][1] - moment[1][0]).abs() + (moment[0][2] - moment[2][0]).abs();
                assert!(skew + (moment[1][2] - moment[2][1]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn the_dissipative_part_sees_the_highest_mode() {
        // E' = A + B p_(k-1): the constant does nothing for k > 1. At rest, with rates that strain without turning, E'
        // = sym F' to first order.
        let damping = Damping { viscous: [[0.0; 6]; 6], dissipative: tensor(0.7) };
        for k in 2..=4 {
            let rule = Rule::assumed_strain(k, k);
            let size = 1e-7;
            let of = |constant: f64, highest: f64| {
                let rate = |p: f64| {
                    [0, 1, 2].map(|r| {
                        [0, 1, 2].map(|c| (constant + highest * p) * if r == c { size } else { 0.0 })
                    })
                };
                let rates: Vec<Mat3<f64>> = rule.highest_mode().iter().map(|p| rate(*p)).collect();
                rule.dissipated(&damping, &[[0.0; 3]; 3], &rates, &mut Average::new(k, 0.0)) / (size * size)
            };
            let D = damping.dissipative;
            let trace: f64 = (0..9).map(|n| D[n / 3][n % 3]).sum();
            assert!(of(1.0, 0.0).abs() < 1e-6 * trace, "{k}");
            assert!((of(1.0, 2.0) - 4.0 * trace).abs() < 1e-5 * trace, "{k}");
        }
    }

    #[test]
    fn tangents_are_derivatives() {
        let damping = Damping { viscous: tensor(0.3), dissipative: tensor(1.1) };
        for k in 1..=3 {
            for rule in rules(k) {
                let tangent = averaged(&rule, &damping, &rates(k), Request::Tangent).tangent;
                for (j, r, c) in (0..9 * k).map(|n| (n / 9, n / 3 % 3, n % 3)) {
                    let at = |shift: f64| {
                        let mut rates = rates(k);
                        rates[j][r][c] += shift;
                        averaged(&rule, &damping, &rates, Request::Stress).stress
                    };
                    let plus = at(1e-5);
                    let minus = at(-1e-5);
                    for (i, n) in (0..9 * k).map(|n| (n / 9, n % 9)) {
                        let slope = (plus[i][n / 3][n % 3] - minus[i][n / 3][n % 3]) / 2e-5;
                        assert!((tangent[i * k + j][n][3 * r + c] - slope).abs() < 1e-7, "{k} {i} {j} {n}");
                    }
                }
            }
        }
    }
}
