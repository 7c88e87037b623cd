//! The energy of a layer, by the squared distance over that of the layer.

/// How the pressure of a layer begins.
///
/// ```
/// use emmy::body::LayerLaw;
/// assert_eq!(LayerLaw::default(), LayerLaw::Smooth);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LayerLaw {
    /// Softly, with a continuous stiffness.
    #[default]
    Smooth,
    /// As an elastic layer with the modulus of the contact.
    Linear,
}

/// A layer with a modulus kappa and a thickness d. With `y = (distance/d)^2`, its energy per area is
///
/// ```math
/// psi(y) = kappa d/8 (1 - y)^m/y  for 0 < y < 1,  0 from 1 on
/// ```
///
/// with m = 3 of the smooth law and m = 2 of the linear one.
///
/// ```
/// use emmy::body::LayerLaw;
/// use emmy::internals::contact::Layer;
/// let layer = Layer { modulus: 100.0, thickness: 0.5, law: LayerLaw::Smooth };
/// assert!((layer.energy(0.3) - 6.25 * 0.343 / 0.3).abs() < 1e-14);
/// assert_eq!((layer.energy(1.0), layer.slope(1.2)), (0.0, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Modulus kappa \[force/length^2\].
    pub modulus: f64,
    /// Thickness d \[length\].
    pub thickness: f64,
    /// Law.
    pub law: LayerLaw,
}

/// The kind of things to which a layer belongs. All layers of a contact are equally stiff, and the thinner ones silent
/// until the pressure is high.
///
/// ```
/// use emmy::internals::contact::LayerOf;
/// assert_eq!([LayerOf::Points, LayerOf::Guards, LayerOf::BluntEdges].map(LayerOf::part), [1.0, 0.5, 0.25]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LayerOf {
    /// Points of the facets.
    Points,
    /// Nodes, and sharp edges against each other.
    Guards,
    /// Other edges.
    BluntEdges,
}

impl LayerOf {
    /// Its thickness over that of the points.
    pub const fn part(self) -> f64 {
        match self {
            LayerOf::Points => 1.0,
            LayerOf::Guards => 0.5,
            LayerOf::BluntEdges => 0.25,
        }
    }
}

impl Layer {
    /// The layer of something, from that of the points.
    pub fn of(&self, what: LayerOf) -> Layer {
        Layer { thickness: what.part() * self.thickness, ..*self }
    }

    fn c(&self) -> f64 {
        0.125 * self.modulus * self.thickness
    }

    /// psi \[energy/length^2\].
    pub fn energy(&self, y: f64) -> f64 {
        let e = 1.0 - y;
        match self.law {
            _ if y >= 1.0 => 0.0,
            LayerLaw::Smooth => self.c() * e * e * e / y,
            LayerLaw::Linear => self.c() * e * e / y,
        }
    }

    /// `dpsi/dy`.
    pub fn slope(&self, y: f64) -> f64 {
        let e = 1.0 - y;
        match self.law {
            _ if y >= 1.0 => 0.0,
            LayerLaw::Smooth => -self.c() * e * e * (1.0 + 2.0 * y) / (y * y),
            LayerLaw::Linear => -self.c() * e * (1.0 + y) / (y * y),
        }
    }

    /// `d^2psi/dy^2`.
    pub fn curvature(&self, y: f64) -> f64 {
        match self.law {
            _ if y >= 1.0 => 0.0,
            LayerLaw::Smooth => 2.0 * self.c() * (1.0 / (y * y * y) - 1.0),
            LayerLaw::Linear => 2.0 * self.c() / (y * y * y),
        }
    }

