//! Frames and histories of a team of threads, against those of the whole body.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, io};

use emmy::body::{Body, FieldName, FieldValues, Fields, Place, Region};
use emmy::material::NeoHooke;
use emmy::mesh::{Share, block, owners};
use emmy::motion::{Motion, State};
use emmy::team::{Team, Threads};

use crate::history::{Extreme, History, HistoryColumns, Row, fixed_names};
use crate::input::{self, Overrides, Problem};
use crate::mesh::vtu;
use crate::recording::Recording;
use crate::results::{Ending, Results};
use crate::summary::Status;
use crate::vtk::{Format, FrameTime, FrameWriter, Precision};
use crate::whole_file::names;

const INPUT: &str = "\
    mesh.box = { size = [1, 2, 1], cells = [2, 4, 2] }\n\
    region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]\n\
    time = { scheme = 'DGM', steps = [{ until = 0.5, size = 0.1 }] }\n\
    solver.kind = 'iterative'\n\
    newton.tolerance = 1e-13\n\
    [output]\n\
    every = 1\n\
    extremes = ['von_mises_stress', 'velocity', 'cell_volume_ratio']\n\
    probes = [\n\
        { name = 'tip', point = [1, 2, 1], quantities = ['position', 'velocity', 'cauchy_stress'] },\n\
        { name = 'middle', point = [0.5, 0.75, 0.5], quantities = ['momentum_density', 'displacement'] },\n\
        { name = 'seen', point = [1, 2, 0], quantities = ['displacement', 'velocity'], relative_to = 'rigid-motion' },\n\
    ]\n\
    values = [\n\
        { name = 'energy', quantity = 'strain_energy_density', measure = 'total' },\n\
        { name = 'stress', quantity = 'cauchy_stress', group = 'body' },\n\
        { name = 'face', quantity = 'velocity', group = 'x-max' },\n\
        { name = 'most', quantity = 'von_mises_stress', group = 'y-max', measure = 'max' },\n\
    ]\n";

fn problem(directory: &Path) -> Problem {
    let file = directory.join("box.toml");
    // Once, before the ranks read it.
    if !file.exists() {
        fs::write(&file, INPUT).unwrap();
    }
    let fields = format!("output.fields={:?}", FieldName::ALL.map(FieldName::name));
    let overrides =
        Overrides { output: Some(directory.join("out")), set: vec![fields], ..Default::default() };
    input::read(&file, &overrides).unwrap()
}

/// The part of a rank of the body of a problem.
fn part_of(whole: &Body, team: Arc<dyn Team>) -> Body {
    let share = Share::new(whole.mesh(), &owners(whole.mesh(), team.size()).unwrap(), team.rank());
    let rubber = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 2.0);
    Body::shared(share, team).region(rubber).build().unwrap()
}

/// A bent state that moves, without any symmetry.
fn bent(body: &Body) -> State {
    let mut state = State::initial(body, 0.0, &[]).unwrap();
    let points = body.mesh().points().iter();
    state.displacement = points
        .clone()
        .flat_map(|[x, y, z]| [0.1 * x * y, 0.02 * y * y + 0.01 * x, 0.03 * z * (x + 2.0 * y)])
        .collect();
    state.velocity =
        points.flat_map(|[x, y, z]| [0.3 * y * z, 0.2 * x - 0.1 * z * y, 0.4 * x * y + z]).collect();
    state.transferred(body, 0.0).unwrap()
}

/// Rows of the history of a problem at its start and after two steps, and the largest stress in the frame of the start.
fn results(problem: &Problem) -> ([Row; 2], Vec<Extreme>) {
    let body = &problem.body;
    let mut motion = Motion::starting(body, problem.scheme, problem.newton, bent(body)).unwrap();
    let columns = HistoryColumns::of(problem);
    let start = columns.row(motion.view(), 0.0);
    let (mut recording, missing) = Recording::open(problem, None).unwrap();
    assert!(missing.is_empty());
    let largest = recording.write(&motion).unwrap();
    recording.finish().unwrap();
    assert_eq!(recording.written(), [FrameTime { step: 0, time: 0.0 }]);
    (0..2).for_each(|_| _ = motion.step(0.1).unwrap());
    ([start, columns.row(motion.view(), 0.0)], largest)
}

