//! Averaging rules at a material point.
//!
//! A time integration scheme is, at a material point, a rule that averages the first Piola-Kirchhoff stress over a
//! step. It sees the displacement gradient at the start of the step, the rates of the deformation gradient at the time
//! element's Gauss points, and a material; it returns stage averages `P_i` and their derivatives. Nothing else of the
//! library depends on the scheme.
//!
//! ```math
//! f_i = (1/b_i) integral_0^1 l_i F_int dalpha = integral_B P_i grad N dV
//! ```

#![allow(non_snake_case)]

mod contact;
mod damping;
mod energy_momentum;
mod follower;
mod mean;
mod standard;
mod start_tangent;
#[cfg(test)]
mod tests;
mod time_point;
mod volume;

pub use contact::ContactRule;
pub use damping::Damping;
pub use follower::FollowerRule;
pub use mean::Mean;
pub use start_tangent::StartTangent;
pub use volume::{VolumeAverage, VolumeDamping, VolumeStart};

use crate::material::Response;
use crate::polynomial::{lagrange, lagrange_rate, legendre};
use crate::quadrature::{Quadrature, gauss, lobatto};
use crate::tensor::{Elasticity, Lane, Mat3, Sym, Tangent, add_scaled};
use time_point::{TimePoint, time_points};

/// An averaging rule: the quadrature that makes a scheme out of a time element.
///
/// ```
/// use emmy::internals::average::Rule;
/// let mid_point = Rule::standard(1, &emmy::internals::quadrature::gauss(1));
/// assert_eq!((mid_point.degree(), mid_point.nodes()), (1, &[0.5][..]));
/// ```
#[derive(Debug, Clone)]
pub struct Rule {
    /// Gauss points c_i of the time element.
    c: Vec<f64>,
    /// Gauss weights b_i.
    b: Vec<f64>,
    /// a_ij = L_j(c_i), row by row.
    a: Vec<f64>,
    /// Values p_i of the Legendre polynomial of degree k - 1 and norm one at the Gauss points.
    highest_mode: Vec<f64>,
    kind: Kind,
    points: Vec<TimePoint>,
    /// Gauss points that integrate det C along an assumed strain exactly, a polynomial of degree 3k.
    det_points: Vec<TimePoint>,
    /// `[L_1, w l_1 / b_1]` of every point: for k = 1 the path of strains is straight.
    path: Vec<[f64; 2]>,
    mean: Mean,
    load_quadrature: Quadrature<1>,
    smooth_quadrature: Quadrature<1>,
}

/// An averaging rule as a value. A new rule has its own file in this folder, a variant here and a row in the table of
/// [`crate::time::scheme::SCHEMES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AveragingRule {
    /// `FE(n)`: stress at n Gauss points (section 4.4.1).
    Standard(usize),
    /// `trapezoidal`: stress at both ends; at degree 1 the average acceleration method.
    Trapezoidal,
    /// `Lobatto(n)`: stress at n Lobatto points.
    Lobatto(usize),
    /// `AS(n)`: assumed strain in time with n inner Gauss points (equation (62)).
    AssumedStrain(usize),
    /// `DGM`: discrete gradient (equations (63)-(65)).
    DiscreteGradient,
}

/// Largest sensible number of points: more gain nothing, and are probably a slip of the keyboard.
const MAX_POINTS: usize = 64;

impl AveragingRule {
    /// Key word of its scheme, and the number of points after it.
    pub fn word_and_points(self) -> (&'static str, Option<usize>) {
        match self {
            AveragingRule::Standard(n) => ("FE", Some(n)),
            AveragingRule::Trapezoidal => ("trapezoidal", None),
            AveragingRule::Lobatto(n) => ("Lobatto", Some(n)),
            AveragingRule::AssumedStrain(n) => ("AS", Some(n)),
            AveragingRule::DiscreteGradient => ("DGM", None),
        }
    }

