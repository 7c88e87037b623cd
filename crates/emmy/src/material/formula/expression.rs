//! Expressions in the invariants of C, as trees.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// An invariant of the right Cauchy-Green tensor C, or its invariant with a fibre of the unit direction a.
///
/// ```
/// use emmy::material::Invariant;
/// assert_eq!(Invariant::ALL.map(Invariant::name).join(" "), "I1 I2 I3 J I1_bar I2_bar I4 I4_bar");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Invariant {
    /// `I1 = tr C`
    I1,
    /// `I2 = (I1^2 - tr C^2) / 2`
    I2,
    /// `I3 = det C`
    I3,
    /// `J = det F`
    J,
    /// `J^(-2/3) I1`
    I1Bar,
    /// `J^(-4/3) I2`
    I2Bar,
    /// `I4 = a . C a`, the square of the fibre's stretch
    I4,
    /// `J^(-2/3) I4`
    I4Bar,
}

impl Invariant {
    /// Every invariant.
    pub const ALL: [Invariant; 8] = [
        Invariant::I1,
        Invariant::I2,
        Invariant::I3,
        Invariant::J,
        Invariant::I1Bar,
        Invariant::I2Bar,
        Invariant::I4,
        Invariant::I4Bar,
    ];

    /// Its name in the text of a formula.
    pub const fn name(self) -> &'static str {
        match self {
            Invariant::I1 => "I1",
            Invariant::I2 => "I2",
            Invariant::I3 => "I3",
            Invariant::J => "J",
            Invariant::I1Bar => "I1_bar",
            Invariant::I2Bar => "I2_bar",
            Invariant::I4 => "I4",
            Invariant::I4Bar => "I4_bar",
        }
    }

    /// Whether it needs the direction of a fibre.
    pub const fn needs_fibre(self) -> bool {
        matches!(self, Invariant::I4 | Invariant::I4Bar)
    }

    /// Whether it is a function of the volume alone.
    pub(super) const fn is_volume(self) -> bool {
        matches!(self, Invariant::I3 | Invariant::J)
    }
}

/// A smooth function of invariants, made from numbers and [`Invariant`]s with operators and the functions below.
///
/// ```
/// use emmy::material::{Expression, Invariant};
/// let [i1, j] = [Invariant::I1, Invariant::J].map(Expression::from);
/// // mu/2 (I1 - 3) - mu ln J with mu = 500
/// let energy = 250.0 * (i1 - 3.0) - 500.0 * j.ln();
/// assert!(energy.has(Invariant::J) && !energy.has(Invariant::I2));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Expression(pub(super) Tree);

/// The tree of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Tree {
    Number(f64),
    Invariant(Invariant),
    Sum(Box<[Tree; 2]>),
    Product(Box<[Tree; 2]>),
    Power(Box<[Tree; 2]>),
    Function(Function, Box<Tree>),
}

/// A function of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Ln,
    Exp,
    Sinh,
    Cosh,
    Tanh,
}

impl Tree {
    /// Visits every invariant.
    fn any(&self, is: &impl Fn(Invariant) -> bool) -> bool {
        match self {
            Tree::Number(_) => false,
            Tree::Invariant(invariant) => is(*invariant),
            Tree::Sum(parts) | Tree::Product(parts) | Tree::Power(parts) => {
                parts.iter().any(|part| part.any(is))
            }
            Tree::Function(_, argument) => argument.any(is),
        }
    }

    /// Number of operations.
    pub(super) fn size(&self) -> usize {
        match self {
            Tree::Number(_) | Tree::Invariant(_) => 1,
            Tree::Sum(parts) | Tree::Product(parts) | Tree::Power(parts) => {
                1 + parts.iter().map(Tree::size).sum::<usize>()
            }
            Tree::Function(_, argument) => 1 + argument.size(),
        }
    }
}

impl Expression {
    /// Whether an invariant occurs in it.
    pub fn has(&self, invariant: Invariant) -> bool {
        self.0.any(&|own| own == invariant)
    }

    /// Whether it is a function of the volume alone, and not a constant.
    pub(super) fn is_of_volume(&self) -> bool {
        self.0.any(&|_| true) && !self.0.any(&|own| !own.is_volume())
    }

    /// Terms whose sum it is.
    pub(super) fn terms(&self) -> Vec<Expression> {
        fn add(tree: &Tree, factor: f64, terms: &mut Vec<Expression>) {
            match tree {
                Tree::Sum(parts) => parts.iter().for_each(|part| add(part, factor, terms)),
                Tree::Product(parts) => match &**parts {
                    [Tree::Number(number), other] | [other, Tree::Number(number)] => {
                        add(other, factor * number, terms);
                    }
                    _ => terms.push(Expression(tree.clone()) * factor),
                },
                _ => terms.push(Expression(tree.clone()) * factor),
            }
        }
        let mut terms = Vec::new();
        add(&self.0, 1.0, &mut terms);
        terms
    }

    fn function(self, function: Function) -> Self {
        Expression(Tree::Function(function, Box::new(self.0)))
    }

    /// Power with any exponent.
    #[must_use]
    pub fn power(self, exponent: impl Into<Expression>) -> Self {
        Expression(Tree::Power(Box::new([self.0, exponent.into().0])))
    }

    /// Square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.power(0.5)
    }

    /// Natural logarithm.
    #[must_use]
    pub fn ln(self) -> Self {
        self.function(Function::Ln)
    }

    /// Exponential.
    #[must_use]
    pub fn exp(self) -> Self {
        self.function(Function::Exp)
    }

    /// Hyperbolic sine.
    #[must_use]
    pub fn sinh(self) -> Self {
        self.function(Function::Sinh)
    }

    /// Hyperbolic cosine.
    #[must_use]
    pub fn cosh(self) -> Self {
        self.function(Function::Cosh)
    }

    /// Hyperbolic tangent.
    #[must_use]
    pub fn tanh(self) -> Self {
        self.function(Function::Tanh)
    }
}

impl From<f64> for Expression {
    fn from(number: f64) -> Self {
        Expression(Tree::Number(number))
    }
}

impl From<Invariant> for Expression {
    fn from(invariant: Invariant) -> Self {
        Expression(Tree::Invariant(invariant))
    }
}

impl Neg for Expression {
    type Output = Expression;
    fn neg(self) -> Expression {
        -1.0 * self
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $result:expr) => {
        impl $trait for Expression {
            type Output = Expression;
            fn $method(self, other: Expression) -> Expression {
                let ($a, $b) = (self, other);
                $result
            }
        }
        impl $trait<f64> for Expression {
            type Output = Expression;
            fn $method(self, other: f64) -> Expression {
                $trait::$method(self, Expression::from(other))
            }
        }
        impl $trait<Expression> for f64 {
            type Output = Expression;
            fn $method(self, other: Expression) -> Expression {
                $trait::$method(Expression::from(self), other)
            }
        }
    };
}

operator!(Add, add, |a, b| Expression(Tree::Sum(Box::new([a.0, b.0]))));
operator!(Sub, sub, |a, b| a + -b);
operator!(Mul, mul, |a, b| Expression(Tree::Product(Box::new([a.0, b.0]))));
operator!(Div, div, |a, b| match b.0 {
    // A constant factor, as in `mu/2 (I1 - 3)`.
    Tree::Number(number) if (1.0 / number).is_finite() => a * (1.0 / number),
    b => a * Expression(b).power(-1.0),
});
