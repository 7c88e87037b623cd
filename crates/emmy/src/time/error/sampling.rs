//! Errors of the steps between two estimates.

use crate::body::Body;
use crate::error::Result;
use crate::quadrature::gauss;
use crate::time::Memory;

/// Extrapolates the estimated error of a step to the following steps.
///
/// The error of a step of size h grows like `h^q`, and with the derivatives of the motion. The lowest derivative beyond
/// an element of degree k is estimated from the jump of the k-th derivative of u^h between two steps,
///
/// ```math
/// g = |u^(k+1)|_M,    u^(k+1) ~ 2 (D_n - D_(n-1)) / (h_n + h_(n-1)),    D = h^-k sum_i x_i prod_(j != i) 1/(c_i - c_j)
/// ```
///
/// up to a factor. A faster motion u(s t) has g in the ratio `s^(k+1)` and the error in the ratio `s^q`, so that
///
/// ```math
/// e = e_0 (h/h_0)^q (g/g_0)^p,    p = q/(k + 1)
/// ```
///
/// with e_0, h_0, g_0 of the estimated step; a motion of larger amplitude has p = 1. The law is used for small changes
/// only, and for as many steps as it has proved accurate.
#[derive(Debug)]
pub(super) struct Sampling {
    /// q and p.
    order: f64,
    power: f64,
    /// Weights of the rates in D, `[k]`.
    weights: Vec<f64>,
    /// D of the last accepted step, and its size.
    derivative: Vec<f64>,
    last_size: Option<f64>,
    /// D of the observed step.
    new_derivative: Vec<f64>,
    /// u^(k+1) of that step, and its size g.
    jump: Vec<f64>,
    derivative_norm: Option<f64>,
    /// h_0 and g_0.
    sample: Option<[f64; 2]>,
    /// The estimated errors.
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    /// Number of steps without an estimate after the last one, and the remaining ones.
    pause: usize,
    left: usize,
    is_extrapolated: bool,
}

/// Largest number of consecutive steps without an estimate.
const MAX_PAUSE: usize = 16;

/// Largest growth of the step size in the extrapolation; a smaller step has a small error.
const MAX_EXTRAPOLATED_GROWTH: f64 = 2.0;

/// Largest change of the norm of the derivative in the extrapolation: the two powers then differ by at most a half.
const MAX_DERIVATIVE_RATIO: f64 = 2.0;

/// Largest ratio of the extrapolated and the estimated error with which the pauses grow.
const AGREEMENT_RATIO: f64 = 1.5;

impl Sampling {
    /// For steps of a degree whose error grows like `h^order`, with n degrees of freedom.
    pub(super) fn new(degree: usize, order: usize, n: usize) -> Self {
        let nodes: Vec<f64> = gauss(degree).points.into_iter().map(|[c]| c).collect();
        let weight = |i: usize| {
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
            others.map(|(_, c)| 1.0 / (nodes[i] - c)).product()
        };
        let zero = vec![0.0; n];
        Sampling {
            order: order as f64,
            power: order as f64 / (degree as f64 + 1.0),
            weights: (0..degree).map(weight).collect(),
            derivative: zero.clone(),
            last_size: None,
            new_derivative: zero.clone(),
            jump: zero.clone(),
            derivative_norm: None,
            sample: None,
            displacement: zero.clone(),
            velocity: zero,
            pause: 0,
            left: 0,
            is_extrapolated: false,
        }
    }

    /// Forgets the previous steps, which say nothing after a jump of the loads.
    pub(super) fn restart(&mut self) {
        (self.last_size, self.sample, self.pause, self.left) = (None, None, 0, 0);
    }

    /// Observes a step with the rates `[k][n_nodes][3]`.
    pub(super) fn observe(&mut self, body: &Body, rates: &[f64], step_size: f64) {
        let n = self.derivative.len();
        let scale = step_size.powi(-(self.weights.len() as i32));
        self.new_derivative.fill(0.0);
        for (rates, weight) in rates.chunks_exact(n).zip(&self.weights) {
            let terms = self.new_derivative.iter_mut().zip(rates);
            terms.for_each(|(D, x)| *D += scale * weight * x);
        }
        self.derivative_norm = self.last_size.map(|last_size| {
            let distance = 0.5 * (step_size + last_size);
            let pairs = self.new_derivative.iter().zip(&self.derivative);
            self.jump.iter_mut().zip(pairs).for_each(|(jump, (new, old))| *jump = (new - old) / distance);
            body.mass_weighted_rms(&self.jump)
        });
    }

