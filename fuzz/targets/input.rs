//! Any bytes as an input file: a problem, or faults with positions inside the text, never a panic.

#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use emmy_io::input::{self, Overrides};
use libfuzzer_sys::fuzz_target;

/// A folder in memory, if possible.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    folder.expect("a folder of its own")
});

fuzz_target!(|bytes: &[u8]| {
    if is_large(bytes) {
        return;
    }
    let file = FOLDER.path().join("input.toml");
    std::fs::write(&file, bytes).expect("a file of its own");
    match input::read(&file, &Overrides::default()) {
        Ok(problem) => assert!(problem.plan.n_steps() > 0 && !problem.resolved.is_empty()),
        Err(error) => {
            assert!(!error.faults().is_empty() && !error.to_string().is_empty());
            for place in error.faults().iter().filter_map(|fault| fault.place()) {
                assert!(place.line() <= bytes.len() + 1 && place.column() <= bytes.len() + 1);
            }
        }
    }
});

/// Whether a built-in mesh has more than some thousand cells, which takes too long for a fuzzer.
fn is_large(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(input) = text.parse::<toml::Table>() else { return false };
    let Some(mesh) = input.get("mesh") else { return false };
    let parts = mesh.get("parts").and_then(toml::Value::as_array);
    [mesh].into_iter().chain(parts.into_iter().flatten()).any(is_large_shape)
}

fn is_large_shape(mesh: &toml::Value) -> bool {
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|value| value as f64));
    let product = |shape: &str| {
        let cells = mesh.get(shape)?.get("cells")?.as_array()?;
        Some(cells.iter().filter_map(number).product::<f64>())
    };
    // About 2.5 r^2 cells in a layer of a cylinder, and 4 r^3 in a ball.
    let around = |shape: &str| number(mesh.get(shape)?.get("cells")?.as_array()?.first()?);
    let layers = product("cylinder").zip(around("cylinder")).map(|(product, radial)| 3.0 * product * radial);
    let of_ball = mesh.get("ball").and_then(|shape| number(shape.get("cells")?)).map(|radial| 5.0 * radial.powi(3));
    let cell_size = mesh.get("l-block").and_then(|shape| number(shape.get("cell_size")?));
    cell_size.is_some_and(|size| size < 0.4)
        || [layers, of_ball].into_iter().chain(["box", "rectangle", "ring"].map(product)).any(|n| n > Some(2000.0))
}
