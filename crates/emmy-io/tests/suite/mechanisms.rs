//! Joints and rigid bodies in the files of a run.

use std::path::Path;

use emmy::body::FieldName;
use emmy::mesh::CellKind;
use emmy_io::history::History;
use emmy_io::input::{self, Overrides, Problem};
use emmy_io::mesh;
use emmy_io::report;
use emmy_io::results::Results;
use emmy_io::summary::Status;
use emmy_io::vtk::SeriesReader;

/// An elastic block that carries a rigid body at a corner, and a point mass on a link.
const INPUT: &str = "\
    mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }\n\
    region = [{ density = 2, material.neo-hooke = { lambda = 1000, mu = 500 } }]\n\
    rigid = [\n\
        { name = 'hub', mass = 2, centre = [0, 2.5, 0], inertia = [0.2, 0.3, 0.25] },\n\
        { name = 'ball', mass = 1, centre = [3, 2, 0] },\n\
    ]\n\
    joint = [\n\
        { name = 'corner', spherical = { between = ['y-max', 'hub'], at = [0, 2, 0] } },\n\
        { distance = { between = ['ball', 'y-max'], points = [[3, 2, 0], [1, 2, 0]], length = '2 + 0.1*t^2' } },\n\
    ]\n\
    support = [{ group = 'y-min', fix = ['x', 'y', 'z'] }]\n\
    load = [{ acceleration = [0, 0, -9.81] }]\n\
    time = { scheme = 'DGM', degree = 2, steps = [{ until = 0.2, size = 0.05 }] }\n\
    output.fields = ['displacement', 'cell_volume_ratio']\n";

fn run(directory: &Path, set: &[&str]) -> Problem {
    let file = directory.join("hub.toml");
    std::fs::write(&file, INPUT).unwrap();
    let (output, set) = (Some(directory.join("out")), set.iter().map(ToString::to_string).collect());
    let problem = input::read(&file, &Overrides { output, set, ..Default::default() }).unwrap();
    let mut motion = problem.motion(&mut []).unwrap();
    let mut results = Results::create(&problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());
    drop(motion);
    problem
}

