//! Expressions of the time, such as `0.5 * sin(2*pi*t)`, of position and time, or of the invariants of a strain.
//!
//! A text becomes a tree ([`parse()`]). Its value at a time is computed with first and second derivatives by the time,
//! by the rules of differentiation on numbers ([`Jet`]). Its kinks are those of pulses, at given times ([`Pulse`]).

mod jet;
mod parse;
mod pulse;

use emmy::body::{Field, TimeFunction};
use emmy::internals::number::short;

use super::fault::{Fault, Place};
use super::table::{Item, Read};
use jet::Jet;
use parse::{Mistake, parse};
use pulse::{PULSES, Pulse};

/// Names that may occur in an expression, beside the constants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary<'a> {
    pub(super) variables: &'a [&'a str],
    /// Whether a function may occur.
    pub(super) has_function: fn(&str) -> bool,
    /// Whether pulses of the variable `t` may occur.
    pub(super) has_pulses: bool,
    /// Advice in place of a function with a kink.
    pub(super) instead_of_kinks: &'static str,
    /// Advice on a name that is not near to a known one.
    pub(super) about_others: &'static str,
}

/// Names in an expression of the time.
pub(super) const TIME: Vocabulary<'static> = Vocabulary {
    variables: &["t"],
    has_function: |_| true,
    has_pulses: true,
    instead_of_kinks: "; there are `half_sine`, `ramp`, `step` and `window`, such as step(t, 0.1), and tables [[time, value], \
                       ...], whose kinks are integrated exactly",
    about_others: "",
};

/// Names in an expression of reference position and time.
pub(super) const POSITION_AND_TIME: Vocabulary<'static> = Vocabulary {
    variables: &["x", "y", "z", "t"],
    has_function: |_| true,
    has_pulses: false,
    instead_of_kinks: ": bound the load by a group of cells, or give as `history` a function of time such as step(t, 0.1) or \
                       a table [[time, value], ...], whose kinks are integrated exactly",
    about_others: "",
};

/// Names and values of the constants.
pub(super) const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];

/// A function of one argument: its value and two derivatives there.
type Function = fn(f64) -> [f64; 3];

/// Names of the functions, with value and two derivatives.
pub(super) const FUNCTIONS: [(&str, Function); 13] = [
    ("sin", |x| [x.sin(), x.cos(), -x.sin()]),
    ("cos", |x| [x.cos(), -x.sin(), -x.cos()]),
    ("tan", |x| {
        let t = x.tan();
        let s = 1.0 + x.tan().powi(2);
        [t, s, 2.0 * t * s]
    }),
    ("asin", |x| {
        let r = 1.0 / (1.0 - x * x).sqrt();
        [x.asin(), r, x * r.powi(3)]
    }),
    ("acos", |x| {
        let r = 1.0 / (1.0 - x * x).sqrt();
        [x.acos(), -r, -x * r.powi(3)]
    }),
    ("atan", |x| {
        let r = 1.0 / (1.0 + x * x);
        [x.atan(), r, -2.0 * x * r * r]
    }),
    ("sinh", |x| [x.sinh(), x.cosh(), x.sinh()]),
    ("cosh", |x| [x.cosh(), x.sinh(), x.cosh()]),
    ("tanh", |x| {
        let t = x.tanh();
        let s = x.cosh().powi(-2);
        [t, s, -2.0 * t * s]
    }),
    ("exp", |x| [x.exp(); 3]),
    ("ln", |x| [x.ln(), 1.0 / x, -1.0 / (x * x)]),
    ("log10", |x| [x.log10(), 1.0 / x, -1.0 / (x * x)].map_rates(std::f64::consts::LOG10_E)),
    ("sqrt", |x| [x.sqrt(), 0.5 / x.sqrt(), -0.25 * x.powf(-1.5)]),
];

/// Multiplies derivatives by a factor.
trait MapRates {
    fn map_rates(self, factor: f64) -> Self;
}

impl MapRates for [f64; 3] {
    fn map_rates(self, factor: f64) -> Self {
        [self[0], factor * self[1], factor * self[2]]
    }
}

/// An expression.
#[derive(Debug, Clone)]
pub(super) enum Expression {
    /// A variable, by its number among those of the expression.
    Variable(usize),
    Number(f64),
    Negative(Box<Expression>),
    Operation(Operator, Box<[Expression; 2]>),
    /// A function, by its number in [`FUNCTIONS`].
    Function(usize, Box<Expression>),
    /// A pulse of the variable with a number.
    Pulse(usize, Pulse),
}

