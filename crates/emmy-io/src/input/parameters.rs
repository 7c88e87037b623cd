//! `[parameters]`: numbers by name, and values such as `"= 2*E"`, which are computed from them before anything is
//! checked. A resolved input has the numbers alone, so that it stands for the same run.

use super::description::{Described, Kind, NUMBER, Others, Section, for_each_value};
use super::expression::{self, CONSTANTS, FUNCTIONS, Vocabulary};
use super::fault::{Fault, Faults, Place};
use super::suggest::{did_you_mean, listed};
use super::tree::{Entry, Node, Value};

/// Key of the table.
const NAME: &str = "parameters";

/// `[parameters]`.
pub(super) static PARAMETERS: Described = Described::new(|| {
    Section::new("[parameters]", "Numbers by name, from which other numbers of the input are computed")
        .others(Others {
            kind: NUMBER,
            doc: "A number, or an expression of other parameters such as `\"= 2*E\"`",
        })
});

/// Variables of expressions, which parameters of the same name do not replace.
const VARIABLES: [&str; 4] = ["x", "y", "z", "t"];

/// Longest chain of parameters that depend on each other.
const LONGEST: usize = 100;

/// Relative distance from a whole number that is rounding, as of 0.3/0.1.
const ROUNDING: f64 = 1e-9;

/// Whether a value is a text that stands for a number.
pub(super) fn is_computed(kind: &Kind, value: &Value) -> bool {
    matches!(kind, Kind::Number(_) | Kind::Whole(..) | Kind::Expression)
        && matches!(value, Value::String(text) if text.trim_start().starts_with('='))
}

/// Takes the parameters out of an input and replaces the values that are computed from them by numbers. Returns remarks
/// on parameters without effect.
pub(super) fn evaluate(tree: &mut Node, kind: &'static Kind, faults: &mut Faults) -> Vec<String> {
    let mut parameters = Parameters::taken_out(tree, faults);
    parameters.evaluate(tree, kind, faults);
    let mut notes = Vec::new();
    for index in 0..parameters.all.len() {
        let _ = parameters.value(index, &mut Vec::new(), faults);
    }
    let unused = parameters.all.iter().filter(|own| !own.is_used && own.state != State::Wrong);
    for Parameter { name, place, .. } in unused {
        if place.source_name() != "--set" {
            notes.push(format!("no value of the input depends on the parameter `{name}`"));
            continue;
        }
        let others = parameters.all.iter().filter(|own| own.is_used).map(|own| own.name.as_str());
        let label = did_you_mean(name, others).unwrap_or_else(|| "without effect".to_string());
        let fault = Fault::at(place, format!("--set: no value of the input depends on `{name}`"), label);
        let help = "such a value begins with `=`, as in \"= 2*E\"; the `input.toml` of a run has numbers in its place";
        faults.push(fault.help(help));
    }
    notes
}

/// Replaces computed values of a table that stands in no input, where there are no parameters.
pub(super) fn evaluate_alone(node: &mut Node, kind: &'static Kind, faults: &mut Faults) {
    Parameters { all: Vec::new() }.evaluate(node, kind, faults);
}

/// A parameter.
struct Parameter {
    name: String,
    /// Place of the name.
    place: Place,
    node: Node,
    state: State,
    is_used: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Unknown,
    Known(f64),
    /// Its fault is stored.
    Wrong,
}

struct Parameters {
    all: Vec<Parameter>,
}

impl Parameters {
    /// The parameters of an input. A value of another kind than a table stays, and has its fault when it is read.
    fn taken_out(tree: &mut Node, faults: &mut Faults) -> Parameters {
        let Some(entries) = tree.entries_mut() else { return Parameters { all: Vec::new() } };
        let is_own = |entry: &Entry| entry.key == NAME && matches!(entry.node.value, Value::Table(_));
        let own = entries.iter().position(is_own).map(|at| entries.remove(at).node.value);
        let Some(Value::Table(own)) = own else { return Parameters { all: Vec::new() } };
        let of = |Entry { key: name, place, node }: Entry| {
            let taken = match name.as_str() {
                own if CONSTANTS.iter().any(|(constant, _)| *constant == own) => Some("a constant"),
                own if FUNCTIONS.iter().any(|(function, _)| *function == own) => Some("a function"),
                _ => None,
            };
            let is_name = |c: char| c.is_alphanumeric() || c == '_';
            let state = match taken {
                Some(taken) => {
                    let message = format!("`{name}` is {taken} and cannot be a parameter");
                    faults.push(Fault::at(&place, message, "choose another name"));
                    State::Wrong
                }
                None if !name.chars().all(is_name)
                    || name.starts_with(|c: char| c.is_numeric())
                    || name.is_empty() =>
                {
                    let message =
                        format!("`{name}` cannot be a parameter: a name has letters, digits and `_` alone");
                    faults.push(Fault::at(&place, message, "not a name"));
                    State::Wrong
                }
                None => State::Unknown,
            };
            Parameter { name, place, node, state, is_used: false }
        };
        Parameters { all: own.into_iter().map(of).collect() }
    }