    /// Ratio of the error of the observed step to the error of the sample, if the law applies.
    fn factor(&self, step_size: f64) -> Option<f64> {
        let [size, sampled] = self.sample?;
        let derivative_norm = self.derivative_norm?;
        let larger = step_size / size;
        let change = derivative_norm / sampled;
        let is_near = larger <= MAX_EXTRAPOLATED_GROWTH
            && (1.0 / MAX_DERIVATIVE_RATIO..=MAX_DERIVATIVE_RATIO).contains(&change);
        is_near.then(|| larger.powf(self.order) * change.powf(self.power))
    }

    /// Sets the errors of the observed step by the law; false if they must be estimated.
    pub(super) fn extrapolate(
        &mut self,
        step_size: f64,
        displacement: &mut [f64],
        velocity: &mut [f64],
    ) -> bool {
        let factor = self.factor(step_size).filter(|_| self.left > 0);
        self.is_extrapolated = factor.is_some();
        if let Some(factor) = factor {
            displacement.iter_mut().zip(&self.displacement).for_each(|(new, e)| *new = factor * e);
            velocity.iter_mut().zip(&self.velocity).for_each(|(new, e)| *new = factor * e);
        }
        self.is_extrapolated
    }

    /// Whether the errors of the last step were extrapolated.
    pub(super) fn is_extrapolated(&self) -> bool {
        self.is_extrapolated
    }

    /// Takes the estimated errors of the observed step as the next sample.
    pub(super) fn resample(&mut self, body: &Body, step_size: f64, displacement: &[f64], velocity: &[f64]) {
        let by_law = self.factor(step_size).map(|factor| factor * body.mass_weighted_rms(&self.displacement));
        let agrees = by_law.is_some_and(|e| {
            (1.0 / AGREEMENT_RATIO..=AGREEMENT_RATIO).contains(&(body.mass_weighted_rms(displacement) / e))
        });
        self.pause = if agrees { (2 * self.pause).clamp(1, MAX_PAUSE) } else { 0 };
        (self.left, self.is_extrapolated) = (self.pause, false);
        self.sample = self.derivative_norm.map(|derivative_norm| [step_size, derivative_norm]);
        self.displacement.copy_from_slice(displacement);
        self.velocity.copy_from_slice(velocity);
    }

    /// Advances to the next step.
    pub(super) fn accept(&mut self, step_size: f64) {
        std::mem::swap(&mut self.derivative, &mut self.new_derivative);
        self.last_size = Some(step_size);
        self.left -= usize::from(self.is_extrapolated);
    }

    /// Keeps the memory that the next errors depend on.
    pub(super) fn save(&self, memory: &mut Memory) {
        memory.save_nodal("sampling.derivative", &self.derivative);
        memory.save_option("sampling.last_size", self.last_size);
        memory.save_option("sampling.sample.size", self.sample.map(|[size, _]| size));
        memory.save_option("sampling.sample.derivative_norm", self.sample.map(|[_, norm]| norm));
        memory.save_nodal("sampling.displacement", &self.displacement);
        memory.save_nodal("sampling.velocity", &self.velocity);
        memory.save_number("sampling.pause", self.pause as f64);
        memory.save_number("sampling.left", self.left as f64);
    }

    /// Restores the data of [`Sampling::save`].
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(super) fn restore(&mut self, memory: &Memory) -> Result<()> {
        memory.fill("sampling.derivative", &mut self.derivative)?;
        self.last_size = memory.option("sampling.last_size")?;
        let size = memory.option("sampling.sample.size")?;
        let derivative_norm = memory.option("sampling.sample.derivative_norm")?;
        self.sample = size.zip(derivative_norm).map(|(size, norm)| [size, norm]);
        memory.fill("sampling.displacement", &mut self.displacement)?;
        memory.fill("sampling.velocity", &mut self.velocity)?;
        self.pause = memory.number("sampling.pause")? as usize;
        self.left = memory.number("sampling.left")? as usize;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;
    use crate::input::Region;
    use crate::material::NeoHooke;
    use crate::mesh;

    fn cube() -> Body {
        let rubber = Region::new(NeoHooke::new(1.0, 1.0).unwrap(), 1.0);
        Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber).build().unwrap()
    }

