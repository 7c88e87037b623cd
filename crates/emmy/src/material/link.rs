//! Links of two nodes: bars, springs and attractions, as functions of tr E.

#![allow(non_snake_case)]

use super::model::{Bounds, IfAbsent, Model, ModelCells, Parameter, Values};
use super::{Material, finite, fulfils, positive};
use crate::error::Result;
use crate::tensor::{Elasticity, Lane, Sym, trace};

/// A link between two nodes at a distance l, L in the reference configuration.
///
/// ```math
/// bar: V = E A L e^2/2,  e = (l^2/L^2 - 1)/2      spring: V = k/2 (l - l_0)^2      attraction: V = -g/l
/// ```
///
/// The bar is the St. Venant-Kirchhoff material in the Green-Lagrange strain of its length; only bars have a mass,
/// density times area times length. The attraction with g = G m_1 m_2 is Newton's law of gravitation.
///
/// ```
/// use emmy::prelude::*;
/// let spring = Link::spring(2.0, Some(0.5))?.with_length(1.0);
/// assert_eq!(spring.strain_energy(&[0.0; 6]), 0.25); // k/2 (1 - 1/2)^2
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Bar { youngs_modulus: f64, area: f64 },
    Spring { stiffness: f64, rest_length: Option<f64> },
    Attraction { strength: f64 },
}

const YOUNGS_MODULUS: Parameter = Parameter::positive("youngs_modulus", "stress", "Young's modulus E");

impl Link {
    /// The model of bars.
    pub const BAR: Model = Model {
        name: "bar",
        energy: "E A L e^2/2, e = (l^2/L^2 - 1)/2",
        purpose: "trusses, cables under tension; mass density A L",
        parameters: &[&[YOUNGS_MODULUS, Parameter::positive("area", "length²", "Cross section A")]],
        cells: ModelCells::Links,
    };

    /// The model of springs.
    pub const SPRING: Model = Model {
        name: "spring",
        energy: "k/2 (l - l_0)^2",
        purpose: "springs, without mass",
        parameters: &[&[
            Parameter::positive("stiffness", "force/length", "Stiffness k"),
            Parameter::number("rest_length", Bounds::AtLeast(0.0), "length", "Length l_0 without force")
                .if_absent(IfAbsent::Means("the reference length of each link")),
        ]],
        cells: ModelCells::MasslessLinks,
    };

    /// The model of attractions.
    pub const ATTRACTION: Model = Model {
        name: "attraction",
        energy: "-g/l",
        purpose: "gravitation, g = G m_1 m_2; without mass",
        parameters: &[&[Parameter::number(
            "strength",
            Bounds::NotZero,
            "energy·length",
            "Strength g, of two masses that attract each other G m_1 m_2; negative: repulsion",
        )]],
        cells: ModelCells::MasslessLinks,
    };

    /// The bar with values of the parameters of [`Link::BAR`].
    ///
    /// # Errors
    /// As [`Link::bar`].
    pub fn bar_from_values(values: &Values) -> Result<Self> {
        Link::bar(values.number("youngs_modulus"), values.number("area"))
    }

    /// The spring with values of the parameters of [`Link::SPRING`].
    ///
    /// # Errors
    /// As [`Link::spring`].
    pub fn spring_from_values(values: &Values) -> Result<Self> {
        Link::spring(values.number("stiffness"), values.optional("rest_length"))
    }

    /// The attraction with values of the parameters of [`Link::ATTRACTION`].
    ///
    /// # Errors
    /// As [`Link::attraction`].
    pub fn attraction_from_values(values: &Values) -> Result<Self> {
        Link::attraction(values.number("strength"))
    }

    /// A bar with Young's modulus E \[stress\] and cross section A \[length^2\].
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless both are positive.
    pub fn bar(youngs_modulus: f64, area: f64) -> Result<Self> {
        positive("bar", "youngs_modulus", youngs_modulus)?;
        positive("bar", "area", area)?;
        Ok(Link(Kind::Bar { youngs_modulus, area }))
    }

