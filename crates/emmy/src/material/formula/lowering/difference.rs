//! Differences of a node between a start and an end, from the values at the start and the differences of the variables.
//!
//! The difference of a bend has the accuracy of the work along the step: terms that are linear in the strain at rest do
//! not occur in it. For the differences of functions, with `zeta = (x_2 - x_1) / x_1` and `t = x_1/x_0 - 1`,
//!
//! ```math
//! ln x_2 - ln x_1 = ln(1 + zeta),      [t - ln(1 + t)]_1^2 = t zeta + zeta - ln(1 + zeta)
//! e^y_2 - e^y_1 = e^y_1 (e^dy - 1),      [e^y - 1 - y]_1^2 = (e^y_1 - 1)(e^dy - 1) + e^dy - 1 - dy
//! ```

use super::super::graph::{DET, F, Id, Node, Z};
use super::super::tape::Operand;
use super::{Lowering, Way, ZERO};

impl Lowering<'_> {
    /// The difference of the bend.
    pub(in super::super) fn bend_difference(&mut self, id: Id) -> Operand {
        self.lower(id, Way::BendDifference)
    }

    fn difference(&mut self, id: Id) -> Operand {
        self.lower(id, Way::Difference)
    }

    fn scaled_bend_difference(&mut self, id: Id, factor: f64) -> Operand {
        if factor == 0.0 {
            return ZERO;
        }
        let difference = self.bend_difference(id);
        self.instructions.scaled(difference, factor)
    }

    pub(super) fn lower_difference(&mut self, id: Id, way: Way) -> Operand {
        let is_bend = way == Way::BendDifference;
        match self.graph.node(id).clone() {
            Node::Constant(_) => ZERO,
            Node::Variable(Z | F) if is_bend => ZERO,
            Node::Variable(index) => self.instructions.input(DET + 1 + index),
            Node::Sum(_, terms) => self.sum(ZERO, &terms, way),
            Node::Product(a, b) => self.difference_of_product(a, b, is_bend),
            Node::Power(base, exponent) => match exponent.value() {
                -1.0 => self.difference_of_inverse(id, base, is_bend),
                0.5 => self.difference_of_root(id, base, is_bend),
                2.0 => self.difference_of_square(base, is_bend),
                n => match self.factors(base, n) {
                    Some(equal) => self.lower(equal, way),
                    None => self.difference_of_power(id, base, n, is_bend),
                },
            },
            Node::Ln(argument) => self.difference_of_ln(argument, is_bend),
            Node::Exp(argument) => self.difference_of_exp(argument, is_bend),
        }
    }

    /// `(x_2 - x_1) y_1 + x_2 (y_2 - y_1)`, where x and y stand for values or changes.
    fn of_product(&mut self, [x, dx]: [Operand; 2], [y, dy]: [Operand; 2]) -> Operand {
        let end = self.instructions.sum(x, dx);
        let first = self.instructions.product(dx, y);
        let second = self.instructions.product(end, dy);
        self.instructions.sum(first, second)
    }

    /// `x_2^2 - x_1^2 = (x_2 - x_1)(2 x_1 + x_2 - x_1)`
    fn of_square(&mut self, x: Operand, dx: Operand) -> Operand {
        let double = self.instructions.scaled(x, 2.0);
        let sum = self.instructions.sum(double, dx);
        self.instructions.product(dx, sum)
    }

    fn difference_of_product(&mut self, a: Id, b: Id, is_bend: bool) -> Operand {
        let [a_0, b_0] = [a, b].map(|id| self.graph.rest(id));
        let [da, db] = [a, b].map(|id| self.difference(id));
        if !is_bend {
            let [a, b] = [a, b].map(|id| self.near(id));
            return self.of_product([a, da], [b, db]);
        }
        let changes = [a, b].map(|id| self.change(id));
        let product = self.of_product([changes[0], da], [changes[1], db]);
        let (a, b) = (self.scaled_bend_difference(a, b_0), self.scaled_bend_difference(b, a_0));
        let sum = self.instructions.sum(product, a);
        self.instructions.sum(sum, b)
    }

    fn difference_of_square(&mut self, base: Id, is_bend: bool) -> Operand {
        let difference = self.difference(base);
        if !is_bend {
            let x = self.near(base);
            return self.of_square(x, difference);
        }
        let change = self.change(base);
        let square = self.of_square(change, difference);
        let bend = self.scaled_bend_difference(base, 2.0 * self.graph.rest(base));
        self.instructions.sum(square, bend)
    }

    /// `1/x_2 - 1/x_1 = -(x_2 - x_1)/(x_1 x_2)`; the bend is `c^2 / (x x_0^2)` with the change c of x.
    fn difference_of_inverse(&mut self, id: Id, base: Id, is_bend: bool) -> Operand {
        let rest = self.graph.rest(id);
        let (value, difference) = (self.value(base), self.difference(base));
        let inverse = self.instructions.quotient(Operand::Constant(1.0), value);
        if !is_bend {
            let end = self.instructions.sum(value, difference);
            let quotient = self.instructions.quotient(difference, end);
            let product = self.instructions.product(quotient, inverse);
            return self.instructions.scaled(product, -1.0);
        }
        let (change, own) = (self.change(base), self.difference(id));
        let quotient = self.instructions.product(change, inverse);
        let of_quotient = self.of_product([change, difference], [inverse, own]);
        let square = self.of_product([change, difference], [quotient, of_quotient]);
        let square = self.instructions.scaled(square, rest * rest);
        let bend = self.scaled_bend_difference(base, -rest * rest);
        self.instructions.sum(square, bend)
    }

    fn difference_of_root(&mut self, id: Id, base: Id, is_bend: bool) -> Operand {
        let rest = self.graph.rest(id);
        if !is_bend {
            let (value, difference) = (self.value(base), self.difference(base));
            let end = self.instructions.sum(value, difference);
            let [start, end] = [value, end].map(|x| self.instructions.sqrt(x));
            let sum = self.instructions.sum(start, end);
            return self.instructions.quotient(difference, sum);
        }
        let (change, own) = (self.change(id), self.difference(id));
        let square = self.of_square(change, own);
        let square = self.instructions.scaled(square, -0.5 / rest);
        let bend = self.scaled_bend_difference(base, 0.5 / rest);
        self.instructions.sum(square, bend)
    }

    /// zeta.
    fn relative_difference(&mut self, id: Id) -> Operand {
        let (difference, value) = (self.difference(id), self.value(id));
        self.instructions.quotient(difference, value)
    }

    /// The difference of `t - ln(1 + t)`.
    fn of_minus_ln(&mut self, id: Id) -> Operand {
        let (t, zeta) = (self.relative_change(id), self.relative_difference(id));
        let product = self.instructions.product(t, zeta);
        let minus_ln = self.instructions.minus_ln_1p(zeta);
        self.instructions.sum(product, minus_ln)
    }

    /// The difference of `e^y - 1 - y`.
    fn of_exp_minus(&mut self, y: Operand, dy: Operand) -> Operand {
        let factors = [y, dy].map(|y| self.instructions.exp_m1(y));
        let product = self.instructions.product(factors[0], factors[1]);
        let exp = self.instructions.exp_m1_minus(dy);
        self.instructions.sum(product, exp)
    }

    fn difference_of_power(&mut self, id: Id, base: Id, n: f64, is_bend: bool) -> Operand {
        let zeta = self.relative_difference(base);
        let ln = self.instructions.ln_1p(zeta);
        let ln = self.instructions.scaled(ln, n);
        if !is_bend {
            let (value, exp) = (self.value(id), self.instructions.exp_m1(ln));
            return self.instructions.product(value, exp);
        }
        let [rest, base_rest] = [id, base].map(|id| self.graph.rest(id));
        let t = self.relative_change(base);
        let start = self.instructions.ln_1p(t);
        let start = self.instructions.scaled(start, n);
        let exp = self.of_exp_minus(start, ln);
        let minus_ln = self.of_minus_ln(base);
        let minus_ln = self.instructions.scaled(minus_ln, -n);
        let own = self.instructions.sum(exp, minus_ln);
        let own = self.instructions.scaled(own, rest);
        let bend = self.scaled_bend_difference(base, rest * n / base_rest);
        self.instructions.sum(own, bend)
    }

    fn difference_of_ln(&mut self, argument: Id, is_bend: bool) -> Operand {
        if !is_bend {
            let zeta = self.relative_difference(argument);
            return self.instructions.ln_1p(zeta);
        }
        let minus_ln = self.of_minus_ln(argument);
        let own = self.instructions.scaled(minus_ln, -1.0);
        let bend = self.scaled_bend_difference(argument, 1.0 / self.graph.rest(argument));
        self.instructions.sum(own, bend)
    }

    fn difference_of_exp(&mut self, argument: Id, is_bend: bool) -> Operand {
        let rest = self.graph.rest(argument).exp();
        let (change, difference) = (self.change(argument), self.difference(argument));
        if !is_bend {
            let start = self.instructions.exp_m1(change);
            let start = self.instructions.sum(start, Operand::Constant(1.0));
            let exp = self.instructions.exp_m1(difference);
            let product = self.instructions.product(start, exp);
            return self.instructions.scaled(product, rest);
        }
        let own = self.of_exp_minus(change, difference);
        let own = self.instructions.scaled(own, rest);
        let bend = self.scaled_bend_difference(argument, rest);
        self.instructions.sum(own, bend)
    }
}
