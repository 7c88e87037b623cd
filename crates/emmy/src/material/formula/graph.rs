//! Energies as graphs over four variables that vanish at rest, in which equal parts are one node, and their
//! derivatives.
//!
//! With `A = C - I` and the fibre a, the variables are
//!
//! ```math
//! z = det C - 1,      w = II_A + det A,      u = II_A + 2 det A,      f = a . A a
//! ```
//!
//! so that `I1 = 3 + z - w`, `I2 = 3 + 2 z - u`, `I3 = 1 + z`, `I4 = 1 + f`. At small strain z and f are of first
//! order, w and u of second: linear terms of an energy that is stress-free at rest then cancel symbolically.

mod reading;

use std::collections::HashMap;

/// Number of variables.
pub(super) const VARIABLES: usize = 4;

/// z.
pub(super) const Z: usize = 0;
/// w.
pub(super) const W: usize = 1;
/// u.
pub(super) const U: usize = 2;
/// f.
pub(super) const F: usize = 3;

/// `det C = 1 + z`, which a tape has beside the variables: under compression the sum would cancel.
pub(super) const DET: usize = 4;
/// Number of inputs of a tape; that of an energy change has the differences of the variables after them.
pub(super) const INPUTS: usize = 5;

/// A node, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Id(usize);

/// A finite or infinite number that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Number(u64);

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        // -0 is 0.
        Number((value + 0.0).to_bits())
    }
}

impl Number {
    pub(super) fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// An operation on nodes.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Node {
    Constant(Number),
    Variable(usize),
    /// A constant and multiples of other nodes, in the order of their numbers.
    Sum(Number, Vec<(Id, Number)>),
    Product(Id, Id),
    Power(Id, Number),
    Ln(Id),
    Exp(Id),
}

/// All nodes; the parts of a node come before it.
#[derive(Debug, Default)]
pub(super) struct Graph {
    nodes: Vec<Node>,
    /// Values at rest, where all variables are zero.
    rest: Vec<f64>,
    ids: HashMap<Node, Id>,
    derivatives: HashMap<(Id, usize), Id>,
}

/// Whether twice an exponent is a whole number, so that the power is one of roots and products.
fn is_half(exponent: f64) -> bool {
    (2.0 * exponent).fract() == 0.0
}

impl Graph {
    pub(super) fn node(&self, id: Id) -> &Node {
        &self.nodes[id.0]
    }

    /// Value at rest.
    pub(super) fn rest(&self, id: Id) -> f64 {
        self.rest[id.0]
    }

    /// Whether it is exactly zero everywhere.
    pub(super) fn is_zero(&self, id: Id) -> bool {
        self.constant_of(id) == Some(0.0)
    }

    /// Every node.
    pub(super) fn nodes(&self) -> impl Iterator<Item = &Node> {
        self.nodes.iter()
    }

    /// The node of an operation, without simplification.
    pub(super) fn intern(&mut self, node: Node) -> Id {
        if let Some(id) = self.ids.get(&node) {
            return *id;
        }
        let rest = self.evaluate(&node, &self.rest, &[0.0; VARIABLES]);
        let id = Id(self.nodes.len());
        self.nodes.push(node.clone());
        self.rest.push(rest);
        self.ids.insert(node, id);
        id
    }

    fn evaluate(&self, node: &Node, values: &[f64], variables: &[f64; VARIABLES]) -> f64 {
        match node {
            Node::Constant(number) => number.value(),
            Node::Variable(index) => variables[*index],
            Node::Sum(constant, terms) => {
                terms.iter().fold(constant.value(), |sum, (id, factor)| sum + factor.value() * values[id.0])
            }
            Node::Product(a, b) => values[a.0] * values[b.0],
            Node::Power(a, n) => values[a.0].powf(n.value()),
            Node::Ln(a) => values[a.0].ln(),
            Node::Exp(a) => values[a.0].exp(),
        }
    }

    /// Value where the variables have the given ones.
    pub(super) fn value_at(&self, id: Id, variables: &[f64; VARIABLES]) -> f64 {
        let mut values = Vec::with_capacity(id.0 + 1);
        for node in &self.nodes[..=id.0] {
            let value = self.evaluate(node, &values, variables);
            values.push(value);
        }
        values[id.0]
    }