    /// A spring with stiffness k \[force/length\] and length at rest l_0 \[length\]; `None`: the reference length.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless the stiffness is positive and the length is not negative.
    pub fn spring(stiffness: f64, rest_length: Option<f64>) -> Result<Self> {
        positive("spring", "stiffness", stiffness)?;
        let length = rest_length.unwrap_or(0.0);
        let is_length = length >= 0.0 && length.is_finite();
        fulfils(is_length, "spring", "rest_length", length, "must be finite and not negative")?;
        Ok(Link(Kind::Spring { stiffness, rest_length }))
    }

    /// An attraction of strength g \[energy length\]; a negative one repels.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] unless the strength is finite and not zero.
    pub fn attraction(strength: f64) -> Result<Self> {
        finite("attraction", "strength", strength)?;
        fulfils(strength != 0.0, "attraction", "strength", strength, "must not be zero")?;
        Ok(Link(Kind::Attraction { strength }))
    }

    /// Cross section of a bar \[length^2\]; zero for springs and attractions.
    pub fn area(&self) -> f64 {
        match self.0 {
            Kind::Bar { area, .. } => area,
            _ => 0.0,
        }
    }

    /// Young's modulus of a bar \[force/length^2\].
    ///
    /// ```
    /// use emmy::material::Link;
    /// assert_eq!(Link::bar(2.1e5, 10.0)?.youngs_modulus(), Some(2.1e5));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn youngs_modulus(&self) -> Option<f64> {
        match self.0 {
            Kind::Bar { youngs_modulus, .. } => Some(youngs_modulus),
            Kind::Spring { .. } | Kind::Attraction { .. } => None,
        }
    }

    /// The energy of a link with a reference length L \[length\].
    pub fn with_length(&self, length: f64) -> LinkEnergy {
        let (law, factor) = match self.0 {
            Kind::Bar { youngs_modulus, area } => (Law::Bar, youngs_modulus * area * length),
            Kind::Spring { stiffness, rest_length } => {
                let gap = 1.0 - rest_length.unwrap_or(length) / length;
                (Law::Spring { gap }, stiffness * length * length)
            }
            Kind::Attraction { strength } => (Law::Attraction, strength / length),
        };
        LinkEnergy { law, factor }
    }
}

/// Energy of a whole link (not per volume) of known reference length as a function of tr E \[energy\].
///
/// ```math
/// tr E = (l^2/L^2 - 1)/2,    x = l/L:    W = E A L (tr E)^2/2,    k L^2 (x - l_0/L)^2/2,    -(g/L)/x
/// ```
///
/// ```
/// use emmy::prelude::*;
/// let bar = Link::bar(1000.0, 0.1)?.with_length(2.0);
/// let energy = bar.strain_energy(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// assert!((energy - 1.0).abs() < 1e-15); // 1000 * 0.1 * 2 * 0.1^2 / 2
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkEnergy {
    law: Law,
    factor: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    Bar,
    /// `gap`: 1 - l_0/L.
    Spring {
        gap: f64,
    },
    Attraction,
}

impl LinkEnergy {
    /// W and its first two derivatives with respect to tr E, divided by the factor.
    #[inline(always)]
    fn derivatives<L: Lane>(&self, e: L) -> [L; 3] {
        let one = e.splat(1.0);
        let square = one + e * 2.0;
        let stretch = square.sqrt();
        match self.law {
            Law::Bar => [e * e * 0.5, e, one],
            Law::Spring { gap } => {
                // l/L - 1 without cancellation.
                let extension = e * 2.0 / (one + stretch);
                let out = extension + e.splat(gap);
                [out * out * 0.5, out / stretch, e.splat(1.0 - gap) / (square * stretch)]
            }
            Law::Attraction => {
                let third = one / (square * stretch);
                [-(one / stretch), third, third / square * -3.0]
            }
        }
    }
}

