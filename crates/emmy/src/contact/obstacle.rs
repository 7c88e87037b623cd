//! The surface of an obstacle, and the forces of a layer between it and a point.

use super::correction::{Correction, GaussPoint};
use super::layer::Layer;
use crate::tensor::{Mat3, dot3, mat3, three};

/// Largest degree of a time element, with those of the estimators.
pub const MAX_STAGES: usize = 16;

/// The surface of an obstacle, with the gap g to a point \[length\].
///
/// ```
/// use emmy::internals::contact::ObstacleSurface;
/// let bowl = ObstacleSurface::Round { origin: [0.0; 3], axis: [0.0; 3], radius: 2.0, sign: -1.0 };
/// assert_eq!((bowl.gap([0.0, 0.5, 0.0]), bowl.gradient([0.0, 0.5, 0.0])), (1.5, [0.0, -1.0, 0.0]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ObstacleSurface {
    /// A plane.
    Plane {
        /// A point of it \[length\].
        origin: [f64; 3],
        /// Unit normal.
        normal: [f64; 3],
    },
    /// A cylinder, or a sphere: `g = sign (|r| - radius)` with the vector r from the axis, or from the centre.
    Round {
        /// A point of the axis, or the centre \[length\].
        origin: [f64; 3],
        /// Unit vector along the axis; zero for a sphere.
        axis: [f64; 3],
        /// Radius \[length\].
        radius: f64,
        /// 1 for points outside, -1 for points inside.
        sign: f64,
    },
}

impl ObstacleSurface {
    /// A point of the plane or of the axis, or the centre \[length\].
    pub fn origin(&self) -> [f64; 3] {
        match *self {
            ObstacleSurface::Plane { origin, .. } | ObstacleSurface::Round { origin, .. } => origin,
        }
    }

    /// The gap to a position; negative behind the surface.
    pub fn gap(&self, q: [f64; 3]) -> f64 {
        match *self {
            ObstacleSurface::Plane { origin, normal } => dot3(minus(q, origin), normal),
            ObstacleSurface::Round { radius, sign, .. } => sign * (norm(self.arm(q)) - radius),
        }
    }

    /// The gradient of the gap.
    pub fn gradient(&self, q: [f64; 3]) -> [f64; 3] {
        match *self {
            ObstacleSurface::Plane { normal, .. } => normal,
            ObstacleSurface::Round { sign, .. } => {
                let arm = self.arm(q);
                scaled(sign / norm(arm), arm)
            }
        }
    }

    /// The second derivative of the gap \[1/length\].
    pub fn curvature(&self, q: [f64; 3]) -> Mat3<f64> {
        match *self {
            ObstacleSurface::Plane { .. } => Mat3::default(),
            ObstacleSurface::Round { axis, sign, .. } => {
                let arm = self.arm(q);
                let square = dot3(arm, arm);
                mat3(|i, j| sign / square.sqrt() * (across(axis, i, j) - arm[i] * arm[j] / square))
            }
        }
    }

    /// Whether a straight path between two positions leads through the obstacle.
    pub fn is_passed(&self, from: [f64; 3], to: [f64; 3]) -> bool {
        let is_behind = self.gap(from) <= 0.0 || self.gap(to) <= 0.0;
        let ObstacleSurface::Round { radius, sign: 1.0, .. } = *self else { return is_behind };
        let (start, way) = (self.arm(from), minus(self.arm(to), self.arm(from)));
        let square = dot3(way, way);
        let nearest = if square > 0.0 { (-dot3(start, way) / square).clamp(0.0, 1.0) } else { 0.0 };
        is_behind || norm(three(|d| start[d] + nearest * way[d])) <= radius
    }

    /// The vector from the axis or the centre.
    fn arm(&self, q: [f64; 3]) -> [f64; 3] {
        match *self {
            ObstacleSurface::Plane { origin, .. } => minus(q, origin),
            ObstacleSurface::Round { origin, axis, .. } => {
                let arm = minus(q, origin);
                let along = dot3(arm, axis);
                three(|d| arm[d] - along * axis[d])
            }
        }
    }

