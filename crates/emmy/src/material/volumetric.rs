//! Volumetric laws: the energy of a change of volume, for materials with a separate volumetric part.

#![allow(non_snake_case)]

use super::{VolumeLaw, VolumeMeasure, positive};
use crate::error::Result;
use crate::tensor::{Lane, exp_m1_minus, inlined};

/// The law by which a material resists a change of volume, with the bulk modulus K.
///
/// | law | W_vol(J) | source |
/// |---|---|---|
/// | `logarithmic` | K/2 (ln J)^2 | Simo, Taylor and Pister (1985), Comput. Methods Appl. Mech. Eng. 51 |
/// | `quadratic` | K/2 (J - 1)^2 | Sussman and Bathe (1987), Comput. Struct. 26 |
/// | `simo-taylor` | K/4 (J^2 - 1 - 2 ln J) | Simo and Taylor (1991), Comput. Methods Appl. Mech. Eng. 85 |
/// | `miehe` | K (J - ln J - 1) | Miehe (1994), Int. J. Numer. Methods Eng. 37 |
/// | `liu` | K (J ln J - J + 1) | Liu, Hofstetter and Mang (1994), Eng. Comput. 11 |
///
/// All have the bulk modulus K at small strain. Hartmann and Neff (2003), Int. J. Solids Struct. 40, compare them:
/// `simo-taylor` (the default) and `miehe` grow without bound under compression and tension and are convex in J;
/// `logarithmic` is not convex beyond J = e; `quadratic` and `liu` let a body be crushed to nothing by finite work.
///
/// ```
/// use emmy::material::Volumetric;
/// assert_eq!("miehe".parse::<Volumetric>(), Ok(Volumetric::Miehe));
/// assert_eq!(Volumetric::default().name(), "simo-taylor");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Volumetric {
    /// K/2 (ln J)^2
    Logarithmic,
    /// K/2 (J - 1)^2
    Quadratic,
    /// K/4 (J^2 - 1 - 2 ln J)
    #[default]
    SimoTaylor,
    /// K (J - ln J - 1)
    Miehe,
    /// K (J ln J - J + 1)
    Liu,
}

impl Volumetric {
    /// Every law.
    pub const ALL: [Volumetric; 5] = [
        Volumetric::Logarithmic,
        Volumetric::Quadratic,
        Volumetric::SimoTaylor,
        Volumetric::Miehe,
        Volumetric::Liu,
    ];

    /// Key word.
    pub const fn name(self) -> &'static str {
        match self {
            Volumetric::Logarithmic => "logarithmic",
            Volumetric::Quadratic => "quadratic",
            Volumetric::SimoTaylor => "simo-taylor",
            Volumetric::Miehe => "miehe",
            Volumetric::Liu => "liu",
        }
    }
}

impl std::str::FromStr for Volumetric {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let names = || Volumetric::ALL.map(Volumetric::name).join(", ");
        let law = Volumetric::ALL.into_iter().find(|law| law.name() == word);
        law.ok_or_else(|| format!("\"{word}\" is not a volumetric law; there is {}", names()))
    }
}

/// A volumetric law with its bulk modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Volume {
    law: Volumetric,
    bulk_modulus: f64,
}

impl Volume {
    pub(super) fn new(material: &'static str, bulk_modulus: f64, law: Volumetric) -> Result<Self> {
        positive(material, "bulk_modulus", bulk_modulus)?;
        Ok(Volume { law, bulk_modulus })
    }

    /// The volume with a part of the bulk modulus, and the law with the rest; `None` if there is no rest.
    pub(super) fn split(&self, kept: f64) -> Option<(Volume, VolumeLaw)> {
        let rest = VolumeLaw::new(VolumeMeasure::Ratio, self.law, self.bulk_modulus - kept)?;
        Some((Volume { law: self.law, bulk_modulus: kept }, rest))
    }

    /// Whether there is no energy, as at the points of a cell with a projected volume.
    #[inline(always)]
    pub(super) fn is_zero(&self) -> bool {
        self.bulk_modulus == 0.0
    }

    /// W_vol at ln J.
    #[inline(always)]
    pub(super) fn energy<L: Lane>(&self, ln_J: L) -> L {
        let one = ln_J.splat(1.0);
        match self.law {
            Volumetric::Logarithmic => ln_J * ln_J * (0.5 * self.bulk_modulus),
            Volumetric::Quadratic => {
                let e = ln_J.exp_m1();
                e * e * (0.5 * self.bulk_modulus)
            }
            Volumetric::SimoTaylor => exp_m1_minus(ln_J * 2.0) * (0.25 * self.bulk_modulus),
            Volumetric::Miehe => exp_m1_minus(ln_J) * self.bulk_modulus,
            // J ln J - J + 1 = J (e^-ln J - 1 + ln J)
            Volumetric::Liu => (one + ln_J.exp_m1()) * exp_m1_minus(-ln_J) * self.bulk_modulus,
        }
    }

