//! From graphs to instructions, without cancellation at small strain.
//!
//! A node x with the value x_0 at rest is computed in one of three ways: as it is; as its change `x - x_0`, which is
//! small at small strain; or as its bend, the change without the part that is linear in z and f,
//!
//! ```math
//! x = x_0 + x_z z + x_f f + bend
//! ```
//!
//! No rule of a product, power or function cancels; a sum may, but the linear parts are gone from a bend. The same
//! holds for differences over a step ([`difference`]). The energy is the bend of its formula, because the linear part
//! vanishes with the stress at rest; the stress comes from changes of derivatives.

mod difference;

use std::collections::HashMap;

use super::graph::{DET, F, Graph, Id, Node, Number, Z};
use super::tape::{Instructions, Operand};

const ZERO: Operand = Operand::Constant(0.0);

/// How a node is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Way {
    Value,
    Change,
    Bend,
    /// The value at the end of a step less the value at its start.
    Difference,
    /// The bend at the end of a step less the bend at its start.
    BendDifference,
}

/// Instructions for the nodes of a graph.
#[derive(Debug)]
pub(super) struct Lowering<'a> {
    graph: &'a mut Graph,
    pub(super) instructions: Instructions,
    known: HashMap<(Id, Way), Operand>,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(graph: &'a mut Graph) -> Self {
        Lowering { graph, instructions: Instructions::default(), known: HashMap::new() }
    }

    /// x, with an absolute error of round-off at small strain.
    pub(super) fn value(&mut self, id: Id) -> Operand {
        self.lower(id, Way::Value)
    }

    /// x less its value at rest, with a relative error of round-off.
    pub(super) fn change(&mut self, id: Id) -> Operand {
        self.lower(id, Way::Change)
    }

    /// x less its value at rest and its linear part, with a relative error of round-off.
    pub(super) fn bend(&mut self, id: Id) -> Operand {
        self.lower(id, Way::Bend)
    }

    fn lower(&mut self, id: Id, way: Way) -> Operand {
        if let Some(known) = self.known.get(&(id, way)) {
            return *known;
        }
        if matches!(way, Way::Difference | Way::BendDifference) {
            let operand = self.lower_difference(id, way);
            self.known.insert((id, way), operand);
            return operand;
        }
        let operand = match self.graph.node(id).clone() {
            Node::Constant(number) if way == Way::Value => Operand::Constant(number.value()),
            Node::Constant(_) => ZERO,
            Node::Variable(Z | F) if way == Way::Bend => ZERO,
            Node::Variable(index) => self.instructions.input(index),
            Node::Sum(..) if way == Way::Value && self.graph.is_det(id) => self.instructions.input(DET),
            Node::Sum(constant, terms) => {
                let start = if way == Way::Value { constant.value() } else { 0.0 };
                self.sum(Operand::Constant(start), &terms, way)
            }
            Node::Product(a, b) => self.product(a, b, way),
            Node::Power(base, exponent) => self.power(id, base, exponent.value(), way),
            Node::Ln(argument) => self.ln(argument, way),
            Node::Exp(argument) => self.exp(argument, way),
        };
        self.known.insert((id, way), operand);
        operand
    }

    fn sum(&mut self, start: Operand, terms: &[(Id, Number)], way: Way) -> Operand {
        terms.iter().fold(start, |sum, (term, factor)| {
            let term = self.lower(*term, way);
            let scaled = self.instructions.scaled(term, factor.value());
            self.instructions.sum(sum, scaled)
        })
    }

    /// The value, with a relative error of round-off where it vanishes at rest.
    fn near(&mut self, id: Id) -> Operand {
        if self.graph.rest(id) == 0.0 { self.change(id) } else { self.value(id) }
    }

    /// `a_0 b' + b_0 a' + (a - a_0)(b - b_0)`; for changes the last two are one product.
    fn product(&mut self, a: Id, b: Id, way: Way) -> Operand {
        let [a_0, b_0] = [a, b].map(|id| self.graph.rest(id));
        match way {
            Way::Value => {
                let [a, b] = [a, b].map(|id| self.value(id));
                self.instructions.product(a, b)
            }
            Way::Change => {
                let b_value = self.near(b);
                let [a, b] = [a, b].map(|id| self.change(id));
                let product = self.instructions.product(a, b_value);
                let scaled = self.instructions.scaled(b, a_0);
                self.instructions.sum(product, scaled)
            }
            _ => {
                let [a_change, b_change] = [a, b].map(|id| self.change(id));
                let product = self.instructions.product(a_change, b_change);
                let a = self.scaled_bend(a, b_0);
                let b = self.scaled_bend(b, a_0);
                let sum = self.instructions.sum(product, a);
                self.instructions.sum(sum, b)
            }
        }
    }

    fn scaled_bend(&mut self, id: Id, factor: f64) -> Operand {
        if factor == 0.0 {
            return ZERO;
        }
        let bend = self.bend(id);
        self.instructions.scaled(bend, factor)
    }

    /// The change of a node by its value at rest.
    fn relative_change(&mut self, id: Id) -> Operand {
        let rest = self.graph.rest(id);
        let change = self.change(id);
        self.instructions.scaled(change, 1.0 / rest)
    }

    /// A power: whole and half exponents by products of squares, inverses and square roots.
    fn power(&mut self, id: Id, base: Id, n: f64, way: Way) -> Operand {
        match n {
            -1.0 => self.inverse(id, base, way),
            0.5 => self.root(id, base, way),
            2.0 => self.square(base, way),
            _ => match self.factors(base, n) {
                Some(equal) => self.lower(equal, way),
                None => self.general_power(id, base, n, way),
            },
        }
    }

    /// A node equal to a power, made of powers with simpler exponents; `None` if there is none.
    fn factors(&mut self, base: Id, n: f64) -> Option<Id> {
        let mut power = |base: Id, n: f64| match n {
            1.0 => base,
            _ => self.graph.intern(Node::Power(base, n.into())),
        };
        if (2.0 * n).fract() != 0.0 {
            return None;
        }
        if n.fract() != 0.0 {
            let (root, rest) = (power(base, 0.5), power(base, n - 0.5));
            return Some(self.graph.intern(Node::Product(rest, root)));
        }
        if n < 0.0 {
            let inverse = power(base, -1.0);
            return Some(power(inverse, -n));
        }
        if n % 2.0 == 0.0 {
            let half = power(base, n / 2.0);
            return Some(power(half, 2.0));
        }
        let rest = power(base, n - 1.0);
        Some(self.graph.intern(Node::Product(rest, base)))
    }

    fn square(&mut self, base: Id, way: Way) -> Operand {
        let rest = self.graph.rest(base);
        match way {
            Way::Value => {
                let x = self.near(base);
                self.instructions.product(x, x)
            }
            Way::Change => {
                let change = self.change(base);
                let value = self.near(base);
                let sum = self.instructions.sum(value, Operand::Constant(rest));
                self.instructions.product(change, sum)
            }
            _ => {
                let change = self.change(base);
                let bend = self.scaled_bend(base, 2.0 * rest);
                let square = self.instructions.product(change, change);
                self.instructions.sum(square, bend)
            }
        }
    }

    fn inverse(&mut self, id: Id, base: Id, way: Way) -> Operand {
        let rest = self.graph.rest(id);
        let value = self.value(base);
        let inverse = self.instructions.quotient(Operand::Constant(1.0), value);
        if way == Way::Value {
            return inverse;
        }
        // 1/x - 1/x_0 = -(x - x_0) / (x x_0)
        let change = self.change(base);
        let quotient = self.instructions.product(change, inverse);
        if way == Way::Change {
            return self.instructions.scaled(quotient, -rest);
        }
        // ... + (x - x_0) / x_0^2 = (x - x_0)^2 / (x x_0^2)
        let square = self.instructions.product(quotient, change);
        let square = self.instructions.scaled(square, rest * rest);
        let bend = self.scaled_bend(base, -rest * rest);
        self.instructions.sum(square, bend)
    }

    fn root(&mut self, id: Id, base: Id, way: Way) -> Operand {
        let rest = self.graph.rest(id);
        let value = self.value(base);
        let root = self.instructions.sqrt(value);
        if way == Way::Value {
            return root;
        }
        // s - s_0 = (x - x_0) / (s + s_0)
        let change = self.change(base);
        let sum = self.instructions.sum(root, Operand::Constant(rest));
        let own_change = self.instructions.quotient(change, sum);
        if way == Way::Change {
            return own_change;
        }
        // ... - (x - x_0) / (2 s_0) = -(s - s_0)^2 / (2 s_0)
        let square = self.instructions.product(own_change, own_change);
        let square = self.instructions.scaled(square, -0.5 / rest);
        let bend = self.scaled_bend(base, 0.5 / rest);
        self.instructions.sum(square, bend)
    }

    /// `x^n = x_0^n e^(n ln(1 + t))`, with `t = x/x_0 - 1`.
    fn general_power(&mut self, id: Id, base: Id, n: f64, way: Way) -> Operand {
        let rest = self.graph.rest(id);
        let t = self.relative_change(base);
        let ln = self.instructions.ln_1p(t);
        let ln = self.instructions.scaled(ln, n);
        let own = match way {
            Way::Value | Way::Change => self.instructions.exp_m1(ln),
            _ => {
                let minus_ln = self.instructions.minus_ln_1p(t);
                let minus_ln = self.instructions.scaled(minus_ln, -n);
                let exp = self.instructions.exp_m1_minus(ln);
                self.instructions.sum(exp, minus_ln)
            }
        };
        let own = self.instructions.scaled(own, rest);
        match way {
            Way::Value => self.instructions.sum(own, Operand::Constant(rest)),
            Way::Change => own,
            _ => {
                let base_rest = self.graph.rest(base);
                let bend = self.scaled_bend(base, rest * n / base_rest);
                self.instructions.sum(own, bend)
            }
        }
    }

    fn ln(&mut self, argument: Id, way: Way) -> Operand {
        let rest = self.graph.rest(argument);
        let t = self.relative_change(argument);
        if way == Way::Bend {
            let minus_ln = self.instructions.minus_ln_1p(t);
            let own = self.instructions.scaled(minus_ln, -1.0);
            let bend = self.scaled_bend(argument, 1.0 / rest);
            return self.instructions.sum(own, bend);
        }
        let change = self.instructions.ln_1p(t);
        let start = if way == Way::Value { rest.ln() } else { 0.0 };
        self.instructions.sum(change, Operand::Constant(start))
    }

    fn exp(&mut self, argument: Id, way: Way) -> Operand {
        let rest = self.graph.rest(argument).exp();
        let change = self.change(argument);
        if way == Way::Bend {
            let own = self.instructions.exp_m1_minus(change);
            let own = self.instructions.scaled(own, rest);
            let bend = self.scaled_bend(argument, rest);
            return self.instructions.sum(own, bend);
        }
        let own = self.instructions.exp_m1(change);
        let own = self.instructions.scaled(own, rest);
        let start = if way == Way::Value { rest } else { 0.0 };
        self.instructions.sum(own, Operand::Constant(start))
    }
}