    /// The discrete gradient of the gap between two positions, at a position on the path between them:
    ///
    /// ```math
    /// n  of a plane,     2 r(q)/(|r_1| + |r_2|)  otherwise
    /// ```
    ///
    /// Its mean product with the velocity along a path of any degree is the change of the gap, and it points along r,
    /// so that the force has no moment about the centre or the axis.
    fn secant(&self, [q_1, q_2]: [[f64; 3]; 2], q: [f64; 3]) -> Secant {
        match *self {
            ObstacleSurface::Plane { normal, .. } => Secant { gradient: normal, ..Secant::default() },
            ObstacleSurface::Round { axis, sign, .. } => {
                let [r_1, r_2, r] = [q_1, q_2, q].map(|q| self.arm(q));
                let sum = norm(r_1) + norm(r_2);
                let factor = 2.0 * sign / sum;
                Secant {
                    gradient: scaled(factor, r),
                    by_stage: mat3(|i, j| factor * across(axis, i, j)),
                    by_end: mat3(|i, j| -factor * r[i] * r_2[j] / (norm(r_2) * sum)),
                }
            }
        }
    }
}

/// A discrete gradient, with its derivatives by the position of the stage and by that at the end.
#[derive(Clone, Copy, Default)]
struct Secant {
    gradient: [f64; 3],
    by_stage: Mat3<f64>,
    by_end: Mat3<f64>,
}

/// The path of a point in a step: its position at the start and its rates at the k Gauss points of a time element with
/// coefficients `a_ij` and weights `b_i`.
#[derive(Debug, Clone, Copy)]
pub struct PointPath<'a> {
    /// Position at the start \[length\].
    pub start: [f64; 3],
    /// Rates, `[k]` \[length\].
    pub rates: &'a [[f64; 3]],
    /// `a_ij`, `[k][k]`.
    pub coefficients: &'a [f64],
    /// `b_i`, `[k]`.
    pub weights: &'a [f64],
}

impl PointPath<'_> {
    /// The position at a point with the integrals of the basis.
    pub fn at(&self, integrals: &[f64]) -> [f64; 3] {
        let mut q = self.start;
        for (x, integral) in self.rates.iter().zip(integrals) {
            (0..3).for_each(|d| q[d] += integral * x[d]);
        }
        q
    }

    /// The position at a Gauss point.
    pub fn stage(&self, i: usize) -> [f64; 3] {
        let k = self.rates.len();
        self.at(&self.coefficients[i * k..(i + 1) * k])
    }

    /// The position at the end.
    pub fn end(&self) -> [f64; 3] {
        self.at(self.weights)
    }
}

/// A layer between the surface of an obstacle and points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObstacleLayer {
    /// The surface.
    pub surface: ObstacleSurface,
    /// The layer.
    pub layer: Layer,
}

impl ObstacleLayer {
    /// Energy per area at a gap, and its first and second derivatives by the gap.
    pub fn by_gap(&self, gap: f64) -> [f64; 3] {
        let square = self.layer.thickness.powi(2);
        let (y, rate) = (gap * gap / square, 2.0 * gap / square);
        let slope = self.layer.slope(y);
        let stiffness = self.layer.curvature(y) * rate * rate + slope * 2.0 / square;
        [self.layer.energy(y), slope * rate, stiffness]
    }

    /// The pressure at a position \[force/length^2\]; NaN behind the surface.
    pub fn pressure(&self, q: [f64; 3]) -> f64 {
        match self.surface.gap(q) {
            gap if gap <= 0.0 => f64::NAN,
            gap if gap < self.layer.thickness => -self.by_gap(gap)[1],
            _ => 0.0,
        }
    }

    /// Change of the energy over that of the gap, and its derivative by the second gap.
    fn quotient(&self, g_1: f64, g_2: f64) -> [f64; 2] {
        let square = self.layer.thickness.powi(2);
        let [y_1, y_2] = [g_1, g_2].map(|g| g * g / square);
        let quotient = self.layer.quotient(y_1, y_2) / square;
        let slope = self.layer.quotient_slope(y_1, y_2) * 2.0 * g_2 / (square * square);
        [quotient * (g_1 + g_2), slope * (g_1 + g_2) + quotient]
    }