/// An operator between two expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

impl Expression {
    /// Visits the number of every variable that occurs.
    pub(super) fn visit_variables(&self, visit: &mut impl FnMut(usize)) {
        match self {
            Expression::Variable(number) | Expression::Pulse(number, _) => visit(*number),
            Expression::Number(_) => {}
            Expression::Negative(argument) | Expression::Function(_, argument) => {
                argument.visit_variables(visit)
            }
            Expression::Operation(_, sides) => sides.iter().for_each(|side| side.visit_variables(visit)),
        }
    }

    /// Adds the times of all kinks.
    fn add_kinks(&self, kinks: &mut Vec<f64>) {
        match self {
            Expression::Variable(_) | Expression::Number(_) => {}
            Expression::Negative(argument) | Expression::Function(_, argument) => argument.add_kinks(kinks),
            Expression::Operation(_, sides) => sides.iter().for_each(|side| side.add_kinks(kinks)),
            Expression::Pulse(_, pulse) => kinks.extend(pulse.kinks()),
        }
    }

    /// Value; quotients are rounded once, so that 49/49 is 1.
    pub(super) fn value(&self, variables: &[f64]) -> f64 {
        match self {
            Expression::Variable(number) => variables[*number],
            Expression::Number(value) => *value,
            Expression::Negative(argument) => -argument.value(variables),
            Expression::Function(function, argument) => FUNCTIONS[*function].1(argument.value(variables))[0],
            Expression::Pulse(number, pulse) => pulse.at(variables[*number])[0],
            Expression::Operation(operator, sides) => {
                let [a, b] = [sides[0].value(variables), sides[1].value(variables)];
                match operator {
                    Operator::Plus => a + b,
                    Operator::Minus => a - b,
                    Operator::Times => a * b,
                    Operator::Over => a / b,
                    Operator::Power => a.powf(b),
                }
            }
        }
    }

    /// Value and derivatives by the time; `variables`: the variables with theirs.
    fn at(&self, variables: &[Jet]) -> Jet {
        match self {
            Expression::Variable(number) => variables[*number],
            Expression::Number(value) => Jet([*value, 0.0, 0.0]),
            Expression::Negative(argument) => argument.at(variables).scaled(-1.0),
            Expression::Function(function, argument) => {
                argument.at(variables).into_function(FUNCTIONS[*function].1)
            }
            Expression::Pulse(number, pulse) => variables[*number].chain(pulse.at(variables[*number].0[0])),
            Expression::Operation(operator, sides) => {
                let [a, b] = [sides[0].at(variables), sides[1].at(variables)];
                match operator {
                    Operator::Plus => a.plus(b),
                    Operator::Minus => a.plus(b.scaled(-1.0)),
                    Operator::Times => a.times(b),
                    Operator::Over => a.times(b.power_of(-1.0)),
                    Operator::Power => a.power(b),
                }
            }
        }
    }

    /// The time function of an expression in [`TIME`]; `text` is its source.
    pub(super) fn time_function(self, text: &str) -> TimeFunction {
        let mut kinks = Vec::new();
        self.add_kinks(&mut kinks);
        TimeFunction::smooth(text, move |time| self.at(&[Jet([time, 1.0, 0.0])]).0).with_kinks(kinks)
    }
}

/// Reads the text of an expression.
pub(super) fn read(item: &Item<'_>, vocabulary: &Vocabulary<'_>) -> Result<Expression, Fault> {
    let text = item.text().unwrap_or_default();
    parse(text, vocabulary).map_err(|Mistake { reason, place }| {
        Fault::at(&item.place().inside(text, place), format!("`{}`: {reason}", item.key), "here")
    })
}

/// Reads the part of a text from a byte on.
pub(super) fn read_text(
    text_place: &Place,
    text: &str,
    start: usize,
    vocabulary: &Vocabulary<'_>,
) -> Result<Expression, Fault> {
    parse(&text[start..], vocabulary).map_err(|Mistake { reason, place }| {
        let place = text_place.inside(text, start + place.start..start + place.end);
        Fault::at(&place, format!("`{}`: {reason}", text.trim()), "here")
    })
}

