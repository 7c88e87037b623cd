//! Frames read back: the arrays of a `.vtu` are the state, bit for bit, and the arrays of a `.vtkhdf` are the same.

use std::io::Read;
use std::path::Path;

use base64::{Engine, engine::general_purpose::STANDARD};
use emmy::body::{FieldName, FieldValues, Fields, Place};
use emmy::motion::{Motion, ReferenceMotion, State};
use emmy_io::input::{self, Overrides, Problem};
use emmy_io::results::Results;
use emmy_io::summary::Status;
use emmy_io::vtk::{Precision, Series, SeriesReader};

const INPUT: &str = "\
    mesh.box = { size = [1, 2, 1], cells = [2, 2, 1] }\n\
    region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]\n\
    initial = { angular_velocity = [0.1, 0.2, 0.3], gradient = [[0.1, 0, 0], [0, 0, 0], [0, 0, 0]] }\n\
    time = { scheme = 'DGM', degree = 2, steps = [{ until = 0.5, size = 0.1 }] }\n\
    output.every = 5\n";

/// The bytes of an array of a frame.
fn bytes(xml: &str, name: &str) -> Vec<u8> {
    let element = &xml[xml.find(&format!("Name=\"{name}\"")).unwrap()..];
    let text = &element[element.find('>').unwrap() + 1..element.find("</DataArray>").unwrap()];
    let number =
        |bytes: &[u8], i: usize| u64::from_le_bytes(bytes[8 * i..8 * i + 8].try_into().unwrap()) as usize;
    let n_blocks = number(&STANDARD.decode(&text[..12]).unwrap(), 0);
    let split = (8 * (3 + n_blocks)).div_ceil(3) * 4;
    let (header, data) = (STANDARD.decode(&text[..split]).unwrap(), STANDARD.decode(&text[split..]).unwrap());
    let (mut bytes, mut at) = (Vec::new(), 0);
    for block in 0..n_blocks {
        let size = number(&header, 3 + block);
        flate2::read::ZlibDecoder::new(&data[at..at + size]).read_to_end(&mut bytes).unwrap();
        at += size;
    }
    assert_eq!(at, data.len());
    bytes
}

fn floats(xml: &str, name: &str) -> Vec<f64> {
    bytes(xml, name).chunks(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap())).collect()
}

fn integers(xml: &str, name: &str) -> Vec<i64> {
    bytes(xml, name).chunks(8).map(|chunk| i64::from_le_bytes(chunk.try_into().unwrap())).collect()
}

fn problem(directory: &Path, set: &[&str]) -> Problem {
    let file = directory.join("box.toml");
    std::fs::write(&file, INPUT).unwrap();
    let (output, set) = (Some(directory.join("out")), set.iter().map(ToString::to_string).collect());
    input::read(&file, &Overrides { output, set, ..Default::default() }).unwrap()
}

/// The last state of a run that ends, or that is dropped before its end.
fn run(problem: &Problem, ends: bool) -> State {
    let state = State::initial(&problem.body, 0.0, &problem.initial).unwrap();
    let motion = Motion::starting(&problem.body, problem.scheme, problem.newton, state).unwrap();
    let mut motion = problem.settled(motion);
    let mut results = Results::create(problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    if ends {
        assert!(results.finish(problem, &motion, Status::Done, None).error.is_none());
    }
    motion.state().clone()
}

/// The frame of the last state of a run, with the state.
fn frame(directory: &Path) -> (String, State, emmy::mesh::Mesh) {
    let problem = problem(directory, &[]);
    let state = run(&problem, true);
    (read(directory, 5), state, problem.body.mesh().clone())
}

fn read(directory: &Path, step: usize) -> String {
    std::fs::read_to_string(directory.join(format!("out/frames/out_{step:06}.vtu"))).unwrap()
}

fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(directory.join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn arrays_of_a_frame_are_the_state() {
    let temp = tempfile::tempdir().unwrap();
    let (xml, state, mesh) = frame(temp.path());
    assert_eq!(state.step, 5);
    assert!(state.displacement.iter().any(|u| u.abs() > 1e-2));
    assert_eq!(floats(&xml, "displacement"), state.displacement);
    assert_eq!(floats(&xml, "velocity"), state.velocity);
    let points: Vec<f64> = mesh.points().iter().flatten().copied().collect();
    assert_eq!(floats(&xml, "Points"), points);
    let nodes: Vec<i64> = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| node.into())).collect();
    assert_eq!(integers(&xml, "connectivity"), nodes);
    assert_eq!(integers(&xml, "offsets"), [8, 16, 24, 32]);
    assert_eq!((bytes(&xml, "types"), bytes(&xml, "region")), (vec![12; 4], vec![0; 16]));
    assert!(xml.contains(
        "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.5<"
    ));
}

