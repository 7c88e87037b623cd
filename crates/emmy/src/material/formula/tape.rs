//! Tapes: lists of instructions on registers, run at the points of a lane type.

use std::collections::HashMap;

use super::graph::Number;
use crate::tensor::{Lane, exp_m1_minus};

/// Number of registers of a short tape, which most energies have, and of the longest one.
const SHORT: usize = 16;
const LONG: usize = 128;

/// An instruction's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Index(usize);

/// A number, or the result of an instruction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operand {
    Constant(f64),
    Result(Index),
}

/// An instruction on registers or, while a tape is made, on the results of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Instruction<R> {
    Input(usize),
    /// x k
    Scale(R, Number),
    /// x + k
    Offset(R, Number),
    Add(R, R),
    Subtract(R, R),
    Multiply(R, R),
    Divide(R, R),
    /// x y + z
    MultiplyAdd(R, R, R),
    /// x k + y
    ScaleAdd(R, Number, R),
    /// k / x
    Over(Number, R),
    Sqrt(R),
    Ln1p(R),
    /// x - ln(1 + x)
    MinusLn1p(R),
    ExpM1(R),
    /// e^x - 1 - x
    ExpM1Minus(R),
}

impl<R: Copy> Instruction<R> {
    fn map<T>(self, mut to: impl FnMut(R) -> T) -> Instruction<T> {
        use Instruction as I;
        match self {
            I::Input(index) => I::Input(index),
            I::Scale(x, k) => I::Scale(to(x), k),
            I::Offset(x, k) => I::Offset(to(x), k),
            I::Add(x, y) => I::Add(to(x), to(y)),
            I::Subtract(x, y) => I::Subtract(to(x), to(y)),
            I::Multiply(x, y) => I::Multiply(to(x), to(y)),
            I::Divide(x, y) => I::Divide(to(x), to(y)),
            I::MultiplyAdd(x, y, z) => I::MultiplyAdd(to(x), to(y), to(z)),
            I::ScaleAdd(x, k, y) => I::ScaleAdd(to(x), k, to(y)),
            I::Over(k, x) => I::Over(k, to(x)),
            I::Sqrt(x) => I::Sqrt(to(x)),
            I::Ln1p(x) => I::Ln1p(to(x)),
            I::MinusLn1p(x) => I::MinusLn1p(to(x)),
            I::ExpM1(x) => I::ExpM1(to(x)),
            I::ExpM1Minus(x) => I::ExpM1Minus(to(x)),
        }
    }
}

/// Instructions in the order in which they were asked for, equal ones once.
#[derive(Debug, Default)]
pub(super) struct Instructions {
    all: Vec<Instruction<Index>>,
    indices: HashMap<Instruction<Index>, Index>,
}

impl Instructions {
    fn put(&mut self, instruction: Instruction<Index>) -> Operand {
        let next = Index(self.all.len());
        let index = *self.indices.entry(instruction).or_insert(next);
        if index == next {
            self.all.push(instruction);
        }
        Operand::Result(index)
    }

    pub(super) fn input(&mut self, index: usize) -> Operand {
        self.put(Instruction::Input(index))
    }

    pub(super) fn scaled(&mut self, x: Operand, k: f64) -> Operand {
        match x {
            Operand::Constant(x) => Operand::Constant(x * k),
            Operand::Result(_) if k == 0.0 => Operand::Constant(0.0),
            Operand::Result(_) if k == 1.0 => x,
            Operand::Result(x) => match self.all[x.0] {
                Instruction::Scale(inner, own) => {
                    self.put(Instruction::Scale(inner, (own.value() * k).into()))
                }
                _ => self.put(Instruction::Scale(x, k.into())),
            },
        }
    }