    /// The rule with at least as many points as a degree needs.
    ///
    /// ```
    /// use emmy::time::AveragingRule;
    /// assert_eq!(AveragingRule::Standard(1).for_degree(2), AveragingRule::Standard(2));
    /// assert_eq!(AveragingRule::Trapezoidal.for_degree(2), AveragingRule::Lobatto(3));
    /// ```
    pub fn for_degree(self, degree: usize) -> AveragingRule {
        match self {
            AveragingRule::Standard(n) => AveragingRule::Standard(n.max(degree)),
            AveragingRule::Trapezoidal if degree > 1 => AveragingRule::Lobatto(degree + 1),
            AveragingRule::Lobatto(n) => AveragingRule::Lobatto(n.max(degree + 1)),
            AveragingRule::AssumedStrain(n) => AveragingRule::AssumedStrain(n.max(degree)),
            AveragingRule::Trapezoidal | AveragingRule::DiscreteGradient => self,
        }
    }

    /// Checks the number of points for a degree; the error is the reason.
    pub fn check_degree(self, degree: usize) -> Result<(), String> {
        let (n, least, reason) = match self {
            AveragingRule::Standard(n) | AveragingRule::AssumedStrain(n) => {
                (n, degree, "points: the step would be singular")
            }
            AveragingRule::Lobatto(n) => (n, degree + 1, "Lobatto points"),
            AveragingRule::Trapezoidal if degree != 1 => {
                return Err(format!("it has degree 1 only, not {degree}; use Lobatto(n) for higher degrees"));
            }
            AveragingRule::Trapezoidal | AveragingRule::DiscreteGradient => return Ok(()),
        };
        if n < least {
            return Err(format!("degree {degree} needs at least {least} {reason}"));
        }
        if n > MAX_POINTS { Err(format!("at most {MAX_POINTS} points")) } else { Ok(()) }
    }

    /// Whether the rule has an algorithmic stress, a function of the strain rates: AS and DGM.
    pub fn is_energy_momentum(self) -> bool {
        match self {
            AveragingRule::Standard(_) | AveragingRule::Trapezoidal | AveragingRule::Lobatto(_) => false,
            AveragingRule::AssumedStrain(_) | AveragingRule::DiscreteGradient => true,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Standard,
    EnergyMomentum(StressKind),
}

/// Algorithmic stress of an energy-momentum rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StressKind {
    AssumedStrain,
    DiscreteGradient,
    /// As [`StressKind::AssumedStrain`], see [`Rule::straining_rates`].
    StrainingRates,
}

/// Wanted results of [`Rule::average`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request {
    /// Stage averages of the stress.
    Stress,
    /// Stage averages of the stress and their derivatives.
    Tangent,
}

/// Result of a rule at a material point, with its working memory.
#[derive(Debug, Clone)]
pub struct Average<L> {
    /// Stage averages P_i of the first Piola-Kirchhoff stress, `[k]`.
    pub stress: Vec<Mat3<L>>,
    /// Derivatives dP_i/dF'_j, `[i k + j]`.
    pub tangent: Vec<Tangent<L>>,
    /// Smallest determinant of the deformation gradients, or of the assumed strains in their place.
    pub min_det: L,
    gradients: Vec<Mat3<L>>,
    strain_rates: Vec<Sym<L>>,
    stresses: Vec<Sym<L>>,
    elasticities: Vec<Elasticity<L>>,
    stiffness: Vec<Elasticity<L>>,
}

impl<L: Lane> Average<L> {
    /// Memory for a rule of a degree; `zero` is any number of the lane type.
    pub fn new(degree: usize, zero: L) -> Self {
        let k = degree;
        let zero = zero.splat(0.0);
        Average {
            stress: vec![[[zero; 3]; 3]; k],
            tangent: vec![[[zero; 9]; 9]; k * k],
            min_det: zero,
            gradients: vec![[[zero; 3]; 3]; k],
            strain_rates: vec![[zero; 6]; k],
            stresses: vec![[zero; 6]; k],
            elasticities: vec![[[zero; 6]; 6]; k],
            stiffness: vec![[[zero; 6]; 6]; k * k],
        }
    }
}

impl Rule {
    /// The quadrature of an averaging rule for a degree.
    pub fn new(rule: AveragingRule, degree: usize) -> Rule {
        match rule {
            AveragingRule::Standard(n) => Rule::standard(degree, &gauss(n)),
            AveragingRule::Trapezoidal => Rule::standard(degree, &lobatto(2)),
            AveragingRule::Lobatto(n) => Rule::standard(degree, &lobatto(n)),
            AveragingRule::AssumedStrain(n) => Rule::assumed_strain(degree, n),
            AveragingRule::DiscreteGradient => Rule::discrete_gradient(degree),
        }
    }