    /// W_vol at `ln J + change` less that at ln J, without cancellation.
    #[inline(always)]
    pub(super) fn energy_change<L: Lane>(&self, ln_J: L, change: L) -> L {
        // e^2(l + d) - e^2l - 2 d = (e^2l - 1) (e^2d - 1) + (e^2d - 1 - 2 d)
        let grown = inlined!(|l: L, d: L| l.exp_m1() * d.exp_m1() + exp_m1_minus(d));
        let over_bulk_modulus = match self.law {
            Volumetric::Logarithmic => change * (ln_J * 2.0 + change) * 0.5,
            Volumetric::Quadratic => {
                let e = ln_J.exp_m1();
                let rise = (e + e.splat(1.0)) * change.exp_m1();
                rise * (e * 2.0 + rise) * 0.5
            }
            Volumetric::SimoTaylor => grown(ln_J * 2.0, change * 2.0) * 0.25,
            Volumetric::Miehe => grown(ln_J, change),
            Volumetric::Liu => {
                let rise = change.exp_m1();
                let bent = change * rise - exp_m1_minus(change);
                (ln_J.exp_m1() + ln_J.splat(1.0)) * (ln_J * rise + bent)
            }
        };
        over_bulk_modulus * self.bulk_modulus
    }

    /// Kirchhoff pressure dW_vol/d(ln J) at ln J.
    #[inline(always)]
    pub(super) fn pressure<L: Lane>(&self, ln_J: L) -> L {
        let one = ln_J.splat(1.0);
        let over_bulk_modulus = match self.law {
            Volumetric::Logarithmic => ln_J,
            Volumetric::Quadratic => {
                let e = ln_J.exp_m1();
                e * (one + e)
            }
            Volumetric::SimoTaylor => (ln_J * 2.0).exp_m1() * 0.5,
            Volumetric::Miehe => ln_J.exp_m1(),
            Volumetric::Liu => ln_J * (one + ln_J.exp_m1()),
        };
        over_bulk_modulus * self.bulk_modulus
    }

    /// d^2W_vol/d(ln J)^2 at ln J.
    #[inline(always)]
    pub(super) fn stiffness<L: Lane>(&self, ln_J: L) -> L {
        let one = ln_J.splat(1.0);
        let J = one + ln_J.exp_m1();
        let over_bulk_modulus = match self.law {
            Volumetric::Logarithmic => one,
            Volumetric::Quadratic => J * (J * 2.0 - one),
            Volumetric::SimoTaylor => J * J,
            Volumetric::Miehe => J,
            Volumetric::Liu => J * (one + ln_J),
        };
        over_bulk_modulus * self.bulk_modulus
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::conformance::{Big, big};
    use super::super::tests::rejects;
    use super::*;

    /// W_vol in its textbook form.
    pub(crate) fn energy(law: Volumetric, bulk_modulus: f64, det_C: &Big) -> Big {
        let K = big(bulk_modulus);
        let one = big(1.0);
        let ln_J = det_C.ln() / big(2.0);
        let J = || ln_J.clone().exp();
        match law {
            Volumetric::Logarithmic => K / big(2.0) * &ln_J * &ln_J,
            Volumetric::Quadratic => K / big(2.0) * (J() - &one) * (J() - &one),
            Volumetric::SimoTaylor => K / big(4.0) * (det_C - one - big(2.0) * ln_J),
            Volumetric::Miehe => K * (J() - ln_J - one),
            Volumetric::Liu => K * (J() * (&ln_J - &one) + one),
        }
    }

    #[test]
    fn laws_have_their_energies_and_derivatives() {
        use num_dual::Dual64;
        for law in Volumetric::ALL {
            let volume = Volume::new("m", 3.0, law).unwrap();
            for x in [-2.0, -0.7, -0.1, -1e-4, -1e-9, 1e-9, 1e-4, 0.1, 0.3, 0.5, 1.0, 1.7] {
                let exact = energy(law, 3.0, &(big(2.0 * x)).exp());
                let error = (big(volume.energy(x)) - &exact) / &exact;
                assert!(error.to_f64().value().abs() < 2e-15, "{law:?} at {x}");
                let dual = Dual64::new(x, 1.0);
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs();
                for change in [0.1 * x, -1e-7 * x, 1e-12] {
                    let end = energy(law, 3.0, &((big(x) + big(change)) * big(2.0)).exp());
                    let error = (big(volume.energy_change(x, change)) - (end - &exact)).to_f64().value();
                    let scale = volume.pressure(x).abs() + volume.stiffness(x).abs() * change.abs();
                    assert!(error.abs() < 4e-15 * scale * change.abs(), "{law:?} from {x} by {change}");
                }
                assert!(close(volume.energy(dual).eps, volume.pressure(x)), "{law:?} at {x}");
                assert!(close(volume.pressure(dual).eps, volume.stiffness(x)), "{law:?} at {x}");
            }
        }
    }

    #[test]
    fn names_are_read_back_and_bad_moduli_rejected() {
        assert!(Volumetric::ALL.iter().all(|law| law.name().parse() == Ok(*law)));
        assert!("simo".parse::<Volumetric>().unwrap_err().contains("simo-taylor"));
        rejects("bulk_modulus", Volume::new("m", 0.0, Volumetric::Miehe));
    }
}