    /// `(psi(y_2) - psi(y_1))/(y_2 - y_1)`, without cancellation.
    pub fn quotient(&self, y_1: f64, y_2: f64) -> f64 {
        let (e_1, e_2) = (1.0 - y_1, 1.0 - y_2);
        if e_1 <= 0.0 && e_2 <= 0.0 {
            return 0.0;
        }
        if e_1 <= 0.0 || e_2 <= 0.0 {
            return (self.energy(y_2) - self.energy(y_1)) / (y_2 - y_1);
        }
        let numerator = match self.law {
            LayerLaw::Smooth => e_1 * e_1 + e_1 * e_2 + e_2 * e_2 - e_1 * e_2 * (e_1 + e_2),
            LayerLaw::Linear => e_1 + e_2 - e_1 * e_2,
        };
        -self.c() * numerator / (y_1 * y_2)
    }

    /// Derivative of [`Layer::quotient`] by `y_2`.
    pub fn quotient_slope(&self, y_1: f64, y_2: f64) -> f64 {
        if y_1 >= 1.0 && y_2 >= 1.0 {
            return 0.0;
        }
        if y_1 >= 1.0 || y_2 >= 1.0 {
            return (self.slope(y_2) - self.quotient(y_1, y_2)) / (y_2 - y_1);
        }
        let whole = match self.law {
            LayerLaw::Smooth => 1.0,
            LayerLaw::Linear => 0.0,
        };
        self.c() * (1.0 / (y_1 * y_2 * y_2) - whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of an independent implementation: kappa = 100, d = 0.5.
    #[test]
    fn energies_and_slopes_are_those_of_another_implementation() {
        let layer = Layer { modulus: 100.0, thickness: 0.5, law: LayerLaw::Smooth };
        let y = [0.05, 0.3, 0.7, 0.95, 1.2];
        let energies = [
            107.171_874_999_999_97,
            7.145_833_333_333_331,
            0.241_071_428_571_428_71,
            8.223_684_210_526_337e-4,
            0.0,
        ];
        let slopes = [
            -2_481.874_999_999_999,
            -54.444_444_444_444_43,
            -2.755_102_040_816_327_6,
            -0.050_207_756_232_687_06,
            0.0,
        ];
        let quotients = [
            -400.104_166_666_666_6,
            -17.261_904_761_904_763,
            -0.960_996_240_601_504_2,
            -0.003_289_473_684_210_535_2,
        ];
        for (i, &y_i) in y.iter().enumerate() {
            assert!((layer.energy(y_i) - energies[i]).abs() <= 1e-12 * energies[i].abs());
            assert!((layer.slope(y_i) - slopes[i]).abs() <= 1e-12 * slopes[i].abs());
        }
        for (pair, expected) in y.windows(2).zip(quotients) {
            assert!((layer.quotient(pair[0], pair[1]) / expected - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn quotients_and_derivatives_agree() {
        for law in [LayerLaw::Smooth, LayerLaw::Linear] {
            let layer = Layer { modulus: 30.0, thickness: 0.2, law };
            for (y_1, y_2) in [(0.2, 0.5), (0.6, 0.61), (0.9, 1.1), (1.3, 0.8), (1.5, 1.4)] {
                let change = layer.energy(y_2) - layer.energy(y_1);
                let quotient = layer.quotient(y_1, y_2);
                assert!((quotient * (y_2 - y_1) - change).abs() < 1e-14, "{law:?} {y_1} {y_2}");
                assert_eq!(quotient, layer.quotient(y_2, y_1));
                let difference = |f: &dyn Fn(f64) -> f64| (f(y_2 + 1e-5) - f(y_2 - 1e-5)) / 2e-5;
                for (own, expected) in [
                    (layer.slope(y_2), difference(&|y| layer.energy(y))),
                    (layer.curvature(y_2), difference(&|y| layer.slope(y))),
                    (layer.quotient_slope(y_1, y_2), difference(&|y| layer.quotient(y_1, y))),
                ] {
                    assert!(
                        (own - expected).abs() < 1e-7 * (1.0 + own.abs()),
                        "{law:?} {y_1} {y_2}: {own} {expected}"
                    );
                }
            }
            // The limit of equal arguments.
            assert!((layer.quotient(0.4, 0.4) / layer.slope(0.4) - 1.0).abs() < 1e-15);
        }
    }
}
