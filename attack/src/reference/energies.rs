//! Strain energies as functions of C, and the stress and elasticity that follow from them by differentiation.

use super::dual::Dual;

/// Symmetric tensor as a matrix.
pub type Tensor = [[f64; 3]; 3];

/// A strain energy per reference volume.
#[derive(Debug, Clone, PartialEq)]
pub enum Energy {
    /// `lambda/2 (tr E)^2 + mu E : E`.
    SaintVenantKirchhoff {
        /// First parameter of Lame.
        lambda: f64,
        /// Shear modulus.
        mu: f64,
    },
    /// `mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J`.
    NeoHooke {
        /// First parameter of Lame.
        lambda: f64,
        /// Shear modulus.
        mu: f64,
    },
    /// `c10 (I1bar - 3) + c01 (I2bar - 3) + K/4 (J^2 - 1 - 2 ln J)`.
    MooneyRivlin {
        /// Modulus of the first invariant.
        c10: f64,
        /// Modulus of the second invariant.
        c01: f64,
        /// Bulk modulus.
        bulk: f64,
    },
    /// `c/b (exp(b (I1_bar - 3)) - 1) + K/2 (J - 1)^2`, given as a formula.
    Formula {
        /// Modulus.
        c: f64,
        /// Growth.
        b: f64,
        /// Bulk modulus.
        bulk: f64,
    },
    /// `mu/2 (I1bar - 3) + k1/(2 k2) (exp(k2 <E_f>^2) - 1) + K/2 (ln J)^2` with one family of fibres.
    Fibres {
        /// Shear modulus of the matrix.
        mu: f64,
        /// Stiffness of the fibres.
        k1: f64,
        /// Growth of their stiffness.
        k2: f64,
        /// Dispersion.
        kappa: f64,
        /// Direction.
        fibre: [f64; 3],
        /// Bulk modulus.
        bulk: f64,
    },
}

/// Measure of volume that a formulation projects, less its value at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// `J - 1`.
    Ratio,
    /// `tr E`.
    Trace,
}

/// Invariants of C as duals.
struct Invariants {
    c: [Dual; 6],
    first: Dual,
    second: Dual,
    ratio: Dual,
}

/// C as six duals: xx, yy, zz, xy, yz, xz.
fn variables(c: &Tensor) -> [Dual; 6] {
    let entries = [c[0][0], c[1][1], c[2][2], c[0][1], c[1][2], c[0][2]];
    std::array::from_fn(|i| Dual::variable(entries[i], i))
}

fn invariants(tensor: &Tensor) -> Invariants {
    let c = variables(tensor);
    let first = c[0] + c[1] + c[2];
    let squares = c[3].square() + c[4].square() + c[5].square();
    let second = c[0] * c[1] + c[1] * c[2] + c[2] * c[0] - squares;
    let third = c[0] * c[1] * c[2] + c[3] * c[4] * c[5] * 2.0
        - c[0] * c[4].square()
        - c[1] * c[5].square()
        - c[2] * c[3].square();
    Invariants { c, first, second, ratio: third.sqrt() }
}

impl Energy {
    /// The material as Emmy's input has it.
    pub fn text(&self) -> String {
        match self {
            Energy::SaintVenantKirchhoff { lambda, mu } => {
                format!("saint-venant-kirchhoff = {{ lambda = {lambda:?}, mu = {mu:?} }}")
            }
            Energy::NeoHooke { lambda, mu } => format!("neo-hooke = {{ lambda = {lambda:?}, mu = {mu:?} }}"),
            Energy::MooneyRivlin { c10, c01, bulk } => {
                format!("mooney-rivlin = {{ c10 = {c10:?}, c01 = {c01:?}, bulk_modulus = {bulk:?} }}")
            }
            Energy::Formula { c, b, bulk } => format!(
                "energy = {{ formula = \"c/b*(exp(b*(I1_bar - 3)) - 1) + K/2*(J - 1)^2\", c = {c:?}, b = {b:?}, K = {bulk:?} }}"
            ),
            Energy::Fibres { mu, k1, k2, kappa, fibre, bulk } => format!(
                "holzapfel-gasser-ogden = {{ mu = {mu:?}, k1 = {k1:?}, k2 = {k2:?}, kappa = {kappa:?}, \
                 fibres = [{fibre:?}], bulk_modulus = {bulk:?}, volumetric = \"logarithmic\" }}"
            ),
        }
    }

    /// The volume measure of a projected volume.
    pub fn measure(&self) -> Measure {
        match self {
            Energy::SaintVenantKirchhoff { .. } => Measure::Trace,
            _ => Measure::Ratio,
        }
    }

