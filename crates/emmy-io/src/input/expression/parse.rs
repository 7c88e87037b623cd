//! Recursive descent from the text of an expression to its tree.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ("-" | "+") signed | power
//! power   = atom [ "^" signed ]
//! atom    = number | variable | constant | function "(" sum ")" | "(" sum ")"
//!         | pulse "(" "t" "," sum { "," sum } ")"
//! ```

use std::ops::Range;

use super::super::suggest::{did_you_mean, listed};
use super::{CONSTANTS, Expression, FUNCTIONS, Operator, PULSES, Pulse, Vocabulary};

/// A mistake in an expression, and its bytes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mistake {
    pub(super) reason: String,
    pub(super) place: Range<usize>,
}

/// The deepest nesting of an expression: the depth of recursion in reading and evaluation.
const DEEPEST: usize = 100;

/// Functions that users may expect, but that have kinks.
const KINKED: [&str; 7] = ["abs", "min", "max", "sign", "floor", "if", "heaviside"];

/// Reads an expression.
pub(super) fn parse(text: &str, vocabulary: &Vocabulary<'_>) -> Result<Expression, Mistake> {
    let mut reader = Reader { text, vocabulary, at: 0, depth: 0 };
    let expression = reader.sum()?;
    match reader.next() {
        None => Ok(expression),
        Some(')') => Err(reader.mistake_here("this `)` closes nothing")),
        Some(c) if c.is_alphanumeric() || c == '_' || c == '(' || c == '.' => {
            Err(reader.mistake_here("an operator is missing here, such as `*`"))
        }
        Some(c) => Err(reader.mistake_here(&format!("`{c}` has no meaning here"))),
    }
}

struct Reader<'a> {
    text: &'a str,
    vocabulary: &'a Vocabulary<'a>,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    /// The next character that is not a space.
    fn next(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Skips the next character if it is the given one.
    fn skip(&mut self, wanted: char) -> bool {
        let is_there = self.next() == Some(wanted);
        self.at += if is_there { wanted.len_utf8() } else { 0 };
        is_there
    }

    fn mistake_here(&mut self, reason: &str) -> Mistake {
        let length = self.next().map_or(0, char::len_utf8);
        Mistake { reason: reason.to_string(), place: self.at..self.at + length }
    }

    /// Reads one level deeper.
    fn deeper(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<Expression, Mistake>,
    ) -> Result<Expression, Mistake> {
        if self.depth == DEEPEST {
            return Err(self.mistake_here("the expression is nested too deep here"));
        }
        self.depth += 1;
        let expression = read(self);
        self.depth -= 1;
        expression
    }

    fn sum(&mut self) -> Result<Expression, Mistake> {
        self.chain(&[('+', Operator::Plus), ('-', Operator::Minus)], Self::product)
    }

    fn product(&mut self) -> Result<Expression, Mistake> {
        self.chain(&[('*', Operator::Times), ('/', Operator::Over)], Self::signed)
    }

    /// Operands between operators of one rank, from left to right.
    fn chain(
        &mut self,
        operators: &[(char, Operator)],
        part: fn(&mut Self) -> Result<Expression, Mistake>,
    ) -> Result<Expression, Mistake> {
        let mut left = part(self)?;
        let mut n_parts = 1;
        loop {
            let next = self.next();
            let Some(&(sign, operator)) = operators.iter().find(|(sign, _)| Some(*sign) == next) else {
                return Ok(left);
            };
            // Each operand adds a level to the tree.
            n_parts += 1;
            if n_parts > DEEPEST {
                return Err(self.mistake_here("the expression is too long here"));
            }
            self.skip(sign);
            left = Expression::Operation(operator, Box::new([left, part(self)?]));
        }
    }

    fn signed(&mut self) -> Result<Expression, Mistake> {
        if self.skip('-') {
            return Ok(Expression::Negative(Box::new(self.deeper(Self::signed)?)));
        }
        if self.skip('+') {
            return self.deeper(Self::signed);
        }
        let base = self.atom()?;
        if self.skip('^') {
            let exponent = self.deeper(Self::signed)?;
            return Ok(Expression::Operation(Operator::Power, Box::new([base, exponent])));
        }
        Ok(base)
    }

    fn atom(&mut self) -> Result<Expression, Mistake> {
        match self.next() {
            None => {
                let reason = format!("the expression ends where {} should be", self.wanted());
                Err(self.mistake_here(&reason))
            }
            Some('(') => self.bracket(),
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c) => {
                let reason = format!("{} should be here, not `{c}`", self.wanted());
                Err(self.mistake_here(&reason))
            }
        }
    }

    /// The possible forms of an atom.
    fn wanted(&self) -> String {
        match self.vocabulary.variables {
            [] => "a number or a function".to_string(),
            variables => format!("a number, {} or a function", listed(variables.iter().copied())),
        }
    }

    /// The mistake where a bracket should be closed.
    fn unclosed(&mut self) -> Mistake {
        match self.next() {
            Some('<' | '>' | '=') => self.mistake_here(
                "there are no comparisons: step(t, 0.1) is 1 from t = 0.1 on, window(t, 0, 0.1) between two times",
            ),
            Some(c) if c.is_alphanumeric() || c == '_' => {
                self.mistake_here("an operator or a `)` is missing here; numbers have no units")
            }
            _ => self.mistake_here("a `)` is missing here"),
        }
    }

    /// `( sum )`; the next character is the bracket.
    fn bracket(&mut self) -> Result<Expression, Mistake> {
        self.skip('(');
        let inside = self.deeper(Self::sum)?;
        match self.skip(')') {
            true => Ok(inside),
            false => Err(self.unclosed()),
        }
    }

    fn number(&mut self) -> Result<Expression, Mistake> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(|b| b.is_ascii_digit() || *b == b'.') {
                at += 1;
            }
            at
        };
        let mut end = digits(start);
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            // `2e` is 2 and the name e: an operator is missing between them.
            end = if exponent > end + 1 + sign { exponent } else { end };
        }
        self.at = end;
        let text = &self.text[start..end];
        let place = start..end;
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Expression::Number(value)),
            Ok(_) => Err(Mistake { reason: format!("`{text}` is too large"), place }),
            Err(_) => Err(Mistake { reason: format!("`{text}` is not a number"), place }),
        }
    }

    fn name(&mut self) -> Result<Expression, Mistake> {
        let start = self.at;
        let rest = &self.text[self.at..];
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = &rest[..length];
        let place = start..start + length;
        self.at += length;
        if let Some(number) = self.vocabulary.variables.iter().position(|variable| *variable == name) {
            return Ok(Expression::Variable(number));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            return Ok(Expression::Number(*value));
        }
        if self.vocabulary.has_pulses && PULSES.iter().any(|(known, _)| *known == name) {
            return self.pulse(name, place);
        }
        let has = |name: &str| (self.vocabulary.has_function)(name);
        let Some(function) = FUNCTIONS.iter().position(|(known, _)| *known == name && has(name)) else {
            return Err(Mistake { reason: unknown(name, self.vocabulary), place });
        };
        if self.next() != Some('(') {
            let variable = self.vocabulary.variables.first().copied().unwrap_or_default();
            return Err(Mistake { reason: format!("`{name}` needs brackets: {name}({variable})"), place });
        }
        Ok(Expression::Function(function, Box::new(self.bracket()?)))
    }
}