    /// Rates of `u = t^power` in all degrees of freedom, in a step from t of size h.
    fn rates(degree: usize, power: i32, t: f64, h: f64) -> Vec<f64> {
        let rate = |[c]: [f64; 1]| vec![h * f64::from(power) * (t + h * c).powi(power - 1); 24];
        gauss(degree).points.into_iter().flat_map(rate).collect()
    }

    /// The k-th derivative of u^h equals the derivative of `t^(k+1)` in the middle of a step, times 1/(k-1)!, so that
    /// the jump is (k+1) k.
    #[test]
    fn the_derivative_that_the_element_lacks_is_measured() {
        let body = cube();
        for k in 1..=3 {
            let mut sampling = Sampling::new(k, 2 * k + 1, 24);
            let mut t = 0.2;
            let expected = (k * (k + 1)) as f64 * 3f64.sqrt();
            for h in [0.1, 0.1, 0.07, 0.2] {
                sampling.observe(&body, &rates(k, k as i32 + 1, t, h), h);
                if t > 0.2 {
                    let found = sampling.derivative_norm.unwrap();
                    assert!((found / expected - 1.0).abs() < 1e-12, "k = {k}: {found} {expected}");
                }
                sampling.accept(h);
                t += h;
            }
        }
    }

    /// k = 2, `u = g t^3/6`: g is the third derivative, and equal in each step but the first.
    fn cubic(g: f64, t: f64, h: f64) -> Vec<f64> {
        rates(2, 3, t, h).into_iter().map(|x| g / 6.0 * x).collect()
    }

    /// Does steps of one size with a given error; returns which of them are estimated.
    fn march(sampling: &mut Sampling, body: &Body, steps: Range<usize>, error: f64) -> Vec<usize> {
        let (mut displacement, mut velocity) = (vec![0.0; 24], vec![0.0; 24]);
        let mut estimated = Vec::new();
        for step in steps {
            sampling.observe(body, &cubic(1.0, 0.1 * step as f64, 0.1), 0.1);
            if !sampling.extrapolate(0.1, &mut displacement, &mut velocity) {
                estimated.push(step);
                sampling.resample(body, 0.1, &[error; 24], &[2.0 * error; 24]);
            }
            sampling.accept(0.1);
        }
        estimated
    }

    #[test]
    fn estimates_become_rare_where_the_law_is_good() {
        let body = cube();
        let mut sampling = Sampling::new(2, 5, 24);
        // The first step has no predecessor, the second one no sample, the third one confirms the law.
        assert_eq!(march(&mut sampling, &body, 0..60, 1e-3), [0, 1, 2, 4, 7, 12, 21, 38, 55]);
        // It must be confirmed again after a jump.
        sampling.restart();
        assert_eq!(march(&mut sampling, &body, 0..20, 1e-3), [0, 1, 2, 4, 7, 12]);
        // An error outside the law shortens the pauses.
        assert_eq!(march(&mut sampling, &body, 20..41, 2e-3), [21, 22, 24, 27, 32]);
    }

    #[test]
    fn errors_follow_size_and_pace() {
        let body = cube();
        let mut sampling = Sampling::new(2, 5, 24);
        march(&mut sampling, &body, 0..4, 1e-3);
        sampling.left = 1;
        let (mut displacement, mut velocity) = (vec![0.0; 24], vec![0.0; 24]);
        // Rates of one derivative D of u^h: the jump of a motion s times as fast, u(s t), with g in the ratio s^3.
        let mut look = |sampling: &mut Sampling, s: f64, h: f64| {
            let target = sampling.derivative[0] + s.powi(3) * 0.5 * (0.1 + h);
            let [first, last] = [gauss(2).points[0][0], gauss(2).points[1][0]];
            let rates = [first, last].map(|c| [target * h * h * c; 24]);
            sampling.observe(&body, rates.as_flattened(), h);
            sampling.extrapolate(h, &mut displacement, &mut velocity).then(|| [displacement[5], velocity[23]])
        };
        let expected = 1e-3 * (1.2f64 * 0.5).powi(5);
        let [u, v] = look(&mut sampling, 1.2, 0.05).unwrap();
        assert!((u / expected - 1.0).abs() < 1e-9 && (v / expected - 2.0).abs() < 1e-9, "{u} {v}");
        // Three times the size, four times the derivative norm, no change: must be estimated.
        assert_eq!(look(&mut sampling, 1.0, 0.3), None);
        assert_eq!(look(&mut sampling, 4f64.cbrt(), 0.1), None);
        assert_eq!(look(&mut sampling, 0.0, 0.1), None);
    }
}