/// Checks numbers to 1e-12 of the largest.
fn assert_near(own: &[f64], whole: &[f64], what: &str) {
    let largest = whole.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    assert_eq!(own.len(), whole.len(), "{what}");
    for (own, whole) in own.iter().zip(whole) {
        // At the start there is no acceleration.
        let is_near = (own - whole).abs() <= 1e-12 * largest || own.is_nan() && whole.is_nan();
        assert!(is_near, "{what}: {own} instead of {whole}");
    }
}

fn frame_of(directory: &Path, ending: &str) -> PathBuf {
    directory.join(format!("out/frames/out_000000.{ending}"))
}

#[test]
fn rows_and_frames_are_those_of_the_whole_body() {
    let temp = tempfile::tempdir().unwrap();
    let whole_problem = problem(temp.path());
    let (whole, largest) = results(&whole_problem);
    let n_fixed = HistoryColumns::of(&whole_problem)
        .names()
        .iter()
        .filter(|name| fixed_names().any(|own| own == *name))
        .count();
    assert!(whole[0].numbers.len() > n_fixed + 20);
    let file = frame_of(temp.path(), "vtu");
    let bytes = fs::read(&file).unwrap();
    let frame = vtu::frame(&file, &bytes).unwrap();
    for size in [2, 3] {
        let temp = tempfile::tempdir().unwrap();
        problem(temp.path());
        let ranks = Threads::run(size, |team| {
            let problem = problem(temp.path());
            let body = part_of(&problem.body, team);
            results(&Problem { body, ..problem })
        });
        for (rows, of_frame) in ranks.unwrap() {
            let numbers =
                |row: &Row| row.numbers[n_fixed..].iter().map(|number| number.value()).collect::<Vec<_>>();
            let place =
                |extreme: &Extreme| (extreme.member, extreme.is_cell, extreme.point, extreme.field.clone());
            for (row, whole) in rows.iter().zip(&whole) {
                assert_near(&numbers(row), &numbers(whole), "columns");
                assert!(row.extremes.iter().map(place).eq(whole.extremes.iter().map(place)));
            }
            assert!(of_frame.len() == 1 && of_frame.iter().map(place).eq(largest.iter().map(place)));
        }
        let list = frame_of(temp.path(), "pvtu");
        let joined = vtu::joined_frame(&list).unwrap();
        assert!(joined.points == frame.points && joined.cells == frame.cells);
        let names: Vec<&str> = frame.fields.iter().map(|(name, _)| name.as_str()).collect();
        assert!(names.contains(&"cauchy_stress"));
        let fields = vtu::fields(&file, &bytes, Place::Nodes, &names).unwrap();
        let of_pieces = vtu::joined_fields(&list, &names).unwrap();
        for ((own, whole), name) in of_pieces.iter().zip(&fields).zip(names) {
            assert_near(own, whole, name);
        }
        assert_cells_are_equal(&list, size, &file);
    }
}

/// Fields in the cells of all pieces, by the numbers of the cells; every cell is in one piece.
fn assert_cells_are_equal(list: &Path, size: usize, file: &Path) {
    const NAMES: [&str; 5] =
        ["cell_cauchy_stress", "cell_volume_ratio", "region", "group:body", "facets:x-max"];
    let whole = vtu::fields(file, &fs::read(file).unwrap(), Place::Cells, &NAMES).unwrap();
    let mut joined: Vec<Vec<f64>> = whole.iter().map(|numbers| vec![f64::NAN; numbers.len()]).collect();
    let mut n_cells = 0;
    for rank in 0..size {
        let path = list.with_extension("").join(format!("{rank:04}.vtu"));
        let bytes = fs::read(&path).unwrap();
        let of_piece = |name| vtu::fields(&path, &bytes, Place::Cells, &[name]).unwrap().concat();
        let cells = of_piece("cell");
        assert_eq!(of_piece("rank"), vec![rank as f64; cells.len()]);
        n_cells += cells.len();
        for (name, joined) in NAMES.into_iter().zip(&mut joined) {
            let numbers = of_piece(name);
            let n = numbers.len() / cells.len();
            for (numbers, cell) in numbers.chunks_exact(n).zip(&cells) {
                joined[n * *cell as usize..][..n].copy_from_slice(numbers);
            }
        }
    }
    assert_eq!(n_cells, 16);
    for ((own, whole), name) in joined.iter().zip(&whole).zip(NAMES) {
        assert_near(own, whole, name);
    }
}

