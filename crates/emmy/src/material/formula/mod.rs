//! Materials whose energy is a formula in the invariants of C.

#![allow(non_snake_case)]

mod expression;
mod graph;
mod lowering;
mod program;
mod tape;
#[cfg(test)]
mod tests;

use std::sync::Arc;

pub use expression::{Expression, Invariant};

use super::invariants::right_cauchy_green;
use super::{Material, VolumeLaw, VolumeMeasure, Volumetric, axes, compiled_with_this_crate};
use crate::error::Result;
use crate::tensor::{
    Elasticity, Lane, SYM_INDEX, Sym, double_dot, inlined, mixed_cofactor, sym, sym_cofactor, sym_det,
    sym_scaled, trace,
};
use graph::{F, INPUTS, U, VARIABLES, W, Z};
use program::{PAIRS, Program, TANGENT, VolumeFunction};

/// A material whose stored energy is a formula in the invariants of C, differentiated by rule.
///
/// ```math
/// W = W(I1, I2, I3, J, I1bar, I2bar, I4, I4bar),      S = sum_i dW/dI_i dI_i/dE
/// ```
///
/// `I4 = a . C a` belongs to a fibre of direction a. W and S keep all their digits at strains from 1e-8 on, as those of
/// the other materials do: the program that evaluates the formula works with changes from the reference configuration,
/// in which the linear terms of the energy, such as those of `mu/2 (I1 - 3) - mu ln J`, cancel before they are
/// computed. A constant in the formula has no effect: W = 0 at rest.
///
/// A step of a body costs little more than with a built-in material of the same functions, and allocates nothing.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::material::{EnergyFormula, Expression, Invariant};
/// let [i1, j] = [Invariant::I1, Invariant::J].map(Expression::from);
/// let energy = 250.0 * (i1 - 3.0) - 500.0 * j.clone().ln() + 500.0 * j.ln().power(2.0);
/// let formula = EnergyFormula::new(&energy, None)?;
/// let builtin = NeoHooke::new(1000.0, 500.0)?;
/// let strain = [1e-8, 0.0, 2e-8, 0.0, -1e-8, 0.0];
/// let [own, exact] = [formula.strain_energy(&strain), builtin.strain_energy(&strain)];
/// assert!((own / exact - 1.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyFormula {
    energy: Expression,
    /// a (x) a.
    fibre: Sym<f64>,
    program: Arc<Program>,
}

/// A, its polynomials and the variables of the tapes.
struct Strain<L> {
    A: Sym<L>,
    cofactor: Sym<L>,
    trace: L,
    inputs: [L; INPUTS],
}

/// Inputs of the tapes from the trace of A, that of its cofactor, its determinant, `a . A a`, and det C.
#[inline(always)]
fn inputs<L: Lane>(trace: L, second: L, det: L, fibre: L, det_C: L) -> [L; INPUTS] {
    let w = second + det;
    [trace + w, w, w + det, fibre, det_C]
}

impl EnergyFormula {
    /// The material with an energy \[energy/length^3\] and the direction of its fibre, not necessarily a unit vector.
    ///
    /// # Errors
    /// [`crate::Error::EnergyFormula`] if the formula is not finite and twice differentiable at rest, if the stress at
    /// rest is not 0 within 1e-10 of the moduli, if the moduli at rest are not positive, if the formula is too long, or
    /// if it has I4 and no fibre, or a fibre and no I4; [`crate::Error::Direction`] for a fibre of no direction.
    pub fn new(energy: &Expression, fibre: Option<[f64; 3]>) -> Result<Self> {
        program::check_fibre(energy, fibre.is_some())?;
        let a = fibre.map_or(Ok([0.0; 3]), |direction| axes::unit("energy", "fibre", direction))?;
        let program = Arc::new(Program::new(energy)?);
        Ok(EnergyFormula { energy: energy.clone(), fibre: sym(|i, j| a[i] * a[j]), program })
    }