/// Message about an argument that is not the time, or not a number.
const CONSTANT: &str =
    "a pulse has the time `t` first and then numbers: shift its numbers instead, as in half_sine(t, 1, 2)";

impl Reader<'_> {
    /// `name(t, t1, ...)`, after its name.
    fn pulse(&mut self, name: &str, place: Range<usize>) -> Result<Expression, Mistake> {
        if !self.skip('(') {
            let reason = Pulse::new(name, &[]).map_or_else(|(_, reason)| reason, |_| String::new());
            return Err(Mistake { reason, place });
        }
        let (mut arguments, mut places) = (Vec::new(), Vec::new());
        loop {
            self.next();
            let start = self.at;
            arguments.push(self.deeper(Self::sum)?);
            places.push(start..self.at);
            if !self.skip(',') {
                break;
            }
        }
        if !self.skip(')') {
            return Err(self.unclosed());
        }
        let Expression::Variable(variable) = arguments[0] else {
            return Err(Mistake { reason: CONSTANT.to_string(), place: places[0].clone() });
        };
        let mut numbers = Vec::new();
        for (argument, place) in arguments.iter().zip(&places).skip(1) {
            let mut is_constant = true;
            argument.visit_variables(&mut |_| is_constant = false);
            // No variable occurs.
            let number = if is_constant { argument.value(&[]) } else { f64::NAN };
            if !number.is_finite() {
                return Err(Mistake { reason: CONSTANT.to_string(), place: place.clone() });
            }
            numbers.push(number);
        }
        let pulse = Pulse::new(name, &numbers).map_err(|(number, reason)| {
            let place = number.map_or(place, |number| places[1 + number].clone());
            Mistake { reason, place }
        })?;
        Ok(Expression::Pulse(variable, pulse))
    }
}

/// Message about an unknown name.
fn unknown(name: &str, vocabulary: &Vocabulary<'_>) -> String {
    let is_pulse = |name: &str| PULSES.iter().any(|(known, _)| *known == name);
    if KINKED.contains(&name) || is_pulse(name) {
        return format!("`{name}` is not smooth{}", vocabulary.instead_of_kinks);
    }
    let constants = CONSTANTS.iter().map(|(name, _)| *name);
    let functions = FUNCTIONS.iter().map(|(name, _)| *name).filter(|name| (vocabulary.has_function)(name));
    let pulses = PULSES.iter().map(|(name, _)| *name).filter(|_| vocabulary.has_pulses);
    let known = vocabulary.variables.iter().copied().chain(constants.chain(functions)).chain(pulses);
    // Any letter is near to a variable, but not a misspelt `t`.
    match did_you_mean(name, known.clone()).filter(|_| name.chars().count() > 1) {
        Some(advice) => format!("`{name}` is not known here: {advice}"),
        None => {
            let about = vocabulary.about_others;
            format!("`{name}` is not known here; there is {}{about}", listed(known))
        }
    }
}
