//! Frames that would take much room: smaller defaults of `[output]`, and advice.

use emmy::body::FieldName;

use super::complete;
use super::problem::Problem;
use super::tree::{Node, Value};
use crate::sizes::{Sizes, bytes};
use crate::vtk::Precision;

/// Bytes of all frames above which the defaults are smaller and a note gives advice.
const LARGE: f64 = 1e8;

/// Frames of a plan by the smaller defaults.
const FRAMES: usize = 100;

/// Fields by the smaller defaults.
const FIELDS: [FieldName; 4] =
    [FieldName::Displacement, FieldName::VonMisesStress, FieldName::LargestStretch, FieldName::AxialForce];

/// Which keys of `[output]` an input leaves out.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeftOut {
    frames: bool,
    precision: bool,
    fields: bool,
}

impl LeftOut {
    /// Those of a tree without its defaults.
    pub(super) fn of(tree: &mut Node) -> Self {
        let mut has = |key: &str| tree.get_mut("output").is_some_and(|own| own.get_mut(key).is_some());
        LeftOut {
            frames: !has("every") && !has("interval"),
            precision: !has("precision"),
            fields: !has("fields"),
        }
    }
}

/// Bytes of all frames before compression, on a team those of all ranks; of adaptive steps those of `FRAMES` frames.
fn planned(problem: &Problem) -> f64 {
    let mut frame = [Sizes::of(problem).frame];
    problem.body.ranks().sum("bytes of a frame", &mut frame);
    frame[0] * problem.output.n_frames(&problem.plan).unwrap_or(FRAMES) as f64
}

/// Gives a problem and its input smaller defaults if its frames would be large, with a note; or advice if they remain
/// large. A call of all ranks. Returns whether the input has changed.
pub(super) fn reduce(problem: &mut Problem, tree: &mut Node, left_out: LeftOut) -> bool {
    let before = planned(problem);
    if before <= LARGE {
        return false;
    }
    let mut smaller = Vec::new();
    let place = tree.place.clone();
    let mut put = |key: &str, value: Value| {
        if let Some(output) = tree.get_mut("output") {
            output.put(key, Node { value, place: place.clone() });
        }
    };
    let n_steps = problem.plan.n_steps();
    if left_out.frames && problem.plan.adaptivity().is_none() && n_steps > FRAMES {
        let every = n_steps.div_ceil(FRAMES);
        problem.output.every = every;
        put("every", Value::Integer(every as i64));
        smaller.push(format!("every = {every}"));
    }
    if left_out.precision {
        problem.output.precision = Precision::Single;
        put("precision", Value::String(Precision::Single.name().to_string()));
        smaller.push(format!("precision = \"{}\"", Precision::Single.name()));
    }
    if left_out.fields {
        let fields: Vec<FieldName> =
            FIELDS.into_iter().filter(|field| problem.body.has_field(*field)).collect();
        let names = || fields.iter().map(|field| field.name());
        let items = names().map(|name| complete::string(name, &place)).collect();
        put("fields", Value::Array(items));
        let names = names().map(|name| format!("\"{name}\"")).collect::<Vec<String>>();
        smaller.push(format!("fields = [{}]", names.join(", ")));
        problem.output.fields = fields;
    }
    let after = planned(problem);
    if !smaller.is_empty() {
        problem.notes.push(format!(
            "all fields in every step would take {} of frames; the defaults of [output] are here: {}",
            bytes(before),
            smaller.join(", ")
        ));
    }
    if after > LARGE {
        problem.notes.push(format!(
            "the frames take up to {}: fewer of them (`every`, `interval`), fewer `fields`, `precision = \"single\"` and \
             `format = \"vtkhdf\"` need less",
            bytes(after)
        ));
    }
    !smaller.is_empty()
}
