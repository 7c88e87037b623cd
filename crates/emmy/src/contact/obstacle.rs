//! Obstacles: surfaces of simple shapes, and the force of a layer between one and a point.

use super::layer::Layer;
use crate::tensor::dot3;

/// The shape of an obstacle.
///
/// ```
/// use emmy::body::Obstacle;
/// let floor = Obstacle::Plane { point: [0.0; 3], normal: [0.0, 0.0, 2.0] };
/// assert_eq!(floor.gap([5.0, 0.0, 3.0]), 3.0);
/// let bowl = Obstacle::Sphere { centre: [0.0; 3], radius: 2.0, inside: true };
/// assert_eq!(bowl.gap([0.0, 0.5, 0.0]), 1.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// A half-space.
    Plane {
        /// A point of the plane \[length\].
        point: [f64; 3],
        /// Normal towards the body, of any length.
        normal: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Centre \[length\].
        centre: [f64; 3],
        /// Radius \[length\].
        radius: f64,
        /// Whether the body is inside.
        inside: bool,
    },
    /// A cylinder without ends.
    Cylinder {
        /// A point of the axis \[length\].
        point: [f64; 3],
        /// Axis, of any length.
        axis: [f64; 3],
        /// Radius \[length\].
        radius: f64,
        /// Whether the body is inside.
        inside: bool,
    },
}

/// A symmetric 3x3 matrix, or one that is not.
type Matrix = [[f64; 3]; 3];

impl Obstacle {
    /// The gap g between the obstacle and a position \[length\]; negative where they overlap.
    pub fn gap(&self, q: [f64; 3]) -> f64 {
        match self {
            Obstacle::Plane { point, normal } => dot3(minus(q, *point), unit(*normal)),
            Obstacle::Sphere { radius, .. } | Obstacle::Cylinder { radius, .. } => {
                self.sign() * (norm(self.arm(q)) - radius)
            }
        }
    }

    /// The gradient of the gap.
    pub fn gradient(&self, q: [f64; 3]) -> [f64; 3] {
        if let Obstacle::Plane { normal, .. } = self {
            return unit(*normal);
        }
        let arm = self.arm(q);
        let factor = self.sign() / norm(arm);
        arm.map(|r| factor * r)
    }

    /// The second derivative of the gap.
    pub fn curvature(&self, q: [f64; 3]) -> [[f64; 3]; 3] {
        if let Obstacle::Plane { .. } = self {
            return [[0.0; 3]; 3];
        }
        let arm = self.arm(q);
        let (size, across) = (norm(arm), self.across());
        let entry = |i: usize, j: usize| across[i][j] - arm[i] * arm[j] / (size * size);
        matrix(|i, j| self.sign() / size * entry(i, j))
    }

    /// Whether a straight path between two positions outside of the obstacle leads through it.
    pub fn is_passed(&self, from: [f64; 3], to: [f64; 3]) -> bool {
        let (Obstacle::Sphere { radius, inside: false, .. }
        | Obstacle::Cylinder { radius, inside: false, .. }) = self
        else {
            return false;
        };
        let (start, way) = (self.arm(from), minus(self.arm(to), self.arm(from)));
        let square = dot3(way, way);
        let nearest = if square > 0.0 { (-dot3(start, way) / square).clamp(0.0, 1.0) } else { 0.0 };
        norm([0, 1, 2].map(|d| start[d] + nearest * way[d])) <= *radius
    }

    /// A position relative to the centre, or to the axis.
    fn arm(&self, q: [f64; 3]) -> [f64; 3] {
        match self {
            Obstacle::Plane { point, .. } => minus(q, *point),
            Obstacle::Sphere { centre, .. } => minus(q, *centre),
            Obstacle::Cylinder { point, axis, .. } => {
                let (arm, axis) = (minus(q, *point), unit(*axis));
                let along = dot3(arm, axis);
                [0, 1, 2].map(|d| arm[d] - along * axis[d])
            }
        }
    }

