//! Nodes of expressions.

use super::super::expression::{Function, Invariant, Tree};
use super::{F, Graph, Id, U, W, Z};

impl Graph {
    fn invariant(&mut self, invariant: Invariant) -> Id {
        let det_power = |graph: &mut Graph, exponent: f64| {
            let z = graph.variable(Z);
            let det = graph.sum(1.0, &[(z, 1.0)]);
            graph.power(det, exponent)
        };
        let isochoric = |graph: &mut Graph, invariant: Invariant, exponent: f64| {
            let (value, scale) = (graph.invariant(invariant), det_power(graph, exponent));
            graph.product(value, scale)
        };
        match invariant {
            Invariant::I1 => {
                let parts = [(self.variable(Z), 1.0), (self.variable(W), -1.0)];
                self.sum(3.0, &parts)
            }
            Invariant::I2 => {
                let parts = [(self.variable(Z), 2.0), (self.variable(U), -1.0)];
                self.sum(3.0, &parts)
            }
            Invariant::I3 => det_power(self, 1.0),
            Invariant::J => det_power(self, 0.5),
            Invariant::I4 => {
                let f = self.variable(F);
                self.sum(1.0, &[(f, 1.0)])
            }
            Invariant::I1Bar => isochoric(self, Invariant::I1, -1.0 / 3.0),
            Invariant::I2Bar => isochoric(self, Invariant::I2, -2.0 / 3.0),
            Invariant::I4Bar => isochoric(self, Invariant::I4, -1.0 / 3.0),
        }
    }

    /// The node of an expression.
    pub(in super::super) fn read(&mut self, tree: &Tree) -> Id {
        match tree {
            Tree::Number(value) => self.constant(*value),
            Tree::Invariant(invariant) => self.invariant(*invariant),
            Tree::Sum(parts) => {
                let [a, b] = parts.each_ref().map(|part| self.read(part));
                self.sum(0.0, &[(a, 1.0), (b, 1.0)])
            }
            Tree::Product(parts) => {
                let [a, b] = parts.each_ref().map(|part| self.read(part));
                self.product(a, b)
            }
            Tree::Power(parts) => {
                let [base, exponent] = parts.each_ref().map(|part| self.read(part));
                if let Some(exponent) = self.constant_of(exponent) {
                    return self.power(base, exponent);
                }
                let ln = self.ln(base);
                let product = self.product(exponent, ln);
                self.exp(product)
            }
            Tree::Function(function, argument) => {
                let argument = self.read(argument);
                self.function(*function, argument)
            }
        }
    }

    fn function(&mut self, function: Function, argument: Id) -> Id {
        let exp = |graph: &mut Graph, factor: f64| {
            let argument = graph.sum(0.0, &[(argument, factor)]);
            graph.exp(argument)
        };
        match function {
            Function::Ln => self.ln(argument),
            Function::Exp => self.exp(argument),
            Function::Sinh | Function::Cosh => {
                let sign = if function == Function::Cosh { 0.5 } else { -0.5 };
                let parts = [(exp(self, 1.0), 0.5), (exp(self, -1.0), sign)];
                self.sum(0.0, &parts)
            }
            // 2 / (1 + e^-2x) - 1
            Function::Tanh => {
                let exp = exp(self, -2.0);
                let denominator = self.sum(1.0, &[(exp, 1.0)]);
                let quotient = self.power(denominator, -1.0);
                self.sum(-1.0, &[(quotient, 2.0)])
            }
        }
    }
}