    pub(super) fn sum(&mut self, x: Operand, y: Operand) -> Operand {
        match (x, y) {
            (Operand::Constant(x), Operand::Constant(y)) => Operand::Constant(x + y),
            (Operand::Constant(0.0), other) | (other, Operand::Constant(0.0)) => other,
            (Operand::Constant(k), Operand::Result(x)) | (Operand::Result(x), Operand::Constant(k)) => {
                self.put(Instruction::Offset(x, k.into()))
            }
            (Operand::Result(x), Operand::Result(y)) => {
                let instruction = match (self.all[x.0], self.all[y.0]) {
                    (_, Instruction::Scale(a, k)) => multiple(a, k, x),
                    (Instruction::Scale(a, k), _) => multiple(a, k, y),
                    (_, Instruction::Multiply(a, b)) => Instruction::MultiplyAdd(a, b, x),
                    (Instruction::Multiply(a, b), _) => Instruction::MultiplyAdd(a, b, y),
                    _ => Instruction::Add(x, y),
                };
                self.put(instruction)
            }
        }
    }

    pub(super) fn product(&mut self, x: Operand, y: Operand) -> Operand {
        match (x, y) {
            (Operand::Constant(k), x) | (x, Operand::Constant(k)) => self.scaled(x, k),
            (Operand::Result(a), Operand::Result(b)) => {
                // Factors go outwards, where they meet those of a sum.
                let apart = |x: Index| match self.all[x.0] {
                    Instruction::Scale(inner, k) => (inner, k.value()),
                    _ => (x, 1.0),
                };
                let ((a, k), (b, l)) = (apart(a), apart(b));
                let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                let product = self.put(Instruction::Multiply(a, b));
                self.scaled(product, k * l)
            }
        }
    }

    pub(super) fn quotient(&mut self, x: Operand, y: Operand) -> Operand {
        match (x, y) {
            (x, Operand::Constant(k)) => self.scaled(x, 1.0 / k),
            (Operand::Constant(0.0), _) => Operand::Constant(0.0),
            (Operand::Constant(k), Operand::Result(y)) => self.put(Instruction::Over(k.into(), y)),
            (Operand::Result(x), Operand::Result(y)) => self.put(Instruction::Divide(x, y)),
        }
    }

    pub(super) fn sqrt(&mut self, x: Operand) -> Operand {
        self.function(x, f64::sqrt, Instruction::Sqrt)
    }

    pub(super) fn ln_1p(&mut self, x: Operand) -> Operand {
        self.function(x, f64::ln_1p, Instruction::Ln1p)
    }

    pub(super) fn minus_ln_1p(&mut self, x: Operand) -> Operand {
        self.function(x, Lane::minus_ln_1p, Instruction::MinusLn1p)
    }

    pub(super) fn exp_m1(&mut self, x: Operand) -> Operand {
        self.function(x, f64::exp_m1, Instruction::ExpM1)
    }

    pub(super) fn exp_m1_minus(&mut self, x: Operand) -> Operand {
        self.function(x, exp_m1_minus, Instruction::ExpM1Minus)
    }

    fn function(
        &mut self,
        x: Operand,
        of_constant: fn(f64) -> f64,
        of_result: fn(Index) -> Instruction<Index>,
    ) -> Operand {
        match x {
            Operand::Constant(x) => Operand::Constant(of_constant(x)),
            Operand::Result(x) => self.put(of_result(x)),
        }
    }