    /// The gradient of the energy per area at a position \[force/length^2\], and the second derivative.
    pub fn gradient(&self, q: [f64; 3]) -> ([f64; 3], Mat3<f64>) {
        let gap = self.surface.gap(q);
        if gap >= self.layer.thickness {
            return Default::default();
        }
        let [_, slope, stiffness] = self.by_gap(gap);
        let (n, curvature) = (self.surface.gradient(q), self.surface.curvature(q));
        (scaled(slope, n), mat3(|i, j| stiffness * n[i] * n[j] + slope * curvature[i][j]))
    }

    /// Stage averages of the force per area \[force/length^2\], `forces: [k]`, that change the energy exactly:
    ///
    /// ```math
    /// k = 1:  f = [psi]/[g] Dg,    k > 1:  f_i = (psi'_i + c g'_i) grad g_i + c [g] Dg_i
    /// ```
    ///
    /// with the rates `g'_i = grad g_i . x_i`, changes `[.]` over the step, the discrete gradient Dg and the correction
    /// c. Returns whether one is not zero. `derivatives`: those of f_i by x_j, `[i k + j]`; empty if they are not
    /// wanted.
    pub fn conserving_forces(
        &self,
        path: &PointPath<'_>,
        forces: &mut [[f64; 3]],
        derivatives: &mut [Mat3<f64>],
    ) -> bool {
        let (surface, d, k) = (&self.surface, self.layer.thickness, path.rates.len());
        let ends = [path.start, path.end()];
        let [g_1, g_2] = ends.map(|q| surface.gap(q));
        if g_1.min(g_2) >= d && (0..k).all(|i| surface.gap(path.stage(i)) >= d) {
            return false;
        }
        let mut stages = [Stage::default(); MAX_STAGES];
        let stages = &mut stages[..k];
        for (i, stage) in stages.iter_mut().enumerate() {
            let (q, x) = (path.stage(i), path.rates[i]);
            let (n, [_, slope, stiffness]) = (surface.gradient(q), self.by_gap(surface.gap(q)));
            let secant = surface.secant(ends, q);
            *stage = Stage { q, x, n, slope, stiffness, rate: dot3(n, x), secant };
        }
        let [quotient, quotient_slope] = self.quotient(g_1, g_2);
        // A difference of gaps would have the rounding of positions.
        let change =
            stages.iter().zip(path.weights).map(|(own, b)| b * dot3(own.secant.gradient, own.x)).sum();
        let points = stages.iter().zip(path.weights).map(|(own, &weight)| GaussPoint {
            weight,
            slope: own.slope,
            rate: own.rate,
            size: norm(own.x),
        });
        let correction = Correction::new(quotient, change, points);
        let c = correction.factor;
        // Factors of the gradient in a stage, and of the discrete gradient.
        let of_gradient = |own: &Stage| if k == 1 { 0.0 } else { own.slope + c * own.rate };
        let of_secant = if k == 1 { quotient } else { c * change };
        for (force, own) in forces.iter_mut().zip(&*stages) {
            *force = three(|d| of_gradient(own) * own.n[d] + of_secant * own.secant.gradient[d]);
        }
        if derivatives.is_empty() {
            return true;
        }
        let at_end = surface.gradient(ends[1]);
        let end_slope = self.by_gap(g_2)[1];
        for (j, &b_j) in path.weights.iter().enumerate() {
            // d[g], dc and the derivative of the factor of the discrete gradient, by x_j.
            let by_change = scaled(b_j, at_end);
            let mut by_c = [0.0; 3];
            if k > 1 && c != 0.0 {
                by_c = scaled(end_slope - 2.0 * c * change, by_change);
                for (i, own) in stages.iter().enumerate() {
                    let a_ij = path.coefficients[i * k + j];
                    let by_rate = own.rate_derivative(surface, a_ij, i == j);
                    let of_rate = own.slope + 2.0 * c * own.rate;
                    let of_slope = own.rate * own.stiffness * a_ij;
                    (0..3).for_each(|d| {
                        by_c[d] -= path.weights[i] * (of_slope * own.n[d] + of_rate * by_rate[d]);
                    });
                }
                by_c = scaled(1.0 / correction.norm, by_c);
            }
            let by_secant = match k {
                1 => scaled(quotient_slope, by_change),
                _ => three(|d| change * by_c[d] + c * by_change[d]),
            };
            for (i, own) in stages.iter().enumerate() {
                let a_ij = path.coefficients[i * k + j];
                let by_rate = own.rate_derivative(surface, a_ij, i == j);
                let curvature = surface.curvature(own.q);
                let by_gradient = three(|d| match k {
                    1 => 0.0,
                    _ => own.stiffness * a_ij * own.n[d] + c * by_rate[d] + own.rate * by_c[d],
                });
                let Secant { gradient, by_stage, by_end } = &own.secant;
                derivatives[i * k + j] = mat3(|r, s| {
                    own.n[r] * by_gradient[s]
                        + of_gradient(own) * a_ij * curvature[r][s]
                        + gradient[r] * by_secant[s]
                        + of_secant * (a_ij * by_stage[r][s] + b_j * by_end[r][s])
                });
            }
        }
        true
    }
}

