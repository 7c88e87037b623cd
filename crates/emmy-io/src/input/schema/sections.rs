//! The sections of an input.

use emmy::body::fields::FieldName;
use emmy::sparse::SOLVERS;
use emmy::time::{ESTIMATORS, MAX_DEGREE};
use serde_json::{Value, json};

use super::super::keys;
use super::kinds::{Table, exactly, history, list, number, positive, text, vector, whole, words};
use super::materials;
use crate::vtk::{Format, Precision};

/// The whole input.
pub(super) fn root() -> Value {
    Table::new(keys::ROOT, "Motion of an elastic body; units are any consistent set")
        .may("title", text("Any text; it goes into the summary"))
        .must("mesh", mesh())
        .must("region", region())
        .may("mass", mass())
        .may("load", load())
        .may("support", support())
        .may("initial", initial())
        .must("time", time())
        .may("newton", newton())
        .may("solver", solver())
        .may("output", output())
        .may("limits", limits())
        .rule("definitions", json!({ "material": materials::material() }))
        .schema()
}

fn group(what: &str) -> Value {
    text(&format!("Group of the mesh: {what}"))
}

fn mesh() -> Value {
    let file = "Mesh file, its path relative to the input: Gmsh .msh (2.2, 4.1), Abaqus .inp, VTK .vtu";
    Table::new(keys::MESH, "Where the cells come from: exactly one source")
        .may("l-block", l_block())
        .may("box", block())
        .may("rectangle", rectangle())
        .may("network", network())
        .may("file", text(file))
        .may("scale", positive("Factor on all coordinates; left out: 1"))
        .one_of(&[&["l-block"], &["box"], &["rectangle"], &["network"], &["file"]])
        .schema()
}

fn l_block() -> Value {
    Table::new(keys::L_BLOCK, "L-shaped block, 10 long, 6 wide, 3 thick; groups body, face-a, face-b")
        .must("cell_size", positive("Edge of its hex8 cells [length]: 1, 1/2, 1/3, ..."))
        .schema()
}

fn block() -> Value {
    let groups = "groups body, x-min, x-max, y-min, y-max, z-min, z-max";
    Table::new(keys::BOX, &format!("Block of hex8 cells with a corner at the origin; {groups}"))
        .must("size", exactly(3, positive("An edge"), "Its three edges [length]"))
        .must("cells", exactly(3, whole(1, "Number of cells"), "Number of cells along each edge"))
        .schema()
}

fn rectangle() -> Value {
    let groups = "groups body, x-min, x-max, y-min, y-max";
    Table::new(keys::RECTANGLE, &format!("Body in plane strain, of quad4 cells in the plane z = 0; {groups}"))
        .must("size", exactly(2, positive("An edge"), "Its two edges [length]"))
        .must("cells", exactly(2, whole(1, "Number of cells"), "Number of cells along each edge"))
        .schema()
}

fn network() -> Value {
    let numbers = json!({ "type": "array", "items": { "type": "integer", "minimum": 0 } });
    let named =
        |what: &str| json!({ "description": what, "type": "object", "additionalProperties": numbers });
    let link = exactly(2, whole(0, "A point, counted from 0"), "Two points");
    Table::new(keys::NETWORK, "Links between points; group of all of them: links")
        .must("points", list(0, vector("A position"), "Positions of the points [length], counted from 0"))
        .must("links", list(1, link, "Pairs of points, such as [[0, 1], [1, 2]]"))
        .may("groups", named("Groups of points by name, such as { star = [0], planets = [1, 2] }"))
        .may("link_groups", named("Groups of links by name, counted from 0"))
        .schema()
}

fn region() -> Value {
    let thickness = "Thickness of cells in plane strain [length]; left out: 1";
    let massless = json!({ "anyOf": [{ "required": ["spring"] }, { "required": ["attraction"] }] });
    Table::new(keys::REGION, "Cells with a density and a material")
        .may("group", group("cells; with one region it may be left out and is every cell"))
        .may("density", positive("Mass per reference volume; springs and attractions have none"))
        .may("thickness", positive(thickness))
        .must("material", json!({ "$ref": "#/definitions/material" }))
        .may("viscosity", viscosity())
        .rule("anyOf", json!([{ "required": ["density"] }, { "properties": { "material": massless } }]))
        .one_or_more()
}

fn viscosity() -> Value {
    let time = "Time by which the stiffness at rest is multiplied (stiffness-proportional damping) [time]";
    Table::new(
        keys::VISCOSITY,
        "Viscosity of Kelvin and Voigt: a stress linear in the strain rate; links have `time` alone",
    )
    .may("time", positive(time))
    .may("shear", positive("Shear viscosity [stress time]"))
    .may("bulk", positive("Bulk viscosity [stress time]"))
    .rule("minProperties", json!(1))
    .schema()
}

fn mass() -> Value {
    Table::new(keys::MASS, "Point masses")
        .must("group", group("nodes, facets or cells"))
        .must("mass", positive("Mass at each node of the group"))
        .one_or_more()
}