    /// Derivative of the arm.
    fn across(&self) -> Matrix {
        let axis = match self {
            Obstacle::Cylinder { axis, .. } => unit(*axis),
            _ => [0.0; 3],
        };
        matrix(|i, j| if i == j { 1.0 } else { 0.0 } - axis[i] * axis[j])
    }

    fn sign(&self) -> f64 {
        match self {
            Obstacle::Sphere { inside: true, .. } | Obstacle::Cylinder { inside: true, .. } => -1.0,
            _ => 1.0,
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
        if let Obstacle::Plane { normal, .. } = self {
            return Secant { gradient: unit(*normal), by_stage: [[0.0; 3]; 3], by_end: [[0.0; 3]; 3] };
        }
        let [r_1, r_2, r] = [q_1, q_2, q].map(|q| self.arm(q));
        let (size_2, sum) = (norm(r_2), norm(r_1) + norm(r_2));
        let factor = 2.0 * self.sign() / sum;
        let across = self.across();
        Secant {
            gradient: r.map(|r| factor * r),
            by_stage: matrix(|i, j| factor * across[i][j]),
            by_end: matrix(|i, j| -factor * r[i] * r_2[j] / (size_2 * sum)),
        }
    }
}

/// A discrete gradient, with its derivatives by the position of the stage and by that at the end.
struct Secant {
    gradient: [f64; 3],
    by_stage: Matrix,
    by_end: Matrix,
}

/// The path of a point in a step: its position at the start and its rates at the k Gauss points of a time element with
/// coefficients `a_ij` and weights `b_i`.
#[derive(Debug, Clone, Copy)]
pub struct Path<'a> {
    /// Position at the start \[length\].
    pub start: [f64; 3],
    /// Rates, `[k]` \[length\].
    pub rates: &'a [[f64; 3]],
    /// `a_ij`, `[k][k]`.
    pub coefficients: &'a [f64],
    /// `b_i`, `[k]`.
    pub weights: &'a [f64],
}

impl Path<'_> {
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

/// A layer between an obstacle and points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObstacleLayer {
    /// The obstacle.
    pub obstacle: Obstacle,
    /// The layer.
    pub layer: Layer,
}

impl ObstacleLayer {
    /// Energy per area at a gap, and its first and second derivatives by the gap.
    pub fn by_gap(&self, gap: f64) -> [f64; 3] {
        let d = self.layer.thickness;
        let (y, rate) = ((gap / d).powi(2), 2.0 * gap / (d * d));
        let slope = self.layer.slope(y);
        [self.layer.energy(y), slope * rate, self.layer.curvature(y) * rate * rate + slope * 2.0 / (d * d)]
    }

    /// Change of the energy over that of the gap, and its derivative by the second gap.
    fn quotient(&self, g_1: f64, g_2: f64) -> [f64; 2] {
        let square = self.layer.thickness.powi(2);
        let [y_1, y_2] = [g_1, g_2].map(|g| g * g / square);
        let quotient = self.layer.quotient(y_1, y_2) / square;
        let slope = self.layer.quotient_slope(y_1, y_2) * 2.0 * g_2 / (square * square);
        [quotient * (g_1 + g_2), slope * (g_1 + g_2) + quotient]
    }

    /// The gradient of the energy per area at a position \[force/length^2\]; with the second derivative.
    pub fn gradient(&self, q: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let gap = self.obstacle.gap(q);
        if gap >= self.layer.thickness {
            return ([0.0; 3], [[0.0; 3]; 3]);
        }
        let [_, slope, stiffness] = self.by_gap(gap);
        let n = self.obstacle.gradient(q);
        let curvature = self.obstacle.curvature(q);
        (n.map(|n| slope * n), matrix(|i, j| stiffness * n[i] * n[j] + slope * curvature[i][j]))
    }