/// Reads a vector field over reference position and time: three numbers or expressions in [`POSITION_AND_TIME`].
pub(super) fn read_field(item: &Item<'_>) -> Result<Field, Fault> {
    if let Some(field) = item.field() {
        return Ok(field.clone());
    }
    let component = |item: &Item<'_>| match item.text() {
        Some(_) => read(item, &POSITION_AND_TIME),
        None => Ok(Expression::Number(f64::read(*item))),
    };
    let items: [Item<'_>; 3] = Read::read(*item);
    let components = [component(&items[0])?, component(&items[1])?, component(&items[2])?];
    let text = items.map(|item| item.text().map_or_else(|| short(f64::read(item)), str::to_string));
    Ok(Field::named(&text.join(", "), move |[x, y, z], time| {
        let variables = [x, y, z, time].map(|value| Jet([value, 0.0, 0.0]));
        components.each_ref().map(|component| component.at(&variables).0[0])
    }))
}

#[cfg(test)]
#[allow(non_snake_case)]
mod tests {
    use super::*;

    fn time_function(text: &str) -> TimeFunction {
        parse(text, &TIME).unwrap().time_function(text)
    }

    #[test]
    fn values_match_mathematics() {
        let t = 0.7f64;
        for (text, value) in [
            ("-t^2", -0.49),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("1 - 2 - 3", -4.0),
            ("8/4/2*3", 3.0),
            ("-2^2 + +1", -3.0),
            ("2e-3*1.5E+3 + .5", 3.5),
            ("exp(-(t/0.2)^2)", (-12.25f64).exp()),
            ("sin(2*pi*t)", (2.0 * std::f64::consts::PI * t).sin()),
            (" ( t ) ", t),
            ("log10(100) + ln(e)", 3.0),
        ] {
            assert!(
                (time_function(text).value(t) - value).abs() < 1e-14,
                "{text}: {}",
                time_function(text).value(t)
            );
        }
    }