    /// The tape that computes some operands; `None` if it needs more registers than there are.
    pub(super) fn tape<const N: usize>(&self, outputs: [Operand; N]) -> Option<Tape<N>> {
        let mut last_use = vec![None; self.all.len()];
        for output in outputs {
            if let Operand::Result(index) = output {
                last_use[index.0] = Some(usize::MAX);
            }
        }
        for at in (0..self.all.len()).rev() {
            if last_use[at].is_some() {
                let _ = self.all[at].map(|operand| {
                    last_use[operand.0].get_or_insert(at);
                });
            }
        }
        let mut registers = vec![0u8; self.all.len()];
        let mut free: Vec<u8> = (0..LONG as u8).rev().collect();
        let mut highest = 0;
        let mut instructions = Vec::new();
        for at in 0..self.all.len() {
            let Some(end) = last_use[at] else { continue };
            let mut done: Vec<usize> = Vec::new();
            let instruction = self.all[at].map(|operand| {
                if last_use[operand.0] == Some(at) && !done.contains(&operand.0) {
                    done.push(operand.0);
                }
                registers[operand.0]
            });
            // The result may take the register of an operand that is not needed afterwards.
            free.extend(done.iter().map(|operand| registers[*operand]));
            let to = free.pop()?;
            registers[at] = to;
            highest = highest.max(to);
            instructions.push((instruction, to));
            debug_assert!(end > at, "a result is used after it is made");
        }
        let outputs = outputs.map(|output| match output {
            Operand::Constant(value) => Output::Constant(value),
            Operand::Result(index) => Output::Register(registers[index.0]),
        });
        Some(Tape { instructions, is_short: usize::from(highest) < SHORT, outputs })
    }
}

/// `a k + y`.
fn multiple(a: Index, k: Number, y: Index) -> Instruction<Index> {
    match k.value() {
        -1.0 => Instruction::Subtract(y, a),
        _ => Instruction::ScaleAdd(a, k, y),
    }
}

/// An output of a tape.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Output {
    Constant(f64),
    Register(u8),
}

/// Instructions with N results.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tape<const N: usize> {
    instructions: Vec<(Instruction<u8>, u8)>,
    is_short: bool,
    outputs: [Output; N],
}

impl<const N: usize> Tape<N> {
    /// The results for the inputs: the variables and det C.
    #[inline(always)]
    pub(super) fn run<L: Lane, const I: usize>(&self, inputs: &[L; I]) -> [L; N] {
        if self.is_short { self.run_in::<L, I, SHORT>(inputs) } else { self.run_in::<L, I, LONG>(inputs) }
    }

    #[inline(always)]
    fn run_in<L: Lane, const I: usize, const R: usize>(&self, inputs: &[L; I]) -> [L; N] {
        let one = inputs[0].splat(1.0);
        let mut registers = [one; R];
        for (instruction, to) in &self.instructions {
            // A register's number modulo R, a power of two, needs no check of its bounds.
            let get = crate::tensor::inlined!(|register: u8| registers[usize::from(register) % R]);
            let value = match *instruction {
                Instruction::Input(index) => inputs[index % I],
                Instruction::Scale(x, k) => get(x) * k.value(),
                Instruction::Offset(x, k) => get(x) + one.splat(k.value()),
                Instruction::Add(x, y) => get(x) + get(y),
                Instruction::Subtract(x, y) => get(x) - get(y),
                Instruction::Multiply(x, y) => get(x) * get(y),
                Instruction::Divide(x, y) => get(x) / get(y),
                Instruction::MultiplyAdd(x, y, z) => get(x).mul_add(get(y), get(z)),
                Instruction::ScaleAdd(x, k, y) => get(x).mul_add(one.splat(k.value()), get(y)),
                Instruction::Over(k, x) => one.splat(k.value()) / get(x),
                Instruction::Sqrt(x) => get(x).sqrt(),
                Instruction::Ln1p(x) => get(x).ln_1p(),
                Instruction::MinusLn1p(x) => get(x).minus_ln_1p(),
                Instruction::ExpM1(x) => get(x).exp_m1(),
                Instruction::ExpM1Minus(x) => exp_m1_minus(get(x)),
            };
            registers[usize::from(*to) % R] = value;
        }
        let mut results = [one; N];
        for (result, output) in results.iter_mut().zip(&self.outputs) {
            *result = match *output {
                Output::Constant(value) => one.splat(value),
                Output::Register(register) => registers[usize::from(register) % R],
            };
        }
        results
    }
}