    #[inline(always)]
    fn strain<L: Lane>(&self, E: &Sym<L>) -> Strain<L> {
        let A = sym_scaled(E[0].splat(2.0), E);
        let cofactor = sym_cofactor(&A);
        let t = trace(&A);
        let fibre = double_dot(&A, &self.fibre_of(E[0]));
        let inputs = inputs(t, trace(&cofactor), sym_det(&A), fibre, sym_det(&right_cauchy_green(&A)));
        Strain { A, cofactor, trace: t, inputs }
    }

    /// a (x) a in every lane.
    #[inline(always)]
    fn fibre_of<L: Lane>(&self, one: L) -> Sym<L> {
        sym(
            #[inline(always)]
            |i, j| one.splat(self.fibre[SYM_INDEX[i][j]]),
        )
    }

    /// ```math
    /// S = 2 [W_z I + (W_z + W_w + W_u) M + (W_z + W_w + 2 W_u) cof A + W_f a (x) a],      M = tr A I - A
    /// ```
    #[inline(always)]
    fn stress_of<L: Lane>(&self, strain: &Strain<L>, [p, m, q, f]: [L; 4]) -> Sym<L> {
        let fibre = self.fibre_of(p);
        let component = inlined!(|a: usize| {
            let shear = q.mul_add(strain.cofactor[a], f * fibre[a]) - m * strain.A[a];
            let sum = if a < 3 { shear + m.mul_add(strain.trace, p) } else { shear };
            sum * 2.0
        });
        [component(0), component(1), component(2), component(3), component(4), component(5)]
    }

    /// Terms of the formula that are functions of the volume alone, and the sum of the others.
    fn volume_and_rest(&self) -> (Expression, Expression) {
        let (volume, others): (Vec<_>, Vec<_>) =
            self.energy.terms().into_iter().partition(Expression::is_of_volume);
        let sum =
            |terms: Vec<Expression>| terms.into_iter().fold(Expression::from(0.0), |sum, term| sum + term);
        (sum(volume), sum(others))
    }
}

/// A law of volume as an expression, with the bulk modulus.
fn expression_of(law: Volumetric, bulk_modulus: f64) -> Expression {
    let J = || Expression::from(Invariant::J);
    match law {
        Volumetric::Logarithmic => 0.5 * bulk_modulus * J().ln().power(2.0),
        Volumetric::Quadratic => 0.5 * bulk_modulus * (J() - 1.0).power(2.0),
        Volumetric::SimoTaylor => 0.25 * bulk_modulus * (J().power(2.0) - 1.0 - 2.0 * J().ln()),
        Volumetric::Miehe => bulk_modulus * (J() - J().ln() - 1.0),
        Volumetric::Liu => bulk_modulus * (J() * J().ln() - J() + 1.0),
    }
}

/// Volume ratios at which a function of the volume is compared with the laws.
const RATIOS: [f64; 6] = [0.3, 0.6, 0.9, 1.2, 1.7, 3.0];