fn load() -> Value {
    Table::new(keys::LOAD, "What acts on the body: exactly one kind of load")
        .may("group", group("where the load acts; with acceleration and attraction left out: everywhere"))
        .may("traction", vector("Force per reference area of a group of facets [stress]"))
        .may("force", vector("Resultant, spread evenly over a group of facets [force]"))
        .may("nodal_force", vector("Force at each node of the group [force]"))
        .may(
            "pressure",
            number("Pressure on the current surface of a group of facets, positive onto the body [stress]"),
        )
        .may("acceleration", vector("Acceleration of every mass, such as gravity [length/time²]"))
        .may("attraction", attraction())
        .may(
            "drag",
            positive("Rate of a force -rate M v on the whole body (mass-proportional damping) [1/time]"),
        )
        .may("history", history("Factor over time; left out: 1"))
        .one_of(&[
            &["traction", "group"],
            &["force", "group"],
            &["nodal_force", "group"],
            &["pressure", "group"],
            &["acceleration"],
            &["attraction"],
            &["drag"],
        ])
        .one_or_more()
}

fn attraction() -> Value {
    let what = "Strength g of the potential -g m/distance [length³/time²]; negative: repulsion";
    Table::new(keys::ATTRACTION_TO_A_POINT, "Attraction of every mass to a point of space")
        .must("centre", vector("The point [length]"))
        .must("strength", json!({ "description": what, "type": "number", "not": { "const": 0 } }))
        .schema()
}

fn support() -> Value {
    let component = words(&["x", "y", "z"], "A component");
    let kinds = ["fix", "move", "rotate", "symmetry", "spring"].map(|kind| json!({ "required": [kind] }));
    Table::new(keys::SUPPORT, "What is held, moved or turned")
        .must("group", group("nodes, facets or cells"))
        .may("fix", list(1, component, "Components that do not move, such as [\"x\", \"y\", \"z\"]"))
        .may("move", motion())
        .may("rotate", rotation())
        .may("symmetry", json!({ "description": "The facets lie in a plane of symmetry", "const": true }))
        .may(
            "spring",
            positive("Stiffness to the ground: each node's [force/length], or of facets [force/length³]"),
        )
        .may("until", positive("Time from which on the support no longer holds"))
        .rule("anyOf", json!(kinds))
        .one_or_more()
}

fn motion() -> Value {
    Table::new(keys::MOVE, "Displacement of components over time, from 0 on")
        .may("x", history("Displacement along x [length]"))
        .may("y", history("Displacement along y [length]"))
        .may("z", history("Displacement along z [length]"))
        .rule("minProperties", json!(1))
        .schema()
}

fn rotation() -> Value {
    Table::new(keys::ROTATE, "Rotation of the group as a rigid body")
        .must("axis", vector("Direction of the axis, of any length"))
        .may("about", vector("A point of the axis [length]; left out: the origin"))
        .must("angle", history("Angle over time [radian], from 0 on"))
        .schema()
}

fn initial() -> Value {
    let row = exactly(3, json!({ "type": "number" }), "A row");
    Table::new(
        keys::INITIAL,
        "Velocities at the start: velocity + angular_velocity × (X - about) + gradient X",
    )
    .may("group", group("nodes, facets or cells; left out: all nodes"))
    .may("velocity", vector("Velocity [length/time]"))
    .may("angular_velocity", vector("Angular velocity [1/time]"))
    .may("about", vector("A point of the axis [length]"))
    .may("gradient", exactly(3, row, "Gradient of the velocity, row by row [1/time]"))
    .one_or_more()
}

fn time() -> Value {
    let degree = json!({
        "description": "Degree k of the time elements; of order 2k at the ends of the steps",
        "type": "integer", "minimum": 1, "maximum": MAX_DEGREE,
    });
    let mut time = Table::new(keys::TIME, "Scheme, degree and steps")
        .must("scheme", scheme())
        .may("degree", degree)
        .may("steps", list(1, phase(), "Phases of steps, from t = 0 on"))
        .may("adaptive", adaptive())
        .may("until", number("End of a run with adaptive steps"))
        .may(
            "smallest_step",
            positive("Size down to which a step that fails is cut; left out: 1/1024 of the step"),
        )
        .schema();
    time["anyOf"] = json!([{ "required": ["steps"] }, { "required": ["adaptive"] }]);
    time
}

/// Schemes that an editor offers; the numbers in them may be others.
const SCHEMES: [&str; 14] = [
    "DGM",
    "DGM(0.8)",
    "AS(5, 0.8)",
    "AS(1)",
    "AS(2)",
    "AS(5)",
    "FE(1)",
    "FE(2)",
    "trapezoidal",
    "Lobatto(2)",
    "Newmark(0.25, 0.5)",
    "HHT(0.05)",
    "generalized-alpha(0.8)",
    "Bathe",
];