impl Material for LinkEnergy {
    const IS_LINK: bool = true;

    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        self.derivatives(trace(E))[0] * self.factor
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let S = self.derivatives(trace(E))[1] * self.factor;
        let zero = E[0].splat(0.0);
        [S, S, S, zero, zero, zero]
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let [_, first, second] = self.derivatives(trace(E));
        let zero = E[0].splat(0.0);
        let (S, modulus) = (first * self.factor, second * self.factor);
        let mut D = [[zero; 6]; 6];
        for a in 0..3 {
            for b in 0..3 {
                D[a][b] = modulus;
            }
        }
        ([S, S, S, zero, zero, zero], D)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::rejects;
    use super::*;

    /// Strain of a link of length 2 at a length l; the distribution of tr E over the axes does not matter.
    fn strain(l: f64) -> Sym<f64> {
        let e = (l * l / 4.0 - 1.0) / 2.0;
        [0.5 * e, 0.3 * e, 0.2 * e, 0.7, -0.1, 0.4]
    }

    #[test]
    fn energies_match_functions_of_the_length() {
        let links = [
            (
                Link::bar(3.0, 0.5).unwrap(),
                (|l| 1.5 * 2.0 * ((l * l / 4.0 - 1.0) / 2.0f64).powi(2) / 2.0) as fn(f64) -> f64,
            ),
            (Link::spring(5.0, None).unwrap(), |l| 2.5 * (l - 2.0) * (l - 2.0)),
            (Link::spring(5.0, Some(0.7)).unwrap(), |l| 2.5 * (l - 0.7) * (l - 0.7)),
            (Link::attraction(7.0).unwrap(), |l| -7.0 / l),
        ];
        for (link, energy) in links {
            for l in [0.9, 1.7, 2.0, 2.6, 7.0] {
                let W = link.with_length(2.0);
                assert!((W.strain_energy(&strain(l)) - energy(l)).abs() < 1e-14 * (1.0 + energy(l).abs()));
                // dV/dl = S de/dl = S l/L^2, a central difference with an error of 1e-6^2.
                let slope = (energy(l + 1e-6) - energy(l - 1e-6)) / 2e-6;
                let S = W.stress(&strain(l))[0];
                assert!((S * l / 4.0 - slope).abs() < 1e-7 * (1.0 + slope.abs()), "{link:?} {l}");
                let (S, D) = W.stress_and_elasticity(&strain(l));
                let at = |e: f64| W.stress(&[e, 0.0, 0.0, 0.0, 0.0, 0.0])[0];
                let e = trace(&strain(l));
                let slope = (at(e + 1e-6) - at(e - 1e-6)) / 2e-6;
                assert!((D[0][1] - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{link:?} {l}");
                assert_eq!(S, W.stress(&strain(l)));
            }
        }
    }

    #[test]
    fn springs_keep_their_digits() {
        // l = L (1 + d): W = k/2 L^2 d^2 to all digits, with e = d + d^2/2.
        let spring = Link::spring(2.0, None).unwrap().with_length(3.0);
        for d in [1e-2, 1e-5, 1e-8] {
            let energy = spring.strain_energy(&[d + 0.5 * d * d, 0.0, 0.0, 0.0, 0.0, 0.0]);
            assert!((energy / (9.0 * d * d) - 1.0).abs() < 1e-15, "{d}");
        }
    }

    #[test]
    fn bad_parameters_are_rejected() {
        rejects("youngs_modulus", Link::bar(0.0, 1.0));
        rejects("area", Link::bar(1.0, -1.0));
        rejects("stiffness", Link::spring(f64::NAN, None));
        rejects("rest_length", Link::spring(1.0, Some(-1.0)));
        rejects("strength", Link::attraction(0.0));
        assert!(Link::spring(1.0, Some(0.0)).is_ok() && Link::attraction(-1.0).is_ok());
    }
}