    /// Stage averages of the force per area \[force/length^2\], `forces: [k]`, that change the energy exactly:
    ///
    /// ```math
    /// k = 1:  f = [psi]/[g] Dg,    k > 1:  f_i = (psi'_i + D gamma_i/N) grad g_i + D [g]/N Dg_i
    /// D = [psi] - sum_i b_i psi'_i gamma_i,   gamma_i = grad g_i . x_i,   N = sum_i b_i gamma_i^2 + [g]^2
    /// ```
    ///
    /// with the gaps g_i at the stages, changes `[.]` over the step and the discrete gradient Dg. Returns whether one
    /// is not zero. `derivatives`: those of f_i by x_j, `[i k + j]`; empty if they are not wanted.
    pub fn conserving_forces(
        &self,
        path: &Path<'_>,
        forces: &mut [[f64; 3]],
        derivatives: &mut [[[f64; 3]; 3]],
    ) -> bool {
        let (obstacle, k, ends) = (&self.obstacle, path.rates.len(), [path.start, path.end()]);
        let [g_1, g_2] = ends.map(|q| obstacle.gap(q));
        let d = self.layer.thickness;
        if g_1.min(g_2) >= d && (0..k).all(|i| obstacle.gap(path.stage(i)) >= d) {
            return false;
        }
        let [quotient, quotient_slope] = self.quotient(g_1, g_2);
        let at_end = obstacle.gradient(ends[1]);
        if let [force] = forces {
            let secant = obstacle.secant(ends, path.stage(0));
            *force = secant.gradient.map(|n| quotient * n);
            if let [derivative] = derivatives {
                let (a, b) = (path.coefficients[0], path.weights[0]);
                *derivative = matrix(|i, j| {
                    quotient_slope * b * secant.gradient[i] * at_end[j]
                        + quotient * (a * secant.by_stage[i][j] + b * secant.by_end[i][j])
                });
            }
            return true;
        }
        self.add_higher_forces(path, (ends, g_2, quotient), forces, derivatives);
        true
    }

    /// The mean force per area of a step of degree 1, with a symmetric derivative that no pressure makes indefinite.
    /// Returns whether it is not zero.
    pub fn kept_force(
        &self,
        path: &Path<'_>,
        forces: &mut [[f64; 3]],
        derivatives: &mut [[[f64; 3]; 3]],
    ) -> bool {
        let (obstacle, middle) = (&self.obstacle, path.stage(0));
        let [g_1, g_2] = [path.start, path.end()].map(|q| obstacle.gap(q));
        if g_1.min(g_2) >= self.layer.thickness {
            return false;
        }
        let [quotient, slope] = self.quotient(g_1, g_2);
        let n = obstacle.gradient(middle);
        forces.fill(n.map(|n| quotient * n));
        derivatives.fill(matrix(|i, j| slope * path.weights[0] * n[i] * n[j]));
        true
    }