    /// Standard rule FE: any quadrature of the step, inside and out (section 4.4.1).
    pub fn standard(degree: usize, quadrature: &Quadrature<1>) -> Rule {
        Rule::with(degree, Kind::Standard, quadrature)
    }

    /// The configuration at the end of a step, for equilibria: there are stresses, forces and constraints.
    pub fn at_end() -> Rule {
        let end = Quadrature { points: vec![[1.0]], weights: vec![1.0] };
        Rule { c: vec![1.0], a: vec![1.0], ..Rule::standard(1, &end) }
    }

    /// Whether it sees the configuration at the end alone, and no path to it.
    pub fn is_at_end(&self) -> bool {
        self.c == [1.0]
    }

    /// Assumed strain in time, AS(n), with n inner Gauss points (equations (57), (62)).
    pub fn assumed_strain(degree: usize, n: usize) -> Rule {
        Rule::with(degree, Kind::EnergyMomentum(StressKind::AssumedStrain), &gauss(n))
    }

    /// Discrete gradient, DGM (equations (63)-(65)).
    pub fn discrete_gradient(degree: usize) -> Rule {
        // The inner rule replaces the energy difference if that is lost in rounding.
        Rule::with(degree, Kind::EnergyMomentum(StressKind::DiscreteGradient), &gauss(degree + 3))
    }

    /// The symmetric part of energy-momentum rules with k = 1: AS(1), with derivatives along rates without rotation.
    ///
    /// ```math
    /// dP = a dF' S + F(c) dS/dE' : sym(F(c)^T dF'),    a = c = 1/2
    /// ```
    ///
    /// In a body that rotates by an angle t, the configuration at c is shrunk by `cos(t/2)`. The energy-momentum rules
    /// see no strain in this shrinkage, but the mid-point rule does: in a stiff body, its tangent does not approximate
    /// theirs.
    pub fn straining_rates() -> Rule {
        Rule::with(1, Kind::EnergyMomentum(StressKind::StrainingRates), &gauss(1))
    }

    fn with(degree: usize, kind: Kind, quadrature: &Quadrature<1>) -> Rule {
        let outer = gauss(degree);
        let c: Vec<f64> = outer.points.iter().map(|p| p[0]).collect();
        let b = outer.weights;
        let a = time_point::coefficients(&c, &b);
        let points = time_points(&c, &b, quadrature);
        let det_points = time_points(&c, &b, &gauss((3 * degree).div_ceil(2)));
        let path = points.iter().map(|point| [point.integrals[0], point.stage_weights[0]]).collect();
        let mean = match kind {
            Kind::Standard => Mean::of(degree, &points),
            // The outer quadrature, which integrates the path exactly.
            Kind::EnergyMomentum(_) => Mean { start: vec![1.0; degree], rates: Vec::clone(&a) },
        };
        let load_quadrature = gauss(degree.div_ceil(2) + 1);
        let smooth_quadrature = gauss(degree + 4);
        let highest_mode = c.iter().map(|&c| legendre(degree - 1, c)).collect();
        Rule {
            c,
            b,
            a,
            highest_mode,
            kind,
            points,
            det_points,
            path,
            mean,
            load_quadrature,
            smooth_quadrature,
        }
    }

    /// Whether the rule has an algorithmic stress: AS and DGM.
    pub fn is_energy_momentum(&self) -> bool {
        self.kind != Kind::Standard
    }

    /// Whether the stage averages of an internal force have no moment about the configuration in the same stage: for
    /// AS and DGM, and for the stress at the Gauss points alone.
    pub fn has_no_moment(&self) -> bool {
        let is_at = |(point, c): (&TimePoint, &f64)| point.alpha == *c;
        self.is_energy_momentum()
            || self.points.len() == self.c.len() && self.points.iter().zip(&self.c).all(is_at)
    }

    /// Degree k of the time element.
    pub fn degree(&self) -> usize {
        self.c.len()
    }

    /// Gauss points c_i of the time element, `[k]`.
    pub fn nodes(&self) -> &[f64] {
        &self.c
    }

    /// Gauss weights b_i of the time element, `[k]`.
    pub fn weights(&self) -> &[f64] {
        &self.b
    }

