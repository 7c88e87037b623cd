//! Files of natural modes: `modes.toml`, `modes.csv`, and a frame for each mode.

use std::io;
use std::path::{Path, PathBuf};

use emmy::body::{FieldName, FieldValues};
use emmy::modes::Mode;

use crate::directory::{self, DirectoryError, Lock, MARK};
use crate::input::Problem;
use crate::vtk::FrameWriter;
use crate::whole_file::replace;

/// Kind of the directory, in messages.
const KIND: &str = "natural modes";

/// The file by which the directory is recognized: the input.
pub const WITNESS: &str = "modes.toml";

/// The table of the modes.
pub const TABLE: &str = "modes.csv";

/// Columns of [`TABLE`].
const COLUMNS: &str =
    "mode,angular_frequency,frequency,period,effective_mass_x,effective_mass_y,effective_mass_z,residual";

/// Largest displacement of a mode in a frame, relative to the diagonal of the body.
const AMPLITUDE: f64 = 0.08;

/// Checks that modes may be written into a directory. Nothing is changed.
///
/// # Errors
/// [`DirectoryError`].
pub fn check(directory: &Path, problem: &Problem) -> Result<(), DirectoryError> {
    directory::check_kind(directory, KIND, WITNESS)?;
    directory::check_sources(directory, &problem.files)
}

/// Writes modes about a displacement `[n_nodes][3]` into a directory, in place of earlier ones; returns the path of the
/// frames.
///
/// Frame 0 is the body at rest, frame i adds mode i to it, its largest displacement 8 % of the body's diagonal.
///
/// # Errors
/// [`DirectoryError`].
pub fn write(
    directory: &Path,
    problem: &Problem,
    displacement: &[f64],
    modes: &[Mode],
) -> Result<PathBuf, DirectoryError> {
    check(directory, problem)?;
    let system = |error| DirectoryError::System { path: directory.to_path_buf(), error };
    std::fs::create_dir_all(directory).map_err(system)?;
    let _lock = Lock::take(directory)?;
    let written = || -> io::Result<PathBuf> {
        replace(&directory.join(WITNESS), input(problem).as_bytes())?;
        directory::remove_frames(directory)?;
        let path = write_frames(directory, problem, displacement, modes)?;
        replace(&directory.join(TABLE), csv(modes).as_bytes())?;
        Ok(path)
    };
    written().map_err(system)
}

/// The resolved input with its mark.
fn input(problem: &Problem) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("{MARK} {version}: the input of these natural modes.\n\n{}", problem.resolved)
}

/// Numbers have 17 significant digits.
fn csv(modes: &[Mode]) -> String {
    let row = |(index, mode): (usize, &Mode)| {
        let [x, y, z] = mode.effective_mass;
        let numbers = [mode.angular_frequency, mode.frequency(), mode.period(), x, y, z, mode.residual];
        format!("{},{}\n", index + 1, numbers.map(|number| format!("{number:.16e}")).join(","))
    };
    format!("{COLUMNS}\n{}", modes.iter().enumerate().map(row).collect::<String>())
}

fn write_frames(
    directory: &Path,
    problem: &Problem,
    displacement: &[f64],
    modes: &[Mode],
) -> io::Result<PathBuf> {
    let body = &problem.body;
    let form = (problem.output.format, problem.output.precision);
    let mut frames = FrameWriter::create(form, directory, body)?;
    let diagonal = body.mesh().diagonal();
    let mut write = |step: usize, numbers: Vec<f64>| {
        frames.write(step, step as f64, &[FieldValues { name: FieldName::Displacement, numbers }])
    };
    // The internal nodes of cells are not drawn.
    let n = body.mesh().n_dofs();
    let displacement = &displacement[..n];
    write(0, displacement.to_vec())?;
    for (index, mode) in modes.iter().enumerate() {
        let shape = &mode.shape[..n];
        let scale = AMPLITUDE * diagonal / largest(shape);
        let added = displacement.iter().zip(shape).map(|(u, v)| u + scale * v);
        write(index + 1, added.collect())?;
    }
    frames.finish()?;
    Ok(frames.path())
}

/// Largest length of a vector; `shape: [n_nodes][3]`.
fn largest(shape: &[f64]) -> f64 {
    let square = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
    shape.as_chunks().0.iter().map(square).fold(0.0, f64::max).sqrt()
}
