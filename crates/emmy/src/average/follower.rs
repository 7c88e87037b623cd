//! Quadrature in time of follower loads.

use super::{Kind, Rule, TimePoint};
use crate::polynomial::lagrange;
use crate::quadrature::gauss;

/// Points of a step at which a scheme evaluates a follower load.
///
/// The load is `p(t) F(q)` with a factor p over time and a force F that is quadratic in the positions. Its stage
/// averages are
///
/// ```math
/// f_i = (1/b_i) integral_0^1 l_i p F(q^h) dalpha = sum_m s_im p_m F(q^h(alpha_m)),
/// p_m = (1/w_m) integral_0^1 Lambda_m(alpha) p dalpha
/// ```
///
/// with the Lagrange basis `Lambda_m` on the points. Energy-momentum rules take 3k Gauss points: `l_i F` has degree
/// `3k - 1` in alpha, so it is interpolated exactly, and f_i is exact for every time function. Standard rules evaluate
/// the load at the same points as the stress.
///
/// ```
/// use emmy::internals::average::{FollowerRule, Rule};
/// assert_eq!(FollowerRule::new(&Rule::discrete_gradient(2)).n_points(), 6);
/// assert_eq!(FollowerRule::new(&Rule::standard(1, &emmy::internals::quadrature::gauss(1))).n_points(), 1);
/// ```
#[derive(Debug, Clone)]
pub struct FollowerRule {
    points: Vec<TimePoint>,
    /// As many Gauss points as there are points: `Lambda_m` is interpolated on them exactly.
    fine: Rule,
    /// `(B_r / w_m) Lambda_m(c_r)` with weights B_r and points c_r of the fine rule, `[m][r]`.
    mean: Vec<f64>,
}

impl FollowerRule {
    /// The quadrature of a rule.
    pub fn new(rule: &Rule) -> Self {
        let k = rule.degree();
        let points = match rule.kind {
            Kind::Standard => rule.points.clone(),
            Kind::EnergyMomentum(_) => Rule::standard(k, &gauss(3 * k)).points,
        };
        let nodes: Vec<f64> = points.iter().map(|point| point.alpha).collect();
        let fine = Rule::standard(nodes.len(), &gauss(1));
        let mean = points.iter().enumerate().flat_map(|(m, point)| {
            let nodes = &nodes;
            let fine = &fine;
            let weight = move |(&c, &b): (&f64, &f64)| b / point.weight * lagrange(nodes, m, c);
            fine.nodes().iter().zip(fine.weights()).map(weight)
        });
        FollowerRule { mean: mean.collect(), fine, points }
    }

    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.points.len()
    }

    /// Points alpha_m in `[0, 1]`.
    pub fn alphas(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|point| point.alpha)
    }

    /// `L_j(alpha_m)`, the integrals of the basis at a point, `[k]`.
    pub fn integrals(&self, m: usize) -> &[f64] {
        &self.points[m].integrals
    }

    /// `s_im = w_m l_i(alpha_m) / b_i`, the weights of a point in the stage averages, `[k]`.
    pub fn stage_weights(&self, m: usize) -> &[f64] {
        &self.points[m].stage_weights
    }

    /// The rule whose basis averages a time function for [`FollowerRule::factors`]; its degree is the number of points.
    pub fn fine(&self) -> &Rule {
        &self.fine
    }

    /// Factors p_m from the averages of a time function on the basis of [`FollowerRule::fine`]; both `[n_points]`.
    pub fn factors(&self, averages: &[f64], factors: &mut [f64]) {
        for (factor, mean) in factors.iter_mut().zip(self.mean.chunks_exact(averages.len())) {
            *factor = mean.iter().zip(averages).map(|(mean, average)| mean * average).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::lobatto;

    /// Sum of w_m p_m alpha_m^d with averages of p = alpha^e, whose exact value is 1/(d + e + 1).
    fn moment(rule: &Rule, d: i32, e: i32) -> f64 {
        let follower = FollowerRule::new(rule);
        // The averages (1/B_r) integral of the fine basis times alpha^e, by a quadrature that is exact for them.
        let fine = follower.fine();
        let inner = gauss(20);
        let average = |r: usize| {
            let terms = inner.iter().map(|(&[a], w)| w * fine.basis(r, a) * a.powi(e));
            terms.sum::<f64>() / fine.weights()[r]
        };
        let averages: Vec<f64> = (0..follower.n_points()).map(average).collect();
        let mut factors = vec![0.0; follower.n_points()];
        follower.factors(&averages, &mut factors);
        let points = follower.points.iter().zip(&factors);
        points.map(|(point, p)| point.weight * p * point.alpha.powi(d)).sum()
    }

    #[test]
    fn averages_are_exact_for_the_path_and_any_factor() {
        for k in 1..=4 {
            for d in 0..3 * k as i32 {
                for e in 0..9 {
                    let error = moment(&Rule::assumed_strain(k, k), d, e) - 1.0 / f64::from(d + e + 1);
                    assert!(error.abs() < 1e-14, "k = {k}, {d}, {e}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn impulses_of_standard_rules_are_exact_for_any_factor() {
        for rule in
            [Rule::standard(1, &gauss(1)), Rule::standard(2, &gauss(3)), Rule::standard(1, &lobatto(2))]
        {
            (0..9).for_each(|e| assert!((moment(&rule, 0, e) - 1.0 / f64::from(e + 1)).abs() < 1e-15));
        }
    }
}
