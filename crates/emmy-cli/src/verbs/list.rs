//! `emmy list WHAT`: one item a line, its key word first.

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use emmy::body::fields::FieldName;
use emmy::mesh::CellKind;
use emmy::sparse::SOLVERS;
use emmy::time::{ESTIMATORS, SCHEMES};
use serde_json::json;

use super::new::TEMPLATES;
use crate::failure::Failure;
use crate::print;

/// Arguments of the verb.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What to list; without it, the words are listed
    what: Option<What>,
    /// As JSON: a list of objects with `name` and `description`
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// Schemes in time
    Schemes,
    /// Estimators of the error of a step
    Estimators,
    /// Material models
    Materials,
    /// Elements that a mesh may be made of
    Elements,
    /// Where a mesh may come from
    Meshes,
    /// Solvers of the linear systems
    Solvers,
    /// Fields that frames may hold
    Fields,
    /// Examples that `emmy new` writes
    Templates,
}

type Item = (&'static str, &'static str);

const MATERIALS: [Item; 14] = [
    (
        "saint-venant-kirchhoff",
        "W(C) = lambda/2 (tr E)^2 + mu E : E, E = (C - I)/2; parameters lambda, mu or youngs_modulus, poissons_ratio; \
         large rotation, small strain",
    ),
    (
        "neo-hooke",
        "W(C) = mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J, J^2 = det C; parameters lambda, mu or youngs_modulus, \
         poissons_ratio; large strain",
    ),
    (
        "ciarlet-geymonat",
        "W(C) = mu/2 (tr C - 3) + lambda/4 (J^2 - 1) - (lambda/2 + mu) ln J; parameters lambda, mu or youngs_modulus, \
         poissons_ratio; large strain, strong compression",
    ),
    (
        "hencky",
        "W(C) = lambda/2 (tr h)^2 + mu h : h, h = ln(C)/2; parameters lambda, mu or youngs_modulus, poissons_ratio; \
         metals, polymers",
    ),
    (
        "mooney-rivlin",
        "W(C) = c10 (I1bar - 3) + c01 (I2bar - 3) + W_vol; parameters c10, c01, bulk_modulus, \
         volumetric = \"simo-taylor\"; rubber",
    ),
    (
        "yeoh",
        "W(C) = c10 x + c20 x^2 + c30 x^3 + W_vol, x = I1bar - 3; parameters c10, c20, c30, bulk_modulus, \
         volumetric = \"simo-taylor\"; filled rubber",
    ),
    (
        "gent",
        "W(C) = -mu jm/2 ln(1 - (I1bar - 3)/jm) + W_vol; parameters mu, jm, bulk_modulus, \
         volumetric = \"simo-taylor\"; rubber with a limit of its stretch",
    ),
    (
        "arruda-boyce",
        "W(C) = n sum_i C_i/lambda_m^(2i-2) (I1bar^i - 3^i) + W_vol, five terms; parameters mu, lambda_m, bulk_modulus, \
         volumetric = \"simo-taylor\"; rubber, eight chains",
    ),
    (
        "ogden",
        "W(C) = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + W_vol, l_i = J^(-1/3) lambda_i; \
         parameters mu = [...], alpha = [...], bulk_modulus, volumetric = \"simo-taylor\"; rubber, any strain",
    ),
    (
        "orthotropic",
        "W(C) = E : D : E / 2, E = (C - I)/2; parameters youngs_modulus_1, _2, _3, poissons_ratio_12, _23, _13, mu_12, \
         mu_23, mu_13, axis_1 = [1, 0, 0], axis_2 = [0, 1, 0]; wood, plies, bone, small strain",
    ),
    (
        "holzapfel-gasser-ogden",
        "W(C) = mu/2 (I1bar - 3) + k1/(2 k2) sum_f (exp(k2 <E_f>^2) - 1) + W_vol, E_f = kappa (I1bar - 3) + \
         (1 - 3 kappa) (I4bar_f - 1); parameters mu, k1, k2, kappa = 0, fibres = [[x, y, z], ...], bulk_modulus, \
         volumetric = \"simo-taylor\"; soft tissue with fibres",
    ),
    (
        "bar",
        "V = E A L e^2/2, e = (l^2/L^2 - 1)/2; parameters youngs_modulus, area; links: trusses, cables under tension",
    ),
    (
        "spring",
        "V = k/2 (l - l_0)^2; parameters stiffness, rest_length = the reference length; links without mass",
    ),
    ("attraction", "V = -g/l; parameter strength; links without mass: gravitation, g = G m_1 m_2"),
];