impl Material for EnergyFormula {
    compiled_with_this_crate!();

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let [energy] = self.program.energy.run(&self.strain(E).inputs);
        energy
    }

    /// With `B = 2 dE`, the polynomials of A have the differences
    ///
    /// ```math
    /// d(tr A) = tr B,      d(II_A) = tr cof(A, B) + tr cof B,      d(det A) = cof A : B + A : cof B + det B
    /// ```
    #[inline(always)]
    fn energy_change<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>) -> Option<L> {
        let Strain { A, cofactor, inputs, .. } = self.strain(E);
        let B = sym_scaled(E[0].splat(2.0), dE);
        let of_B = sym_cofactor(&B);
        let second = trace(&mixed_cofactor(&A, &B)) + trace(&of_B);
        let det = double_dot(&cofactor, &B) + double_dot(&A, &of_B) + sym_det(&B);
        let w = second + det;
        let fibre = double_dot(&B, &self.fibre_of(E[0]));
        let [z_1, w_1, u_1, f_1, det_C] = inputs;
        let inputs = [z_1, w_1, u_1, f_1, det_C, trace(&B) + w, w, w + det, fibre];
        let [change] = self.program.energy_change.run(&inputs);
        Some(change)
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let strain = self.strain(E);
        self.stress_of(&strain, self.program.gradient.run(&strain.inputs))
    }

    /// Trace, cofactor and determinant of A are polynomials along the path, so that a point costs a run of the tape.
    #[inline(always)]
    fn stress_along<L: Lane>(&self, E: &Sym<L>, dE: &Sym<L>, points: &[[f64; 2]]) -> Sym<L> {
        let constant = inlined!(|value| E[0].splat(value));
        let (A, B) = (sym_scaled(constant(2.0), E), sym_scaled(constant(2.0), dE));
        let fibre = self.fibre_of(E[0]);
        let cofactors = [sym_cofactor(&A), mixed_cofactor(&A, &B), sym_cofactor(&B)];
        let [t_0, t_1] = [trace(&A), trace(&B)];
        let [f_0, f_1] = [double_dot(&A, &fibre), double_dot(&B, &fibre)];
        let second = [trace(&cofactors[0]), trace(&cofactors[1]), trace(&cofactors[2])];
        let det = [sym_det(&A), double_dot(&cofactors[0], &B), double_dot(&A, &cofactors[2]), sym_det(&B)];
        let C = right_cauchy_green(&A);
        let det_C = [sym_det(&C), double_dot(&sym_cofactor(&C), &B), double_dot(&C, &cofactors[2])];
        // Moments of the factors of I, of M and of cof A, and the factor of the fibre.
        let mut p_sum = constant(0.0);
        let mut m_sums = [constant(0.0); 2];
        let mut q_sums = [constant(0.0); 3];
        let mut f_sum = constant(0.0);
        for &[alpha, weight] in points {
            let a = constant(alpha);
            let second = second[2].mul_add(a, second[1]).mul_add(a, second[0]);
            let det_C = det[3].mul_add(a, det_C[2]).mul_add(a, det_C[1]).mul_add(a, det_C[0]);
            let det = det[3].mul_add(a, det[2]).mul_add(a, det[1]).mul_add(a, det[0]);
            let inputs = inputs(t_1.mul_add(a, t_0), second, det, f_1.mul_add(a, f_0), det_C);
            let [p, m, q, f] = self.program.gradient.run(&inputs);
            p_sum += p * weight;
            f_sum += f * weight;
            m_sums[0] += m * weight;
            m_sums[1] += m * (weight * alpha);
            q_sums[0] += q * weight;
            q_sums[1] += q * (weight * alpha);
            q_sums[2] += q * (weight * alpha * alpha);
        }
        let isotropic = p_sum + m_sums[0].mul_add(t_0, m_sums[1] * t_1);
        let component = inlined!(|a: usize| {
            let cofactor = q_sums[0]
                .mul_add(cofactors[0][a], q_sums[1].mul_add(cofactors[1][a], q_sums[2] * cofactors[2][a]));
            let strain = m_sums[0].mul_add(A[a], m_sums[1] * B[a]);
            let sum = f_sum.mul_add(fibre[a], cofactor - strain);
            (if a < 3 { sum + isotropic } else { sum }) * 2.0
        });
        [component(0), component(1), component(2), component(3), component(4), component(5)]
    }

    /// With `T = (W_z + W_w + 2 W_u) A + (W_z + W_w + W_u) I` and `G_z = I + M + cof A`, `G_w = M + cof A`,
    /// `G_u = M + 2 cof A`, `G_f = a (x) a`,
    ///
    /// ```math
    /// D = 4 dcof(T)/dT + 4 sum_ij W_ij G_i (x) G_j
    /// ```
    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let strain = self.strain(E);
        let result: [L; TANGENT] = self.program.tangent.run(&strain.inputs);
        let [p, m, q, f] = [result[0], result[1], result[2], result[3]];
        let T = inlined!(|a: usize| {
            let factor = q * strain.A[a];
            (if a < 3 { factor + m } else { factor }) * 4.0
        });
        let mut D = derivative_of_cofactor(&[T(0), T(1), T(2), T(3), T(4), T(5)]);
        let zero = p.splat(0.0);
        let one = p.splat(1.0);
        let M = inlined!(|a: usize| if a < 3 { strain.trace - strain.A[a] } else { -strain.A[a] });
        let unit = inlined!(|a: usize| if a < 3 { one } else { zero });
        let mut G = [[zero; 6]; VARIABLES];
        for a in 0..6 {
            G[W][a] = M(a) + strain.cofactor[a];
            G[Z][a] = G[W][a] + unit(a);
            G[U][a] = G[W][a] + strain.cofactor[a];
        }
        G[F] = self.fibre_of(p);
        for i in (0..VARIABLES).filter(|i| self.program.is_curved[*i]) {
            // sum_j W_ij G_j
            let mut V = [zero; 6];
            for (pair, [k, l]) in PAIRS.into_iter().enumerate() {
                if k != i && l != i || !self.program.is_curved[k + l - i] {
                    continue;
                }
                for a in 0..6 {
                    V[a] = result[4 + pair].mul_add(G[k + l - i][a], V[a]);
                }
            }
            for a in 0..6 {
                for b in a..6 {
                    D[a][b] = (G[i][a] * 4.0).mul_add(V[b], D[a][b]);
                }
            }
        }
        for a in 0..6 {
            for b in 0..a {
                D[a][b] = D[b][a];
            }
        }
        (self.stress_of(&strain, [p, m, q, f]), D)
    }

    /// Terms of J alone, if they are a multiple of ln J and of one of the laws of [`Volumetric`].
    fn split(&self, share: f64) -> Option<(Self, VolumeLaw)> {
        let (volume, others) = self.volume_and_rest();
        let function = VolumeFunction::new(&volume);
        // T = slope ln J + modulus U, with U'(1) = 0 and U''(1) = 1.
        let [slope, second] = function.derivatives;
        let modulus = second + slope;
        let law = Volumetric::ALL.into_iter().find(|law| {
            let unit = VolumeLaw::new(VolumeMeasure::Ratio, *law, 1.0);
            unit.is_some_and(|unit| {
                RATIOS.iter().all(|J| {
                    let parts = [slope * J.ln(), modulus * unit.energy(J - 1.0)];
                    let scale = parts[0].abs() + parts[1].abs();
                    (function.change(*J) - parts[0] - parts[1]).abs() <= 1e-12 * scale
                })
            })
        })?;
        let rest = &self.program.rest;
        let projected = modulus.min(rest.bulk_modulus() - share * rest.shear_modulus());
        let volume_law = VolumeLaw::new(VolumeMeasure::Ratio, law, projected)?;
        let kept = slope * Expression::from(Invariant::J).ln() + expression_of(law, modulus - projected);
        let energy = others + kept;
        let program = Arc::new(Program::unchecked(&energy).ok()?);
        Some((EnergyFormula { energy, program, ..self.clone() }, volume_law))
    }
}

/// Derivative of the cofactor of a symmetric tensor.
#[inline(always)]
fn derivative_of_cofactor<L: Lane>(T: &Sym<L>) -> Elasticity<L> {
    let o = T[0].splat(0.0);
    let [a, b, c, d, e, f] = *T;
    let [ha, hb, hc, hd, he, hf] = [a * 0.5, b * 0.5, c * 0.5, d * 0.5, e * 0.5, f * 0.5];
    [
        [o, c, b, o, -e, o],
        [c, o, a, o, o, -f],
        [b, a, o, -d, o, o],
        [o, o, -d, -hc, hf, he],
        [-e, o, o, hf, -ha, hd],
        [o, -f, o, he, hd, -hb],
    ]
}
