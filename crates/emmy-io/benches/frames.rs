//! A frame of a block of 97,336 bricks (103,823 nodes) as written by a run: the fields, the file of each format, and
//! its size.
//!
//!     cargo bench -p emmy-io --bench frames

#![allow(non_snake_case)]

use divan::{Bencher, black_box};
use emmy::body::{Body, Region};
use emmy::body::{FieldName, FieldValues, Fields};
use emmy::material::NeoHooke;
use emmy::mesh::block;
use emmy_io::vtk::{Format, FrameWriter, Precision};
use tempfile::TempDir;

const MOTION: [FieldName; 2] = [FieldName::Displacement, FieldName::Velocity];

fn main() {
    let (body, state) = (body(), state(&body()));
    let fields = Fields::new(&body);
    for (what, values) in
        [("motion only", values(&fields, &state, &MOTION)), ("all nodal fields", all(&fields, &state))]
    {
        for format in Format::ALL {
            let temp = tempfile::tempdir().unwrap();
            let mut writer = writer(&temp, format, &body);
            let before = size(&temp);
            writer.write(0, 0.0, &values).unwrap();
            writer.finish().unwrap();
            println!("{}, {what}: {:.1} MB a frame", format.name(), (size(&temp) - before) as f64 / 1e6);
        }
    }
    divan::main();
}

fn body() -> Body {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0);
    Body::builder(block([1.0; 3], [46; 3]).unwrap()).region(rubber).build().unwrap()
}

/// A smooth bending with noise in the last digits, like a solution.
fn state(body: &Body) -> Vec<f64> {
    let noise = |i: usize| 1e-11 * (12.9898 * i as f64).sin();
    let u = |(i, X): (usize, &[f64; 3])| {
        [0.1 * (3.0 * X[1]).sin(), 0.1 * X[0] * X[2], 0.1 * (2.0 * X[0]).cos()].map(|u| u + noise(i))
    };
    body.mesh().points().iter().enumerate().flat_map(u).collect()
}

fn values(fields: &Fields, state: &[f64], names: &[FieldName]) -> Vec<FieldValues> {
    fields.at([state, state], names)
}

/// The default fields.
fn all(fields: &Fields, state: &[f64]) -> Vec<FieldValues> {
    values(fields, state, &FieldName::ALL[..9])
}

fn writer(temp: &TempDir, format: Format, body: &Body) -> FrameWriter {
    FrameWriter::create((format, Precision::Double), &temp.path().join("out"), body).unwrap()
}

fn size(temp: &TempDir) -> u64 {
    let files = |directory| std::fs::read_dir(directory).into_iter().flatten().flatten();
    let all = files(temp.path().join("out")).chain(files(temp.path().join("out/frames")));
    all.filter_map(|file| file.metadata().ok()).filter(|file| file.is_file()).map(|file| file.len()).sum()
}

#[divan::bench(sample_count = 10)]
fn nodal_fields(bencher: Bencher<'_, '_>) {
    let body = body();
    let (fields, state) = (Fields::new(&body), state(&body));
    bencher.bench(|| all(&fields, black_box(&state)));
}

#[divan::bench(sample_count = 10)]
fn cell_fields(bencher: Bencher<'_, '_>) {
    let body = body();
    let (fields, state) = (Fields::new(&body), state(&body));
    bencher.bench(|| values(&fields, black_box(&state), &FieldName::ALL[9..13]));
}

#[divan::bench(sample_count = 10, args = ["vtu", "vtkhdf"])]
fn file_of_the_motion(bencher: Bencher<'_, '_>, format: &str) {
    file(bencher, format, &MOTION);
}

#[divan::bench(sample_count = 10, args = ["vtu", "vtkhdf"])]
fn file_of_all_nodal_fields(bencher: Bencher<'_, '_>, format: &str) {
    file(bencher, format, &FieldName::ALL[..9]);
}

fn file(bencher: Bencher<'_, '_>, format: &str, names: &[FieldName]) {
    let format = Format::ALL.into_iter().find(|own| own.name() == format).unwrap();
    let (body, temp) = (body(), tempfile::tempdir().unwrap());
    let values = values(&Fields::new(&body), &state(&body), names);
    let (mut writer, mut step) = (writer(&temp, format, &body), 0);
    bencher.bench_local(|| {
        step += 1;
        writer.write(step, step as f64, &values).unwrap();
    });
}
