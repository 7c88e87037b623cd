//! The motion inside a step, one degree higher than its element.

use crate::polynomial::lagrange;
use crate::quadrature::gauss;

/// The superconvergent reconstruction of a step of an element of degree k.
///
/// The element's velocity is the polynomial of degree k with `v^h(0) = v_1` and `v^h(c_i) = x_i/h` at the k Gauss
/// points, and ends with v_2. Its integral
///
/// ```math
/// u~(alpha) = u_1 + h integral_0^alpha v^h,    u~' = h v^h,    u~(0) = u_1,    u~(1) = u_2
/// ```
///
/// has degree k + 1 and the ends of u^h, since Gauss' rule with k points is exact for v^h. Its error inside the step
/// has the order k + 2, one more than the error of u^h. Its rates at k + 1 Gauss points, `h v^h`, are a state of the
/// element of degree k + 1.
#[derive(Debug)]
pub struct Reconstruction {
    /// `[k + 1][k + 1]`: weights of h v_1 and of the k rates.
    weights: Vec<f64>,
    /// Rates of u~ at k + 1 Gauss points, `[k + 1][n_nodes][3]`.
    pub rates: Vec<f64>,
}

impl Reconstruction {
    /// Memory for steps of a degree and n degrees of freedom.
    pub fn new(degree: usize, n: usize) -> Self {
        let abscissae = |n: usize| gauss(n).points.into_iter().map(|[c]| c);
        let nodes: Vec<f64> = std::iter::once(0.0).chain(abscissae(degree)).collect();
        let row = |alpha: f64| (0..nodes.len()).map(|i| lagrange(&nodes, i, alpha)).collect::<Vec<_>>();
        let weights = abscissae(degree + 1).flat_map(row).collect();
        Reconstruction { weights, rates: vec![0.0; (degree + 1) * n] }
    }

    /// Reconstructs a step with the rates `[k][n_nodes][3]` from its velocity at the start.
    pub fn set(&mut self, velocity: &[f64], rates: &[f64], step_size: f64) {
        let n = velocity.len();
        let k = rates.len() / n;
        for (new, weights) in self.rates.chunks_exact_mut(n).zip(self.weights.chunks_exact(k + 1)) {
            new.iter_mut().zip(velocity).for_each(|(x, v)| *x = weights[0] * step_size * v);
            for (rates, weight) in rates.chunks_exact(n).zip(&weights[1..]) {
                new.iter_mut().zip(rates).for_each(|(x, rate)| *x += weight * rate);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_one_degree_more_are_reconstructed() {
        // u = t^(k+1) on 0.3 .. 0.3 + h.
        for k in 1..=4 {
            let h = 0.7f64;
            let power = k as i32;
            let rate = |alpha: f64| h * f64::from(power + 1) * (0.3 + h * alpha).powi(power);
            let mut reconstruction = Reconstruction::new(k, 1);
            let rates: Vec<f64> = gauss(k).points.iter().map(|&[c]| rate(c)).collect();
            reconstruction.set(&[rate(0.0) / h], &rates, h);
            let new = gauss(k + 1);
            for (&[c], x) in new.points.iter().zip(&reconstruction.rates) {
                assert!((x - rate(c)).abs() < 1e-14);
            }
            let end: f64 = new.weights.iter().zip(&reconstruction.rates).map(|(b, x)| b * x).sum();
            assert!((end - (1f64.powi(power + 1) - 0.3f64.powi(power + 1))).abs() < 1e-14);
        }
    }
}
