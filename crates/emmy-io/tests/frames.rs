//! Frames read back: the arrays of a `.vtu` are the state, bit by bit.

use std::io::Read;
use std::path::Path;

use base64::{Engine, engine::general_purpose::STANDARD};
use emmy::motion::{Motion, State};
use emmy_io::input::{self, Overrides};
use emmy_io::results::Results;
use emmy_io::summary::Status;

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

/// The frame of the last state of a run, and what the run knew.
fn frame(directory: &Path) -> (String, State, emmy::mesh::Mesh) {
    let file = directory.join("box.toml");
    std::fs::write(&file, INPUT).unwrap();
    let output = Some(directory.join("out"));
    let problem = input::read(&file, &Overrides { output, ..Default::default() }).unwrap();
    let state = State::initial(&problem.body, 0.0, &problem.initial).unwrap();
    let mut motion =
        Motion::new(&problem.body, problem.scheme, problem.degree, problem.newton, state).unwrap();
    let mut results = Results::create(&problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    results.finish(motion.state(), Status::Done, None).unwrap();
    let xml = std::fs::read_to_string(directory.join("out/frames/out_000005.vtu")).unwrap();
    (xml, motion.state().clone(), problem.body.mesh().clone())
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
