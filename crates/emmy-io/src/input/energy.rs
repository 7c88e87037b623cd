//! `material.energy = { formula = "...", ... }`: a material by its energy, with parameters of any names.

use std::collections::BTreeSet;

use emmy::body::Region;
use emmy::material::{EnergyFormula, Expression as Energy, Invariant};

use super::description::{Described, Kind, NUMBER, Others, Section, vector};
use super::expression::{self, CONSTANTS, Expression, FUNCTIONS, Operator, Vocabulary};
use super::fault::Fault;
use super::finite;
use super::suggest::{did_you_mean, listed};
use super::table::{Item, Read, Table};

/// Key of the model.
pub(super) const NAME: &str = "energy";

/// Its energy, as in the lists of models.
pub(super) const ENERGY: &str = "a formula in I1, I2, I3, J, I1_bar, I2_bar, I4, I4_bar";

/// Its use.
pub(super) const PURPOSE: &str = "an energy of your own";

const FORMULA: &str = "formula";
const FIBRE: &str = "fibre";

/// `energy`.
pub(super) static SECTION: Described = Described::new(|| {
    let others = Others {
        kind: NUMBER,
        doc: "A parameter of the formula, of any name that is not an invariant, a function or a constant",
    };
    Section::new(NAME, &format!("{ENERGY}: {PURPOSE}"))
        .must(
            FORMULA,
            Kind::Text,
            "",
            "Stored energy per reference volume, such as `\"mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2\"`",
        )
        .may(
            FIBRE,
            vector(),
            "",
            "Direction of the fibre whose stretch is the root of I4, not necessarily a unit vector",
        )
        .absent("none, and no I4")
        .others(others)
});

/// A function of energies.
type Function = fn(Energy) -> Energy;

/// Functions that an energy may have, by their names in [`FUNCTIONS`].
const OF_ENERGIES: [(&str, Function); 7] = [
    ("ln", Energy::ln),
    ("exp", Energy::exp),
    ("sqrt", Energy::sqrt),
    ("log10", |x| x.ln() * std::f64::consts::LOG10_E),
    ("sinh", Energy::sinh),
    ("cosh", Energy::cosh),
    ("tanh", Energy::tanh),
];

/// Reads the material and creates its region.
pub(super) fn region(table: &Table<'_>, density: f64) -> Result<Region, Fault> {
    let formula: Item<'_> = table.must(FORMULA);
    let parameters = parameters(table)?;
    let invariants = Invariant::ALL.map(Invariant::name);
    let names = parameters.iter().map(|(name, _)| *name);
    let variables: Vec<&str> = invariants.iter().copied().chain(names).collect();
    let vocabulary = Vocabulary {
        variables: &variables,
        has_function: |name| OF_ENERGIES.iter().any(|(own, _)| *own == name),
        has_pulses: false,
        instead_of_kinks: ", and an energy has two derivatives; `holzapfel-gasser-ogden` has fibres that bear tension only",
        about_others: "; a parameter is a key beside `formula`, as in { formula = \"mu/2*(I1_bar - 3) + K/2*(J - 1)^2\", mu = 1, \
                       K = 10 }",
    };
    let expression = expression::read(&formula, &vocabulary)?;
    check_use(table, &expression, &variables)?;
    let values = Invariant::ALL.map(Energy::from).into_iter();
    let values: Vec<Energy> =
        values.chain(parameters.iter().map(|(_, value)| Energy::from(*value))).collect();
    let material = EnergyFormula::new(&energy(&expression, &values), table.may(FIBRE)).map_err(|error| {
        let guilty = match error {
            emmy::Error::Direction { .. } => table.item(FIBRE),
            _ => None,
        };
        guilty.unwrap_or(formula).fault(error.to_string(), "not an energy of a solid")
    })?;
    let region = Region::new(material, density);
    finite::check_moduli(&formula, &region)?;
    Ok(region)
}

/// Names and values of the parameters.
fn parameters<'a>(table: &Table<'a>) -> Result<Vec<(&'a str, f64)>, Fault> {
    table
        .others()
        .map(|item| {
            let name = item.key;
            let taken = match name {
                _ if Invariant::ALL.iter().any(|invariant| invariant.name() == name) => Some("an invariant"),
                _ if CONSTANTS.iter().any(|(own, _)| *own == name) => Some("a constant"),
                _ if FUNCTIONS.iter().any(|(own, _)| *own == name) => Some("a function"),
                _ => None,
            };
            if let Some(taken) = taken {
                let message = format!("`{name}` is {taken} and cannot be a parameter of the formula");
                return Err(Fault::at(item.key_place, message, "choose another name"));
            }
            Ok((name, Read::read(item)))
        })
        .collect()
}