    /// The energy of a volume, with its first derivative.
    pub fn volume_energy(&self, theta: f64) -> (f64, f64) {
        let ratio = 1.0 + theta;
        match *self {
            Energy::SaintVenantKirchhoff { lambda, .. } => (0.5 * lambda * theta * theta, lambda * theta),
            Energy::NeoHooke { lambda: k, .. } | Energy::Fibres { bulk: k, .. } => {
                (0.5 * k * ratio.ln().powi(2), k * ratio.ln() / ratio)
            }
            Energy::MooneyRivlin { bulk, .. } => {
                (0.25 * bulk * (ratio * ratio - 1.0 - 2.0 * ratio.ln()), 0.5 * bulk * (ratio - 1.0 / ratio))
            }
            Energy::Formula { bulk, .. } => (0.5 * bulk * theta * theta, bulk * theta),
        }
    }

    /// Second derivative of the energy of a volume at rest.
    pub fn bulk_stiffness(&self) -> f64 {
        match *self {
            Energy::SaintVenantKirchhoff { lambda, .. } | Energy::NeoHooke { lambda, .. } => lambda,
            Energy::MooneyRivlin { bulk, .. }
            | Energy::Formula { bulk, .. }
            | Energy::Fibres { bulk, .. } => bulk,
        }
    }

    /// The rest of the energy.
    fn rest(&self, i: &Invariants) -> Dual {
        let first_bar = i.ratio.power(-2.0 / 3.0) * i.first;
        match *self {
            Energy::SaintVenantKirchhoff { mu, .. } => {
                let strain: [Dual; 6] = std::array::from_fn(|n| (i.c[n] - f64::from(n < 3)) * 0.5);
                let normal = strain[0].square() + strain[1].square() + strain[2].square();
                let shear = strain[3].square() + strain[4].square() + strain[5].square();
                (normal + shear * 2.0) * mu
            }
            Energy::NeoHooke { mu, .. } => (i.first - 3.0) * (0.5 * mu) - i.ratio.ln() * mu,
            Energy::MooneyRivlin { c10, c01, .. } => {
                let second_bar = i.ratio.power(-4.0 / 3.0) * i.second;
                (first_bar - 3.0) * c10 + (second_bar - 3.0) * c01
            }
            Energy::Formula { c, b, .. } => (((first_bar - 3.0) * b).exp() - 1.0) * (c / b),
            Energy::Fibres { mu, k1, k2, kappa, fibre: a, .. } => {
                let length = a.iter().map(|x| x * x).sum::<f64>();
                let normal = i.c[0] * a[0] * a[0] + i.c[1] * a[1] * a[1] + i.c[2] * a[2] * a[2];
                let shear = i.c[3] * a[0] * a[1] + i.c[4] * a[1] * a[2] + i.c[5] * a[0] * a[2];
                let fourth_bar = i.ratio.power(-2.0 / 3.0) * (normal + shear * 2.0) * (1.0 / length);
                let strain = (first_bar - 3.0) * kappa + (fourth_bar - 1.0) * (1.0 - 3.0 * kappa);
                let fibres = match strain.value > 0.0 {
                    true => ((strain.square() * k2).exp() - 1.0) * (0.5 * k1 / k2),
                    false => Dual::constant(0.0),
                };
                (first_bar - 3.0) * (0.5 * mu) + fibres
            }
        }
    }

    /// The energy at a point and S = 2 dW/dC, without the energy of the volume if that is projected.
    pub fn at(&self, c: &Tensor, without_volume: bool) -> (f64, Tensor) {
        let i = invariants(c);
        let mut energy = self.rest(&i);
        if !without_volume {
            let theta = match self.measure() {
                Measure::Ratio => i.ratio - 1.0,
                Measure::Trace => (i.first - 3.0) * 0.5,
            };
            let (value, rate) = self.volume_energy(theta.value);
            energy = energy + Dual { value, by: theta.by.map(|d| rate * d) };
        }
        let d = energy.by;
        let s = [2.0 * d[0], 2.0 * d[1], 2.0 * d[2], d[3], d[4], d[5]];
        (energy.value, [[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])
    }

    /// The stress `D : E` of the undeformed material, by central differences along E with an error of the fourth order.
    ///
    /// Fibres bear tension only and count as slack.
    pub fn elastic_stress(&self, strain: &Tensor, without_volume: bool) -> Tensor {
        if let Energy::Fibres { mu, k2, kappa, fibre, bulk, k1 } = *self
            && k1 != 0.0
        {
            let matrix = Energy::Fibres { mu, k1: 0.0, k2, kappa, fibre, bulk };
            return matrix.elastic_stress(strain, without_volume);
        }
        let size = strain.iter().flatten().fold(0.0f64, |m, e| m.max(e.abs()));
        if size == 0.0 {
            return [[0.0; 3]; 3];
        }
        let step = 4e-4 / size;
        let stress = |factor: f64| {
            let c: Tensor = std::array::from_fn(|i| {
                std::array::from_fn(|j| f64::from(i == j) + 2.0 * factor * step * strain[i][j])
            });
            self.at(&c, without_volume).1
        };
        let [near, far] = [1.0, 2.0].map(|n| (stress(n), stress(-n)));
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (8.0 * (near.0[i][j] - near.1[i][j]) - (far.0[i][j] - far.1[i][j])) / (12.0 * step)
            })
        })
    }
}