/// Displacements and accelerations are those in the frame of reference, stresses do not depend on it.
#[test]
fn frames_have_the_frame_of_reference_of_the_input() {
    let fields = "output.fields=[\"displacement\", \"acceleration\", \"von_mises_stress\"]";
    let [(_, absolute, state), (body, relative, same)] = ["ground", "rigid-motion"].map(|name| {
        let temp = tempfile::tempdir().unwrap();
        let problem = problem(temp.path(), &[fields, &format!("output.relative_to=\"{name}\"")]);
        let state = run(&problem, true);
        (problem.body, read(temp.path(), 5), state)
    });
    assert_eq!(state, same);
    let [expected, _] = ReferenceMotion::of_body().seen(&body, &state.displacement, &state.velocity);
    assert_eq!(floats(&absolute, "displacement"), state.displacement);
    assert_eq!(floats(&relative, "displacement"), expected);
    assert_eq!(floats(&relative, "von_mises_stress"), floats(&absolute, "von_mises_stress"));
    // A free body has no mean acceleration.
    let masses = body.lumped_mass();
    for accelerations in [&absolute, &relative].map(|xml| floats(xml, "acceleration")) {
        let sum = |d: usize| masses.iter().zip(accelerations.chunks(3)).map(|(m, a)| m * a[d]).sum::<f64>();
        let size: f64 = accelerations.iter().map(|a| a.abs()).sum();
        assert!(size > 1.0 && (0..3).all(|d| sum(d).abs() < 1e-10 * size), "{size}");
    }
}

/// The eight fields at the nodes, whose names never change.
const NODAL: [(&str, usize); 8] = [
    ("displacement", 3),
    ("velocity", 3),
    ("momentum_density", 3),
    ("cauchy_stress", 6),
    ("second_piola_kirchhoff_stress", 6),
    ("von_mises_stress", 1),
    ("principal_stretches", 3),
    ("strain_energy_density", 1),
];

#[test]
fn frames_have_the_fields_of_their_state_and_no_stress_at_the_start() {
    let temp = tempfile::tempdir().unwrap();
    let (xml, state, mesh) = frame(temp.path());
    let problem = problem(temp.path(), &[]);
    let fields = Fields::new(&problem.body).at([&state.displacement, &state.velocity], &FieldName::ALL);
    let start = read(temp.path(), 0);
    for (name, components) in NODAL {
        let field = fields.iter().find(|field| field.name.name() == name).unwrap();
        assert_eq!(floats(&xml, name), field.numbers, "{name}");
        assert_eq!(field.numbers.len(), components * mesh.n_nodes());
        assert!(xml.contains(&format!("Name=\"{name}\" NumberOfComponents=\"{components}\"")));
        if name.contains("stress") || name.contains("energy") {
            assert!(floats(&start, name).iter().all(|&value| value == 0.0), "{name}");
            assert!(field.numbers.iter().any(|&value| value.abs() > 1e-6), "{name}");
        }
    }
    assert!(floats(&start, "principal_stretches").iter().all(|&stretch| stretch == 1.0));
    let names = "ComponentName0=\"xx\" ComponentName1=\"yy\" ComponentName2=\"zz\" ComponentName3=\"xy\" \
                 ComponentName4=\"yz\" ComponentName5=\"xz\"";
    assert_eq!(xml.matches(names).count(), 2);
    assert!(!xml.contains("axial_force") && !xml.contains("cell_"));
}

#[test]
fn fields_are_those_that_are_asked_for() {
    let temp = tempfile::tempdir().unwrap();
    run(&problem(temp.path(), &["output.fields=['cell_cauchy_stress', 'velocity']"]), true);
    let xml = read(temp.path(), 5);
    assert_eq!(floats(&xml, "cell_cauchy_stress").len(), 6 * 4);
    let cell_data = xml.find("<CellData").unwrap();
    assert!(xml.find("cell_cauchy_stress").unwrap() > cell_data && xml.find("velocity").unwrap() < cell_data);
    assert!(!xml.contains("displacement"));
}

const ONE_FILE: &str = "output.format=vtkhdf";