/// Every parameter occurs in the formula.
fn check_use(table: &Table<'_>, expression: &Expression, variables: &[&str]) -> Result<(), Fault> {
    let mut used = BTreeSet::new();
    expression.visit_variables(&mut |number| {
        used.insert(variables[number]);
    });
    let Some(unused) = table.others().find(|item| !used.contains(item.key)) else { return Ok(()) };
    let name = unused.key;
    let label = did_you_mean(name, [FORMULA, FIBRE]).unwrap_or_else(|| "has no effect".to_string());
    let message = format!("the parameter `{name}` does not occur in the formula");
    let help = format!("names in the formula: {}", listed(used));
    Err(Fault::at(unused.key_place, message, label).help(help))
}

/// An expression with values for its variables.
fn energy(expression: &Expression, values: &[Energy]) -> Energy {
    match expression {
        Expression::Variable(number) => values[*number].clone(),
        Expression::Number(value) => Energy::from(*value),
        Expression::Negative(argument) => -energy(argument, values),
        // The vocabulary has no pulses.
        Expression::Pulse(..) => Energy::from(f64::NAN),
        Expression::Function(number, argument) => {
            let name = FUNCTIONS[*number].0;
            let function = OF_ENERGIES.iter().find(|(own, _)| *own == name);
            // The vocabulary has no other functions.
            let argument = energy(argument, values);
            function.map_or_else(|| Energy::from(f64::NAN), |(_, function)| function(argument))
        }
        Expression::Operation(operator, sides) => {
            let [a, b] = sides.each_ref().map(|side| energy(side, values));
            match operator {
                Operator::Plus => a + b,
                Operator::Minus => a - b,
                Operator::Times => a * b,
                Operator::Over => a / b,
                Operator::Power => a.power(b),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{memory, tree};

    /// The region of `material.energy = { ... }`.
    fn read(text: &str) -> Result<Region, String> {
        let mut tree = tree::parse("test", &format!("energy = {{ {text} }}\n")).unwrap();
        let node = tree.get_mut(NAME).unwrap().clone();
        memory::read_alone(NAME, node, |table, faults| faults.keep(region(table, 1.0)))
            .map_err(|error| error.faults()[0].to_string())
    }

    #[test]
    fn functions_of_energies_are_functions_of_expressions() {
        assert!(OF_ENERGIES.iter().all(|(own, _)| FUNCTIONS.iter().any(|(name, _)| own == name)));
    }

    #[test]
    fn moduli_match_the_formula() {
        // Ciarlet and Geymonat: lambda = 3, mu = 2, so that K = 3 + 4/3.
        let text = "formula = 'mu/2*(I1 - 3) + l/4*(I3 - 1) - (l/2 + mu)*ln(sqrt(I3))', mu = 2, l = 3";
        let [bulk, shear] = read(text).unwrap().moduli().unwrap();
        assert!((bulk - 13.0 / 3.0).abs() < 1e-14 && (shear - 2.0).abs() < 1e-14, "{bulk} {shear}");
        // Every function: x, 1/2 x ln(10) log10(e), ... each with the slope 1 at x = 0, so that mu = 2 * 6.
        let text = "formula = 'x*0 + sinh(I1_bar - 3) + tanh(I1_bar - 3) + exp(I1_bar - 3) + 2*sqrt(I1_bar - 2) + \
                    ln(I1_bar - 2) + log10(I1_bar - 2)/log10(e) + cosh(I1_bar - 3) + 5*(J - 1)^2', x = 1";
        let [bulk, shear] = read(text).unwrap().moduli().unwrap();
        assert!((bulk - 10.0).abs() < 1e-12 && (shear - 12.0).abs() < 1e-12, "{bulk} {shear}");
    }

    #[test]
    fn parameters_are_numbers_in_the_formula() {
        let formula = "formula = 'mu/2*(I1_bar - 3) + K/2*(J - 1)^2', mu = 1";
        for (text, says) in [
            (format!("{formula}, K = 10, k = 3"), "`k` does not occur in the formula"),
            (format!("{formula}, K = 10, fiber = [1, 0, 0]"), "`fiber` must be a number"),
            (formula.to_string(), "`K` is not known here"),
            (format!("{formula}, K = 10, J = 3"), "`J` is an invariant"),
            (format!("{formula}, K = 10, e = 3"), "`e` is a constant"),
            (format!("{formula}, K = 10, sin = 3"), "`sin` is a function"),
            (format!("{formula}, K = 10, fibre = [1, 0, 0]"), "so that `fibre` has no effect"),
            ("formula = 'sin(I1)'".to_string(), "`sin` is not known here"),
            ("formula = 'max(I4, 1)', fibre = [1, 0, 0]".to_string(), "holzapfel-gasser-ogden"),
            ("mu = 3".to_string(), "`formula` is missing"),
            (format!("{formula}, K = 1e200"), "must not be beyond 1e150"),
            ("formula = '1e200*(I1_bar - 3) + 1e200*ln(J)^2'".to_string(), "that follow are 2e200 and 2e200"),
        ] {
            let message = read(&text).unwrap_err();
            assert!(message.contains(says), "{message}\n{says}");
        }
    }
}
