//! Estimated sizes of the files of a run.

use emmy::body::Place;

use crate::history::HistoryColumns;
use crate::input::Problem;
use crate::vtk::Format;

/// Bytes of a number with 17 digits and a comma in `history.csv`, averaged over signs and exponents.
const NUMBER: f64 = 22.5;

/// Bytes of a count and its comma.
const COUNT: f64 = 5.0;

/// Columns of counts: `step`, `newton_iterations`.
const COUNTS: usize = 2;

/// Bytes of a step in `newton.csv`, with six evaluations of the residual, and in `run.log`.
const LOGGED_STEP: f64 = 6.0 * 33.0 + 117.0;

/// Bytes of a number in a checkpoint.
const CHECKPOINT_NUMBER: f64 = 8.0;

/// Bytes of the files of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// A row of `history.csv`.
    pub row: f64,
    /// A step in `newton.csv` and `run.log`, averaged over all steps.
    pub logged_step: f64,
    /// A frame before compression.
    pub frame: f64,
    /// A checkpoint.
    pub checkpoint: f64,
}

impl Sizes {
    /// The sizes for a problem.
    pub fn of(problem: &Problem) -> Self {
        let output = &problem.output;
        let n_columns = HistoryColumns::of(problem).names().len();
        let n_dofs = problem.body.n_dofs() as f64;
        Sizes {
            row: (n_columns - COUNTS) as f64 * NUMBER + COUNTS as f64 * COUNT,
            logged_step: if output.log_every == 0 { 0.0 } else { LOGGED_STEP / output.log_every as f64 },
            frame: frame(problem),
            // The state and the memory of a stepper of degree k.
            checkpoint: CHECKPOINT_NUMBER * (6 + problem.scheme.degree()) as f64 * n_dofs
                + problem.resolved.len() as f64,
        }
    }
}

/// Bytes of a frame before compression: its fields; with a file each also points, cells and groups, and as text of 64
/// characters.
fn frame(problem: &Problem) -> f64 {
    let mesh = problem.body.mesh();
    let output = &problem.output;
    let fields = output.fields.iter().filter(|name| problem.body.has_field(**name)).map(|name| {
        let n = if name.place() == Place::Nodes { mesh.n_nodes() } else { mesh.n_cells() };
        (n * name.components().len() * output.precision.width()) as f64
    });
    let fields: f64 = fields.sum();
    if output.format == Format::Vtkhdf {
        return fields;
    }
    let corners: usize = mesh.cells().map(|cell| cell.nodes.len()).sum();
    let groups = mesh.groups();
    let marks =
        groups.nodes.len() * mesh.n_nodes() + (groups.cells.len() + groups.facets.len()) * mesh.n_cells();
    let same = 24 * mesh.n_nodes() + 13 * mesh.n_cells() + 8 * corners + marks;
    4.0 / 3.0 * (fields + same as f64)
}

/// A number of bytes with two or three digits.
pub fn bytes(n: f64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB"];
    let power =
        (0..units.len() - 1).find(|&power| n < 1000f64.powi(power as i32 + 1)).unwrap_or(units.len() - 1);
    let value = n / 1000f64.powi(power as i32);
    let digits = usize::from(value < 10.0 && power > 0);
    format!("{value:.digits$} {}", units[power])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_their_unit() {
        let texts = [12.0, 1234.0, 385e6, 4.04e9, 385e12].map(bytes);
        assert_eq!(texts, ["12 B", "1.2 kB", "385 MB", "4.0 GB", "385 TB"]);
    }
}