    #[test]
    fn rates_match_differences() {
        let t = 0.7;
        let mut texts: Vec<String> = FUNCTIONS.iter().map(|(name, _)| format!("3*{name}(t^2/2)")).collect();
        texts.extend(
            ["step(t, 0.5, 2)*t", "window(t, 0, 2, 1)", "half_sine(t, 0, 2)^2", "ramp(t, 0, 2)"]
                .map(String::from),
        );
        texts.extend(["t^3", "t^t", "2^t/(1 + t)", "-t*sin(t)", "(1 - t)^-0.5", "t^2^t"].map(String::from));
        for text in texts {
            let d = 1e-4;
            let expression = parse(&text, &TIME).unwrap();
            let at = |i: f64| expression.at(&[Jet([t + i * d, 1.0, 0.0])]).0;
            for order in 0..2 {
                // Five points: the error is of order d^4, rounding of order eps/d.
                let [a, b, c, f] = [-2.0, -1.0, 1.0, 2.0].map(|i| at(i)[order]);
                let difference = (a - 8.0 * b + 8.0 * c - f) / (12.0 * d);
                let rate = at(0.0)[order + 1];
                assert!((rate - difference).abs() < 1e-9 * (1.0 + rate.abs()), "{text}: {rate} {difference}");
            }
        }
        // Powers at zero: its logarithm does not occur.
        let at_zero = |text: &str| parse(text, &TIME).unwrap().at(&[Jet([0.0, 1.0, 0.0])]).0;
        assert_eq!(at_zero("t^2"), [0.0, 0.0, 2.0]);
        assert_eq!(at_zero("t^1 + t^0"), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn pulses_match_their_definition() {
        for (text, values) in [
            ("step(t, 1)", [0.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
            ("step(t, 1, 3)", [0.0, 0.0, 0.0, 0.103515625, 0.5, 1.0]),
            ("ramp(t, 1, 3)", [0.0, 0.0, 0.0, 0.25, 0.5, 1.0]),
            ("window(t, 1, 2)", [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]),
            ("window(t, 1, 3, 0.5)", [0.0, 0.0, 0.0, 1.0, 1.0, 0.0]),
            ("window(t, 1, 3, 1)", [0.0, 0.0, 0.0, 0.5, 1.0, 0.0]),
            ("half_sine(t, 1, 2)", [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
            ("3 - 2*half_sine(t, 1/2, 2 + 2/4)", [3.0, 3.0, 3.0 - 2f64.sqrt(), 1.0, 3.0 - 2f64.sqrt(), 3.0]),
        ] {
            let function = time_function(text);
            for (time, value) in [-1.0, 0.5, 1.0, 1.5, 2.0, 3.0].into_iter().zip(values) {
                assert!(
                    (function.value(time) - value).abs() < 1e-14,
                    "{text} at {time}: {}",
                    function.value(time)
                );
            }
        }
        let jumps = [
            "step(t, 1)",
            "(t - 1)*step(t, 1)",
            "window(t, 0, 2)",
            "half_sine(t, -0.1, 0.3)",
            "ramp(t, 1, 2)",
        ];
        let jumps = jumps.map(|text| time_function(text).first_jump());
        assert_eq!(jumps, [Some(1.0), None, Some(0.0), None, None]);
        let kinks = time_function("ramp(t, 1, 2)*window(t, 0, 3, 0.5) + half_sine(t, 1, 4)").kinks();
        assert_eq!(kinks, [0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 4.0]);
    }

    #[test]
    fn pulses_are_integrated_to_their_kinks() {
        // 30 g over 11 ms: v = 2 A T/pi, and half of v T at its end.
        let [A, T] = [294.2, 0.011];
        let pulse = time_function("294.2*half_sine(t, 0, 0.011)");
        let path = TimeFunction::from_acceleration(&pulse, [0.0, 0.05]).unwrap();
        let v = 2.0 * A * T / std::f64::consts::PI;
        assert!(
            (path.rate(0.011) / v - 1.0).abs() < 1e-14
                && (path.value(0.011) / (0.5 * v * T) - 1.0).abs() < 1e-14
        );
        assert!((path.value(0.05) / (v * (0.05 - 0.5 * T)) - 1.0).abs() < 1e-14);
        assert_eq!(path.next_kink(0.0), Some(0.011));
    }

    #[test]
    fn mistakes_have_their_place() {
        for (text, place, says) in [
            ("sin(2*pi*", 9..9, "ends"),
            ("sin(t", 5..5, "`)`"),
            ("2 t", 2..3, "operator"),
            ("2*sine(t)", 2..6, "`sin`"),
            ("2*x", 2..3, "`t`"),
            ("sin t", 0..3, "sin("),
            ("t(2)", 1..2, "operator"),
            ("pi(2)", 2..3, "operator"),
            ("1..2", 0..4, "not a number"),
            ("t $ 2", 2..3, "`$`"),
            ("t)", 1..2, "`)`"),
            ("*t", 0..1, "`*`"),
            ("max(t)", 0..3, "table"),
            ("half_sine", 0..9, "half_sine(t, t1, t2)"),
            ("2*step(t)", 2..6, "step(t, t1) or step(t, t1, t2)"),
            ("step(t, 1, 2, 3)", 0..4, "step(t, t1) or step(t, t1, t2)"),
            ("ramp(2*t, 1, 2)", 5..8, "the time `t` first"),
            ("ramp(t, 1, t)", 11..12, "then numbers"),
            ("window(t, 3, 2)", 13..14, "after its start"),
            ("window(t, 1, 2, 0.7)", 16..19, "fit between"),
            ("halfsine(t, 1, 2)", 0..8, "`half_sine`"),
            ("heaviside(t)", 0..9, "step(t, 0.1)"),
            ("ramp(t, 1, 2", 12..12, "`)`"),
            ("half_sine(t, 0, 11ms)", 18..19, "no units"),
            ("(t < 0.011)", 3..4, "no comparisons"),
            ("1e999", 0..5, "too large"),
            ("\u{3c0}*t", 0..2, "\u{3c0}"),
        ] {
            let mistake = parse(text, &TIME).unwrap_err();
            assert!(mistake.reason.contains(says) && mistake.place == place, "{text}: {mistake:?}");
        }
        let deep = "(".repeat(100_000);
        assert!(parse(&deep, &TIME).unwrap_err().reason.contains("deep"));
        assert!(parse(&"-".repeat(100_000), &TIME).is_err() && parse(&"2^".repeat(100_000), &TIME).is_err());
        let mistake = parse("step(t, 1)*x", &POSITION_AND_TIME).unwrap_err();
        assert!(mistake.reason.contains("as `history` a function") && mistake.place == (0..4), "{mistake:?}");
        let mistake = parse("abs(x)", &POSITION_AND_TIME).unwrap_err();
        assert!(mistake.reason.contains("group of cells") && mistake.place == (0..3), "{mistake:?}");
    }
}