fn scheme() -> Value {
    let number = r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*";
    let points = r"(FE|AS|Lobatto)\(\+?0*[1-9]\d*\)";
    let dissipative = format!(r"AS\(\s*\+?0*[1-9]\d*\s*,{number}\)|DGM\({number}\)");
    let pattern = format!(
        r"^({points}|{dissipative}|DGM|trapezoidal|Bathe|central-differences|Newmark\({number},{number}\)|(HHT|generalized-alpha)\({number}\))$"
    );
    let listed = SCHEMES.into_iter().chain(["central-differences"]).collect::<Vec<_>>();
    let what =
        "Scheme in time; `emmy list schemes` explains them. Of n Gauss points: FE(n), AS(n), Lobatto(n)";
    // An editor takes the word from the one branch and what to say of it from either.
    let branch = |key: &str, value: Value| json!({ "description": what, "type": "string", key: value });
    json!({
        "description": what,
        "type": "string",
        "anyOf": [branch("enum", json!(listed)), branch("pattern", json!(pattern))],
    })
}

fn adaptive() -> Value {
    let what = "Largest error of a step, relative to the scales, below 1";
    let tolerance =
        json!({ "description": what, "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 });
    Table::new(keys::ADAPTIVE, "Steps whose sizes are chosen by the error, in place of `steps`")
        .must("tolerance", tolerance)
        .may("min_size", positive("Smallest step; a step that is too inaccurate even then ends the run"))
        .may("max_size", positive("Largest step"))
        .may("first_size", positive("First step; left out: chosen from velocity and acceleration"))
        .may(
            "length",
            positive(
                "Scale of positions [length]; left out: the radius of gyration of the body's lumped masses",
            ),
        )
        .may(
            "velocity",
            positive("Scale of velocities [length/time]; left out: errors of velocities do not count"),
        )
        .may(
            "estimator",
            words(
                &ESTIMATORS.map(|(name, ..)| name),
                "How the error is estimated; left out: difference for degree 1, else sampled",
            ),
        )
        .may("min_degree", whole(1, "Lowest degree to choose from; left out: 1"))
        .may("max_degree", whole(1, "Highest degree to choose from; left out: `degree` stays as it is"))
        .schema()
}

fn phase() -> Value {
    Table::new(keys::PHASE, "Steps of one size")
        .must("until", number("Time at which the phase ends"))
        .must("size", positive("Step size; the last step is shortened to end on `until`"))
        .schema()
}

fn newton() -> Value {
    let what = "Relative size of the residual at which a step counts as solved, below 1";
    let tolerance =
        json!({ "description": what, "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 });
    Table::new(keys::NEWTON, "When the iteration of a step ends")
        .may("tolerance", tolerance)
        .may("max_iterations", whole(1, "Iterations before a step is given up (exit code 3)"))
        .schema()
}

fn solver() -> Value {
    let kinds = SOLVERS.map(|(name, ..)| name);
    Table::new(keys::SOLVER, "Solver of the linear systems")
        .must("kind", words(&kinds, "`emmy list solvers` explains them; left out: auto"))
        .schema()
}

fn output() -> Value {
    let directory = "Where results go, relative to the working directory; left out: the name of the input file without .toml";
    let field = words(&FieldName::ALL.map(FieldName::name), "A field");
    let mut fields = list(0, field, "Fields in the frames; `emmy list fields` explains them");
    fields["uniqueItems"] = json!(true);
    Table::new(keys::OUTPUT, "What is written, and where")
        .may("directory", text(directory))
        .may("every", whole(0, "Steps between frames; 0: no frames"))
        .may("interval", positive("Time between frames, in place of `every`; these times are met exactly"))
        .may(
            "format",
            words(&Format::ALL.map(Format::name), "Files of the frames: .vtu each, or one .vtkhdf"),
        )
        .may(
            "precision",
            words(&Precision::ALL.map(Precision::name), "Precision of the fields in the frames"),
        )
        .may("fields", fields)
        .may("checkpoint_every", whole(0, "Steps between checkpoints; 0: none"))
        .may("log_every", whole(0, "Steps between rows of newton.csv and between steps in run.log; 0: none"))
        .may("probes", list(0, probe(), "Nodes whose path goes into the history"))
        .schema()
}

fn probe() -> Value {
    let name = json!({
        "description": "Name of its columns: letters, digits, _ and -",
        "type": "string",
        "pattern": r"^[\w-]+$",
        "not": { "enum": ["linear_momentum", "angular_momentum"] },
    });
    Table::new(keys::PROBE, "A node that is followed")
        .must("name", name)
        .must("point", vector("Reference position; the nearest node is taken [length]"))
        .schema()
}

fn limits() -> Value {
    Table::new(keys::LIMITS, "What ends a run early (exit code 4)")
        .may("energy", positive("Largest accumulated energy residual, as a part of the largest T + |V|"))
        .may(
            "angular_momentum",
            positive("Largest accumulated angular momentum residual, as a part of the largest |L|"),
        )
        .schema()
}