const MESHES: [Item; 5] = [
    ("l-block", "L-shaped block, { cell_size = 1.0 }; groups body, face-a, face-b"),
    ("box", "block of bricks, { size = [2, 8, 2], cells = [2, 8, 2] }; groups body, x-min, x-max, ... z-max"),
    (
        "rectangle",
        "plane strain, { size = [2, 8], cells = [2, 8] } of quad4 cells; groups body, x-min, x-max, y-min, y-max",
    ),
    (
        "network",
        "links between points, { points = [[0, 0, 0], ...], links = [[0, 1], ...], groups = { name = [0, ...] }, \
         link_groups = { name = [0, ...] } }; group links",
    ),
    ("file", "mesh file: Gmsh .msh (2.2 and 4.1), Abaqus .inp, VTK .vtu; groups by their names in the file"),
];

/// Prints the list.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(what) = arguments.what else { return words(arguments.json) };
    let items: Vec<Item> = match what {
        What::Schemes => SCHEMES.map(|row| (row.form, row.description)).to_vec(),
        What::Estimators => ESTIMATORS.map(|(name, _, description)| (name, description)).to_vec(),
        What::Materials => MATERIALS.to_vec(),
        What::Elements => CellKind::ALL.map(|kind| (kind.name(), description(kind))).to_vec(),
        What::Meshes => MESHES.to_vec(),
        What::Solvers => SOLVERS.map(|(name, _, description)| (name, description)).to_vec(),
        What::Fields => FieldName::ALL.map(|field| (field.name(), field.description())).to_vec(),
        What::Templates => TEMPLATES.map(|template| (template.name, template.title())).to_vec(),
    };
    print::result(&if arguments.json { as_json(&items) } else { as_lines(&items) })
}

/// Prints what can be listed.
fn words(as_json: bool) -> Result<(), Failure> {
    let values: Vec<_> = What::value_variants().iter().filter_map(What::to_possible_value).collect();
    let help = |value: &PossibleValue| value.get_help().map(ToString::to_string).unwrap_or_default();
    let items: Vec<(&str, String)> = values.iter().map(|value| (value.get_name(), help(value))).collect();
    let items: Vec<(&str, &str)> = items.iter().map(|(name, help)| (*name, help.as_str())).collect();
    print::result(&if as_json { self::as_json(&items) } else { as_lines(&items) })
}

fn description(kind: CellKind) -> &'static str {
    match kind {
        CellKind::Hex8 => "trilinear hexahedron, 8 nodes",
        CellKind::Hex20 => "serendipity hexahedron, 20 nodes",
        CellKind::Hex27 => "triquadratic hexahedron, 27 nodes",
        CellKind::Tet4 => "linear tetrahedron, 4 nodes",
        CellKind::Tet10 => "quadratic tetrahedron, 10 nodes",
        CellKind::Wedge6 => "linear wedge, 6 nodes",
        CellKind::Wedge15 => "serendipity wedge, 15 nodes",
        CellKind::Pyramid5 => "linear pyramid with rational shape functions, 5 nodes",
        CellKind::Tri3 => "linear triangle in plane strain, 3 nodes",
        CellKind::Tri6 => "quadratic triangle in plane strain, 6 nodes",
        CellKind::Quad4 => "bilinear quadrilateral in plane strain, 4 nodes",
        CellKind::Quad8 => "serendipity quadrilateral in plane strain, 8 nodes",
        CellKind::Quad9 => "biquadratic quadrilateral in plane strain, 9 nodes",
        CellKind::Line2 => "link: bar, spring or attraction, 2 nodes",
    }
}

fn as_lines(items: &[(&str, &str)]) -> String {
    let width = items.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    items.iter().map(|(name, description)| format!("{name:width$}  {description}\n")).collect()
}

fn as_json(items: &[(&str, &str)]) -> String {
    let object = |(name, description): &(&str, &str)| json!({ "name": name, "description": description });
    format!("{:#}\n", serde_json::Value::Array(items.iter().map(object).collect()))
}