    /// Coefficients a_ij = L_j(c_i), `[i k + j]`.
    pub fn coefficients(&self) -> &[f64] {
        &self.a
    }

    /// Values p_i of the highest-degree Legendre mode of the test space at the Gauss points, `sum_i b_i p_i^2 = 1`,
    /// `[k]`.
    pub fn highest_mode(&self) -> &[f64] {
        &self.highest_mode
    }

    /// Coefficients of the stage averages of a linear force.
    pub fn mean(&self) -> &Mean {
        &self.mean
    }

    /// Lagrange basis polynomial l_i of the test functions, on the Gauss points.
    pub fn basis(&self, i: usize, alpha: f64) -> f64 {
        lagrange(&self.c, i, alpha)
    }

    /// Coefficients e_ij that continue the polynomial of a step into the next one: the prediction is
    /// `x_i = sum_j e_ij x_j` of the old step; `ratio`: next step size over this one. `[i k + j]`.
    ///
    /// ```math
    /// e_ij = r l_j(1 + r c_i)
    /// ```
    pub fn continuation(&self, ratio: f64, coefficients: &mut [f64]) {
        let k = self.degree();
        for (i, &c_i) in self.c.iter().enumerate() {
            for j in 0..k {
                coefficients[i * k + j] = ratio * self.basis(j, 1.0 + ratio * c_i);
            }
        }
    }

    /// Quadrature on [0, 1] that is exact for the basis times a linear function: for pieces of a table.
    pub fn load_quadrature(&self) -> &Quadrature<1> {
        &self.load_quadrature
    }

    /// Quadrature for smooth functions of time times a test function: k + 4 Gauss points.
    ///
    /// It is exact for functions of degree k + 8, so that averages have an error of order k + 9, at least the order 2k
    /// of the time element for all degrees.
    pub fn smooth_quadrature(&self) -> &Quadrature<1> {
        &self.smooth_quadrature
    }

    /// Derivative `dl_i/dalpha` of the Lagrange basis polynomial l_i of the test functions.
    pub fn basis_rate(&self, i: usize, alpha: f64) -> f64 {
        lagrange_rate(&self.c, i, alpha)
    }

    /// Whether the derivatives of the averages are symmetric, `dP/dF' = (dP/dF')^T`: true for a standard rule with k =
    /// 1 and without damping.
    pub fn is_symmetric(&self, is_damped: bool) -> bool {
        let is_symmetric = match self.kind {
            Kind::Standard => !is_damped,
            Kind::EnergyMomentum(StressKind::StrainingRates) => true,
            Kind::EnergyMomentum(StressKind::AssumedStrain | StressKind::DiscreteGradient) => false,
        };
        is_symmetric && self.degree() == 1
    }

    /// Integrated basis functions L_j at the rule's single stress point, `[k]`; `None` if the rule has several points.
    pub fn only_point(&self) -> Option<&[f64]> {
        match (self.kind, &self.points[..]) {
            (Kind::Standard, [point]) => Some(&point.integrals),
            (Kind::Standard | Kind::EnergyMomentum(_), _) => None,
        }
    }

    /// Stage averages of the stress over a step, and their derivatives if wanted.
    ///
    /// `start`: displacement gradient G_1 = F_1 - I; `rates`: F'_j, `[k]`. A rule with an [`Rule::only_point`] also
    /// takes the gradient at that point and no rates. The result is in `average`.
    #[inline(always)]
    pub fn average<L: Lane>(
        &self,
        material: &dyn Response<L>,
        start: &Mat3<L>,
        rates: &[Mat3<L>],
        request: Request,
        average: &mut Average<L>,
    ) {
        match self.kind {
            Kind::Standard => self.average_standard(material, start, rates, request, average),
            Kind::EnergyMomentum(kind) => {
                self.average_energy_momentum(kind, material, start, rates, request, average);
            }
        }
    }

    /// Displacement gradient `G_1 + sum_j L_j F'_j` at a point of the step with the integrals L_j of the basis.
    #[inline(always)]
    fn gradient_at<L: Lane>(start: &Mat3<L>, integrals: &[f64], rates: &[Mat3<L>]) -> Mat3<L> {
        let mut G = *start;
        for (&L_j, rate) in integrals.iter().zip(rates) {
            G = add_scaled(&G, L_j, rate);
        }
        G
    }
}