    fn constant_of(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(number) => Some(number.value()),
            _ => None,
        }
    }

    pub(super) fn constant(&mut self, value: f64) -> Id {
        self.intern(Node::Constant(value.into()))
    }

    fn variable(&mut self, index: usize) -> Id {
        self.intern(Node::Variable(index))
    }

    /// `constant + sum_i factor_i term_i`.
    pub(super) fn sum(&mut self, constant: f64, parts: &[(Id, f64)]) -> Id {
        let mut total = constant;
        let mut terms: Vec<(Id, f64)> = Vec::new();
        for &(id, factor) in parts {
            match self.node(id) {
                Node::Constant(number) => total += factor * number.value(),
                Node::Sum(own, inner) => {
                    total += factor * own.value();
                    terms.extend(inner.iter().map(|(id, inner)| (*id, factor * inner.value())));
                }
                _ => terms.push((id, factor)),
            }
        }
        terms.sort_by_key(|(id, _)| *id);
        let mut merged: Vec<(Id, f64)> = Vec::new();
        for (id, factor) in terms {
            match merged.last_mut().filter(|(last, _)| *last == id) {
                Some((_, sum)) => *sum += factor,
                None => merged.push((id, factor)),
            }
        }
        merged.retain(|(_, factor)| *factor != 0.0);
        match merged[..] {
            [] => self.constant(total),
            [(id, 1.0)] if total == 0.0 => id,
            _ => {
                let terms = merged.into_iter().map(|(id, factor)| (id, factor.into())).collect();
                self.intern(Node::Sum(total.into(), terms))
            }
        }
    }

    /// A factor and the rest of a node that is a multiple of another one.
    fn factored(&self, id: Id) -> (f64, Id) {
        match self.node(id) {
            Node::Sum(constant, terms) if constant.value() == 0.0 && terms.len() == 1 => {
                (terms[0].1.value(), terms[0].0)
            }
            _ => (1.0, id),
        }
    }

    fn base_and_exponent(&self, id: Id) -> (Id, f64) {
        match self.node(id) {
            Node::Power(base, exponent) => (*base, exponent.value()),
            _ => (id, 1.0),
        }
    }

    pub(super) fn product(&mut self, a: Id, b: Id) -> Id {
        let ((k, a), (l, b)) = (self.factored(a), self.factored(b));
        let factor = k * l;
        let inner = match (self.constant_of(a), self.constant_of(b)) {
            (Some(a), _) => return self.sum(0.0, &[(b, factor * a)]),
            (_, Some(b)) => return self.sum(0.0, &[(a, factor * b)]),
            _ => {
                let ((base, m), (other, n)) = (self.base_and_exponent(a), self.base_and_exponent(b));
                // Other exponents cost a logarithm each, and are kept apart.
                if base == other && is_half(m) && is_half(n) {
                    self.power(base, m + n)
                } else {
                    self.intern(Node::Product(a.min(b), a.max(b)))
                }
            }
        };
        self.sum(0.0, &[(inner, factor)])
    }

    /// Whether it is det C, which is positive.
    pub(super) fn is_det(&self, id: Id) -> bool {
        match self.node(id) {
            Node::Sum(constant, terms) if constant.value() == 1.0 => match terms[..] {
                [(z, factor)] => factor.value() == 1.0 && *self.node(z) == Node::Variable(Z),
                _ => false,
            },
            _ => false,
        }
    }

    pub(super) fn power(&mut self, base: Id, exponent: f64) -> Id {
        let (factor, inner) = self.factored(base);
        let is_whole = exponent.fract() == 0.0;
        if exponent == 0.0 {
            return self.constant(1.0);
        }
        if exponent == 1.0 {
            return base;
        }
        if factor != 1.0 && (factor > 0.0 || is_whole) {
            let power = self.power(inner, exponent);
            return self.sum(0.0, &[(power, factor.powf(exponent))]);
        }
        match *self.node(base) {
            Node::Constant(number) => self.constant(number.value().powf(exponent)),
            Node::Exp(argument) => {
                let argument = self.sum(0.0, &[(argument, exponent)]);
                self.exp(argument)
            }
            Node::Power(inner, own) if is_whole || self.is_det(inner) => {
                self.power(inner, own.value() * exponent)
            }
            _ => self.intern(Node::Power(base, exponent.into())),
        }
    }

    pub(super) fn ln(&mut self, argument: Id) -> Id {
        let (factor, inner) = self.factored(argument);
        if factor != 1.0 && factor > 0.0 {
            let ln = self.ln(inner);
            return self.sum(factor.ln(), &[(ln, 1.0)]);
        }
        match *self.node(argument) {
            Node::Constant(number) => self.constant(number.value().ln()),
            Node::Exp(inner) => inner,
            Node::Power(base, exponent) if self.is_det(base) => {
                let ln = self.ln(base);
                self.sum(0.0, &[(ln, exponent.value())])
            }
            _ => self.intern(Node::Ln(argument)),
        }
    }

    pub(super) fn exp(&mut self, argument: Id) -> Id {
        let (factor, inner) = self.factored(argument);
        match *self.node(inner) {
            Node::Constant(number) => self.constant(number.value().exp()),
            Node::Ln(base) => self.power(base, factor),
            _ => self.intern(Node::Exp(argument)),
        }
    }

    /// Partial derivative by a variable.
    pub(super) fn derivative(&mut self, id: Id, variable: usize) -> Id {
        if let Some(known) = self.derivatives.get(&(id, variable)) {
            return *known;
        }
        let result = match self.node(id).clone() {
            Node::Constant(_) => self.constant(0.0),
            Node::Variable(index) => self.constant(if index == variable { 1.0 } else { 0.0 }),
            Node::Sum(_, terms) => {
                let parts: Vec<(Id, f64)> = terms
                    .iter()
                    .map(|(id, factor)| (self.derivative(*id, variable), factor.value()))
                    .collect();
                self.sum(0.0, &parts)
            }
            Node::Product(a, b) => {
                let (da, db) = (self.derivative(a, variable), self.derivative(b, variable));
                let parts = [(self.product(da, b), 1.0), (self.product(a, db), 1.0)];
                self.sum(0.0, &parts)
            }
            Node::Power(base, exponent) => {
                let n = exponent.value();
                let inner = self.derivative(base, variable);
                let power = if is_half(n) {
                    self.power(base, n - 1.0)
                } else {
                    // Shares the logarithm and the exponential of the power.
                    let inverse = self.power(base, -1.0);
                    self.product(id, inverse)
                };
                let product = self.product(power, inner);
                self.sum(0.0, &[(product, n)])
            }
            Node::Ln(argument) => {
                let (inverse, inner) = (self.power(argument, -1.0), self.derivative(argument, variable));
                self.product(inverse, inner)
            }
            Node::Exp(argument) => {
                let inner = self.derivative(argument, variable);
                self.product(id, inner)
            }
        };
        self.derivatives.insert((id, variable), result);
        result
    }
}
