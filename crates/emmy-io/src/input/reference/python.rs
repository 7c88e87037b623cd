//! Classes of the materials in Python, filled from the descriptions of their models: energy, parameters, errors,
//! fields. By hand are the headline of a class, its examples and the name of its model.

use emmy::internals::body::{MODELS, RegionModel};
use emmy::internals::material::{ELASTIC_CONSTANTS, IfAbsent, Parameter, ParameterKind};
use emmy::material::Volumetric;

use super::updated;

/// Files of the classes, in `python/emmy/`.
const FILES: [&str; 3] = ["_solids.py", "_rubber.py", "_links.py"];

/// Two empty lines, which stand before a class.
const GAP: &str = "\n\n\n";

/// A file with its classes filled, and the names of their models.
fn filled(file: &str) -> (String, Vec<String>) {
    let classes = file.trim_end().split(GAP);
    let (names, classes): (Vec<Option<&str>>, Vec<String>) =
        classes.map(|text| class(text).unwrap_or((None, text.to_string()))).unzip();
    (classes.join(GAP) + "\n", names.into_iter().flatten().map(str::to_string).collect())
}

/// The name of a model and its class, unless the text is not the class of a model.
fn class(text: &str) -> Option<(Option<&str>, String)> {
    let (doc, rest) = text.split_once("\n    model = \"")?;
    let (name, _) = rest.split_once('"')?;
    let model = RegionModel::named(name)?.model;
    let (headline, rest) = doc.split_once("\n\n")?;
    let (_, examples) = rest.split_once("    Examples\n")?;
    let energy = match model.is_link() {
        true => format!("``V = {}``, of the whole link.", model.energy),
        false => format!("``W = {}``", model.energy),
    };
    let lists = model.every_parameter().filter(|parameter| parameter.kind == ParameterKind::Numbers);
    let raises = match (model.has_elastic_constants(), lists.count()) {
        (true, _) => {
            let names: Vec<&str> = ELASTIC_CONSTANTS.iter().map(name_of).collect();
            format!(
                "If not exactly two of {} are given,\n        or a value is out of its range.",
                names.join(", ")
            )
        }
        (_, 2..) => "If a value is out of its range, or the lists have different lengths.".to_string(),
        _ if name == "orthotropic" => {
            "If a value is out of its range, or the stiffness is not positive definite.".to_string()
        }
        _ => "If a value is out of its range.".to_string(),
    };
    let is_optional = |parameter: &Parameter| parameter.if_absent != IfAbsent::Required;
    // Parameters that must be given come first.
    let (optional, required): (Vec<_>, Vec<_>) =
        model.every_parameter().partition(|parameter| is_optional(parameter));
    let required = required.into_iter().map(|own| parameter(own, ["", ""]));
    let optional = optional.into_iter().map(|own| parameter(own, [", optional", " | None = None"]));
    let (parameters, fields): (String, String) = required.chain(optional).unzip();
    let class = format!(
        "{headline}

    {energy}

    Parameters
    ----------
{parameters}
    Raises
    ------
    InputError
        {raises}

    Examples
{examples}
    model = \"{name}\"
{fields}"
    );
    Some((Some(name), class.trim_end().to_string()))
}

/// A parameter in the docstring and its field; each ends with what makes it optional.
fn parameter(parameter: &Parameter, [optional, or_none]: [&str; 2]) -> (String, String) {
    let laws = || Volumetric::ALL.map(|law| format!("\"{}\"", law.name())).join(", ");
    let (kind, hint) = match parameter.kind {
        ParameterKind::Number(bounds) => (format!("float {bounds}").trim_end().to_string(), "float"),
        ParameterKind::Numbers => ("list of float".to_string(), "Sequence[float] | NDArray[Any]"),
        ParameterKind::Direction => ("vector".to_string(), "Vector"),
        ParameterKind::Directions => ("list of vector".to_string(), "Sequence[Vector] | NDArray[Any]"),
        ParameterKind::Law => (format!("{{{}}}", laws()), "str"),
    };
    let absent = match parameter.if_absent {
        IfAbsent::Required | IfAbsent::FromTwoOthers => String::new(),
        IfAbsent::Value(own) | IfAbsent::Means(own) => format!("; {} if not given", own.replace('\'', "\"")),
    };
    let (name, doc) = (name_of(parameter), parameter.doc);
    let described = format!("    {name} : {kind}{optional}\n        {doc}{absent}.\n");
    (described, format!("    {name}: {hint}{or_none}\n"))
}

/// Name in Python, where `lambda` is a keyword.
fn name_of(parameter: &Parameter) -> &'static str {
    if parameter.name == "lambda" { "lambda_" } else { parameter.name }
}

#[test]
fn the_classes_of_python_match_the_models() {
    let files = FILES.iter();
    let mut all: Vec<String> =
        files.flat_map(|file| updated(&format!("python/emmy/{file}"), filled)).collect();
    let mut models = MODELS.iter().map(|model| model.model.name).collect::<Vec<_>>();
    all.sort();
    models.sort();
    assert_eq!(all, models, "each model has one class in {FILES:?}");
}