    fn evaluate(&mut self, node: &mut Node, kind: &'static Kind, faults: &mut Faults) {
        for_each_value(node, kind, &mut |node, kind| {
            if faults.are_many() {
                return;
            }
            if !is_computed(kind, &node.value) {
                if let (Kind::TimeFunction(_) | Kind::Expression, Value::String(text)) = (kind, &node.value) {
                    node.value = Value::String(self.with_numbers(text, faults));
                }
                return;
            }
            let Some(value) = self.computed(node, &mut Vec::new(), faults) else { return };
            let whole = value.round();
            let is_whole = (value - whole).abs() <= ROUNDING * value.abs().max(1.0) && whole.abs() < 1e15;
            node.value = match kind {
                Kind::Whole(..) if is_whole => Value::Integer(whole as i64),
                _ => Value::Float(value),
            };
        });
    }

    /// An expression of time or position with numbers in place of the parameters.
    fn with_numbers(&mut self, text: &str, faults: &mut Faults) -> String {
        let mut written = String::new();
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let is_name = |c: char| c.is_alphanumeric() || c == '_';
            // `2e3` and its exponent are one number.
            let length = match first {
                c if is_name(c) || c == '.' => {
                    rest.find(|c: char| !is_name(c) && c != '.').unwrap_or(rest.len())
                }
                c => c.len_utf8(),
            };
            let (word, others) = rest.split_at(length);
            let index = self.all.iter().position(|own| own.name == word && !VARIABLES.contains(&word));
            if let Some(index) = index {
                self.all[index].is_used = true;
            }
            match index.and_then(|index| self.value(index, &mut Vec::new(), faults)) {
                Some(value) if value < 0.0 => written += &format!("({value:?})"),
                Some(value) => written += &format!("{value:?}"),
                None => written += word,
            }
            rest = others;
        }
        written
    }

    /// The number of a text that begins with `=`, unless it has a fault; `chain`: the parameters that depend on it.
    fn computed(&mut self, node: &Node, chain: &mut Vec<usize>, faults: &mut Faults) -> Option<f64> {
        let Value::String(text) = &node.value else { return None };
        let start = text.find('=')? + 1;
        let names: Vec<&str> = self.all.iter().map(|own| own.name.as_str()).collect();
        let vocabulary = Vocabulary {
            variables: &names,
            has_function: |_| true,
            has_pulses: false,
            instead_of_kinks: "; there are smooth functions alone",
            about_others: "; other numbers have names in `[parameters]`",
        };
        let expression = faults.keep(expression::read_text(&node.place, text, start, &vocabulary))?;
        let mut used = Vec::new();
        expression.visit_variables(&mut |number| used.push(number));
        let mut values = vec![f64::NAN; self.all.len()];
        let mut is_known = true;
        for number in used {
            self.all[number].is_used = true;
            match self.value(number, chain, faults) {
                Some(value) => values[number] = value,
                None => is_known = false,
            }
        }
        let value = expression.value(&values);
        match value.is_finite() {
            _ if !is_known => None,
            true => Some(value),
            false => {
                let message = format!("`{}` is not a finite number", text.trim());
                faults.push(Fault::at(&node.place, message, format!("{value}")));
                None
            }
        }
    }

    /// The number of a parameter, unless it has a fault.
    fn value(&mut self, index: usize, chain: &mut Vec<usize>, faults: &mut Faults) -> Option<f64> {
        match self.all[index].state {
            State::Known(value) => return Some(value),
            State::Wrong => return None,
            State::Unknown => {}
        }
        let node = self.all[index].node.clone();
        let name = &self.all[index].name;
        let value = match &node.value {
            _ if chain.contains(&index) => {
                let begin = chain.iter().position(|own| *own == index).unwrap_or(0);
                let names = chain[begin..].iter().map(|own| self.all[*own].name.as_str());
                let message = format!("parameters depend on each other in a circle: {}", listed(names));
                faults.push(Fault::at(&node.place, message, format!("`{name}` depends on itself")));
                None
            }
            _ if chain.len() == LONGEST => {
                let message = format!("more than {LONGEST} parameters depend on each other in a row");
                faults.push(Fault::at(&node.place, message, "here"));
                None
            }
            Value::Integer(value) => Some(*value as f64),
            Value::Float(value) if value.is_finite() => Some(*value),
            Value::Float(value) => {
                let message = format!("`{name}` must be a finite number, not {value}");
                faults.push(Fault::at(&node.place, message, "not finite"));
                None
            }
            own if is_computed(&NUMBER, own) => {
                chain.push(index);
                let value = self.computed(&node, chain, faults);
                chain.pop();
                value
            }
            own => {
                let found = own.kind();
                let message =
                    format!("the parameter `{name}` must be a number or an expression, not {found}");
                let fault = Fault::at(&node.place, message, format!("this is {found}"));
                faults.push(fault.help(format!("an expression begins with `=`: {name} = \"= 2*pi\"")));
                None
            }
        };
        self.all[index].state = value.map_or(State::Wrong, State::Known);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::ROOT_KIND;
    use super::super::tree::parse;
    use super::super::write::toml;
    use super::*;

    /// A text with its values computed, and the remarks; or all faults.
    fn computed(text: &str) -> Result<(String, Vec<String>), Vec<String>> {
        let mut tree = parse("test", text).unwrap();
        let mut faults = Faults::default();
        let notes = evaluate(&mut tree, &ROOT_KIND, &mut faults);
        match faults.finish() {
            Ok(()) => Ok((toml(&tree), notes)),
            Err(error) => Err(error.faults().iter().map(|fault| fault.message().to_string()).collect()),
        }
    }

    #[test]
    fn numbers_are_computed_where_numbers_may_stand() {
        let text = "title = '= not a number'\nparameters = { E = 210e3, h = '= L/4', L = 2, half = '= E/2' }\n\
                    [mesh]\nbox = { size = ['= L', '= 2*h', 1], cells = ['= L/0.1', 1, '= 49/49'] }\n\
                    [[load]]\ngroup = 'a'\nforce = [0, 0, '= -sqrt(E - half + 20e3)']\nhistory = [[0, 0], ['= h', 1]]\n\
                    [time]\nsteps = [{ until = '= 2^3', size = '= 1/3' }]\n";
        let (text, notes) = computed(text).unwrap();
        // -sqrt(125,000) and a third to all digits; 2/0.1 is 20, a whole number.
        let force = -125_000_f64.sqrt();
        for part in [
            "title = \"= not a number\"",
            "size = [2.0, 1.0, 1], cells = [20, 1, 1]",
            &format!("force = [0, 0, {force:?}]"),
            "history = [[0, 0], [0.5, 1]]",
            "{ until = 8.0, size = 0.3333333333333333 }",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(!text.contains("parameters") && notes.is_empty(), "{text} {notes:?}");
    }

    #[test]
    fn expressions_of_time_and_position_may_use_parameters() {
        let text = "parameters = { A = -2, f = 1e-7, t = 5, e3 = 7, b = '= t' }\n\
                    [[load]]\nbody_force = ['2e3*A^2 + x', 0, '= b']\nhistory = 'A*sin(2*pi*f*t) + 1e3'\n";
        let (text, notes) = computed(text).unwrap();
        assert!(text.contains("body_force = [\"2e3*(-2.0)^2 + x\", 0, 5.0]"), "{text}");
        assert!(text.contains("history = \"(-2.0)*sin(2*pi*1e-7*t) + 1e3\""), "{text}");
        assert_eq!(notes, ["no value of the input depends on the parameter `e3`"]);
    }

    #[test]
    fn faults_are_all_named() {
        let faults = |text: &str| computed(text).unwrap_err();
        let circle = "parameters = { a = '= b + 1', b = '= 2*c', c = '= a', d = '= d' }";
        let circle = faults(circle);
        assert_eq!(circle.len(), 2, "{circle:?}");
        assert_eq!(circle[0], "parameters depend on each other in a circle: `a`, `b`, `c`");
        let several = faults(
            "parameters = { stiff = 1, e = 2, 'a-b' = 3, sin = 4, x = '1', n = inf, z = '= 1/(stiff - 1)' }\n\
             [newton]\ntolerance = '= 2*stif'\nmax_iterations = '= '\n",
        );
        for part in [
            "`e` is a constant",
            "`a-b` cannot be a parameter",
            "`sin` is a function",
            "the parameter `x` must be a number or an expression, not a string",
            "`n` must be a finite number",
            "`= 1/(stiff - 1)` is not a finite number",
            "`= 2*stif`: `stif` is not known here: did you mean `stiff`?",
            "the expression ends where",
        ] {
            assert!(several.iter().any(|fault| fault.contains(part)), "{part}\n{several:#?}");
        }
        assert_eq!(several.len(), 8, "{several:#?}");
        let chain: Vec<String> = (1..200).map(|i| format!("a{i} = '= a{}'", i - 1)).collect();
        let chain =
            faults(&format!("[newton]\ntolerance = '= a199'\n[parameters]\na0 = 1\n{}\n", chain.join("\n")));
        assert!(chain.iter().any(|fault| fault.contains("in a row")), "{chain:?}");
    }

    #[test]
    fn parameters_without_effect_are_noted() {
        let (_, notes) = computed("parameters = { a = 1, b = '= a' }\n").unwrap();
        assert_eq!(notes, ["no value of the input depends on the parameter `b`"]);
    }
}