/// A stage of a path.
#[derive(Clone, Copy, Default)]
struct Stage {
    q: [f64; 3],
    x: [f64; 3],
    /// Gradient of the gap.
    n: [f64; 3],
    /// psi' and psi''.
    slope: f64,
    stiffness: f64,
    /// Rate of the gap.
    rate: f64,
    secant: Secant,
}

impl Stage {
    /// Derivative of the rate of the gap by x_j.
    fn rate_derivative(&self, surface: &ObstacleSurface, a_ij: f64, is_own: bool) -> [f64; 3] {
        let curvature = surface.curvature(self.q);
        three(|d| a_ij * dot3(curvature[d], self.x) + if is_own { self.n[d] } else { 0.0 })
    }
}

/// An entry of the projection across an axis.
fn across(axis: [f64; 3], i: usize, j: usize) -> f64 {
    (if i == j { 1.0 } else { 0.0 }) - axis[i] * axis[j]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    three(|d| a[d] - b[d])
}

fn scaled(factor: f64, v: [f64; 3]) -> [f64; 3] {
    v.map(|x| factor * x)
}

fn norm(v: [f64; 3]) -> f64 {
    dot3(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Rule;
    use crate::contact::LayerLaw;

    /// Numbers in `[-1, 1)` of a linear congruence.
    struct Random(u64);

    impl Random {
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self, size: f64) -> [f64; 3] {
            [0; 3].map(|_| size * self.number())
        }
    }

    fn surfaces() -> [ObstacleSurface; 4] {
        let round = |axis, sign| ObstacleSurface::Round { origin: [0.1, -0.2, 0.3], axis, radius: 1.0, sign };
        [
            ObstacleSurface::Plane { origin: [0.1, 0.2, 0.0], normal: [0.6, 0.0, 0.8] },
            round([0.0; 3], 1.0),
            round([0.0, 0.6, 0.8], 1.0),
            round([0.0, 0.6, 0.8], -1.0),
        ]
    }

    /// A path near a surface, and the layer there.
    fn drawn(surface: ObstacleSurface, k: usize, random: &mut Random) -> ([f64; 3], Vec<[f64; 3]>) {
        loop {
            let (start, rates) = (random.vector(2.5), (0..k).map(|_| random.vector(0.3)).collect::<Vec<_>>());
            let rule = Rule::discrete_gradient(k);
            let path = path(start, &rates, &rule);
            let gaps = (0..k).map(|i| path.stage(i)).chain([start, path.end()]).map(|q| surface.gap(q));
            let gaps: Vec<f64> = gaps.collect();
            // Away from the edge of the layer, where the third derivative jumps.
            if gaps.iter().all(|gap| (0.1..0.75).contains(gap)) {
                return (start, rates);
            }
        }
    }

    fn path<'a>(start: [f64; 3], rates: &'a [[f64; 3]], rule: &'a Rule) -> PointPath<'a> {
        PointPath { start, rates, coefficients: rule.coefficients(), weights: rule.weights() }
    }

    fn layer(surface: ObstacleSurface, law: LayerLaw) -> ObstacleLayer {
        ObstacleLayer { surface, layer: Layer { modulus: 3.0, thickness: 0.8, law } }
    }

    #[test]
    fn forces_do_the_work_of_the_energy_and_have_no_moment() {
        let mut random = Random(3);
        for (surface, k) in surfaces().into_iter().flat_map(|own| (1..=4).map(move |k| (own, k))) {
            for law in [LayerLaw::Smooth, LayerLaw::Linear] {
                let (own, rule) = (layer(surface, law), Rule::discrete_gradient(k));
                let (start, rates) = drawn(surface, k, &mut random);
                let path = path(start, &rates, &rule);
                let mut forces = vec![[0.0; 3]; k];
                assert!(own.conserving_forces(&path, &mut forces, &mut []));
                let work: f64 =
                    forces.iter().zip(&rates).zip(rule.weights()).map(|((f, x), b)| b * dot3(*f, *x)).sum();
                let [psi_1, psi_2] = [start, path.end()].map(|q| own.by_gap(surface.gap(q))[0]);
                assert!((work - (psi_2 - psi_1)).abs() < 1e-13 * (psi_1 + psi_2), "{surface:?} {k}");
                for (i, f) in forces.iter().enumerate() {
                    // Along the gradient at the stage.
                    let along = dot3(*f, surface.gradient(path.stage(i)));
                    assert!((dot3(*f, *f) - along * along).abs() < 1e-12 * along * along, "{surface:?} {k}");
                }
            }
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let mut random = Random(5);
        for (surface, k) in surfaces().into_iter().flat_map(|own| (1..=3).map(move |k| (own, k))) {
            let (own, rule) = (layer(surface, LayerLaw::Smooth), Rule::discrete_gradient(k));
            let (start, mut rates) = drawn(surface, k, &mut random);
            let mut derivatives = vec![Mat3::default(); k * k];
            own.conserving_forces(&path(start, &rates, &rule), &mut vec![[0.0; 3]; k], &mut derivatives);
            let size = derivatives.as_flattened().as_flattened().iter().fold(0.0f64, |m, d| m.max(d.abs()));
            for (j, s) in (0..k).flat_map(|j| (0..3).map(move |s| (j, s))) {
                let mut at = |step: f64| {
                    rates[j][s] += step;
                    let mut forces = vec![[0.0; 3]; k];
                    own.conserving_forces(&path(start, &rates, &rule), &mut forces, &mut []);
                    rates[j][s] -= step;
                    forces
                };
                let (plus, minus) = (at(1e-5), at(-1e-5));
                for (i, r) in (0..k).flat_map(|i| (0..3).map(move |r| (i, r))) {
                    let difference = (plus[i][r] - minus[i][r]) / 2e-5;
                    let error = (derivatives[i * k + j][r][s] - difference).abs();
                    assert!(error < 1e-7 * size, "{surface:?} {k} {i} {j}: {error:e} of {size}");
                }
            }
            // At rest they are the gradient, and its second derivative.
            let (gradient, second) = own.gradient(start);
            let step = |d: usize, by: f64| {
                let mut q = start;
                q[d] += by;
                own.by_gap(surface.gap(q))[0]
            };
            for d in 0..3 {
                let difference = (step(d, 1e-5) - step(d, -1e-5)) / 2e-5;
                assert!((gradient[d] - difference).abs() < 1e-8 * (1.0 + difference.abs()));
            }
            rates.fill([0.0; 3]);
            let mut forces = vec![[0.0; 3]; k];
            own.conserving_forces(&path(start, &rates, &rule), &mut forces, &mut derivatives);
            for (i, force) in forces.iter().enumerate() {
                (0..3).for_each(|d| assert!((force[d] - gradient[d]).abs() < 1e-12, "{surface:?} {k}"));
                let a = rule.coefficients()[i * k];
                let sum = |r: usize, s: usize| (derivatives[i * k][r][s] - a * second[r][s]).abs();
                let error = (0..9).map(|at| sum(at / 3, at % 3)).fold(0.0, f64::max);
                assert!(k > 1 || error < 1e-12, "{surface:?} {error:e}");
            }
        }
    }

    #[test]
    fn a_path_through_a_ball_passes() {
        let [plane, ball, _, inside] = surfaces();
        assert!(ball.is_passed([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]));
        assert!(!ball.is_passed([-2.0, 1.0, 0.0], [2.0, 1.2, 0.0]));
        assert!(plane.is_passed([1.0; 3], [-1.0; 3]) && !plane.is_passed([1.0; 3], [1.0, 2.0, 3.0]));
        assert!(inside.is_passed([0.0; 3], [5.0, 0.0, 0.0]) && !inside.is_passed([0.0; 3], [0.2, 0.1, 0.0]));
    }
}
