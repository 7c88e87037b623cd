//! Features of an input, on axes, and what Emmy refuses.

/// A kind of feature with its values; the first is the default.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// Name.
    pub name: &'static str,
    /// Values.
    pub values: &'static [&'static str],
}

const fn axis(name: &'static str, values: &'static [&'static str]) -> Axis {
    Axis { name, values }
}

/// All axes.
pub const AXES: [Axis; 13] = [
    axis(
        "cells",
        &[
            "hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15", "quad4", "quad8", "quad9",
            "tri3", "tri6",
        ],
    ),
    axis("formulation", &["standard", "projected-volume", "incompatible-modes"]),
    axis("material", &["neo-hooke", "saint-venant-kirchhoff", "mooney-rivlin", "formula", "fibres", "two"]),
    axis(
        "load",
        &[
            "traction",
            "none",
            "force",
            "nodal-force",
            "pressure",
            "acceleration",
            "group-acceleration",
            "body-force",
            "attraction",
        ],
    ),
    axis(
        "support",
        &[
            "fixed",
            "free",
            "rollers",
            "symmetry",
            "moved",
            "kinked",
            "turned",
            "accelerated",
            "springs",
            "bed",
            "released",
        ],
    ),
    axis("damping", &["none", "viscous-time", "viscous-shear", "drag"]),
    axis(
        "scheme",
        &[
            "DGM",
            "FE(k)",
            "FE(k+2)",
            "AS(k)",
            "AS(k+2)",
            "Lobatto(k+1)",
            "trapezoidal",
            "DGM(0.5)",
            "AS(k+1,0.3)",
            "Newmark(0.3,0.6)",
            "HHT(0.1)",
            "generalized-alpha(0.7)",
            "Bathe",
            "central-differences",
        ],
    ),
    axis("degree", &["1", "2", "3"]),
    axis("start", &["velocity", "rest", "equilibrium", "state"]),
    axis("masses", &["none", "points", "spread"]),
    axis("steps", &["planned", "adaptive"]),
    axis("solver", &["auto", "direct", "iterative", "multigrid"]),
    axis("run", &["alone", "resumed", "ranks", "static", "gradient"]),
];

/// A value of an axis.
pub type Feature = (usize, usize);

/// A choice of a value on each axis.
pub type Choice = [usize; AXES.len()];

/// Name of a feature.
pub fn name((axis, value): Feature) -> &'static str {
    AXES[axis].values[value]
}

/// The axis of a name.
///
/// # Panics
/// If there is none.
pub fn axis_of(name: &str) -> usize {
    AXES.iter().position(|axis| axis.name == name).expect("an axis")
}

/// Two axes, each with names of features, and words of the message that refuses them together.
type Refusal = (&'static str, &'static [&'static str], &'static str, &'static [&'static str], &'static str);

/// Pairs that Emmy refuses.
const REFUSED: [Refusal; 17] = [
    ("cells", &["tet4", "tri3"], "formulation", &["projected-volume"], "project"),
    (
        "cells",
        &["hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15", "quad8", "quad9", "tri3", "tri6"],
        "formulation",
        &["incompatible-modes"],
        "incompatible",
    ),
    ("formulation", &["incompatible-modes"], "scheme", &["central-differences"], "mass"),
    ("damping", &["viscous-time", "viscous-shear"], "scheme", CLASSIC, "has no damping"),
    ("damping", &["drag"], "scheme", CLASSIC, "has no damping"),
    ("support", DRIVEN, "scheme", CLASSIC, "cannot move a support"),
    ("support", DRIVEN, "scheme", &["DGM(0.5)", "AS(k+1,0.3)"], "cannot move a support"),
    ("steps", &["adaptive"], "scheme", CLASSIC, "`adaptive` needs a time element"),
    ("degree", &["2", "3"], "scheme", &OF_DEGREE_ONE, "degree"),
    ("support", &["free", "rollers", "symmetry"], "start", &["equilibrium"], "hold"),
    ("support", &["free", "rollers", "symmetry"], "run", &["static"], "hold"),
    ("solver", &["direct"], "run", &["ranks"], "MUMPS"),
    ("support", DRIVEN, "run", &["gradient"], "driven supports are not covered"),
    ("support", &["released"], "run", &["gradient"], "released are not covered"),
    ("load", &["pressure"], "run", &["gradient"], "pressures"),
    ("damping", &["viscous-time", "viscous-shear", "drag"], "run", &["gradient"], "viscosity and drag"),
    ("scheme", WITHOUT_ADJOINT, "run", &["gradient"], "without dissipation"),
];

const CLASSIC: &[&str] =
    &["Newmark(0.3,0.6)", "HHT(0.1)", "generalized-alpha(0.7)", "Bathe", "central-differences"];

const WITHOUT_ADJOINT: &[&str] = &[
    "DGM(0.5)",
    "AS(k+1,0.3)",
    "Newmark(0.3,0.6)",
    "HHT(0.1)",
    "generalized-alpha(0.7)",
    "Bathe",
    "central-differences",
];

const OF_DEGREE_ONE: [&str; 6] =
    ["trapezoidal", "Newmark(0.3,0.6)", "HHT(0.1)", "generalized-alpha(0.7)", "Bathe", "central-differences"];

const DRIVEN: &[&str] = &["moved", "kinked", "turned", "accelerated"];

/// A word of the message by which Emmy refuses a pair of features; `None`: it computes them.
pub fn refusal(a: Feature, b: Feature) -> Option<&'static str> {
    let is = |(axis, value): Feature, own: &str, names: &[&str]| {
        AXES[axis].name == own && names.contains(&AXES[axis].values[value])
    };
    let find = |(first, firsts, second, seconds, word): &(&str, &[&str], &str, &[&str], &'static str)| {
        let one_way = is(a, first, firsts) && is(b, second, seconds);
        (one_way || is(b, first, firsts) && is(a, second, seconds)).then_some(*word)
    };
    REFUSED.iter().find_map(find)
}