const FORM: (Format, Precision) = (Format::Vtu, Precision::Double);

/// Writes the displacement as the frames of some steps.
fn write(frames: &mut FrameWriter, body: &Body, steps: std::ops::Range<usize>) -> io::Result<()> {
    let state = bent(body);
    let fields: Vec<FieldValues> =
        Fields::new(body).at([&state.displacement, &state.velocity], &[FieldName::Displacement]);
    steps.into_iter().try_for_each(|step| frames.write(step, step as f64, &fields))
}

fn times(steps: std::ops::Range<usize>) -> Vec<FrameTime> {
    steps.map(|step| FrameTime { step, time: step as f64 }).collect()
}

#[test]
fn frames_are_resumed_by_other_numbers_of_ranks_and_alone() {
    let temp = tempfile::tempdir().unwrap();
    let whole = problem(temp.path()).body;
    let directory = temp.path().join("out");
    let there = |path: &str| {
        let mut names = names(&directory.join(path)).unwrap();
        names.sort();
        names
    };
    Threads::run(3, |team| {
        let body = part_of(&whole, team);
        let mut frames = FrameWriter::create(FORM, &directory, &body).unwrap();
        write(&mut frames, &body, 0..4).unwrap();
        frames.finish().unwrap();
    })
    .unwrap();
    assert_eq!(there("frames").len(), 8);
    assert_eq!(there("frames/out_000003"), ["0000.vtu", "0001.vtu", "0002.vtu"]);
    // A killed run left pieces without a list.
    fs::remove_file(directory.join("frames/out_000003.pvtu")).unwrap();
    fs::write(directory.join("frames/out_000003/mine.txt"), "").unwrap();
    fs::remove_file(directory.join("frames/out_000001.pvtu")).unwrap();
    Threads::run(2, |team| {
        let body = part_of(&whole, team);
        let (mut frames, missing) = FrameWriter::resume(FORM, &directory, &body, (&times(0..2), 1)).unwrap();
        assert_eq!(missing, times(1..2));
        assert_eq!(frames.last_step(), Some(0));
        write(&mut frames, &body, 2..3).unwrap();
    })
    .unwrap();
    assert_eq!(
        there("frames"),
        ["out_000000", "out_000000.pvtu", "out_000002", "out_000002.pvtu", "out_000003"]
    );
    assert_eq!(
        (there("frames/out_000002").len(), there("frames/out_000003")),
        (2, vec!["mine.txt".to_string()])
    );
    let kept = [times(0..1), times(2..3)].concat();
    let (mut frames, missing) = FrameWriter::resume(FORM, &directory, &whole, (&kept, 2)).unwrap();
    assert!(missing.is_empty());
    write(&mut frames, &whole, 3..5).unwrap();
    Threads::run(4, |team| {
        let body = part_of(&whole, team);
        let kept = [kept.clone(), times(3..4)].concat();
        let (mut frames, missing) = FrameWriter::resume(FORM, &directory, &body, (&kept, 3)).unwrap();
        assert!(missing.is_empty());
        write(&mut frames, &body, 4..5).unwrap();
    })
    .unwrap();
    let collection = fs::read_to_string(directory.join("out.pvd")).unwrap();
    let listed: Vec<&str> =
        collection.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(
        listed,
        [
            "frames/out_000000.pvtu",
            "frames/out_000002.pvtu",
            "frames/out_000003.vtu",
            "frames/out_000004.pvtu"
        ]
    );
    assert!(!directory.join("frames/out_000004.vtu").exists());
    // The frames of the next run replace them all.
    crate::directory::remove_frames(&directory).unwrap();
    assert_eq!(there("frames"), ["out_000003"]);
}

#[test]
fn an_error_of_one_rank_is_an_error_of_all_and_lists_nothing() {
    let temp = tempfile::tempdir().unwrap();
    let whole = problem(temp.path()).body;
    let directory = temp.path().join("out");
    // A folder in the place of a piece.
    fs::create_dir_all(directory.join("frames/out_000000/0001.vtu")).unwrap();
    let errors = Threads::run(3, |team| {
        let body = part_of(&whole, team);
        let mut frames = FrameWriter::create(FORM, &directory, &body).unwrap();
        write(&mut frames, &body, 0..1).unwrap_err().to_string()
    })
    .unwrap();
    // Other ranks know where it was.
    assert!(errors[1].contains("0001.vtu"), "{errors:?}");
    assert!([0, 2].iter().all(|&rank| errors[rank] == format!("rank 1: {}", errors[1])), "{errors:?}");
    assert!(!directory.join("frames/out_000000.pvtu").exists());
    let collection = fs::read_to_string(directory.join("out.pvd")).unwrap();
    assert!(!collection.contains("DataSet"));
}