    /// The forces of degree 2 and more.
    fn add_higher_forces(
        &self,
        path: &Path<'_>,
        (ends, g_2, quotient): ([[f64; 3]; 2], f64, f64),
        forces: &mut [[f64; 3]],
        derivatives: &mut [[[f64; 3]; 3]],
    ) {
        let (obstacle, k) = (&self.obstacle, path.rates.len());
        let stage = |i: usize| {
            let q = path.stage(i);
            let (x, n) = (path.rates[i], obstacle.gradient(q));
            let [_, slope, stiffness] = self.by_gap(obstacle.gap(q));
            Stage { q, x, n, slope, stiffness, rate: dot3(n, x) }
        };
        // The change of the gap by its rates: a difference of gaps would have the rounding of positions.
        let mut change = 0.0;
        for (i, b) in path.weights.iter().enumerate() {
            let Stage { q, x, .. } = stage(i);
            change += b * dot3(obstacle.secant(ends, q).gradient, x);
        }
        let (mut defect, mut square, mut noise) = (quotient * change, change * change, 0.0);
        for (i, b) in path.weights.iter().enumerate() {
            let Stage { slope, rate, x, .. } = stage(i);
            defect -= b * slope * rate;
            square += b * rate * rate;
            noise += b * slope.abs().max(quotient.abs()) * norm(x);
        }
        // The defect of a point at rest, or that slides along the surface, is rounding over rounding.
        let is_noise = defect.abs() <= 32.0 * f64::EPSILON * noise || square == 0.0;
        let (defect, square) = if is_noise { (0.0, 1.0) } else { (defect, square) };
        for i in 0..k {
            let Stage { q, n, slope, rate, .. } = stage(i);
            let secant = obstacle.secant(ends, q).gradient;
            let along = slope + defect * rate / square;
            forces[i] = [0, 1, 2].map(|d| along * n[d] + defect * change / square * secant[d]);
        }
        if derivatives.is_empty() {
            return;
        }
        let at_end = obstacle.gradient(ends[1]);
        let end_slope = self.by_gap(g_2)[1];
        for j in 0..k {
            // Derivatives by x_j of what all stages share.
            let (mut by_defect, mut by_square) = ([0.0; 3], [0.0; 3]);
            let by_change = at_end.map(|n| path.weights[j] * n);
            if !is_noise {
                (0..3).for_each(|d| by_defect[d] += end_slope * by_change[d]);
                (0..3).for_each(|d| by_square[d] += 2.0 * change * by_change[d]);
                for (i, b) in path.weights.iter().enumerate() {
                    let Stage { slope, rate, .. } = stage(i);
                    let [by_slope, by_rate] = self.of_stage((path, i, j), &stage(i));
                    (0..3).for_each(|d| by_defect[d] -= b * (rate * by_slope[d] + slope * by_rate[d]));
                    (0..3).for_each(|d| by_square[d] += 2.0 * b * rate * by_rate[d]);
                }
            }
            for i in 0..k {
                let own = stage(i);
                let [by_slope, by_rate] = self.of_stage((path, i, j), &own);
                let Secant { gradient, by_stage, by_end } = obstacle.secant(ends, own.q);
                let (a, b) = (path.coefficients[i * k + j], path.weights[j]);
                let along = own.slope + defect * own.rate / square;
                let curvature = obstacle.curvature(own.q);
                let share = |value: f64, by_value: f64, d: usize| {
                    (value * by_defect[d] + defect * by_value) / square
                        - defect * value * by_square[d] / (square * square)
                };
                let by_along = [0, 1, 2].map(|d| by_slope[d] + share(own.rate, by_rate[d], d));
                let by_secant = [0, 1, 2].map(|d| share(change, by_change[d], d));
                derivatives[i * k + j] = matrix(|r, c| {
                    own.n[r] * by_along[c]
                        + along * a * curvature[r][c]
                        + gradient[r] * by_secant[c]
                        + defect * change / square * (a * by_stage[r][c] + b * by_end[r][c])
                });
            }
        }
    }

    /// Derivatives of the slope `psi'_i` and of the rate `gamma_i` by x_j.
    fn of_stage(&self, (path, i, j): (&Path<'_>, usize, usize), stage: &Stage) -> [[f64; 3]; 2] {
        let a = path.coefficients[i * path.rates.len() + j];
        let curvature = self.obstacle.curvature(stage.q);
        let by_rate = [0, 1, 2].map(|d| {
            let turned = a * dot3(curvature[d], stage.x);
            turned + if i == j { stage.n[d] } else { 0.0 }
        });
        [stage.n.map(|n| stage.stiffness * a * n), by_rate]
    }
}

/// A stage of a path.
struct Stage {
    q: [f64; 3],
    x: [f64; 3],
    n: [f64; 3],
    /// psi' and psi''.
    slope: f64,
    stiffness: f64,
    /// gamma.
    rate: f64,
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn norm(v: [f64; 3]) -> f64 {
    dot3(v, v).sqrt()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let size = norm(v);
    v.map(|x| x / size)
}

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}