#[test]
fn joints_and_rigid_bodies_have_columns_and_a_place_in_the_summary() {
    let temp = tempfile::tempdir().unwrap();
    run(temp.path(), &[]);
    let out = temp.path().join("out");
    let history = History::read(&out.join("history.csv")).unwrap();
    let column = |name: &str| history.column(name).unwrap_or_else(|| panic!("no {name}"));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    for name in ["corner_force_x", "corner_moment_z", "joint-2_force_y", "joint-2_drive_force"] {
        let numbers = column(name);
        assert!(numbers[0].is_nan() && numbers[1..].iter().all(|number| number.is_finite()), "{name}");
        assert_eq!(summary[name].as_f64(), numbers.last().copied(), "{name}");
    }
    assert!((column("joint-2_distance")[4] - 2.004).abs() < 1e-13);
    assert!(history.column("corner_angle").is_none() && history.column("ball_spin_x").is_none());
    assert_eq!((column("hub_y")[0], column("hub_spin_x")[0]), (2.5, 0.0));
    assert!(column("ball_z")[4] < 0.0 && summary["ball_z_min"].as_f64() == Some(column("ball_z")[4]));
    let worst = column("constraint_residual").into_iter().fold(0.0, f64::max);
    assert!(worst < 1e-13 && summary["worst_constraint_residual"].as_f64() == Some(worst));
    assert_eq!(summary["constraints"].as_u64(), Some(4));
    assert_eq!(summary["largest_hidden_constraint"], summary["hidden_constraint_max"]);
    let page = std::fs::read_to_string(report::write(&out).unwrap()).unwrap();
    for part in [r#""kind":"spherical""#, r#""kind":"distance""#, r#""name":"joint-2""#] {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.contains(r#""rigid":["hub","ball"]"#));
}

#[test]
fn a_column_cannot_be_that_of_a_joint() {
    let read = |set: &str| {
        let temp = tempfile::tempdir().unwrap();
        let file = temp.path().join("hub.toml");
        std::fs::write(&file, INPUT).unwrap();
        let set = vec![set.to_string()];
        input::read(&file, &Overrides { set, ..Default::default() }).unwrap_err().to_string()
    };
    let value = "output.values=[{ name = 'corner_force_x', quantity = 'velocity', measure = 'max' }]";
    let error = read(value);
    assert!(error.contains("there is a column `corner_force_x` already"), "{error}");
    let error = read("joint.0.name='y-min'");
    assert!(error.contains("`y-min` would have a column `y-min_force_x`, which is there already"), "{error}");
}

/// Vertices at the centres and lines along the axes, behind the cells of the mesh.
#[test]
fn rigid_bodies_are_in_the_frames() {
    let [files, series] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let problem = run(files.path(), &[]);
    let frame = files.path().join("out/frames/out_000004.vtu");
    let file = mesh::read(&frame).unwrap();
    // The mesh of a frame is that of the input.
    assert_eq!((file.mesh.n_nodes(), file.mesh.n_cells()), (12, 2));
    assert!(file.mesh.cells().all(|cell| cell.kind == CellKind::Hex8));
    run(series.path(), &["output.format=vtkhdf"]);
    let series = SeriesReader::open(&series.path().join("out/out.vtkhdf")).unwrap();
    let ratios = series.values(FieldName::CellVolumeRatio, 4).unwrap();
    assert!(ratios.len() == 2 + 5 && ratios[..2].iter().all(|ratio| (ratio - 1.0).abs() < 0.1));
    assert!(ratios[2..].iter().all(|ratio| ratio.is_nan()), "{ratios:?}");
    let moved = series.values(FieldName::Displacement, 4).unwrap();
    assert_eq!(moved.len(), 3 * problem.body.mesh().n_nodes());
    let mesh = series.mesh().unwrap();
    let lines: Vec<Vec<u32>> =
        mesh.cells().filter(|cell| cell.kind == CellKind::Line2).map(|cell| cell.nodes.to_vec()).collect();
    assert_eq!(lines, [[12, 13], [12, 14], [12, 15]]);
}

/// A face of an elastic block is a rigid plate on a hinge, with a mass in addition.
const PLATE: &str = "\
    mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }\n\
    region = [{ density = 2, material.neo-hooke = { lambda = 1000, mu = 500 } }]\n\
    rigid = [{ name = 'plate', group = 'y-max', mass = 0.5 }]\n\
    joint = [{ name = 'hinge', revolute = { between = ['plate', 'ground'], at = [0.5, 2, 0.5], axis = [1, 0, 0] } }]\n\
    load = [{ acceleration = [0, 0, -9.81] }, { group = 'plate', force = [0, 0, 1] }]\n\
    initial = [{ group = 'body', velocity = [1, 0, 0] }]\n\
    time = { scheme = 'DGM', degree = 2, steps = [{ until = 0.2, size = 0.05 }] }\n";

#[test]
fn faces_of_a_mesh_are_rigid_bodies() {
    let temp = tempfile::tempdir().unwrap();
    let file = temp.path().join("plate.toml");
    std::fs::write(&file, PLATE).unwrap();
    let read = |set: &[&str]| {
        let (output, set) = (Some(temp.path().join("out")), set.iter().map(ToString::to_string).collect());
        input::read(&file, &Overrides { output, set, ..Default::default() })
            .map_err(|error| error.to_string())
    };
    let problem = read(&[]).unwrap();
    // The masses of cells count once: region and what is added.
    let masses: Vec<f64> = problem.body.regions().iter().map(|region| region.mass).collect();
    assert_eq!(masses, [4.0, 0.5]);
    assert!((problem.body.lumped_mass().iter().sum::<f64>() - 4.5).abs() < 1e-14);
    let centre = problem.body.rigid_bodies().next().unwrap().centre;
    assert_eq!(centre, Some([0.5, 2.0, 0.5]));
    let note = "initial velocity of `body`: 4 nodes start with the velocity of a rigid body instead; give one to `plate`";
    assert!(problem.notes.iter().any(|own| own == note), "{:?}", problem.notes);
    let mut motion = problem.motion(&mut []).unwrap();
    let mut results = Results::create(&problem).unwrap();
    motion.march(&problem.plan, &mut [&mut results]).unwrap();
    assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());
    let history = History::read(&temp.path().join("out/history.csv")).unwrap();
    let column = |name: &str| history.column(name).unwrap_or_else(|| panic!("no {name}"));
    for name in ["hinge_force_z", "hinge_angle", "plate_z", "plate_spin_x"] {
        assert!(column(name)[1..].iter().all(|number| number.is_finite()), "{name}");
    }
    assert!(column("plate_z").iter().all(|z| (z - 0.5).abs() < 1e-14) && column("plate_spin_x")[4] != 0.0);
    for (set, words) in [
        ("rigid.0.group='y-mx'", "no group `y-mx` of nodes, facets or cells"),
        ("rigid.0.name='y-max'", "the mesh has a group `y-max`, too"),
        ("rigid.0.inertia=[0.1, 0.1, 0.3]", "no body has these moments of inertia: 0.3 exceeds 0.1 + 0.1"),
        (
            "support=[{ group = 'y-max', fix = ['x'] }]",
            "belongs to the rigid body \"plate\"; hold the body instead",
        ),
        (
            "tie=[{ follower = 'y-max', leader = 'y-min', kind = 'nodes', tolerance = 9 }]",
            "swap follower and leader",
        ),
    ] {
        let error = read(&[set]).err().unwrap_or_else(|| panic!("{set}"));
        assert!(error.contains(words), "{set}: {error}");
    }
    // A moment and a hinge need a direction, which a face has once it is rigid.
    assert!(read(&["load=[{ group = 'plate', moment = [0, 0, 1] }]"]).is_ok());
    let error = read(&["joint.0.revolute.between=['y-max', 'ground']"]).err().unwrap();
    assert!(error.contains("`y-max` is a group of an elastic body and has no direction"), "{error}");
}