/// Rank 0 writes the peaks of all ranks: those of the rows of the history.
#[test]
fn the_summary_of_a_team_has_the_peaks_of_its_history() {
    let temp = tempfile::tempdir().unwrap();
    let problem = || problem(temp.path());
    drop(problem());
    Threads::run(3, |team| {
        let problem = problem();
        let problem = Problem { body: part_of(&problem.body, team), ..problem };
        let mut results = Results::create(&problem).unwrap();
        let start = bent(&problem.body);
        let mut motion = Motion::starting(&problem.body, problem.scheme, problem.newton, start).unwrap();
        motion.march(&problem.plan, &mut [&mut results]).unwrap();
        assert!(results.finish(&problem, &motion, Status::Done, None).error.is_none());
    })
    .unwrap();
    let history = History::read(&temp.path().join("out/history.csv")).unwrap();
    let text = fs::read_to_string(temp.path().join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let time = history.column("time").unwrap();
    let mut n_compared = 0;
    for name in history.columns().iter().filter(|name| !fixed_names().any(|fixed| fixed == *name)) {
        let numbers = history.column(name).unwrap();
        let of = |ending: &str| summary[format!("{name}{ending}")].as_f64().unwrap();
        let [smallest, largest] = [f64::min, f64::max].map(|of| numbers.iter().copied().reduce(of).unwrap());
        assert_eq!([of("_min"), of("_max"), of("")], [smallest, largest, numbers[5]], "{name}");
        let first = |number: f64| time[numbers.iter().position(|own| *own == number).unwrap()];
        assert_eq!([of("_min_time"), of("_max_time")], [first(smallest), first(largest)], "{name}");
        n_compared += 1;
    }
    // Vectors and a tensor of three probes, three extremes, three values and a tensor.
    assert_eq!(n_compared, 6 + 6 + 6 + 6 + 3 + 1 + 6 + 3 + 1);
}

/// A run that fails on one rank has failed on all: else the others would wait for its last checkpoint.
#[test]
fn the_status_at_the_end_is_that_of_all_ranks() {
    let temp = tempfile::tempdir().unwrap();
    let problem = || problem(temp.path());
    drop(problem());
    // A run that fails on rank 1, and one whose summary cannot be written by rank 0.
    for fails in [true, false] {
        let endings = Threads::run(3, |team| {
            let (rank, problem) = (team.rank(), problem());
            let problem = Problem { body: part_of(&problem.body, team), ..problem };
            let mut results = Results::create(&problem).unwrap();
            let start = bent(&problem.body);
            let motion = Motion::starting(&problem.body, problem.scheme, problem.newton, start).unwrap();
            let summary = results.directory().join("summary.json");
            if rank == 0 && !fails {
                fs::remove_file(&summary).unwrap();
                fs::create_dir(&summary).unwrap();
            }
            let status = if fails && rank == 1 { Status::Failed } else { Status::Done };
            let Ending { status, error, .. } = results.finish(&problem, &motion, status, None);
            if rank == 0 && !fails {
                fs::remove_dir(&summary).unwrap();
            }
            (status, error.map(|error| error.to_string()))
        });
        for (status, error) in endings.unwrap() {
            assert_eq!((status == Status::Failed, error.is_some()), (fails, !fails), "{error:?}");
        }
        fs::remove_dir_all(temp.path().join("out")).unwrap();
    }
}

#[test]
fn one_file_of_all_frames_is_rejected() {
    let temp = tempfile::tempdir().unwrap();
    let whole = problem(temp.path()).body;
    Threads::run(2, |team| {
        let body = part_of(&whole, team);
        let form = (Format::Vtkhdf, Precision::Double);
        let error = FrameWriter::create(form, temp.path(), &body).unwrap_err().to_string();
        assert_eq!(error, "one file of all frames (use `output.format = \"vtu\"`) is not possible on a team");
    })
    .unwrap();
}

/// More ranks than have cells that count: they write no piece.
#[test]
fn ranks_without_cells_write_nothing() {
    let temp = tempfile::tempdir().unwrap();
    let mesh = block([3.0, 1.0, 1.0], [3, 1, 1]).unwrap();
    // The last rank owns nodes of a cell that counts on another rank.
    let owners: Vec<u32> =
        mesh.points().iter().map(|x| if x[0] > 2.5 { 2 } else { u32::from(x[0] > 0.5) }).collect();
    let directory = temp.path().join("out");
    Threads::run(3, |team| {
        let rubber = Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 2.0);
        let body =
            Body::shared(Share::new(&mesh, &owners, team.rank()), team).region(rubber).build().unwrap();
        let mut frames = FrameWriter::create(FORM, &directory, &body).unwrap();
        write(&mut frames, &body, 0..1).unwrap();
    })
    .unwrap();
    assert_eq!(names(&directory.join("frames/out_000000")).unwrap().len(), 2);
    let joined = vtu::joined_frame(&directory.join("frames/out_000000.pvtu")).unwrap();
    assert_eq!(joined.points, mesh.points());
    assert!(
        joined
            .cells
            .iter()
            .map(|(kind, nodes)| (*kind, &nodes[..]))
            .eq(mesh.cells().map(|cell| (cell.kind, cell.nodes)))
    );
}

