//! A number with its first and second derivative by the time.

/// Value, rate and second derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jet(pub(super) [f64; 3]);

impl Jet {
    pub(super) fn scaled(self, factor: f64) -> Jet {
        Jet(self.0.map(|x| factor * x))
    }

    pub(super) fn plus(self, other: Jet) -> Jet {
        Jet([0, 1, 2].map(|i| self.0[i] + other.0[i]))
    }

    /// Product, by the rule of Leibniz.
    pub(super) fn times(self, other: Jet) -> Jet {
        let (Jet([a, da, dda]), Jet([b, db, ddb])) = (self, other);
        Jet([a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb])
    }

    /// A function of the number, by the chain rule.
    pub(super) fn into_function(self, function: fn(f64) -> [f64; 3]) -> Jet {
        self.chain(function(self.0[0]))
    }

    /// A function of the number, from its value and derivatives there.
    pub(super) fn chain(self, [f, df, ddf]: [f64; 3]) -> Jet {
        let Jet([_, da, dda]) = self;
        // An unbounded derivative matters only if the argument changes.
        let product = |f: f64, a: f64| if a == 0.0 { 0.0 } else { f * a };
        Jet([f, product(df, da), product(ddf, da * da) + product(df, dda)])
    }

    /// A power with a fixed exponent.
    pub(super) fn power_of(self, exponent: f64) -> Jet {
        let a = self.0[0];
        // A factor of zero times an unbounded power of zero is zero: (a^1)'' = 0 at a = 0.
        let term = |factor: f64, n: f64| if factor == 0.0 { 0.0 } else { factor * a.powf(n) };
        let n = exponent;
        let n_1 = exponent - 1.0;
        self.chain([a.powf(n), term(n, n_1), term(n * n_1, n_1 - 1.0)])
    }

    /// A power; with a variable exponent it is `exp(b ln a)`.
    pub(super) fn power(self, exponent: Jet) -> Jet {
        let Jet([b, db, ddb]) = exponent;
        if db == 0.0 && ddb == 0.0 {
            return self.power_of(b);
        }
        let a = self.0[0];
        let logarithm = self.chain([a.ln(), 1.0 / a, -1.0 / (a * a)]);
        let product = logarithm.times(exponent);
        product.chain([product.0[0].exp(); 3])
    }
}