#[test]
fn one_file_holds_the_same_data_as_the_frames() {
    let (frames, series) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let names_set = format!("output.fields={:?}", FieldName::ALL.map(FieldName::name));
    run(&problem(frames.path(), &[&names_set, "output.every=1"]), true);
    let problem = problem(series.path(), &[&names_set, "output.every=1", ONE_FILE]);
    run(&problem, true);
    assert_eq!(
        names(series.path()),
        [
            ".lock",
            "checkpoint",
            "events.csv",
            "history.csv",
            "input.toml",
            "newton.csv",
            "out.vtkhdf",
            "run.log",
            "summary.json"
        ]
    );
    let series = SeriesReader::open(&series.path().join("out/out.vtkhdf")).unwrap();
    assert_eq!(series.mesh().unwrap(), *problem.body.mesh());
    assert_eq!(series.times(), [0.0, 0.1, 0.2, 0.30000000000000004, 0.4, 0.5]);
    let expected = FieldName::ALL.into_iter().filter(|&name| problem.body.has_field(name));
    assert_eq!(expected.clone().count(), FieldName::ALL.len() - 3); // no axial force, no contact
    assert!(series.fields().into_iter().eq(expected));
    for step in 0..6 {
        let xml = read(frames.path(), step);
        for name in series.fields() {
            // At the start there is no acceleration.
            let [own, there] = [series.values(name, step).unwrap(), floats(&xml, name.name())];
            let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
            assert!(own.len() == there.len() && own.iter().zip(&there).all(is_same), "{name}");
        }
    }
    assert!(series.values(FieldName::Velocity, 6).is_err());
    assert!(series.values(FieldName::AxialForce, 0).is_err());
}

/// Like a killed run, which writes nothing more.
#[test]
fn a_run_that_is_given_up_leaves_a_whole_file() {
    let temp = tempfile::tempdir().unwrap();
    run(&problem(temp.path(), &["output.every=1", ONE_FILE]), false);
    assert!(names(temp.path()).contains(&"out.vtkhdf".to_string()));
    let series = SeriesReader::open(&temp.path().join("out/out.vtkhdf")).unwrap();
    let n = series.times().len();
    assert!((1..=6).contains(&n));
    let last = series.values(FieldName::Velocity, n - 1).unwrap();
    assert!(last.iter().any(|v| v.abs() > 0.01));
    // The next run removes the files of this one.
    run(&problem(temp.path(), &[]), true);
    assert_eq!(
        names(temp.path()),
        [
            ".lock",
            "checkpoint",
            "events.csv",
            "frames",
            "history.csv",
            "input.toml",
            "newton.csv",
            "out.pvd",
            "run.log",
            "summary.json"
        ]
    );
}

#[test]
fn single_precision_keeps_seven_digits_in_both_formats() {
    let (frames, series) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let single = "output.precision=single";
    let state = run(&problem(frames.path(), &[single]), true);
    run(&problem(series.path(), &[single, ONE_FILE]), true);
    let series = SeriesReader::open(&series.path().join("out/out.vtkhdf")).unwrap();
    let xml = read(frames.path(), 5);
    let found = bytes(&xml, "displacement");
    let found = found.chunks(4).map(|chunk| f32::from_le_bytes(chunk.try_into().unwrap()));
    assert!(found.eq(state.displacement.iter().map(|&u| u as f32)));
    let one = series.values(FieldName::Displacement, 1).unwrap();
    assert!(one.iter().zip(&state.displacement).all(|(&one, &u)| one == f64::from(u as f32)));
    assert!(xml.contains("type=\"Float64\" Name=\"Points\""));
}

/// Several chunks of different kinds of fields.
#[test]
fn large_frames_are_divided_and_come_back() {
    let temp = tempfile::tempdir().unwrap();
    let mesh = emmy::mesh::block([1.0; 3], [40, 40, 30]).unwrap();
    let [n_nodes, n_cells] = [mesh.n_nodes(), mesh.n_cells()];
    let field = |name: FieldName, k: usize| {
        let n = if name.place() == Place::Nodes { n_nodes } else { n_cells };
        let numbers = (0..n * name.components().len()).map(|i| ((i * (k + 1)) as f64).sin());
        FieldValues { name, numbers: numbers.collect() }
    };
    let frame = |k: usize| FieldName::ALL.map(|name| field(name, k));
    let mut series = Series::create(temp.path(), Precision::Double, &mesh, &vec![0; n_cells]).unwrap();
    (0..3).for_each(|k| series.write(k, k as f64, &frame(k)).unwrap());
    let others = series.write(3, 3.0, &frame(3)[..2]).unwrap_err().to_string();
    assert!(others.contains("the same fields in every frame"), "{others}");
    series.finish().unwrap();
    let reader = SeriesReader::open(series.path()).unwrap();
    assert_eq!(reader.times(), [0.0, 1.0, 2.0]);
    for k in 0..3 {
        for field in frame(k) {
            assert!(reader.values(field.name, k).unwrap() == field.numbers, "{}", field.name);
        }
    }
}