/// The messages of all ranks, of which the last one reads another file.
fn messages(own: &Path, other: &Path) -> Vec<Option<String>> {
    let read = |team: Arc<dyn Team>| {
        let file = if team.rank() == 2 { other } else { own };
        let output = Some(own.with_file_name("out"));
        let problem = input::read_on_team(file, &Overrides { output, ..Default::default() }, &team);
        problem.err().map(|error| error.to_string())
    };
    Threads::run(3, read).unwrap()
}

#[test]
fn ranks_with_two_inputs_are_rejected_before_they_build_anything() {
    let temp = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = temp.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    };
    let own = write("own/box.toml", INPUT);
    for (from, to, says) in [
        ("density = 2", "density = 3", ": `region.0.density` is 3"),
        ("cells = [2, 4, 2]", "cells = [2, 4, 3]", ": `mesh.box.cells.2` is 3 there, and 2 on rank 0"),
        ("until = 0.5", "until = 0.6", ": `time.steps.0.until` is 0.6 there, and 0.5 on rank 0"),
        ("scheme = 'DGM'", "scheme = 'Bathe'", ""),
        ("every = 1\n", "every = 2\n", ": `output.every` is 2 there, and 1 on rank 0"),
    ] {
        let found = messages(&own, &write("other/box.toml", &INPUT.replace(from, to)));
        let is_told = |message: &Option<String>| {
            message.as_ref().is_some_and(|text| text.contains(&format!("rank 2 has another input{says}")))
        };
        assert!(found.iter().all(is_told), "{to}: {found:?}");
    }
    // The same content elsewhere.
    assert_eq!(messages(&own, &write("other/box.toml", INPUT)), [None, None, None]);

    // A fault on one rank is one of all.
    let found = messages(&own, &write("other/box.toml", "mesh = 1"));
    assert!(found.iter().all(Option::is_some));
}

#[test]
fn ranks_with_two_tables_are_rejected() {
    let temp = tempfile::tempdir().unwrap();
    let loaded = format!(
        "{INPUT}[[load]]\ngroup = 'y-max'\ntraction = [1, 0, 0]\nhistory = {{ file = 'table.csv', time = 't', value = 'f' }}\n"
    );
    let [own, other] = ["own", "other"].map(|name| temp.path().join(name));
    for folder in [&own, &other] {
        fs::create_dir(folder).unwrap();
        fs::write(folder.join("box.toml"), &loaded).unwrap();
        fs::write(folder.join("table.csv"), "t,f\n0,0\n1,2\n").unwrap();
    }
    let files = [&own, &other].map(|folder| folder.join("box.toml"));
    assert_eq!(messages(&files[0], &files[1]), [None, None, None]);
    fs::write(other.join("table.csv"), "t,f\n0,0\n1,3\n").unwrap();
    for message in messages(&files[0], &files[1]) {
        assert!(message.is_some_and(|text| text.contains("rank 2 has other files of histories: 2 rows")));
    }
}