/// Whether a pair means nothing or is not tried: a static analysis has no time.
pub fn is_void(a: Feature, b: Feature) -> bool {
    let timeless = |own: Feature, other: Feature| {
        AXES[own.0].name == "run"
            && name(own) == "static"
            && ["scheme", "degree", "start", "steps"].contains(&AXES[other.0].name)
            && other.1 > 0
    };
    // The gradient is taken in the library here, along planned steps.
    let planned = |own: Feature, other: Feature| name(own) == "gradient" && name(other) == "adaptive";
    timeless(a, b) || timeless(b, a) || planned(a, b) || planned(b, a)
}

/// All pairs of features on different axes.
pub fn pairs() -> Vec<(Feature, Feature)> {
    let features: Vec<Feature> = (0..AXES.len())
        .flat_map(|axis| (0..AXES[axis].values.len()).map(move |value| (axis, value)))
        .collect();
    let after = |a: Feature| features.iter().copied().filter(move |b| b.0 > a.0).map(move |b| (a, b));
    features.iter().flat_map(|&a| after(a)).collect()
}

/// Words of the messages by which Emmy refuses a choice.
pub fn refusals(choice: &Choice) -> Vec<&'static str> {
    let mut words = Vec::new();
    for a in 0..AXES.len() {
        words.extend((a + 1..AXES.len()).filter_map(|b| refusal((a, choice[a]), (b, choice[b]))));
    }
    words
}

/// Whether two features of a choice mean nothing together.
pub fn has_void(choice: &Choice) -> bool {
    (0..AXES.len()).any(|a| (a + 1..AXES.len()).any(|b| is_void((a, choice[a]), (b, choice[b]))))
}

/// Choices that cover all pairs that Emmy computes, each drawn feature by feature so that it covers many of them.
pub fn covering() -> Vec<Choice> {
    let mut left: Vec<(Feature, Feature)> =
        pairs().into_iter().filter(|&(a, b)| refusal(a, b).is_none() && !is_void(a, b)).collect();
    let mut choices = Vec::new();
    while let Some(&(a, b)) = left.first() {
        let mut chosen: Vec<Feature> = vec![a, b];
        for axis in (0..AXES.len()).filter(|axis| *axis != a.0 && *axis != b.0) {
            let fits = |own: Feature, chosen: &[Feature]| {
                chosen.iter().all(|&other| refusal(own, other).is_none() && !is_void(own, other))
            };
            let gain = |own: Feature, chosen: &[Feature]| {
                let is_pair = |pair: &&(Feature, Feature)| {
                    let other = if pair.0 == own { pair.1 } else { pair.0 };
                    (pair.0 == own || pair.1 == own) && chosen.contains(&other)
                };
                left.iter().filter(is_pair).count()
            };
            let values = (0..AXES[axis].values.len()).map(|value| (axis, value));
            let own = values.filter(|own| fits(*own, &chosen)).max_by_key(|own| {
                // Among equals the first.
                (gain(*own, &chosen), usize::MAX - own.1)
            });
            chosen.push(own.unwrap_or((axis, 0)));
        }
        let mut choice = [0; AXES.len()];
        chosen.iter().for_each(|&(axis, value)| choice[axis] = value);
        left.retain(|&((a, x), (b, y))| choice[a] != x || choice[b] != y);
        choices.push(choice);
    }
    choices
}

/// The axes and the refused pairs as tables of Markdown, as CONTRIBUTING.md has them.
pub fn tables() -> String {
    let quoted = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let mut text = String::from("| axis | features, the default first |\n|---|---|\n");
    for axis in AXES {
        text += &format!("| {} | {} |\n", axis.name, quoted(axis.values));
    }
    text += "\n| refused | with | the message has |\n|---|---|---|\n";
    for (first, firsts, second, seconds, words) in REFUSED {
        text += &format!("| {first} {} | {second} {} | {words} |\n", quoted(firsts), quoted(seconds));
    }
    text
}

/// The features of a choice that are not defaults, for messages.
pub fn describe(choice: &Choice) -> String {
    let others = choice.iter().enumerate().filter(|(_, value)| **value > 0);
    let names: Vec<&str> = others.map(|(axis, &value)| AXES[axis].values[value]).collect();
    names.join(", ")
}
